use super::super::read::read;
use super::*;

fn film() -> Film {
    let pixel = |i: u32| [i as f32 / 37.0, 1.5 - i as f32 / 10.0, f32::from_bits(i << 20)];
    Film::from_pixels(7, 5, (0..35).map(pixel).collect()).unwrap()
}

fn eight_bit(film: &Film, transfer: Transfer) -> Vec<u8> {
    film.rows().flat_map(|row| row_to_bytes(row, transfer)).collect()
}

fn written(name: &str, film: &Film, transfer: Transfer) -> Film {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    check_writable(&path).unwrap();
    write(film, &path, transfer).unwrap();
    read(&path).unwrap()
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
fn what_is_said_of_an_image_changes_no_pixel() {
    let folder = tempfile::tempdir().unwrap();
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
    let mut device = std::fs::File::options().write(true).open("/dev/full").unwrap();
    for format in Format::ALL {
        let mut sink: Sink<'_> = std::io::BufWriter::new(&mut device);
        let film = Film::new(64, 64).unwrap();
        let extras = Extras::default();
        let text = match encode(&mut sink, &film, format, Transfer::Linear, &extras) {
            Err(error) => encode_error(Path::new("a"), error).to_string(),
            // A small file may stay in the buffer until the flush.
            Ok(()) => write_error(Path::new("a"), sink.flush().unwrap_err()).to_string(),
        };
        assert!(text.ends_with("; free some space or write to another disk"), "{text}");
        let _ = sink.into_parts();
    }
}
