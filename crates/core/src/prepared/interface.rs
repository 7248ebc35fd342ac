//! Interfaces: the surfaces that lie where a ray meets a transparent one.
//!
//! Surfaces along a ray have an order, and none is skipped. Those of solids that lie at one place, within
//! the distance by which the origin of a bent ray is moved, are one interface between two media: that before
//! the first and that behind the last of them. So touching solids leave no gap, and what is thinner than that
//! distance is entered and left. An opaque surface there is seen as if it touched the medium: there is no
//! interface. What else lies there is the next hit, which is known.

use glam::Vec3;

use super::{MediumStack, PreparedScene, Shape, Sides};
use crate::accel::{Hit, Traversal};
use crate::kernels::{Arithmetic, ShadingPoint, SurfacePoint, Transparency};
use crate::math::float::{max, offset_of_error};
use crate::math::{Mask, Ray, Single, Vector};

/// What lies where a ray meets a transparent surface.
#[derive(Clone, Copy)]
pub(super) struct Interface {
    /// The media on both sides.
    pub(super) sides: Sides,
    /// Whether the surface is there: it is none of a solid that is the medium on neither side.
    pub(super) is_there: bool,
    /// Its last surface.
    pub(super) last: InterfaceHit,
    /// The weight of refracted light by the surfaces after the first.
    pub(super) tint: Vec3,
    /// What behind the last surface is so close that the origin of a bent ray would be beyond.
    pub(super) close: Option<Hit>,
    /// The next hit of the ray behind the last surface, if it is known; else a miss.
    pub(super) next: Hit,
    /// The media behind the first surface, and the hit next to it, if it is known; else a miss.
    pub(super) behind: MediumStack,
    pub(super) second: Hit,
}

impl Interface {
    /// The direction to the side of the last surface on which bent rays start.
    pub(super) fn side(&self) -> Vec3 {
        let normal = Vec3::from(self.last.normal);
        if self.close.is_some() { normal } else { -normal }
    }
}

/// A hit and its position.
#[derive(Clone, Copy)]
pub(super) struct InterfaceHit {
    pub(super) hit: Hit,
    /// See [`SurfacePoint`].
    pub(super) point: Vector<f32>,
    pub(super) error: Vector<f32>,
    /// The unit normal on the side of the ray's origin.
    pub(super) normal: Vector<f32>,
    /// See [`close_depth`].
    depth: f32,
    /// Whether the ray comes from behind.
    leaves: bool,
}

impl InterfaceHit {
    /// A hit at the shading point in a lane.
    #[inline(always)]
    pub(super) fn at<F: Single>(hit: &Hit, points: &ShadingPoint<F>, lane: usize) -> Self {
        let vector = |of: &Vector<F>| Vector::<f32>::from(of.lane(lane));
        let [point, error, normal] =
            [vector(&points.point), vector(&points.error), vector(&points.normal)];
        let leaves = points.inside.bits() >> lane & 1 == 1;
        Self { hit: *hit, point, error, normal, depth: close_depth(error.element_sum()), leaves }
    }
}

/// How much longer the part of a ray is in which filters look for what is near, in depths and as a share of t:
/// measured, so that nearly all hits are within.
const FILTERED: f32 = 8.0;
const FILTERED_SHARE: f32 = 1.0 / 65536.0;

/// At smaller cosines of the angle to the normal, nothing farther along a ray is taken for close.
pub(super) const LEAST_COSINE: f32 = 1.0 / 64.0;

/// The largest depth below a surface, where points have errors of this sum, at which another one is close:
/// twice that of the origin of a bent ray, which its own rounding moves too.
pub(super) fn close_depth(error: f32) -> f32 {
    2.0 * offset_of_error(error)
}

impl PreparedScene {
    /// What lies where `ray`, inside of `media`, meets a surface with this `transparency`.
    pub(super) fn interface<P: Arithmetic>(
        &self,
        (ray, media): (&Ray, MediumStack),
        first: InterfaceHit,
        transparency: &Transparency,
        traversal: &mut Traversal,
    ) -> Interface {
        let InterfaceHit { hit, leaves: from_behind, .. } = first;
        let shape = self.shape(&hit);
        let (crossed, next) = self.crossed::<P>(ray, &first, traversal);
        // Along an edge, what it encloses may not be entered.
        let mut sides = Sides { before: media, beyond: media };
        if let Some(crossed) = crossed {
            let leaves =
                if crossed == hit { from_behind } else { self.surface_of::<P>(ray, &crossed).1 };
            sides = self.sides(media, shape, leaves, &mut traversal.media);
        }
        let is_crossed = crossed.is_some();
        let mut found = Interface {
            sides,
            is_there: is_crossed,
            last: first,
            tint: Vec3::ONE,
            close: None,
            next,
            behind: sides.beyond,
            second: next,
        };
        if transparency.kt > 0.0 && shape.solid.is_some() && is_crossed {
            self.join_close::<P>(ray, &mut found, traversal);
        }
        found.is_there = is_crossed && (shape.solid.is_none() || self.differ(&found.sides));
        found
    }

