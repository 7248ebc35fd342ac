//! The tree: an arena and its root, and the chunks that rays build.

use std::ops::Range;
use std::sync::OnceLock;

use super::arena::StandIn;
use super::{Arena, ArenaView, Best, Hit, Kind, NO_PRIMITIVE, Ref, TreeContents, child_of};
use crate::counters::TestCounts;
use crate::geometry::instance::Instance;
use crate::geometry::{Geometry, PreparedRay, Surfaces};
use crate::kernels::{Aabb, Arithmetic};
use crate::math::float::min;
use crate::math::{LANES, Ray};

/// A bounding volume hierarchy over the primitives of a [`crate::geometry::Geometry`].
#[derive(Debug, Default)]
pub struct Tree {
    pub(super) arena: Arena,
    /// Of everything, and of each kind of [`Surfaces`].
    pub(super) root: Option<Root>,
    pub(super) surfaces: [Option<Root>; Surfaces::ALL.len()],
    /// The contents of the tree, without chunks that rays build.
    pub(super) census: TreeContents,
    pub(super) demand: Option<Demand>,
    /// Number of triangles without area, which are not in it.
    pub(super) left_out: u64,
    /// The factor by which rays are widened for the boxes of instances: see [`Instance::widening`].
    pub(super) widening: f32,
    /// Rays whose origins have no larger coordinates need not be widened.
    pub(super) near: f32,
}

/// The chunks of a tree that the first rays to reach them build.
#[derive(Debug)]
pub(super) struct Demand {
    /// A box around everything.
    pub(super) extents: Aabb,
    pub(super) chunks: Vec<Chunk>,
}

#[derive(Debug)]
pub(super) struct Chunk {
    /// Where its entries are among the numbers of the arena.
    pub(super) entries: Range<usize>,
    /// Its root and contents, once it is built.
    pub(super) built: OnceLock<(Ref, TreeContents)>,
}

/// The geometry and tree of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Searched<'a> {
    pub(super) tree: &'a Tree,
    /// That of the tree.
    pub(super) arena: ArenaView<'a>,
    pub(super) geometry: &'a Geometry,
    /// The trees of prototypes.
    pub(super) blas: &'a [Tree],
    /// What of the tree is searched.
    pub(super) root: Option<Root>,
    /// See [`Traversal::without_t`](super::Traversal::without_t).
    pub(super) without_t: bool,
    /// Whether only instances are searched.
    pub(super) only_instances: bool,
}

/// A part of a tree, where traversal may start.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// The node or leaf.
    pub place: Ref,
    /// Its box.
    pub bounds: Aabb,
}

impl Demand {
    /// The largest number of inner nodes on a path in a chunk. Memory for rays is taken before it is
    /// built. Measured: 7 in scans.
    pub(super) const MOST_DEPTH: u64 = 24;

    /// The contents of the chunks that are built.
    fn built(&self) -> impl Iterator<Item = TreeContents> {
        self.chunks.iter().filter_map(|chunk| Some(chunk.built.get()?.1))
    }
}

impl Tree {
    /// The root of everything, or of some surfaces.
    pub(super) fn root_of(&self, surfaces: Option<Surfaces>) -> Option<Root> {
        surfaces.map_or(self.root, |surfaces| self.surfaces[surfaces as usize])
    }

    /// What is built so far.
    pub fn census(&self) -> TreeContents {
        let below = self.demand.iter().flat_map(Demand::built);
        let below = below.fold(TreeContents::default(), std::ops::Add::add);
        TreeContents { depth: self.census.depth + below.depth, ..self.census + below }
    }

    /// The numbers of chunks built so far and of all; `None` if the tree was built at once.
    pub fn chunks(&self) -> Option<[usize; 2]> {
        self.demand.as_ref().map(|demand| [demand.built().count(), demand.chunks.len()])
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.arena.bytes()
    }

    /// The boxes of this many levels of nodes below the root, or of leaves above: together they contain
    /// every hit, more tightly than the root's own.
    pub(super) fn outline(&self, levels: usize) -> Vec<Aabb> {
        let mut parts: Vec<_> = self.root.into_iter().collect();
        for _ in 0..levels {
            parts = parts.into_iter().flat_map(|part| self.below(part)).collect();
        }
        parts.into_iter().map(|part| part.bounds).collect()
    }

    /// The children of a node with their boxes, or a leaf itself.
    pub(super) fn below(&self, part: Root) -> Vec<Root> {
        let Root { place, .. } = part;
        if place.kind() != Kind::Node {
            return vec![part];
        }
        let node = self.arena.view().node(place);
        let lanes = 0..node.count as usize;
        let child = |lane| {
            let plane = |side: usize| [0, 1, 2].map(|axis: usize| node.planes[axis][side][lane]);
            let bounds = Aabb { low: plane(0).into(), high: plane(1).into() };
            Root { place: child_of(node, place, lane), bounds }
        };
        lanes.map(child).collect()
    }

