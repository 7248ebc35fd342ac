//! Texture coordinates and texture look-up.

mod coordinates;
mod lazy;
mod pyramid;
mod wrap;

use glam::{DVec2, Vec2, Vec3};

use pyramid::MipLevel;
use wrap::{below, neighbours, position};

pub use coordinates::{Placing, PlanarMap, UvMap, sphere_directions, sphere_uv, sphere_uv_change};
pub use lazy::LazyImage;
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
    /// The levels of the pyramid above the texels, down to one texel; empty if it is not built.
    levels: Vec<MipLevel>,
}

impl Image {
    /// An image without a pyramid. `width` and `height` are at least 1, and there are `width` times
    /// `height` `texels`.
    pub fn new(width: u32, height: u32, texels: Texels) -> Self {
        Self { width, height, texels, levels: Vec::new() }
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
        texels + self.levels.iter().map(MipLevel::bytes).sum::<usize>()
    }

    /// The coarsest level of detail: 0 without a pyramid.
    pub fn coarsest(&self) -> u32 {
        self.levels.len() as u32
    }

    #[inline]
    fn texel(&self, x: u32, y: u32) -> Vec3 {
        let index = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Bytes(texels) => {
                let [r, g, b, _] = texels[index];
                Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0
            }
            Texels::Levels(texels, values) => {
                let [r, g, b, _] = texels[index].map(usize::from);
                Vec3::new(values[r].x, values[g].y, values[b].z)
            }
            Texels::Floats(texels) => Vec3::from(texels[index]),
        }
    }

    /// The colour at `uv`: u from left to right, v from bottom to top, both 0 to 1 across the
    /// image. Coordinates that are not finite count as 0. Without a level, trilinear look-ups are
    /// bilinear.
    #[inline]
    pub fn look_up(&self, uv: Vec2, filter: Filter, wrap: Wrap) -> Vec3 {
        match filter {
            Filter::Nearest => {
                let x = position(uv.x, self.width, wrap);
                let y = position(1.0 - uv.y, self.height, wrap);
                self.texel(below(x, self.width), below(y, self.height))
            }
            Filter::Bilinear | Filter::Trilinear => {
                bilinear([self.width, self.height], uv, wrap, |x, y| self.texel(x, y))
            }
        }
    }

    /// The level of detail for a look-up over a parallelogram with the sides `footprint` in texture
    /// coordinates: the binary logarithm of the longer side in texels, from 0 to
    /// [`Image::coarsest`] (Williams, *Pyramidal Parametrics*, SIGGRAPH 1983; the longer side as in
    /// Heckbert, *Survey of Texture Mapping*, 1986). Elongated footprints are thus blurred rather
    /// than aliased. If a side is not finite, as at grazing angles, the level is the coarsest.
    pub fn level(&self, footprint: &[Vec2; 2]) -> f32 {
        let coarsest = self.coarsest() as f32;
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        // No square of a single-precision number overflows in double precision.
        let [x, y] = footprint.map(|side| (side.as_dvec2() * size).length_squared());
        if !(x.is_finite() && y.is_finite()) {
            return coarsest;
        }
        let longer = if x > y { x } else { y };
        // The logarithm of 0 is negative infinity, below every level.
        (0.5 * libm::log2(longer)).clamp(0.0, f64::from(coarsest)) as f32
    }

    /// The colour at `uv`, bilinear in the level of detail and linear between two levels; with the
    /// number of texels read, 4 or 8. Levels below 0 count as 0; levels above [`Image::coarsest`]
    /// and NaN count as that.
    pub fn look_up_at(&self, uv: Vec2, level: f32, wrap: Wrap) -> (Vec3, u64) {
        let coarsest = self.coarsest() as f32;
        let level = if level < coarsest { level.max(0.0) } else { coarsest };
        let finer = level.floor();
        let color = self.look_up_in(finer as usize, uv, wrap);
        if level == finer {
            return (color, TEXELS_BETWEEN);
        }
        let coarser = self.look_up_in(finer as usize + 1, uv, wrap);
        (mix(color, coarser, level - finer), 2 * TEXELS_BETWEEN)
    }

    /// As [`Image::look_up_at`], for a whole level.
    #[inline]
    fn look_up_in(&self, level: usize, uv: Vec2, wrap: Wrap) -> Vec3 {
        match level.checked_sub(1).and_then(|above| self.levels.get(above)) {
            None => self.look_up(uv, Filter::Bilinear, wrap),
            Some(level) => bilinear(level.size, uv, wrap, |x, y| level.texel(x, y)),
        }
    }
}

/// Texels that a bilinear look-up reads.
const TEXELS_BETWEEN: u64 = 4;

impl Filter {
    /// Number of texels that one look-up in one level reads.
    pub fn texels(self) -> u64 {
        match self {
            Self::Nearest => 1,
            Self::Bilinear | Self::Trilinear => TEXELS_BETWEEN,
        }
    }

    /// Largest number of levels that one look-up reads.
    pub fn levels(self) -> u64 {
        match self {
            Self::Nearest | Self::Bilinear => 1,
            Self::Trilinear => 2,
        }
    }
}

/// The four texels around `uv` in an image of this size, weighted.
#[inline]
fn bilinear(
    [width, height]: [u32; 2],
    uv: Vec2,
    wrap: Wrap,
    texel: impl Fn(u32, u32) -> Vec3,
) -> Vec3 {
    let (x0, x1, fx) = neighbours(position(uv.x, width, wrap), width, wrap);
    let (y0, y1, fy) = neighbours(position(1.0 - uv.y, height, wrap), height, wrap);
    let top = mix(texel(x0, y0), texel(x1, y0), fx);
    let bottom = mix(texel(x0, y1), texel(x1, y1), fx);
    mix(top, bottom, fy)
}

/// From `a` to `b` by `fraction`, below 1. Between equal colours the result is that colour,
/// although rounded weights need not add up to 1.
#[inline]
fn mix(a: Vec3, b: Vec3, fraction: f32) -> Vec3 {
    if a == b { a } else { a.lerp(b, fraction) }
}

#[cfg(test)]
mod tests;
