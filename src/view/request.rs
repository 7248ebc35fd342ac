//! What the page asks for, in JSON.

use serde::{Deserialize, Serialize};

use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::render::TracerKind;
use wavecrest_image::look::Look;
use wavecrest_image::write::{Develop, Transfer};
use wavecrest_scene::load::framing::Up;

/// The largest side of a grid of points.
const MOST_SIDE: u32 = 64;

/// A request. Places and movements are in shares of the image: places from its top left, movements of its height.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
pub(super) enum Request {
    /// The pointer takes hold of what is at a place.
    Grab { at: [f64; 2] },
    /// A turn around it.
    Orbit { by: [f64; 2] },
    /// A turn of the camera in its place.
    Turn { by: [f64; 2] },
    /// A movement across the image.
    Pan { by: [f64; 2] },
    /// A movement towards what is at a place, in notches of a wheel.
    Zoom { at: [f64; 2], by: f64 },
    /// Steps to the right, upward and ahead: 1 is what a second of walking covers.
    Walk { by: [f64; 3] },
    /// A view from a named side.
    Side { side: String },
    /// One way to render the image, or two to compare.
    Set { halves: Vec<Half> },
    /// What is shown of the file.
    Show(Shown),
    /// The hits of the rays at a place.
    Probe { at: [f64; 2] },
    /// An image has been drawn, or a part of one has arrived: so many seconds ago if it was drawn.
    Taken {
        #[serde(default)]
        drawing: f64,
    },
}

/// What is shown of the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Shown {
    /// Width and height of the image, in pixels.
    pub(super) size: [u32; 2],
    /// What the image shows instead of light.
    pub(super) look: Option<Look>,
    /// The up axis; `None` for the usual one.
    pub(super) up: Option<Up>,
    /// Whether added lights stay where they are for the usual view.
    pub(super) stays: bool,
    /// In stops: each doubles the light.
    pub(super) exposure: f32,
    /// The transfer curve; `None` for that of the file.
    pub(super) transfer: Option<Transfer>,
}

impl Shown {
    /// Whether it is a valid choice.
    pub(super) fn is_valid(&self) -> bool {
        self.size.iter().all(|side| *side > 0) && self.exposure.abs() <= Develop::MOST_STOPS
    }

    /// Whether it shows light.
    pub(super) fn is_lit(&self) -> bool {
        self.look.is_none_or(Look::is_shaded)
    }

    /// How light is developed.
    pub(super) fn develop(&self) -> Develop {
        Develop { exposure: if self.is_lit() { self.exposure } else { 0.0 }, ..Develop::default() }
    }
}

/// One way to render the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Half {
    /// The distribution of the points; `None` for the samples of the file.
    pub(super) sampler: Option<Sampling>,
    /// The side of their grid.
    side: u32,
    pub(super) precision: Precision,
    pub(super) tracer: TracerKind,
}

impl Half {
    /// As the file and the command say, with so many rays a pixel: in a sequence, whose passes tell their error.
    pub(super) fn of_file(precision: Precision, tracer: TracerKind, rays: u32) -> Self {
        let side = (1..MOST_SIDE).find(|side| side * side >= rays).unwrap_or(MOST_SIDE);
        Self { sampler: (side > 1).then_some(Sampling::Sobol), side, precision, tracer }
    }

    /// The camera of the file with its samples: each has one point on the lens.
    pub(super) fn camera(&self, own: &Camera) -> Camera {
        let Some(mut points) = self.points() else { return *own };
        // As the reader of a scene file has it.
        if own.has_lens() && points.sampling == Sampling::Random {
            points.sampling = Sampling::Jittered;
        }
        own.resampled(Some(points), Some(Points { side: 1, ..points }))
    }

    /// The number of samples after the next pass beyond `samples`, of `all`: of a sequence twice as many, of others all.
    pub(super) fn next_pass(&self, samples: u32, all: u32) -> u32 {
        let is_sequence = self.sampler == Some(Sampling::Sobol);
        if is_sequence { (2 * samples).clamp(1, all) } else { all }
    }

    /// The points that are asked for, unless they are those of the file.
    pub(super) fn points(&self) -> Option<Points> {
        let side = self.side.clamp(1, MOST_SIDE);
        self.sampler.map(|sampling| Points { sampling, side })
    }

    /// The options in which it differs from a render without any, with their values.
    pub(super) fn differs(&self) -> impl Iterator<Item = [&'static str; 2]> {
        let (precision, tracer) = (self.precision, self.tracer);
        let differs = [
            (precision != Precision::default()).then(|| ["--precision", precision.name()]),
            (tracer != TracerKind::default()).then(|| ["--tracer", tracer.name()]),
        ];
        differs.into_iter().flatten()
    }

    /// The words of its line in the chart.
    pub(super) fn name(&self) -> String {
        let sampler = self.sampler.map_or("of the file", Sampling::name).to_owned();
        self.differs().fold(sampler, |name, [_, value]| name + ", " + value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<Request> {
        serde_json::from_str(text).ok()
    }

    #[test]
    fn requests_are_read_and_others_refused() {
        assert_eq!(read(r#"{"do":"taken"}"#), Some(Request::Taken { drawing: 0.0 }));
        let depth = r#"{"size":[4,3],"look":"depth","up":"-z","stays":true,"exposure":1.5,"transfer":null}"#;
        let Some(Request::Show(shown)) = read(&depth.replacen('{', r#"{"do":"show","#, 1)) else {
            panic!("not read");
        };
        assert!(shown.is_valid() && shown.look == Some(Look::Depth));
        assert_eq!(serde_json::to_string(&shown).unwrap(), depth);
        let half = r#"{"sampler":"sobol","side":900,"precision":"fast","tracer":"recursive"}"#;
        let Some(Request::Set { halves }) = read(&format!(r#"{{"do":"set","halves":[{half}]}}"#))
        else {
            panic!("not read");
        };
        assert_eq!(halves[0].points(), Some(Points { sampling: Sampling::Sobol, side: MOST_SIDE }));
        assert_eq!(halves[0].name(), "sobol, fast, recursive");
        assert_eq!(serde_json::to_string(&halves[0]).unwrap(), half);
        for wrong in [
            "",
            "null",
            "[]",
            r#"{"do":"exit"}"#,
            r#"{"do":"orbit","by":[1]}"#,
            r#"{"do":"orbit","by":["1",2]}"#,
            &depth.replacen('{', r#"{"do":"show","#, 1).replace("depth", "elsewhere"),
            r#"{"do":"side","side":7}"#,
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
