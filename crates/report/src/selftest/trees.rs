//! A tree must give the hits of brute force, whatever primitives it holds.

use glam::Vec3;

use super::case::{Effort, Outcome};
use super::directions::cubes;
use super::ways::{Numbers, every_way, inputs};
use wavecrest_core::accel::Hit;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::kernels::triangle::T_TOLERANCE;
use wavecrest_core::math::ray::Ray;

/// What brute force finds.
pub(super) fn by_brute_force(effort: &Effort, geometry: &Geometry, rays: &[Ray]) -> Vec<Hit> {
    let accel = effort.accel(geometry.clone(), Preset::Brute);
    let mut hits = vec![Hit::MISS; rays.len()];
    let threads = rayon::current_num_threads();
    let block = rays.len().div_ceil(16 * threads).max(1);
    rayon::scope(|scope| {
        for (rays, hits) in rays.chunks(block).zip(hits.chunks_mut(block)) {
            let accel = &accel;
            scope.spawn(move |_| accel.closest_of(rays, hits, &mut accel.traversal()));
        }
    });
    hits
}

/// Adds a triangle with vertices of its own.
pub(super) fn add_triangle(geometry: &mut Geometry, corners: [Vec3; 3]) {
    let first = geometry.positions.len() as u32;
    geometry.positions.extend(corners);
    geometry.triangles.push([first, first + 1, first + 2]);
}

/// Traces the rays with every preset and kernel, and compares the hits with those expected.
fn compare(
    effort: &Effort,
    geometry: &Geometry,
    rays: &[Ray],
    expected: &[Hit],
    presets: &[Preset],
) -> Outcome {
    let with = |&preset: &Preset| {
        every_way(effort.accel(geometry.clone(), preset), rays, |i, _, hit| {
            let context = || format!("{}: {hit:?} and not {:?}", preset.name(), expected[i]);
            (hit != expected[i]).then(context)
        })
    };
    presets.iter().map(with).sum()
}

/// A number from -1 to 1, or a multiple of a quarter: on faces and edges.
fn coordinate(numbers: &mut Numbers) -> f32 {
    if numbers.below(2) == 0 {
        numbers.below(9) as f32 / 4.0 - 1.0
    } else {
        (2.0 * numbers.one() - 1.0) as f32
    }
}

fn point(numbers: &mut Numbers) -> Vec3 {
    Vec3::from([(); 3].map(|()| coordinate(numbers)))
}

/// Row 3.
pub(super) fn boxes(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for (s, scale) in [1.0, 1_048_576.0, 1.0 / 1_048_576.0].into_iter().enumerate() {
        let mut geometry = cubes(3, 0.75);
        geometry.positions.iter_mut().for_each(|p| *p -= 1.0);
        let mut numbers = Numbers::new(effort, 3, usize::MAX - s);
        for _ in 0..200 {
            let center = point(&mut numbers);
            let size = numbers.magnitude(1e-3, 1.0) as f32;
            add_triangle(&mut geometry, [(); 3].map(|()| center + point(&mut numbers) * size));
        }
        geometry.positions.iter_mut().for_each(|p| *p *= scale);
        let rays: Vec<Ray> = inputs(effort, 3 + 16 * s as u32, 0..effort.of(1_000_000))
            .map(|mut numbers| {
                let (origin, target) = (point(&mut numbers) * 2.0, point(&mut numbers));
                Ray::new(origin * scale, (target - origin) * scale)
            })
            .collect();
        let expected = by_brute_force(effort, &geometry, &rays);
        let presets = &Preset::ALL[1..];
        outcome.add(compare(effort, &geometry, &rays, &expected, presets));
    }
    outcome
}

/// Row 20. Corners and rays are whole numbers, and so the ray is in the very plane.
pub(super) fn in_the_plane(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let planes = 100;
    for p in 0..planes {
        let mut numbers = Numbers::new(effort, 20, usize::MAX - p);
        let mut whole = |most: usize| {
            Vec3::from([(); 3].map(|()| numbers.below(2 * most + 1) as f32 - most as f32))
        };
        let (corner, a, b) = (whole(50), whole(20), whole(20));
        let mut geometry = Geometry::default();
        add_triangle(&mut geometry, [corner, corner + a, corner + b]);
        let start = p * 100_000;
        let rays: Vec<Ray> = inputs(effort, 20, start..start + effort.of(1_000_000) / planes)
            .map(|mut numbers| {
                let mut whole = || numbers.below(21) as f32 - 10.0;
                let origin = corner + a * whole() + b * whole();
                Ray::new(origin, a * whole() + b * whole())
            })
            .collect();
        let expected = by_brute_force(effort, &geometry, &rays);
        outcome.add(every_way(effort.accel(geometry, Preset::VeryFast), &rays, |i, _, hit| {
            let is_right = hit == expected[i] && (hit.is_miss() || hit.t.is_finite());
            (!is_right).then(|| format!("{hit:?} and not {:?}", expected[i]))
        }));
    }
    outcome
}

