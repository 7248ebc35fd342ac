//! Peak memory of a render, estimated and measured.

use crate::components::{Channels, Filter};
use crate::survey::{Survey, SurveyedMesh};
use crate::systems::{Extracted, textures};
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
/// of the current pool: measured on meshes of 1, 4 and 18 million triangles. A tree in several
/// chunks takes hardly more than itself and each thread's memory for a chunk; one chunk is held with
/// boxes, hierarchy and costs at once.
pub fn build_bytes(preset: Preset, primitives: u64) -> u64 {
    let chunk = CHUNK as u64;
    match preset {
        Preset::Brute => 0,
        _ if primitives > chunk => {
            let threads = (rayon::current_num_threads() as u64).min(primitives.div_ceil(chunk));
            primitives * (tree_bytes(preset) + ORDER_BYTES) + threads * chunk * 600
        }
        _ => primitives * 320,
    }
}

/// Bytes for each primitive of the order along a curve.
const ORDER_BYTES: u64 = 6;

/// Bytes of nodes and leaves for each primitive, measured: a leaf holds three to five triangles.
const fn tree_bytes(preset: Preset) -> u64 {
    match preset {
        Preset::Brute => 0,
        Preset::OnDemand | Preset::Fastest => 45,
        Preset::VeryFast => 50,
        _ => 47,
    }
}

/// Measured bytes of the program with an empty scene, and of each of its threads.
fn program_bytes() -> u64 {
    (13 << 20) + (rayon::current_num_threads() as u64) * (64 << 10)
}

impl Estimate {
    /// The peak over reading, building and tracing.
    pub fn total(&self) -> u64 {
        let lasting = self.geometry + self.appearance + self.program;
        // The system's allocator may keep what the batches of many threads held.
        let tracing = self.tree + self.film + self.batches + self.decoding.max(self.writing);
        (lasting + self.build.max(tracing)).max(self.loading)
    }

    /// The same if rays build these bytes of the trees.
    #[must_use]
    pub fn with_tree(self, bytes: u64) -> Self {
        Self { tree: bytes, build: self.build.saturating_sub(self.tree) + bytes, ..self }
    }

    /// [`check_room`] for the total.
    ///
    /// # Errors
    /// If the system refuses that much.
    pub fn check_room(&self) -> Result<()> {
        check_room(self.total(), "the render")
            .map_err(|error| error.remedy("free some, or use a smaller scene or image"))
    }
}

/// Allocates as much memory, and frees it again. Programs with Rust's own allocator, which aborts if
/// memory is refused, can check before they begin.
///
/// # Errors
/// If the system refuses that much.
pub fn check_room(bytes: u64, what: &str) -> Result<()> {
    let room = reserve::<u8>(usize::try_from(bytes).unwrap_or(usize::MAX), what)?;
    // The compiler may leave out an allocation that nothing reads.
    std::hint::black_box(room.as_ptr());
    Ok(())
}

/// Bytes of an image of this number of pixels.
pub const fn film_bytes(pixels: u64) -> u64 {
    pixels.saturating_mul(size_of::<[f32; 3]>() as u64)
}

/// Bytes of a render's images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageBytes {
    /// Those in memory from tracing to writing: [`Estimate::film`].
    pub film: u64,
    /// [`Estimate::writing`].
    pub writing: u64,
}

impl ImageBytes {
    /// A whole image of this width and height in pixels, not written.
    pub fn whole([width, height]: [u32; 2]) -> Self {
        Self { film: film_bytes(u64::from(width) * u64::from(height)), writing: 0 }
    }
}

/// Estimates the peak of a render of a whole extracted scene, with `preset` and batches of `batch`
/// paths, on the threads of the current pool.
pub fn estimate_extracted(extracted: &Extracted, preset: Preset, batch: usize) -> Estimate {
    let scene: &PreparedScene = extracted.scene();
    let geometry = extracted.geometry();
    let primitives = geometry.held() as u64;
    let threads = rayon::current_num_threads() as u64;
    Estimate {
        geometry: geometry.bytes(),
        appearance: scene.appearance.expected_bytes(),
        tree: primitives * tree_bytes(preset),
        build: build_bytes(preset, primitives),
        film: film_bytes(extracted.pixels()),
        batches: Batch::estimated_bytes(scene, batch_size(scene, batch)) * threads,
        decoding: scene.appearance.decoding_bytes(threads as usize),
        writing: 0,
        program: program_bytes(),
        loading: peak().unwrap_or(0),
    }
}

/// The options of a render that affect its memory.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// The images, from the width and height of the whole image in pixels.
    pub images: &'a dyn Fn([u32; 2]) -> ImageBytes,
    /// The preset; the default choice if `None`.
    pub preset: Option<Preset>,
    /// Paths in a batch.
    pub batch: usize,
    /// Whether meshes are copied for each of their instances.
    pub flat: bool,
}

