//! Finished units in memory, saved while others are rendered.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::part::{self, Header, Unit};
use wavecrest_base::error::Result;
use wavecrest_core::render::work::{Summed, Task};

/// The start of a unit: its tile, and its first block.
type Key = (u32, u32);

/// Units, at most one for each start.
#[derive(Debug, Default)]
pub(super) struct Store {
    units: Mutex<BTreeMap<Key, Arc<Unit>>>,
}

impl Store {
    /// Stores a unit; it replaces a shorter one with the same start.
    pub(super) fn put(&self, unit: Unit) {
        self.units().insert((unit.tile, unit.blocks.start), Arc::new(unit));
    }

    /// As [`Store::put`], from the render loop.
    pub(super) fn keep(&self, summed: &Summed<'_>) {
        self.put(Unit {
            tile: summed.tile,
            blocks: summed.blocks.clone(),
            invalid: summed.invalid,
            sums: summed.sums.to_vec(),
        });
    }

    /// Writes the current units as a part with this header.
    pub(super) fn write(&self, path: &Path, header: &Header) -> Result<()> {
        let units = self.all();
        let header = Header { units: units.len() as u64, ..header.clone() };
        part::write(path, &header, units.iter().map(|unit| &**unit))
    }

    /// The current units, in order. They are shared, not copied.
    pub(super) fn all(&self) -> Vec<Arc<Unit>> {
        self.units().values().cloned().collect()
    }

    /// The rest of a task: all of it, nothing, or the blocks after those stored.
    pub(super) fn rest(&self, task: Task) -> Option<Task> {
        let Some(unit) = self.units().get(&(task.tile, task.blocks.start)).cloned() else {
            return Some(task);
        };
        let blocks = unit.blocks.end..task.blocks.end;
        (!blocks.is_empty()).then(|| Task {
            tile: task.tile,
            blocks,
            sums: Some(unit.sums.clone()),
        })
    }

    fn units(&self) -> MutexGuard<'_, BTreeMap<Key, Arc<Unit>>> {
        self.units.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
