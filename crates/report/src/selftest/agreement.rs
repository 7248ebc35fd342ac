//! Every kernel against the reference, on a user's own scene: rays aimed at edges and vertices.

use super::aim::{BoundingBall, any_corners, rays};
use super::prelude::*;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::math::simd::Level;

/// The number of rays: quick, and in full.
const RAYS: [usize; 2] = [1 << 16, 1 << 20];

/// Rays that are aimed together: a packet.
const TOGETHER: usize = 64;

/// Rays that are asked together: many packets, of which one must not spoil the next.
const RAYS_OF_A_CALL: usize = 64 * TOGETHER;

/// The streams of random numbers of rays and of packets, in place of a case's number and a part's
/// place.
const AGREEING: [u32; 2] = [103, 0];
const TOGETHER_AIMED: [u32; 2] = [103, 1];

/// Asks every kernel at every instruction level, in full with several trees, for the hits of rays
/// aimed at edges, vertices and points of primitives, from outside and from other primitives. In
/// exact precision they must be those of the reference to the last bit.
pub fn agreement(mut accel: Accel, effort: &Effort) -> Outcome {
    let (geometry, extent) = (accel.geometry(), BoundingBall::of(accel.geometry()));
    let count = rays(geometry, effort, RAYS);
    let aim = |n| aim(geometry, &extent, InputRng::new(effort, AGREEING, n), TOGETHER_AIMED);
    let aimed: Vec<Ray> = (0..count).into_par_iter().map(aim).collect();
    let expected = by_reference(&mut accel, &aimed);
    let mut outcome = compare(&mut accel, &expected);
    if effort.count == Count::Full {
        for preset in [Preset::OnDemand, Preset::Medium] {
            accel.rebuild(preset);
            outcome.add(compare(&mut accel, &expected).with_context(|| preset.name().to_owned()));
        }
    }
    outcome
}

/// Rays that are asked together, with what the reference answers.
pub(super) type Answered<'a> = Vec<(&'a [Ray], Vec<RayAnswer>)>;

/// What the reference answers with the tree of `accel`.
pub(super) fn by_reference<'a>(accel: &mut Accel, rays: &'a [Ray]) -> Answered<'a> {
    accel.kernel = KernelChoice::Reference;
    parallel::map(rays.chunks(RAYS_OF_A_CALL), |rays| (rays, answers(accel, rays)))
}

/// Case 49. Slivers, sheets a few ulp apart and wide planes, with rays aimed at their edges and
/// vertices.
pub(super) fn aimed(rng: &mut InputRng) -> World {
    let mut geometry = Geometry::default();
    for _ in 0..64 {
        let (a, along) = (rng.ball(1.0).as_vec3(), rng.direction());
        let aside = rng.direction() * rng.magnitude(1e-9, 1e-3);
        let middle = a.as_dvec3() + along * rng.one() + aside;
        add_triangle(&mut geometry, [a, (a.as_dvec3() + along).as_vec3(), middle.as_vec3()]);
    }
    for _ in 0..64 {
        let corners = [(); 3].map(|()| rng.ball(1.0).as_vec3());
        let step = rng.direction().as_vec3() * (f32::EPSILON * rng.below(4) as f32);
        add_triangle(&mut geometry, corners);
        let [a, b, c] = corners.map(|corner| corner + step);
        add_triangle(&mut geometry, [b, c, a]);
    }
    for _ in 0..8 {
        let half = rng.magnitude(1.0, 1e6) as f32;
        let first = geometry.positions.len() as u32;
        let center = Vec3::Y * rng.about(1.0) as f32;
        geometry.positions.extend(corners(center, Vec3::X * half, Vec3::Z * half));
        geometry.quads.push([0, 1, 2, 3].map(|corner| first + corner));
    }
    let (extent, packets) = (BoundingBall::of(&geometry), [49, rng.bits()]);
    World::new(geometry.clone(), MIXED, move |rng| {
        Some(aim(&geometry, &extent, rng.clone(), packets))
    })
}

/// Of a ray the closest hit, its primitive where no t is asked for, and whether there is any.
pub(super) type RayAnswer = (Hit, u32, bool);

fn answers(accel: &Accel, rays: &[Ray]) -> Vec<RayAnswer> {
    let (mut closest, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    let mut without_t = closest.clone();
    let mut traversal = accel.traversal();
    accel.closest_of(rays, &mut closest, &mut traversal);
    accel.occluded_of(rays, &mut any, &mut traversal);
    traversal.without_t = true;
    accel.closest_of(rays, &mut without_t, &mut traversal);
    let all = closest.into_iter().zip(without_t).zip(any);
    all.map(|((hit, without_t), any)| (hit, without_t.primitive, any)).collect()
}

/// Compares the answers of every kernel but the reference, at every instruction level, with the expected ones.
pub(super) fn compare(accel: &mut Accel, answered: &Answered<'_>) -> Outcome {
    let mut outcome = Outcome::default();
    for level in Level::available() {
        let Some(token) = level.token() else { continue };
        accel.level = token;
        for kernel in KernelChoice::FOR_RENDERS {
            accel.kernel = kernel;
            let differences = parallel::map(answered.iter(), |(rays, expected)| {
                let mut outcome = Outcome::default();
                for ((ray, found), right) in rays.iter().zip(answers(accel, rays)).zip(expected) {
                    outcome
                        .check(found == *right, || format!("{ray}: {found:?} and not {right:?}"));
                }
                outcome
            });
            let context = || format!("{} {}", level.name(), kernel.name());
            outcome.add(differences.into_iter().sum::<Outcome>().with_context(context));
            if accel.tree().is_none() {
                // There is nothing left to vary: every kernel asks every primitive.
                return outcome;
            }
        }
    }
    outcome
}

/// A ray of a packet from one point at one primitive: along an edge, around a vertex or inside; or
/// from there at edges of primitives everywhere. Some end where they are aimed. `packets` is the
/// stream of random numbers of what they share.
fn aim(geometry: &Geometry, extent: &BoundingBall, mut rng: InputRng, packets: [u32; 2]) -> Ray {
    let place = rng.index % TOGETHER;
    let mut shared = InputRng::new(&rng.effort, packets, rng.index / TOGETHER);
    let from = if shared.below(3) > 0 {
        extent.around(&mut shared)
    } else {
        let corners = any_corners(geometry, &mut shared);
        shared.within(corners).as_vec3()
    };
    let [a, b, c] = any_corners(geometry, &mut shared);
    let (aim, t_max) = (shared.below(4), shared.among([1.0, f32::INFINITY]));
    let target = match aim {
        0 => a.lerp(b, place as f32 / (TOGETHER - 1) as f32),
        1 => {
            let moved = |x: f32, steps: i32| f32::from_bits((x.to_bits() as i32 + steps) as u32);
            let (across, along) = (place as i32 % 8 - 4, place as i32 / 8 - 4);
            Vec3::new(moved(a.x, across), moved(a.y, along), a.z)
        }
        2 => rng.within([a, b, c]).as_vec3(),
        _ => {
            let [a, b, _] = any_corners(geometry, &mut rng);
            a.lerp(b, rng.one() as f32)
        }
    };
    Ray { t_max, ..Ray::new(from, target - from) }
}
