//! Files without a scene: framed from every side, gone around, looked at closer, and written down.

use wavecrest_core::film::Film;

use crate::support::{bytes, film, folder, json_in, places, put, repository, run_well};

/// A low block that is longer than wide, with a small one on its top, and a point far away that no face has.
const BLOCK: &str = "\
v -1 0 -2\nv 1 0 -2\nv 1 1 -2\nv -1 1 -2\nv -1 0 2\nv 1 0 2\nv 1 1 2\nv -1 1 2\n\
v -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0.5 2 -0.5\nv -0.5 2 -0.5\n\
v -0.5 1 0.5\nv 0.5 1 0.5\nv 0.5 2 0.5\nv -0.5 2 0.5\nv 9 9 9\n\
f 4 3 2 1\nf 5 6 7 8\nf 1 5 8 4\nf 2 3 7 6\nf 4 8 7 3\nf 1 2 6 5\n\
f 12 11 10 9\nf 13 14 15 16\nf 9 13 16 12\nf 10 11 15 14\nf 12 16 15 11\n";

fn with_block() -> tempfile::TempDir {
    let folder = folder();
    put(folder.path(), "block.obj", BLOCK);
    folder
}

/// The free part of the image on the left, right, top and bottom of what is not nothing, in shares of its sides.
fn margins(film: &Film) -> [f64; 4] {
    let nothing = film.pixel(0, 0).expect("a pixel");
    let (width, height) = (film.width(), film.height());
    let seen = places(width, height);
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
                let size = ["--width", width, "--height", height];
                let view =
                    ["-q", "block.obj", "a.pfm", "--as", "ids", "--view", side, "--fit", fit];
                run_well(folder.path(), &[&view[..], &size].concat());
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

/// Faces of a material that is left out, others that are cut away, and one without an area, all of them far away.
const UNSEEN: &str = "\
mtllib a.mtl\nv 90 0 0\nv 0 90 0\nv 0 0 90\nv 91 0 0\nv 92 0 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
f 18 21 22\nusemtl clear\nf 18 19 20\nusemtl cut\nf 18/1 19/2 20/3\n";

#[test]
fn what_is_not_seen_is_not_framed() {
    let folder = with_block();
    let at = folder.path();
    put(at, "a.mtl", "newmtl clear\nd 0\nnewmtl cut\nmap_d black.pgm\n");
    put(at, "black.pgm", "P2 2 2 255 0 0 0 0\n");
    put(at, "more.obj", format!("{BLOCK}{UNSEEN}"));
    let [block, more] = ["block", "more"].map(|name| {
        let (scene, image) = (format!("{name}.obj"), format!("{name}.pfm"));
        run_well(at, &[&scene, &image, "-q", "--width", "40", "--height", "30"]);
        film(at, &image)
    });
    assert!(more.same_bits(&block));
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
        put(at, name, text);
        for side in ["front", "left", "top", "iso", "inside"] {
            let view = [&[name, "a.pfm", "--view", side], &size[..]].concat();
            run_well(at, &view);
            run_well(
                at,
                &[&[name, "a.gif", "--turntable", "3", "--view", side], &size[..]].concat(),
            );
            run_well(at, &[&[name, "a.pfm", "--sheet", "front,top"], &size[..]].concat());
        }
    }
    let above = ["flat.obj", "a.pfm", "--view", "top", "--as", "ids"];
    run_well(at, &[&above[..], &size[..]].concat());
    let [_, _, top, bottom] = margins(&film(at, "a.pfm"));
    assert!((top - 0.04).abs() <= 0.05 && (bottom - 0.04).abs() <= 0.05, "{top} {bottom}");
}

#[test]
fn a_camera_that_is_chosen_is_written_down_and_so_is_a_turn() {
    let folder = with_block();
    let at = folder.path();
    let size = ["--width", "40", "--height", "30"];
    let asked = ["--view", "70,15", "--up", "z", "--fov", "25", "--turntable", "3"];
    run_well(at, &[&["convert", "-q", "block.obj", "s.json"], &size[..], &asked].concat());
    run_well(at, &[&["-q", "block.obj", "a-#.pfm"], &size[..], &asked].concat());
    run_well(at, &["-q", "s.json", "b-#.pfm", "--frames", "1..3"]);
    for shard in ["1/2", "2/2"] {
        run_well(
            at,
            &[&["-q", "block.obj", "c-#.pfm", "--shard", shard], &size[..], &asked].concat(),
        );
    }
    let read = |name: &str| bytes(at, name);
    for frame in 1..=3 {
        let first = read(&format!("a-{frame}.pfm"));
        assert_eq!(first, read(&format!("b-{frame}.pfm")), "{frame}");
        assert_eq!(first, read(&format!("c-{frame}.pfm")), "{frame}");
    }
    assert_ne!(read("a-1.pfm"), read("a-2.pfm"));
    run_well(at, &["-q", "s.json", "still.pfm"]);
    assert_eq!(read("still.pfm"), read("a-1.pfm"), "the camera stands where the turn begins");
}

