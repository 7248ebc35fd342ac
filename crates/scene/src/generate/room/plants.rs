//! Plants: pots and stems are grids, leaves are soups.

use std::f64::consts::TAU;

use glam::DVec3;

use super::builder::Builder;
use super::colour::Colour;
use super::leaf::leaf;
use super::place::Place;
use super::profiles::{POT, SOIL};
use super::random::Random;
use super::solids::MM;

impl Builder {
    /// A pot full of soil.
    fn pot(&mut self, place: Place, fineness: f64, colour: Colour) {
        self.lathe(place, POT, fineness, colour);
        self.lathe(place, SOIL, fineness, Colour::SOIL);
    }

    /// A small tree in a pot, of this height.
    pub(super) fn ficus(&mut self, place: Place, height: f64, weight: u64) {
        self.pot(place, 1.5, Colour::CLAY);
        let trunk = height * 0.55;
        self.stem(place.moved(0.0, 0.24, 0.0), DVec3::Y * trunk, 0.016);
        let mut random = self.random();
        for _ in 0..9_u32 {
            let way = random.direction() * DVec3::new(0.28, 0.16, 0.28);
            let fork = place.moved(0.0, 0.24 + trunk * random.between(0.7, 0.98), 0.0);
            self.stem(fork, way + DVec3::Y * height * 0.22, 7.0 * MM);
        }
        let half = DVec3::new(height * 0.24, height * 0.31, height * 0.24);
        let crown = place.moved(0.0, 0.24 + trunk + half.y * 0.55, 0.0);
        for colour in [Colour::LEAF, Colour::LEAF_DARK] {
            self.crown(crown, half, [0.085, 0.036], weight, colour);
        }
    }

    /// Herbs in a small pot.
    pub(super) fn herbs(&mut self, place: Place, weight: u64) {
        self.pot(place.scaled(0.42), 3.0, Colour::CLAY);
        let half = DVec3::new(0.1, 0.09, 0.1);
        self.crown(place.moved(0.0, 0.17, 0.0), half, [0.03, 0.016], weight, Colour::LEAF_PALE);
    }

    /// Flowers with their leaves, in a vase below `place`.
    pub(super) fn bouquet(&mut self, place: Place) {
        let mut random = self.random();
        for _ in 0..14_u32 {
            let mut way = random.direction() * 0.16;
            way.y = random.between(0.14, 0.3);
            self.stem(place.moved(0.0, -0.03, 0.0), way, 1.8 * MM);
            let flower = move |random: &mut Random, scale: f64| {
                let out = random.direction();
                let base = place.point(way + out * 0.012);
                leaf(base, out, [0.028 * scale, 0.018 * scale], 0.0, random)
            };
            self.plant(1, 24, Colour::PETAL, flower);
        }
        let half = DVec3::new(0.14, 0.09, 0.14);
        self.crown(place.moved(0.0, 0.08, 0.0), half, [0.05, 0.02], 8, Colour::LEAF_PALE);
    }

    /// A palm: fronds that bend outward, with leaflets along both sides.
    pub(super) fn palm(&mut self, place: Place, weight: u64) {
        const FRONDS: u32 = 16;
        self.pot(place, 1.5, Colour::CHINA);
        let mut random = self.random();
        for frond in 0..FRONDS {
            let turn = TAU * (f64::from(frond) / f64::from(FRONDS) + random.between(-0.02, 0.02));
            let (sin, cos) = libm::sincos(turn);
            let out = DVec3::new(cos, 0.0, sin) * random.between(0.35, 0.62);
            let rise = random.between(0.75, 1.35);
            let curve = move |t: f64| {
                out * (t * (0.3 + 0.7 * t)) + DVec3::Y * (0.24 + rise * t * (1.45 - 0.75 * t))
            };
            let side = DVec3::new(-sin, 0.0, cos);
            self.tube(place, (1.2, 1.0), side, Colour::STEM, move |t| {
                (curve(t), 7.0 * MM - 5.0 * MM * t)
            });
            let leaflet = move |random: &mut Random, scale: f64| {
                let t = random.between(0.28, 1.0);
                let hand = if random.unit() < 0.5 { side } else { -side };
                let way = (curve(t) - curve(t - 0.01)).normalize() + hand * 1.3;
                let length = 0.3 * libm::sin(t * 2.6) * scale.max(0.4);
                let base = place.point(curve(t));
                leaf(base, place.direction(way), [length, 0.02 * scale], 0.35, random)
            };
            let colour = random.one_of(&[Colour::LEAF, Colour::LEAF_PALE]);
            self.plant(weight, 90, colour, leaflet);
        }
    }

    /// Ivy that hangs from a pot.
    pub(super) fn ivy(&mut self, place: Place, strands: u32, weight: u64) {
        self.pot(place.scaled(0.5), 3.0, Colour::CHINA);
        let mut random = self.random();
        for strand in 0..strands {
            let turn = TAU * f64::from(strand) / f64::from(strands);
            let (sin, cos) = libm::sincos(turn);
            let length = random.between(0.25, 0.85);
            let phase = random.between(0.0, TAU);
            let curve = move |t: f64| {
                let out = 0.05 + 0.15 * libm::sqrt(t.clamp(0.0, 1.0)).min(2.0 * t.max(0.0));
                let sway = 0.03 * libm::sin(7.0 * t + phase);
                let hang = 0.15 + 0.35 * t.max(0.0) * (0.25 - t) - length * t * t;
                DVec3::new((out + sway) * cos, hang, (out + sway) * sin)
            };
            let leaves = move |random: &mut Random, scale: f64| {
                let base = curve(random.unit()) + random.direction() * 0.012;
                let way = place.direction(random.direction());
                let size = random.between(0.03, 0.06) * scale;
                leaf(place.point(base), way, [size, size * 0.8], 0.6, random)
            };
            let colour = random.one_of(&[Colour::LEAF_DARK, Colour::LEAF]);
            self.plant(weight, 60, colour, leaves);
        }
    }

    /// Clumps of leaves in an ellipsoid, growing outward.
    fn crown(&mut self, place: Place, half: DVec3, size: [f64; 2], weight: u64, colour: Colour) {
        let full_sized = (half.x * half.y * half.z / (size[0] * size[0] * size[1]) * 6.0) as u64;
        let mut random = self.random();
        let clumps: Vec<DVec3> = (0..18_u32).map(|_| random.direction() * 0.66).collect();
        let growth = move |random: &mut Random, scale: f64| {
            let way = random.direction();
            let out = random.one_of(&clumps) + way * libm::cbrt(random.between(0.1, 1.0)) * 0.36;
            let base = place.point(out * half);
            let size = size.map(|side| side * scale * random.between(0.7, 1.1));
            leaf(base, place.direction(out + way) + random.direction() * 0.6, size, 0.5, random)
        };
        self.plant(weight, full_sized, colour, growth);
    }

    /// A tapering stem from the origin of `place`.
    fn stem(&mut self, place: Place, way: DVec3, radius: f64) {
        let side = way.any_orthogonal_vector();
        self.tube(place, (way.length(), 1.0), side, Colour::STEM, move |t| {
            (way * t, radius * (1.0 - 0.5 * t))
        });
    }
}
