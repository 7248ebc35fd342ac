//! Instances of meshes: rotated, stretched, mirrored, sheared, and far away.

use glam::{DAffine3, DMat3};

use super::aim::around;
use super::prelude::*;
use super::shapes::Closed;
use wavecrest_core::geometry::instance::Instance;

/// Places of instances in a world, and instances at a place.
const PLACES: u32 = 6;
const COPIES: usize = 2;

/// Case 44.
pub(super) fn any(rng: &mut InputRng) -> World {
    [never_left, between_numbers][rng.index % 2](rng)
}

/// Instances of `prototype` at these places.
fn instances(prototype: Geometry, places: impl IntoIterator<Item = DAffine3>) -> Geometry {
    let bounds = around(&prototype);
    let triangles = prototype.triangles.len() as u32;
    let placed = (0_u32..).zip(places);
    let instances = placed.map(|(n, place)| Instance::new(0, n * triangles, place, &bounds));
    let instances = instances.collect();
    Geometry { prototypes: vec![prototype], instances, ..Geometry::default() }
}

/// Instances of a closed mesh, from next to the origin to far away: of those at a place the first
/// is hit, and others do not touch each other.
fn closed(rng: &mut InputRng) -> (Geometry, Closed) {
    let size = rng.magnitude(1e-2, 1e2);
    let closed = Closed::new(rng, [5, 8], 0.3, DVec3::splat(size), Vec3::ZERO);
    let place = |number: u32| {
        // By up to 4 along each axis: they stay within 8 sizes of their places, which are 20 apart.
        let stretched = DVec3::from([(); 3].map(|()| rng.magnitude(0.25, 4.0)));
        let mirrored = DVec3::new(rng.sign(), 1.0, 1.0);
        let matrix3 = rng.rotation() * DMat3::from_diagonal(stretched * mirrored);
        let far = DVec3::X * (20.0 * f64::from(number)) + DVec3::Y * rng.magnitude(1.0, 1e4);
        DAffine3 { matrix3, translation: far * size }
    };
    let places: Vec<DAffine3> = (0..PLACES).map(place).collect();
    (instances(closed.geometry.clone(), places.repeat(COPIES)), closed)
}

/// Rays from inside at points of edges.
fn never_left(rng: &mut InputRng) -> World {
    let (geometry, closed) = closed(rng);
    World::new(geometry.clone(), ALL_HIT, move |rng| {
        let instance = &geometry.instances[rng.below(geometry.instances.len())];
        let corners = closed.geometry.triangle(rng.below(closed.geometry.triangles.len()));
        let target = instance.to_world().transform_point3(rng.on_edge(corners));
        let origin = instance.point(closed.inside(rng));
        Some(Ray::new(origin, (target - origin.as_dvec3()).as_vec3()))
    })
}

/// Half the length of a plate of [`between_numbers`], and the number of plates.
const HALF: f32 = 8.0;
const PLATES: u32 = 512;

/// Plates that are met because a ray is rounded in their space.
///
/// A shear takes the origin of a ray to where numbers of single precision are 16 apart. So a ray
/// that passes the plate by up to 6 in the world meets it in its own space, at the same t, for its
/// direction there is of small integers.
fn between_numbers(rng: &mut InputRng) -> World {
    let mut plate = Geometry::default();
    let along = Vec3::X * (HALF + 0.5);
    add_sheet(&mut plate, corners(Vec3::X * (0.5 - HALF), along, Vec3::Z * HALF));
    let shear = DMat3::from_cols(DVec3::X, DVec3::ONE.with_z(0.0), DVec3::Z);
    let mut aimed = Vec::new();
    let places: Vec<DAffine3> = (0..PLATES)
        .map(|number| {
            let distance = f64::from((1 << 27) + 16 * rng.below(1 << 20) as u32);
            let beside = 2.0 + rng.below(6) as f64;
            // The rays of other plates are farther away than their side.
            let along = f64::from(number) * f64::from(4.0 * HALF);
            // The axes in any order and in either direction.
            let turn = rng.below(3);
            let [x, y, z] = [0, 1, 2].map(|k| DVec3::AXES[(k + turn) % 3] * rng.sign());
            aimed.push(Ray::new((z * along).as_vec3(), y.as_vec3()));
            let axes = DMat3::from_cols(x, y, z);
            let translation = axes * DVec3::new(-beside, distance, along);
            DAffine3 { matrix3: axes * shear, translation }
        })
        .collect();
    World::new(instances(plate, places), ALL_HIT, move |rng| Some(aimed[rng.index % aimed.len()]))
}
