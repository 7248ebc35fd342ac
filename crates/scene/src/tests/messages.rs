//! The exact words of each error and warning of a scene's values.

use serde_json::{Value, json};

use super::{complete, error, load, refused, set, strictly, warned, warnings, with, without};

#[test]
fn top_level() {
    let text = |scene: &Value| error(scene).to_string();
    assert_eq!(text(&json!([1, 2])), "s.json: must be a scene, an object { ... }, found [1,2]");
    let missing = [
        "s.json: nbounces: is missing; give an integer from 0 to 10000",
        "s.json: camera: is missing; give an object { ... }",
        "s.json: scene: is missing; give an object { ... }",
    ];
    assert_eq!(text(&json!({})), missing.join("\n"));
    refused("nbounces", json!(-1), "nbounces: must be an integer from 0 to 10000, found -1");
    refused("nbounces", json!(2.5), "nbounces: must be an integer from 0 to 10000, found 2.5");
    refused("nbounces", json!("3"), "nbounces: must be an integer from 0 to 10000, found \"3\"");
    refused("scene", json!([]), "scene: must be the scene, an object { ... }, found []");
    refused("scene.shapes", json!({}), "scene.shapes: must be an array of shapes, found {}");
    refused(
        "scene.lightsources",
        json!(null),
        "scene.lightsources: must be an array of lights, found null",
    );
    refused(
        "scene.backgroundcolor",
        json!([0, -0.5, 0]),
        "scene.backgroundcolor[1]: must be a number from 0 to 2^40, found -0.5",
    );
    refused(
        "scene.backgroundcolor",
        json!([0, 0]),
        "scene.backgroundcolor: must be three numbers [r, g, b], found [0,0]",
    );
    refused("scene.ambient", json!(-1), "scene.ambient: must be a number from 0 to 2^40, found -1");
    refused(
        "scene.instances",
        json!({}),
        "scene.instances: must be an array of instances, found {}",
    );
}

#[test]
fn keys() {
    warned(
        "camera.widht",
        json!(3),
        "camera.widht: is not a key of a thin-lens camera, found 3; it is ignored",
    );
    warned(
        "extra",
        json!({"a": 1}),
        "extra: is not a key of a scene, found {\"a\":1}; it is ignored",
    );
    warned(
        "scene.shapes[1].radius",
        json!(3),
        "scene.shapes[1].radius: is not a key of a plane, found 3; it is ignored",
    );
    warned(
        "scene.shapes[5].uvs",
        json!([]),
        "scene.shapes[5].uvs: is not a key of a trimesh from a file, found []; it is ignored",
    );
    let misspelt = set(without("camera.antialias"), "camera.antialais", json!(2));
    let found = "camera.antialais: is not a key of a thin-lens camera, found 2";
    let meant = "did you mean \"antialias\"?";
    assert_eq!(warnings(&misspelt), [format!("{found}; it is ignored; {meant}")]);
    let error = strictly(&misspelt).err().unwrap().to_string();
    assert_eq!(error, format!("s.json: {found}; remove it; {meant}"));
    let error = strictly(&with("extra", json!(1))).err().unwrap().to_string();
    assert_eq!(error, "s.json: extra: is not a key of a scene, found 1; remove it");
}

#[test]
fn missing_keys() {
    let missing = |scene: &Value| error(scene).to_string();
    assert_eq!(
        missing(&without("camera.width")),
        "s.json: camera.width: is missing; give an integer from 1 to 65536"
    );
    assert_eq!(
        missing(&set(without("camera.width"), "camera.Widht", json!(640))),
        "s.json: camera.width: is missing; rename \"Widht\" to \"width\""
    );
    assert_eq!(
        missing(&set(without("camera.location"), "camera.positon", json!([0, 0, 5]))),
        "s.json: camera.location: is missing; rename \"positon\" to \"location\""
    );
    // "ks" is near, but it is a key in its own right.
    assert_eq!(
        missing(&without("scene.shapes[0].material.kd")),
        "s.json: scene.shapes[0].material.kd: is missing; give a number from 0 to 2^40"
    );
    assert_eq!(
        missing(&without("scene.shapes[0].type")),
        "s.json: scene.shapes[0].type: is missing; \
         give \"sphere\", \"disk\", \"plane\", \"triangle\" or \"trimesh\""
    );
    assert_eq!(
        missing(&without("scene.shapes[4].points").clone()),
        "s.json: scene.shapes[4].points: is missing; give an array of at least three points \
         [[x, y, z], ...], or the path of a mesh as \"file\""
    );
}

