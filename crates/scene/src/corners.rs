//! Properties of flat shapes from their corners: normal, area, planarity and crossing edges.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// Largest distance of a quad's corners from one plane, in single-precision units in the last place
/// of the largest coordinate. Corners that were planar before they were rounded, and perhaps
/// rotated, are within it.
const PLANAR_ULPS: f64 = 64.0;

/// The direction of `v`, of any length; `None` if it has none.
pub(crate) fn direction(v: DVec3) -> Option<DVec3> {
    // Scaled first, so that the square of a tiny length does not underflow.
    let scale = v.abs().max_element();
    (scale > 0.0).then(|| (v / scale).normalize())
}

/// A unit vector; a vector without direction becomes down.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    direction(v).unwrap_or(DVec3::NEG_Y)
}

/// A normal of the front of a triangle; its length is twice the area.
pub(crate) fn triangle_normal([p0, p1, p2]: &[DVec3; 3]) -> DVec3 {
    (p2 - p0).cross(p1 - p0)
}

/// A normal of the front of a quad; its length is twice the area.
pub(crate) fn quad_normal([p0, p1, p2, p3]: &[DVec3; 4]) -> DVec3 {
    (p2 - p0).cross(p1 - p3)
}

/// Whether a triangle has an area beyond the rounding error of its corners.
pub(crate) fn triangle_has_area(points: &[DVec3; 3]) -> bool {
    let [p0, p1, p2] = points;
    exceeds_rounding(triangle_normal(points), p2 - p0, p1 - p0, largest(points))
}

/// Whether a quad has an area beyond the rounding error of its corners.
pub(crate) fn quad_has_area(points: &[DVec3; 4]) -> bool {
    let [p0, p1, p2, p3] = points;
    exceeds_rounding(quad_normal(points), p2 - p0, p1 - p3, largest(points))
}

/// Whether a cross product exceeds rounding. Moving the corners by one unit in the last place of
/// the `largest` coordinate moves `a` and `b` by at most 2 such units in each direction, hence
/// their cross product by about this much.
fn exceeds_rounding(cross: DVec3, a: DVec3, b: DVec3, largest: f64) -> bool {
    cross.length() > 2.0 * f64::EPSILON * largest * (a.length() + b.length())
}

/// Whether the corners of a quad lie in one plane, within 64 single-precision units in the last
/// place of the largest coordinate.
///
/// A quad that is not planar is rendered as two triangles. The measure is the distance between its
/// diagonals, so that all corners count alike.
pub(crate) fn quad_is_planar(points: &[DVec3; 4]) -> bool {
    let Some(normal) = direction(quad_normal(points)) else { return false };
    let apart = (points[1] - points[0]).dot(normal).abs();
    apart <= PLANAR_ULPS * f64::from(f32::EPSILON) * largest(points)
}

/// Whether no two opposite edges of a quad cross or touch, as seen along the axis nearest to its
/// normal. The predicates are exact.
pub(crate) fn quad_is_simple(points: &[DVec3; 4]) -> bool {
    let normal = quad_normal(points);
    let [a, b, c, d] = points.map(|p| flattened(normal, p));
    !segments_meet([a, b, c, d]) && !segments_meet([b, c, d, a])
}

/// Whether two neighbouring corners of a quad coincide.
pub(crate) fn quad_repeats_a_corner(points: &[DVec3; 4]) -> bool {
    (0..4).any(|i| points[i] == points[(i + 1) % 4])
}

/// The coordinates of a point in the plane of the two axes along which a polygon with this `normal`
/// is largest; it is counter-clockwise there.
pub(crate) fn flattened(normal: DVec3, point: DVec3) -> DVec2 {
    let DVec3 { x, y, z } = point;
    match normal.abs().max_position() {
        0 => DVec2::new(y * normal.x.signum(), z),
        1 => DVec2::new(z * normal.y.signum(), x),
        _ => DVec2::new(x * normal.z.signum(), y),
    }
}

/// Positive for a counter-clockwise triangle; 0 for one without area. Its sign is exact.
pub(crate) fn orientation([a, b, c]: [DVec2; 3]) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

fn segments_meet([a, b, c, d]: [DVec2; 4]) -> bool {
    apart(orientation([a, b, c]), orientation([a, b, d]))
        && apart(orientation([c, d, a]), orientation([c, d, b]))
}

/// Whether two points are on different sides of a line; one of them may be on it.
fn apart(side: f64, other: f64) -> bool {
    // Signs instead of the product, which could underflow. If both are on it, all are on one line
    // and nothing crosses.
    let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
    sign(side) != sign(other)
}

fn largest(points: &[DVec3]) -> f64 {
    points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}
