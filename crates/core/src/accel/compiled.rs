//! Tree searches, compiled for each instruction level.
//!
//! With [`Search::crossings`](super::Search::crossings), these functions are the only place where
//! searches are compiled, once for each level, so they are never inlined. A call costs less than a node visit. The single-ray kernel exists for every
//! level; batch kernels exist for levels with vectors of eight numbers, which justify the code
//! size. At other levels each ray is searched alone.

use std::marker::PhantomData;

use fearless_simd::Level;

use super::{Accel, Best, Hit, KernelChoice, Query, Rays, Searched, Traversal, packet, single};
use crate::geometry::PreparedRay;
use crate::kernels::Arithmetic;
use crate::math::{Kernel, Lanes, Ray, dispatch, dispatch_wide, entry};

/// The hit on `ray` for query `Q`.
#[inline(never)]
pub(super) fn one<Q: Query, P: Arithmetic>(
    level: Level,
    searched: Searched<'_>,
    ray: &Ray,
    traversal: &mut Traversal,
) -> Hit {
    let query = PhantomData::<(Q, P)>;
    dispatch(level, One { searched, ray, traversal, query })
}

/// Searches many rays at the level and with the kernel of `accel`. The level must have batch kernels.
#[inline(never)]
pub(super) fn many<Q: Query, P: Arithmetic>(
    &Accel { level, kernel: choice, .. }: &Accel,
    searched: Searched<'_>,
    rays: Rays<'_>,
    answers: &mut [Q::Answer],
    traversal: &mut Traversal,
) {
    let precision = PhantomData::<P>;
    let many = Many::<Q, P> { searched, rays, answers, traversal, choice, precision };
    dispatch_wide(level, many);
}

/// One ray, searched alone.
struct One<'a, Q, P> {
    searched: Searched<'a>,
    ray: &'a Ray,
    traversal: &'a mut Traversal,
    query: PhantomData<(Q, P)>,
}

impl<Q: Query, P: Arithmetic> Kernel for One<'_, Q, P> {
    type Output = Hit;

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) -> Hit {
        let Traversal { stack, noted, tests, .. } = self.traversal;
        let ray = &PreparedRay::new(self.ray);
        let Some(root) = self.searched.tree.root() else { return Hit::MISS };
        stack[0] = entry(f32::NEG_INFINITY, root.place.bits());
        let (best, stack) = (Best::none(ray.ray.t_max), (stack.as_mut_slice(), 1));
        let notes = (&mut *tests, noted);
        let best = single::trace::<S, Q, P>(simd, self.searched, (ray, 0), best, stack, notes);
        best.answer(self.searched, self.ray, tests)
    }
}

/// Many rays, searched together.
struct Many<'a, Q: Query, P> {
    searched: Searched<'a>,
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
        let Self { searched, rays, answers, traversal, choice, .. } = self;
        packet::trace::<S, Q, P>(simd, searched, (rays, choice), answers, traversal);
    }
}
