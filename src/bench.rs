//! `bench`: times both tracers and the steps between them, after checking that all images are
//! equal.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::common::{
    SearchOptions, choice, command_words, not_negative, print, tell, to_json, whole, with_bar,
    write_text,
};
use super::input::SceneOptions;
use wavecrest_api::{self as api, session::Session};
use wavecrest_base::error::{Error, Result};
use wavecrest_base::replace::{Listed, check_differs, check_replaceable, make_folder};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_report::bench::page::{STEPS, machine, overview, page, scene, write_figures};
use wavecrest_report::bench::variant::{BATCHES, Varied};
use wavecrest_report::bench::{
    BenchPlan, BenchReport, BenchSetting, Preparation, SceneBench, TimedRender,
};
use wavecrest_report::effects::scenes::{SceneVariant, variants};
use wavecrest_report::effects::{self, EffectScene};
use wavecrest_report::measure::RoundLimits;
use wavecrest_report::page::Block;
use wavecrest_report::text::text;
use wavecrest_scene::load::{LoadOptions, load_str};

/// Time both tracers and the steps between them on each scene, after checking that all images are identical.
///
/// The exit code is 1 if images differ. With `--effects`, measure instead what each effect costs, on
/// built-in scenes that add one effect at a time.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct BenchArgs {
    /// Scenes (.json, .gltf, .glb) or meshes (.ply, .obj, .stl)
    #[arg(required_unless_present = "effects", value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,
    /// Measure what each effect costs in time and memory
    #[arg(long, conflicts_with_all = ["scenes", "compare"])]
    pub(crate) effects: bool,
    /// Greatest number of timed rounds; fewer if --min-time is reached, but at least 6
    #[arg(long, value_name = "N", default_value_t = 50,
          value_parser = whole(1..=10_000_u16))]
    pub(crate) repeats: u16,
    /// Untimed rounds at the start
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = whole(1..=10_000_u16))]
    pub(crate) warmup: u16,
    /// Least total time of the runs of each variant, up to --repeats rounds
    #[arg(long, value_name = "SECONDS", default_value = "1", value_parser = not_negative("seconds, such as 2.5"))]
    pub(crate) min_time: f64,
    /// Also compare the wavefront tracer across kernels, the steps to it across instruction sets, batch sizes,
    /// both tracers across threads, or with every pass forced on (plan); comma-separated
    #[arg(long, value_name = "WHAT", value_parser = choice::<Varied>(), value_delimiter = ',')]
    pub(crate) compare: Vec<Varied>,
    /// Compare these batch sizes, such as 16,64,1024,65536
    #[arg(long, value_name = "PATHS", value_parser = whole(1..=1_u32 << 20), value_delimiter = ',',
          conflicts_with = "effects")]
    pub(crate) batches: Vec<u32>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write JSON to this file, updated after every scene
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Write an HTML page with charts, updated after every scene
    #[arg(long, value_name = "FILE", conflicts_with = "effects")]
    pub(crate) page: Option<PathBuf>,
    /// Write each chart of the page to this folder, as SVG and CSV
    #[arg(long, value_name = "FOLDER", conflicts_with = "effects")]
    pub(crate) charts: Option<PathBuf>,
    /// Paths in a batch of the wavefront tracer
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = whole(1..=1_u32 << 20))]
    pub(crate) batch: u32,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Traversal
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

impl BenchArgs {
    /// The files to write.
    fn outputs(&self) -> impl Iterator<Item = &Path> {
        self.output.iter().chain(&self.page).map(PathBuf::as_path)
    }

    /// Number and duration of timed rounds.
    fn schedule(&self) -> RoundLimits {
        let (warmup, most) = (usize::from(self.warmup), usize::from(self.repeats));
        RoundLimits { warmup, most, seconds: self.min_time }
    }

    /// What to compare.
    fn plan(&self) -> BenchPlan {
        let mut axes = self.compare.clone();
        let named: Vec<usize> = self.batches.iter().map(|paths| *paths as usize).collect();
        if !named.is_empty() && !axes.contains(&Varied::Batches) {
            axes.push(Varied::Batches);
        }
        let batches = if named.is_empty() { BATCHES.to_vec() } else { named };
        BenchPlan { axes, batches, schedule: self.schedule() }
    }

    /// The render options with `tracer`.
    fn options(&self, tracer: TracerKind) -> RenderOptions {
        let (seed, batch) = (self.seed, self.batch as usize);
        RenderOptions { tracer, seed, batch, ..Default::default() }
    }
}

/// Measures every scene, prints the results, and returns whether all images were equal.
///
/// # Errors
/// If a scene cannot be loaded or prepared, or the report cannot be written.
pub(crate) fn run(args: &BenchArgs) -> Result<bool> {
    args.search.check(args.scene_options.precision)?;
    args.outputs().try_for_each(check_replaceable)?;
    if let (Some(output), Some(page)) = (&args.output, &args.page) {
        check_differs(page, output, "the JSON")?;
    }
    args.scene_options.threads.run(|| {
        check_scenes(args)?;
        args.charts.iter().try_for_each(|folder| make_folder(folder))?;
        if args.effects { price_effects(args) } else { run_here(args) }
    })
}

/// Refuses a scene that cannot be read, and to write over a file of a scene. The results of the first scene are
/// written before the second is read, so all are read here if a file is there to be replaced.
fn check_scenes(args: &BenchArgs) -> Result<()> {
    let old: Vec<&Path> = args.outputs().filter(|file| file.exists()).collect();
    // The first is read anyway before anything is timed or written.
    args.scenes.iter().skip(usize::from(old.is_empty())).try_for_each(|scene| {
        old.iter().try_for_each(|file| check_differs(file, scene, "the scene"))?;
        let loaded = args.scene_options.read(scene)?;
        old.iter().try_for_each(|file| loaded.check_apart(file))
    })
}

