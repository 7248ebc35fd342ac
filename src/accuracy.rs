//! `accuracy`: sweeps and reports error against time.

use std::path::{Path, PathBuf};

use super::common::{Threads, above_zero, command_words, print, progress_bar, whole};
use wavecrest_base::error::Result;
use wavecrest_report::accuracy::pilot::target;
use wavecrest_report::accuracy::report::ERRORS;
use wavecrest_report::accuracy::store::{Record, Store, SweepHeader};
use wavecrest_report::accuracy::{AccuracyReport, SweepProgress, page, sweep};
use wavecrest_report::bench::Circumstances;
use wavecrest_report::text::text;
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::extract;

/// The template of the progress bar.
const PROGRESS: &str = "{msg} {wide_bar} {percent}%, {eta} left";

/// Measure error against time for every sampler, sample count and precision.
///
/// Results are saved as they come; repeat the command to resume an interrupted sweep.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct AccuracyArgs {
    /// Scenes
    #[arg(required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    /// Folder for results and report
    #[arg(short, long, value_name = "FOLDER", required_unless_present = "advise")]
    pub(crate) output: Option<PathBuf>,
    /// Only estimate, from a short pilot render, how many points each sampler needs for --target-error and which is
    /// fastest
    #[arg(long, requires = "target_error", conflicts_with = "output")]
    pub(crate) advise: bool,
    /// Error to advise on (RMSE of linear values)
    #[arg(long, value_name = "ERROR", value_parser = above_zero, requires = "advise")]
    pub(crate) target_error: Option<f64>,
    /// Greatest image side, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 160, value_parser = whole(1..=65536_u32))]
    pub(crate) side_pixels: u32,
    /// Errors whose cost to report, comma-separated
    #[arg(long, value_name = "ERRORS", value_parser = above_zero, value_delimiter = ',', default_values_t = ERRORS)]
    pub(crate) errors: Vec<f64>,
    /// Renders of each setting, with different seeds [default: 8, or 16 with --full]
    #[arg(long, value_name = "N", value_parser = whole(2..=4096_u32))]
    pub(crate) seeds: Option<u32>,
    /// Greatest number of points on a light, on the lens or in a pixel [default: 256, or 2025 with --full]
    #[arg(long, value_name = "N", value_parser = whole(1..=65536_u32))]
    pub(crate) most: Option<u32>,
    /// Least number of points of each kind in a reference render [default: 1024, or 5041 with --full]
    #[arg(long, value_name = "N", value_parser = whole(1..=1_u32 << 20))]
    pub(crate) reference: Option<u32>,
    /// More points, seeds and a better reference: for results to keep
    #[arg(long)]
    pub(crate) full: bool,
    /// Accepted for older commands: `bench --effects` measures what each effect costs
    #[arg(long, hide = true)]
    pub(crate) no_effects: bool,
    /// Threads
    #[command(flatten)]
    pub(crate) threads: Threads,
    /// Print no progress and no results
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Runs the sweep, or advises.
///
/// # Errors
/// If a scene cannot be rendered, the folder has the results of another sweep, or results cannot be
/// read or written.
pub(crate) fn run(args: &AccuracyArgs) -> Result<()> {
    args.threads.run(|| {
        // A scene that cannot be read is an error now, not after those before it.
        let options = LoadOptions::default();
        args.scenes.iter().try_for_each(|scene| load(scene, &options).map(drop))?;
        match (&args.output, args.target_error) {
            (Some(folder), _) => run_sweep(args, folder),
            (None, error) => advise(args, error.unwrap_or_default()),
        }
    })
}

/// Prints the cost of an error with each sampler.
fn advise(args: &AccuracyArgs, error: f64) -> Result<()> {
    for file in &args.scenes {
        let loaded = load(file, &LoadOptions::default())?;
        let extracted = extract(loaded.world, Default::default())?;
        let preset = extracted.preset().at_once();
        let mut scene = extracted.build(preset);
        let advice = target::advise(&mut scene, error, 0)?;
        let best = advice.iter().min_by(|a, b| a.seconds().total_cmp(&b.seconds()));
        let best = best.map(|advice| advice.choice);
        let mut text = format!("{}\n", file.display());
        for advice in &advice {
            let mark = if best == Some(advice.choice) { '*' } else { ' ' };
            text += &format!("{mark} {advice}\n");
        }
        print(&text)?;
    }
    Ok(())
}

/// The extent of a sweep by default, and with `--full`: seeds, points, and points of a reference.
const EXTENTS: [[u32; 3]; 2] = [[8, 256, 1024], [16, 2025, 5041]];

fn run_sweep(args: &AccuracyArgs, folder: &Path) -> Result<()> {
    let [seeds, most, reference] = EXTENTS[usize::from(args.full)];
    let seeds = args.seeds.unwrap_or(seeds);
    let header = SweepHeader {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        longest: args.side_pixels,
        most: args.most.unwrap_or(most),
        least: args.reference.unwrap_or(reference),
    };
    let mut store = Store::open(folder, &header)?;
    store.add(Record::Circumstances(Circumstances::here(command_words())))?;
    let bar = progress_bar(args.quiet, PROGRESS);
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    let mut swept = sweep::run(&args.scenes, seeds, &mut store, &|progress| match progress {
        SweepProgress::More(work) => bar.inc_length(work),
        SweepProgress::Stage(name) => bar.set_message(name.to_owned()),
        SweepProgress::Step(work) => bar.inc(work),
    })?;
    bar.finish_and_clear();
    let findings = AccuracyReport::new(seeds, &store, &swept, &args.errors);
    page::write(&findings, &mut swept, folder)?;
    if !args.quiet {
        print(&text(&page::summary(&findings)))?;
        print(&format!("{}\n", folder.join("report.html").display()))?;
    }
    Ok(())
}
