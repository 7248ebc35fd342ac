//! Memory foretold: what a render of a scene will hold at its peak.

use crate::accel::build::Preset;
use crate::prepared::PreparedScene;
use crate::systems::Extracted;
use crate::wavefront::batch::Batch;

/// Bytes by use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Prediction {
    /// Positions, indices, spheres.
    pub geometry: u64,
    /// Mesh attributes and decoded textures.
    pub looks: u64,
    /// The tree, once built.
    pub tree: u64,
    /// What building the tree needs at its peak, the tree counted.
    pub build: u64,
    /// The image.
    pub film: u64,
    /// The wavefronts' columns, one wavefront a thread.
    pub batches: u64,
    /// The program itself.
    pub program: u64,
}

/// Bytes for each primitive at the peak of a build, boxes, hierarchy and our own nodes together:
/// measured on meshes of 1 and 4 million triangles.
const fn build_bytes(preset: Preset) -> u64 {
    match preset {
        Preset::Brute => 0,
        Preset::Fastest | Preset::VeryFast | Preset::Fast | Preset::Medium => 250,
        Preset::Slow | Preset::VerySlow => 270,
    }
}

/// Bytes of our nodes and leaves for each primitive, measured: leaves hold one primitive with the
/// quickest preset and about two with the others.
const fn tree_bytes(preset: Preset) -> u64 {
    match preset {
        Preset::Brute => 0,
        Preset::Fastest => 68,
        _ => 40,
    }
}

/// What the program holds with an empty scene: measured.
const PROGRAM: u64 = 8 << 20;

impl Prediction {
    /// The peak: either while building or while tracing.
    pub fn total(&self) -> u64 {
        let lasting = self.geometry + self.looks + self.program;
        lasting + self.build.max(self.tree + self.film + self.batches)
    }
}

/// Foretells the peak of a render with `preset` and batches of `batch` paths, on the threads of
/// the current pool.
pub fn predict(extracted: &Extracted, preset: Preset, batch: usize) -> Prediction {
    let scene: &PreparedScene = extracted.scene();
    let geometry = extracted.geometry();
    let primitives = geometry.len() as u64;
    let [width, height] = scene.camera.size().map(u64::from);
    let path: usize = Batch::bytes_per_path(scene).iter().map(|(_, bytes)| bytes).sum();
    Prediction {
        geometry: geometry.bytes(),
        looks: scene.looks.bytes(),
        tree: primitives * tree_bytes(preset),
        build: primitives * build_bytes(preset),
        film: width * height * size_of::<[f32; 3]>() as u64,
        batches: (path * batch * rayon::current_num_threads()) as u64,
        program: PROGRAM,
    }
}
