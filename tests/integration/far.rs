//! Scenes far from the origin: what is moved together looks the same, to the last bit where nothing has to be rounded.

use glam::DVec3;
use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_image::compare::compare;
use wavecrest_scene::load::{LoadOptions, load};

use crate::support::{
    folder, image, image_of, matte, point_light, put, ready, scene, try_prepare, with,
};

/// How far, by multiples of the power of two that scenes are moved back by. In single precision a coordinate there has
/// steps of an eighth.
const FAR: DVec3 = DVec3::new(1_048_576.0, -2_097_152.0, 524_288.0);

/// A number with more digits than single precision has, and as many as double precision keeps that far out.
fn exact(x: f64) -> f64 {
    (x * 1_073_741_824.0).round() / 1_073_741_824.0
}

/// Points moved by `by`.
fn points<const N: usize>(points: [[f64; 3]; N], by: DVec3) -> Value {
    points.map(|p| (DVec3::from_array(p.map(exact)) + by).to_array()).into_iter().collect()
}

/// A pyramid without base, as its points and corners.
fn pyramid(by: DVec3) -> Value {
    let corners = [
        [-0.412_345_67, -0.287_654_32, -4.4],
        [0.387_654_32, -0.3, -4.1],
        [0.1, 0.431_234_56, -4.3],
        [0.012_345_67, 0.023_456_78, -3.912_345_67],
    ];
    json!({"type": "trimesh", "points": points(corners, by), "material": matte(0.9, [0.9, 0.4, 0.2]),
           "indices": [[0, 3, 1], [1, 3, 2], [2, 3, 0]], "name": "pyramid"})
}

/// A scene of `shapes` and `instances`, whose camera and light are moved by `by`.
fn seen(by: DVec3, lights: &[Value], shapes: &[Value], instances: Value) -> Value {
    let at = |p: [f64; 3]| (DVec3::from_array(p) + by).to_array();
    let camera = json!({"type": "pinhole", "width": 96, "height": 72, "fov": 40,
                        "location": at([0.0; 3]), "look": at([0.0, 0.0, -4.0])});
    let lamp = point_light(60.0, at([1.5, 2.0, -1.0]), [1.0; 3]);
    let mut json = scene(1, &camera, &[&[lamp], lights].concat(), shapes);
    json["scene"]["instances"] = instances;
    json
}

/// Both scenes have one image, which shows more than the background.
fn assert_same(near: &Value, far: &Value, what: &str) {
    let [near, far] = [near, far].map(image);
    assert_same_films(&near, &far, what);
}

/// Both are one image, which shows more than the background.
fn assert_same_films(near: &Film, far: &Film, what: &str) {
    let shown = near.pixels().iter().filter(|pixel| **pixel != near.pixels()[0]).count();
    assert!(shown > 50, "{what} fills {shown} pixels");
    let pairs = near.pixels().iter().zip(far.pixels());
    let differing = pairs.filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0, "{what}");
}

/// A shape, moved so far.
type Shape = fn(DVec3) -> Value;

#[test]
fn hc07_shapes_of_every_kind_are_moved_before_they_are_rounded() {
    let shapes: [(&str, Shape); 5] = [
        ("mesh", pyramid),
        ("triangle", |by| {
            let corners = [[-0.5, -0.4, -4.2], [-0.1, 0.61, -4.0], [0.7, -0.3, -3.8]];
            json!({"type": "triangle", "points": points(corners, by)})
        }),
        ("strip", |by| {
            let corners =
                [[-0.5, -0.4, -4.2], [-0.1, 0.61, -4.0], [0.7, -0.3, -3.8], [0.9, 0.4, -4.0]];
            json!({"type": "trimesh", "points": points(corners, by), "sides": "both"})
        }),
        ("quad", |by| {
            let corners =
                [[-0.4, -0.3, -4.0], [-0.4, 0.5, -4.0], [0.6, 0.5, -4.0], [0.6, -0.3, -4.0]];
            json!({"type": "plane", "points": points(corners, by)})
        }),
        ("sphere", |by| {
            let center = points([[0.1, -0.123_456_78, -4.0]], by)[0].clone();
            json!({"type": "sphere", "center": center, "radius": 0.712_345_67})
        }),
    ];
    for (name, shape) in shapes {
        let scene = |by: DVec3| {
            let shape = with(shape(by), "material", matte(0.9, [0.9, 0.4, 0.2]));
            seen(by, &[], &[shape], json!([]))
        };
        assert_same(&scene(DVec3::ZERO), &scene(FAR), name);
    }
}

#[test]
fn hc07_a_transform_moves_a_far_mesh_back_exactly() {
    let back = json!({"translate": (-FAR).to_array()});
    let near = seen(DVec3::ZERO, &[], &[pyramid(DVec3::ZERO)], json!([]));
    let far = seen(DVec3::ZERO, &[], &[with(pyramid(FAR), "transform", back)], json!([]));
    assert_same(&near, &far, "a mesh");
}

