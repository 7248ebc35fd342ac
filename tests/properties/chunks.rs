use glam::{DAffine3, DQuat, DVec3, Vec3};
use wavecrest_core::accel::build::{ChunkSizes, Preset, build};
use wavecrest_core::accel::tree::Tree;
use wavecrest_core::accel::{Accel, Hit};
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::geometry::{Geometry, Primitive, Quadric};
use wavecrest_core::kernels::quad;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;

use crate::kernels::{add_quad, add_triangle, brute, check, shells};

fn random(index: u32, dimension: u32) -> [f32; 4] {
    Stream { seed: 11, pixel: index, sample: 0, bounce: 0 }.uniform(dimension)
}

/// Triangles of very uneven size, quads, spheres, and some triangles without area.
fn mixture(count: u32) -> Geometry {
    let mut geometry = Geometry::default();
    for i in 0..count {
        let [x, y, z, s] = random(i, 0);
        let center = Vec3::new(x, y, z) * 10.0;
        let size = 0.01 + 2.0 * s * s * s * s;
        let first = geometry.positions.len() as u32;
        for k in 0..3 {
            let [a, b, c, _] = random(i, 1 + k);
            let flat = if i % 10 == 0 { 0.0 } else { 1.0 };
            geometry.positions.push(center + (Vec3::new(a, b * flat, c * flat) - 0.5) * size);
        }
        if i % 10 == 0 {
            let p = geometry.positions[first as usize];
            geometry.positions[first as usize + 1] = p;
        }
        geometry.triangles.push([first, first + 1, first + 2]);
        if i % 8 == 0 {
            let [_, side, up] = [0, 1, 2].map(|k| geometry.positions[first as usize + k] - center);
            add_quad(&mut geometry, [center, center + up, center + up + side, center + side]);
            geometry.quadrics.push(Quadric::Sphere(center - Vec3::splat(size), 0.2 * size));
        }
    }
    geometry
}

/// Needles from one corner, of which some are there often, so that they are in a fan and in a heap.
fn needles(count: u32) -> Geometry {
    let mut geometry = Geometry { positions: vec![Vec3::splat(1.0)].into(), ..Geometry::default() };
    for i in 0..count {
        let [x, y, z, _] = random(i, 30);
        let tip = Vec3::new(x, y, z) * 9.0;
        geometry.positions.extend([tip, tip + Vec3::new(0.05, 0.02, 0.0)]);
        let needle = [0, 2 * i + 1, 2 * i + 2];
        geometry.triangles.extend(vec![needle; if i == 7 { 90 } else { 1 }]);
    }
    geometry
}

/// Every other ray ends on its way.
fn rays() -> Vec<Ray> {
    let ray = |i| {
        let [a, b, c, _] = random(i, 20);
        let [d, e, f, _] = random(i, 21);
        let origin = Vec3::new(a, b, c) * 14.0 - 2.0;
        let ray = Ray::new(origin, Vec3::new(d, e, f) * 10.0 - origin);
        Ray { t_max: if i % 2 == 0 { 0.7 } else { ray.t_max }, ..ray }
    };
    (0..400).map(ray).collect()
}

const fn cut(chunk: usize, parts: usize, room: usize) -> ChunkSizes {
    ChunkSizes { chunk, parts, room }
}

/// Cuts that make many chunks of a small scene: with no room, with some, and with enough.
const CUTS: [ChunkSizes; 3] = [cut(1, 1, 0), cut(37, 4, 40), cut(500, 50, 400)];

/// Presets of which each builds in another way.
const CHUNKED: [Preset; 5] =
    [Preset::OnDemand, Preset::Fastest, Preset::VeryFast, Preset::Fast, Preset::Medium];

fn cut_accel(geometry: &Geometry, preset: Preset, cut: ChunkSizes) -> Accel {
    Accel::in_chunks(geometry.clone(), preset, cut)
}

