//! The passes of a render as a table: what each needs, reads and writes; and the part of it that
//! runs.
//!
//! [`PASSES`] is the only place that knows which effect needs which work. The census decides the
//! effects. The [`Schedule`] follows from these and the table: the steps that run and the columns
//! that have storage. Both tracers, the batch and the memory estimate read the schedule; an effect is asked for by itself
//! only where it adds light to a step that runs anyway, as an environment does.

use super::{Decision, Effect};

wavecrest_base::choices! {
    /// A group of columns in the wavefront's batch, which defines their widths, in the order of the batch.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum ColumnGroup {
        /// Radiance gathered by paths, and their pixels.
        Paths = "paths",
        /// The rays of this bounce.
        Rays = "rays",
        /// Their hits.
        Hits = "hits",
        /// Points that lights may reach.
        LitPoints = "lit points",
        /// Highlight colours at lit points.
        Tints = "tints",
        /// Queued shadow rays.
        ShadowRays = "shadow rays",
        /// The rays of the next bounce.
        NextRays = "next rays",
        /// Differentials of rays from surfaces, of this bounce and of the next.
        Differentials = "differentials",
        /// What the rays of this bounce and of the next went through, and the rays that wait.
        Branches = "branches",
    }
}

wavecrest_base::choices! {
    /// A pass, or a part of one, that a scene may skip. Names are those in messages.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Step {
        /// Camera rays.
        Generate = "generate",
        /// Points of rays within their pixel.
        Jitter = "jitter",
        /// Points of rays on the lens.
        Lens = "lens",
        /// Closest hits.
        Intersect = "intersect",
        /// Light of hits without further rays.
        Shade = "shade",
        /// Interpolated normals.
        Normals = "normals",
        /// Interpolated vertex colours.
        Colors = "colors",
        /// Texture look-ups.
        Texels = "texels",
        /// Normals from textures.
        NormalMaps = "normal maps",
        /// Look-ups in material textures.
        Maps = "maps",
        /// Highlight colours.
        Tints = "tints",
        /// Emission of materials.
        Emission = "emission",
        /// Points to light.
        Collect = "lit points",
        /// Mirror rays.
        Mirror = "mirror",
        /// Rays through surfaces, and the mirror rays of these.
        Transmit = "transmission",
        /// Their differentials.
        Differentials = "differentials",
        /// Shadow rays and the light they carry.
        Shadow = "shadow",
        /// The next bounce.
        Advance = "advance",
        /// Sums of pixels.
        Resolve = "resolve",
    }
}

/// The effects that a step serves. It runs if one of each list is present, for what shows them; without
/// lists it runs in every scene, for everything in it.
pub type Needs = &'static [&'static [Effect]];

/// A row of [`PASSES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// The work.
    pub step: Step,
    /// The pass that it is a part of; `None` for passes.
    pub part_of: Option<Step>,
    /// The effects it serves.
    pub needs: Needs,
    /// The columns that it reads.
    pub reads: &'static [ColumnGroup],
    /// The columns that it writes.
    pub writes: &'static [ColumnGroup],
}

impl Pass {
    /// Whether its needs are met.
    pub fn is_needed(&self, present: impl Fn(Effect) -> bool) -> bool {
        self.needs.iter().all(|any| any.iter().any(|&effect| present(effect)))
    }

    /// The effects that it serves.
    pub fn effects(self) -> impl Iterator<Item = Effect> {
        self.needs.iter().copied().flatten().copied()
    }
}

/// All lights: points of every kind are sampled in the same way.
const LIGHTS: &[Effect] = &[
    Effect::PointLights,
    Effect::SpotLights,
    Effect::DirectionalLights,
    Effect::AreaLights,
    Effect::AmbientOcclusion,
];

/// The effects that send rays on from surfaces.
const NEXT: &[Effect] = &[Effect::Mirrors, Effect::Transparency];

