//! Sample points on the unit square, and the maps from the square to lights and lenses. All maps
//! preserve area: equal cells of the square become equal areas of the shape.

use std::f32::consts::TAU;

use glam::{DVec2, Vec2, Vec3};

use super::sobol;

wavecrest_base::choices! {
    /// How a set of sample points is spread over the unit square.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Sampling {
        /// Each point anywhere, independent of the others.
        Random = "random",
        /// One point in each cell of a grid, anywhere in the cell.
        Jittered = "jittered",
        /// The points of a scrambled Sobol sequence: see [`super::sobol`].
        Sobol = "sobol",
    }
}

impl Sampling {
    /// Point number `index.0` of the `columns` times `rows` points that `stream` has at
    /// `dimension`. Both coordinates are in \[0, 1).
    ///
    /// Random and jittered points use the two numbers `random` of the stream. The Sobol points of
    /// all samples of a pixel form one sequence: `index.1` is the number of the point in it.
    #[inline(always)]
    pub fn point(
        self,
        index: (u32, u32),
        [columns, rows]: [u32; 2],
        random: impl FnOnce() -> [f32; 2],
        seeds: impl FnOnce() -> [u32; 3],
    ) -> Vec2 {
        match self {
            Self::Random => Vec2::from(random()),
            Self::Jittered => {
                let (column, row) = (index.0 % columns, index.0 / columns);
                let [x, y] = random();
                Vec2::new(cell(column, columns, x), cell(row, rows, y))
            }
            Self::Sobol => sobol::point(index.1, seeds()),
        }
    }
}

/// A set of points on the unit square: their number and how they are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Points {
    /// Distribution.
    pub sampling: Sampling,
    /// Its square is the number of points, with or without a grid.
    pub side: u32,
}

impl Points {
    /// The number of points.
    pub fn count(self) -> u32 {
        self.side * self.side
    }
}

/// The point at `fraction` of the `index`th of `count` equal parts of \[0, 1).
#[inline(always)]
fn cell(index: u32, count: u32, fraction: f32) -> f32 {
    let x = (index as f32 + fraction) / count as f32;
    // The sum or quotient of the last cell may round up to 1.
    x.min(1.0_f32.next_down())
}

/// A point of the unit disk: `square.x` is the angle, `square.y` the share of the area closer to
/// the centre.
#[inline]
pub fn disk(square: Vec2) -> Vec2 {
    let (sin, cos) = libm::sincosf(TAU * square.x);
    square.y.sqrt() * Vec2::new(cos, sin)
}

/// A point of the unit sphere: `square.x` is the angle about +y, `square.y` the share of the area
/// below it (Archimedes: equal heights cut equal areas).
#[inline]
pub fn sphere(square: Vec2) -> Vec3 {
    let height = 2.0 * square.y - 1.0;
    let radius = (1.0 - height * height).max(0.0).sqrt();
    let (sin, cos) = libm::sincosf(TAU * square.x);
    Vec3::new(radius * sin, height, radius * cos)
}

/// A point of the spherical cap of this `height` on the unit sphere: its offset across the axis, at
/// the angle `square.x`, and its depth below the top, `square.y` times the height.
#[inline]
pub fn cap(square: Vec2, height: f64) -> (DVec2, f64) {
    let below = f64::from(square.y) * height;
    // The root of 1 - (1 - below)^2, without a difference of nearly equal numbers.
    let radius = (below * (2.0 - below)).sqrt();
    let (sin, cos) = libm::sincosf(TAU * square.x);
    (DVec2::new(f64::from(cos), f64::from(sin)) * radius, below)
}

/// The second and third barycentric coordinate of a point of a triangle (Turk 1990).
#[inline]
pub fn triangle(square: Vec2) -> Vec2 {
    let root = square.x.sqrt();
    Vec2::new(root * (1.0 - square.y), root * square.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The other maps: `tests/properties/numbers.rs`. A share of heights is one of area.
    #[test]
    fn caps_keep_area_and_lie_on_the_sphere() {
        for height in [0.5, 2.0] {
            for step in 0_u8..=100 {
                let share = f64::from(step) / 100.0;
                let (aside, below) = cap(Vec2::new(0.3, share as f32), height);
                assert!((below - share * height).abs() < 1e-6, "{below}");
                let radius = aside.length_squared() + (1.0 - below) * (1.0 - below);
                assert!((radius - 1.0).abs() < 1e-6, "{radius}");
            }
        }
    }
}
