//! Images for inspection: the content of a scene instead of its lighting.
//!
//! | look | a sample shows |
//! |---|---|
//! | clay | the scene in matte grey, under its own lights |
//! | normals | the shading normal: x, y and z from -1 to 1 as red, green and blue |
//! | depth | the distance along the view axis, from light (nearest in view) to dark (farthest) |
//! | wireframe | the scene, with a line of constant width along every visible edge |
//! | uv | texture coordinates: u as red, v as green, a checker of 16 by 16 fields as blue |
//! | ids | each object in its own colour, or each triangle of a single mesh |
//!
//! Clay and uv replace materials and textures before the scene is extracted. The others come from a
//! pass over the camera rays. The colours of all but clay and wireframe are encoded display values,
//! to be written with [`Transfer::Linear`](super::write::Transfer::Linear).

use glam::Vec3;

use crate::aov::VisibleHit;
use crate::camera_rays::{CameraRays, Gather};
use crate::colormap::{distinct, magma};
use wavecrest_base::error::Result;
use wavecrest_core::accel::Hit;
use wavecrest_core::film::Film;
use wavecrest_core::geometry::Primitive;
use wavecrest_core::kernels::precision::Arithmetic;
use wavecrest_core::math::float::dot;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render;
use wavecrest_core::tile::Tile;

wavecrest_base::choices! {
    /// A kind of image for inspection.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Look {
        /// The scene in matte grey, with its own lights.
        Clay = "clay",
        /// Shading normals as colours.
        Normals = "normals",
        /// Distance along the view axis; near is bright.
        Depth = "depth",
        /// The scene with its triangle edges.
        Wireframe = "wireframe",
        /// Texture coordinates as colours over a checker.
        Uv = "uv",
        /// A colour for each object, or for each triangle of a single mesh.
        Ids = "ids",
    }
}

impl Look {
    /// Whether the scene is rendered for it.
    pub fn is_shaded(self) -> bool {
        matches!(self, Self::Clay | Self::Wireframe)
    }
}

/// The colour of the empty background: a dark grey that no object has.
const NOTHING: [f32; 3] = [0.13; 3];

/// The colour of lines, linear: nearly black.
const LINE: [f32; 3] = [0.004, 0.004, 0.008];

/// The image of an unshaded look, or its part `crop`.
///
/// # Errors
/// If the crop is not within the image, there is no memory for the film, or an image cannot be
/// decoded.
pub fn film(scene: &PreparedScene, look: Look, crop: Option<Tile>, seed: u64) -> Result<Film> {
    let window = render::window(scene, crop)?;
    // The range is that of the whole image, so that a part has the same colours.
    let shown = if look == Look::Depth { render::window(scene, None)? } else { window };
    let mut found = vec![PixelSums::default(); shown.len()];
    let rays = CameraRays { scene, window: shown, seed, watch: &() };
    rays.run(&SamplePainter { scene, look }, &mut |at, painted| found[at] = *painted);
    scene.appearance.check()?;
    let samples = scene.camera.rays_per_pixel();
    let range = range(&found);
    let mut film = Film::new(window.width, window.height)?;
    for (index, pixel) in film.pixels_mut().iter_mut().enumerate() {
        let (x, y) = window.pixel(index as u32);
        let at = (y - shown.y) as usize * shown.width as usize + (x - shown.x) as usize;
        *pixel = color(&found[at], look, range, samples);
    }
    Ok(film)
}

/// Bytes that [`film`] takes beside the film, for an image of `pixels` of the `whole` image's pixels.
pub fn bytes(look: Look, pixels: u64, whole: u64) -> u64 {
    let shown = match look {
        _ if look.is_shaded() => 0,
        Look::Depth => whole,
        _ => pixels,
    };
    shown.saturating_mul(size_of::<PixelSums>() as u64)
}

/// The smallest and largest mean depth of the pixels.
fn range(found: &[PixelSums]) -> [f64; 2] {
    let depths = found.iter().filter_map(PixelSums::mean_depth);
    depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], depth| [a.min(depth), b.max(depth)])
}

/// The colour of a pixel; samples without a hit show the background.
fn color(painted: &PixelSums, look: Look, [near, far]: [f64; 2], samples: u32) -> [f32; 3] {
    let covered = f64::from(painted.hits) / f64::from(samples);
    let color = match (look, painted.mean_depth()) {
        (_, None) => [0.0; 3],
        (Look::Depth, Some(depth)) => {
            let part = if far > near { (far - depth) / (far - near) } else { 1.0 };
            magma(part as f32).map(|value| f64::from(value) * covered)
        }
        _ => painted.color.map(|sum| sum / f64::from(samples)),
    };
    [0, 1, 2].map(|i| (color[i] + f64::from(NOTHING[i]) * (1.0 - covered)) as f32)
}

