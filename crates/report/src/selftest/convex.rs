//! A convex globe on a grid: points in front of one of its faces are outside the globe.

use glam::{DVec3, Vec3};

/// Vertices and triangles, counter-clockwise from outside.
pub(super) struct Mesh {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// An octahedron with each face divided into `n` by `n`, and vertices at a distance of about
/// `radius` from 0, all of them multiples of `step`.
pub(super) fn globe(n: i32, radius: f64, step: f64) -> Mesh {
    let mut mesh = Mesh { positions: Vec::new(), triangles: Vec::new() };
    for octant in 0..8 {
        let sign = |k: i32| if octant >> k & 1 == 0 { 1.0 } else { -1.0 };
        let signs = DVec3::new(sign(0), sign(1), sign(2));
        let is_mirrored = signs.element_product() < 0.0;
        let first = mesh.positions.len() as i32;
        for i in 0..=n {
            for j in 0..=n - i {
                let at = DVec3::new(f64::from(i), f64::from(j), f64::from(n - i - j)).normalize();
                let on_grid = (at * (radius / step)).round() * step;
                mesh.positions.push((on_grid * signs).as_vec3());
            }
        }
        // Row i starts after rows of n + 1, n, ... vertices.
        let vertex = |i: i32, j: i32| (first + i * (n + 1) - i * (i - 1) / 2 + j) as u32;
        let mut add = |[a, b, c]: [u32; 3]| {
            mesh.triangles.push(if is_mirrored { [a, c, b] } else { [a, b, c] });
        };
        for i in 0..n {
            for j in 0..n - i {
                add([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < n {
                    add([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
    }
    mesh
}

impl Mesh {
    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize].as_dvec3())
    }

    /// The distance of `point` in front of that triangle's plane.
    pub(super) fn height(&self, triangle: usize, point: DVec3) -> f64 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).normalize().dot(point - a)
    }

    /// The first triangle whose front a ray from outside meets, and where. `None` also if the ray
    /// passes so near to an edge that the neighbour may be hit.
    pub(super) fn seen(&self, origin: DVec3, direction: DVec3) -> Option<usize> {
        (0..self.triangles.len()).find(|&triangle| {
            let corners = self.corners(triangle).map(|v| v - origin);
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a);
            let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|v| -v.dot(direction));
            let sum: f64 = volumes.iter().sum();
            normal.dot(direction) < 0.0 && volumes.iter().all(|v| *v > 1e-3 * sum)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_vertex_is_on_or_behind_every_face() {
        for n in [2, 4, 6] {
            let mesh = globe(n, 64.0, 1.0 / 64.0);
            assert_eq!(mesh.triangles.len(), 8 * (n * n) as usize);
            for triangle in 0..mesh.triangles.len() {
                let [a, b, c] = mesh.corners(triangle);
                for p in &mesh.positions {
                    let coord = |v: DVec3| robust::Coord3D { x: v.x, y: v.y, z: v.z };
                    let below = robust::orient3d(coord(a), coord(b), coord(c), coord(p.as_dvec3()));
                    assert!(below >= 0.0, "{n}: {p} is before {triangle}");
                }
            }
        }
    }
}
