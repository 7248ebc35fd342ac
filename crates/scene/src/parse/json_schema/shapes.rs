//! What the keys of shapes mean.

use serde_json::{Value, json};

use super::objects::{color, definition_of_with, not_both_names, point};
use super::{
    Describe, about, by_type, definition_of, integer, list, number, object, or, text, tuple,
    where_all, word, word_or,
};
use crate::components::{Encoding, Filter, Shading, Wrap};
use crate::parse::{material, mesh, shape};
use crate::reader::Range;

/// The shapes of the scene and those of lights, each kind by its name.
pub(super) fn definitions() -> impl Iterator<Item = (String, Value)> {
    shapes("", shape_key).into_iter().chain(shapes("lit-", light_shape_key))
}

/// A shape, and each kind of shape, whose names begin with `prefix`.
fn shapes(prefix: &str, common: Describe) -> Vec<(String, Value)> {
    // The shape of a light needs no material, and is always seen.
    let (always, more): (&[_], &[_]) = if prefix.is_empty() {
        (&["type", "material"], &shape::SCENE_KEYS)
    } else {
        (&["type"], &[])
    };
    let kind = |about: &str, keys: &[&'static str], own: Describe, required: &[&str]| {
        let keys = [&shape::COMMON_KEYS[..], more, keys].concat();
        let describe = |key: &str| own(key).or_else(|| common(key));
        let required = [always, required].concat();
        where_all(object(about, &keys, &required, describe), vec![not_both_names()])
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
        "encoding" => about(
            word_or(&material::ENCODINGS, Encoding::default()),
            "What the numbers of the texture stand for.",
        ),
        "tint" => or(color("What the colours of the texture are multiplied by."), json!([1, 1, 1])),
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