/// Draws the visible edges over the image of `scene`, or over its part `crop`.
///
/// # Errors
/// If the crop is not within the image.
pub fn draw_edges(
    picture: &mut Film,
    scene: &PreparedScene,
    crop: Option<Tile>,
    seed: u64,
) -> Result<()> {
    let window = render::window(scene, crop)?;
    let samples = f64::from(scene.camera.rays_per_pixel());
    let pixels = picture.pixels_mut();
    CameraRays { scene, window, seed, watch: &() }.run(
        &Wires { scene },
        &mut |at, covered: &f64| {
            let part = (covered / samples) as f32;
            let mixed = |i: usize| pixels[at][i] + (LINE[i] - pixels[at][i]) * part;
            pixels[at] = [mixed(0), mixed(1), mixed(2)];
        },
    );
    Ok(())
}

/// Colours each sample.
struct SamplePainter<'a> {
    scene: &'a PreparedScene,
    look: Look,
}

/// The sums of a pixel's samples.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSums {
    /// Number of samples that hit something.
    hits: u32,
    color: [f64; 3],
    depth: f64,
}

impl PixelSums {
    /// The mean over samples that hit something; `None` if none does.
    fn mean_depth(&self) -> Option<f64> {
        (self.hits > 0).then(|| self.depth / f64::from(self.hits))
    }
}

impl Gather for SamplePainter<'_> {
    type Sums = PixelSums;

    fn add<P: Arithmetic>(&self, ray: &Ray, hit: &Hit, _: bool, sums: &mut PixelSums) {
        let Some(seen) = VisibleHit::of::<P>(self.scene, ray, hit) else { return };
        let [_, _, forward] = self.scene.camera.basis();
        sums.hits += 1;
        sums.depth += f64::from(hit.t) * f64::from(dot(ray.direction, forward));
        let color = match self.look {
            Look::Normals => seen.normal.to_array().map(|value| 0.5 + 0.5 * value),
            Look::Uv => seen.albedo.to_array(),
            Look::Ids => distinct(self.number(hit)),
            Look::Clay | Look::Depth | Look::Wireframe => [0.0; 3],
        };
        sums.color.iter_mut().zip(color).for_each(|(sum, value)| *sum += f64::from(value));
    }
}

impl SamplePainter<'_> {
    /// The number of the object that was hit, or of the triangle if there is only one object.
    fn number(&self, hit: &Hit) -> u32 {
        let appearance = &self.scene.appearance;
        match appearance.shapes.len() {
            0 | 1 => hit.primitive,
            _ => appearance.shape_of(hit.primitive) as u32,
        }
    }
}

/// Half the width of a line in pixels: each side of an edge draws its half.
const HALF_WIDTH: f32 = 0.6;
/// A line fades over one pixel, half of it on either side of its border.
const BORDER: f32 = 0.5;
/// Triangles with a smaller height in pixels have fainter lines, so that fine meshes are not black.
const FAINT_BELOW: f32 = 6.0;

/// Draws triangle edges as lines of constant width in pixels: sums the coverage of a pixel's samples by lines.
///
/// The distance of a point from an edge in pixels follows from its distance in the scene, and from
/// its change between pixels, the ray's differential. So nothing is projected, and edges behind the
/// camera need no care.
struct Wires<'a> {
    scene: &'a PreparedScene,
}

impl Gather for Wires<'_> {
    type Sums = f64;

    fn add<P: Arithmetic>(&self, ray: &Ray, hit: &Hit, _: bool, sums: &mut f64) {
        if !hit.is_miss() {
            *sums += f64::from(self.covered(ray, hit));
        }
    }
}

impl Wires<'_> {
    /// The coverage of the hit by a line, from 0 to 1.
    fn covered(&self, ray: &Ray, hit: &Hit) -> f32 {
        let geometry = self.scene.accel.geometry();
        if let Some(corners) = geometry.mesh_triangle(hit.primitive) {
            return self.line(ray, hit.t, &corners);
        }
        match geometry.primitive(hit.primitive) {
            // A quad has four edges; its diagonal is not one.
            Primitive::Quad(index) => self.line(ray, hit.t, &geometry.quad(index)),
            _ => 0.0,
        }
    }

    /// The same for the polygon with these corners.
    fn line(&self, ray: &Ray, t: f32, corners: &[Vec3]) -> f32 {
        let [a, b, c] = [corners[0], corners[1], corners[2]];
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return 0.0 };
        let direction = ray.direction.into();
        let steps = self.scene.camera.differential(direction).at(direction, t, normal.into());
        let steps = steps.map(Vec3::from);
        let point = ray.origin + ray.direction * t;
        let ends = |i: usize| (corners[i], corners[(i + 1) % corners.len()]);
        let (mut nearest, mut lowest) = (f32::INFINITY, f32::INFINITY);
        for i in 0..corners.len() {
            let (from, to) = ends(i);
            let across = (to - from).cross(normal).normalize_or_zero();
            let step = steps.map(|step| step.dot(across));
            let a_pixel = step[0].hypot(step[1]);
            if a_pixel > 0.0 {
                let (_, beyond) = ends((i + 1) % corners.len());
                nearest = nearest.min((point - from).dot(across).abs() / a_pixel);
                lowest = lowest.min((beyond - from).dot(across).abs() / a_pixel);
            }
        }
        let covered = (HALF_WIDTH + BORDER - nearest).clamp(0.0, 1.0);
        covered * (lowest / FAINT_BELOW).min(1.0)
    }
}