#[test]
fn a_tree_over_a_fan_answers_as_brute_force_does() {
    let (geometry, rays) = (needles(1200), rays());
    let expected = brute(&geometry, &rays);
    for (preset, cut) in CHUNKED.into_iter().flat_map(|p| [(p, CUTS[2]), (p, cut(5000, 8, 400))]) {
        let mut accel = cut_accel(&geometry, preset, cut);
        check(&format!("{preset:?} {cut:?}"), &mut accel, &rays, &expected);
    }
}

#[test]
fn hc03_a_tree_in_chunks_answers_as_brute_force_does() {
    let (geometry, rays) = (mixture(1500), rays());
    let expected = brute(&geometry, &rays);
    for (preset, cut) in CHUNKED.into_iter().flat_map(|p| CUTS.map(|cut| (p, cut))) {
        let mut accel = cut_accel(&geometry, preset, cut);
        check(&format!("{preset:?} {cut:?}"), &mut accel, &rays, &expected);
        check_leaves(&accel);
    }
}

/// Every primitive is within the boxes of its leaves, and in as many as it has to be: a quad by halves.
fn check_leaves(accel: &Accel) {
    accel.build_rest();
    let (geometry, tree) = (accel.geometry(), accel.tree().expect("it has one"));
    let mut leaves = vec![0; geometry.len()];
    tree.for_each_leaf(|bounds, numbers| {
        for number in numbers {
            leaves[number as usize] += 1;
            let is_around = |own: Aabb| bounds.union(own) == *bounds;
            let is_within = match geometry.primitive(number) {
                Primitive::Quad(i) => {
                    quad::halves(&geometry.quad(i)).into_iter().map(Aabb::around).any(is_around)
                }
                _ => is_around(geometry.bounds(number)),
            };
            assert!(is_within, "{number}");
        }
    });
    for (number, times) in (0..).zip(leaves) {
        let expected = match geometry.primitive(number) {
            Primitive::Quad(_) => 2,
            _ => i32::from(!geometry.is_degenerate(number)),
        };
        assert_eq!(times, expected, "{number}");
    }
}

#[test]
fn the_tree_is_the_same_on_any_number_of_threads() {
    let geometry = mixture(3000);
    let built = |threads: usize, preset: Preset| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let cut = cut(100, 8, if threads == 2 { 400 } else { 30 });
        let accel = pool.install(|| cut_accel(&geometry, preset, cut));
        accel.build_rest();
        let (mut leaves, tree) = (Vec::new(), accel.tree().expect("it has one"));
        tree.for_each_leaf(|bounds, numbers| leaves.push((*bounds, numbers)));
        (leaves, tree.census())
    };
    for preset in CHUNKED {
        let alone = built(1, preset);
        assert!([2, 5].iter().all(|&threads| built(threads, preset) == alone), "{preset:?}");
    }
}

/// All threads reach the same chunks at once, many times.
#[test]
fn a_chunk_is_built_once_whoever_comes_first() {
    let (geometry, rays) = (mixture(300), rays());
    let (reference, _) = brute(&geometry, &rays);
    for _ in 0..1000 {
        let accel = cut_accel(&geometry, Preset::OnDemand, cut(20, 1, 400));
        let tree = accel.tree().expect("it has one");
        assert_eq!(tree.chunks().expect("it is built on demand")[0], 0);
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    let (mut hits, mut traversal) = (vec![Hit::MISS; 400], accel.traversal());
                    accel.closest_of(&*rays, &mut hits, &mut traversal);
                    assert!(hits == reference);
                });
            }
        });
        let before = tree.census();
        accel.build_rest();
        let [built, all] = tree.chunks().expect("it is built on demand");
        assert!(built == all && before.nodes <= tree.census().nodes && before.nodes > 8);
    }
}

