//! Lights at extreme positions, and reflection at extreme angles and exponents.

use super::prelude::*;
use super::shapes::Closed;
use super::surfaces::struck;
use wavecrest_core::kernels::blinn_phong::{Material, reflect};
use wavecrest_core::kernels::light::{Emitter, Falloff, Light, Triangles};
use wavecrest_core::kernels::shade::{ShadingPoint, ShadowRequest, shadow_request};
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::math::vector::Vector;

/// The power of the lights of cases 31 and 32.
const POWER: f32 = 10.0;

/// The material of the points that they light, which reflects at most all of their light.
const MATERIAL: Material = Material { ks: 0.5, kd: 0.5, exponent: 8.0, color: Vec3::ONE, kr: 0.0 };

/// A point of a triangle of this size, seen from its front, and the triangle.
fn some_point(numbers: &mut Numbers, unit: f64) -> Option<(ShadingPoint<f32>, [Vec3; 3])> {
    let corners = numbers.triangle(unit);
    let accel = numbers.effort.accel(of_triangles([corners]), Preset::VeryFast);
    let [point, error, normal] = struck(&accel, numbers)?;
    let view = numbers.direction().as_vec3();
    let view = if view.dot(normal) < 0.0 { -view } else { view };
    Some((ShadingPoint::plain([point, error, normal], view, &MATERIAL), corners))
}

/// The shadow ray from a point to a light brings a finite contribution, if any, and `is_right`.
fn shadow_ray(
    numbers: &mut Numbers,
    point: &ShadingPoint<f32>,
    emitter: Emitter,
    is_right: impl Fn(Falloff, Option<&ShadowRequest<f32>>) -> bool,
) -> Outcome {
    let (falloff, sampling) = (numbers.among(Falloff::ALL), Sampling::Jittered);
    let power = Vec3::splat(POWER);
    let light = Light { emitter, power, falloff, sampling, grid: [1, 1], dimension: 1 };
    let stream = Stream { seed: 0, pixel: numbers.below(1 << 20) as u32, sample: 0, bounce: 0 };
    let request = shadow_request(point, Vec3::ONE.into(), &light, &light.point(0, &stream), None);
    let is_valid = request.as_ref().is_none_or(|request| {
        let contribution = Vec3::from(request.contribution);
        let is_valid = contribution.is_finite() && contribution.min_element() >= 0.0;
        is_valid && request.ray().direction.is_finite()
    });
    Outcome::of(is_valid && is_right(falloff, request.as_ref()), || {
        format!("{request:?} from {point:?} to {light:?}")
    })
}

/// The part of a light that is left at a distance.
fn part_left(falloff: Falloff, distance: f64) -> f64 {
    let sphere = 4.0 * std::f64::consts::PI;
    match falloff {
        Falloff::Linear => 1.0 / (sphere * distance),
        Falloff::InverseSquare => 1.0 / (sphere * distance * distance),
        Falloff::None => 1.0,
    }
}

/// Case 31: a point, and a light that it sees edge on, that contains it, or that is a needle.
pub(super) fn edge_on(numbers: &mut Numbers) -> Outcome {
    let unit = numbers.magnitude(1e-3, 1e3);
    let Some((point, corners)) = some_point(numbers, unit) else { return Outcome::default() };
    let near = Vec3::from(point.point);
    let [p, q] = [(); 2].map(|()| near + (numbers.direction() * unit).as_vec3());
    let needle = q + (numbers.direction() * (1e-6 * unit)).as_vec3();
    // In the light's plane, beside it and at its corner; the point's own surface.
    let shape = numbers.among([[p, q, p + (p - near)], [near, p, q], corners, [p, q, needle]]);
    let Some(triangles) = Triangles::new(vec![shape]) else { return Outcome::default() };
    shadow_ray(numbers, &point, Emitter::Triangles(triangles), |_, _| true)
}

