//! Lights at extreme positions, and reflection at extreme angles and exponents.

use super::prelude::*;
use super::surfaces::on_triangle;
use wavecrest_core::kernels::blinn_phong::{Material, reflect};
use wavecrest_core::kernels::light::{Emitter, Falloff, Light, Triangles};
use wavecrest_core::kernels::shade::{ShadingPoint, ShadowRequest, shadow_request};
use wavecrest_core::kernels::surface::Surface;
use wavecrest_core::math::float::normalize;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::math::vector::Vector;

const FALLOFFS: [Falloff; 3] = [Falloff::Linear, Falloff::InverseSquare, Falloff::None];
const FALLOFF_NAMES: [&str; 3] = ["linear", "inverse-square", "none"];

/// The power of the lights in tests of kernels.
const POWER: f32 = 10.0;

const MATERIAL: Material = Material { ks: 0.5, kd: 0.5, exponent: 8.0, color: Vec3::ONE, kr: 0.0 };

/// A point of a triangle, seen from its front.
fn shading_point(numbers: &mut Numbers, surface: &Surface<f32>) -> ShadingPoint<f32> {
    let view = numbers.direction().as_vec3();
    ShadingPoint {
        point: surface.point,
        error: surface.error,
        normal: surface.normal,
        shading_normal: surface.normal,
        view: if view.dot(surface.normal.into()) < 0.0 { -view } else { view }.into(),
        color: Vec3::ONE.into(),
        occlusion: 1.0,
        emission: Vec3::ZERO.into(),
        reflection: MATERIAL.reflection(),
        kr: MATERIAL.kr,
        lit: true,
    }
}

/// The shadow ray from a point to a light.
fn request(
    numbers: &mut Numbers,
    point: &ShadingPoint<f32>,
    emitter: Emitter,
    falloff: Falloff,
) -> Option<ShadowRequest<f32>> {
    let (power, sampling) = (Vec3::splat(POWER), Sampling::Jittered);
    let light = Light { emitter, power, falloff, sampling, grid: [1, 1], dimension: 1 };
    let stream = Stream { seed: 0, pixel: numbers.below(1 << 20) as u32, sample: 0, bounce: 0 };
    shadow_request(point, Vec3::ONE.into(), &light, &light.point(0, &stream))
}

/// Case 31: a point, and a light that it sees edge on, that contains it, or that is a needle.
pub(super) fn edge_on(numbers: &mut Numbers) -> Outcome {
    let unit = numbers.magnitude(1e-3, 1e3);
    let corners = numbers.triangle(unit);
    let surface = on_triangle(Tests::from(&numbers.effort), numbers, &corners);
    let Some(surface) = surface else { return Outcome::default() };
    let point = shading_point(numbers, &surface);
    let near = Vec3::from(surface.point);
    let [p, q] = [(); 2].map(|()| near + (numbers.direction() * unit).as_vec3());
    let needle = q + (numbers.direction() * (1e-6 * unit)).as_vec3();
    // In the light's plane, beside it and at its corner; the point's own surface.
    let shape = numbers.among([[p, q, p + (p - near)], [near, p, q], corners, [p, q, needle]]);
    let falloff = numbers.among(FALLOFFS);
    let Some(triangles) = Triangles::new(vec![shape]) else { return Outcome::default() };
    let request = request(numbers, &point, Emitter::Triangles(triangles), falloff);
    let is_right = request.as_ref().is_none_or(|request| {
        let contribution = Vec3::from(request.contribution);
        let is_valid = contribution.is_finite() && contribution.min_element() >= 0.0;
        is_valid && request.ray().direction.is_finite()
    });
    Outcome::of(is_right, || format!("{request:?} from {point:?} to {shape:?}"))
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
    let falloff = FALLOFF_NAMES[numbers.index % 3];
    let eye = Eye::above(50.0, numbers.effort.either(17, 65));
    let picture = |shape| {
        let light = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                           "falloff": falloff, "sampling": "jittered", "samples": 2,
                           "shape": shape});
        let scene = scenes::scene(&eye, &[light], &[scenes::floor(3.0)]);
        Picture::new(scene, |_, _, pixel| Some(pixel.iter().all(|value| *value >= 0.0)))
    };
    shapes.map(picture).into()
}

/// Case 31: shapes without area.
pub(super) fn without_area(numbers: &mut Numbers) -> Refusal {
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
    Refusal::at(&scenes::scene(&eye, &[first, light], &[]), "scene.lightsources[1].shape")
}

