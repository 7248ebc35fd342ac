//! The lights of files without any: a key and a rim light infinitely far away, a sky that leans to
//! the other side and so is the fill, and a ground that receives shadows ([`super::ground`]).
//!
//! All lights follow the camera, so that shadows fall to the back and to the right in any view. The
//! lamps are round patches of the sky: their shadows are equally soft at any size of the scene, and
//! the lamps are invisible.

use std::path::Path;

use glam::DVec3;

use super::{Placed, Sphere, ground};
use crate::components::{
    Ambient, AreaLight, CameraPath, DirectionalLight, Falloff, Mesh, PointLight, Sampling,
    Settings, View,
};
use crate::corners::{direction, quad_has_area};
use crate::load::lighting::{Background, Lighting, Rig};
use crate::mesh::MeshData;
use crate::schema::{Light, Shape};

/// Mirror bounces: after four, little mirrored light is left.
const BOUNCES: u32 = 4;
/// Background of files with lights: a dark grey, before which black and white surfaces are both
/// visible.
const DARK: DVec3 = DVec3::splat(0.05);
/// Background of other files: lighter than any light grey surface, but not white.
const LIGHT: DVec3 = DVec3::new(0.86, 0.87, 0.88);
/// The ambient part of all lights together, as in scene files with one light.
const AMBIENT: f64 = 0.08;

/// A lamp of the studio.
struct Lamp {
    name: &'static str,
    /// Its direction, to the right, up, and back from the camera.
    side: DVec3,
    /// The light it adds to a white surface that faces it.
    color: DVec3,
    /// Its diameter in the sky, in degrees.
    angle: f64,
    /// Shadow rays for each hit; a pixel has at least four hits.
    samples: u32,
}

/// With the sky, they light a white surface that faces the key just to white.
const STUDIO: [Lamp; 2] = [
    Lamp {
        name: "the key",
        side: DVec3::new(-0.7, 1.0, 0.6),
        color: DVec3::new(0.84, 0.82, 0.79),
        angle: 14.0,
        samples: 4,
    },
    Lamp {
        name: "the rim",
        side: DVec3::new(0.35, 0.8, -1.0),
        color: DVec3::new(0.2, 0.2, 0.2),
        angle: 10.0,
        samples: 1,
    },
];

/// The sky of a lit scene, and the light from the ground below it.
const SKY: [DVec3; 2] = [DVec3::new(0.235, 0.25, 0.27), DVec3::new(0.1, 0.095, 0.09)];
/// Direction of the sky in a studio, to the right, up, and back: it leans to the side that the key
/// leaves dark, and so fills it without a ray.
const LEANING: DVec3 = DVec3::new(0.6, 1.0, 0.5);
/// The same for a room: light reflected by its walls.
const ROOM: [DVec3; 2] = [DVec3::splat(0.3), DVec3::splat(0.26)];
/// The light of a room's lamp on a white surface that faces it, at any distance.
const CEILING: f64 = 0.66;
/// Shadow rays to it for each hit.
const CEILING_SAMPLES: u32 = 4;
/// The light of the camera's lamp on a white surface that faces it.
const HEADLIGHT: DVec3 = DVec3::splat(0.65);
/// Sine of the largest angle off the vertical of a view from directly above.
const STEEP: f64 = 1e-3;

/// The object to light.
pub(crate) struct Subject<'a> {
    pub(crate) all: &'a [Placed<'a>],
    pub(crate) bounds: &'a Sphere,
    pub(crate) view: &'a View,
    /// The path of the camera, if any.
    pub(crate) path: Option<&'a CameraPath>,
    /// Direction of the sky, of unit length.
    pub(crate) up: DVec3,
    /// The corners of a flat lamp, if the camera is in a room.
    pub(crate) lamp: Option<[DVec3; 4]>,
}

/// The lights for an object.
pub(crate) struct Lit {
    pub(crate) lights: Vec<Light>,
    /// `None` if the camera would be below it.
    pub(crate) ground: Option<Shape>,
    pub(crate) settings: Settings,
    /// A description of the choices.
    pub(crate) told: &'static str,
}

