//! Shapes: the keys of all shapes, and those of each kind.

use glam::DVec3;

use crate::components::{
    Encoding, Facing, Filter, Maps, Name, Quad, Shading, Sides, Sphere, Transform, Triangle, Wrap,
};
use crate::corners::{
    direction, quad_has_area, quad_is_planar, quad_is_simple, quad_normal, quad_repeats_a_corner,
    triangle_has_area, triangle_normal,
};
use crate::reader::{Absent, Cursor, Key, Kind, Object, Range, Takes, keys};
use crate::schema::{Geometry, Shape};
use wavecrest_base::error::{Error, Result};

use super::{maps, material, mesh, transform};

/// Sine of the angle to the surface below which a `normal` does not distinguish the sides, in
/// single precision.
const IN_PLANE: f64 = 1e-6;

wavecrest_base::choices! {
    /// The shapes.
    #[derive(Clone, Copy, PartialEq)]
    pub(crate) enum ShapeKind {
        /// A sphere.
        Sphere = "sphere",
        /// A flat quad.
        Plane = "plane",
        /// A triangle.
        Triangle = "triangle",
        /// A mesh of triangles.
        Trimesh = "trimesh",
    }
}

const NAME_KEYS: &[Key] = keys! {
    /// The kind of shape.
    "type": word::<ShapeKind>(), Required;
    /// A name, for messages and for instances.
    "name": Text;
    /// Synonym of name.
    "id": Text;
};

/// Keys of shapes of the scene.
const SCENE_KEYS: &[Key] = keys! {
    /// The material.
    "material": Definition("material"), Required;
    /// An image that replaces the diffuse colour: a path from the scene's folder.
    "texture": Text;
    /// Filtering between texels.
    "filter": word::<Filter>(), Says("bilinear");
    /// Wrap mode of coordinates outside 0 to 1.
    "wrap": word::<Wrap>(), Says("repeat");
    /// Encoding of the texture's values.
    "encoding": word::<Encoding>(), Says("linear");
    /// Factor on the colours of the texture.
    "tint": Color, Are([1.0; 3]);
    /// Parts of the shape where the alpha of the texture, or of the image alpha, is lower are cut out.
    "alphacutoff": Number(Range::NOT_NEGATIVE);
    /// An image whose alpha, or brightness if it has none, cuts out the shape.
    "alpha": Text;
    /// Transform of the texture coordinates before the look-up.
    "uvtransform": Definition("uvtransform");
    /// Colours that multiply the material's emission.
    "emissionmap": Definition("colormap");
    /// Metalness and roughness, which determine the rest of the material together with the colour.
    "metalmap": Definition("metalmap");
    /// The share of ambient light that arrives, in the red channel.
    "occlusionmap": Definition("strengthmap");
    /// Normals: red along u, green along v, blue along the surface normal.
    "normalmap": Definition("strengthmap");
    /// Whether only its instances are visible.
    "hidden": Truth, Off;
};

/// Keys of shapes of lights, which have a colour of their own and are always visible.
const LIGHT_KEYS: &[Key] = &[
    ignored("material"),
    ignored("texture"),
    ignored("filter"),
    ignored("wrap"),
    ignored("encoding"),
    ignored("tint"),
    ignored("alphacutoff"),
    ignored("alpha"),
    ignored("uvtransform"),
    ignored("emissionmap"),
    ignored("metalmap"),
    ignored("occlusionmap"),
    ignored("normalmap"),
];

const fn ignored(name: &'static str) -> Key {
    let about = "Not looked at: the light has a colour of its own.";
    Key { name, takes: Takes::Anything, absent: Absent::Open, about }
}

const PLACE_KEYS: &[Key] = keys! {
    /// Transform from its own space to the world.
    "transform": Definition("transform");
    /// The sides that lights illuminate; by default both for spheres and for meshes without
    /// `normal`, and the front for others.
    "sides": word::<Sides>();
    /// Whether a mesh is shaded with its triangles' normals or with its own.
    "shading": word::<Shading>(), Says("flat");
};

/// The owner of a shape, which decides the keys shared by all kinds of shapes.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Owner {
    Scene,
    Light,
}

/// The kind of object of a shape with these keys of its `own`.
pub(crate) fn kind(own: &Kind, owner: Owner) -> Kind {
    let shared: &[&[Key]] = match owner {
        Owner::Scene => &[NAME_KEYS, SCENE_KEYS, PLACE_KEYS],
        Owner::Light => &[NAME_KEYS, LIGHT_KEYS, PLACE_KEYS],
    };
    Kind { keys: shared, more: own.keys, ..*own }
}

// The kinds of shapes, with the keys that others lack.

pub(crate) const SPHERE: Kind = Kind::new("a sphere", "A sphere.", &[SPHERE_KEYS]);
pub(crate) const PLANE: Kind = Kind::new("a plane", "A flat quad.", &[PLANE_KEYS, FLAT_KEYS]);
pub(crate) const TRIANGLE: Kind =
    Kind::new("a triangle", "A triangle.", &[TRIANGLE_KEYS, FLAT_KEYS]);