/// Case 32: a point light at a point, or within a few of its rounding errors.
pub(super) fn at_a_point(numbers: &mut Numbers) -> Outcome {
    let mut outcome = Outcome::default();
    let unit = numbers.magnitude(1e-6, 1e6);
    let corners = numbers.triangle(unit);
    let surface = on_triangle(Tests::from(&numbers.effort), numbers, &corners);
    let Some(surface) = surface else { return outcome };
    let point = shading_point(numbers, &surface);
    let least = f64::from(surface.error.max_abs());
    let [at, normal] = [surface.point, surface.normal].map(|v| Vec3::from(v).as_dvec3());
    let few = least * numbers.magnitude(1e-3, 10.0);
    let part = unit * numbers.magnitude(1e-9, 1e-5);
    let any = numbers.direction();
    let away = numbers.among([DVec3::ZERO, normal * few, any * few, any * part]);
    let position = (at + away).as_vec3();
    let falloff = numbers.among(FALLOFFS);
    let request = request(numbers, &point, Emitter::Point(position), falloff);
    let towards = position.as_dvec3() - at;
    let distance = towards.length();
    let context = || format!("{request:?} from {point:?} to {position}");
    let Some(request) = &request else {
        let is_before = normal.dot(towards) > 1e-5 * distance && distance > 0.0;
        outcome.check(!is_before, || format!("it is left out: {}", context()));
        return outcome;
    };
    let sphere = 4.0 * std::f64::consts::PI;
    let nearest = distance.max(least);
    let left = match falloff {
        Falloff::Linear => 1.0 / (sphere * nearest),
        Falloff::InverseSquare => 1.0 / (sphere * nearest * nearest),
        Falloff::None => 1.0,
    };
    let most = f64::from(POWER * (MATERIAL.kd + MATERIAL.ks)) * left * 1.0001;
    let contribution = Vec3::from(request.contribution);
    let is_bounded = contribution.is_finite() && f64::from(contribution.max_element()) <= most;
    outcome.check(is_bounded, || format!("more than {most}: {}", context()));
    let is_doubtful = (distance / least - 1.0).abs() < 1e-5;
    let is_counted = request.at_light == (distance < least) || is_doubtful;
    outcome.check(is_counted, || format!("{distance}, {least}: {}", context()));
    outcome
}

/// Case 32: a light before a wall at z = 1.5, which the centre of the image sees. Numbers there are
/// 2^-23 apart: very near, the light is within the rounding error of the wall; a few ulp away it is
/// where the shadow ray starts.
pub(super) fn before_a_wall(numbers: &mut Numbers) -> Vec<Picture> {
    let height = numbers.index as i32 - 2;
    let side: u32 = numbers.effort.either(9, 65);
    let eye = Eye::at(DVec3::Z * 5.0, 50.0, [side; 2]);
    let place = DVec3::Z * 1.5;
    let wall = scenes::square([place, DVec3::X, DVec3::Y], scenes::white());
    let ulp = f64::from(1.5_f32.next_up() - 1.5);
    let picture = |falloff| {
        let light =
            scenes::point_light(10.0, place + DVec3::Z * (ulp * f64::from(height)), falloff);
        let scene = scenes::scene(&eye, &[light], std::slice::from_ref(&wall));
        let shows = move |x, y, pixel: [f32; 3]| {
            ([x, y] == [side / 2; 2]).then_some((pixel[0] > 0.0) == (height > 0))
        };
        Picture { at_surface: Some(u64::from(height == 1)), ..Picture::new(scene, shows) }
    };
    FALLOFF_NAMES.map(picture).into()
}

