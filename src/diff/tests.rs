use super::*;
use wavecrest_image::compare::pixels_beyond;
use wavecrest_image::error_map::error_map;

fn parse(words: &[&str]) -> std::result::Result<DiffArgs, clap::Error> {
    crate::common::parse(&words.join(" "))
}

fn report(args: &DiffArgs, changed: f32) -> Report<'_> {
    let a = Film::new(2, 2).unwrap();
    let mut b = a.clone();
    b.pixels_mut()[2][1] = changed;
    let beyond = pixels_beyond(&a, &b, args.limits.tolerance()).unwrap();
    Report::new(args, compare(&a, &b).unwrap(), beyond, &perceived(args, &a, &b).unwrap())
}

#[test]
fn a_difference_is_described_in_words() {
    let args = parse(&["a.ppm", "b.ppm"]).unwrap();
    assert_eq!(
        report(&args, 0.5).text(),
        "size                2 x 2\n\
         MSE                 0.020833\n\
         RMSE                0.144338\n\
         PSNR                16.81 dB\n\
         relative MSE        0.080128\n\
         bias                -0.041667, red 0, green -0.125000, blue 0\n\
         FLIP                0.908767 at 67.02 pixels per degree\n\
         largest difference  0.500000, green at column 0, row 1\n\
         different pixels    1 of 4 (25.000 %)\n\
         result              different: largest difference 0.500000 is above 0\n"
    );
}

#[test]
fn equality_and_values_that_are_not_finite_are_described_in_words() {
    let args = parse(&["a.ppm", "b.ppm", "--tolerance", "0.5"]).unwrap();
    let last = |changed| report(&args, changed).text().lines().last().unwrap().to_owned();
    assert_eq!(last(0.0), "result              equal in every bit");
    assert_eq!(
        last(0.5),
        "result              equal within limits: largest difference 0.500000 is not above 0.500000"
    );
    assert_eq!(
        last(0.6),
        "result              different: largest difference 0.600000 is above 0.500000"
    );
    assert!(report(&args, 0.0).text().contains("infinite (no difference)\n"));
    let text = report(&args, f32::NAN).text();
    assert!(text.contains("none (infinite difference)\n"), "{text}");
    assert!(text.contains("pixels not finite   1 of 4 (25.000 %)\n"), "{text}");
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
fn two_files_are_compared_and_the_difference_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let a = Film::new(3, 2).unwrap();
    let mut b = a.clone();
    b.pixels_mut()[4] = [0.25, 0.0, 0.0];
    write(&a, &at("a.exr"), Transfer::Linear).unwrap();
    write(&b, &at("b.pfm"), Transfer::Linear).unwrap();
    let mut args = parse(&["a", "b", "-o", "d", "--gain", "2"]).unwrap();
    (args.a, args.b, args.output) = (at("a.exr"), at("b.pfm"), Some(at("d.pfm")));
    assert!(!run(&args).unwrap());
    assert_eq!(read(&at("d.pfm")).unwrap().pixels()[4], [0.5, 0.0, 0.0]);
    for kind in &MapKind::ALL {
        args.map = *kind;
        assert!(!run(&args).unwrap());
        let found = read(&at("d.pfm")).unwrap();
        assert!(found.same_bits(&error_map(&a, &b, *kind, 2.0).unwrap()), "{kind:?}");
    }
    args.limits.tolerance = Some(0.25);
    args.json = true;
    assert!(run(&args).unwrap());
}

#[test]
fn sizes_that_differ_are_an_error_that_names_the_second_file() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a.ppm"), folder.path().join("b.ppm"));
    write(&Film::new(1, 2).unwrap(), &a, Transfer::Linear).unwrap();
    write(&Film::new(2, 2).unwrap(), &b, Transfer::Linear).unwrap();
    let mut args = parse(&["a", "b"]).unwrap();
    (args.a, args.b) = (a, b);
    assert_eq!(
        run(&args).unwrap_err().to_string(),
        format!(
            "{}: the images differ in size, found 1 x 2 and 2 x 2; \
             render both at one size",
            args.b.display()
        )
    );
}

/// One pixel of four differs, by 0.5: RMSE 0.144, FLIP 0.909.
#[test]
fn pictures_pass_where_every_limit_holds() {
    let passes = |limits: &str| {
        let words: Vec<&str> = ["a", "b"].into_iter().chain(limits.split_whitespace()).collect();
        report(&parse(&words).unwrap(), 0.5).is_within_limits()
    };
    for (limits, expected) in [
        ("", false),
        ("--max-rmse 0.15", true),
        ("--max-rmse 0.14", false),
        ("--max-flip 0.91", true),
        ("--max-flip 0.9", false),
        ("--max-pixels 1", true),
        ("--max-pixels 0", false),
        ("--max-pixels 25%", true),
        ("--max-pixels 24.9%", false),
        ("--max-pixels 0 --tolerance 0.5", true),
        ("--max-pixels 0 --tolerance 0.4", false),
        ("--max-rmse 0.15 --tolerance 0.4", false),
        ("--max-rmse 0.15 --max-flip 0.9 --max-pixels 1", false),
        ("--max-rmse 0.15 --max-flip 0.91 --max-pixels 1", true),
    ] {
        assert_eq!(passes(limits), expected, "{limits}");
    }
    let args = parse(&["a", "b", "--max-rmse", "9", "--max-flip", "1"]).unwrap();
    assert!(!report(&args, f32::NAN).is_within_limits(), "what is not finite differs by infinity");
}

#[test]
fn the_verdict_names_the_limits_that_decide() {
    let args =
        parse(&["a", "b", "--max-rmse", "0.1", "--max-flip", "1", "--max-pixels", "0"]).unwrap();
    let text = report(&args, 0.5).text();
    let expected = "result              different: RMSE 0.144338 is above 0.100000, \
                    the number of different pixels 1 is above 0\n";
    assert!(text.ends_with(expected), "{text}");
}

#[test]
fn pixels_are_a_number_or_a_share() {
    assert_eq!("20".parse(), Ok(Pixels::Count(20)));
    assert_eq!("0.5%".parse(), Ok(Pixels::Share(0.005)));
    for bad in ["-1", "0.5", "101%", "nan%", "%", "x"] {
        assert!(bad.parse::<Pixels>().is_err(), "{bad}");
    }
}
