//! Texture coordinates and texture look-up.

mod around;
mod coordinates;
mod lazy;
mod pyramid;
mod wrap;

use glam::Vec3;

use crate::math::vector::set;
use crate::math::{Mask, Real, Single, Vector, both};
use around::{Around, SHARES, four, mix};
use pyramid::MipLevel;
use wrap::{below, position};

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
            let texel = |x, y| self.texel(y as usize * self.width as usize + x as usize);
            self.levels = pyramid::levels(self.width, self.height, texel);
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

    /// The texel of that number, row by row.
    #[inline(always)]
    fn texel(&self, index: usize) -> Vec3 {
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
        let size @ [width, height] = [self.width, self.height].map(|side| u.same(side as f32));
        if filter == Filter::Nearest {
            let x = below(position(u, width, wrap), width).integers();
            let y = below(position(u.same(1.0) - v, height, wrap), height).integers();
            let mut rows = <[F::Row; 3]>::default();
            for (lane, (&x, &y)) in x.as_ref().iter().zip(y.as_ref()).enumerate() {
                set::<F>(
                    &mut rows,
                    lane,
                    self.texel(y as usize * self.width as usize + x as usize),
                );
            }
            return Vector::load(u.token(), &rows);
        }
        let around = Around::new(size, uv, wrap);
        match &self.texels {
            Texels::Bytes(texels) => around.color_of_bytes(texels, self.width),
            _ => around.color(
                #[inline(always)]
                |lane| four(around.indices(lane, self.width), |index| self.texel(index)),
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
                let u = u.times(self.width as f32);
                let v = v.times(self.height as f32);
                u * u + v * v
            },
        );
        let infinity = across.same(f32::INFINITY);
        // Not if either is NaN.
        let is_finite = across.lt(infinity) & down.lt(infinity);
        let longer = F::select(across.gt(down), across, down);
        let longer = F::select(is_finite, longer, across.same(f32::MAX));
        log2_from_1(longer).times(0.5).min(across.same(self.coarsest() as f32))
    }

    /// The colours at `uv`, bilinear in the level of detail and linear between two levels; and the
    /// lanes that read two levels, a bit each. Levels below 0 count as 0; levels above
    /// [`Image::coarsest`] and NaN count as that.
    #[inline(always)]
    pub fn look_up_at<F: Single>(&self, uv: [F; 2], level: F, wrap: Wrap) -> (Vector<F>, u32) {
        let ([finer, next], fraction) = self.levels_around(level);
        let color = self.look_up_in(finer, uv, wrap);
        let between = fraction.ne(level.zero());
        if !between.any() {
            return (color, 0);
        }
        let both = mix(color, self.look_up_in(next, uv, wrap), fraction);
        (Vector::select(between, both, color), between.bits())
    }

    /// As [`Image::look_up_at`], for whole levels.
    #[inline(always)]
    fn look_up_in<F: Single>(&self, level: F, uv: [F; 2], wrap: Wrap) -> Vector<F> {
        let (levels, around) = (level.integers(), Around::new(self.sizes(level), uv, wrap));
        around.color(
            #[inline(always)]
            |lane| match self.mip_level(levels.as_ref()[lane]) {
                None => four(around.indices(lane, self.width), |index| self.texel(index)),
                Some(MipLevel { size: [width, _], texels }) => {
                    four(around.indices(lane, *width), |index| Vec3::from(texels[index]))
                }
            },
        )
    }

    /// Whether it is worth while to prefetch its texels: they fill more than the caches that a core has
    /// for itself.
    #[inline(always)]
    pub fn is_large(&self) -> bool {
        // With 2^18 texels look-ups took a fiftieth longer with prefetches, with 2^20 they were faster.
        u64::from(self.width) * u64::from(self.height) >= 1 << 20
    }

    /// Calls `each` with addresses in the cache lines that look-ups at `uv` read: in the image itself, or
    /// around a level of detail.
    #[inline(always)]
    pub fn addresses<F: Single>(
        &self,
        uv: [F; 2],
        level: Option<F>,
        wrap: Wrap,
        each: impl Fn(*const i8) + Copy,
    ) {
        let Some(level) = level else {
            return self.addresses_in(uv[0].zero(), uv, wrap, each);
        };
        let ([finer, next], fraction) = self.levels_around(level);
        self.addresses_in(finer, uv, wrap, each);
        if fraction.ne(level.zero()).any() {
            self.addresses_in(next, uv, wrap, each);
        }
    }

    /// As [`Image::addresses`], for whole levels.
    #[inline(always)]
    fn addresses_in<F: Single>(&self, level: F, uv: [F; 2], wrap: Wrap, each: impl Fn(*const i8)) {
        let (levels, around) = (level.integers(), Around::new(self.sizes(level), uv, wrap));
        for (lane, &level) in levels.as_ref().iter().enumerate() {
            let (first, bytes, width) = match (self.mip_level(level), &self.texels) {
                (Some(MipLevel { size: [width, _], texels }), _) => {
                    (texels.as_ptr().cast::<i8>(), size_of::<[f32; 3]>(), *width)
                }
                (None, Texels::Floats(texels)) => {
                    (texels.as_ptr().cast(), size_of::<[f32; 3]>(), self.width)
                }
                (None, Texels::Bytes(texels) | Texels::Levels(texels, _)) => {
                    (texels.as_ptr().cast(), size_of::<[u8; 4]>(), self.width)
                }
            };
            // The texels to the right are nearly always in the same cache lines.
            let [above, _, below, _] = around.indices(lane, width);
            each(first.wrapping_add(above * bytes));
            each(first.wrapping_add(below * bytes));
        }
    }

    /// The whole levels at or below a level of detail and next to that, and the fraction from one to the
    /// other. Where it is 0, both are the same.
    #[inline(always)]
    fn levels_around<F: Single>(&self, level: F) -> ([F; 2], F) {
        let coarsest = level.same(self.coarsest() as f32);
        let level = F::select(level.lt(coarsest), level.max(level.zero()), coarsest);
        let finer = Real::floor(level);
        let next = F::select(level.ne(finer), finer + level.same(1.0), finer);
        ([finer, next], level - finer)
    }

    /// The widths and heights of whole levels.
    #[inline(always)]
    fn sizes<F: Single>(&self, level: F) -> [F; 2] {
        if self.levels.is_empty() {
            return [self.width, self.height].map(|side| level.same(side as f32));
        }
        let (levels, mut size) = (level.integers(), <[F::Row; 2]>::default());
        let [width, height] = &mut size;
        for (lane, &level) in levels.as_ref().iter().enumerate() {
            let level = self.mip_level(level);
            let [x, y] = level.map_or([self.width, self.height], |level| level.size);
            (width.as_mut()[lane], height.as_mut()[lane]) = (x as f32, y as f32);
        }
        [F::load(level.token(), width), F::load(level.token(), height)]
    }
}

/// The binary logarithm of `x`, and 0 below 1: with a relative error below 2^-22.
///
/// With x = 2^k m and m from the root of 1/2 to that of 2, it is k + 2 / ln 2 artanh s for
/// s = (m - 1) / (m + 1), of which s^2 is below 0.0295: the terms after s^9 / 9 add less than
/// 1e-9.
#[inline(always)]
fn log2_from_1<F: Single>(x: F) -> F {
    let one = x.same(1.0);
    let (exponent, m) = x.max(one).parts();
    let s = (m - one) / (m + one);
    let square = s * s;
    let mut sum = s.zero();
    for term in [9.0, 7.0, 5.0, 3.0, 1.0] {
        sum = sum * square + s.same(1.0 / term);
    }
    exponent + s * sum.times(2.0 / std::f32::consts::LN_2)
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

#[cfg(test)]
mod tests;
