//! Files without a scene, framed from every side. `messages/views.txt` has more.

use wavecrest_core::film::Film;

use crate::support::{film, folder, places, put, run_well};

/// A low block that is longer than wide, with a small one on its top, and a point far away that no face has.
const BLOCK: &str = "\
v -1 0 -2\nv 1 0 -2\nv 1 1 -2\nv -1 1 -2\nv -1 0 2\nv 1 0 2\nv 1 1 2\nv -1 1 2\n\
v -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0.5 2 -0.5\nv -0.5 2 -0.5\n\
v -0.5 1 0.5\nv 0.5 1 0.5\nv 0.5 2 0.5\nv -0.5 2 0.5\nv 9 9 9\n\
f 4 3 2 1\nf 5 6 7 8\nf 1 5 8 4\nf 2 3 7 6\nf 4 8 7 3\nf 1 2 6 5\n\
f 12 11 10 9\nf 13 14 15 16\nf 9 13 16 12\nf 10 11 15 14\nf 12 16 15 11\n";

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
    let folder = folder();
    put(folder.path(), "block.obj", BLOCK);
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
