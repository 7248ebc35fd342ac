//! Advice on samples for an error: the choices of a pilot, tried.

use std::fmt;

use super::{Chosen, MeasuredError, choices, measured};
use crate::plot::number::figure;
use wavecrest_base::error::Result;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::prepared::{Original, PreparedScene, Samples};
use wavecrest_core::render::{RenderOptions, render};

/// The cost of an error with one sampler.
#[derive(Clone, Copy, Debug)]
pub struct Advice {
    /// The choice, as the pilot expects it.
    pub choice: Chosen,
    /// Seconds of tracing the image, and its error; `None` if the choice takes too long to try.
    pub measured: Option<(f64, MeasuredError)>,
}

/// Choices that take longer than this in seconds are not tried.
const TRIED: f64 = 5.0;

/// What `error` costs with each sampler: the choices of a pilot, tried on the whole image. The scene
/// is restored.
///
/// # Errors
/// As [`choices`].
pub fn advise(
    scene: &mut PreparedScene,
    original: &Original,
    error: f64,
    seed: u64,
) -> Result<Vec<Advice>> {
    let mut advice = Vec::new();
    for choice in choices(scene, original, &Sampling::ALL, (error, seed), &())? {
        let mut measured = None;
        if choice.seconds <= TRIED {
            scene.resample(original, &choice.samples());
            let options = RenderOptions { seed, ..RenderOptions::default() };
            let rendered = render(scene, &options, &())?;
            let again = render(scene, &options, &())?.seconds;
            let error = self::measured(scene, &rendered, seed, &())?;
            measured = error.map(|error| (rendered.seconds.min(again), error));
        }
        advice.push(Advice { choice, measured });
    }
    scene.resample(original, &Samples::default());
    Ok(advice)
}

impl Advice {
    /// Seconds of tracing: measured, or expected of a choice that was not tried.
    pub fn seconds(&self) -> f64 {
        self.measured.map_or(self.choice.seconds, |(seconds, _)| seconds)
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((seconds, found)) = self.measured else {
            return write!(f, "{} (not tried)", self.choice);
        };
        let points = self.choice.axis.counted(self.choice.points);
        write!(f, "{points}: error {}, {seconds:.3} s of tracing", figure(found.error))
    }
}
