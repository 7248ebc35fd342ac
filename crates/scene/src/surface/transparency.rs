//! Transparent materials.

use glam::{DVec3, Vec3};

use super::Material;
use crate::format::{Declared, Key, Object, Range, Writer, component};
use wavecrest_base::error::Result;
use wavecrest_core::kernels::transmission;

component! {
    /// Light that goes through a surface: straight on, or refracted.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Transparency {
        /// Share of the light that comes from the surface; the rest comes from straight behind it.
        pub opacity: f64 = "opacity": Number(Range::UNIT), Is(1.0);
        /// Whether the alpha of vertices, the mesh's `alphas`, multiplies the opacity.
        pub vertex_alpha: bool = "vertexalpha": Truth, Off;
        /// Share of the light that is refracted, or mirrored by Fresnel's equations; of `kr`, the rest is left.
        pub kt: f64 = "kt": Number(Range::UNIT), Is(0.0);
        /// Index of refraction of the inside, which the front of the surface encloses.
        pub ior: f64 = "ior": Number(Self::IOR), Is(1.5) => "kt";
        /// Whether the surface is a thin sheet, which bends no ray.
        pub thin: bool = "thin": Truth, Off => "kt" | "attenuationdistance";
        /// Colour of refracted light.
        pub color: DVec3 = "transmissioncolor": Color, Are([1.0; 3]) => "kt";
        /// Whether the base colour tints refracted light as well: `diffusecolor`, or the texture, times
        /// vertex colours; of a solid its square root at each surface.
        pub tinted: bool = "tinted": Truth, Off => "kt";
        /// Colour that light has left after the attenuation distance inside.
        pub attenuation_color: DVec3 = "attenuationcolor": Color, Are([1.0; 3])
            => "attenuationdistance";
        /// The distance, in scene units; 0 if light stays as it is.
        pub attenuation_distance: f64 = "attenuationdistance": Number(Range::NOT_NEGATIVE), Is(0.0)
            => "attenuationcolor";
        /// Of solids that overlap, the one with the highest priority is there; of equal ones the smallest.
        pub priority: f64 = "priority": Number(Range::COORDINATE), Is(0.0) => "kt" | "attenuationdistance";
    }
}

impl Declared for Transparency {
    const KEYS: &'static [Key] = Self::FIELDS;

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        // Most materials have none of the keys, and there may be many.
        let is_given = |key: &Key| object.cursor().value().get(key.name).is_some();
        if !Self::FIELDS.iter().any(is_given) {
            return Ok(Some(Self::OPAQUE));
        }
        Material::warn_of_gain(object, &["transmissioncolor"]);
        Ok(Some(Self::fields(object, None)))
    }

    fn write(&self, to: &mut Writer<'_>) {
        if *self != Self::OPAQUE {
            self.write_fields(to);
        }
    }
}

impl Transparency {
    /// Indices of refraction: from that of the empty inside of the densest material. Converters write
    /// large ones for what mirrors all.
    pub(crate) const IOR: Range = Range::at_least(0.1);

    /// Lets nothing through.
    pub const OPAQUE: Self = Self {
        opacity: 1.0,
        vertex_alpha: false,
        kt: 0.0,
        ior: 1.5,
        thin: false,
        color: DVec3::ONE,
        tinted: false,
        attenuation_color: DVec3::ONE,
        attenuation_distance: 0.0,
        priority: 0.0,
    };

    /// Whether anything goes through, or is absorbed inside.
    pub(crate) fn has_effect(&self) -> bool {
        let transmission::Transparency { opacity, kt, absorption, .. } = self.in_single_precision();
        opacity < 1.0 || kt > 0.0 || self.vertex_alpha || absorption != Vec3::ZERO
    }

    /// Whether it encloses what bends or absorbs light.
    pub(crate) fn is_medium(&self) -> bool {
        let transmission::Transparency { kt, ior, absorption, .. } = self.in_single_precision();
        absorption != Vec3::ZERO || !self.thin && kt > 0.0 && ior != 1.0
    }

    /// Whether all light passes it as if it were not there, if it adds none: in a medium, an empty solid is a bubble.
    pub(crate) fn is_clear(&self, is_black: bool, has_media: bool) -> bool {
        let transmission::Transparency { opacity, kt, ior, color, tinted, .. } =
            self.in_single_precision();
        let passes = kt == 1.0 && ior == 1.0 && color == Vec3::ONE && !tinted && is_black;
        let is_sheet = self.thin || kt == 0.0;
        (opacity == 0.0 || passes) && !self.is_medium() && (is_sheet || !has_media)
    }

    /// As tracers read it.
    pub(crate) fn in_single_precision(&self) -> transmission::Transparency {
        transmission::Transparency {
            opacity: self.opacity as f32,
            kt: self.kt as f32,
            ior: self.ior as f32,
            color: self.color.as_vec3(),
            tinted: self.tinted && self.kt as f32 > 0.0,
            absorption: self.absorption().as_vec3(),
            thin: self.thin,
        }
    }

    /// Light absorbed inside, by channel, per scene unit.
    fn absorption(&self) -> DVec3 {
        // A thin sheet has no inside.
        if self.thin || self.attenuation_distance == 0.0 {
            return DVec3::ZERO;
        }
        let left = self.attenuation_color.clamp(DVec3::splat(LEAST), DVec3::ONE);
        // Finite in single precision, so that no product is infinity times zero.
        let of = |left: f64| (-libm::log(left) / self.attenuation_distance).min(f32::MAX.into());
        DVec3::new(of(left.x), of(left.y), of(left.z))
    }
}

/// Less light than this counts as none: a millionth is below every step of an image.
const LEAST: f64 = 1e-6;
