//! Lights: points on them, and their falloff.

mod distant;
mod spot;

use std::f32::consts::PI;

use glam::{DAffine3, DVec3, Vec3};

pub use distant::Distant;
pub use spot::Cone;

use super::slab::Aabb;
use super::{Disk, triangle};
use crate::math::float::{dot_f64, max, max_abs};
use crate::math::sampling::{self, Draw, Sampling};
use crate::math::{Mask, Real, Single, Stream, Vector};

wavecrest_base::choices! {
    /// How the strength of a light falls with the distance d to it.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Falloff {
        /// 1 / (4 pi d).
        #[default]
        Linear = "linear",
        /// 1 / (4 pi d^2).
        InverseSquare = "inverse-square",
        /// 1 at every distance.
        None = "none",
    }
}

impl Falloff {
    /// The factor at `distance` > 0.
    #[inline(always)]
    pub fn at<F: Single>(self, distance: F) -> F {
        let (one, around) = (distance.same(1.0), distance.same(4.0 * PI));
        match self {
            Self::Linear => one / (around * distance),
            Self::InverseSquare => one / (around * distance * distance),
            Self::None => one,
        }
    }
}

wavecrest_base::choices! {
    /// Kinds of emitters, by the name of such a light.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum EmitterKind {
        /// Shines from a point in all directions.
        Point = "point light",
        /// Shines from a point within a cone.
        Spot = "spot light",
        /// Is infinitely far away.
        Directional = "directional light",
        /// Has a shape.
        Area = "area light",
        /// Is all around.
        Sky = "sky",
    }
}

/// The source of a light.
#[derive(Clone, Debug, PartialEq)]
pub enum Emitter {
    /// A point.
    Point(Vec3),
    /// A point with a cone.
    Spot(Vec3, Cone),
    /// A source infinitely far away.
    Distant(Distant),
    /// A sphere.
    Sphere {
        /// Its centre.
        center: Vec3,
        /// Its radius.
        radius: f32,
    },
    /// A disk, and the axes in its plane.
    Disk(Disk, [DVec3; 2]),
    /// Triangles, of a quad or of a mesh.
    Triangles(Triangles),
    /// Ambient light from all around, as far as nothing nearer than this distance is in its way.
    Around(f32),
}

/// Triangles whose points are chosen uniformly by area.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangles {
    corners: Vec<[Vec3; 3]>,
    /// Unit normals; zero for triangles without area, which are never chosen.
    normals: Vec<Vec3>,
    /// For each triangle, the cumulative share of the area up to and including it. The last is 1.
    cumulative: Vec<f32>,
}

impl Triangles {
    /// The triangles with these corners, or `None` if they have no area.
    pub fn new(corners: Vec<[Vec3; 3]>) -> Option<Self> {
        let mut total = 0.0;
        let up_to = |[a, b, c]: &[Vec3; 3]| {
            let cross = (b - a).as_dvec3().cross((c - a).as_dvec3());
            total += 0.5 * dot_f64(cross, cross).sqrt();
            total
        };
        let sums: Vec<f64> = corners.iter().map(up_to).collect();
        let cumulative = sums.iter().map(|sum| (sum / total) as f32).collect();
        let normals = corners.iter().map(|c| triangle::normal(c).as_vec3()).collect();
        (total > 0.0 && total.is_finite()).then_some(Self { corners, normals, cumulative })
    }

    /// The points for points of the unit square: x chooses the triangle and, rescaled, a point on it.
    #[inline(always)]
    fn points<F: Single>(&self, [x, y]: [F; 2]) -> LightPoint<F> {
        let token = x.token();
        let mut points = LightPoint::of(Vector::splat(token, Vec3::ZERO));
        let mut left = x.ge(x.zero());
        // For each triangle that a lane has chosen: few, where neighbouring samples have neighbouring points.
        while left.any() {
            let lane = left.bits().trailing_zeros() as usize;
            let chosen = x.lane(lane);
            let last = self.corners.len() - 1;
            let index = self.cumulative.partition_point(|&end| end <= chosen).min(last);
            let start = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
            let share = (self.cumulative[index] - start).max(f32::MIN_POSITIVE);
            let here = left & x.ge(x.same(start)) & x.lt(x.same(self.cumulative[index]));
            let within = ((x - x.same(start)) / x.same(share)).max(x.zero()).min(x.same(1.0));
            let point = self.point_of(index, [within, y]);
            points = LightPoint::select(here, point, points);
            left = left & !here & !F::mask(token, 1 << lane);
        }
        points
    }

