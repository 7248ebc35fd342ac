//! The point of a triangle nearest to a ray, in the ray's sheared space and in double precision.

use glam::DVec3;

pub(super) fn edges_f64([a, b, c]: &[DVec3; 3]) -> [f64; 3] {
    [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x]
}

/// Barycentric coordinates of the point of the triangle nearest to the ray, none negative. `None`
/// if the ray lies in the triangle's plane. Points count as on the ray up to `sideways` from it.
///
/// That point is where the ray meets the plane, unless single precision accepted a ray that passes
/// just outside. A ray that grazes the triangle may meet its plane far away, and the nearest point
/// of the boundary was hit instead. The same holds if the triangle is so nearly edge-on that not
/// even double precision finds a point of it on the ray.
pub(super) fn weights(vertices: &[DVec3; 3], sideways: f64) -> Option<DVec3> {
    let edges = DVec3::from(edges_f64(vertices));
    let sum = edges.element_sum();
    if sum == 0.0 {
        return None;
    }
    let inside = edges / sum;
    let is_inside = inside.min_element() >= 0.0 && is_beside(vertices, inside, sideways);
    Some(if is_inside { inside } else { nearest_on_boundary(vertices) })
}

/// Whether the ray passes within `sideways` of the point with these weights, along each axis.
pub(super) fn is_beside([a, b, c]: &[DVec3; 3], weights: DVec3, sideways: f64) -> bool {
    (a * weights.x + b * weights.y + c * weights.z).truncate().abs().max_element() <= sideways
}

/// As [`weights`], for the point of the boundary nearest to the ray.
pub(super) fn nearest_on_boundary(vertices: &[DVec3; 3]) -> DVec3 {
    let distance = |i: usize| vertices[i].truncate().length_squared();
    let sides = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
        // From the nearer end: the direction of the side does not matter.
        let (i, j) = if distance(i) <= distance(j) { (i, j) } else { (j, i) };
        let (p, q) = (vertices[i].truncate(), vertices[j].truncate());
        let along = q - p;
        let s = (-p.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let mut weights = DVec3::ZERO;
        // A side seen end on has no direction: either end is right.
        weights[j] = if s.is_nan() { 0.0 } else { s };
        weights[i] = 1.0 - weights[j];
        ((p + along * weights[j]).length_squared(), weights)
    });
    let [first, second, third] = sides;
    let nearer = if second.0 < first.0 { second } else { first };
    if third.0 < nearer.0 { third.1 } else { nearer.1 }
}
