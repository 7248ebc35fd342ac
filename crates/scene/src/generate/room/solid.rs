//! Things with flat faces: blocks, boards with bevelled edges, mouldings.

use glam::{DVec2, DVec3};

use super::pieces::Facets;
use super::place::Place;

/// A millimetre: furniture is measured in metres, and its details in these.
pub(super) const MM: f64 = 0.001;
/// The default bevel of edges, in metres.
pub(super) const BEVEL: f64 = 3.0 * MM;

impl Facets {
    /// A block from `low` to `high`: six quads.
    pub(super) fn block(&mut self, place: &Place, low: [f64; 3], high: [f64; 3]) {
        self.faces(place, low, high, 0.0);
    }

    /// A block whose edges are cut back by `bevel`: six faces, twelve edges and eight corners.
    pub(super) fn board(&mut self, place: &Place, low: [f64; 3], high: [f64; 3], bevel: f64) {
        self.faces(place, low, high, bevel);
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
            self.triangles.push(if faces_out { [a, b, c] } else { [a, c, b] });
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

/// A rectangle at the height `z`, facing +z.
pub(super) fn rectangle(place: &Place, low: DVec2, high: DVec2, z: f64) -> [DVec3; 4] {
    [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]
        .map(|corner| place.point(corner.extend(z)))
}

/// The front of a cupboard's door: a frame with a raised field, on a leaf 20 mm thick.
pub(super) const DOOR: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [0.0, 0.02 - BEVEL],
    [BEVEL, 0.02],
    [0.055, 0.02],
    [0.06, 0.016],
    [0.066, 0.011],
    [0.078, 0.011],
    [0.1, 0.018],
];

/// The front of a drawer: bevelled, with a groove.
pub(super) const DRAWER: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [0.0, 0.02 - BEVEL],
    [BEVEL, 0.02],
    [0.022, 0.02],
    [0.025, 0.017],
    [0.028, 0.017],
    [0.031, 0.02],
];
