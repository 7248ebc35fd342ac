//! Meshes at rest: skins and morph targets.

use glam::DVec3;
use serde_json::json;
use wavecrest_scene::components::{InstanceOf, Mesh, Transform};

use super::{File, SQUARE, image, loaded, square};
use crate::support::difference;

/// Columns of a matrix that moves by this.
fn moves([x, y, z]: [f32; 3]) -> [f32; 16] {
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
}

/// The square with two joints, nodes 3 and 4: its left side follows the first one, and its right
/// side the second one. Both are bound 10 to the right of where they are.
pub(super) fn skinned() -> File {
    let mut file = square();
    let joints = [[0, 9, 9, 9], [9, 1, 9, 9], [9, 1, 9, 9], [0, 9, 9, 9]];
    let joints = file.accessor(joints.as_flattened(), 5121, 4, "VEC4");
    let weights: [[f32; 4]; 4] =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];
    let weights = file.floats(&weights);
    let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    let bound = moves([-10.0, 0.0, 0.0]).repeat(2);
    let bytes: Vec<u8> = bound.iter().flat_map(|x| x.to_le_bytes()).collect();
    let bound = file.accessor(&bytes, 5126, 2, "MAT4");
    let joints = [0, 1].map(|_| file.node(json!({"translation": [10, 0, 0]})));
    file.json["skins"] = json!([{"joints": joints, "inverseBindMatrices": bound}]);
    file.json["nodes"][0]["skin"] = json!(0);
    file
}

/// The square with two targets: one moves its upper side up by 1, the other all of it to the right.
pub(super) fn morphed() -> File {
    let mut file = square();
    let up = SQUARE.map(|[_, y, _]| [0.0, if y > 0.0 { 1.0 } else { 0.0 }, 0.0]);
    let targets = [up, [[1.0, 0.0, 0.0]; 4]].map(|moves| json!({"POSITION": file.floats(&moves)}));
    file.json["meshes"][0]["primitives"][0]["targets"] = targets.into_iter().collect();
    file
}

/// The corners of all meshes in the world, but for those of instances alone.
fn corners(file: &File) -> Vec<[DVec3; 4]> {
    let mut world = loaded(file).expect("it is right").world;
    let meshes = world.query_mut::<(&Mesh, &Transform)>();
    let place = |(mesh, transform): (&Mesh, &Transform)| {
        let point = |i: usize| transform.0.transform_point3(mesh.data.positions[i].as_dvec3());
        [0, 1, 2, 3].map(point)
    };
    meshes.into_iter().map(place).collect()
}

fn moved(by: impl Fn(usize, DVec3) -> DVec3) -> [DVec3; 4] {
    [0, 1, 2, 3].map(|i| by(i, DVec3::from_array(SQUARE[i].map(f64::from))))
}

#[test]
fn joints_place_a_skin_and_its_node_does_not() {
    let mut file = skinned();
    file.json["nodes"][0]["scale"] = json!([100, 0, 100]);
    assert_eq!(corners(&file), [moved(|_, p| p)]);
    file.json["nodes"][4]["translation"] = json!([12, 0, 3]);
    let away = DVec3::new(2.0, 0.0, 3.0);
    let right = |i: usize| if i == 1 || i == 2 { away } else { DVec3::ZERO };
    assert_eq!(corners(&file), [moved(|i, p| p + right(i))]);
    // A joint moves with its parent; without matrices the mesh is bound at its own place.
    file.json["nodes"][3]["children"] = json!([4]);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    file.json["skins"][0] = json!({"joints": [3, 4]});
    let place = |i: usize| {
        DVec3::X * 10.0 + if i == 1 || i == 2 { away + DVec3::X * 10.0 } else { DVec3::ZERO }
    };
    assert_eq!(corners(&file), [moved(|i, p| p + place(i))]);
}

/// Both joints half each, in every type, in one set or in two.
#[test]
fn weights_of_every_type_and_set_are_blended() {
    let wide = |list: [u16; 4]| list.map(u16::to_le_bytes).as_flattened().repeat(4);
    let floats = |list: [f32; 4]| list.map(f32::to_le_bytes).as_flattened().repeat(4);
    let joints = [(5121, [0, 1, 0, 0].repeat(4)), (5123, wide([0, 1, 0, 0]))];
    let weights = [
        (5126, floats([0.5, 0.5, 0.0, 0.0])),
        // Their sum is not 1.
        (5126, floats([0.25, 0.25, 0.0, 0.0])),
        (5121, [127, 127, 0, 0].repeat(4)),
        (5123, wide([32_767, 32_767, 0, 0])),
    ];
    let right = [moved(|_, p| p + DVec3::new(2.0, 0.0, 0.0))];
    let mut plain = skinned();
    plain.json["nodes"][4]["translation"] = json!([14, 0, 0]);
    let accessor = |file: &mut File, (code, bytes): &(u32, Vec<u8>)| {
        let number = file.accessor(bytes, *code, 4, "VEC4");
        file.json["accessors"][number]["normalized"] = json!([5121, 5123].contains(code));
        number
    };
    for joints in &joints {
        for weights in &weights {
            let mut file = plain.clone();
            let weights = accessor(&mut file, weights);
            let joints = accessor(&mut file, joints);
            file.json["accessors"][joints]["normalized"] = json!(false);
            let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
            attributes["JOINTS_0"] = joints.into();
            attributes["WEIGHTS_0"] = weights.into();
            assert_eq!(corners(&file), right);
        }
    }
    let ones = |file: &mut File| file.floats(&[[0.5, 0.0, 0.0, 0.0]; 4]);
    let attributes = json!({
        "POSITION": 0, "JOINTS_0": plain.accessor(&[0; 16], 5121, 4, "VEC4"), "WEIGHTS_0": ones(&mut plain),
        "JOINTS_1": plain.accessor(&[1; 16], 5121, 4, "VEC4"), "WEIGHTS_1": ones(&mut plain)
    });
    plain.json["meshes"][0]["primitives"][0]["attributes"] = attributes;
    assert_eq!(corners(&plain), right);
}

