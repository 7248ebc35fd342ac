//! The primitives as dense arrays, and the definition of a hit.
//!
//! Primitives are numbered: triangles first, then quads, then quadrics, each kind in the order of
//! the scene file, then those of instances. The number alone gives the kind.

pub mod cutouts;
mod holes;
pub mod instance;
mod quadric;

use std::ops::Range;

use glam::Vec3;

use crate::counters::{PrimitiveCounts, TestCounts};
use crate::kernels::{Aabb, Arithmetic, Precision, ShearedSpace, SlabRay, quad, triangle};
use crate::math::Ray;
use crate::math::float::min;
use cutouts::Cutout;
use instance::{Instance, Instanced};
use wavecrest_base::{parallel, shared::Shared};

pub use quadric::Quadric;

/// The primitives of a scene, in world space. Coordinates and radii are finite, and no larger than
/// [`MAX_COORDINATE`](crate::math::float::MAX_COORDINATE).
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Vertices of triangles and quads.
    pub positions: Shared<Vec3>,
    /// Three vertices a triangle, counter-clockwise from the front.
    pub triangles: Shared<[u32; 3]>,
    /// Four vertices a quad, ordered so that the diagonal from the first to the third lies inside.
    pub quads: Vec<[u32; 4]>,
    /// Spheres and disks.
    pub quadrics: Vec<Quadric>,
    /// Primitives that shadow rays pass, by number, in rising order: shapes of lights, and
    /// transparent ones.
    pub passed: Vec<Range<u32>>,
    /// Those of them that are transparent.
    pub transparent: Vec<Range<u32>>,
    /// Primitives with holes, in rising order of their numbers.
    pub cutouts: Vec<Cutout>,
    /// Precision of the tests.
    pub precision: Precision,
    /// Meshes shown by instances, each in its own space, with triangles only.
    pub prototypes: Vec<Geometry>,
    /// Instances of prototypes. Their primitives' numbers follow those of the scene's own, instance
    /// by instance.
    pub instances: Vec<Instance>,
}

/// A primitive: its kind and its index in that kind's array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Primitive {
    /// In [`Geometry::triangles`].
    Triangle(usize),
    /// In [`Geometry::quads`].
    Quad(usize),
    /// In [`Geometry::quadrics`].
    Quadric(usize),
    /// A triangle of an instance.
    Instanced(Instanced),
}

/// Primitives that are shaded alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadingKind {
    /// Triangles and quads.
    Flat,
    /// Spheres and disks.
    Quadrics,
    /// Triangles of instances.
    Instances,
}

impl ShadingKind {
    /// Every kind, in order.
    pub const ALL: [Self; 3] = [Self::Flat, Self::Quadrics, Self::Instances];
}

/// The primitives by what shadow rays do there: each kind has a tree of its own below the root of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// They end.
    Opaque,
    /// They pass shapes of lights.
    Lights,
    /// They pass and lose light.
    Transparent,
}

impl Surfaces {
    /// Every kind, in order.
    pub const ALL: [Self; 3] = [Self::Opaque, Self::Lights, Self::Transparent];
}

/// A ray with values derived for the tests.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay {
    /// The ray itself.
    pub ray: Ray,
    /// For boxes.
    pub slab: SlabRay,
    /// For triangles and quads.
    pub space: ShearedSpace,
}

impl PreparedRay {
    /// Prepares `ray`, which must be valid.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        Self::widened(ray, 0.0)
    }

    /// As [`Self::new`], for the boxes of [`SlabRay::widened`].
    #[inline(always)]
    pub fn widened(ray: &Ray, factor: f32) -> Self {
        let slab = SlabRay::widened(ray, factor);
        Self { ray: *ray, slab, space: ShearedSpace::new(ray) }
    }
}

impl Geometry {
    /// Number of primitives of every kind, including degenerate triangles, and those of instances
    /// once for each instance.
    pub fn len(&self) -> usize {
        self.instances.last().map_or(self.own(), |last| {
            last.first() as usize + self.prototypes[last.prototype()].own()
        })
    }

    /// Number of primitives outside instances.
    #[inline]
    pub fn own(&self) -> usize {
        self.triangles.len() + self.quads.len() + self.quadrics.len()
    }

    /// Number of primitives of each kind, without those of instances.
    pub fn counts(&self) -> PrimitiveCounts {
        let spheres = self.quadrics.iter().filter(|quadric| quadric.sphere().is_some()).count();
        PrimitiveCounts {
            triangles: self.triangles.len() as u64,
            quads: self.quads.len() as u64,
            spheres: spheres as u64,
            disks: (self.quadrics.len() - spheres) as u64,
        }
    }

