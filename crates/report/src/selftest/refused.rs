//! Invalid scenes and meshes: each is refused with an error that names it, and none causes a panic.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use glam::DVec3;
use serde_json::{Value, json};

use super::case::{Effort, Outcome};
use super::scenes::{self, Eye, Prepared};
use super::ways::{Numbers, inputs};
use wavecrest_base::error::{ErrorKind, Result};
use wavecrest_core::accel::build::Preset;

/// A camera that looks at the origin.
fn eye() -> Eye {
    Eye::at(DVec3::new(0.0, 0.0, 5.0), 40.0, [8, 8])
}

/// Counts whether the scene is refused with an error of this kind that names `named`.
fn count_refusal(
    outcome: &mut Outcome,
    prepared: Result<Prepared>,
    kind: ErrorKind,
    named: &str,
    what: &str,
) {
    let failure = match prepared {
        Ok(_) => Some("it is taken".to_owned()),
        Err(error) if error.kind() != kind => Some(format!("it is of another kind: {error}")),
        Err(error) if !error.to_string().contains(named) => Some(format!("it says {error}")),
        Err(_) => None,
    };
    outcome.count(failure.map(|failure| format!("{what}, which is to name {named}: {failure}")));
}

/// Whether the scene is refused with an error that names `named`.
pub(super) fn names(prepared: Result<Prepared>, named: &str) -> Outcome {
    let mut outcome = Outcome::default();
    count_refusal(&mut outcome, prepared, ErrorKind::Scene, named, "the scene");
    outcome
}

/// An invalid length as text: 0, negative, missing, not finite, or not a number.
fn no_length(numbers: &mut Numbers, is_zero_a_length: bool) -> (String, ErrorKind) {
    let all = ["0.0 -0.0 -1 -1e-30 null \"one\" 1e13", "NaN Infinity -Infinity 1e999"];
    let all: Vec<&str> = all.iter().flat_map(|words| words.split(' ')).collect();
    let first = if is_zero_a_length { 2 } else { 0 };
    match first + numbers.below(all.len() + 1 - first) {
        // A random negative number.
        i if i == all.len() => ((-numbers.magnitude(1e-30, 1e12)).to_string(), ErrorKind::Scene),
        // JSON has no such numbers.
        i => (all[i].to_owned(), if i < 7 { ErrorKind::Scene } else { ErrorKind::Syntax }),
    }
}

/// Replaces the only "PUT HERE" of the scene by `text`. Returns the place as named by a syntax
/// error, or else the path.
fn put<'a>(scene: &Value, text: &str, kind: ErrorKind, path: &'a str) -> (String, &'a str) {
    let named = if kind == ErrorKind::Syntax { "line 1 column" } else { path };
    (scene.to_string().replace("\"PUT HERE\"", text), named)
}

/// Case 17.
pub(super) fn radii(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for mut numbers in inputs(effort, 17, 0..effort.of(100_000)) {
        let wrong = numbers.below(3);
        let (text, kind) = no_length(&mut numbers, false);
        let mut shapes =
            [(); 3].map(|()| scenes::sphere(DVec3::ZERO, 1.0, scenes::matte([1.0; 3])));
        shapes[wrong]["radius"] = json!("PUT HERE");
        let path = format!("scene.shapes[{wrong}].radius");
        // Too small or too large after transform and rounding.
        let is_scaled = numbers.below(4) == 0;
        let (text, kind) = if is_scaled {
            let scale = [1e-60, 1e60][numbers.below(2)];
            shapes[wrong]["transform"] = json!({"scale": scale});
            ("1.0".to_owned(), ErrorKind::Scene)
        } else {
            (text, kind)
        };
        let path = if is_scaled { &path[..path.len() - ".radius".len()] } else { &path };
        let scene = scenes::scene(0, &eye().json(), &[], &shapes);
        let (json, named) = put(&scene, &text, kind, path);
        let prepared = scenes::prepare_text(effort, &json, Path::new("s.json"), Preset::VeryFast);
        count_refusal(&mut outcome, prepared, kind, named, &format!("radius {text}"));
    }
    outcome
}

/// Invalid lenses.
pub(super) fn lenses(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for mut numbers in inputs(effort, 29, 0..effort.of(100_000)) {
        let (key, may_be_zero) = [("focal", false), ("aperture", true)][numbers.below(2)];
        let (text, kind) = no_length(&mut numbers, may_be_zero);
        let mut camera = eye().json();
        camera["type"] = json!("thinlens");
        camera["focal"] = json!(5);
        camera["aperture"] = json!(0.1);
        camera[key] = json!("PUT HERE");
        let scene = scenes::scene(0, &camera, &[], &[]);
        let path = format!("camera.{key}");
        let (json, named) = put(&scene, &text, kind, &path);
        let prepared = scenes::prepare_text(effort, &json, Path::new("s.json"), Preset::VeryFast);
        count_refusal(&mut outcome, prepared, kind, named, &format!("{key} {text}"));
    }
    outcome
}

