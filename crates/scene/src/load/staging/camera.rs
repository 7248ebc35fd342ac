//! The camera that is put where a file has none, and the size of the image.

use glam::DVec3;

use wavecrest_base::error::Result;
use wavecrest_core::math::sampling::Sampling;

use super::Sphere;
use crate::components::{FovAxis, View};
use crate::load::LoadOptions;
use crate::parse;

/// Width of the image in pixels, where nothing is said of it; the height for one that is upright.
const LONGER_SIDE: u32 = 1024;
/// Its width by its height.
const ASPECT: f64 = 4.0 / 3.0;
/// Rays along each side of a pixel.
const ANTIALIAS: u32 = 2;
/// Full angle of the camera that is put where a file has none, in degrees.
const FOV_DEGREES: f64 = 40.0;
/// Where that camera stands, as seen from the middle: in front, above and a little to the right.
const CAMERA_SIDE: DVec3 = DVec3::new(0.5, 0.4, 1.0);

/// Width and height of the image: what is asked for; else as the `aspect` is, width by height, or 4 by 3.
///
/// # Errors
/// Where what is asked for is too large, or nothing.
pub(crate) fn size(options: &LoadOptions, aspect: Option<f64>) -> Result<(u32, u32)> {
    let aspect = aspect.unwrap_or(ASPECT);
    let most = f64::from(parse::LONGEST_SIDE);
    // Within the bounds of a side, so that the conversion is exact.
    let side = |length: f64| length.round().clamp(1.0, most) as u32;
    let longer = f64::from(LONGER_SIDE);
    let (width, height) = match (options.width, options.height) {
        (Some(width), Some(height)) => (width, height),
        (Some(width), None) => (width, side(f64::from(width) / aspect)),
        (None, Some(height)) => (side(f64::from(height) * aspect), height),
        (None, None) => (side(longer * aspect.min(1.0)), side(longer / aspect.max(1.0))),
    };
    parse::check_size(width, height)?;
    Ok((width, height))
}

/// Rays of each pixel.
pub(crate) fn rays_per_pixel() -> u64 {
    u64::from(ANTIALIAS).pow(2)
}

/// A view of this size whose place is yet to be found.
pub(crate) fn view(width: u32, height: u32) -> View {
    View {
        location: DVec3::Z,
        look: DVec3::ZERO,
        up: DVec3::Y,
        fov_degrees: FOV_DEGREES,
        fov_axis: FovAxis::Smaller,
        width,
        height,
        antialias: ANTIALIAS,
        sampling: Sampling::Jittered,
    }
}

/// A view of all that there is, with +y upward.
///
/// # Errors
/// As [`size`].
pub(crate) fn framed(bounds: &Sphere, options: &LoadOptions) -> Result<View> {
    let (width, height) = size(options, None)?;
    let half = (FOV_DEGREES / 2.0).to_radians();
    // The sphere touches the sides of what is seen.
    let location = bounds.outside(CAMERA_SIDE.normalize(), 1.0 / libm::sin(half));
    Ok(View { location, look: bounds.center, ..view(width, height) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_side_of_the_image_follows_from_the_other() {
        let asked = |width, height, aspect| {
            size(&LoadOptions { width, height, ..LoadOptions::default() }, aspect)
        };
        assert_eq!(asked(None, None, None).unwrap(), (1024, 768));
        assert_eq!(asked(None, None, Some(0.5)).unwrap(), (512, 1024));
        assert_eq!(asked(Some(200), None, Some(2.0)).unwrap(), (200, 100));
        assert_eq!(asked(None, Some(300), None).unwrap(), (400, 300));
        assert_eq!(asked(Some(7), Some(9), Some(2.0)).unwrap(), (7, 9));
        assert_eq!(asked(None, Some(9), Some(1e30)).unwrap(), (65_536, 9));
        assert!(asked(Some(0), None, None).is_err() && asked(Some(70_000), None, None).is_err());
        assert!(asked(Some(65_536), Some(65_536), None).is_err());
    }
}
