//! The records of a sweep: a file of JSON lines, one for each measurement, written at once.
//!
//! An interrupted sweep finds its records there and continues with the missing ones. A truncated
//! last line is ignored.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::setting::Truth;
use crate::bench::{Circumstances, Preparation};
use crate::measure::{SHORT, Timing, quiet};
use crate::selftest::errors::HitErrors;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{make_folder, written};

/// The values shared by all records of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepHeader {
    /// The program's version.
    pub version: String,
    /// Largest length of the longer side of images in pixels.
    pub longest: u32,
    /// Largest number of points of a kind.
    pub most: u32,
    /// Smallest number of points of a render of the reference.
    pub least: u32,
}

/// A scene of the sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// Its name.
    pub scene: String,
    /// Its file.
    pub file: PathBuf,
    /// See [`wavecrest_core::prepared::PreparedScene::fingerprint`], in hexadecimal.
    pub fingerprint: String,
    /// Width and height of the images, in pixels.
    pub size: [u32; 2],
    /// Triangles, quads and spheres.
    pub primitives: u64,
}

/// The preparation of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PreparedRecord {
    /// The scene's name.
    pub scene: String,
    /// The time of each stage.
    #[serde(flatten)]
    pub time: Preparation,
}

/// A reference, stored in a file beside this one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "as in the table of `report`")]
pub struct ReferenceRecord {
    pub scene: String,
    pub target: Truth,
    pub file: String,
    pub samples: u64,
    pub replicates: u32,
    pub standard_error: f64,
    pub seconds: f64,
}

/// One render of a setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointRecord {
    /// The scene's name.
    pub scene: String,
    /// The target that it is compared with.
    pub target: Truth,
    /// The setting.
    pub key: String,
    /// Its seed.
    pub seed: u64,
    /// Seconds from the first ray to the last.
    pub seconds: f64,
    /// Wall-clock and processor time of all repetitions, of which the fastest counts.
    pub timing: Timing,
    /// Rays of every kind.
    pub rays: u64,
    /// Errors against the reference, as in [`wavecrest_image::compare`].
    #[serde(flatten)]
    pub error: ImageErrors,
}

/// The differences of an image from the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImageErrors {
    /// Mean squared error.
    pub mse: f64,
    /// Mean squared error relative to the square of the reference.
    pub relative_mse: f64,
    /// Mean signed error.
    pub bias: f64,
    /// Mean FLIP.
    pub flip: f64,
}

/// A test of a precision on a scene's triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialRecord {
    /// The scene's name.
    pub scene: String,
    /// The precision.
    pub precision: String,
    /// Rays aimed at edges, and the number that passed between two triangles.
    pub leaks: [u64; 2],
    /// Rays that leave a triangle, and the number that hit it again.
    pub self_hits: [u64; 2],
    /// Errors of hits against the exact ones.
    pub errors: Box<HitErrors>,
}

/// A line of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "record", rename_all = "kebab-case")]
#[allow(missing_docs, reason = "each says what it is")]
pub enum Record {
    Header(SweepHeader),
    Circumstances(Circumstances),
    Scene(SceneRecord),
    Prepared(PreparedRecord),
    Reference(ReferenceRecord),
    Point(PointRecord),
    Trial(TrialRecord),
}

impl Record {
    /// The record, if it is of kind `T`.
    fn of<T: 'static>(&self) -> Option<&T> {
        let found: &dyn Any = match self {
            Self::Header(found) => found,
            Self::Circumstances(found) => found,
            Self::Scene(found) => found,
            Self::Prepared(found) => found,
            Self::Reference(found) => found,
            Self::Point(found) => found,
            Self::Trial(found) => found,
        };
        found.downcast_ref()
    }
}

/// All records of one kind.
pub fn records_of<T: 'static>(records: &[Record]) -> impl Iterator<Item = &T> {
    records.iter().filter_map(Record::of)
}

/// The number of rounds of a scene, and the seeds of those that were busy.
pub(crate) fn busy_rounds(scene: &str, records: &[Record]) -> (usize, BTreeSet<u64>) {
    let rounds = sums(scene, records);
    let quiet = quiet(&rounds.values().copied().collect::<Vec<_>>());
    let busy = rounds.keys().zip(&quiet).filter(|(_, quiet)| !**quiet).map(|(seed, _)| *seed);
    (rounds.len(), busy.collect())
}

