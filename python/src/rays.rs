//! Traces rays from arrays on all threads, block by block.

use std::cmp::Ordering;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use wavecrest_api::glam::DVec3;
use wavecrest_api::memory::reserve;
use wavecrest_api::{self as api, Hit, NO_PRIMITIVE, Ray, Traversal};

use super::arrays::Rows;
use super::plane;
use super::shapes::Shapes;

/// The direction in which [`Rays::contains`] looks. Any would do; along an axis, rays would run along the
/// sides of boxes, where exact arithmetic decides.
const ASIDE: DVec3 = DVec3::new(0.36, 0.48, 0.8);

/// A ray as given may meet a face that it meets once it is rounded somewhere else, but hardly further away
/// than the face is large, or than coordinates are times this: a few dozen of their roundings.
const NEAR: f64 = 1.0 / (1 << 18) as f64;

/// Hits whose corners are fetched together, so that waiting for memory overlaps.
const AHEAD: usize = 32;

/// Rays in double or single precision, and what they are traced against.
#[derive(Clone, Copy)]
pub(crate) struct Rays<'a> {
    pub(crate) shapes: &'a Shapes,
    pub(crate) count: usize,
    pub(crate) origins: Rows<'a>,
    /// `None` for points, from which rays start in any direction.
    pub(crate) directions: Option<Rows<'a>>,
    /// The ends of the range of t.
    pub(crate) range: [f64; 2],
    /// Whether rays and meshes were given in single precision.
    pub(crate) is_single: bool,
}

/// What a ray meets.
#[derive(Clone, Copy)]
pub(crate) struct Found {
    /// The number of the ray.
    pub(crate) ray: usize,
    /// [`NO_PRIMITIVE`] for a miss.
    pub(crate) primitive: u32,
    /// In lengths of the scaled direction.
    t: f64,
}

impl Found {
    /// The hit or the miss of a rounded ray.
    pub(crate) fn of(ray: usize, hit: Hit) -> Self {
        Self { ray, primitive: hit.primitive, t: hit.t.into() }
    }

    pub(crate) fn is_miss(&self) -> bool {
        self.primitive == NO_PRIMITIVE
    }
}

/// The memory of a thread.
#[derive(Clone)]
struct Worker {
    traversal: Traversal,
    rays: Vec<Ray>,
    hits: Vec<Hit>,
}

/// The power of two that scales a vector to a length of about 1; of subnormal ones, to 2^-51 at least.
#[inline]
fn scale(direction: DVec3) -> f64 {
    const TOP: u64 = f64::MAX.to_bits() >> 52;
    let exponent = direction.abs().max_element().to_bits() >> 52;
    f64::from_bits(TOP.saturating_sub(exponent).max(1) << 52)
}

