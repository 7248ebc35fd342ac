//! Constructions whose hits are known: closed and convex meshes, cubes and sheets.

use super::prelude::*;

/// A geometry of triangles with these corners.
pub(super) fn of_triangles(all: impl IntoIterator<Item = [Vec3; 3]>) -> Geometry {
    let mut geometry = Geometry::default();
    all.into_iter().for_each(|corners| add_triangle(&mut geometry, corners));
    geometry
}

/// Adds a triangle with its own vertices.
pub(super) fn add_triangle(geometry: &mut Geometry, corners: [Vec3; 3]) {
    let first = geometry.positions.len() as u32;
    geometry.positions.extend(corners);
    geometry.triangles.push([first, first + 1, first + 2]);
}

/// Adds two triangles with these corners around them.
pub(super) fn add_sheet(geometry: &mut Geometry, corners: [Vec3; 4]) {
    let first = geometry.positions.len() as u32;
    geometry.positions.extend(corners);
    geometry.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|half| half.map(|v: u32| first + v)));
}

/// The corners of the parallelogram with this centre and these half sides.
pub(super) fn corners(center: Vec3, u: Vec3, v: Vec3) -> [Vec3; 4] {
    [center - u - v, center + u - v, center + u + v, center - u + v]
}

/// The corners of each side of a cube. Corner `i` has the higher x, y and z if its bits 0, 1 and 2
/// are 1.
pub(super) const CUBE_SIDES: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// Adds a cube of twelve triangles.
pub(super) fn add_cube(geometry: &mut Geometry, low: Vec3, side: f32) {
    let corner = |i: u32| low + Vec3::from([0, 1, 2].map(|k| (i >> k & 1) as f32)) * side;
    CUBE_SIDES.into_iter().for_each(|corners| add_sheet(geometry, corners.map(corner)));
}

/// A grid of `n` by `n` by `n` cubes with sides of half the distance between them.
pub(super) fn cubes(n: u32, distance: f32) -> Geometry {
    let mut geometry = Geometry::default();
    for i in 0..n * n * n {
        let low = Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32) * distance;
        add_cube(&mut geometry, low, distance / 2.0);
    }
    geometry
}

/// A closed mesh around a point from which all of it is visible: a ray from the inside cannot
/// leave.
#[derive(Clone)]
pub(super) struct Closed {
    pub(super) geometry: Geometry,
    scale: DVec3,
    offset: Vec3,
    /// Before it is scaled, every point at most this far from the origin is inside.
    radius: f64,
}

impl Closed {
    /// A globe of `rings` rings of `segments` vertices each, and two poles, at which `segments`
    /// triangles meet. Radii vary by up to `bumps`; then everything is scaled and moved.
    pub(super) fn new(
        rng: &mut InputRng,
        [rings, segments]: [u32; 2],
        bumps: f64,
        scale: DVec3,
        offset: Vec3,
    ) -> Self {
        let mut unscaled = Vec::new();
        let mut add = |polar: f64, turn: f64| {
            let r = 1.0 + bumps * (rng.one() - 0.5);
            let ring = r * libm::sin(polar);
            let (sin, cos) = libm::sincos(turn);
            unscaled.push(DVec3::new(ring * cos, ring * sin, r * libm::cos(polar)));
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
        let south = unscaled.len() as u32 - 1;
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
        let distances = triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|v| unscaled[v as usize]);
            (b - a).cross(c - a).normalize().dot(a).abs()
        });
        let radius = distances.fold(f64::INFINITY, f64::min);
        let positions =
            unscaled.iter().map(|p| (p * scale + offset.as_dvec3()).as_vec3()).collect();
        let geometry = Geometry { positions, triangles: triangles.into(), ..Geometry::default() };
        Self { geometry, scale, offset, radius }
    }

    /// A point inside, with a margin for rounding.
    pub(super) fn inside(&self, rng: &mut InputRng) -> Vec3 {
        (self.offset.as_dvec3() + rng.ball(0.5 * self.radius) * self.scale).as_vec3()
    }
}
