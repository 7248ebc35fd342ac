//! Closed meshes: a ray from the inside cannot leave.

use glam::{DVec3, Vec3};

use super::ways::Numbers;
use wavecrest_core::geometry::Geometry;

/// A closed mesh around a point from which all of it is visible.
pub(super) struct Closed {
    pub(super) geometry: Geometry,
    /// The point.
    pub(super) center: Vec3,
    /// Every point at most this far from it is inside.
    pub(super) radius: f32,
}

/// A globe of `rings` rings of `segments` vertices each, and two poles, at which `segments`
/// triangles meet. Radii vary by up to `bumps`; then everything is scaled and moved.
pub(super) fn globe(
    mut numbers: Numbers,
    [rings, segments]: [u32; 2],
    bumps: f64,
    (scale, offset): (f64, Vec3),
) -> Closed {
    let mut positions = Vec::new();
    let mut add = |polar: f64, turn: f64| {
        let r = 1.0 + bumps * (numbers.one() - 0.5);
        let ring = r * libm::sin(polar);
        let p = DVec3::new(ring * libm::cos(turn), ring * libm::sin(turn), r * libm::cos(polar));
        positions.push((p * scale + offset.as_dvec3()).as_vec3());
    };
    add(0.0, 0.0);
    for ring in 1..=rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings + 1);
        for segment in 0..segments {
            // Rings are rotated against each other.
            let turn = f64::from(segment) + 0.37 * f64::from(ring);
            add(polar, std::f64::consts::TAU * turn / f64::from(segments));
        }
    }
    add(std::f64::consts::PI, 0.0);
    let vertex = |ring: u32, segment: u32| 1 + (ring - 1) * segments + segment % segments;
    let south = positions.len() as u32 - 1;
    let mut triangles = Vec::new();
    for s in 0..segments {
        triangles.push([0, vertex(1, s), vertex(1, s + 1)]);
        for ring in 1..rings {
            let [a, b] = [vertex(ring, s), vertex(ring, s + 1)];
            let [c, d] = [vertex(ring + 1, s), vertex(ring + 1, s + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
        triangles.push([south, vertex(rings, s + 1), vertex(rings, s)]);
    }
    let geometry = Geometry { positions, triangles, ..Geometry::default() };
    let radius = nearest_plane(&geometry, offset) as f32;
    Closed { geometry, center: offset, radius }
}

/// The smallest distance to a triangle's plane.
fn nearest_plane(geometry: &Geometry, from: Vec3) -> f64 {
    let planes = (0..geometry.triangles.len()).map(|i| {
        let [a, b, c] = geometry.triangle(i).map(|v| v.as_dvec3() - from.as_dvec3());
        (b - a).cross(c - a).normalize().dot(a).abs()
    });
    planes.fold(f64::INFINITY, f64::min)
}
