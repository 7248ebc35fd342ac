//! Rays that wait, if surfaces let light through.

use crate::prepared::Branch;

/// Rays that wait until the rays before them on their path are done: a stack for each path.
#[derive(Clone, Debug, Default)]
pub struct BranchStacks {
    stacks: Vec<Vec<Branch>>,
    paths: usize,
}

impl BranchStacks {
    /// Bytes of a path for which no ray waits.
    pub const ROW_BYTES: usize = size_of::<Vec<Branch>>();

    /// None yet, of up to `paths` paths.
    pub fn with_capacity(paths: usize) -> Self {
        Self { paths, ..Self::default() }
    }

    /// Whether no ray ever waited.
    pub fn is_empty(&self) -> bool {
        self.stacks.is_empty()
    }

    /// Adds a ray to the stack of its path.
    pub fn push(&mut self, path: u32, branch: Branch) {
        if self.stacks.is_empty() {
            self.stacks.resize(self.paths, Vec::new());
        }
        let stack = &mut self.stacks[path as usize];
        // No more than the path needs; later paths in its place take the same memory.
        stack.reserve_exact(1);
        stack.push(branch);
        Branch::sink(stack, stack.len() - 1);
    }

    /// Removes the last ray of the path.
    pub fn pop(&mut self, path: u32) -> Option<Branch> {
        self.stacks[path as usize].pop()
    }

    /// Forgets all rays.
    pub fn clear(&mut self) {
        self.stacks.clear();
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let stack =
            |stack: &Vec<Branch>| size_of_val(stack) + stack.capacity() * size_of::<Branch>();
        self.stacks.iter().map(stack).sum()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::math::Ray;
    use crate::prepared::PathState;

    fn branch(bounces: u32) -> Branch {
        let (ray, state) =
            (Ray::new(Vec3::ZERO, Vec3::Z), PathState { bounces, ..PathState::default() });
        Branch { ray, throughput: Vec3::ONE, state, differential: None }
    }

    #[test]
    fn rays_wait_on_a_stack_whose_memory_is_used_again() {
        const PATHS: u32 = 13;
        for bounces in [1, 3, 8] {
            let mut waiting = BranchStacks::with_capacity(PATHS as usize);
            for _ in 0..2 {
                for number in 0..=2 * bounces {
                    (0..PATHS).for_each(|path| waiting.push(path, branch(number)));
                }
                for path in 0..PATHS {
                    let left = std::iter::from_fn(|| waiting.pop(path));
                    let left: Vec<u32> = left.map(|branch| branch.state.bounces).collect();
                    assert_eq!(left, (0..=2 * bounces).rev().collect::<Vec<_>>());
                }
                let rays = (2 * bounces as usize + 1) * size_of::<Branch>();
                assert_eq!(waiting.bytes(), PATHS as usize * (BranchStacks::ROW_BYTES + rays));
            }
        }
    }
}
