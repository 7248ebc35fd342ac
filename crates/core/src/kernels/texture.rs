//! Texture coordinates and texture look-up.

mod lazy;
mod pyramid;

use std::f32::consts::{PI, TAU};

use glam::{DVec2, DVec3, Mat3, Vec2, Vec3};

use crate::math::float::{dot, dot_f64};
pub use lazy::LazyImage;
use pyramid::Level;

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

wavecrest_base::choices! {
    /// How a coordinate outside 0 to 1 is taken.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Wrap {
        /// The image repeats.
        #[default]
        Repeat = "repeat",
        /// The edge of the image goes on.
        Clamp = "clamp",
    }
}

/// An image's texels, linear, top row first.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8 bits a channel, 255 being 1; the fourth byte is padding.
    Bytes(Vec<[u8; 4]>),
    /// 8 bits a channel again, each byte standing for the value that its channel has there in a table:
    /// what is encoded with a curve, or tinted, takes no more room than what is neither.
    Levels(Vec<[u8; 4]>, Box<[Vec3; 256]>),
    /// Floating point, for formats of more than 8 bits.
    Floats(Vec<[f32; 3]>),
}

/// An image made ready for look-ups.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Its width in texels, at least 1.
    pub width: u32,
    /// Its height in texels, at least 1.
    pub height: u32,
    /// `width` times `height` of them.
    pub texels: Texels,
    /// The levels of the pyramid above the texels, down to one texel; none where it is not built.
    levels: Vec<Level>,
}

impl Image {
    /// An image without pyramid. `width` and `height` are at least 1, and there are as many
    /// `texels` as they say.
    pub fn new(width: u32, height: u32, texels: Texels) -> Self {
        Self { width, height, texels, levels: Vec::new() }
    }

    /// Builds the pyramid, unless it is there: see [`pyramid`].
    pub fn build_pyramid(&mut self) {
        if self.levels.is_empty() {
            self.levels = pyramid::levels(self.width, self.height, |x, y| self.texel(x, y));
        }
    }

    /// Bytes held, those of the pyramid counted.
    pub fn bytes(&self) -> usize {
        let texels = match &self.texels {
            Texels::Bytes(texels) => size_of_val(texels.as_slice()),
            Texels::Levels(texels, values) => {
                size_of_val(texels.as_slice()) + size_of_val(values.as_slice())
            }
            Texels::Floats(texels) => size_of_val(texels.as_slice()),
        };
        texels + self.levels.iter().map(Level::bytes).sum::<usize>()
    }

    /// The greatest level of detail: 0 without a pyramid.
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
    /// image. Coordinates that are not finite count as 0. Trilinear, where nothing is said of a
    /// level, is bilinear.
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

    /// The level of detail for a look-up that stands for a parallelogram, whose sides in texture
    /// coordinates are `footprint`: the binary logarithm of the longer side in texels, from 0 to
    /// [`Image::coarsest`] (Williams, *Pyramidal Parametrics*, SIGGRAPH 1983; the longer side as in
    /// Heckbert, *Survey of Texture Mapping*, 1986). What is longer on one side than on the other
    /// is thus rather blurred than aliased. Where a side is not finite, as where a ray grazes its
    /// surface, the level is the coarsest.
    pub fn level(&self, footprint: &[Vec2; 2]) -> f32 {
        let coarsest = self.coarsest() as f32;
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        // No square of a single-precision number overflows in double precision.
        let [x, y] = footprint.map(|side| (side.as_dvec2() * size).length_squared());
        if !(x.is_finite() && y.is_finite()) {
            return coarsest;
        }
        let longer = if x > y { x } else { y };
        // The logarithm of 0 is infinite, below every level.
        (0.5 * libm::log2(longer)).clamp(0.0, f64::from(coarsest)) as f32
    }

    /// The colour at `uv`, bilinear in the level of detail and, where that lies between two levels,
    /// linear between their answers; and the number of texels read, 4 or 8. A level below 0 counts
    /// as 0; one above [`Image::coarsest`], or one that is no number, as that.
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

    /// As [`Image::look_up_at`] of a whole number.
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

    /// Number of levels that one look-up reads at most.
    pub fn levels(self) -> u64 {
        match self {
            Self::Nearest | Self::Bilinear => 1,
            Self::Trilinear => 2,
        }
    }
}

/// The four texels about `uv` of an image of this size, weighted.
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

/// From `a` to `b` by `fraction`, below 1. Between equal colours it is that colour: the weights, once
/// rounded, need not add up to 1.
#[inline]
fn mix(a: Vec3, b: Vec3, fraction: f32) -> Vec3 {
    if a == b { a } else { a.lerp(b, fraction) }
}

