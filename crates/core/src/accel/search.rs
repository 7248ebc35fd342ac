//! The queries of an [`Accel`]: for one ray or many, for the closest hit or any.
//!
//! Only [`Search::in_tree`] and [`Search::all_in_tree`] are compiled once for each instruction level, so
//! they are never inlined. A call costs less than a node visit. The single-ray
//! kernel exists for every level; batch kernels exist for levels with vectors of eight numbers, which
//! justify the code size. At other levels each ray is searched alone.

use std::marker::PhantomData;
use std::ops::Range;

use super::{
    Accel, Closest, Hit, KernelChoice, Occluded, Query, Rays, Searched, Traversal, Tree, packet,
    single,
};
use crate::at_level;
use crate::at_wide_level;
use crate::counters::TestCounts;
use crate::geometry::{Geometry, Surfaces};
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

    /// The closest hit on instances, which are not among [`Self::crossings`].
    pub(crate) fn closest_instanced(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        let geometry = self.accel.geometry();
        if geometry.instances.is_empty() || !ray.is_valid() {
            return Hit::MISS;
        }
        if let Some(tree) = &self.accel.tree {
            let searched = Searched { only_instances: true, ..self.part(tree, None, traversal) };
            return self.in_tree(&searched, (ray, 0), &mut Closest, traversal);
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
        let searched = self.part(tree, Q::SURFACES, traversal);
        Q::answer(self.in_tree(&searched, (ray, 0), &mut Q::default(), traversal))
    }

    #[inline(never)]
    fn many<Q: Query>(&self, rays: Rays<'_>, answers: &mut [Q::Answer], traversal: &mut Traversal) {
        let Some(tree) = self.accel.tree.as_ref().filter(|_| !self.is_each()) else {
            self.each::<Q>(rays, answers, traversal);
            return;
        };
        let searched = self.part(tree, Q::SURFACES, traversal);
        self.all_in_tree(&searched, rays, answers, &mut Q::default(), traversal);
    }

    /// Whether rays are searched one by one. The reference has no use for lanes.
    pub(super) fn is_each(&self) -> bool {
        P::IS_REFERENCE
            || matches!(self.accel.kernel, KernelChoice::Single | KernelChoice::Reference)
            || !is_wide(self.accel.level)
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
    }

    /// The scene, or its primitives of some surfaces. Among instances, hits are compared by t.
    #[inline(always)]
    pub(super) fn part<'b>(
        &'b self,
        tree: &'b Tree,
        surfaces: Option<Surfaces>,
        traversal: &Traversal,
    ) -> Searched<'b> {
        let Accel { geometry, blas, .. } = self.accel;
        let without_t = traversal.without_t && geometry.instances.is_empty();
        let root = tree.root_of(surfaces);
        Searched { blas, root, without_t, ..Searched::new(tree, geometry) }
    }

    /// The hit in a tree for the query, of the ray with that number.
    #[inline(never)]
    pub(super) fn in_tree<Q: Query>(
        &self,
        searched: &Searched<'_>,
        ray: (&Ray, usize),
        query: &mut Q,
        traversal: &mut Traversal,
    ) -> Hit {
        let memory = (traversal.stack.as_mut_slice(), &mut traversal.tests);
        at_level!(self.accel.level, simd =>
            single::hit::<_, Q, P, true>(simd, searched, ray, query, memory))
    }

    /// As [`Self::in_tree`], for many rays. The level must have batch kernels.
    #[inline(never)]
    pub(super) fn all_in_tree<Q: Query>(
        &self,
        searched: &Searched<'_>,
        rays: Rays<'_>,
        answers: &mut [Q::Answer],
        query: &mut Q,
        traversal: &mut Traversal,
    ) {
        let rays = (rays, self.accel.kernel);
        at_wide_level!(self.accel.level, simd =>
            packet::trace::<_, Q, P>((simd, *self), searched, rays, answers, query, traversal));
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
