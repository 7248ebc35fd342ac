//! A closed tube along a torus knot.
//!
//! The knot winds three times around the axis of a torus and five times through its hole. Its frame
//! needs no transport along the curve: the curve lies on the torus, so the normal of the torus is
//! always perpendicular to the tangent and returns to itself, and the tube closes without a twist
//! or a seam.
//!
//! A tube of varying radius around a curve does not intersect itself as long as its largest radius
//! is below the reach of the curve (Federer 1959): the smaller of its least radius of curvature and
//! half the least distance between two strands. Here that is 0.28, as a test measures.

use std::f64::consts::TAU;

use glam::DVec3;

use super::noise::Fractal;
use super::surface::{Surface, cell_triangle};

/// Turns about the axis of the torus.
const TURNS: f64 = 3.0;
/// Turns through its hole.
const WINDS: f64 = 5.0;
/// The radius of the circle that the torus runs along.
const MAJOR: f64 = 1.0;
/// The radius of the torus about that circle.
const MINOR: f64 = 0.4;
/// The radius of the tube before it is displaced.
const TUBE: f64 = 0.18;
/// The largest displacement, as a share of [`TUBE`]: the widest tube is 0.27, below the reach.
pub(super) const MOST_DISPLACEMENT: f64 = 0.5;
/// Steps along the knot for each step around the tube: its length, 22.85, over its girth, so that
/// cells are nearly square.
pub(super) const RINGS_PER_SIDE: u64 = 20;
/// Frequency of the coarsest noise: a wave is about half the width of the tube.
const FREQUENCY: f64 = 6.0;

/// The knot as a grid of rings, closed in both directions.
pub(super) struct Knot {
    /// Steps around the tube.
    sides: u64,
    rings: u64,
    displacement: f64,
    fractal: Fractal,
}

impl Knot {
    pub(super) fn new(sides: u64, displacement: f64, seed: u64) -> Self {
        let fractal = Fractal::new(seed, FREQUENCY, TAU * TUBE / sides as f64);
        Self { sides, rings: sides * RINGS_PER_SIDE, displacement, fractal }
    }

    /// The point at step `i` around the tube and at ring `j`.
    fn point(&self, i: f64, j: f64) -> DVec3 {
        let [centre, normal, binormal] = frame(TAU * (j / self.rings as f64));
        let (sin, cos) = libm::sincos(TAU * (i / self.sides as f64));
        let outward = normal * cos + binormal * sin;
        let plain = centre + outward * TUBE;
        centre + outward * (TUBE * (1.0 + self.displacement * self.fractal.sum(plain)))
    }

    /// The step and the ring of vertex `v`.
    fn grid_point(&self, v: u64) -> (f64, f64) {
        ((v % self.sides) as f64, (v / self.sides) as f64)
    }
}

impl Surface for Knot {
    fn vertices(&self) -> u64 {
        self.sides * self.rings
    }

    fn position(&self, v: u64) -> DVec3 {
        let (i, j) = self.grid_point(v);
        self.point(i, j)
    }

    fn normal(&self, v: u64) -> DVec3 {
        let (i, j) = self.grid_point(v);
        let around = self.point(i + 1.0, j) - self.point(i - 1.0, j);
        let along = self.point(i, j + 1.0) - self.point(i, j - 1.0);
        around.cross(along).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let (i, j) = (t / 2 % self.sides, t / 2 / self.sides);
        let (next_i, next_j) = ((i + 1) % self.sides, (j + 1) % self.rings);
        let corner = |i: u64, j: u64| (j * self.sides + i) as u32;
        let corners = [corner(i, j), corner(next_i, j), corner(next_i, next_j), corner(i, next_j)];
        // All diagonals run along with the rings.
        cell_triangle(corners, true, t % 2)
    }
}

/// The point of the centre line at `angle`, which runs from 0 to tau along the whole knot, and the normal and the
/// binormal there, which span the tube.
fn frame(angle: f64) -> [DVec3; 3] {
    let (sin_turn, cos_turn) = libm::sincos(TURNS * angle);
    let (sin_wind, cos_wind) = libm::sincos(WINDS * angle);
    let outward = DVec3::new(cos_turn, sin_turn, 0.0);
    let forward = DVec3::new(-sin_turn, cos_turn, 0.0);
    let distance = MAJOR + MINOR * cos_wind;
    let normal = outward * cos_wind + DVec3::Z * sin_wind;
    let velocity =
        forward * (TURNS * distance) + (DVec3::Z * cos_wind - outward * sin_wind) * (MINOR * WINDS);
    let centre = outward * distance + DVec3::Z * (MINOR * sin_wind);
    [centre, normal, velocity.normalize().cross(normal)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of the centre line, and the arc length up to each; the last is the total length.
    fn centre_line(count: usize) -> (Vec<DVec3>, Vec<f64>) {
        let points: Vec<DVec3> =
            (0..count).map(|i| frame(TAU * i as f64 / count as f64)[0]).collect();
        let mut arc = vec![0.0];
        for i in 0..count {
            arc.push(arc[i] + points[i].distance(points[(i + 1) % count]));
        }
        (points, arc)
    }

    #[test]
    fn widest_tube_is_below_the_reach() {
        let count = 2000;
        let (points, arc) = centre_line(count);
        let widest = TUBE * (1.0 + MOST_DISPLACEMENT);
        let length = arc[count];
        assert!((length / (TAU * TUBE) - RINGS_PER_SIDE as f64).abs() < 0.5);
        for i in 0..count {
            let (before, here) = (points[(i + count - 1) % count], points[i]);
            let after = points[(i + 1) % count];
            let (a, b) = (here - before, after - here);
            let curvature =
                2.0 * a.cross(b).length() / (a.length() * b.length() * (after - before).length());
            assert!(curvature * widest < 0.9, "bends too sharply at {i}");
            for j in 0..i {
                let apart = (arc[i] - arc[j]).min(length - arc[i] + arc[j]);
                // Nearer along the curve than half a turn of that radius, the bound on the
                // curvature already keeps the strands apart (Schur's comparison theorem).
                if apart > std::f64::consts::PI * widest {
                    let distance = points[i].distance(points[j]);
                    assert!(distance > 2.0 * widest, "strands {i} and {j} are {distance} apart");
                }
            }
        }
    }
}
