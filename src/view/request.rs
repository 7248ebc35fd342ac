//! What the page asks for, in JSON.

use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};

use wavecrest_base::choice::Choice;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::render::TracerKind;
use wavecrest_image::look::Look;

/// The name of the samples that the file has.
const OF_FILE: &str = "file";
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
    /// What the image shows instead of light.
    Look {
        #[serde(deserialize_with = "look")]
        look: Option<Look>,
    },
    /// The hits of the rays at a place.
    Probe { at: [f64; 2] },
    /// The last image has been drawn.
    Taken,
}

impl Request {
    /// Adds a movement of the same kind that follows; false if it is of another.
    pub(super) fn absorb(&mut self, next: &Self) -> bool {
        match (self, next) {
            (Self::Orbit { by }, Self::Orbit { by: more })
            | (Self::Pan { by }, Self::Pan { by: more }) => add(by, more),
            (Self::Walk { by }, Self::Walk { by: more }) => add(by, more),
            (Self::Zoom { at, by }, Self::Zoom { at: place, by: more }) => {
                *at = *place;
                *by += more;
            }
            _ => return false,
        }
        true
    }
}

fn add<const N: usize>(sum: &mut [f64; N], more: &[f64; N]) {
    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}

/// One way to render the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(super) struct Half {
    /// The distribution of the points; `None` for the samples of the file.
    #[serde(deserialize_with = "sampler")]
    pub(super) sampler: Option<Sampling>,
    /// The side of their grid.
    side: u32,
    #[serde(deserialize_with = "choice")]
    pub(super) precision: Precision,
    #[serde(deserialize_with = "choice")]
    pub(super) tracer: TracerKind,
}

impl Half {
    /// As the file and the command say.
    pub(super) fn of_file(precision: Precision, tracer: TracerKind) -> Self {
        Self { sampler: None, side: 1, precision, tracer }
    }

    /// The points that are asked for, unless they are those of the file.
    pub(super) fn points(&self) -> Option<Points> {
        let side = self.side.clamp(1, MOST_SIDE);
        self.sampler.map(|sampling| Points { sampling, side })
    }

    /// The words of its line in the chart.
    pub(super) fn name(&self) -> String {
        let sampler = self.sampler.map_or("of the file", Sampling::name);
        let differs = [
            (self.precision != Precision::default()).then(|| self.precision.name()),
            (self.tracer != TracerKind::default()).then(|| self.tracer.name()),
        ];
        differs.into_iter().flatten().fold(sampler.to_owned(), |name, word| name + ", " + word)
    }

    pub(super) fn json(&self) -> Value {
        let sampler = self.sampler.map_or(OF_FILE, Sampling::name);
        json!({
            "sampler": sampler,
            "side": self.side,
            "precision": self.precision.name(),
            "tracer": self.tracer.name(),
        })
    }
}

/// The names of samplers.
pub(super) fn samplers() -> Vec<&'static str> {
    std::iter::once(OF_FILE).chain(Sampling::ALL.map(Sampling::name)).collect()
}

/// A value by its name.
fn choice<'de, T: Choice, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    named(&String::deserialize(from)?)
}

fn sampler<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Sampling>, D::Error> {
    let name = String::deserialize(from)?;
    if name == OF_FILE { Ok(None) } else { named(&name).map(Some) }
}

fn look<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Look>, D::Error> {
    Option::<String>::deserialize(from)?.map(|name| named(&name)).transpose()
}

fn named<T: Choice, E: serde::de::Error>(name: &str) -> Result<T, E> {
    T::by_name(name).ok_or_else(|| E::custom("not one of the possible values"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<Request> {
        serde_json::from_str(text).ok()
    }

    #[test]
    fn requests_are_read_and_others_refused() {
        assert_eq!(read(r#"{"do":"taken"}"#), Some(Request::Taken));
        assert_eq!(read(r#"{"do":"look","look":null}"#), Some(Request::Look { look: None }));
        let depth = Some(Request::Look { look: Some(Look::Depth) });
        assert_eq!(read(r#"{"do":"look","look":"depth"}"#), depth);
        let half = r#"{"sampler":"sobol","side":900,"precision":"fast","tracer":"recursive"}"#;
        let Some(Request::Set { halves }) = read(&format!(r#"{{"do":"set","halves":[{half}]}}"#))
        else {
            panic!("not read");
        };
        assert_eq!(halves[0].points(), Some(Points { sampling: Sampling::Sobol, side: MOST_SIDE }));
        assert_eq!(halves[0].name(), "sobol, fast, recursive");
        let again: Half = serde_json::from_value(halves[0].json()).unwrap();
        assert_eq!(again, halves[0]);
        for wrong in [
            "",
            "null",
            "[]",
            r#"{"do":"exit"}"#,
            r#"{"do":"orbit","by":[1]}"#,
            r#"{"do":"orbit","by":["1",2]}"#,
            r#"{"do":"look","look":"elsewhere"}"#,
            r#"{"do":"side","side":7}"#,
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn movements_of_a_kind_add_up() {
        let mut first = Request::Orbit { by: [0.25, 0.5] };
        assert!(first.absorb(&Request::Orbit { by: [0.5, -1.0] }));
        assert_eq!(first, Request::Orbit { by: [0.75, -0.5] });
        assert!(!first.absorb(&Request::Pan { by: [0.5, -1.0] }));
        assert!(!first.absorb(&Request::Taken));
    }
}
