//! What several commands share: options, output, progress.

use std::io::{ErrorKind as IoKind, IsTerminal, Write};
use std::path::Path;

use bytesize::ByteSize;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use crate::choice::{by_name, choice};
use crate::lighting::LightingOptions;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, KernelChoice};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::tile::Tile;
use wavecrest_core::wavefront::DEFAULT_BATCH;
pub(crate) use wavecrest_report::files::{to_json, write_text};
use wavecrest_scene::load::framing::{Fit, Fov, Framing, Sheet, Side, Up};
use wavecrest_scene::load::{LoadOptions, LoadedScene, load, survey};
use wavecrest_scene::memory::{self, Estimate};
use wavecrest_scene::systems::{self, Extracted};

/// Options on what scene is read and how.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SceneOptions {
    /// Take warnings about unknown keys for errors
    #[arg(long)]
    pub(crate) strict: bool,
    /// Width of the image in pixels, instead of the scene's
    #[arg(long, value_name = "PIXELS")]
    pub(crate) width: Option<u32>,
    /// Height of the image in pixels, instead of the scene's
    #[arg(long, value_name = "PIXELS")]
    pub(crate) height: Option<u32>,
    /// The camera to take of a glTF file, by its name or its number [default: the first of the scene]
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// Read material files and images that an OBJ file names outside its folder, too
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// From where a mesh or a glTF file is seen
    #[command(flatten)]
    pub(crate) framing: FramingOptions,
    /// How a file without lights is lit
    #[command(flatten)]
    pub(crate) lighting: LightingOptions,
    /// How much work goes into the BVH [default: chosen from triangles and expected rays]
    #[arg(long, value_name = "PRESET", value_parser = choice::<Preset>())]
    pub(crate) bvh: Option<Preset>,
    /// How exactly hits are found: fast leaks, exact takes its time
    #[arg(long, value_name = "PRECISION", value_parser = choice::<Precision>(), default_value_t)]
    pub(crate) precision: Precision,
    /// Copy meshes that instances show to where they are shown, rather than hold them once
    #[arg(long)]
    pub(crate) flatten: bool,
    /// Refuse what would take more memory than this, such as 8GiB, before anything large is read
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub(crate) memory_limit: Option<ByteSize>,
    /// On how many threads
    #[command(flatten)]
    pub(crate) threads: Threads,
    /// Say nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

impl SceneOptions {
    /// Loads `scene` and prints its warnings.
    pub(crate) fn load(&self, scene: &Path) -> Result<LoadedScene> {
        let options = self.load_options();
        if let Some(limit) = self.memory_limit {
            check_memory(scene, &self.estimate(scene, None, DEFAULT_BATCH)?, limit)?;
        }
        let loaded = load(scene, &options)?;
        self.warn(&loaded.warnings);
        if !self.quiet {
            loaded.notes.iter().for_each(|note| tell(&format!("note: {note}")));
        }
        Ok(loaded)
    }

    /// Estimates the memory of a render of so many `pixels`, of all if `None`, before anything large is read.
    pub(crate) fn estimate(
        &self,
        scene: &Path,
        pixels: Option<u64>,
        batch: usize,
    ) -> Result<Estimate> {
        let survey = survey(scene, &self.load_options())?;
        let asked = memory::Asked { pixels, preset: self.bvh, batch, flat: self.flatten };
        Ok(memory::estimate(&survey, asked))
    }

    fn load_options(&self) -> LoadOptions {
        LoadOptions {
            strict: self.strict,
            width: self.width,
            height: self.height,
            camera: self.camera.clone(),
            allow_outside: self.allow_outside,
            framing: (&self.framing).into(),
            lighting: self.lighting.options(),
        }
    }

    /// Runs the systems on `loaded` but for the last.
    pub(crate) fn extract(&self, mut loaded: LoadedScene) -> Result<Extracted> {
        let (precision, flat) = (self.precision, self.flatten);
        let options = systems::Options { precision, flat, ..Default::default() };
        systems::extract(&mut loaded.world, options)
    }

