//! What is read of files in many formats, and what is said of those that are none.

use std::fs::File;
use std::io::{Seek as _, Write as _};
use std::path::Path;

use image::{DynamicImage, ImageFormat};
use wavecrest_base::error::{Error, Result};
use wavecrest_core::film::Film;
use wavecrest_image::read::read;
use wavecrest_image::write::{Format, Transfer, write};

use crate::support::folder;

pub(super) fn read_bytes(name: &str, bytes: &[u8]) -> Result<Film> {
    read_made(name, |path| std::fs::write(path, bytes).expect("a file"))
}

fn read_image(name: &str, image: &DynamicImage, format: ImageFormat) -> Film {
    let made = read_made(name, |path| image.save_with_format(path, format).expect("a file"));
    made.expect("an image")
}

pub(super) fn read_made(name: &str, make: impl FnOnce(&Path)) -> Result<Film> {
    let folder = folder();
    let path = folder.path().join(name);
    make(&path);
    let strip = folder.path().display().to_string() + "/";
    read(&path).map_err(|e| {
        let text = e.to_string().replace(&strip, "");
        Error::new(e.kind(), text)
    })
}

#[test]
fn numbers_of_8_and_16_bits_become_0_to_1() {
    let narrow =
        DynamicImage::ImageRgb8(image::RgbImage::from_raw(1, 1, vec![0, 51, 255]).unwrap());
    let wide = image::ImageBuffer::from_raw(1, 1, vec![0u16, 13107, 65535]).unwrap();
    let wide = DynamicImage::ImageRgb16(wide);
    for (image, format) in [
        (&narrow, ImageFormat::Png),
        (&wide, ImageFormat::Png),
        (&narrow, ImageFormat::Bmp),
        (&narrow, ImageFormat::Tiff),
        (&wide, ImageFormat::Tiff),
        (&narrow, ImageFormat::Qoi),
    ] {
        // The content decides, not the name.
        let film = read_image("a.jpg", image, format);
        assert_eq!(film.pixels(), [[0.0, 0.2, 1.0]], "{format:?}");
    }
    let tga = read_image("a.tga", &narrow, ImageFormat::Tga);
    assert_eq!(tga.pixels(), [[0.0, 0.2, 1.0]]);
}

#[test]
fn grey_is_spread_and_alpha_left_out() {
    let grey = DynamicImage::ImageLuma8(image::GrayImage::from_raw(1, 1, vec![51]).unwrap());
    let both = image::GrayAlphaImage::from_raw(1, 1, vec![51, 0]).unwrap();
    let rgba = image::RgbaImage::from_raw(1, 1, vec![51, 102, 255, 3]).unwrap();
    let pixel = |image| read_image("a.png", &image, ImageFormat::Png).pixels()[0];
    assert_eq!(pixel(grey), [0.2; 3]);
    assert_eq!(pixel(DynamicImage::ImageLumaA8(both)), [0.2; 3]);
    assert_eq!(pixel(DynamicImage::ImageRgba8(rgba)), [0.2, 0.4, 1.0]);
}

#[test]
fn files_that_are_no_images_have_their_messages() {
    let text = |name, bytes: &[u8]| read_bytes(name, bytes).unwrap_err().to_string();
    assert_eq!(text("a.png", b""), "a.png: the file is empty; name an image");
    assert_eq!(
        text("a.txt", b"hello there, world"),
        "a.txt: cannot read the image: The image format could not be determined; \
         use PNG, EXR or another common format"
    );
    assert_eq!(
        text("a.pfm", b"PF\n2 2\n-1\n1234"),
        "a.pfm: an image of 2 x 2 pixels needs 48 bytes after its header, found 4; \
         the file may be cut off"
    );
    assert!(text("a.png", b"\x89PNG\r\n\x1a\nrubbish").starts_with("a.png: cannot read"));
}

#[test]
fn files_that_cannot_be_opened_have_their_messages() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let text = read(&path).unwrap_err().to_string();
    assert_eq!(
        text,
        format!("{}: cannot read the image: there is no such file; check the path", path.display())
    );
    assert_eq!(
        read(folder.path()).unwrap_err().to_string(),
        format!("{}: cannot read the image: it is a folder; name a file", folder.path().display())
    );
}

#[test]
fn a_header_that_asks_for_too_much_is_refused() {
    // A QOI file begins with a magic number, two sizes, channels and colour space, all easy to
    // forge.
    let qoi = |width: u32, height: u32| {
        let mut bytes = b"qoif".to_vec();
        bytes.extend(width.to_be_bytes());
        bytes.extend(height.to_be_bytes());
        bytes.extend([3, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
        read_bytes("a.qoi", &bytes).unwrap_err().to_string()
    };
    assert_eq!(
        qoi(16_384, 16_384),
        "a.qoi: the image has more pixels than its file can hold, found 16384 x 16384 in \
         22 bytes; check that the file is whole"
    );
}

#[test]
fn damaged_files_never_panic() {
    let folder = folder();
    let damaged = folder.path().join("it");
    let mut file = File::create(&damaged).unwrap();
    // One file throughout: that many new ones would take seconds.
    let mut decode_quietly = |bytes: &[u8]| {
        file.set_len(bytes.len() as u64).and_then(|()| file.rewind()).unwrap();
        file.write_all(bytes).unwrap();
        let told = read(&damaged).map_or_else(|error| error.to_string(), |_| String::new());
        assert!(!told.contains("the decoder failed"), "{told}");
    };
    let film = Film::from_pixels(9, 7, (0..63).map(|i| [i as f32 / 63.0; 3]).collect()).unwrap();
    let written = Format::ALL.map(|format| {
        let path = folder.path().join(format!("a.{}", format.name()));
        write(&film, &path, Transfer::Linear).unwrap();
        std::fs::read(&path).unwrap()
    });
    let radiance = b"#?RGBE\nEXPOSURE=2\n\n-Y 1 +X 2\n\x01\x02\x03\x80\x01\x02\x03\x80".to_vec();
    for whole in written.into_iter().chain([radiance]) {
        for cut in (0..whole.len()).step_by(whole.len() / 40 + 1) {
            decode_quietly(&whole[..cut]);
        }
        for place in 0..whole.len().min(600) {
            let mut bytes = whole.clone();
            for value in [0, 0x7f, 0xff, bytes[place] ^ 1] {
                bytes[place] = value;
                decode_quietly(&bytes);
            }
        }
    }
}
