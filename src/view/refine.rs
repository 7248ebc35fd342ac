//! What is rendered of a half in passes, and what the settings that were tried with one camera cost.

use serde_json::{Value, json};

use super::request::Half;
use wavecrest_base::words::counted;
use wavecrest_core::counters::Counters;
use wavecrest_core::render::Rendered;
use wavecrest_core::render::work::RenderWork;
use wavecrest_image::farm::Passes;
use wavecrest_report::plot::{Chart, ChartAxis, Draw, Point, Scale, Series};

/// The errors and times of the passes with one camera.
#[derive(Default)]
pub(super) struct Tried(Vec<Series>);

impl Tried {
    /// Adds a pass of a half, with its samples in words; the same again takes the place of the one before.
    pub(super) fn add(&mut self, half: &Half, words: &str, seconds: f64, error: f64) {
        let (name, label) = (half.name(), words.to_owned());
        let point = Point { x: seconds, y: error, low: error, high: error, label };
        let known = self.0.iter_mut().find(|series| series.name == name);
        match known {
            Some(Series { points, .. }) => {
                points.retain(|other| other.label != point.label);
                points.push(point);
            }
            None => self.0.push(Series { name, draw: Draw::Line, points: vec![point] }),
        }
    }

    /// The chart, wide and narrow, as elements of a page; `None` before the first pass with an error.
    pub(super) fn chart(&self) -> Option<[String; 2]> {
        let axis = |label: &str, unit: &str| ChartAxis::new(label, unit, Scale::Log);
        let chart = Chart {
            title: "Error against time".to_owned(),
            x: axis("time of the render", "s"),
            y: axis("RMSE", ""),
            series: self.0.clone(),
            ..Chart::default()
        };
        (!self.0.is_empty()).then(|| chart.elements())
    }
}

/// What is rendered of a half.
pub(super) enum HalfRender {
    /// Its look is finished.
    Look,
    /// Passes, and their work.
    Light(Box<(Passes, RenderWork)>),
}

impl HalfRender {
    pub(super) fn is_finished(&self) -> bool {
        match self {
            Self::Look => true,
            Self::Light(render) => render.0.is_finished(),
        }
    }
}

/// A number of samples in words.
pub(super) fn rays(count: u32) -> String {
    format!("{} per pixel", counted(count.into(), "ray"))
}

/// The work on a half so far.
pub(super) struct Work<'a> {
    counters: &'a Counters,
    seconds: f64,
    pass_seconds: &'a [(&'static str, f64)],
    error: Option<f64>,
}

impl<'a> Work<'a> {
    pub(super) fn of(Rendered { counters, seconds, pass_seconds, .. }: &'a Rendered) -> Self {
        Self { counters, seconds: *seconds, pass_seconds, error: None }
    }

    pub(super) fn of_passes(work: &'a RenderWork, error: Option<f64>) -> Self {
        let RenderWork { counters, seconds, pass_seconds, .. } = work;
        Self { counters, seconds: *seconds, pass_seconds, error }
    }
}

/// What a render took, for the page.
pub(super) fn figures_of(words: &str, work: &Work<'_>, moves: bool) -> Value {
    let Work { counters, seconds, pass_seconds, error } = *work;
    let (rays, all) = (counters.rays, pass_seconds.iter().map(|(_, s)| s).sum::<f64>());
    let shares = pass_seconds.iter().map(|(name, s)| (name, s / all));
    json!({
        "samples": words,
        "next": words,
        "seconds": seconds,
        "error": error,
        "rays": rays.all(),
        "rays_per_second": rays.all() as f64 / seconds,
        "passes": shares.filter(|(_, share)| *share > 0.0).collect::<Vec<_>>(),
        "counters": {"rays": rays, "samples": counters.samples, "tests": counters.tests},
        "done": 1.0,
        "rests": false,
        "moving": moves,
    })
}