    /// The points of a triangle for points of the unit square.
    #[inline(always)]
    fn point_of<F: Single>(&self, index: usize, square: [F; 2]) -> LightPoint<F> {
        let [second, third] = sampling::triangle(square);
        let (second, third) = (second.widen(), third.widen());
        let [a, b, c] = self.corners[index];
        let size = max(max_abs(a), max(max_abs(b), max_abs(c)));
        let [a, b, c] = [a, b, c].map(|v| v.as_dvec3());
        let (ab, ac) = (Vector::alike(second, b - a), Vector::alike(second, c - a));
        let position = Vector::alike(second, a) + ab.scale(second) + ac.scale(third);
        LightPoint::new(position, size, Vector::splat(square[0].token(), self.normals[index]))
    }
}

impl Emitter {
    /// The single point of the light, as in [`LightPoint::position`], or `None` for lights with
    /// more.
    #[inline(always)]
    pub fn only_point(&self) -> Option<Vec3> {
        match self {
            Self::Point(position) | Self::Spot(position, _) => Some(*position),
            Self::Distant(distant) if distant.is_parallel() => Some(distant.middle()),
            _ => None,
        }
    }

    /// Moves a source without a shape; a cone keeps its direction.
    pub fn moved(&mut self, by: &DAffine3) {
        match self {
            Self::Point(position) | Self::Spot(position, _) => {
                *position = by.transform_point3(position.as_dvec3()).as_vec3();
            }
            Self::Distant(distant) => distant.turn(&by.matrix3),
            _ => {}
        }
    }

    /// Whether the source is infinitely far away.
    #[inline(always)]
    pub fn is_distant(&self) -> bool {
        matches!(self, Self::Distant(_))
    }

    /// Of ambient light, the distance within which something may be in its way.
    #[inline(always)]
    pub fn ambient_reach(&self) -> Option<f32> {
        match self {
            Self::Around(reach) => Some(*reach),
            _ => None,
        }
    }

    /// The cone outside of which it is dark.
    #[inline(always)]
    pub fn cone(&self) -> Option<&Cone> {
        match self {
            Self::Spot(_, cone) => Some(cone),
            _ => None,
        }
    }

    /// Its kind.
    pub fn kind(&self) -> EmitterKind {
        match self {
            Self::Point(_) => EmitterKind::Point,
            Self::Spot(..) => EmitterKind::Spot,
            Self::Distant(_) => EmitterKind::Directional,
            Self::Sphere { .. } | Self::Disk(..) | Self::Triangles(_) => EmitterKind::Area,
            Self::Around(_) => EmitterKind::Sky,
        }
    }

    /// The middle of a box, half of its sides, and a distance from it, within which all of the source is.
    /// Sources without a position are on the unit sphere of directions to them.
    pub fn extent(&self) -> (DVec3, DVec3, f64) {
        let round = |center: Vec3, radius: f32| (center.as_dvec3(), DVec3::ZERO, radius.into());
        match self {
            Self::Point(position) | Self::Spot(position, _) => round(*position, 0.0),
            Self::Distant(distant) => (distant.towards(), DVec3::ZERO, distant.spread()),
            Self::Sphere { center, radius } | Self::Disk(Disk { center, radius, .. }, _) => {
                round(*center, *radius)
            }
            Self::Around(_) => round(Vec3::ZERO, 2.0),
            Self::Triangles(triangles) => {
                let corners = triangles.corners.iter().map(|corners| Aabb::around(*corners));
                let Aabb { low, high } = corners.fold(Aabb::EMPTY, Aabb::union);
                let (low, high) = (low.as_dvec3(), high.as_dvec3());
                ((low + high) / 2.0, (high - low) / 2.0, 0.0)
            }
        }
    }
}

/// A point of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint<F> {
    /// In world space; for distant lights, a vector from any point towards the light. For light from
    /// all around, a point of the unit sphere: with the normal added, directions to it are spread
    /// by their cosine with the normal.
    pub position: Vector<F>,
    /// Bound on the distance of `position` to the exact shape, for each coordinate.
    pub error: Vector<F>,
    /// Unit normal of the shape; zero for point lights.
    pub normal: Vector<F>,
}

impl<F: Single> LightPoint<F> {
    /// The points of lights without a shape.
    #[inline(always)]
    fn of(position: Vector<F>) -> Self {
        let zero = Vector::splat(position.x.token(), Vec3::ZERO);
        Self { position, error: zero, normal: zero }
    }

