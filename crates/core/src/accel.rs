//! The acceleration structure: finds hits.
//!
//! [`Geometry`] holds the primitives and defines a hit; [`build`] converts obvhs's binary
//! trees to the nodes and leaves of an [`arena`]. [`single`] traverses it for one ray, [`stream`]
//! for many rays in flight, [`packet`] for tiles of coherent rays. Without a tree,
//! [`search`] tests every primitive, which is the reference. All of them return the same answers to the last bit, at any instruction
//! level: [`crate::kernels::slab`] says why.
//!
//! A mesh shown in several places is stored once, as a prototype with its own tree; each copy is an
//! [instance](crate::geometry::instance), whose box is in the scene's tree. A ray that reaches it goes on
//! in the prototype's tree, in the space of the prototype, and comes back.

pub mod arena;
mod best;
pub mod build;
mod choice;
mod crossings;
mod hit;
mod leaf;
mod node;
mod order;
mod packet;
mod query;
mod rays;
mod search;
mod single;
mod stream;
pub mod tree;
mod wide;

use std::marker::PhantomData;

use crate::counters::{Kernels, TestCounts};
use crate::geometry::Geometry;
use crate::kernels::{Aabb, Arithmetic, Precision};
use crate::math::Ray;
use crate::math::float::max;
use crate::math::multisets::Multisets;
use crate::math::simd::Level;
use crate::with_precision;
use build::{ChunkSizes, Preset};
use packet::Packets;
use stream::Flight;
use wavecrest_base::parallel;
// The types that every search uses, by their names alone.
use arena::{Arena, ArenaView, Kind, Node, Patch, Ref, Soup, TreeContents, Unit, Units, child_of};
use best::Best;
use node::{distance, place, widened};
use query::{Closest, Occluded, Query};
use tree::{Chunk, Demand, Root, Searched, Tree};

pub(crate) use arena::prefetch;
pub use choice::KernelChoice;
pub use crossings::Crossings;
pub use hit::{Hit, NO_PRIMITIVE};
pub use rays::{RayColumns, Rays, rays_at_once};
pub use search::Search;

/// Scratch memory of a thread: stacks that fit the tree, and counters.
#[derive(Clone, Debug, Default)]
pub struct Traversal {
    stack: Vec<u64>,
    flight: Flight,
    packets: Packets,
    /// For searches in prototypes.
    inside: Option<Box<Traversal>>,
    /// What a ray crosses near a hit.
    pub(crate) crossed: Crossings,
    /// What rays were inside of.
    pub(crate) media: Multisets,
    /// Whether an upper bound may take the place of the t of closest hits on triangles and quads,
    /// which is computed last, and not needed for shading.
    pub without_t: bool,
    /// Tests made so far.
    pub tests: TestCounts,
    /// Rays so far, by kernel.
    pub kernels: Kernels,
}

/// The primitives and their search structure.
#[derive(Debug)]
pub struct Accel {
    geometry: Geometry,
    /// `None` for the brute-force reference.
    tree: Option<Tree>,
    /// A bottom-level tree for each prototype; empty for the reference.
    blas: Vec<Tree>,
    /// The instruction level; it does not affect answers.
    pub level: fearless_simd::Level,
    /// The kernel for batches of rays; it does not affect answers.
    pub kernel: KernelChoice,
}

impl Accel {
    /// Builds the structure of `preset` over `geometry`, to be searched at the best instruction
    /// level of the processor.
    pub fn new(geometry: Geometry, preset: Preset) -> Self {
        Self::in_chunks(geometry, preset, ChunkSizes::default())
    }

    /// As [`Self::new`], with trees in chunks of other sizes than usual, which do not affect answers.
    pub fn in_chunks(geometry: Geometry, preset: Preset, sizes: ChunkSizes) -> Self {
        let mut accel = Self::unbuilt(geometry);
        accel.build(preset, sizes);
        accel
    }

    /// The primitives without a structure; not for searches yet.
    pub fn unbuilt(geometry: Geometry) -> Self {
        // Not that of all instructions there are: some levels have no code of their own.
        let level = Level::best().token().unwrap_or_else(fearless_simd::Level::new);
        let kernel = KernelChoice::default();
        Self { geometry, tree: None, blas: Vec::new(), level, kernel }
    }

    /// Builds another structure over the same primitives.
    pub fn rebuild(&mut self, preset: Preset) {
        self.build(preset, ChunkSizes::default());
    }

    fn build(&mut self, preset: Preset, sizes: ChunkSizes) {
        (self.tree, self.blas) = (None, Vec::new());
        let geometry = &self.geometry;
        if preset == Preset::Brute {
            return;
        }
        let build = |geometry: &Geometry, blas: &[_]| build::build(geometry, blas, preset, sizes);
        self.blas = parallel::map(geometry.prototypes.iter(), |of| build(of, &[]));
        self.tree = Some(build(geometry, &self.blas));
    }

