//! Cameras, as the schema has them.

use serde_json::{Value, json};

use super::objects::{definition_of_with, point};
use super::{about, by_type, integer, list, number, object, one_of, or, where_all, word, word_or};
use crate::components::{FovAxis, Interpolation, Sampling};
use crate::parse::{camera, light};
use crate::reader::Range;

pub(super) fn cameras() -> Value {
    let kinds = camera::KINDS.map(|(word, _)| (word, word));
    by_type("The camera and the size of the image.", &kinds)
}

const VIEW_REQUIRED: [&str; 4] = ["type", "width", "height", "fov"];

/// The keys that have several names.
fn view_names() -> Vec<Value> {
    vec![one_of(&["location", "position"]), one_of(&["look", "lookat", "lookAt"])]
}

pub(super) fn pinhole() -> Value {
    let about = "A camera that is sharp everywhere.";
    let camera = object(about, &camera::KEYS, &VIEW_REQUIRED, |key| match key {
        "path" => Some(definition_of_with("pinholePath", "How the camera moves, frame by frame.")),
        _ => camera_key(key),
    });
    where_all(camera, view_names())
}

pub(super) fn thin_lens() -> Value {
    let keys = [&camera::KEYS[..], &camera::LENS_KEYS].concat();
    let required = [&VIEW_REQUIRED[..], &["aperture", "focal"]].concat();
    let camera = object("A camera that is sharp in one plane.", &keys, &required, camera_key);
    where_all(camera, view_names())
}

fn camera_key(key: &str) -> Option<Value> {
    let side = || integer(1, camera::LONGEST_SIDE);
    let lens_side = || or(integer(1, camera::MOST_LENS_SAMPLES), camera::LENS_SAMPLES);
    Some(match key {
        "type" => about(word(&camera::KINDS), "Which kind of camera this is."),
        "width" => about(side(), "Width of the image, in pixels."),
        "height" => about(side(), "Height of the image, in pixels."),
        "fov" => about(
            number(camera::FOV),
            "Full angle of view across one side of the image, in degrees.",
        ),
        "location" => point("Where the camera is."),
        "position" => point("Another name of location."),
        "look" => point("The point in the middle of the image."),
        "lookat" | "lookAt" => point("Another name of look."),
        "up" => or(point("Up in the image."), json!([0, 1, 0])),
        "fovaxis" => about(
            word_or(&camera::FOV_AXES, FovAxis::default()),
            "The side that fov is measured across.",
        ),
        "antialias" => about(
            or(integer(1, camera::MOST_ANTIALIAS), 1),
            "Side of the grid of rays in each pixel; 1 is one ray through its centre.",
        ),
        "sampling" => about(
            word_or(&light::SAMPLINGS, Sampling::Jittered),
            "How rays are spread: over the pixel by a pinhole, over its lens by a thin lens.",
        ),
        "path" => definition_of_with("cameraPath", "How the camera moves, frame by frame."),
        "aperture" => about(number(Range::NOT_NEGATIVE), "Diameter of the lens; 0 is a pinhole."),
        "focal" => {
            about(number(Range::POSITIVE), "Distance of the plane in focus, along the view.")
        }
        "nsamplesx" => {
            about(lens_side(), "Points on the lens: angles. Times nsamplesy, rays a pixel.")
        }
        "nsamplesy" => {
            about(lens_side(), "Points on the lens: radii. Times nsamplesx, rays a pixel.")
        }
        _ => return None,
    })
}

/// How a camera moves: that of a pinhole, and that of a thin lens, whose frames have a focus too.
pub(super) fn paths() -> [(&'static str, Value); 2] {
    let pinhole = &camera::FRAME_KEYS[..camera::PINHOLE_FRAME_KEYS];
    [("pinholePath", path(pinhole)), ("cameraPath", path(&camera::FRAME_KEYS))]
}

fn path(frame_keys: &[&'static str]) -> Value {
    let required = ["keys"];
    object("How the camera moves, frame by frame.", &camera::PATH_KEYS, &required, |key| {
        Some(match key {
            "keys" => {
                about(list(1, frame(frame_keys)), "Where it is at some frames, in their order.")
            }
            "interpolation" => about(
                word_or(&camera::INTERPOLATIONS, Interpolation::default()),
                "How it moves between these frames.",
            ),
            _ => return None,
        })
    })
}

fn frame(keys: &[&'static str]) -> Value {
    let about_frame = "Where the camera is at a frame; what is absent is as the camera says.";
    object(about_frame, keys, &["frame"], |key| {
        Some(match key {
            "frame" => about(integer(0, camera::LAST_FRAME), "The frame."),
            "up" => point("Up in the image."),
            _ => return camera_key(key),
        })
    })
}