/// Case 31: shapes of lights that some points of the floor see edge on, or that touch the floor.
pub(super) fn hardly_lights(numbers: &mut Numbers) -> Vec<Picture> {
    let shapes = [
        json!({"type": "plane", "points": [[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]]}),
        json!({"type": "plane", "points": [[0, 0, -1], [0, 1, -1], [0, 1, 1], [0, 0, 1]]}),
        json!({"type": "triangle", "points": [[-1, 0, 0], [1, 0, 0], [0, 1, 0]]}),
        json!({"type": "triangle", "points": [[-1, 1, 0], [1, 1, 0], [1, 1.000_001, 0]]}),
        json!({"type": "trimesh", "points": [[-1, 1, 0], [1, 1, 0], [0, 2, 0]],
               "indices": [[0, 0, 1], [0, 1, 2], [1, 1, 1]]}),
        json!({"type": "sphere", "center": [0, 1, 0], "radius": 1}),
        json!({"type": "sphere", "center": [0, 0, 0], "radius": 1e-6}),
    ];
    let falloff = Falloff::ALL[numbers.index].name();
    let eye = Eye::above(50.0, numbers.effort.either(17, 65));
    let picture = |shape| {
        let light = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                           "falloff": falloff, "samples": 2, "shape": shape});
        let scene = scenes::scene(&eye, &[light], &[scenes::floor(3.0, scenes::white())]);
        Picture::new(scene, |_, _, pixel| Some(pixel.iter().all(|value| *value >= 0.0)))
    };
    shapes.map(picture).into()
}

/// Case 31: shapes without area.
pub(super) fn without_area(numbers: &mut Numbers) -> Outcome {
    let collinear = json!([[-1, 2, 0], [0, 2, 1], [1, 2, 2]]);
    let shapes = [
        json!({"type": "triangle", "points": collinear}),
        json!({"type": "triangle", "points": [[0, 1, 0], [0, 1, 0], [1, 1, 0]]}),
        json!({"type": "plane", "points": [[0, 1, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0]]}),
        json!({"type": "plane", "points": [[0, 1, 0], [0, 1, 0], [1, 1, 1], [1, 1, 0]]}),
        json!({"type": "trimesh", "points": collinear, "indices": [[0, 1, 2], [1, 1, 2]]}),
        json!({"type": "sphere", "center": [0, 3, 0], "radius": 0}),
        // An area that vanishes by rounding.
        json!({"type": "triangle",
               "points": [[1, 1, 1], [1, 1, 1.000_000_001], [1, 1.000_000_001, 1]]}),
    ];
    let shape = &shapes[numbers.index % shapes.len()];
    let (sampling, samples) = numbers.among([("random", 1), ("random", 7), ("jittered", 3)]);
    let light = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                       "sampling": sampling, "samples": samples, "shape": shape});
    let first = scenes::point_light(10.0, DVec3::Y, "linear");
    let eye = Eye::at(DVec3::Z * 5.0, 40.0, [8, 8]);
    let scene = scenes::scene(&eye, &[first, light], &[]);
    scenes::refused_at(&scene, "scene.lightsources[1].shape")
}

/// Case 32: a point light at a point, or within a few of its rounding errors.
pub(super) fn at_a_point(numbers: &mut Numbers) -> Outcome {
    let unit = numbers.magnitude(1e-6, 1e6);
    let Some((point, _)) = some_point(numbers, unit) else { return Outcome::default() };
    let least = f64::from(point.error.max_abs());
    let [at, normal] = [point.point, point.normal].map(|v| Vec3::from(v).as_dvec3());
    let few = least * numbers.magnitude(1e-3, 10.0);
    let part = unit * numbers.magnitude(1e-9, 1e-5);
    let any = numbers.direction();
    let away = numbers.among([DVec3::ZERO, normal * few, any * few, any * part]);
    let position = (at + away).as_vec3();
    let towards = position.as_dvec3() - at;
    let distance = towards.length();
    shadow_ray(numbers, &point, Emitter::Point(position), |falloff, request| {
        let Some(request) = request else {
            // It is behind or beside the surface, or in the same place.
            return normal.dot(towards) <= 1e-5 * distance;
        };
        let most = 1.0001 * f64::from(POWER) * part_left(falloff, distance.max(least));
        let is_doubtful = (distance / least - 1.0).abs() < 1e-5;
        f64::from(Vec3::from(request.contribution).max_element()) <= most
            && (request.at_light == (distance < least) || is_doubtful)
    })
}

