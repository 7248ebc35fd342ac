//! The statistics of one render, in a stable JSON form.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `scene`, `tracer`, `threads`, `seed` | | the settings |
//! | `simd`, `kernel`, `precision` | | the instruction level, the kernel for batches of rays, and the precision of hits |
//! | `image.width`, `.height`, `.samples_per_pixel` | pixels, rays | the image, or the part of it |
//! | `rays.primary`, `.secondary`, `.shadow` | rays | camera, mirror and shadow rays traced |
//! | `samples.lens`, `.light`, `.texels` | | points sampled on the lens and on area lights; texels read |
//! | `samples.colors` | | hits whose colour was interpolated between vertices |
//! | `samples.footprints` | | footprints of rays on surfaces, for trilinear textures and for mirrors that may show them |
//! | `textures.images`, `.decoded`, `.bytes` | | images that may be visible, those decoded for a look-up, and their bytes |
//! | `estimated.rays`, `.samples` | | upper bounds on these before the first ray: see [`crate::estimate`] |
//! | `tests.nodes` | nodes | inner nodes visited, by one ray or several together, each testing eight boxes |
//! | `tests.instances` | visits | of an instance by a ray that meets its box |
//! | `tests.cutouts` | tests | hits on cut-outs, each with a look-up of alpha |
//! | `tests.primitives.triangles`, `.quads`, `.spheres` | tests | tests of primitives; a quad counts once for each half |
//! | `kernels.closest.packet`, `.stream`, `.single` | rays | camera and mirror rays by their first kernel: a packet, many in flight, one alone |
//! | `kernels.closest.handed_over` | rays | rays that packets handed over to the kernel in flight |
//! | `kernels.closest.rays_a_node`, `.rays_a_round` | rays | average number of rays of a packet at a visited node, and in flight in a round (`null` without any) |
//! | `kernels.shadow.…` | | the same for shadow rays |
//! | `dropped.degenerate` | triangles | dropped, as they have no area |
//! | `invalid` | samples | not finite; they count as black |
//! | `first_invalid.x`, `.y`, `.sample`, `.bounce`, `.primitive`, `.shape` | | where the first of them becomes not finite (`null` without any) |
//! | `lights_at_surface` | rays | to lights within the rounding error of the surface |
//! | `time.load`, `.build`, `.trace`, `.write`, `.total` | seconds | wall-clock time by stage |
//! | `time.passes` | seconds | by pass, summed over threads |
//! | `memory.predicted`, `.peak` | bytes | peak of the process: estimated before a mesh or a texture is read, and measured (`null` if unknown) |
//! | `columns.estimated`, `.held` | bytes | columns of the wavefront's batches on all threads: estimated, and allocated (the recursive tracer has none) |
//! | `bvh.preset`, `.nodes`, `.depth`, `.bytes` | | the trees: all nodes, the largest depth |
//! | `resumed` | | the share of the image that a checkpoint held (0 to 1): rays and other counts are those of this run only |
//! | `goal.asked`, `.samples`, `.expected_error`, `.expected_seconds`, `.found_error`, `.renders` | | the choice for a target error or a time budget, and its outcome (`null` without either); `.found_error` is `null` without random samples, `.expected_error` if a budget is too short to measure it |
//! | `plan` | | each effect, whether it is simulated, and the reason |

use serde::Serialize;
use serde_json::{Map, Value};

use crate::estimate::Estimated;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, KernelChoice};
use wavecrest_core::counters::Counters;
use wavecrest_core::counters::KernelCounts;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::Plan;
use wavecrest_core::prepared::{Appearance, Dropped, LazyImage};
use wavecrest_core::probe::Invalid;
use wavecrest_core::render::TracerKind;

/// See the module documentation: fields have the names of the JSON.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]
pub struct Statistics {
    pub version: &'static str,
    pub scene: String,
    pub tracer: TracerKind,
    pub threads: usize,
    pub seed: u64,
    pub simd: Level,
    pub kernel: KernelChoice,
    pub precision: Precision,
    pub image: ImageSize,
    pub rays: Rays,
    pub samples: Samples,
    pub textures: Textures,
    pub estimated: Estimated,
    pub tests: Tests,
    pub kernels: KernelUse,
    pub dropped: Dropped,
    pub invalid: u64,
    pub first_invalid: Option<Invalid>,
    pub lights_at_surface: u64,
    pub time: Time,
    pub memory: Memory,
    pub columns: Columns,
    pub bvh: Bvh,
    pub goal: Option<Goal>,
    pub resumed: f64,
    pub plan: Plan,
}

