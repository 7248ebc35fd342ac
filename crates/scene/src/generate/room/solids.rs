//! The solids of furniture: boards and mouldings with flat faces that share no vertex, and bodies of
//! revolution, tubes and cushions as grids.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use super::builder::{Builder, Place};
use super::colour::Colour;
use super::profiles::Profile;
use crate::generate::grid::Ends;
use crate::generate::surface::{Surface, cell_triangle};

/// A millimetre: furniture is measured in metres, and its details in these.
pub(super) const MM: f64 = 0.001;
/// The default bevel of edges, in metres.
pub(super) const BEVEL: f64 = 3.0 * MM;
/// The fineness of small bodies, relative to cloth; and that of legs and stands.
pub(super) const FINE: f64 = 4.0;
pub(super) const TURNED: f64 = 1.5;

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

/// A quadratic B-spline through the ends of its control points, in the plane of radius and height.
/// A point given twice is a sharp corner.
struct Spline(Vec<DVec2>);

impl Spline {
    /// From control points in centimetres.
    fn new(controls: Profile) -> Self {
        let ends = [controls.first(), controls.last()].map(|end| end.into_iter());
        let [first, last] = ends;
        let all = first.chain(controls).chain(last);
        Self(all.map(|&[r, y]| DVec2::new(r, y) / 100.0).collect())
    }

    /// The point at `t`, from 0 to 1.
    fn at(&self, t: f64) -> DVec2 {
        let spans = self.0.len() - 2;
        let s = t * spans as f64;
        let span = (s as usize).min(spans - 1);
        let f = s - span as f64;
        let [a, b, c] = [self.0[span], self.0[span + 1], self.0[span + 2]];
        let (start, end) = ((a + b) / 2.0, (b + c) / 2.0);
        start * ((1.0 - f) * (1.0 - f)) + b * (2.0 * f * (1.0 - f)) + end * (f * f)
    }

    fn length(&self) -> f64 {
        self.0.windows(2).map(|leg| leg[0].distance(leg[1])).sum()
    }

    fn radius(&self) -> f64 {
        self.0.iter().fold(0.0, |most, p| p.x.max(most))
    }
}

impl Builder {
    /// The body that `profile` sweeps around the y axis of `place`: control points in centimetres
    /// of radius and height, with the outside on the right of the path. Flat discs close the ends,
    /// which must not be on the axis.
    pub(super) fn lathe(&mut self, place: Place, profile: Profile, fineness: f64, colour: Colour) {
        let spline = Spline::new(profile);
        let cells = [
            self.steps(TAU * spline.radius(), fineness, 8),
            self.steps(spline.length(), fineness, profile.len() as u64),
        ];
        let shape = move |u: f64, v: f64| {
            let (p, (sin, cos)) = (spline.at(v), libm::sincos(TAU * u));
            place.point(DVec3::new(p.x * cos, p.y, -p.x * sin))
        };
        self.grid(Ends::Fans, cells, colour, shape);
    }

    /// A tube a few metres long around a curve, with `radius` at each of its points, in metres.
    /// `side` is never along the curve.
    pub(super) fn tube(
        &mut self,
        place: Place,
        (length, fineness): (f64, f64),
        side: DVec3,
        colour: Colour,
        curve: impl Fn(f64) -> (DVec3, f64) + Send + Sync + 'static,
    ) {
        /// The step over which the direction of the curve is measured.
        const STEP: f64 = 1.0 / 1024.0;
        let cells = [self.steps(TAU * curve(0.5).1, fineness, 5), self.steps(length, fineness, 4)];
        let shape = move |u: f64, v: f64| {
            let (centre, radius) = curve(v);
            let tangent = (curve(v + STEP).0 - curve(v - STEP).0).normalize();
            let first = side.cross(tangent).normalize();
            let (sin, cos) = libm::sincos(TAU * u);
            place.point(centre + (first * cos + tangent.cross(first) * sin) * radius)
        };
        self.grid(Ends::Fans, cells, colour, shape);
    }

    /// A straight round rod between two points, with rounded ends.
    pub(super) fn rod(&mut self, place: Place, ends: [DVec3; 2], radius: f64, colour: Colour) {
        let [from, to] = ends;
        let axis = to - from;
        let side = axis.any_orthogonal_vector();
        self.tube(place, (axis.length() / 4.0, FINE), side, colour, move |t| {
            let near_end = (t.min(1.0 - t) * 8.0).clamp(0.0, 1.0);
            (from + axis * t, radius * (0.5 + 0.5 * libm::sin(FRAC_PI_2 * near_end)))
        });
    }

    /// A cushion that fills a box of these half sizes around the origin of `place`: an ellipsoid
    /// for a `roundness` of 1, the box itself for 0.
    pub(super) fn cushion(
        &mut self,
        place: Place,
        half: DVec3,
        roundness: f64,
        fineness: f64,
        colour: Colour,
    ) {
        /// The latitude of the last ring before a pole, in quarter turns.
        const LAST_RING: f64 = 0.97;
        let power = move |x: f64| libm::pow(x.abs(), roundness).copysign(x);
        let cells = [
            self.steps(4.0 * (half.x + half.z), fineness, 12),
            self.steps(2.0 * (half.y + half.x.min(half.z)), fineness, 6),
        ];
        let shape = move |u: f64, v: f64| {
            let (sin, cos) = libm::sincos(TAU * u);
            let (up, out) = libm::sincos(PI * (v - 0.5) * LAST_RING);
            let p = DVec3::new(power(cos), 0.0, -power(sin)) * power(out);
            place.point((p + DVec3::Y * power(up)) * half)
        };
        self.grid(Ends::Fans, cells, colour, shape);
    }
}
