//! The proof that everything reachable in an arena lies within it.

use std::collections::VecDeque;

use bytemuck::Pod;

use super::{Kind, LeafHead, NODE_UNITS, Node, Patch, Ref, Soup, TreeContents, Unit, list_units};
use crate::counters::each;
use wavecrest_base::parallel;

/// Number of subtrees that are proved separately, so that all threads have work.
const PROVED_APART: usize = 1024;

/// Proves that everything below a set of places lies within an arena.
pub(super) struct Proof<'a> {
    pub(super) units: &'a [Unit],
    /// Number of primitive numbers in the arena.
    pub(super) numbers: usize,
}

impl Proof<'_> {
    /// Visits everything: first the top, then the subtrees below it on all threads.
    pub(super) fn census(&self, root: Ref) -> Option<TreeContents> {
        let mut census = TreeContents::default();
        let mut top = VecDeque::from([(root, 1)]);
        let mut reached = 0;
        while top.len() < PROVED_APART {
            let Some((place, depth)) = top.pop_front() else { return Some(census) };
            reached += 1;
            self.visit(place, depth, &mut census, |child| top.push_back(child))?;
        }
        for below in parallel::map(top.into_iter(), |start| self.below(start)) {
            let (below, more) = below?;
            (census, reached) = (census + below, reached + more);
        }
        // A tree reaches each unit once at most.
        (reached <= self.units.len()).then_some(census)
    }

    /// Visits everything below a place at some depth. Returns how many places were reached.
    pub(super) fn below(&self, start: (Ref, u64)) -> Option<(TreeContents, usize)> {
        let (mut census, mut reached) = (TreeContents::default(), 0);
        let mut waiting = vec![start];
        while let Some((place, depth)) = waiting.pop() {
            reached += 1;
            (reached <= self.units.len()).then_some(())?;
            self.visit(place, depth, &mut census, |child| waiting.push(child))?;
        }
        Some((census, reached))
    }

    /// Proves the content at `place`, counts it, and hands its children on to be proved. Children
    /// come after their parent, so there are no cycles.
    fn visit(
        &self,
        place: Ref,
        depth: u64,
        census: &mut TreeContents,
        mut hand_on: impl FnMut((Ref, u64)),
    ) -> Option<()> {
        let rest = self.units.get(place.unit()..)?;
        let within = |&LeafHead { first, count, .. }: &LeafHead| {
            let end = u64::from(first) + u64::from(count);
            (count <= 8 && end <= self.numbers as u64).then_some(u64::from(count))
        };
        match place.kind() {
            Kind::Node => {
                let node: &Node = content(rest)?;
                census.nodes += 1;
                census.children += u64::from(node.count);
                census.depth = census.depth.max(depth);
                let (used, unused) = node.children.split_at_checked(node.count as usize)?;
                for &relative in used {
                    // No node points to itself or back.
                    if (relative >> 2) < NODE_UNITS as u32 {
                        return None;
                    }
                    hand_on((Ref(relative.checked_add(place.0)?), depth + 1));
                }
                // No ray meets the other lanes, but even if one did it would stay within the arena.
                unused.iter().all(|&child| child == 0).then_some(())?;
            }
            Kind::Patch => {
                census.triangles += within(&content::<Patch>(rest)?.head)?;
                census.patches += 1;
            }
            Kind::Soup => {
                census.triangles += within(&content::<Soup>(rest)?.head)?;
                census.soups += 1;
            }
            Kind::List => {
                let count = rest.first()?.0[0] as usize;
                rest.get(..list_units(count))?;
                // Without a number, it stands for something else.
                census.lists += u64::from(count > 0);
            }
        }
        Some(())
    }
}

impl std::ops::Add for TreeContents {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let depth = self.depth.max(other.depth);
        Self { depth, ..each(self, other, |a, b| a + b) }
    }
}

/// The content of the first units of `rest`.
fn content<T: Pod>(rest: &[Unit]) -> Option<&T> {
    let units = rest.get(..size_of::<T>() / size_of::<Unit>())?;
    Some(bytemuck::from_bytes(bytemuck::cast_slice(units)))
}
