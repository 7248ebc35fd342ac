use std::f32::consts::{PI, TAU};

use glam::Vec3;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit, KernelChoice, Traversal};
use wavecrest_core::counters::TestCounts;
use wavecrest_core::geometry::{Geometry, Quadric};
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::{FARTHEST_ORIGIN, Ray};
use wavecrest_core::math::simd::Level;

/// Numbers one after the other.
pub(crate) struct Numbers(pub(crate) u32);

impl Numbers {
    /// Three from -1 to 1.
    pub(crate) fn vector(&mut self) -> Vec3 {
        let [x, y, z, _] = self.four();
        Vec3::new(x, y, z) * 2.0 - 1.0
    }

    /// From 0 to 1.
    pub(crate) fn one(&mut self) -> f32 {
        self.four()[0]
    }

    /// An integer below `end`.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.one() * end as f32) as usize % end
    }

    fn four(&mut self) -> [f32; 4] {
        self.0 += 1;
        Stream { seed: 5, pixel: self.0, sample: 0, bounce: 0 }.uniform(0)
    }
}

pub(crate) fn add_triangle(geometry: &mut Geometry, corners: [Vec3; 3]) {
    let first = geometry.positions.len() as u32;
    geometry.positions.extend(corners);
    geometry.triangles.push([first, first + 1, first + 2]);
}

pub(crate) fn add_quad(geometry: &mut Geometry, corners: [Vec3; 4]) {
    let first = geometry.positions.len() as u32;
    geometry.positions.extend(corners);
    geometry.quads.push([0, 1, 2, 3].map(|k| first + k));
}

/// Triangles, spheres and disks within `size` of the origin.
pub(crate) fn cloud(numbers: &mut Numbers, size: f32) -> Geometry {
    let mut geometry = Geometry::default();
    for _ in 0..400 {
        let center = numbers.vector();
        let corners = [0; 3].map(|_| (center + numbers.vector() * 0.2) * size);
        add_triangle(&mut geometry, corners);
    }
    for _ in 0..20 {
        let (center, radius) = (numbers.vector() * size, 0.2 * numbers.one() * size);
        geometry.quadrics.push(Quadric::Sphere(center, radius));
        let normal = numbers.vector().normalize_or(Vec3::Z);
        let disk = Disk { center: numbers.vector() * size, normal, radius };
        geometry.quadrics.push(Quadric::Disk(disk));
    }
    geometry
}

/// A sphere of radius 1 with bumps, of `n` times `n` pairs of triangles.
pub(crate) fn bumpy_sphere(n: u32) -> Geometry {
    let position = |i: u32| {
        let (u, v) = (i % (n + 1), i / (n + 1));
        let (longitude, latitude) = (u as f32 / n as f32 * TAU, v as f32 / n as f32 * PI);
        let radius = 1.0 + 0.1 * (7.0 * longitude).sin() * (5.0 * latitude).sin();
        let (around, height) = latitude.sin_cos();
        radius * Vec3::new(around * longitude.cos(), around * longitude.sin(), height)
    };
    let triangles = (0..n * n).flat_map(|i| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    });
    let positions = (0..(n + 1) * (n + 1)).map(position).collect();
    Geometry { positions, triangles: triangles.collect(), ..Geometry::default() }
}

/// Spheres around one another: the last hides the others.
pub(crate) fn shells(count: u32) -> Geometry {
    let shell = |i| Quadric::Sphere(Vec3::ZERO, 1.0 + i as f32 * 1e-3);
    Geometry { quadrics: (0..count).map(shell).collect(), ..Geometry::default() }
}

/// The closest hits of rays, and whether they meet anything.
pub(crate) type Answers = (Vec<Hit>, Vec<bool>);

/// The answers to all rays together.
pub(crate) fn answers(accel: &Accel, rays: &[Ray], traversal: &mut Traversal) -> Answers {
    // Whatever was there before is written over.
    let mut hits = vec![Hit { t: 0.5, primitive: 0 }; rays.len()];
    let mut occluded = vec![true; rays.len()];
    accel.closest_of(rays, &mut hits, traversal);
    accel.occluded_of(rays, &mut occluded, traversal);
    (hits, occluded)
}

