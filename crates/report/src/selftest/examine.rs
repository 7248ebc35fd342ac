//! The hard cases on a user's own mesh: leaks through its edges, self-hits, and the quality of its
//! triangles.

use std::time::Instant;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use super::case::{Count, Effort, Outcome};
use super::errors::{self, HitErrors};
use super::topology::{Edge, Topology};
use super::ways::{Numbers, Tests, blocks, in_order, inputs};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit, Traversal};
use wavecrest_core::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::math::float::{normalize, offset_origin};
use wavecrest_core::math::ray::Ray;

/// Rays of each kind, in full.
const RAYS: usize = 10_000_000;

/// Points at which leaves are counted.
const POINTS: usize = 256;

/// A triangle with at least this ratio of length to height is a sliver.
const SLIVER: f64 = 1000.0;

/// Properties of a mesh, independent of the precision.
#[derive(Clone, Debug, Serialize)]
pub struct Shape {
    /// Triangles, including degenerate ones.
    pub triangles: usize,
    /// Quads, spheres and triangles of instances, which are not tested.
    pub others: usize,
    /// Degenerate triangles, which are dropped.
    pub dropped: u64,
    /// Triangles at least 1000 times as long as high.
    pub slivers: u64,
    /// The greatest ratio of length to height.
    pub longest: f64,
    /// Edges of only one triangle: the border of the mesh.
    pub borders: u64,
    /// Edges of more than two triangles.
    pub crowded: u64,
}

/// A tree over a mesh.
#[derive(Clone, Debug, Serialize)]
pub struct Bvh {
    /// Its preset.
    pub preset: Preset,
    /// Its inner nodes.
    pub nodes: u64,
    /// Inner nodes above the deepest leaf.
    pub depth: usize,
    /// The average number of leaves around a point of the surface: 1 without overlap.
    pub overlap: f64,
}

/// The outcome for a mesh in one precision.
#[derive(Clone, Debug, Serialize)]
pub struct Trial {
    /// Rays at edges between two triangles on opposite sides as seen by the ray: a ray that passes
    /// between them has leaked.
    pub leaks: Outcome,
    /// Rays that leave a triangle: a ray that hits it again is a self-hit.
    pub self_hits: Outcome,
    /// Nanoseconds for each of these rays; 0 without rays.
    pub nanoseconds: f64,
    /// The errors of hits on its triangles.
    pub errors: HitErrors,
}

/// Describes a mesh.
pub fn shape(geometry: &Geometry, accel: &Accel) -> Shape {
    let topology = Topology::new(geometry);
    let ratios = (0..geometry.triangles.len()).into_par_iter().map(|i| {
        let [a, b, c] = geometry.triangle(i).map(|v| v.as_dvec3());
        let longest =
            (b - a).length_squared().max((c - b).length_squared().max((a - c).length_squared()));
        // Twice the area is length times height. Degenerate triangles are counted elsewhere.
        let doubled = (b - a).cross(c - a).length();
        if doubled > 0.0 { longest / doubled } else { 0.0 }
    });
    let of = |ratio: f64| (u64::from(ratio >= SLIVER), ratio);
    let (slivers, longest) =
        ratios.map(of).reduce(|| (0, 0.0), |a, b| (a.0 + b.0, f64::max(a.1, b.1)));
    Shape {
        triangles: geometry.triangles.len(),
        others: geometry.len() - geometry.triangles.len(),
        dropped: accel.left_out(),
        slivers,
        longest,
        borders: topology.borders,
        crowded: topology.crowded,
    }
}

/// Describes the tree over a mesh.
pub fn bvh(accel: &Accel, preset: Preset, effort: &Effort) -> Option<Bvh> {
    let tree = accel.tree()?;
    let geometry = accel.geometry();
    if geometry.triangles.is_empty() {
        return None;
    }
    let points: Vec<Vec3> = inputs(effort, EXAMINED, 0..POINTS)
        .map(|mut numbers| point_on(geometry, &mut numbers).as_vec3())
        .collect();
    let mut around = 0_u64;
    tree.for_each_leaf(|bounds, _| {
        let inside = |p: &&Vec3| bounds.low.cmple(**p).all() && bounds.high.cmpge(**p).all();
        around += points.iter().filter(inside).count() as u64;
    });
    let census = tree.census;
    let overlap = around as f64 / POINTS as f64;
    Some(Bvh { preset, nodes: census.nodes, depth: census.depth, overlap })
}

