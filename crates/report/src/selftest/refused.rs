//! Invalid lengths and meshes: each is refused with an error that names it, and none causes a panic.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use glam::DVec3;
use serde_json::{Value, json};

use super::case::{Effort, Outcome};
use super::numbers::Numbers;
use super::parts::{Picture, Refusal};
use super::scenes::{self, Eye};
use wavecrest_base::error::{ErrorKind, Result};
use wavecrest_core::accel::build::Preset;

/// A camera that looks at the origin.
fn eye() -> Eye {
    Eye::at(DVec3::Z * 5.0, 40.0, [8, 8])
}

/// The scene with an invalid length in place of "PUT HERE": 0, negative, missing, not finite, or not a
/// number.
fn with_no_length(numbers: &mut Numbers, scene: &Value, path: &str, may_be_zero: bool) -> Refusal {
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
    Refusal { text, kind, named: named.to_owned() }
}

/// Case 17.
pub(super) fn radii(numbers: &mut Numbers) -> Refusal {
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
        return Refusal::at(&scene, &path);
    }
    with_no_length(numbers, &scene, &format!("{path}.radius"), false)
}

/// Case 29: invalid lenses.
pub(super) fn lenses(numbers: &mut Numbers) -> Refusal {
    let (key, may_be_zero) = numbers.among([("focal", false), ("aperture", true)]);
    let mut scene = scenes::scene(&eye(), &[], &[]);
    let camera = &mut scene["camera"];
    camera["type"] = json!("thinlens");
    camera["focal"] = json!(5);
    camera["aperture"] = json!(0.1);
    camera[key] = json!("PUT HERE");
    with_no_length(numbers, &scene, &format!("camera.{key}"), may_be_zero)
}

/// Case 25.
pub(super) fn meshes(effort: &Effort) -> Outcome {
    let folder = match tempfile::tempdir() {
        Ok(folder) => folder,
        Err(error) => return Outcome::of(false, || format!("no folder for meshes: {error}")),
    };
    let mut outcome = Outcome::default();
    for n in 0..effort.either(100, 1000) {
        for (place, format) in (0..).zip([Format::Obj, Format::Ply, Format::BinaryPly]) {
            let extension = if format == Format::Obj { "obj" } else { "ply" };
            let path = folder.path().join(format!("m.{extension}"));
            let mut numbers = Numbers::new(effort, [25, place], n);
            let faulty = Faulty::new(&mut numbers);
            let bytes = faulty.bytes(format);
            outcome.add(one_mesh(effort, &path, &bytes, Some(&faulty.place(format))));
            // The same file with some bits flipped: it may be anything.
            let turned = turn_bits(&mut numbers, bytes);
            outcome.add(one_mesh(effort, &path, &turned, None));
            let wild = Faulty::wild(&mut numbers).bytes(format);
            outcome.add(one_mesh(effort, &path, &wild, None));
        }
    }
    outcome
}

/// Loads the file as the mesh of a scene, and renders it if possible. A refusal must name the file
/// and `fault`, if any.
fn one_mesh(effort: &Effort, path: &Path, bytes: &[u8], fault: Option<&str>) -> Outcome {
    // A panic is the failure to detect: it is reported, and the test continues.
    let loaded = std::fs::write(path, bytes)
        .map(|()| catch_unwind(AssertUnwindSafe(|| load_and_render(effort, path))));
    let outcome = match loaded {
        Err(error) => Outcome::of(false, || format!("it cannot be written: {error}")),
        Ok(Err(_)) => Outcome::of(false, || "a panic".to_owned()),
        Ok(Ok(Err(error))) => {
            let (text, file) = (error.to_string(), path.display().to_string());
            // The whole number, not the start of another.
            let names =
                |fault: &str| [":", " ("].iter().any(|end| text.contains(&format!("{fault}{end}")));
            let is_right = fault.is_none_or(names) && text.contains(&file);
            Outcome::of(is_right, || format!("{text} does not name {fault:?}"))
        }
        Ok(Ok(Ok(rendered))) => {
            let mut outcome = Outcome::of(fault.is_none(), || format!("{fault:?} passes"));
            outcome.add(rendered);
            outcome
        }
    };
    outcome.with_context(|| String::from_utf8_lossy(bytes).escape_debug().take(400).collect())
}

