use std::cmp::Ordering;

use glam::{DAffine3, DQuat, Vec3};
use proptest::prelude::*;
use proptest::test_runner::Config;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Crossings, Hit, KernelChoice};
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::geometry::{Geometry, Primitive, Quadric};
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::kernels::quad::halves;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;

use crate::exact::{Exact, meeting, rounded_once};
use crate::inputs::{magnitude, unit};
use crate::{disk, sphere};

/// A place where surfaces nearly coincide: half as wide as a wall, and with the plane's normal.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Vec3,
    normal: Vec3,
    width: f32,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Triangle,
    Quad,
    Disk,
    /// On either side, of a radius in widths.
    Sphere(f32),
    Instance,
}

/// A surface at a place: beside the plane by some of the least steps at its coordinates and by a
/// length, and turned within it.
#[derive(Clone, Copy, Debug)]
struct Wall {
    kind: Kind,
    steps: i8,
    beside: f32,
    turn: f32,
    is_passed: bool,
}

fn place() -> impl Strategy<Value = Place> {
    let normal = prop_oneof![Just(Vec3::Z), Just(Vec3::NEG_Y), unit()];
    (normal, unit(), magnitude(-2, 4), prop_oneof![Just(0.0), Just(1.0), Just(100.0)])
        .prop_map(|(normal, at, width, away)| Place { at: at * away, normal, width: width.abs() })
}

fn walls() -> impl Strategy<Value = Vec<Wall>> {
    let kind = prop_oneof![
        2 => Just(Kind::Triangle),
        2 => Just(Kind::Quad),
        1 => Just(Kind::Disk),
        1 => magnitude(-8, 6).prop_map(Kind::Sphere),
        1 => Just(Kind::Instance),
    ];
    let beside = prop_oneof![3 => Just(0.0), 1 => magnitude(-24, -10)];
    let turn = prop_oneof![Just(0.0), 0.0_f32..3.0];
    let wall = (kind, prop_oneof![Just(0), -2_i8..=2], beside, turn, any::<bool>()).prop_map(
        |(kind, steps, beside, turn, is_passed)| Wall { kind, steps, beside, turn, is_passed },
    );
    // Some twice.
    prop::collection::vec((wall, prop_oneof![5 => Just(1_usize), 1 => Just(2)]), 1..12)
        .prop_map(|walls| walls.into_iter().flat_map(|(wall, times)| vec![wall; times]).collect())
}

impl Place {
    /// Four corners of a wall around the place.
    fn corners(&self, wall: &Wall) -> [Vec3; 4] {
        let along = self.normal.any_orthonormal_vector();
        let (sin, cos) = wall.turn.sin_cos();
        let u = (along * cos + self.normal.cross(along) * sin) * (2.0 * self.width);
        let v = self.normal.cross(u);
        let step = self.at.abs().max_element().max(self.width) * f32::EPSILON;
        let middle = self.at + self.normal * (f32::from(wall.steps) * step + wall.beside);
        [middle - u, middle - v, middle + u, middle + v]
    }

    /// The walls as a geometry, those of a kind in their order.
    fn geometry(&self, walls: &[Wall]) -> Geometry {
        let mut geometry = Geometry::default();
        let (mut flags, mut carried) = ([const { Vec::new() }; 3], Vec::new());
        for wall in walls {
            let [a, b, c, d] = self.corners(wall);
            let first = geometry.positions.len() as u32;
            match wall.kind {
                Kind::Triangle => {
                    geometry.positions.extend([a, b, c]);
                    geometry.triangles.push([first, first + 1, first + 2]);
                    flags[0].push(wall.is_passed);
                }
                Kind::Quad => {
                    geometry.positions.extend([a, b, c, d]);
                    geometry.quads.push([0, 1, 2, 3].map(|k| first + k));
                    flags[1].push(wall.is_passed);
                }
                Kind::Disk => {
                    let center = (a + c) * 0.5;
                    let disk = Disk { center, normal: self.normal, radius: self.width };
                    geometry.quadrics.push(Quadric::Disk(disk));
                    flags[2].push(wall.is_passed);
                }
                Kind::Sphere(radius) => {
                    let radius = radius * self.width;
                    let center = (a + c) * 0.5 + self.normal * radius;
                    geometry.quadrics.push(Quadric::Sphere(center, radius.abs()));
                    flags[2].push(wall.is_passed);
                }
                Kind::Instance => carried.push(*wall),
            }
        }
        let flags: Vec<bool> = flags.concat();
        let passed = (0..).zip(flags).filter(|(_, is_passed)| *is_passed);
        geometry.passed = passed.map(|(number, _)| number..number + 1).collect();
        self.add_instances(&mut geometry, &carried);
        geometry
    }