    /// Adds the surfaces of solids that are close behind the last one of an interface.
    fn join_close<P: Arithmetic>(
        &self,
        ray: &Ray,
        found: &mut Interface,
        traversal: &mut Traversal,
    ) {
        let Interface { sides, last, tint, close, next, .. } = found;
        // Of equal solids in one place one surface is there, for which the first one stands.
        let mut has_own = self.differ(sides);
        while !next.is_miss() {
            let at = self.located::<P>(ray, *next, last);
            if (last.point - at.point).dot(last.normal) > last.depth {
                return;
            }
            let shape = self.shape(next);
            let through = self.appearance.class(shape).transparency;
            let Some(through) = through.filter(|_| shape.light.is_none()) else {
                sides.beyond = sides.before;
                return;
            };
            if through.kt == 0.0 || shape.solid.is_none() {
                *close = Some(*next);
                return;
            }
            let own = self.sides(sides.beyond, shape, at.leaves, &mut traversal.media);
            if self.differ(&own) {
                *tint *= if has_own { through.color * through.kt } else { Vec3::ONE };
                has_own = true;
            }
            (sides.beyond, *last) = (own.beyond, at);
            *next = self.crossed::<P>(ray, last, traversal).1;
        }
    }

    /// What `ray` crosses where it meets a surface, if it does not only touch it: of the triangles of
    /// a shape around an edge or a corner, the one that counts. And what it meets behind, if that is close; else a miss.
    fn crossed<P: Arithmetic>(
        &self,
        ray: &Ray,
        at: &InterfaceHit,
        traversal: &mut Traversal,
    ) -> (Option<Hit>, Hit) {
        let InterfaceHit { hit, depth, leaves, .. } = *at;
        let cosine = Vector::from(ray.direction).dot(at.normal).abs();
        let end = hit.t + depth / max(cosine, LEAST_COSINE);
        let near =
            Ray { t_min: hit.t.next_down(), t_max: max(end, hit.t.next_up()).next_up(), ..*ray };
        let search = self.accel.search::<P>();
        // Nearly always nothing else is near, which filters can tell in a range that is longer by more than they err.
        let more = FILTERED * depth + hit.t * FILTERED_SHARE;
        let longer = Ray { t_min: hit.t - more, t_max: end + more, ..*ray };
        if self.accel.geometry().instances.is_empty() && search.crosses_one(&longer, traversal) {
            return (Some(hit), Hit::MISS);
        }
        let mut crossings = std::mem::take(&mut traversal.crossed);
        search.crossings(&near, traversal, &mut crossings);
        let instanced = search.closest_instanced(&near, traversal);
        let hits = crossings.with(instanced);
        let is_hit = |other: &Hit| *other == hit;
        // A ball may be crossed twice at one rounded t.
        let index =
            if leaves { hits.iter().rposition(is_hit) } else { hits.iter().position(is_hit) };
        let shape = self.appearance.shape_of(hit.primitive);
        let index = index.or_else(|| {
            hits.iter().position(|other| {
                other.t == hit.t && self.appearance.shape_of(other.primitive) == shape
            })
        });
        let behind = index.map_or_else(
            || hits.iter().position(|other| other.t >= hit.t).unwrap_or(hits.len()),
            |index| index + 1,
        );
        let found =
            (index.map(|index| hits[index]), hits.get(behind).copied().unwrap_or(Hit::MISS));
        traversal.crossed = crossings;
        found
    }

    /// The position of a hit that `ray` has behind `before`.
    fn located<P: Arithmetic>(&self, ray: &Ray, hit: Hit, before: &InterfaceHit) -> InterfaceHit {
        let (SurfacePoint { point, error, normal, .. }, leaves) = self.surface_of::<P>(ray, &hit);
        let depth = close_depth(error.element_sum());
        let is_behind = normal.dot(ray.direction.into()) > 0.0;
        let normal = if is_behind { -normal } else { normal };
        // The two sides of a ball may have one rounded t.
        let leaves = leaves || hit.primitive == before.hit.primitive;
        InterfaceHit { hit, point, depth, error, normal, leaves }
    }

    fn shape(&self, hit: &Hit) -> &Shape {
        &self.appearance.shapes[self.appearance.shape_of(hit.primitive)]
    }
}