pub(crate) fn brute(geometry: &Geometry, rays: &[Ray]) -> Answers {
    let accel = Accel::new(geometry.clone(), Preset::Brute);
    answers(&accel, rays, &mut accel.traversal())
}

/// Asks every kernel with all instructions there are, rays alone and together.
pub(crate) fn check(name: &str, accel: &mut Accel, rays: &[Ray], (hits, occluded): &Answers) {
    for level in Level::available() {
        accel.level = level.token().expect("it is available");
        let mut traversal = accel.traversal();
        traversal.without_t = true;
        let mut many = vec![Hit::MISS; rays.len()];
        accel.closest_of(rays, &mut many, &mut traversal);
        let primitives = many.iter().map(|hit| hit.primitive);
        assert!(primitives.eq(hits.iter().map(|hit| hit.primitive)), "{name} {level:?}");
        traversal.without_t = false;
        let (many, any) = answers(accel, rays, &mut traversal);
        for (i, ray) in rays.iter().enumerate() {
            let one = accel.closest(ray, &mut traversal);
            let shadow = accel.occluded(ray, &mut traversal);
            let (found, expected) = ((one, many[i], shadow, any[i]), (hits[i], occluded[i]));
            let equal = found == (expected.0, expected.0, expected.1, expected.1);
            assert!(equal, "{name} {level:?} {ray:?}: {found:?} and not {expected:?}");
        }
    }
}

/// [`check`]s two trees against brute force; says how many hits there were.
pub(crate) fn compare(name: &str, geometry: &Geometry, rays: &[Ray]) -> usize {
    let expected = brute(geometry, rays);
    for preset in [Preset::VeryFast, Preset::Medium] {
        let mut accel = Accel::new(geometry.clone(), preset);
        check(&format!("{name} {preset:?}"), &mut accel, rays, &expected);
    }
    expected.0.iter().filter(|hit| !hit.is_miss()).count()
}

/// All distances of a tile are negative, those of boxes too.
#[test]
fn tiles_meet_what_is_before_their_origins() {
    let geometry = bumpy_sphere(24);
    let ray = |i: u8| {
        let origin = Vec3::new(f32::from(i % 8) / 16.0, f32::from(i / 8) / 16.0, 5.0);
        Ray { t_min: -10.0, t_max: -1.0, ..Ray::new(origin, Vec3::new(0.1, 0.1, 1.0)) }
    };
    let rays: Vec<Ray> = (0..64).map(ray).collect();
    assert_eq!(compare("before the origin", &geometry, &rays), rays.len());
}

/// The bound on the t of a large triangle is beyond the small ones behind it, for whose nodes single
/// rays leave the tile: they are no closer.
#[test]
fn rays_that_leave_a_tile_keep_their_hits() {
    let mut geometry = Geometry::default();
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    add_triangle(&mut geometry, [at(-1e3, -1e3, 1.0), at(3e3, -1e3, 1.0), at(-1e3, 3e3, 1.0)]);
    let targets = (0_u8..64).map(|i| at(f32::from(i % 8) + 0.5, f32::from(i / 8) + 0.5, 1.0));
    let rays: Vec<Ray> = targets.map(|target| Ray::new(Vec3::ZERO, target)).collect();
    for ray in &rays {
        for cell in 0_u8..=255 {
            let [x, y] = [cell % 16, cell / 16].map(|k| (f32::from(k) - 8.3) / 64.0);
            let corners = [at(x, y, 0.0), at(x + 0.03, y, 0.0), at(x, y + 0.03, 0.0)];
            add_triangle(&mut geometry, corners.map(|corner| ray.direction * 1.0001 + corner));
        }
    }
    assert_eq!(compare("small behind large", &geometry, &rays), rays.len());
}