/// Case 32: a light before a wall of any size, which the centre of the image sees. Numbers at the
/// wall are a `step` apart: very near, the light is within the rounding error of the wall; a few
/// steps away it is where the shadow ray starts.
pub(super) fn before_a_wall(numbers: &mut Numbers) -> Vec<Picture> {
    let height = (numbers.index % 12) as f64 - 2.0;
    let side: u32 = numbers.effort.either(9, 65);
    let unit = libm::exp2(numbers.below(41) as f64 - 20.0);
    let eye = Eye::at(DVec3::Z * (5.0 * unit), 50.0, [side; 2]);
    let place = DVec3::Z * (1.5 * unit);
    let wall = scenes::square([place, DVec3::X * unit, DVec3::Y * unit], scenes::white());
    let step = ulp(1.5 * unit);
    let bare = scenes::scene(&eye, &[], std::slice::from_ref(&wall));
    let least = scenes::prepare_whole(&numbers.effort, &bare).ok().and_then(|prepared| {
        let (camera, accel) = (&prepared.scene.camera, &prepared.scene.accel);
        let stream = Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 };
        let ray = camera.ray(side / 2, side / 2, &stream);
        let (_, [_, error, _]) = met(accel, &ray, &mut accel.traversal())?;
        Some(f64::from(error.max_element()))
    });
    // Without a point on the wall no pixel is right.
    let nearest = least.map_or(f64::INFINITY, |least| least.max(height.abs() * step));
    let picture = |falloff: Falloff| {
        let light = scenes::point_light(10.0, place + DVec3::Z * (step * height), falloff.name());
        let scene = scenes::scene(&eye, &[light], std::slice::from_ref(&wall));
        let most = 1.0001 * 0.8 * 10.0 * part_left(falloff, nearest);
        let shows = move |x, y, [pixel, ..]: [f32; 3]| {
            let is_right = [x, y] != [side / 2; 2] || (pixel > 0.0) == (height > 0.0);
            Some(is_right && f64::from(pixel) <= most)
        };
        Picture { at_surface: Some(u64::from(height == 1.0)), ..Picture::new(scene, shows) }
    };
    Falloff::ALL.map(picture).into()
}

/// Case 33: an open sheet, with a light before its tilted normals: lit if the light is before the
/// sheet too, black if it is behind, where nothing else hides it.
pub(super) fn behind_a_sheet(numbers: &mut Numbers) -> Vec<Picture> {
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * numbers.one());
    let aside = DVec3::new(cos, 0.0, sin);
    let place = aside * numbers.magnitude(2.0, 20.0);
    // At least 63 degrees, so that a light is before the normals at up to 26 degrees behind the
    // sheet.
    let normal = (aside * numbers.magnitude(2.0, 4.0) + DVec3::Y).normalize().to_array();
    let corners = corners(Vec3::ZERO, Vec3::Z, Vec3::X).map(|p| p.as_dvec3());
    let sheet = scenes::mesh(&corners, &[[0, 1, 2], [0, 2, 3]], scenes::white());
    let sheet = scenes::with(sheet, json!({"shading": "smooth", "normals": vec![normal; 4]}));
    let eye = Eye::above(10.0, numbers.effort.either(8, 32));
    let picture = |side: f64| {
        let light = place + DVec3::Y * (side * numbers.magnitude(1e-3, 0.4));
        let lights = [scenes::point_light(100.0, light, "none")];
        let scene = scenes::scene(&eye, &lights, std::slice::from_ref(&sheet));
        // Or the light behind would be left out before any kernel can err.
        let picture =
            Picture::new(scene, move |_, _, pixel| Some((pixel != [0.0; 3]) == (side > 0.0)));
        Picture { whole: true, ..picture }
    };
    [1.0, -1.0].map(picture).into()
}

