//! Exit codes, messages, and what is left behind when something fails.

use serde_json::json;

use super::{ball, files, run, run_wrongly, text, with_ball, with_scene};
use crate::support::folder;

#[test]
fn a_missing_scene_is_named() {
    let folder = folder();
    let message = "no.json: cannot read the scene: there is no such file; check the path";
    run_wrongly(folder.path(), &["no.json", "out.png"], message);
    run_wrongly(folder.path(), &["check", "no.json"], message);
    run_wrongly(folder.path(), &["explain", "no.json"], message);
    assert!(files(folder.path()).is_empty());
}

#[test]
fn bad_json_is_placed() {
    let folder = with_scene("{\n  \"nbounces\": 0,\n  \"camera\" 3\n}");
    let message = "ball.json: line 3 column 12: a key without a value; \
                   write a colon and a value after it";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
    let folder = with_scene("");
    let message = "ball.json: the file is empty; write a scene in it, as SCENES.md describes, \
                   or render a .gltf, .glb, .ply, .obj or .stl file";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
    let folder = with_scene("{}{}");
    let message = "ball.json: line 1 column 3: there is more after the end of the scene; \
                   keep one scene in a file";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
}

#[test]
fn an_unknown_format_is_an_error_before_the_scene_is_read() {
    let folder = folder();
    run_wrongly(
        folder.path(),
        &["no.json", "out.pmp"],
        "out.pmp: unknown image format, found .pmp; \
         did you mean .ppm? use .ppm, .png, .exr or .pfm",
    );
    run_wrongly(
        folder.path(),
        &["no.json", "out"],
        "out: the name of an image must end in its format; use .ppm, .png, .exr or .pfm",
    );
}

#[test]
fn a_misspelt_key_is_a_warning_with_a_suggestion_and_an_error_if_strict() {
    let mut scene = ball();
    scene["scene"]["shapes"][0]["materail"] = json!({});
    let folder = with_scene(&scene.to_string());
    let said = |options: &[&str]| {
        let output = run(folder.path(), &[&["ball.json", "out.png"], options].concat());
        (output.status.code(), text(&output.stderr).to_owned())
    };
    let place = "ball.json: scene.shapes[0].materail: is not a key of a sphere, found {}";
    let warning = format!("warning: {place}; it is ignored\n");
    assert!(said(&[]).1.starts_with(&warning));
    assert_eq!(said(&["-q"]), (Some(0), warning));
    assert_eq!(said(&["--strict"]), (Some(2), format!("error: {place}; remove it\n")));
}

