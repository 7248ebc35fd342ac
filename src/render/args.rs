//! The arguments of `render`.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::common::{
    FILES, FRAMES, IMAGE, LONG, SPEED, SearchOptions, above_zero, choice, numbers, output, tell,
    whole,
};
use crate::input::SceneOptions;
use crate::output_options::{DevelopOptions, Metadata};
use crate::progress::Style;
use wavecrest_api as api;
use wavecrest_base::choice::Choice as _;
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};
use wavecrest_base::replace::make_folder;
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_core::tile::Tile;
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_image::aov::Layer;
use wavecrest_image::farm::Shard;
use wavecrest_image::farm::checkpoint::Checkpoint;
use wavecrest_image::look::Look;
use wavecrest_image::write::{Develop, Transfer};

/// Render a scene to an image.
#[derive(Clone, Debug, clap::Args)]
#[command(
    override_usage = "wavecrest [render] <SCENE> <OUTPUT> [OPTIONS]\n       wavecrest [render] <SCENE>... --output <FOLDER> [OPTIONS]"
)]
pub(crate) struct RenderArgs {
    /// Scene (.json), glTF file (.gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Image to write: .png, .jpg, .ppm, .exr or .pfm; - writes a PNG to standard output; with --turntable also .gif; with
    /// --shard a .part file
    #[arg(value_name = "OUTPUT", required_unless_present = "output")]
    pub(crate) image: Option<PathBuf>,
    /// Further scenes, with --output FOLDER
    #[arg(value_name = "SCENE", hide = true)]
    pub(crate) more: Vec<PathBuf>,
    /// Image to write, as an option; or the folder for a .png of each scene
    #[arg(short, long, value_name = "OUTPUT")]
    pub(crate) output: Option<PathBuf>,
    /// Which scene this is of how many
    #[arg(skip)]
    pub(crate) number: Option<[u64; 2]>,
    /// Transfer function of 8-bit images (.png, .jpg, .ppm) [default: that of the scene; srgb for glTF files
    /// and meshes]
    #[arg(long, help_heading = IMAGE, value_parser = choice::<Transfer>())]
    pub(crate) transfer: Option<Transfer>,
    /// Render geometry or materials instead of lighting
    #[arg(long = "as", help_heading = IMAGE, value_name = "LOOK", value_parser = choice::<Look>(),
          conflicts_with_all = ["checkpoint", "target_error", "time_budget"])]
    pub(crate) look: Option<Look>,
    /// Exposure and tone mapping
    #[command(flatten)]
    pub(crate) develop: DevelopOptions,
    /// Render only this part of the image, in pixels from the top left
    #[arg(long, help_heading = IMAGE, value_name = "X,Y,WIDTH,HEIGHT", value_parser = crop, allow_hyphen_values = true)]
    pub(crate) crop: Option<Tile>,
    /// Also write the image to this file; can be given several times
    #[arg(long, help_heading = IMAGE, value_name = "FILE")]
    pub(crate) also: Vec<PathBuf>,
    /// Layers to add to .exr outputs, comma-separated: depth, normal, albedo, position, object, material, samples,
    /// invalid, all (these), or alpha (colours then count as premultiplied)
    #[arg(long, help_heading = IMAGE, value_name = "LAYERS", value_parser = layers)]
    pub(crate) aov: Option<LayerList>,
    /// Take Sobol samples until the error is at most this (RMSE of linear values); at most --samples
    #[arg(long, help_heading = IMAGE, value_name = "ERROR", value_parser = above_zero)]
    pub(crate) target_error: Option<f64>,
    /// Take Sobol samples for so many seconds, with all that the command does; with --target-error, whichever ends first
    #[arg(long, help_heading = IMAGE, value_name = "SECONDS", value_parser = above_zero)]
    pub(crate) time_budget: Option<f64>,
    /// Seed of the random numbers
    #[arg(long, help_heading = IMAGE, value_name = "N", default_value_t = 0, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
    /// Render this frame of the camera's path
    #[arg(long, help_heading = FRAMES, value_name = "N", value_parser = whole(0..=u32::MAX))]
    pub(crate) frame: Option<u32>,
    /// Render frames A to B, one image each; every # in the output's name stands for a digit of the frame number.
    /// With --shard, each shard renders whole frames
    #[arg(long, help_heading = FRAMES, value_name = "A..B", value_parser = frames, conflicts_with_all = ["frame", "stats", "checkpoint", "target_error", "time_budget", "save_every"])]
    pub(crate) frames: Option<Frames>,
    /// How to show progress on standard error
    #[arg(long, help_heading = LONG, value_enum, default_value_t)]
    pub(crate) progress: Style,
    /// Write the unfinished image at this interval
    #[arg(long, help_heading = LONG, value_name = "SECONDS", value_parser = above_zero)]
    pub(crate) save_every: Option<f64>,
    /// Save finished work to this file at intervals, and when SIGINT or SIGTERM stops the render
    #[arg(long, help_heading = LONG, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Interval between checkpoints, in seconds [default: 60]
    #[arg(long, help_heading = LONG, value_name = "SECONDS", requires = "checkpoint", value_parser = above_zero)]
    pub(crate) every: Option<f64>,
    /// Resume from the checkpoint, if it exists
    #[arg(long, help_heading = LONG, requires = "checkpoint")]
    pub(crate) resume: bool,
    /// Render shard I of N to a .part file for `wavecrest merge`
    #[arg(long, help_heading = LONG, value_name = "I/N", conflicts_with_all = ["target_error", "time_budget", "stats", "also", "aov", "save_every"])]
    pub(crate) shard: Option<Shard>,
    /// Metadata to write
    #[arg(long, help_heading = FILES, value_enum, default_value_t)]
    pub(crate) metadata: Metadata,
    /// Write statistics as JSON
    #[arg(long, help_heading = FILES, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
    /// Stop with an error if a sample or a texel is not finite; by default it counts as black
    #[arg(long, help_heading = FILES)]
    pub(crate) trap_invalid: bool,
    /// Tracer; does not change the image
    #[arg(long, help_heading = SPEED, value_parser = choice::<TracerKind>(), default_value_t)]
    pub(crate) tracer: TracerKind,
    /// Traversal
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Paths in a batch of the wavefront tracer; does not change the image
    #[arg(long, help_heading = SPEED, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = whole(1..=1_u32 << 20))]
    pub(crate) batch: u32,
}

