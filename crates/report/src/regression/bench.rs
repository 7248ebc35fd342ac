//! Compares two reports of `bench`: the time of each tracer and of each variant, on each scene.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::{Change, Estimate, Found, Regression, Side};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The parts of a report in use: see [`crate::bench`].
#[derive(Deserialize)]
struct Report {
    version: String,
    commit: Option<String>,
    machine: Value,
    scenes: Vec<Scene>,
}

#[derive(Deserialize)]
struct Scene {
    scene: String,
    image: Value,
    equal: bool,
    rays: Value,
    comparisons: Vec<Comparison>,
}

#[derive(Deserialize)]
struct Comparison {
    of: String,
    variants: Vec<Timed>,
}

#[derive(Deserialize)]
struct Timed {
    label: String,
    seconds: Seconds,
    yardstick: f64,
}

impl Timed {
    /// The times to compare, in seconds or in yardsticks.
    fn times(&self, in_yardsticks: bool) -> Vec<f64> {
        let unit = if in_yardsticks { self.yardstick } else { 1.0 };
        self.seconds.each.iter().map(|seconds| seconds / unit).collect()
    }
}

#[derive(Deserialize)]
struct Seconds {
    each: Vec<f64>,
}

/// Compares two reports.
///
/// # Errors
/// If one of them cannot be read.
pub fn compare(before: &Path, after: &Path) -> Result<Regression> {
    let sides = [read(before)?, read(after)?];
    let mut regression = Regression {
        before: side(before, &sides[0]),
        after: side(after, &sides[1]),
        ..Regression::default()
    };
    let same_machine = sides[0].machine == sides[1].machine;
    let mut found = Vec::new();
    for scene in &sides[0].scenes {
        let name = &scene.scene;
        match sides[1].scenes.iter().find(|other| other.scene == *name) {
            None => regression.warnings.push(format!("`{name}` is missing after")),
            Some(other) if other.image != scene.image => {
                regression.warnings.push(format!("`{name}` differs in size or samples"));
            }
            Some(other) => {
                if other.rays != scene.rays {
                    regression.warnings.push(format!("`{name}` casts a different number of rays"));
                }
                found.extend(times(scene, other, same_machine));
                regression.changes.extend(equality(scene, other));
            }
        }
    }
    Ok(regression.judged(found))
}

fn read(path: &Path) -> Result<Report> {
    let text =
        std::fs::read_to_string(path).map_err(|e| Error::io("cannot read the report", path, e))?;
    serde_json::from_str(&text).map_err(|e| {
        Error::new(ErrorKind::Syntax, format!("this is not a report of `bench`: {e}"))
            .in_file(path)
            .remedy("use a file that `bench --output` wrote")
    })
}

fn side(path: &Path, report: &Report) -> Side {
    let path = path.display().to_string();
    let (version, commit) = (report.version.clone(), report.commit.clone());
    Side { path, version, commit, machine: report.machine.clone() }
}

/// All timings of a scene, by name.
fn timed(scene: &Scene) -> Vec<(String, &Timed)> {
    let mut all = Vec::new();
    for Comparison { of, variants } in &scene.comparisons {
        let of = if of == "ladder" { String::new() } else { format!("{of}: ") };
        all.extend(variants.iter().map(|timed| (format!("{of}{}", timed.label), timed)));
    }
    all
}

/// On one machine the unit is a [yardstick](crate::yardstick) measured at the same time.
fn times(before: &Scene, after: &Scene, same_machine: bool) -> Vec<Found> {
    let others = timed(after);
    let one = |(what, before): (String, &Timed)| {
        let (_, after) = others.iter().find(|(name, _)| *name == what)?;
        let in_yardsticks = same_machine && before.yardstick.min(after.yardstick) > 0.0;
        let [before, after] = [before, *after].map(|timed| timed.times(in_yardsticks));
        Some((what, Estimate::of_times(&before, &after)?))
    };
    let found = timed(before).into_iter().filter_map(one);
    found.map(|(what, estimate)| Found::new(&before.scene, what, "time", estimate)).collect()
}

/// Whether the images are still equal.
fn equality(before: &Scene, after: &Scene) -> Option<Change> {
    let words = [before, after].map(|s| if s.equal { "equal" } else { "different" }.to_owned());
    let what = "the images of all variants".to_owned();
    (before.equal != after.equal).then(|| Change::new(&before.scene, what, words, before.equal))
}
