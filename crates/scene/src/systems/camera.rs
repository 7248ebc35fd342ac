//! The camera: from the view and its lens to a ray generator.

use glam::DVec3;
use hecs::World;

use super::missing;
use crate::components::{CameraKey, CameraPath, ThinLens, View};
use wavecrest_base::error::Result;
use wavecrest_core::kernels::camera::path::{Key, Path};
use wavecrest_core::kernels::camera::{Camera, Lens, Placement};
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::plan::schedule::{Schedule, Step};

/// A pinhole as a lens.
const PINHOLE: Lens = Lens { radius: 0.0, focal: 1.0, sampling: Sampling::Random, grid: [1, 1] };

/// The camera of the world, moved by `-origin`. A lens of aperture 0 is a pinhole, to the last bit.
pub fn run(world: &World, origin: DVec3, schedule: Schedule) -> Result<Camera> {
    let mut query = world.query::<(&View, Option<&ThinLens>)>();
    let (view, lens) = query.iter().next().ok_or_else(|| missing("View"))?;
    let placement = Placement {
        location: view.location - origin,
        look: view.look - origin,
        up: view.up,
        fov_degrees: view.fov_degrees,
        fov_axis: view.fov_axis,
        size: [view.width, view.height],
    };
    let lens = schedule.runs(Step::Lens).then(|| lens.map_or(PINHOLE, of_extent));
    let antialias = if schedule.runs(Step::Jitter) { view.antialias } else { 1 };
    Ok(Camera::new(&placement, antialias, view.sampling, lens))
}

/// The path of the world's camera, moved by `-origin`, if it has one.
pub fn path(world: &World, origin: DVec3, schedule: Schedule) -> Option<Path> {
    let mut query = world.query::<(&View, Option<&ThinLens>, &CameraPath)>();
    let (view, lens, path) = query.iter().next()?;
    let key = |key: &CameraKey| Key {
        frame: key.frame,
        placement: Placement {
            location: key.location - origin,
            look: key.look - origin,
            up: key.up,
            fov_degrees: key.fov_degrees,
            fov_axis: view.fov_axis,
            size: [view.width, view.height],
        },
        focal: key.focal as f32,
    };
    let keys = path.keys.iter().map(key).collect();
    let lens = schedule.runs(Step::Lens).then(|| lens.map_or(PINHOLE, of_extent));
    let antialias = if schedule.runs(Step::Jitter) { view.antialias } else { 1 };
    Some(Path::new(keys, path.interpolation, (antialias, view.sampling), lens))
}

/// The radius of a lens, as rays are made with it.
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