/// Case 36: light and view from extreme directions.
pub(super) fn highlights(numbers: &mut Numbers) -> Outcome {
    let normal = numbers.direction().as_vec3();
    let view = [numbers.direction().as_vec3(), normal][numbers.below(2)];
    let nearly = (numbers.direction() * numbers.magnitude(1e-9, 1e-5)).as_vec3();
    let any = numbers.direction().as_vec3();
    let to_light = numbers.among([-view, normalize(nearly - view), view, any]);
    let [ks, kd] = [(); 2].map(|()| [0.0, 1.0, numbers.one() as f32][numbers.below(3)]);
    let exponent = exponents(numbers)[numbers.below(7)] as f32;
    let material = Material { ks, kd, exponent, ..MATERIAL }.reflection();
    let [at, from, to] = [normal, view, to_light].map(Vector::from);
    let found = Vec3::from(reflect(&material, Vec3::ONE.into(), at, from, to));
    let most = 1.000_01 * f64::from(ks + kd);
    let is_right =
        found.is_finite() && found.min_element() >= 0.0 && f64::from(found.max_element()) <= most;
    Outcome::of(is_right, || {
        format!("{found} of {material:?}, normal {normal}, view {view}, light {to_light}")
    })
}

/// Exponents, of any size and including the limits of scenes.
fn exponents(numbers: &mut Numbers) -> [f64; 7] {
    let any = numbers.magnitude(1e-6, 1e6);
    [0.0, 1e-30, 1.0, 999_999.5, 1e6, any.round(), any]
}

/// Case 36: a ball under one light, from the eye, from behind it, or from anywhere, so that the half
/// vector is the view, vanishes nearly, or has any direction. No pixel is brighter than the
/// material reflects.
pub(super) fn shiny_ball(numbers: &mut Numbers) -> Vec<Picture> {
    let (any, exponent) = (numbers.one(), exponents(numbers)[numbers.index % 7]);
    let [ks, kd] = [(); 2].map(|()| numbers.among([0.0, 1.0, any]));
    let material = json!({"ks": ks, "kd": kd, "specularexponent": exponent,
                          "diffusecolor": [1, 1, 1]});
    let ball = scenes::sphere(DVec3::ZERO, 1.0, material);
    let location = numbers.direction() * 4.0;
    let eye = Eye::at(location, 40.0, [24, 24]);
    let picture = |position| {
        let light = scenes::point_light(1.0, position, "none");
        let scene = scenes::scene(&eye, &[light], std::slice::from_ref(&ball));
        let shows = move |x, y, [pixel, ..]: [f32; 3]| {
            // Beside the ball is the background.
            let is_seen = location.cross(eye.direction(x, y)).length() < 0.999;
            is_seen.then_some((0.0..=1.000_01 * (ks + kd)).contains(&f64::from(pixel)))
        };
        Picture::new(scene, shows).like_itself()
    };
    [location, -location, location * 0.375, numbers.direction() * 4.0].map(picture).into()
}

/// Half angles of the cones of case 41 in degrees, where the inner one is either 0 or the same.
const OUTER: [f64; 7] = [0.0, 1e-6, 1e-3, 0.1, 30.0, 45.0, 90.0];

/// The floor, in this light.
fn lit_floor(numbers: &Numbers, light: Value) -> (Eye, Value) {
    let eye = Eye::above(90.0, numbers.effort.either(17, 65));
    (eye, scenes::scene(&eye, &[light], &[scenes::floor(100.0, scenes::white())]))
}

