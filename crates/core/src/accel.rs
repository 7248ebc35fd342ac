//! The structure that hits are found in.
//!
//! [`geometry::Geometry`] holds the primitives and defines what a hit is; [`build`] has obvhs make
//! binary trees over them and turns these into the nodes and leaves of an [`arena`]. [`single`]
//! traverses it for one ray, [`stream`] for many in flight, [`packet`] for tiles of rays that go
//! nearly the same way. [`brute`] asks every primitive and is the reference. All of them give the
//! same answers to the last bit, with any instructions: [`crate::kernels::slab`] says why.
//!
//! A mesh that is shown in several places is held once, as a prototype with a tree of its own; each showing is
//! an [`instance`], which rays visit after the scene's own primitives.

pub mod arena;
mod brute;
pub mod build;
mod choice;
mod coincident;
mod compiled;
mod counts;
pub mod cutouts;
pub mod geometry;
pub mod instance;
mod instances;
mod leaf;
mod near;
mod node;
mod packet;
mod query;
mod rays;
mod seals;
mod search;
mod single;
mod stream;
mod ties;
mod tlas;
pub mod tree;
mod units;
mod wide;

use std::marker::PhantomData;

use rayon::prelude::*;

use crate::kernels::precision::{Arithmetic, Precision};
use crate::math::ray::Ray;
use crate::with_precision;
use build::{Preset, Survey};
use geometry::Geometry;
use instances::Walks;
use packet::Packets;
use seals::Seals;
use stream::Flight;
use tlas::Tlas;
use tree::Tree;

pub use choice::{KernelChoice, KernelCounts, Kernels};
pub use counts::TestCounts;
use rays::BLOCK_EDGE;
pub use rays::{RayColumns, Rays};
pub use search::Search;

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

/// What one thread needs to trace: stacks that fit the tree, and its counters.
#[derive(Clone, Debug, Default)]
pub struct Traversal {
    stack: Vec<u64>,
    flight: Flight,
    packets: Packets,
    walks: Walks,
    /// Tests made so far.
    pub tests: TestCounts,
    /// Rays taken so far, by kernel.
    pub kernels: Kernels,
}

/// Where a kernel counts its work.
struct Counts<'a> {
    tests: &'a mut TestCounts,
    kernel: &'a mut KernelCounts,
}

/// The primitives and how they are searched.
#[derive(Debug)]
pub struct Accel {
    geometry: Geometry,
    /// `None` for the brute-force reference.
    tree: Option<Tree>,
    /// A bottom-level tree for each prototype; none for the reference.
    blas: Vec<Tree>,
    /// The top-level tree, over the instances.
    tlas: Tlas,
    /// The instructions to search with. No answer depends on them.
    pub level: fearless_simd::Level,
    /// The kernel that takes batches of rays. No answer depends on it.
    pub kernel: KernelChoice,
}

impl Accel {
    /// Builds the structure that `preset` names over `geometry`, to be searched with the best
    /// instructions that the processor has.
    pub fn new(geometry: Geometry, preset: Preset) -> Self {
        let mut accel = Self::unbuilt(geometry);
        accel.rebuild(preset);
        accel
    }

    /// The primitives alone, not yet to be searched.
    pub fn unbuilt(geometry: Geometry) -> Self {
        let (level, kernel) = (fearless_simd::Level::new(), KernelChoice::default());
        Self { geometry, tree: None, blas: Vec::new(), tlas: Tlas::default(), level, kernel }
    }

    /// Builds another structure over the same primitives.
    pub fn rebuild(&mut self, preset: Preset) {
        let geometry = &mut self.geometry;
        geometry.seals = Seals::default();
        geometry.prototypes.iter_mut().for_each(|prototype| prototype.seals = Seals::default());
        (self.tree, self.blas, self.tlas) = (None, Vec::new(), Tlas::default());
        if preset == Preset::Brute {
            find_all_seals(geometry);
            return;
        }
        self.tree = Some(tight(geometry, preset));
        self.blas = build_blas(&mut geometry.prototypes, preset);
        self.tlas = Tlas::new(&geometry.instances, |prototype| self.blas[prototype].upper_boxes());
    }

