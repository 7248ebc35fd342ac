//! Peak memory of a render, estimated and measured.

use crate::survey::Survey;
use crate::systems::Extracted;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::{CHUNK, Preset};
use wavecrest_core::prepared::{PreparedScene, largest};
use wavecrest_core::render::batch_size;
use wavecrest_core::wavefront::batch::Batch;

pub use wavecrest_base::memory::reserve;

/// Bytes by use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Estimate {
    /// Positions, indices, spheres.
    pub geometry: u64,
    /// Mesh attributes and decoded textures.
    pub appearance: u64,
    /// The tree, once built.
    pub tree: u64,
    /// The peak while building the tree, including the tree.
    pub build: u64,
    /// The image.
    pub film: u64,
    /// The wavefronts' columns, one wavefront for each thread.
    pub batches: u64,
    /// Additional memory of images while they are decoded.
    pub decoding: u64,
    /// Additional memory while the image is written: layers, and files as a whole.
    pub writing: u64,
    /// The program itself.
    pub program: u64,
    /// The peak while reading the scene: estimated, or measured after reading.
    pub loading: u64,
}

/// Peak bytes of building a tree over this number of primitives, including the tree, on the threads
/// of the current pool: measured on meshes of 1, 4 and 18 million triangles. It takes hardly more than
/// the tree and each thread's memory for a chunk, with boxes, hierarchy and costs at once.
pub fn build_bytes(preset: Preset, primitives: u64) -> u64 {
    if preset == Preset::Brute {
        return 0;
    }
    let in_chunks = primitives.min(rayon::current_num_threads() as u64 * CHUNK as u64);
    primitives * TREE_BYTES + in_chunks * 750
}

/// Bytes of nodes, leaves and order for each primitive: measured up to 80 for grids, and more where triangles overlap.
const TREE_BYTES: u64 = 80;

impl Estimate {
    /// The program and a tree, on the threads of the current pool: measured, with an empty scene.
    fn of(preset: Preset, primitives: u64, [film, writing]: [u64; 2]) -> Self {
        Self {
            tree: if preset == Preset::Brute { 0 } else { primitives * TREE_BYTES },
            build: build_bytes(preset, primitives),
            film,
            writing,
            program: (13 << 20) + (rayon::current_num_threads() as u64) * (64 << 10),
            ..Self::default()
        }
    }

    /// The peak over reading, building and tracing.
    pub fn total(&self) -> u64 {
        let lasting = self.geometry + self.appearance + self.program;
        // The system's allocator may keep what the batches of many threads held.
        let tracing = self.tree + self.film + self.batches + self.decoding.max(self.writing);
        (lasting + self.build.max(tracing)).max(self.loading)
    }

    /// The same for a render of `scene`, after a pilot has done what most of its rays do, which left `now` bytes to this
    /// process, and had taken `peak`; the batches' columns hold `batches`.
    #[must_use]
    pub fn measured(self, scene: &PreparedScene, batches: u64, [now, peak]: [u64; 2]) -> Self {
        let (appearance, tree) = (scene.appearance.bytes(), scene.accel.tree_bytes());
        let program = now.saturating_sub(self.geometry + appearance + tree);
        Self { appearance, tree, build: tree, batches, decoding: 0, program, loading: peak, ..self }
    }
}

/// Allocates as much memory, and frees it again. Programs with Rust's own allocator, which aborts if
/// memory is refused, can check before they begin.
///
/// # Errors
/// If the system refuses that much.
pub fn check_room(bytes: u64, what: &str) -> Result<()> {
    let room = reserve::<u8>(usize::try_from(bytes).unwrap_or(usize::MAX), what)
        .map_err(|error| error.remedy("free some, or use a smaller mesh, scene or image"))?;
    // The compiler may leave out an allocation that nothing reads.
    std::hint::black_box(room.as_ptr());
    Ok(())
}

/// Bytes of an image of this number of pixels.
pub const fn film_bytes(pixels: u64) -> u64 {
    pixels.saturating_mul(size_of::<[f32; 3]>() as u64)
}

/// Estimates the peak of a render before any mesh or texture is read, on the threads of the current
/// pool: with `preset`, batches of `batch` paths, and images of so many bytes, first those in memory
/// from tracing to writing, then additional ones while they are written.
pub fn estimate(survey: &Survey, images: [u64; 2], preset: Preset, batch: usize) -> Estimate {
    let threads = rayon::current_num_threads();
    let (geometry, attributes) = (survey.meshes.geometry(), survey.meshes.attributes);
    let found = Estimate::of(preset, survey.meshes.triangles, images);
    Estimate {
        geometry,
        appearance: attributes + survey.images.iter().map(|[held, _]| held).sum::<u64>(),
        batches: Batch::bytes_at_most(batch, survey.bounces) * threads as u64,
        decoding: largest(survey.images.iter().map(|[_, more]| *more), threads),
        loading: found.program + survey.reading + READ_TIMES * (geometry + attributes),
        ..found
    }
}

/// A mesh is there as read and as the scene takes it over, and its normals are found in lists of about as much.
const READ_TIMES: u64 = 3;

/// Estimates the peak of a render of a whole extracted scene, with `preset` and batches of `batch`
/// paths, on the threads of the current pool.
pub fn estimate_extracted(extracted: &Extracted, preset: Preset, batch: usize) -> Estimate {
    let (scene, geometry) = (extracted.scene(), extracted.geometry());
    let images = [film_bytes(extracted.pixels()), 0];
    let threads = rayon::current_num_threads();
    Estimate {
        geometry: geometry.bytes(),
        appearance: scene.appearance.expected_bytes(),
        batches: Batch::estimated_bytes(scene, batch_size(scene, batch)) * threads as u64,
        decoding: scene.appearance.decoding_bytes(threads),
        loading: peak().unwrap_or(0),
        ..Estimate::of(preset, geometry.held() as u64, images)
    }
}

/// The peak memory of this process so far in bytes, if the system reports it.
pub fn peak() -> Option<u64> {
    process().map(|[_, peak]| peak)
}

/// The memory of this process in bytes, now and at its peak, if the system reports it.
pub fn process() -> Option<[u64; 2]> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let reported = |key| {
        let line = status.lines().find_map(|line| line.strip_prefix(key))?;
        Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
    };
    Some([reported("VmRSS:")?, reported("VmHWM:")?])
}
