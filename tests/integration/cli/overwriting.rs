//! No command writes over a file that it reads.

use std::path::Path;

use serde_json::json;
use tempfile::TempDir;
use wavecrest_core::film::Film;
use wavecrest_image::write::{Transfer, write};

use super::{files, run, run_wrongly, text, with_scene};
use crate::support::{matte, pinhole, point_light, scene, wall, with};

/// An OBJ file with a material for each of two images, in the order in which `convert` numbers them the other way round.
const OBJ: &str = "mtllib s.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
    usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\n";
const MTL: &str = "newmtl a\nmap_Kd s-image1.png\nnewmtl b\nmap_Kd s-image0.png\n";

fn write_image(folder: &Path, name: &str, level: f32) {
    let film = Film::from_pixels(2, 2, vec![[level; 3]; 4]).expect("a film");
    write(&film, &folder.join(name), Transfer::Linear).expect("a file");
}

/// `ball.json` shows tex-1.png, and the camera moves; `s.obj` has its materials in `s.mtl`.
fn prepared() -> TempDir {
    let mut camera = pinhole([8, 6], 40.0, 5.0);
    camera["path"] =
        json!({"keys": [{"frame": 1, "location": [0, 0, 5]}, {"frame": 2, "location": [0, 1, 5]}]});
    let shape = with(wall(4.0, -2.0, matte(0.8, [0.2, 0.4, 0.9])), "texture", "tex-1.png");
    let light = point_light(40.0, [2.0, 3.0, 4.0], [1.0; 3]);
    let folder = with_scene(&scene(0, &camera, &[light], &[shape]).to_string());
    for (name, level) in [("tex-1.png", 0.2), ("s-image0.png", 0.4), ("s-image1.png", 0.8)] {
        write_image(folder.path(), name, level);
    }
    std::fs::write(folder.path().join("s.obj"), OBJ).expect("a file");
    std::fs::write(folder.path().join("s.mtl"), MTL).expect("a file");
    folder
}

/// All files with their content.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let read = |name: String| {
        let bytes = std::fs::read(folder.join(&name)).expect("a file");
        (name, bytes)
    };
    files(folder).into_iter().map(read).collect()
}

#[test]
fn files_of_a_scene_are_replaced_by_no_output() {
    let folder = prepared();
    let before = contents(folder.path());
    let part = |file: &str, of: &str| {
        format!("{file}: this file is also part of the scene {of}; write to another file")
    };
    let texture = part("tex-1.png", "ball.json");
    let other_name = part("./tex-1.png", "ball.json");
    let materials = part("s.mtl", "s.obj");
    let image = part("s-image0.png", "s.obj");
    let is_scene = "ball.json: this file is also the scene; write to another file".to_owned();
    let checkpoint =
        "tex-1.png: the checkpoint exists already; resume from it with --resume, or remove it";
    let checkpoint = checkpoint.to_owned();
    let cases: &[(&[&str], &String)] = &[
        (&["ball.json", "tex-1.png"], &texture),
        (&["ball.json", "x.png", "--also", "./tex-1.png"], &other_name),
        (&["ball.json", "x.png", "--stats", "tex-1.png"], &texture),
        (&["ball.json", "x.png", "--checkpoint", "tex-1.png"], &checkpoint),
        (&["ball.json", "tex-#.png", "--frames", "1..2"], &texture),
        (&["ball.json", "x-#.png", "--frames", "1..2", "--log", "ball.json"], &is_scene),
        (&["s.obj", "x.png", "--stats", "s.mtl"], &materials),
        (&["s.obj", "s-image0.png", "--turntable", "2"], &image),
        (&["s.obj", "s-image0.png", "--sheet", "front,left"], &image),
        (&["bench", "ball.json", "--page", "ball.json"], &is_scene),
        (&["bench", "ball.json", "-o", "ball.json"], &is_scene),
        (&["bench", "s.obj", "ball.json", "--page", "tex-1.png"], &texture),
    ];
    let small = ["--width", "8", "--height", "6"];
    for (arguments, message) in cases {
        run_wrongly(folder.path(), &[arguments, &["-q"][..], &small].concat(), message);
        assert_eq!(contents(folder.path()), before, "{arguments:?}");
    }
    // The picture of one material would be overwritten before it is copied for the other.
    run_wrongly(folder.path(), &["convert", "s.obj", "s.json", "--force", "-q"], &image);
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn lines_are_added_to_a_log_and_to_nothing_else() {
    let folder = prepared();
    let before = contents(folder.path());
    for (scene, log) in [("ball.json", "tex-1.png"), ("ball.json", "s.mtl"), ("s.obj", "s.mtl")] {
        let message = format!(
            "{log}: cannot add to the log: this file is not a log; \
             name a new file, or the log of an earlier render"
        );
        run_wrongly(folder.path(), &[scene, "x.png", "--log", log], &message);
        run_wrongly(folder.path(), &["s.obj", "x.gif", "--turntable", "2", "--log", log], &message);
        assert_eq!(contents(folder.path()), before);
    }
    let lines = || {
        let output = run(folder.path(), &["ball.json", "x.png", "-q", "--log", "x.log"]);
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
        std::fs::read_to_string(folder.path().join("x.log")).expect("a log").lines().count()
    };
    assert_eq!(lines() * 2, lines());
}