impl Rays<'_> {
    /// The origin of a ray, its scaled direction, and that scale.
    #[inline(always)]
    fn line(&self, ray: usize) -> (DVec3, DVec3, f64) {
        let direction = self.directions.map_or(ASIDE, |rows| rows.get(ray));
        let scale = scale(direction);
        (self.origins.get(ray), direction * scale, scale)
    }

    /// A ray relative to the origin of the shapes, rounded once.
    #[inline(always)]
    fn rounded(&self, ray: usize) -> Ray {
        let (origin, direction, scale) = self.line(ray);
        let [t_min, t_max] = self.range.map(|t| (t / scale) as f32);
        let origin = api::mesh::relative(origin, self.shapes.origin);
        Ray { origin, t_min, direction: direction.as_vec3(), t_max }
    }

    /// The corners of a face that is hit, where they matter.
    #[inline(always)]
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        match self.is_single || primitive == NO_PRIMITIVE {
            true => [DVec3::ZERO; 3],
            false => self.shapes.corners(self.shapes.face(primitive)),
        }
    }

    /// Where the ray as given meets the plane of the face that it hits once it is rounded, if that is near.
    #[inline(always)]
    fn met(&self, rounded: Found, [a, b, c]: [DVec3; 3]) -> Option<Found> {
        if self.is_single || rounded.is_miss() {
            return Some(rounded);
        }
        let (origin, direction, _) = self.line(rounded.ray);
        let t = plane::meeting(origin, direction, [a, b, c]);
        let sizes = (origin - self.shapes.origin).abs() + (a - self.shapes.origin).abs();
        let near = (b - a).abs() + (c - a).abs() + sizes * NEAR;
        ((t - rounded.t).abs() <= near.element_sum()).then_some(Found { t, ..rounded })
    }

    /// The same where the upper bound of t is far from that, but t itself need not be.
    #[cold]
    #[inline(never)]
    fn met_again(&self, ray: usize, rounded: &Ray, face: [DVec3; 3], by: &mut Traversal) -> Found {
        let found = Found::of(ray, self.shapes.accel.closest(rounded, by));
        self.met(found, face).unwrap_or(found)
    }

    /// The distance in lengths of the direction as given; infinite for a miss. Which hits are within the
    /// range is decided by rounded numbers, so it may be outside by a little.
    #[inline(always)]
    pub(crate) fn distance(&self, found: Found) -> f64 {
        found.t * self.line(found.ray).2
    }

    /// The place of a hit.
    #[inline]
    pub(crate) fn place(&self, found: Found) -> DVec3 {
        let (origin, direction, _) = self.line(found.ray);
        origin + direction * found.t
    }

    /// Works on a part of the rays on all threads, block by block, each with one of `blocks`.
    fn on_threads<T: Send>(
        &self,
        part: Range<usize>,
        blocks: impl Iterator<Item = T> + Send,
        work: impl Fn(&mut Worker, Range<usize>, T) + Sync,
    ) {
        let count = api::rays_at_once(part.len());
        let starts = part.clone().step_by(count);
        let traversal = self.shapes.accel.traversal();
        let worker = Worker { traversal, rays: Vec::new(), hits: Vec::new() };
        let mut workers = vec![worker; rayon::current_num_threads().min(starts.len())];
        let blocks = Mutex::new(starts.zip(blocks));
        let next = || blocks.lock().unwrap_or_else(PoisonError::into_inner).next();
        workers.par_iter_mut().with_max_len(1).for_each(|worker| {
            while let Some((start, block)) = next() {
                let rays = start..part.end.min(start + count);
                worker.rays.clear();
                worker.rays.extend(rays.clone().map(|ray| self.rounded(ray)));
                work(worker, rays, block);
            }
        });
    }

    /// Finds the closest hits of a part, or misses: `store` puts each into its place in one of `blocks`.
    pub(crate) fn closest<T, B: Iterator<Item = T> + Send>(
        &self,
        part: Range<usize>,
        blocks: impl Iterator<Item = B> + Send,
        store: impl Fn(Found, T) + Sync,
    ) {
        self.on_threads(part, blocks, |Worker { traversal, rays, hits }, numbers, into| {
            traversal.without_t = !self.is_single;
            hits.resize(rays.len(), Hit::MISS);
            self.shapes.accel.closest_of(&rays[..], hits, traversal);
            traversal.without_t = false;
            let mut places = numbers.zip(into).zip(&*rays);
            let mut corners = [[DVec3::ZERO; 3]; AHEAD];
            for hits in hits.chunks(AHEAD) {
                for (hit, into) in hits.iter().zip(&mut corners) {
                    *into = self.corners(hit.primitive);
                }
                for ((hit, corners), ((ray, into), rounded)) in
                    hits.iter().zip(corners).zip(&mut places)
                {
                    let found = match self.met(Found::of(ray, *hit), corners) {
                        Some(found) => found,
                        None => self.met_again(ray, rounded, corners, traversal),
                    };
                    store(found, into);
                }
            }
        });
    }

    /// Whether the rays of a part hit anything.
    pub(crate) fn any(&self, part: Range<usize>, found: &mut [bool]) {
        let blocks = found.chunks_mut(api::rays_at_once(part.len()));
        self.on_threads(part, blocks, |worker, _, found| {
            self.shapes.accel.occluded_of(&worker.rays[..], found, &mut worker.traversal);
        });
    }

    /// Whether the points of a part are inside: rays from there cross the mesh an odd number of times, or if
    /// they are `wound`, leave it more often than they enter it, or less often.
    pub(crate) fn contains(&self, part: Range<usize>, wound: bool, inside: &mut [bool]) {
        let blocks = inside.chunks_mut(api::rays_at_once(part.len()));
        let geometry = self.shapes.accel.geometry();
        let turn = |ray: &Ray, hit: &Hit| {
            let corners = geometry.triangle(hit.primitive as usize).map(|corner| corner.as_dvec3());
            match plane::side(ray.direction.as_dvec3(), corners) {
                Ordering::Less => -1,
                _ => 1,
            }
        };
        self.on_threads(part, blocks, |Worker { traversal, rays, hits }, _, inside| {
            for (ray, inside) in rays.iter().zip(inside) {
                self.shapes.accel.crossings(ray, traversal, hits);
                *inside = match wound {
                    true => hits.iter().map(|hit| turn(ray, hit)).sum::<i64>() != 0,
                    false => !hits.len().is_multiple_of(2),
                };
            }
        });
    }

    /// Adds what rays of a part cross, at most this many for each.
    pub(crate) fn all(
        &self,
        part: Range<usize>,
        most: usize,
        found: &mut Vec<Found>,
    ) -> api::Result<()> {
        let mut blocks: Vec<_> =
            part.clone().step_by(api::rays_at_once(part.len())).map(|_| Ok(Vec::new())).collect();
        self.on_threads(part, blocks.iter_mut(), |worker, rays, found| {
            *found = self.crossed(rays, most, worker);
        });
        let blocks = blocks.into_iter().collect::<api::Result<Vec<_>>>()?;
        grow(found, blocks.iter().map(Vec::len).sum())?;
        found.extend(blocks.into_iter().flatten());
        Ok(())
    }

    /// What the rays of the worker cross, which have these numbers.
    fn crossed(
        &self,
        numbers: Range<usize>,
        most: usize,
        Worker { traversal, rays, hits }: &mut Worker,
    ) -> api::Result<Vec<Found>> {
        let mut found = Vec::new();
        for (number, ray) in numbers.zip(&*rays) {
            self.shapes.accel.crossings(ray, traversal, hits);
            hits.truncate(most);
            grow(&mut found, hits.len())?;
            found.extend(hits.iter().map(|&hit| Found::of(number, hit)));
        }
        for found in &mut found {
            *found = self.met(*found, self.corners(found.primitive)).unwrap_or(*found);
        }
        // Those that rounding leaves no distance between may be the other way round as given.
        for found in found.chunk_by_mut(|one, other| one.ray == other.ray) {
            found.sort_by(|one, other| {
                one.t.total_cmp(&other.t).then(one.primitive.cmp(&other.primitive))
            });
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