/// Shapes without area, used as lights. `path` is the place in the error.
fn lights_without_area() -> Vec<(Value, &'static str)> {
    let collinear = json!([[-1, 2, 0], [0, 2, 1], [1, 2, 2]]);
    let path = "scene.lightsources[1].shape";
    vec![
        (json!({"type": "triangle", "points": collinear}), path),
        (json!({"type": "triangle", "points": [[0, 1, 0], [0, 1, 0], [1, 1, 0]]}), path),
        (json!({"type": "plane", "points": [[0, 1, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0]]}), path),
        (json!({"type": "plane", "points": [[0, 1, 0], [0, 1, 0], [1, 1, 1], [1, 1, 0]]}), path),
        (json!({"type": "trimesh", "points": collinear, "indices": [[0, 1, 2], [1, 1, 2]]}), path),
        (json!({"type": "sphere", "center": [0, 3, 0], "radius": 0}), path),
        // An area that vanishes by rounding or scaling.
        (
            json!({"type": "triangle", "points": [[1, 1, 1], [1, 1, 1.000_000_001], [1, 1.000_000_001, 1]]}),
            path,
        ),
    ]
}

/// Case 31, for the lights that are refused.
pub(super) fn lights(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for (shape, path) in lights_without_area() {
        for (sampling, samples) in [("random", 1), ("random", 7), ("jittered", 3)] {
            let what = format!("a light of the shape {shape}");
            let light = json!({"type": "arealight", "intensity": 10, "color": [1, 1, 1],
                               "sampling": sampling, "samples": samples, "shape": shape});
            let first = scenes::point_light(10.0, DVec3::Y, "linear");
            let scene = scenes::scene(0, &eye().json(), &[first, light], &[]);
            let prepared = scenes::prepare(effort, &scene, Preset::VeryFast);
            count_refusal(&mut outcome, prepared, ErrorKind::Scene, path, &what);
        }
    }
    outcome
}

/// Case 25.
pub(super) fn meshes(effort: &Effort) -> Outcome {
    let folder = match tempfile::tempdir() {
        Ok(folder) => folder,
        Err(error) => return Outcome::one(Some(format!("no folder for meshes: {error}"))),
    };
    let mut outcome = Outcome::default();
    for n in 0..effort.either(100, 1000) {
        for (format, extension) in
            [(Format::Text, "obj"), (Format::Text, "ply"), (Format::Binary, "ply")]
        {
            let path = folder.path().join(format!("m.{extension}"));
            let mut numbers = Numbers::new(effort, 25 + 32 * format as u32, n);
            let faulty = Faulty::new(&mut numbers);
            let bytes = faulty.bytes(extension, format);
            let named = faulty.place(extension);
            outcome.add(one_mesh(effort, &path, &bytes, Some(&named)));
            // The same file with some bits flipped: it may be anything.
            let turned = turn_bits(&mut numbers, bytes);
            outcome.add(one_mesh(effort, &path, &turned, None));
            let wild = Faulty::wild(&mut numbers).bytes(extension, format);
            outcome.add(one_mesh(effort, &path, &wild, None));
        }
    }
    outcome
}

/// Loads the file as the mesh of a scene, and renders it if possible. A refusal must name the file
/// and `fault`, if any.
fn one_mesh(effort: &Effort, path: &Path, bytes: &[u8], fault: Option<&str>) -> Outcome {
    if let Err(error) = std::fs::write(path, bytes) {
        return Outcome::one(Some(format!("cannot write {}: {error}", path.display())));
    }
    let mut outcome = Outcome::default();
    let context = || String::from_utf8_lossy(bytes).escape_debug().take(400).collect::<String>();
    // A panic is the failure to detect: it is reported, and the test continues.
    match catch_unwind(AssertUnwindSafe(|| load_and_render(effort, path))) {
        Err(_) => outcome.count(Some(format!("a panic over {}", context()))),
        Ok(Err(error)) => {
            let (text, file) = (error.to_string(), path.display().to_string());
            // The whole number, not the start of another.
            let names =
                |fault: &str| [":", " ("].iter().any(|end| text.contains(&format!("{fault}{end}")));
            let is_named = fault.is_none_or(names) && text.contains(&file);
            outcome.count((!is_named).then(|| format!("{text}, {fault:?}, of {}", context())));
        }
        Ok(Ok(rendered)) => {
            outcome.count(fault.map(|fault| format!("{fault} passes in {}", context())));
            outcome.add(rendered.with_context(context));
        }
    }
    outcome
}