impl RenderArgs {
    /// The renders of all scenes, one each.
    ///
    /// # Errors
    /// If several have no folder for their images, or the same name, or the folder cannot be made.
    pub(super) fn each(&self) -> Result<Vec<Self>> {
        let usage = |message: &str| Error::new(ErrorKind::Usage, message);
        let scenes: Vec<&PathBuf> =
            std::iter::once(&self.scene).chain(&self.image).chain(&self.more).collect();
        let folder =
            self.output.as_ref().filter(|path| path.is_dir() || path.extension().is_none());
        let given = if self.output.is_some() { scenes.len() } else { 1 + self.more.len() };
        let folder = match folder {
            Some(folder) if given > 1 || folder.is_dir() => folder,
            _ if given == 1 => return Ok(vec![self.clone()]),
            _ => {
                let error = usage("several scenes need a folder for their images");
                return Err(error.in_file(scenes[1]).remedy("name it with --output"));
            }
        };
        let of_one = [
            ("--also", !self.also.is_empty()),
            ("--stats", self.stats.is_some()),
            ("--checkpoint", self.checkpoint.is_some()),
            ("--shard", self.shard.is_some()),
        ];
        refuse("a folder of images", folder, &of_one)?;
        make_folder(folder)?;
        let mut all: Vec<Self> = Vec::with_capacity(scenes.len());
        for (number, &scene) in (1..).zip(&scenes) {
            let image = folder.join(scene.with_extension("png").file_name().unwrap_or_default());
            if let Some(other) = all.iter().find(|other| other.image.as_ref() == Some(&image)) {
                let message = format!("the image of {} has the same name", other.scene.display());
                return Err(usage(&message).in_file(scene).remedy("render them one by one"));
            }
            let number = Some([number, scenes.len() as u64]);
            let (scene, image, output, more) = (scene.clone(), Some(image), None, Vec::new());
            all.push(Self { scene, image, more, output, number, ..self.clone() });
        }
        Ok(all)
    }

    /// Prints a note, unless there are to be none.
    pub(super) fn say(&self, words: &str) {
        if !self.scene_options.quiet {
            tell(words);
        }
    }