    /// The points at `position`, computed from coordinates up to `size`.
    #[inline(always)]
    fn new(position: Vector<F::Double>, size: f32, normal: Vector<F>) -> Self {
        let position = Vector::<F>::narrow(position);
        Self { position, error: position.rounding_error(position.x.same(size)), normal }
    }

    /// `a` in the lanes of `mask`, `b` in the others.
    #[inline(always)]
    fn select(mask: F::Mask, a: Self, b: Self) -> Self {
        Self {
            position: Vector::select(mask, a.position, b.position),
            error: Vector::select(mask, a.error, b.error),
            normal: Vector::select(mask, a.normal, b.normal),
        }
    }
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The source.
    pub emitter: Emitter,
    /// Intensity times colour, linear. Of light from all around, 1 in channels that may have any.
    pub power: Vec3,
    /// Falloff with distance.
    pub falloff: Falloff,
    /// Distribution of its sample points.
    pub sampling: Sampling,
    /// Columns and rows of the grid of sample points; their product is the number of points.
    pub grid: [u32; 2],
    /// The first [`Stream`] dimension of its points, which use one dimension each.
    pub dimension: u32,
}

impl Light {
    /// The factor on its light at `distance` > 0, where `towards` points to the light.
    #[inline(always)]
    pub fn share_at<F: Single>(&self, distance: F, towards: Vector<F>) -> F {
        let part = self.falloff.at(distance);
        match self.emitter.cone() {
            Some(cone) => part * cone.at(towards),
            None => part,
        }
    }

    /// Number of points, and so of shadow rays for each lit hit.
    #[inline]
    pub fn samples(&self) -> u32 {
        self.grid[0] * self.grid[1]
    }

    /// Whether its points use random numbers.
    #[inline]
    pub fn is_sampled(&self) -> bool {
        self.emitter.only_point().is_none()
    }

    /// Its `index`th point, for the pixel and the sample of each lane.
    #[inline(always)]
    pub fn points<F: Single>(
        &self,
        token: F::Token,
        index: u32,
        stream: Stream,
        streams: [&[u32]; 2],
    ) -> LightPoint<F> {
        if let Some(position) = self.emitter.only_point() {
            return LightPoint::of(Vector::splat(token, position));
        }
        let Self { dimension, grid, .. } = *self;
        let draw = Draw { dimension: dimension + index, first: 0, scramble: dimension, grid };
        // All samples of the pixel share one sequence, so that few points for each sample do as
        // well as many.
        let number = |sample: u32| sample.wrapping_mul(self.samples()).wrapping_add(index);
        let index = |sample| (index, number(sample));
        self.at(self.sampling.points(token, stream, streams, draw, index))
    }

    /// Its `index`th point.
    #[inline(always)]
    pub fn point(&self, index: u32, stream: &Stream) -> LightPoint<f32> {
        self.points((), index, *stream, [&[stream.pixel], &[stream.sample]])
    }

    /// Its points at points of the unit square.
    #[inline(always)]
    fn at<F: Single>(&self, square: [F; 2]) -> LightPoint<F> {
        let token = square[0].token();
        match &self.emitter {
            Emitter::Point(position) | Emitter::Spot(position, _) => {
                LightPoint::of(Vector::splat(token, *position))
            }
            Emitter::Distant(distant) => LightPoint::of(distant.at(square)),
            Emitter::Sphere { center, radius } => {
                let normal = sampling::sphere(square);
                // Normalised again: a length that is not quite 1 would move the point off the
                // sphere.
                let outward = normal.widen().normalize_wide();
                let out = outward.scale(outward.x.same(f64::from(*radius)));
                let position = Vector::alike(out.x, center.as_dvec3()) + out;
                LightPoint::new(position, max(max_abs(*center), *radius), normal)
            }
            Emitter::Disk(Disk { center, normal, radius }, [x, y]) => {
                let [across, along] = sampling::disk(square);
                let (across, along) = (across.widen(), along.widen());
                let offset = Vector::alike(across, *x).scale(across)
                    + Vector::alike(across, *y).scale(along);
                let offset = offset.scale(across.same(f64::from(*radius)));
                let position = Vector::alike(across, center.as_dvec3()) + offset;
                let normal = Vector::splat(token, *normal);
                LightPoint::new(position, max(max_abs(*center), *radius), normal)
            }
            Emitter::Triangles(triangles) => triangles.points(square),
            Emitter::Around(..) => LightPoint::of(sampling::sphere(square)),
        }
    }
}

#[cfg(test)]
mod tests;
