//! What the keys of each object of the format mean.

use serde_json::{Value, json};

use super::{
    Describe, about, by_type, cameras, definition_of, integer, list, number, object, or, text,
    tuple, where_all, word, word_or,
};
use crate::scene::components::{Encoding, Falloff, Filter, Shading, Wrap};
use crate::scene::parse::{
    AMBIENT, KEYS, MOST_BOUNCES, SCENE_KEYS, light, material, mesh, shape, transform,
};
use crate::scene::reader::Range;

/// The whole file.
pub(super) fn scene_file() -> Value {
    let required = ["nbounces", "camera", "scene"];
    object("A scene: camera, lights and shapes.", &KEYS, &required, |key| {
        Some(match key {
            "$schema" => about(text(), "The address of this schema, for editors."),
            "nbounces" => {
                about(integer(0, MOST_BOUNCES), "Most mirror bounces after the camera ray.")
            }
            "camera" => definition_of_with("camera", "Where the picture is taken from."),
            "scene" => definition_of_with("scene", "What is in the picture."),
            "transfer" => {
                let names = word_or(&material::ENCODINGS, Encoding::default());
                about(names, "How images of 8 bits are written, where nobody says.")
            }
            _ => return None,
        })
    })
}

/// The definitions, by name.
pub(super) fn definitions() -> Vec<(String, Value)> {
    let parts = [
        ("number", number(Range::COORDINATE)),
        ("point", about(tuple(3, definition_of("number")), "A point or a direction, [x, y, z].")),
        ("color", about(tuple(3, number(Range::NOT_NEGATIVE)), "A linear colour, [r, g, b].")),
        ("scene", scene()),
        ("instance", instance()),
        ("camera", cameras::cameras()),
        ("cameraPath", cameras::camera_path()),
        ("pinhole", cameras::pinhole()),
        ("thinlens", cameras::thin_lens()),
        ("light", by_type("A light.", &[("pointlight", "pointlight"), ("arealight", "arealight")])),
        ("pointlight", point_light()),
        ("arealight", area_light()),
        ("material", materials()),
        ("transform", transforms()),
        ("transformParts", transform_parts()),
        ("matrix", matrix()),
    ];
    let parts = parts.into_iter().map(|(name, value)| (name.to_owned(), value));
    parts.chain(shapes("", shape_key)).chain(shapes("lit-", light_shape_key)).collect()
}

fn definition_of_with(name: &str, text: &str) -> Value {
    about(definition_of(name), text)
}

pub(super) fn point(text: &str) -> Value {
    definition_of_with("point", text)
}

fn color(text: &str) -> Value {
    definition_of_with("color", text)
}

fn scene() -> Value {
    object("What is in the picture.", &SCENE_KEYS, &["backgroundcolor"], |key| {
        Some(match key {
            "backgroundcolor" => color("What a camera ray that hits nothing shows."),
            "lightsources" => about(list(0, definition_of("light")), "The lights."),
            "shapes" => about(list(0, definition_of("shape")), "The shapes."),
            "ambient" => about(
                or(number(Range::NOT_NEGATIVE), AMBIENT),
                "Share of the diffuse colour that each light adds everywhere, visible or not.",
            ),
            "instances" => {
                about(list(0, definition_of("instance")), "Shapes shown once more, elsewhere.")
            }
            _ => return None,
        })
    })
}

fn instance() -> Value {
    let keys = ["shape", "transform", "material", "name"];
    object("A shape shown once more.", &keys, &["shape", "transform"], |key| {
        Some(match key {
            "shape" => about(text(), "The name of the shape."),
            "transform" => {
                definition_of_with("transform", "From the shape's own space to the world's.")
            }
            "material" => definition_of_with("material", "In place of the shape's own."),
            "name" => about(text(), "A name for messages."),
            _ => return None,
        })
    })
}

fn point_light() -> Value {
    let required = ["type", "intensity", "position", "color"];
    object("A light at a point.", &light::COMMON_KEYS, &required, light_key)
}

fn area_light() -> Value {
    let keys = [&light::COMMON_KEYS[..], &light::AREA_KEYS].concat();
    let required = ["type", "intensity", "color", "sampling", "samples", "shape"];
    object("A light with a shape, which is seen in its own colour.", &keys, &required, light_key)
}