/// The reciprocal of 1e-40 is infinite, and where it meets a coordinate of 0, not a number.
#[test]
fn hc03_a_triangle_with_a_corner_at_the_height_of_a_tiny_rays_origin_is_met() {
    let corners = [Vec3::new(-1.0, -1.0, 1e-3), Vec3::new(1.0, -1.0, 1e-3), Vec3::Y];
    for turn in 0..3 {
        let mut geometry = Geometry::default();
        add_triangle(&mut geometry, [0, 1, 2].map(|i| corners[(i + turn) % 3]));
        let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 1e-40));
        assert_eq!(compare("corner", &geometry, &[ray]), 1);
    }
}

/// Random rays through a cloud.
pub(crate) fn through(numbers: &mut Numbers, count: usize) -> Vec<Ray> {
    (0..count)
        .map(|_| {
            let (origin, target) = (numbers.vector() * 3.0, numbers.vector());
            Ray::new(origin, target - origin)
        })
        .collect()
}

#[test]
fn fast_hits_are_nearly_the_exact_ones_in_every_way() {
    let mut numbers = Numbers(50);
    let mut geometry = cloud(&mut numbers, 1.0);
    let rays = through(&mut numbers, 4000);
    let (exact, _) = brute(&geometry, &rays);
    geometry.precision = Precision::Fast;
    let mut accel = Accel::new(geometry, Preset::Fast);
    for level in Level::available() {
        accel.level = level.token().expect("it is available");
        for kernel in KernelChoice::ALL {
            accel.kernel = kernel;
            let (fast, any) = answers(&accel, &rays, &mut accel.traversal());
            let differ = fast.iter().zip(&exact).filter(|(f, r)| f.primitive != r.primitive);
            // What single precision decides otherwise passes an edge within its rounding.
            assert!(differ.count() <= 2, "{level:?} {kernel:?}");
            let differ = any.iter().zip(&exact).filter(|(any, r)| **any == r.is_miss());
            assert!(differ.count() <= 2, "{level:?} {kernel:?}");
        }
    }
}

/// What boxes are padded by would overflow, and children that are not there be met.
#[test]
fn hc26_rays_from_the_farthest_places_there_are_come_to_an_end() {
    let mut numbers = Numbers(70_000);
    let geometry = cloud(&mut numbers, 1.0);
    let mut from = |most: f32| -> Vec<Ray> {
        let mut ray = |i: usize| {
            let mut any = || [most, -most, 16.0, 0.7 * most][numbers.below(4)];
            let mut origin = Vec3::new(any(), any(), any());
            origin[i % 3] = most;
            let direction = if i.is_multiple_of(2) { -origin } else { numbers.vector() - origin };
            Ray::new(origin, direction)
        };
        (0..64).map(&mut ray).collect()
    };
    assert_eq!(compare("too far", &geometry, &from(f32::MAX)), 0);
    // From here single precision places vertices anywhere: any hit is right that all agree on.
    compare("farthest", &geometry, &from(FARTHEST_ORIGIN));
}

#[test]
fn every_kernel_counts_hits_whose_t_it_finds() {
    for precision in Precision::ALL {
        let mut numbers = Numbers(0);
        let mut geometry = cloud(&mut numbers, 1.0);
        geometry.quadrics.clear();
        geometry.set_precision(precision);
        let rays = through(&mut numbers, 500);
        let mut accel = Accel::new(geometry, Preset::Fast);
        for kernel in KernelChoice::FOR_RENDERS {
            accel.kernel = kernel;
            let (mut traversal, mut hits) = (accel.traversal(), vec![Hit::MISS; rays.len()]);
            accel.closest_of(&rays[..], &mut hits, &mut traversal);
            hits.retain(|hit| !hit.is_miss());
            assert!(hits.len() > 100, "{}", hits.len());
            let TestCounts { finished, settled, .. } = traversal.tests;
            // The t of open pairs is known once they are settled.
            let least = hits.len() as u64 - settled.min(hits.len() as u64);
            let expected = match precision {
                Precision::Fast => 0..=0,
                Precision::Exact => least..=hits.len() as u64,
            };
            assert!(expected.contains(&finished), "{kernel:?}: {finished} of {expected:?}");
        }
    }
}
