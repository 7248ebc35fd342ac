//! What must hold for any bytes whatever. Each function takes an input, panics where something does
//! not hold, and says whether the input was accepted. The fuzzers of `fuzz/` and the tests beside
//! this file call the same ones.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::DVec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::{RenderOptions, TracerKind, render};
use wavecrest_scene::components::Material;
use wavecrest_scene::load::{LoadOptions, LoadedScene, load_gltf, load_str};
use wavecrest_scene::mesh::{self, LoadedMesh};
use wavecrest_scene::mtl;
use wavecrest_scene::systems;

use crate::rays::{Question, question};

/// The most primitives, and rays, of a scene that is rendered.
const MOST_PRIMITIVES: usize = 1000;
const MOST_RAYS: u64 = 4000;

/// The most bounces.
const MOST_BOUNCES: u32 = 3;

/// One thread: to hand small inputs to others takes longer than to read them.
fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static POOL: LazyLock<ThreadPool> =
        LazyLock::new(|| ThreadPoolBuilder::new().num_threads(1).build().expect("a thread"));
    POOL.install(work)
}

/// A folder with a mesh and a texture that scenes can name.
fn files() -> PathBuf {
    let within = "tests/fuzz/files";
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|f| f.join(within));
    folders.filter(|folder| folder.is_dir()).last().expect("the repository has these files")
}

/// A scene in JSON is refused in words, or it can be rendered: to one image, by either tracer, of
/// which every pixel is a number.
pub fn scene(bytes: &[u8]) -> bool {
    alone(|| is_scene(bytes))
}

fn is_scene(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let options = LoadOptions { width: Some(5), height: Some(4), ..LoadOptions::default() };
    load_str(text, &files().join("scene.json"), &options).is_ok_and(is_rendered)
}

/// A glTF file, as text or binary, is refused in words, or it can be rendered likewise.
pub fn gltf(bytes: &[u8]) -> bool {
    alone(|| {
        let options = LoadOptions { width: Some(5), height: Some(4), ..LoadOptions::default() };
        let loaded = load_gltf(bytes.to_vec(), &files().join("scene.gltf"), &options);
        loaded.is_ok_and(is_rendered)
    })
}

/// Whether a scene can be made ready; if so, both tracers have one image of it, all numbers.
fn is_rendered(loaded: LoadedScene) -> bool {
    let Ok(extracted) = systems::extract(loaded.world, Default::default()) else {
        return false;
    };
    let rays = extracted.scene().expected_rays();
    if extracted.geometry().len() > MOST_PRIMITIVES || rays > MOST_RAYS {
        return true;
    }
    let mut scene = extracted.build(Preset::Medium);
    scene.bounces = scene.bounces.min(MOST_BOUNCES);
    let film = |tracer| {
        let options = RenderOptions { tracer, ..RenderOptions::default() };
        render(&scene, &options, &()).expect("the whole of a small image").film
    };
    let (wavefront, recursive) = (film(TracerKind::Wavefront), film(TracerKind::Recursive));
    assert!(!wavefront.pixels().as_flattened().iter().any(|x| x.is_nan()), "a pixel is no number");
    assert!(wavefront.same_bits(&recursive), "the tracers differ");
    true
}

/// A PLY file is refused in words, or it is a sound mesh.
pub fn ply(bytes: &[u8]) -> bool {
    alone(|| is_mesh("mesh.ply", bytes))
}

/// An OBJ file is refused in words, or it is a sound mesh.
pub fn obj(bytes: &[u8]) -> bool {
    alone(|| is_mesh("mesh.obj", bytes))
}

/// An STL file is refused in words, or it is a sound mesh.
pub fn stl(bytes: &[u8]) -> bool {
    alone(|| is_mesh("mesh.stl", bytes))
}

/// Of an MTL file whatever is right is read: every material can be written into a scene file.
pub fn mtl(bytes: &[u8]) -> bool {
    let materials = mtl::materials(bytes);
    for (_, material, texture, cutout) in &materials {
        let Material {
            ks, kd, specular_exponent, diffuse_color, kr, emission, specular_color, ..
        } = *material;
        assert!([ks, kd, kr].iter().all(|weight| (0.0..=1.0).contains(weight)), "{material:?}");
        assert!((0.0..=1e6).contains(&specular_exponent), "{material:?}");
        let threshold = cutout.as_ref().map_or(1.0, |cutout| cutout.threshold);
        assert!(threshold > 0.0 && threshold.is_finite(), "{cutout:?}");
        let colors = texture.iter().map(|texture| texture.tint).chain([
            diffuse_color,
            emission,
            specular_color,
        ]);
        let is_color = |color: DVec3| color.is_finite() && color.min_element() >= 0.0;
        assert!(colors.into_iter().all(is_color), "{material:?}, {texture:?}");
    }
    materials.iter().any(|(_, _, texture, _)| texture.is_some())
}

/// What is read is sound, and does not depend on how much of the file is read at a time.
fn is_mesh(name: &str, bytes: &[u8]) -> bool {
    let path = Path::new(name);
    let told = |portion| mesh::load_bytes(path, bytes, portion).map_err(|e| e.to_string());
    let whole = told(1 << 14);
    if let Ok(LoadedMesh { mesh, .. }) = &whole {
        assert!(mesh::validate(mesh, path).is_ok(), "a mesh was read that is not sound");
    }
    for portion in [64, 200, 1000] {
        assert_eq!(whole, told(portion), "read in portions of {portion}");
    }
    whole.is_ok()
}

/// A mesh of any bits is refused, or a tree is built in which rays of any bits find what brute force
/// finds, with every kernel and all instructions.
pub fn accel(bytes: &[u8]) -> bool {
    alone(|| is_answered(bytes))
}

fn is_answered(bytes: &[u8]) -> bool {
    let Some(Question { geometry, rays, preset, kernels }) = question(bytes) else { return false };
    let mut brute = Accel::new(geometry.clone(), Preset::Brute);
    brute.kernel = kernels[kernels.len() - 1];
    let expected = answers(&brute, &rays);
    let mut accel = Accel::new(geometry, preset);
    let levels = if cfg!(fuzzing) { vec![Level::best()] } else { Level::available() };
    for level in levels {
        accel.level = level.token().expect("it is available");
        for &kernel in kernels {
            accel.kernel = kernel;
            let found = answers(&accel, &rays);
            for (i, ray) in rays.iter().enumerate() {
                let (found, expected) = (found(i), expected(i));
                let place = (preset, level, kernel);
                assert!(found == expected, "{place:?}, {ray:?}: {found:?} and not {expected:?}");
            }
        }
    }
    true
}

/// The closest hits and whether rays are occluded, by the number of the ray. A t is compared by
/// its bits.
fn answers(accel: &Accel, rays: &[Ray]) -> impl Fn(usize) -> (u32, u32, bool) + use<> {
    let mut traversal = accel.traversal();
    let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    accel.closest_of(rays, &mut hits, &mut traversal);
    accel.occluded_of(rays, &mut occluded, &mut traversal);
    move |i| (hits[i].t.to_bits(), hits[i].primitive, occluded[i])
}
