//! The structure that hits are found in.
//!
//! [`geometry::Geometry`] holds the primitives and defines what a hit is; [`build`] has obvhs make
//! binary trees over them and turns these into the nodes and leaves of an [`arena`]. [`single`]
//! traverses it for one ray, [`stream`] for many in flight, [`packet`] for tiles of rays that go
//! nearly the same way. [`brute`] asks every primitive and is the reference. All of them give the
//! same answers to the last bit, with any instructions: [`crate::kernels::slab`] says why.

pub mod arena;
pub mod brute;
pub mod build;
mod choice;
mod coincident;
pub mod geometry;
mod leaf;
mod node;
mod packet;
mod query;
mod rays;
mod seals;
mod single;
mod stream;
pub mod tree;
mod units;
mod wide;

use std::marker::PhantomData;

use rayon::prelude::*;

use crate::kernels::precision::{Arithmetic, Exact, Fast, Precision, Robust};
use crate::math::ray::Ray;
use crate::math::simd::{Kernel, Lanes, dispatch};
use build::Preset;
use geometry::{Geometry, PreparedRay};
use packet::Packets;
use query::{Closest, Occluded, Query};
use stream::Flight;
use tree::Tree;

pub use choice::{KernelChoice, KernelCounts, Kernels};
use rays::BLOCK_EDGE;
pub use rays::{RayColumns, Rays};

/// The number of no primitive.
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// The answer to a closest-hit query.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
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
    /// Inner nodes visited, each testing the boxes of its children.
    pub nodes: u64,
    /// Leaves visited.
    pub leaves: u64,
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
            leaves: f(self.leaves, other.leaves),
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

/// What one thread needs to trace: stacks that fit the tree, and its counters.
#[derive(Clone, Debug, Default)]
pub struct Traversal {
    stack: Vec<u64>,
    flight: Flight,
    packets: Packets,
    /// Tests made so far.
    pub tests: TestCounts,
    /// Rays taken so far, by kernel.
    pub kernels: Kernels,
}

/// The primitives and how they are searched.
#[derive(Debug)]
pub struct Accel {
    /// The primitives.
    pub geometry: Geometry,
    /// The tree, or `None` for the brute-force reference.
    pub tree: Option<Tree>,
    /// The instructions to search it with.
    pub level: fearless_simd::Level,
    /// The kernel that many rays are searched with.
    pub kernel: KernelChoice,
}

impl Accel {
    /// Builds the structure that `preset` names over `geometry`, to be searched with the best
    /// instructions that the processor has.
    pub fn new(mut geometry: Geometry, preset: Preset) -> Self {
        let build =
            |geometry: &Geometry| (preset != Preset::Brute).then(|| build::build(geometry, preset));
        let mut tree = build(&geometry);
        // Fast arithmetic leaks anyway.
        let is_whole = tree.as_ref().is_some_and(|tree| tree.kept == geometry.len() as u64);
        if !is_whole && geometry.precision != Precision::Fast {
            geometry.seals = seals::find(&geometry);
            if !geometry.seals.is_empty() {
                // Scans with collapsed triangles are rare: they are built once more.
                drop(tree);
                tree = build(&geometry);
            }
        }
        Self { tree, ..Self::unbuilt(geometry) }
    }

    /// The primitives alone, not yet to be searched.
    pub fn unbuilt(geometry: Geometry) -> Self {
        let (level, kernel) = (fearless_simd::Level::new(), KernelChoice::default());
        Self { geometry, tree: None, level, kernel }
    }

    /// How many triangles no ray can hit, since they have no area.
    pub fn left_out(&self) -> u64 {
        match &self.tree {
            Some(tree) => self.geometry.len() as u64 - tree.kept + self.geometry.seals.len() as u64,
            None => {
                let numbers = (0..self.geometry.len() as u32).into_par_iter();
                numbers.filter(|&number| self.geometry.is_degenerate(number)).count() as u64
            }
        }
    }

    /// Scratch memory for one thread: traversal then allocates nothing.
    pub fn traversal(&self) -> Traversal {
        let Some(tree) = &self.tree else { return Traversal::default() };
        Traversal {
            stack: vec![0; tree.stack_entries()],
            flight: Flight::new(tree),
            ..Traversal::default()
        }
    }

