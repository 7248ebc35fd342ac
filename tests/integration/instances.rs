//! Instances: a mesh that is held once looks as its copies would, to rounding; and what holds of any hit
//! holds of theirs, whatever the transform.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use serde_json::{Value, json};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, KernelChoice};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::math::random::Stream;
use wavecrest_report::selftest::examine::trial;
use wavecrest_report::selftest::{Count, Effort};
use wavecrest_scene::generate::{self, Model, Recipe};
use wavecrest_scene::systems::SceneOptions;

use crate::support::{edited, json_in, matte, options, prepare, prepare_in, render_on, repository};

/// The scene of `scenes/instances.json`, with this many pixels across.
fn stones(width: u32) -> Value {
    let scene = json_in(&repository("scenes"), "instances.json");
    edited(scene, &format!("/camera/width {width}\n/camera/height {}", width * 5 / 8))
}

#[test]
fn a_mesh_is_held_once_and_looks_as_its_copies_do() {
    let scene = stones(160);
    for kernel in [KernelChoice::Auto, KernelChoice::Reference] {
        let [held, flat] = [false, true].map(|flat| {
            let options = SceneOptions { flat, ..SceneOptions::default() };
            let mut ready = prepare_in(&repository("scenes"), &scene, options);
            ready.accel.kernel = kernel;
            ready
        });
        let geometry = held.accel.geometry();
        assert_eq!((geometry.prototypes.len(), geometry.instances.len()), (2, 35));
        assert_eq!((geometry.held(), geometry.len()), (401, 7001));
        assert_eq!(flat.accel.geometry().len(), 7001);
        let [a, b] = [&held, &flat].map(|scene| render_on(1, scene, &options()));
        assert!(a.counters.tests.instances > 10_000, "{}", a.counters.tests.instances);
        assert_eq!(b.counters.tests.instances, 0);
        // What is rounded differently shows at silhouettes and at the ends of shadows alone.
        let far = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|k| (a[k] - b[k]).abs() > 1e-3);
        let pairs = a.film.pixels().iter().zip(b.film.pixels());
        let differing = pairs.filter(|&pair| far(pair)).count();
        assert!(differing <= 4, "{kernel:?}: {differing} of {} pixels", a.film.pixels().len());
    }
}

/// A number from 0 to 1 for each of the names.
fn numbers(index: u32, dimension: u32) -> [f64; 4] {
    Stream { seed: 3, pixel: index, sample: 0, bounce: 0 }.uniform(dimension).map(f64::from)
}

/// Any turn, scales from 1e-3 to 1e3 with up to a factor of 16 between axes, a shear, a mirror or none, and a
/// place up to a hundred sizes away.
fn transform(index: u32) -> DAffine3 {
    let [a, b, c, d] = numbers(index, 0);
    let [e, f, g, h] = numbers(index, 1);
    let [i, j, k, l] = numbers(index, 2);
    let size = 10_f64.powf(6.0 * a - 3.0);
    let scale =
        DVec3::new(size, size * 2_f64.powf(4.0 * b - 2.0), size * 2_f64.powf(4.0 * c - 2.0));
    let mirror = if d < 0.5 { DVec3::new(-1.0, 1.0, 1.0) } else { DVec3::ONE };
    let turn = DMat3::from_euler(glam::EulerRot::XYZ, 6.3 * e, 6.3 * f, 6.3 * g);
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(h - 0.5, 1.0, 0.0), DVec3::Z);
    let place = DVec3::new(i - 0.5, j - 0.5, k - 0.5) * size * 10_f64.powf(4.0 * l - 2.0);
    DAffine3 { matrix3: turn * shear * DMat3::from_diagonal(scale * mirror), translation: place }
}

fn bounds(prototype: &Geometry) -> Aabb {
    prototype.positions.iter().fold(Aabb::EMPTY, |all, &p| all.union(Aabb { low: p, high: p }))
}

fn shown(prototype: &Geometry, to_world: DAffine3) -> Accel {
    let instances = vec![Instance::new(0, 0, to_world, &bounds(prototype))];
    let geometry =
        Geometry { prototypes: vec![prototype.clone()], instances, ..Geometry::default() };
    Accel::new(geometry, Preset::Fast)
}

#[test]
fn no_ray_meets_the_surface_that_it_leaves() {
    let mut recipe = Recipe::new(Model::Sphere, 2000);
    recipe.displacement = 0.0;
    let mesh = generate::mesh(&recipe).expect("a mesh");
    let prototype =
        Geometry { positions: mesh.positions, triangles: mesh.triangles, ..Geometry::default() };
    let left = (0..120).map(|index| {
        let seed = u64::from(index);
        let effort = Effort { precision: Precision::Exact, seed, count: Count::Brief };
        let self_hits = trial(&shown(&prototype, transform(index)), &effort).self_hits;
        assert_eq!(self_hits.failed, 0, "transform {index}: {self_hits:?}");
        self_hits.tried
    });
    let left: u64 = left.sum();
    assert!(left > 200_000, "{left}");
}

/// Other prototypes than meshes, and a mesh that is shown once, are primitives of the scene's own.
#[test]
fn small_forms_are_copied_to_where_they_are_shown() {
    let material = matte(1.0, [1.0; 3]);
    let shapes = json!([
        {"type": "sphere", "name": "ball", "center": [0, 0, 0], "radius": 1, "material": material},
        {"type": "plane", "name": "tile", "points": [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]], "material": material},
        {"type": "triangle", "name": "flag", "points": [[0, 0, 0], [0, 1, 0], [1, 1, 0]], "material": material},
        {"type": "trimesh", "name": "once", "hidden": true, "points": [[0, 0, 0], [0, 1, 0], [1, 1, 0]], "material": material}
    ]);
    let at = |name: &str| json!({"shape": name, "transform": {"translate": [3, 0, 0], "scale": 2}});
    let mut scene = stones(32);
    scene["scene"]["shapes"] = shapes;
    scene["scene"]["instances"] = json!([at("ball"), at("tile"), at("flag"), at("once")]);
    let ready = prepare(&scene);
    let geometry = ready.accel.geometry();
    assert_eq!((geometry.instances.len(), geometry.prototypes.len()), (0, 0));
    let counts = [geometry.triangles.len(), geometry.quads.len(), geometry.quadrics.len()];
    assert_eq!(counts, [3, 2, 2]);
    assert_eq!(geometry.quadrics[1].sphere(), Some((Vec3::new(3.0, 0.0, 0.0), 2.0)));
    let places: Vec<&str> = ready.appearance.paths.iter().map(String::as_str).collect();
    assert!(places.contains(&"scene.instances[3]") && !places.contains(&"scene.shapes[3]"));
}
