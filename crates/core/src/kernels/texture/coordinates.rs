//! Texture coordinates of points on surfaces.

use std::f32::consts::{PI, TAU};

use glam::{Mat3, Vec2, Vec3};

use crate::math::float::{dot_f64, normalize};
use crate::math::{Real, Single, Vector, both};

/// The coordinates of points on a sphere, from their unit normals: u around +y from behind (-z), v
/// up.
#[inline(always)]
pub fn sphere_uv<F: Single>(normal: Vector<F>) -> [F; 2] {
    let [mut u, mut v] = [normal.x, normal.y];
    for lane in 0..F::LANES {
        let Vec3 { x, y, z } = normal.lane(lane);
        u.set_lane(lane, 0.5 + libm::atan2f(x, z) / TAU);
        v.set_lane(lane, 0.5 + libm::asinf(y.clamp(-1.0, 1.0)) / PI);
    }
    [u, v]
}

/// The changes of the coordinates of [`sphere_uv`] if the unit normals change by `turn`.
///
/// All u meet at a pole, so the derivative is unbounded nearby. The change of u is therefore the
/// angle that `turn` subtends from the axis: the derivative if `turn` is short, and at most a
/// quarter of a turn, the value for a step away from the pole itself. The seam of u behind the
/// sphere does not matter here.
#[inline(always)]
pub fn sphere_uv_change<F: Single>(normal: Vector<F>, turn: Vector<F>) -> [F; 2] {
    let turn = turn.widen();
    let (along_parallel, along_meridian, from_axis) = directions::<F>(normal);
    let mut u = turn.dot(along_parallel);
    for lane in 0..F::LANES {
        u.set_lane(lane, libm::atan2(u.lane(lane), from_axis.lane(lane)));
    }
    let v = turn.dot(along_meridian);
    [F::narrow(u / u.same(std::f64::consts::TAU)), F::narrow(v / v.same(std::f64::consts::PI))]
}

/// The directions in which the coordinates of [`sphere_uv`] grow at points with these unit normals:
/// two orthogonal unit vectors, perpendicular to each. At a pole, where all u meet, that of u is +x.
#[inline(always)]
pub fn sphere_directions<F: Single>(normal: Vector<F>) -> [Vector<F>; 2] {
    let (along_parallel, along_meridian, _) = directions::<F>(normal);
    [Vector::narrow(along_parallel), Vector::narrow(along_meridian)]
}

/// The directions along the parallel and the meridian, and the distance from the axis.
#[inline(always)]
fn directions<F: Single>(normal: Vector<F>) -> (Vector<F::Double>, Vector<F::Double>, F::Double) {
    let n = normal.widen();
    let (zero, one) = (n.x.zero(), n.x.same(1.0));
    let from_axis = (n.x * n.x + n.z * n.z).sqrt();
    let is_aside = from_axis.gt(zero);
    let sin = F::Double::select(is_aside, n.x / from_axis, zero);
    let cos = F::Double::select(is_aside, n.z / from_axis, one);
    let along_meridian = Vector::new(-sin * n.y, from_axis, -cos * n.y);
    (Vector::new(cos, zero, -sin), along_meridian, from_axis)
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
    #[inline(always)]
    pub fn apply<F: Single>(&self, uv: [F; 2]) -> [F; 2] {
        let [u, v] = self.change(uv);
        [u + u.same(self.moved.x), v + v.same(self.moved.y)]
    }

    /// The change of these coordinates with the surface's own.
    #[inline(always)]
    pub fn change<F: Single>(&self, [u, v]: [F; 2]) -> [F; 2] {
        let [along, up] = self.turned;
        [u.times(along.x) + v.times(along.y), u.times(up.x) + v.times(up.y)]
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

    /// The coordinates of points.
    #[inline(always)]
    pub fn uv<F: Single>(&self, point: Vector<F>) -> [F; 2] {
        self.change(point - Vector::splat(point.x.token(), self.origin))
    }

    /// The changes of the coordinates for steps of the points.
    #[inline(always)]
    pub fn change<F: Single>(&self, step: Vector<F>) -> [F; 2] {
        both(
            [self.u, self.v],
            #[inline(always)]
            |edge| step.dot(Vector::splat(step.x.token(), edge)),
        )
    }
}