fn load_and_render(effort: &Effort, path: &Path) -> Result<Outcome> {
    let shape = json!({"type": "trimesh", "file": path.display().to_string(),
                       "material": scenes::matte([1.0; 3])});
    let light = scenes::point_light(10.0, DVec3::new(1.0, 2.0, 4.0), "linear");
    let scene = scenes::scene(0, &eye().json(), &[light], &[shape]);
    let prepared = scenes::prepare(effort, &scene, Preset::VeryFast)?;
    Ok(scenes::every_way_to_render(effort, prepared.scene, &|_| Outcome::default()))
}

fn turn_bits(numbers: &mut Numbers, mut bytes: Vec<u8>) -> Vec<u8> {
    for _ in 0..=numbers.below(8) {
        let at = numbers.below(bytes.len());
        bytes[at] ^= 1 << numbers.below(8);
    }
    if numbers.below(4) == 0 {
        bytes.truncate(numbers.below(bytes.len()));
    }
    bytes
}

#[derive(Clone, Copy)]
enum Format {
    Text,
    Binary,
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
        let mut coordinate = || (2.0 * numbers.one() - 1.0) as f32;
        let mut positions: Vec<[f32; 3]> =
            (0..vertices).map(|_| [(); 3].map(|()| coordinate())).collect();
        let mut corner = || numbers.below(vertices) as u32;
        let mut triangles: Vec<[u32; 3]> =
            (0..1 + vertices).map(|_| [(); 3].map(|()| corner())).collect();
        let which = numbers.below(3);
        let fault = if numbers.below(2) == 0 {
            let at = numbers.below(vertices);
            let wrong = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e13, f32::MIN];
            positions[at][which] = wrong[numbers.below(wrong.len())];
            Fault::Vertex(at)
        } else {
            let at = numbers.below(triangles.len());
            let beyond = numbers.magnitude(1.0, 1e9) as u32;
            triangles[at][which] = vertices as u32 - 1 + beyond;
            Fault::Triangle(at)
        };
        Self { positions, triangles, fault: Some(fault) }
    }

    /// Mostly random bits.
    fn wild(numbers: &mut Numbers) -> Self {
        let vertices = 3 + numbers.below(8);
        let bits = |numbers: &mut Numbers| (numbers.one() * 4_294_967_296.0) as u32;
        let tame = numbers.below(2) == 0;
        let positions = (0..vertices).map(|_| {
            [(); 3].map(|()| {
                let value = f32::from_bits(bits(numbers));
                // Otherwise hardly any would be a mesh.
                let is_usual = value.abs() < 1e12;
                if is_usual || !tame { value } else { 0.25 }
            })
        });
        let positions = positions.collect();
        let triangles = (0..2 * vertices).map(|_| {
            [(); 3].map(|()| {
                if numbers.below(200) == 0 { bits(numbers) } else { numbers.below(vertices) as u32 }
            })
        });
        Self { positions, triangles: triangles.collect(), fault: None }
    }

    /// The place that an error must name.
    fn place(&self, extension: &str) -> String {
        match (self.fault, extension) {
            (None, _) => String::new(),
            (Some(Fault::Vertex(vertex)), "ply") => format!("vertex {vertex}"),
            (Some(Fault::Triangle(triangle)), "ply") => format!("face {triangle}"),
            (Some(Fault::Vertex(vertex)), _) => format!("line {}", 1 + vertex),
            (Some(Fault::Triangle(triangle)), _) => {
                format!("line {}", 1 + self.positions.len() + triangle)
            }
        }
    }

    /// The file.
    fn bytes(&self, extension: &str, format: Format) -> Vec<u8> {
        if extension == "ply" {
            return self.ply(format);
        }
        self.lines("v ", "f ", 1)
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

    fn ply(&self, format: Format) -> Vec<u8> {
        let name = match format {
            Format::Text => "ascii",
            Format::Binary => "binary_little_endian",
        };
        let (vertices, faces) = (self.positions.len(), self.triangles.len());
        let mut bytes = format!(
            "ply\nformat {name} 1.0\nelement vertex {vertices}\nproperty float x\n\
             property float y\nproperty float z\nelement face {faces}\n\
             property list uchar uint vertex_indices\nend_header\n"
        )
        .into_bytes();
        match format {
            Format::Text => bytes.extend(self.lines("", "3 ", 0)),
            Format::Binary => {
                bytes.extend(self.positions.iter().flatten().flat_map(|x| x.to_le_bytes()));
                for corners in &self.triangles {
                    bytes.push(3);
                    bytes.extend(corners.iter().flat_map(|v| v.to_le_bytes()));
                }
            }
        }
        bytes
    }
}
