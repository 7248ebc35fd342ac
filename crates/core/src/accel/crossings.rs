//! Everything that rays cross: searches that end at no hit.
//!
//! What many rays cross is found in any order, and then sorted by ray.

use super::{Best, Hit, Query, Rays, Search, Searched, Traversal};
use crate::counters::{KernelCounts, Kernels};
use crate::geometry::{Geometry, Surfaces};
use crate::kernels::Arithmetic;
use crate::math::Ray;

/// Rays that cross more than this together are searched in parts, so that memory is bounded: what the
/// rays of a batch cross then stays in the second-level cache.
const MOST: usize = 1 << 13;

/// Fewer rays than this are searched one by one.
const FEWEST_TOGETHER: usize = 8;

/// What rays cross, ray by ray. Its memory is used again.
#[derive(Clone, Debug, Default)]
pub struct Crossings {
    /// As it was found.
    crossed: Crossed,
    /// Sorted by ray.
    hits: Vec<Hit>,
    /// For each ray the end of its hits; those of the first begin at 0.
    ends: Vec<u32>,
    /// The number of rays of the last part, if there was more than one part.
    part: Option<usize>,
}

impl Crossings {
    /// What each ray crosses: the primitives, those of lights too, but not those of instances, in the order of
    /// their exact t, of equal t first those that shadow rays pass, then by number.
    pub fn of_rays(&self) -> impl Iterator<Item = &[Hit]> {
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let own = start..end as usize;
            start = end as usize;
            &self.hits[own]
        })
    }

    /// What all rays cross.
    pub fn hits(&self) -> &[Hit] {
        &self.hits
    }

    /// What a ray crosses, and where it first meets an instance, if it does.
    pub(crate) fn with(&mut self, instanced: Hit) -> &[Hit] {
        if !instanced.is_miss() {
            let before = self.hits.partition_point(|other| other.t <= instanced.t);
            self.hits.insert(before, instanced);
        }
        &self.hits
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let Self { crossed: Crossed { found, .. }, hits, ends, .. } = self;
        found.capacity() * size_of::<(u32, Best)>()
            + hits.capacity() * size_of::<Hit>()
            + ends.capacity() * size_of::<u32>()
    }

    /// Sorts what was found for the first `count` rays; `finish` gives the hit of a ray.
    fn sort(
        &mut self,
        geometry: &Geometry,
        (rays, count): (Rays<'_>, usize),
        finish: impl Fn(&dyn Fn() -> Ray, &Best) -> Hit,
    ) {
        let Self { crossed: Crossed { found, .. }, hits, ends, .. } = self;
        ends.clear();
        ends.resize(count, 0);
        found.iter().for_each(|&(ray, _)| ends[ray as usize] += 1);
        let mut sum = 0;
        ends.iter_mut().for_each(|count| sum += std::mem::replace(count, sum));
        hits.clear();
        hits.resize(found.len(), Hit::MISS);
        for (number, best) in found {
            let place = &mut ends[*number as usize];
            hits[*place as usize] = finish(&|| rays.ray(*number as usize), best);
            *place += 1;
        }
        let mut rest = hits.as_mut_slice();
        let mut start = 0;
        for (number, &end) in ends.iter().enumerate() {
            let own = rest.split_off_mut(..(end - start) as usize).unwrap_or_default();
            start = end;
            if own.len() > 1 {
                geometry.sort(&rays.ray(number), own);
            }
        }
    }
}

/// The query for all that rays cross. The answer for a ray, which is given, is whether to leave it out.
#[derive(Clone, Debug, Default)]
struct Crossed {
    /// Each with the number of its ray.
    found: Vec<(u32, Best)>,
    /// No more are found than this.
    most: usize,
}

impl Query for Crossed {
    type Answer = bool;
    const ALL: bool = true;

    #[inline(always)]
    fn answer(_: Hit) -> bool {
        false
    }

    #[inline(always)]
    fn hit(_: bool) -> Hit {
        Hit::MISS
    }

    #[inline(always)]
    fn go_on(left_out: bool) -> Option<Hit> {
        (!left_out).then_some(Hit::MISS)
    }

    #[inline(always)]
    fn cross(&mut self, ray: usize, at: Best) {
        if self.found.len() < self.most {
            self.found.push((ray as u32, at));
        }
    }

    fn counts(kernels: &mut Kernels) -> &mut KernelCounts {
        &mut kernels.crossed
    }
}

/// The query for how much a ray crosses, as filters tell.
#[derive(Default)]
struct Counted {
    certain: u32,
    open: u32,
}