#[test]
fn a_required_key_that_is_misspelt_is_an_error_that_names_it() {
    let mut scene = ball();
    let sphere = scene["scene"]["shapes"][0].as_object_mut().expect("an object");
    let radius = sphere.remove("radius").expect("a radius");
    sphere.insert("raduis".to_owned(), radius);
    let folder = with_scene(&scene.to_string());
    let output = run(folder.path(), &["ball.json", "out.png"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        text(&output.stderr),
        "error: ball.json: scene.shapes[0].radius: is missing; rename \"raduis\" to \"radius\"\n"
    );
}

#[test]
fn all_errors_of_a_scene_are_listed_up_to_ten() {
    let mut scene = ball();
    scene["camera"]["fov"] = json!(500);
    scene["scene"]["lightsources"][0]["intensity"] = json!([1, 1, 1]);
    scene["scene"]["shapes"][1]["material"]["kd"] = json!("a");
    let folder = with_scene(&scene.to_string());
    let output = run(folder.path(), &["ball.json", "out.png"]);
    assert_eq!(output.status.code(), Some(2));
    let errors = [
        "camera.fov: must be a number from 0.001 to 179, found 500",
        "scene.lightsources[0].intensity: must be a number from 0 to 2^40, found [1,1,1]; \
         give one number, not a list",
        "scene.shapes[1].material.kd: must be a number from 0 to 2^40, found \"a\"",
    ];
    let lines: String = errors.map(|error| format!("error: ball.json: {error}\n")).concat();
    assert_eq!(text(&output.stderr), lines);

    scene["scene"]["shapes"] = json!(vec![json!({"type": "sphere"}); 4]);
    let folder = with_scene(&scene.to_string());
    let output = run(folder.path(), &["check", "ball.json"]);
    let lines: Vec<&str> = text(&output.stderr).lines().collect();
    assert_eq!(lines.len(), 11, "{lines:?}");
    assert_eq!(lines[10], "error: 4 more errors are not listed");
}

#[test]
fn a_word_that_is_neither_command_nor_file_is_both_in_the_message() {
    let folder = with_ball();
    run_wrongly(
        folder.path(),
        &["rendr", "ball.json", "out.png"],
        "\"rendr\" is neither a command nor a file; did you mean \"wavecrest render\"?",
    );
    run_wrongly(
        folder.path(),
        &["picture"],
        "\"picture\" is neither a command nor a file; see wavecrest --help for the commands",
    );
}

#[test]
fn unknown_formats_are_refused_with_the_supported_ones() {
    let folder = with_ball();
    for name in ["mesh.fbx", "mesh"] {
        std::fs::write(folder.path().join(name), "Kaydara FBX").expect("a file");
        let message = format!(
            "{name}: this kind of file is not read; \
             use a scene (.json), glTF (.gltf, .glb) or a mesh (.ply, .obj, .stl)"
        );
        run_wrongly(folder.path(), &[name, "out.png"], &message);
    }
}

#[test]
fn options_without_effect_on_a_scene_file_are_refused() {
    let folder = with_ball();
    run_wrongly(
        folder.path(),
        &["ball.json", "out.png", "--lights", "studio"],
        "ball.json: --lights has no effect on this file; \
         leave it out, and change \"lightsources\" in the scene",
    );
    run_wrongly(
        folder.path(),
        &["ball.json", "out.png", "--crease", "30"],
        "ball.json: --crease has no effect on this file; \
         leave it out, and set \"shading\" in the scene",
    );
}

#[test]
fn an_invalid_value_is_reported_with_its_place_and_the_remedy() {
    let mut scene = ball();
    scene["scene"]["shapes"][0]["radius"] = json!(-2);
    let folder = with_scene(&scene.to_string());
    let message = "ball.json: scene.shapes[0].radius: \
                   must be a number above 0 and at most 2^40, found -2";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
    scene["scene"]["shapes"][0] = json!({"type": "spere"});
    let folder = with_scene(&scene.to_string());
    let message = "ball.json: scene.shapes[0].type: \
                   must be \"sphere\", \"disk\", \"plane\", \"triangle\" or \"trimesh\", found \"spere\"; \
                   did you mean \"sphere\"?";
    run_wrongly(folder.path(), &["ball.json", "out.png"], message);
}

#[test]
fn an_unwritable_output_is_an_error_before_the_scene_is_read() {
    let folder = folder();
    run_wrongly(
        folder.path(),
        &["no.json", "none/out.png"],
        "none/out.png: cannot write the file: there is no folder none; \
         create it first or name one that exists",
    );
    std::fs::create_dir(folder.path().join("dir.png")).expect("a folder");
    run_wrongly(
        folder.path(),
        &["no.json", "dir.png"],
        "dir.png: cannot write the file: this is a folder; name a file inside it",
    );
    run_wrongly(
        folder.path(),
        &["no.json", "-o", "-"],
        "-: an image cannot be written to standard output; \
         name a file that ends in .ppm, .png, .exr or .pfm",
    );
}

#[test]
fn an_older_image_stays_when_the_render_fails() {
    let folder = with_ball();
    std::fs::write(folder.path().join("out.png"), "precious").expect("a file");
    let old = || std::fs::read_to_string(folder.path().join("out.png")).expect("it is there");
    run_wrongly(
        folder.path(),
        &["ball.json", "out.png", "--crop", "10,10,8,8"],
        "the crop must lie within the image, found 10,10,8,8; \
         the image is 16 x 12; give x,y,width,height",
    );
    assert_eq!(old(), "precious");
    run_wrongly(
        folder.path(),
        &["ball.json", "out.png", "--stats", "none/stats.json"],
        "none/stats.json: cannot write the file: there is no folder none; \
         create it first or name one that exists",
    );
    assert_eq!(old(), "precious");
    assert_eq!(files(folder.path()), ["ball.json", "out.png"], "nothing else is left behind");
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    let folder = with_ball();
    for (arguments, told) in [
        (&["ball.json"][..], "required arguments were not provided"),
        (&["ball.json"], "\nUsage: wavecrest [render] [OPTIONS] <SCENE> <OUTPUT>\n"),
        (&["ball.json", "a.png", "-o", "b.png"], "cannot be used with"),
        (&["ball.json", "a.png", "--crop", "1,2,3"], "write four whole numbers"),
        (&["ball.json", "a.png", "--tracer", "recursiv"], "'recursive'"),
        (&["ball.json", "a.png", "--width", "0"], "use a whole number from 1 to 65536"),
        (&["ball.json", "a.png", "--width", "-5"], "use a whole number from 1 to 65536"),
        (&["ball.json", "a.png", "--width", "30x20"], "use --width 30 --height 20"),
        (&["ball.json", "a.png", "--threads", "0"], "use a whole number from 1 to 4096"),
        (&["ball.json", "a.png", "--batch", "0"], "use a whole number from 1 to 1048576"),
        (
            &["ball.json", "a.png", "--seed", "-1"],
            "use a whole number from 0 to 18446744073709551615",
        ),
        (&["ball.json", "a.png", "--crop", "-1,0,2,2"], "write four whole numbers"),
        (
            &["ball.json", "a.png", "--kernel", "reference", "--precision", "fast"],
            "leave out --precision fast, or use --kernel single",
        ),
        (&["ball.json", "a.png", "--bvh", "quick"], "possible values: brute, on-demand"),
        (&[], "Usage: wavecrest"),
    ] {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(told), "{arguments:?}: {}", text(&output.stderr));
    }
    assert_eq!(files(folder.path()), ["ball.json"]);
}
