//! The lights of files without any: a key and a rim light infinitely far away, a sky that leans to
//! the other side and so is the fill, and a ground that receives shadows ([`super::ground`]).
//!
//! All lights follow the camera, so that shadows fall to the back and to the right in any view. The
//! lamps are round patches of the sky: their shadows are equally soft at any size of the scene, and
//! the lamps are invisible.

use std::path::Path;

use glam::{DMat3, DVec3};
use hecs::World;

use super::camera::Framed;
use super::follow::Staged;
use super::{Scenery, ground};
use crate::components::{
    Added, AreaLight, DirectionalLight, Encoding, Environment, Falloff, JsonPath, Maps, Mesh,
    Order, PointLight, Sampling, Settings, Sky, TextureRef, Transparency,
};
use crate::corners::{direction, quad_has_area};
use crate::mesh::MeshData;
use crate::options::lighting::{Background, Lighting, Rig};
use crate::query::change;
use crate::scene_file::AMBIENT;
use crate::systems::bounds::Ends;

/// Bounces: after four, little mirrored light is left.
const BOUNCES: u32 = 4;
/// Bounces in files with glass: a ray through a vessel goes through four surfaces, and on through
/// another.
const GLASS_BOUNCES: u32 = 8;
/// Background of files with lights: a dark grey, before which black and white surfaces are both
/// visible.
const DARK: DVec3 = DVec3::splat(0.05);
/// Background of other files: lighter than any light grey surface, but not white.
const LIGHT: DVec3 = DVec3::new(0.86, 0.87, 0.88);

/// The lamps of the studio, with their names. With the sky, they light a white surface that faces the key just to
/// white; a pixel has at least four hits, each of which takes so many shadow rays.
const STUDIO: [(&str, DirectionalLight); 2] = [
    ("the key", lamp([0.84, 0.82, 0.79], [-0.7, 1.0, 0.6], 14.0, 2)),
    ("the rim", lamp([0.2, 0.2, 0.2], [0.35, 0.8, -1.0], 10.0, 1)),
];

/// A lamp of a colour, with the direction to it, to the right, up, and back from the camera, its diameter in degrees, and
/// its number of samples.
const fn lamp(
    color: [f64; 3],
    to_it: [f64; 3],
    angle_degrees: f64,
    samples: u32,
) -> DirectionalLight {
    let (color, direction) = (DVec3::from_array(color), DVec3::from_array(to_it));
    let (intensity, sampling) = (1.0, Sampling::Sobol);
    DirectionalLight { intensity, color, direction, angle_degrees, sampling, samples }
}

/// The largest number of lamps that are added.
pub(crate) const MOST_LAMPS: u32 = STUDIO.len() as u32;

/// The sky of a lit scene, and the light from the ground below it.
const SKY: [DVec3; 2] = [DVec3::new(0.235, 0.25, 0.27), DVec3::new(0.1, 0.095, 0.09)];
/// Rays for each hit that look for what is in the way of its light, and how far they look, as a
/// share of the radius of all that is there. A room has walls all around: only what is near
/// darkens it.
const SKY_SAMPLES: u32 = 2;
const NEAR: f64 = 0.3;
/// Direction of the sky in a studio, to the right, up, and back: it leans to the side that the key
/// leaves dark, and so fills it.
const LEANING: DVec3 = DVec3::new(0.6, 1.0, 0.5);
/// The same for a room: light reflected by its walls.
const ROOM: [DVec3; 2] = [DVec3::splat(0.24), DVec3::splat(0.21)];
/// The light of a room's lamp on a white surface that faces it, at any distance: white walls around
/// stay darker than the lamp.
const CEILING: f64 = 0.53;
/// Shadow rays to it for each hit.
const CEILING_SAMPLES: u32 = 2;
/// The light of the camera's lamp on a white surface that faces it.
const HEADLIGHT: DVec3 = DVec3::splat(0.65);
/// Sine of the largest angle off the vertical of a view from directly above.
const STEEP: f64 = 1e-3;

/// Adds lights to a `world` of a `file` without any, and a ground below its `contents` unless the
/// camera is below it; they can follow it from then on. Returns the other settings, and a description of the choices.
pub(crate) fn light(
    world: &mut World,
    contents: &Scenery<'_>,
    framed: &Framed,
    file: &Path,
    lighting: &Lighting,
) -> (Settings, &'static str) {
    let (settings, told, height) = rig(world, contents, framed, file, lighting);
    let (own, lit) = (framed.clone(), framed.view);
    let staged = Staged { framed: own, lighting: *lighting, lit, ends: contents.ends, height };
    world.spawn((staged,));
    (settings, told)
}