/// The number of rays: one of two values, or a hundredth of the smaller.
pub(super) fn rays(effort: &Effort, [quick, full]: [usize; 2]) -> usize {
    match effort.count {
        Count::Brief => quick / 100,
        Count::Quick => quick,
        Count::Full => full,
    }
}

/// The stream of random numbers, in place of a case's number.
const EXAMINED: u32 = 100;

/// A point of a triangle.
fn point_on(geometry: &Geometry, numbers: &mut Numbers) -> DVec3 {
    let number = numbers.below(geometry.triangles.len());
    numbers.within(geometry.triangle(number))
}

/// Tests the mesh of `accel`, in its precision. Without triangles, there are no rays.
pub fn trial(accel: &Accel, effort: &Effort) -> Trial {
    let geometry = accel.geometry();
    let topology = Topology::new(geometry);
    let extent = Extent::of(geometry);
    let leaks = leaking(accel, &topology, &extent, effort);
    let self_hits = leaving(accel, &extent, effort);
    let asked = (leaks.tried + self_hits.tried).max(1);
    let nanoseconds = (leaks.seconds + self_hits.seconds) * 1e9 / asked as f64;
    let [leaks, self_hits] = [leaks, self_hits].map(|all| Outcome { seconds: 0.0, ..all });
    let rays =
        if geometry.triangles.is_empty() { 0 } else { rays(effort, [RAYS / 100, RAYS / 10]) };
    let errors = errors::of_mesh(accel, effort, rays, |numbers| {
        let target = point_on(geometry, numbers);
        let from = extent.around(numbers);
        Ray::new(from, normalize(target.as_vec3() - from))
    });
    Trial { leaks, self_hits, nanoseconds, errors }
}

/// The centre of a mesh's box, and half of its diagonal.
pub(super) struct Extent {
    middle: DVec3,
    half: f64,
}

impl Extent {
    pub(super) fn of(geometry: &Geometry) -> Self {
        // Without padding: the same rays are traced in every precision.
        let all = (0..geometry.triangles.len()).map(|i| Aabb::around(geometry.triangle(i)));
        let Some(all) = all.reduce(|a, b| a.union(b)) else {
            return Self { middle: DVec3::ZERO, half: 1.0 };
        };
        let (low, high) = (all.low.as_dvec3(), all.high.as_dvec3());
        Self { middle: (low + high) / 2.0, half: (high - low).length() / 2.0 }
    }

    /// A random point around the mesh.
    pub(super) fn around(&self, numbers: &mut Numbers) -> Vec3 {
        let direction = numbers.direction();
        (self.middle + direction * (self.half * (0.1 + 2.0 * numbers.one()))).as_vec3()
    }
}

/// Rays for each task.
const RAYS_OF_A_THREAD: usize = 1 << 12;

/// Rays at edges, from random points around the mesh.
fn leaking(accel: &Accel, topology: &Topology, extent: &Extent, effort: &Effort) -> Outcome {
    if topology.len() == 0 {
        return Outcome::default();
    }
    ask(
        accel,
        effort,
        |n, _| {
            let mut numbers = Numbers::new(effort, EXAMINED + 1, n);
            let edge = topology.edge(numbers.below(topology.len()))?;
            let from = extent.around(&mut numbers);
            let part = 0.1 + 0.8 * numbers.one();
            let ray = edge_ray(accel.geometry(), &edge, from, part)?;
            Some((ray, edge.triangles))
        },
        |ray, triangles, hit| {
            // A face seen nearly edge on is hit far behind its edge.
            let is_own = triangles.contains(&hit.primitive);
            let passes = !is_own && (hit.is_miss() || hit.t > BEYOND);
            passes.then(|| format!("{ray} passes between two triangles: {hit:?}"))
        },
    )
}

/// A ray that hits something after this part of its way to an edge has passed the edge.
const BEYOND: f32 = 1.0 + 1.0 / 1024.0;