/// Memory of the meshes of a survey.
#[derive(Default)]
struct MeshBytes {
    primitives: u64,
    /// Bytes of positions and triangles, and of attributes, in the scene.
    geometry: u64,
    appearance: u64,
    /// Bytes of all meshes as read.
    read: u64,
    /// Bytes of the last copy. All meshes are read before the scene takes over the first one's
    /// arrays and extends them for the others; the last of these still exists when its copy is
    /// complete.
    copy: u64,
}

impl MeshBytes {
    fn of(meshes: &[SurveyedMesh], flat: bool) -> Self {
        let mut all = Self::default();
        let mut own = 0;
        for SurveyedMesh { holds, normals, uvs, tangents, uses } in meshes {
            let is_shared = *uses > 1 && !flat;
            let copies = if is_shared { 1 } else { *uses };
            let add =
                |to: &mut u64, each: u64| *to = to.saturating_add(each.saturating_mul(copies));
            add(&mut all.primitives, holds.triangles);
            add(&mut all.geometry, holds.prototype_bytes());
            add(&mut all.appearance, if *normals { holds.normal_bytes() } else { 0 });
            add(&mut all.appearance, if *uvs { holds.uv_bytes() } else { 0 });
            add(&mut all.appearance, holds.color_bytes());
            let by_vertex = holds.positions.saturating_mul(size_of::<[f32; 4]>() as u64);
            add(&mut all.appearance, if *tangents { by_vertex } else { 0 });
            all.read = all.read.saturating_add(holds.bytes());
            if !is_shared {
                own += 1;
                all.copy = all.copy.max(holds.prototype_bytes());
            }
        }
        all.copy = if own > 1 { all.copy } else { 0 };
        all
    }
}

/// Estimates the peak of a render before any mesh or texture is read, on the threads of the current
/// pool.
pub fn estimate(survey: &Survey, asked: Asked<'_>) -> Estimate {
    let meshes = MeshBytes::of(&survey.meshes, asked.flat);
    let mut found = Estimate {
        program: program_bytes(),
        geometry: meshes.geometry.saturating_add(survey.instances * INSTANCE_BYTES),
        appearance: meshes.appearance,
        ..Estimate::default()
    };
    let texture = |(source, &filter)| textures::survey(source, filter, Channels::Color);
    let mask = |source| textures::survey(source, Filter::Bilinear, Channels::Alpha);
    let images: Vec<[u64; 2]> = (survey.textures.iter().map(texture))
        .chain(survey.masks.iter().map(mask))
        .chain(survey.embedded.iter().copied())
        .collect();
    let held = images.iter().map(|[held, _]| *held);
    found.appearance = held.fold(found.appearance, u64::saturating_add);
    found.decoding = largest(images.iter().map(|[_, more]| *more), rayon::current_num_threads());
    let text = survey.text.saturating_mul(JSON_BYTES_PER_BYTE);
    let lasting = found.geometry.saturating_add(found.appearance).saturating_add(found.program);
    let read = [survey.raw, meshes.read.min(READER_BYTES), found.program, text, survey.creasing];
    let read = read.into_iter().fold(meshes.read, u64::saturating_add);
    found.loading = read.max(lasting.saturating_add(meshes.copy));
    let primitives = survey.others.saturating_add(meshes.primitives);
    let preset = asked.preset.unwrap_or_else(|| Preset::choose(primitives, expected_rays(survey)));
    found.tree = primitives.saturating_mul(tree_bytes(preset));
    found.build = build_bytes(preset, primitives);
    ImageBytes { film: found.film, writing: found.writing } = (asked.images)(survey.size);
    let batch = Batch::bytes_at_most(asked.batch, survey.bounces);
    found.batches = batch * rayon::current_num_threads() as u64;
    found
}

/// About the largest number of rays of a render, like
/// [`PreparedScene::expected_rays`](wavecrest_core::prepared::PreparedScene::expected_rays).
fn expected_rays(survey: &Survey) -> u64 {
    let pixels: u64 = survey.size.map(u64::from).iter().product();
    let paths = pixels.saturating_mul(survey.rays_per_pixel);
    let hits = paths.saturating_mul(1 + u64::from(survey.bounces.min(1)));
    hits.saturating_mul(1 + survey.light_samples)
}

/// Bytes of an instance: its transforms, its shape and material, its node of the tree over instances.
const INSTANCE_BYTES: u64 = 600;

/// Bytes that readers hold beyond their results: blocks of text and their parsed values.
const READER_BYTES: u64 = 24 << 20;

/// Upper bound on the bytes that JSON takes for each byte of its text while it is read.
const JSON_BYTES_PER_BYTE: u64 = 25;

/// The peak memory of this process so far in bytes, if the system reports it.
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
