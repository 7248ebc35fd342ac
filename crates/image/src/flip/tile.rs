//! The passes over a tile of the image.
//!
//! Each tile reads its pixels and those that filters reach around it, filters the rows once for all
//! filters, then the columns, and compares. The image's edge pixels are repeated beyond its edge.

use super::difference::{Difference, Features, shown};
use super::filter::{Filter, Filters};
use wavecrest_core::film::Film;

/// The smallest side of a tile in pixels: its memory then stays in a core's cache.
const MIN_SIDE: usize = 64;

/// Two images, compared tile by tile.
pub(super) struct Tiles<'a> {
    filters: Filters,
    difference: Difference,
    films: [&'a Film; 2],
}

/// A tile: its first column and row, and its number of columns and rows.
#[derive(Clone, Copy)]
struct Place {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

/// An image after the pass along rows: a plane for each filter, with rows above and below the tile.
#[derive(Default)]
struct Filtered {
    lightness: Vec<f64>,
    red_green: Vec<f64>,
    yellow_blue: [Vec<f64>; 2],
    smooth: Vec<f64>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

/// A row of an image after both passes: a colour and features for each pixel.
#[derive(Default)]
struct Row {
    color: [Vec<f64>; 3],
    along_x: [Vec<f64>; 2],
    along_y: [Vec<f64>; 2],
    /// The second term of a sum.
    term: Vec<f64>,
}

impl<'a> Tiles<'a> {
    pub(super) fn new(filters: Filters, films: [&'a Film; 2]) -> Self {
        Self { filters, difference: Difference::new(), films }
    }

    /// The side of a tile in pixels: at least the reach of the filters, or most of the work would
    /// be around tiles.
    pub(super) fn side(&self) -> usize {
        MIN_SIDE.max(2 * self.filters.radius())
    }

    /// Fills the rows of a band of tiles, `band` bands from the top.
    pub(super) fn band(&self, band: usize, out: &mut [f32]) {
        let width = self.films[0].width() as usize;
        let (mut filtered, mut rows) = (<[Filtered; 2]>::default(), <[Row; 2]>::default());
        for x in (0..width).step_by(self.side()) {
            let place = Place {
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
    fn along_rows(&self, film: &Film, place: Place, out: &mut Filtered) {
        let filters = &self.filters;
        let [first, second] = &filters.yellow_blue;
        out.clear();
        let mut planes = <[Vec<f64>; 3]>::default();
        for y in self.reached(place.y, place.height, film.height()) {
            let row = &film.pixels()[y * film.width() as usize..][..film.width() as usize];
            planes.iter_mut().for_each(Vec::clear);
            for x in self.reached(place.x, place.width, film.width()) {
                for (plane, value) in planes.iter_mut().zip(shown(row[x])) {
                    plane.push(value);
                }
            }
            let [lightness, red_green, yellow_blue] = &planes;
            let append = |filter: &Filter, plane: &[f64], out: &mut Vec<f64>| {
                let start = out.len();
                out.resize(start + place.width, 0.0);
                filter.apply(&plane[self.before(filter)..], 1, &mut out[start..]);
            };
            append(&filters.lightness, lightness, &mut out.lightness);
            append(&filters.red_green, red_green, &mut out.red_green);
            append(first, yellow_blue, &mut out.yellow_blue[0]);
            append(second, yellow_blue, &mut out.yellow_blue[1]);
            append(&filters.smooth, lightness, &mut out.smooth);
            append(&filters.edge, lightness, &mut out.edge);
            append(&filters.point, lightness, &mut out.point);
        }
    }

    /// The pass along columns, for the tile's row `y`.
    fn along_columns(&self, from: &Filtered, place: Place, y: usize, out: &mut Row) {
        let filters = &self.filters;
        let [first, second] = &filters.yellow_blue;
        let apply = |filter: &Filter, plane: &[f64], out: &mut Vec<f64>| {
            out.resize(place.width, 0.0);
            let start = (y + self.before(filter)) * place.width;
            filter.apply(&plane[start..], place.width, out);
        };
        let [lightness, red_green, yellow_blue] = &mut out.color;
        apply(&filters.lightness, &from.lightness, lightness);
        apply(&filters.red_green, &from.red_green, red_green);
        apply(first, &from.yellow_blue[0], yellow_blue);
        apply(second, &from.yellow_blue[1], &mut out.term);
        yellow_blue.iter_mut().zip(&out.term).for_each(|(sum, term)| *sum += term);
        let [edge_x, point_x] = &mut out.along_x;
        apply(&filters.smooth, &from.edge, edge_x);
        apply(&filters.smooth, &from.point, point_x);
        let [edge_y, point_y] = &mut out.along_y;
        apply(&filters.edge, &from.smooth, edge_y);
        apply(&filters.point, &from.smooth, point_y);
    }

    fn compare(&self, [a, b]: &[Row; 2], out: &mut [f32]) {
        for (x, out) in out.iter_mut().enumerate() {
            let colors = self.difference.of_colors(a.color(x), b.color(x));
            let features = self.difference.of_features(a.features(x), b.features(x));
            *out = self.difference.combined(colors, features) as f32;
        }
    }

    /// The rows or columns that filters reach around `count` of them; the image's first and last
    /// are repeated beyond its edge.
    fn reached(&self, start: usize, count: usize, size: u32) -> impl Iterator<Item = usize> {
        let (radius, last) = (self.filters.radius(), size as usize - 1);
        (start..start + count + 2 * radius).map(move |i| i.saturating_sub(radius).min(last))
    }

    /// The number of pixels before a tile that `filter` does not reach.
    fn before(&self, filter: &Filter) -> usize {
        self.filters.radius() - filter.radius()
    }
}

impl Filtered {
    fn clear(&mut self) {
        let [first, second] = &mut self.yellow_blue;
        let planes = [
            &mut self.lightness,
            &mut self.red_green,
            first,
            second,
            &mut self.smooth,
            &mut self.edge,
            &mut self.point,
        ];
        planes.into_iter().for_each(Vec::clear);
    }
}

impl Row {
    fn color(&self, x: usize) -> [f64; 3] {
        [self.color[0][x], self.color[1][x], self.color[2][x]]
    }

    fn features(&self, x: usize) -> Features {
        let strength = |i: usize| {
            let (along_x, along_y) = (self.along_x[i][x], self.along_y[i][x]);
            // Lightness ranges from -16 to 100; the filters cancel constants.
            (along_x * along_x + along_y * along_y).sqrt() / 116.0
        };
        Features { edge: strength(0), point: strength(1) }
    }
}
