//! The report of a probe: plain data in scene units, also as JSON.

use glam::{DVec3, Vec3};
use serde::Serialize;

use crate::recursive::PathEnd;

/// A recorded path.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PathRecord {
    /// The camera ray within the pixel.
    pub sample: u32,
    /// Its rays in order, from the camera's on.
    pub bounces: Vec<Bounce>,
    /// Its radiance: linear red, green and blue.
    pub radiance: Vec3,
}

/// The kind of a ray of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayKind {
    /// It starts at the camera.
    Camera,
    /// It is mirrored at a surface.
    Mirrored,
    /// It is refracted there.
    Refracted,
    /// It goes straight on behind the surface.
    Straight,
}

/// A ray and its interaction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounce {
    /// Its kind.
    pub kind: RayKind,
    /// The number of the ray in the path at whose hit it starts; `None` for the camera's.
    pub from: Option<usize>,
    /// The share of its light that reaches the camera.
    pub throughput: Vec3,
    /// Origin, in scene units.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: Vec3,
    /// The entry in the scene file of the shape whose inside it runs in; `None` in air.
    pub medium: Option<String>,
    /// Inner nodes visited.
    pub nodes: u64,
    /// Leaves visited.
    pub leaves: u64,
    /// Primitives of all kinds tested.
    pub primitives: u64,
    /// The hit, if any.
    pub met: Option<HitRecord>,
    /// The radiance gathered by this ray and those before.
    pub radiance: Vec3,
    /// Why no ray goes on from here; `None` if one does.
    pub end: Option<PathEnd>,
}

/// A hit.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HitRecord {
    /// The primitive, by its number in the scene.
    pub primitive: u32,
    /// Triangle, quad, sphere or disk.
    pub kind: &'static str,
    /// The shape's entry in the scene file.
    pub shape: String,
    /// The shape's name, if it has one.
    pub name: Option<String>,
    /// The appearance of the surface; `None` for lights.
    pub surface: Option<SurfaceRecord>,
    /// Distance along the ray, in lengths of its direction.
    pub t: f32,
    /// Bound on the error of t; `None` in fast precision.
    pub t_error: Option<f32>,
    /// Barycentric coordinates of the second and third corner of triangles, else zero.
    pub uv: [f32; 2],
    /// The point, in scene units.
    pub point: DVec3,
    /// Bound on the error of each coordinate.
    pub error: Vec3,
    /// Geometric normal, on the viewer's side; for a light's shape, on the side of its winding.
    pub normal: Vec3,
    /// Shading normal.
    pub shading_normal: Vec3,
    /// Whether lights reach this side.
    pub lit: bool,
    /// The lights' contributions.
    pub lights: Vec<LightRecord>,
}

/// The material at a hit, with its textures looked up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceRecord {
    /// Diffuse colour, linear: the material's, or the texture's.
    pub color: Vec3,
    /// The file of the image that gives the colour.
    pub texture: Option<String>,
    /// Weight of the highlight.
    pub ks: f32,
    /// Weight of the diffuse part.
    pub kd: f32,
    /// Sharpness of the highlight.
    pub exponent: f32,
    /// Weight of the mirror ray.
    pub kr: f32,
    /// Share of the light that does not come from straight behind.
    pub opacity: f32,
    /// Weight of refracted light.
    pub kt: f32,
    /// Index of refraction; 1 where nothing is refracted.
    pub ior: f32,
    /// Emission of the material, linear.
    pub emission: Vec3,
}

/// A sample point of a light, for a hit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightRecord {
    /// The index of the light among those that can add more than an ambient part.
    pub light: usize,
    /// Whether it is ambient light, for which rays look.
    pub ambient: bool,
    /// The index of the point.
    pub index: usize,
    /// Its distance in scene units, or how far a ray to ambient light looks; `None` if it is
    /// infinitely far away.
    pub distance: Option<f32>,
    /// Whether its light arrives.
    pub verdict: Visibility,
    /// Its contribution to the path.
    pub adds: Vec3,
}

/// Whether the light of a point arrives.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Visibility {
    /// The point is behind the surface.
    Behind,
    /// None of its light would be reflected to the viewer.
    NotReflected,
    /// A shadow ray is blocked.
    Occluded {
        /// The primitive's number; `None` if only the any-hit query finds it.
        primitive: Option<u32>,
        /// The shape's entry in the scene file.
        shape: String,
        /// Where it is blocked: 1 is at the light, or beyond the scene for distant lights.
        t: f32,
    },
    /// The light arrives.
    Visible,
    /// A part of it arrives through transparent surfaces.
    Weakened {
        /// Its share by channel.
        #[serde(rename = "passed")]
        transmittance: Vec3,
    },
}

/// Where a sample is not finite.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InvalidSample {
    /// Column of the pixel.
    pub x: u32,
    /// Row of the pixel.
    pub y: u32,
    /// The camera ray within the pixel.
    pub sample: u32,
    /// The number of rays of the path before the one whose value is not finite.
    pub bounce: usize,
    /// The primitive that was hit there, by its number.
    pub primitive: Option<u32>,
    /// Its shape's entry in the scene file.
    pub shape: String,
}

impl std::fmt::Display for InvalidSample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { x, y, sample, bounce, primitive, shape } = self;
        write!(f, "pixel {x},{y}, sample {sample}, ray {bounce}")?;
        match primitive {
            Some(number) => write!(f, ", primitive {number} of {shape}"),
            None => Ok(()),
        }
    }
}

/// The record of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelRecord {
    /// Column and row.
    pub pixel: [u32; 2],
    /// The number of its samples.
    pub samples: u32,
    /// The recorded paths, sample by sample.
    pub paths: Vec<PathRecord>,
    /// The number of rays and points on lights with which the record ends before the last path does.
    pub cut_after: Option<u32>,
}
