//! Cut-outs: a sheet with an alpha for each texel, some exactly at the threshold.

use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec2};

use super::case::{Effort, Outcome};
use super::ways::{Numbers, every_way, inputs, with_every_kernel};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::geometry::cutouts::{Cutout, Cutouts, MeshUvs};
use wavecrest_core::kernels::corners::CornerValues;
use wavecrest_core::kernels::texture::{Filter, Image, LazyImage, PlanarMap, Texels, UvMap, Wrap};
use wavecrest_core::math::ray::Ray;

/// Texels along each side of the sheet, whose side has this length.
const TEXELS: usize = 8;

/// Within this distance of the border of a texel, in texels, rounding decides.
const BESIDE: f64 = 1e-3;

/// Scenes of case 45 for each kind.
const SCENES: usize = 8;

/// The primitives of the sheet.
#[derive(Clone, Copy)]
enum Kind {
    /// Two triangles, with projected coordinates.
    Triangles,
    /// Two triangles, with coordinates at their corners.
    Mesh,
    Quad,
}

/// A copy of the sheet without holes, in the same place.
#[derive(Clone, Copy, PartialEq)]
enum Copy {
    None,
    Before,
    Behind,
}

/// A sheet in front of a wall.
struct Sheet {
    geometry: Geometry,
    /// From sheet coordinates to the world.
    to_world: DAffine3,
    /// The opaque texels, by row from the lowest.
    solid: Vec<bool>,
    /// The primitives of the sheet, of its copy, and of the wall.
    sheet: Range<u32>,
    copy: Range<u32>,
    wall: Range<u32>,
}

/// A ray aimed at a texel of the sheet.
struct Aimed {
    ray: Ray,
    is_solid: bool,
    /// Whether the wall is behind the sheet as seen by the ray.
    has_wall: bool,
}

/// Case 45.
pub(super) fn cut_out(effort: &Effort) -> Outcome {
    let kinds = [Kind::Triangles, Kind::Mesh, Kind::Quad];
    let copies = [Copy::None, Copy::Before, Copy::Behind];
    let all = kinds.into_iter().flat_map(|kind| copies.map(|copy| (kind, copy)));
    let scenes = all.flat_map(|scene| (0..SCENES).map(move |_| scene)).enumerate();
    scenes
        .map(|(number, (kind, copy))| {
            let sheet = Sheet::new(&mut Numbers::new(effort, 45, usize::MAX - number), kind, copy);
            let start = number * 1_000_000;
            let rays = effort.of(1_000_000) / (9 * SCENES);
            let aimed = inputs(effort, 45, start..start + rays);
            let aimed: Vec<Aimed> = aimed.filter_map(|mut n| sheet.aimed(&mut n)).collect();
            sheet.seen(effort, &aimed)
        })
        .sum()
}