/// Case 41: spots that point at the origin, straight down or aslant. Everything inside a cone is
/// lit, everything outside is black, and so is the axis itself of a cone of 0 degrees.
pub(super) fn cones(numbers: &mut Numbers) -> Vec<Picture> {
    /// Within this distance of the edge of a cone, as a cosine, rounding decides.
    const DOUBTFUL: f64 = 1e-6;
    let outer = OUTER[numbers.index % OUTER.len()];
    let edge = if outer == 90.0 { 0.0 } else { libm::cos(outer.to_radians()) };
    // Few axes are as they were after all roundings.
    let count = if outer == 0.0 { 24 } else { 1 };
    let mut aslant = || DVec3::from([(); 3].map(|()| 1.0 + numbers.below(1000) as f64));
    let aslant: Vec<DVec3> = (0..count).map(|_| aslant()).collect();
    let picture = |from: DVec3, inner: f64| {
        let spot = json!({"type": "spotlight", "intensity": 10, "color": [1, 1, 1],
                          "position": from.to_array(), "direction": (-from).to_array(),
                          "inner": inner, "outer": outer, "falloff": "none"});
        let (eye, scene) = lit_floor(numbers, spot);
        let shows = move |x, y, pixel: [f32; 3]| {
            let hit = eye.on_floor(eye.direction(x, y));
            let within = (from - hit).normalize().dot(from.normalize()) - edge;
            let is_lit = within > 0.0 && outer > 0.0;
            (within.abs() > DOUBTFUL || outer == 0.0).then_some((pixel[0] > 0.0) == is_lit)
        };
        Picture::new(scene, shows)
    };
    std::iter::once(DVec3::Y * 2.0)
        .chain(aslant)
        .flat_map(|from| [0.0, outer].map(|inner| picture(from, inner)))
        .collect()
}

/// Case 41: parallel light in the plane of the floor adds nothing, and half of the light from half
/// of the sky is above the floor.
pub(super) fn along_the_floor(numbers: &mut Numbers) -> Vec<Picture> {
    let angle: f64 = [0.0, 1e-6, 0.53, 180.0][numbers.index];
    let light = json!({"type": "directionallight", "intensity": 1, "color": [1, 1, 1],
                       "direction": [1, 0, 0], "angle": angle, "samples": 16});
    let (_, scene) = lit_floor(numbers, light);
    // At most all directions at the greatest height.
    let most = (angle / 2.0).to_radians().sin() as f32;
    let shows = move |_, _, pixel: [f32; 3]| {
        Some((0.0..=most).contains(&pixel[0]) && (angle < 1.0 || pixel[0] > 0.0))
    };
    vec![Picture::new(scene, shows)]
}

/// Case 61: inside a closed mesh nothing of a sky arrives, and on a plate alone all of it.
pub(super) fn under_the_sky(numbers: &mut Numbers) -> Vec<Picture> {
    let size = numbers.magnitude(1e-3, 1e5);
    let middle = numbers.direction() * (size * numbers.among([0.0, 1.0, 100.0]));
    let closed = Closed::new(numbers, [8, 12], 0.5, (DVec3::splat(size), middle.as_vec3()));
    let points: Vec<DVec3> = closed.geometry.positions.iter().map(|p| p.as_dvec3()).collect();
    let globe = scenes::mesh(&points, &closed.geometry.triangles, scenes::white());
    let (u, v) = numbers.direction().any_orthonormal_pair();
    let plate = scenes::square([middle, u * size, v * size], scenes::white());
    let [inside, before] =
        [closed.inside(numbers).as_dvec3(), middle + numbers.direction() * (3.0 * size)];
    let sampling = numbers.among(["random", "sobol"]);
    let sky = json!({"scene": {"ambient": {"sky": [1, 1, 1], "samples": 8, "sampling": sampling}}});
    [(inside, inside + u * size, globe, 0.0), (before, middle, plate, 1.0)]
        .map(|(from, look, shape, right)| {
            let eye = Eye { look, ..Eye::at(from, 60.0, [8, 8]) };
            let scene = scenes::with(scenes::scene(&eye, &[], &[shape]), sky.clone());
            let shows = move |_, _, pixel: [f32; 3]| {
                let is_met = pixel != scenes::BACKGROUND.map(|value| value as f32);
                is_met.then(|| (pixel[0] - right).abs() < 1e-6)
            };
            Picture::new(scene, shows).like_itself()
        })
        .into()
}
