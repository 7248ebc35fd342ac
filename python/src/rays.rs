//! Traces rays from arrays on all threads, block by block.

use std::cmp::Ordering;
use std::ops::Range;

use numpy::PyArrayMethods;
use pyo3::prelude::*;
use wavecrest_api::glam::DVec3;
use wavecrest_api::memory::reserve;
use wavecrest_api::parallel;
use wavecrest_api::{self as api, Accel, Crossings, Hit, NO_PRIMITIVE, Ray, Traversal};

use super::arrays::{Column, Rows, column};
use super::base::{exception, in_stretches};
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

/// The hit or the miss of a ray.
#[derive(Clone, Copy)]
pub(crate) struct RayHit {
    /// The number of the ray.
    pub(crate) ray: usize,
    /// [`NO_PRIMITIVE`] for a miss.
    pub(crate) primitive: u32,
    /// In lengths of the scaled direction.
    t: f64,
}

impl RayHit {
    /// That of a rounded ray.
    fn of(ray: usize, hit: Hit) -> Self {
        Self { ray, primitive: hit.primitive, t: hit.t.into() }
    }

    pub(crate) fn is_miss(&self) -> bool {
        self.primitive == NO_PRIMITIVE
    }
}

/// The memory of a thread, with the rays of its block.
#[derive(Clone)]
pub(crate) struct Worker {
    pub(crate) traversal: Traversal,
    pub(crate) rays: Vec<Ray>,
    pub(crate) hits: Vec<Hit>,
    crossings: Crossings,
}

impl Worker {
    /// Calls `each` with the index of each ray, the ray and what it crosses, until that fails.
    pub(crate) fn cross<E>(
        &mut self,
        accel: &Accel,
        mut each: impl FnMut(usize, &Ray, &[Hit]) -> Result<(), E>,
    ) -> Result<(), E> {
        let Self { traversal, rays, crossings, .. } = self;
        let mut next = 0;
        while next < rays.len() {
            accel.crossings_of(&rays[next..], traversal, crossings);
            for hits in crossings.of_rays() {
                each(next, &rays[next], hits)?;
                next += 1;
            }
        }
        Ok(())
    }
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
    fn met(&self, rounded: RayHit, [a, b, c]: [DVec3; 3]) -> Option<RayHit> {
        if self.is_single || rounded.is_miss() {
            return Some(rounded);
        }
        let (origin, direction, _) = self.line(rounded.ray);
        let t = plane::meeting(origin, direction, [a, b, c]);
        let sizes = (origin - self.shapes.origin).abs() + (a - self.shapes.origin).abs();
        let near = (b - a).abs() + (c - a).abs() + sizes * NEAR;
        ((t - rounded.t).abs() <= near.element_sum()).then_some(RayHit { t, ..rounded })
    }

    /// The same where the upper bound of t is far from that, but t itself need not be.
    #[cold]
    #[inline(never)]
    fn met_again(&self, ray: usize, rounded: &Ray, face: [DVec3; 3], by: &mut Traversal) -> RayHit {
        let hit = RayHit::of(ray, self.shapes.accel.closest(rounded, by));
        self.met(hit, face).unwrap_or(hit)
    }

    /// The distance in lengths of the direction as given; infinite for a miss. Which hits are within the
    /// range is decided by rounded numbers, so it may be outside by a little.
    #[inline(always)]
    pub(crate) fn distance(&self, hit: RayHit) -> f64 {
        hit.t * self.line(hit.ray).2
    }

    /// The place of a hit.
    #[inline]
    pub(crate) fn place(&self, hit: RayHit) -> DVec3 {
        let (origin, direction, _) = self.line(hit.ray);
        origin + direction * hit.t
    }

    /// Works on a part of the rays on all threads, block by block, each with one of `blocks`.
    fn trace<T: Send>(
        &self,
        part: Range<usize>,
        blocks: impl Iterator<Item = T> + Send,
        work: impl Fn(&mut Worker, Range<usize>, T) + Sync,
    ) {
        let size = api::rays_at_once(part.len());
        let starts = part.clone().step_by(size);
        let worker = || {
            let traversal = self.shapes.accel.traversal();
            let crossings = Crossings::default();
            Worker { traversal, rays: Vec::new(), hits: Vec::new(), crossings }
        };
        parallel::with_state(starts.zip(blocks), worker, |worker, (start, block)| {
            let rays = start..part.end.min(start + size);
            worker.rays.clear();
            worker.rays.extend(rays.clone().map(|ray| self.rounded(ray)));
            work(worker, rays, block);
        });
    }

