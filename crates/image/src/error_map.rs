//! Images of the differences between two images.

use super::colormap::{diverging, magma};
use super::compare::{
    check_sizes, distance, relative_difference, signed_difference, squared_difference,
};
use super::flip::{DEFAULT_PIXELS_PER_DEGREE, Flip, flip};
use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_core::film::Film;

wavecrest_base::choices! {
    /// The error that a map shows for a pixel of `a` and the reference `b`. All kinds except the
    /// first show one number for each pixel, the mean over its three values, in false colours.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum MapKind {
        /// The absolute difference |a - b|, in red, green and blue.
        #[default]
        Absolute = "absolute",
        /// (a - b)^2, from black (0) to light yellow (1).
        Squared = "squared",
        /// (a - b)^2 / (b^2 + 0.01), from black (0) to light yellow (1).
        Relative = "relative",
        /// The perceived difference, FLIP, from black (0) to light yellow (1).
        Flip = "flip",
        /// a - b, from blue (-1, too dark) over grey (0) to red (1, too bright).
        Signed = "signed",
    }
}

/// The map of the errors of `a` against `b`, the reference. Errors are multiplied by `gain` before
/// they become colours; [`MapKind::Flip`] is described at [`DEFAULT_PIXELS_PER_DEGREE`].
///
/// False colours are encoded display values (see [`colormap`](super::colormap)): write the film
/// with [`Transfer::Linear`](super::write::Transfer::Linear). Infinite errors have the last colour;
/// undefined signed errors, such as those of NaN, are black.
///
/// # Errors
/// If the sizes differ or memory does not suffice.
pub fn error_map(a: &Film, b: &Film, kind: MapKind, gain: f32) -> Result<Film> {
    let absolute = |a, b| (distance(signed_difference(a, b)) * f64::from(gain)) as f32;
    let colored = |error: fn(f32, f32) -> f64, color: fn(f32) -> [f32; 3]| {
        each_pixel(a, b, |a, b| {
            let sum = error(a[0], b[0]) + error(a[1], b[1]) + error(a[2], b[2]);
            color((sum / 3.0 * f64::from(gain)) as f32)
        })
    };
    match kind {
        MapKind::Absolute => each_pixel(a, b, |a, b| [0, 1, 2].map(|i| absolute(a[i], b[i]))),
        MapKind::Squared => colored(squared_difference, magma),
        MapKind::Relative => colored(relative_difference, magma),
        MapKind::Flip => flip_map(&flip(a, b, DEFAULT_PIXELS_PER_DEGREE)?, gain),
        MapKind::Signed => colored(signed_difference, diverging),
    }
}

/// The map of [`MapKind::Flip`] for a result of [`flip`].
///
/// # Errors
/// If memory does not suffice.
pub fn flip_map(flip: &Flip, gain: f32) -> Result<Film> {
    let mut film = Film::new(flip.width, flip.height)?;
    parallel::each_mut(film.pixels_mut(), |i, out| *out = magma(flip.map[i] * gain));
    Ok(film)
}

/// The `error` of each pixel of `a` against that of `b`.
fn each_pixel(
    a: &Film,
    b: &Film,
    error: impl Fn(&[f32; 3], &[f32; 3]) -> [f32; 3] + Sync,
) -> Result<Film> {
    check_sizes(a, b)?;
    let mut film = Film::new(a.width(), a.height())?;
    parallel::each_mut(film.pixels_mut(), |i, out| *out = error(&a.pixels()[i], &b.pixels()[i]));
    Ok(film)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(pixels: &[[f32; 3]]) -> Film {
        Film::from_pixels(pixels.len() as u32, 1, pixels.to_vec()).unwrap()
    }

    #[test]
    fn flip_is_shown_in_the_colours_of_its_map() {
        let (a, b) = (film(&[[0.5; 3], [0.0; 3]]), film(&[[0.5; 3], [1.0; 3]]));
        let seen = flip(&a, &b, DEFAULT_PIXELS_PER_DEGREE).unwrap();
        let expected: Vec<[f32; 3]> = seen.map.iter().map(|&v| magma(0.5 * v)).collect();
        assert_eq!(error_map(&a, &b, MapKind::Flip, 0.5).unwrap().into_pixels(), expected);
        assert!(seen.map[1] > 0.0);
    }

    #[test]
    fn what_is_not_finite_stands_out() {
        let a = film(&[[f32::NAN, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0], [0.0; 3]]);
        let b = film(&[[0.0; 3], [0.0; 3], [f32::INFINITY, 0.0, 0.0]]);
        let found = |kind| error_map(&a, &b, kind, 1.0).unwrap().into_pixels();
        assert_eq!(found(MapKind::Squared), [magma(1.0); 3]);
        assert_eq!(found(MapKind::Relative), [magma(1.0); 3]);
        assert_eq!(found(MapKind::Signed), [[0.0; 3], diverging(1.0), diverging(-1.0)]);
    }
}
