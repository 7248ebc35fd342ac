use glam::Vec3;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Crossings, Hit, KernelChoice};
use wavecrest_core::geometry::{Geometry, Quadric, Surfaces};
use wavecrest_core::kernels::disk::{self, Disk};
use wavecrest_core::kernels::precision::{Exact, Reference};
use wavecrest_core::kernels::{sphere, triangle};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::probe::occluder;

use crate::kernels::{Numbers, add_quad, add_triangle, bumpy_sphere};
use crate::packets::scene;

fn crossings(accel: &Accel, ray: &Ray) -> Vec<Hit> {
    let mut crossings = Crossings::default();
    accel.crossings(ray, &mut accel.traversal(), &mut crossings);
    crossings.hits().to_vec()
}

/// The crossings of rays by brute force, which every tree and instruction level must find.
pub(crate) fn checked(geometry: &Geometry, rays: &[Ray]) -> Vec<Vec<Hit>> {
    let brute = Accel::new(geometry.clone(), Preset::Brute);
    let expected: Vec<_> = rays.iter().map(|ray| crossings(&brute, ray)).collect();
    for preset in [Preset::OnDemand, Preset::VeryFast, Preset::Medium] {
        let mut accel = Accel::new(geometry.clone(), preset);
        for level in Level::available() {
            accel.level = level.token().expect("it is available");
            for (ray, expected) in rays.iter().zip(&expected) {
                assert_eq!(&crossings(&accel, ray), expected, "{preset:?} {level:?} {ray}");
            }
        }
        accel.kernel = KernelChoice::Reference;
        for (ray, expected) in rays.iter().zip(&expected) {
            assert_eq!(&crossings(&accel, ray), expected, "{preset:?} reference {ray}");
        }
    }
    expected
}

/// Ties, rays in planes and along edges.
#[test]
fn hc03_crossings_on_a_grid_are_those_of_brute_force_and_are_met() {
    let mut numbers = Numbers(110_000);
    let mut geometry = Geometry::default();
    let mut point = || Vec3::from([0; 3].map(|_| numbers.below(7) as f32));
    for _ in 0..300 {
        add_triangle(&mut geometry, [point(), point(), point()]);
    }
    let corners = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::new(0.0, 1.0, 1.0)];
    add_quad(&mut geometry, corners.map(|corner| corner * 6.0));
    let rays: Vec<Ray> = (0..600)
        .map(|i| {
            let (from, to) = (point(), point());
            Ray { t_max: if i % 4 == 0 { 1.0 } else { f32::INFINITY }, ..Ray::new(from, to - from) }
        })
        .collect();
    let all = checked(&geometry, &rays);
    let mut skipped = 0;
    for (ray, hits) in rays.iter().zip(&all) {
        let met = (0..geometry.triangles.len() as u32).filter_map(|primitive| {
            let t = triangle::meet(ray, &geometry.triangle(primitive as usize))?;
            Some(Hit { t, primitive })
        });
        let met: Vec<Hit> = met.collect();
        let own = hits.iter().filter(|hit| (hit.primitive as usize) < geometry.triangles.len());
        assert!(own.clone().all(|hit| met.contains(hit)), "{ray}");
        skipped += met.len() - own.count();
    }
    assert!(skipped > 500, "{skipped}");
    assert!(all.iter().flatten().any(|hit| hit.primitive as usize == geometry.triangles.len()));
}