fn light_key(key: &str) -> Option<Value> {
    Some(match key {
        "type" => about(word(&light::KINDS), "Which kind of light this is."),
        "intensity" => about(
            number(Range::NOT_NEGATIVE),
            "Strength; with the usual falloff 40 to 100 suits distances of 10 to 20.",
        ),
        "position" => point("Where a point light is. An area light is where its shape is."),
        "color" => color("The colour of the light."),
        "falloff" => about(
            word_or(&light::FALLOFFS, Falloff::default()),
            "At distance d: 1/(4 pi d), 1/(4 pi d^2), or 1.",
        ),
        "sampling" => about(
            word(&light::SAMPLINGS),
            "How points are chosen: at random, one in each cell of a grid, or by a Sobol sequence.",
        ),
        "samples" => about(
            integer(1, light::MOST_SAMPLES),
            "Points on the light; with jittered sampling, along each side of the grid.",
        ),
        "shape" => definition_of_with("lit-shape", "What shines; it needs no material."),
        _ => return None,
    })
}

fn materials() -> Value {
    let required = ["ks", "kd", "specularexponent", "diffusecolor"];
    object("What a shape is made of, after Blinn and Phong.", &material::KEYS, &required, |key| {
        let weight = || number(Range::NOT_NEGATIVE);
        Some(match key {
            "ks" => about(weight(), "Weight of the highlight, 0 to 1."),
            "kd" => about(weight(), "Weight of the diffuse part, 0 to 1."),
            "specularexponent" => about(number(material::EXPONENT), "Sharpness of the highlight."),
            "diffusecolor" => color("Colour of the diffuse part, where no texture replaces it."),
            "kr" => about(or(weight(), 0), "Weight of the mirror ray, 0 to 1."),
            _ => return None,
        })
    })
}

fn transforms() -> Value {
    json!({
        "description": "From a shape's own space to the world's.",
        "if": {"type": "array"}, "then": definition_of("matrix"), "else": definition_of("transformParts")
    })
}

fn transform_parts() -> Value {
    object("First scaled, then turned, then moved.", &transform::PARTS, &[], |key| {
        let one_or_three = || json!({"anyOf": [definition_of("number"), definition_of("point")]});
        Some(match key {
            "translate" => or(point("How far it is moved."), json!([0, 0, 0])),
            "rotate" => or(point("Degrees about x, then y, then z."), json!([0, 0, 0])),
            "scale" => about(or(one_or_three(), 1), "One factor, or one along each axis."),
            _ => return None,
        })
    })
}

fn matrix() -> Value {
    let row = || tuple(4, definition_of("number"));
    json!({
        "description": "Four rows; it acts on columns, so that the last column is the translation.",
        "type": "array", "prefixItems": [row(), row(), row(), {"const": [0, 0, 0, 1]}],
        "minItems": 4, "maxItems": 4
    })
}

/// A shape, and each kind of shape, whose names begin with `prefix`.
fn shapes(prefix: &str, common: Describe) -> Vec<(String, Value)> {
    // The shape of a light needs no material.
    let always = if prefix.is_empty() { &["type", "material"][..] } else { &["type"] };
    let kind = |about: &str, keys: &[&'static str], own: Describe, required: &[&str]| {
        let keys = [&shape::COMMON_KEYS[..], keys].concat();
        let describe = |key: &str| own(key).or_else(|| common(key));
        let not_both = json!({"not": {"required": ["name", "id"]}});
        let required = [always, required].concat();
        where_all(object(about, &keys, &required, describe), vec![not_both])
    };
    let (sphere, flat) = (&shape::SPHERE_KEYS, &shape::FLAT_KEYS);
    let (indexed, strip) = (&mesh::INDEXED_KEYS, &mesh::STRIP_KEYS);
    let name = |name: &str| format!("{prefix}{name}");
    vec![
        (name("shape"), any_shape(&name)),
        (name("sphere"), kind("A sphere.", sphere, sphere_key, &["center", "radius"])),
        (name("plane"), kind("A plane quad.", flat, plane_key, &["points"])),
        (name("triangle"), kind("A triangle.", flat, triangle_key, &["points"])),
        (name("trimesh"), any_mesh(&name)),
        (name("meshFile"), kind("A mesh from a file.", &mesh::FILE_KEYS, mesh_key, &["file"])),
        (name("meshIndexed"), kind("A mesh.", indexed, mesh_key, &["points", "indices"])),
        (name("meshStrip"), kind("A strip of triangles.", strip, mesh_key, &["points"])),
    ]
}

