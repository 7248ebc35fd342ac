//! Gradient noise and its fractal sums.
//!
//! The noise is that of Perlin, "Improving Noise" (2002): each point of the integer lattice has one
//! of twelve gradients, and between the points their planes are blended by a quintic. Instead of
//! Perlin's permutation table, the lattice point and the seed are hashed to the gradient, so the
//! noise neither repeats nor needs a table, and each seed gives a different noise. The ridged sum
//! is that of Musgrave, in Ebert et al., "Texturing and Modeling" (2003).
//!
//! Everything is integer arithmetic, or `+ - *` on 64-bit floats in a fixed order, so a value has
//! the same bits on every machine.

use glam::{DVec3, FloatExt as _};

/// Growth of the frequency from one octave to the next.
const LACUNARITY: f64 = 2.0;
/// Decrease of the amplitude from one octave to the next. Below 1 / [`LACUNARITY`], so that slopes
/// stay finite for any number of octaves and fine triangles do not become needles.
const GAIN: f64 = 0.45;
/// Octaves with waves shorter than this many edges of the mesh are left out: they would only cause
/// spikes.
const EDGES_PER_WAVE: f64 = 4.0;
/// Octaves beyond this number change a coordinate by less than the resolution of a 32-bit float.
const MOST_OCTAVES: u32 = 20;
/// Offset of each octave's lattice, so that the zeros of the octaves do not coincide.
const OCTAVE_SHIFT: DVec3 = DVec3::new(0.3719, 0.6173, 0.8431);

/// How steeply a ridge falls from its crest. The noise is mostly within 1 / 1.6 of zero, so that
/// valleys come near 0 and crests near 1.
const CREST_SHARPNESS: f64 = 1.6;
/// How quickly the height of one octave admits the next.
const RIDGE_FEEDBACK: f64 = 2.0;

/// Noise summed over octaves, each finer and weaker than the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fractal {
    seed: u64,
    frequency: f64,
    octaves: u32,
}

impl Fractal {
    /// A sum whose coarsest waves have this `frequency` per unit of length, and whose finest are
    /// those that a mesh with edges of about `edge` can show.
    pub(super) fn new(seed: u64, frequency: f64, edge: f64) -> Self {
        let mut octaves = 1;
        let mut next = frequency * LACUNARITY;
        while octaves < MOST_OCTAVES && next * edge * EDGES_PER_WAVE <= 1.0 {
            octaves += 1;
            next *= LACUNARITY;
        }
        Self { seed, frequency, octaves }
    }

    /// The plain sum at `p`, in [-1, 1] for any number of octaves.
    pub(super) fn sum(&self, p: DVec3) -> f64 {
        let mut amplitude = 1.0 - GAIN;
        let mut total = 0.0;
        for octave in 0..self.octaves {
            total += amplitude * self.octave(p, octave);
            amplitude *= GAIN;
        }
        total
    }

    /// Musgrave's ridged sum at `p`, in [0, 1]: sharp crests where the noise crosses zero, and
    /// fine detail only where the coarse octaves are already high, so that valleys stay smooth.
    pub(super) fn ridged(&self, p: DVec3) -> f64 {
        let mut amplitude = 1.0 - GAIN;
        let mut weight = 1.0;
        let mut total = 0.0;
        for octave in 0..self.octaves {
            let crest = (1.0 - CREST_SHARPNESS * self.octave(p, octave).abs()).max(0.0);
            let signal = crest * crest * weight;
            total += amplitude * signal;
            weight = (signal * RIDGE_FEEDBACK).min(1.0);
            amplitude *= GAIN;
        }
        total
    }

    /// One octave's noise at `p`.
    fn octave(&self, p: DVec3, octave: u32) -> f64 {
        // A power of two: exact.
        let frequency = self.frequency * f64::from(1_u32 << octave);
        let seed = mix(self.seed.wrapping_add(u64::from(octave)));
        gradient_noise(p * frequency + OCTAVE_SHIFT * f64::from(octave + 1), seed)
    }
}

/// Perlin's gradient noise at `p`, in [-1, 1], zero at every lattice point.
fn gradient_noise(p: DVec3, seed: u64) -> f64 {
    let (x, fx) = split(p.x);
    let (y, fy) = split(p.y);
    let (z, fz) = split(p.z);
    let corner = |dx: i64, dy: i64, dz: i64| {
        let gradient = lattice_gradient(x + dx, y + dy, z + dz, seed);
        gradient.dot(DVec3::new(fx - dx as f64, fy - dy as f64, fz - dz as f64))
    };
    let u = fade(fx);
    let edge = |dy, dz| corner(0, dy, dz).lerp_monotonic(corner(1, dy, dz), u);
    let v = fade(fy);
    let face = |dz| edge(0, dz).lerp_monotonic(edge(1, dz), v);
    // The true bound is about 1.04; the clamp makes bounds on displacements exact.
    face(0).lerp_monotonic(face(1), fade(fz)).clamp(-1.0, 1.0)
}

/// The integer at or below `x`, and the remainder.
fn split(x: f64) -> (i64, f64) {
    let cut = x as i64;
    let whole = if cut as f64 > x { cut - 1 } else { cut };
    (whole, x - whole as f64)
}

/// Perlin's quintic: from 0 to 1, with first and second derivatives zero at both ends.
fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The gradient of a lattice point.
fn lattice_gradient(x: i64, y: i64, z: i64, seed: u64) -> DVec3 {
    // Odd multipliers without common structure separate the three axes before the mixing.
    let key = (x as u64).wrapping_mul(0x8CB9_2BA7_2F3D_8DD7)
        ^ (y as u64).wrapping_mul(0xD6E8_FEB8_6659_FD93).rotate_left(21)
        ^ (z as u64).wrapping_mul(0xA076_1D64_78BD_642F).rotate_left(42);
    // The high bits are mixed best; a multiplication maps them evenly to the twelve.
    let pick = ((mix(key ^ seed) >> 32) * 12) >> 32;
    // The centres of a cube's edges: no gradient favours an axis.
    let [a, b] = [pick & 1, pick >> 1 & 1].map(|bit| if bit == 0 { 1.0 } else { -1.0 });
    match pick / 4 {
        0 => DVec3::new(a, b, 0.0),
        1 => DVec3::new(a, 0.0, b),
        _ => DVec3::new(0.0, a, b),
    }
}

/// Spreads every bit of `x` over the whole word: the finaliser of Steele, Lea and Flood's
/// SplitMix (2014).
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_keep_their_bounds_and_use_them() {
        let fractal = Fractal::new(1, 1.0, 1e-3);
        let (mut low, mut high, mut ridge_low, mut ridge_high) = (1.0_f64, -1.0_f64, 1.0_f64, 0.0);
        for t in (0..4000).map(f64::from) {
            let p = DVec3::new(t * 0.137 - 200.0, 71.0 - t * 0.0713, t * 0.0411 - 3.0);
            low = low.min(fractal.sum(p));
            high = high.max(fractal.sum(p));
            ridge_low = ridge_low.min(fractal.ridged(p));
            ridge_high = fractal.ridged(p).max(ridge_high);
        }
        assert!(low > -1.0 && low < -0.3, "{low}");
        assert!(high < 1.0 && high > 0.3, "{high}");
        assert!((0.0..0.1).contains(&ridge_low), "{ridge_low}");
        assert!(ridge_high > 0.7 && ridge_high <= 1.0, "{ridge_high}");
    }
}
