//! What exactness costs in time: how often each step to an exact hit is taken, and its price.
//!
//! Counts are those of a render. Prices are measured one step at a time, in one thread, for rays of
//! the camera and others that leave primitives, at the leaves that these visit.

use std::hint::black_box;
use std::time::Instant;

use super::setting::Setting;
use super::store::{Record, StepRecord, StepsRecord, Store, records_of};
use super::subject::Subject;
use super::{OnProgress, SweepProgress};
use crate::measure::rounds;
use crate::selftest::agreement::leaving;
use crate::statistics::Rays;
use wavecrest_base::error::Result;
use wavecrest_core::accel::steps::{HitStep, Steps};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::PreparedScene;

/// Rays of the camera, and as many that leave primitives.
const RAYS: u32 = 1 << 11;

/// Largest number of rounds, and the seconds after which no further round starts.
const ROUNDS: usize = 32;
const SHORT: f64 = 0.5;

/// Counts and prices the steps of the scene, unless done already.
///
/// # Errors
/// If the scene can no longer be rendered, or the record cannot be written.
pub fn run(subject: &mut Subject, store: &mut Store, progress: &OnProgress<'_>) -> Result<()> {
    let scene = subject.record.scene.clone();
    if records_of(&store.records).any(|s: &StepsRecord| s.scene == scene) {
        return Ok(());
    }
    progress(SweepProgress::Stage(&format!("{scene}: steps to exact hits")));
    let c = subject.render(&Setting::default(), 0)?.counters;
    let rays = Rays::from(&c).all();
    let mut prices = prices(&subject.prepare(&Setting::default())?.scene);
    let fast_filter = prices.pop().unwrap_or_default();
    let step = |(step, nanoseconds): (HitStep, f64)| StepRecord {
        step: step.name().to_owned(),
        count: step.count(&c.tests),
        nanoseconds,
    };
    let steps = HitStep::ALL.into_iter().zip(prices).map(step).collect();
    store.add(Record::Steps(StepsRecord { scene, rays, steps, fast_filter }))?;
    Ok(())
}

impl StepsRecord {
    /// How often a ray takes the step, on average.
    pub fn times(&self, step: &StepRecord) -> f64 {
        step.count as f64 / self.rays.max(1) as f64
    }

    /// Nanoseconds that a ray spends in the step, on average.
    pub fn nanoseconds(&self, step: &StepRecord) -> f64 {
        self.times(step) * step.nanoseconds
    }

    /// Whether a ray takes any step: none does without triangles and quads.
    pub fn has_any(&self) -> bool {
        self.steps.iter().any(|step| step.count > 0)
    }

    /// All steps together, in words.
    pub fn sentence(&self) -> String {
        format!(
            "These steps take {:.1} ns a ray; the filter of `fast` takes {:.1} ns a pair.",
            self.steps.iter().map(|step| self.nanoseconds(step)).sum::<f64>(),
            self.fast_filter
        )
    }
}

/// The least nanoseconds of each step, then of the filter in fast precision; 0 for steps that no ray
/// takes. Other programs can only add to a time.
fn prices(scene: &PreparedScene) -> Vec<f64> {
    let rays: Vec<Ray> = rays(scene).collect();
    let steps = Steps::new(&scene.accel, &rays);
    let exact = HitStep::ALL.map(|step| (step, Precision::Exact));
    let all = exact.into_iter().chain([(HitStep::Filter, Precision::Fast)]);
    let mut least: Vec<_> = all.map(|taken| (taken, f64::INFINITY)).collect();
    for _ in rounds(ROUNDS, SHORT) {
        for ((step, precision), least) in &mut least {
            *least = least.min(each(steps.count(*step), || steps.run(*step, *precision)));
        }
    }
    least.into_iter().map(|(_, least)| least).collect()
}

/// Nanoseconds for each of the `count` times that `run` takes a step.
fn each(count: u64, run: impl Fn() -> u64) -> f64 {
    let start = Instant::now();
    black_box(run());
    let seconds = start.elapsed().as_secs_f64();
    if count > 0 { seconds * 1e9 / count as f64 } else { 0.0 }
}

/// Rays through pixels all over the image, and rays that leave primitives.
fn rays(scene: &PreparedScene) -> impl Iterator<Item = Ray> {
    let [width, height] = scene.camera.size();
    let pixels = u64::from(width) * u64::from(height);
    let of_camera = move |i: u32| {
        let pixel = (u64::from(i) * pixels / u64::from(RAYS)) as u32;
        let stream = Stream { seed: 0, pixel, sample: 0, bounce: 0 };
        scene.camera.ray(pixel % width, pixel / width, &stream)
    };
    (0..RAYS).map(of_camera).chain(leaving(scene.accel.geometry(), RAYS as usize))
}
