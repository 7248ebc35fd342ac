//! Searching a tree with the instructions of a level.
//!
//! The functions here are the one place where kernels are compiled, once for each level: hence they are never
//! inlined. To call one costs less than a visit of a node.

use std::marker::PhantomData;

use fearless_simd::Level;

use super::geometry::{Geometry, PreparedRay};
use super::query::{Closest, Occluded, Query};
use super::rays::Rays;
use super::tree::Tree;
use super::{Hit, KernelChoice, Traversal, packet, single};
use crate::kernels::precision::Arithmetic;
use crate::math::simd::{Kernel, Lanes, dispatch};

/// What is searched.
pub(super) type Searched<'a> = (&'a Tree, &'a Geometry);

/// The closest hit on `ray`, of seals too.
#[inline(never)]
pub(super) fn closest<P: Arithmetic>(
    level: Level,
    searched: Searched<'_>,
    ray: &PreparedRay,
    traversal: &mut Traversal,
) -> Hit {
    dispatch(level, One::<Closest, P>::new(searched, ray, traversal))
}

/// Whether anything but a light's shape is on `ray`.
#[inline(never)]
pub(super) fn occluded<P: Arithmetic>(
    level: Level,
    searched: Searched<'_>,
    ray: &PreparedRay,
    traversal: &mut Traversal,
) -> bool {
    dispatch(level, One::<Occluded, P>::new(searched, ray, traversal))
}

/// Asks many rays, with the kernel of `choice`.
#[inline(never)]
pub(super) fn many<Q: Query, P: Arithmetic>(
    (level, choice): (Level, KernelChoice),
    (tree, geometry): Searched<'_>,
    rays: Rays<'_>,
    answers: &mut [Q::Answer],
    traversal: &mut Traversal,
) {
    let precision = PhantomData::<P>;
    let many = Many::<Q, P> { tree, geometry, rays, answers, traversal, choice, precision };
    dispatch(level, many);
}

/// One ray, traced alone.
struct One<'a, Q, P> {
    tree: &'a Tree,
    geometry: &'a Geometry,
    ray: &'a PreparedRay,
    traversal: &'a mut Traversal,
    query: PhantomData<(Q, P)>,
}

impl<'a, Q, P> One<'a, Q, P> {
    #[inline(always)]
    fn new(
        (tree, geometry): Searched<'a>,
        ray: &'a PreparedRay,
        traversal: &'a mut Traversal,
    ) -> Self {
        Self { tree, geometry, ray, traversal, query: PhantomData }
    }
}

impl<P: Arithmetic> Kernel for One<'_, Closest, P> {
    type Output = Hit;

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) -> Hit {
        let Traversal { stack, tests, .. } = self.traversal;
        let height = single::start::<P>(self.tree, self.ray, stack);
        let best = single::no_hit(self.ray);
        let stack = (stack.as_mut_slice(), height);
        let ray = self.ray;
        let best = single::closest::<S, P>(simd, self.tree, self.geometry, ray, best, stack, tests);
        single::or_miss(best)
    }
}

impl<P: Arithmetic> Kernel for One<'_, Occluded, P> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) -> bool {
        let Traversal { stack, tests, .. } = self.traversal;
        let height = single::start::<P>(self.tree, self.ray, stack);
        let stack = (stack.as_mut_slice(), height);
        single::occluded::<S, P>(simd, self.tree, self.geometry, self.ray, stack, tests)
    }
}

/// Many rays, in flight together.
struct Many<'a, Q: Query, P> {
    tree: &'a Tree,
    geometry: &'a Geometry,
    rays: Rays<'a>,
    answers: &'a mut [Q::Answer],
    traversal: &'a mut Traversal,
    choice: KernelChoice,
    precision: PhantomData<P>,
}

impl<Q: Query, P: Arithmetic> Kernel for Many<'_, Q, P> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) {
        let Traversal { flight, packets, stack, tests, kernels, .. } = self.traversal;
        let Self { tree, geometry, rays, answers, choice, .. } = self;
        let memory = (packets, flight, stack.as_mut_slice());
        let counts = (tests, if Q::ANY { &mut kernels.shadow } else { &mut kernels.closest });
        let rays = (rays, choice);
        packet::trace::<S, Q, P>(simd, tree, geometry, rays, answers, memory, counts);
    }
}
