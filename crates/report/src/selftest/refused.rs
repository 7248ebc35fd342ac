//! Invalid lengths and meshes: each is refused with an error that names it, and none causes a
//! panic.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use super::prelude::*;
use wavecrest_scene::mesh::MeshData;
use wavecrest_scene::write::write_ply;

/// A camera that looks at the origin.
fn eye() -> Eye {
    Eye::at(DVec3::Z * 5.0, 40.0, [8, 8])
}

/// The scene with an invalid length in place of "PUT HERE": 0, negative, missing, not finite, or
/// not a number.
fn with_no_length(numbers: &mut Numbers, scene: &Value, path: &str, may_be_zero: bool) -> Outcome {
    let negative = (-numbers.magnitude(1e-30, 1e12)).to_string();
    let values = ["0.0", "-0.0", "-1", "-1e-30", "null", "\"one\"", "1e13", &negative];
    // JSON has no such numbers.
    let no_values = ["NaN", "Infinity", "-Infinity", "1e999"];
    let first = if may_be_zero { 2 } else { 0 };
    let which = first + numbers.below(values.len() + no_values.len() - first);
    let (value, kind, named) = match values.get(which) {
        Some(value) => (value, ErrorKind::Scene, path),
        None => (&no_values[which - values.len()], ErrorKind::Syntax, "line 1 column"),
    };
    let text = scene.to_string().replace("\"PUT HERE\"", value);
    scenes::refused(&text, kind, named)
}

/// Case 17.
pub(super) fn radii(numbers: &mut Numbers) -> Outcome {
    let wrong = numbers.below(3);
    let mut shapes = [(); 3].map(|()| scenes::sphere(DVec3::ZERO, 1.0, scenes::white()));
    // Too small or too large after transform and rounding.
    let is_scaled = numbers.once_in(4);
    if is_scaled {
        shapes[wrong]["transform"] = json!({"scale": numbers.among([1e-60, 1e60])});
    } else {
        shapes[wrong]["radius"] = json!("PUT HERE");
    }
    let scene = scenes::scene(&eye(), &[], &shapes);
    let path = format!("scene.shapes[{wrong}]");
    if is_scaled {
        return scenes::refused_at(&scene, &path);
    }
    with_no_length(numbers, &scene, &format!("{path}.radius"), false)
}

/// Case 29: invalid lenses.
pub(super) fn lenses(numbers: &mut Numbers) -> Outcome {
    let (key, may_be_zero) = numbers.among([("focal", false), ("aperture", true)]);
    let lens = json!({"camera": {"type": "thinlens", "focal": 5, "aperture": 0.1}});
    let mut scene = scenes::with(scenes::scene(&eye(), &[], &[]), lens);
    scene["camera"][key] = json!("PUT HERE");
    with_no_length(numbers, &scene, &format!("camera.{key}"), may_be_zero)
}

/// Case 25: meshes with one fault, the same with some bits flipped, which may be anything, and
/// meshes with random values.
pub(super) fn meshes(numbers: &mut Numbers) -> Outcome {
    let folder = match tempfile::tempdir() {
        Ok(folder) => folder,
        Err(error) => return Outcome::of(false, || format!("no folder for meshes: {error}")),
    };
    let mut outcome = Outcome::default();
    for extension in ["obj", "ply"] {
        let path = folder.path().join(format!("m.{extension}"));
        let [mut mesh, mut wild] = [(); 2].map(|()| any_mesh(numbers));
        let fault = spoil(&mut mesh, numbers, extension);
        scatter(&mut wild, numbers);
        let bytes = bytes_of(&mesh, extension);
        let turned = turn_bits(numbers, bytes.clone());
        let files =
            [(bytes, Some(fault.as_str())), (turned, None), (bytes_of(&wild, extension), None)];
        let all = files.map(|(bytes, fault)| one_mesh(&numbers.effort, &path, &bytes, fault));
        outcome.add(all.into_iter().sum());
    }
    outcome
}