fn run_here(args: &BenchArgs) -> Result<bool> {
    let mut report = BenchReport::new(command_words().split_off(1));
    if !args.json {
        let steps = Block::Paragraph(STEPS.to_owned());
        print(&text(&[Block::Facts(machine(&report.circumstances.machine)), steps]))?;
    }
    let outcome = args.scenes.iter().try_for_each(|path| {
        let scene = bench(args, path)?;
        tell_scene(args, &report, &scene)?;
        report.scenes.push(scene);
        // After every scene, so that nothing is lost if the next one fails.
        export(args, &report)
    });
    if args.json {
        print(&to_json(&report)?)?;
    } else if report.scenes.len() > 1 {
        print(&text(&overview(&report.scenes)))?;
    }
    outcome.map(|()| report.scenes.iter().all(|scene| scene.equal))
}

/// Prepares a scene once, and measures it.
fn bench(args: &BenchArgs, path: &Path) -> Result<SceneBench> {
    let (mut scene, setting) = prepare(args, path)?;
    // The bar moves only between runs: nothing else runs while they are timed.
    with_bar(args.scene_options.quiet, RUNS, |progress| {
        SceneBench::measure(&mut scene, setting, &args.plan(), progress)
    })
}

/// The bar of runs.
const RUNS: &str = "{wide_bar} {pos} of {len} runs, {eta} left";

fn prepare(args: &BenchArgs, path: &Path) -> Result<(PreparedScene, BenchSetting)> {
    let start = Instant::now();
    // Neither tracer should wait for an image.
    let usual = args.scene_options.preparing(Some(&args.search));
    let options = api::SceneOptions { at_once: true, ..usual };
    let session = args.scene_options.session(path, &options, |_| Ok(()))?;
    let Session { scene, preset, seconds: [_, build], .. } = session;
    let time = Preparation { load: start.elapsed().as_secs_f64() - build, build };
    let batch = args.batch as usize;
    let name = path.display().to_string();
    let SearchOptions { simd, kernel } = args.search;
    let seed = args.seed;
    let precision = args.scene_options.precision;
    let setting = BenchSetting { scene: name, seed, batch, simd, kernel, precision, preset, time };
    Ok((scene, setting))
}

fn tell_scene(args: &BenchArgs, report: &BenchReport, found: &SceneBench) -> Result<()> {
    let name = &found.setting.scene;
    if !args.json {
        // Warnings go to standard error.
        let mut blocks = scene(found, &report.circumstances.machine);
        blocks.retain(|block| !matches!(block, Block::Warning(_)));
        print(&format!("\n{name}\n{}", text(&blocks)))?;
    }
    // Even if quiet: a wrong image must not go unnoticed.
    for different in found.comparisons.iter().filter_map(|compared| compared.difference.as_ref()) {
        tell(&format!("error: {name}: {}", different.words()));
    }
    found.warnings.iter().for_each(|warning| tell(&format!("warning: {name}: {warning}")));
    Ok(())
}

fn export(args: &BenchArgs, report: &BenchReport) -> Result<()> {
    if args.page.is_some() || args.charts.is_some() {
        let page = page(report);
        args.page.iter().try_for_each(|file| page.write(file))?;
        args.charts.iter().try_for_each(|folder| write_figures(&page, folder))?;
    }
    let Some(file) = &args.output else { return Ok(()) };
    let json = to_json(report)?;
    write_text(file, &json)
}

/// Measures every effect, prints the results, and returns whether all images were right.
fn price_effects(args: &BenchArgs) -> Result<bool> {
    let folder = tempfile::tempdir().map_err(|e| {
        Error::io("cannot create a folder for the texture", std::env::temp_dir(), e)
    })?;
    let _listed = Listed::new(folder.path());
    let variants = variants(folder.path())?.into_iter();
    let entries: Vec<EffectScene> = variants
        .map(|variant| prepare_effect(args, variant, folder.path()))
        .collect::<Result<_>>()?;
    let SearchOptions { simd, kernel } = args.search;
    let precision = args.scene_options.precision;
    let setting = effects::EffectSetting { simd, kernel, precision, batch: args.batch as usize };
    let trace = |scene: &_, tracer| TimedRender::of(scene, &args.options(tracer));
    let list = with_bar(args.scene_options.quiet, RUNS, |progress| {
        effects::measure(&entries, setting, &args.schedule(), trace, progress)
    })?;
    if let Some(differs) = &list.difference {
        tell(&format!("error: {}: the image or the ray counts are wrong", differs.label));
    }
    let json = to_json(&list)?;
    if let Some(file) = &args.output {
        write_text(file, &json)?;
    }
    print(&if args.json { json } else { effects::text(&list) })?;
    Ok(list.difference.is_none())
}

fn prepare_effect(args: &BenchArgs, variant: SceneVariant, folder: &Path) -> Result<EffectScene> {
    let (width, height) = (args.scene_options.input.width, args.scene_options.input.height);
    let options = LoadOptions { strict: true, width, height, ..LoadOptions::default() };
    // Warnings would be about built-in scenes.
    let loaded = load_str(&variant.scene.to_string(), &folder.join("effect.json"), &options)?;
    let usual = args.scene_options.preparing(Some(&args.search));
    // The same tree for all, so that no effect has a better one.
    let bvh = usual.bvh.or(Some(Preset::Medium));
    let options = api::SceneOptions { at_once: true, bvh, ..usual };
    let Session { scene, .. } = Session::of(loaded, &options, |_| Ok(()))?;
    Ok(EffectScene { variant, scene })
}
