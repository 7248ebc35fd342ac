//! Decoding of vertex colours.

use rayon::prelude::*;

use super::data::MeshData;
use crate::components::VertexColors;
use wavecrest_core::math::srgb::srgb_decode;

impl MeshData {
    /// Decodes the colours of a file to linear ones, or drops them.
    pub(crate) fn decode_colors(&mut self, encoding: VertexColors) {
        match (encoding, &mut self.colors) {
            (VertexColors::Srgb, Some(colors)) => {
                colors.par_iter_mut().for_each(|color| *color = color.map(srgb_decode));
            }
            (VertexColors::None, colors) => *colors = None,
            _ => {}
        }
    }
}
