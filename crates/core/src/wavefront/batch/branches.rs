//! Rays that wait, if surfaces let light through.

use crate::prepared::Branch;

/// In place of a row.
const NONE: u32 = u32::MAX;

/// Rays that wait until the rays before them on their path are done. Those that are not faint are a stack for each path;
/// those that are faint wait below, in their order, as if the others were all: random numbers go by the number of a ray.
#[derive(Clone, Debug, Default)]
pub struct BranchStacks {
    /// The rays of all paths, and rows that are free, each with the row that comes after it.
    rows: Vec<(Branch, u32)>,
    free: u32,
    /// For each path its next ray that is not faint, and its first and last faint one.
    heads: Vec<[u32; 3]>,
    paths: usize,
}

impl BranchStacks {
    /// Bytes of a path for which no ray waits.
    pub const ROW_BYTES: usize = size_of::<[u32; 3]>();

    /// None yet, of up to `paths` paths.
    pub fn with_capacity(paths: usize) -> Self {
        Self { paths, free: NONE, ..Self::default() }
    }

    /// Whether no ray waits.
    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    /// Adds a ray to those of its path.
    pub fn push(&mut self, path: u32, branch: Branch) {
        if self.heads.is_empty() {
            self.heads.resize(self.paths, [NONE; 3]);
        }
        let [next, first, last] = &mut self.heads[path as usize];
        let is_faint = branch.state.faint;
        let new = (branch, if is_faint { NONE } else { *next });
        let row = match self.rows.get_mut(self.free as usize) {
            Some(free) => {
                let row = std::mem::replace(&mut self.free, free.1);
                *free = new;
                row
            }
            None => {
                self.rows.push(new);
                self.rows.len() as u32 - 1
            }
        };
        if !is_faint {
            *next = row;
            return;
        }
        match self.rows.get_mut(*last as usize) {
            Some(last) => last.1 = row,
            None => *first = row,
        }
        *last = row;
    }

    /// Removes the next ray of the path.
    pub fn pop(&mut self, path: u32) -> Option<Branch> {
        let [next, first, last] = &mut self.heads[path as usize];
        let head = if *next == NONE { first } else { next };
        let row = *head;
        let (branch, after) = self.rows.get_mut(row as usize)?;
        *head = std::mem::replace(after, self.free);
        self.free = row;
        let branch = *branch;
        if *last == row {
            *last = NONE;
        }
        Some(branch)
    }

    /// Forgets all rays.
    pub fn clear(&mut self) {
        *self = Self::with_capacity(self.paths);
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.rows.capacity() * size_of::<(Branch, u32)>() + size_of_val(self.heads.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::kernels::Footprint;
    use crate::math::Ray;
    use crate::prepared::PathState;

    fn branch(bounces: u32, faint: bool) -> Branch {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let state = PathState { bounces, faint, ..PathState::default() };
        Branch { ray, throughput: Vec3::ONE, state, footprint: Footprint::Camera(1.0) }
    }

    /// As on the stack of the recursive tracer, in memory that is used again.
    #[test]
    fn the_last_rays_of_a_path_come_first_and_faint_ones_below_all_others() {
        const PATHS: u32 = 13;
        let mut waiting = BranchStacks::with_capacity(PATHS as usize);
        let mut stacks = vec![Vec::new(); PATHS as usize];
        let mut bytes = Vec::new();
        for round in 0..6 {
            for number in 0..40 * PATHS {
                let (path, faint) = (number * 5 % PATHS, number % 3 == 1);
                let stack = &mut stacks[path as usize];
                stack.push(branch(number, faint));
                Branch::sink(stack, stack.len() - 1);
                waiting.push(path, branch(number, faint));
                let other = number * 7 % PATHS;
                if round % 2 == 1 || number % 4 == 0 {
                    let of = |branch: Option<Branch>| branch.map(|branch| branch.state);
                    assert_eq!(of(waiting.pop(other)), of(stacks[other as usize].pop()));
                }
            }
            for (path, stack) in (0..).zip(&mut stacks) {
                while let Some(expected) = stack.pop() {
                    assert_eq!(waiting.pop(path).map(|of| of.state), Some(expected.state));
                }
                assert!(waiting.pop(path).is_none());
            }
            bytes.push(waiting.bytes());
        }
        assert!(bytes.iter().all(|&held| held == bytes[0]), "{bytes:?}");
    }
}
