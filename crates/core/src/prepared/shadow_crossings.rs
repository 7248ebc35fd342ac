//! What shadow rays lose at transparent surfaces.
//!
//! The crossings of many rays are collected in one list ([`PreparedScene::collect_crossings`]), which
//! finds the shape of each. Then those of one class and kind of primitive are evaluated together
//! ([`ShadowCrossings::evaluate`]), and at last those of each ray are folded in their order
//! ([`ShadowCrossings::transmittances`]). Memory is used again for the next rays.

use glam::{DVec3, Vec3};

use super::interface::{LEAST_COSINE, close_depth};
use super::{Face, Group, MappedHits, MediumStack, PreparedScene, SampleCounts, Shape};
use crate::accel::{Crossings, Rays, Traversal};
use crate::geometry::{ShadingKind, Surfaces};
use crate::kernels::Arithmetic;
use crate::math::float::{dot, max};
use crate::math::multisets::Multisets;
use crate::math::vector::set;
use crate::math::{Line, Mask, Ray, Single, Vector};

/// Shadow rays and the transparent surfaces that they cross.
#[derive(Clone, Debug, Default)]
pub struct ShadowCrossings {
    rays: Vec<CrossingRay>,
    crossings: Vec<Crossing>,
    /// Memory for what the rays cross.
    crossed: Crossings,
}

/// A shadow ray that crosses transparent surfaces, or starts where light is absorbed.
#[derive(Clone, Copy, Debug)]
struct CrossingRay {
    /// Its number among those that were given.
    number: usize,
    /// The end of its crossings in the list, which begin where those of the ray before end.
    end: usize,
    /// The ray, of unit direction.
    unit: Ray,
    /// The distance at which it ends, in scene units.
    distance: f64,
    /// What it is inside of where it starts.
    media: MediumStack,
}

/// A point at which a shadow ray crosses a transparent surface.
#[derive(Clone, Copy, Debug, Default)]
struct Crossing {
    /// The number of the primitive.
    primitive: u32,
    /// Its shape's index in [`Appearance::shapes`](super::Appearance::shapes).
    shape: u32,
    /// The ray's index in the list.
    ray: u32,
    /// The distance along the ray, in scene units: that of a hit, which is rounded to single precision.
    distance: f64,
    /// Opacity.
    opacity: f32,
    /// Base colour, if that tints refracted light; else white.
    color: Vec3,
    /// The cosine of the angle between the normal and the way back along the ray.
    cosine: f32,
    /// Bound on the distance of the point to the exact surface, in scene units: the sum over its
    /// coordinates.
    error: f32,
    /// Whether the ray comes from behind.
    inside: bool,
}

