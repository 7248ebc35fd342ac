//! The plan: which effects a scene needs, why others are skipped, and which passes run.
//!
//! The census (`systems::census` of the scene crate) makes the plan once. An effect that it skips
//! costs nothing: its pass does not run, its queue has no storage, its random numbers are not
//! drawn.

pub mod schedule;

use serde::Serialize;

use schedule::{PASSES, Pass, Schedule};

/// An effect that costs time only in scenes that show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Triangles, alone or in meshes.
    Triangles,
    /// Quads.
    Quads,
    /// Spheres.
    Spheres,
    /// Disks.
    Disks,
    /// Interpolated normals.
    SmoothShading,
    /// Vertex colours.
    VertexColors,
    /// Texture look-ups.
    Textures,
    /// Normals from textures.
    NormalMaps,
    /// Textures of metal and roughness, and of ambient light.
    MaterialTextures,
    /// Coloured highlights.
    TintedHighlights,
    /// Emission of materials.
    Emission,
    /// Holes given by the alpha of an image.
    CutOuts,
    /// Ray differentials, for textures filtered over their footprints.
    RayDifferentials,
    /// Hemispheric ambient light.
    HemisphereLight,
    /// Point lights, with a shadow ray each.
    PointLights,
    /// Spot lights, with a shadow ray each.
    SpotLights,
    /// Directional lights, with a shadow ray for each sample.
    DirectionalLights,
    /// Area lights, with a shadow ray for each sample.
    AreaLights,
    /// Mirror rays.
    Mirrors,
    /// A lens with an aperture.
    DepthOfField,
    /// Several rays through different points of a pixel.
    Antialiasing,
}

impl Effect {
    /// Every effect, in the order in which a ray meets them.
    pub const ALL: [Self; 21] = [
        Self::Antialiasing,
        Self::DepthOfField,
        Self::Triangles,
        Self::Quads,
        Self::Spheres,
        Self::Disks,
        Self::SmoothShading,
        Self::VertexColors,
        Self::Textures,
        Self::NormalMaps,
        Self::MaterialTextures,
        Self::TintedHighlights,
        Self::Emission,
        Self::CutOuts,
        Self::RayDifferentials,
        Self::HemisphereLight,
        Self::PointLights,
        Self::SpotLights,
        Self::DirectionalLights,
        Self::AreaLights,
        Self::Mirrors,
    ];

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Quads => "quads",
            Self::Spheres => "spheres",
            Self::Disks => "disks",
            Self::SmoothShading => "smooth shading",
            Self::VertexColors => "vertex colours",
            Self::Textures => "textures",
            Self::NormalMaps => "normal maps",
            Self::MaterialTextures => "material textures",
            Self::TintedHighlights => "tinted highlights",
            Self::Emission => "emission",
            Self::CutOuts => "cut-outs",
            Self::RayDifferentials => "ray differentials",
            Self::HemisphereLight => "hemisphere light",
            Self::PointLights => "point lights",
            Self::SpotLights => "spot lights",
            Self::DirectionalLights => "directional lights",
            Self::AreaLights => "area lights",
            Self::Mirrors => "mirrors",
            Self::DepthOfField => "depth of field",
            Self::Antialiasing => "antialiasing",
        }
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
    /// The plan with these decisions.
    pub fn new(decisions: Vec<Decision>) -> Self {
        Self::of(decisions, &PASSES)
    }

    /// As [`Plan::new`], with another table than [`PASSES`]: for tests of the table itself, and for
    /// renders that skip nothing ([`schedule::unplanned`]).
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
        let effects = pass.needs.effects();
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
