//! A tree must return the hits of brute force for any primitives, and these must be right: they are
//! computed in integers, or follow from the construction of the primitives.

use glam::Vec3;
use rayon::prelude::*;

use super::case::{Effort, Outcome};
use super::directions::cubes;
use super::ways::{Numbers, every_way, inputs};
use super::whole::{Triangles, wrong};
use wavecrest_core::accel::Hit;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;

/// The hits of brute force.
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

/// Adds a triangle with its own vertices.
pub(super) fn add_triangle(geometry: &mut Geometry, corners: [Vec3; 3]) {
    let first = geometry.positions.len() as u32;
    geometry.positions.extend(corners);
    geometry.triangles.push([first, first + 1, first + 2]);
}

/// Traces the rays with every preset and kernel: the hits must be those of brute force to the last
/// bit, and `wrong` describes their error, if any.
fn compare(
    effort: &Effort,
    geometry: &Geometry,
    rays: &[Ray],
    presets: &[Preset],
    wrong: impl Fn(usize, Hit) -> Option<String>,
) -> Outcome {
    let expected = by_brute_force(effort, geometry, rays);
    let mut outcome = Outcome::default();
    for (i, (ray, &hit)) in rays.iter().zip(&expected).enumerate() {
        outcome.count(wrong(i, hit).map(|failure| format!("ray {i}, {ray}: {failure}")));
    }
    for &preset in presets {
        let accel = effort.accel(geometry.clone(), preset);
        outcome.add(every_way(accel, rays, |i, _, hit| {
            let context = || format!("{}: {hit:?} and not {:?}", preset.name(), expected[i]);
            (hit != expected[i]).then(context)
        }));
    }
    outcome
}

/// The expected hits of the rays on a geometry with integer coordinates.
fn expected_of(geometry: &Geometry, rays: &[Ray]) -> Vec<Hit> {
    let triangles = Triangles::of(geometry);
    rays.par_iter().map(|ray| triangles.met_by(ray)).collect()
}

/// The unit of a grid on which corners and rays lie.
const UNIT: f32 = 4096.0;

/// A random integer coordinate from -1 to 1 in units, or a multiple of a quarter unit: on faces and
/// edges.
fn coordinate(numbers: &mut Numbers) -> f32 {
    if numbers.below(2) == 0 {
        (numbers.below(9) as f32 / 4.0 - 1.0) * UNIT
    } else {
        ((2.0 * numbers.one() - 1.0) as f32 * UNIT).round()
    }
}

fn point(numbers: &mut Numbers) -> Vec3 {
    Vec3::from([(); 3].map(|()| coordinate(numbers)))
}

/// Case 3. The rays have the same hits at every scale.
pub(super) fn boxes(effort: &Effort) -> Outcome {
    let mut geometry = cubes(3, 0.75 * UNIT);
    geometry.positions.iter_mut().for_each(|p| *p -= UNIT);
    let mut numbers = Numbers::new(effort, 3, usize::MAX);
    for _ in 0..200 {
        let center = point(&mut numbers);
        let size = numbers.magnitude(1e-3, 1.0) as f32;
        let corners = [(); 3].map(|()| center + (point(&mut numbers) * size).round());
        add_triangle(&mut geometry, corners);
    }
    let rays: Vec<Ray> = inputs(effort, 3, 0..effort.of(1_000_000))
        .map(|mut numbers| {
            let (origin, target) = (point(&mut numbers) * 2.0, point(&mut numbers));
            Ray::new(origin, target - origin)
        })
        .collect();
    let expected = expected_of(&geometry, &rays);
    let at_scale = |scale: f32| {
        let mut geometry = geometry.clone();
        geometry.positions.iter_mut().for_each(|p| *p *= scale);
        let scaled = |ray: &Ray| Ray::new(ray.origin * scale, ray.direction * scale);
        let rays: Vec<Ray> = rays.iter().map(scaled).collect();
        compare(effort, &geometry, &rays, &Preset::ALL[1..], |i, hit| wrong(hit, expected[i]))
    };
    let scales = [1.0 / UNIT, 1_048_576.0 / UNIT, 1.0 / (UNIT * 1_048_576.0)];
    let mut outcome: Outcome = scales.into_iter().map(at_scale).sum();
    let certain = expected.iter().filter(|expected| !expected.is_miss()).count();
    outcome.check(certain > rays.len() / 4, || format!("{certain} rays certainly hit anything"));
    outcome
}

/// Case 48. Corners, origins and targets are small integers, so that many rays pass through edges and
/// corners, and end or begin exactly at what they meet.
pub(super) fn at_ends(effort: &Effort) -> Outcome {
    let whole = |numbers: &mut Numbers| Vec3::from([(); 3].map(|()| numbers.below(9) as f32 - 4.0));
    let mut geometry = Geometry::default();
    let mut numbers = Numbers::new(effort, 48, usize::MAX);
    for _ in 0..24 {
        add_triangle(&mut geometry, [(); 3].map(|()| whole(&mut numbers)));
    }
    let rays: Vec<Ray> = inputs(effort, 48, 0..effort.of(1_000_000))
        .map(|mut numbers| {
            let (origin, target) = (whole(&mut numbers), whole(&mut numbers));
            let (t_min, t_max) = ([0.0, -1.0, 0.25][numbers.below(3)], numbers.below(2) + 1);
            Ray { t_min, t_max: t_max as f32 / 2.0, ..Ray::new(origin, target - origin) }
        })
        .filter(Ray::is_valid)
        .collect();
    let expected = expected_of(&geometry, &rays);
    let presets = [Preset::Fastest, Preset::Slow];
    compare(effort, &geometry, &rays, &presets, |i, hit| wrong(hit, expected[i]))
}

