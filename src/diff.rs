//! `diff`: by how much two pictures differ.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::common::print;
use crate::choice::choice;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::check_differs;
use wavecrest_core::film::Film;
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_image::compare::{Channel, Comparison, compare};
use wavecrest_image::error_map::{MapKind, error_map, flip_map};
use wavecrest_image::flip::{DEFAULT_PIXELS_PER_DEGREE, Flip, flip};
use wavecrest_image::read::read;
use wavecrest_image::write::{Transfer, check_writable, write};

/// Compares a picture with a reference and reports how much they differ.
///
/// PPM, PNG, EXR, PFM and most other formats are read; whole numbers count as 0 to 1, without a
/// transfer curve. With A the first picture and B the second, the reference: MSE is the mean of (A -
/// B)^2, relative MSE that of (A - B)^2 / (B^2 + 0.01), the bias that of A - B, positive where A is
/// brighter. FLIP is the mean difference that is seen, from 0 to 1, by one who looks at both in turn.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct DiffArgs {
    /// The first picture
    pub(crate) a: PathBuf,
    /// The second picture, of the same size: the reference
    pub(crate) b: PathBuf,
    /// The largest difference of two values at which the pictures still count as equal
    #[arg(long, value_name = "MAX", default_value = "0", value_parser = not_negative)]
    pub(crate) tolerance: f64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write a picture of the difference (.ppm, .png, .exr or .pfm)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// What that picture shows: all but the first in false colours
    #[arg(long, value_name = "KIND", value_parser = choice::<MapKind>(), default_value_t, requires = "output")]
    pub(crate) map: MapKind,
    /// Multiply the difference in the picture by this, to see small ones
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = not_negative,
          requires = "output")]
    pub(crate) gain: f64,
    /// For FLIP, how many pixels lie within a degree of the viewer's field of view; the default is a
    /// display 0.7 m wide with 3840 pixels in a row, 0.7 m away
    #[arg(long, value_name = "PIXELS", default_value_t = DEFAULT_PIXELS_PER_DEGREE)]
    pub(crate) pixels_per_degree: f64,
    /// The curve that the values of both pictures carry, which FLIP undoes
    #[arg(long, value_name = "CURVE", value_parser = choice::<Transfer>(), default_value_t)]
    pub(crate) transfer: Transfer,
}

/// Compares the two pictures, prints what was found, and returns whether they count as equal: no
/// two values differ by more than the tolerance.
///
/// # Errors
/// When a picture cannot be read, their sizes differ, or the difference cannot be written.
pub(crate) fn run(args: &DiffArgs) -> Result<bool> {
    if let Some(output) = &args.output {
        check_writable(output)?;
        check_differs(output, &args.a, "one of the pictures")?;
        check_differs(output, &args.b, "one of the pictures")?;
    }
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    let comparison = compare(&a, &b).map_err(|e| e.in_file(&args.b))?;
    let seen = seen(args, &a, &b)?;
    let report = Report::new(args, comparison, &seen);
    if let Some(output) = &args.output {
        let gain = args.gain as f32;
        let map = match args.map {
            MapKind::Flip => flip_map(&seen, gain)?,
            kind => error_map(&a, &b, kind, gain)?,
        };
        write(&map, output, Transfer::Linear)?;
    }
    print(&if args.json { report.json()? } else { report.text() })?;
    Ok(report.within_tolerance)
}

/// The difference that is seen.
fn seen(args: &DiffArgs, a: &Film, b: &Film) -> Result<Flip> {
    match args.transfer {
        Transfer::Linear => flip(a, b, args.pixels_per_degree),
        Transfer::Srgb => flip(&decoded(a), &decoded(b), args.pixels_per_degree),
    }
}

fn decoded(film: &Film) -> Film {
    let mut film = film.clone();
    let values = film.pixels_mut().as_flattened_mut().iter_mut();
    values.for_each(|value| *value = srgb_decode(*value));
    film
}

/// What is printed. The keys of the JSON are the names here.
#[derive(Serialize)]
struct Report<'a> {
    a: &'a Path,
    b: &'a Path,
    #[serde(flatten)]
    comparison: Comparison,
    /// The mean of FLIP.
    flip: f64,
    flip_pixels_per_degree: f64,
    tolerance: f64,
    within_tolerance: bool,
}

impl<'a> Report<'a> {
    fn new(args: &'a DiffArgs, comparison: Comparison, seen: &Flip) -> Self {
        let within_tolerance = comparison.largest <= args.tolerance;
        Self {
            a: &args.a,
            b: &args.b,
            comparison,
            flip: seen.mean,
            flip_pixels_per_degree: seen.pixels_per_degree,
            tolerance: args.tolerance,
            within_tolerance,
        }
    }

    fn json(&self) -> Result<String> {
        serde_json::to_string_pretty(self).map(|text| text + "\n").map_err(|error| {
            // A path that is not Unicode is all that can fail.
            Error::new(ErrorKind::Usage, format!("cannot write the result as JSON: {error}"))
                .remedy("leave out --json")
        })
    }