/// The place of `coordinate` along `count` texels: in \[0, count\].
#[inline]
fn position(coordinate: f32, count: u32, wrap: Wrap) -> f32 {
    let coordinate = if coordinate.is_finite() { coordinate } else { 0.0 };
    let fraction = match wrap {
        // The far edge is the end of the image, not the start of the next one.
        Wrap::Repeat if coordinate == 1.0 => 1.0,
        Wrap::Repeat => coordinate - coordinate.floor(),
        Wrap::Clamp => coordinate.clamp(0.0, 1.0),
    };
    fraction * count as f32
}

/// The texel at or below `x`, within bounds.
#[inline]
fn below(x: f32, count: u32) -> u32 {
    (x as u32).min(count - 1)
}

/// The two texels whose centres `x` lies between, and how far it is from the first to the second.
#[inline]
fn neighbours(x: f32, count: u32, wrap: Wrap) -> (u32, u32, f32) {
    let from_centre = x - 0.5;
    let floor = from_centre.floor();
    let fraction = from_centre - floor;
    let first = floor as i64;
    let bound = |i: i64| match wrap {
        Wrap::Repeat => i.rem_euclid(i64::from(count)) as u32,
        Wrap::Clamp => i.clamp(0, i64::from(count) - 1) as u32,
    };
    (bound(first), bound(first + 1), fraction)
}

/// The coordinates of a sphere's point, from its unit normal: u about +y from behind (-z), v up.
#[inline]
pub fn sphere_uv(normal: Vec3) -> Vec2 {
    let u = 0.5 + libm::atan2f(normal.x, normal.z) / TAU;
    let v = 0.5 + libm::asinf(normal.y.clamp(-1.0, 1.0)) / PI;
    Vec2::new(u, v)
}

/// How the coordinates of [`sphere_uv`] change where the normal, of unit length, changes by `turn`.
///
/// All u meet at a pole, so that near it their derivative has no bound. The change of u is therefore
/// the angle that `turn` is seen under from the axis: the derivative where `turn` is short, and a
/// quarter of a turn at most, which is what a step away from the pole itself is taken for. That u
/// begins again behind the sphere changes nothing here.
pub fn sphere_uv_change(normal: Vec3, turn: Vec3) -> Vec2 {
    let (n, turn) = (normal.as_dvec3(), turn.as_dvec3());
    let from_axis = (n.x * n.x + n.z * n.z).sqrt();
    let (sin, cos) = if from_axis > 0.0 { (n.x / from_axis, n.z / from_axis) } else { (0.0, 1.0) };
    let along_parallel = DVec3::new(cos, 0.0, -sin);
    let along_meridian = DVec3::new(-sin * n.y, from_axis, -cos * n.y);
    let u = libm::atan2(dot_f64(turn, along_parallel), from_axis) / std::f64::consts::TAU;
    let v = dot_f64(turn, along_meridian) / std::f64::consts::PI;
    DVec2::new(u, v).as_vec2()
}

/// How points of a shape become texture coordinates.
#[derive(Clone, Copy, Debug)]
pub enum UvMap {
    /// From the normal, turned back into the sphere's own space.
    Sphere(Mat3),
    /// By projection.
    Planar(PlanarMap),
    /// From the corners of the mesh's triangles.
    Mesh,
}

/// Texture coordinates on a plane: projections on two of its edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarMap {
    origin: Vec3,
    /// Each edge divided by the square of its length.
    u: Vec3,
    v: Vec3,
}

impl PlanarMap {
    /// The map with u = 1 at `origin + u_edge` and v = 1 at `origin + v_edge`.
    pub fn new(origin: Vec3, u_edge: Vec3, v_edge: Vec3) -> Self {
        let scaled = |edge: Vec3| {
            let e = edge.as_dvec3();
            (e / dot_f64(e, e).max(f64::MIN_POSITIVE)).as_vec3()
        };
        Self { origin, u: scaled(u_edge), v: scaled(v_edge) }
    }

    /// The coordinates of `point`.
    #[inline]
    pub fn uv(&self, point: Vec3) -> Vec2 {
        self.change(point - self.origin)
    }

