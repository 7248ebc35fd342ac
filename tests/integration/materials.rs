//! OBJ files with the materials of their MTL files, and PLY files with their pictures.

use std::path::Path;

use serde_json::json;
use wavecrest_core::film::Film;
use wavecrest_scene::load::{LoadOptions, LoadedScene, load, load_str};

use crate::support::{
    assert_near, edited, folder, image_of, matte, pinhole, pixel, plain, put, put_image, ready,
};

/// Two squares beside each other, in red and in what `right` names, and a third that has no material.
fn obj(right: &str) -> String {
    let square = |x: i32| format!("v {x} 0 0\nv {} 0 0\nv {} 1 0\nv {x} 1 0\n", x + 1, x + 1);
    let squares: String = [-2, -1, 0].map(square).concat();
    format!(
        "mtllib a b.mtl\n{squares}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 9 10 11 12\n\
         usemtl red\nf 1/1 2/2 3/3 4/4\nusemtl {right}\nf 5/1 6/2 7/3 8/4\n"
    )
}

const MTL: &str =
    "newmtl red\nKd 0.8 0.1 0.1\nnewmtl picture\nKd 1 1 1\nmap_Kd -bm 1 textures\\t.png\n";

fn written(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = folder();
    std::fs::create_dir(folder.path().join("textures")).expect("a folder");
    put_image(folder.path(), "textures/t.png", [2, 2], |_, _| [0.0, 1.0, 0.0]);
    files.iter().for_each(|(name, text)| put(folder.path(), name, text));
    folder
}

fn warnings(scene: &LoadedScene) -> Vec<String> {
    scene.warnings.iter().map(ToString::to_string).collect()
}

fn film(scene: LoadedScene) -> Film {
    image_of(&ready(Ok(scene)), 0)
}

fn loaded(path: &Path) -> LoadedScene {
    let options = LoadOptions { width: Some(24), height: Some(18), ..LoadOptions::default() };
    load(path, &options).unwrap_or_else(|error| panic!("{error}"))
}

/// A scene that shows the OBJ file from straight before it, under ambient light alone, with an instance above.
fn shown(folder: &Path, materials: &str) -> LoadedScene {
    let camera = json!({"type": "pinhole", "width": 6, "height": 4, "fov": 20, "fovaxis": "y",
                        "location": [-0.5, 1, 5.671_281_819_617_709], "look": [-0.5, 1, 0]});
    let shape = json!({"type": "trimesh", "file": "m.obj", "name": "m", "materials": materials,
                       "material": matte(1.0, [0.5, 0.5, 0.5])});
    let instances = json!([{"shape": "m", "transform": {"translate": [0, 1, 0]}}]);
    let json = edited(plain(0, &camera, &[shape]), &format!("/scene/instances {instances}"));
    let file = folder.join("scene.json");
    let options = LoadOptions { strict: true, ..LoadOptions::default() };
    load_str(&json.to_string(), &file, &options).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn each_face_has_its_material_and_its_picture() {
    let folder = written(&[("m.obj", &obj("picture")), ("a b.mtl", MTL)]);
    let scene = shown(folder.path(), "file");
    let is_of_files = |warning: &String| !warning.contains("lightsources");
    let told: Vec<String> = warnings(&scene).into_iter().filter(is_of_files).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("unsupported options of MTL maps: -bm"), "{told:?}");
    assert!(scene.files.iter().any(|file| file.ends_with("a b.mtl")));
    let found = film(scene);
    for y in [0, 3] {
        for (x, right) in [(0, [0.8, 0.1, 0.1]), (2, [0.0, 1.0, 0.0]), (5, [0.5; 3])] {
            assert_near(pixel(&found, x, y), right, 1e-6, &format!("{x}, {y}"));
        }
    }
    let plain = film(shown(folder.path(), "shape"));
    for x in [0, 2, 5] {
        assert_near(pixel(&plain, x, 3), [0.5; 3], 1e-6, "of the shape");
    }
}