/// Lights a `subject` from a `file` without lights.
pub(crate) fn lit(subject: &Subject<'_>, file: &Path, lighting: &Lighting) -> Lit {
    let background = lighting.background.map_or(LIGHT, Background::color);
    let under = |[sky, ground]: [DVec3; 2], up| {
        settings_of(file, background, Ambient::Hemisphere { sky, ground, up })
    };
    match lighting.rig {
        Rig::None => Lit {
            lights: Vec::new(),
            ground: None,
            settings: under([DVec3::ONE; 2], subject.up),
            told: "unlit colours",
        },
        Rig::Studio => {
            // A room without extent has no place for a lamp.
            if let Some(corners) = subject.lamp.filter(quad_has_area) {
                return Lit {
                    lights: vec![ceiling(corners)],
                    ground: None,
                    settings: under(ROOM, subject.up),
                    told: "a light under the ceiling is added",
                };
            }
            let axes = subject.axes();
            let lamps = STUDIO.each_ref().map(|lamp| lamp.light(&axes));
            let leaning = place(&axes, LEANING);
            // On a transparent background there is nothing to darken.
            let has_ground = lighting.background != Some(Background::Transparent);
            let colors = (background, from_sky(SKY, leaning, subject.up));
            let ground = has_ground.then(|| ground::under(subject, &axes, &lamps, colors));
            Lit {
                lights: STUDIO.iter().zip(lamps).map(|(lamp, light)| lamp.named(light)).collect(),
                ground: ground.flatten(),
                settings: under(SKY, leaning),
                told: "studio lights and a ground are added",
            }
        }
        Rig::Headlight => Lit {
            lights: vec![headlight(subject.view)],
            ground: None,
            settings: under(if subject.lamp.is_some() { ROOM } else { SKY }, subject.up),
            told: "a light at the camera and a sky are added",
        },
    }
}

/// The light on a surface with this normal from a sky in the direction `up`.
fn from_sky([sky, below]: [DVec3; 2], up: DVec3, normal: DVec3) -> DVec3 {
    (sky + below) / 2.0 + (sky - below) / 2.0 * up.normalize().dot(normal)
}

/// The other settings of a file with this number of lights of its own.
pub(crate) fn settings(file: &Path, lights: usize, lighting: &Lighting) -> Settings {
    let background = lighting.background.map_or(DARK, Background::color);
    // Each light adds it.
    settings_of(file, background, Ambient::Even(AMBIENT / lights.max(1) as f64))
}

fn settings_of(file: &Path, background: DVec3, ambient: Ambient) -> Settings {
    Settings { file: file.to_owned(), bounces: BOUNCES, background, ambient }
}

/// Largest number of shadow rays for each hit of the added lights.
pub(crate) fn samples() -> u64 {
    STUDIO.iter().map(|lamp| u64::from(lamp.samples)).sum()
}

/// A lamp at the camera.
fn headlight(view: &View) -> Light {
    let light = PointLight {
        intensity: 1.0,
        position: view.location,
        color: HEADLIGHT,
        falloff: Falloff::None,
    };
    Light::Point { path: "the light".to_owned(), light }
}

/// A flat lamp with these corners, equally bright at any distance.
fn ceiling(corners: [DVec3; 4]) -> Light {
    let path = "the lamp".to_owned();
    let light = AreaLight {
        intensity: CEILING,
        color: DVec3::ONE,
        falloff: Falloff::None,
        sampling: Sampling::Sobol,
        samples: CEILING_SAMPLES,
    };
    let positions = corners.map(|corner| corner.as_vec3()).to_vec();
    let data = MeshData { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Default::default() };
    let shape = Shape::of(path.clone(), None, Mesh { data, ..Mesh::default() });
    Light::Area { path, light, shape: Box::new(shape) }
}

/// The vector with these components to the right, up, and back.
fn place([right, up, back]: &[DVec3; 3], side: DVec3) -> DVec3 {
    *right * side.x + *up * side.y + *back * side.z
}

impl Lamp {
    fn named(&self, light: DirectionalLight) -> Light {
        Light::Directional { path: self.name.to_owned(), light }
    }

    fn light(&self, axes: &[DVec3; 3]) -> DirectionalLight {
        DirectionalLight {
            intensity: 1.0,
            color: self.color,
            direction: -place(axes, self.side),
            angle_degrees: self.angle,
            sampling: Sampling::Sobol,
            samples: self.samples,
        }
    }
}

impl Subject<'_> {
    /// The directions to the right, up and to the camera, for an upright viewer in front of the
    /// scene.
    fn axes(&self) -> [DVec3; 3] {
        let Self { view, up, .. } = self;
        let level = |v: DVec3| v - *up * v.dot(*up);
        // From directly above, the lower edge of the image is in front.
        let from = view.location - view.look;
        let is_level = |v: &DVec3| v.length() > STEEP * from.length();
        let back = Some(level(from)).filter(is_level).or_else(|| Some(level(-view.up)));
        let back = back.and_then(direction);
        let back = back.unwrap_or_else(|| up.any_orthonormal_vector());
        [up.cross(back), *up, back]
    }
}
