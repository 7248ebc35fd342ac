#[path = "../../tests/approved.rs"]
mod approved;

use super::*;
use wavecrest_image::compare::pixels_beyond;

fn parse(words: &[&str]) -> std::result::Result<DiffArgs, clap::Error> {
    crate::common::parse(&words.join(" "))
}

fn report(args: &DiffArgs, changed: f32) -> DiffReport<'_> {
    let a = Film::new(2, 2).unwrap();
    let mut b = a.clone();
    b.pixels_mut()[2][1] = changed;
    let beyond = pixels_beyond(&a, &b, args.limits.tolerance()).unwrap();
    DiffReport::new(args, compare(&a, &b).unwrap(), beyond, &perceived(args, &a, &b).unwrap())
}

/// Of texts after the first, lines that are others.
#[test]
fn reports_say_what_differs_and_which_limits_decide() {
    let mut usual = String::new();
    approved::compare("src/diff/reports.txt", |line| {
        let (words, changed) = line.rsplit_once(", ").unwrap();
        let args = crate::common::parse(words).unwrap();
        let report = report(&args, changed.parse().unwrap());
        let text = report.text();
        let others = text.lines().filter(|line| !usual.lines().any(|usual| usual == *line));
        let verdict = if report.is_within_limits() { "passes" } else { "fails" };
        let found = others.chain([verdict]).collect::<Vec<_>>().join("\n");
        if usual.is_empty() {
            usual = text;
        }
        found
    });
}

#[test]
fn json_names_the_files_and_the_verdict() {
    let args = parse(&["a.ppm", "b.ppm", "--json"]).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(&to_json(&report(&args, 0.5)).unwrap()).unwrap();
    assert_eq!(json["a"], "a.ppm");
    assert_eq!(json["largest"], 0.5);
    assert_eq!(json["largest_at"], serde_json::json!([0, 1]));
    assert_eq!(json["largest_channel"], "green");
    assert_eq!(json["within_tolerance"], false);
    assert_eq!(json["pixels_beyond_tolerance"], 1);
    let limit = serde_json::json!({"of": "largest difference", "found": 0.5, "limit": 0.0, "within": false});
    assert_eq!(json["limits"], serde_json::json!([limit]));
    assert_eq!(json["channel_bias"], serde_json::json!([0.0, -0.125, 0.0]));
    assert_eq!(json["flip_pixels_per_degree"], DEFAULT_PIXELS_PER_DEGREE);
    let keys: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(
        keys.join(" "),
        "a b width height mse rmse psnr relative_mse bias channel_bias largest largest_at largest_channel \
         different_pixels nonfinite equal flip flip_pixels_per_degree tolerance within_tolerance \
         pixels_beyond_tolerance limits"
    );
}

#[test]
fn flip_asks_for_light() {
    let args = |transfer| parse(&["a", "b", "--transfer", transfer]).unwrap();
    let (linear, srgb) = (args("linear"), args("srgb"));
    // The curve has its say between the ends of the scale, and none at them.
    assert_ne!(report(&linear, 0.5).flip, report(&srgb, 0.5).flip);
    assert_eq!(report(&linear, 1.0).flip, report(&srgb, 1.0).flip);
    assert_eq!(report(&srgb, 0.5).flip, report(&linear, srgb_decode(0.5)).flip);
    assert_eq!(report(&srgb, 0.5).comparison, report(&linear, 0.5).comparison);
}

#[test]
fn pixels_per_degree_are_those_asked_for() {
    let args = |pixels| parse(&["a", "b", "--pixels-per-degree", pixels]).unwrap();
    let (few, many) = (args("10"), args("200"));
    let (few, many) = (report(&few, 0.5), report(&many, 0.5));
    assert_eq!((few.flip_pixels_per_degree, many.flip_pixels_per_degree), (10.0, 200.0));
    // As flip-evaluator 1.7 has it.
    assert!((few.flip - 0.398_067).abs() < 1e-4, "{}", few.flip);
    assert!((many.flip - 0.959_176).abs() < 1e-4, "{}", many.flip);
    let film = Film::new(1, 1).unwrap();
    assert!(perceived(&args("0.5"), &film, &film).is_err());
}

#[test]
fn a_map_needs_an_output() {
    assert!(parse(&["a", "b", "--map", "flip"]).is_err());
    let parsed = parse(&["a", "b", "-o", "c.png", "--map", "signed"]).unwrap();
    assert_eq!(parsed.map, MapKind::Signed);
    assert_eq!(parse(&["a", "b", "-o", "c.png"]).unwrap().map, MapKind::Absolute);
}

#[test]
fn numbers_must_not_be_negative_or_infinite() {
    for bad in ["-1", "inf", "nan", "x"] {
        assert!(parse(&["a", "b", &format!("--tolerance={bad}")]).is_err(), "{bad}");
    }
    assert!(parse(&["a", "b", "--gain", "2"]).is_err(), "gain without output");
    assert_eq!(parse(&["a", "b", "-o", "c.png", "--gain", "2"]).unwrap().gain, 2.0);
}

#[test]
fn pixels_are_a_number_or_a_share() {
    assert_eq!("20".parse(), Ok(Pixels::Count(20)));
    assert_eq!("0.5%".parse(), Ok(Pixels::Share(0.005)));
    for bad in ["-1", "0.5", "101%", "nan%", "%", "x"] {
        assert!(bad.parse::<Pixels>().is_err(), "{bad}");
    }
}
