//! The meeting of a ray and a triangle without rounding: the definition, and the reference.
//!
//! With o the origin and d the direction of the ray and a, b, c the corners, the ray passes the
//! edge from p to q on the side given by the sign of det(p - o, q - o, d). The three add up to
//! det(b - a, c - a, d), and t is det(a - o, b - o, c - o) over that sum. A ray that passes an edge
//! or a corner meets every triangle there; one in the triangle's plane meets nothing, and nothing
//! meets a triangle without area.

use std::cmp::Ordering;

use glam::{DVec3, Vec3};

use crate::math::Ray;
use crate::math::exact::{Comparable, Expansion, Quotient, cross, determinant, exact};

/// Three exact coordinates.
type Expansion3 = [Expansion; 3];

fn difference(p: Vec3, o: Vec3) -> Expansion3 {
    [0, 1, 2].map(|k| &Expansion::from(p[k]) - &Expansion::from(o[k]))
}

/// A ray and a triangle, as seen from the origin of the ray.
struct ShiftedPair {
    direction: Expansion3,
    corners: [Expansion3; 3],
}

impl ShiftedPair {
    fn new(ray: &Ray, triangle: &[Vec3; 3]) -> Self {
        Self {
            direction: exact(ray.direction),
            corners: triangle.map(|corner| difference(corner, ray.origin)),
        }
    }

    /// On which side of the edges opposite to the corners the ray passes.
    fn sides(&self) -> [Expansion; 3] {
        let [a, b, c] = &self.corners;
        [(b, c), (c, a), (a, b)].map(|(p, q)| determinant(p, q, &self.direction))
    }

    /// On which side of the edge opposite to a corner a ray that meets its line passes, once its
    /// origin is moved: see [`crossing`].
    fn moved_side(&self, corner: usize) -> Ordering {
        let [p, q] = [1, 2].map(|next| &self.corners[(corner + next) % 3]);
        let along = [0, 1, 2].map(|k| &p[k] - &q[k]);
        let d = &self.direction;
        let component = |i: usize, j: usize| (&(&along[i] * &d[j]) - &(&along[j] * &d[i])).sign();
        component(1, 2).then_with(|| component(2, 0)).then_with(|| component(0, 1))
    }

    /// t at the triangle's plane, given the sides; `None` if the ray is parallel to it.
    fn t(&self, [a, b, c]: &[Expansion; 3]) -> Option<Quotient> {
        let [u, v, w] = &self.corners;
        Quotient::new(determinant(u, v, w), &(a + b) + c)
    }
}

/// The t at which the line of `ray` meets the closed `triangle`.
pub fn meeting(ray: &Ray, triangle: &[Vec3; 3]) -> Option<Quotient> {
    let pair = ShiftedPair::new(ray, triangle);
    let sides = pair.sides();
    let any = |sign| sides.iter().any(|side| side.sign() == sign);
    if any(Ordering::Less) && any(Ordering::Greater) {
        return None;
    }
    pair.t(&sides)
}

/// The t at which `ray` meets the closed `triangle` within its range, from either side, rounded
/// once.
pub fn meet(ray: &Ray, triangle: &[Vec3; 3]) -> Option<f32> {
    let t = meeting(ray, triangle)?;
    t.is_within([ray.t_min, ray.t_max]).then(|| t.rounded())
}

/// The t at which `ray` crosses `triangle` within its range, rounded once: it meets it still if its
/// origin is moved by an infinitesimal step along x, by an infinitesimal part of that along y, and by
/// such a part again along z (Edelsbrunner and Mücke, *Simulation of Simplicity*, 1990).
///
/// The moved ray passes no edge and no corner, so of the triangles around one the ray crosses those
/// that it would cross beside it: a closed surface is left as often as it is entered. The step e adds
/// e . ((p - q) x d) to the determinant of the edge from p to q, which is zero only for an edge along
/// the ray, whose triangle the ray does not meet.
pub fn crossing(ray: &Ray, triangle: &[Vec3; 3]) -> Option<f32> {
    let pair = ShiftedPair::new(ray, triangle);
    let sides = pair.sides();
    let range = [ray.t_min, ray.t_max];
    let t = pair.t(&sides).filter(|t| t.is_within(range))?;
    let sign = |edge: usize| sides[edge].sign().then_with(|| pair.moved_side(edge));
    (sign(0) == sign(1) && sign(1) == sign(2)).then(|| t.rounded())
}

/// The t at which `ray` meets the plane of `triangle`, without regard to its range; `None` if they
/// are parallel.
pub fn plane(ray: &Ray, triangle: &[Vec3; 3]) -> Option<Quotient> {
    let [a, b, c] = *triangle;
    Quotient::at_plane(ray, &cross(&difference(b, a), &difference(c, a)), a)
}

/// Barycentric coordinates of the point at which the line of a ray meets a triangle's plane, each
/// within a few ulp; `None` if they are parallel.
pub fn barycentric(ray: &Ray, triangle: &[Vec3; 3]) -> Option<DVec3> {
    let sides = ShiftedPair::new(ray, triangle).sides();
    let sum = (&(&sides[0] + &sides[1]) + &sides[2]).value();
    (sum != 0.0).then(|| DVec3::from(sides.map(|side| side.value())) / sum)
}
