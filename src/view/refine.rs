//! The renders that an image at rest goes through, each with more samples than the one before, and what they cost.

use wavecrest_base::words::counted;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{PreparedScene, Samples};
use wavecrest_report::accuracy::pilot::MeasuredError;
use wavecrest_report::accuracy::setting::{Axis, Facts};
use wavecrest_report::plot::{Chart, ChartAxis, Draw, Point, Scale, Series};

use super::request::Half;

/// One render.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Refinement {
    pub(super) samples: Samples,
    /// The samples in words.
    pub(super) words: String,
    /// Whether renders show its error: those with one ray through the centre of each pixel agree in what they miss.
    pub(super) is_measured: bool,
}

/// The samples of a scene's file, from which the renders before the last follow.
pub(super) struct OwnSamples {
    axis: Axis,
    sampling: Sampling,
    /// The number of points along the axis.
    count: u32,
    /// Rays for each pixel.
    rays: u32,
}

impl OwnSamples {
    /// Those of a scene as it was prepared, with the sampling of its pixels.
    pub(super) fn of(scene: &PreparedScene, sampling: Sampling) -> Self {
        let axis = Axis::of(&Facts::of(scene));
        let (rays, antialias) = (scene.camera.rays_per_pixel(), scene.camera.antialias());
        let of_lights = || scene.lights.iter().filter(|light| light.is_sampled());
        let (sampling, count) = match axis {
            Axis::Pixel(_) => (sampling, antialias * antialias),
            Axis::Lens(_) => (Sampling::Jittered, rays),
            Axis::Lights(_) => (
                of_lights().next().map_or(sampling, |light| light.sampling),
                of_lights().map(|light| light.samples()).max().unwrap_or(1),
            ),
        };
        Self { axis, sampling, count, rays }
    }

    /// The renders of a half: twice the side of the grid each time, and what it asks for as the last.
    pub(super) fn refinements(&self, half: &Half) -> Vec<Refinement> {
        let along = |points: Points| Refinement {
            samples: self.axis.samples(points),
            words: self.axis.counted(points),
            is_measured: points.side > 1 || !matches!(self.axis, Axis::Pixel(_)),
        };
        let (sampling, count, last) = match half.points() {
            Some(points) => (points.sampling, points.count(), along(points)),
            None => {
                let words = format!("the file's {} per pixel", counted(self.rays.into(), "ray"));
                let last = Refinement { samples: Samples::default(), words, is_measured: true };
                (self.sampling, self.count, last)
            }
        };
        let sides = (0..).map(|power| 1_u32 << power).take_while(|side| side * side < count);
        sides.map(|side| along(Points { sampling, side })).chain([last]).collect()
    }
}

/// One ray through the centre of each pixel, and one point on whatever else has several.
pub(super) fn fewest() -> Refinement {
    let one = Some(Points { sampling: Sampling::Jittered, side: 1 });
    let samples = Samples { lights: one, lens: one, pixel: one };
    Refinement { samples, words: "1 ray per pixel".to_owned(), is_measured: false }
}

/// The errors and times of the settings that were tried with one camera.
#[derive(Default)]
pub(super) struct Tried(Vec<Series>);

impl Tried {
    /// Adds a render of a half; the same again takes the place of the one before.
    pub(super) fn add(&mut self, half: &Half, words: &str, seconds: f64, error: MeasuredError) {
        let (name, MeasuredError { error, at_most, .. }) = (half.name(), error);
        let label = words.to_owned();
        let point = Point { x: seconds, y: error, low: error, high: at_most, label };
        let known = self.0.iter_mut().find(|series| series.name == name);
        match known {
            Some(Series { points, .. }) => {
                points.retain(|other| other.label != point.label);
                points.push(point);
            }
            None => self.0.push(Series { name, draw: Draw::Line, points: vec![point] }),
        }
    }

    /// The chart, wide and narrow, as elements of a page; `None` before the first render.
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
