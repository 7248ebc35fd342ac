//! The surface of a shape: its material and its textures.

mod material;
mod textures;

use crate::format::Declaration;

pub use material::Material;
pub use textures::{
    CutOut, Encoding, Filter, Maps, MetalMap, Placing, StrengthMap, TextureRef, TextureSource, Wrap,
};
pub(crate) use textures::{THRESHOLD, existing_file};

/// The components of a surface.
pub(crate) const SURFACE: [Declaration; 5] = [
    Declaration::of::<Material>(),
    Declaration::of::<TextureRef>(),
    textures::LOOK_UP,
    Declaration::of::<CutOut>(),
    Declaration::of::<Maps>(),
];
