//! The arguments of `render`.

mod array;
mod frames;
mod outputs;
mod parts;
mod show;

use std::path::PathBuf;

use crate::choice::choice;
use crate::common::{Extent, SceneOptions, SearchOptions, above_zero, crop, whole};
use crate::develop::DevelopOptions;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_core::tile::Tile;
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_image::look::Look;
use wavecrest_image::write::Transfer;

use frames::FrameOptions;
pub(super) use frames::Frames;
pub(super) use outputs::Layers;
use outputs::OutputOptions;
use parts::PartOptions;
use show::ShowOptions;
pub(super) use show::Style;

/// Render a scene to an image.
#[derive(Clone, Debug, clap::Args)]
#[command(override_usage = "wavecrest [render] [OPTIONS] <SCENE> <OUTPUT>")]
pub(crate) struct RenderArgs {
    /// Scene (.json), glTF file (.gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Image to write: .png, .ppm, .exr or .pfm; with --turntable also .gif; with --shard a .part file
    #[arg(value_name = "OUTPUT", required_unless_present = "output")]
    pub(crate) image: Option<PathBuf>,
    /// Image to write, as an option
    #[arg(short, long, value_name = "OUTPUT", conflicts_with = "image")]
    pub(crate) output: Option<PathBuf>,
    /// Tracer; does not change the image
    #[arg(long, value_parser = choice::<TracerKind>(), default_value_t)]
    pub(crate) tracer: TracerKind,
    /// Render only this part of the image, in pixels from the top left
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT", value_parser = crop, allow_hyphen_values = true)]
    pub(crate) crop: Option<Tile>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Paths in a batch of the wavefront tracer; does not change the image
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = whole(1..=1_u32 << 20))]
    pub(crate) batch: u32,
    /// Traversal
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Stop with an error if a sample is not finite; by default it counts as black
    #[arg(long)]
    pub(crate) trap_invalid: bool,
    /// Transfer function of 8-bit images (.ppm, .png) [default: that of the scene; srgb for glTF files
    /// and meshes]
    #[arg(long, value_parser = choice::<Transfer>())]
    pub(crate) transfer: Option<Transfer>,
    /// Render geometry or materials instead of lighting
    #[arg(long = "as", value_name = "LOOK", value_parser = choice::<Look>(),
          conflicts_with_all = ["checkpoint", "target_error", "time_budget"])]
    pub(crate) look: Option<Look>,
    /// Exposure and tone mapping
    #[command(flatten)]
    pub(crate) develop: DevelopOptions,
    /// Outputs
    #[command(flatten)]
    pub(crate) outputs: OutputOptions,
    /// Progress
    #[command(flatten)]
    pub(crate) show: ShowOptions,
    /// Choose sampler and sample count to reach this error (RMSE of linear values)
    #[arg(long, value_name = "ERROR", value_parser = above_zero, conflicts_with_all = ["crop", "time_budget"])]
    pub(crate) target_error: Option<f64>,
    /// Choose sampler and sample count to finish within this time
    #[arg(long, value_name = "SECONDS", value_parser = above_zero, conflicts_with = "crop")]
    pub(crate) time_budget: Option<f64>,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
    /// Checkpoints and shards
    #[command(flatten)]
    pub(crate) parts: PartOptions,
    /// Frames
    #[command(flatten)]
    pub(crate) frames: FrameOptions,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

impl RenderArgs {
    /// The render options.
    pub(super) fn options(&self) -> RenderOptions {
        let batch = self.batch as usize;
        let Self { tracer, crop, seed, .. } = *self;
        RenderOptions { tracer, crop, seed, batch, ..Default::default() }
    }

    /// The extent of the image to render.
    pub(super) fn extent(&self) -> Extent<'_> {
        Extent { images: self, batch: self.batch as usize }
    }

    /// The file to write.
    ///
    /// # Errors
    /// If none is named.
    pub(super) fn output(&self) -> Result<&PathBuf> {
        self.output.as_ref().or(self.image.as_ref()).ok_or_else(|| {
            Error::new(ErrorKind::Usage, "the output is missing").remedy("add one, such as out.png")
        })
    }
}
