//! The camera: from the view and its lens to a ray generator.

use glam::DVec3;
use hecs::World;

use super::bounds::wide;
use crate::components::{CameraKey, CameraPath, ThinLens, View};
use crate::query::missing;
use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::camera::path::{Keyframe, Path};
use wavecrest_core::kernels::camera::{Camera, Lens, Placement};
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::plan::schedule::{Schedule, Step};

/// A pinhole as a lens.
const PINHOLE: Lens = Lens { radius: 0.0, focal: 1.0, sampling: Sampling::Random, grid: [1, 1] };

/// Largest number of frames that are checked one by one.
const MOST_FRAMES: u32 = 1 << 12;

/// The camera in every frame of its path, and at its own position; empty if there are too many.
pub(super) fn frames_of(camera: &Camera, path: Option<&Path>) -> Vec<Camera> {
    let Some(path) = path else { return vec![*camera] };
    let (first, last) = path.frames().into_inner();
    if last - first >= MOST_FRAMES {
        return Vec::new();
    }
    (first..=last).filter_map(|frame| path.at(frame)).chain([*camera]).collect()
}

/// The camera of the world, moved by `-origin`, and its path if it has one; without a schedule with its lens, but
/// not antialiased. A lens of aperture 0 is a pinhole, to the last bit.
pub(crate) fn run(
    world: &World,
    origin: DVec3,
    schedule: Option<Schedule>,
) -> Result<(Camera, Option<Path>)> {
    let lens_runs = schedule.is_none_or(|schedule| schedule.runs(Step::Lens));
    let jitter_runs = schedule.is_some_and(|schedule| schedule.runs(Step::Jitter));
    let mut query = world.query::<(&View, Option<&ThinLens>, Option<&CameraPath>)>();
    let (view, lens, path) = query.iter().next().ok_or_else(|| missing("View"))?;
    let lens = lens_runs.then(|| lens.map_or(PINHOLE, of_extent));
    let antialias = if jitter_runs { view.antialias } else { 1 };
    let placement = |view: &View| {
        let (location, look) = (view.location - origin, view.look - origin);
        Placement { location, look, ..view.placement() }
    };
    let key = |&CameraKey { frame, location, look, up, fov_degrees, focal }: &CameraKey| {
        let placement = placement(&View { location, look, up, fov_degrees, ..*view });
        Keyframe { frame, placement, focal: focal as f32 }
    };
    let camera = Camera::new(&placement(view), antialias, view.sampling, lens);
    let path = path.map(|CameraPath { keys, interpolation }| {
        Path::new(keys.iter().map(key).collect(), *interpolation, camera)
    });
    Ok((camera, path))
}

/// The least distance of anything from the middle of a pupil; 0 with instances, and in doubt.
fn nearest(cameras: &[Camera], geometry: &Geometry) -> f64 {
    if !geometry.instances.is_empty() {
        return 0.0;
    }
    let distance = |number: u32| {
        let [low, high] = wide(geometry.bounds(number));
        let pupils = cameras.iter().map(|camera| camera.pupil().0);
        let away = pupils.map(|pupil| (low - pupil).max(pupil - high).max(DVec3::ZERO).length());
        away.fold(f64::INFINITY, f64::min)
    };
    parallel::reduce(geometry.own(), f64::INFINITY, |i| distance(i as u32), f64::min)
}

/// The least side of a pixel around what is seen, and the widest blur by a lens in pixels, in all frames;
/// in doubt 0 and infinite.
pub(crate) fn resolution(cameras: &[Camera], geometry: &Geometry) -> (f64, f64) {
    let nearest = nearest(cameras, geometry);
    let of = |camera: &Camera| camera.resolution(nearest);
    let least = |(a, b): (f64, f64), (c, d): (f64, f64)| (a.min(c), b.max(d));
    cameras.iter().map(of).reduce(least).filter(|_| nearest > 0.0).unwrap_or((0.0, f64::INFINITY))
}

/// The radius of a lens in single precision, as for rays.
pub(super) fn radius(lens: &ThinLens) -> f32 {
    (lens.aperture / 2.0) as f32
}

fn of_extent(lens: &ThinLens) -> Lens {
    let radius = radius(lens);
    if radius == 0.0 {
        return PINHOLE;
    }
    let grid = [lens.samples_x, lens.samples_y];
    Lens { radius, focal: lens.focal as f32, sampling: lens.sampling, grid }
}
