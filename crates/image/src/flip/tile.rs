//! The passes over a tile of the image.
//!
//! Each tile reads its pixels and those that filters reach around it, filters the rows once for all
//! filters, then the columns, and compares (sections 4.1.2 to 4.3 of the paper). The image's edge
//! pixels are repeated beyond its edge.

use std::f64::consts::FRAC_1_SQRT_2;

use super::super::color::{from_opponents, opponents, rgb_to_xyz, xyz_to_lab, xyz_to_rgb};
use super::filter::{FILTERS, Filters, Weights};
use wavecrest_core::film::Film;

/// The smallest side of a tile in pixels: its memory then stays in a core's cache.
const MIN_SIDE: usize = 64;

/// Two images, compared tile by tile.
pub(super) struct Tiles<'a> {
    filters: Filters,
    largest_difference: f64,
    films: [&'a Film; 2],
}

/// A tile: its first column and row, and its number of columns and rows.
#[derive(Clone, Copy)]
struct TileArea {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

/// An image after the pass along rows: a plane for each filter, with rows above and below the tile.
type Filtered = [Vec<f64>; FILTERS];

/// The plane that each of the [`Filters`] reads along rows: of lightness, of red against green, or
/// of yellow against blue.
const ALONG_ROWS: [usize; FILTERS] = [0, 1, 2, 2, 0, 0, 0];

/// A row of an image after both passes: values for each pixel.
type PixelRow = [Vec<f64>; ALONG_COLUMNS.len()];

/// The filter along columns, and the plane filtered along rows that it reads: for the colour, whose
/// last two are terms of a sum, and for edges and points along x and along y.
const ALONG_COLUMNS: [[usize; 2]; 8] =
    [[0, 0], [1, 1], [2, 2], [3, 3], [4, 5], [4, 6], [5, 4], [6, 4]];

impl<'a> Tiles<'a> {
    pub(super) fn new(filters: Filters, films: [&'a Film; 2]) -> Self {
        Self { filters, largest_difference: largest_difference(), films }
    }

    /// The side of a tile in pixels: at least the reach of the filters, or most of the work would
    /// be around tiles.
    pub(super) fn side(&self) -> usize {
        MIN_SIDE.max(2 * self.filters.radius())
    }

    /// Fills the rows of a band of tiles, `band` bands from the top.
    pub(super) fn band(&self, band: usize, out: &mut [f32]) {
        let width = self.films[0].width() as usize;
        let (mut filtered, mut rows) = (<[Filtered; 2]>::default(), <[PixelRow; 2]>::default());
        for x in (0..width).step_by(self.side()) {
            let place = TileArea {
                x,
                y: band * self.side(),
                width: self.side().min(width - x),
                height: out.len() / width,
            };
            for (filtered, film) in filtered.iter_mut().zip(self.films) {
                self.along_rows(film, place, filtered);
            }
            for (y, out) in out.chunks_exact_mut(width).enumerate() {
                for (row, filtered) in rows.iter_mut().zip(&filtered) {
                    self.along_columns(filtered, place, y, row);
                }
                self.compare(&rows, &mut out[x..x + place.width]);
            }
        }
    }

    /// The pass along rows: the tile's, and those that filters reach above and below.
    fn along_rows(&self, film: &Film, place: TileArea, out: &mut Filtered) {
        out.iter_mut().for_each(Vec::clear);
        let mut planes = <[Vec<f64>; 3]>::default();
        for y in self.reached(place.y, place.height, film.height()) {
            let row = &film.pixels()[y * film.width() as usize..][..film.width() as usize];
            planes.iter_mut().for_each(Vec::clear);
            for x in self.reached(place.x, place.width, film.width()) {
                for (plane, value) in planes.iter_mut().zip(shown(row[x])) {
                    plane.push(value);
                }
            }
            for ((filter, plane), out) in self.filters.0.iter().zip(ALONG_ROWS).zip(&mut *out) {
                let start = out.len();
                out.resize(start + place.width, 0.0);
                filter.apply(&planes[plane][self.before(filter)..], 1, &mut out[start..]);
            }
        }
    }

    /// The pass along columns, for the tile's row `y`.
    fn along_columns(&self, from: &Filtered, place: TileArea, y: usize, out: &mut PixelRow) {
        for ([filter, plane], out) in ALONG_COLUMNS.into_iter().zip(out) {
            let filter = &self.filters.0[filter];
            out.resize(place.width, 0.0);
            let start = (y + self.before(filter)) * place.width;
            filter.apply(&from[plane][start..], place.width, out);
        }
    }

    fn compare(&self, [a, b]: &[PixelRow; 2], out: &mut [f32]) {
        for (x, out) in out.iter_mut().enumerate() {
            let colors = color_difference(color(a, x), color(b, x), self.largest_difference);
            let features = feature_difference(features(a, x), features(b, x));
            // The feature difference amplifies the colour difference. Equal colours show none,
            // whatever surrounds them.
            *out = if colors == 0.0 { 0.0 } else { libm::pow(colors, 1.0 - features) as f32 };
        }
    }

    /// The rows or columns that filters reach around `count` of them; the image's first and last
    /// are repeated beyond its edge.
    fn reached(&self, start: usize, count: usize, size: u32) -> impl Iterator<Item = usize> {
        let (radius, last) = (self.filters.radius(), size as usize - 1);
        (start..start + count + 2 * radius).map(move |i| i.saturating_sub(radius).min(last))
    }

    /// The number of pixels before a tile that `filter` does not reach.
    fn before(&self, filter: &Weights) -> usize {
        self.filters.radius() - filter.radius()
    }
}

fn color(row: &PixelRow, x: usize) -> [f64; 3] {
    [row[0][x], row[1][x], row[2][x] + row[3][x]]
}

/// The strength of a pixel as part of an edge, and as a point.
fn features(row: &PixelRow, x: usize) -> [f64; 2] {
    // Lightness ranges from -16 to 100; the filters cancel constants.
    let strength = |[x, y]: [f64; 2]| (x * x + y * y).sqrt() / 116.0;
    [[row[4][x], row[6][x]], [row[5][x], row[7][x]]].map(strength)
}

/// The exponent of colour distances (q_c), which gives small ones more weight.
const COLOR_POWER: f64 = 0.7;

/// Up to this part of the largest difference (p_c) ...
const KNEE_FROM: f64 = 0.4;

/// ... differences are spread over this part of the scale (p_t): larger ones hardly differ to the
/// eye.
const KNEE_TO: f64 = 0.95;

/// The largest colour difference, raised to the exponent: green and blue are farthest apart.
fn largest_difference() -> f64 {
    let hunted = |rgb| hunt(xyz_to_lab(rgb_to_xyz(rgb)));
    libm::pow(hyab(hunted([0.0, 1.0, 0.0]), hunted([0.0, 0.0, 1.0])), COLOR_POWER)
}

/// The difference of two colours in YCxCz, from 0 to 1.
fn color_difference(a: [f64; 3], b: [f64; 3], largest: f64) -> f64 {
    let distance = hyab(perceived(a), perceived(b));
    if distance == 0.0 {
        return 0.0;
    }
    let part = libm::pow(distance, COLOR_POWER) / largest;
    // Filtered colours are clamped, but rounding may exceed the largest difference.
    if part < KNEE_FROM {
        part * (KNEE_TO / KNEE_FROM)
    } else {
        (KNEE_TO + (part - KNEE_FROM) / (1.0 - KNEE_FROM) * (1.0 - KNEE_TO)).min(1.0)
    }
}

/// The difference of two pixels' features, from 0 to 1.
fn feature_difference([edge, point]: [f64; 2], [other_edge, other_point]: [f64; 2]) -> f64 {
    let difference = (edge - other_edge).abs().max((point - other_point).abs());
    // A feature may have strength 1 along both axes. The exponent q_f is a half.
    (difference * FRAC_1_SQRT_2).sqrt().min(1.0)
}

/// A pixel's linear values as the light of a display, in YCxCz.
///
/// YCxCz has the axes of CIELAB without its roots, so averages are averages of light.
fn shown(pixel: [f32; 3]) -> [f64; 3] {
    let light = |value: f32| if value > 0.0 { f64::from(value.min(1.0)) } else { 0.0 };
    opponents(rgb_to_xyz(pixel.map(light)))
}

/// A filtered colour, clamped to the gamut of a display, in CIELAB with the Hunt effect.
fn perceived(filtered: [f64; 3]) -> [f64; 3] {
    let rgb = xyz_to_rgb(from_opponents(filtered)).map(|value| value.clamp(0.0, 1.0));
    hunt(xyz_to_lab(rgb_to_xyz(rgb)))
}

/// The Hunt effect: darker colours appear less vivid.
fn hunt([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    [lightness, 0.01 * lightness * a, 0.01 * lightness * b]
}

/// The distance of Abasi, Tehran and Fairchild (*Distance metrics for very large color
/// differences*, 2020): lightness separate from the rest.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, u, v] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (u * u + v * v).sqrt()
}