/// As [`light`], without a memory of it; also returns the height of the ground along up.
pub(super) fn rig(
    world: &mut World,
    contents: &Scenery<'_>,
    framed: &Framed,
    file: &Path,
    lighting: &Lighting,
) -> (Settings, &'static str, Option<f64>) {
    let background = lighting.background.map_or(LIGHT, Background::color);
    let distance = Some(contents.sphere.radius * NEAR);
    let under = |world: &mut World, [sky, ground]: [DVec3; 2], up, samples| {
        let sampling = Sampling::Sobol;
        let (sky, ground) = (Some(sky), Some(ground));
        world.spawn((Sky { sky, ground, up, samples, sampling, distance },));
        settings_of(file, background, 0.0)
    };
    match lighting.rig {
        Rig::None => (under(world, [DVec3::ONE; 2], framed.up, 0), "unlit colours", None),
        Rig::Studio => {
            if let Some(corners) = room_lamp(framed, &contents.ends) {
                world.spawn(ceiling(corners));
                let settings = under(world, ROOM, framed.up, SKY_SAMPLES);
                return (settings, "a light under the ceiling is added", None);
            }
            let axes = axes(framed);
            let lamps = STUDIO.map(|(_, lamp)| {
                let direction = -(axes * lamp.direction);
                DirectionalLight { direction, ..lamp }
            });
            let leaning = axes * LEANING;
            // On a transparent background there is nothing to darken.
            let has_ground = lighting.background != Some(Background::Transparent);
            let colors = (background, from_sky(SKY, leaning, framed.up));
            let height = has_ground
                .then(|| ground::spawn(world, contents, framed, &axes, &lamps, colors))
                .flatten();
            for (((name, _), light), order) in STUDIO.into_iter().zip(lamps).zip(0..) {
                world.spawn((Order(order), JsonPath(name.to_owned()), light));
            }
            (
                under(world, SKY, leaning, SKY_SAMPLES),
                "studio lights and a ground are added",
                height,
            )
        }
        Rig::Headlight => {
            let (intensity, position) = (1.0, framed.view.location);
            let lamp = PointLight { intensity, position, color: HEADLIGHT, falloff: Falloff::None };
            world.spawn((Order(0), JsonPath("the light".to_owned()), lamp));
            let light = if framed.lamp.is_some() { ROOM } else { SKY };
            (under(world, light, framed.up, 0), "a light at the camera and a sky are added", None)
        }
    }
}

/// The corners of the lamp of a room whose box has these ends, for a camera inside. A room without extent has no place for
/// one.
pub(super) fn room_lamp(framed: &Framed, [low, high]: &Ends) -> Option<[DVec3; 4]> {
    let eye = framed.view.location;
    let is_inside = eye.cmpge(*low).all() && eye.cmple(*high).all();
    framed.lamp.filter(|corners| is_inside && quad_has_area(corners))
}

/// Adds an image around a `world` of a `file`, as its only light. Returns as [`light`].
pub(crate) fn surround(
    world: &mut World,
    framed: &Framed,
    file: &Path,
    image: TextureRef,
    lighting: &Lighting,
) -> (Settings, &'static str) {
    let hidden = lighting.background == Some(Background::Transparent);
    let (samples, sampling) = (SKY_SAMPLES, Sampling::Sobol);
    let sky = Sky { sky: None, ground: None, up: framed.up, samples, sampling, distance: None };
    world.spawn((Environment::of_image(image, framed.up, hidden),));
    world.spawn((sky,));
    let background = lighting.background.map_or(LIGHT, Background::color);
    (settings_of(file, background, 0.0), "the environment lights it")
}

/// The light on a surface with this normal from a sky in the direction `up`.
fn from_sky([sky, below]: [DVec3; 2], up: DVec3, normal: DVec3) -> DVec3 {
    (sky + below) / 2.0 + (sky - below) / 2.0 * up.normalize().dot(normal)
}

/// The other settings of a file with this number of lights of its own.
pub(crate) fn settings(file: &Path, lights: usize, lighting: &Lighting) -> Settings {
    let background = lighting.background.map_or(DARK, Background::color);
    // Each light adds it: all together, as in scene files with one light.
    settings_of(file, background, AMBIENT / lights.max(1) as f64)
}

fn settings_of(file: &Path, background: DVec3, ambient: f64) -> Settings {
    let (file, transfer) = (file.to_owned(), Encoding::Srgb);
    Settings { file, bounces: BOUNCES, background, ambient, transfer }
}

/// Adapts the settings to the surfaces of a world: with glass, rays have enough bounces to pass
/// through; with an occlusion map, which tells of cavities that meshes lack, none look for others.
pub(crate) fn allow_for_surfaces(world: &mut World) {
    if world.query_mut::<&Maps>().into_iter().any(|maps| maps.occlusion.is_some()) {
        change(world, |sky: &mut Sky| sky.samples = 0);
    }
    if world.query_mut::<&Transparency>().into_iter().any(|transparency| transparency.kt > 0.0) {
        change(world, |settings: &mut Settings| settings.bounces = GLASS_BOUNCES);
    }
}

/// A flat lamp with these corners, equally bright at any distance.
fn ceiling(corners: [DVec3; 4]) -> (Order, JsonPath, Added, AreaLight, Mesh) {
    let light = AreaLight {
        intensity: CEILING,
        color: DVec3::ONE,
        falloff: Falloff::None,
        sampling: Sampling::Sobol,
        samples: CEILING_SAMPLES,
    };
    let positions = corners.map(|corner| corner.as_vec3()).to_vec();
    let data = MeshData {
        positions: positions.into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Default::default()
    };
    let mesh = Mesh { data, ..Mesh::default() };
    (Order(0), JsonPath("the lamp".to_owned()), Added::Lamp, light, mesh)
}

/// The directions to the right, up and to the camera, for an upright viewer in front of the scene.
pub(super) fn axes(Framed { view, up, .. }: &Framed) -> DMat3 {
    let level = |v: DVec3| v - *up * v.dot(*up);
    // From directly above, the lower edge of the image is in front.
    let from = view.location - view.look;
    let is_level = |v: &DVec3| v.length() > STEEP * from.length();
    let back = Some(level(from)).filter(is_level).or_else(|| Some(level(-view.up)));
    let back = back.and_then(direction).unwrap_or_else(|| up.any_orthonormal_vector());
    DMat3::from_cols(up.cross(back), *up, back)
}