/// Row 21: every triangle several times, in any order.
pub(super) fn duplicates(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let base = cubes(3, 0.75);
    let rays: Vec<Ray> = inputs(effort, 21, 0..effort.of(1_000_000))
        .map(|mut numbers| {
            let origin = point(&mut numbers) * 3.0;
            Ray::new(origin, point(&mut numbers) - origin)
        })
        .collect();
    let expected = by_brute_force(effort, &base, &rays);
    for shuffle in 0..4 {
        let mut numbers = Numbers::new(effort, 21, usize::MAX - shuffle);
        // Which triangle of the base each is.
        let mut which: Vec<usize> = (0..base.triangles.len()).flat_map(|i| [i; 5]).collect();
        for i in (1..which.len()).rev() {
            which.swap(i, numbers.below(i + 1));
        }
        let triangles = which.iter().map(|&i| base.triangles[i]).collect();
        let geometry = Geometry { triangles, ..base.clone() };
        for preset in [Preset::Fastest, Preset::Medium] {
            outcome.add(every_way(effort.accel(geometry.clone(), preset), &rays, |i, _, hit| {
                // Of all at this distance the first in the shuffled order; edges have two triangles.
                let is_first = |number: u32| {
                    let own = which[number as usize];
                    !which[..number as usize].contains(&own)
                };
                // Of triangles that share an edge each has a t of its own, within the bound.
                let is_near = |t: f32| (hit.t - t).abs() <= 2.0 * T_TOLERANCE * t;
                let is_right = if hit.is_miss() {
                    expected[i].is_miss()
                } else {
                    is_near(expected[i].t) && is_first(hit.primitive)
                };
                (!is_right).then(|| format!("{hit:?}, once {:?}", expected[i]))
            }));
        }
    }
    outcome
}

/// Row 22: squares about one point, of all sizes.
pub(super) fn one_centroid(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let largest = effort.of(1_000_000);
    for count in [100, largest / 10, largest] {
        let mut geometry = Geometry::default();
        for mut numbers in inputs(effort, 22, 0..count) {
            let (a, b) = (numbers.direction().as_vec3(), numbers.direction().as_vec3());
            let size = numbers.magnitude(1.0, 100.0) as f32;
            // The middle of the box is the origin.
            add_triangle(&mut geometry, [a * size, -a * size, b * (0.1 * size)]);
        }
        let rays: Vec<Ray> = inputs(effort, 22 + 16, 0..64)
            .map(|mut numbers| {
                let origin = numbers.direction().as_vec3() * 200.0;
                Ray::new(origin, numbers.direction().as_vec3() * 10.0 - origin)
            })
            .collect();
        let expected = by_brute_force(effort, &geometry, &rays);
        outcome.add(compare(effort, &geometry, &rays, &expected, &[Preset::VeryFast]));
        let accel = effort.accel(geometry, Preset::VeryFast);
        for ray in &rays {
            let mut traversal = accel.traversal();
            accel.closest(ray, &mut traversal);
            let tested = traversal.tests.triangles;
            let context = || format!("{tested} tests of {count} triangles");
            outcome.check(tested <= 2 * count as u64, context);
        }
    }
    outcome
}

/// Row 23: each triangle within the next, which is larger by a tenth.
pub(super) fn nested(effort: &Effort) -> Outcome {
    let mut geometry = Geometry::default();
    let mut size = 1e-10_f64;
    for _ in 0..500 {
        let s = size as f32;
        add_triangle(&mut geometry, [[-s, -s], [s, -s], [0.0, s]].map(|[y, z]| Vec3::new(s, y, z)));
        size *= 1.1;
    }
    let rays: Vec<Ray> = inputs(effort, 23, 0..effort.of(100_000))
        .map(|mut numbers| {
            let far = numbers.magnitude(1e-10, 1e11);
            let target = numbers.direction() * numbers.magnitude(1e-10, 1e10);
            let origin = if numbers.below(2) == 0 {
                glam::DVec3::X * far
            } else {
                numbers.direction() * far
            };
            Ray::new(origin.as_vec3(), (target - origin).as_vec3())
        })
        .collect();
    let expected = by_brute_force(effort, &geometry, &rays);
    let presets = [Preset::Fastest, Preset::VeryFast, Preset::Medium];
    compare(effort, &geometry, &rays, &expected, &presets)
}
