//! Texture coordinates and texture look-up.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use crate::math::float::{dot, dot_f64};

/// How a look-up between texels is answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The texel that the point lies in.
    Nearest,
    /// The four texels around the point, weighted.
    #[default]
    Bilinear,
}

impl Filter {
    /// Every filter, from the plainest on.
    pub const ALL: [Self; 2] = [Self::Nearest, Self::Bilinear];

    /// What scene files call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Bilinear => "bilinear",
        }
    }

    /// Number of texels that one look-up reads.
    pub fn texels(self) -> u64 {
        match self {
            Self::Nearest => 1,
            Self::Bilinear => 4,
        }
    }
}

/// How a coordinate outside 0 to 1 is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// The edge of the image goes on.
    Clamp,
}

/// An image's texels, linear, top row first.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8 bits a channel, 255 being 1; the fourth byte is padding.
    Bytes(Vec<[u8; 4]>),
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
}

impl Image {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Bytes(texels) => size_of_val(texels.as_slice()),
            Texels::Floats(texels) => size_of_val(texels.as_slice()),
        }
    }

    #[inline]
    fn texel(&self, x: u32, y: u32) -> Vec3 {
        let index = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Bytes(texels) => {
                let [r, g, b, _] = texels[index];
                Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0
            }
            Texels::Floats(texels) => Vec3::from(texels[index]),
        }
    }

    /// The colour at `uv`: u from left to right, v from bottom to top, both 0 to 1 across the
    /// image. Coordinates that are not finite count as 0.
    #[inline]
    pub fn look_up(&self, uv: Vec2, filter: Filter, wrap: Wrap) -> Vec3 {
        let x = position(uv.x, self.width, wrap);
        let y = position(1.0 - uv.y, self.height, wrap);
        match filter {
            Filter::Nearest => self.texel(below(x, self.width), below(y, self.height)),
            Filter::Bilinear => {
                let (x0, x1, fx) = neighbours(x, self.width, wrap);
                let (y0, y1, fy) = neighbours(y, self.height, wrap);
                let top = self.texel(x0, y0).lerp(self.texel(x1, y0), fx);
                let bottom = self.texel(x0, y1).lerp(self.texel(x1, y1), fx);
                top.lerp(bottom, fy)
            }
        }
    }
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
        let p = point - self.origin;
        Vec2::new(dot(p, self.u), dot(p, self.v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red grows along x by tenths, green down y.
    fn gradient(width: u32, height: u32) -> Image {
        let texel = |i: u32| [(i % width) as f32 / 10.0, (i / width) as f32 / 10.0, 0.0];
        Image { width, height, texels: Texels::Floats((0..width * height).map(texel).collect()) }
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
        let image = gradient(3, 5);
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
                for filter in [Filter::Nearest, Filter::Bilinear] {
                    for wrap in [Wrap::Repeat, Wrap::Clamp] {
                        assert!(image.look_up(Vec2::new(u, v), filter, wrap).is_finite());
                    }
                }
            }
        }
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