    /// Each of the walls is a prototype in a space of its own.
    fn add_instances(&self, geometry: &mut Geometry, walls: &[Wall]) {
        let own = geometry.own() as u32;
        for (number, wall) in (0..).zip(walls) {
            let turn = DQuat::from_rotation_x(f64::from(wall.turn));
            let world = DAffine3::from_rotation_translation(turn, self.at.as_dvec3());
            let back = world.inverse();
            let corners = self.corners(wall);
            let corners = corners.map(|corner| back.transform_point3(corner.as_dvec3()).as_vec3());
            let bounds = Aabb::around(corners);
            geometry.prototypes.push(Geometry {
                positions: corners.to_vec().into(),
                triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
                ..Geometry::default()
            });
            geometry.instances.push(Instance::new(number, own + 2 * number, world, &bounds));
        }
    }

    /// Rays at the place from this far, some of them from one point, some nearly in the plane.
    fn rays(&self, distance: f32, from: Vec3, targets: &[(f32, f32)]) -> Vec<Ray> {
        let u = self.normal.any_orthonormal_vector() * self.width;
        let v = self.normal.cross(u);
        let rays = targets.iter().enumerate().map(|(i, &(x, y))| {
            // Spheres may be small.
            let within = if i % 4 == 1 { 1.0 / 64.0 } else { 1.0 };
            let target = self.at + (u * x + v * y) * within;
            let aside = if i % 4 == 3 { u * y } else { Vec3::ZERO };
            let origin = self.at + from * distance + aside;
            Ray::new(origin, (target - origin) * if i % 8 == 6 { 1e-3 } else { 1.0 })
        });
        rays.filter(Ray::is_valid).collect()
    }
}

/// Every t at which a ray meets a primitive.
fn met(geometry: &Geometry, ray: &Ray, number: u32) -> Vec<Exact> {
    match geometry.primitive(number) {
        Primitive::Triangle(i) => meeting(ray, &geometry.triangle(i)).into_iter().collect(),
        Primitive::Quad(i) => {
            halves(&geometry.quad(i)).iter().filter_map(|half| meeting(ray, half)).collect()
        }
        Primitive::Quadric(i) => match geometry.quadrics[i] {
            Quadric::Sphere(center, radius) => sphere::meetings(ray, center, radius),
            Quadric::Disk(disk) => disk::meeting(ray, &disk).into_iter().collect(),
        },
        Primitive::Instanced(instanced) => {
            let (instance, prototype) = geometry.instance(instanced);
            met(prototype, &instance.carried(ray), instanced.triangle)
        }
    }
}

/// A surface at t, whether it is flat, and how the order ranks it among those of equal t.
type Ranked = (Exact, bool, (bool, u32));

/// By exact t, but for spheres whose t round alike.
fn order(one: &Ranked, other: &Ranked) -> Ordering {
    let are_tied = rounded_once(&one.0) == rounded_once(&other.0);
    let by_t = match (one.1, other.1) {
        (true, true) => one.0.cmp(&other.0),
        (one, other) if are_tied => one.cmp(&other),
        _ => one.0.cmp(&other.0),
    };
    by_t.then(one.2.cmp(&other.2))
}

/// All that a ray meets, in order.
fn ranked(geometry: &Geometry, ray: &Ray) -> Vec<Ranked> {
    let of = |number| {
        let sphere = |i: usize| geometry.quadrics[i].sphere();
        let primitive = geometry.primitive(number);
        let is_flat = !matches!(primitive, Primitive::Quadric(i) if sphere(i).is_some());
        let rank = (!geometry.is_passed(number), number);
        met(geometry, ray, number).into_iter().map(move |t| (t, is_flat, rank))
    };
    let mut all: Vec<Ranked> = (0..geometry.len() as u32).flat_map(of).collect();
    all.sort_by(order);
    all
}