/// Also with a mirror, and with normals that are not turned as positions are.
#[test]
fn a_skin_of_one_joint_looks_as_its_mesh_placed_there() {
    for place in [
        json!({"rotation": [0, 0.3, 0, 0.953_939_2], "scale": [0.5, 1, 2]}),
        json!({"scale": [-0.8, 0.6, 1], "translation": [0.1, 0.2, -1]}),
        json!({"translation": [4000, -5000, 2000]}),
    ] {
        let with_normals = |mut file: File| {
            let normals = file.floats(&[[0.3, 0.2, 1.0]; 4]);
            file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
            file
        };
        let mut plain = with_normals(square());
        let mut file = with_normals(skinned());
        plain.json["nodes"][0] = json!({"mesh": 0});
        for (key, value) in place.as_object().expect("an object") {
            plain.json["nodes"][0][key] = value.clone();
        }
        file.json["nodes"][3] = place.clone();
        file.json["skins"][0] = json!({"joints": [3, 3]});
        if place["translation"][0] == 4000 {
            for file in [&mut plain, &mut file] {
                file.json["nodes"][1]["translation"] = json!([4000, -5000, 2005]);
                file.json["nodes"][2]["translation"] = json!([4001, -4998, 2004]);
            }
        }
        let far = difference(&image(&plain), &image(&file));
        assert!(far < 1e-5, "{place}: {far}");
    }
}

#[test]
fn targets_count_by_the_weights_of_the_node_or_else_of_the_mesh() {
    let up = |i: usize, by: f64| if i >= 2 { DVec3::Y * by } else { DVec3::ZERO };
    let mut file = morphed();
    assert_eq!(corners(&file), [moved(|_, p| p)]);
    file.json["meshes"][0]["weights"] = json!([0.5, 2]);
    assert_eq!(corners(&file), [moved(|i, p| p + up(i, 0.5) + DVec3::X * 2.0)]);
    file.json["nodes"][0]["weights"] = json!([-1, 0]);
    assert_eq!(corners(&file), [moved(|i, p| p + up(i, -1.0))]);
}

#[test]
fn targets_move_normals_and_skins_move_what_targets_moved() {
    let mut file = morphed();
    let normals = file.floats(&[[0.0, 0.0, 1.0]; 4]);
    let leans = file.floats(&[[0.5, 0.0, 0.0]; 4]);
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = normals.into();
    primitive["targets"] = json!([{"NORMAL": leans}]);
    file.json["nodes"][0]["weights"] = json!([2]);
    let mut leaning = square();
    let normals = leaning.floats(&[[1.0, 0.0, 1.0]; 4]);
    leaning.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    assert!(difference(&image(&file), &image(&leaning)) < 1e-6);

    let mut file = skinned();
    let right = file.floats(&[[1.0, 0.0, 0.0]; 4]);
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": right}]);
    file.json["nodes"][0]["weights"] = json!([3]);
    file.json["nodes"][3]["translation"] = json!([10, 7, 0]);
    let with = |i: usize| if i == 0 || i == 3 { DVec3::Y * 7.0 } else { DVec3::ZERO };
    assert_eq!(corners(&file), [moved(|i, p| p + DVec3::X * 3.0 + with(i))]);
}

#[test]
fn a_mesh_is_stored_once_for_each_pose() {
    let mut file = morphed();
    for weights in [json!([0, 0]), json!([1, 0]), json!([1, 0]), json!([0, 1])] {
        file.node(json!({"mesh": 0, "weights": weights}));
    }
    let mut world = loaded(&file).expect("it is right").world;
    assert_eq!(world.query_mut::<&Mesh>().into_iter().count(), 3);
    assert_eq!(world.query_mut::<&InstanceOf>().into_iter().count(), 4);
    let mut file = skinned();
    file.node(json!({"mesh": 0, "translation": [0, 5, 0]}));
    let mut found = corners(&file);
    found.sort_by(|a, b| a[0].y.total_cmp(&b[0].y));
    assert_eq!(found, [moved(|_, p| p), moved(|_, p| p + DVec3::Y * 5.0)]);
}