impl PreparedScene {
    /// Replaces the list by what the rays from the number `first` on cross, but for those that are
    /// `occluded`: as many as together cross not too much. `media` tells what a ray starts inside of. Returns
    /// the number of the next ray.
    pub fn collect_crossings<P: Arithmetic>(
        &self,
        (rays, first): (Rays<'_>, usize),
        occluded: &mut [bool],
        media: &dyn Fn(usize) -> MediumStack,
        list: &mut ShadowCrossings,
        traversal: &mut Traversal,
    ) -> usize {
        let ShadowCrossings { rays: found, crossings, crossed, .. } = list;
        found.clear();
        crossings.clear();
        let left_out = &mut occluded[first..];
        let asked = (Some(Surfaces::Transparent), &mut *left_out);
        let search = self.accel.search::<P>();
        let count = search.crossings_of(rays.without(first), asked, traversal, crossed);
        let absorbs = self.solids.iter().any(|solid| solid.absorption != Vec3::ZERO);
        let mut shape = 0;
        for ((number, hits), _) in
            (first..).zip(crossed.of_rays()).zip(left_out).filter(|(_, left_out)| !**left_out)
        {
            if hits.is_empty() && !absorbs {
                continue;
            }
            let media = media(number);
            if hits.is_empty() && self.medium(&media).absorption == Vec3::ZERO {
                continue;
            }
            let ray = rays.ray(number);
            let length = f64::from(dot(ray.direction, ray.direction)).sqrt();
            let index = found.len() as u32;
            crossings.extend(hits.iter().map(|hit| {
                shape = self.appearance.shape_beside(shape, hit.primitive);
                Crossing {
                    primitive: hit.primitive,
                    shape: shape as u32,
                    ray: index,
                    distance: f64::from(hit.t) * length,
                    ..Crossing::default()
                }
            }));
            let direction = (ray.direction.as_dvec3() / length).as_vec3();
            let distance = f64::from(ray.t_max) * length;
            let unit = Ray { direction, ..ray };
            found.push(CrossingRay { number, end: crossings.len(), unit, distance, media });
        }
        first + count
    }

    /// The share of light that passes all transparent surfaces along a shadow ray that nothing else
    /// blocks, inside of `media` where it starts.
    #[inline(never)]
    pub fn transmittance<P: Arithmetic>(
        &self,
        (ray, media): (&Ray, MediumStack),
        list: &mut ShadowCrossings,
        traversal: &mut Traversal,
        look_ups: &mut SampleCounts,
    ) -> Vec3 {
        let rays = Rays::Rows(std::slice::from_ref(ray));
        self.collect_crossings::<P>((rays, 0), &mut [false], &|_| media, list, traversal);
        if list.rays.is_empty() {
            return Vec3::ONE;
        }
        let mut group = Group::<f32>::default();
        for i in 0..list.len() {
            let (face, kind) = list.face(i, self);
            list.evaluate::<f32, P>((), self, (kind, &[face]), &mut group, look_ups);
        }
        let mut all = Vec3::ONE;
        list.transmittances(self, traversal, |_, transmittance| all = transmittance);
        all
    }
}

impl ShadowCrossings {
    /// The number of crossings.
    pub(crate) fn len(&self) -> usize {
        self.crossings.len()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let Self { rays, crossings, crossed } = self;
        rays.capacity() * size_of::<CrossingRay>()
            + crossings.capacity() * size_of::<Crossing>()
            + crossed.bytes()
    }

    /// The `i`th crossing, with `i` in place of its ray, and its kind.
    #[inline(always)]
    pub fn face(&self, i: usize, scene: &PreparedScene) -> (Face, ShadingKind) {
        let Crossing { primitive, shape, .. } = self.crossings[i];
        (Face { ray: i as u32, primitive, shape }, scene.accel.geometry().kind(primitive))
    }

    /// Evaluates the crossings of `faces`, at most one for each lane, all of them of one class and kind.
    /// `group` is memory for their data.
    #[inline(always)]
    pub fn evaluate<F: Single, P: Arithmetic>(
        &mut self,
        token: F::Token,
        scene: &PreparedScene,
        (kind, faces): (ShadingKind, &[Face]),
        group: &mut Group<F>,
        look_ups: &mut SampleCounts,
    ) {
        let (appearance, geometry) = (&scene.appearance, scene.accel.geometry());
        group.begin_crossings(faces, appearance);
        let class = group.class(appearance);
        let [mut origins, mut directions] = <[[F::Row; 3]; 2]>::default();
        let mut distances = F::Row::default();
        for lane in 0..F::LANES {
            let Crossing { ray, distance, .. } = self.crossings[group.faces[lane].ray as usize];
            let unit = &self.rays[ray as usize].unit;
            set::<F>(&mut origins, lane, unit.origin);
            set::<F>(&mut directions, lane, unit.direction);
            distances.as_mut()[lane] = distance as f32;
            if !class.passes_evenly {
                group.fetch_values(lane, scene);
            }
            group.fetch_corners(lane, geometry, || *unit);
        }
        let origin = Vector::load(token, &origins);
        let line = &Line { origin, direction: Vector::load(token, &directions) };
        let t = F::load(token, &distances);
        let surfaces = group.surfaces::<P>((kind, line, t), geometry);
        let (normal, inside) = group.sided_normals(line, &surfaces);
        let cosine = (-line.direction).dot_in_order(normal);
        let error = surfaces.error.x + surfaces.error.y + surfaces.error.z;
        let constant = (F::splat(token, class.opacity()), Vector::splat(token, Vec3::ONE));
        let (opacity, color) = if class.passes_evenly {
            constant
        } else {
            let mapped_hits =
                MappedHits { group, surfaces: &surfaces, line, t, scene, footprint: None };
            F::outlined(
                token,
                #[inline(always)]
                || mapped_hits.opacity_and_tint(class, look_ups),
            )
        };
        for (lane, face) in faces.iter().enumerate() {
            let crossing = &mut self.crossings[face.ray as usize];
            crossing.opacity = opacity.lane(lane);
            crossing.color = color.lane(lane);
            crossing.cosine = cosine.lane(lane);
            crossing.error = error.lane(lane);
            crossing.inside = inside.bits() >> lane & 1 == 1;
        }
    }

