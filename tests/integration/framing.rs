//! Files without a scene: framed from every side, gone around, looked at closer, and written down.

use std::path::Path;

use wavecrest_core::film::Film;
use wavecrest_image::read::read;

use crate::support::{folder, repository, wavecrest};

/// A low block that is longer than wide, with a small one on its top, and a point far away that no face has.
const BLOCK: &str = "\
v -1 0 -2\nv 1 0 -2\nv 1 1 -2\nv -1 1 -2\nv -1 0 2\nv 1 0 2\nv 1 1 2\nv -1 1 2\n\
v -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0.5 2 -0.5\nv -0.5 2 -0.5\n\
v -0.5 1 0.5\nv 0.5 1 0.5\nv 0.5 2 0.5\nv -0.5 2 0.5\nv 9 9 9\n\
f 4 3 2 1\nf 5 6 7 8\nf 1 5 8 4\nf 2 3 7 6\nf 4 8 7 3\nf 1 2 6 5\n\
f 12 11 10 9\nf 13 14 15 16\nf 9 13 16 12\nf 10 11 15 14\nf 12 16 15 11\n";

fn run(folder: &Path, arguments: &[&str]) -> String {
    let found = wavecrest(folder).args(arguments).output().expect("it runs");
    let text = String::from_utf8(found.stderr).expect("text");
    assert_eq!(found.status.code(), Some(0), "{arguments:?}: {text}");
    text
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let found = wavecrest(folder).args(arguments).output().expect("it runs");
    assert_eq!(found.status.code(), Some(2), "{arguments:?}");
    String::from_utf8(found.stderr).expect("text")
}

