//! What a file lacks that is no whole scene: a camera that sees all of it, a light, the rest.
//!
//! A standalone mesh has none of these, a glTF file perhaps some. What is chosen is reported, and
//! `wavecrest convert` writes it down to be changed.

use std::path::Path;

use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

use wavecrest_base::error::Result;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::math::sampling::Sampling;

use crate::components::{Falloff, FovAxis, PointLight, Settings, View};
use crate::corners::direction;
use crate::load::LoadOptions;
use crate::parse;

/// Width of the image in pixels, where nothing is said of it; the height for one that is upright.
const LONGER_SIDE: u32 = 1024;
/// Its width by its height.
const ASPECT: f64 = 4.0 / 3.0;
/// Rays along each side of a pixel.
const ANTIALIAS: u32 = 2;
/// Mirror bounces: after four, little is left of what is mirrored.
const BOUNCES: u32 = 4;
/// What rays that hit nothing show: a dark grey, before which black and white surfaces both are seen.
const BACKGROUND: DVec3 = DVec3::splat(0.05);
/// The ambient part of all lights together, as in scene files that have one light.
const AMBIENT: f64 = 0.08;
/// Full angle of the camera that is put where a file has none, in degrees.
const FOV_DEGREES: f64 = 40.0;
/// Where that camera stands, as seen from the middle: in front, above and a little to the right.
const CAMERA_SIDE: DVec3 = DVec3::new(0.5, 0.4, 1.0);
/// What the light that is put where a file has none adds to a white surface that faces it.
const LIGHT: f64 = 0.92;
/// Where that light comes from, to the right, up and back as the camera has it: over its left shoulder.
const LIGHT_SIDE: DVec3 = DVec3::new(-0.6, 0.9, 1.0);
/// How far away it is, in radii.
const LIGHT_DISTANCE: f64 = 100.0;

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

/// Width and height of the image: what is asked for; else as the `aspect` is, width by height, or 4 by 3.
///
/// # Errors
/// Where what is asked for is too large, or nothing.
pub(crate) fn size(options: &LoadOptions, aspect: Option<f64>) -> Result<(u32, u32)> {
    let aspect = aspect.unwrap_or(ASPECT);
    let most = f64::from(parse::LONGEST_SIDE);
    // Within the bounds of a side, so that the conversion is exact.
    let side = |length: f64| length.round().clamp(1.0, most) as u32;
    let longer = f64::from(LONGER_SIDE);
    let (width, height) = match (options.width, options.height) {
        (Some(width), Some(height)) => (width, height),
        (Some(width), None) => (width, side(f64::from(width) / aspect)),
        (None, Some(height)) => (side(f64::from(height) * aspect), height),
        (None, None) => (side(longer * aspect.min(1.0)), side(longer / aspect.max(1.0))),
    };
    parse::check_size(width, height)?;
    Ok((width, height))
}

/// Rays of each pixel.
pub(crate) fn rays_per_pixel() -> u64 {
    u64::from(ANTIALIAS).pow(2)
}

/// A view of this size whose place is yet to be found.
pub(crate) fn view(width: u32, height: u32) -> View {
    View {
        location: DVec3::Z,
        look: DVec3::ZERO,
        up: DVec3::Y,
        fov_degrees: FOV_DEGREES,
        fov_axis: FovAxis::Smaller,
        width,
        height,
        antialias: ANTIALIAS,
        sampling: Sampling::Jittered,
    }
}

/// A view of all that there is, with +y upward.
///
/// # Errors
/// As [`size`].
pub(crate) fn framed(bounds: &Sphere, options: &LoadOptions) -> Result<View> {
    let (width, height) = size(options, None)?;
    let half = (FOV_DEGREES / 2.0).to_radians();
    // The sphere touches the sides of what is seen.
    let location = bounds.outside(CAMERA_SIDE.normalize(), 1.0 / libm::sin(half));
    Ok(View { location, look: bounds.center, ..view(width, height) })
}

/// A light for what the camera sees.
pub(crate) fn light(view: &View, bounds: &Sphere) -> PointLight {
    let back = direction(view.location - view.look).unwrap_or(DVec3::Z);
    let right = direction(view.up.cross(back)).unwrap_or(DVec3::X);
    let up = back.cross(right);
    let side = right * LIGHT_SIDE.x + up * LIGHT_SIDE.y + back * LIGHT_SIDE.z;
    PointLight {
        intensity: LIGHT,
        position: bounds.outside(side.normalize(), LIGHT_DISTANCE),
        color: DVec3::ONE,
        falloff: Falloff::None,
    }
}

/// The rest, for a scene of so many lights.
pub(crate) fn settings(file: &Path, lights: usize) -> Settings {
    Settings {
        file: file.to_owned(),
        bounces: BOUNCES,
        background: BACKGROUND,
        // Each light adds it.
        ambient: AMBIENT / lights.max(1) as f64,
    }
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

    #[test]
    fn one_side_of_the_image_follows_from_the_other() {
        let asked = |width, height, aspect| {
            size(&LoadOptions { width, height, ..LoadOptions::default() }, aspect)
        };
        assert_eq!(asked(None, None, None).unwrap(), (1024, 768));
        assert_eq!(asked(None, None, Some(0.5)).unwrap(), (512, 1024));
        assert_eq!(asked(Some(200), None, Some(2.0)).unwrap(), (200, 100));
        assert_eq!(asked(None, Some(300), None).unwrap(), (400, 300));
        assert_eq!(asked(Some(7), Some(9), Some(2.0)).unwrap(), (7, 9));
        assert_eq!(asked(None, Some(9), Some(1e30)).unwrap(), (65_536, 9));
        assert!(asked(Some(0), None, None).is_err() && asked(Some(70_000), None, None).is_err());
        assert!(asked(Some(65_536), Some(65_536), None).is_err());
    }
}
