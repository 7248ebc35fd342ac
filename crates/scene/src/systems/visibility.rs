//! Components of the entity of a shape or a light: what systems find out about it.

use hecs::Entity;

use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::prepared::Shape;

/// The entity that a shape or a light is made of; that of a shape has its surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source(pub(crate) Entity);

/// The largest weights of a shape's material in any texel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaterialBound(pub(crate) Material);

/// Which rays may meet a shape, and what they may see there: in doubt they do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Visibility {
    /// Whether camera rays may meet it.
    pub(crate) is_seen: bool,
    /// Whether any rays may meet it; otherwise it has no primitives.
    pub(crate) is_met: bool,
    /// Whether its material lets light through.
    pub(crate) is_transparent: bool,
    /// Whether its mirror, if it is one, may show anything.
    pub(crate) is_mirror: bool,
    /// Whether rays can meet a surface of it: not of a light's shape, and not without area.
    pub(crate) is_surface: bool,
    /// The visible sides that lights can reach, also in mirrors; `None` if it is out of view.
    pub(crate) faces: Option<Faces>,
    /// Whether any light but ambient light reaches what is visible, or else any of it.
    pub(crate) is_lit: bool,
    /// The visible properties of its material; if it is out of view, those that would be.
    pub(crate) shows: Shows,
    /// Whether any texture that shows is trilinear.
    pub(crate) is_trilinear: bool,
    /// Whether it has holes that rays may meet.
    pub(crate) has_holes: bool,
}

impl Visibility {
    /// Whether any of its surface is in view.
    pub(crate) fn is_in_view(&self) -> bool {
        self.is_surface && self.faces.is_some()
    }

    /// Whether rays may meet its surface.
    pub(crate) fn is_surface_met(&self) -> bool {
        self.is_surface && self.is_met
    }

    /// Whether rays may meet its surface, which lets light through.
    pub(crate) fn lets_light_through(&self) -> bool {
        self.is_surface_met() && self.is_transparent
    }
}

/// The visible properties of a shape's material; of one out of view, those that would be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Shows {
    /// Its base colour, where vertex colours or a texture vary it.
    pub(crate) color: bool,
    /// The texture of its colour.
    pub(crate) texture: bool,
    pub(crate) emission: bool,
    /// The texture of metalness and roughness.
    pub(crate) metal: bool,
    /// The texture of ambient light.
    pub(crate) occlusion: bool,
    /// The colour of its highlight, or of mirrored light.
    pub(crate) tint: bool,
    /// The texture of its normals.
    pub(crate) normal: bool,
}

/// Sides of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Faces {
    pub(crate) front: bool,
    pub(crate) back: bool,
}

impl Faces {
    pub(crate) const FRONT: Self = Self { front: true, back: false };
    pub(crate) const BACK: Self = Self { front: false, back: true };

    /// The sides of the shape that lights can reach.
    pub(crate) fn lit(shape: &Shape) -> Self {
        Self { front: true, back: shape.two_sided }
    }

    pub(crate) fn any(self) -> bool {
        self.front || self.back
    }
}
