//! Completes files that are not whole scenes: adds a camera that sees everything, lights, and
//! settings.
//!
//! A standalone mesh has none of these, a glTF file may have some. The choices are reported, and
//! `wavecrest convert` writes them to a scene file, in which they can be changed.

mod camera;
mod fit;
mod grid;
mod ground;
mod light;
mod orbit;
mod room;
mod upward;

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

pub(crate) use camera::{Framed, framed, rays_per_pixel, size, view};
pub(crate) use ground::GROUND;
pub(crate) use light::{MOST_LAMPS, Subject, light, samples, settings};
pub(crate) use upward::Upward;

/// A bounding sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sphere {
    pub(crate) center: DVec3,
    /// Above 0.
    pub(crate) radius: f64,
}

/// Visible geometry and its transform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) points: &'a [Vec3],
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) world: DAffine3,
    /// Whether all points are visible: those that no triangle uses are not. Without triangles all
    /// count.
    pub(crate) shows_all: bool,
}

impl<'a> Placed<'a> {
    pub(crate) fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]], world: DAffine3) -> Self {
        Self { points, triangles, world, shows_all: uses_all(points.len(), triangles) }
    }

    /// Reduces the results of `of` for each visible point by `merge`, in any order.
    fn reduce<T: Copy + Send + Sync>(
        &self,
        none: T,
        of: impl Fn(DVec3) -> T + Sync,
        merge: impl Fn(T, T) -> T + Sync + Send,
    ) -> T {
        // Blocks, because a reduction of single points calls its functions for each.
        const BLOCK: usize = 1 << 12;
        let point = |p: &Vec3| of(self.world.transform_point3(p.as_dvec3()));
        if self.shows_all {
            let block = |points: &[Vec3]| points.iter().map(point).fold(none, &merge);
            return self.points.par_chunks(BLOCK).map(block).reduce(|| none, &merge);
        }
        let corner = |i: &u32| point(&self.points[*i as usize]);
        let block =
            |corners: &[[u32; 3]]| corners.as_flattened().iter().map(corner).fold(none, &merge);
        self.triangles.par_chunks(BLOCK).map(block).reduce(|| none, &merge)
    }
}

/// Whether each of `points` is a corner of a triangle, or there are no triangles.
fn uses_all(points: usize, triangles: &[[u32; 3]]) -> bool {
    if triangles.is_empty() {
        return true;
    }
    let used: Vec<AtomicU64> = (0..points.div_ceil(64)).map(|_| AtomicU64::new(0)).collect();
    triangles.as_flattened().par_iter().for_each(|&point| {
        let (word, bit) = (&used[point as usize / 64], 1 << (point % 64));
        // A read is cheaper, and most corners are not the first at their point.
        if word.load(Ordering::Relaxed) & bit == 0 {
            word.fetch_or(bit, Ordering::Relaxed);
        }
    });
    let count = |word: AtomicU64| word.into_inner().count_ones() as usize;
    used.into_iter().map(count).sum::<usize>() == points
}

/// The box around all points; its ends are infinite if there are none.
fn extent(all: &[Placed<'_>]) -> (DVec3, DVec3) {
    let merge = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
    all.iter().map(|placed| placed.reduce(EMPTY, |p| (p, p), merge)).fold(EMPTY, merge)
}

/// The sphere around the centre of the box around all points. Without points, radius 1 around the
/// origin.
pub(crate) fn bounds(all: &[Placed<'_>]) -> Sphere {
    let (low, high) = extent(all);
    if !(low.is_finite() && high.is_finite()) {
        return Sphere { center: DVec3::ZERO, radius: 1.0 };
    }
    let center = (low + high) / 2.0;
    let farthest =
        |placed: &Placed<'_>| placed.reduce(0.0, |point| point.distance(center), f64::max);
    let radius = all.iter().map(farthest).fold(0.0, f64::max);
    // A single point has no extent; it is seen from one unit away.
    Sphere { center, radius: if radius > 0.0 { radius } else { 1.0 } }
}

/// The empty box.
const EMPTY: (DVec3, DVec3) = (DVec3::INFINITY, DVec3::NEG_INFINITY);

/// The eight corners of the box around some points; empty without points.
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
        let placed = |world| Placed::new(&points, &[], world);
        let moved = placed(DAffine3::from_translation(DVec3::X * 10.0));
        let sphere = bounds(&[placed(DAffine3::IDENTITY), moved]);
        assert_eq!(sphere.center, DVec3::new(6.0, 0.5, 0.5));
        assert!((sphere.radius - 36.5_f64.sqrt()).abs() < 1e-12, "{}", sphere.radius);
        assert_eq!(bounds(&[]), Sphere { center: DVec3::ZERO, radius: 1.0 });
        assert_eq!(corners(&points).len(), 8);
        // A point that no triangle uses is invisible.
        let seen = Placed::new(&points, &[[0, 2, 3]], DAffine3::IDENTITY);
        assert_eq!(bounds(&[seen]).center, DVec3::new(0.0, 0.5, 0.5));
    }
}
