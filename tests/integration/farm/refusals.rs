//! Parts that are damaged, foreign, or of another image are refused by name, and say in what they differ.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::TempDir;
use wavecrest_base::error::Error;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::RenderOptions;
use wavecrest_core::tile::Tile;
use wavecrest_image::farm::merge::merge;
use wavecrest_image::farm::part::PartReader;
use wavecrest_scene::systems::SceneOptions;

use super::{begin, checkpoint, no_warning, render_until, shard, write_part, write_parts};
use crate::parts::ball;
use crate::support::{edited, folder, options, prepare, prepare_in, put, repository};
use crate::transcript;

/// A folder with the parts `1.part` and `2.part` of a small image, and their paths.
fn two_parts() -> (TempDir, Vec<PathBuf>) {
    let folder = folder();
    let parts = write_parts(&prepare(&ball([20, 12], 1)), &options(), 2, folder.path());
    (folder, parts)
}

/// What reading all of a part comes to.
fn read(file: &Path) -> Result<usize, Error> {
    let mut reader = PartReader::open(file)?;
    let mut units = 0;
    while reader.next_unit()?.is_some() {
        units += 1;
    }
    Ok(units)
}

fn refused(bytes: &[u8], what: &str) -> String {
    let folder = folder();
    put(folder.path(), "bad.part", bytes);
    let error = read(&folder.path().join("bad.part")).expect_err(what).to_string();
    let within = error.replace(&format!("{}/", folder.path().display()), "");
    assert!(within.starts_with("bad.part: "), "{what}: {error}");
    within
}

#[test]
fn a_part_with_any_byte_changed_is_refused() {
    let (_folder, parts) = two_parts();
    let bytes = std::fs::read(&parts[0]).expect("a part");
    assert!(read(&parts[0]).expect("it is sound") > 1);
    for at in 0..bytes.len() {
        // All of the header and of what surrounds units, and some of the sums.
        if at > 1500 && at % 7 != 0 {
            continue;
        }
        let mut wrong = bytes.clone();
        wrong[at] ^= 1 << (at % 8);
        refused(&wrong, &format!("byte {at}"));
    }
}

#[test]
fn a_part_of_the_wrong_length_is_refused() {
    let (_folder, parts) = two_parts();
    let bytes = std::fs::read(&parts[0]).expect("a part");
    for length in (0..bytes.len()).step_by(13).chain([bytes.len() - 1]) {
        refused(&bytes[..length], &format!("{length} bytes"));
    }
    let long = refused(&[&bytes[..], b"x"].concat(), "a byte more");
    assert!(long.contains("the part is damaged: there is more after its last unit"), "{long}");
    let error = read(folder().path()).expect_err("a folder").to_string();
    assert!(error.contains("cannot read the part"), "{error}");
}

/// The length of the header of a part, and where it begins.
const START: usize = 16;
fn header_length(part: &[u8]) -> usize {
    u32::from_le_bytes(part[12..START].try_into().expect("four bytes")) as usize
}

/// The beginning of a part: its mark, the version of its format, and the length of its header.
fn start(version: u32, length: u32) -> Vec<u8> {
    [&b"WAVEPART"[..], &version.to_le_bytes(), &length.to_le_bytes()].concat()
}

/// `header` is a sound header without units, edited as the lines say; it is of an image that the file does not hold.
#[test]
fn what_is_no_part_or_claims_too_much_is_refused_and_sets_no_memory_aside() {
    let (_folder, parts) = two_parts();
    let bytes = std::fs::read(&parts[0]).expect("a part");
    let end = START + header_length(&bytes);
    let header: Value = serde_json::from_slice(&bytes[START..end]).expect("JSON");
    transcript::check("files-of-parts", |input, more| {
        match input.split(' ').collect::<Vec<_>>()[..] {
            ["content"] => refused(more.as_bytes(), input),
            ["start", version, length] => {
                let number = |text: &str| text.parse().expect("a number");
                refused(&[start(number(version), number(length)), vec![0; 40]].concat(), input)
            }
            [kind] => {
                let json = edited(edited(header.clone(), "/units 0"), more).to_string();
                let mut part = start(3, json.len() as u32);
                part.extend(json.as_bytes());
                let hash = xxhash_rust::xxh3::xxh3_64_with_seed(&part, 0);
                part.extend(hash.to_le_bytes());
                if kind == "header" {
                    return refused(&part, input);
                }
                let folder = folder();
                put(folder.path(), "large.part", part);
                merge(&[folder.path().join("large.part")]).expect_err(input).to_string()
            }
            _ => panic!("{input}"),
        }
    });
}

