//! The hard cases on a user's own scene, of any shapes: leaks through edges and spheres, and
//! self-hits.

use std::iter::Sum;

use glam::DAffine3;
use serde::Serialize;

use super::aim::{BoundingBall, at_any, is_outside, rays};
use super::errors::HitErrors;
use super::prelude::*;
use wavecrest_core::accel::Traversal;
use wavecrest_core::counters::PrimitiveCounts;
use wavecrest_core::geometry::Primitive;
use wavecrest_core::kernels::triangle::is_degenerate;
use wavecrest_scene::mesh::first_of_each;

/// Rays of each kind, in full, and those of a task.
const RAYS: usize = 10_000_000;
const RAYS_OF_A_TASK: usize = 1 << 12;

/// The streams of random numbers, in place of a case's number and a part's place.
const LEAKING: [u32; 2] = [100, 1];
const LEAVING: [u32; 2] = [100, 2];
const HITTING: [u32; 2] = [110, 1];

/// Properties of a geometry, independent of the precision.
#[derive(Clone, Debug, Serialize)]
pub struct GeometryFacts {
    /// Shapes, including degenerate triangles.
    #[serde(flatten)]
    pub shapes: PrimitiveCounts,
    /// Triangles of instances, once for each.
    pub instanced: u64,
    /// Degenerate triangles, which are dropped.
    pub dropped: u64,
}

/// The outcome in one precision.
#[derive(Clone, Debug, Serialize)]
pub struct SceneTrial {
    /// Rays at edges between two triangles on opposite sides as seen by the ray, where a ray that
    /// passes between them has leaked, and rays into spheres.
    pub leaks: Outcome,
    /// Rays that leave a primitive: a ray that hits it again is a self-hit.
    pub self_hits: Outcome,
    /// The errors of hits on triangles.
    pub errors: HitErrors,
}

/// Describes a geometry.
pub fn shape(accel: &Accel) -> GeometryFacts {
    let geometry = accel.geometry();
    GeometryFacts {
        shapes: geometry.counts(),
        instanced: (geometry.len() - geometry.own()) as u64,
        dropped: accel.left_out(),
    }
}

/// Tests the primitives of `accel`, in its precision.
pub fn trial(accel: &Accel, effort: &Effort) -> SceneTrial {
    let geometry = accel.geometry();
    let extent = BoundingBall::of(geometry);
    let prototypes = geometry.prototypes.iter().map(edges_of).collect();
    let meshes = MeshEdges { geometry, own: edges_of(geometry), prototypes };
    let count = rays(geometry, effort, [RAYS / 25, RAYS]);
    let leaks = ask(
        accel,
        count,
        |n, _| meshes.aimed(&extent, &mut InputRng::new(effort, LEAKING, n)),
        |ray, own, hit| {
            // A face seen nearly edge on is hit far behind its edge.
            let passes = !own.contains(&hit.primitive) && (hit.is_miss() || hit.t > BEYOND);
            Outcome::of(!passes, || format!("{ray} passes between or through {own:?}: {hit:?}"))
        },
    );
    let leaving = |n| InputRng::new(effort, LEAVING, n);
    let self_hits = ask(
        accel,
        count,
        |n, traversal| left(accel, &extent, &mut leaving(n), traversal, LOWEST),
        |ray, own, hit| {
            Outcome::of(hit.primitive != own, || format!("{ray} meets {own} again at {}", hit.t))
        },
    );
    let errors = ask(
        accel,
        rays(geometry, effort, [RAYS / 100, RAYS / 10]),
        |n, _| Some((at_any(geometry, &extent, &mut InputRng::new(effort, HITTING, n)), ())),
        |ray, (), hit| {
            let is_on_triangle = (hit.primitive as usize) < geometry.triangles.len();
            let errors = || HitErrors::of(geometry, &ray, hit);
            is_on_triangle.then(errors).unwrap_or_default()
        },
    );
    SceneTrial { leaks, self_hits, errors }
}

