//! The records of a sweep's file.

use std::any::Any;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::accuracy::setting::Target;
use crate::bench::Preparation;
use crate::measure::Timing;
use crate::selftest::errors::HitErrors;

/// The values shared by all records of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepHeader {
    /// The program's version.
    pub version: String,
    /// Largest length of the longer side of images in pixels.
    pub longest: u32,
    /// Largest number of points of a kind.
    pub most: u32,
    /// Smallest number of points of a render of the reference.
    pub least: u32,
}

/// The circumstances of the start or resumption of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Circumstances {
    /// The arguments.
    pub command: Vec<String>,
    /// The commit of the checkout that contains the program, with a `+` if it was modified.
    pub commit: Option<String>,
    /// As in the reports of `bench`.
    pub machine: serde_json::Value,
}

/// A scene of the sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// Its name.
    pub scene: String,
    /// Its file.
    pub file: PathBuf,
    /// See [`wavecrest_core::prepared::PreparedScene::fingerprint`], in hexadecimal.
    pub fingerprint: String,
    /// Width and height of the images, in pixels.
    pub size: [u32; 2],
    /// Triangles, quads and spheres.
    pub primitives: u64,
}

/// The preparation of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PreparedRecord {
    /// The scene's name.
    pub scene: String,
    /// The time of each stage.
    #[serde(flatten)]
    pub time: Preparation,
}

/// A reference, stored in a file beside this one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "as in reference::Reference")]
pub struct ReferenceRecord {
    pub scene: String,
    pub target: Target,
    pub file: String,
    pub samples: u64,
    pub replicates: u32,
    pub standard_error: f64,
    pub seconds: f64,
}

/// One render of a setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointRecord {
    /// The scene's name.
    pub scene: String,
    /// The target that it is compared with.
    pub target: Target,
    /// The setting.
    pub key: String,
    /// Its seed.
    pub seed: u64,
    /// Seconds from the first ray to the last.
    pub seconds: f64,
    /// Wall-clock and processor time of all repetitions, of which the fastest counts.
    pub timing: Timing,
    /// Rays of every kind.
    pub rays: u64,
    /// Errors against the reference, as in [`wavecrest_image::compare`].
    #[serde(flatten)]
    pub error: Errors,
}

/// The differences of an image from the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Mean squared error.
    pub mse: f64,
    /// Mean squared error relative to the square of the reference.
    pub relative_mse: f64,
    /// Mean signed error.
    pub bias: f64,
    /// Mean FLIP.
    pub flip: f64,
}

/// A test of a precision on a scene's triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialRecord {
    /// The scene's name.
    pub scene: String,
    /// The precision.
    pub precision: String,
    /// Rays aimed at edges, and the number that passed between two triangles.
    pub leaks: [u64; 2],
    /// Rays that leave a triangle, and the number that hit it again.
    pub self_hits: [u64; 2],
    /// Errors of hits against the exact ones.
    pub errors: Box<HitErrors>,
}

/// The steps to the exact hits of a scene: see [`steps`](crate::accuracy::steps).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepsRecord {
    /// The scene's name.
    pub scene: String,
    /// Rays of every kind in a render.
    pub rays: u64,
    /// The steps in their order.
    pub steps: Vec<StepRecord>,
    /// Nanoseconds of the filter of `fast`, which has no bounds, for a pair.
    pub fast_filter: f64,
}

/// A step to an exact hit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// Its name.
    pub step: String,
    /// How often the rays of the render took it.
    pub count: u64,
    /// Nanoseconds each time.
    pub nanoseconds: f64,
}

/// The kinds of records: a line of the file is one of them.
macro_rules! records {
    ($($name:ident($kind:ty)),+ $(,)?) => {
        /// A line of the file.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "record", rename_all = "kebab-case")]
        #[allow(missing_docs, reason = "each says what it is")]
        pub enum Record {
            $($name($kind),)+
        }

        impl Record {
            /// The record, if it is of kind `T`.
            pub(super) fn of<T: 'static>(&self) -> Option<&T> {
                match self {
                    $(Self::$name(found) => (found as &dyn Any).downcast_ref(),)+
                }
            }
        }
    };
}

records! {
    Header(SweepHeader),
    Circumstances(Circumstances),
    Scene(SceneRecord),
    Prepared(PreparedRecord),
    Reference(ReferenceRecord),
    Point(PointRecord),
    Trial(TrialRecord),
    Steps(StepsRecord),
}