    /// How the coordinates change with the point.
    #[inline]
    pub fn change(&self, step: Vec3) -> Vec2 {
        Vec2::new(dot(step, self.u), dot(step, self.v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red grows along x by tenths, green down y.
    fn gradient(width: u32, height: u32) -> Image {
        let texel = |i: u32| [(i % width) as f32 / 10.0, (i / width) as f32 / 10.0, 0.0];
        let texels = (0..width * height).map(texel).collect();
        Image::new(width, height, Texels::Floats(texels))
    }

    #[test]
    fn v_runs_from_bottom_to_top() {
        let image = gradient(4, 4);
        let at = |u, v| image.look_up(Vec2::new(u, v), Filter::Nearest, Wrap::Repeat);
        assert_eq!(at(0.0, 1.0), Vec3::new(0.0, 0.0, 0.0));
        assert_eq!(at(1.0, 0.0), Vec3::new(0.3, 0.3, 0.0));
    }

    #[test]
    fn bilinear_meets_the_texel_at_its_centre_and_averages_between() {
        let image = gradient(4, 1);
        let at = |u| image.look_up(Vec2::new(u, 0.5), Filter::Bilinear, Wrap::Repeat).x;
        assert_eq!(at(0.375), 0.1);
        assert!((at(0.5) - 0.15).abs() < 1e-6);
        assert!((at(0.0) - 0.15).abs() < 1e-6, "the seam averages the first and the last");
        assert_eq!(image.look_up(Vec2::new(0.0, 0.5), Filter::Bilinear, Wrap::Clamp).x, 0.0);
    }

    #[test]
    fn hc30_every_coordinate_is_in_bounds() {
        let mut image = gradient(3, 5);
        image.build_pyramid();
        let odd = [
            0.0,
            1.0,
            -f32::EPSILON,
            -1e-30,
            1e6,
            -1e6,
            1e30,
            f32::NAN,
            f32::INFINITY,
            0.999_999_94,
        ];
        for &u in &odd {
            for &v in &odd {
                for wrap in [Wrap::Repeat, Wrap::Clamp] {
                    for filter in [Filter::Nearest, Filter::Bilinear] {
                        assert!(image.look_up(Vec2::new(u, v), filter, wrap).is_finite());
                    }
                    for &level in &odd {
                        assert!(image.look_up_at(Vec2::new(u, v), level, wrap).0.is_finite());
                    }
                }
            }
        }
    }

    #[test]
    fn the_level_is_the_logarithm_of_the_longer_side_in_texels() {
        let mut image = gradient(64, 32);
        let level = |image: &Image, x: [f32; 2], y: [f32; 2]| {
            image.level(&[Vec2::from(x) / 64.0, Vec2::from(y) / 32.0])
        };
        assert_eq!(level(&image, [64.0, 0.0], [0.0, 32.0]), 0.0, "without a pyramid");
        image.build_pyramid();
        assert_eq!(image.coarsest(), 6);
        assert_eq!(level(&image, [1.0, 0.0], [0.0, 0.5]), 0.0);
        assert_eq!(level(&image, [0.3, 0.0], [0.0, 0.5]), 0.0);
        assert_eq!(level(&image, [0.0, 0.0], [0.0, 0.0]), 0.0);
        assert_eq!(level(&image, [2.0, 0.0], [0.0, 0.5]), 1.0);
        assert_eq!(level(&image, [-2.0, 0.0], [0.0, 4.0]), 2.0, "v counts in rows");
        assert_eq!(level(&image, [1e30, 0.0], [0.0, 0.5]), 6.0);
        for side in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            assert_eq!(level(&image, [1.0, 0.0], [side, 0.0]), 6.0, "{side}");
            assert_eq!(level(&image, [1.0, side], [1.0, 0.0]), 6.0, "{side}");
        }
    }

    #[test]
    fn levels_are_bilinear_and_between_them_linear() {
        let mut image = gradient(7, 5);
        image.build_pyramid();
        let uv = Vec2::new(0.4, 0.7);
        let at = |level| image.look_up_at(uv, level, Wrap::Repeat);
        let finest = image.look_up(uv, Filter::Bilinear, Wrap::Repeat);
        for below in [0.0, -1.0, f32::NEG_INFINITY] {
            assert_eq!(at(below), (finest, 4));
        }
        // The mean of 0 to 0.6 and of 0 to 0.4.
        let (mean, texels) = at(2.0);
        assert!(mean.distance(Vec3::new(0.3, 0.2, 0.0)) < 1e-6 && texels == 4, "{mean}");
        for above in [2.5, 1e30, f32::INFINITY, f32::NAN] {
            assert_eq!(at(above), (mean, 4));
        }
        let (half, texels) = at(0.5);
        assert!(half.distance((finest + at(1.0).0) / 2.0) < 1e-6 && texels == 8, "{half}");
        assert_eq!(gradient(7, 5).look_up_at(uv, 1.5, Wrap::Repeat), (finest, 4), "no pyramid");
    }

    #[test]
    fn maps_put_the_corners_where_they_belong() {
        assert_eq!(sphere_uv(Vec3::Z), Vec2::splat(0.5));
        assert!((sphere_uv(Vec3::X) - Vec2::new(0.75, 0.5)).length() < 1e-6);
        assert!((sphere_uv(Vec3::Y).y - 1.0).abs() < 1e-6);
        let map = PlanarMap::new(Vec3::ONE, Vec3::X * 4.0, Vec3::Y * 2.0);
        assert_eq!(map.uv(Vec3::new(3.0, 2.0, 1.0)), Vec2::splat(0.5));
    }
}
