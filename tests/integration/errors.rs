//! What is said of scenes and meshes that are wrong, word for word: where, what was found, and what
//! would be right.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_base::error::{ErrorKind, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems;

use crate::support::{
    BACKGROUND, folder, image_of, matte, pinhole, point_light, refusal, repository, scene, with,
};

/// A scene of one mesh from this file.
fn mesh_scene(file: &str) -> Value {
    with_mesh(json!({"type": "trimesh", "file": file, "material": matte(0.8, [1.0, 0.6, 0.3])}))
}

fn with_mesh(mesh: Value) -> Value {
    let light = point_light(40.0, [1.0, 2.0, 4.0], [1.0; 3]);
    scene(0, &pinhole([24, 18], 50.0, 5.0), &[light], &[mesh])
}

/// What is wrong with a scene in `folder`, which the message then leaves out.
fn told(scene: &Value, folder: &Path) -> (ErrorKind, String) {
    let error = refusal(scene, &folder.join("s.json"));
    let prefix = format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR);
    (error.kind(), error.to_string().replace(&prefix, ""))
}

/// Checks what is said of a mesh file of this content.
#[track_caller]
fn check_mesh(name: &str, content: &str, kind: ErrorKind, message: &str) {
    let folder = folder();
    std::fs::write(folder.path().join(name), content).expect("a file");
    let expected = format!("s.json: scene.shapes[0].file: cannot read the mesh: {name}: {message}");
    assert_eq!(told(&mesh_scene(name), folder.path()), (kind, expected), "{content}");
}

const VERTICES: &str = "0 0 0\n1 0 0\n0 1 0\n";

/// A PLY text with this many vertices and faces in its header, and this body.
fn ply(vertices: u64, faces: u64, body: &str) -> String {
    let coordinates = "property float x\nproperty float y\nproperty float z\n";
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\n{coordinates}element face {faces}\n\
         property list uchar int vertex_indices\nend_header\n{body}"
    )
}

#[test]
fn a_truncated_ply_file_is_an_error_with_its_end() {
    check_mesh(
        "m.ply",
        &ply(3, 1, "0 0 0\n1 0"),
        ErrorKind::Syntax,
        "vertex 1: the file is cut off: its header promises 3 of \"vertex\", and there is room for 1; \
         copy or export it again",
    );
    check_mesh(
        "m.ply",
        &ply(3, 1, &format!("{VERTICES}3 0 1")),
        ErrorKind::Syntax,
        "face 0 (line 13): the file is cut off: a list of 3 takes at least 6 bytes, and 4 are left; \
         copy or export it again, or correct the types in its header",
    );
}

#[test]
fn a_binary_ply_file_that_was_cut_off_is_refused_wherever_it_ends() {
    let folder = folder();
    let text = ply(3, 1, "").replace("ascii", "binary_little_endian");
    let mut whole = text.clone().into_bytes();
    for value in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        whole.extend(value.to_le_bytes());
    }
    whole.push(3);
    [0_i32, 1, 2].iter().for_each(|i| whole.extend(i.to_le_bytes()));
    let write = |bytes: &[u8]| std::fs::write(folder.path().join("m.ply"), bytes).expect("a file");
    write(&whole);
    assert_eq!(dropped(&mesh_scene("m.ply"), folder.path()), 0, "the whole file is right");
    for length in 0..whole.len() {
        write(&whole[..length]);
        let (kind, text) = told(&mesh_scene("m.ply"), folder.path());
        assert_eq!(kind, ErrorKind::Syntax, "{length}: {text}");
    }
}

#[test]
fn a_count_beyond_the_file_size_is_refused_before_memory_is_allocated() {
    check_mesh(
        "m.ply",
        &ply(4_000_000_000, 1, VERTICES),
        ErrorKind::Syntax,
        "vertex 3: the file is cut off: its header promises 4000000000 of \"vertex\", and there is room for 3; \
         copy or export it again",
    );
    check_mesh(
        "m.ply",
        &ply(40_000_000_000, 1, VERTICES),
        ErrorKind::Limit,
        "header line 3: a mesh can have at most 4294967294 rows of the element \"vertex\", \
         found 40000000000; split the mesh into several files",
    );
}

#[test]
fn a_vertex_that_is_not_finite_is_named() {
    let words = "the coordinates of a vertex must be finite and within 2^40";
    let remedy = "correct the vertex, or scale the mesh down";
    for (written, shown) in [("nan", "NaN"), ("inf", "inf"), ("2e12", "2000000000000")] {
        let body = format!("0 0 0\n1 {written} 0\n0 1 0\n3 0 1 2\n");
        check_mesh(
            "m.ply",
            &ply(3, 1, &body),
            ErrorKind::Mesh,
            &format!("vertex 1: {words}, found (1, {shown}, 0); {remedy}"),
        );
        check_mesh(
            "m.obj",
            &format!("v 0 0 0\nv 1 {written} 0\nv 0 1 0\nf 1 2 3\n"),
            ErrorKind::Mesh,
            &format!("line 2: {words}, found (1, {shown}, 0); {remedy}"),
        );
    }
}