/// The choice for a target error or a time budget, and its outcome.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Goal {
    pub asked: String,
    pub samples: String,
    pub expected_error: f64,
    pub expected_seconds: f64,
    pub found_error: Option<f64>,
    pub renders: u32,
}

/// The size of the rendered image.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct ImageSize {
    pub width: u32,
    pub height: u32,
    pub samples_per_pixel: u32,
}

/// Rays by kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Rays {
    pub primary: u64,
    pub secondary: u64,
    pub shadow: u64,
}

/// Samples by kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Samples {
    pub lens: u64,
    pub light: u64,
    pub colors: u64,
    pub texels: u64,
    pub footprints: u64,
}

/// Images of textures.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Textures {
    pub images: usize,
    pub decoded: usize,
    pub bytes: u64,
}

impl From<&Appearance> for Textures {
    fn from(appearance: &Appearance) -> Self {
        let images = &appearance.images;
        Self {
            images: images.len(),
            decoded: images.iter().filter(|image| image.decoded().is_some()).count(),
            bytes: images.iter().map(LazyImage::bytes).sum(),
        }
    }
}

/// Tests by kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Tests {
    pub nodes: u64,
    pub instances: u64,
    pub cutouts: u64,
    pub primitives: PrimitiveTests,
}

/// Tests of primitives by kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct PrimitiveTests {
    pub triangles: u64,
    pub quads: u64,
    pub spheres: u64,
}

impl PrimitiveTests {
    /// Tests of every kind.
    pub fn all(&self) -> u64 {
        self.triangles + self.quads + self.spheres
    }
}

/// Rays by kernel, in both classes.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct KernelUse {
    pub closest: ClassUse,
    pub shadow: ClassUse,
}

/// Rays of one class by kernel.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct ClassUse {
    pub packet: u64,
    pub handed_over: u64,
    pub stream: u64,
    pub single: u64,
    pub rays_a_node: Option<f64>,
    pub rays_a_round: Option<f64>,
}

/// Seconds by stage.
#[derive(Clone, Debug, Default, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Time {
    pub load: f64,
    pub build: f64,
    pub trace: f64,
    pub write: f64,
    pub total: f64,
    pub passes: Map<String, Value>,
}

/// Peak bytes.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Memory {
    pub predicted: u64,
    pub peak: Option<u64>,
}

/// Bytes of the columns of all batches.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Columns {
    pub estimated: u64,
    pub held: u64,
}

/// The tree.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct Bvh {
    pub preset: Preset,
    pub nodes: usize,
    pub depth: usize,
    pub bytes: u64,
}

impl Bvh {
    /// The size of `accel`, built with `preset`.
    pub fn of(accel: &Accel, preset: Preset) -> Self {
        let census = || accel.trees().map(|tree| tree.census);
        Self {
            preset,
            nodes: census().map(|census| census.nodes as usize).sum(),
            depth: census().map(|census| census.depth).max().unwrap_or(0),
            bytes: accel.tree_bytes(),
        }
    }
}

impl From<&Counters> for Rays {
    fn from(c: &Counters) -> Self {
        Self { primary: c.primary_rays, secondary: c.secondary_rays, shadow: c.shadow_rays }
    }
}

impl Rays {
    /// Rays of every kind.
    pub fn all(&self) -> u64 {
        self.primary + self.secondary + self.shadow
    }
}

impl From<&Counters> for Samples {
    fn from(c: &Counters) -> Self {
        Self {
            lens: c.lens_samples,
            light: c.light_samples,
            colors: c.colors,
            texels: c.texels,
            footprints: c.footprints,
        }
    }
}

impl From<&Counters> for Tests {
    fn from(c: &Counters) -> Self {
        let t = &c.tests;
        let primitives =
            PrimitiveTests { triangles: t.triangles, quads: t.quads, spheres: t.spheres };
        Self { nodes: t.nodes, instances: t.instances, cutouts: t.cutouts, primitives }
    }
}

impl From<&Counters> for KernelUse {
    fn from(c: &Counters) -> Self {
        Self { closest: (&c.kernels.closest).into(), shadow: (&c.kernels.shadow).into() }
    }
}

impl From<&KernelCounts> for ClassUse {
    fn from(c: &KernelCounts) -> Self {
        Self {
            packet: c.packet,
            handed_over: c.handed_over,
            stream: c.stream,
            single: c.single,
            rays_a_node: c.rays_a_node(),
            rays_a_round: c.rays_a_round(),
        }
    }
}

/// Seconds by pass as a JSON object.
pub fn pass_map(passes: &[(&'static str, f64)]) -> Map<String, Value> {
    passes.iter().map(|&(name, seconds)| (name.to_owned(), seconds.into())).collect()
}