    /// The render options.
    pub(super) fn options(&self) -> RenderOptions {
        let Self { tracer, crop, seed, .. } = *self;
        RenderOptions { tracer, crop, seed, batch: self.batch as usize }
    }

    /// How the scene is prepared.
    pub(super) fn preparing(&self) -> api::SceneOptions {
        let (look, exposure) = (self.look, Develop::from(self.develop).factor());
        let usual = self.scene_options.preparing(Some(&self.search));
        api::SceneOptions { look, exposure, ..usual }
    }

    /// The file to write.
    ///
    /// # Errors
    /// If none is named.
    pub(super) fn output(&self) -> Result<&PathBuf> {
        output(&self.output, &self.image, "out.png")
    }

    /// The files to write.
    ///
    /// # Errors
    /// If none is named.
    pub(super) fn paths(&self) -> Result<Vec<PathBuf>> {
        Ok(std::iter::once(self.output()?).chain(&self.also).cloned().collect())
    }

    /// The layers to write, with the alpha of a transparent background.
    pub(super) fn layers(&self) -> Vec<Layer> {
        let mut layers = self.aov.clone().unwrap_or_default().0;
        if self.scene_options.input.is_transparent() {
            layers.push(Layer::Alpha);
        }
        layers
    }

    /// The checkpoint, if requested.
    pub(super) fn checkpoint(&self) -> Option<Checkpoint> {
        let every = self.every.unwrap_or(USUAL_PAUSE);
        Some(Checkpoint {
            file: self.checkpoint.clone()?,
            // Intervals that are too long mean never.
            every: Duration::try_from_secs_f64(every).unwrap_or(Duration::MAX),
            resume: self.resume,
        })
    }
}

/// Refuses `others`, each with whether it is given, together with an `option`.
pub(super) fn refuse(option: &str, output: &Path, others: &[(&str, bool)]) -> Result<()> {
    let Some((other, _)) = others.iter().find(|(_, is_given)| *is_given) else { return Ok(()) };
    let message = format!("{option} and {other} cannot be used together");
    Err(Error::new(ErrorKind::Usage, message).in_file(output).remedy(format!("leave out {other}")))
}

/// Default number of seconds between checkpoints.
const USUAL_PAUSE: f64 = 60.0;

/// `x,y,width,height` in pixels.
fn crop(text: &str) -> std::result::Result<Tile, String> {
    let tile = |[x, y, width, height]: [u32; 4]| Tile { x, y, width, height };
    let wrong = "write four whole numbers: x,y,width,height, such as 0,0,64,64";
    numbers(text).map(tile).ok_or_else(|| wrong.to_owned())
}

/// The requested layers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct LayerList(Vec<Layer>);

/// `depth,normal`, or `all`.
fn layers(text: &str) -> std::result::Result<LayerList, String> {
    if text == "all" {
        // Alpha changes the colours: they are premultiplied by it.
        let all = Layer::ALL.into_iter().filter(|layer| *layer != Layer::Alpha);
        return Ok(LayerList(all.collect()));
    }
    let names = || Layer::ALL.map(Layer::name).into_iter();
    let layer = |word: &str| {
        Layer::by_name(word).ok_or_else(|| match did_you_mean(word, names()) {
            Some(near) => format!("there is no layer {word:?}; did you mean {near}?"),
            None => {
                let all = names().collect::<Vec<_>>().join(", ");
                format!("there is no layer {word:?}; use all, {all}")
            }
        })
    };
    text.split(',')
        .map(|word| layer(word.trim()))
        .collect::<std::result::Result<_, _>>()
        .map(LayerList)
}

/// A range of frames.
pub(crate) type Frames = RangeInclusive<u32>;

/// Largest number of frames in a range.
const MAX_FRAMES: u32 = 1_000_000;

/// `A..B`, inclusive.
fn frames(text: &str) -> std::result::Result<Frames, String> {
    let parsed = text.split_once("..").and_then(|(first, last)| {
        let (first, last): (u32, u32) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
        (first <= last && last - first < MAX_FRAMES).then_some(first..=last)
    });
    parsed.ok_or_else(|| {
        format!("write the first frame and the last, such as 1..24; at most {MAX_FRAMES}")
    })
}
