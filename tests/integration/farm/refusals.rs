//! Parts that are damaged, foreign, or of another image are refused by name, and say in what they differ.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::TempDir;
use wavecrest_base::error::Error;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::RenderOptions;
use wavecrest_image::farm::merge::merge;
use wavecrest_image::farm::part::Reader;
use wavecrest_image::farm::{Author, Session};
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems::{self, Options};

use super::{checkpoint, no_warning, shard};
use crate::parts::ball;
use crate::support::{folder, options, prepare, repository};

/// A folder with the parts `1.part` and `2.part` of a small image, and their paths.
fn two_parts() -> (TempDir, [PathBuf; 2]) {
    let folder = folder();
    let scene = prepare(&ball([20, 12], 1));
    let files = [1, 2].map(|number| {
        let file = folder.path().join(format!("{number}.part"));
        super::write_part(&scene, shard(number, 2), &file);
        file
    });
    (folder, files)
}

/// What reading all of a part comes to.
fn read(file: &Path) -> Result<usize, Error> {
    let mut reader = Reader::open(file)?;
    let mut units = 0;
    while reader.next_unit()?.is_some() {
        units += 1;
    }
    Ok(units)
}

fn refused(bytes: &[u8], what: &str) -> String {
    let folder = folder();
    let file = folder.path().join("bad.part");
    std::fs::write(&file, bytes).expect("a file");
    let error = read(&file).expect_err(what).to_string();
    assert!(error.contains("bad.part: "), "{what}: {error}");
    error
}

#[test]
fn a_part_with_any_byte_changed_is_refused() {
    let (_folder, [one, _]) = two_parts();
    let bytes = std::fs::read(&one).expect("a part");
    assert!(read(&one).expect("it is sound") > 1);
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
    let (_folder, [one, _]) = two_parts();
    let bytes = std::fs::read(&one).expect("a part");
    for length in (0..bytes.len()).step_by(13).chain([bytes.len() - 1]) {
        refused(&bytes[..length], &format!("{length} bytes"));
    }
    let long = refused(&[&bytes[..], b"x"].concat(), "a byte more");
    assert!(long.contains("the part is damaged: there is more after its last unit"), "{long}");
}

#[test]
fn a_file_that_is_not_a_part_is_refused() {
    let text = refused(b"P6\n16 12\n255\nno part at all, but an image", "an image");
    assert!(
        text.ends_with(
            "bad.part: this is not a part of a render; \
             use a file that wavecrest wrote with --shard or --checkpoint"
        ),
        "{text}"
    );
    let newer = [&b"WAVEPART"[..], &7u32.to_le_bytes(), &[0; 40]].concat();
    let text = refused(&newer, "a newer one");
    assert!(text.contains("the part has another format version, found 7"), "{text}");
    // A length that the file does not have is not believed.
    let claims = [&b"WAVEPART"[..], &1u32.to_le_bytes(), &u32::MAX.to_le_bytes(), &[0; 40]];
    let text = refused(&claims.concat(), "claims");
    assert!(text.contains("its header is too long"), "{text}");
    let error = read(folder().path()).expect_err("a folder").to_string();
    assert!(error.contains("cannot read the part"), "{error}");
}

/// A header that is whole, and speaks of what cannot be or of an image that the file does not hold.
#[test]
fn a_header_that_claims_too_much_sets_no_memory_aside() {
    let (_folder, [one, _]) = two_parts();
    let bytes = std::fs::read(&one).expect("a part");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let header: Value = serde_json::from_slice(&bytes[16..16 + length]).expect("JSON");
    let with = |changes: &[(&str, Value)]| {
        let mut header = header.clone();
        header["units"] = json!(0);
        for (place, value) in changes {
            *header.pointer_mut(place).expect("it is there") = value.clone();
        }
        let json = header.to_string();
        let mut start = b"WAVEPART\x01\0\0\0".to_vec();
        start.extend((json.len() as u32).to_le_bytes());
        start.extend(json.as_bytes());
        let hash = xxhash_rust::xxh3::xxh3_64_with_seed(&start, 0);
        start.extend(hash.to_le_bytes());
        start
    };
    for (changes, told) in [
        (vec![("/identity/image", json!([0, 12]))], "identity.image"),
        (vec![("/identity/image", json!([1 << 20, 1 << 20]))], "identity.image"),
        (vec![("/identity/window", json!([0, 0, 21, 12]))], "identity.window"),
        (vec![("/identity/window", json!([0, 0, 0, 12]))], "identity.window"),
        (vec![("/identity/window", json!([u32::MAX, 0, u32::MAX, 12]))], "identity.window"),
        (vec![("/identity/samples", json!(0))], "identity.samples"),
        (vec![("/identity/edge", json!(0))], "identity.edge"),
        (vec![("/identity/edge", json!(1 << 30))], "identity.edge"),
        (vec![("/units", json!(u64::MAX))], "it is cut short"),
        (vec![("/identity/seed", json!("seven"))], "the header is malformed"),
    ] {
        let text = refused(&with(&changes), told);
        assert!(text.contains(told), "{text}");
    }
    // A large image that is sound in itself, without a unit.
    let large = [
        ("/identity/image", json!([16384, 16384])),
        ("/identity/window", json!([0, 0, 16384, 16384])),
        ("/shard", json!(null)),
    ];
    let folder = folder();
    let file = folder.path().join("large.part");
    std::fs::write(&file, with(&large)).expect("a file");
    let length = file.metadata().expect("a file").len();
    let error = merge(&[file]).expect_err("nothing is there").to_string();
    assert_eq!(
        error,
        format!(
            "the parts do not make a whole image, found {length} bytes of parts for 268435456 pixels; \
             render what is missing and merge again"
        )
    );
}