fn any_shape(name: &impl Fn(&str) -> String) -> Value {
    let kinds = shape::KINDS.map(|(word, _)| (word, name(word)));
    let kinds: Vec<_> = kinds.iter().map(|(word, name)| (*word, name.as_str())).collect();
    by_type("A shape.", &kinds)
}

/// Which kind of mesh it is follows from the keys that are there.
fn any_mesh(name: &impl Fn(&str) -> String) -> Value {
    let to = |kind: &str| definition_of(&name(kind));
    json!({
        "description": "A mesh of triangles: from a file, with indices, or a strip.",
        "if": {"required": ["file"]}, "then": to("meshFile"),
        "else": {"if": {"required": ["indices"]}, "then": to("meshIndexed"), "else": to("meshStrip")}
    })
}

/// The keys of a light's shape, whose looks are not asked for.
fn light_shape_key(key: &str) -> Option<Value> {
    match key {
        "material" | "texture" | "filter" | "wrap" | "encoding" | "tint" => {
            Some(json!({"description": "Not looked at: the light has a colour of its own."}))
        }
        _ => shape_key(key),
    }
}

/// The keys of all shapes.
fn shape_key(key: &str) -> Option<Value> {
    Some(match key {
        "type" => about(word(&shape::KINDS), "Which kind of shape this is."),
        "name" => about(text(), "A name, for messages and for instances."),
        "id" => about(text(), "Another name of name."),
        "hidden" => {
            about(or(json!({"type": "boolean"}), false), "Whether its instances alone are seen.")
        }
        "material" => definition_of_with("material", "What it is made of."),
        "texture" => about(
            text(),
            "An image in place of the diffuse colour: a path from the scene's folder.",
        ),
        "filter" => about(
            word_or(&material::FILTERS, Filter::default()),
            "What a look-up between texels shows.",
        ),
        "wrap" => about(
            word_or(&material::WRAPS, Wrap::default()),
            "How coordinates outside 0 to 1 are taken.",
        ),
        "encoding" => {
            let names = word_or(&material::ENCODINGS, Encoding::default());
            about(names, "What the texture's numbers stand for.")
        }
        "tint" => definition_of_with("color", "What the texture is multiplied by."),
        "transform" => definition_of_with("transform", "From its own space to the world's."),
        "sides" => about(
            word(&shape::SIDES),
            "Which sides lights reach; absent, both of spheres and meshes from files, and the \
             front of others.",
        ),
        "shading" => about(
            word_or(&shape::SHADINGS, Shading::Flat),
            "Whether a mesh is lit with its triangles' normals or with its own.",
        ),
        _ => return None,
    })
}

fn sphere_key(key: &str) -> Option<Value> {
    Some(match key {
        "center" => point("The centre."),
        "radius" => about(number(Range::POSITIVE), "The radius."),
        _ => return None,
    })
}

fn plane_key(key: &str) -> Option<Value> {
    Some(match key {
        "points" => about(
            tuple(4, definition_of("point")),
            "Bottom left, top left, top right, bottom right, as seen from the front.",
        ),
        _ => return flat_key(key),
    })
}

fn triangle_key(key: &str) -> Option<Value> {
    Some(match key {
        "points" => about(
            tuple(3, definition_of("point")),
            "The corners, clockwise as seen from the front.",
        ),
        _ => return flat_key(key),
    })
}

fn flat_key(key: &str) -> Option<Value> {
    let side = json!({"if": {"type": "array"}, "then": definition_of("point"),
                      "else": {"enum": [1, -1]}});
    (key == "normal").then(|| about(side, "-1 turns the front away; a vector points to it."))
}

fn mesh_key(key: &str) -> Option<Value> {
    let points = || list(3, definition_of("point"));
    Some(match key {
        "points" => about(points(), "The points of the mesh."),
        "size" => about(integer(0, u32::MAX), "The number of points, if it is to be checked."),
        "normal" => about(
            list(1, json!({"enum": [0, -1]})),
            "For each triangle of a strip 0, which keeps its winding, or -1, which turns it.",
        ),
        "indices" => about(
            list(1, tuple(3, integer(0, u32::MAX))),
            "Triangles, by the numbers of their points from 0, clockwise as seen from the front.",
        ),
        "uvs" => about(
            list(3, tuple(2, definition_of("number"))),
            "Texture coordinates, for each point.",
        ),
        "normals" => about(points(), "Normals for smooth shading, for each point."),
        "file" => about(text(), "A mesh file: a path from the scene's folder."),
        _ => return None,
    })
}