#[test]
fn missing_files_are_named_once_and_their_faces_are_plain() {
    for (files, right) in [
        (vec![("m.obj", obj("picture"))], "the material file \"a\" is missing"),
        (vec![("m.obj", obj("none")), ("a b.mtl", MTL.to_owned())], "not in any MTL file: none;"),
        (
            vec![("m.obj", obj("picture")), ("a b.mtl", MTL.replace("t.png", "u.png"))],
            "the image \"textures\\\\u.png\" is missing; put it beside the mesh",
        ),
        (
            vec![("m.obj", obj("picture")), ("a b.mtl", MTL.replace("\\t.png", "/../a b.mtl"))],
            "cannot read the texture",
        ),
    ] {
        let files: Vec<(&str, &str)> = files.iter().map(|(n, text)| (*n, text.as_str())).collect();
        let folder = written(&files);
        let scene = loaded(&folder.path().join("m.obj"));
        let told = warnings(&scene);
        let found = told.iter().filter(|warning| warning.contains(right)).count();
        assert_eq!(found, 1, "{right}: {told:?}");
        film(scene);
    }
}

/// A square with a picture of four colours: the same in each format, and as a scene file.
#[test]
fn pictures_are_the_same_in_every_format() {
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n";
    let ply = |own: &str, corners: [&str; 4], list: &str, face: &str| {
        let rows = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"].iter().zip(corners);
        let rows: String = rows.map(|(row, uv)| format!("{row} {uv}\n")).collect();
        format!(
            "ply\nformat ascii 1.0\ncomment TextureFile textures/four.png\nelement vertex 4\nproperty float x\n\
             property float y\nproperty float z\n{own}element face 1\nproperty list uchar int vertex_indices\n{list}\
             end_header\n{rows}4 0 1 2 3 {face}\n"
        )
    };
    let uvs = ["0 0", "1 0", "1 1", "0 1"];
    let vertex = ply("property float s\nproperty float t\n", uvs, "", "");
    let list = "property list uchar float texcoord\n";
    let corner = ply("", [""; 4], list, &format!("8 {}", uvs.join(" ")));
    let folder = written(&[("m.obj", obj), ("vertex.ply", &vertex), ("corner.ply", &corner)]);
    let colors = |x, y| [f32::from(x == 0), f32::from(y == 0), 0.5];
    put_image(folder.path(), "textures/four.png", [2, 2], colors);
    let of = |name: &str| {
        let scene = loaded(&folder.path().join(name));
        assert_eq!(warnings(&scene), [""; 0], "{name}");
        film(scene)
    };
    let mut films = Vec::new();
    for options in ["", "-s 3 2 -o 0.25 "] {
        put(folder.path(), "m.mtl", format!("newmtl a\nmap_Kd {options}textures/four.png\n"));
        films.push(of("m.obj"));
        let out = folder.path().join("out.json");
        wavecrest_scene::write::write(&loaded(&folder.path().join("m.obj")), &out, true)
            .expect("a scene");
        assert!(of("out.json").same_bits(films.last().expect("one")), "{options}");
    }
    assert!(!films[0].same_bits(&films[1]));
    for name in ["vertex.ply", "corner.ply"] {
        assert!(of(name).same_bits(&films[0]), "{name}");
    }
}

/// Colours of vertices multiply those of the material.
#[test]
fn the_colours_of_vertices_multiply_the_material() {
    let text = "v -9 -9 0 1 0.5 0\nv 9 -9 0 1 0.5 0\nv 0 9 0 1 0.5 0\nf 1 2 3\n";
    let folder = written(&[("m.obj", text)]);
    let half = 0.214_041_14;
    for (colors, right) in
        [("srgb", [0.5, 0.5 * half, 0.0]), ("linear", [0.5, 0.25, 0.0]), ("none", [0.5; 3])]
    {
        let shape = json!({"type": "trimesh", "file": "m.obj", "vertexcolors": colors,
                           "material": matte(1.0, [0.5, 0.5, 0.5])});
        let json = plain(0, &pinhole([3, 3], 20.0, 5.0), &[shape]);
        let file = folder.path().join("scene.json");
        let scene = load_str(&json.to_string(), &file, &LoadOptions::default()).expect("a scene");
        assert_near(pixel(&film(scene), 1, 1), right, 1e-6, colors);
    }
}
