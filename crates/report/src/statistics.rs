//! The parts of the statistics of one render, which have a stable form as JSON.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `scene`, `tracer`, `threads`, `seed` | | the settings |
//! | `simd`, `kernel`, `precision` | | the instruction level, the kernel for batches of rays, and the precision of hits |
//! | `image.width`, `.height`, `.samples_per_pixel` | pixels, rays | the image, or the part of it |
//! | `rays.primary`, `.secondary`, `.shadow` | rays | camera rays, rays that go on from surfaces, and shadow rays traced |
//! | `samples.lens`, `.light`, `.texels` | | points sampled on the lens and on area lights; texels read |
//! | `samples.colors` | | hits whose colour was interpolated between vertices |
//! | `samples.footprints` | | footprints of rays on surfaces, for trilinear textures and for rays from surfaces that may show them |
//! | `textures.images`, `.decoded`, `.bytes`, `.invalid` | | images that may be visible, those decoded for a look-up, their bytes, and how many of their numbers are not finite and count as 0 |
//! | `tests.nodes` | nodes | inner nodes visited, by one ray or several together, each testing eight boxes |
//! | `tests.instances` | visits | of an instance by a ray that meets its box |
//! | `tests.cutouts` | tests | hits on cut-outs that would replace the ray's best, each with a look-up of alpha |
//! | `tests.primitives.triangles`, `.quads`, `.spheres`, `.disks` | tests | tests of primitives; a quad counts once for each half |
//! | `kernels.closest.packet`, `.stream`, `.single` | rays | all but shadow rays by their first kernel: a packet, many in flight, one alone |
//! | `kernels.closest.handed_over` | rays | rays that packets handed over to the kernel in flight |
//! | `kernels.closest.rays_a_node`, `.rays_a_round` | rays | average number of rays of a packet at a visited node, and in flight in a round (`null` without any) |
//! | `kernels.shadow.…` | | the same for shadow rays |
//! | `dropped.degenerate` | triangles | dropped, as they have no area |
//! | `invalid` | samples | not finite; they count as black |
//! | `first_invalid.x`, `.y`, `.sample`, `.bounce`, `.primitive`, `.shape` | | where the first of them becomes not finite (`null` without any) |
//! | `lights_at_surface` | rays | to lights within the rounding error of the surface |
//! | `cut_short` | paths | that ended at 65 536 rays: their surfaces send on more light than they receive |
//! | `time.load`, `.build`, `.trace`, `.write`, `.total` | seconds | wall-clock time by stage |
//! | `time.passes` | seconds | by pass ([`TimedPass`](wavecrest_core::tile::TimedPass)), summed over threads, empty for the recursive tracer; `maps` is the shading of mapped hits, and `decode` the decoding of images, wherever it is |
//! | `memory.peak` | bytes | peak of the process (`null` if unknown) |
//! | `columns.held` | bytes | columns of the wavefront's batches on all threads (the recursive tracer has none) |
//! | `bvh.preset`, `.nodes`, `.depth`, `.bytes` | | the trees as they are at the end: all nodes, the largest depth |
//! | `bvh.chunks` | | the numbers of chunks that rays built, and of all; `null` if trees were built at once |
//! | `resumed` | | the share of the image that a checkpoint held (0 to 1): rays and other counts are those of this run only |
//! | `goal.asked.error`, `.seconds`, `goal.samples`, `.found_error`, `.passes`, `.seconds`, `.end` | RMSE, s | a target error or a time budget, and its outcome (`null` without either): the samples of each pixel, the error of the image (`null` with one sample, or where no two halves of them differ), the passes that this render finished and their seconds, and what ended it: `error`, `time`, `samples` (there are no more) or `cancelled` |
//! | `plan` | | each effect, whether it is simulated, and the reason |

#![allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]

use serde::{Serialize, Serializer};

use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::{Appearance, LazyImage, PreparedScene};

/// The size of the whole image.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct ImageSize {
    pub width: u32,
    pub height: u32,
    pub samples_per_pixel: u32,
}

impl ImageSize {
    /// That of the images of `scene`.
    pub fn of(scene: &PreparedScene) -> Self {
        let [width, height] = scene.camera.size();
        Self { width, height, samples_per_pixel: scene.camera.rays_per_pixel() }
    }
}

/// Images of textures.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Textures {
    pub images: usize,
    pub decoded: usize,
    pub bytes: u64,
    pub invalid: u64,
}

impl Textures {
    /// Those of `appearance`.
    pub fn of(appearance: &Appearance) -> Self {
        let images = &appearance.images;
        Self {
            images: images.len(),
            decoded: images.iter().filter(|image| image.decoded().is_some()).count(),
            bytes: images.iter().map(LazyImage::bytes).sum(),
            invalid: images.iter().filter_map(LazyImage::held).map(|image| image.invalid).sum(),
        }
    }
}

/// Seconds by stage.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Time {
    pub load: f64,
    pub build: f64,
    pub trace: f64,
    pub write: f64,
    pub total: f64,
    #[serde(serialize_with = "as_map")]
    pub passes: Vec<(&'static str, f64)>,
}

/// Peak bytes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Memory {
    pub peak: Option<u64>,
}

/// The tree.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Bvh {
    pub preset: Preset,
    pub nodes: usize,
    pub depth: usize,
    pub bytes: u64,
    /// The numbers of chunks built and of all, if rays build them.
    pub chunks: Option<[usize; 2]>,
}

impl Bvh {
    /// The size of `accel`, built with `preset`.
    pub fn of(accel: &Accel, preset: Preset) -> Self {
        let census = || accel.trees().map(|tree| tree.census());
        Self {
            preset,
            nodes: census().map(|census| census.nodes as usize).sum(),
            depth: census().map(|census| census.depth as usize).max().unwrap_or(0),
            bytes: accel.tree_bytes(),
            chunks: accel.chunks(),
        }
    }
}

/// Seconds by pass as a JSON object.
pub(crate) fn as_map<S: Serializer>(passes: &[(&str, f64)], sink: S) -> Result<S::Ok, S::Error> {
    sink.collect_map(passes.iter().copied())
}
