//! Properties shared by all kinds of shapes, and limits on their number.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use hecs::World;

use super::occurrences::Occurrence;
use crate::components::{
    AreaLight, CutOut, Facing, Maps, Shading, Sides, StrengthMap, TextureRef, Transform,
};
use crate::query::json_path;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::prepared::Shape;

/// Numbers of primitives and vertices stay below this, so that they fit 32 bits and leave one value
/// for "none".
const MAX_NUMBER: usize = u32::MAX as usize - 1;

/// The properties shared by all kinds of shapes.
pub(crate) struct Common {
    pub(super) transform: DAffine3,
    pub(super) facing: Option<Facing>,
    pub(super) sides: Sides,
    pub(super) smooth: bool,
    pub(super) textured: bool,
    /// Whether it has a normal map.
    pub(super) normal_mapped: bool,
    pub(super) emission: Option<Vec3>,
    pub(super) place: String,
}

impl Common {
    pub(super) fn of(
        world: &World,
        Occurrence { entity, prototype, .. }: Occurrence,
        origin: DVec3,
    ) -> Self {
        let light = world.get::<&AreaLight>(entity).ok();
        let is_shape = light.is_none();
        let own = |entity| world.get::<&Transform>(entity).map_or(DAffine3::IDENTITY, |t| t.0);
        let mut transform = own(entity);
        if entity != prototype {
            transform *= own(prototype);
        }
        transform.translation -= origin;
        Self {
            transform,
            facing: world.get::<&Facing>(prototype).ok().map(|f| *f),
            sides: world.get::<&Sides>(entity).map_or(Sides::Both, |s| *s),
            smooth: is_shape && world.get::<&Shading>(entity).is_ok_and(|s| *s == Shading::Smooth),
            textured: is_shape
                && (world.get::<&TextureRef>(entity).is_ok()
                    || world.get::<&Maps>(entity).is_ok()
                    || world.get::<&CutOut>(entity).is_ok()),
            normal_mapped: is_shape
                && world
                    .get::<&Maps>(entity)
                    .is_ok_and(|maps| maps.normal.as_ref().is_some_and(StrengthMap::has_effect)),
            emission: light.map(|l| l.color.as_vec3()),
            place: json_path(world, entity),
        }
    }

    /// Whether the front of a flat shape is where its corners run clockwise in world space, given
    /// the normal on its front in its own space.
    pub(super) fn flipped(&self, front: DVec3) -> bool {
        let chosen = match self.facing {
            None => true,
            Some(Facing::Flipped) => false,
            Some(Facing::Toward(side)) => front.dot(side) >= 0.0,
        };
        chosen != self.mirrors()
    }

    /// Whether the transform reverses the winding.
    pub(super) fn mirrors(&self) -> bool {
        self.transform.matrix3.determinant() < 0.0
    }

    pub(super) fn shape(&self, primitives: std::ops::Range<u32>, flipped: bool) -> Shape {
        Shape {
            primitives,
            emission: self.emission,
            flipped,
            two_sided: self.sides == Sides::Both,
            smooth: false,
            colored: false,
            texture: None,
            detail: None,
            mesh: None,
        }
    }
}

pub(super) fn in_range(point: DVec3) -> bool {
    point.abs().max_element() <= f64::from(MAX_COORDINATE)
}

pub(super) fn check_point(common: &Common, point: DVec3) -> Result<()> {
    if in_range(point) {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Scene, "the transform moves the shape too far away")
        .at(format!("{}.transform", common.place))
        .value(format!("a coordinate of {:e}", point.abs().max_element()))
        .remedy(format!("keep coordinates within {MAX_COORDINATE:e}")))
}

/// A sphere or a disk in world space, but for its normal.
pub(crate) struct Round {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
    /// The rotation, possibly with a reflection, from its own space.
    pub(crate) turn: DMat3,
}

impl Common {
    /// A `shape` around `center` in world space.
    ///
    /// # Errors
    /// If it is too far away for single precision, or its radius is too small. Boxes of too large
    /// ones would have infinite area and make the tree's costs meaningless.
    pub(crate) fn round(&self, shape: &str, center: DVec3, radius: f64) -> Result<Round> {
        let center = self.transform.transform_point3(center);
        let turn = self.transform.matrix3;
        let scale = turn.x_axis.length();
        let size = radius * scale;
        check_point(self, center)?;
        if size > f64::from(MAX_COORDINATE) {
            let message = format!("the transform makes the {shape} too large");
            return Err(Error::new(ErrorKind::Scene, message)
                .at(format!("{}.transform", self.place))
                .value(format!("a radius of {size:e}"))
                .remedy(format!("keep it within {MAX_COORDINATE:e}")));
        }
        if size as f32 == 0.0 {
            let message = "the radius is too small for single precision";
            return Err(Error::new(ErrorKind::Scene, message)
                .at(format!("{}.radius", self.place))
                .value(size)
                .remedy("use a larger unit of length"));
        }
        let turn = turn * (1.0 / scale);
        Ok(Round { center: center.as_vec3(), radius: size as f32, turn })
    }
}

pub(super) fn check_count(common: &Common, count: usize, what: &str) -> Result<()> {
    if count <= MAX_NUMBER {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Limit, format!("the scene has too many {what}"))
        .at(&common.place)
        .value(count)
        .remedy(format!("at most {MAX_NUMBER} are allowed")))
}
