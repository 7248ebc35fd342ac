//! Shapes: the keys that all have, and the forms.

use glam::DVec3;

use crate::components::{Facing, Name, Quad, Shading, Sides, Sphere, Transform, Triangle};
use crate::corners::{
    direction, quad_has_area, quad_is_planar, quad_is_simple, quad_normal, quad_repeats_a_corner,
    triangle_has_area, triangle_normal,
};
use crate::reader::{Cursor, Object, Range};
use crate::schema::{Geometry, Shape};
use wavecrest_base::error::{Error, Result};

use super::{material, mesh, transform};

pub(super) const COMMON_KEYS: [&str; 12] = [
    "type",
    "name",
    "id",
    "material",
    "texture",
    "filter",
    "wrap",
    "encoding",
    "tint",
    "transform",
    "sides",
    "shading",
];

/// Of a shape of the scene, and not of one of a light.
pub(super) const SCENE_KEYS: [&str; 1] = ["hidden"];
pub(super) const SPHERE_KEYS: [&str; 2] = ["center", "radius"];
/// Of a plane and of a triangle.
pub(super) const FLAT_KEYS: [&str; 2] = ["points", "normal"];

/// Sine of the angle to the surface below which a `normal` does not tell the sides apart, in
/// single precision.
const IN_PLANE: f64 = 1e-6;

pub(super) const SIDES: [(&str, Sides); 2] = [("front", Sides::Front), ("both", Sides::Both)];
pub(super) const SHADINGS: [(&str, Shading); 2] =
    [("flat", Shading::Flat), ("smooth", Shading::Smooth)];

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Sphere,
    Plane,
    Triangle,
    Trimesh,
}

pub(super) const KINDS: [(&str, Kind); 4] = [
    ("sphere", Kind::Sphere),
    ("plane", Kind::Plane),
    ("triangle", Kind::Triangle),
    ("trimesh", Kind::Trimesh),
];

/// Reads an element of `scene.shapes`.
pub(super) fn shape(cursor: &Cursor<'_>) -> Result<Shape> {
    let object = open(cursor, &SCENE_KEYS)?;
    let hidden = object.get("hidden").map_or(Ok(false), |cursor| cursor.truth())?;
    let material = material::material(&object.need("material", "an object { ... }")?)?;
    let texture = material::texture(&object)?;
    Ok(Shape { hidden, material: Some(material), texture, ..form(&object)? })
}

/// Reads the `shape` of an area light. It shines with the light's own colour, so that its material
/// and its texture are not looked at.
pub(super) fn light_shape(cursor: &Cursor<'_>) -> Result<Shape> {
    let object = open(cursor, &[])?;
    let shape = form(&object)?;
    if let Geometry::Triangle(triangle) = &shape.geometry
        && !triangle_has_area(&triangle.points)
        && let Some(points) = object.get("points")
    {
        return Err(points.error("a light must have an area").remedy("move the corners apart"));
    }
    Ok(shape)
}

