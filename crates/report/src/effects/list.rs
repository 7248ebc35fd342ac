//! The price list, as written in JSON: see [`crate::effects`].

#![allow(missing_docs, reason = "the table there says it once, for the JSON and for the fields")]

use serde::Serialize;

use crate::bench::equal::Difference;
use crate::bench::{Machine, Ratio};
use crate::measure::Rounds;
use crate::statistics::{ImageSize, Rays, Samples};
use crate::summary::Summary;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;

/// The list.
#[derive(Clone, Debug, Serialize)]
pub struct PriceList {
    pub version: &'static str,
    pub machine: Machine,
    pub image: Option<ImageSize>,
    #[serde(flatten)]
    pub setting: Setting,
    #[serde(flatten)]
    pub rounds: Rounds,
    pub difference: Option<Difference>,
    pub effects: Vec<Price>,
}

/// The settings of the renders.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Setting {
    pub simd: Level,
    pub kernel: KernelChoice,
    pub precision: Precision,
    pub batch: usize,
}

/// The cost of one effect.
#[derive(Clone, Debug, Serialize)]
pub struct Price {
    pub effect: String,
    pub added_to: Option<String>,
    pub reached: bool,
    pub simulated: Vec<&'static str>,
    pub rays: Rays,
    pub samples: Samples,
    pub bytes_per_path: usize,
    pub wavefront: Cost,
    pub recursive: Cost,
}

/// The cost with one tracer.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    pub seconds: Summary,
    pub seconds_per_mray: f64,
    pub price: Option<Ratio>,
}
