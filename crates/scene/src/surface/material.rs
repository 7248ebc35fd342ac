//! Materials.

use glam::DVec3;

use crate::format::{Declared, Key, Kind, Object, Range, Writer, component, keys};
use wavecrest_base::error::Result;

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
    };

    /// The object of a material.
    pub(crate) const OBJECT: Kind =
        Kind::new("a material", "A Blinn-Phong material with mirror reflection.", Self::FIELDS);
}

impl Declared for Material {
    const KEYS: &'static [Key] = keys! {
        /// The material.
        "material": Object(&Material::OBJECT), Required;
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let object = object.need("material", "an object { ... }")?.object(Self::OBJECT)?;
        warn_of_gain(&object);
        Ok(Some(Self::fields(&object, None)))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.object("material", |to| self.write_fields(to));
    }
}

/// Weights above 1 are allowed but rarely meant. Invalid values are reported when they are read.
fn warn_of_gain(object: &Object<'_>) {
    let message = "is above 1, so the surface reflects more light than it receives";
    for key in ["ks", "kd", "kr", "diffusecolor", "specularcolor"] {
        object.warn_above_1(key, message, "use 0 to 1");
    }
}
