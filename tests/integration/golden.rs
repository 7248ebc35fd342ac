//! Golden images: the float image of every scene, as it was when it was last approved.
//!
//! `WAVECREST_BLESS=1 cargo test --test integration golden` writes them again. A failure leaves
//! `tests/golden/NAME.actual.exr` and `NAME.diff.png`, the difference made visible.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_image::compare::{compare, difference_image};
use wavecrest_image::read::read;
use wavecrest_image::write::{Transfer, write};

use crate::support::{blessing, extract_small, files_in, image_of, repository, scene_files, stem};

/// The longest side of a golden image, in pixels.
const LONGEST: u32 = 72;

/// The most rays that a golden image may take.
const MOST_RAYS: u64 = 4_000_000;

/// The greatest difference of two values that is still the same picture.
///
/// One machine gives the same bits every time. All arithmetic of the renderer is IEEE 754 without
/// functions of the machine's own, so that others should, too; this leaves room for a compiler that
/// takes the liberty of one rounding, and for nothing that could be seen.
const TOLERANCE: f64 = 1e-6;

/// What the picture of the difference is multiplied by: the tolerance becomes a tenth of white.
const GAIN: f32 = 1e5;

fn golden(name: &str) -> PathBuf {
    repository("tests/golden").join(format!("{name}.exr"))
}

#[test]
fn every_scene_gives_its_golden_image() {
    let failures: Vec<String> =
        scene_files().par_iter().filter_map(|(name, path)| check(name, path).err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_golden_image_has_a_scene() {
    let scenes: Vec<String> = scene_files().into_iter().map(|(name, _)| name).collect();
    let images = files_in("tests/golden", "exr").into_iter().map(|path| stem(&path));
    let stray: Vec<String> = images
        .filter(|name| !name.ends_with(".actual") && !scenes.contains(name))
        .map(|name| format!("tests/golden/{name}.exr belongs to no scene: remove it"))
        .collect();
    assert!(stray.is_empty(), "{}", stray.join("\n"));
}

fn check(name: &str, path: &Path) -> Result<(), String> {
    let scene = extract_small(path, LONGEST, MOST_RAYS).build(Preset::Fast);
    let found = image_of(&scene, 0);
    let golden = golden(name);
    if blessing() {
        return bless(&found, &golden);
    }
    let again = "WAVECREST_BLESS=1 cargo test --test integration golden";
    if !golden.exists() {
        return Err(format!("{name}: there is no golden image: look at the scene, then {again}"));
    }
    let expected = read(&golden).map_err(|error| error.to_string())?;
    let difference = match compare(&expected, &found) {
        Ok(comparison) if comparison.largest <= TOLERANCE => return Ok(()),
        Ok(comparison) => format!(
            "{} pixels differ, by up to {} at {:?}",
            comparison.different_pixels,
            comparison.largest,
            comparison.largest_at.unwrap_or_default()
        ),
        Err(error) => error.to_string(),
    };
    let seen = leave_pictures(name, &expected, &found)?;
    Err(format!("{name}: {difference}; {seen}; if the new image is right: {again}"))
}

/// Writes a golden image, unless it would stay the same.
fn bless(found: &Film, golden: &Path) -> Result<(), String> {
    if golden.exists() && read(golden).is_ok_and(|old| old.same_bits(found)) {
        return Ok(());
    }
    write(found, golden, Transfer::Linear).map_err(|error| error.to_string())
}

/// Writes the image found and, where there can be one, the picture of the difference.
fn leave_pictures(name: &str, expected: &Film, found: &Film) -> Result<String, String> {
    let beside = |suffix: &str| repository("tests/golden").join(format!("{name}.{suffix}"));
    let text = |error: wavecrest_base::error::Error| error.to_string();
    write(found, &beside("actual.exr"), Transfer::Linear).map_err(text)?;
    let mut seen = format!("see tests/golden/{name}.actual.exr");
    if let Ok(difference) = difference_image(expected, found, GAIN) {
        write(&difference, &beside("diff.png"), Transfer::Linear).map_err(text)?;
        seen += &format!(" and {name}.diff.png ({GAIN} times the difference)");
    }
    Ok(seen)
}