fn load_and_render(effort: &Effort, path: &Path) -> Result<Outcome> {
    let shape = json!({"type": "trimesh", "file": path.display().to_string(),
                       "material": scenes::white()});
    let light = scenes::point_light(10.0, DVec3::new(1.0, 2.0, 4.0), "linear");
    let picture = Picture::new(scenes::scene(&eye(), &[light], &[shape]), |_, _, _| None);
    let prepared = scenes::prepare(effort, &picture.scene, Preset::VeryFast)?;
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

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Obj,
    Ply,
    BinaryPly,
}

/// The fault of a mesh.
#[derive(Clone, Copy)]
enum Fault {
    Vertex(usize),
    Triangle(usize),
}

/// A faulty mesh.
struct Faulty {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    fault: Option<Fault>,
}

impl Faulty {
    /// With one fault: a vertex that is not finite, or an index out of range.
    fn new(numbers: &mut Numbers) -> Self {
        let vertices = 3 + numbers.below(30);
        let mut coordinate = || numbers.about(1.0) as f32;
        let mut positions: Vec<[f32; 3]> =
            (0..vertices).map(|_| [(); 3].map(|()| coordinate())).collect();
        let mut corner = || numbers.below(vertices) as u32;
        let mut triangles: Vec<[u32; 3]> =
            (0..=vertices).map(|_| [(); 3].map(|()| corner())).collect();
        let which = numbers.below(3);
        let fault = if numbers.once_in(2) {
            let at = numbers.below(vertices);
            let wrong = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e13, f32::MIN];
            positions[at][which] = numbers.among(wrong);
            Fault::Vertex(at)
        } else {
            let at = numbers.below(triangles.len());
            triangles[at][which] = vertices as u32 - 1 + numbers.magnitude(1.0, 1e9) as u32;
            Fault::Triangle(at)
        };
        Self { positions, triangles, fault: Some(fault) }
    }

    /// Mostly random bits.
    fn wild(numbers: &mut Numbers) -> Self {
        let vertices = 3 + numbers.below(8);
        // Otherwise hardly any would be a mesh.
        let is_tame = numbers.once_in(2);
        let mut coordinate = || {
            let value = f32::from_bits(numbers.bits());
            if value.abs() < 1e12 || !is_tame { value } else { 0.25 }
        };
        let positions = (0..vertices).map(|_| [(); 3].map(|()| coordinate())).collect();
        let mut corner = || {
            if numbers.once_in(200) { numbers.bits() } else { numbers.below(vertices) as u32 }
        };
        let triangles = (0..2 * vertices).map(|_| [(); 3].map(|()| corner())).collect();
        Self { positions, triangles, fault: None }
    }

    /// The place that an error must name.
    fn place(&self, format: Format) -> String {
        let is_obj = format == Format::Obj;
        match self.fault {
            None => String::new(),
            Some(Fault::Vertex(vertex)) if is_obj => format!("line {}", 1 + vertex),
            Some(Fault::Triangle(triangle)) if is_obj => {
                format!("line {}", 1 + self.positions.len() + triangle)
            }
            Some(Fault::Vertex(vertex)) => format!("vertex {vertex}"),
            Some(Fault::Triangle(triangle)) => format!("face {triangle}"),
        }
    }

    /// The file.
    fn bytes(&self, format: Format) -> Vec<u8> {
        let name = match format {
            Format::Obj => return self.lines("v ", "f ", 1),
            Format::Ply => "ascii",
            Format::BinaryPly => "binary_little_endian",
        };
        let (vertices, faces) = (self.positions.len(), self.triangles.len());
        let mut bytes = format!(
            "ply\nformat {name} 1.0\nelement vertex {vertices}\nproperty float x\n\
             property float y\nproperty float z\nelement face {faces}\n\
             property list uchar uint vertex_indices\nend_header\n"
        )
        .into_bytes();
        if format == Format::Ply {
            bytes.extend(self.lines("", "3 ", 0));
            return bytes;
        }
        bytes.extend(self.positions.iter().flatten().flat_map(|x| x.to_le_bytes()));
        for corners in &self.triangles {
            bytes.push(3);
            bytes.extend(corners.iter().flat_map(|v| v.to_le_bytes()));
        }
        bytes
    }

    /// A line for each vertex and each triangle, with corners counted from `first`.
    fn lines(&self, vertex: &str, face: &str, first: u64) -> Vec<u8> {
        let vertices = self.positions.iter().map(|[x, y, z]| format!("{vertex}{x} {y} {z}\n"));
        let faces = self.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|v| u64::from(v) + first);
            format!("{face}{a} {b} {c}\n")
        });
        vertices.chain(faces).collect::<String>().into_bytes()
    }
}
