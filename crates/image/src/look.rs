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
//! Clay and uv replace materials and textures while the scene is extracted. The others come from a
//! pass over the camera rays. The colours of all but clay and wireframe are encoded display values,
//! to be written with [`Transfer::Linear`](super::write::Transfer::Linear).

use std::time::Instant;

use glam::Vec3;

use crate::camera_rays::CameraRays;
use crate::colormap::{distinct, magma};
use wavecrest_base::error::Result;
use wavecrest_core::accel::Hit;
use wavecrest_core::counters::Counters;
use wavecrest_core::film::Film;
use wavecrest_core::geometry::Primitive;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{self as core, RenderOptions, Rendered, Watch, window};
use wavecrest_core::tile::Tile;
use wavecrest_core::wavefront::Seen;

wavecrest_base::choices! {
    /// A kind of image for inspection.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "kebab-case")]
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

/// Renders the light of the scene, or the `look` for which it was prepared.
///
/// # Errors
/// As [`core::render`].
pub fn render(
    scene: &PreparedScene,
    look: Option<Look>,
    options: &RenderOptions,
    watch: &dyn Watch,
) -> Result<Rendered> {
    let tile = window(scene, options.crop)?;
    let Some(look) = look.filter(|look| !look.is_shaded()) else {
        let mut rendered = core::render(scene, options, watch)?;
        if look == Some(Look::Wireframe) && rendered.finished {
            draw_edges(&mut rendered.film, scene, tile, options.seed);
        }
        return Ok(rendered);
    };
    let start = Instant::now();
    let film = film(scene, look, tile, options.seed, watch)?;
    let finished = !watch.cancelled();
    watch.tile(&tile, film.pixels());
    Ok(Rendered {
        film,
        finished,
        tiles: vec![tile],
        counters: Counters::default(),
        columns: 0,
        pass_seconds: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
        precision: scene.accel.geometry().precision,
    })
}

/// The image of an unshaded look in a `window`; a part of it if `watch` cancels it.
fn film(
    scene: &PreparedScene,
    look: Look,
    window: Tile,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Film> {
    let mut film = Film::new(window.width, window.height)?;
    if look == Look::Depth {
        let [width, height] = scene.camera.size();
        let whole = Tile { x: 0, y: 0, width, height };
        let rays = CameraRays { scene, window: whole, seed, watch };
        draw_depth(&mut film, &rays, window);
    } else {
        let samples = f64::from(scene.camera.rays_per_pixel());
        let pixels = film.pixels_mut();
        let color = |seen: &Seen| match look {
            Look::Normals => seen.normal.to_array().map(|value| 0.5 + 0.5 * value),
            Look::Ids => distinct(number(scene, seen.hit.primitive)),
            _ => seen.albedo.to_array(),
        };
        CameraRays { scene, window, seed, watch }.sum(color, &mut |at, sums| {
            let covered = f64::from(sums.hits) / samples;
            pixels[at] = before_nothing(sums.color.map(|sum| sum / samples), covered);
        });
    }
    scene.appearance.check()?;
    Ok(film)
}

/// Draws depths. The range is that of the whole image, so that a part has the same colours.
fn draw_depth(film: &mut Film, rays: &CameraRays<'_>, window: Tile) {
    let whole = rays.window;
    let samples = f64::from(rays.scene.camera.rays_per_pixel());
    // The mean over the samples that hit something, and their share.
    let mut depths = vec![[0.0; 2]; whole.len()];
    rays.sum(|_| [0.0; 3], &mut |at, sums| {
        let hits = f64::from(sums.hits);
        depths[at] = [sums.depth / hits.max(1.0), hits / samples];
    });
    let [near, far] = depths
        .iter()
        .filter(|[_, covered]| *covered > 0.0)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[near, far], [depth, _]| {
            [near.min(*depth), far.max(*depth)]
        });
    for (index, pixel) in film.pixels_mut().iter_mut().enumerate() {
        let (x, y) = window.pixel(index as u32);
        let [depth, covered] = depths[y as usize * whole.width as usize + x as usize];
        let part = if far > near { (far - depth) / (far - near) } else { 1.0 };
        let color = magma(part as f32).map(|value| f64::from(value) * covered);
        *pixel = before_nothing(color, covered);
    }
}

/// The colour of a pixel of which this share is `covered`; samples without a hit show the background.
fn before_nothing(color: [f64; 3], covered: f64) -> [f32; 3] {
    [0, 1, 2].map(|i| (color[i] + f64::from(NOTHING[i]) * (1.0 - covered)) as f32)
}

/// The number of the object that was hit, or of the triangle if there is only one object.
fn number(scene: &PreparedScene, primitive: u32) -> u32 {
    match scene.appearance.shapes.len() {
        0 | 1 => primitive,
        _ => scene.appearance.shape_of(primitive) as u32,
    }
}

/// Draws the visible edges over the image of `scene` in a `window`.
fn draw_edges(picture: &mut Film, scene: &PreparedScene, window: Tile, seed: u64) {
    let samples = f64::from(scene.camera.rays_per_pixel());
    let pixels = picture.pixels_mut();
    let add = |sum: &mut f64, seen: &Seen, _: bool| {
        *sum += f64::from(covered(scene, &seen.ray, &seen.first));
    };
    CameraRays { scene, window, seed, watch: &() }.run(false, &add, &mut |at, covered: &f64| {
        let part = (covered / samples) as f32;
        let mixed = |i: usize| pixels[at][i] + (LINE[i] - pixels[at][i]) * part;
        pixels[at] = [mixed(0), mixed(1), mixed(2)];
    });
}

/// Half the width of a line in pixels: each side of an edge draws its half.
const HALF_WIDTH: f32 = 0.6;
/// A line fades over one pixel, half of it on either side of its border.
const BORDER: f32 = 0.5;
/// Triangles with a smaller height in pixels have fainter lines, so that fine meshes are not black.
const FAINT_BELOW: f32 = 6.0;

/// The coverage of the hit by the line along a triangle's edge, from 0 to 1.
fn covered(scene: &PreparedScene, ray: &Ray, hit: &Hit) -> f32 {
    if hit.is_miss() {
        return 0.0;
    }
    let geometry = scene.accel.geometry();
    if let Some(corners) = geometry.mesh_triangle(hit.primitive) {
        return line(&scene.camera, ray, hit.t, &corners);
    }
    match geometry.primitive(hit.primitive) {
        // A quad has four edges; its diagonal is not one.
        Primitive::Quad(index) => line(&scene.camera, ray, hit.t, &geometry.quad(index)),
        _ => 0.0,
    }
}

/// The same for the polygon with these corners, whose lines have a constant width in pixels.
///
/// The distance of a point from an edge in pixels follows from its distance in the scene, and from
/// its change between pixels, the ray's differential. So nothing is projected, and edges behind the
/// camera need no care.
fn line(camera: &Camera, ray: &Ray, t: f32, corners: &[Vec3]) -> f32 {
    let [a, b, c] = [corners[0], corners[1], corners[2]];
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return 0.0 };
    let direction = ray.direction.into();
    let share = 1.0 / (camera.points() as f32).sqrt();
    let steps = camera.differential(direction, share).at(direction, t, normal.into());
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