fn film(folder: &Path, name: &str) -> Film {
    read(&folder.join(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn with_block() -> tempfile::TempDir {
    let folder = folder();
    std::fs::write(folder.path().join("block.obj"), BLOCK).expect("a file");
    folder
}

/// The free part of the image on the left, right, top and bottom of what is not nothing, in shares of its sides.
fn margins(film: &Film) -> [f64; 4] {
    let nothing = film.pixel(0, 0).expect("a pixel");
    let (width, height) = (film.width(), film.height());
    let seen = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let seen: Vec<(u32, u32)> =
        seen.filter(|&(x, y)| film.pixel(x, y).expect("a pixel") != nothing).collect();
    let side = |of: &dyn Fn(&(u32, u32)) -> u32| seen.iter().map(of).min().expect("it is seen");
    let [left, right] = [side(&|p| p.0), side(&|p| width - 1 - p.0)].map(f64::from);
    let [top, bottom] = [side(&|p| p.1), side(&|p| height - 1 - p.1)].map(f64::from);
    let (width, height) = (f64::from(width), f64::from(height));
    [left / width, right / width, top / height, bottom / height]
}

/// Ids show where there is something, whatever light there is.
#[test]
fn what_is_seen_fills_the_image_from_every_side_and_at_every_aspect() {
    let folder = with_block();
    for size in [["60", "60"], ["160", "40"], ["40", "160"]] {
        for side in ["front", "back", "left", "right", "top", "bottom", "iso", "-130,-20"] {
            for (fit, margin) in [("0.92", 0.04), ("0.5", 0.25)] {
                let [width, height] = size;
                let view = [
                    "-q",
                    "block.obj",
                    "a.pfm",
                    "--as",
                    "ids",
                    "--width",
                    width,
                    "--height",
                    height,
                ];
                run(folder.path(), &[&view[..], &["--view", side, "--fit", fit]].concat());
                let [left, right, top, bottom] = margins(&film(folder.path(), "a.pfm"));
                let pixel = |side: &str| 1.5 / side.parse::<f64>().expect("a number");
                let what = format!("{size:?} {side} {fit}: {left} {right} {top} {bottom}");
                let even = (left - right).abs() <= 2.0 * pixel(width)
                    && (top - bottom).abs() <= 2.0 * pixel(height);
                let fills =
                    (left - margin).abs() <= pixel(width) || (top - margin).abs() <= pixel(height);
                assert!(
                    even && fills && left >= margin - pixel(width) && top >= margin - pixel(height),
                    "{what}"
                );
            }
        }
    }
}

/// A square, a line and a single point: there is a view of each from every side, along its plane too.
#[test]
fn flat_objects_have_all_views() {
    let folder = folder();
    let at = folder.path();
    let flat = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 2 3 4\n";
    let line = "v 0 0 0\nv 0 1 0\nv 0 2 0\nf 1 2 3\n";
    let point = "v 1e5 2 3\nv 1e5 2 3\nv 1e5 2 3\nf 1 2 3\n";
    let size = ["-q", "--width", "40", "--height", "30"];
    for (name, text) in [("flat.obj", flat), ("line.obj", line), ("point.obj", point)] {
        std::fs::write(at.join(name), text).expect("a file");
        for side in ["front", "left", "top", "iso", "inside"] {
            let view = [&[name, "a.pfm", "--view", side], &size[..]].concat();
            run(at, &view);
            run(at, &[&[name, "a.gif", "--turntable", "3", "--view", side], &size[..]].concat());
            run(at, &[&[name, "a.pfm", "--sheet", "front,top"], &size[..]].concat());
        }
    }
    let above = ["flat.obj", "a.pfm", "--view", "top", "--as", "ids"];
    run(at, &[&above[..], &size[..]].concat());
    let [_, _, top, bottom] = margins(&film(at, "a.pfm"));
    assert!((top - 0.04).abs() <= 0.05 && (bottom - 0.04).abs() <= 0.05, "{top} {bottom}");
}

#[test]
fn a_scene_file_keeps_its_camera() {
    let folder = with_block();
    run(folder.path(), &["convert", "-q", "block.obj", "s.json"]);
    for option in [
        &["--view", "front"][..],
        &["--up", "-z"],
        &["--fov", "30"],
        &["--fit", "0.5"],
        &["--turntable", "4"],
    ] {
        let told = refused(folder.path(), &[&["s.json", "a.png"], option].concat());
        let words = "s.json: a scene file has its own camera; change";
        assert!(told.contains(words), "{told}");
    }
    let told = refused(folder.path(), &["block.obj", "a.png", "--view", "up"]);
    assert!(told.contains("front, back, left, right, top, bottom, iso or inside"), "{told}");
}

#[test]
fn a_camera_that_is_chosen_is_written_down_and_so_is_a_turn() {
    let folder = with_block();
    let at = folder.path();
    let size = ["--width", "40", "--height", "30"];
    let asked = ["--view", "70,15", "--up", "z", "--fov", "25", "--turntable", "3"];
    run(at, &[&["convert", "-q", "block.obj", "s.json"], &size[..], &asked].concat());
    run(at, &[&["-q", "block.obj", "a-#.pfm"], &size[..], &asked].concat());
    run(at, &["-q", "s.json", "b-#.pfm", "--frames", "1..3"]);
    for shard in ["1/2", "2/2"] {
        run(at, &[&["-q", "block.obj", "c-#.pfm", "--shard", shard], &size[..], &asked].concat());
    }
    let read = |name: &str| std::fs::read(at.join(name)).expect(name);
    for frame in 1..=3 {
        let first = read(&format!("a-{frame}.pfm"));
        assert_eq!(first, read(&format!("b-{frame}.pfm")), "{frame}");
        assert_eq!(first, read(&format!("c-{frame}.pfm")), "{frame}");
    }
    assert_ne!(read("a-1.pfm"), read("a-2.pfm"));
    run(at, &["-q", "s.json", "still.pfm"]);
    assert_eq!(read("still.pfm"), read("a-1.pfm"), "the camera stands where the turn begins");
}

#[test]
fn a_turn_is_one_file_that_moves_and_sides_are_one_picture() {
    let folder = with_block();
    let at = folder.path();
    let size = ["--width", "40", "--height", "30", "-q"];
    for name in ["a.gif", "a.png"] {
        run(at, &[&["block.obj", name, "--turntable", "3"], &size[..]].concat());
    }
    let bytes = |name: &str| std::fs::read(at.join(name)).expect(name);
    assert!(bytes("a.gif").starts_with(b"GIF89a"));
    assert!(bytes("a.png").windows(4).any(|chunk| chunk == b"acTL"));
    run(at, &[&["block.obj", "sheet.pfm", "--sheet", "front,30,20,top"], &size[..]].concat());
    run(at, &[&["block.obj", "top.pfm", "--view", "top"], &size[..]].concat());
    let (sheet, top) = (film(at, "sheet.pfm"), film(at, "top.pfm"));
    assert_eq!((sheet.width(), sheet.height()), (80, 84));
    for (x, y) in [(3, 3), (20, 15), (11, 7), (30, 20)] {
        let (found, expected) = (sheet.pixel(x, 42 + y), top.pixel(x, y));
        let background = top.pixel(0, 0);
        // Light stays where it is for the first side.
        assert_eq!(found == background, expected == background, "{x} {y}");
    }
    let told = refused(at, &["block.obj", "a.gif", "--turntable", "3", "--shard", "1/2"]);
    assert!(told.contains("--turntable and --shard cannot be used together"), "{told}");
    for (output, option) in
        [("a.gif", "--checkpoint"), ("a-#.png", "--checkpoint"), ("a-#.png", "--stats")]
    {
        let told = refused(at, &["block.obj", output, "--turntable", "3", option, "kept"]);
        let words = format!("--turntable and {option} cannot be used together; leave out {option}");
        assert!(told.contains(&words), "{told}");
    }
}

#[test]
fn a_part_of_a_look_is_that_part_of_the_whole() {
    let folder = folder();
    let scene = repository("scenes/lightbounce.json");
    let scene = scene.to_str().expect("a name");
    let size = ["--width", "48", "--height", "32", "-q"];
    for look in ["clay", "normals", "depth", "wireframe", "uv", "ids"] {
        let whole = [&[scene, "a.pfm", "--as", look], &size[..]].concat();
        run(folder.path(), &whole);
        run(
            folder.path(),
            &[&[scene, "b.pfm", "--as", look, "--crop", "10,6,20,16", "--threads", "1"], &size[..]]
                .concat(),
        );
        let (a, b) = (film(folder.path(), "a.pfm"), film(folder.path(), "b.pfm"));
        for (x, y) in (0..16).flat_map(|y| (0..20).map(move |x| (x, y))) {
            assert_eq!(b.pixel(x, y), a.pixel(x + 10, y + 6), "{look} {x} {y}");
        }
        let plain = [scene, "c.pfm", "--width", "48", "--height", "32", "-q"];
        run(folder.path(), &plain);
        // There is no triangle in this scene but the quad's edges, which are in view.
        assert!(!a.same_bits(&film(folder.path(), "c.pfm")), "{look} shows something else");
    }
    let told = refused(folder.path(), &[scene, "a.part", "--as", "ids", "--shard", "1/2"]);
    assert!(told.contains("--as and --shard cannot be used together, found ids"), "{told}");
}

#[test]
fn looks_show_what_they_say() {
    let folder = with_block();
    let at = folder.path();
    let look = |look: &str| {
        let size = ["--width", "80", "--height", "60", "--view", "front", "-q", "--as", look];
        run(at, &[&["block.obj", "a.pfm"], &size[..]].concat());
        film(at, "a.pfm")
    };
    // In the middle of the front, which faces the camera.
    let (x, y) = (40, 45);
    let normals = look("normals");
    assert_eq!(normals.pixel(x, y), Some([0.5, 0.5, 1.0]));
    let depth = look("depth");
    let nearest = depth.pixel(x, y).expect("a pixel");
    assert!(nearest[0] > 0.95 && nearest[1] > 0.9, "{nearest:?}");
    let wires = look("wireframe");
    let lit = ["-q", "block.obj", "a.pfm", "--lights", "headlight"];
    run(at, &[&lit[..], &["--width", "80", "--height", "60", "--view", "front"]].concat());
    let plain = film(at, "a.pfm");
    // Along the diagonal of the front, and nowhere near it.
    let red = |film: &Film, x, y| film.pixel(x, y).map(|pixel| pixel[0]).expect("a pixel");
    let is_darker = |x, y| red(&wires, x, y) < 0.9 * red(&plain, x, y);
    let rows: Vec<usize> =
        (40..50).map(|y| (20..60).filter(|&x| is_darker(x, y)).count()).collect();
    assert!(rows.iter().all(|count| (1..=8).contains(count)), "{rows:?}");
}

/// Small enough to be quick.
const SMALL: [&str; 5] = ["a.pfm", "--width", "40", "--height", "30"];

/// What is told of a file with this content.
fn told(name: &str, content: &str) -> String {
    let folder = folder();
    std::fs::write(folder.path().join(name), content).expect("a file");
    run(folder.path(), &[&[name], &SMALL[..]].concat())
}

#[test]
fn the_axis_taken_for_up_is_told_unless_it_is_requested() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let found = told("a.obj", triangle);
    assert!(found.contains("a.obj: y is up (change with --up); default camera"), "{found}");
    let folder = folder();
    std::fs::write(folder.path().join("a.obj"), triangle).expect("a file");
    let found = run(folder.path(), &[&["a.obj", "--up", "z"], &SMALL[..]].concat());
    assert!(!found.contains("is up"), "{found}");
}

#[test]
fn an_image_without_the_scene_is_told_with_the_reason() {
    let far =
        format!("{BLOCK}v 1e5 1e5 1e5\nv 1.00001e5 1e5 1e5\nv 1e5 1.00001e5 1e5\nf 18 19 20\n");
    let found = told("a.obj", &far);
    let words = "the image looks empty: triangles far from the rest make it small, found 1; remove";
    assert!(found.contains(words), "{found}");
    assert!(!told("a.obj", BLOCK).contains("empty"));
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
    write("a.mtl", "newmtl a\nd 0\n").expect("a file");
    write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n").expect("a file");
    let found = run(folder.path(), &[&["a.obj"], &SMALL[..]].concat());
    let words = "nothing is left of the mesh: all its materials are invisible; set d to 1";
    assert!(found.contains(words), "{found}");
}

#[test]
fn colours_of_faces_are_told_and_bytes_as_colours_are_scaled() {
    let ply = |properties: &str, values: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
             {properties}end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2{values}\n"
        )
    };
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let found = told("a.ply", &ply(colors, " 255 0 0"));
    assert!(found.contains("the colours of faces are ignored; export"), "{found}");
    let found = told("a.ply", &ply("property list uchar float texcoord\n", " 6 0 0 1 0 0 1"));
    assert!(found.contains("the texture coordinates of faces are ignored"), "{found}");
    assert!(!told("a.ply", &ply("", "")).contains("ignored"));
    let folder = folder();
    let image = |name: &str, most: u32| {
        let text = format!("v 0 0 0 {most} 0 0\nv 1 0 0 0 {most} 0\nv 0 1 0 0 0 {most}\nf 1 2 3\n");
        std::fs::write(folder.path().join("a.obj"), text).expect("a file");
        let told = run(folder.path(), &["a.obj", name, "--width", "40", "--height", "30"]);
        (film(folder.path(), name), told.contains("are taken as 0 to 255"))
    };
    let ((bytes, is_told), (ones, is_told_too)) = (image("a.pfm", 255), image("b.pfm", 1));
    assert!(bytes.same_bits(&ones) && is_told && !is_told_too);
}
