//! The camera: from the view and its lens to a ray generator.

use glam::DVec3;
use hecs::World;

use super::missing;
use crate::error::Result;
use crate::kernels::camera::{Camera, Lens, Placement};
use crate::scene::components::{ThinLens, View};

/// The camera of the world, moved by `-origin`. A lens of aperture 0 is a pinhole, to the last bit.
pub fn run(world: &World, origin: DVec3) -> Result<Camera> {
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
    let lens = lens.filter(|l| l.aperture > 0.0).map(|l| Lens {
        radius: (l.aperture / 2.0) as f32,
        focal: l.focal as f32,
        sampling: l.sampling,
        grid: [l.samples_x, l.samples_y],
    });
    Ok(Camera::new(&placement, view.antialias, view.sampling, lens))
}
