//! Materials.

use glam::{DVec3, Vec3};

use super::Transparency;
use wavecrest_core::kernels::metal::look;
use wavecrest_core::kernels::shade::HALF_LEVEL;

use crate::format::{Declaration, Kind, Object, Range, component, declared, keys};

component! {
    /// Blinn-Phong, with a mirror.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Material {
        /// Weight of the highlight, 0 to 1.
        pub ks: f64 = "ks": Number(Range::NOT_NEGATIVE), Required;
        /// Weight of the diffuse part, 0 to 1.
        pub kd: f64 = "kd": Number(Range::NOT_NEGATIVE), Required;
        /// Sharpness of the highlight.
        pub specular_exponent: f64 =
            "specularexponent": Number(Range::new(0.0, Self::SHARPEST)), Required;
        /// Diffuse colour D, unless a texture replaces it.
        pub diffuse_color: DVec3 = "diffusecolor": Color, Required;
        /// Weight of the mirror ray, 0 to 1.
        pub kr: f64 = "kr": Number(Range::NOT_NEGATIVE), Is(0.0);
        /// Colour that the surface emits, visible from both sides. It does not light other
        /// surfaces: use an area light for that.
        pub emission: DVec3 = "emission": Color, Are([0.0; 3]);
        /// Colour S of the highlight and of mirrored light.
        pub specular_color: DVec3 = "specularcolor": Color, Are([1.0; 3]);
        /// Share of ambient light that is scattered.
        pub ambient: f64 = "ka": Number(Range::UNIT), Is(1.0);
        /// Whether it shows its base colour as it is, under any light: `diffusecolor`, or the texture,
        /// times vertex colours.
        pub unlit: bool = "unlit": Truth, Off;
    }
}

impl Material {
    /// The largest exponent of a highlight, which is then a fraction of a pixel wide.
    pub(crate) const SHARPEST: f64 = 1e6;

    /// White, without a highlight and a mirror.
    pub const MATTE: Self = Self {
        ks: 0.0,
        kd: 1.0,
        specular_exponent: 1.0,
        diffuse_color: DVec3::ONE,
        kr: 0.0,
        emission: DVec3::ZERO,
        specular_color: DVec3::ONE,
        ambient: 1.0,
        unlit: false,
    };

    /// The weight of what it mirrors.
    pub(crate) fn mirrors(&self) -> Vec3 {
        self.specular_color.as_vec3() * self.kr as f32
    }

    /// Whether only what is brighter than white shows in it.
    pub(crate) fn is_faint_mirror(&self) -> bool {
        self.mirrors() != Vec3::ZERO && self.mirrors().max_element() < HALF_LEVEL
    }

    /// That of a base colour, metalness and roughness.
    pub(crate) fn metal(color: DVec3, metallic: f64, roughness: f64) -> Self {
        let look = look(color.into(), metallic, roughness);
        Self {
            ks: look.ks,
            kd: look.kd,
            specular_exponent: look.exponent,
            diffuse_color: color,
            kr: look.kr,
            specular_color: look.tint.into(),
            ambient: look.kd,
            ..Self::MATTE
        }
    }

    /// Weights above 1 are allowed but rarely meant. Invalid values are reported when they are read.
    pub(super) fn warn_of_gain(object: &Object<'_>, keys: &[&'static str]) {
        let message = "is above 1, so the surface reflects more light than it receives";
        keys.iter().for_each(|key| object.warn_above_1(key, message, "use 0 to 1"));
    }
}

declared!(Material, |_: &mut Self, object: &Object<'_>| {
    Self::warn_of_gain(object, &["ks", "kd", "kr", "diffusecolor", "specularcolor"]);
    Ok(())
});

/// The object of a material.
pub(crate) const OBJECT: Kind = Kind {
    components: &[Declaration::of::<Material>(), Declaration::of::<Transparency>()],
    ..Kind::new("a material", "A Blinn-Phong material with mirror reflection and refraction.", &[])
};

/// The components of a material, which have an object of their own.
pub(crate) const MATERIAL: Declaration = Declaration {
    keys: keys! {
        /// The material.
        "material": Object(&OBJECT), Required;
    },
    read: |object, entity| {
        object.need("material", "an object { ... }")?.object(OBJECT)?.components(entity)
    },
    write: |entity, to| to.object("material", |to| to.components(&OBJECT, entity)),
    copy: |from, to| OBJECT.declarations().for_each(|component| (component.copy)(from, to)),
    is_in: |entity| entity.has::<Material>(),
};