#[test]
fn missing_shards_are_named() {
    let folder = folder();
    let scene = prepare(&ball([40, 40], 1));
    let parts: Vec<PathBuf> = (1..=5)
        .map(|number| {
            let file = folder.path().join(format!("{number}.part"));
            super::write_part(&scene, shard(number, 5), &file);
            file
        })
        .collect();
    let told = |parts: &[PathBuf]| merge(parts).expect_err("a gap").to_string();
    assert_eq!(
        told(&[&parts[..1], &parts[2..4]].concat()),
        "shards 2/5, 5/5 are missing; render them with --shard, or add their files, and merge again"
    );
    assert_eq!(
        told(&[parts[0].clone(), parts[0].clone()]),
        "shards 2/5, 3/5, 4/5, 5/5 are missing; render them with --shard, or add their files, and \
         merge again"
    );
}

/// The checkpoint of a render that was ended is a part with gaps.
#[test]
fn unfinished_parts_are_refused_with_their_place() {
    let folder = folder();
    let scene = prepare(&ball([80, 80], 1));
    let kept = checkpoint(&folder.path().join("a.kept"), false);
    let options = options();
    let session = Session::begin(&scene, options, Author::default(), None, Some(kept.clone()));
    let session = session.expect("a session");
    session.render(&super::EndAfter::new(99), &no_warning).expect("a part");
    let error = merge(&[kept.file]).expect_err("a gap").to_string();
    assert!(
        error.starts_with(
            "the parts do not make a whole image, found 1 tiles missing, the first at "
        ),
        "{error}"
    );
}

/// Two parts that say the same of themselves and not the same of a tile: one of the machines errs.
#[test]
fn parts_that_differ_where_they_overlap_are_refused() {
    let (folder, [one, two]) = two_parts();
    let mut bytes = std::fs::read(&one).expect("a part");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let header = 16 + length;
    let seed = u64::from_le_bytes(bytes[header..header + 8].try_into().expect("eight bytes"));
    // The first unit: numbers, sums, hash; the part has another last bit, and a hash that fits.
    let start = header + 8;
    let end = start + 24 + 64 * 24;
    bytes[start + 24] ^= 1;
    let hash = xxhash_rust::xxh3::xxh3_64_with_seed(&bytes[start..end], seed);
    bytes[end..end + 8].copy_from_slice(&hash.to_le_bytes());
    let other = folder.path().join("other.part");
    std::fs::write(&other, bytes).expect("a file");
    let error = merge(&[one.clone(), other.clone(), two]).expect_err("they differ").to_string();
    assert_eq!(
        error,
        format!(
            "{}: tile at 0,0: it differs from {}; remove one of the two, or render both again",
            other.display(),
            one.display()
        )
    );
}

#[test]
fn parts_that_were_cut_in_another_way_are_refused_where_they_overlap() {
    let folder = folder();
    let scene = prepare(&ball([8, 8], 29));
    let name = |name: &str| folder.path().join(name);
    super::write_part(&scene, shard(1, 1), &name("whole.part"));
    super::write_part(&scene, shard(2, 3), &name("second.part"));
    let error = merge(&[name("whole.part"), name("second.part")]).expect_err("they overlap");
    let text = error.to_string();
    assert!(text.contains("second.part: tile at 0,0: it overlaps "), "{text}");
}

/// A part of the render of a scene with these changes.
struct Stranger {
    scene: PreparedScene,
    options: RenderOptions,
}

