//! Files: what is no JSON, what is not there, and what paths start from.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;
use tempfile::TempDir;

use super::{complete, one_triangle, set};
use crate::components::{Mesh, TextureRef, TextureSource};
use crate::load::{LoadOptions, LoadedScene, load, load_with};
use crate::mesh::LoadedMesh;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};

/// How the file at `path` is refused: the kind, and the text without the path before it.
fn refused(path: &Path) -> (ErrorKind, String) {
    let error = load(path, &LoadOptions::default()).err().unwrap();
    let text = error.to_string();
    (error.kind(), text.strip_prefix(&format!("{}: ", path.display())).unwrap().to_owned())
}

fn in_folder(name: &str, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn text_that_is_no_scene_and_a_byte_order_mark_that_is_skipped() {
    let deep = "[".repeat(100_000);
    for (bytes, kind, message) in [
        (
            &b"{\n  \"nbounces\": ,\n}"[..],
            ErrorKind::Syntax,
            "line 2 column 15: a value is missing or malformed; \
             write a number, a text in double quotes, true, false, a list or an object",
        ),
        (
            b"",
            ErrorKind::Syntax,
            "the file is empty; write a scene in it, as SCENES.md describes, or render a .gltf, .glb, .ply, .obj or .stl file",
        ),
        (
            b"{\"nbounces\": 1e999}",
            ErrorKind::Syntax,
            "line 1 column 18: the number is too large; use one below 1e308",
        ),
        (b"{\"nbounces\": NaN}", ErrorKind::Syntax, "a value is missing or malformed"),
        (b"{} {}", ErrorKind::Syntax, "more after the end of the scene"),
        (deep.as_bytes(), ErrorKind::Syntax, "nested too deeply"),
        (
            b"{\"a\": \"\xff\"}",
            ErrorKind::Syntax,
            "the scene is not text from byte 7 on; save it as UTF-8, or check that it is a scene",
        ),
        ("\u{feff}[]".as_bytes(), ErrorKind::Scene, "must be a scene, an object { ... }, found []"),
    ] {
        let (_folder, path) = in_folder("s.json", bytes);
        let (found, text) = refused(&path);
        assert!(found == kind && text.contains(message), "{text} and not {message}");
    }
}

#[test]
fn a_scene_that_is_not_there() {
    let (kind, text) = refused(Path::new("no/such.json"));
    assert!(kind == ErrorKind::Io && text.starts_with("cannot read the scene: "), "{text}");
    assert!(load(Path::new("src"), &LoadOptions::default()).is_err());
}

#[test]
#[cfg(unix)]
fn a_scene_file_that_is_too_long_is_not_read() {
    let (_folder, path) = in_folder("s.json", b"{}");
    // Sparse: it takes no room on the disk.
    let file = fs::OpenOptions::new().write(true).open(&path).unwrap();
    file.set_len((1 << 28) + 1).unwrap();
    let message = "the scene file is too large: 268435457 bytes or more; \
                   keep it below 256 MiB, and large meshes in files of their own";
    assert_eq!(refused(&path), (ErrorKind::Limit, message.to_owned()));
}

#[test]
fn paths_start_from_the_scene_files_folder() {
    let (folder, path) = in_folder("s.json", b"");
    fs::write(folder.path().join("wood.png"), b"").unwrap();
    let scene = set(complete(), "scene.shapes[0].texture", json!("wood.png"));
    let mesh = folder.path().join("bunny.ply");
    fs::write(&mesh, b"").unwrap();
    let scene = set(scene, "scene.shapes[5].file", json!("bunny.ply"));
    let scene = load_with(&scene.to_string(), &path, &LoadOptions::default(), |file| {
        assert_eq!(file, mesh);
        one_triangle(file)
    });
    let world = scene.unwrap().world;
    let textures: Vec<TextureSource> =
        world.query::<&TextureRef>().iter().map(|texture| texture.look_up.source.clone()).collect();
    assert_eq!(textures, [TextureSource::File(folder.path().join("wood.png"))]);
    let found = world.query::<&Mesh>().iter().filter_map(|mesh| mesh.file.clone()).next();
    assert_eq!(found, Some(mesh.clone()));
}

#[test]
fn files_of_another_machine_are_found_beside_the_scene() {
    let (folder, path) = in_folder("s.json", b"");
    let here = |name: &str| folder.path().join(name);
    fs::create_dir(here("images")).unwrap();
    for name in ["out.jpg", "bunny.ply", "images/wood.png"] {
        fs::write(here(name), b"").unwrap();
    }
    let scene = set(complete(), "scene.shapes[0].texture", json!("C:/Users/me/out.jpg"));
    let scene = set(scene, "scene.shapes[1].texture", json!("images\\wood.png"));
    let scene = set(scene, "scene.shapes[5].file", json!("/home/me/none/bunny.ply"));
    let loaded =
        load_with(&scene.to_string(), &path, &LoadOptions::default(), one_triangle).unwrap();
    let warnings: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
    let told = |place: &str, value: &str, name: &str| {
        let [scene, used] = [&path, &here(name)].map(|path| path.display().to_string());
        format!(
            "{scene}: scene.{place}: there is no such file here, found {value:?}; {used} is used"
        )
    };
    assert_eq!(
        warnings,
        [
            told("shapes[0].texture", "C:/Users/me/out.jpg", "out.jpg"),
            told("shapes[1].texture", "images\\wood.png", "images/wood.png"),
            told("shapes[5].file", "/home/me/none/bunny.ply", "bunny.ply"),
        ]
    );
    let missing = set(complete(), "scene.shapes[0].texture", json!("C:/Users/me/none.jpg"));
    let error = load_with(&missing.to_string(), &path, &LoadOptions::default(), one_triangle);
    let error = error.err().unwrap().to_string();
    assert!(error.contains("C:/Users/me/none.jpg"), "{error}");
}

fn with_reader(reader: impl Fn(&Path) -> Result<LoadedMesh>) -> Result<LoadedScene> {
    let json = complete().to_string();
    load_with(&json, Path::new("s.json"), &LoadOptions::default(), reader)
}

#[test]
fn a_mesh_that_cannot_be_read() {
    let broken = |file: &Path| {
        Err(Error::new(ErrorKind::Mesh, "is not finite").in_file(file).at("vertex 3").value("inf"))
    };
    let error = with_reader(broken).err().unwrap();
    assert_eq!(error.kind(), ErrorKind::Mesh);
    assert_eq!(
        error.to_string(),
        "s.json: scene.shapes[5].file: cannot read the mesh: \
         src/lib.rs: vertex 3: is not finite, found inf"
    );
}

#[test]
fn the_warnings_of_a_mesh_are_passed_on() {
    let odd = |file: &Path| {
        let warning = Warning::from_error(&Error::new(ErrorKind::Mesh, "odd").in_file(file));
        Ok(LoadedMesh { warnings: vec![warning], ..one_triangle(file)? })
    };
    assert_eq!(with_reader(odd).unwrap().warnings[0].to_string(), "src/lib.rs: odd");
}

#[test]
fn a_light_of_a_mesh_without_triangles() {
    let empty = |_: &Path| Ok(LoadedMesh::default());
    let shape = json!({"type": "trimesh", "file": "src/lib.rs"});
    let scene = set(complete(), "scene.lightsources[1].shape", shape).to_string();
    let loaded = load_with(&scene, Path::new("s.json"), &LoadOptions::default(), empty);
    let text = "s.json: scene.lightsources[1].shape: a light must have an area";
    assert_eq!(loaded.err().unwrap().to_string(), text);
}
