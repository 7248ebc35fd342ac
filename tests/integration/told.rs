//! What is said of scenes and meshes that are wrong, or can be rendered and are probably not meant so, word for word: where,
//! what was found, and what would be right.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems;

use crate::support::{
    BACKGROUND, edited, folder, image_of, matte, pinhole, point_light, put, repository, scene,
    try_ready, wall, with,
};
use crate::transcript;

/// A scene of one mesh from this file.
fn mesh_scene(file: &str) -> Value {
    with_shape(json!({"type": "trimesh", "file": file, "material": matte(0.8, [1.0, 0.6, 0.3])}))
}

fn with_shape(shape: Value) -> Value {
    let light = point_light(40.0, [1.0, 2.0, 4.0], [1.0; 3]);
    scene(0, &pinhole([24, 18], 50.0, 5.0), &[light], &[shape])
}

/// The image, the number of triangles left out, and the warnings of a scene in `folder`, with the note of what is dropped.
fn render(scene: &Value, folder: &Path) -> Result<(Film, u64, Vec<String>)> {
    let file = folder.join("s.json");
    let mut loaded = load_str(&scene.to_string(), &file, &LoadOptions::default())?;
    let warnings = std::mem::take(&mut loaded.warnings);
    let prepared = try_ready(Ok(loaded))?;
    let seen = systems::warnings(&prepared, &file);
    let note = systems::note(&prepared, &file).map(|note| within(folder, &format!("note: {note}")));
    let texts = warnings.iter().chain(&seen).map(|warning| within(folder, &warning.to_string()));
    let texts = texts.chain(note);
    let texts = texts.filter(|text| !text.contains("the image looks empty")).collect();
    Ok((image_of(&prepared, 0), prepared.degenerate, texts))
}

/// A text without the name of the folder.
fn within(folder: &Path, text: &str) -> String {
    text.replace(&format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR), "")
}

/// What is said of a scene in `folder`: a kind of error and its text, or warnings.
fn told(scene: &Value, folder: &Path) -> String {
    match render(scene, folder) {
        Ok((.., warnings)) if warnings.is_empty() => "no word".to_owned(),
        Ok((.., warnings)) => warnings.join("\n"),
        Err(error) => within(folder, &format!("{:?}: {error}", error.kind())),
    }
}

/// A PLY text with this many vertices and faces in its header, and this body.
fn ply(vertices: &str, faces: &str, body: &str) -> String {
    let coordinates = "property float x\nproperty float y\nproperty float z\n";
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\n{coordinates}element face {faces}\n\
         property list uchar int vertex_indices\nend_header\n{body}"
    )
}

/// The lines are those of the file; of a PLY file, those after a header of so many vertices and faces.
#[test]
fn meshes_that_are_wrong_are_refused_with_the_place() {
    transcript::check("meshes", |input, content| {
        let folder = folder();
        let words: Vec<&str> = input.split(' ').collect();
        let content = match words[..] {
            [_, vertices, faces] => ply(vertices, faces, content),
            _ => content.to_owned(),
        };
        match words[0] {
            "dir.ply" => std::fs::create_dir(folder.path().join("dir.ply")).expect("a folder"),
            "no.ply" => {}
            name => put(folder.path(), name, content),
        }
        told(&mesh_scene(words[0]), folder.path())
    });
}

/// The scene that an input names, edited as its lines say.
#[test]
fn scenes_that_are_wrong_or_not_meant_so_are_told_with_place_and_remedy() {
    let folder = folder();
    let triangle = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\n";
    put(folder.path(), "m.obj", [triangle, "f 1 2 3\n"].concat());
    put(folder.path(), "uvs.obj", [triangle, "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"].concat());
    let texture = repository("textures/checker.png");
    std::fs::copy(texture, folder.path().join("t.png")).expect("a copy");
    let stones = std::fs::read_to_string(repository("scenes/instances.json")).expect("a scene");
    transcript::check("scenes", |base, changes| {
        let mut within = folder.path().to_owned();
        let base = match base {
            "mesh" => mesh_scene("m.obj"),
            "mesh with coordinates" => mesh_scene("uvs.obj"),
            "wall" => with_shape(wall(1.0, 0.0, matte(0.8, [0.5; 3]))),
            "back" => with_shape(with(wall(1.0, 0.0, matte(0.8, [0.5; 3])), "normal", -1)),
            "instances" => {
                within = repository("scenes");
                serde_json::from_str(&stones).expect("JSON")
            }
            "moving" => edited(
                with_shape(wall(1.0, 0.0, matte(0.8, [0.5; 3]))),
                r#"/camera/path {"keys": [{"frame": 1}, {"frame": 3, "location": [2, 1, 5], "fov": 40}]}"#,
            ),
            "every key" => crate::schema::complete(),
            _ => panic!("{base}"),
        };
        told(&edited(base, changes), &within)
    });
}

/// A bumpy grid as an OBJ text, with `extra` triangles without area between every two of its own.
fn grid(extra: &[&str]) -> String {
    const N: usize = 8;
    let place = |i: usize| i as f64 / 4.0 - 1.0;
    let vertex = |i: usize| {
        let (x, y) = (place(i % (N + 1)), place(i / (N + 1)));
        format!("v {x} {y} {}\n", ((i * 7) % 5) as f64 / 16.0)
    };
    let mut text: String = (0..(N + 1) * (N + 1)).map(vertex).collect();
    for (x, y) in (0..N).flat_map(|y| (0..N).map(move |x| (x, y))) {
        let a = y * (N + 1) + x + 1;
        let (b, c, d) = (a + 1, a + N + 2, a + N + 1);
        text += &format!("f {a} {b} {c}\n");
        extra.iter().for_each(|face| text += &format!("f {face}\n"));
        text += &format!("f {a} {c} {d}\n");
    }
    text
}

#[test]
fn hc18_triangles_without_area_are_counted_and_leave_no_trace_in_the_image() {
    let folder = folder();
    let of = |text: &str| {
        put(folder.path(), "m.obj", text);
        render(&mesh_scene("m.obj"), folder.path()).expect("a scene")
    };
    let (clean, none, warnings) = of(&grid(&[]));
    assert_eq!((none, warnings), (0, vec![]));
    // The last two corners alike, all three alike, the first and the last alike.
    let (mixed, dropped, warnings) = of(&grid(&["1 2 2", "5 5 5", "40 12 40"]));
    assert_eq!(dropped, 3 * 64);
    assert_eq!(warnings, ["note: s.json: 192 triangles have no area and are left out"]);
    assert!(mixed.same_bits(&clean));
    let covered = clean.pixels().iter().filter(|p| p.map(f64::from) != BACKGROUND).count();
    assert!(covered > 50, "the mesh is to be seen: {covered}");
}
