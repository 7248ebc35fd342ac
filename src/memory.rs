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
    /// What the builder needs besides, at its peak.
    pub build: u64,
    /// The image.
    pub film: u64,
    /// The wavefronts' columns, one wavefront a thread.
    pub batches: u64,
    /// The program itself.
    pub program: u64,
}

/// Bytes that obvhs holds for each primitive at its peak, the boxes it is given counted: measured
/// on meshes of 1 to 18 million triangles, where presets that split need the most.
const fn build_bytes(preset: Preset) -> u64 {
    match preset {
        Preset::Brute => 0,
        Preset::Fastest => 200,
        Preset::VeryFast | Preset::Fast | Preset::Medium => 232,
        Preset::Slow | Preset::VerySlow => 420,
    }
}

/// Bytes of our nodes and leaves for each primitive: a node of 64 bytes for every two primitives
/// or so, and four bytes for each place in a leaf.
const TREE_BYTES: u64 = 40;

/// What the program holds with an empty scene: measured.
const PROGRAM: u64 = 12 << 20;

impl Prediction {
    /// The peak: either while building, when the hierarchy and our nodes exist together, or while
    /// tracing.
    pub fn total(&self) -> u64 {
        let lasting = self.geometry + self.looks + self.tree + self.program;
        lasting + self.build.max(self.film + self.batches)
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
        tree: if preset == Preset::Brute { 0 } else { primitives * TREE_BYTES },
        build: primitives * build_bytes(preset),
        film: width * height * size_of::<[f32; 3]>() as u64,
        batches: (path * batch * rayon::current_num_threads()) as u64,
        program: PROGRAM,
    }
}