    /// The primitives.
    #[inline(always)]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The tree over the scene's own primitives, or `None` for the brute-force reference.
    pub fn tree(&self) -> Option<&Tree> {
        self.tree.as_ref()
    }

    /// How many triangles no ray can hit, since they have no area. Those of a prototype count once.
    pub fn left_out(&self) -> u64 {
        let prototypes = self.geometry.prototypes.iter().enumerate();
        let of_prototypes: u64 =
            prototypes.map(|(i, own)| own.left_out(self.blas.get(i).map(|tree| tree.kept))).sum();
        self.geometry.left_out(self.tree.as_ref().map(|tree| tree.kept)) + of_prototypes
    }

    /// Scratch memory for one thread: traversal then allocates nothing.
    pub fn traversal(&self) -> Traversal {
        let Some(entries) = self.trees().map(Tree::stack_entries).max() else {
            return Traversal::default();
        };
        Traversal { stack: vec![0; entries], flight: Flight::new(entries), ..Traversal::default() }
    }

    /// The searches of precision `P`, for those who know it: the geometry's.
    #[inline(always)]
    pub fn search<P: Arithmetic>(&self) -> Search<'_, P> {
        Search { accel: self, precision: PhantomData }
    }

    /// The closest hit on `ray`, of light shapes too.
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        with_precision!(self.geometry.precision, P => self.search::<P>().closest(ray, traversal))
    }

    /// Whether anything is on `ray`, light shapes apart: light passes them.
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        with_precision!(self.geometry.precision, P => self.search::<P>().occluded(ray, traversal))
    }

    /// The closest hits on many rays, of light shapes too.
    pub fn closest_of<'a>(
        &self,
        rays: impl Into<Rays<'a>>,
        answers: &mut [Hit],
        traversal: &mut Traversal,
    ) {
        let rays = rays.into();
        with_precision!(self.geometry.precision, P =>
            self.search::<P>().closest_of(rays, answers, traversal));
    }

    /// For many rays, whether anything is on each, light shapes apart.
    pub fn occluded_of<'a>(
        &self,
        rays: impl Into<Rays<'a>>,
        answers: &mut [bool],
        traversal: &mut Traversal,
    ) {
        let rays = rays.into();
        with_precision!(self.geometry.precision, P =>
            self.search::<P>().occluded_of(rays, answers, traversal));
    }

    /// The tree over the scene's own primitives, if there is one, and those of prototypes.
    pub fn trees(&self) -> impl Iterator<Item = &Tree> {
        self.tree.iter().chain(&self.blas)
    }

    /// Bytes held by all trees.
    pub fn tree_bytes(&self) -> u64 {
        self.trees().map(Tree::bytes).sum::<u64>() + self.tlas.bytes()
    }
}

/// The tree over the primitives that `geometry` holds itself, tight where precision asks for it.
fn tight(geometry: &mut Geometry, preset: Preset) -> Tree {
    let survey = Survey::of(geometry);
    find_seals(geometry, survey.degenerate());
    build::build(geometry, survey, preset)
}

/// A tree for each prototype: large ones one after the other, each on all threads, small ones side by side.
fn build_blas(prototypes: &mut [Geometry], preset: Preset) -> Vec<Tree> {
    let is_large = |prototype: &Geometry| prototype.own() > preset.chunk();
    let mut trees: Vec<Option<Tree>> = prototypes
        .par_iter_mut()
        .map(|prototype| (!is_large(prototype)).then(|| tight(prototype, preset)))
        .collect();
    for (prototype, tree) in prototypes.iter_mut().zip(&mut trees) {
        tree.get_or_insert_with(|| tight(prototype, preset));
    }
    trees.into_iter().map(Option::unwrap_or_default).collect()
}

/// The seals of the scene's own triangles and of those of prototypes.
fn find_all_seals(geometry: &mut Geometry) {
    find_seals(geometry, Survey::of(geometry).degenerate());
    for prototype in &mut geometry.prototypes {
        find_seals(prototype, Survey::of(prototype).degenerate());
    }
}

/// The seals among the `degenerate` triangles. Fast arithmetic leaks anyway, and has none.
fn find_seals(geometry: &mut Geometry, degenerate: &[u32]) {
    if geometry.precision != Precision::Fast {
        geometry.seals = seals::find(geometry, degenerate);
    }
}

#[cfg(test)]
mod tests;
