//! Materials.

use glam::DVec3;

use crate::format::{Declared, Key, Kind, Object, Range, Writer, component, keys};
use wavecrest_base::error::Result;

/// Exponents of the highlight. At a million it is a fraction of a pixel wide.
const EXPONENT: Range = Range::new(0.0, 1e6);

component! {
    /// Blinn-Phong, with a mirror.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Material {
        /// Weight of the highlight, 0 to 1.
        pub ks: f64 = "ks": Number(Range::NOT_NEGATIVE), Required;
        /// Weight of the diffuse part, 0 to 1.
        pub kd: f64 = "kd": Number(Range::NOT_NEGATIVE), Required;
        /// Sharpness of the highlight.
        pub specular_exponent: f64 = "specularexponent": Number(EXPONENT), Required;
        /// Colour of the diffuse part, unless a texture replaces it.
        pub diffuse_color: DVec3 = "diffusecolor": Color, Required;
        /// Weight of the mirror ray, 0 to 1.
        pub kr: f64 = "kr": Number(Range::NOT_NEGATIVE), Is(0.0);
        /// Emission, visible but without effect on other surfaces.
        pub emission: DVec3 = "emission": Color, Are([0.0; 3]);
        /// Colour of the highlight and of mirrored light.
        pub specular_color: DVec3 = "specularcolor": Color, Are([1.0; 3]);
    }
}

impl Material {
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
    let remedy = "use 0 to 1";
    let message = "is above 1, so the surface reflects more light than it receives";
    for key in ["ks", "kd", "kr"] {
        if let Some(cursor) =
            object.get(key).filter(|c| c.value().as_f64().is_some_and(|x| x > 1.0))
        {
            cursor.warn(message, remedy);
        }
    }
    object.warn_above_1("diffusecolor", message, remedy);
    object.warn_above_1("specularcolor", message, remedy);
}
