//! Closed meshes seen from far away.

use glam::DVec3;

use super::case::{Effort, Outcome};
use super::convex::{Mesh, globe};
use super::ways::{Numbers, every_way, inputs};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;

/// The radius of the globe, and the grid of its vertices.
const RADIUS: f64 = 64.0;
const STEP: f64 = 1.0 / 64.0;

/// Case 43. Rays from up to 10 000 radii away, at edges and vertices of a closed mesh whose
/// surrounding faces are all visible.
pub(super) fn aimed(effort: &Effort) -> Outcome {
    let mesh = globe(6, RADIUS, STEP);
    let edges = edges(&mesh);
    let geometry = Geometry {
        positions: mesh.positions.clone(),
        triangles: mesh.triangles.clone(),
        ..Geometry::default()
    };
    let (rays, latest): (Vec<Ray>, Vec<f32>) = inputs(effort, 43, 0..effort.of(10_000_000))
        .filter_map(|mut numbers| ray_from_afar(&mesh, &edges, &mut numbers))
        .unzip();
    let all = [Preset::VeryFast, Preset::Medium].map(|preset| {
        every_way(effort.accel(geometry.clone(), preset), &rays, |i, _, hit| {
            (hit.is_miss() || hit.t > latest[i]).then(|| format!("{hit:?} is behind the mesh"))
        })
    });
    all.into_iter().sum()
}

/// The ends of an edge and the faces around both of them.
struct Edge {
    ends: [DVec3; 2],
    faces: Vec<usize>,
}

fn edges(mesh: &Mesh) -> Vec<Edge> {
    let all = (0..mesh.triangles.len()).flat_map(|face| {
        let [a, b, c] = mesh.corners(face);
        [[a, b], [b, c], [c, a]]
    });
    let about = |end: &DVec3| {
        let end = *end;
        (0..mesh.triangles.len()).filter(move |&face| mesh.corners(face).contains(&end))
    };
    all.map(|ends| Edge { ends, faces: ends.iter().flat_map(about).collect() }).collect()
}

/// A ray at a point of an edge or at its end, and the t at which it is still before the centre of
/// the mesh; `None` if a surrounding face is seen at a low angle.
fn ray_from_afar(mesh: &Mesh, edges: &[Edge], numbers: &mut Numbers) -> Option<(Ray, f32)> {
    let Edge { ends: [a, b], faces } = &edges[numbers.below(edges.len())];
    let target = a + (b - a) * [0.0, numbers.one(), numbers.magnitude(1e-7, 1.0)][numbers.below(3)];
    let away = numbers.magnitude(10.0, 1e4);
    // Towards the camera, on the side of the edge.
    let towards = (target.normalize() + numbers.direction() * numbers.one()).normalize();
    let origin = (towards * (away * RADIUS)).as_vec3();
    let steep = |&face: &usize| mesh.height(face, origin.as_dvec3()) > 0.2 * away * RADIUS;
    let ray = Ray::new(origin, (target - origin.as_dvec3()).as_vec3());
    // A chord at that angle is at least 0.4 radii long.
    faces.iter().all(steep).then_some((ray, (1.0 + 0.2 / away) as f32))
}
