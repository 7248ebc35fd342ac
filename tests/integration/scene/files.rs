//! Files: what is no JSON, what is not there, and what paths start from.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;
use tempfile::TempDir;

use super::{complete, set};
use crate::approved;
use wavecrest_base::error::ErrorKind;
use wavecrest_scene::load::{LoadOptions, load, load_str};

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
fn text_that_is_no_scene() {
    approved::compare("tests/integration/scene/texts.txt", |text| {
        let loaded = load_str(text, Path::new("s.json"), &LoadOptions::default());
        loaded.err().unwrap().to_string()
    });
    let empty = "the file is empty; write a scene in it, as SCENES.md describes, or render a .gltf, .glb, .ply, .obj or .stl file";
    for (bytes, kind, message) in [
        (&b""[..], ErrorKind::Syntax, empty),
        ("[".repeat(100_000).as_bytes(), ErrorKind::Syntax, "nested too deeply"),
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
fn files_of_another_machine_are_found_beside_the_scene() {
    let (folder, path) = in_folder("s.json", b"");
    let here = |name: &str| folder.path().join(name);
    fs::create_dir(here("images")).unwrap();
    for name in ["out.jpg", "bunny.ply", "images/wood.png"] {
        fs::write(here(name), include_bytes!("triangle.ply")).unwrap();
    }
    let scene = set(complete(), "scene.shapes[0].texture", json!("C:/Users/me/out.jpg"));
    let scene = set(scene, "scene.shapes[1].texture", json!("images\\wood.png"));
    let scene = set(scene, "scene.shapes[5].file", json!("/home/me/none/bunny.ply"));
    let loaded = load_str(&scene.to_string(), &path, &LoadOptions::default()).unwrap();
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
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let missing = set(complete(), "scene.shapes[0].texture", json!("C:/Users/me/none.jpg"));
    let error = load_str(&missing.to_string(), &path, &strict);
    let error = error.err().unwrap().to_string();
    assert!(error.contains("C:/Users/me/none.jpg"), "{error}");
}
