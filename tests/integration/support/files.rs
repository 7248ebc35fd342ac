//! Files in folders of tests, and the command run there.

use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::{Value, json};
use tempfile::TempDir;
use wavecrest_core::film::Film;
use wavecrest_image::read::read;
use wavecrest_image::write::{Transfer, write};

use super::{begin, places};

/// A folder that is removed when the test ends.
pub(crate) fn folder() -> TempDir {
    begin();
    tempfile::tempdir().expect("a folder")
}

/// The command, to be run in `folder`.
pub(crate) fn wavecrest(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecrest"));
    command.current_dir(folder);
    command
}

/// Runs the command in `folder`.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Output {
    wavecrest(folder).args(arguments).output().expect("the command runs")
}

pub(crate) fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// Runs the command, which must succeed; returns what it says on standard error.
#[track_caller]
pub(crate) fn run_well(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let told = text(&output.stderr).to_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {told}");
    told
}

/// Runs the command, which must print JSON.
#[track_caller]
pub(crate) fn run_json(folder: &Path, arguments: &[&str]) -> Value {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Writes a file in `folder`.
pub(crate) fn put(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    std::fs::write(folder.join(name), content).expect("a file");
}

/// The bytes of a file in `folder`.
#[track_caller]
pub(crate) fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The JSON of a file in `folder`.
#[track_caller]
pub(crate) fn json_in(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&bytes(folder, name)).expect("JSON")
}

/// The image in a file in `folder`.
#[track_caller]
pub(crate) fn film(folder: &Path, name: &str) -> Film {
    read(&folder.join(name)).unwrap_or_else(|error| panic!("{error}"))
}

/// Writes an image in `folder`.
pub(crate) fn put_image(
    folder: &Path,
    name: &str,
    [width, height]: [u32; 2],
    texel: impl Fn(u32, u32) -> [f32; 3],
) {
    let texels = places(width, height).map(|(x, y)| texel(x, y)).collect();
    let film = Film::from_pixels(width, height, texels).expect("a film");
    write(&film, &folder.join(name), Transfer::Linear).expect("a file");
}

/// Writes `t.png`: red, green, blue and yellow texels.
pub(crate) fn put_texture(folder: &Path) {
    let texels = [[0.9, 0.1, 0.1], [0.1, 0.9, 0.1], [0.1, 0.1, 0.9], [0.9, 0.9, 0.1]];
    put_image(folder, "t.png", [2, 2], |x, y| texels[(2 * y + x) as usize]);
}

/// Whether the images of slow tests are to be written rather than compared.
pub(crate) fn blessing() -> bool {
    static BLESSING: OnceLock<bool> = OnceLock::new();
    *BLESSING.get_or_init(|| std::env::var_os("WAVECREST_BLESS").is_some_and(|value| value == "1"))
}

/// Writes a square with texture coordinates for glTF (`m.bin`), and as `m.obj` with a material whose mask is
/// `images[0]`. Returns a glTF file of the square with these images, a texture each, and no material.
pub(crate) fn textured_square(folder: &Path, images: &[&str]) -> Value {
    let at = |name: &str| folder.join(name);
    let obj = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
               usemtl leaf\nf 1/1 2/2 3/3 4/4\n";
    std::fs::write(at("m.obj"), obj).expect("a file");
    let mtl = format!("newmtl leaf\nKd 1 1 1\nmap_d {}\n", images[0]);
    std::fs::write(at("m.mtl"), mtl).expect("a file");
    let floats = |all: &[f32]| all.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let positions = floats(&[-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0]);
    let uvs = floats(&[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    std::fs::write(at("m.bin"), [&positions[..], &uvs, &[0, 1, 2, 0, 2, 3]].concat())
        .expect("a file");
    let textures: Vec<Value> = (0..images.len()).map(|source| json!({"source": source})).collect();
    let images: Vec<Value> = images.iter().map(|uri| json!({"uri": uri})).collect();
    json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
                                    "indices": 2, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 6}
        ],
        "buffers": [{"byteLength": 86, "uri": "m.bin"}],
        "images": images, "textures": textures,
    })
}
