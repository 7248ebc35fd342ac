//! Traces rays from arrays on all threads, block by block.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use wavecrest_api::glam::{DVec3, Vec3};
use wavecrest_api::memory::reserve;
use wavecrest_api::{self as api, Accel, Hit, Ray, Traversal};

use super::input::Rows;

/// Rays for each task, as in the command.
pub(crate) const BLOCK: usize = 4096;

/// The direction in which [`contains`] looks. Any would do; along an axis, rays would run along the
/// sides of boxes, where exact arithmetic decides.
const ASIDE: Vec3 = Vec3::new(0.36, 0.48, 0.8);

/// Rays in double or single precision.
#[derive(Clone, Copy)]
pub(crate) struct Rays<'a> {
    pub(crate) origins: Rows<'a>,
    /// `None` for points, from which rays start in any direction.
    pub(crate) directions: Option<Rows<'a>>,
    pub(crate) t_max: f32,
    /// The origin of the mesh.
    pub(crate) from: DVec3,
}

impl Rays<'_> {
    pub(crate) fn len(&self) -> usize {
        self.origins.len()
    }
}

/// The memory of a thread.
#[derive(Clone)]
struct Worker {
    traversal: Traversal,
    rays: Vec<Ray>,
    hits: Vec<Hit>,
}

impl Worker {
    /// Takes a part of the rays: relative to the origin of the mesh, then rounded once.
    fn take(&mut self, rays: &Rays<'_>, part: Range<usize>) {
        let blank = Ray { t_max: rays.t_max, ..Ray::new(Vec3::ZERO, ASIDE) };
        self.rays.resize(part.len(), blank);
        let from = rays.from;
        rays.origins.each(part.clone(), &mut self.rays, |ray, origin| {
            ray.origin = api::mesh::relative(origin, from);
        });
        if let Some(directions) = rays.directions {
            directions.each(part, &mut self.rays, |ray, direction| {
                ray.direction = direction.as_vec3();
            });
        }
    }
}

/// Works on the blocks on all threads.
fn on_threads<T: Send>(
    accel: &Accel,
    blocks: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(&mut Worker, T) + Sync,
) {
    let worker = Worker { traversal: accel.traversal(), rays: Vec::new(), hits: Vec::new() };
    let mut workers = vec![worker; rayon::current_num_threads().min(blocks.len())];
    let blocks = Mutex::new(blocks);
    let next = || blocks.lock().unwrap_or_else(PoisonError::into_inner).next();
    workers.par_iter_mut().with_max_len(1).for_each(|worker| {
        while let Some(block) = next() {
            work(worker, block);
        }
    });
}

/// The numbers of a block's rays, of which there are `count`.
fn part(first: usize, block: usize, count: usize) -> Range<usize> {
    let start = first + block * BLOCK;
    start..start + count
}

/// The number of the face that is hit, or -1.
fn face(hit: Hit) -> i64 {
    if hit.is_miss() { -1 } else { hit.primitive.into() }
}

/// The closest hits of the rays from the `first` on: faces and distances.
pub(crate) fn closest(
    accel: &Accel,
    rays: &Rays<'_>,
    first: usize,
    (faces, distances): (&mut [i64], &mut [f32]),
) {
    let blocks = faces.chunks_mut(BLOCK).zip(distances.chunks_mut(BLOCK)).enumerate();
    on_threads(accel, blocks, |worker, (number, (faces, distances))| {
        worker.take(rays, part(first, number, faces.len()));
        worker.hits.resize(faces.len(), Hit::MISS);
        accel.closest_of(&worker.rays[..], &mut worker.hits, &mut worker.traversal);
        for ((hit, into), distance) in worker.hits.iter().zip(faces).zip(distances) {
            (*into, *distance) = (face(*hit), hit.t);
        }
    });
}

/// Whether the rays from the `first` on hit anything.
pub(crate) fn any(accel: &Accel, rays: &Rays<'_>, first: usize, found: &mut [bool]) {
    on_threads(accel, found.chunks_mut(BLOCK).enumerate(), |worker, (number, found)| {
        worker.take(rays, part(first, number, found.len()));
        accel.occluded_of(&worker.rays[..], found, &mut worker.traversal);
    });
}

/// Whether the points from the `first` on are inside: rays from there cross the mesh an odd number
/// of times.
pub(crate) fn contains(accel: &Accel, points: &Rays<'_>, first: usize, inside: &mut [bool]) {
    on_threads(accel, inside.chunks_mut(BLOCK).enumerate(), |worker, (number, inside)| {
        worker.take(points, part(first, number, inside.len()));
        let Worker { traversal, rays, hits } = worker;
        for (ray, inside) in rays.iter().zip(inside) {
            accel.crossings(ray, traversal, hits);
            *inside = !hits.len().is_multiple_of(2);
        }
    });
}

/// Crossings: for each the number of the ray, that of the face, and the distance.
pub(crate) type Crossings = (Vec<i64>, Vec<i64>, Vec<f32>);

/// Adds what rays of a part cross, at most this many for each.
pub(crate) fn all(
    accel: &Accel,
    rays: &Rays<'_>,
    part: Range<usize>,
    most: usize,
    (numbers, faces, distances): &mut Crossings,
) -> api::Result<()> {
    let mut blocks: Vec<_> = part.clone().step_by(BLOCK).map(|_| Ok(Vec::new())).collect();
    on_threads(accel, blocks.iter_mut().enumerate(), |worker, (number, found)| {
        let start = part.start + number * BLOCK;
        *found = block(accel, rays, start..part.end.min(start + BLOCK), most, worker);
    });
    let blocks = blocks.into_iter().collect::<api::Result<Vec<Vec<(i64, Hit)>>>>()?;
    let more = blocks.iter().map(Vec::len).sum();
    grow(numbers, more)?;
    grow(faces, more)?;
    grow(distances, more)?;
    for (number, hit) in blocks.into_iter().flatten() {
        numbers.push(number);
        faces.push(face(hit));
        distances.push(hit.t);
    }
    Ok(())
}

/// What the rays with these numbers cross.
fn block(
    accel: &Accel,
    rays: &Rays<'_>,
    numbers: Range<usize>,
    most: usize,
    worker: &mut Worker,
) -> api::Result<Vec<(i64, Hit)>> {
    worker.take(rays, numbers.clone());
    let Worker { traversal, rays, hits } = worker;
    let mut found = Vec::new();
    for (number, ray) in numbers.zip(&*rays) {
        accel.crossings(ray, traversal, hits);
        hits.truncate(most);
        grow(&mut found, hits.len())?;
        found.extend(hits.iter().map(|&hit| (number as i64, hit)));
    }
    Ok(found)
}

/// Makes room for as many more values, or is an error if the system refuses the memory.
fn grow<T>(values: &mut Vec<T>, more: usize) -> api::Result<()> {
    if values.capacity() - values.len() < more {
        let mut larger = reserve((values.len() + more).max(2 * values.len()), HITS)?;
        larger.append(values);
        *values = larger;
    }
    Ok(())
}

const HITS: &str = "the hits";

/// As many values, or an error if the system refuses the memory. They are in pages of zeros until
/// threads write them.
pub(crate) fn zeros<T: Copy + Default>(count: usize) -> api::Result<Vec<T>> {
    // The compiler may leave out an allocation that nothing reads.
    std::hint::black_box(reserve::<T>(count, HITS)?.as_ptr());
    Ok(vec![T::default(); count])
}
