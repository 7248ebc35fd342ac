//! Finished units in memory, to be written while others are made.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::part::{self, Header, Unit};
use wavecrest_base::error::Result;
use wavecrest_core::render::work::{Summed, Task};

/// Where a unit begins: its tile, and its first block.
type Key = (u32, u32);

/// Units, at most one of a beginning.
#[derive(Debug, Default)]
pub(super) struct Store {
    units: Mutex<BTreeMap<Key, Arc<Unit>>>,
}

impl Store {
    /// Keeps a unit, in place of the shorter one that begins where it does.
    pub(super) fn put(&self, unit: Unit) {
        self.units().insert((unit.tile, unit.blocks.start), Arc::new(unit));
    }

    /// As [`Store::put`], from the loop.
    pub(super) fn keep(&self, summed: &Summed<'_>) {
        self.put(Unit {
            tile: summed.tile,
            blocks: summed.blocks.clone(),
            invalid: summed.invalid,
            sums: summed.sums.to_vec(),
        });
    }

    /// Writes what there is now as a part with this header.
    pub(super) fn write(&self, path: &Path, header: &Header) -> Result<()> {
        let units = self.all();
        let header = Header { units: units.len() as u64, ..header.clone() };
        part::write(path, &header, units.iter().map(|unit| &**unit))
    }

    /// What there is now, in order. The units are shared, not copied.
    pub(super) fn all(&self) -> Vec<Arc<Unit>> {
        self.units().values().cloned().collect()
    }

    /// What is left of a task: all, nothing, or what follows the blocks that there are.
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
