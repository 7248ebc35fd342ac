//! Memory: what a render of a scene will hold at its peak, foretold and measured.

use crate::accel::build::Preset;
use crate::prepared::PreparedScene;
use crate::render::batch_size;
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
    /// What was held at the peak so far, while reading the scene: measured.
    pub so_far: u64,
}

/// Bytes at the peak of building a tree over so many primitives, the tree counted, on the threads of
/// the current pool: measured on meshes of 1, 4 and 18 million triangles. A tree in chunks is hardly
/// more than itself and what each thread needs for a chunk; one in one piece is held with boxes,
/// hierarchy and costs together.
fn build_bytes(preset: Preset, primitives: u64) -> u64 {
    let chunk = preset.chunk() as u64;
    match preset {
        Preset::Brute => 0,
        _ if primitives > chunk => {
            let threads = (rayon::current_num_threads() as u64).min(primitives.div_ceil(chunk));
            primitives * 60 + threads * chunk * 600
        }
        _ => primitives * 320,
    }
}

/// Bytes of our nodes and leaves for each primitive, measured: a leaf holds three or four triangles.
const fn tree_bytes(preset: Preset) -> u64 {
    match preset {
        Preset::Brute => 0,
        Preset::Fastest | Preset::VeryFast => 50,
        _ => 47,
    }
}

/// What the program holds with an empty scene: measured.
const PROGRAM: u64 = 10 << 20;

impl Prediction {
    /// The peak: while reading, while building or while tracing.
    pub fn total(&self) -> u64 {
        let lasting = self.geometry + self.looks + self.program;
        let ahead = lasting + self.build.max(self.tree + self.film + self.batches);
        ahead.max(self.so_far)
    }
}

/// Foretells the peak of a render of `pixels` with `preset` and batches of `batch` paths, on the
/// threads of the current pool.
pub fn predict(extracted: &Extracted, pixels: u64, preset: Preset, batch: usize) -> Prediction {
    let scene: &PreparedScene = extracted.scene();
    let geometry = extracted.geometry();
    let primitives = geometry.len() as u64;
    let threads = rayon::current_num_threads() as u64;
    Prediction {
        geometry: geometry.bytes(),
        looks: scene.looks.bytes(),
        tree: primitives * tree_bytes(preset),
        build: build_bytes(preset, primitives),
        film: pixels * size_of::<[f32; 3]>() as u64,
        batches: Batch::bytes_foretold(scene, batch_size(scene, batch)) * threads,
        program: PROGRAM,
        so_far: peak().unwrap_or(0),
    }
}

/// The largest number of bytes that this process has held in memory so far, where the system tells.
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