#[test]
fn a_camera_is_placed_by_hand_where_another_stands() {
    let folder = with_block();
    let at = folder.path();
    let size = ["--width", "40", "--height", "30", "-q"];
    for (up, side) in [("y", "70,15"), ("z", "front"), ("z", "top"), ("-x", "bottom")] {
        let options = [&size[..], &["--up", up]].concat();
        let view = [&options[..], &["--view", side]].concat();
        run_well(at, &[&["convert", "--force", "block.obj", "s.json"], &view[..]].concat());
        run_well(at, &[&["block.obj", "a.pfm"], &view[..]].concat());
        let camera = &json_in(at, "s.json")["camera"];
        let point = |key: &str| {
            let numbers = camera[key].as_array().expect("a point").iter();
            numbers.map(ToString::to_string).collect::<Vec<_>>().join(",")
        };
        let hand = ["--from", &point("location"), "--at", &point("look")].map(str::to_owned);
        let hand: Vec<&str> = hand.iter().map(String::as_str).collect();
        run_well(at, &[&["block.obj", "b.pfm"], &options[..], &hand].concat());
        assert_eq!(bytes(at, "a.pfm"), bytes(at, "b.pfm"), "{up} {side}");
    }
}

#[test]
fn a_turn_is_one_file_that_moves_and_sides_are_one_picture() {
    let folder = with_block();
    let at = folder.path();
    let size = ["--width", "40", "--height", "30", "-q"];
    for name in ["a.gif", "a.png"] {
        run_well(at, &[&["block.obj", name, "--turntable", "3"], &size[..]].concat());
    }
    assert!(bytes(at, "a.gif").starts_with(b"GIF89a"));
    assert!(bytes(at, "a.png").windows(4).any(|chunk| chunk == b"acTL"));
    run_well(at, &[&["block.obj", "sheet.pfm", "--sheet", "front,30,20,top"], &size[..]].concat());
    run_well(at, &[&["block.obj", "top.pfm", "--view", "top"], &size[..]].concat());
    let (sheet, top) = (film(at, "sheet.pfm"), film(at, "top.pfm"));
    assert_eq!((sheet.width(), sheet.height()), (80, 60));
    for (x, y) in [(3, 3), (20, 15), (11, 7), (30, 20)] {
        let (found, expected) = (sheet.pixel(x, 30 + y), top.pixel(x, y));
        assert_eq!(found, expected, "each side is lit from where it is looked at: {x} {y}");
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
        run_well(folder.path(), &whole);
        let part = [scene, "b.pfm", "--as", look, "--crop", "10,6,20,16", "--threads", "1"];
        run_well(folder.path(), &[&part[..], &size].concat());
        let (a, b) = (film(folder.path(), "a.pfm"), film(folder.path(), "b.pfm"));
        for (x, y) in places(20, 16) {
            assert_eq!(b.pixel(x, y), a.pixel(x + 10, y + 6), "{look} {x} {y}");
        }
        let plain = [scene, "c.pfm", "--width", "48", "--height", "32", "-q"];
        run_well(folder.path(), &plain);
        // There is no triangle in this scene but the quad's edges, which are in view.
        assert!(!a.same_bits(&film(folder.path(), "c.pfm")), "{look} shows something else");
    }
}

#[test]
fn looks_show_what_they_say() {
    let folder = with_block();
    let at = folder.path();
    let look = |look: &str| {
        let size = ["--width", "80", "--height", "60", "--view", "front", "-q", "--as", look];
        run_well(at, &[&["block.obj", "a.pfm"], &size[..]].concat());
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
    run_well(at, &[&lit[..], &["--width", "80", "--height", "60", "--view", "front"]].concat());
    let plain = film(at, "a.pfm");
    // Along the diagonal of the front, and nowhere near it.
    let red = |film: &Film, x, y| film.pixel(x, y).map(|pixel| pixel[0]).expect("a pixel");
    let is_darker = |x, y| red(&wires, x, y) < 0.9 * red(&plain, x, y);
    let rows: Vec<usize> =
        (40..50).map(|y| (20..60).filter(|&x| is_darker(x, y)).count()).collect();
    assert!(rows.iter().all(|count| (1..=8).contains(count)), "{rows:?}");
}

#[test]
fn bytes_as_colours_of_vertices_are_scaled_and_told() {
    let folder = folder();
    let image = |name: &str, most: u32| {
        let text = format!("v 0 0 0 {most} 0 0\nv 1 0 0 0 {most} 0\nv 0 1 0 0 0 {most}\nf 1 2 3\n");
        put(folder.path(), "a.obj", text);
        let told = run_well(folder.path(), &["a.obj", name, "--width", "40", "--height", "30"]);
        (film(folder.path(), name), told.contains("are taken as 0 to 255"))
    };
    let ((bytes, is_told), (ones, is_told_too)) = (image("a.pfm", 255), image("b.pfm", 1));
    assert!(bytes.same_bits(&ones) && is_told && !is_told_too);
}
