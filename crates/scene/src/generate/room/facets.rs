//! The flat parts of furniture: boards and mouldings, whose faces share no vertex.

use glam::{DVec2, DVec3};

use super::place::Place;
use crate::generate::surface::{Surface, cell_triangle};

/// Flat quads and triangles, each with its own corners, so that edges look sharp.
#[derive(Default)]
pub(super) struct Facets {
    /// Convex and counter-clockwise as seen from the front, as are the triangles, which repeat
    /// their last corner.
    pub(super) quads: Vec<[DVec3; 4]>,
    pub(super) triangles: Vec<[DVec3; 4]>,
}

impl Facets {
    /// A block whose edges are cut back by `bevel`, if that is not 0: six faces, then twelve edges
    /// and eight corners.
    pub(super) fn board(&mut self, place: &Place, low: [f64; 3], high: [f64; 3], bevel: f64) {
        self.faces(place, low, high, bevel);
        if bevel == 0.0 {
            return;
        }
        let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        // The corner with the signs `s`, on the face perpendicular to `axis`.
        let corner = |s: DVec3, axis: usize| {
            let inset = DVec3::splat(bevel) - DVec3::AXES[axis] * bevel;
            place.point(middle + s * (half - inset))
        };
        for axis in 0..3 {
            let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
            for (a, b) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
                let sign = |w: f64| {
                    DVec3::AXES[first] * a + DVec3::AXES[second] * b + DVec3::AXES[axis] * w
                };
                let (down, up) = (sign(-1.0), sign(1.0));
                let [p, q] = if a * b > 0.0 { [first, second] } else { [second, first] };
                self.quads.push([corner(down, p), corner(down, q), corner(up, q), corner(up, p)]);
            }
        }
        for signs in 0..8_u8 {
            let sign = |bit: u8| if signs >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let s = DVec3::new(sign(0), sign(1), sign(2));
            let [a, b, c] = [corner(s, 0), corner(s, 1), corner(s, 2)];
            let faces_out = s.x * s.y * s.z > 0.0;
            self.triangles.push(if faces_out { [a, b, c, c] } else { [a, c, b, b] });
        }
    }

    /// The six faces of a block, each inset by `inset` in its plane.
    fn faces(&mut self, place: &Place, low: [f64; 3], high: [f64; 3], inset: f64) {
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let at = |w: f64, a: f64, b: f64| {
                let mut p = [0.0; 3];
                (p[axis], p[u], p[v]) = (w, a, b);
                place.point(DVec3::from_array(p))
            };
            let ([u0, v0], [u1, v1]) =
                ([low[u] + inset, low[v] + inset], [high[u] - inset, high[v] - inset]);
            let face = |w, a0, a1| [at(w, a0, v0), at(w, a1, v0), at(w, a1, v1), at(w, a0, v1)];
            self.quads.push(face(high[axis], u0, u1));
            self.quads.push(face(low[axis], u1, u0));
        }
    }

    /// Mitred frames around a rectangle of the plane z = 0, each from one (inset, height towards
    /// +z) of `profile` to the next, open in the middle.
    pub(super) fn frames(&mut self, place: &Place, low: DVec2, high: DVec2, profile: &[[f64; 2]]) {
        let ring = |[inset, z]: [f64; 2]| rectangle(place, low + inset, high - inset, z);
        self.between(&profile.iter().map(|&at| ring(at)).collect::<Vec<_>>());
    }

    /// Quads between each ring of four corners and the next ring inside it.
    pub(super) fn between(&mut self, rings: &[[DVec3; 4]]) {
        for pair in rings.windows(2) {
            for i in 0..4 {
                let next = (i + 1) % 4;
                self.quads.push([pair[0][i], pair[0][next], pair[1][next], pair[1][i]]);
            }
        }
    }

    /// As [`Self::frames`], with the middle closed.
    pub(super) fn panel(&mut self, place: &Place, low: DVec2, high: DVec2, profile: &[[f64; 2]]) {
        self.frames(place, low, high, profile);
        let Some(&[inset, z]) = profile.last() else { return };
        self.quads.push(rectangle(place, low + inset, high - inset, z));
    }
}

/// Triangles, or flat convex quads, each with its own corners.
pub(super) struct Soup {
    /// Corners of each facet: 3 or 4.
    pub(super) sides: u64,
    pub(super) facets: u64,
    /// The corners of a facet by its number, counter-clockwise as seen from the front; a triangle
    /// repeats its last one.
    pub(super) facet: Box<dyn Fn(u64) -> [DVec3; 4] + Send + Sync>,
}

impl Surface for Soup {
    fn vertices(&self) -> u64 {
        self.sides * self.facets
    }

    fn triangles(&self) -> u64 {
        (self.sides - 2) * self.facets
    }

    fn position(&self, v: u64) -> DVec3 {
        (self.facet)(v / self.sides)[(v % self.sides) as usize]
    }

    fn normal(&self, v: u64) -> DVec3 {
        let [a, b, c, _] = (self.facet)(v / self.sides);
        (b - a).cross(c - a).normalize()
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let halves = self.sides - 2;
        let first = (t / halves * self.sides) as u32;
        cell_triangle([first, first + 1, first + 2, first + 3], true, t % halves)
    }
}

/// A rectangle at the height `z`, facing +z.
pub(super) fn rectangle(place: &Place, low: DVec2, high: DVec2, z: f64) -> [DVec3; 4] {
    [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]
        .map(|corner| place.point(corner.extend(z)))
}
