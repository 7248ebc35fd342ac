//! The surface of a shape: its material and its textures.

mod maps;
mod material;
mod textures;
mod transparency;

use crate::format::Declaration;

pub(crate) use maps::{EMISSION_MAP, METAL_MAP, OCCLUSION_MAP, OPACITY_MAP};
pub use maps::{Map, Maps};
pub use material::Material;
pub(crate) use material::{MATERIAL, OBJECT as MATERIAL_OBJECT};
pub use textures::{Channels, CutOut, Encoding, Filter, LookUp, Placing, TextureRef, Wrap};
pub(crate) use textures::{IMAGE, THRESHOLD, existing_file};
pub use transparency::Transparency;

/// The components of a surface.
pub(crate) const SURFACE: [Declaration; 5] = [
    MATERIAL,
    Declaration::of::<TextureRef>(),
    textures::LOOK_UP,
    Declaration::of::<CutOut>(),
    Declaration::of::<Maps>(),
];