    fn text(&self) -> String {
        let found = &self.comparison;
        let size = format!("{} x {}", found.width, found.height);
        let mut text = String::new();
        line(&mut text, "size", &size);
        line(&mut text, "MSE", &number(found.mse));
        line(&mut text, "RMSE", &number(found.rmse));
        line(&mut text, "PSNR", &decibels(found.psnr));
        line(&mut text, "relative MSE", &number(found.relative_mse));
        line(&mut text, "bias", &self.bias());
        line(&mut text, "FLIP", &self.flip());
        line(&mut text, "largest difference", &self.largest());
        line(&mut text, "different pixels", &share(found, found.different_pixels));
        if found.nonfinite > 0 {
            line(&mut text, "pixels not finite", &share(found, found.nonfinite));
        }
        line(&mut text, "result", &self.verdict());
        text
    }

    fn bias(&self) -> String {
        let found = &self.comparison;
        let mut text = number(found.bias);
        for (channel, &bias) in Channel::ALL.into_iter().zip(&found.channel_bias) {
            let _ = write!(text, ", {} {}", channel.name(), number(bias));
        }
        text
    }

    fn flip(&self) -> String {
        format!("{} at {:.2} pixels per degree", number(self.flip), self.flip_pixels_per_degree)
    }

    fn largest(&self) -> String {
        let found = &self.comparison;
        let mut text = number(found.largest);
        if let (Some((x, y)), Some(channel)) = (found.largest_at, found.largest_channel) {
            let _ = write!(text, ", {} at column {x}, row {y}", channel.name());
        }
        text
    }

    fn verdict(&self) -> String {
        match (self.within_tolerance, self.comparison.equal) {
            (true, true) => "equal in every bit".into(),
            (true, false) => format!("equal within {}", self.tolerance),
            (false, _) => format!("different by more than {}", self.tolerance),
        }
    }
}

fn line(text: &mut String, name: &str, value: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{name:<20}{value}");
}

/// Six digits, with an exponent where the number is small.
fn number(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if value.is_nan() {
        "unknown".into()
    } else if value.is_infinite() {
        if value > 0.0 { "infinite".into() } else { "-infinite".into() }
    } else if (1e-3..1e6).contains(&value.abs()) {
        format!("{value:.6}")
    } else {
        format!("{value:.5e}")
    }
}

fn decibels(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.2} dB")
    } else if value > 0.0 {
        "infinite (no difference)".into()
    } else {
        "none (infinite difference)".into()
    }
}

fn share(found: &Comparison, pixels: u64) -> String {
    let all = u64::from(found.width) * u64::from(found.height);
    format!("{pixels} of {all} ({:.3} %)", 100.0 * pixels as f64 / all as f64)
}

fn not_negative(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("use a number of 0 or more, such as 0.001".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavecrest_core::film::Film;

    fn parse(words: &[&str]) -> std::result::Result<DiffArgs, clap::Error> {
        crate::common::parse(&words.join(" "))
    }

    fn report(args: &DiffArgs, changed: f32) -> Report<'_> {
        let a = Film::new(2, 2).unwrap();
        let mut b = a.clone();
        b.pixels_mut()[2][1] = changed;
        Report::new(args, compare(&a, &b).unwrap(), &seen(args, &a, &b).unwrap())
    }

    #[test]
    fn a_difference_is_told_in_words() {
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
             result              different by more than 0\n"
        );
    }

    #[test]
    fn equality_and_what_is_not_finite_are_told_in_words() {
        let args = parse(&["a.ppm", "b.ppm", "--tolerance", "0.5"]).unwrap();
        let last = |changed| report(&args, changed).text().lines().last().unwrap().to_owned();
        assert_eq!(last(0.0), "result              equal in every bit");
        assert_eq!(last(0.5), "result              equal within 0.5");
        assert_eq!(last(0.6), "result              different by more than 0.5");
        assert!(report(&args, 0.0).text().contains("infinite (no difference)\n"));
        let text = report(&args, f32::NAN).text();
        assert!(text.contains("none (infinite difference)\n"), "{text}");
        assert!(text.contains("pixels not finite   1 of 4 (25.000 %)\n"), "{text}");
    }

    #[test]
    fn json_names_the_files_and_the_verdict() {
        let args = parse(&["a.ppm", "b.ppm", "--json"]).unwrap();
        let json: serde_json::Value =
            serde_json::from_str(&report(&args, 0.5).json().unwrap()).unwrap();
        assert_eq!(json["a"], "a.ppm");
        assert_eq!(json["largest"], 0.5);
        assert_eq!(json["largest_at"], serde_json::json!([0, 1]));
        assert_eq!(json["largest_channel"], "green");
        assert_eq!(json["within_tolerance"], false);
        assert_eq!(json["channel_bias"], serde_json::json!([0.0, -0.125, 0.0]));
        assert_eq!(json["flip_pixels_per_degree"], DEFAULT_PIXELS_PER_DEGREE);
        let keys: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(
            keys.join(" "),
            "a b width height mse rmse psnr relative_mse bias channel_bias largest largest_at largest_channel \
             different_pixels nonfinite equal flip flip_pixels_per_degree tolerance within_tolerance"
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
        assert!(seen(&args("0.5"), &film, &film).is_err());
    }

    #[test]
    fn a_map_needs_a_picture_to_be() {
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
        args.tolerance = 0.25;
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
                "{}: two images must have the same size to be compared, found 1 x 2 and 2 x 2; \
                 render both at one size",
                args.b.display()
            )
        );
    }
}