#[test]
fn camera_words() {
    let kinds = "camera.type: must be \"pinhole\" or \"thinlens\"";
    refused(
        "camera.type",
        json!("Pinhole"),
        &format!("{kinds}, found \"Pinhole\"; did you mean \"pinhole\"?"),
    );
    refused("camera.type", json!("orthographic"), &format!("{kinds}, found \"orthographic\""));
    refused("camera.type", json!(3), &format!("{kinds}, found 3"));
    refused("camera", json!([]), "camera: must be the camera, an object { ... }, found []");
    refused(
        "camera.fovaxis",
        json!("lager"),
        "camera.fovaxis: must be \"x\", \"y\", \"smaller\" or \"larger\", found \"lager\"; \
         did you mean \"larger\"?",
    );
    refused(
        "camera.sampling",
        json!("jitered"),
        "camera.sampling: must be \"random\", \"jittered\" or \"sobol\", found \"jitered\"; \
         did you mean \"jittered\"?",
    );
}

#[test]
fn camera_place() {
    refused(
        "camera.look",
        json!([0, 0, 5]),
        "camera.look: the camera looks at its own location, found [0,0,5]; \
         move \"look\" away from \"location\"",
    );
    refused(
        "camera.position",
        json!([0, 0, 5]),
        "camera.position: means the same as \"location\", which is also given, found [0,0,5]; \
         keep \"location\" or \"position\", not both",
    );
    refused(
        "camera.lookat",
        json!([0, 0, 1]),
        "camera.lookat: means the same as \"look\", which is also given, found [0,0,1]; \
         keep \"look\" or \"lookat\", not both",
    );
    refused(
        "camera.location",
        json!([0, 2e12, 5]),
        "camera.location[1]: must be a number from -2^40 to 2^40, \
         found 2000000000000.0",
    );
    refused(
        "camera.location",
        json!([0, "1", 5]),
        "camera.location[1]: must be a number from -2^40 to 2^40, found \"1\"; remove the quotes",
    );
    refused(
        "camera.look",
        json!("0 0 0"),
        "camera.look: must be three numbers [x, y, z], found \"0 0 0\"",
    );
    refused(
        "camera.up",
        json!([0, 0, 0]),
        "camera.up: must not be zero, found [0,0,0]; use a vector such as [0, 1, 0]",
    );
    warned(
        "camera.up",
        json!([0, 0, -2]),
        "camera.up: is parallel to the view direction, \
         found [0, 0, -2]; [1, 0, 0] is used instead",
    );
}

#[test]
fn lights() {
    let first = "scene.lightsources[0]";
    let second = "scene.lightsources[1]";
    refused(first, json!(1), &format!("{first}: must be a light, an object {{ ... }}, found 1"));
    refused(
        &format!("{first}.type"),
        json!("pointligth"),
        &format!(
            "{first}.type: must be \"pointlight\", \"spotlight\", \"directionallight\" or \"arealight\", found \"pointligth\"; \
             did you mean \"pointlight\"?"
        ),
    );
    refused(
        &format!("{first}.intensity"),
        json!(-1),
        &format!("{first}.intensity: must be a number from 0 to 2^40, found -1"),
    );
    refused(
        &format!("{first}.falloff"),
        json!("square"),
        &format!(
            "{first}.falloff: must be \"linear\", \"inverse-square\" or \"none\", found \"square\""
        ),
    );
    refused(
        &format!("{second}.sampling"),
        json!("halton"),
        &format!(
            "{second}.sampling: must be \"random\", \"jittered\" or \"sobol\", found \"halton\""
        ),
    );
    refused(
        &format!("{second}.samples"),
        json!(0),
        &format!("{second}.samples: must be an integer from 1 to 65536, found 0"),
    );
}