/// Spheres are entered and left, also by rays that touch them or start inside.
#[test]
fn hc05_spheres_are_crossed_twice_and_disks_once() {
    let mut numbers = Numbers(130_000);
    let mut geometry = Geometry::default();
    let mut point = || Vec3::from([0; 3].map(|_| numbers.below(5) as f32));
    for i in 0..60 {
        let (center, normal) = (point(), (point() - 2.0).normalize_or(Vec3::X));
        geometry.quadrics.push(match i % 2 {
            0 => Quadric::Sphere(center, 1.0),
            _ => Quadric::Disk(Disk { center, normal, radius: 1.0 }),
        });
    }
    let rays: Vec<Ray> = (0..600)
        .map(|i| {
            let (from, to) = (point(), point());
            let t_max = if i % 4 == 0 { 1.0 } else { f32::INFINITY };
            Ray { t_max, ..Ray::new(from, to - from) }
        })
        .filter(Ray::is_valid)
        .collect();
    let mut twice = 0;
    for (ray, hits) in rays.iter().zip(checked(&geometry, &rays)) {
        for (number, quadric) in (0..).zip(&geometry.quadrics) {
            let found = hits.iter().filter(|hit| hit.primitive == number);
            let found: Vec<f32> = found.map(|hit| hit.t).collect();
            let expected = match *quadric {
                Quadric::Sphere(center, radius) => {
                    sphere::crossings::<Reference>(ray, center, radius)
                }
                Quadric::Disk(disk) => [disk::intersect_exactly(ray, &disk), None],
            };
            let expected: Vec<f32> = expected.into_iter().flatten().collect();
            assert_eq!(found, expected, "{ray} {quadric:?}");
            twice += usize::from(found.len() == 2);
        }
    }
    assert!(twice > 500, "{twice}");
}

/// From outside, rays through corners and edges enter a closed surface as often as they leave
/// it, alternately.
#[test]
fn hc01_hc02_a_closed_surface_is_left_as_often_as_it_is_entered() {
    let mut numbers = Numbers(120_000);
    for mut geometry in [cube(), bumpy_sphere(12)] {
        if geometry.triangles.len() > 12 {
            weld(&mut geometry, 12);
        }
        let mut target = |geometry: &Geometry, i: usize| {
            let [a, b, c] = geometry.triangle(numbers.below(geometry.triangles.len()));
            // A corner, the middle of an edge, a point inside.
            [a, (a + b) * 0.5, (a + b + c) * 0.25][i % 3]
        };
        let rays: Vec<Ray> = (0..600)
            .map(|i| {
                let (p, q) = (target(&geometry, i), target(&geometry, i / 3));
                let from = if i % 2 == 0 { p - (q - p) * 8.0 } else { p.with_z(-9.0) };
                Ray::new(from, p - from)
            })
            .collect();
        let mut found = 0;
        for (ray, hits) in rays.iter().zip(checked(&geometry, &rays)) {
            let enters = |hit: &Hit| {
                let corners = geometry.triangle(hit.primitive as usize);
                triangle::normal(&corners).dot(ray.direction.as_dvec3()) < 0.0
            };
            let entered = hits.iter().filter(|hit| enters(hit)).count();
            assert_eq!(2 * entered, hits.len(), "{ray}: {hits:?}");
            found += hits.len();
        }
        assert!(found > 600, "{found}");
    }
}

/// Of integers, with sides along the axes: many rays run in their planes or along edges.
fn cube() -> Geometry {
    let corner = |i: u8| Vec3::from([0, 1, 2].map(|k| f32::from(i >> k & 1)));
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Geometry {
        positions: (0..8).map(corner).collect(),
        triangles: halves.collect(),
        ..Geometry::default()
    }
}

/// Closes the seam and the poles of a sphere of `n` times `n` pairs.
fn weld(geometry: &mut Geometry, n: u32) {
    for i in 0..geometry.positions.len() as u32 {
        let (u, v) = (i % (n + 1), i / (n + 1));
        let like = if v == 0 || v == n { v * (n + 1) } else { i - u + u % n };
        geometry.positions[i as usize] = geometry.positions[like as usize];
    }
}

