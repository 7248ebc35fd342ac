//! The light that is put where a file has none, and what else holds for all of its scene.

use std::path::Path;

use glam::DVec3;

use super::Sphere;
use crate::components::{Falloff, PointLight, Settings, View};
use crate::corners::direction;

/// Mirror bounces: after four, little is left of what is mirrored.
const BOUNCES: u32 = 4;
/// What rays that hit nothing show: a dark grey, before which black and white surfaces both are seen.
const BACKGROUND: DVec3 = DVec3::splat(0.05);
/// The ambient part of all lights together, as in scene files that have one light.
const AMBIENT: f64 = 0.08;
/// What the light that is put where a file has none adds to a white surface that faces it.
const LIGHT: f64 = 0.92;
/// Where that light comes from, to the right, up and back as the camera has it: over its left shoulder.
const LIGHT_SIDE: DVec3 = DVec3::new(-0.6, 0.9, 1.0);
/// Where it is in a room: above what is looked at, as a share of the way there.
const ROOM_LIGHT_HEIGHT: f64 = 0.2;
/// How far away it is, in radii.
const LIGHT_DISTANCE: f64 = 100.0;

/// A light for what the camera sees: far away, or over its head where it stands within a room.
pub(crate) fn light(view: &View, bounds: &Sphere, inside: bool) -> PointLight {
    let back = direction(view.location - view.look).unwrap_or(DVec3::Z);
    let right = direction(view.up.cross(back)).unwrap_or(DVec3::X);
    let up = back.cross(right);
    let side = right * LIGHT_SIDE.x + up * LIGHT_SIDE.y + back * LIGHT_SIDE.z;
    let position = match inside {
        true => view.look + up * (ROOM_LIGHT_HEIGHT * view.location.distance(view.look)),
        false => bounds.outside(side.normalize(), LIGHT_DISTANCE),
    };
    PointLight { intensity: LIGHT, position, color: DVec3::ONE, falloff: Falloff::None }
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
