//! Framing options for files without a camera: view side, up axis, field of view.

use std::str::FromStr;

use glam::{DMat3, DVec3};

use crate::format::Range;

/// Framing of a file without a camera, or replacing its cameras.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Framing {
    /// The side from which it is seen.
    pub side: Option<Side>,
    /// The axis of the file that is up.
    pub up: Option<Up>,
    /// The full angle across the shorter side of the image.
    pub fov: Option<Fov>,
    /// The share of the image to fill.
    pub fit: Option<Fit>,
    /// Number of frames of one turn of the camera, from frame 1 on.
    pub turntable: Option<u32>,
}

/// The side from which a file is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// From outside, with everything in the image.
    Around {
        /// Degrees from the front towards the right.
        azimuth: f64,
        /// Degrees upward.
        elevation: f64,
    },
    /// From inside, as a room.
    Inside,
}

/// Another place for a camera, in the coordinates of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAt {
    /// The position of the camera.
    pub eye: DVec3,
    /// What it looks at; the same as before if `None`.
    pub target: Option<DVec3>,
    /// Up in the image; the same as before if `None`.
    pub up: Option<DVec3>,
}

impl Side {
    /// Names of sides with their azimuth and elevation in degrees.
    pub const NAMED: [(&'static str, f64, f64); 7] = [
        ("front", 0.0, 0.0),
        ("back", 180.0, 0.0),
        ("left", -90.0, 0.0),
        ("right", 90.0, 0.0),
        ("top", 0.0, 90.0),
        ("bottom", 0.0, -90.0),
        // Isometric: all three axes appear equally long.
        ("iso", 45.0, 35.264_389_682_754_654),
    ];
}

impl FromStr for Side {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "inside" {
            return Ok(Self::Inside);
        }
        let named = Self::NAMED.iter().find(|(name, ..)| *name == text);
        let angles = || {
            let (azimuth, elevation) = text.split_once(',')?;
            Some((azimuth.trim().parse::<f64>().ok()?, elevation.trim().parse::<f64>().ok()?))
        };
        match named.map(|&(_, azimuth, elevation)| (azimuth, elevation)).or_else(angles) {
            Some((azimuth, elevation)) if azimuth.abs() <= 360.0 && elevation.abs() <= 90.0 => {
                Ok(Self::Around { azimuth, elevation })
            }
            _ => Err("write front, back, left, right, top, bottom, iso or inside, or two angles in \
                      degrees, AZIMUTH,ELEVATION, such as 30,20: from the front to the right, at most \
                      360, and upward, at most 90"
                .to_owned()),
        }
    }
}

/// The direction of a camera from the object, and up in its image if it looks straight down or up;
/// with y up and z to the front. Angles are in degrees: [`Side::Around`] has their meaning.
pub fn toward(azimuth: f64, elevation: f64) -> [DVec3; 2] {
    let (sine, cosine) = sin_cos(elevation);
    let (right, front) = sin_cos(azimuth);
    let overhead = DVec3::new(right, 0.0, front) * -sine.signum();
    [DVec3::new(right * cosine, sine, front * cosine), overhead]
}

/// Sine and cosine of an angle in degrees; exact for right angles, so that views along an axis are
/// exact.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    match turn {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => (libm::sin(turn.to_radians()), libm::cos(turn.to_radians())),
    }
}

wavecrest_base::choices! {
    /// The axis of a file that points upward.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Up {
        /// +x.
        X = "x",
        /// +y, as in glTF.
        Y = "y",
        /// +z, as in most CAD and 3D printing programs.
        Z = "z",
        /// -x.
        #[serde(rename = "-x")]
        NegativeX = "-x",
        /// -y.
        #[serde(rename = "-y")]
        NegativeY = "-y",
        /// -z.
        #[serde(rename = "-z")]
        NegativeZ = "-z",
    }
}

impl Up {
    /// The axis nearest to a direction.
    pub fn nearest(direction: DVec3) -> Self {
        let along = |up: &Self| up.axes().y_axis.dot(direction);
        Self::ALL.into_iter().max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(Self::Y)
    }

    /// Unit vectors to the right, up, and to the front, out of the image: right-handed. With +y up,
    /// as in glTF, the front is +z; other up axes are rotated to +y the shortest way.
    pub fn axes(self) -> DMat3 {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        match self {
            Self::X => DMat3::from_cols(-y, x, z),
            Self::Y => DMat3::IDENTITY,
            Self::Z => DMat3::from_cols(x, z, -y),
            Self::NegativeX => DMat3::from_cols(y, -x, z),
            Self::NegativeY => DMat3::from_cols(x, -y, -z),
            Self::NegativeZ => DMat3::from_cols(x, -z, y),
        }
    }
}

/// Angles of view, in degrees. At 180 the image plane would be at infinity.
pub(crate) const FOV: Range = Range::new(0.001, 179.0);

/// A full angle of view in degrees, in the range of scene files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fov(f64);

impl Fov {
    /// The angle in degrees.
    pub fn degrees(self) -> f64 {
        self.0
    }
}

impl FromStr for Fov {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let degrees = text.parse().ok().filter(|&degrees| FOV.contains(degrees));
        let words = || format!("write an angle in degrees, {}, such as 40", FOV.words());
        degrees.map(Self).ok_or_else(words)
    }
}

/// The share of the image's width or height to fill, above 0, at most 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit(f64);

impl Fit {
    /// The share, above 0, at most 1.
    pub fn share(self) -> f64 {
        self.0
    }
}

impl Default for Fit {
    /// Leaves four per cent free on each side.
    fn default() -> Self {
        Self(0.92)
    }
}

impl FromStr for Fit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // A smaller share is less than a pixel of the widest image.
        const SMALLEST: f64 = 1e-4;
        let share = text.parse().ok().filter(|share| (SMALLEST..=1.0).contains(share));
        share
            .map(Self)
            .ok_or_else(|| format!("write a share of the image from {SMALLEST} to 1, such as 0.9"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_handed_and_named_after_the_up_axis() {
        for up in Up::ALL {
            let axes = up.axes();
            assert_eq!(axes.determinant(), 1.0, "{up:?}");
            let sign = if up.name().starts_with('-') { -1.0 } else { 1.0 };
            let axis = "xyz".find(up.name().trim_start_matches('-')).unwrap();
            assert_eq!(axes.y_axis[axis], sign, "{up:?}");
        }
    }
}
