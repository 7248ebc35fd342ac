//! Hits on triangles in integers, computed without rounding and without code of the kernels.
//!
//! The side of an edge on which a ray passes is the sign of a determinant, and t the quotient of
//! two: fractions whose parts fit 64 bits if all coordinates are below [`LARGEST`].

use glam::{I64Vec3, Vec3};

use wavecrest_core::accel::Hit;
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::kernels::triangle::T_TOLERANCE;
use wavecrest_core::math::ray::Ray;

/// Limit of coordinates and components of directions: determinants are then below 2^53.
const LARGEST: f32 = 32_768.0;

/// A ray that passes an edge within this share of the coordinates may hit either side of it: a few
/// times the rounding of single precision.
const BESIDE: f64 = 1.0 / (1_u32 << 18) as f64;

/// Hits beside an edge may be later than the first certain one by this share of t.
const LATER: f32 = 1e-3;

/// A triangle that a ray does not certainly miss.
struct Candidate {
    number: u32,
    /// Infinite if the ray is in the triangle's plane.
    t: f64,
    /// Whether it certainly meets the triangle.
    is_certain: bool,
}

/// The expected hit of a ray.
pub(super) struct Expected {
    /// The first certain hit: at the smallest t, rounded once, the lowest number.
    pub(super) first: Hit,
    /// Other triangles that rounding may put first: those whose edges the ray passes closely.
    beside: Vec<u32>,
}

/// Triangles with integer corners.
pub(super) struct Triangles(Vec<[I64Vec3; 3]>);

fn whole(v: Vec3) -> I64Vec3 {
    debug_assert!(v == v.round() && v.abs().max_element() < LARGEST, "{v}");
    v.as_i64vec3()
}

impl Triangles {
    /// The triangles of a geometry.
    pub(super) fn of(geometry: &Geometry) -> Self {
        let corners = |i| geometry.triangle(i).map(whole);
        Self((0..geometry.triangles.len()).map(corners).collect())
    }

    /// The expected hit of `ray`, which has integer coordinates too.
    pub(super) fn met_by(&self, ray: &Ray) -> Expected {
        let (origin, direction) = (whole(ray.origin), whole(ray.direction));
        let candidates = (0..).zip(&self.0).filter_map(|(number, triangle)| {
            candidate(number, triangle.map(|corner| corner - origin), origin, direction)
        });
        let mut expected = Expected { first: Hit::MISS, beside: Vec::new() };
        for candidate in candidates {
            let hit = Hit { t: candidate.t as f32, primitive: candidate.number };
            if !candidate.is_certain {
                expected.beside.push(candidate.number);
            } else if hit.t < expected.first.t {
                expected.first = hit;
            }
        }
        expected
    }
}

/// The triangle with these `corners`, relative to the `origin` of a ray, unless the ray certainly
/// misses it.
fn candidate(
    number: u32,
    corners: [I64Vec3; 3],
    origin: I64Vec3,
    direction: I64Vec3,
) -> Option<Candidate> {
    let [a, b, c] = corners;
    let edges = [[b, c], [c, a], [a, b]];
    let sides = edges.map(|[p, q]| direction.dot(p.cross(q)));
    let whole: i64 = sides.iter().sum();
    let is_outside = sides.iter().any(|s| *s < 0) && sides.iter().any(|s| *s > 0);
    let size = corners.iter().fold(origin.abs(), |size, p| size.max(p.abs())).max_element();
    let beside = BESIDE * size as f64;
    let is_beside = |([p, q], side): ([I64Vec3; 2], i64)| {
        (side as f64).abs() <= beside * (q - p).cross(direction).as_dvec3().length()
    };
    let is_doubtful = edges.into_iter().zip(sides).any(is_beside);
    if is_outside && !is_doubtful {
        return None;
    }
    let t = if whole == 0 { f64::INFINITY } else { a.dot(b.cross(c)) as f64 / whole as f64 };
    (t > 0.0).then_some(Candidate { number, t, is_certain: !is_doubtful && !is_outside })
}

impl Expected {
    /// The error of a hit, if any.
    pub(super) fn wrong(&self, hit: Hit) -> Option<String> {
        let Self { first, beside } = self;
        let is_right = if hit.primitive == first.primitive {
            hit.is_miss() || (hit.t - first.t).abs() <= T_TOLERANCE * first.t
        } else {
            beside.contains(&hit.primitive) && hit.t <= first.t * (1.0 + LATER)
        };
        (!is_right).then(|| format!("{hit:?} and not {first:?}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selftest::trees::add_triangle;

    #[test]
    fn the_first_at_the_least_t_is_expected() {
        let mut geometry = Geometry::default();
        for z in [4.0, 3.0, 3.0, -3.0] {
            let corners = [[-9.0, -9.0, z], [9.0, -9.0, z], [0.0, 9.0, z]];
            add_triangle(&mut geometry, corners.map(Vec3::from));
        }
        let triangles = Triangles::of(&geometry);
        let met = |x: f32, y: f32| triangles.met_by(&Ray::new(Vec3::new(x, y, 0.0), Vec3::Z * 2.0));
        let through = met(0.0, 0.0);
        assert_eq!(through.first, Hit { t: 1.5, primitive: 1 });
        assert!(through.wrong(Hit { t: 1.5, primitive: 1 }).is_none());
        for wrong in [(1.5, 2), (1.5001, 1), (2.0, 0)] {
            assert!(through.wrong(Hit { t: wrong.0, primitive: wrong.1 }).is_some(), "{wrong:?}");
        }
        assert!(through.wrong(Hit::MISS).is_some() && met(9.0, 9.0).wrong(Hit::MISS).is_none());
        // On an edge each of them may be hit, or none.
        let on_edge = met(0.0, -9.0);
        assert!(on_edge.first.is_miss() && on_edge.wrong(Hit { t: 2.0, primitive: 0 }).is_none());
    }
}