    /// The root of the chunk that the list at `place` stands for, if it is built.
    pub(super) fn known(&self, place: Ref) -> Option<Ref> {
        let demand = self.demand.as_ref().filter(|_| place.kind() == Kind::List)?;
        let chunk = demand.chunks.get(self.arena.view().stands_for(StandIn::Chunk, place)?)?;
        Some(chunk.built.get()?.0)
    }

    /// Calls `visit` for each node and leaf with its box, clipped by the boxes of all nodes above.
    pub(super) fn walk(&self, mut visit: impl FnMut(Ref, &Aabb)) {
        let mut waiting: Vec<_> = self.root.into_iter().collect();
        while let Some(Root { place, bounds }) = waiting.pop() {
            let place = self.known(place).unwrap_or(place);
            visit(place, &bounds);
            if place.kind() == Kind::Node {
                let clipped = |own: Aabb| Aabb {
                    low: own.low.max(bounds.low),
                    high: own.high.min(bounds.high),
                };
                let below = self.below(Root { place, bounds }).into_iter();
                waiting.extend(below.map(|own| Root { bounds: clipped(own.bounds), ..own }));
            }
        }
    }

    /// Calls `visit` for each leaf with its box, clipped by the boxes of all nodes above it, and its
    /// primitives. A chunk that is not built is a leaf without any: see [`super::Accel::build_rest`].
    pub fn for_each_leaf(&self, mut visit: impl FnMut(&Aabb, Vec<u32>)) {
        let arena = self.arena.view();
        self.walk(|place, bounds| {
            let count = match place.kind() {
                Kind::Node => return,
                Kind::List => arena.list(place).len(),
                _ => arena.head(place).count as usize,
            };
            visit(bounds, (0..count).map(|entry| arena.number_of(place, entry)).collect());
        });
    }

    /// The number of nodes and leaves that the surface-area heuristic expects for a ray that
    /// crosses the whole scene's box without a hit.
    pub fn expected_visits(&self) -> Visits {
        let mut visits = Visits::default();
        let whole = self.root.map_or(0.0, |root| root.bounds.half_area());
        self.walk(|place, bounds| {
            let share = if whole > 0.0 { bounds.half_area() / whole } else { 1.0 };
            let is_node = place.kind() == Kind::Node;
            *(if is_node { &mut visits.nodes } else { &mut visits.leaves }) += share;
        });
        visits
    }

    /// Entries needed in the stack of a ray: every inner node on a path leaves all its children
    /// except one, the last one leaves all, and whole vectors are written.
    pub(super) fn stack_entries(&self) -> usize {
        let below = if self.demand.is_some() { Demand::MOST_DEPTH } else { 0 };
        (LANES - 1) * (self.census.depth + below) as usize + 2 * LANES
    }
}

impl<'a> Searched<'a> {
    /// All of a tree without instances.
    pub(super) fn new(tree: &'a Tree, geometry: &'a Geometry) -> Self {
        let (arena, root) = (tree.arena.view(), tree.root);
        Self { tree, arena, geometry, blas: &[], root, without_t: false, only_instances: false }
    }

    /// Prepares a ray for the search.
    #[inline(always)]
    pub(super) fn prepare(&self, ray: &Ray) -> PreparedRay {
        PreparedRay::widened(ray, self.tree.widening)
    }

    /// The instance for which the list at `place` stands; `None` for other places.
    #[inline(always)]
    pub(super) fn instance(&self, place: Ref) -> Option<&'a Instance> {
        let number = self.arena.stands_for(StandIn::Instance, place)?;
        self.geometry.instances.get(number)
    }

    /// The prototype of an instance.
    #[inline(always)]
    pub(super) fn prototype(&self, instance: &Instance) -> Self {
        let number = instance.prototype();
        Self::new(&self.blas[number], &self.geometry.prototypes[number])
    }

    /// `ray` in the space of an instance's prototype, up to its best hit: one whose t rounds to the same
    /// number may come first. `None` if it cannot be traced there.
    #[inline(always)]
    pub(super) fn carried(&self, instance: &Instance, ray: &Ray, best: &Best) -> Option<Ray> {
        let carried = instance.carried(ray);
        let carried = Ray { t_max: min(ray.t_max, best.high.next_up()), ..carried };
        carried.is_valid().then_some(carried)
    }

    /// Offers a ray that is back from an instance the `hit` there, which has the prototype's number.
    #[inline(always)]
    pub(super) fn offer<P: Arithmetic>(
        &self,
        instance: &Instance,
        Hit { t, primitive }: Hit,
        (ray, best): (&Ray, &mut Best),
        tests: &mut TestCounts,
    ) {
        if primitive != NO_PRIMITIVE {
            let hit = Hit { t, primitive: instance.first() + primitive };
            best.offer::<P>(self, ray, Best::of(hit), tests);
        }
    }
}

/// See [`Tree::expected_visits`].
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Visits {
    /// Inner nodes.
    pub nodes: f64,
    /// Leaves.
    pub leaves: f64,
}