    /// Prints warnings, unless quiet is requested.
    pub(crate) fn warn(&self, warnings: &[Warning]) {
        if !self.quiet {
            warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
        }
    }
}

/// Options on the camera that is put before a mesh or a glTF file.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FramingOptions {
    /// See a mesh or a glTF file from here, in place of its own camera: front, back, left, right, top, bottom,
    /// iso or inside, or two angles in degrees, from the front to the right and upward
    #[arg(
        long,
        value_name = "SIDE|AZIMUTH,ELEVATION",
        allow_hyphen_values = true,
        conflicts_with = "camera"
    )]
    pub(crate) view: Option<Side>,
    /// Which axis of a mesh or a glTF file is up [default: y; z for STL, and for PLY where its shape says so]
    #[arg(long, value_name = "AXIS", value_parser = choice::<Up>(), allow_hyphen_values = true,
          conflicts_with = "camera")]
    pub(crate) up: Option<Up>,
    /// The full angle across the shorter side of the image of a mesh or a glTF file [default: 40, in rooms 60]
    #[arg(long, value_name = "DEGREES", conflicts_with = "camera")]
    pub(crate) fov: Option<Fov>,
    /// How much of the image a mesh or a glTF file fills, 0 to 1 [default: 0.92]
    #[arg(long, value_name = "SHARE", conflicts_with = "camera")]
    pub(crate) fit: Option<Fit>,
    /// Go once around a mesh or a glTF file in so many frames, from 1 on
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(2..=3600), conflicts_with = "camera")]
    pub(crate) turntable: Option<u32>,
    /// See a mesh or a glTF file from several sides: rendered as one picture, with names under them
    #[arg(long, value_name = "SIDE,SIDE,...", allow_hyphen_values = true,
          conflicts_with_all = ["camera", "view", "turntable"])]
    pub(crate) sheet: Option<Sheet>,
}

impl From<&FramingOptions> for Framing {
    fn from(options: &FramingOptions) -> Self {
        let FramingOptions { view: side, up, fov, fit, turntable, .. } = *options;
        Self { side, up, fov, fit, turntable, sheet: options.sheet.clone().unwrap_or_default() }
    }
}

/// Options on how the tree is searched, which change no answer.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct SearchOptions {
    /// Vector instructions: auto for the best that this processor has, or sse2, sse42, avx2, avx512
    /// or neon; the image is the same
    #[arg(long, value_name = "LEVEL", default_value = "auto", value_parser = simd)]
    pub(crate) simd: Level,
    /// How a batch of rays is taken through the tree; the image is the same
    #[arg(long, value_name = "KERNEL", value_parser = choice::<KernelChoice>(), default_value_t)]
    pub(crate) kernel: KernelChoice,
}

impl SearchOptions {
    /// Has `accel` searched as the options say.
    pub(crate) fn apply(&self, accel: &mut Accel) {
        accel.kernel = self.kernel;
        if let Some(level) = self.simd.token() {
            accel.level = level;
        }
    }
}

/// A set of vector instructions that this processor has.
fn simd(text: &str) -> std::result::Result<Level, String> {
    if text == "auto" {
        return Ok(Level::best());
    }
    let available = Level::available();
    available.iter().copied().find(|level| level.name() == text).ok_or_else(|| {
        let names: Vec<_> = available.iter().map(|level| level.name()).collect();
        let is_known = by_name::<Level>(text).is_some();
        let what =
            if is_known { "this processor does not have it" } else { "there is no such level" };
        format!("{what}; use auto, {}", names.join(", "))
    })
}

/// How many threads to work on.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct Threads {
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub(crate) threads: Option<u16>,
}

impl Threads {
    /// Runs `work` on the threads asked for.
    pub(crate) fn run<R: Send>(&self, work: impl FnOnce() -> Result<R> + Send) -> Result<R> {
        let threads = self.threads.map_or(0, usize::from);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
            Error::new(ErrorKind::Usage, format!("cannot start the threads: {e}"))
                .remedy("ask for fewer with --threads")
        })?;
        pool.install(work)
    }
}

