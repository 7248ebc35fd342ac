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
pub mod brute;
pub mod build;
mod choice;
mod coincident;
mod counts;
pub mod geometry;
pub mod instance;
mod instances;
mod leaf;
mod node;
mod packet;
mod query;
mod rays;
mod seals;
mod search;
mod single;
mod stream;
mod tlas;
pub mod tree;
mod units;
mod wide;

use rayon::prelude::*;

use crate::kernels::precision::{Arithmetic, Exact, Fast, Precision, Robust};
use crate::math::ray::Ray;
use build::Preset;
use geometry::{Geometry, PreparedRay};
use instances::Ways;
use packet::Packets;
use query::{Closest, Occluded};
use stream::Flight;
use tlas::Tlas;
use tree::Tree;

pub use choice::{KernelChoice, KernelCounts, Kernels};
pub use counts::TestCounts;
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

/// What one thread needs to trace: stacks that fit the tree, and its counters.
#[derive(Clone, Debug, Default)]
pub struct Traversal {
    stack: Vec<u64>,
    flight: Flight,
    packets: Packets,
    ways: Ways,
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
    /// A tree for each prototype; none for the reference.
    blas: Vec<Tree>,
    /// Over the instances.
    tlas: Tlas,
    /// The instructions to search it with.
    pub level: fearless_simd::Level,
    /// The kernel that many rays are searched with.
    pub kernel: KernelChoice,
}

impl Accel {
    /// Builds the structure that `preset` names over `geometry`, to be searched with the best
    /// instructions that the processor has.
    pub fn new(mut geometry: Geometry, preset: Preset) -> Self {
        if preset == Preset::Brute {
            find_all_seals(&mut geometry);
            return Self::unbuilt(geometry);
        }
        let tree = tight(&mut geometry, preset);
        let mut prototypes = std::mem::take(&mut geometry.prototypes);
        let blas = build_blas(&mut prototypes, preset);
        geometry.prototypes = prototypes;
        let boxes = |prototype: usize| {
            let tree: &Tree = &blas[prototype];
            tree.upper_boxes()
        };
        let tlas = Tlas::new(&geometry.instances, boxes);
        Self { tree: Some(tree), blas, tlas, ..Self::unbuilt(geometry) }
    }

    /// The primitives alone, not yet to be searched.
    pub fn unbuilt(geometry: Geometry) -> Self {
        let (level, kernel) = (fearless_simd::Level::new(), KernelChoice::default());
        Self { geometry, tree: None, blas: Vec::new(), tlas: Tlas::default(), level, kernel }
    }

    /// How many triangles no ray can hit, since they have no area. Those of a prototype count once.
    pub fn left_out(&self) -> u64 {
        let of_prototype = self.geometry.prototypes.iter().enumerate();
        let of_prototype: u64 = of_prototype
            .map(|(i, prototype)| prototype.left_out(self.blas.get(i).map(|t| t.kept)))
            .sum();
        self.geometry.left_out(self.tree.as_ref().map(|tree| tree.kept)) + of_prototype
    }

    /// Scratch memory for one thread: traversal then allocates nothing.
    pub fn traversal(&self) -> Traversal {
        let Some(entries) = self.trees().map(Tree::stack_entries).max() else {
            return Traversal::default();
        };
        Traversal { stack: vec![0; entries], flight: Flight::new(entries), ..Traversal::default() }
    }

    /// The closest hit on `ray`, of light shapes too.
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        traversal.kernels.closest.single += 1;
        if !ray.is_valid() {
            return Hit::MISS;
        }
        match self.geometry.precision {
            Precision::Fast => self.closest_in::<Fast>(ray, traversal),
            Precision::Robust => self.closest_in::<Robust>(ray, traversal),
            Precision::Exact => self.closest_in::<Exact>(ray, traversal),
        }
    }

    #[inline(always)]
    fn closest_in<P: Arithmetic>(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        let ray = PreparedRay::of::<P>(ray);
        match &self.tree {
            Some(tree) => {
                let searched = (tree, &self.geometry);
                let best = search::closest::<P>(self.level, searched, &ray, traversal);
                let best = self.geometry.unsealed(best);
                if self.geometry.instances.is_empty() {
                    return best;
                }
                self.among_instances::<Closest, P>(&ray.ray, best, traversal)
            }
            None => {
                let hit = brute::closest::<P>(&self.geometry, &ray, &mut traversal.tests);
                self.geometry.unsealed(hit)
            }
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
                let searched = (tree, &self.geometry);
                let occluded = search::occluded::<P>(self.level, searched, &ray, traversal);
                if occluded || self.geometry.instances.is_empty() {
                    return occluded;
                }
                !self.among_instances::<Occluded, P>(&ray.ray, Hit::MISS, traversal).is_miss()
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
                self.closest_of_in::<Fast>(tree, rays, answers, traversal);
            }
            (Some(tree), Some(_)) => {
                self.closest_of_in::<Robust>(tree, rays, answers, traversal);
            }
            _ => {
                for (i, answer) in answers.iter_mut().enumerate() {
                    *answer = self.closest(&rays.ray(i), traversal);
                }
            }
        }
    }

    fn closest_of_in<P: Arithmetic>(
        &self,
        tree: &Tree,
        rays: Rays<'_>,
        answers: &mut [Hit],
        traversal: &mut Traversal,
    ) {
        let how = (self.level, self.kernel);
        search::many::<Closest, P>(how, (tree, &self.geometry), rays, answers, traversal);
        if !self.geometry.seals.is_empty() {
            answers.iter_mut().for_each(|hit| *hit = self.geometry.unsealed(*hit));
        }
        if !self.geometry.instances.is_empty() {
            self.all_among_instances::<Closest, P>(rays, answers, traversal);
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
                self.occluded_of_in::<Fast>(tree, rays, answers, traversal);
            }
            (Some(tree), Some(_)) => {
                self.occluded_of_in::<Robust>(tree, rays, answers, traversal);
            }
            _ => {
                for (i, answer) in answers.iter_mut().enumerate() {
                    *answer = self.occluded(&rays.ray(i), traversal);
                }
            }
        }
    }

    fn occluded_of_in<P: Arithmetic>(
        &self,
        tree: &Tree,
        rays: Rays<'_>,
        answers: &mut [bool],
        traversal: &mut Traversal,
    ) {
        let how = (self.level, self.kernel);
        search::many::<Occluded, P>(how, (tree, &self.geometry), rays, answers, traversal);
        if !self.geometry.instances.is_empty() {
            self.all_among_instances::<Occluded, P>(rays, answers, traversal);
        }
    }

    /// The precision in which rays are searched many at a time; `None` if each is searched alone. What
    /// is exact has no use for lanes.
    fn many(&self) -> Option<Precision> {
        let is_one = self.kernel == KernelChoice::Single;
        let precision = self.geometry.precision;
        (!is_one && precision != Precision::Exact).then_some(precision)
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
    let tree = build::build(geometry, preset);
    // Fast arithmetic leaks anyway.
    if tree.kept == geometry.own() as u64 || geometry.precision == Precision::Fast {
        return tree;
    }
    geometry.seals = seals::find(geometry);
    if geometry.seals.is_empty() {
        return tree;
    }
    // Scans with collapsed triangles are rare: they are built once more.
    drop(tree);
    build::build(geometry, preset)
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
    if geometry.precision != Precision::Fast {
        geometry.seals = seals::find(geometry);
        for prototype in &mut geometry.prototypes {
            prototype.seals = seals::find(prototype);
        }
    }
}

#[cfg(test)]
mod tests;