    /// Finds the closest hits of a part, or misses: `store` puts each into its place in one of `blocks`.
    pub(crate) fn closest<T, B: Iterator<Item = T> + Send>(
        &self,
        part: Range<usize>,
        blocks: impl Iterator<Item = B> + Send,
        store: impl Fn(RayHit, T) + Sync,
    ) {
        self.trace(part, blocks, |worker, numbers, into| {
            let Worker { traversal, rays, hits, .. } = worker;
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
                    let hit = match self.met(RayHit::of(ray, *hit), corners) {
                        Some(hit) => hit,
                        None => self.met_again(ray, rounded, corners, traversal),
                    };
                    store(hit, into);
                }
            }
        });
    }

    /// The closest hit or the miss of each ray.
    pub(crate) fn first(&self, py: Python<'_>) -> PyResult<Vec<RayHit>> {
        let mut first = reserve(self.count, "the hits").map_err(exception)?;
        first.resize(self.count, RayHit::of(0, Hit::MISS));
        in_stretches(py, self.count, |part| {
            let blocks = first[part.clone()].chunks_mut(api::rays_at_once(part.len()));
            self.closest(part, blocks.map(|block| block.iter_mut()), |hit, into| *into = hit);
        })?;
        Ok(first)
    }

    /// What rays cross, at most this many for each.
    pub(crate) fn all(&self, py: Python<'_>, most: usize) -> PyResult<Vec<RayHit>> {
        let mut all = Vec::new();
        in_stretches(py, self.count, |part| {
            let blocks = part.clone().step_by(api::rays_at_once(part.len()));
            let mut blocks: Vec<_> = blocks.map(|_| Ok(Vec::new())).collect();
            self.trace(part, blocks.iter_mut(), |worker, rays, block| {
                *block = self.crossed(rays, most, worker);
            });
            all.append(&mut blocks);
        })?;
        let blocks = all.into_iter().collect::<PyResult<Vec<_>>>()?;
        let mut all = reserve(blocks.iter().map(Vec::len).sum(), "the hits").map_err(exception)?;
        all.extend(blocks.into_iter().flatten());
        Ok(all)
    }

    /// What the traversals of `work` find for each ray.
    pub(crate) fn answers<'py>(
        &self,
        py: Python<'py>,
        work: impl Fn(&mut Worker, &mut [bool]) + Sync,
    ) -> PyResult<Column<'py, bool>> {
        // Bytes other than 0 and 1 are no bools, even before they are written.
        let answers = column(py, "zeros", self.count)?;
        let mut into = answers.readwrite();
        let into = into.as_slice_mut()?;
        in_stretches(py, self.count, |part| {
            let blocks = into[part.clone()].chunks_mut(api::rays_at_once(part.len()));
            self.trace(part, blocks, |worker, _, answers| work(worker, answers));
        })?;
        Ok(answers)
    }

    /// Whether the crossings of a ray are those of one from inside: an odd number, or if they are `wound`, more that leave
    /// the mesh than that enter it, or less.
    pub(crate) fn is_inside(&self, ray: &Ray, crossings: &[Hit], wound: bool) -> bool {
        let turn = |hit: &Hit| {
            let corners = self.shapes.accel.geometry().triangle(hit.primitive as usize);
            match plane::side(ray.direction.as_dvec3(), corners.map(|corner| corner.as_dvec3())) {
                Ordering::Less => -1,
                _ => 1,
            }
        };
        match wound {
            true => crossings.iter().map(turn).sum::<i64>() != 0,
            false => !crossings.len().is_multiple_of(2),
        }
    }

    /// What the rays of the worker cross, which have these numbers.
    fn crossed(
        &self,
        numbers: Range<usize>,
        most: usize,
        worker: &mut Worker,
    ) -> PyResult<Vec<RayHit>> {
        let mut crossed: Vec<RayHit> = Vec::new();
        worker.cross(&self.shapes.accel, |index, _, hits| {
            let (number, hits) = (numbers.start + index, &hits[..hits.len().min(most)]);
            let needed = crossed.len() + hits.len();
            if crossed.capacity() < needed {
                let larger = reserve(needed.max(2 * crossed.len()), "the hits");
                let mut larger = larger.map_err(exception)?;
                larger.append(&mut crossed);
                crossed = larger;
            }
            let own = hits.iter().map(|&hit| RayHit::of(number, hit));
            crossed
                .extend(own.map(|hit| self.met(hit, self.corners(hit.primitive)).unwrap_or(hit)));
            Ok::<_, PyErr>(())
        })?;
        // Those that rounding leaves no distance between may be the other way round as given.
        for hits in crossed.chunk_by_mut(|one, other| one.ray == other.ray) {
            hits.sort_by(|one, other| {
                one.t.total_cmp(&other.t).then(one.primitive.cmp(&other.primitive))
            });
        }
        Ok(crossed)
    }
}
