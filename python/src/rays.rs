//! Traces rays from arrays on all threads, block by block.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use wavecrest_api::glam::{DVec3, Vec3};
use wavecrest_api::memory::reserve;
use wavecrest_api::{self as api, Accel, Hit, Ray, Traversal};

use super::input::Rows;

/// The direction in which [`Rays::contains`] looks. Any would do; along an axis, rays would run along the
/// sides of boxes, where exact arithmetic decides.
const ASIDE: Vec3 = Vec3::new(0.36, 0.48, 0.8);

/// Rays in double or single precision, and what they are traced against.
#[derive(Clone, Copy)]
pub(crate) struct Rays<'a> {
    pub(crate) accel: &'a Accel,
    pub(crate) origins: Rows<'a>,
    /// `None` for points, from which rays start in any direction.
    pub(crate) directions: Option<Rows<'a>>,
    pub(crate) t_max: f32,
    /// The origin of the mesh.
    pub(crate) from: DVec3,
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
        let (origins, directions, from) = (rays.origins, rays.directions, rays.from);
        self.rays.clear();
        self.rays.extend(part.map(|i| Ray {
            t_max: rays.t_max,
            ..Ray::new(
                api::mesh::relative(origins.get(i), from),
                directions.map_or(ASIDE, |rows| rows.get(i).as_vec3()),
            )
        }));
    }
}

/// The number of rays in a block of a part.
fn block(part: &Range<usize>) -> usize {
    api::rays_at_once(part.len())
}

/// The number of the face that is hit, or -1.
fn face(hit: Hit) -> i64 {
    if hit.is_miss() { -1 } else { hit.primitive.into() }
}

/// Crossings: for each the number of the ray, that of the face, and the distance.
pub(crate) type Crossings = (Vec<i64>, Vec<i64>, Vec<f32>);

impl Rays<'_> {
    pub(crate) fn len(&self) -> usize {
        self.origins.len()
    }

    /// Works on a part of the rays on all threads, block by block, each with one of `blocks`.
    fn on_threads<T: Send>(
        &self,
        part: Range<usize>,
        blocks: impl Iterator<Item = T> + Send,
        work: impl Fn(&mut Worker, T) + Sync,
    ) {
        let count = block(&part);
        let starts = part.clone().step_by(count);
        let traversal = self.accel.traversal();
        let worker = Worker { traversal, rays: Vec::new(), hits: Vec::new() };
        let mut workers = vec![worker; rayon::current_num_threads().min(starts.len())];
        let blocks = Mutex::new(starts.zip(blocks));
        let next = || blocks.lock().unwrap_or_else(PoisonError::into_inner).next();
        workers.par_iter_mut().with_max_len(1).for_each(|worker| {
            while let Some((start, block)) = next() {
                worker.take(self, start..part.end.min(start + count));
                work(worker, block);
            }
        });
    }

    /// The closest hits of a part: faces and distances.
    pub(crate) fn closest(&self, part: Range<usize>, faces: &mut [i64], distances: &mut [f32]) {
        let count = block(&part);
        let blocks = faces.chunks_mut(count).zip(distances.chunks_mut(count));
        self.on_threads(part, blocks, |worker, (faces, distances)| {
            worker.hits.resize(faces.len(), Hit::MISS);
            self.accel.closest_of(&worker.rays[..], &mut worker.hits, &mut worker.traversal);
            for ((hit, into), distance) in worker.hits.iter().zip(faces).zip(distances) {
                (*into, *distance) = (face(*hit), hit.t);
            }
        });
    }

    /// Whether the rays of a part hit anything.
    pub(crate) fn any(&self, part: Range<usize>, found: &mut [bool]) {
        let blocks = found.chunks_mut(block(&part));
        self.on_threads(part, blocks, |worker, found| {
            self.accel.occluded_of(&worker.rays[..], found, &mut worker.traversal);
        });
    }

    /// Whether the points of a part are inside: rays from there cross the mesh an odd number of times.
    pub(crate) fn contains(&self, part: Range<usize>, inside: &mut [bool]) {
        let blocks = inside.chunks_mut(block(&part));
        self.on_threads(part, blocks, |worker, inside| {
            let Worker { traversal, rays, hits } = worker;
            for (ray, inside) in rays.iter().zip(inside) {
                self.accel.crossings(ray, traversal, hits);
                *inside = !hits.len().is_multiple_of(2);
            }
        });
    }

    /// Adds what rays of a part cross, at most this many for each.
    pub(crate) fn all(
        &self,
        part: Range<usize>,
        most: usize,
        (numbers, faces, distances): &mut Crossings,
    ) -> api::Result<()> {
        let mut blocks: Vec<_> =
            part.clone().step_by(block(&part)).map(|first| (first, Ok(Vec::new()))).collect();
        self.on_threads(part, blocks.iter_mut(), |worker, (first, found)| {
            *found = self.crossed(*first, most, worker);
        });
        let blocks = blocks.into_iter().map(|(_, found)| found).collect::<api::Result<Vec<_>>>()?;
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

    /// What the rays of the worker cross, which are numbered from `first` on.
    fn crossed(
        &self,
        first: usize,
        most: usize,
        Worker { traversal, rays, hits }: &mut Worker,
    ) -> api::Result<Vec<(i64, Hit)>> {
        let mut found = Vec::new();
        for (number, ray) in (first..).zip(&*rays) {
            self.accel.crossings(ray, traversal, hits);
            hits.truncate(most);
            grow(&mut found, hits.len())?;
            found.extend(hits.iter().map(|&hit| (number as i64, hit)));
        }
        Ok(found)
    }
}

/// Makes room for as many more values, or is an error if the system refuses the memory.
fn grow<T>(values: &mut Vec<T>, more: usize) -> api::Result<()> {
    if values.capacity() - values.len() < more {
        let mut larger = reserve((values.len() + more).max(2 * values.len()), "the hits")?;
        larger.append(values);
        *values = larger;
    }
    Ok(())
}
