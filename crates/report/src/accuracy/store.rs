//! The records of a sweep: a file of JSON lines, one for each measurement, written at once.
//!
//! An interrupted sweep finds its records there and continues with the missing ones. A truncated
//! last line is ignored.

mod records;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use super::setting::Target;
use crate::measure::{SHORT, Timing, quiet};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{make_folder, written};

pub use records::*;

/// All records of one kind.
pub fn all<T: 'static>(records: &[Record]) -> impl Iterator<Item = &T> {
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
    for point in all::<PointRecord>(records).filter(|point| point.scene == scene) {
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

/// The records in `text`, the contents of `path`, and the length of its whole lines in bytes.
fn records(text: &str, path: &Path) -> Result<(Vec<Record>, usize)> {
    let whole = text.rfind('\n').map_or(0, |end| end + 1);
    let lines = text[..whole].lines().enumerate();
    let record = |(number, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|e| {
            Error::new(ErrorKind::Io, format!("line {} is not a record: {e}", number + 1))
                .in_file(path)
                .remedy("remove the file to start again")
        })
    };
    Ok((lines.map(record).collect::<Result<_>>()?, whole))
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
        let (records, whole) = records(&text, &path)?;
        file.set_len(whole as u64).map_err(failed)?;
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

    /// Appends a record and flushes it to the disk.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, record: Record) -> Result<()> {
        let failed = |e| Error::io("cannot write a record", self.folder.join(FILE), e);
        let line = serde_json::to_string(&record).map_err(|e| failed(e.into()))?;
        self.file.write_all(format!("{line}\n").as_bytes()).map_err(failed)?;
        self.file.flush().map_err(failed)?;
        self.records.push(record);
        Ok(())
    }

    /// Whether a setting has been rendered with a seed.
    pub fn has(&self, scene: &str, target: Target, key: &str, seed: u64) -> bool {
        let asked = (scene, target, key, seed);
        all(&self.records).any(|p: &PointRecord| (&*p.scene, p.target, &*p.key, p.seed) == asked)
    }

    /// Refuses scenes with a duplicate name or with changes since their records were made.
    ///
    /// # Errors
    /// If `scene` is not the one with that name in the records.
    pub fn admit(&mut self, scene: SceneRecord) -> Result<()> {
        let is_it = |known: &&SceneRecord| known.scene == scene.scene;
        let known = all(&self.records).find(is_it);
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