/// Case 20. Corners and rays are integers, so the ray is exactly in the plane: it meets nothing.
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
        outcome.add(every_way(effort.accel(geometry, Preset::VeryFast), &rays, |_, _, hit| {
            (!hit.is_miss()).then(|| format!("it hits {hit:?}"))
        }));
    }
    outcome
}

/// Case 21: every triangle several times, in any order.
pub(super) fn duplicates(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let base = cubes(3, 0.75 * UNIT);
    let rays: Vec<Ray> = inputs(effort, 21, 0..effort.of(1_000_000))
        .map(|mut numbers| {
            let origin = point(&mut numbers) * 3.0;
            Ray::new(origin, point(&mut numbers) - origin)
        })
        .collect();
    for shuffle in 0..4 {
        let mut numbers = Numbers::new(effort, 21, usize::MAX - shuffle);
        // The base triangle of each copy.
        let mut which: Vec<usize> = (0..base.triangles.len()).flat_map(|i| [i; 5]).collect();
        for i in (1..which.len()).rev() {
            which.swap(i, numbers.below(i + 1));
        }
        let triangles = which.iter().map(|&i| base.triangles[i]).collect();
        let geometry = Geometry { triangles, ..base.clone() };
        let expected = expected_of(&geometry, &rays);
        for preset in [Preset::Brute, Preset::Fastest, Preset::Medium] {
            outcome.add(every_way(effort.accel(geometry.clone(), preset), &rays, |i, _, hit| {
                // Beside an edge either triangle may be hit, but of each only the first in the
                // shuffled order.
                let is_first = |number: u32| {
                    let own = which[number as usize];
                    !which[..number as usize].contains(&own)
                };
                let later = !hit.is_miss() && !is_first(hit.primitive);
                let copy = later.then(|| format!("{hit:?} is a copy of one before it"));
                wrong(hit, expected[i]).or(copy)
            }));
        }
    }
    outcome
}

/// Case 22: triangles around one point, of all sizes.
pub(super) fn one_centroid(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let largest = effort.of(1_000_000);
    for count in [100, largest / 10, largest] {
        let mut geometry = Geometry::default();
        for mut numbers in inputs(effort, 22, 0..count) {
            let (a, b) = (numbers.direction().as_vec3(), numbers.direction().as_vec3());
            let size = numbers.magnitude(64.0, 6400.0) as f32;
            // The middle of the box is the origin.
            let a = (a * size).round();
            add_triangle(&mut geometry, [a, -a, (b * (0.1 * size)).round()]);
        }
        let rays: Vec<Ray> = inputs(effort, 22 + 16, 0..64)
            .map(|mut numbers| {
                let origin = (numbers.direction().as_vec3() * 12_800.0).round();
                Ray::new(origin, (numbers.direction().as_vec3() * 640.0).round() - origin)
            })
            .collect();
        let expected = expected_of(&geometry, &rays);
        let wrong = |i: usize, hit| wrong(hit, expected[i]);
        outcome.add(compare(effort, &geometry, &rays, &[Preset::VeryFast], wrong));
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

/// Number of triangles in case 23, and the ratio of consecutive sizes.
const NESTED: usize = 500;
const LARGER: f64 = 1.1;

/// Case 23: nested triangles. The one of size s is across x = s, from -s to s.
pub(super) fn nested(effort: &Effort) -> Outcome {
    let mut geometry = Geometry::default();
    let mut sizes = Vec::new();
    for i in 0..NESTED {
        let s = (1e-10 * libm::pow(LARGER, i as f64)) as f32;
        add_triangle(&mut geometry, [[-s, -s], [s, -s], [0.0, s]].map(|[y, z]| Vec3::new(s, y, z)));
        sizes.push(f64::from(s));
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
    let presets = [Preset::Fastest, Preset::VeryFast, Preset::Medium];
    compare(effort, &geometry, &rays, &presets, |i, hit| not_nested(&sizes, &rays[i], hit))
}

/// The error of a hit on triangles of these sizes, from the crossings of the ray with their planes.
fn not_nested(sizes: &[f64], ray: &Ray, hit: Hit) -> Option<String> {
    /// Within this distance of an edge, relative to the size and the distance, rounding decides.
    const BESIDE: f64 = 1e-5;
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    // The t at which the ray crosses the plane of a size, and its distance inside the triangle
    // there.
    let crossing = |size: f64| {
        let t = (size - origin.x) / direction.x;
        let [_, y, z] = (origin + direction * t).to_array();
        let beside = BESIDE * (size + origin.abs().max_element());
        let within = (size - 2.0 * y.abs() - z).min(z + size);
        (t, within / beside)
    };
    let certain = sizes.iter().zip(0..).filter_map(|(&size, number)| {
        let (t, within) = crossing(size);
        (t > 0.0 && within > 1.0).then_some((t, number))
    });
    let (t, first) =
        certain.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, u32::MAX));
    let is_right = if hit.primitive == first {
        hit.is_miss() || (f64::from(hit.t) / t - 1.0).abs() <= BESIDE
    } else {
        let beside = sizes.get(hit.primitive as usize).map(|&size| crossing(size));
        beside.is_some_and(|(_, within)| within > -1.0) && f64::from(hit.t) <= t * (1.0 + BESIDE)
    };
    (!is_right).then(|| format!("{hit:?} and not {first} at {t}"))
}