impl Query for Counted {
    type Answer = bool;
    const ALL: bool = true;
    const TAKES_OPEN: bool = true;

    fn answer(_: Hit) -> bool {
        false
    }

    fn hit(_: bool) -> Hit {
        Hit::MISS
    }

    #[inline(always)]
    fn cross(&mut self, _: usize, at: Best) {
        let is_certain = at.high < f32::INFINITY;
        *(if is_certain { &mut self.certain } else { &mut self.open }) += 1;
    }

    fn counts(kernels: &mut Kernels) -> &mut KernelCounts {
        &mut kernels.crossed
    }
}

impl<P: Arithmetic> Search<'_, P> {
    /// Whether `ray` certainly crosses one of the scene's own primitives, beside every edge, and certainly no other:
    /// by filters alone, which may leave that open.
    pub(crate) fn crosses_one(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        let Some(tree) = &self.accel.tree else { return false };
        let mut counted = Counted::default();
        let searched = self.part(tree, None, traversal);
        self.in_tree(&searched, (ray, 0), &mut counted, traversal);
        counted.certain == 1 && counted.open == 0
    }

    /// What `ray` crosses: see [`Accel::crossings`](super::Accel::crossings).
    pub fn crossings(&self, ray: &Ray, traversal: &mut Traversal, crossings: &mut Crossings) {
        let rays = Rays::Rows(std::slice::from_ref(ray));
        self.crossings_of(rays, (None, &mut [false]), traversal, crossings);
    }

    /// What `rays` cross, but for those that are `left_out`: of all primitives, or of some surfaces. Rays
    /// that cross much are searched in parts: returns the number of rays of this one.
    #[inline(never)]
    pub fn crossings_of(
        &self,
        rays: Rays<'_>,
        (surfaces, left_out): (Option<Surfaces>, &mut [bool]),
        traversal: &mut Traversal,
        crossings: &mut Crossings,
    ) -> usize {
        let mut count = crossings.part.unwrap_or(usize::MAX).min(rays.count());
        let searched = self.accel.tree.as_ref().map(|tree| self.part(tree, surfaces, traversal));
        loop {
            let query = &mut crossings.crossed;
            query.found.clear();
            query.most = if count > 1 { MOST } else { usize::MAX };
            let (rays, left_out) = (rays.first(count), &mut left_out[..count]);
            match searched {
                Some(searched) => self.find(&searched, rays, left_out, query, traversal),
                None => self.find_in_all(surfaces, rays, left_out, query, traversal),
            }
            if query.found.len() < query.most {
                break;
            }
            count /= 2;
            crossings.part = Some(count);
        }
        if crossings.crossed.found.len() < MOST / 4 {
            crossings.part = crossings.part.map(|part| part.saturating_mul(2));
        }
        let geometry = &self.accel.geometry;
        crossings.sort(geometry, (rays, count), |ray, best| match searched {
            Some(Searched { arena, .. }) if best.has_t() => {
                Hit { t: best.low, primitive: best.number(arena) }
            }
            Some(Searched { arena, .. }) => best.finished(arena, &ray()),
            None => Hit { t: best.low, primitive: best.entry },
        });
        count
    }

    fn find(
        &self,
        searched: &Searched<'_>,
        rays: Rays<'_>,
        left_out: &mut [bool],
        query: &mut Crossed,
        traversal: &mut Traversal,
    ) {
        if searched.root.is_none() {
        } else if rays.count() < FEWEST_TOGETHER || self.is_each() {
            for (number, _) in left_out.iter().enumerate().filter(|(_, left_out)| !**left_out) {
                self.in_tree(searched, (&rays.ray(number), number), query, traversal);
            }
        } else {
            self.all_in_tree(searched, rays, left_out, query, traversal);
        }
    }

    /// As [`Self::find`], by brute force.
    fn find_in_all(
        &self,
        surfaces: Option<Surfaces>,
        rays: Rays<'_>,
        left_out: &[bool],
        query: &mut Crossed,
        traversal: &mut Traversal,
    ) {
        let geometry = &self.accel.geometry;
        for (number, _) in left_out.iter().enumerate().filter(|(_, left_out)| !**left_out) {
            let ray = rays.ray(number);
            for primitive in (0..geometry.own() as u32).filter(|_| ray.is_valid()) {
                if surfaces.is_none_or(|surfaces| geometry.surfaces_of(primitive) == surfaces) {
                    let at = |t| query.cross(number, Best::of(Hit { t, primitive }));
                    geometry.cross::<P>(primitive, &ray, &mut traversal.tests).for_each(at);
                }
            }
        }
    }
}
