//! Instances of meshes: rotated, stretched, mirrored, sheared, and far away.

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use super::case::{Effort, Outcome};
use super::closed::{Closed, globe};
use super::trees::by_brute_force;
use super::ways::{Numbers, every_way, inputs};
use wavecrest_core::accel::Hit;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::math::ray::Ray;

/// Scenes of row 44, places of instances in each, and instances at a place.
const SCENES: usize = 20;
const PLACES: u32 = 6;
const COPIES: u32 = 2;

/// A ray from inside that hits something later than this, relative to its target, has left its
/// instance.
const BEYOND: f32 = 1.1;

/// Case 44.
pub(super) fn shown(effort: &Effort) -> Outcome {
    let mut outcome = between_numbers(effort);
    outcome.add(turned(effort));
    outcome
}

fn turned(effort: &Effort) -> Outcome {
    (0..SCENES)
        .map(|scene| {
            let mut numbers = Numbers::new(effort, 44, usize::MAX - scene);
            let place = (numbers.magnitude(1e-2, 1e2), Vec3::ZERO);
            let closed = globe(numbers.clone(), [5, 8], 0.3, place);
            let geometry = instances_of(&closed, &mut numbers, place.0);
            let start = scene * 1_000_000;
            let inputs = inputs(effort, 44, start..start + effort.of(2_000_000) / SCENES);
            let (inside, others): (Vec<Ray>, Vec<Ray>) =
                inputs.map(|mut numbers| rays(&geometry, &closed, &mut numbers)).unzip();
            let mut outcome = never_left(effort, &geometry, &inside);
            outcome.add(as_brute_force(effort, &geometry, &others));
            outcome.with_context(|| format!("scene {scene}"))
        })
        .sum()
}

/// Instances of a mesh of about this `size`, from next to the origin to far away: of those at a place
/// the first is hit, and others do not touch each other.
fn instances_of(closed: &Closed, numbers: &mut Numbers, size: f64) -> Geometry {
    let prototype = closed.geometry.clone();
    let bounds = prototype.positions.iter().map(|&p| Aabb { low: p, high: p });
    let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
    let triangles = prototype.triangles.len() as u32;
    let place = |number: u32| {
        // By up to 4 along each axis: they stay within 8 sizes of their places, which are 20 apart.
        let stretched = DVec3::from([(); 3].map(|()| numbers.magnitude(0.25, 4.0)));
        let angle = std::f64::consts::TAU * numbers.one();
        let turned = DMat3::from_quat(DQuat::from_axis_angle(numbers.direction(), angle));
        let mirrored = DVec3::new(numbers.sign(), 1.0, 1.0);
        let matrix = turned * DMat3::from_diagonal(stretched * mirrored);
        let far = DVec3::X * (20.0 * f64::from(number)) + DVec3::Y * numbers.magnitude(1.0, 1e4);
        DAffine3 { matrix3: matrix, translation: far * size }
    };
    let places: Vec<DAffine3> = (0..PLACES).map(place).collect();
    let placed = (0..).zip(places.repeat(COPIES as usize));
    let instances = placed
        .map(|(number, place)| Instance::new(0, number * triangles, place, &bounds))
        .collect();
    Geometry { prototypes: vec![prototype], instances, ..Geometry::default() }
}

/// A ray from inside an instance at a point of an edge; and one from a random point at an extreme
/// point of an instance's box.
fn rays(geometry: &Geometry, closed: &Closed, numbers: &mut Numbers) -> (Ray, Ray) {
    let instance = &geometry.instances[numbers.below(geometry.instances.len())];
    let to_world = |point: DVec3| instance.to_world().transform_point3(point);
    let corners = closed.geometry.triangle(numbers.below(closed.geometry.triangles.len()));
    let [a, b, _] = corners.map(|corner| corner.as_dvec3());
    let inside = numbers.direction() * (0.5 * numbers.one() * f64::from(closed.radius));
    let origin = to_world(inside).as_vec3();
    let target = to_world(a + (b - a) * [0.0, numbers.one()][numbers.below(2)]);
    let elsewhere = &geometry.instances[numbers.below(geometry.instances.len())];
    let from = elsewhere.to_world().translation + numbers.direction() * target.length();
    let at = |from: Vec3| Ray::new(from, (target - from.as_dvec3()).as_vec3());
    (at(origin), at(from.as_vec3()))
}