    /// The primitives.
    #[inline(always)]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Searches by this kernel at this instruction level from now on.
    pub fn search_by(&mut self, kernel: KernelChoice, level: Level) {
        self.kernel = kernel;
        if let Some(level) = level.token() {
            self.level = level;
        }
    }

    /// Searches in another precision from now on, in the same structure.
    pub fn set_precision(&mut self, precision: Precision) {
        self.geometry.set_precision(precision);
    }

    /// The tree over the scene's own primitives, or `None` for the brute-force reference.
    pub fn tree(&self) -> Option<&Tree> {
        self.tree.as_ref()
    }

    /// The number of triangles without area that no ray can hit. Those of a prototype count once.
    pub fn left_out(&self) -> u64 {
        if self.tree.is_some() {
            return self.trees().map(|tree| tree.left_out).sum();
        }
        let prototypes = &self.geometry.prototypes;
        std::iter::once(&self.geometry).chain(prototypes).map(Geometry::left_out).sum()
    }

    /// Scratch memory for one thread: traversal then allocates nothing.
    pub fn traversal(&self) -> Traversal {
        let Some(tree) = &self.tree else { return Traversal::default() };
        // A ray in an instance comes back.
        let below = self.blas.iter().map(Tree::stack_entries).max().map_or(0, |below| below + 1);
        let entries = tree.stack_entries() + below;
        Traversal { stack: vec![0; entries], flight: Flight::new(entries), ..Traversal::default() }
    }

    /// The searches in precision `P`, which must be the geometry's.
    #[inline(always)]
    pub fn search<P: Arithmetic>(&self) -> Search<'_, P> {
        Search { accel: self, precision: PhantomData }
    }

    /// The closest hit on `ray`, including light shapes: see [`Hit`].
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        with_precision!(self.geometry.precision, P => self.search::<P>().closest(ray, traversal))
    }

    /// Whether `ray` is occluded; light shapes do not occlude.
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        with_precision!(self.geometry.precision, P => self.search::<P>().occluded(ray, traversal))
    }

    /// Everything that `ray` crosses, in place of what `crossings` held. Of the triangles around an edge
    /// or a corner, [`crossing`](crate::kernels::triangle::crossing) says which; a sphere may be
    /// crossed twice. Of dozens of opaque triangles with the same corners the first counts.
    pub fn crossings(&self, ray: &Ray, traversal: &mut Traversal, crossings: &mut Crossings) {
        with_precision!(self.geometry.precision, P => {
            self.search::<P>().crossings(ray, traversal, crossings);
        });
    }

    /// As [`Self::crossings`], for many rays: for as many of the first ones as together cross not too much.
    /// Returns their number.
    pub fn crossings_of<'a>(
        &self,
        rays: impl Into<Rays<'a>>,
        traversal: &mut Traversal,
        crossings: &mut Crossings,
    ) -> usize {
        let rays = rays.into();
        let none = &mut *vec![false; rays.count()];
        with_precision!(self.geometry.precision, P => {
            self.search::<P>().crossings_of(rays, (None, none), traversal, crossings)
        })
    }

    /// The closest hits on many rays, including light shapes.
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

    /// Whether each of many rays is occluded; light shapes do not occlude.
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

    /// Boxes that together contain every hit, some dozens at most, each with the factor by which the
    /// errors of rays are larger there than elsewhere; `None` if nothing is certain of them.
    pub fn outline(&self) -> Option<Vec<(Aabb, f32)>> {
        let tree = self.tree.as_ref().filter(|_| self.geometry.precision != Precision::Fast)?;
        let factor = max(tree.widening, 1.0);
        Some(tree.outline(2).into_iter().map(|bounds| (bounds, factor)).collect())
    }

    /// The numbers of chunks that rays built so far, and of all; `None` if every tree was built at
    /// once.
    pub fn chunks(&self) -> Option<[usize; 2]> {
        self.trees().filter_map(Tree::chunks).reduce(|[a, b], [c, d]| [a + c, b + d])
    }

    /// Builds the chunks that no ray has reached so far.
    pub fn build_rest(&self) {
        let geometries = std::iter::once(&self.geometry).chain(&self.geometry.prototypes);
        for (tree, geometry) in self.trees().zip(geometries) {
            let searched = Searched::new(tree, geometry);
            tree.walk(|place, _| _ = searched.chunk(place));
        }
    }

    /// Bytes held by all trees.
    pub fn tree_bytes(&self) -> u64 {
        self.trees().map(Tree::bytes).sum::<u64>()
    }
}
