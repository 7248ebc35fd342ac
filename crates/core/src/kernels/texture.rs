//! Texture coordinates and texture look-up.

mod coordinates;
mod lazy;
mod pyramid;
mod wrap;

use glam::Vec3;

use crate::math::{Mask, Real, Single, Vector, both};
use pyramid::MipLevel;
use wrap::{below, neighbours, position};

pub use coordinates::{Placing, PlanarMap, UvMap, sphere_directions, sphere_uv, sphere_uv_change};
pub use lazy::LazyImage;
pub(crate) use lazy::decoding;
pub use wrap::Wrap;

wavecrest_base::choices! {
    /// How a look-up between texels is answered.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Filter {
        /// The texel that the point lies in.
        Nearest = "nearest",
        /// The four texels around the point, weighted.
        #[default]
        Bilinear = "bilinear",
        // The levels are those whose texels are next in size to what the look-up is for.
        /// As [`Filter::Bilinear`] in two levels of the image's pyramid, and between these. See [`Image::level`].
        Trilinear = "trilinear",
    }
}

/// An image's texels, linear, top row first.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8 bits a channel, 255 meaning 1; the fourth byte is padding.
    Bytes(Vec<[u8; 4]>),
    /// 8 bits a channel, with a table of the values for each channel: encoded or tinted images take
    /// no more memory than others.
    Levels(Vec<[u8; 4]>, Box<[Vec3; 256]>),
    /// Floating point, for formats of more than 8 bits.
    Floats(Vec<[f32; 3]>),
}

/// An image for look-ups.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Its width in texels, at least 1.
    pub width: u32,
    /// Its height in texels, at least 1.
    pub height: u32,
    /// `width` times `height` texels.
    pub texels: Texels,
    /// How many numbers of the file are not finite, alpha included; they are 0 in `texels`.
    pub invalid: u64,
    /// The levels of the pyramid above the texels, down to one texel; empty if it is not built.
    levels: Vec<MipLevel>,
}

impl Image {
    /// An image without a pyramid. `width` and `height` are at least 1, and there are `width` times
    /// `height` `texels`.
    pub fn new(width: u32, height: u32, texels: Texels) -> Self {
        Self { width, height, texels, invalid: 0, levels: Vec::new() }
    }

    /// Builds the pyramid, unless it exists: see [`pyramid`].
    pub fn build_pyramid(&mut self) {
        if self.levels.is_empty() {
            self.levels = pyramid::levels(self.width, self.height, |x, y| self.texel(x, y));
        }
    }

    /// Bytes held, including the pyramid.
    pub fn bytes(&self) -> usize {
        let texels = match &self.texels {
            Texels::Bytes(texels) => size_of_val(texels.as_slice()),
            Texels::Levels(texels, values) => {
                size_of_val(texels.as_slice()) + size_of_val(values.as_slice())
            }
            Texels::Floats(texels) => size_of_val(texels.as_slice()),
        };
        texels + self.levels.iter().map(|level| size_of_val(level.texels.as_slice())).sum::<usize>()
    }

    /// The coarsest level of detail: 0 without a pyramid.
    pub fn coarsest(&self) -> u32 {
        self.levels.len() as u32
    }

