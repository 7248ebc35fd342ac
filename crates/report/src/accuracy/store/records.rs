//! What a line of a sweep's file may say.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::accuracy::setting::Target;
use crate::accuracy::subject::Stages;
use crate::selftest::errors::HitErrors;

/// What is the same for all records of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// The program's version.
    pub version: String,
    /// The longer side of images, at most, in pixels.
    pub longest: u32,
    /// The most points of a kind.
    pub most: u32,
    /// The fewest points of a render of the reference.
    pub least: u32,
}

/// Under which circumstances a sweep was begun, or taken up again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Circumstances {
    /// The arguments.
    pub command: Vec<String>,
    /// The commit of the checkout that the program lies in, with a `+` where it was changed.
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

/// A scene was prepared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PreparedRecord {
    /// The scene's name.
    pub scene: String,
    /// The setting whose structure it has.
    pub key: String,
    /// How long it took.
    #[serde(flatten)]
    pub time: Stages,
}

/// A reference was made, and lies in a file beside this one.
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

/// A setting was rendered once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointRecord {
    /// The scene's name.
    pub scene: String,
    /// What it is compared with.
    pub target: Target,
    /// The setting.
    pub key: String,
    /// Of its random numbers.
    pub seed: u64,
    /// From the first ray to the last.
    pub seconds: f64,
    /// Seconds of a [yardstick](crate::yardstick) just before: how quick the machine was. Older sweeps have
    /// none.
    #[serde(default)]
    pub yardstick: f64,
    /// Seconds in each pass, summed over threads.
    pub passes: Vec<(String, f64)>,
    /// Rays of every kind.
    pub rays: u64,
    /// Against the reference, as in [`wavecrest_image::compare`].
    #[serde(flatten)]
    pub error: Errors,
}

/// How far a picture is from the reference.
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
    /// The FLIP that one pixel of twenty exceeds; older sweeps have none.
    #[serde(default)]
    pub flip_95: f64,
}

/// Something that must not change the picture was tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NeutralRecord {
    /// The scene's name.
    pub scene: String,
    /// What was changed.
    pub knob: String,
    /// To what.
    pub value: String,
    /// From the first ray to the last.
    pub seconds: f64,
    /// The root mean square error against the reference, less that of the usual choice.
    pub error_change: f64,
    /// Whether the picture has the same bits as with the usual choice.
    pub equal: bool,
}

/// The scene was built and rendered with a preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PresetRecord {
    /// The scene's name.
    pub scene: String,
    /// The preset.
    pub preset: String,
    /// Seconds of building.
    pub build: f64,
    /// From the first ray to the last.
    pub seconds: f64,
}

/// The layer last taken away, and the seconds in each pass without it and those before it.
pub type Step = (Option<String>, Vec<(String, f64)>);

/// The scene was rendered without one layer after the other: see [`layers`](crate::accuracy::layers).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayersRecord {
    /// The scene's name.
    pub scene: String,
    /// The precision.
    pub precision: String,
    /// The layers in the order in which they were taken away, after the whole scene.
    pub steps: Vec<Step>,
}

/// A setting was rendered many times more: see [`spread`](crate::accuracy::spread).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpreadRecord {
    /// The scene's name.
    pub scene: String,
    /// What it is compared with.
    pub target: Target,
    /// The setting.
    pub key: String,
    /// How often.
    pub renders: u32,
    /// The variance of a value in one render: a mean over all values.
    pub variance: f64,
    /// The root mean square of what the mean of the renders is off by, less what chance explains.
    pub bias: f64,
    /// What chance explains of it: root mean square.
    pub expected: f64,
    /// Values with an interval, and how many of these hold the reference.
    pub intervals: u64,
    /// See there.
    pub covered: u64,
}

/// An error was asked for: see [`calibration`](crate::accuracy::calibration).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibrationRecord {
    /// The scene's name.
    pub scene: String,
    /// Of the random numbers.
    pub seed: u64,
    /// The error asked for.
    pub asked: f64,
    /// What the pilot expected of its choice.
    pub expected: f64,
    /// Against the reference.
    pub made: f64,
}

/// A precision was tried on a scene's triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialRecord {
    /// The scene's name.
    pub scene: String,
    /// The precision.
    pub precision: String,
    /// Rays at edges, and how many passed between two triangles.
    pub leaks: [u64; 2],
    /// Rays that leave a triangle, and how many met it again: acne.
    pub self_hits: [u64; 2],
    /// Nanoseconds for each of these rays.
    pub nanoseconds: f64,
    /// How far hits are from the exact ones; none in records of versions that did not measure it.
    #[serde(default)]
    pub errors: Option<Box<HitErrors>>,
}

/// The kinds of records: a line of the file is one of them.
macro_rules! records {
    ($($name:ident($kind:ty)),+ $(,)?) => {
        /// A line of the file.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "record", rename_all = "kebab-case")]
        #[allow(missing_docs, reason = "each says what it is")]
        pub enum Record {
            $($name($kind)),+
        }

        $(impl Recorded for $kind {
            fn of(record: &Record) -> Option<&Self> {
                match record {
                    Record::$name(found) => Some(found),
                    _ => None,
                }
            }
        })+
    };
}

/// What a record may be.
pub trait Recorded: Sized + 'static {
    /// What `record` is, if it is one of these.
    fn of(record: &Record) -> Option<&Self>;
}

records! {
    Header(Header),
    Circumstances(Circumstances),
    Scene(SceneRecord),
    Prepared(PreparedRecord),
    Reference(ReferenceRecord),
    Point(PointRecord),
    Neutral(NeutralRecord),
    Trial(TrialRecord),
    Preset(PresetRecord),
    Layers(LayersRecord),
    Spread(SpreadRecord),
    Calibration(CalibrationRecord),
}
