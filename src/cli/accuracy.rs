//! `accuracy`: error against time, swept and reported.

use std::cell::RefCell;
use std::path::PathBuf;

use indicatif::ProgressBar;

use super::common::{Threads, print, progress_bar};
use crate::accuracy::Findings;
use crate::accuracy::store::{Circumstances, Header, Record, Store};
use crate::accuracy::sweep::{Options, Progress, run as sweep};
use crate::error::Result;

/// What the progress bar shows.
const PROGRESS: &str = "{msg} {wide_bar} {pos}/{len}, {eta} left";

/// Sweeps what may move the error of a scene's picture, and what must not, and reports error against time.
///
/// Results are written as they come: the same command goes on where it was interrupted.
#[derive(Clone, Debug, clap::Args)]
pub struct AccuracyArgs {
    /// The scenes, in JSON
    #[arg(required = true)]
    pub scenes: Vec<PathBuf>,
    /// The folder for results and report
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
    /// The longer side of images, at most, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 160, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub longest: u32,
    /// Renders of each setting, with random numbers of their own
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(2..=4096))]
    pub seeds: u32,
    /// The most points of a kind, on a light, the lens or in a pixel
    #[arg(long, value_name = "N", default_value_t = 2025, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub most: u32,
    /// The fewest points in each render of the reference
    #[arg(long, value_name = "N", default_value_t = 5041, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub reference: u32,
    /// On how many threads
    #[command(flatten)]
    pub threads: Threads,
    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Shows a sweep's progress as a bar.
struct Shown {
    bar: RefCell<ProgressBar>,
    quiet: bool,
}

impl Progress for Shown {
    fn stage(&self, name: &str, steps: u64) {
        self.bar.borrow().finish_and_clear();
        let bar = progress_bar(self.quiet, PROGRESS);
        bar.set_length(steps);
        bar.set_message(name.to_owned());
        self.bar.replace(bar);
    }

    fn step(&self) {
        self.bar.borrow().inc(1);
    }
}

/// Sweeps as the arguments say, and returns whether what must not change a picture did not.
///
/// # Errors
/// When a scene cannot be rendered, the folder has the results of another sweep, or results cannot be
/// written.
pub fn run(args: &AccuracyArgs) -> Result<bool> {
    args.threads.run(|| {
        let options = Options {
            longest: args.longest,
            seeds: args.seeds,
            most: args.most,
            least: args.reference,
        };
        let mut store = Store::open(&args.output, &Header::new(&options))?;
        store.add(Record::Circumstances(Circumstances::here()))?;
        let shown = Shown { bar: RefCell::new(ProgressBar::hidden()), quiet: args.quiet };
        let swept = sweep(&args.scenes, &options, &mut store, &shown)?;
        shown.bar.borrow().finish_and_clear();
        let findings = Findings::new(&options, &store, &swept);
        findings.write(&args.output)?;
        if !args.quiet {
            print(&text(&findings))?;
            print(&format!("{}\n", args.output.join("accuracy.json").display()))?;
        }
        Ok(findings
            .scenes
            .iter()
            .flat_map(|s| &s.neutral)
            .all(|n| n.equal && n.error_change == 0.0))
    })
}

/// The slopes, in words.
fn text(findings: &Findings) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    for scene in &findings.scenes {
        let _ = writeln!(text, "{}", scene.scene.scene);
        for family in &scene.families {
            for series in &family.series {
                let Some(slope) = series.slope else { continue };
                let _ = writeln!(
                    text,
                    "  {:<24}{:<10}MSE falls with the power {:.3} ({:.3} to {:.3})",
                    family.counted, series.name, slope.value, slope.low, slope.high
                );
            }
        }
        let wrong = scene.neutral.iter().filter(|n| !n.equal || n.error_change != 0.0).count();
        let all = scene.neutral.len();
        let _ = writeln!(text, "  {} of {all} choices that must not matter do not", all - wrong);
    }
    text
}