fn hit((t, _, (_, primitive)): &Ranked) -> Hit {
    Hit { t: rounded_once(t), primitive: *primitive }
}

/// Combinations of tree, kernel and level: a fifth of them, but in five parts all.
fn ways(geometry: &Geometry, part: usize) -> impl Iterator<Item = Accel> {
    let presets = [Preset::Brute, Preset::OnDemand, Preset::Fastest, Preset::Medium];
    let kernels =
        presets.into_iter().flat_map(|preset| KernelChoice::ALL.map(|kernel| (preset, kernel)));
    let all = kernels.flat_map(|way| Level::available().into_iter().map(move |level| (way, level)));
    all.skip(part).step_by(PARTS).map(|((preset, kernel), level)| {
        let mut accel = Accel::new(geometry.clone(), preset);
        (accel.kernel, accel.level) = (kernel, level.token().expect("it is available"));
        accel
    })
}

/// See [`ways`]; no divisor of the number of levels, so that each part has all of them.
const PARTS: usize = 5;

/// Walls as a geometry, rays at their place, and a part of the [`ways`] to ask.
fn questions() -> impl Strategy<Value = (Geometry, Vec<Ray>, usize)> {
    let targets = prop::collection::vec((-1.0_f32..1.0, -1.0_f32..1.0), 1..32);
    (place(), walls(), magnitude(0, 20), unit(), targets, 0..PARTS).prop_map(
        |(place, walls, distance, from, targets, part)| {
            (place.geometry(&walls), place.rays(distance.abs(), from, &targets), part)
        },
    )
}

/// One of so many cases: of each, many ways are tried.
fn config(part: u32) -> Config {
    Config { cases: crate::config().cases.div_ceil(part), ..crate::config() }
}

proptest! {
    #![proptest_config(config(10))]

    /// Whatever kernel is asked, the answers are those of the reference kernel without a tree.
    #[test]
    fn surfaces_that_nearly_coincide_are_met_as_the_reference_meets_them(
        (geometry, rays, part) in questions(),
    ) {
        let ask = |accel: &Accel| {
            let (mut traversal, mut hits) = (accel.traversal(), vec![Hit::MISS; rays.len()]);
            let mut occluded = vec![false; rays.len()];
            accel.closest_of(&rays[..], &mut hits, &mut traversal);
            accel.occluded_of(&rays[..], &mut occluded, &mut traversal);
            (hits, occluded)
        };
        let mut reference = Accel::new(geometry.clone(), Preset::Brute);
        reference.kernel = KernelChoice::Reference;
        let expected = ask(&reference);
        for accel in ways(&geometry, part) {
            prop_assert_eq!(&ask(&accel), &expected, "{:?} {:?}", accel.kernel, accel.level);
        }
    }
}

proptest! {
    #![proptest_config(config(300))]

    /// The closest hit comes first of all, and what a ray crosses is in order.
    #[test]
    fn surfaces_that_nearly_coincide_are_met_in_order(
        (geometry, rays, part) in questions(),
    ) {
        let all: Vec<_> = rays.iter().map(|ray| ranked(&geometry, ray)).collect();
        let closest: Vec<Hit> =
            all.iter().map(|ranked| ranked.first().map_or(Hit::MISS, hit)).collect();
        for accel in ways(&geometry, part) {
            let (mut traversal, mut found) = (accel.traversal(), vec![Hit::MISS; rays.len()]);
            let mut crossings = Crossings::default();
            accel.closest_of(&rays[..], &mut found, &mut traversal);
            prop_assert_eq!(&found, &closest, "{:?} {:?}", accel.kernel, accel.level);
            for (i, ray) in rays.iter().enumerate() {
                prop_assert_eq!(accel.closest(ray, &mut traversal), closest[i]);
                accel.crossings(ray, &mut traversal, &mut crossings);
                // A ray meets more than it crosses: triangles around an edge.
                let own = |hit: &Hit| (hit.primitive as usize) < geometry.own();
                let mut met = all[i].iter().map(hit).filter(own);
                let found = crossings.hits();
                prop_assert!(found.iter().all(|hit| met.any(|met| met == *hit)), "{found:?}");
            }
        }
    }
}