    /// Calls `each` with the number of each ray and the share of its light that passes.
    pub fn transmittances(
        &self,
        scene: &PreparedScene,
        traversal: &mut Traversal,
        mut each: impl FnMut(usize, Vec3),
    ) {
        let Self { rays, crossings, .. } = self;
        let mut first = 0;
        for ray in rays.iter() {
            let own = &crossings[first..ray.end];
            each(ray.number, transmittance(scene, ray, own, &mut traversal.media));
            first = ray.end;
        }
    }
}

/// The share of light that passes the `crossings` of a ray.
///
/// As for other rays, each is an interface between two media, those at one place are one, and the medium
/// absorbs.
fn transmittance(
    scene: &PreparedScene,
    ray: &CrossingRay,
    crossings: &[Crossing],
    all: &mut Multisets,
) -> Vec3 {
    let (mut media, mut from, mut transmittance) = (ray.media, 0.0, DVec3::ONE);
    let shape = |crossing: &Crossing| &scene.appearance.shapes[crossing.shape as usize];
    let through = |shape: &Shape| scene.appearance.class(shape).transparency;
    let mut rest = crossings;
    while let Some((first, behind)) = rest.split_first() {
        rest = behind;
        let own = shape(first);
        let Some(transparency) = through(own) else { continue };
        let mut sides = scene.sides(media, own, first.inside, all);
        transmittance *= scene.absorbed(&media, first.distance - from);
        if sides.before != media {
            transmittance *= scene.more_absorbed([&media, &sides.before], first.distance);
        }
        let mut last = *first;
        // As at an interface.
        let mut has_own = scene.differ(&sides);
        while let Some((next, behind)) = rest.split_first().filter(|_| transparency.kt > 0.0) {
            let through =
                through(shape(next)).filter(|of| of.kt > 0.0 && shape(next).solid.is_some());
            let Some(through) = through.filter(|_| own.solid.is_some() && last.is_close(next))
            else {
                break;
            };
            let leaves = next.inside || next.primitive == last.primitive;
            let next_sides = scene.sides(sides.beyond, shape(next), leaves, all);
            if scene.differ(&next_sides) {
                let tint = if has_own { through.color * through.kt } else { Vec3::ONE };
                transmittance *= tint.as_dvec3();
                has_own = true;
            }
            sides.beyond = next_sides.beyond;
            (last, rest) = (*next, behind);
        }
        if own.solid.is_none() || scene.differ(&sides) {
            let iors = [sides.before, sides.beyond].map(|media| scene.medium(&media).ior);
            transmittance *=
                transparency.transmittance(first.opacity, first.color, first.cosine, iors);
        }
        (media, from) = (sides.beyond, last.distance);
    }
    (transmittance * scene.absorbed(&media, ray.distance - from)).as_vec3()
}

impl Crossing {
    /// Whether the next one lies at the same place: see [`close_depth`].
    fn is_close(&self, next: &Self) -> bool {
        let way = (next.distance - self.distance) as f32;
        way * max(self.cosine, LEAST_COSINE) <= close_depth(self.error)
    }
}