/// Smallest distance in ulp of the triangles' other edges from the ray, as seen by the ray:
/// rounding then puts it through one of the two triangles.
const LEAST_DISTANCE: f64 = 32.0;

/// A ray from `from` that meets the edge at `part` of it, if its triangles are on both sides of it
/// as seen from there.
fn edge_ray(geometry: &Geometry, edge: &Edge, from: Vec3, part: f64) -> Option<Ray> {
    let [a, b] = edge.ends.map(|v| geometry.positions[v as usize].as_dvec3());
    let o = from.as_dvec3();
    let target = (a + (b - a) * part).as_vec3();
    let d = (target.as_dvec3() - o).normalize();
    // From the ray to the line through two points, as seen along the ray.
    let distance = |a: DVec3, b: DVec3| {
        let side = (a - o).cross(b - o).dot(d);
        (side / (b - a).cross(d).length()).abs()
    };
    let ulp = f64::from(f32::EPSILON) * target.as_dvec3().abs().max(o.abs()).max_element();
    let plane = (a - o).cross(b - o);
    let sides = edge.triangles.map(|triangle| {
        let corners = geometry.triangle(triangle as usize).map(|v| v.as_dvec3());
        let c = corners.into_iter().find(|&c| c != a && c != b)?;
        let is_wide = distance(a, c).min(distance(b, c)) > LEAST_DISTANCE * ulp;
        is_wide.then(|| plane.dot(c - o))
    });
    let [Some(one), Some(other)] = sides else { return None };
    (one * other < 0.0).then(|| Ray::new(from, target - from))
}

/// Rays that leave triangles in all directions, on the side on which these were hit.
fn leaving(accel: &Accel, extent: &Extent, effort: &Effort) -> Outcome {
    let geometry = accel.geometry();
    if geometry.triangles.is_empty() {
        return Outcome::default();
    }
    ask(
        accel,
        effort,
        |n, traversal| {
            let mut numbers = Numbers::new(effort, EXAMINED + 2, n);
            let target = point_on(geometry, &mut numbers);
            let from = extent.around(&mut numbers);
            let ray = Ray::new(from, normalize(target.as_vec3() - from));
            let hit = Some(accel.closest(&ray, traversal)).filter(|hit| !hit.is_miss())?;
            let Primitive::Triangle(i) = geometry.primitive(hit.primitive) else { return None };
            let surface = Tests::in_accel(accel).surface(&ray, hit.t, &geometry.triangle(i));
            let [point, error, normal] = surface.vectors();
            let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
            let direction = normalize(numbers.direction().as_vec3() + normal);
            let origin = offset_origin(point, error, normal, direction);
            let leaves = direction.dot(normal) > 1e-3;
            leaves.then(|| (Ray::new(origin, direction), [hit.primitive; 2]))
        },
        |ray, [own, _], hit| {
            (hit.primitive == own).then(|| format!("{ray} meets triangle {own} again at {}", hit.t))
        },
    )
}

/// Traces the rays of `make`, each with two accompanying numbers, and judges the answers.
fn ask(
    accel: &Accel,
    effort: &Effort,
    make: impl Fn(usize, &mut Traversal) -> Option<(Ray, [u32; 2])> + Sync,
    judge: impl Fn(&Ray, [u32; 2], Hit) -> Option<String> + Sync,
) -> Outcome {
    let count = rays(effort, [RAYS / 25, RAYS]);
    in_order(blocks(count, RAYS_OF_A_THREAD).map(|block| {
        let mut traversal = accel.traversal();
        let made = block.filter_map(|n| make(n, &mut traversal));
        let (rays, numbers): (Vec<Ray>, Vec<[u32; 2]>) = made.unzip();
        let mut hits = vec![Hit::MISS; rays.len()];
        let start = Instant::now();
        accel.closest_of(&rays[..], &mut hits, &mut traversal);
        let mut outcome = Outcome { seconds: start.elapsed().as_secs_f64(), ..Outcome::default() };
        for ((ray, &number), &hit) in rays.iter().zip(&numbers).zip(&hits) {
            outcome.count(judge(ray, number, hit));
        }
        outcome
    }))
}