    /// Number of stored primitives: those of a prototype count once.
    pub fn held(&self) -> usize {
        self.own() + self.prototypes.iter().map(Self::own).sum::<usize>()
    }

    /// Sets the precision of the tests.
    pub fn set_precision(&mut self, precision: Precision) {
        self.precision = precision;
        self.prototypes.iter_mut().for_each(|prototype| prototype.precision = precision);
    }

    /// Whether there are no primitives.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The primitive with that number.
    #[inline(always)]
    pub fn primitive(&self, number: u32) -> Primitive {
        let index = number as usize;
        let (triangles, quads) = (self.triangles.len(), self.quads.len());
        if index < triangles {
            Primitive::Triangle(index)
        } else if index < triangles + quads {
            Primitive::Quad(index - triangles)
        } else if index < triangles + quads + self.quadrics.len() {
            Primitive::Quadric(index - triangles - quads)
        } else {
            Primitive::Instanced(self.instanced(number))
        }
    }

    /// The shading kind of the primitive with that number.
    #[inline(always)]
    pub fn kind(&self, number: u32) -> ShadingKind {
        let index = number as usize;
        if index >= self.own() {
            ShadingKind::Instances
        } else if index >= self.triangles.len() + self.quads.len() {
            ShadingKind::Quadrics
        } else {
            ShadingKind::Flat
        }
    }

    /// The primitive with that number, which belongs to an instance.
    fn instanced(&self, number: u32) -> Instanced {
        let after = self.instances.partition_point(|instance| instance.first() <= number);
        let instance = after.saturating_sub(1) as u32;
        let first = self.instances.get(instance as usize).map_or(0, Instance::first);
        Instanced { instance, triangle: number - first }
    }

    /// The instance that shows a primitive, and its prototype.
    #[inline]
    pub fn instance(&self, instanced: Instanced) -> (&Instance, &Self) {
        let instance = &self.instances[instanced.instance as usize];
        (instance, &self.prototypes[instance.prototype()])
    }

