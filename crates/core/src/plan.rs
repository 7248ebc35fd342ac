//! The plan: which effects a scene needs, why others are skipped, and which passes run.
//!
//! The census (`systems::census` of the scene crate) makes the plan once. An effect that it skips
//! costs nothing: its pass does not run, its queue has no storage, its random numbers are not
//! drawn.

pub mod schedule;

use serde::Serialize;

use schedule::{Pass, Schedule};

wavecrest_base::choices! {
    /// An effect that costs time only in scenes that show it, in the order in which a ray meets them.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Effect {
        /// Several rays through different points of a pixel.
        Antialiasing = "antialiasing",
        /// A lens with an aperture.
        DepthOfField = "depth of field",
        /// Triangles, alone or in meshes.
        Triangles = "triangles",
        /// Quads.
        Quads = "quads",
        /// Spheres.
        Spheres = "spheres",
        /// Disks.
        Disks = "disks",
        /// Interpolated normals.
        SmoothShading = "smooth shading",
        /// Vertex colours.
        VertexColors = "vertex colours",
        /// Texture look-ups.
        Textures = "textures",
        /// Normals from textures.
        NormalMaps = "normal maps",
        /// Textures of metal and roughness, and of ambient light.
        MaterialTextures = "material textures",
        /// Coloured highlights.
        TintedHighlights = "tinted highlights",
        /// Emission of materials.
        Emission = "emission",
        /// Holes given by the alpha of an image.
        CutOuts = "cut-outs",
        /// Ray differentials, for textures filtered over their footprints.
        RayDifferentials = "ray differentials",
        /// Hemispheric ambient light.
        HemisphereLight = "hemisphere light",
        /// What is near a surface and in the way of ambient light, with a shadow ray for each sample.
        AmbientOcclusion = "ambient occlusion",
        /// An image or a gradient all around.
        Environment = "environment",
        /// Point lights, with a shadow ray each.
        PointLights = "point lights",
        /// Spot lights, with a shadow ray each.
        SpotLights = "spot lights",
        /// Directional lights, with a shadow ray for each sample.
        DirectionalLights = "directional lights",
        /// Area lights, with a shadow ray for each sample.
        AreaLights = "area lights",
        /// Mirror rays.
        Mirrors = "mirrors",
        /// Surfaces that let light through: straight on, or refracted.
        Transparency = "transparency",
    }
}

/// Whether an effect is simulated, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Decision {
    /// The effect.
    pub effect: Effect,
    /// Whether the scene needs it.
    pub present: bool,
    /// The reason, from the scene.
    pub reason: String,
}

/// The census's decisions, one for each effect, and the resulting schedule.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Plan {
    decisions: Vec<Decision>,
    #[serde(skip)]
    schedule: Schedule,
}

impl Plan {
    /// The plan with these decisions. Another table than [`PASSES`](schedule::PASSES) is for tests of the table
    /// itself, and for renders that skip nothing ([`schedule::UNPLANNED`]).
    pub fn of(decisions: Vec<Decision>, passes: &[Pass]) -> Self {
        let schedule = Schedule::new(passes, &decisions);
        Self { decisions, schedule }
    }

    /// All decisions.
    pub fn decisions(&self) -> &[Decision] {
        &self.decisions
    }

    /// Whether the scene needs `effect`. For each ray, read [`Schedule`] instead.
    pub fn has(&self, effect: Effect) -> bool {
        self.decisions.iter().any(|d| d.effect == effect && d.present)
    }

    /// The steps that run, and the columns that have storage.
    #[inline(always)]
    pub fn schedule(&self) -> Schedule {
        self.schedule
    }

    /// Why the pass runs or not: the decisions on the effects that it needs.
    pub fn reason(&self, pass: &Pass) -> String {
        let effects: Vec<Effect> = pass.effects().collect();
        if effects.is_empty() {
            return "every scene needs it".to_owned();
        }
        let runs = self.schedule.runs(pass.step);
        let asked = self.decisions.iter().filter(|d| effects.contains(&d.effect));
        let reasons: Vec<&str> =
            asked.filter(|d| d.present == runs).map(|d| d.reason.as_str()).collect();
        reasons.join(", ")
    }
}