#[test]
fn light_shapes_without_area() {
    let path = "scene.lightsources[1].shape";
    refused(
        path,
        json!({"type": "triangle", "points": [[0, 0, 0], [1, 1, 1], [2, 2, 2]]}),
        &format!(
            "{path}.points: a light must have an area, found [[0,0,0],[1,1,1],[2,2,2]]; \
             move the corners apart"
        ),
    );
    refused(
        path,
        json!({"type": "trimesh", "points": [[0, 0, 0], [1, 1, 1], [2, 2, 2]]}),
        &format!("{path}: a light must have an area"),
    );
    refused(
        path,
        json!({"type": "plane", "points": [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]}),
        &format!(
            "{path}.points: the plane has no area, found [[0,0,0],[1,0,0],[2,0,0],[3,0,0]]; \
             order them bottom left, top left, top right, bottom right"
        ),
    );
}

#[test]
fn materials() {
    let path = "scene.shapes[0].material";
    refused(
        path,
        json!("red"),
        &format!("{path}: must be a material, an object {{ ... }}, found \"red\""),
    );
    refused(
        &format!("{path}.specularexponent"),
        json!(1e7),
        &format!("{path}.specularexponent: must be a number from 0 to 1000000, found 10000000.0"),
    );
    refused(
        &format!("{path}.kr"),
        json!(-0.1),
        &format!("{path}.kr: must be a number from 0 to 2^40, found -0.1"),
    );
    let above = "is above 1, so the surface reflects more light than it receives";
    for key in ["ks", "kd", "kr"] {
        let path = format!("{path}.{key}");
        warned(&path, json!(1.5), &format!("{path}: {above}, found 1.5; use 0 to 1"));
    }
    let path = format!("{path}.diffusecolor");
    warned(&path, json!([2, 0, 0]), &format!("{path}: {above}, found [2,0,0]; use 0 to 1"));
}

#[test]
fn textures() {
    let path = "scene.shapes[0].texture";
    refused(path, json!(""), &format!("{path}: must be the path of an image, found \"\""));
    refused(
        path,
        json!("no/such.png"),
        &format!(
            "{path}: there is no file at no/such.png, found \"no/such.png\"; \
             relative paths start at the scene file's folder"
        ),
    );
    refused(
        path,
        json!("src"),
        &format!(
            "{path}: there is a folder, not a file, at src, found \"src\"; \
             relative paths start at the scene file's folder"
        ),
    );
    refused(
        "scene.shapes[0].filter",
        json!("bicubic"),
        "scene.shapes[0].filter: must be \"nearest\", \"bilinear\" or \"trilinear\", found \"bicubic\"",
    );
    refused(
        "scene.shapes[0].wrap",
        json!("fold"),
        "scene.shapes[0].wrap: must be \"repeat\", \"clamp\" or \"mirror\", found \"fold\"",
    );
    warned(
        "scene.shapes[1].filter",
        json!("nearest"),
        "scene.shapes[1].filter: has no effect without a texture, found \"nearest\"; \
         add \"texture\", or remove it",
    );
    refused(
        "scene.shapes[4].texture",
        json!("Cargo.toml"),
        "scene.shapes[4].texture: the mesh has no texture coordinates; \
         add \"uvs\", or remove the texture",
    );
}

#[test]
fn names() {
    refused(
        "scene.shapes[0].name",
        json!(""),
        "scene.shapes[0].name: must be a string that is not empty, found \"\"",
    );
    refused(
        "scene.shapes[0].id",
        json!("b"),
        "scene.shapes[0].id: means the same as \"name\", which is also given, found \"b\"; \
         keep \"name\" or \"id\", not both",
    );
    warned(
        "scene.shapes[2].id",
        json!("ball"),
        "scene.shapes[2]: scene.shapes[0] has the same name, \"ball\"; \
         use a different name for each shape",
    );
}

#[test]
fn long_values_are_cut() {
    let long: Vec<u32> = (0..100_000).collect();
    let text = error(&with("camera.width", json!(long))).to_string();
    assert_eq!(
        text,
        "s.json: camera.width: must be an integer from 1 to 65536, found \
         [0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28..."
    );
    assert!(load(&complete()).is_ok());
}
