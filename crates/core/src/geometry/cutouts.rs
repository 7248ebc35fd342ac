//! Cut-outs: primitives with holes given by the alpha of an image.
//!
//! A hit on a cut-out counts if alpha is at least its threshold; otherwise the primitive counts as
//! absent, for rays of every kind. The tests in lanes ignore alpha: only a hit that would replace a
//! ray's best is checked, alone.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec2;

use super::Geometry;
use crate::kernels::texture::Placing;
use crate::kernels::{CornerValues, Filter, LazyImage, UvMap, Wrap};

/// Primitives with the same cut-out.
#[derive(Clone, Debug)]
pub struct Cutout {
    /// The primitives, by number.
    pub primitives: Range<u32>,
    /// The lowest alpha that is opaque, from 0 to 1.
    pub threshold: f32,
    /// The image, each channel of which is alpha; `None` if that of vertices is all.
    pub image: Option<Arc<LazyImage>>,
    /// Filtering between texels.
    pub filter: Filter,
    /// Wrap mode of coordinates outside 0 to 1.
    pub wrap: Wrap,
    /// The map from points to texture coordinates.
    pub map: UvMap,
    /// A change of these coordinates, if any.
    pub placing: Option<Placing>,
    /// The coordinates of a mesh, for [`UvMap::Mesh`].
    pub mesh: Option<MeshUvs>,
}

/// Texture coordinates and alphas of a mesh.
#[derive(Clone, Debug)]
pub struct MeshUvs {
    /// The number of the mesh's first triangle.
    pub first_triangle: u32,
    /// The number of the mesh's first position.
    pub first_position: u32,
    /// The coordinates; empty if there are none.
    pub uvs: CornerValues<Vec2>,
    /// The alphas of vertex colours, which multiply that of the image.
    pub alphas: Option<CornerValues<f32>>,
}

impl Geometry {
    /// The cut-out of the primitive with this number.
    #[cold]
    #[inline(never)]
    pub(crate) fn cutout(&self, number: u32) -> Option<&Cutout> {
        let after = self.cutouts.partition_point(|cutout| cutout.primitives.start <= number);
        self.cutouts[..after].last().filter(|cutout| cutout.primitives.contains(&number))
    }
}

impl Cutout {
    /// Whether there is a hole at these coordinates, where vertices have this `alpha`.
    pub(super) fn is_hole(&self, uv: [f32; 2], alpha: f32) -> bool {
        let Some(image) = &self.image else { return alpha < self.threshold };
        // An image that cannot be decoded ends the render.
        let Some(image) = image.usable() else { return false };
        let uv = self.placing.map_or(uv, |placing| placing.apply(uv));
        image.look_up(uv, self.filter, self.wrap).x * alpha < self.threshold
    }
}