#[test]
fn an_index_out_of_range_is_named() {
    let words = "the vertex index is out of range";
    let whole = "check that the file is whole";
    check_mesh(
        "m.ply",
        &ply(3, 1, &format!("{VERTICES}3 0 1 3\n")),
        ErrorKind::Mesh,
        &format!("face 0 (line 13): {words}, found 3; the mesh has 3: {whole}"),
    );
    for (face, message) in [
        ("f 1 2 4", format!("found 4; the mesh has 3: {whole}")),
        ("f -4 1 2", format!("found -4; the mesh has 3: {whole}")),
        ("f 0 1 2", "found 0; count from 1, or backward from -1".to_owned()),
    ] {
        let content = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n");
        check_mesh("m.obj", &content, ErrorKind::Mesh, &format!("line 4: {words}, {message}"));
    }
}

#[test]
fn lines_that_are_no_numbers_and_no_faces_are_shown() {
    check_mesh(
        "m.ply",
        &ply(3, 1, "0 0 0\n1 0 0\n0 1 x\n3 0 1 2\n"),
        ErrorKind::Syntax,
        "vertex 2 (line 12): a number is malformed, found x; write it as 12 or -0.5e3",
    );
    check_mesh(
        "m.obj",
        "v 0 0\nf 1 2 3",
        ErrorKind::Syntax,
        "line 1: \"v\" needs at least 3 numbers, found 2; \
         complete the line; the file may be cut off",
    );
    check_mesh(
        "m.obj",
        "v 0 0 0\nf 1 x 1\n",
        ErrorKind::Syntax,
        "line 2: a corner of a face is malformed, found \"x\"; write it as 1, 1/2, 1//3 or 1/2/3",
    );
    check_mesh(
        "m.obj",
        "v 0 0 0\nf 1 1\n",
        ErrorKind::Mesh,
        "line 2: a face needs at least 3 vertices, found 2; remove the face",
    );
}

#[test]
fn a_file_without_triangles_is_refused() {
    let message = "the mesh has no triangles; \
                   export it with faces";
    check_mesh("m.ply", &ply(3, 0, VERTICES), ErrorKind::Mesh, message);
    check_mesh("m.obj", "v 0 0 0\n", ErrorKind::Mesh, message);
    check_mesh("m.ply", "", ErrorKind::Syntax, "the file is empty; export it again");
}

#[test]
fn a_misspelt_header_gets_a_suggestion() {
    check_mesh(
        "m.ply",
        &ply(3, 1, "").replace("element vertex", "elemnt vertex"),
        ErrorKind::Syntax,
        "header line 3: unknown header line, found elemnt; \
         did you mean element?",
    );
    check_mesh(
        "m.ply",
        "solid\n",
        ErrorKind::Syntax,
        "header line 1: a PLY file begins with the line \"ply\", found \"solid\"; \
         check that this is a PLY file",
    );
}

#[test]
fn other_formats_are_refused_by_their_names() {
    check_mesh(
        "m.fbx",
        "Kaydara",
        ErrorKind::Mesh,
        "this is not a mesh file, found the extension \"fbx\"; \
         use a .ply, .obj or .stl file",
    );
    let (kind, message) = told(&mesh_scene("m.gltf"), folder().path());
    assert_eq!(
        (kind, message.as_str()),
        (
            ErrorKind::Scene,
            "s.json: scene.shapes[0].file: a glTF file cannot be a shape, found \
             \"m.gltf\"; run wavecrest convert IN OUT.json, and use the meshes that it writes"
        )
    );
}

#[test]
fn a_missing_mesh_and_a_folder_have_different_errors() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("dir.ply")).expect("a folder");
    let remedy = "relative paths start at the scene file's folder";
    for (name, there) in [("no.ply", "no file"), ("dir.ply", "a folder, not a file,")] {
        let place = "s.json: scene.shapes[0].file";
        let expected = format!("{place}: there is {there} at {name}, found \"{name}\"; {remedy}");
        assert_eq!(told(&mesh_scene(name), folder.path()), (ErrorKind::Io, expected));
    }
}

const TRIANGLE: &str = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_texture_needs_texture_coordinates() {
    let folder = folder();
    std::fs::write(folder.path().join("m.obj"), TRIANGLE).expect("a file");
    let texture = repository("textures/checker.png");
    std::fs::copy(texture, folder.path().join("t.png")).expect("a copy");
    let mut scene = mesh_scene("m.obj");
    scene["scene"]["shapes"][0]["texture"] = "t.png".into();
    let expected = "s.json: scene.shapes[0].texture: \
                    the mesh has no texture coordinates; \
                    add \"uvs\", or remove the texture";
    assert_eq!(told(&scene, folder.path()), (ErrorKind::Scene, expected.to_owned()));
    let with_uvs = TRIANGLE.replace("f 1 2 3", "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3");
    std::fs::write(folder.path().join("m.obj"), with_uvs).expect("a file");
    assert_eq!(dropped(&scene, folder.path()), 0, "with them it is right");
}

