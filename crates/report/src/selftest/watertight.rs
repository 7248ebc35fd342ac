//! Rays aimed at shared edges and vertices. Random rays find no leaks, as these have no width.

use glam::Vec3;
use rayon::prelude::*;

use super::case::{Effort, Outcome};
use super::closed::{Closed, globe};
use super::ways::{Numbers, every_way};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::ray::Ray;

/// Rings and segments, and the variation of radii.
const GLOBES: [([u32; 2], f64); 5] =
    [([2, 3], 0.0), ([5, 8], 0.3), ([9, 16], 0.3), ([20, 33], 0.0), ([12, 64], 0.2)];

/// Scales and positions.
const PLACES: [(f64, Vec3); 4] = [
    (1.0, Vec3::ZERO),
    (64.0, Vec3::new(1e5, -1e5, 1e5)),
    (1_048_576.0, Vec3::ZERO),
    (1.0 / 1_048_576.0, Vec3::ZERO),
];

/// Number of rays in full, and the share of them traced by brute force too.
const RAYS: usize = 10_000_000;
const BY_BRUTE_FORCE: usize = 10;

/// A ray that hits something later than this, relative to its target, has leaked: the target is
/// rounded, and faces seen at a low angle are hit slightly later, but not by this much.
const BEYOND: f32 = 1.1;

/// The target of a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Aim {
    Edge,
    Vertex,
}

/// Rays at points of edges.
pub(super) fn edges(effort: &Effort) -> Outcome {
    aimed(effort, Aim::Edge)
}

/// Rays at vertices.
pub(super) fn vertices(effort: &Effort) -> Outcome {
    aimed(effort, Aim::Vertex)
}

fn aimed(effort: &Effort, aim: Aim) -> Outcome {
    let mut outcome = Outcome::default();
    let count = effort.of(RAYS) / (GLOBES.len() * PLACES.len());
    for (i, &(size, bumps)) in GLOBES.iter().enumerate() {
        for (j, &place) in PLACES.iter().enumerate() {
            let case = 1 + aim as u32 + 16 * (1 + i * PLACES.len() + j) as u32;
            let closed = globe(Numbers::new(effort, case, usize::MAX), size, bumps, place);
            let rays: Vec<Ray> = (0..count)
                .into_par_iter()
                .map(|n| ray(&closed, aim, Numbers::new(effort, case, n)))
                .collect();
            let few: Vec<Ray> = rays.iter().step_by(BY_BRUTE_FORCE).copied().collect();
            for (preset, rays) in
                [(Preset::VeryFast, &rays), (Preset::Medium, &few), (Preset::Brute, &few)]
            {
                let accel = effort.accel(closed.geometry.clone(), preset);
                let context = |failure: &str| {
                    format!("globe {size:?} at {place:?}, {}: {failure}", preset.name())
                };
                outcome.add(every_way(accel, rays, |_, _, hit| {
                    if hit.is_miss() {
                        Some(context("it leaves the mesh"))
                    } else if hit.t > BEYOND {
                        Some(context("it passes through what it is aimed at"))
                    } else {
                        None
                    }
                }));
            }
        }
    }
    outcome
}

/// A ray that meets its target at t = 1.
fn ray(closed: &Closed, aim: Aim, mut numbers: Numbers) -> Ray {
    let Closed { geometry, center, radius } = closed;
    let away = numbers.direction() * (0.5 * numbers.one() * f64::from(*radius));
    let origin = (center.as_dvec3() + away).as_vec3();
    let corners = geometry.triangle(numbers.below(geometry.triangles.len()));
    let k = numbers.below(3);
    let (a, b) = (corners[k], corners[(k + 1) % 3]);
    let target = match aim {
        Aim::Vertex => a,
        Aim::Edge => {
            // Some just beside a vertex.
            let s = numbers.one();
            let s = if numbers.below(4) == 0 { numbers.magnitude(1e-7, 1.0) } else { s };
            (a.as_dvec3() + (b.as_dvec3() - a.as_dvec3()) * s).as_vec3()
        }
    };
    Ray::new(origin, target - origin)
}
