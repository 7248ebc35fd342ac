//! The structure that hits are found in.
//!
//! [`geometry::Geometry`] holds the primitives and defines what a hit is; [`build`] has obvhs make
//! a binary tree over them and turns it into the nodes of [`tree`]; [`single`] traverses it for
//! one ray. [`brute`] asks every primitive and is the reference. All of them give the same answers
//! to the last bit.

pub mod brute;
pub mod build;
mod coincident;
pub mod geometry;
pub mod single;
pub mod tree;

use crate::math::ray::Ray;
use build::Preset;
use geometry::{Geometry, PreparedRay};
use tree::Tree;

/// The number of no primitive.
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// The answer to a closest-hit query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Where on the ray. Infinite for a miss.
    pub t: f32,
    /// Which primitive: of equal t the one of the lowest number. [`NO_PRIMITIVE`] for a miss.
    pub primitive: u32,
}

impl Hit {
    /// No hit.
    pub const MISS: Self = Self { t: f32::INFINITY, primitive: NO_PRIMITIVE };

    /// Whether there is none.
    #[inline]
    pub fn is_miss(&self) -> bool {
        self.primitive == NO_PRIMITIVE
    }
}

/// Work counted while tracing, exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TestCounts {
    /// Inner nodes visited, each testing two boxes.
    pub nodes: u64,
    /// Triangles tested.
    pub triangles: u64,
    /// Quads tested.
    pub quads: u64,
    /// Spheres tested.
    pub spheres: u64,
}

impl TestCounts {
    fn zip(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            nodes: f(self.nodes, other.nodes),
            triangles: f(self.triangles, other.triangles),
            quads: f(self.quads, other.quads),
            spheres: f(self.spheres, other.spheres),
        }
    }
}

impl std::ops::Add for TestCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl std::ops::Sub for TestCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl std::ops::AddAssign for TestCounts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// What one thread needs to trace: a stack that fits the tree, and its counters.
#[derive(Clone, Debug, Default)]
pub struct Traversal {
    stack: Vec<single::Entry>,
    /// Tests made so far.
    pub tests: TestCounts,
}

/// The primitives and how they are searched.
#[derive(Clone, Debug)]
pub struct Accel {
    /// The primitives.
    pub geometry: Geometry,
    /// The tree, or `None` for the brute-force reference.
    pub tree: Option<Tree>,
}

impl Accel {
    /// Builds the structure that `preset` names over `geometry`.
    pub fn new(geometry: Geometry, preset: Preset) -> Self {
        let tree = (preset != Preset::Brute).then(|| build::build(&geometry, preset));
        Self { geometry, tree }
    }

    /// Scratch memory for one thread: traversal then allocates nothing.
    pub fn traversal(&self) -> Traversal {
        let depth = self.tree.as_ref().map_or(0, Tree::depth);
        Traversal { stack: Vec::with_capacity(depth + 1), tests: TestCounts::default() }
    }

    /// The closest hit on `ray`, of light shapes too.
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        if !ray.is_valid() {
            return Hit::MISS;
        }
        let ray = PreparedRay::new(ray);
        match &self.tree {
            Some(tree) => single::closest(tree, &self.geometry, &ray, traversal),
            None => brute::closest(&self.geometry, &ray, &mut traversal.tests),
        }
    }

    /// Whether anything is on `ray`, light shapes apart: light passes them.
    #[inline]
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        if !ray.is_valid() {
            return false;
        }
        let ray = PreparedRay::new(ray);
        match &self.tree {
            Some(tree) => single::occluded(tree, &self.geometry, &ray, traversal),
            None => brute::occluded(&self.geometry, &ray, &mut traversal.tests),
        }
    }

    /// Bytes held by the tree.
    pub fn tree_bytes(&self) -> u64 {
        self.tree.as_ref().map_or(0, Tree::bytes)
    }
}