/// Where a ray meets nothing, nothing is built.
#[test]
fn only_chunks_that_rays_reach_are_built() {
    let geometry = mixture(1500);
    let accel = cut_accel(&geometry, Preset::OnDemand, cut(37, 1, 400));
    let mut traversal = accel.traversal();
    let mut built = |ray: Ray| {
        accel.closest(&ray, &mut traversal);
        accel.tree().and_then(Tree::chunks).expect("it is built on demand")[0]
    };
    assert_eq!(built(Ray::new(Vec3::splat(50.0), Vec3::X)), 0);
    let through = built(Ray::new(Vec3::new(-3.0, 5.1, 5.2), Vec3::X));
    assert!((1..30).contains(&through), "{through}");
    assert_eq!(built(Ray::new(Vec3::new(-3.0, 5.1, 5.2), Vec3::X)), through);
}

#[test]
fn hc23_a_chunk_that_is_too_deep_is_a_list() {
    // Each sphere is a little larger than the one before, and encloses half of it.
    let sphere = |i| Quadric::Sphere(Vec3::X * 1.05_f32.powi(i), 0.5 * 1.05_f32.powi(i));
    let geometry = Geometry { quadrics: (-568..568).map(sphere).collect(), ..Geometry::default() };
    let (rays, mut accel) = (rays(), cut_accel(&geometry, Preset::OnDemand, cut(300, 1, 400)));
    check("spheres", &mut accel, &rays, &brute(&geometry, &rays));
    let tree = accel.tree().expect("it has one");
    accel.build_rest();
    // In leaves, each would be in a list of its own.
    let lists = tree.census().lists;
    assert!(lists < geometry.quadrics.len() as u64 / 4, "{lists} lists: chunks are not too deep");
}

#[test]
fn rays_build_where_they_are_few_or_much_is_out_of_view() {
    for (out_of_view, rays, expected) in [
        (0, 0, Preset::OnDemand),
        (0, 1999, Preset::OnDemand),
        (0, 2000, Preset::Fastest),
        (500, 7999, Preset::OnDemand),
        (500, 8000, Preset::Fastest),
        (1000, 32_000, Preset::Fast),
    ] {
        let chosen = Preset::choose_for_part(1000, out_of_view, rays);
        assert_eq!(chosen, expected, "{out_of_view} {rays}");
        if expected != Preset::OnDemand {
            assert_eq!(chosen, Preset::choose(1000, rays));
        }
    }
}

#[test]
fn large_triangles_make_no_chunk_large() {
    let mut geometry = Geometry::default();
    for i in 0..2000 {
        let corner = Vec3::from_slice(&random(i, 30)[..3]) * 10.0;
        add_triangle(&mut geometry, [corner, corner + Vec3::X * 0.1, corner + Vec3::Y * 0.1]);
    }
    let nodes = |geometry: &Geometry, preset| {
        let accel = cut_accel(geometry, preset, cut(40, 1, 400));
        accel.build_rest();
        accel.tree().expect("it has one").expected_visits().nodes
    };
    for preset in [Preset::OnDemand, Preset::Fastest] {
        let small = nodes(&geometry, preset);
        let mut both = geometry.clone();
        for x in [1.0, 4.0, 9.0] {
            add_triangle(&mut both, [Vec3::ZERO, Vec3::new(x, 10.0, 0.0), Vec3::new(x, 0.0, 10.0)]);
        }
        let with_large = nodes(&both, preset);
        assert!(with_large < 1.2 * small, "{preset:?}: {with_large} nodes instead of {small}");
    }
}

