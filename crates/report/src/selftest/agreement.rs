//! Every kernel against the reference, on a user's own scene: rays aimed at edges and vertices.

use rayon::prelude::*;

use super::case::Count;
use super::examine::{Extent, rays};
use super::prelude::*;
use super::shapes::{add_sheet, add_triangle, corners};
use super::ways::{blocks, in_order, with_every_kernel};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::geometry::Primitive;
use wavecrest_core::kernels::precision::Precision;

/// The number of rays: quick, and in full.
const RAYS: [usize; 2] = [1 << 16, 1 << 20];

/// Rays that are aimed together: a packet.
const TOGETHER: usize = 64;

/// Packets for each task.
const PACKETS_OF_A_THREAD: usize = 64;

/// The stream of random numbers, in place of a case's number and a part's place.
const AGREEING: [u32; 2] = [103, 0];

/// Asks every kernel at every instruction level, in full with several trees, for the hits of rays
/// aimed at edges, vertices and points of primitives, from outside and from other primitives. In
/// exact precision they must be those of the reference to the last bit.
pub fn agreement(accel: Accel, effort: &Effort) -> Outcome {
    let presets = effort.either(&[][..], &[Preset::Fastest, Preset::Slow]);
    let packets = rays(accel.geometry(), effort, RAYS).div_ceil(TOGETHER);
    agree(accel, effort, packets, presets)
}

/// As [`agreement`], with this number of packets, and with the tree of `accel` and those of
/// `presets`.
fn agree(mut accel: Accel, effort: &Effort, packets: usize, presets: &[Preset]) -> Outcome {
    accel.kernel = KernelChoice::Reference;
    let extent = Extent::of(accel.geometry());
    let asked: Vec<_> = blocks(packets, PACKETS_OF_A_THREAD)
        .map(|block| {
            let aimed = |n| packet(accel.geometry(), &extent, Numbers::new(effort, AGREEING, n));
            let rays: Vec<Ray> = block.flat_map(aimed).collect();
            let answers = Answers::of(&accel, &rays);
            (rays, answers)
        })
        .collect();
    let mut outcome = compare(&mut accel, &asked);
    for preset in presets {
        accel.rebuild(*preset);
        outcome.add(compare(&mut accel, &asked).with_context(|| preset.name().to_owned()));
    }
    outcome
}

/// Packets of case 49, in full.
const PACKETS: usize = 32_000;

/// Case 49. Slivers, sheets a few ulp apart and wide planes, with rays aimed at their edges and
/// vertices.
pub(super) fn aimed(effort: &Effort) -> Outcome {
    let mut numbers = Numbers::new(effort, [49, 0], 0);
    let mut geometry = Geometry::default();
    for _ in 0..64 {
        let (a, along) = (numbers.ball(1.0).as_vec3(), numbers.direction());
        let aside = numbers.direction() * numbers.magnitude(1e-9, 1e-3);
        let middle = a.as_dvec3() + along * numbers.one() + aside;
        add_triangle(&mut geometry, [a, (a.as_dvec3() + along).as_vec3(), middle.as_vec3()]);
    }
    for _ in 0..64 {
        let corners = numbers.triangle(1.0);
        let step = numbers.direction().as_vec3() * (f32::EPSILON * numbers.below(4) as f32);
        add_triangle(&mut geometry, corners);
        let [a, b, c] = corners.map(|corner| corner + step);
        add_triangle(&mut geometry, [b, c, a]);
    }
    for _ in 0..8 {
        let half = numbers.magnitude(1.0, 1e6) as f32;
        let center = Vec3::Y * numbers.about(1.0) as f32;
        add_sheet(&mut geometry, corners(center, Vec3::X * half, Vec3::Z * half));
    }
    let accel = effort.accel(geometry, Preset::Fastest);
    agree(accel, effort, effort.of(PACKETS), &[Preset::Slow])
}

/// The answers to both queries.
struct Answers {
    closest: Vec<Hit>,
    /// As `closest`, without t.
    primitives: Vec<u32>,
    occluded: Vec<bool>,
}

