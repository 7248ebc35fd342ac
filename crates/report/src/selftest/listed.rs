//! Inline shapes far from the origin.

use glam::DVec3;
use serde_json::{Value, json};

use super::case::{Effort, Outcome};
use super::convex::{Mesh, globe};
use super::scenes::{self, Eye, camera_rays};
use super::ways::every_way;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;

/// The radius of the globe, and the grid of its vertices.
const RADIUS: f64 = 64.0;
const STEP: f64 = 1.0 / 64.0;

/// The camera, relative to the centre of the globe.
const EYE: DVec3 = DVec3::new(120.0, 80.0, 150.0);

/// Powers of two by which scenes are moved, up to the largest coordinates of a scene. Double
/// precision represents the vertices even there.
const FARTHEST: [i32; 4] = [0, 20, 30, 38];

/// Case 42. Inline points are moved to the camera before they are rounded.
pub(super) fn listed_points(effort: &Effort) -> Outcome {
    let diagonals = [DVec3::ONE, DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.0, 0.0, -1.0)];
    let moves = FARTHEST.iter().flat_map(|&k| diagonals.map(|way| way * libm::exp2(f64::from(k))));
    let mesh = globe(6, RADIUS, STEP);
    let both = moves.flat_map(|by| [as_mesh(&mesh, by), as_triangles(&mesh, by)].map(|s| (by, s)));
    both.map(|(by, shapes)| {
        let context = || format!("{} shapes moved by {by}", shapes.len());
        Outcome::from(faces_in_place(effort, &mesh, by, &shapes)).with_context(context)
    })
    .sum()
}

/// The coordinates of a vertex in the file.
fn place(mesh: &Mesh, vertex: u32, by: DVec3) -> [f64; 3] {
    (mesh.positions[vertex as usize].as_dvec3() + by).to_array()
}

fn as_mesh(mesh: &Mesh, by: DVec3) -> Vec<Value> {
    let points: Vec<_> = (0..mesh.positions.len() as u32).map(|i| place(mesh, i, by)).collect();
    vec![json!({"type": "trimesh", "points": points, "indices": mesh.triangles, "sides": "both",
                "material": scenes::matte([1.0; 3])})]
}

fn as_triangles(mesh: &Mesh, by: DVec3) -> Vec<Value> {
    let triangle = |corners: &[u32; 3]| {
        let points = corners.map(|vertex| place(mesh, vertex, by));
        json!({"type": "triangle", "points": points, "sides": "both",
               "material": scenes::matte([1.0; 3])})
    };
    mesh.triangles.iter().map(triangle).collect()
}

/// Every pixel shows the expected face.
fn faces_in_place(effort: &Effort, mesh: &Mesh, by: DVec3, shapes: &[Value]) -> Result<Outcome> {
    let still = Eye::at(EYE, 40.0, effort.either([48, 40], [128, 120]));
    let moved = Eye { location: EYE + by, look: by, ..still };
    let seen = still.pixels().map(|(x, y)| mesh.seen(EYE, still.direction(x, y)));
    let faces: Vec<Option<usize>> = seen.collect();
    let scene = scenes::scene(0, &moved.json(), &[], shapes);
    let scene = scenes::prepare(effort, &scene, Preset::VeryFast)?.scene;
    let rays = camera_rays(&scene);
    let mut outcome = every_way(scene.accel, &rays, |i, _, hit| {
        let face = faces[i].filter(|&face| hit.primitive as usize != face);
        face.map(|face| format!("{hit:?} and not {face}"))
    });
    let count = faces.iter().flatten().count();
    outcome.check(count >= faces.len() / 4, || format!("only {count} pixels show a face"));
    Ok(outcome)
}