/// Whatever kernel answers, what many rays pass is what each crosses of the transparent primitives.
#[test]
fn hc03_what_many_rays_pass_is_what_each_of_them_crosses() {
    let mut geometry = scene(60);
    let all = geometry.passed.clone();
    geometry.transparent = vec![all[0].start + 40..all[0].end, all[2].clone()];
    let mut numbers = Numbers(140_000);
    let eye = Vec3::new(0.3, 0.2, 5.0);
    let rays: Vec<Ray> = (0..2500)
        .map(|i| {
            let at = Vec3::new((i % 50) as f32 / 25.0 - 1.0, (i / 50) as f32 / 25.0 - 1.0, 0.0);
            // Coherent ones first, then scattered ones.
            let (from, to) = if i < 1500 { (eye, at) } else { (numbers.vector() * 2.0, at) };
            Ray { t_max: if i % 5 == 0 { 1.0 } else { f32::INFINITY }, ..Ray::new(from, to - from) }
        })
        .collect();
    let brute = Accel::new(geometry.clone(), Preset::Brute);
    let mut traversal = brute.traversal();
    let mut expected = Vec::new();
    for ray in &rays {
        let mut hits = crossings(&brute, ray);
        hits.retain(|hit| geometry.is_transparent(hit.primitive));
        let is_occluded = brute.occluded(ray, &mut traversal);
        expected.push(if is_occluded { Vec::new() } else { hits });
    }
    let found = expected.iter().filter(|hits| !hits.is_empty()).count();
    let most = expected.iter().map(Vec::len).max();
    assert!(found > 200 && most > Some(3), "{found} {most:?}");
    for preset in [Preset::Fast, Preset::OnDemand, Preset::Brute] {
        let mut accel = Accel::new(geometry.clone(), preset);
        let kernels = KernelChoice::FOR_RENDERS;
        for (level, kernel) in
            Level::available().into_iter().flat_map(|level| kernels.map(|kernel| (level, kernel)))
        {
            (accel.level, accel.kernel) = (level.token().expect("it is available"), kernel);
            let (mut traversal, search) = (accel.traversal(), accel.search::<Exact>());
            let mut occluded = vec![false; rays.len()];
            search.occluded_of((&*rays).into(), &mut occluded, &mut traversal);
            let mut list = Crossings::default();
            let mut next = 0;
            for size in [rays.len(), 100, 1] {
                while next < rays.len() {
                    let part = next..rays.len().min(next + size);
                    let asked = (Some(Surfaces::Transparent), &mut occluded[part.clone()]);
                    let part = (&rays[part]).into();
                    let count = search.crossings_of(part, asked, &mut traversal, &mut list);
                    let found: Vec<_> = list.of_rays().map(<[Hit]>::to_vec).collect();
                    assert!(
                        found == expected[next..next + count],
                        "{preset:?} {level:?} {kernel:?}"
                    );
                    next += count;
                }
                next = 0;
            }
        }
    }
}

/// Rays that together cross more than there is room for are searched in parts; one ray is searched whole.
#[test]
fn what_many_rays_cross_takes_bounded_memory() {
    let mut geometry = Geometry::default();
    for z in 0..20_000_u16 {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
        add_triangle(&mut geometry, corners.map(|[x, y]| Vec3::new(x, y, f32::from(z))));
    }
    let accel = Accel::new(geometry, Preset::Fastest);
    let rays: Vec<_> = (0..20_u8)
        .map(|i| {
            let t_max = if i < 10 { f32::INFINITY } else { 1.5 };
            Ray { t_max, ..Ray::new(Vec3::new(0.0, 0.0, -1.0), Vec3::Z) }
        })
        .collect();
    let (mut traversal, mut list) = (accel.traversal(), Crossings::default());
    let (mut next, mut parts) = (0, Vec::new());
    while next < rays.len() {
        let count = accel.crossings_of(&rays[next..], &mut traversal, &mut list);
        let each = if next < 10 { 20_000 } else { 1 };
        assert!(list.of_rays().all(|hits| hits.len() == each), "{next}");
        next += count;
        parts.push(count);
    }
    assert_eq!((&parts[..10], parts.len() < 16), (&[1; 10][..], true), "{parts:?}");
}

#[test]
fn hits_whose_t_is_rounded_down_are_passed() {
    let ray = Ray { t_max: 1.0, ..Ray::new(Vec3::ZERO, Vec3::Z * 10.0) };
    let mut geometry = Geometry::default();
    // 0.7 is above its nearest number, 0.3 below.
    for z in [3.0, 7.0, 7.0, 9.0] {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
        add_triangle(&mut geometry, corners.map(|[x, y]| Vec3::new(x, y, z)));
    }
    for (passed, found) in [(0..3, 3), (0..1, 1), (0..4, u32::MAX)] {
        geometry.passed = vec![passed.clone()];
        let accel = Accel::new(geometry.clone(), Preset::VeryFast);
        let hit = occluder(&accel, &ray, &mut accel.traversal());
        assert_eq!(hit.primitive, if found == u32::MAX { Hit::MISS.primitive } else { found });
        assert_eq!(hit.is_miss(), !accel.occluded(&ray, &mut accel.traversal()), "{passed:?}");
    }
}