/// A ray that hits something after this part of its way to a target has passed the target.
const BEYOND: f32 = 1.0 + 1.0 / 1024.0;

/// Smallest distance in ulp of the triangles' other edges from the ray, as seen by the ray:
/// rounding then puts it through one of the two triangles.
const LEAST_DISTANCE: f64 = 32.0;

/// A geometry with the edges of its own faces, and of those of each prototype.
struct MeshEdges<'a> {
    geometry: &'a Geometry,
    own: Vec<FaceEdge>,
    prototypes: Vec<Vec<FaceEdge>>,
}

impl MeshEdges<'_> {
    /// A ray from around the geometry at an edge or into a sphere, with the numbers of the
    /// primitives there, which have no holes.
    fn aimed(&self, extent: &BoundingBall, rng: &mut InputRng) -> Option<(Ray, [u32; 2])> {
        let from = extent.around(rng);
        let number = rng.below(self.geometry.len()) as u32;
        let primitive = self.geometry.primitive(number);
        // Its mesh, the edges there, the number of the mesh's first primitive, and the mesh's place in the world.
        let (mesh, edges, first, place) = match primitive {
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = self.geometry.instance(instanced);
                let edges = &self.prototypes[instance.prototype()];
                (prototype, edges, instance.first(), *instance.to_world())
            }
            _ => (self.geometry, &self.own, 0, DAffine3::IDENTITY),
        };
        let has_holes =
            |own: &u32| mesh.cutouts.iter().any(|cutout| cutout.primitives.contains(own));
        if let Primitive::Quadric(i) = primitive {
            let (center, radius) = mesh.quadrics[i].sphere()?;
            let inside = rng.direction() * (0.99 * f64::from(radius));
            let target = (center.as_dvec3() + inside).as_vec3();
            // The ray must come from outside, and the target stay inside if it is rounded.
            let size = center.abs().max(from.abs()).max_element();
            let is_right = radius > 1e-4 * size && is_outside(from, (center, 1.01 * radius));
            return (is_right && !has_holes(&number))
                .then(|| (Ray::new(from, target - from), [number; 2]));
        }
        if edges.is_empty() {
            return None;
        }
        let (ends, _) = edges[rng.below(edges.len())];
        let here = &edges[edges.partition_point(|edge| edge.0 < ends)..];
        let faces = here.iter().take_while(|edge| edge.0 == ends).map(|(_, face)| *face);
        let faces: [EdgeFace; 2] = faces.collect::<Vec<_>>().try_into().ok()?;
        let own = faces.map(|(_, primitive)| primitive);
        let point =
            |vertex: u32| place.transform_point3(mesh.positions[vertex as usize].as_dvec3());
        let opposite = faces.map(|(opposite, _)| point(opposite));
        let part = 0.1 + 0.8 * rng.one();
        let ray = edge_ray(from, ends.map(point), opposite, part)?;
        (!own.iter().any(has_holes)).then(|| (ray, own.map(|primitive| first + primitive)))
    }
}

/// A ray from `from` that meets the edge from `a` to `b` at `part` of it, if the triangles'
/// `others` are on both sides of it as seen from there.
fn edge_ray(from: Vec3, [a, b]: [DVec3; 2], others: [DVec3; 2], part: f64) -> Option<Ray> {
    let o = from.as_dvec3();
    let target = (a + (b - a) * part).as_vec3();
    let d = (target.as_dvec3() - o).normalize();
    // From the ray to the line through two points, as seen along the ray.
    let distance = |a: DVec3, b: DVec3| {
        let side = (a - o).cross(b - o).dot(d);
        (side / (b - a).cross(d).length()).abs()
    };
    let ulp = f64::from(f32::EPSILON) * target.as_dvec3().abs().max(o.abs()).max_element();
    let is_wide = |&c: &DVec3| distance(a, c).min(distance(b, c)) > LEAST_DISTANCE * ulp;
    let [one, other] = others.map(|c| (a - o).cross(b - o).dot(c - o));
    (others.iter().all(is_wide) && one * other < 0.0).then(|| Ray::new(from, target - from))
}