/// The checkpoint of a render that was ended is a part with gaps.
#[test]
fn unfinished_parts_are_refused_with_their_place() {
    let folder = folder();
    let (scene, options) = (prepare(&ball([80, 80], 1)), options());
    let kept = checkpoint(&folder.path().join("a.kept"), false);
    let session = begin(&scene, &options, None, Some(&kept)).expect("a session");
    assert!(!render_until(&scene, &session, 0.985).finished);
    let error = merge(&[kept.file]).expect_err("a gap").to_string();
    let words = "the parts do not make a whole image, found 1 tiles missing, the first at ";
    assert!(error.starts_with(words), "{error}");
}

/// Two parts that say the same of themselves and not the same of a tile: one of the machines errs.
#[test]
fn parts_that_differ_where_they_overlap_are_refused() {
    let (folder, parts) = two_parts();
    let mut bytes = std::fs::read(&parts[0]).expect("a part");
    let header = START + header_length(&bytes);
    let seed = u64::from_le_bytes(bytes[header..header + 8].try_into().expect("eight bytes"));
    // The first unit: numbers, sums, hash; the part has another last bit, and a hash that fits.
    let start = header + 8;
    let end = start + 20 + 64 * 24;
    bytes[start + 20] ^= 1;
    let hash = xxhash_rust::xxh3::xxh3_64_with_seed(&bytes[start..end], seed);
    bytes[end..end + 8].copy_from_slice(&hash.to_le_bytes());
    let other = folder.path().join("other.part");
    std::fs::write(&other, bytes).expect("a file");
    let all = [parts[0].clone(), other.clone(), parts[1].clone()];
    let error = merge(&all).expect_err("they differ").to_string();
    let (other, one) = (other.display(), parts[0].display());
    let words = "remove one of the two, or render both again";
    assert_eq!(error, format!("{other}: tile at 0,0: it differs from {one}; {words}"));
}

/// A ball, a wall with a texture, and a mesh.
fn strangers_scene() -> Value {
    let ball = ball([20, 12], 1);
    let points = [[-2.0, -1.0, 0.5], [0.0, 1.0, 0.5], [-1.0, -1.0, 0.0], [0.0, -1.0, 1.0]];
    let mesh = json!({"type": "trimesh", "points": points, "indices": [[0, 1, 2], [1, 2, 3]],
                      "material": ball["scene"]["shapes"][0]["material"]});
    let texture = r#"/scene/shapes/1/texture "textures/picture.png""#;
    edited(ball, &format!("{texture}\n/scene/shapes/- {mesh}"))
}

/// What is said of a part, and of a checkpoint, of a render that differs in one thing from that of [`strangers_scene`]:
/// in its scene, edited as the lines say, or as the input says.
#[test]
fn parts_and_checkpoints_of_another_image_are_refused_with_the_difference() {
    let folder = folder();
    let [one, two, kept] = ["1.part", "2.part", "a.kept"].map(|name| folder.path().join(name));
    let usual = prepare(&strangers_scene());
    write_part(&usual, &options(), shard(1, 2), &one);
    let keep = |scene: &PreparedScene, options: &RenderOptions, resume| {
        let kept = checkpoint(&kept, resume);
        let session = begin(scene, options, None, Some(&kept))?;
        session.render(scene, &(), &no_warning).map(drop)
    };
    keep(&usual, &options(), false).expect("it is kept");
    keep(&usual, &options(), true).expect("it goes on");
    let before = std::fs::read(&kept).expect("a checkpoint");
    let crop = Some(Tile { x: 2, y: 1, width: 9, height: 8 });
    let within = |told: String| told.replace(&format!("{}/", folder.path().display()), "");
    transcript::check("strangers", |input, changes| {
        let precision = if input == "fast" { Precision::Fast } else { Precision::Exact };
        let scene = edited(strangers_scene(), changes);
        let by = SceneOptions { precision, ..SceneOptions::default() };
        let scene = prepare_in(&repository(""), &scene, by);
        let options = match input {
            "seed" => RenderOptions { seed: 5, ..options() },
            "crop" => RenderOptions { crop, ..options() },
            _ => options(),
        };
        write_part(&scene, &options, shard(2, 2), &two);
        let part = merge(&[one.clone(), two.clone()]).expect_err(input).to_string();
        let checkpoint = keep(&scene, &options, true).expect_err(input).to_string();
        within(format!("{part}\n{checkpoint}"))
    });
    let told = keep(&usual, &options(), false).expect_err("it is there").to_string();
    let words = "a.kept: the checkpoint exists already; resume from it with --resume, or remove it";
    assert_eq!(within(told), words);
    let (options, again) = (options(), checkpoint(&kept, true));
    let other = begin(&usual, &options, Some(shard(1, 2)), Some(&again));
    let told = other.map(drop).expect_err("another share").to_string();
    let words = "the checkpoint belongs to another shard, found the whole image";
    assert!(told.contains(words), "{told}");
    assert_eq!(std::fs::read(&kept).expect("a checkpoint"), before);
}