impl Answers {
    fn of(accel: &Accel, rays: &[Ray]) -> Self {
        let (mut closest, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        let mut traversal = accel.traversal();
        traversal.without_t = true;
        accel.closest_of(rays, &mut closest, &mut traversal);
        let primitives = closest.iter().map(|hit| hit.primitive).collect();
        traversal.without_t = false;
        accel.closest_of(rays, &mut closest, &mut traversal);
        accel.occluded_of(rays, &mut occluded, &mut traversal);
        Self { closest, primitives, occluded }
    }
}

/// Compares the answers of every kernel at every level with the expected ones.
fn compare(accel: &mut Accel, asked: &[(Vec<Ray>, Answers)]) -> Outcome {
    with_every_kernel(accel, |accel| {
        in_order(asked.par_iter().map(|(rays, expected)| {
            let (found, mut outcome) = (Answers::of(accel, rays), Outcome::default());
            for (i, ray) in rays.iter().enumerate() {
                let [hit, reference] = [&found, expected].map(|answers| answers.closest[i]);
                let right = hit.primitive == reference.primitive
                    && found.primitives[i] == reference.primitive
                    && hit.t.to_bits() == reference.t.to_bits()
                    && found.occluded[i] == expected.occluded[i];
                outcome.check(right, || format!("{ray}: {hit:?} and not {reference:?}"));
            }
            outcome
        }))
    })
}

/// Rays from one point at one primitive: along an edge, around a vertex or inside; or from there at
/// edges of primitives everywhere. Some end where they are aimed.
fn packet(geometry: &Geometry, extent: &Extent, mut numbers: Numbers) -> [Ray; TOGETHER] {
    let from = if numbers.below(3) > 0 {
        extent.around(&mut numbers)
    } else {
        let corners = any_corners(geometry, &mut numbers);
        numbers.within(corners).as_vec3()
    };
    let [a, b, c] = any_corners(geometry, &mut numbers);
    let (aim, t_max) = (numbers.below(4), [1.0, f32::INFINITY][numbers.below(2)]);
    std::array::from_fn(|i| {
        let target = match aim {
            0 => a + (b - a) * (i as f32 / (TOGETHER - 1) as f32),
            1 => {
                let moved =
                    |x: f32, steps: i32| f32::from_bits((x.to_bits() as i32 + steps) as u32);
                let (across, along) = (i as i32 % 8 - 4, i as i32 / 8 - 4);
                Vec3::new(moved(a.x, across), moved(a.y, along), a.z)
            }
            2 => numbers.within([a, b, c]).as_vec3(),
            _ => {
                let [a, b, _] = any_corners(geometry, &mut numbers);
                a.lerp(b, numbers.one() as f32)
            }
        };
        Ray { t_max, ..Ray::new(from, target - from) }
    })
}

/// The part of a ray that leaves a primitive before it can meet anything.
const START: f32 = 1.0 / 1024.0;

/// Rays from points of primitives to points around them all.
pub(crate) fn leaving(geometry: &Geometry, count: usize) -> impl Iterator<Item = Ray> {
    let effort = Effort { precision: Precision::Exact, seed: 1, count: Count::Quick };
    let extent = Extent::of(geometry);
    let count = if geometry.is_empty() { 0 } else { count };
    (0..count).map(move |n| {
        let mut numbers = Numbers::new(&effort, AGREEING, n);
        let corners = any_corners(geometry, &mut numbers);
        let from = numbers.within(corners).as_vec3();
        Ray { t_min: START, ..Ray::new(from, extent.around(&mut numbers) - from) }
    })
}

/// The corners of any primitive.
fn any_corners(geometry: &Geometry, numbers: &mut Numbers) -> [Vec3; 3] {
    let number = numbers.below(geometry.len()) as u32;
    some_corners(geometry, number, numbers)
}

/// The corners of a primitive. For spheres, points on the surface.
pub(super) fn some_corners(geometry: &Geometry, number: u32, numbers: &mut Numbers) -> [Vec3; 3] {
    match geometry.primitive(number) {
        Primitive::Quad(i) => {
            let [a, b, c, d] = geometry.quad(i);
            if numbers.below(2) == 0 { [a, c, b] } else { [c, a, d] }
        }
        Primitive::Sphere(i) => {
            let (center, radius) = geometry.spheres[i];
            let point = |d: DVec3| (center.as_dvec3() + d * f64::from(radius)).as_vec3();
            [(); 3].map(|()| point(numbers.direction()))
        }
        _ => geometry.mesh_triangle(number).unwrap_or_default(),
    }
}
