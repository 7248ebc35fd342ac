//! Files are read from the folder of the glTF file and below, others where that is allowed.

use std::path::{Path, PathBuf};

use serde_json::json;
use wavecrest_base::error::Result;
use wavecrest_scene::load::{LoadOptions, LoadedScene, load, load_str};
use wavecrest_scene::write::write;

use super::{small, square};
use crate::support::{folder, matte, pinhole, put, put_image, scene, wavecrest};

/// Names that lead from `own/` to a file in the folder above it.
fn names(folder: &Path, file: &str) -> Vec<String> {
    let absolute = folder.join(file).display().to_string();
    let mut names = vec![format!("../{file}"), format!("below/%2E./../{file}"), absolute];
    if cfg!(unix) {
        names.push(format!("link-{file}"));
    }
    names
}

/// A folder with these bytes in a file, and a folder `own` in it, which has a link to that file.
fn with_file(file: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = folder();
    let own = folder.path().join("own");
    std::fs::create_dir_all(own.join("below")).expect("a folder");
    std::fs::write(folder.path().join(file), bytes).expect("a file");
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.path().join(file), own.join(format!("link-{file}")))
        .expect("a link");
    (folder, own)
}

fn read(path: &Path, allow_outside: bool) -> Result<LoadedScene> {
    load(path, &LoadOptions { allow_outside, ..small() })
}

fn refused(read: Result<LoadedScene>, words: &str) {
    let text = read.map(|_| ()).expect_err("it is outside").to_string();
    assert!(text.contains(words) && text.contains("--allow-outside"), "{text}");
}

#[test]
fn buffers_and_images_outside_are_refused_unless_they_are_allowed() {
    let file = square();
    let (folder, own) = with_file("a.bin", &file.bytes);
    let path = own.join("a.gltf");
    for name in names(folder.path(), "a.bin") {
        std::fs::write(&path, file.text(&name)).expect("a file");
        refused(read(&path, false), "buffers[0].uri: is outside the folder of the glTF file");
        assert!(read(&path, true).is_ok(), "{name}");
    }
    std::fs::write(own.join("below/a.bin"), &file.bytes).expect("a file");
    std::fs::write(&path, file.text("below/../below/a.bin")).expect("a file");
    assert!(read(&path, false).is_ok());
    let mut file = file;
    for name in names(folder.path(), "a.bin") {
        file.json["images"] = json!([{"uri": name}]);
        std::fs::write(&path, file.glb()).expect("a file");
        refused(read(&path, false), "images[0].uri: is outside the folder of the glTF file");
        assert!(read(&path, true).is_ok(), "{name}");
    }
}

#[test]
fn pictures_of_materials_outside_are_refused_unless_they_are_allowed() {
    let (folder, own) = with_file("t.png", b"");
    put_image(folder.path(), "t.png", [1, 1], |_, _| [1.0; 3]);
    put(
        &own,
        "m.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n",
    );
    // Names in MTL files are as they stand there.
    for name in names(folder.path(), "t.png").iter().filter(|name| !name.contains('%')) {
        put(&own, "m.mtl", format!("newmtl a\nmap_Kd {name}\n"));
        let told = |allow_outside| {
            let scene = read(&own.join("m.obj"), allow_outside).expect("a scene");
            scene.warnings.iter().map(ToString::to_string).collect::<String>()
        };
        assert!(told(false).contains("is outside the folder of the mesh"), "{}", told(false));
        assert_eq!(told(true), "", "{name}");
    }
}

/// The bytes of no file outside its folder come into what it is converted to.
#[test]
fn a_conversion_copies_nothing_from_outside() {
    let (folder, own) = with_file("secret.png", b"not for others");
    let file = square();
    std::fs::write(folder.path().join("a.bin"), &file.bytes).expect("a file");
    std::fs::write(own.join("a.gltf"), file.text("../a.bin")).expect("a file");
    let run = |more: &[&str]| {
        let mut command = wavecrest(&own);
        command.args(["convert", "a.gltf", "out.json"]).args(more).output().expect("it runs")
    };
    assert_eq!(run(&[]).status.code(), Some(2));
    assert!(!own.join("out-mesh0.ply").exists());
    assert_eq!(run(&["--allow-outside"]).status.code(), Some(0));
    // A scene file may name any image: it is the user's own. What is converted is not.
    let mesh = json!({"type": "trimesh", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "indices": [[0, 1, 2]],
                      "uvs": [[0, 0], [1, 0], [0, 1]], "texture": "../secret.png",
                      "material": matte(1.0, [1.0; 3])});
    let json = scene(0, &pinhole([4, 4], 40.0, 3.0), &[], &[mesh]).to_string();
    for allow_outside in [false, true] {
        let options = LoadOptions { allow_outside, ..LoadOptions::default() };
        let scene = load_str(&json, &own.join("scene.json"), &options).expect("a scene");
        let out = own.join(format!("copy-{allow_outside}.json"));
        let written = write(&scene, &out, false);
        assert_eq!(written.is_ok(), allow_outside, "{written:?}");
        assert_eq!(own.join(format!("copy-{allow_outside}-image0.png")).exists(), allow_outside);
    }
}