const SPHERE_KEYS: &[Key] = keys! {
    /// The centre.
    "center": Point, Required;
    /// The radius.
    "radius": Number(Range::POSITIVE), Required;
};

const PLANE_KEYS: &[Key] = keys! {
    /// Bottom left, top left, top right, bottom right, as seen from the front.
    "points": Exactly(4, &Point), Required;
};

const TRIANGLE_KEYS: &[Key] = keys! {
    /// The corners, clockwise as seen from the front.
    "points": Exactly(3, &Point), Required;
};

const FLAT_KEYS: &[Key] = keys! {
    /// -1 swaps front and back; a vector points to the front.
    "normal": PointOr(&[1, -1]);
};

/// Reads an element of `scene.shapes`.
pub(super) fn shape(cursor: &Cursor<'_>) -> Result<Shape> {
    let object = open(cursor, Owner::Scene)?;
    let hidden = object.get("hidden").map_or(Ok(false), |cursor| cursor.truth())?;
    let material = object.part("material", "an object { ... }", material::material);
    let notes = cursor.notes();
    let shape = notes.part(|| read(&object));
    let texture = notes.part(|| maps::texture(&object));
    let maps = notes.part(|| maps::maps(&object));
    let texture = texture?;
    let cutout = maps::cutout(&object, texture.as_ref())?;
    Ok(Shape { hidden, material: Some(material?), texture, maps: maps?, cutout, ..shape? })
}

/// Reads the `shape` of an area light. It has the light's own colour, so its material and texture
/// are ignored.
pub(super) fn light_shape(cursor: &Cursor<'_>) -> Result<Shape> {
    let object = open(cursor, Owner::Light)?;
    let shape = read(&object)?;
    if let Geometry::Triangle(triangle) = &shape.geometry
        && !triangle_has_area(&triangle.points)
        && let Some(points) = object.get("points")
    {
        return Err(points.error("a light must have an area").remedy("move the corners apart"));
    }
    Ok(shape)
}

/// The shape as an object with exactly the keys of its kind.
fn open<'a>(cursor: &Cursor<'a>, owner: Owner) -> Result<Object<'a>> {
    let own = match cursor.kind("a shape")? {
        ShapeKind::Sphere => &SPHERE,
        ShapeKind::Plane => &PLANE,
        ShapeKind::Triangle => &TRIANGLE,
        ShapeKind::Trimesh => mesh::own_keys(cursor)?,
    };
    cursor.object(kind(own, owner))
}

/// Reads a shape without material and texture.
fn read(object: &Object<'_>) -> Result<Shape> {
    let kind = object.word("type");
    let transform = object.get("transform").map(|c| transform::transform(&c)).transpose()?;
    let (geometry, facing) = match kind {
        ShapeKind::Sphere => (sphere(object, transform)?, None),
        ShapeKind::Plane => quad(object)?,
        ShapeKind::Triangle => triangle(object)?,
        ShapeKind::Trimesh => (mesh::mesh(object)?, None),
    };
    // A mesh without a statement about its fronts has two.
    let has_fronts = kind != ShapeKind::Trimesh || object.has("normal");
    let default_sides =
        if kind == ShapeKind::Sphere || !has_fronts { Sides::Both } else { Sides::Front };
    let (vertex_colors, materials) = match geometry {
        Geometry::MeshFile(_) => (object.word("vertexcolors"), object.word("materials")),
        _ => Default::default(),
    };
    Ok(Shape {
        path: object.cursor().path(),
        name: name(object)?,
        facing,
        geometry,
        transform: transform.map(Transform),
        sides: object.word_or("sides", default_sides),
        shading: object.word("shading"),
        vertex_colors,
        materials,
        hidden: false,
        material: None,
        texture: None,
        cutout: None,
        maps: Maps::default(),
    })
}

pub(super) fn name(object: &Object<'_>) -> Result<Option<Name>> {
    let Some(cursor) = object.one_of(&["name", "id"])? else { return Ok(None) };
    Ok(Some(Name(cursor.text("a string that is not empty")?.to_owned())))
}

fn sphere(object: &Object<'_>, transform: Option<glam::DAffine3>) -> Result<Geometry> {
    if let Some(cursor) = object.get("transform")
        && transform.is_some_and(|t| !transform::is_uniform(&t))
    {
        return Err(uneven(&cursor));
    }
    let center = object.point("center");
    Ok(Geometry::Sphere(Sphere { center, radius: object.number("radius") }))
}

/// The error that the transform at `cursor` would make a sphere an ellipsoid.
pub(super) fn uneven(cursor: &Cursor<'_>) -> Error {
    let error = cursor.error("a sphere can only be scaled uniformly");
    error.remedy("use one scale factor, or a trimesh")
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
        return Err(cursor.error("must not be zero").remedy("use a vector such as [0, 1, 0]"));
    };
    // A shape without area has no sides to distinguish.
    if direction(front).is_some_and(|front| unit.dot(front).abs() < IN_PLANE) {
        let error = cursor.error("lies in the plane of the surface");
        return Err(error.remedy("use a vector that points away from the surface"));
    }
    Ok(())
}
