//! Flat shapes: quads and triangles.

use glam::DVec3;

use crate::corners::{
    direction, quad_has_area, quad_is_planar, quad_is_simple, quad_normal, quad_repeats_a_corner,
    triangle_has_area, triangle_normal,
};
use crate::format::{Cursor, Declaration, Declared, Field, Key, Kind, Object, Writer, keys};
use wavecrest_base::error::Result;

/// Sine of the angle to the surface below which a `normal` does not distinguish the sides, in
/// single precision.
const IN_PLANE: f64 = 1e-6;

pub(super) const PLANE: Kind = Kind::entity(
    "plane",
    "a plane",
    "A flat quad.",
    &[Declaration::of::<Quad>(), Declaration::of::<Facing>()],
);

pub(super) const TRIANGLE: Kind = Kind::entity(
    "triangle",
    "a triangle",
    "A triangle.",
    &[Declaration::of::<Triangle>(), Declaration::of::<Facing>()],
);

/// A planar quad: bottom left, top left, top right, bottom right as seen from its front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// The corners in that order.
    pub points: [DVec3; 4],
}

impl Declared for Quad {
    const KEYS: &'static [Key] = keys! {
        /// Bottom left, top left, top right, bottom right, as seen from the front.
        "points": Exactly(4, &Point), Required;
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let what = "four points [[x, y, z], ...]: bottom left, top left, top right, bottom right";
        let cursor = object.need("points", what)?;
        let points = cursor.exactly(what, |item| item.point())?;
        check_quad(&cursor, &points)?;
        check_facing(object, quad_normal(&points))?;
        Ok(Some(Self { points }))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.set("points", self.points.map(Field::to_json).to_vec());
    }
}

/// One triangle. It is half a [`Quad`]: its front is where the points run clockwise, so that u
/// along `points[0]` to `points[2]` and v along `points[0]` to `points[1]` read left to right and
/// bottom to top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// The corners.
    pub points: [DVec3; 3],
}

impl Triangle {
    /// Whether it has an area beyond rounding.
    pub(crate) fn has_area(&self) -> bool {
        triangle_has_area(&self.points)
    }
}

impl Declared for Triangle {
    const KEYS: &'static [Key] = keys! {
        /// The corners, clockwise as seen from the front.
        "points": Exactly(3, &Point), Required;
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let what = "three points [[x, y, z], ...]";
        let cursor = object.need("points", what)?;
        let triangle = Self { points: cursor.exactly(what, |item| item.point())? };
        check_facing(object, triangle_normal(&triangle.points))?;
        if !triangle.has_area() {
            cursor.warn("the triangle has no area", "it is left out");
        }
        Ok(Some(triangle))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.set("points", self.points.map(Field::to_json).to_vec());
    }
}

fn check_quad(cursor: &Cursor<'_>, points: &[DVec3; 4]) -> Result<()> {
    let order = "order them bottom left, top left, top right, bottom right";
    if quad_repeats_a_corner(points) {
        let error = cursor.error("two neighbouring corners of the plane are equal");
        return Err(error.remedy("use a triangle"));
    }
    if !quad_has_area(points) {
        return Err(cursor.error("the plane has no area").remedy(order));
    }
    if !quad_is_simple(points) {
        return Err(cursor.error("the edges of the plane cross or touch").remedy(order));
    }
    if !quad_is_planar(points) {
        let remedy = "it is rendered as two triangles that share the first and third points";
        cursor.warn("the four points are not in one plane", remedy);
    }
    Ok(())
}

/// Which side of a [`Quad`] or a [`Triangle`] is its front. Without this component, the winding
/// decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facing {
    /// Opposite to the winding's side.
    Flipped,
    /// The side that this vector points to, in the shape's own space.
    Toward(DVec3),
}

impl Declared for Facing {
    const KEYS: &'static [Key] = keys! {
        /// -1 turns the front to the other side; a vector selects the side that it points to.
        "normal": Either(&Point, &OneOf(&[1, -1]));
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let Some(cursor) = object.get("normal") else { return Ok(None) };
        if cursor.value().is_array() {
            return Ok(Some(Self::Toward(cursor.point()?)));
        }
        match cursor.value().as_f64() {
            Some(1.0) => Ok(None),
            Some(-1.0) => Ok(Some(Self::Flipped)),
            _ => {
                Err(cursor
                    .error("must be -1 to flip the face, 1 to keep it, or a vector [x, y, z]"))
            }
        }
    }

    fn write(&self, to: &mut Writer<'_>) {
        match self {
            Self::Flipped => to.set("normal", -1),
            Self::Toward(side) => to.put("normal", *side),
        }
    }
}

/// Checks the `normal` of a shape whose winding gives `front`.
fn check_facing(object: &Object<'_>, front: DVec3) -> Result<()> {
    match (Facing::read(object)?, object.get("normal")) {
        (Some(Facing::Toward(toward)), Some(cursor)) => check_toward(&cursor, toward, front),
        _ => Ok(()),
    }
}

fn check_toward(cursor: &Cursor<'_>, toward: DVec3, front: DVec3) -> Result<()> {
    let Some(unit) = direction(toward) else {
        return Err(cursor.error("must not be zero").remedy("use a vector such as [0, 1, 0]"));
    };
    // A shape without area has no sides to distinguish.
    if direction(front).is_some_and(|front| unit.dot(front).abs() < IN_PLANE) {
        let error = cursor.error("lies in the plane of the surface");
        return Err(error.remedy("use a vector that points away from the surface"));
    }
    Ok(())
}
