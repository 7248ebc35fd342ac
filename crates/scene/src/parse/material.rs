//! Materials.

use crate::components::Material;
use crate::reader::{Cursor, Key, Kind, Object, Range, keys};
use wavecrest_base::error::Result;

/// Exponents of the highlight. At a million it is a fraction of a pixel wide.
const EXPONENT: Range = Range::new(0.0, 1e6);

pub(crate) const MATERIAL: Kind =
    Kind::new("a material", "A Blinn-Phong material with mirror reflection.", &[KEYS]);

const KEYS: &[Key] = keys! {
    /// Weight of the highlight, 0 to 1.
    "ks": Number(Range::NOT_NEGATIVE), Required;
    /// Weight of the diffuse part, 0 to 1.
    "kd": Number(Range::NOT_NEGATIVE), Required;
    /// Sharpness of the highlight.
    "specularexponent": Number(EXPONENT), Required;
    /// Colour of the diffuse part, unless a texture replaces it.
    "diffusecolor": Color, Required;
    /// Weight of the mirror ray, 0 to 1.
    "kr": Number(Range::NOT_NEGATIVE), Is(0.0);
    /// Emission, visible but without effect on other surfaces.
    "emission": Color, Are([0.0; 3]);
    /// Colour of the highlight and of mirrored light.
    "specularcolor": Color, Are([1.0; 3]);
};

/// Reads the `material` of a shape.
pub(super) fn material(cursor: &Cursor<'_>) -> Result<Material> {
    let object = cursor.object(MATERIAL)?;
    warn_of_gain(&object);
    Ok(Material {
        ks: object.number("ks"),
        kd: object.number("kd"),
        specular_exponent: object.number("specularexponent"),
        diffuse_color: object.color("diffusecolor"),
        kr: object.number("kr"),
        emission: object.color("emission"),
        specular_color: object.color("specularcolor"),
    })
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
    super::warn_above_1(object, "diffusecolor", message, remedy);
    super::warn_above_1(object, "specularcolor", message, remedy);
}