impl Sheet {
    fn new(numbers: &mut Numbers, kind: Kind, copy: Copy) -> Self {
        let turned = glam::DQuat::from_rotation_arc(DVec3::Z, numbers.direction());
        let scale = DVec3::splat(numbers.magnitude(1e-3, 1e3));
        let to_world = DAffine3::from_scale_rotation_translation(scale, turned, DVec3::ZERO);
        let place =
            |x: f64, y: f64, z: f64| to_world.transform_point3(DVec3::new(x, y, z)).as_vec3();
        let mut geometry = Geometry::default();
        let square = |low: f64, high: f64, z: f64| {
            [place(low, low, z), place(high, low, z), place(high, high, z), place(low, high, z)]
        };
        geometry.positions.extend(square(0.0, TEXELS as f64, 0.0));
        geometry.positions.extend(square(-1e3, 1e3, -1.0));
        let add = |geometry: &mut Geometry, first: u32| {
            let start = geometry.triangles.len() as u32;
            geometry.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v: u32| v + first)));
            start..start + 2
        };
        let (mut before, mut sheet, mut behind) = (0..0, 0..0, 0..0);
        if copy == Copy::Before {
            before = add(&mut geometry, 0);
        }
        if !matches!(kind, Kind::Quad) {
            sheet = add(&mut geometry, 0);
        }
        if copy == Copy::Behind {
            behind = add(&mut geometry, 0);
        }
        let wall = add(&mut geometry, 4);
        if let Kind::Quad = kind {
            geometry.quads.push([0, 1, 2, 3]);
            sheet = wall.end..wall.end + 1;
        }
        let [origin, u, v] =
            [place(0.0, 0.0, 0.0), place(TEXELS as f64, 0.0, 0.0), place(0.0, TEXELS as f64, 0.0)];
        let planar = UvMap::Planar(PlanarMap::new(origin, u - origin, v - origin));
        let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let uvs = Arc::new(CornerValues { values: uvs.to_vec(), indices: None });
        let of_mesh = MeshUvs { first_triangle: sheet.start, first_position: 0, uvs };
        let (map, mesh) = match kind {
            Kind::Mesh => (UvMap::Mesh, Some(of_mesh)),
            Kind::Triangles | Kind::Quad => (planar, None),
        };
        let (image, threshold, solid) = alphas(numbers);
        let (image, primitives) = (Arc::new(image), sheet.clone());
        let (filter, wrap, placing) = (Filter::Nearest, Wrap::Clamp, None);
        let cutout = Cutout { primitives, threshold, image, filter, wrap, map, placing, mesh };
        geometry.cutouts = Cutouts::new(vec![cutout]);
        let copy = if before.is_empty() { behind } else { before };
        Self { geometry, to_world, solid, sheet, copy, wall }
    }

    /// A ray at a texel, or at the shared edge of the sheet's triangles.
    fn aimed(&self, numbers: &mut Numbers) -> Option<Aimed> {
        let [x, y] = [(); 2].map(|()| TEXELS as f64 * numbers.one());
        let y = if numbers.below(3) == 0 { x } else { y };
        let inner = |at: f64| (at - at.round()).abs() > BESIDE;
        if !inner(x) || !inner(y) {
            return None;
        }
        let has_wall = numbers.below(2) == 0;
        let height = if has_wall { 0.5 + 4.0 * numbers.one() } else { -0.9 + 0.8 * numbers.one() };
        let from = DVec3::new(x + 4.0 * numbers.one(), y - 4.0 * numbers.one(), height);
        let [from, target] = [from, DVec3::new(x, y, 0.0)]
            .map(|point| self.to_world.transform_point3(point).as_vec3());
        let ray = Ray::new(from, target - from);
        Some(Aimed { ray, is_solid: self.solid[y as usize * TEXELS + x as usize], has_wall })
    }

    /// The primitives of which the ray must hit one.
    fn hit_by(&self, aimed: &Aimed) -> Option<&Range<u32>> {
        let sheet = aimed.is_solid.then_some(&self.sheet);
        let copy = (!self.copy.is_empty()).then_some(&self.copy);
        let first = sheet.into_iter().chain(copy).min_by_key(|primitives| primitives.start);
        first.or_else(|| aimed.has_wall.then_some(&self.wall))
    }

    /// Checks that rays hit the expected primitives, that these block shadow rays, and that nothing
    /// else does either.
    fn seen(&self, effort: &Effort, aimed: &[Aimed]) -> Outcome {
        let rays: Vec<Ray> = aimed.iter().map(|aimed| aimed.ray).collect();
        let shadows: Vec<Ray> = rays.iter().map(|ray| Ray { t_max: 1.1, ..*ray }).collect();
        let all = [Preset::Brute, Preset::Fastest, Preset::Medium].map(|preset| {
            let mut outcome =
                every_way(effort.accel(self.geometry.clone(), preset), &rays, |i, _, hit| {
                    let expected = self.hit_by(&aimed[i]);
                    let is_right = match expected {
                        Some(primitives) => primitives.contains(&hit.primitive),
                        None => hit.is_miss(),
                    };
                    (!is_right).then(|| format!("{hit:?} and not one of {expected:?}"))
                });
            let mut accel = effort.accel(self.geometry.clone(), preset);
            outcome.add(with_every_kernel(&mut accel, |accel| {
                let mut answers = vec![false; shadows.len()];
                accel.occluded_of(&shadows[..], &mut answers, &mut accel.traversal());
                let one = |(aimed, &stopped): (&Aimed, &bool)| {
                    let is_there = aimed.is_solid || !self.copy.is_empty();
                    let context = || format!("{} is stopped: {stopped}", aimed.ray);
                    Outcome::one((stopped != is_there).then(context))
                };
                aimed.iter().zip(&answers).map(one).sum()
            }));
            outcome
        });
        all.into_iter().sum()
    }
}

/// An alpha for each texel: the threshold, or the adjacent number below or above. Returns the
/// threshold and the opaque texels too.
fn alphas(numbers: &mut Numbers) -> (LazyImage, f32, Vec<bool>) {
    // From -1 to 1, by row from the lowest; images start at the top.
    let above: Vec<i8> = (0..TEXELS * TEXELS).map(|_| numbers.below(3) as i8 - 1).collect();
    let rows = above.chunks(TEXELS).rev().flatten();
    let level = 1 + numbers.below(254) as u8;
    let (texels, threshold) = if numbers.below(2) == 0 {
        let texel = |&above: &i8| [level.saturating_add_signed(above); 4];
        (Texels::Bytes(rows.map(texel).collect()), f32::from(level) / 255.0)
    } else {
        let threshold = numbers.one() as f32;
        let near = [threshold.next_down(), threshold, threshold.next_up()];
        let texel = |&above: &i8| [near[(above + 1) as usize]; 3];
        (Texels::Floats(rows.map(texel).collect()), threshold)
    };
    let decode = move || Ok(Image::new(TEXELS as u32, TEXELS as u32, texels));
    let solid = above.iter().map(|&above| above >= 0).collect();
    (LazyImage::new("alpha".to_owned(), [0; 2], decode), threshold, solid)
}
