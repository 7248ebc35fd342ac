//! What rays from surfaces carry, if the scene needs it.

use super::room;
use crate::kernels::Differential;
use crate::prepared::PathState;

/// Rows for the rays of a bounce, each with a state, a differential, both or nothing: as the scene needs. Camera rays
/// have none: their differentials follow from their directions, and all have one state.
#[derive(Debug, Default)]
pub struct CarriedRows {
    capacity: usize,
    /// What rays went through, if surfaces let light through.
    states: Vec<PathState>,
    /// The least t of rays with a state: those that go straight on begin behind a hit. As many as have room.
    starts: Vec<f32>,
    /// Differentials, if textures need them.
    differentials: Vec<Differential>,
}

impl CarriedRows {
    /// Bytes of a state and a least t.
    pub const STATE_BYTES: usize = size_of::<PathState>() + size_of::<f32>();

    /// For up to `capacity` rays; rows are allocated at the first one.
    pub fn with_capacity(capacity: usize) -> Self {
        Self { capacity, ..Self::default() }
    }

    /// Removes every row and keeps the memory.
    pub fn clear(&mut self) {
        self.states.clear();
        self.differentials.clear();
    }

    /// Appends the state of a ray, and its least t.
    pub fn push_state(&mut self, state: PathState, t_min: f32) {
        append(&mut self.states, self.capacity, state);
        if self.starts.is_empty() {
            self.starts.resize(room(self.capacity), 0.0);
        }
        self.starts[self.states.len() - 1] = t_min;
    }

    /// Appends the differential of a ray.
    pub fn push_differential(&mut self, differential: Differential) {
        append(&mut self.differentials, self.capacity, differential);
    }

    /// The states of all rays, or none.
    pub fn states(&self) -> &[PathState] {
        &self.states
    }

    /// The least t of all rays; `None` if that is 0.
    pub fn starts(&self) -> Option<&[f32]> {
        (!self.states.is_empty()).then_some(&self.starts)
    }

    /// The differential of the `i`th ray.
    #[inline(always)]
    pub fn differential(&self, i: usize) -> Differential {
        self.differentials[i]
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.states.capacity() * Self::STATE_BYTES
            + self.differentials.capacity() * size_of::<Differential>()
    }
}

/// Appends a row to a list that has room for all rays from its first row on.
fn append<T>(rows: &mut Vec<T>, capacity: usize, row: T) {
    if rows.is_empty() {
        rows.reserve_exact(room(capacity));
    }
    rows.push(row);
}
