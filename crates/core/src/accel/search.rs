//! The queries of an [`Accel`]: for one ray or many, for the closest hit or any.
//!
//! Only [`Search::crossings_of`], [`Search::in_tree`] and [`Search::all_in_tree`] are compiled once for
//! each instruction level, so they are never inlined. A call costs less than a node visit. The single-ray
//! kernel exists for every level; batch kernels exist for levels with vectors of eight numbers, which
//! justify the code size. At other levels each ray is searched alone.

use std::marker::PhantomData;
use std::ops::Range;

use super::crossings::{CrossingQuery, HitsReceiver};
use super::{
    Accel, Closest, Hit, KernelChoice, Occluded, Query, Rays, Searched, Traversal, Tree, crossings,
    packet, single,
};
use crate::at_level;
use crate::at_wide_level;
use crate::counters::TestCounts;
use crate::geometry::Geometry;
use crate::kernels::Arithmetic;
use crate::math::{Ray, is_wide};

/// The searches of an [`Accel`] whose geometry has precision `P`.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a, P> {
    pub(super) accel: &'a Accel,
    pub(super) precision: PhantomData<P>,
}

impl<P: Arithmetic> Search<'_, P> {
    /// See [`Accel::closest`].
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        self.one::<Closest>(ray, traversal)
    }

    /// See [`Accel::occluded`].
    #[inline]
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        self.one::<Occluded>(ray, traversal)
    }

    /// See [`Accel::closest_of`].
    pub fn closest_of(&self, rays: Rays<'_>, answers: &mut [Hit], traversal: &mut Traversal) {
        self.many::<Closest>(rays, answers, traversal);
    }

    /// See [`Accel::occluded_of`].
    pub fn occluded_of(&self, rays: Rays<'_>, answers: &mut [bool], traversal: &mut Traversal) {
        self.many::<Occluded>(rays, answers, traversal);
    }

    /// See [`Accel::crossings`].
    #[inline(never)]
    pub fn crossings(&self, ray: &Ray, traversal: &mut Traversal, hits: &mut Vec<Hit>) {
        let rays = Rays::Rows(std::slice::from_ref(ray));
        let query = CrossingQuery { rays, first: 0, occluded: &[false], only_transparent: false };
        self.crossings_of(query, traversal, hits, &mut |_, _| true);
    }

    /// As [`Accel::crossings`], of transparent primitives, for those `rays` from the number
    /// `first` on that are not `occluded`: after [`Self::occluded_of`] without another search, if
    /// [`Traversal::notes_passed`]. `each` receives the number of each ray, with its hits, and says
    /// whether to go on; `hits` is memory for these. Returns the number of the next ray.
    #[inline(never)]
    pub fn transparent_crossings(
        &self,
        rays: Rays<'_>,
        (first, occluded): (usize, &[bool]),
        traversal: &mut Traversal,
        hits: &mut Vec<Hit>,
        each: &mut HitsReceiver<'_>,
    ) -> usize {
        let query = CrossingQuery { rays, first, occluded, only_transparent: true };
        self.crossings_of(query, traversal, hits, each)
    }

    fn crossings_of(
        &self,
        query: CrossingQuery<'_>,
        traversal: &mut Traversal,
        hits: &mut Vec<Hit>,
        each: &mut HitsReceiver<'_>,
    ) -> usize {
        hits.clear();
        let Accel { geometry, tree, level, .. } = self.accel;
        if let Some(tree) = tree {
            let searched = self.own(tree, traversal);
            return at_level!(*level, simd =>
                crossings::in_tree::<_, P>(simd, searched, query, traversal, hits, each));
        }
        let cross = |_, ray: &Ray, hits: &mut Vec<Hit>| {
            let numbers = 0..geometry.own() as u32;
            crossings::cross_each::<P>(
                geometry,
                (numbers, query.only_transparent),
                ray,
                hits,
                &mut traversal.tests,
            );
        };
        query.run(geometry, hits, cross, each)
    }

    /// The closest hit on instances, which are not among [`Self::crossings`].
    pub(crate) fn closest_instanced(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        let geometry = self.accel.geometry();
        if geometry.instances.is_empty() || !ray.is_valid() {
            return Hit::MISS;
        }
        if self.accel.tree.is_some() {
            return self.among_instances::<Closest>(ray, Hit::MISS, traversal);
        }
        let numbers = geometry.own() as u32..geometry.len() as u32;
        brute::<Closest, P>(geometry, numbers, ray, &mut traversal.tests)
    }

    #[inline(always)]
    fn one<Q: Query>(&self, ray: &Ray, traversal: &mut Traversal) -> Q::Answer {
        Q::counts(&mut traversal.kernels).single += 1;
        if self.accel.kernel == KernelChoice::Reference {
            let reference = self.accel.search::<P::Reference>();
            return reference.one_of_precision::<Q>(ray, traversal);
        }
        self.one_of_precision::<Q>(ray, traversal)
    }

    /// As [`Self::one`], whatever the kernel.
    #[inline(always)]
    fn one_of_precision<Q: Query>(&self, ray: &Ray, traversal: &mut Traversal) -> Q::Answer {
        if !ray.is_valid() {
            return Q::answer(Hit::MISS);
        }
        let Accel { geometry, tree, .. } = self.accel;
        let Some(tree) = tree else {
            let numbers = 0..geometry.len() as u32;
            return Q::answer(brute::<Q, P>(geometry, numbers, ray, &mut traversal.tests));
        };
        let searched = self.own(tree, traversal);
        if Q::ANY {
            traversal.noted.begin(traversal.notes_passed, 1);
        }
        let best = self.in_tree::<Q>(searched, ray, traversal);
        traversal.noted.is_noting = false;
        if geometry.instances.is_empty() || Q::ANY && !best.is_miss() {
            return Q::answer(best);
        }
        Q::answer(self.among_instances::<Q>(ray, best, traversal))
    }

    #[inline(never)]
    fn many<Q: Query>(&self, rays: Rays<'_>, answers: &mut [Q::Answer], traversal: &mut Traversal) {
        let Accel { geometry, tree, kernel, level, .. } = self.accel;
        // The reference has no use for lanes.
        let is_each = P::IS_REFERENCE
            || matches!(kernel, KernelChoice::Single | KernelChoice::Reference)
            || !is_wide(*level);
        let Some(tree) = tree.as_ref().filter(|_| !is_each) else {
            self.each::<Q>(rays, answers, traversal);
            return;
        };
        traversal.noted.begin(Q::ANY && traversal.notes_passed, rays.count());
        self.all_in_tree::<Q>(self.own(tree, traversal), rays, answers, traversal);
        traversal.noted.is_noting = false;
        if !geometry.instances.is_empty() {
            self.all_among_instances::<Q>(rays, answers, traversal);
        }
    }

    /// Searches many rays one by one.
    #[inline(never)]
    fn each<Q: Query>(&self, rays: Rays<'_>, answers: &mut [Q::Answer], traversal: &mut Traversal) {
        for (i, answer) in answers.iter_mut().enumerate() {
            // Rows are read in place: values just copied in pieces are slow to reload.
            let copy;
            let ray = match rays {
                Rays::Rows(rows) => &rows[i],
                Rays::Columns(_) => {
                    copy = rays.ray(i);
                    &copy
                }
            };
            *answer = self.one::<Q>(ray, traversal);
        }
        // Those of the last ray alone.
        traversal.noted.begin(false, 0);
    }

    /// The hit of a ray in the tree of a prototype, by the prototype's own numbers.
    pub(super) fn in_prototype<Q: Query>(
        &self,
        number: usize,
        ray: &Ray,
        traversal: &mut Traversal,
    ) -> Hit {
        if !ray.is_valid() {
            return Hit::MISS;
        }
        self.in_tree::<Q>(self.prototype(number), ray, traversal)
    }

    /// The prototype with that number.
    pub(super) fn prototype(&self, number: usize) -> Searched<'_> {
        let Accel { blas, geometry, .. } = self.accel;
        let geometry = &geometry.prototypes[number];
        Searched { tree: &blas[number], geometry, without_t: false }
    }

    /// The scene's own primitives. Among instances, hits are compared by t.
    #[inline(always)]
    fn own<'b>(&'b self, tree: &'b Tree, traversal: &Traversal) -> Searched<'b> {
        let geometry = &self.accel.geometry;
        let without_t = traversal.without_t && geometry.instances.is_empty();
        Searched { tree, geometry, without_t }
    }

    /// The hit in a tree for query `Q`.
    #[inline(never)]
    fn in_tree<Q: Query>(
        &self,
        searched: Searched<'_>,
        ray: &Ray,
        traversal: &mut Traversal,
    ) -> Hit {
        at_level!(self.accel.level, simd => single::hit::<_, Q, P>(simd, searched, ray, traversal))
    }

    /// As [`Self::in_tree`], for many rays. The level must have batch kernels.
    #[inline(never)]
    pub(super) fn all_in_tree<Q: Query>(
        &self,
        searched: Searched<'_>,
        rays: Rays<'_>,
        answers: &mut [Q::Answer],
        traversal: &mut Traversal,
    ) {
        let rays = (rays, self.accel.kernel);
        at_wide_level!(self.accel.level, simd =>
            packet::trace::<_, Q, P>(simd, searched, rays, answers, traversal));
    }
}

/// The hit for query `Q` by brute force on primitives with these numbers: the reference for the tree.
fn brute<Q: Query, P: Arithmetic>(
    geometry: &Geometry,
    numbers: Range<u32>,
    ray: &Ray,
    tests: &mut TestCounts,
) -> Hit {
    let mut best = Hit::MISS;
    for primitive in numbers {
        if let Some(t) = geometry.hit::<P>(primitive, ray, tests)
            && let hit = (Hit { t, primitive })
            && geometry.order(ray, hit, best).is_lt()
            && !(Q::ANY && geometry.is_passed(primitive))
        {
            best = hit;
            if Q::ANY {
                break;
            }
        }
    }
    best
}
