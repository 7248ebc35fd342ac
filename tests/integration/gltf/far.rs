//! Files far from the origin look as they do about it.

use serde_json::json;

use super::{File, image, square};

/// Where single precision has steps of an eighth.
const FAR: [f64; 3] = [1_048_576.0, -2_097_152.0, 524_288.0];

/// The same with every node moved.
fn moved(file: &File) -> File {
    let mut file = file.clone();
    for node in file.json["nodes"].as_array_mut().expect("a list") {
        let own = |axis: usize| node["translation"][axis].as_f64().unwrap_or(0.0);
        node["translation"] = [0, 1, 2].map(|axis| own(axis) + FAR[axis]).into_iter().collect();
    }
    file
}

fn assert_alike(file: &File, what: &str) {
    let [near, far] = [image(file), image(&moved(file))];
    let shown = near.pixels().iter().filter(|pixel| **pixel != near.pixels()[0]).count();
    assert!(shown > 40, "{what} fills {shown} pixels");
    let is_off = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|k| (a[k] - b[k]).abs() > 0.01);
    let off = near.pixels().iter().zip(far.pixels()).filter(|&pair| is_off(pair)).count();
    assert!(off <= 2, "{what}: {off} pixels differ");
}

#[test]
fn hc07_nodes_are_moved_before_positions_are_rounded() {
    let mut file = square();
    assert_alike(&file, "a mesh, a camera and a light");
    file.node(json!({"mesh": 0, "translation": [0.3, 0.4, 0.5]}));
    assert_alike(&file, "instances");
}

#[test]
fn hc07_camera_studio_and_ground_are_put_about_a_far_file() {
    let mut file = square();
    file.json["scenes"][0]["nodes"] = json!([0]);
    file.json["nodes"][0]["rotation"] = json!([-0.5, 0.0, 0.0, 0.866_025_403_784]);
    assert_alike(&file, "a studio");
}