#[test]
fn hc07_instances_of_a_far_mesh_are_where_they_would_be() {
    let scene = |by: DVec3| {
        let hidden = with(pyramid(by), "hidden", true);
        let at = |x: f64| json!({"shape": "pyramid", "transform": {"translate": [x, 0.0, 0.0]}});
        seen(by, &[], &[hidden], json!([at(-0.5), at(0.5)]))
    };
    assert_same(&scene(DVec3::ZERO), &scene(FAR), "instances");
}

/// The pyramid moved by `by`, as the text of a mesh file. Coordinates are multiples of 2^-12, so that none is rounded.
fn mesh_file(kind: &str, by: DVec3) -> Vec<u8> {
    let corners = [
        [-0.5, -0.25, -4.5],
        [0.375, -0.125, -4.0],
        [0.125, 0.4375, -4.25],
        [0.0625, 0.031_25, -3.9375],
    ];
    let points = corners.map(|p| DVec3::from_array(p) + DVec3::splat(1.0 / 4096.0) + by);
    let faces = [[0_u32, 1, 3], [1, 2, 3], [2, 0, 3]];
    if kind == "obj" {
        let vertices = points.map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).concat();
        let faces = faces.map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).concat();
        return [vertices, faces].concat().into_bytes();
    }
    let header = format!(
        "ply\nformat {kind} 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n\
         element face 3\nproperty list uchar uint vertex_indices\nend_header\n"
    );
    let is_big = kind == "binary_big_endian";
    let double = |x: f64| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
    let int = |x: u32| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
    let (vertices, faces) = if kind == "ascii" {
        let vertices = points.map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).concat();
        let faces = faces.map(|[a, b, c]| format!("3 {a} {b} {c}\n")).concat();
        (vertices.into_bytes(), faces.into_bytes())
    } else {
        let faces = faces.map(|face| [&[3], &*face.map(int).concat()].concat());
        (points.map(|p| p.to_array().map(double).concat()).concat(), faces.concat())
    };
    [header.into_bytes(), vertices, faces].concat()
}

const KINDS: [&str; 4] = ["obj", "ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn hc07_mesh_files_in_double_precision_keep_their_shape_far_away() {
    let folder = folder();
    for kind in KINDS {
        let films = [DVec3::ZERO, FAR].map(|by| {
            let name = if kind == "obj" { "far.obj" } else { "far.ply" };
            put(folder.path(), name, mesh_file(kind, by));
            let shape = json!({"type": "trimesh", "file": name, "name": "pyramid", "sides": "both",
                               "material": matte(0.9, [0.9, 0.4, 0.2])});
            let copies = [0.5, 1.0]
                .map(|x| json!({"shape": "pyramid", "transform": {"translate": [x, 0, 0]}}));
            [json!([]), json!(copies)].map(|instances| {
                let scene = seen(by, &[], std::slice::from_ref(&shape), instances);
                image_of(&try_prepare(&scene, &folder.path().join("scene.json")).unwrap(), 0)
            })
        });
        let [near, far] = films;
        for (near, far) in near.iter().zip(&far) {
            assert_same_films(near, far, kind);
        }
    }
}

#[test]
fn hc07_far_mesh_files_alone_are_framed_as_near_ones() {
    let folder = folder();
    for kind in KINDS {
        let path = folder.path().join(if kind == "obj" { "far.obj" } else { "far.ply" });
        let [near, far] = [DVec3::ZERO, FAR].map(|by| {
            std::fs::write(&path, mesh_file(kind, by)).unwrap();
            let options = LoadOptions { width: Some(96), ..LoadOptions::default() };
            image_of(&ready(load(&path, &options)), 0)
        });
        // The camera's place is rounded.
        let compared = compare(&far, &near).unwrap();
        assert!(compared.rmse < 0.01, "{kind}: {}", compared.rmse);
    }
}

/// It would have no area in single precision.
#[test]
fn hc07_a_far_light_that_is_a_mesh_keeps_its_area() {
    let scene = |by: DVec3| {
        let corners = [[-0.02, 0.9, -4.0], [0.03, 0.91, -4.0], [0.0, 0.9, -3.96]];
        let mesh =
            json!({"type": "trimesh", "points": points(corners, by), "indices": [[0, 1, 2]]});
        let light = json!({"type": "arealight", "intensity": 40.0, "color": [1, 1, 1],
                           "sampling": "sobol", "samples": 4, "shape": mesh});
        seen(by, &[light], &[pyramid(by)], json!([]))
    };
    assert_same(&scene(DVec3::ZERO), &scene(FAR), "a light");
}
