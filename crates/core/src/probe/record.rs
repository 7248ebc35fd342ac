//! What a probe reports: plain data, in scene units, with a form in JSON.

use glam::{DVec3, Vec3};
use serde::Serialize;

use crate::recursive::End;

/// What happens to a path.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Path {
    /// The camera ray within the pixel.
    pub sample: u32,
    /// What happens, from the camera on.
    pub bounces: Vec<Bounce>,
    /// What it adds to the pixel: linear red, green and blue.
    pub radiance: Vec3,
}

/// A ray, and what comes of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounce {
    /// Where the ray starts, in scene units.
    pub origin: DVec3,
    /// Where it goes, of unit length.
    pub direction: Vec3,
    /// Inner nodes visited.
    pub nodes: u64,
    /// Leaves visited.
    pub leaves: u64,
    /// Primitives of all kinds tested.
    pub primitives: u64,
    /// What it meets.
    pub met: Option<Met>,
    /// What the path has gathered when this bounce is over.
    pub radiance: Vec3,
    /// Why the path ends here, if it does.
    pub end: Option<End>,
}

/// A hit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Met {
    /// The primitive, by its number in the scene.
    pub primitive: u32,
    /// Triangle, quad or sphere.
    pub kind: &'static str,
    /// The shape's entry in the scene file.
    pub shape: String,
    /// The shape's name, if it has one.
    pub name: Option<String>,
    /// What the surface looks like there; a light has none of it.
    pub surface: Option<Surface>,
    /// Where on the ray.
    pub t: f32,
    /// Bound on the error of t; fast arithmetic has none.
    pub t_error: Option<f32>,
    /// Barycentric coordinates of the second and third corner; zero but on triangles.
    pub uv: [f32; 2],
    /// Where it is, in scene units.
    pub point: DVec3,
    /// Bound on the error of each coordinate.
    pub error: Vec3,
    /// On the viewer's side; of a light's shape, as its winding has it.
    pub normal: Vec3,
    /// What it is lit with.
    pub shading_normal: Vec3,
    /// Whether lights reach this side.
    pub lit: bool,
    /// What the lights do.
    pub lights: Vec<Light>,
}

/// The material at a hit, with its textures looked up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Surface {
    /// Diffuse colour, linear: the material's, or the texture's.
    pub color: Vec3,
    /// The image that the colour is from.
    pub texture: Option<String>,
    /// Weight of the highlight.
    pub ks: f32,
    /// Weight of the diffuse part.
    pub kd: f32,
    /// Sharpness of the highlight.
    pub exponent: f32,
    /// Weight of the mirror ray.
    pub kr: f32,
    /// Light of the material itself, linear.
    pub emission: Vec3,
}

/// A point of a light, seen from a hit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Light {
    /// The light, by its place among those that can add more than an ambient part.
    pub light: usize,
    /// Which of its points.
    pub index: usize,
    /// How far it is, in scene units; none where it is infinitely far.
    pub distance: Option<f32>,
    /// What comes of it.
    pub verdict: Verdict,
    /// What it adds to the path.
    pub adds: Vec3,
}

/// What comes of a point of a light.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It is behind the surface.
    Behind,
    /// Nothing of it would be reflected to the viewer.
    NotReflected,
    /// A shadow ray meets this primitive at this part of the way.
    Occluded {
        /// By its number; none where only an any-hit query finds it.
        primitive: Option<u32>,
        /// The shape's entry in the scene file.
        shape: String,
        /// 1 is at the light, or beyond the scene where the light is.
        t: f32,
    },
    /// Nothing is in the way.
    Visible,
}

/// A sample that is not finite, by name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Invalid {
    /// Column of the pixel.
    pub x: u32,
    /// Row of the pixel.
    pub y: u32,
    /// The camera ray within the pixel.
    pub sample: u32,
    /// The mirror bounces before the light that is not finite.
    pub bounce: usize,
    /// The primitive that was hit there, by its number.
    pub primitive: Option<u32>,
    /// Its shape's entry in the scene file.
    pub shape: String,
}

impl std::fmt::Display for Invalid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { x, y, sample, bounce, primitive, shape } = self;
        write!(f, "pixel {x},{y}, sample {sample}, bounce {bounce}")?;
        match primitive {
            Some(number) => write!(f, ", primitive {number} of {shape}"),
            None => Ok(()),
        }
    }
}

/// What happens to the rays of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelRecord {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Its paths, sample by sample.
    pub paths: Vec<Path>,
    /// The sample and bounce at which the wavefront differs; `None` where both agree.
    pub differs: Option<[u32; 2]>,
}