    #[inline(always)]
    fn texel(&self, x: u32, y: u32) -> Vec3 {
        let index = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Bytes(texels) => {
                let [r, g, b, _] = texels[index].map(usize::from);
                Vec3::new(SHARES[r], SHARES[g], SHARES[b])
            }
            Texels::Levels(texels, values) => {
                let [r, g, b, _] = texels[index].map(usize::from);
                Vec3::new(values[r].x, values[g].y, values[b].z)
            }
            Texels::Floats(texels) => Vec3::from(texels[index]),
        }
    }

    /// The level above the image itself with this number.
    #[inline(always)]
    fn mip_level(&self, level: u32) -> Option<&MipLevel> {
        level.checked_sub(1).and_then(|above| self.levels.get(above as usize))
    }

    /// The colours at `uv`: u from left to right, v from bottom to top, both 0 to 1 across the
    /// image. Coordinates that are not finite count as 0. Without a level, trilinear look-ups are
    /// bilinear.
    #[inline(always)]
    pub fn look_up<F: Single>(&self, uv: [F; 2], filter: Filter, wrap: Wrap) -> Vector<F> {
        let [u, v] = uv;
        let [width, height] = [self.width, self.height].map(|side| u.same(side as f32));
        match filter {
            Filter::Nearest => {
                let x = below(position(u, width, wrap), width);
                let y = below(position(u.same(1.0) - v, height, wrap), height);
                texels(
                    [x, y],
                    #[inline(always)]
                    |_, x, y| self.texel(x, y),
                )
            }
            Filter::Bilinear | Filter::Trilinear => bilinear(
                [width, height],
                uv,
                wrap,
                #[inline(always)]
                |_, x, y| self.texel(x, y),
            ),
        }
    }

    /// The levels of detail for look-ups over parallelograms with the sides `footprint` in texture
    /// coordinates: the binary logarithm of the longer side in texels, from 0 to
    /// [`Image::coarsest`] (Williams, *Pyramidal Parametrics*, SIGGRAPH 1983; the longer side as in
    /// Heckbert, *Survey of Texture Mapping*, 1986). Elongated footprints are thus blurred rather
    /// than aliased. If a side is not finite, as at grazing angles, the level is the coarsest.
    #[inline(always)]
    pub fn level<F: Single>(&self, footprint: &[[F; 2]; 2]) -> F {
        let [across, down] = both(
            *footprint,
            #[inline(always)]
            |[u, v]| {
                // No square of a single-precision number overflows in double precision.
                let u = u.widen().times(f64::from(self.width));
                let v = v.widen().times(f64::from(self.height));
                u * u + v * v
            },
        );
        let mut longer = F::Double::select(across.gt(down), across, down);
        for lane in 0..F::LANES {
            longer.set_lane(lane, 0.5 * log2_from_1(longer.lane(lane)));
        }
        let coarsest = footprint[0][0].same(self.coarsest() as f32);
        let level = F::narrow(longer).min(coarsest);
        // Also if either is NaN.
        let infinity = across.same(f64::INFINITY);
        let is_finite = across.lt(infinity).bits() & down.lt(infinity).bits();
        F::select(F::mask(level.token(), is_finite), level, coarsest)
    }

    /// The colours at `uv`, bilinear in the level of detail and linear between two levels; and the
    /// lanes that read two levels, a bit each. Levels below 0 count as 0; levels above
    /// [`Image::coarsest`] and NaN count as that.
    #[inline(always)]
    pub fn look_up_at<F: Single>(&self, uv: [F; 2], level: F, wrap: Wrap) -> (Vector<F>, u32) {
        let coarsest = level.same(self.coarsest() as f32);
        let level = F::select(level.lt(coarsest), level.max(level.zero()), coarsest);
        let finer = Real::floor(level);
        let color = self.look_up_in(finer, uv, wrap);
        let between = level.ne(finer);
        if !between.any() {
            return (color, 0);
        }
        let next = F::select(between, finer + level.same(1.0), finer);
        let both = mix(color, self.look_up_in(next, uv, wrap), level - finer);
        (Vector::select(between, both, color), between.bits())
    }

    /// As [`Image::look_up_at`], for whole levels.
    #[inline(always)]
    fn look_up_in<F: Single>(&self, level: F, uv: [F; 2], wrap: Wrap) -> Vector<F> {
        let integers = level.integers();
        let levels = integers.as_ref();
        let mut size = <[F::Row; 2]>::default();
        let [width, height] = &mut size;
        for (lane, &level) in levels.iter().enumerate() {
            let level = self.mip_level(level);
            let [x, y] = level.map_or([self.width, self.height], |level| level.size);
            (width.as_mut()[lane], height.as_mut()[lane]) = (x as f32, y as f32);
        }
        let token = level.token();
        let size = [F::load(token, width), F::load(token, height)];
        bilinear(
            size,
            uv,
            wrap,
            #[inline(always)]
            |lane, x, y| match self.mip_level(levels[lane]) {
                None => self.texel(x, y),
                Some(level) => level.texel(x, y),
            },
        )
    }
}