#[test]
fn smooth_shading_without_normals_is_a_warning_and_flat() {
    let folder = folder();
    std::fs::write(folder.path().join("m.obj"), TRIANGLE).expect("a file");
    let mut scene = mesh_scene("m.obj");
    let (flat, _, warnings) = render(&scene, folder.path());
    assert!(warnings.is_empty(), "{warnings:?}");
    scene["scene"]["shapes"][0]["shading"] = "smooth".into();
    let (smooth, _, warnings) = render(&scene, folder.path());
    assert_eq!(
        warnings,
        ["s.json: scene.shapes[0].shading: the mesh has no normals for smooth shading; \
          flat shading is used"]
    );
    assert!(smooth.same_bits(&flat));
}

/// The image, the number of triangles left out, and the warnings of a scene in `folder`.
fn render(scene: &Value, folder: &Path) -> (Film, u64, Vec<String>) {
    let file = folder.join("s.json");
    let loaded = load_str(&scene.to_string(), &file, &LoadOptions::default());
    let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
    let extracted = systems::extract(loaded.world, Default::default());
    let prepared = extracted.unwrap_or_else(|error| panic!("{error}")).build(Preset::Fast);
    let warnings = systems::warnings(&prepared, &file);
    let prefix = format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR);
    let text = |warning: &Warning| warning.to_string().replace(&prefix, "");
    let warnings = loaded.warnings.iter().chain(&warnings).map(text).collect();
    (image_of(&prepared, 0), prepared.dropped.degenerate, warnings)
}

fn dropped(scene: &Value, folder: &Path) -> u64 {
    render(scene, folder).1
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
        std::fs::write(folder.path().join("m.obj"), text).expect("a file");
        render(&mesh_scene("m.obj"), folder.path())
    };
    let (clean, none, warnings) = of(&grid(&[]));
    assert_eq!((none, warnings), (0, vec![]));
    // The last two corners alike, all three alike, the first and the last alike.
    let (mixed, dropped, warnings) = of(&grid(&["1 2 2", "5 5 5", "40 12 40"]));
    assert_eq!(dropped, 3 * 64);
    assert_eq!(warnings, ["s.json: 192 triangles have no area and are left out"]);
    assert!(mixed.same_bits(&clean));
    let covered = clean.pixels().iter().filter(|p| p.map(f64::from) != BACKGROUND).count();
    assert!(covered > 50, "the mesh is to be seen: {covered}");
}

#[test]
fn hc18_collinear_corners_are_without_area_in_scenes_too() {
    let points = json!([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [0, 0, 0]]);
    let mesh = |indices: Value| {
        with_mesh(json!({"type": "trimesh", "points": points, "indices": indices,
                         "material": matte(0.8, [1.0; 3])}))
    };
    let folder = folder();
    let (clean, none, _) = render(&mesh(json!([[0, 1, 2]])), folder.path());
    let collinear = mesh(json!([[0, 3, 2], [0, 1, 2], [2, 0, 3]]));
    let (mixed, dropped, _) = render(&collinear, folder.path());
    assert_eq!((none, dropped), (0, 2));
    assert!(mixed.same_bits(&clean));
}

#[test]
fn limits_are_reported_with_the_requested_and_the_allowed_value() {
    let triangle = json!({"type": "triangle", "points": [[0, 0, 0], [0, 1, 0], [1, 0, 0]],
                          "material": matte(0.8, [1.0; 3])});
    let scene = with_mesh(triangle);
    let camera = |key: &str, value: Value| {
        let mut scene = scene.clone();
        scene["camera"] = with(scene["camera"].clone(), key, value);
        told(&scene, folder().path())
    };
    assert_eq!(
        camera("width", json!(70_000)),
        (
            ErrorKind::Limit,
            "s.json: camera.width: must be an integer from 1 to 65536, found 70000".to_owned()
        )
    );
    let mut large = scene.clone();
    large["camera"]["width"] = 65_536.into();
    large["camera"]["height"] = 65_536.into();
    assert_eq!(
        told(&large, folder().path()),
        (
            ErrorKind::Limit,
            "s.json: camera: the image would have 65536 x 65536 = 4294967296 pixels; \
             at most 268435456 (2^28) are allowed"
                .to_owned()
        )
    );
    assert_eq!(
        camera("fov", json!(180)),
        (
            ErrorKind::Scene,
            "s.json: camera.fov: must be a number from 0.001 to 179, found 180".to_owned()
        )
    );
}

/// As large as a radius in the file may be; the transform makes it larger.
#[test]
fn hc14_a_sphere_that_a_transform_makes_too_large_is_refused() {
    let sphere = |scale: f64| {
        with_mesh(json!({"type": "sphere", "center": [0, 0, 0], "radius": 1e12,
                         "transform": {"scale": scale}, "material": matte(0.8, [1.0; 3])}))
    };
    assert_eq!(
        told(&sphere(1e10), folder().path()),
        (
            ErrorKind::Scene,
            "s.json: scene.shapes[0].transform: the transform makes the sphere too large, \
             found a radius of 1e22; keep it within 1.0995116e12"
                .to_owned()
        )
    );
    render(&sphere(1.0), folder().path());
}