/// The shape as an object with exactly the keys that its kind has, and `more`.
fn open<'a>(cursor: &Cursor<'a>, more: &[&'static str]) -> Result<Object<'a>> {
    let (kind, own): (&str, &[&'static str]) = match cursor.kind("a shape", &KINDS)? {
        Kind::Sphere => ("a sphere", &SPHERE_KEYS),
        Kind::Plane => ("a plane", &FLAT_KEYS),
        Kind::Triangle => ("a triangle", &FLAT_KEYS),
        Kind::Trimesh => mesh::kind_and_keys(cursor)?,
    };
    cursor.object(kind, [&COMMON_KEYS[..], own, more].concat())
}

/// All of a shape but its material and texture.
fn form(object: &Object<'_>) -> Result<Shape> {
    let kind = object.choice("type", &KINDS)?;
    let transform = object.get("transform").map(|c| transform::transform(&c)).transpose()?;
    let (geometry, facing) = match kind {
        Kind::Sphere => (sphere(object, transform)?, None),
        Kind::Plane => quad(object)?,
        Kind::Triangle => triangle(object)?,
        Kind::Trimesh => (mesh::mesh(object)?, None),
    };
    let default_sides = match geometry {
        Geometry::Sphere(_) | Geometry::MeshFile(_) => Sides::Both,
        _ => Sides::Front,
    };
    Ok(Shape {
        path: object.cursor().path(),
        name: name(object)?,
        facing,
        geometry,
        transform: transform.map(Transform),
        sides: object.choice_or("sides", &SIDES, default_sides)?,
        shading: object.choice_or("shading", &SHADINGS, Shading::Flat)?,
        hidden: false,
        material: None,
        texture: None,
    })
}

pub(super) fn name(object: &Object<'_>) -> Result<Option<Name>> {
    let Some(cursor) = object.one_of(&["name", "id"])? else { return Ok(None) };
    Ok(Some(Name(cursor.text("a text that is not empty")?.to_owned())))
}

fn sphere(object: &Object<'_>, transform: Option<glam::DAffine3>) -> Result<Geometry> {
    if let Some(cursor) = object.get("transform")
        && transform.is_some_and(|t| !transform::is_uniform(&t))
    {
        return Err(uneven(&cursor));
    }
    let center = object.point(&["center"])?;
    Ok(Geometry::Sphere(Sphere { center, radius: object.number("radius", Range::POSITIVE)? }))
}

/// The transform at `cursor` would make something else of a sphere.
pub(super) fn uneven(cursor: &Cursor<'_>) -> Error {
    let error = cursor.error("a sphere cannot be sheared, nor scaled by unequal factors");
    error.remedy("scale it evenly, or use a trimesh")
}

fn quad(object: &Object<'_>) -> Result<(Geometry, Option<Facing>)> {
    let what = "four points [[x, y, z], ...]: bottom left, top left, top right, bottom right";
    let cursor = object.need("points", what)?;
    let points = cursor.points(what)?;
    check_quad(&cursor, &points)?;
    let facing = facing(object, quad_normal(&points))?;
    Ok((Geometry::Quad(Quad { points }), facing))
}

fn check_quad(cursor: &Cursor<'_>, points: &[DVec3; 4]) -> Result<()> {
    let order = "give them as bottom left, top left, top right, bottom right";
    if quad_repeats_a_corner(points) {
        let error = cursor.error("two neighbouring corners of the plane are the same point");
        return Err(error.remedy("use a triangle"));
    }
    if !quad_has_area(points) {
        return Err(cursor.error("the plane has no area").remedy(order));
    }
    if !quad_is_simple(points) {
        return Err(cursor.error("the edges of the plane cross or touch").remedy(order));
    }
    if !quad_is_planar(points) {
        let remedy = "it is drawn as two triangles, divided from the first point to the third";
        cursor.warn("the four points are not in one plane", remedy);
    }
    Ok(())
}

fn triangle(object: &Object<'_>) -> Result<(Geometry, Option<Facing>)> {
    let what = "three points [[x, y, z], ...]";
    let cursor = object.need("points", what)?;
    let points = cursor.points(what)?;
    let facing = facing(object, triangle_normal(&points))?;
    if !triangle_has_area(&points) {
        cursor.warn("the triangle has no area", "it is left out");
    }
    Ok((Geometry::Triangle(Triangle { points }), facing))
}

/// The `normal` of a plane or a triangle whose winding gives `front`.
fn facing(object: &Object<'_>, front: DVec3) -> Result<Option<Facing>> {
    let Some(cursor) = object.get("normal") else { return Ok(None) };
    if cursor.value().is_array() {
        let toward = cursor.point()?;
        check_toward(&cursor, toward, front)?;
        return Ok(Some(Facing::Toward(toward)));
    }
    match cursor.value().as_f64() {
        Some(1.0) => Ok(None),
        Some(-1.0) => Ok(Some(Facing::Flipped)),
        _ => Err(cursor.error("must be -1 to flip the face, 1 to keep it, or a vector [x, y, z]")),
    }
}

fn check_toward(cursor: &Cursor<'_>, toward: DVec3, front: DVec3) -> Result<()> {
    let Some(unit) = direction(toward) else {
        return Err(cursor
            .error("must have a direction")
            .remedy("give a vector such as [0, 1, 0]"));
    };
    // A shape without area has no sides to tell apart.
    if direction(front).is_some_and(|front| unit.dot(front).abs() < IN_PLANE) {
        let error = cursor.error("lies in the surface, so that it points to neither of its sides");
        return Err(error.remedy("give a vector that points away from the surface"));
    }
    Ok(())
}
