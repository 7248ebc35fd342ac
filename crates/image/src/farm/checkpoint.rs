//! Checkpoints: the finished units of a render, saved regularly and loaded to resume it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::part::{self, PartHeader, PartReader, StoredUnit};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::lock;
use wavecrest_core::render::work::{Summed, Task};

/// The checkpoint of a render.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// The part file.
    pub file: PathBuf,
    /// The shortest time between two saves: a save happens when a unit is finished, and less often
    /// if saving takes long.
    pub every: Duration,
    /// Whether to resume from the file. Without a file, everything is rendered.
    pub resume: bool,
}

impl Checkpoint {
    /// The units in the file for the render of `header`. Units with samples that are not finite are
    /// left out and rendered again, so that these samples are counted and located again.
    ///
    /// # Errors
    /// If the file is damaged or of another render, or if it exists but resuming was not requested:
    /// no work is discarded.
    pub(super) fn load(&self, header: &PartHeader) -> Result<Option<UnitStore>> {
        if !self.check()? {
            return Ok(None);
        }
        let mut reader = PartReader::open(&self.file)?;
        check_same(&self.file, &reader.header, header)?;
        let store = UnitStore::default();
        while let Some(unit) = reader.next_unit()? {
            if unit.invalid == 0 {
                store.put(unit);
            }
        }
        Ok(Some(store))
    }

    /// Whether there is a file to resume from; call it before long work.
    ///
    /// # Errors
    /// If the file exists but resuming was not requested: no work is discarded.
    pub fn check(&self) -> Result<bool> {
        match self.file.try_exists() {
            Err(error) => Err(Error::io("cannot read the checkpoint", &self.file, error)),
            Ok(true) if !self.resume => {
                Err(Error::new(ErrorKind::Usage, "the checkpoint exists already")
                    .in_file(&self.file)
                    .remedy("resume from it with --resume, or remove it"))
            }
            Ok(exists) => Ok(exists),
        }
    }
}

/// Refuses a checkpoint of another render.
fn check_same(file: &Path, found: &PartHeader, header: &PartHeader) -> Result<()> {
    let remedies = [
        "use the same options, or another checkpoint file",
        "restore the scene, or use another checkpoint file",
    ];
    let names = ["the checkpoint", "this render"];
    found.identity.check_same(file, &header.identity, names, remedies)?;
    if found.shard == header.shard {
        return Ok(());
    }
    let name = |header: &PartHeader| {
        header.shard.map_or("the whole image".to_owned(), |shard| format!("shard {shard}"))
    };
    let error = Error::new(ErrorKind::Usage, "the checkpoint belongs to another shard");
    let remedy = format!("this render is {}; use one checkpoint file for each shard", name(header));
    Err(error.in_file(file).value(name(found)).remedy(remedy))
}

/// The start of a unit: its tile, and its first block.
type UnitStart = (u32, u32);

/// Finished units in memory, at most one for each start, saved while others are rendered.
#[derive(Debug, Default)]
pub(super) struct UnitStore {
    units: Mutex<BTreeMap<UnitStart, Arc<StoredUnit>>>,
}

impl UnitStore {
    /// Stores a unit; it replaces a shorter one with the same start.
    pub(super) fn put(&self, unit: StoredUnit) {
        lock(&self.units).insert((unit.tile, unit.blocks.start), Arc::new(unit));
    }

    /// As [`UnitStore::put`], from the render loop.
    pub(super) fn keep(&self, summed: &Summed<'_>) {
        let Summed { tile, blocks, invalid, sums } = summed.clone();
        self.put(Summed { tile, blocks, invalid, sums: sums.into_owned().into() });
    }

    /// Writes the current units as a part with this header.
    pub(super) fn write(&self, path: &Path, header: &PartHeader) -> Result<()> {
        let units = self.all();
        let header = PartHeader { units: units.len() as u64, ..header.clone() };
        part::write(path, &header, units.iter().map(|unit| &**unit))
    }

    /// The current units, in order. They are shared, not copied.
    pub(super) fn all(&self) -> Vec<Arc<StoredUnit>> {
        lock(&self.units).values().cloned().collect()
    }

    /// The rest of a task: all of it, nothing, or the blocks after those stored.
    pub(super) fn rest(&self, task: Task) -> Option<Task> {
        let Some(unit) = lock(&self.units).get(&(task.tile, task.blocks.start)).cloned() else {
            return Some(task);
        };
        let blocks = unit.blocks.end..task.blocks.end;
        (!blocks.is_empty()).then(|| Task {
            tile: task.tile,
            blocks,
            sums: Some(unit.sums.to_vec()),
        })
    }
}
