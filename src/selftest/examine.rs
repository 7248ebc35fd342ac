//! The part of `selftest` that tests a user's own scene or mesh.

use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use wavecrest_api::SceneOptions;
use wavecrest_api::session::Session;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::PrimitiveCounts;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::plan::schedule::UNPLANNED;
use wavecrest_core::render::{RenderOptions, TracerKind, render};
use wavecrest_report::selftest::agreement::agreement;
use wavecrest_report::selftest::examine::{GeometryFacts, SceneTrial, shape, trial};
use wavecrest_report::selftest::{Effort, Outcome};
use wavecrest_scene::load::LoadOptions;
use wavecrest_scene::mesh;

/// The longer side in pixels of the image that is searched for samples that are not finite.
const IMAGE_SIDE: u32 = 128;

/// The outcome for a scene.
#[derive(Serialize)]
pub(super) struct Examined {
    file: String,
    shape: GeometryFacts,
    trials: Vec<Tried>,
}

/// The outcome in a precision.
#[derive(Serialize)]
struct Tried {
    precision: Precision,
    #[serde(flatten)]
    trial: SceneTrial,
    /// The hits of every kernel, compared with those of the reference; `None` for fast precision.
    #[serde(skip_serializing_if = "Option::is_none")]
    agreement: Option<Outcome>,
    /// Samples of a small image that are not finite, in either tracer; `None` for a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    invalid: Option<u64>,
}

impl Examined {
    /// Whether there is no failure, except in fast precision.
    pub(super) fn holds(&self) -> bool {
        self.trials.iter().filter(|tried| tried.precision != Precision::Fast).all(|tried| {
            let SceneTrial { leaks, self_hits, .. } = &tried.trial;
            let differing = tried.agreement.as_ref().map_or(0, |outcome| outcome.failed);
            leaks.failed + self_hits.failed + differing + tried.invalid.unwrap_or(0) == 0
        })
    }

    /// In words.
    pub(super) fn text(&self) -> String {
        let mut text = format!("{}: {}", self.file, self.described());
        self.trials.iter().for_each(|tried| text += &tried.text());
        text
    }

    /// The shapes in words.
    fn described(&self) -> String {
        let PrimitiveCounts { triangles, quads, spheres, disks } = self.shape.shapes;
        let GeometryFacts { instanced, dropped, .. } = self.shape;
        let counts = [
            (triangles, "triangles"),
            (quads, "quads"),
            (spheres, "spheres"),
            (disks, "disks"),
            (instanced, "triangles of instances"),
        ];
        let there = counts.iter().filter(|(count, _)| *count > 0);
        let there: Vec<String> = there.map(|(count, name)| format!("{count} {name}")).collect();
        let mut text = there.join(", ");
        if text.is_empty() {
            text += "no shapes, so no rays to test";
        }
        text.push('\n');
        if triangles + quads > 0 {
            let _ = writeln!(text, "  {dropped} degenerate triangles left out");
        }
        text
    }
}

impl Tried {
    /// In words.
    fn text(&self) -> String {
        let Self { precision, trial, agreement, invalid } = self;
        let SceneTrial { leaks, self_hits, errors } = trial;
        let mut text = format!("    {:<7}", precision.name());
        if self_hits.tried > 0 {
            let _ = write!(
                text,
                "{} of {} rays leak, {} of {} hit their own shape",
                leaks.failed, leaks.tried, self_hits.failed, self_hits.tried,
            );
        }
        if let Some(invalid) = invalid {
            let separator = if self_hits.tried > 0 { ", " } else { "" };
            let _ = write!(text, "{separator}{invalid} samples are not finite");
        }
        text.push('\n');
        if errors.hits > 0 {
            let _ = writeln!(text, "      {}", errors.words());
        }
        let agreement = agreement.as_ref().filter(|outcome| outcome.tried > 0);
        if let Some(Outcome { tried, failed, .. }) = agreement {
            let _ = writeln!(
                text,
                "      {failed} of {tried} answers at edges and vertices differ from the reference's"
            );
        }
        // Failures of fast precision are expected.
        let first = agreement.and_then(|outcome| outcome.first.as_ref());
        let failures =
            [leaks.first.as_ref(), self_hits.first.as_ref(), first].into_iter().flatten();
        for first in failures.filter(|_| *precision != Precision::Fast) {
            let _ = writeln!(text, "      the first: {first}");
        }
        text
    }
}

/// Tests the scene or mesh in `file`.
pub(super) fn run(file: &Path, efforts: &[Effort]) -> Result<Examined> {
    let mut examined: Option<Examined> = None;
    for effort in efforts {
        let precision = effort.precision;
        let (accel, invalid) = match mesh::is_mesh_name(file) {
            true => (of_mesh(file, precision)?, None),
            false => of_scene(file, effort).map(|(accel, invalid)| (accel, Some(invalid)))?,
        };
        let trial = trial(&accel, effort);
        let examined = examined.get_or_insert_with(|| Examined {
            file: file.display().to_string(),
            shape: shape(&accel),
            trials: Vec::new(),
        });
        let agreement = (precision == Precision::Exact).then(|| agreement(accel, effort));
        examined.trials.push(Tried { precision, trial, agreement, invalid });
    }
    examined.ok_or_else(|| Error::new(ErrorKind::Usage, "no precision is named"))
}

fn of_mesh(file: &Path, precision: Precision) -> Result<Accel> {
    let data = mesh::load(file)?.mesh;
    let (positions, triangles) = (data.positions, data.triangles);
    let geometry = Geometry { positions, triangles, precision, ..Geometry::default() };
    Ok(Accel::new(geometry, Preset::VeryFast))
}

/// A prepared scene, and its number of samples that are not finite.
fn of_scene(file: &Path, effort: &Effort) -> Result<(Accel, u64)> {
    let Effort { precision, seed, .. } = *effort;
    let options =
        LoadOptions { width: Some(IMAGE_SIDE), height: Some(IMAGE_SIDE), ..LoadOptions::default() };
    // Its rays come from anywhere, and not from the camera alone.
    let all = SceneOptions { precision, passes: &UNPLANNED, ..SceneOptions::default() };
    let Session { scene, .. } = Session::open(file, &options, &all)?;
    let mut invalid = 0;
    for tracer in [TracerKind::Wavefront, TracerKind::Recursive] {
        let options = RenderOptions { tracer, seed, ..RenderOptions::default() };
        invalid += render(&scene, &options, &())?.counters.invalid;
    }
    Ok((scene.accel, invalid))
}
