//! An occurrence of a shape: what all kinds of shapes have besides their geometry, in world space,
//! and limits on their numbers and coordinates.

use std::ops::Range;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use hecs::Entity;

use super::output::ShapeOutput;
use crate::components::{Disk, Facing, Quad, Sides, Sphere, Triangle};
use crate::mesh::MAX_COUNT;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::prepared::{Shape, UvMap};

/// The geometry of a shape in its own space.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form<'w> {
    Sphere(&'w Sphere),
    Disk(&'w Disk),
    Quad(&'w Quad),
    Triangle(&'w Triangle),
    /// The mesh is the prototype's entity's, from which it is taken.
    Mesh,
}

/// A shape, possibly of a light, as it is shown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Occurrence<'w> {
    /// The shape, or the instance.
    pub(crate) entity: Entity,
    /// The entity with the prototype: the same except for instances.
    pub(crate) prototype: Entity,
    pub(crate) form: Form<'w>,
    /// The colour of the light whose shape it is.
    pub(crate) light: Option<Vec3>,
    /// Whether its material lets light through.
    pub(crate) is_transparent: bool,
    /// Whether it may have holes.
    pub(crate) is_cut_out: bool,
    /// Whether it may mirror anything.
    pub(crate) is_mirror: bool,
    /// Whether camera rays may meet it.
    pub(crate) is_seen: bool,
    /// Whether any rays may meet it.
    pub(crate) is_met: bool,
    pub(crate) transform: DAffine3,
    pub(super) facing: Option<Facing>,
    pub(super) sides: Sides,
    pub(super) smooth: bool,
    pub(super) textured: bool,
    /// Whether it has a normal map.
    pub(crate) normal_mapped: bool,
    pub(crate) place: &'w str,
}

/// A sphere or a disk in world space, but for its normal.
pub(crate) struct Round {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
    /// The rotation, possibly with a reflection, from its own space.
    pub(crate) turn: DMat3,
}

impl Occurrence<'_> {
    pub(super) fn is_mesh(&self) -> bool {
        matches!(self.form, Form::Mesh)
    }

    /// Whether shadow rays pass it, as a shape of a light or with less light.
    pub(super) fn is_passed(&self) -> bool {
        self.is_transparent || self.light.is_some()
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

    /// Its shape, and with it what later systems ask of it.
    pub(super) fn output(&self, shape: Shape, uv_map: UvMap) -> ShapeOutput {
        let &Self { entity, is_transparent, is_mirror, is_seen, is_met, .. } = self;
        ShapeOutput { entity, shape, uv_map, is_transparent, is_mirror, is_seen, is_met }
    }

    pub(super) fn shape(&self, primitives: Range<u32>, flipped: bool) -> Shape {
        Shape {
            primitives,
            light: self.light,
            flipped,
            two_sided: self.sides == Sides::Both,
            smooth: false,
            colored: false,
            class: 0,
            mesh: None,
            solid: None,
        }
    }

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
        self.check_point(center)?;
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

    pub(super) fn check_point(&self, point: DVec3) -> Result<()> {
        if in_range(point) {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Scene, "the transform moves the shape too far away")
            .at(format!("{}.transform", self.place))
            .value(format!("a coordinate of {:e}", point.abs().max_element()))
            .remedy(format!("keep coordinates within {MAX_COORDINATE:e}")))
    }

    pub(super) fn check_count(&self, count: usize, what: &str) -> Result<()> {
        if count as u64 <= MAX_COUNT {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Limit, format!("the scene has too many {what}"))
            .at(self.place)
            .value(count)
            .remedy(format!("at most {MAX_COUNT} are allowed")))
    }
}

pub(super) fn in_range(point: DVec3) -> bool {
    point.abs().max_element() <= f64::from(MAX_COORDINATE)
}
