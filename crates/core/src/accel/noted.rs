//! Where shadow rays pass primitives: any-hit searches note the leaves, a list for each ray,
//! so that what the rays cross there is found without another search.

use super::{Ref, Searched};

/// Most leaves in all lists, so that memory is bounded: 2 MiB.
const MOST_LEAVES: usize = 1 << 18;

/// In place of a leaf.
const NONE: u32 = u32::MAX;

/// The leaves with primitives that rays pass.
#[derive(Clone, Debug, Default)]
pub(super) struct NotedLeaves {
    /// Whether a search is to note them.
    pub(super) is_noting: bool,
    /// Each with the place of the one that its ray noted before.
    leaves: Vec<(Ref, u32)>,
    /// The place of each ray's last one. Empty if they are not known.
    last: Vec<u32>,
}

impl NotedLeaves {
    /// Forgets all leaves, and if it `is_noting`, starts the lists of this many rays.
    pub(super) fn begin(&mut self, is_noting: bool, rays: usize) {
        self.leaves.clear();
        self.last.clear();
        self.last.resize(if is_noting { rays } else { 0 }, NONE);
        self.is_noting = is_noting;
    }

    /// Notes a leaf of the ray with that number.
    #[inline(always)]
    pub(super) fn note(&mut self, ray: usize, leaf: Ref) {
        let Some(last) = self.last.get_mut(ray) else { return };
        if self.leaves.len() == MOST_LEAVES {
            self.begin(false, 0);
            return;
        }
        self.leaves.push((leaf, *last));
        *last = self.leaves.len() as u32 - 1;
    }

    /// The leaves of the ray with that number; `None` if these are not known.
    #[inline(always)]
    pub(super) fn of(&self, ray: usize) -> Option<impl Iterator<Item = Ref>> {
        let mut next = *self.last.get(ray)?;
        Some(std::iter::from_fn(move || {
            let &(leaf, before) = self.leaves.get(next as usize)?;
            next = before;
            Some(leaf)
        }))
    }

    /// Notes a leaf of triangles if shadow rays pass any of those that the ray may meet, a bit each.
    #[inline(always)]
    pub(super) fn note_met(&mut self, searched: Searched<'_>, ray: usize, (leaf, met): (Ref, u32)) {
        if self.is_noting && searched.transparent(leaf, met) != 0 {
            self.note(ray, leaf);
        }
    }

    /// Notes a list if shadow rays pass any of its primitives.
    #[inline(always)]
    pub(super) fn note_list(
        &mut self,
        Searched { tree, geometry, .. }: Searched<'_>,
        ray: usize,
        list: Ref,
    ) {
        let numbers = tree.arena.view().list(list);
        if self.is_noting && numbers.iter().any(|&number| geometry.is_transparent(number)) {
            self.note(ray, list);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Memory for what rays pass is bounded: they are asked one by one if it does not suffice.
    #[test]
    fn leaves_are_noted_up_to_a_number() {
        let mut noted = NotedLeaves::default();
        let count = |noted: &NotedLeaves, ray| noted.of(ray).map(Iterator::count);
        noted.begin(true, 2);
        (0..100_000).for_each(|_| noted.note(1, Ref::default()));
        assert_eq!([0, 1].map(|ray| count(&noted, ray)), [Some(0), Some(100_000)]);
        (0..200_000).for_each(|_| noted.note(1, Ref::default()));
        assert_eq!([0, 1].map(|ray| count(&noted, ray)), [None; 2]);
    }
}