/// Writes to standard output. A reader that has seen enough, such as `head`, is no error.
pub(crate) fn print(text: &str) -> Result<()> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != IoKind::BrokenPipe => {
            Err(Error::io("cannot write the result", "standard output", error))
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error. Where that is closed, the line is lost.
pub(crate) fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// A bar on a terminal, and nothing anywhere else. Besides the keys of indicatif, `template` may
/// have `millions`: how many millions are done a second.
pub(crate) fn progress_bar(quiet: bool, template: &str) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("millions", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            let _ = write!(text, "{:.2}", state.per_sec() / 1e6);
        });
    ProgressBar::new(0).with_style(style)
}

/// Does `work`, which reports what is done of how much, with a bar of [`progress_bar`].
pub(crate) fn with_bar<R>(
    quiet: bool,
    template: &str,
    work: impl FnOnce(&mut dyn FnMut(u64, u64)) -> R,
) -> R {
    let bar = progress_bar(quiet, template);
    let result = work(&mut |done, all| {
        bar.set_length(all);
        bar.set_position(done);
    });
    bar.finish_and_clear();
    result
}

/// Refuses a scene whose peak is estimated to be above `limit`.
fn check_memory(scene: &Path, estimated: &Estimate, limit: ByteSize) -> Result<()> {
    if estimated.total() <= limit.as_u64() {
        return Ok(());
    }
    let Estimate { geometry, appearance, tree, build, film, batches, loading, .. } = *estimated;
    let uses = [
        ("reading", loading),
        ("geometry", geometry),
        ("normals and textures", appearance),
        ("building the tree", build),
        ("the tree", tree),
        ("the image", film),
        ("batches", batches),
    ];
    let uses = uses.map(|(name, bytes)| format!("{name} {}", in_words(bytes)));
    let message = format!("the render would take more memory than {}", in_words(limit.as_u64()));
    Err(Error::new(ErrorKind::Limit, message)
        .in_file(scene)
        .value(format!("about {}", in_words(estimated.total())))
        .remedy(format!(
            "raise --memory-limit, or make the scene or the image smaller (at their peaks: {})",
            uses.join(", ")
        )))
}

/// So many bytes.
fn in_words(bytes: u64) -> String {
    ByteSize::b(bytes).display().iec().to_string()
}

/// A number to so many digits.
pub(crate) fn rounded(x: f64, digits: usize) -> f64 {
    let rounded: f64 = format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x);
    // No -0.
    rounded + 0.0
}

/// `n` with spaces between thousands.
pub(crate) fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// So many bytes, in units of 1000.
pub(crate) fn size(bytes: u64) -> String {
    ByteSize::b(bytes).display().si().to_string()
}

/// A number of bytes, with or without a unit.
fn bytes(text: &str) -> std::result::Result<ByteSize, String> {
    let size: std::result::Result<ByteSize, _> = text.parse();
    size.ok().filter(|size| size.as_u64() > 0).ok_or_else(|| {
        "write a number of bytes above 0, such as 8GiB, 500MB or 1000000000".to_owned()
    })
}

/// `x,y,width,height` in pixels.
pub(crate) fn crop(text: &str) -> std::result::Result<Tile, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) => Ok(Tile { x, y, width, height }),
        _ => Err("write four whole numbers: x,y,width,height, such as 0,0,64,64".to_owned()),
    }
}

/// A number above 0.
pub(crate) fn above_zero(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("use a number above 0, such as 0.01".to_owned()),
    }
}

/// The arguments of a command, as the tests write them.
#[cfg(test)]
pub(crate) fn parse<A: clap::Args>(line: &str) -> std::result::Result<A, clap::Error> {
    let command = A::augment_args(clap::Command::new("command").no_binary_name(true));
    A::from_arg_matches(&command.try_get_matches_from(line.split_whitespace())?)
}
