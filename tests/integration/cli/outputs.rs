//! Several outputs, layers, and what files say of how they were made.

use std::path::Path;

use exr::prelude::{
    AnyChannels, AttributeValue, FlatSamples, Image, Layer, read_first_flat_layer_from_file,
};
use serde_json::Value;
use wavecrest_scene::load::load;

use super::{ball, run_silently, with_ball, with_scene};
use crate::support::{bytes, film, image, ready};

/// The attributes of an EXR whose names are ours, and that of the program.
fn attributes(file: &Path) -> Vec<(String, String)> {
    let image = read_first_flat_layer_from_file(file).expect("an EXR");
    let own = &image.layer_data.attributes;
    let software = own.software_name.iter().map(|text| ("software".to_owned(), text.to_string()));
    let text = |value: &AttributeValue| match value {
        AttributeValue::Text(text) => text.to_string(),
        other => panic!("{other:?}"),
    };
    let others = own.other.iter().map(|(name, value)| (name.to_string(), text(value)));
    let mut all: Vec<_> = software.chain(others).collect();
    all.sort();
    all
}

#[test]
fn an_image_is_written_to_several_files() {
    let folder = with_ball();
    let also = ["--also", "b.png", "--also", "c.ppm", "--also", "d.pfm"];
    run_silently(folder.path(), &[&["ball.json", "a.exr"], &also[..]].concat());
    for name in ["a.exr", "b.png", "c.ppm", "d.pfm"] {
        let alone = format!("alone-{name}");
        run_silently(folder.path(), &["ball.json", &alone]);
        assert!(bytes(folder.path(), name) == bytes(folder.path(), &alone), "{name}");
    }
}

#[test]
fn layers_lie_beside_the_colours_and_change_none() {
    let folder = with_ball();
    let arguments = ["ball.json", "a.png", "--also", "b.exr", "--aov", "all"];
    run_silently(folder.path(), &arguments);
    assert!(film(folder.path(), "b.exr").same_bits(&image(&ball())));
    run_silently(folder.path(), &["ball.json", "c.png"]);
    assert!(bytes(folder.path(), "a.png") == bytes(folder.path(), "c.png"));
    let found = read_first_flat_layer_from_file(folder.path().join("b.exr")).expect("an EXR");
    let channels = &found.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    let expected = "B G N.X N.Y N.Z P.X P.Y P.Z R albedo.B albedo.G albedo.R depth.Z invalid.mask \
                    material.id object.id samples.count";
    assert_eq!(names.join(" "), expected);
    for channel in channels {
        let name = channel.name.to_string();
        let is_integer = matches!(channel.sample_data, FlatSamples::U32(_));
        assert_eq!(is_integer, name.ends_with(".id") || name.ends_with(".count"), "{name}");
        assert_eq!(channel.sample_data.len(), 16 * 12);
    }
    let attributes = attributes(&folder.path().join("b.exr"));
    let objects = attributes.iter().find(|(name, _)| name == "wavecrest.objects").expect("a table");
    let objects: Value = serde_json::from_str(&objects.1).expect("JSON");
    let mut shown: Vec<_> = objects.as_object().expect("a table").values().collect();
    shown.sort_by_key(|place| place.to_string());
    assert_eq!(shown, ["scene.shapes[0]", "scene.shapes[1]"]);
    // A part of the image has the same layers there.
    let arguments = ["ball.json", "c.exr", "--aov", "depth, object", "--crop", "3,2,8,7"];
    run_silently(folder.path(), &arguments);
    let part = read_first_flat_layer_from_file(folder.path().join("c.exr")).expect("an EXR");
    let value = |image: &Image<Layer<AnyChannels<FlatSamples>>>, x: usize, y: usize| {
        let layer = &image.layer_data;
        let channel = layer.channel_data.list.iter().find(|c| c.name.to_string() == "depth.Z");
        let index = y * layer.size.0 + x;
        channel.expect("a depth").sample_data.value_by_flat_index(index).to_f32()
    };
    for (x, y) in (0..7).flat_map(|y| (0..8).map(move |x| (x, y))) {
        assert_eq!(value(&part, x, y).to_bits(), value(&found, x + 3, y + 2).to_bits(), "{x},{y}");
    }
}

/// The scene's fingerprint, as files have it.
fn fingerprint(file: &Path) -> String {
    format!("{:032x}", ready(load(file, &Default::default())).fingerprint())
}

