//! The arguments of `render`.

mod array;
mod frames;
mod outputs;
mod parts;
mod show;

use std::path::PathBuf;

use crate::choice::choice;
use crate::common::{SceneOptions, SearchOptions, above_zero, crop};
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

/// Renders a scene to an image.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct RenderArgs {
    /// The scene: JSON, glTF (.gltf, .glb), or a mesh alone (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// The image to write: .ppm, .png, .exr or .pfm; for a shard, .part
    #[arg(value_name = "OUTPUT", required_unless_present = "output")]
    pub(crate) image: Option<PathBuf>,
    /// The image to write, named as an option
    #[arg(short, long, value_name = "OUTPUT", conflicts_with = "image")]
    pub(crate) output: Option<PathBuf>,
    /// How to trace; the image is the same
    #[arg(long, value_parser = choice::<TracerKind>(), default_value_t)]
    pub(crate) tracer: TracerKind,
    /// Render only this part of the image, in pixels from the top left
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT", value_parser = crop)]
    pub(crate) crop: Option<Tile>,
    /// Choose other random numbers
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Paths in a batch of the wavefront; the image is the same
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) batch: u32,
    /// How the tree is searched
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Write no image if a sample is not finite, but say which; without this it counts as black
    #[arg(long)]
    pub(crate) trap_invalid: bool,
    /// How linear colours become 8-bit levels (.ppm, .png) [default: linear for scenes in JSON, srgb for
    /// glTF files and meshes]
    #[arg(long, value_parser = choice::<Transfer>())]
    pub(crate) transfer: Option<Transfer>,
    /// Show what is there, rather than how it looks
    #[arg(long = "as", value_name = "LOOK", value_parser = choice::<Look>(),
          conflicts_with_all = ["checkpoint", "target_error", "time_budget"])]
    pub(crate) look: Option<Look>,
    /// How light becomes levels
    #[command(flatten)]
    pub(crate) develop: DevelopOptions,
    /// What is written
    #[command(flatten)]
    pub(crate) outputs: OutputOptions,
    /// What is seen of it
    #[command(flatten)]
    pub(crate) show: ShowOptions,
    /// Choose sampler and samples for this error, the root mean square of linear values
    #[arg(long, value_name = "ERROR", value_parser = above_zero, conflicts_with_all = ["crop", "time_budget"])]
    pub(crate) target_error: Option<f64>,
    /// Choose sampler and samples for this many seconds from start to end
    #[arg(long, value_name = "SECONDS", value_parser = above_zero, conflicts_with = "crop")]
    pub(crate) time_budget: Option<f64>,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
    /// What is kept, and which share is rendered
    #[command(flatten)]
    pub(crate) parts: PartOptions,
    /// Which frames of a camera that moves
    #[command(flatten)]
    pub(crate) frames: FrameOptions,
    /// What is read and how
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

impl RenderArgs {
    /// How to render.
    pub(super) fn options(&self) -> RenderOptions {
        let batch = self.batch as usize;
        RenderOptions { tracer: self.tracer, crop: self.crop, seed: self.seed, batch }
    }

    /// The image to write.
    ///
    /// # Errors
    /// When none is named.
    pub(super) fn output(&self) -> Result<&PathBuf> {
        self.output.as_ref().or(self.image.as_ref()).ok_or_else(|| {
            Error::new(ErrorKind::Usage, "no image to write is named")
                .remedy("name one, such as out.png")
        })
    }
}
