//! What rays went through, and rays that wait, if surfaces let light through.

use super::columns::{Column, Vectors};
use crate::kernels::transmission::Transparency;
use crate::prepared::{Branch, Trail};

columns! {
    /// The trails of rays after the first, a row for each of [`Rays`](super::Rays). Written and read
    /// by shade.
    Trails {
        /// How often the ray was mirrored or refracted.
        bounces: Vec<u32>,
        /// Whether it was mirrored.
        mirrored: Vec<bool>,
        /// Light absorbed on its way, by channel, per scene unit.
        absorption: Vectors,
    }
}

impl Trails {
    /// The `i`th trail.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Trail {
        let absorption = self.absorption.get(i);
        Trail { bounces: self.bounces[i], mirrored: self.mirrored[i], absorption }
    }

    /// Appends a trail.
    #[inline(always)]
    pub fn push(&mut self, trail: Trail) {
        let i = self.rows;
        (self.bounces[i], self.mirrored[i]) = (trail.bounces, trail.mirrored);
        self.absorption.set(i, trail.absorption);
        self.rows += 1;
    }
}

/// Rays that wait until the rays before them on their path are done: a stack for each path.
#[derive(Clone, Debug, Default)]
pub struct Waiting {
    /// For each path, one more than the index of its last entry, or 0.
    last: Vec<u32>,
    /// Whether a path has a next ray.
    marked: Vec<bool>,
    entries: Vec<Entry>,
    /// One more than the index of an unused entry, or 0.
    unused: u32,
    /// Number of rays that wait.
    rays: usize,
    paths: usize,
}

/// A ray that waits.
#[derive(Clone, Copy, Debug)]
struct Entry {
    branch: Branch,
    /// The entry below it on the stack, or the next unused one, as in [`Waiting::last`].
    below: u32,
}

/// Largest number of rays of a path that wait if no surface sends on more light than it receives:
/// in each of three channels their throughputs add up to 1 at most, and each ray has at least the
/// least weight in one.
const MOST_RAYS: usize = (3.0 / Transparency::LEAST_WEIGHT) as usize;

impl Waiting {
    /// Bytes that a path with up to this number of bounces takes at most: it waits with up to two
    /// rays for each.
    pub fn row_bytes(bounces: u32) -> usize {
        let rays = MOST_RAYS.min(2 * bounces as usize);
        size_of::<u32>() + size_of::<bool>() + rays * size_of::<Entry>()
    }

    /// None yet, of up to `paths` paths.
    pub fn with_capacity(paths: usize) -> Self {
        Self { paths, ..Self::default() }
    }

    /// Whether no ray waits.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.rays == 0
    }

    /// Adds a ray to the stack of its path.
    pub fn push(&mut self, path: u32, branch: Branch) {
        if self.last.is_empty() {
            self.last = vec![0; self.paths];
            self.marked = vec![false; self.paths];
        }
        let last = &mut self.last[path as usize];
        let entry = Entry { branch, below: *last };
        self.rays += 1;
        if let Some(free) = self.unused.checked_sub(1) {
            *last = self.unused;
            self.unused = std::mem::replace(&mut self.entries[free as usize], entry).below;
        } else {
            if self.entries.len() == self.entries.capacity() {
                // No more than all paths need.
                self.entries.reserve_exact(self.paths);
            }
            self.entries.push(entry);
            *last = self.entries.len() as u32;
        }
    }

    /// Marks these paths, and no others.
    pub fn mark(&mut self, paths: &[u32]) {
        self.marked.fill(false);
        for &path in paths {
            self.marked[path as usize] = true;
        }
    }

    /// Removes the last ray of the path if it is not marked.
    pub fn pop_unmarked(&mut self, path: u32) -> Option<Branch> {
        let last = &mut self.last[path as usize];
        let index = last.checked_sub(1).filter(|_| !self.marked[path as usize])?;
        let entry = &mut self.entries[index as usize];
        (*last, entry.below, self.unused) = (entry.below, self.unused, *last);
        self.rays -= 1;
        Some(entry.branch)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.last.as_slice())
            + size_of_val(self.marked.as_slice())
            + self.entries.capacity() * size_of::<Entry>()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::math::ray::Ray;

    fn branch(bounces: u32) -> Branch {
        let (ray, trail) = (Ray::new(Vec3::ZERO, Vec3::Z), Trail { bounces, ..Trail::default() });
        Branch { ray, throughput: Vec3::ONE, trail, differential: None }
    }

    #[test]
    fn rays_wait_on_a_stack_in_the_memory_that_was_estimated() {
        const PATHS: u32 = 13;
        for bounces in [1, 3, 8] {
            let mut waiting = Waiting::with_capacity(PATHS as usize);
            for _ in 0..2 {
                for number in 0..2 * bounces {
                    (0..PATHS).for_each(|path| waiting.push(path, branch(number)));
                }
                waiting.mark(&[0]);
                for path in 1..PATHS {
                    let left = std::iter::from_fn(|| waiting.pop_unmarked(path));
                    let left: Vec<u32> = left.map(|branch| branch.trail.bounces).collect();
                    assert_eq!(left, (0..2 * bounces).rev().collect::<Vec<_>>());
                }
                assert!(waiting.pop_unmarked(0).is_none() && !waiting.is_empty());
                waiting.mark(&[]);
                while waiting.pop_unmarked(0).is_some() {}
                assert!(waiting.is_empty());
                // What was left is used again.
                assert_eq!(waiting.bytes(), PATHS as usize * Waiting::row_bytes(bounces));
            }
        }
    }
}