#[test]
fn files_say_how_they_were_made() {
    let folder = with_ball();
    let also = ["--also", "b.png", "--also", "c.ppm", "--also", "d.pfm", "--seed", "7"];
    run_silently(folder.path(), &[&["ball.json", "a.exr"], &also[..]].concat());
    let software = format!("wavecrest {}", env!("CARGO_PKG_VERSION"));
    let scene = fingerprint(&folder.path().join("ball.json"));
    let expected = [
        ("software", software.as_str()),
        ("wavecrest.precision", "exact"),
        ("wavecrest.samples", "1"),
        ("wavecrest.scene", scene.as_str()),
        ("wavecrest.seed", "7"),
    ];
    let expected = expected.map(|(name, text)| (name.to_owned(), text.to_owned()));
    assert_eq!(attributes(&folder.path().join("a.exr")), expected);
    let has = |name: &str, text: &str| {
        bytes(folder.path(), name).windows(text.len()).any(|w| w == text.as_bytes())
    };
    for text in [format!("tEXtSoftware\0{software}"), format!("tEXtwavecrest.scene\0{scene}")] {
        assert!(has("b.png", &text), "{text}");
    }
    // A PPM that says nothing is one that every reader takes.
    assert!(bytes(folder.path(), "c.ppm").starts_with(b"P6\n16 12\n255\n"));
    assert!(!has("d.pfm", "wavecrest"));
}

#[test]
fn more_or_nothing_is_said_where_that_is_asked_for() {
    let folder = with_ball();
    let also = ["--also", "b.png", "--also", "c.ppm", "--crop", "1,2,6,5"];
    let full = [&["ball.json", "a.exr", "--metadata", "full"], &also[..]].concat();
    run_silently(folder.path(), &full);
    let all = attributes(&folder.path().join("a.exr"));
    let entry = |name: &str| {
        let found = all.iter().find(|(n, _)| n == name);
        found.unwrap_or_else(|| panic!("{name}")).1.as_str()
    };
    assert!(entry("wavecrest.command").ends_with(&full.join(" ")), "{all:?}");
    assert_eq!(entry("wavecrest.crop"), "1,2,6,5");
    let ppm = bytes(folder.path(), "c.ppm");
    let header = String::from_utf8_lossy(&ppm[..ppm.len() - 6 * 5 * 3]).into_owned();
    assert!(header.starts_with("P6\n# wavecrest.software: wavecrest "), "{header}");
    assert!(header.ends_with("--crop 1,2,6,5\n6 5\n255\n"), "{header}");
    let usual = film(folder.path(), "c.ppm");
    run_silently(folder.path(), &[&["ball.json", "a.exr", "--no-metadata"], &also[..]].concat());
    assert_eq!(attributes(&folder.path().join("a.exr")), []);
    for name in ["a.exr", "b.png", "c.ppm"] {
        let said = String::from_utf8_lossy(&bytes(folder.path(), name)).contains("wavecrest");
        assert!(!said, "{name}");
    }
    assert!(film(folder.path(), "c.ppm").same_bits(&usual));
}

#[test]
fn the_hash_of_the_scene_is_that_of_the_rendered_scene() {
    let folder = with_ball();
    let told = |scene: &str| {
        let folder = with_scene(scene);
        run_silently(folder.path(), &["ball.json", "a.exr"]);
        let all = attributes(&folder.path().join("a.exr"));
        all.into_iter().find(|(name, _)| name == "wavecrest.scene").expect("a hash").1
    };
    let text = std::fs::read_to_string(folder.path().join("ball.json")).expect("a scene");
    assert_eq!(told(&text), told(&text.replace(',', " ,\n")), "white space is no part of it");
    assert_ne!(told(&text), told(&text.replace("40.0", "41.0")));
}

/// Whatever the order of the parts, and though one is given twice.
#[test]
fn a_merge_of_parts_is_the_file_of_one_process() {
    let folder = with_ball();
    for options in [&[][..], &["--transfer", "srgb", "--seed", "7", "--crop", "1,1,14,10"]] {
        for (part, shard) in [("3.part", "3/3"), ("1.part", "1/3"), ("2.part", "2/3")] {
            run_silently(
                folder.path(),
                &[&["ball.json", part, "--shard", shard], options].concat(),
            );
        }
        for name in ["a.exr", "a.png", "a.ppm", "a.pfm"] {
            for metadata in ["auto", "scene", "none"] {
                let one = [&["ball.json", name, "--metadata", metadata][..], options].concat();
                run_silently(folder.path(), &one);
                let expected = bytes(folder.path(), name);
                let parts = ["merge", "2.part", "3.part", "1.part", "2.part", "-o", name];
                run_silently(folder.path(), &[&parts[..], &["--metadata", metadata]].concat());
                assert!(bytes(folder.path(), name) == expected, "{name} {metadata}");
            }
        }
    }
}
