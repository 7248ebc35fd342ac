//! `accuracy`: sweeps and reports error against time.

use std::path::PathBuf;

use super::common::{Threads, above_zero, command_words, print, progress_bar};
use wavecrest_base::error::Result;
use wavecrest_report::accuracy::report::ERRORS;
use wavecrest_report::accuracy::store::{Record, Store, SweepHeader};
use wavecrest_report::accuracy::{AccuracyReport, SweepProgress, page, sweep};
use wavecrest_report::bench::Circumstances;
use wavecrest_report::text::text;
use wavecrest_scene::load::{LoadOptions, load};

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
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Errors whose cost to report, comma-separated
    #[arg(long, value_name = "ERRORS", value_parser = above_zero, value_delimiter = ',', default_values_t = ERRORS)]
    pub(crate) errors: Vec<f64>,
    /// More points, seeds and a better reference, for results to keep: up to 2025 points on a light, on the lens or in a
    /// pixel instead of 256, and 16 seeds instead of 8
    #[arg(long)]
    pub(crate) full: bool,
    /// Threads
    #[command(flatten)]
    pub(crate) threads: Threads,
    /// Print no progress and no results
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Runs the sweep.
///
/// # Errors
/// If a scene cannot be rendered, the folder has the results of another sweep, or results cannot be
/// read or written.
pub(crate) fn run(args: &AccuracyArgs) -> Result<()> {
    args.threads.run(|| {
        // A scene that cannot be read is an error now, not after those before it.
        let options = LoadOptions::default();
        args.scenes.iter().try_for_each(|scene| load(scene, &options).map(drop))?;
        run_sweep(args)
    })
}

/// Largest length of the longer side of images in pixels.
const LONGEST: u32 = 160;

/// The extent of a sweep by default, and with `--full`: seeds, points, and points of a reference.
const EXTENTS: [[u32; 3]; 2] = [[8, 256, 1024], [16, 2025, 5041]];

fn run_sweep(args: &AccuracyArgs) -> Result<()> {
    let (folder, [seeds, most, least]) = (&args.output, EXTENTS[usize::from(args.full)]);
    let header = SweepHeader {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        longest: LONGEST,
        most,
        least,
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
