//! Layers of parts, merged parts, and statistics, as files have them.

use exr::prelude::read_first_flat_layer_from_file;

use super::{run_silently, with_ball};
use crate::support::{bytes, json_in, run, run_well, text};

#[test]
fn a_part_of_the_image_has_the_layers_that_the_whole_has_there() {
    let folder = with_ball();
    let depths = |options: &[&str]| {
        let arguments = ["ball.json", "a.exr", "--aov", "depth, object"];
        run_silently(folder.path(), &[&arguments, options].concat());
        let image = read_first_flat_layer_from_file(folder.path().join("a.exr")).expect("an EXR");
        let mut channels = image.layer_data.channel_data.list.into_iter();
        let channel = channels.find(|channel| channel.name.to_string() == "depth.Z");
        channel.expect("a depth").sample_data.values_as_f32().map(f32::to_bits).collect::<Vec<_>>()
    };
    let whole = depths(&[]);
    let rows = whole.chunks(16).skip(2).take(7);
    assert_eq!(
        depths(&["--crop", "3,2,8,7"]),
        rows.flat_map(|row| &row[3..11]).copied().collect::<Vec<_>>()
    );
}

/// `statistics.txt` has every key that the documentation names, as JSON pointers.
#[test]
fn statistics_have_every_key_that_their_documentation_names() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "out.exr", "--stats", "stats.json"]);
    let found = json_in(folder.path(), "stats.json");
    for key in include_str!("../statistics.txt").lines() {
        assert!(found.pointer(key).is_some(), "{key} is missing");
    }
    let time = |key: &str| found["time"][key].as_f64().expect("seconds");
    assert!(time("total") >= time("trace"));
    for key in ["secondary", "shadow"] {
        let [most, rays] =
            [&found["estimated"]["rays"][key], &found["rays"][key]].map(|n| n.as_u64());
        assert!(most >= rays && rays > Some(0), "{key}");
    }
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

#[test]
fn the_image_on_standard_output_is_that_of_a_file() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "out.png"]);
    let output = run(folder.path(), &["ball.json", "-", "--quiet"]);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    assert_eq!(output.stdout, bytes(folder.path(), "out.png"));
}

#[test]
fn each_of_several_scenes_has_its_image_though_one_cannot_be_rendered() {
    let folder = with_ball();
    let at = folder.path();
    std::fs::copy(at.join("ball.json"), at.join("other.json")).expect("a copy");
    run_silently(at, &["ball.json", "out.png"]);
    let output = run(at, &["ball.json", "none.json", "other.json", "-o", "images", "--quiet"]);
    assert_eq!(output.status.code(), Some(2));
    let told: Vec<&str> = text(&output.stderr).lines().collect();
    assert!(told.len() == 2 && told[0].contains("none.json") && told[1].contains("1 of 3"));
    for name in ["images/ball.png", "images/other.png"] {
        assert_eq!(bytes(at, name), bytes(at, "out.png"), "{name}");
    }
    run_well(at, &["other.json", "-o", "images", "--quiet"]);
}