/// A triangle at an edge: the vertex opposite to the edge, and the primitive's number.
type EdgeFace = (u32, u32);

/// An edge of a face: the numbers of its ends, the lower first.
type FaceEdge = ([u32; 2], EdgeFace);

/// The edges of a mesh's triangles and of the halves of its quads, without degenerate ones, sorted by the numbers of their
/// ends: at each position those of the first vertex there.
fn edges_of(geometry: &Geometry) -> Vec<FaceEdge> {
    let number = first_of_each(&geometry.positions);
    let triangles = (0..).zip(&geometry.triangles).map(|(i, &corners)| (i, corners));
    let first = geometry.triangles.len() as u32;
    let quads = (first..).zip(&geometry.quads);
    let all = triangles.chain(quads.flat_map(|(i, quad)| halves(quad).map(|half| (i, half))));
    let all: Vec<(u32, [u32; 3])> = all.collect();
    let mut edges: Vec<FaceEdge> = all
        .into_par_iter()
        .filter(|(_, face)| !is_degenerate(&face.map(|v| geometry.positions[v as usize])))
        .flat_map_iter(|(primitive, face)| {
            let [a, b, c] = face.map(|v| number[v as usize]);
            [[a, b, c], [b, c, a], [c, a, b]]
                .map(|[a, b, c]| ([a.min(b), a.max(b)], (c, primitive)))
        })
        .collect();
    edges.par_sort_unstable();
    edges
}

/// The cosine of the lowest rays that leave a surface: quads are not quite flat.
const LOWEST: f64 = 2e-3;

/// A ray that leaves a primitive on the side on which it was hit, with its number. Half of the rays
/// graze it, at an angle with the cosine `lowest`.
pub(super) fn left(
    accel: &Accel,
    extent: &BoundingBall,
    rng: &mut InputRng,
    traversal: &mut Traversal,
    lowest: f64,
) -> Option<(Ray, u32)> {
    let ray = at_any(accel.geometry(), extent, rng);
    let (primitive, [point, error, normal]) = met(accel, &ray, traversal)?;
    let is_inside = normal.dot(ray.direction) > 0.0;
    // The inside of a ball, seen through a hole, faces itself.
    if is_inside && matches!(accel.geometry().primitive(primitive), Primitive::Quadric(_)) {
        return None;
    }
    let outward = if is_inside { -normal } else { normal }.as_dvec3();
    let any = rng.direction();
    let along = any - outward * any.dot(outward);
    let direction =
        if rng.once_in(2) { any + outward } else { along.normalize() + outward * lowest };
    let direction = normalize(direction.as_vec3());
    let ray = Ray::new(offset_origin(point, error, normal, direction), direction);
    let is_outward = direction.as_dvec3().dot(outward) > 0.5 * lowest;
    (is_outward && ray.is_valid()).then_some((ray, primitive))
}

/// Traces the rays of `make`, each with what `judge` needs, and judges the answers.
fn ask<T, R: Send + Sum>(
    accel: &Accel,
    count: usize,
    make: impl Fn(usize, &mut Traversal) -> Option<(Ray, T)> + Sync,
    judge: impl Fn(Ray, T, Hit) -> R + Sync,
) -> R {
    let tasks = (0..count).into_par_iter().chunks(RAYS_OF_A_TASK).map(|task| {
        let mut traversal = accel.traversal();
        let made = task.into_iter().filter_map(|n| make(n, &mut traversal));
        let (rays, about): (Vec<Ray>, Vec<T>) = made.unzip();
        let mut hits = vec![Hit::MISS; rays.len()];
        accel.closest_of(&rays[..], &mut hits, &mut traversal);
        let answers = rays.into_iter().zip(about).zip(hits);
        answers.map(|((ray, about), hit)| judge(ray, about, hit)).sum::<R>()
    });
    tasks.sum()
}
