//! What a file lacks that is no whole scene: a camera that sees all of it, a light, the rest.
//!
//! A standalone mesh has none of these, a glTF file perhaps some. What is chosen is reported, and
//! `wavecrest convert` writes it down to be changed.

mod camera;
mod light;

use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

use wavecrest_core::math::float::MAX_COORDINATE;

pub(crate) use camera::{framed, rays_per_pixel, size, view};
pub(crate) use light::{light, settings};

/// A sphere about all that there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sphere {
    pub(crate) center: DVec3,
    /// Above 0.
    pub(crate) radius: f64,
}

impl Sphere {
    /// A point that lies in a direction, of unit length, so many radii from the centre.
    pub(crate) fn outside(&self, direction: DVec3, radii: f64) -> DVec3 {
        let greatest = f64::from(MAX_COORDINATE);
        (self.center + direction * (self.radius * radii))
            .clamp(DVec3::splat(-greatest), DVec3::splat(greatest))
    }
}

/// Points and where they are: what a sphere is put about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) points: &'a [Vec3],
    pub(crate) world: DAffine3,
}

/// The sphere about the middle of the box about all points. Without any it is that of radius 1 about the
/// origin.
pub(crate) fn bounds(all: &[Placed<'_>]) -> Sphere {
    let boxes = all.iter().filter(|placed| !placed.points.is_empty()).map(|placed| {
        let point = |p: &Vec3| placed.world.transform_point3(p.as_dvec3());
        let points = placed.points.par_iter().map(point).map(|p| (p, p));
        points.reduce(|| EMPTY, |a, b| (a.0.min(b.0), a.1.max(b.1)))
    });
    let (low, high) = boxes.fold(EMPTY, |a, b| (a.0.min(b.0), a.1.max(b.1)));
    if !(low.is_finite() && high.is_finite()) {
        return Sphere { center: DVec3::ZERO, radius: 1.0 };
    }
    let center = (low + high) / 2.0;
    let farthest = |placed: &Placed<'_>| {
        let distance = |p: &Vec3| placed.world.transform_point3(p.as_dvec3()).distance(center);
        placed.points.par_iter().map(distance).reduce(|| 0.0, f64::max)
    };
    let radius = all.iter().map(farthest).fold(0.0, f64::max);
    // A single point has none; seen from one unit away it is a point still.
    Sphere { center, radius: if radius > 0.0 { radius } else { 1.0 } }
}

/// The box of nothing.
const EMPTY: (DVec3, DVec3) = (DVec3::INFINITY, DVec3::NEG_INFINITY);

/// The eight corners of the box about some points; none of no points.
pub(crate) fn corners(points: &[Vec3]) -> Vec<Vec3> {
    if points.is_empty() {
        return Vec::new();
    }
    let bounds = points.par_iter().map(|p| (*p, *p));
    let least = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = bounds.reduce(|| least, |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let side = |i: u32, axis: u32| i >> axis & 1 == 1;
    (0..8).map(|i| Vec3::select([side(i, 0), side(i, 1), side(i, 2)].into(), high, low)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sphere_is_about_all_points_where_they_are() {
        let points = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y, Vec3::Z];
        let moved = Placed { points: &points, world: DAffine3::from_translation(DVec3::X * 10.0) };
        let still = Placed { points: &points, world: DAffine3::IDENTITY };
        let sphere = bounds(&[still, moved]);
        assert_eq!(sphere.center, DVec3::new(6.0, 0.5, 0.5));
        assert!((sphere.radius - 36.5_f64.sqrt()).abs() < 1e-12, "{}", sphere.radius);
        assert_eq!(bounds(&[]), Sphere { center: DVec3::ZERO, radius: 1.0 });
        assert_eq!(corners(&points).len(), 8);
    }
}
