//! Which variant of the tracers' code renders a scene: chosen once, outermost, for both tracers alike.
//!
//! A variant is compiled for a precision and for a set of effects. What is not in the set is not in the
//! code; what is in it is asked of the schedule, once a batch or a path. So a variant with more than the
//! scene calls for gives the same image, and the sets may be few.
//!
//! Few they are, as each costs every set of vector instructions another shading pass, the largest of the
//! wavefront's own kernels:
//!
//! - Lenses, antialiasing and kinds of lights are no constants. They decide once a batch, or once a light,
//!   in passes that have loops of their own for each.
//! - Kinds of shapes are none either. Hits of a kind are shaded in blocks of their own, so that the kind is
//!   asked for once in 64 hits.
//! - Textures and interpolated normals are one constant: both read what a mesh has at its corners, and
//!   scans have mirrors or neither.

use crate::kernels::precision::{Arithmetic, Fast, Precision, Robust};
use crate::plan::schedule::{Schedule, Step};

/// The effects that a variant may be asked for, at compile time.
pub trait Effects: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// Shadow rays.
    const SHADOWS: bool;

    /// Mirror rays.
    const MIRRORS: bool;

    /// Textures and interpolated normals.
    const APPEARANCE: bool;

    /// Whether hits are asked for more than their colour.
    const HAS_ANY: bool = Self::SHADOWS || Self::MIRRORS || Self::APPEARANCE;
}

/// Nothing but background, ambient and emitted light.
#[derive(Clone, Copy, Debug)]
pub struct Ambient;

/// Lights, with shadows.
#[derive(Clone, Copy, Debug)]
pub struct Direct;

/// Every effect.
#[derive(Clone, Copy, Debug)]
pub struct Every;

impl Effects for Ambient {
    const SHADOWS: bool = false;
    const MIRRORS: bool = false;
    const APPEARANCE: bool = false;
}

impl Effects for Direct {
    const SHADOWS: bool = true;
    const MIRRORS: bool = false;
    const APPEARANCE: bool = false;
}

impl Effects for Every {
    const SHADOWS: bool = true;
    const MIRRORS: bool = true;
    const APPEARANCE: bool = true;
}

/// Something to be done with the variant for a scene.
pub trait Work {
    /// What comes of it.
    type Output;

    /// Does it with the variant for precision `P` and effects `E`.
    fn with<P: Arithmetic, E: Effects>(self) -> Self::Output;
}

/// Does `work` with the smallest variant that has all that is scheduled, in this precision.
pub fn choose<W: Work>(precision: Precision, schedule: Schedule, work: W) -> W::Output {
    // Exact hits are shaded at robust points, which are in double precision already.
    match precision {
        Precision::Fast => choose_effects::<Fast, W>(schedule, work),
        Precision::Robust | Precision::Exact => choose_effects::<Robust, W>(schedule, work),
    }
}

fn choose_effects<P: Arithmetic, W: Work>(schedule: Schedule, work: W) -> W::Output {
    let appearance = schedule.runs(Step::Normals) || schedule.runs(Step::Texels);
    if schedule.has_mirrors() || appearance {
        work.with::<P, Every>()
    } else if schedule.has_shadows() {
        work.with::<P, Direct>()
    } else {
        work.with::<P, Ambient>()
    }
}
