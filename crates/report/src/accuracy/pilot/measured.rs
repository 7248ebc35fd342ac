//! The error of an image, measured without a reference: in windows all over it, from the variance of
//! independent renders.

use rand::RngExt;
use rayon::prelude::*;

use crate::accuracy::fit::generator;
use crate::accuracy::setting::{Facts, Target};
use crate::expected::tiles;
use crate::summary::mean_and_error;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, Watch, render};
use wavecrest_core::tile::Tile;

/// Side of a window, in pixels.
const WINDOW: u32 = 8;

/// Windows along each side of the image: one at a random place in each cell of a grid.
const WINDOWS: u32 = 12;

/// Seeds of pilots, apart from those of renders.
pub(super) fn pilot_seed(seed: u64, number: u64) -> u64 {
    seed ^ (0x5EED << 40) ^ (number << 32)
}

/// The work to measure the error of an image of this size, as a share of that of rendering it.
pub fn measuring_share(size: [u32; 2]) -> f64 {
    let pixels: usize = windows(size, 0).iter().map(Tile::len).sum();
    OTHERS as f64 * pixels as f64 / size.map(f64::from).iter().product::<f64>()
}

/// An error measured in windows: root mean squared error of linear values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredError {
    /// The estimate.
    pub error: f64,
    /// The error that the image has at most, with [`CONFIDENCE`]: from the differences between
    /// windows.
    pub at_most: f64,
}

/// The confidence of [`MeasuredError::at_most`], as standard errors of a normal distribution: 0.975.
const CONFIDENCE: f64 = 1.96;

/// Renders of each window beside the image that is measured.
const OTHERS: u64 = 2;

/// The error of an image of `scene` with its current samples. `None` if it is not finished, or if
/// renders do not show their error: with one ray through the centre of each pixel and nothing else
/// left to chance, they are all equal.
///
/// # Errors
/// As [`error`].
pub fn measured(
    scene: &PreparedScene,
    rendered: &Rendered,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Option<MeasuredError>> {
    let is_shown = rendered.finished && Facts::of(scene).is_sampled(Target::Scene);
    is_shown.then(|| error(scene, Some(&rendered.film), seed, watch)).transpose()
}

/// The error of `scene` with its current samples, in windows, from the variance of some renders and
/// of `film`, the whole image, if there is one; without a meaning if `watch` ends it.
///
/// # Errors
/// If there is no memory for a window.
pub fn error(
    scene: &PreparedScene,
    film: Option<&Film>,
    seed: u64,
    watch: &dyn Watch,
) -> Result<MeasuredError> {
    // A window is one tile: all threads have work only if there are several windows at once.
    let tiles = windows(scene.camera.size(), pilot_seed(seed, u64::from(film.is_some())));
    let found = tiles.into_par_iter().map(|tile| {
        let window = [tile.x, tile.y, tile.width, tile.height];
        let mut films: Vec<Film> =
            film.map(|film| film.part(window)).into_iter().collect::<Result<_>>()?;
        for number in 1..=OTHERS {
            let seed = pilot_seed(seed, number);
            let options = RenderOptions { seed, crop: Some(tile), ..RenderOptions::default() };
            films.push(render(scene, &options, watch)?.film);
        }
        Ok(variance(&films))
    });
    let found: Vec<f64> = found.collect::<Result<_>>()?;
    let (mean, deviation) = mean_and_error(&found);
    Ok(MeasuredError { error: mean.sqrt(), at_most: (mean + CONFIDENCE * deviation).sqrt() })
}

/// The variance of a value between images of one size: the mean over all their values.
pub(in crate::accuracy) fn variance(films: &[Film]) -> f64 {
    let n = films.len() as f64;
    let values = films.first().map_or(0, |film| film.pixels().len() * 3);
    let of = |index: usize| {
        let each = || films.iter().map(move |film| f64::from(film.pixels().as_flattened()[index]));
        let mean = each().sum::<f64>() / n;
        each().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0)
    };
    (0..values).map(of).sum::<f64>() / values.max(1) as f64
}

/// A window in each part of the image, at a random place.
fn windows(size: [u32; 2], seed: u64) -> Vec<Tile> {
    let mut random = generator(seed);
    tiles(size, WINDOWS, WINDOW, |room| random.random_range(0..=room as usize) as u32)
}