/// Rays from inside, with t = 1 at the edge: a ray without a hit there has left through an edge, or
/// missed the instance.
fn never_left(effort: &Effort, geometry: &Geometry, rays: &[Ray]) -> Outcome {
    let presets = [Preset::Brute, Preset::VeryFast, Preset::Medium].map(|preset| {
        every_way(effort.accel(geometry.clone(), preset), rays, |_, _, hit| {
            let is_right = !hit.is_miss() && hit.t < BEYOND;
            (!is_right).then(|| format!("{}: {hit:?} and not at 1", preset.name()))
        })
    });
    presets.into_iter().sum()
}

/// Boxes lose no hits at the extreme points.
fn as_brute_force(effort: &Effort, geometry: &Geometry, rays: &[Ray]) -> Outcome {
    let expected = by_brute_force(effort, geometry, rays);
    every_way(effort.accel(geometry.clone(), Preset::VeryFast), rays, |i, _, hit: Hit| {
        (hit != expected[i]).then(|| format!("{hit:?} and not {:?}", expected[i]))
    })
}

/// The side of a plate of [`between_numbers`].
const SIDE: f32 = 16.0;

/// Plates that are met because a ray is rounded in their space.
///
/// A shear takes the origin of a ray to where numbers of single precision are 16 apart. So a ray
/// that passes the plate by up to 6 in the world meets it in its own space, at the same t, for its
/// direction there is of small integers.
fn between_numbers(effort: &Effort) -> Outcome {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z * SIDE);
    let plate = Geometry {
        positions: vec![
            corner(-SIDE, -0.5),
            corner(1.0, -0.5),
            corner(1.0, 0.5),
            corner(-SIDE, 0.5),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Geometry::default()
    };
    let bounds = Aabb { low: plate.positions[0], high: plate.positions[2] };
    let shear = DMat3::from_cols(DVec3::X, DVec3::ONE.with_z(0.0), DVec3::Z);
    let (mut rays, mut distances, mut instances) = (Vec::new(), Vec::new(), Vec::new());
    for (number, mut numbers) in (0_u32..).zip(inputs(effort, 44, 0..effort.either(64, 512))) {
        let distance = f64::from((1 << 27) + 16 * numbers.below(1 << 20) as u32);
        let beside = 2.0 + numbers.below(6) as f64;
        // The rays of other plates are farther away than their side.
        let along = f64::from(number) * f64::from(2.0 * SIDE);
        let axes = axes(&mut numbers);
        let place = axes * DVec3::new(-beside, distance, along);
        let to_world = DAffine3 { matrix3: axes * shear, translation: place };
        instances.push(Instance::new(0, 2 * number, to_world, &bounds));
        rays.push(Ray::new((axes * (along * DVec3::Z)).as_vec3(), (axes * DVec3::Y).as_vec3()));
        distances.push(distance as f32);
    }
    let geometry = Geometry { prototypes: vec![plate], instances, ..Geometry::default() };
    every_way(effort.accel(geometry, Preset::VeryFast), &rays, |i, _, hit| {
        let is_met = hit.t == distances[i] && hit.primitive / 2 == i as u32;
        (!is_met).then(|| format!("{hit:?} and not at {}", distances[i]))
    })
}

/// The axes in any order and in either direction.
fn axes(numbers: &mut Numbers) -> DMat3 {
    let turn = numbers.below(3);
    let axis = |k: usize| DVec3::AXES[(k + turn) % 3];
    let [x, y, z] = [0, 1, 2].map(|k| axis(k) * numbers.sign());
    DMat3::from_cols(x, y, z)
}