    /// The world-space corners of a mesh triangle, or of an instance's. `None` for other kinds.
    #[inline]
    pub fn mesh_triangle(&self, number: u32) -> Option<[Vec3; 3]> {
        match self.primitive(number) {
            Primitive::Triangle(i) => Some(self.triangle(i)),
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = self.instance(instanced);
                Some(
                    prototype
                        .triangle(instanced.triangle as usize)
                        .map(|corner| instance.point(corner)),
                )
            }
            Primitive::Quad(_) | Primitive::Quadric(_) => None,
        }
    }

    /// The corners of a triangle.
    // Written out, as for quads: `map` passes them through memory in pieces.
    #[inline(always)]
    pub fn triangle(&self, index: usize) -> [Vec3; 3] {
        let [a, b, c] = self.triangles[index];
        [self.position(a), self.position(b), self.position(c)]
    }

    /// The corners of a quad.
    #[inline(always)]
    pub fn quad(&self, index: usize) -> [Vec3; 4] {
        let [a, b, c, d] = self.quads[index];
        [self.position(a), self.position(b), self.position(c), self.position(d)]
    }

    #[inline(always)]
    fn position(&self, vertex: u32) -> Vec3 {
        self.positions[vertex as usize]
    }

    /// The box of the primitive, which contains its exact hits. Not for primitives of instances, whose
    /// boxes contain a whole prototype.
    #[inline]
    pub fn bounds(&self, number: u32) -> Aabb {
        match self.primitive(number) {
            Primitive::Triangle(i) => Aabb::around(self.triangle(i)),
            Primitive::Quad(i) => Aabb::around(self.quad(i)),
            Primitive::Quadric(i) => self.quadrics[i].bounds(),
            Primitive::Instanced(_) => Aabb::EMPTY,
        }
    }

    /// Whether the primitive is a triangle without area.
    pub fn is_degenerate(&self, number: u32) -> bool {
        match self.primitive(number) {
            Primitive::Triangle(i) => triangle::is_degenerate(&self.triangle(i)),
            Primitive::Quad(_) | Primitive::Quadric(_) => false,
            Primitive::Instanced(instanced) => {
                self.instance(instanced).1.is_degenerate(instanced.triangle)
            }
        }
    }

    /// The number of triangles without area, but for those of prototypes.
    pub(crate) fn left_out(&self) -> u64 {
        let of = |number: usize| u64::from(self.is_degenerate(number as u32));
        parallel::reduce(self.triangles.len(), 0, of, |a, b| a + b)
    }

    /// Whether shadow rays pass the primitive.
    #[inline]
    pub fn is_passed(&self, number: u32) -> bool {
        is_among(&self.passed, number)
    }

    /// Whether the primitive takes light from shadow rays.
    #[inline]
    pub fn is_transparent(&self, number: u32) -> bool {
        is_among(&self.transparent, number)
    }

    /// What shadow rays do at the primitive.
    #[inline]
    pub fn surfaces_of(&self, number: u32) -> Surfaces {
        match self.is_passed(number) {
            false => Surfaces::Opaque,
            true if self.is_transparent(number) => Surfaces::Transparent,
            true => Surfaces::Lights,
        }
    }

    /// The t at which the ray hits the primitive: the least within its range that is not in a hole,
    /// rounded once.
    #[inline(always)]
    pub(crate) fn hit<P: Arithmetic>(
        &self,
        number: u32,
        ray: &Ray,
        tests: &mut TestCounts,
    ) -> Option<f32> {
        let t = self.meet::<P>(number, ray, tests)?;
        self.behind_holes::<P>(number, ray, t, tests)
    }

    /// As [`Self::hit`], without regard to holes of the scene's own primitives.
    #[inline(always)]
    pub(crate) fn meet<P: Arithmetic>(
        &self,
        number: u32,
        ray: &Ray,
        tests: &mut TestCounts,
    ) -> Option<f32> {
        match self.primitive(number) {
            Primitive::Triangle(i) => {
                tests.primitives.triangles += 1;
                triangle::meet(ray, &self.triangle(i))
            }
            Primitive::Quad(i) => {
                tests.primitives.quads += 2;
                let [first, second] = quad::halves(&self.quad(i));
                match (triangle::meet(ray, &first), triangle::meet(ray, &second)) {
                    (Some(s), Some(t)) => Some(min(s, t)),
                    (s, t) => s.or(t),
                }
            }
            Primitive::Quadric(i) => {
                self.quadrics[i].count(tests, 1);
                self.quadrics[i].hit::<P>(ray)
            }
            Primitive::Instanced(instanced) => self.hit_instanced::<P>(instanced, ray, tests),
        }
    }

    /// Every t at which the ray crosses the primitive outside of holes; none of instances.
    pub(crate) fn cross<P: Arithmetic>(
        &self,
        number: u32,
        ray: &Ray,
        tests: &mut TestCounts,
    ) -> impl Iterator<Item = f32> {
        let found = match self.primitive(number) {
            Primitive::Triangle(i) => {
                tests.primitives.triangles += 1;
                [triangle::crossing(ray, &self.triangle(i)), None]
            }
            Primitive::Quad(i) => {
                tests.primitives.quads += 2;
                quad::halves(&self.quad(i)).map(|half| triangle::crossing(ray, &half))
            }
            Primitive::Quadric(i) => {
                self.quadrics[i].count(tests, 1);
                self.quadrics[i].crossings::<P>(ray)
            }
            Primitive::Instanced(_) => [None; 2],
        };
        let is_there = move |t: &f32| !self.is_hole::<P>(number, ray, *t, tests);
        found.into_iter().flatten().filter(is_there)
    }

    /// As [`Self::hit`], for a triangle of an instance: the ray is transformed into the space of the
    /// prototype.
    #[cold]
    #[inline(never)]
    fn hit_instanced<P: Arithmetic>(
        &self,
        instanced: Instanced,
        ray: &Ray,
        tests: &mut TestCounts,
    ) -> Option<f32> {
        let (instance, prototype) = self.instance(instanced);
        let carried = instance.carried(ray);
        if !carried.is_valid() {
            return None;
        }
        prototype.hit::<P>(instanced.triangle, &carried, tests)
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let own = size_of_val(self.positions.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.quads.as_slice())
            + size_of_val(self.quadrics.as_slice())
            + size_of_val(self.instances.as_slice());
        own as u64 + self.prototypes.iter().map(Self::bytes).sum::<u64>()
    }
}

/// Whether a number is in one of these ranges, which are in rising order.
#[inline]
fn is_among(ranges: &[Range<u32>], number: u32) -> bool {
    let after = ranges.partition_point(|range| range.start <= number);
    after > 0 && ranges[after - 1].contains(&number)
}