/// The passes in order of execution, each followed by its parts.
///
/// Kinds of shapes have no row: no pass depends on a kind, so an absent kind costs nothing as it
/// has no primitives. Nor have the hemispheric light and the environment, which a scene has or has
/// not.
pub const PASSES: [Pass; 19] = {
    use ColumnGroup::{
        Branches, Differentials, Hits, LitPoints, NextRays, Paths, Rays, ShadowRays, Tints,
    };
    [
        row(Step::Generate, None, &[], &[], &[Paths, Rays]),
        row(Step::Jitter, Some(Step::Generate), &[&[Effect::Antialiasing]], &[], &[Rays]),
        row(Step::Lens, Some(Step::Generate), &[&[Effect::DepthOfField]], &[], &[Rays]),
        row(Step::Intersect, None, &[], &[Rays], &[Hits]),
        row(Step::Shade, None, &[], &[Paths, Rays, Hits], &[Paths]),
        row(Step::Normals, Some(Step::Shade), &[&[Effect::SmoothShading]], &[Hits], &[]),
        row(Step::Colors, Some(Step::Shade), &[&[Effect::VertexColors]], &[Hits], &[]),
        row(Step::Texels, Some(Step::Shade), &[&[Effect::Textures]], &[Hits], &[]),
        row(Step::NormalMaps, Some(Step::Shade), &[&[Effect::NormalMaps]], &[Hits], &[]),
        row(Step::Maps, Some(Step::Shade), &[&[Effect::MaterialTextures]], &[Hits], &[]),
        // For mirrors alone, no row is written.
        row(Step::Tints, Some(Step::Shade), &[&[Effect::TintedHighlights]], &[Tints], &[Tints]),
        row(Step::Emission, Some(Step::Shade), &[&[Effect::Emission]], &[Hits], &[Paths]),
        row(Step::Collect, Some(Step::Shade), &[LIGHTS], &[Rays, Hits], &[LitPoints]),
        row(Step::Mirror, Some(Step::Shade), &[&[Effect::Mirrors]], &[Rays, Hits], &[NextRays]),
        row(
            Step::Transmit,
            Some(Step::Shade),
            &[&[Effect::Transparency]],
            &[Rays, Hits, Branches],
            &[NextRays, Branches],
        ),
        row(
            Step::Differentials,
            Some(Step::Shade),
            &[&[Effect::RayDifferentials], NEXT],
            &[Rays, Hits, Differentials],
            &[Differentials],
        ),
        row(Step::Shadow, None, &[LIGHTS], &[LitPoints, ShadowRays], &[ShadowRays, Paths]),
        row(Step::Advance, None, &[NEXT], &[NextRays], &[Rays]),
        row(Step::Resolve, None, &[], &[Paths], &[]),
    ]
};

const fn row(
    step: Step,
    part_of: Option<Step>,
    needs: Needs,
    reads: &'static [ColumnGroup],
    writes: &'static [ColumnGroup],
) -> Pass {
    Pass { step, part_of, needs, reads, writes }
}

/// [`PASSES`] without needs: every scene does all work. The image is the same, since effects that a
/// scene lacks add nothing to it.
pub const UNPLANNED: [Pass; PASSES.len()] = {
    let (mut passes, mut i) = (PASSES, 0);
    while i < passes.len() {
        passes[i].needs = &[];
        i += 1;
    }
    passes
};

/// The steps that run, and the columns that have storage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Schedule {
    /// A bit for each [`Step`], like the following.
    running: u32,
    /// Steps that run for every scene.
    unconditional: u32,
    /// A bit for each [`ColumnGroup`].
    columns: u16,
}

impl Schedule {
    /// The steps of `passes` that run with these decisions.
    pub(super) fn new(passes: &[Pass], decisions: &[Decision]) -> Self {
        let present = |effect| decisions.iter().any(|d| d.effect == effect && d.present);
        let mut schedule = Self::default();
        for pass in passes.iter().filter(|pass| pass.is_needed(present)) {
            schedule.running |= 1 << pass.step as u16;
            schedule.unconditional |= u32::from(pass.needs.is_empty()) << pass.step as u16;
            pass.writes.iter().for_each(|&column| schedule.columns |= 1 << column as u16);
        }
        schedule
    }

    /// Whether the step runs.
    #[inline(always)]
    pub fn runs(self, step: Step) -> bool {
        self.running >> step as u16 & 1 == 1
    }

    /// Whether the step runs in every scene, for everything in it.
    pub fn is_unconditional(self, step: Step) -> bool {
        self.unconditional >> step as u16 & 1 == 1
    }

    /// Whether shadow rays are traced: some light, by the census, reaches something in view.
    #[inline(always)]
    pub fn has_shadows(self) -> bool {
        self.runs(Step::Collect) && self.runs(Step::Shadow)
    }

    /// Whether mirror rays are traced.
    #[inline(always)]
    pub fn has_mirrors(self) -> bool {
        self.runs(Step::Mirror) && self.runs(Step::Advance)
    }

    /// Whether rays go through surfaces.
    #[inline(always)]
    pub fn has_transmission(self) -> bool {
        self.runs(Step::Transmit) && self.runs(Step::Advance)
    }

    /// Whether any rays go on from surfaces.
    #[inline(always)]
    pub fn goes_on(self) -> bool {
        self.has_mirrors() || self.has_transmission()
    }

    /// Whether the column has storage.
    pub fn has(self, column: ColumnGroup) -> bool {
        self.columns >> column as u16 & 1 == 1
    }

    /// The columns that have storage.
    pub fn columns(self) -> impl Iterator<Item = ColumnGroup> {
        ColumnGroup::ALL.into_iter().filter(move |&column| self.has(column))
    }
}

#[cfg(test)]
mod tests;
