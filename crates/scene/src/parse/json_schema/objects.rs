//! What the keys of each object of the format mean.

use serde_json::{Value, json};

use super::{
    about, by_type, cameras, definition_of, integer, list, number, object, or, shapes, text, tuple,
    where_all, word, word_or,
};
use crate::components::{Encoding, Falloff};
use crate::parse::{AMBIENT, KEYS, MOST_BOUNCES, SCENE_KEYS, instance, light, material, transform};
use crate::reader::Range;

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
    let paths = cameras::paths().map(|(name, value)| (name.to_owned(), value));
    parts.chain(paths).chain(shapes::definitions()).collect()
}

pub(super) fn definition_of_with(name: &str, text: &str) -> Value {
    about(definition_of(name), text)
}

pub(super) fn point(text: &str) -> Value {
    definition_of_with("point", text)
}

pub(super) fn color(text: &str) -> Value {
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
    let instance = object("A shape shown once more.", &instance::KEYS, &["shape"], |key| {
        Some(match key {
            "shape" => about(text(), "The name of the shape."),
            "transform" => definition_of_with(
                "transform",
                "Where it is, from where the shape stands in the scene.",
            ),
            "material" => definition_of_with("material", "In place of the shape's own."),
            "name" => about(text(), "A name, for messages."),
            "id" => about(text(), "Another name of name."),
            _ => return None,
        })
    });
    where_all(instance, vec![not_both_names()])
}

/// That a thing is not named twice.
pub(super) fn not_both_names() -> Value {
    json!({"not": {"required": ["name", "id"]}})
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