/// The shares of 255.
static SHARES: [f32; 256] = {
    let (mut shares, mut byte) = ([0.0; 256], 0);
    while byte < shares.len() {
        shares[byte] = byte as f32 / 255.0;
        byte += 1;
    }
    shares
};

/// The binary logarithm of `x`, and 0 below 1: within 4e-16 of its value, and 1e-15.
///
/// With x = 2^k m and m from the root of 1/2 to that of 2, it is k + 2 / ln 2 artanh s for
/// s = (m - 1) / (m + 1), of which s^2 is below 0.0295: the terms after s^19 / 19 add less than
/// 1e-17.
#[inline(always)]
fn log2_from_1(x: f64) -> f64 {
    /// The bits of the root of 1/2.
    const ROOT: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
    let above = if x > 1.0 { x } else { 1.0 }.to_bits() - ROOT;
    let m = f64::from_bits((above & ((1 << 52) - 1)) + ROOT);
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let mut sum = 0.0;
    for term in (0..10).rev() {
        sum = sum * square + 1.0 / f64::from(2 * term + 1);
    }
    (above >> 52) as f64 + s * sum * (2.0 / std::f64::consts::LN_2)
}

impl Filter {
    /// Number of texels that one look-up in one level reads.
    pub fn texels(self) -> u64 {
        match self {
            Self::Nearest => 1,
            Self::Bilinear | Self::Trilinear => 4,
        }
    }
}

/// The four texels around each `uv` in an image of this size, weighted.
#[inline(always)]
fn bilinear<F: Single>(
    [width, height]: [F; 2],
    [u, v]: [F; 2],
    wrap: Wrap,
    texel: impl Fn(usize, u32, u32) -> Vec3 + Copy,
) -> Vector<F> {
    let [x0, x1, fx] = neighbours(position(u, width, wrap), width, wrap);
    let [y0, y1, fy] = neighbours(position(u.same(1.0) - v, height, wrap), height, wrap);
    let top = mix(texels([x0, y0], texel), texels([x1, y0], texel), fx);
    let bottom = mix(texels([x0, y1], texel), texels([x1, y1], texel), fx);
    mix(top, bottom, fy)
}

/// The texels in these columns and rows; `texel` takes the lane, the column and the row.
#[inline(always)]
fn texels<F: Single>([x, y]: [F; 2], texel: impl Fn(usize, u32, u32) -> Vec3) -> Vector<F> {
    let mut found = <[F::Row; 3]>::default();
    let [red, green, blue] = &mut found;
    let (columns, rows) = (x.integers(), y.integers());
    for (lane, (&column, &row)) in columns.as_ref().iter().zip(rows.as_ref()).enumerate() {
        let Vec3 { x, y, z } = texel(lane, column, row);
        (red.as_mut()[lane], green.as_mut()[lane], blue.as_mut()[lane]) = (x, y, z);
    }
    Vector::load(x.token(), &found)
}

/// From `a` to `b` by `fraction`, below 1. Between equal colours the result is that colour,
/// although rounded weights need not add up to 1.
#[inline(always)]
fn mix<F: Single>(a: Vector<F>, b: Vector<F>, fraction: F) -> Vector<F> {
    let between = a.scale(fraction.same(1.0) - fraction) + b.scale(fraction);
    let differs = a.x.ne(b.x) | a.y.ne(b.y) | a.z.ne(b.z);
    Vector::select(differs, between, a)
}

#[cfg(test)]
mod tests;