#[test]
fn triangles_that_repeat_positions_share_leaves() {
    let mut shared = Geometry::default();
    let mut repeated = Geometry::default();
    for (i, j) in (0..40).flat_map(|i| (0..40).map(move |j| (i, j))) {
        shared.positions.push(Vec3::new(i as f32, j as f32, 0.2 * random(i, j)[0]));
        if i < 39 && j < 39 {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| (i + x) * 40 + j + y);
            shared.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    for i in 0..shared.triangles.len() {
        add_triangle(&mut repeated, shared.triangle(i));
    }
    for cut in [CUTS[1], CUTS[2], cut(usize::MAX, 1, 0)] {
        let census = |geometry| build(geometry, &[], Preset::Fast, cut).census();
        assert_eq!(census(&repeated), census(&shared), "{cut:?}");
        let mut accel = cut_accel(&repeated, Preset::Fast, cut);
        check("repeated", &mut accel, &rays(), &brute(&shared, &rays()));
    }
}

#[test]
fn the_heuristic_expects_what_areas_say() {
    let expected = |spheres: Vec<Quadric>| {
        let geometry = Geometry { quadrics: spheres, ..Geometry::default() };
        let visits = build(&geometry, &[], Preset::Fast, ChunkSizes::default()).expected_visits();
        [visits.nodes, visits.leaves].map(|visits| (visits * 1e4).round() / 1e4)
    };
    assert_eq!(expected(Vec::new()), [0.0, 0.0]);
    assert_eq!(expected(vec![Quadric::Sphere(Vec3::ZERO, 1.0)]), [0.0, 1.0]);
    // Two cubes of side 2 in a box of 12 by 2 by 2.
    let apart = (2.0 * 12.0_f64 / 52.0 * 1e4).round() / 1e4;
    let two = [Vec3::ZERO, Vec3::X * 10.0].map(|center| Quadric::Sphere(center, 1.0));
    assert_eq!(expected(two.to_vec()), [1.0, apart]);
}

/// The outermost hides the others, so that the tree saves nearly all tests.
#[test]
fn hc22_around_one_another_most_are_not_tested() {
    for preset in [Preset::Fastest, Preset::VeryFast] {
        let accel = Accel::new(shells(1000), preset);
        let mut traversal = accel.traversal();
        let hit = accel.closest(&Ray::new(Vec3::Z * 9.0, Vec3::NEG_Z), &mut traversal);
        assert_eq!(hit.primitive, 999);
        assert!(traversal.tests.primitives.spheres < 100, "{preset:?}: {:?}", traversal.tests);
    }
}

/// As trees of all sizes that stand at one place, among others: they are joined in parts.
#[test]
fn many_nested_instances_are_found_as_by_brute_force() {
    let mut prototype = Geometry::default();
    let corner = |x: u8, y: u8| Vec3::new(f32::from(x), f32::from(y), 0.5);
    add_triangle(&mut prototype, [corner(0, 0), corner(1, 0), corner(0, 1)]);
    let bounds = Aabb { low: Vec3::ZERO, high: Vec3::ONE };
    let instance = |i: u32| {
        let scale = DVec3::splat(1.0 + f64::from(i) / 300.0);
        let place =
            if i.is_multiple_of(4) { DVec3::new(f64::from(i), 0.0, 0.0) } else { DVec3::ZERO };
        let world = DAffine3::from_scale_rotation_translation(scale, DQuat::IDENTITY, place);
        Instance::new(0, i, world, &bounds)
    };
    let instances = (0..3000).map(instance).collect();
    let geometry = Geometry { prototypes: vec![prototype], instances, ..Geometry::default() };
    let rays: Vec<Ray> = (0..300)
        .map(|i| {
            let [x, y, far, z] = random(i, 0);
            let x = if i % 2 == 0 { 12.0 * x } else { 3000.0 * far };
            let target = Vec3::new(x, 12.0 * y, 12.0 * z);
            Ray::new(Vec3::new(x, 3.0, -2.0), target - Vec3::new(x, 3.0, -2.0))
        })
        .collect();
    let closest = |preset| {
        let accel = Accel::new(geometry.clone(), preset);
        let mut found = vec![Hit::MISS; rays.len()];
        accel.closest_of(&rays[..], &mut found, &mut accel.traversal());
        found
    };
    let expected = closest(Preset::Brute);
    assert!(expected.iter().filter(|hit| !hit.is_miss()).count() > 50);
    for preset in [Preset::OnDemand, Preset::Fastest, Preset::Medium] {
        assert_eq!(closest(preset), expected, "{preset:?}");
    }
}