/// Loads the file as the mesh of a scene, and renders it if possible. A refusal must name the file
/// and `fault`, if any.
fn one_mesh(effort: &Effort, path: &Path, bytes: &[u8], fault: Option<&str>) -> Outcome {
    // A panic is the failure to detect: it is reported, and the test continues.
    let outcome = match catch_unwind(AssertUnwindSafe(|| load_and_render(effort, path, bytes))) {
        Err(_) => Outcome::of(false, || "a panic".to_owned()),
        Ok(Err(error)) => {
            let (text, file) = (error.to_string(), path.display().to_string());
            // The whole number, not the start of another.
            let names =
                |fault: &str| [":", " ("].iter().any(|end| text.contains(&format!("{fault}{end}")));
            let is_right = fault.is_none_or(names) && text.contains(&file);
            Outcome::of(is_right, || format!("{text} does not name {fault:?}"))
        }
        Ok(Ok(rendered)) => {
            let passed = Outcome::of(fault.is_none(), || format!("{fault:?} passes"));
            [passed, rendered].into_iter().sum()
        }
    };
    outcome.with_context(|| String::from_utf8_lossy(bytes).escape_debug().take(400).collect())
}

fn load_and_render(effort: &Effort, path: &Path, bytes: &[u8]) -> Result<Outcome> {
    std::fs::write(path, bytes).map_err(|error| Error::io("cannot write the mesh", path, error))?;
    let shape = json!({"type": "trimesh", "file": path.display().to_string(),
                       "material": scenes::white()});
    let light = scenes::point_light(10.0, DVec3::new(1.0, 2.0, 4.0), "linear");
    let picture = Picture::new(scenes::scene(&eye(), &[light], &[shape]), |_, _, _| None);
    let prepared = scenes::prepare(effort, &picture.scene)?;
    let judge = |rendered: &_| scenes::judged(rendered, &picture, None);
    Ok(scenes::every_way_to_render(effort, prepared.scene, &judge))
}

fn turn_bits(numbers: &mut Numbers, mut bytes: Vec<u8>) -> Vec<u8> {
    for _ in 0..=numbers.below(8) {
        let at = numbers.below(bytes.len());
        bytes[at] ^= 1 << numbers.below(8);
    }
    if numbers.once_in(4) {
        bytes.truncate(numbers.below(bytes.len()));
    }
    bytes
}

/// Any triangles over a few vertices.
fn any_mesh(numbers: &mut Numbers) -> MeshData {
    let vertices = 3 + numbers.below(30);
    let mut position = || Vec3::from([(); 3].map(|()| numbers.about(1.0) as f32));
    let positions = (0..vertices).map(|_| position()).collect();
    let mut triangle = || [(); 3].map(|()| numbers.below(vertices) as u32);
    let triangles = (0..=vertices).map(|_| triangle()).collect();
    MeshData { positions, triangles, ..MeshData::default() }
}

/// Adds a fault, a vertex that is not finite or an index out of range, and returns the place
/// that an error must name.
fn spoil(mesh: &mut MeshData, numbers: &mut Numbers, extension: &str) -> String {
    let MeshData { positions, triangles, .. } = mesh;
    let (vertices, which) = (positions.len(), numbers.below(3));
    let (name, at, line) = if numbers.once_in(2) {
        let at = numbers.below(vertices);
        let wrong = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e13, f32::MIN];
        positions[at][which] = numbers.among(wrong);
        ("vertex", at, 1 + at)
    } else {
        let at = numbers.below(triangles.len());
        let beyond = numbers.magnitude(1.0, 1e9) as u32;
        triangles[at][which] = vertices as u32 - 1 + beyond;
        ("face", at, 1 + vertices + at)
    };
    if extension == "obj" { format!("line {line}") } else { format!("{name} {at}") }
}

/// Replaces values by random bits: half of the time none that would be refused.
fn scatter(mesh: &mut MeshData, numbers: &mut Numbers) {
    let is_tame = numbers.once_in(2);
    for value in mesh.positions.iter_mut().flat_map(|position| position.as_mut()) {
        let bits = f32::from_bits(numbers.bits());
        *value = if bits.abs() < 1e12 || !is_tame { bits } else { *value };
    }
    let corners = mesh.triangles.iter_mut().flatten();
    corners.filter(|_| numbers.once_in(200)).for_each(|corner| *corner = !*corner);
}

/// The file: OBJ, or binary PLY.
fn bytes_of(mesh: &MeshData, extension: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    if extension == "ply" {
        // Memory refuses nothing.
        let _ = write_ply(mesh, &mut bytes);
        return bytes;
    }
    for Vec3 { x, y, z } in &mesh.positions {
        bytes.extend(format!("v {x} {y} {z}\n").into_bytes());
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| u64::from(v) + 1);
        bytes.extend(format!("f {a} {b} {c}\n").into_bytes());
    }
    bytes
}