    /// The closest hit on `ray`, of light shapes too.
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        traversal.kernels.closest.single += 1;
        if !ray.is_valid() {
            return Hit::MISS;
        }
        let hit = match self.geometry.precision {
            Precision::Fast => self.closest_in::<Fast>(ray, traversal),
            Precision::Robust => self.closest_in::<Robust>(ray, traversal),
            Precision::Exact => self.closest_in::<Exact>(ray, traversal),
        };
        self.geometry.unsealed(hit)
    }

    #[inline(always)]
    fn closest_in<P: Arithmetic>(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        let ray = PreparedRay::of::<P>(ray);
        match &self.tree {
            Some(tree) => {
                let one = One::<Closest, P>::new(tree, &self.geometry, &ray, traversal);
                dispatch(self.level, one)
            }
            None => brute::closest::<P>(&self.geometry, &ray, &mut traversal.tests),
        }
    }

    /// Whether anything is on `ray`, light shapes apart: light passes them.
    #[inline]
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        traversal.kernels.shadow.single += 1;
        if !ray.is_valid() {
            return false;
        }
        match self.geometry.precision {
            Precision::Fast => self.occluded_in::<Fast>(ray, traversal),
            Precision::Robust => self.occluded_in::<Robust>(ray, traversal),
            Precision::Exact => self.occluded_in::<Exact>(ray, traversal),
        }
    }

    #[inline(always)]
    fn occluded_in<P: Arithmetic>(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        let ray = PreparedRay::of::<P>(ray);
        match &self.tree {
            Some(tree) => {
                let one = One::<Occluded, P>::new(tree, &self.geometry, &ray, traversal);
                dispatch(self.level, one)
            }
            None => brute::occluded::<P>(&self.geometry, &ray, &mut traversal.tests),
        }
    }

    /// The closest hits on many rays, of light shapes too.
    pub fn closest_of<'a>(
        &self,
        rays: impl Into<Rays<'a>>,
        answers: &mut [Hit],
        traversal: &mut Traversal,
    ) {
        let rays = rays.into();
        match (&self.tree, self.many()) {
            (Some(tree), Some(Precision::Fast)) => {
                let many = Many::<Closest, Fast>::new(self, tree, rays, answers, traversal);
                dispatch(self.level, many);
            }
            (Some(tree), Some(_)) => {
                let many = Many::<Closest, Robust>::new(self, tree, rays, answers, traversal);
                dispatch(self.level, many);
                if !self.geometry.seals.is_empty() {
                    answers.iter_mut().for_each(|hit| *hit = self.geometry.unsealed(*hit));
                }
            }
            _ => {
                for (i, answer) in answers.iter_mut().enumerate() {
                    *answer = self.closest(&rays.ray(i), traversal);
                }
            }
        }
    }

    /// For many rays, whether anything is on each, light shapes apart.
    pub fn occluded_of<'a>(
        &self,
        rays: impl Into<Rays<'a>>,
        answers: &mut [bool],
        traversal: &mut Traversal,
    ) {
        let rays = rays.into();
        match (&self.tree, self.many()) {
            (Some(tree), Some(Precision::Fast)) => {
                let many = Many::<Occluded, Fast>::new(self, tree, rays, answers, traversal);
                dispatch(self.level, many);
            }
            (Some(tree), Some(_)) => {
                let many = Many::<Occluded, Robust>::new(self, tree, rays, answers, traversal);
                dispatch(self.level, many);
            }
            _ => {
                for (i, answer) in answers.iter_mut().enumerate() {
                    *answer = self.occluded(&rays.ray(i), traversal);
                }
            }
        }
    }

    /// The precision in which rays are searched many at a time; `None` if each is searched alone. What
    /// is exact has no use for lanes.
    fn many(&self) -> Option<Precision> {
        let is_one = self.kernel == KernelChoice::Single;
        let precision = self.geometry.precision;
        (!is_one && precision != Precision::Exact).then_some(precision)
    }

    /// Bytes held by the tree.
    pub fn tree_bytes(&self) -> u64 {
        self.tree.as_ref().map_or(0, Tree::bytes)
    }
}

/// One ray, traced alone.
struct One<'a, Q, P> {
    tree: &'a Tree,
    geometry: &'a Geometry,
    ray: &'a PreparedRay,
    traversal: &'a mut Traversal,
    query: PhantomData<(Q, P)>,
}

impl<'a, Q, P> One<'a, Q, P> {
    #[inline(always)]
    fn new(
        tree: &'a Tree,
        geometry: &'a Geometry,
        ray: &'a PreparedRay,
        traversal: &'a mut Traversal,
    ) -> Self {
        Self { tree, geometry, ray, traversal, query: PhantomData }
    }
}

impl<P: Arithmetic> Kernel for One<'_, Closest, P> {
    type Output = Hit;

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) -> Hit {
        let Traversal { stack, tests, .. } = self.traversal;
        let height = single::start::<P>(self.tree, self.ray, stack);
        let best = single::no_hit(self.ray);
        let stack = (stack.as_mut_slice(), height);
        let ray = self.ray;
        let best = single::closest::<S, P>(simd, self.tree, self.geometry, ray, best, stack, tests);
        single::or_miss(best)
    }
}

impl<P: Arithmetic> Kernel for One<'_, Occluded, P> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) -> bool {
        let Traversal { stack, tests, .. } = self.traversal;
        let height = single::start::<P>(self.tree, self.ray, stack);
        let stack = (stack.as_mut_slice(), height);
        single::occluded::<S, P>(simd, self.tree, self.geometry, self.ray, stack, tests)
    }
}

/// Many rays, in flight together.
struct Many<'a, Q: Query, P> {
    tree: &'a Tree,
    geometry: &'a Geometry,
    rays: Rays<'a>,
    answers: &'a mut [Q::Answer],
    traversal: &'a mut Traversal,
    choice: KernelChoice,
    precision: PhantomData<P>,
}

impl<'a, Q: Query, P> Many<'a, Q, P> {
    #[inline(always)]
    fn new(
        accel: &'a Accel,
        tree: &'a Tree,
        rays: Rays<'a>,
        answers: &'a mut [Q::Answer],
        traversal: &'a mut Traversal,
    ) -> Self {
        let (geometry, choice) = (&accel.geometry, accel.kernel);
        Self { tree, geometry, rays, answers, traversal, choice, precision: PhantomData }
    }
}

impl<Q: Query, P: Arithmetic> Kernel for Many<'_, Q, P> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) {
        let Traversal { flight, packets, stack, tests, kernels } = self.traversal;
        let Self { tree, geometry, rays, answers, choice, .. } = self;
        let memory = (packets, flight, stack.as_mut_slice());
        let counts = (tests, if Q::ANY { &mut kernels.shadow } else { &mut kernels.closest });
        let rays = (rays, choice);
        packet::trace::<S, Q, P>(simd, tree, geometry, rays, answers, memory, counts);
    }
}

#[cfg(test)]
mod tests;