/// Case 33: smooth normals on a convex mesh, tilted at random, up to nearly along the surface. No
/// face turned away from the light is lit.
pub(super) fn horizon(numbers: &mut Numbers) -> Vec<Picture> {
    let mesh = super::shapes::convex(numbers.among([1, 2, 4]), 64.0, 1.0 / 64.0);
    let light = numbers.direction() * 64.0 * numbers.magnitude(1.1, 10.0);
    let location = numbers.direction() * 200.0;
    let eye = Eye::at(location, 40.0, [32, 32]);
    let tilt = numbers.among([0.0, 0.5, 3.0]);
    let normals = mesh
        .positions
        .iter()
        .map(|p| (p.as_dvec3().normalize() + numbers.direction() * tilt).normalize().to_array());
    let normals: Vec<[f64; 3]> = normals.collect();
    let shiny = json!({"ks": 1, "kd": 1, "specularexponent": 2, "diffusecolor": [1, 1, 1]});
    let mut shape = scenes::mesh(&mesh.positions, &mesh.triangles, shiny);
    shape["shading"] = json!("smooth");
    shape["normals"] = json!(normals);
    let lights = [scenes::point_light(100.0, light, "none")];
    let scene = scenes::scene(&eye, &lights, &[shape]);
    // Closer to a face's plane than this, rounding decides whether the light is in front of it.
    let doubtful = 64.0 * f64::from(f32::EPSILON) * light.length();
    let shows = move |x, y, pixel| {
        let triangle = super::shapes::seen(&mesh, location, eye.direction(x, y))?;
        let is_behind = super::shapes::height(&mesh, triangle, light) < -doubtful;
        is_behind.then_some(pixel == [0.0; 3])
    };
    vec![Picture { presets: scenes::PRESETS, ..Picture::new(scene, shows) }]
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
    let corners = super::shapes::corners(Vec3::ZERO, Vec3::Z, Vec3::X);
    let mut sheet = scenes::mesh(&corners, &[[0, 1, 2], [0, 2, 3]], scenes::white());
    sheet["shading"] = json!("smooth");
    sheet["normals"] = json!(vec![normal; 4]);
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

/// Case 36.
pub(super) fn highlights(numbers: &mut Numbers) -> Outcome {
    let normal = numbers.direction().as_vec3();
    let view = [numbers.direction().as_vec3(), normal][numbers.below(2)];
    let nearly = (numbers.direction() * numbers.magnitude(1e-9, 1e-5)).as_vec3();
    let any = numbers.direction().as_vec3();
    let to_light = numbers.among([-view, normalize(nearly - view), view, any]);
    let [ks, kd] = [(); 2].map(|()| [0.0, 1.0, numbers.one() as f32][numbers.below(3)]);
    // Including the limits of scenes.
    let of_any_size = numbers.magnitude(1e-6, 1e6) as f32;
    let exponents = [0.0, 1e-30, 1.0, 1e6, 999_999.5, of_any_size.round(), of_any_size];
    let material = Material { ks, kd, exponent: numbers.among(exponents), ..MATERIAL };
    let [to, from] = [to_light, view].map(Vector::from);
    let found = reflect(&material.reflection(), Vec3::ONE.into(), normal.into(), from, to);
    let found = Vec3::from(found);
    let is_right = found.is_finite()
        && found.min_element() >= 0.0
        && f64::from(found.max_element()) <= f64::from(ks + kd) * 1.00001;
    Outcome::of(is_right, || {
        format!("{found} of {material:?}, normal {normal}, view {view}, light {to_light}")
    })
}

/// Case 36: a ball, with the same image in every way of rendering.
pub(super) fn shiny_ball(numbers: &mut Numbers) -> Vec<Picture> {
    let mut shiny = scenes::matte([0.5; 3]);
    shiny["ks"] = json!(1);
    shiny["specularexponent"] = json!([0.0, 1e-30, 0.5, 1.0, 999_999.5, 1e6][numbers.index]);
    let location = DVec3::Z * 4.0;
    // At the eye, where the half vector is the view, and behind the visible surface.
    let lights = [location, -location, DVec3::Z * 1.5]
        .map(|position| scenes::point_light(40.0, position, "linear"));
    let ball = scenes::sphere(DVec3::ZERO, 1.0, shiny);
    let scene = scenes::scene(&Eye::at(location, 40.0, [24, 24]), &lights, &[ball]);
    vec![Picture::new(scene, |_, _, _| None).like_itself()]
}

/// Half angles of the cones of case 41 in degrees, inner and outer.
pub(super) const CONES: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [0.0, 1e-6],
    [1e-3, 1e-3],
    [30.0, 30.0],
    [0.0, 45.0],
    [45.0, 45.0],
    [0.0, 90.0],
    [90.0, 90.0],
];

fn spot(position: [f64; 3], direction: [f64; 3], [inner, outer]: [f64; 2]) -> Value {
    json!({"type": "spotlight", "intensity": 10, "position": position, "color": [1, 1, 1],
           "direction": direction, "inner": inner, "outer": outer, "falloff": "none"})
}

/// The floor, in this light.
fn lit_floor(numbers: &Numbers, light: Value) -> (Eye, Value) {
    let eye = Eye::above(90.0, numbers.effort.either(17, 65));
    (eye, scenes::scene(&eye, &[light], &[scenes::floor(100.0)]))
}

/// Case 41: a spot that points straight down. Everything inside the cone is lit, everything outside
/// is black.
pub(super) fn cones(numbers: &mut Numbers) -> Vec<Picture> {
    const HEIGHT: f64 = 2.0;
    /// Within this distance of the edge of a cone, as a cosine, rounding decides.
    const DOUBTFUL: f64 = 1e-6;
    let cone = CONES[numbers.index];
    let (eye, scene) = lit_floor(numbers, spot([0.0, HEIGHT, 0.0], [0.0, -3.0, 0.0], cone));
    let edge = if cone[1] == 90.0 { 0.0 } else { cone[1].to_radians().cos() };
    let shows = move |x, y, pixel: [f32; 3]| {
        let hit = eye.on_floor(eye.direction(x, y));
        let within = HEIGHT / (hit - DVec3::Y * HEIGHT).length() - edge;
        let is_lit = within > 0.0 && cone[1] > 0.0;
        (within.abs() > DOUBTFUL || cone[1] == 0.0).then_some((pixel[0] > 0.0) == is_lit)
    };
    vec![Picture::new(scene, shows)]
}

/// Case 41: a spot that points at the origin lights it through the narrowest cone, and nothing
/// through one of 0 degrees, though the origin is on its axis.
pub(super) fn at_the_origin(numbers: &mut Numbers) -> Vec<Picture> {
    let from = [(); 3].map(|()| 1.0 + numbers.below(1000) as f64);
    let picture = |outer: f64| {
        let (eye, scene) = lit_floor(numbers, spot(from, from.map(|x| -x), [0.0, outer]));
        let middle = eye.size.map(|side| side / 2);
        let shows = move |x, y, pixel: [f32; 3]| {
            let is_right = (pixel[0] > 0.0) == (outer > 0.0);
            ([x, y] == middle || outer == 0.0).then_some(is_right)
        };
        Picture::new(scene, shows)
    };
    [0.0, 0.1].map(picture).into()
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
