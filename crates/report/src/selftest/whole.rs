//! Hits on triangles in integers, computed without rounding and without code of the kernels.
//!
//! The side of an edge on which a ray passes is the sign of a determinant, and t the quotient of
//! two: fractions whose parts fit 64 bits if all coordinates are below [`LARGEST`].

use glam::I64Vec3;

use super::prelude::*;

/// Limit of coordinates and components of directions: determinants are then below 2^53.
const LARGEST: f32 = 32_768.0;

/// Triangles with integer corners.
pub(super) struct WholeTriangles(Vec<[I64Vec3; 3]>);

fn whole(v: Vec3) -> I64Vec3 {
    debug_assert!(v == v.round() && v.abs().max_element() < LARGEST, "{v}");
    v.as_i64vec3()
}

impl WholeTriangles {
    /// The triangles of a geometry.
    pub(super) fn of(geometry: &Geometry) -> Self {
        let corners = |i| geometry.triangle(i).map(whole);
        Self((0..geometry.triangles.len()).map(corners).collect())
    }

    /// The hit of `ray`, which has integer coordinates too: at the smallest t within its range,
    /// rounded, the lowest number. The ends of the range are quarters, or infinite.
    pub(super) fn met_by(&self, ray: &Ray) -> Hit {
        let (origin, direction) = (whole(ray.origin), whole(ray.direction));
        let mut first = Hit::MISS;
        for (primitive, triangle) in (0..).zip(&self.0) {
            let corners = triangle.map(|corner| corner - origin);
            let range = [ray.t_min, ray.t_max].map(f64::from);
            if let Some(t) = meeting(corners, direction, range).filter(|&t| t < first.t) {
                first = Hit { t, primitive };
            }
        }
        first
    }
}

/// The t at which a ray in this `direction` meets the closed triangle with these `corners`,
/// relative to its origin, strictly within the range.
fn meeting([a, b, c]: [I64Vec3; 3], direction: I64Vec3, [t_min, t_max]: [f64; 2]) -> Option<f32> {
    let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| direction.dot(p.cross(q)));
    let whole: i64 = sides.iter().sum();
    let is_outside = sides.iter().any(|s| *s < 0) && sides.iter().any(|s| *s > 0);
    if is_outside || whole == 0 {
        return None;
    }
    let (height, whole) = (a.dot(b.cross(c)) as f64, whole as f64);
    // Products with quarters are exact, a quotient is not.
    let (low, high) = (t_min * whole.abs(), t_max * whole.abs());
    let height = height * whole.signum();
    (height > low && height < high).then_some((height / whole.abs()) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selftest::shapes::of_triangles;

    #[test]
    fn the_first_at_the_least_t_is_expected() {
        let triangle = |z| [[-9.0, -9.0, z], [9.0, -9.0, z], [0.0, 9.0, z]].map(Vec3::from);
        let geometry = of_triangles([4.0, 3.0, 3.0, -3.0].map(triangle));
        let triangles = WholeTriangles::of(&geometry);
        let met = |x: f32, y: f32| triangles.met_by(&Ray::new(Vec3::new(x, y, 0.0), Vec3::Z * 2.0));
        assert_eq!(met(0.0, 0.0), Hit { t: 1.5, primitive: 1 });
        assert_eq!(met(9.0, 9.0), Hit::MISS);
        // Edges and corners belong to a triangle.
        assert_eq!([met(0.0, -9.0), met(0.0, 9.0)], [Hit { t: 1.5, primitive: 1 }; 2]);
    }
}
