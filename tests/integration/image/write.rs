//! What is written is what is read.

use wavecrest_core::film::Film;
use wavecrest_image::metadata::{Entry, Extras};
use wavecrest_image::read::read;
use wavecrest_image::write::{Format, Transfer, check_writable, row_to_bytes, write, write_with};

use crate::support::folder;

pub(super) fn film() -> Film {
    let pixel = |i: u32| [i as f32 / 37.0, 1.5 - i as f32 / 10.0, f32::from_bits(i << 20)];
    Film::from_pixels(7, 5, (0..35).map(pixel).collect()).expect("a film")
}

fn eight_bit(film: &Film, transfer: Transfer) -> Vec<u8> {
    film.rows().flat_map(|row| row_to_bytes(row, transfer)).collect()
}

fn written(name: &str, film: &Film, transfer: Transfer) -> Film {
    let folder = folder();
    let path = folder.path().join(name);
    check_writable(&path).expect("a folder that takes files");
    write(film, &path, transfer).expect("a file");
    read(&path).expect("an image")
}

#[test]
fn float_formats_keep_every_bit_whatever_the_transfer() {
    let mut film = film();
    film.pixels_mut()[3] = [f32::INFINITY, f32::from_bits(0x7fc0_1234), -0.0];
    for name in ["a.exr", "a.pfm", "a.PFM"] {
        assert!(written(name, &film, Transfer::Srgb).same_bits(&film), "{name}");
    }
}

#[test]
fn eight_bit_formats_keep_the_levels() {
    for transfer in [Transfer::Linear, Transfer::Srgb] {
        for name in ["a.ppm", "a.png"] {
            let back = written(name, &film(), transfer);
            assert_eq!((back.width(), back.height()), (7, 5));
            let levels = eight_bit(&back, Transfer::Linear);
            assert_eq!(levels, eight_bit(&film(), transfer), "{name}");
        }
    }
}

#[test]
fn a_jpeg_is_near_the_levels() {
    let pixel = |i: u32| [(i / 8) as f32 / 8.0, 0.5, 0.2];
    let film = Film::from_pixels(8, 8, (0..64).map(pixel).collect()).expect("a film");
    for name in ["a.jpg", "a.jpeg", "a.JPG"] {
        let back = written(name, &film, Transfer::Srgb);
        let (found, right) = (eight_bit(&back, Transfer::Linear), eight_bit(&film, Transfer::Srgb));
        let far = found.iter().zip(&right).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(far < Some(12), "{far:?}");
        assert!(Format::from_path(name.as_ref()).is_ok_and(|format| format == Format::Jpg));
    }
}

#[test]
fn what_is_said_of_an_image_changes_no_pixel() {
    let folder = folder();
    let entry = |name, text: &str| Entry { name, text: text.to_owned() };
    let entries = [entry("software", "w 1"), entry("seed", "7"), entry("command", "ж\nb")];
    let extras = Extras { entries: &entries, comments: true, ..Extras::default() };
    for format in Format::ALL {
        let path = folder.path().join(format!("a.{}", format.name()));
        write_with(&film(), &path, Transfer::Linear, &extras).unwrap();
        let found = read(&path).unwrap();
        write(&film(), &path, Transfer::Linear).unwrap();
        assert!(found.same_bits(&read(&path).unwrap()), "{format:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported_in_every_format() {
    use std::{io::Write as _, path::Path};
    use wavecrest_base::replace::{Sink, write_error};
    use wavecrest_image::write::write_to;

    let mut device = std::fs::File::options().write(true).open("/dev/full").unwrap();
    for format in Format::ALL {
        let mut sink: Sink<'_> = std::io::BufWriter::new(&mut device);
        let film = Film::new(64, 64).unwrap();
        let extras = Extras::default();
        let path = Path::new("a");
        let text = match write_to(&mut sink, path, &film, format, Transfer::Linear, &extras) {
            Err(error) => error.to_string(),
            // A small file may stay in the buffer until the flush.
            Ok(()) => write_error(path, sink.flush().unwrap_err()).to_string(),
        };
        assert!(text.ends_with("; free some space or write to another disk"), "{text}");
        let _ = sink.into_parts();
    }
}