/// Renders that differ in one thing from that of [`strangers_scene`], and what is told of it.
fn strangers() -> Vec<(&'static str, Stranger)> {
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut scene = strangers_scene();
        change(&mut scene);
        Stranger { scene: prepare(&scene), options: options() }
    };
    let set = |place: &'static str, value: Value| {
        changed(&|scene: &mut Value| {
            *scene.pointer_mut(place).expect("it is there") = value.clone();
        })
    };
    let fast = {
        let text = strangers_scene().to_string();
        let loaded = load_str(&text, &repository("test.json"), &LoadOptions::default());
        let loaded = loaded.expect("a scene");
        let options = Options { precision: Precision::Fast, ..Options::default() };
        let extracted = systems::extract(loaded.world, options);
        extracted.expect("a scene").build(wavecrest_core::accel::build::Preset::Fast)
    };
    let crop = wavecrest_core::tile::Tile { x: 2, y: 1, width: 9, height: 8 };
    let usual = || prepare(&strangers_scene());
    vec![
        ("seed", Stranger { scene: usual(), options: RenderOptions { seed: 5, ..options() } }),
        (
            "part of the image",
            Stranger { scene: usual(), options: RenderOptions { crop: Some(crop), ..options() } },
        ),
        ("precision", Stranger { scene: fast, options: options() }),
        ("image size", set("/camera/width", json!(24))),
        ("number of samples per pixel", set("/camera/antialias", json!(2))),
        ("camera", set("/camera/fov", json!(41.0))),
        ("geometry", set("/scene/shapes/0/radius", json!(1.01))),
        ("geometry", set("/scene/shapes/2/points/1/0", json!(0.01))),
        ("texture", set("/scene/shapes/1/texture", json!("textures/bricks.png"))),
        ("look", set("/scene/shapes/0/material/kd", json!(0.71))),
        ("look", set("/scene/lightsources/0/intensity", json!(41.0))),
        ("look", set("/scene/backgroundcolor/1", json!(0.3))),
        ("look", set("/nbounces", json!(2))),
    ]
}

/// A ball, a wall with a texture, and a mesh.
fn strangers_scene() -> Value {
    let mut scene = ball([20, 12], 1);
    scene["scene"]["shapes"][1]["texture"] = json!("textures/picture.png");
    let material = scene["scene"]["shapes"][0]["material"].clone();
    let points = [[-2.0, -1.0, 0.5], [0.0, 1.0, 0.5], [-1.0, -1.0, 0.0], [0.0, -1.0, 1.0]];
    let mesh = json!({
        "type": "trimesh", "points": points, "indices": [[0, 1, 2], [1, 2, 3]], "material": material
    });
    scene["scene"]["shapes"].as_array_mut().expect("shapes").push(mesh);
    scene
}

#[test]
fn parts_of_another_image_are_refused_with_the_difference() {
    let folder = folder();
    let name = |name: &str| folder.path().join(name);
    super::write_part(&prepare(&strangers_scene()), shard(1, 2), &name("1.part"));
    for (what, Stranger { scene, options }) in strangers() {
        let author = Author::default();
        let session = Session::begin(&scene, options, author, Some(shard(2, 2)), None);
        let session = session.expect("a session");
        session.render_units(&(), &no_warning).expect("units");
        session.write(&name("2.part")).expect("a part");
        let told = merge(&[name("1.part"), name("2.part")]).expect_err(what).to_string();
        assert!(told.contains(&format!("2.part: the {what}")), "{what}: {told}");
        assert!(told.contains(" differs from that of ") && told.contains("1.part"), "{told}");
    }
}

#[test]
fn checkpoints_of_another_render_are_refused_with_the_difference() {
    let folder = folder();
    let kept = checkpoint(&folder.path().join("a.kept"), false);
    let scene = prepare(&strangers_scene());
    let begin = |scene: &PreparedScene, options: &RenderOptions, resume: bool| {
        let kept = checkpoint(&kept.file, resume);
        let session = Session::begin(scene, *options, Author::default(), None, Some(kept.clone()));
        session.map(|session| session.render(&(), &no_warning).map(drop)).map(drop)
    };
    begin(&scene, &options(), false).expect("it is kept");
    begin(&scene, &options(), true).expect("it goes on");
    let before = std::fs::read(&kept.file).expect("a checkpoint");
    for (what, Stranger { scene, options }) in strangers() {
        let told = begin(&scene, &options, true).expect_err(what).to_string();
        assert!(
            told.contains(&format!("the {what}"))
                && told.contains(" differs from that of the checkpoint"),
            "{told}"
        );
        assert!(told.contains("a.kept: "), "{told}");
    }
    let told = begin(&scene, &options(), false).expect_err("it is there").to_string();
    assert!(told.ends_with(
        "a.kept: the checkpoint exists already; resume from it with --resume, or remove it"
    ));
    let options = options();
    let kept = checkpoint(&kept.file, true);
    let other =
        Session::begin(&scene, options, Author::default(), Some(shard(1, 2)), Some(kept.clone()));
    let told = other.map(drop).expect_err("another share").to_string();
    assert!(
        told.contains("the checkpoint belongs to another shard, found the whole image"),
        "{told}"
    );
    assert_eq!(std::fs::read(&kept.file).expect("a checkpoint"), before);
}
