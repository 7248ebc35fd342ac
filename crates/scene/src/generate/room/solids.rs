//! The round solids of furniture, as grids: bodies of revolution, tubes and cushions.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use super::builder::Builder;
use super::colour::Colour;
use super::place::Place;
use super::profiles::Profile;
use crate::generate::grid::Ends;

/// A millimetre: furniture is measured in metres, and its details in these.
pub(super) const MM: f64 = 0.001;
/// The default bevel of edges, in metres.
pub(super) const BEVEL: f64 = 3.0 * MM;
/// The fineness of small bodies, relative to cloth; and that of legs and stands.
pub(super) const FINE: f64 = 4.0;
pub(super) const TURNED: f64 = 1.5;

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
