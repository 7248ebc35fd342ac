//! Texture coordinates of points on surfaces.

use std::f32::consts::{PI, TAU};

use glam::{DVec2, DVec3, Mat3, Vec2, Vec3};

use crate::math::float::{dot, dot_f64, normalize};

/// The coordinates of a point on a sphere, from its unit normal: u around +y from behind (-z), v
/// up.
#[inline]
pub fn sphere_uv(normal: Vec3) -> Vec2 {
    let u = 0.5 + libm::atan2f(normal.x, normal.z) / TAU;
    let v = 0.5 + libm::asinf(normal.y.clamp(-1.0, 1.0)) / PI;
    Vec2::new(u, v)
}

/// The change of the coordinates of [`sphere_uv`] if the unit normal changes by `turn`.
///
/// All u meet at a pole, so the derivative is unbounded nearby. The change of u is therefore the
/// angle that `turn` subtends from the axis: the derivative if `turn` is short, and at most a
/// quarter of a turn, the value for a step away from the pole itself. The seam of u behind the
/// sphere does not matter here.
pub fn sphere_uv_change(normal: Vec3, turn: Vec3) -> Vec2 {
    let turn = turn.as_dvec3();
    let (along_parallel, along_meridian, from_axis) = directions(normal);
    let u = libm::atan2(dot_f64(turn, along_parallel), from_axis) / std::f64::consts::TAU;
    let v = dot_f64(turn, along_meridian) / std::f64::consts::PI;
    DVec2::new(u, v).as_vec2()
}

/// The directions in which the coordinates of [`sphere_uv`] grow at a point with this unit normal:
/// two orthogonal unit vectors, perpendicular to it. At a pole, where all u meet, that of u is +x.
pub fn sphere_directions(normal: Vec3) -> [Vec3; 2] {
    let (along_parallel, along_meridian, _) = directions(normal);
    [along_parallel, along_meridian].map(|direction| direction.as_vec3())
}

/// The directions along the parallel and the meridian, and the distance from the axis.
fn directions(normal: Vec3) -> (DVec3, DVec3, f64) {
    let n = normal.as_dvec3();
    let from_axis = (n.x * n.x + n.z * n.z).sqrt();
    let (sin, cos) = if from_axis > 0.0 { (n.x / from_axis, n.z / from_axis) } else { (0.0, 1.0) };
    let along_meridian = DVec3::new(-sin * n.y, from_axis, -cos * n.y);
    (DVec3::new(cos, 0.0, -sin), along_meridian, from_axis)
}

/// How points of a shape become texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UvMap {
    /// From the normal, rotated into the sphere's own space.
    Sphere(Mat3),
    /// By projection.
    Planar(PlanarMap),
    /// From the corners of the mesh's triangles.
    Mesh,
}

/// An affine change of texture coordinates before a look-up: a matrix `turned` and an offset
/// `moved`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// The rows of the matrix.
    pub turned: [Vec2; 2],
    /// The offset added to the product.
    pub moved: Vec2,
}

impl Placing {
    /// The coordinates for the look-up.
    #[inline]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        self.change(uv) + self.moved
    }

    /// The change of these coordinates with the surface's own.
    #[inline]
    pub fn change(&self, uv: Vec2) -> Vec2 {
        let [u, v] = self.turned;
        Vec2::new(u.x * uv.x + u.y * uv.y, v.x * uv.x + v.y * uv.y)
    }
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

    /// The unit directions in which the coordinates grow; zero for coordinates that do not.
    pub fn directions(&self) -> [Vec3; 2] {
        [normalize(self.u), normalize(self.v)]
    }

    /// The coordinates of `point`.
    #[inline]
    pub fn uv(&self, point: Vec3) -> Vec2 {
        self.change(point - self.origin)
    }

    /// The change of the coordinates for a step of the point.
    #[inline]
    pub fn change(&self, step: Vec3) -> Vec2 {
        Vec2::new(dot(step, self.u), dot(step, self.v))
    }
}
