//! Reading a mesh of a million triangles from the disk, as it is and as a scene prepared up to its
//! tree: time per byte of the file.
//!
//! Run with `cargo bench --bench loading`.

use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

use divan::Bencher;
use divan::counter::BytesCount;
use tempfile::TempDir;

use wavecrest_base::error::{Error, Result};
use wavecrest_scene::generate::{Model, Recipe, mesh, write_ply};
use wavecrest_scene::load::{LoadOptions, load as load_scene};
use wavecrest_scene::mesh::{MeshData, load};
use wavecrest_scene::systems::extract;

const TRIANGLES: u64 = 1_000_000;

fn main() {
    divan::main();
}

fn recipe(normals: bool) -> Recipe {
    Recipe { normals, ..Recipe::new(Model::Sphere, TRIANGLES) }
}

/// A mesh as the text of an OBJ file, which counts from 1.
fn obj(mesh: &MeshData) -> String {
    let mut text = String::new();
    for p in &mesh.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| v + 1)) {
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

/// A mesh as the text of a PLY file.
fn ply_text(mesh: &MeshData) -> String {
    let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\n\
         end_header\n"
    );
    for p in &mesh.positions {
        let _ = writeln!(text, "{} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}

/// Writes the file of this kind to `folder`.
fn write(folder: &Path, kind: &str) -> Result<PathBuf> {
    let put = |name: &str, text: String| -> Result<PathBuf> {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| Error::io("cannot write the file", &path, e))?;
        Ok(path)
    };
    match kind {
        "obj" => put("mesh.obj", obj(&mesh(&recipe(false))?)),
        "ply, text" => put("mesh.ply", ply_text(&mesh(&recipe(false))?)),
        _ => {
            let path = folder.join("mesh.ply");
            write_ply(&recipe(kind == "ply with normals"), &path, &mut |_, _| {})?;
            Ok(path)
        }
    }
}

fn folder() -> Result<TempDir> {
    let failed = |e: io::Error| Error::io("cannot make a folder in", std::env::temp_dir(), e);
    tempfile::tempdir().map_err(failed)
}

/// Writes the file of this kind and times `work` on it; `work` returns the number of triangles
/// read.
fn time(bencher: Bencher<'_, '_>, kind: &str, work: impl Fn(&Path) -> Result<usize>) -> Result<()> {
    let folder = folder()?;
    let path = write(folder.path(), kind)?;
    let triangles = work(&path)? as u64;
    assert!(triangles >= TRIANGLES, "{kind}: {triangles} triangles were read");
    let bytes = std::fs::metadata(&path).map_or(0, |data| data.len());
    bencher.counter(BytesCount::new(bytes)).bench_local(|| work(&path));
    Ok(())
}

#[divan::bench(args = ["ply", "ply with normals", "ply, text", "obj"],
               sample_count = 20, sample_size = 1)]
fn read(bencher: Bencher<'_, '_>, kind: &str) {
    let timed = time(bencher, kind, |path| Ok(load(path)?.mesh.triangles.len()));
    assert!(timed.is_ok(), "{kind}: {timed:?}");
}

#[divan::bench(args = ["ply", "ply with normals", "ply, text", "obj"],
               sample_count = 20, sample_size = 1)]
fn read_and_prepare(bencher: Bencher<'_, '_>, kind: &str) {
    let prepared =
        |path: &Path| extract(load_scene(path, &LoadOptions::default())?.world, Default::default());
    let timed = time(bencher, kind, |path| Ok(prepared(path)?.geometry().triangles.len()));
    assert!(timed.is_ok(), "{kind}: {timed:?}");
}
