//! The error of an image, measured without a reference: in windows all over it, from the variance of
//! independent renders.

use std::time::Instant;

use rayon::prelude::*;

use crate::accuracy::setting::{Facts, Target};
use crate::expected::tiles;
use crate::summary::mean_and_error;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::Order;
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

/// The error of an image of `scene` with its current samples, in windows; without a meaning if `watch` ends it. `None` if
/// the image is not finished, or if renders do not show their error: with one ray through the centre of each pixel and
/// nothing else left to chance, they are all equal.
///
/// # Errors
/// If there is no memory for a window.
pub fn measured(
    scene: &PreparedScene,
    rendered: &Rendered,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Option<MeasuredError>> {
    if !rendered.finished || !Facts::of(scene).is_sampled(Target::Scene) {
        return Ok(None);
    }
    let found = variances(scene, Some(&rendered.film), seed, f64::INFINITY, watch)?;
    let (mean, deviation) = mean_and_error(&found.into_iter().flatten().collect::<Vec<_>>());
    let at_most = (mean + CONFIDENCE * deviation).sqrt();
    Ok(Some(MeasuredError { error: mean.sqrt(), at_most }))
}

/// The variance of some renders of `scene` and of `film`, the whole image, if there is one, in each window that was begun
/// in the first `seconds`: the first ones are all over the image.
///
/// # Errors
/// If there is no memory for a window.
pub(super) fn variances(
    scene: &PreparedScene,
    film: Option<&Film>,
    seed: u64,
    seconds: f64,
    watch: &dyn Watch,
) -> Result<Vec<Option<f64>>> {
    let start = Instant::now();
    // A window is one tile: all threads have work only if there are several windows at once.
    let tiles = windows(scene.camera.size(), pilot_seed(seed, u64::from(film.is_some())));
    let found = tiles.into_par_iter().map(|tile| {
        if start.elapsed().as_secs_f64() > seconds {
            return Ok(None);
        }
        let window = [tile.x, tile.y, tile.width, tile.height];
        let mut films: Vec<Film> =
            film.map(|film| film.part(window)).into_iter().collect::<Result<_>>()?;
        for number in 1..=OTHERS {
            let seed = pilot_seed(seed, number);
            let options = RenderOptions { seed, crop: Some(tile), ..RenderOptions::default() };
            films.push(render(scene, &options, watch)?.film);
        }
        Ok(Some(variance(&films)))
    });
    found.collect()
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

/// A window in each part of the image, at a random place, in an order that is all over the image.
fn windows(size: [u32; 2], seed: u64) -> Vec<Tile> {
    let tiles = tiles(size, WINDOWS, WINDOW, seed);
    let step = Order::Spread.step(tiles.len() as u32) as usize;
    (0..tiles.len()).map(|number| tiles[number * step % tiles.len()]).collect()
}