/// The largest share of the processors that the threads of this pool got in a round of a scene.
pub(crate) fn largest_share(scene: &str, records: &[Record]) -> Option<f64> {
    let shares = sums(scene, records).into_values().filter(|round| round.seconds >= SHORT);
    let threads = rayon::current_num_threads() as f64;
    shares.filter_map(|round| Some(round.processors()? / threads)).reduce(f64::max)
}

/// The duration of all renders of a scene with each seed.
fn sums(scene: &str, records: &[Record]) -> BTreeMap<u64, Timing> {
    let mut rounds: BTreeMap<u64, Vec<Timing>> = BTreeMap::new();
    for point in records_of::<PointRecord>(records).filter(|point| point.scene == scene) {
        rounds.entry(point.seed).or_default().push(point.timing);
    }
    rounds.into_iter().map(|(seed, all)| (seed, all.into_iter().sum())).collect()
}

/// The records of a sweep, in a folder.
#[derive(Debug)]
pub struct Store {
    /// The folder.
    pub folder: PathBuf,
    /// What all records share.
    pub header: SweepHeader,
    /// All records, in the order of their creation.
    pub records: Vec<Record>,
    file: File,
}

/// The name of the file.
pub const FILE: &str = "results.jsonl";

impl Store {
    /// Opens or creates the records of a sweep in `folder`, which is created if it is missing.
    ///
    /// # Errors
    /// If the folder has the records of a sweep with another `header`, or cannot be written.
    pub fn open(folder: &Path, header: &SweepHeader) -> Result<Self> {
        make_folder(folder)?;
        let path = folder.join(FILE);
        let failed = |e| Error::io("cannot open the records", path.as_path(), e);
        let mut options = OpenOptions::new();
        let mut file = options.read(true).append(true).create(true).open(&path).map_err(failed)?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(failed)?;
        text.truncate(text.rfind('\n').map_or(0, |end| end + 1));
        let record = |(number, line): (usize, &str)| {
            serde_json::from_str(line).map_err(|e| {
                Error::new(ErrorKind::Io, format!("line {number} is not a record: {e}"))
                    .in_file(&path)
                    .remedy("remove the file to start again")
            })
        };
        let records = (1..).zip(text.lines()).map(record).collect::<Result<_>>()?;
        file.set_len(text.len() as u64).map_err(failed)?;
        written().insert(path.clone());
        let mut store = Self { folder: folder.to_owned(), header: header.clone(), records, file };
        match store.records.first() {
            None => store.add(Record::Header(header.clone()))?,
            Some(Record::Header(found)) if found == header => {}
            Some(_) => {
                let message = "the folder has the results of another sweep";
                let error = Error::new(ErrorKind::Usage, message).in_file(&path);
                return Err(error.remedy("use the same options as before, or another folder"));
            }
        }
        Ok(store)
    }

    /// Appends a record.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, record: Record) -> Result<()> {
        let failed = |e| Error::io("cannot write a record", self.folder.join(FILE), e);
        let line = serde_json::to_string(&record).map_err(|e| failed(e.into()))?;
        self.file.write_all(format!("{line}\n").as_bytes()).map_err(failed)?;
        self.records.push(record);
        Ok(())
    }

    /// Refuses scenes with a duplicate name or with changes since their records were made.
    ///
    /// # Errors
    /// If `scene` is not the one with that name in the records.
    pub fn admit(&mut self, scene: SceneRecord) -> Result<()> {
        let is_it = |known: &&SceneRecord| known.scene == scene.scene;
        let known = records_of(&self.records).find(is_it);
        match known {
            None => self.add(Record::Scene(scene)),
            Some(known) if known.fingerprint == scene.fingerprint => Ok(()),
            Some(_) => {
                Err(Error::new(ErrorKind::Usage, "the scene differs from the one in the results")
                    .in_file(&scene.file)
                    .value(scene.scene)
                    .remedy("rename the scene, or use another folder"))
            }
        }
    }
}

#[cfg(test)]
mod tests;
