//! EXR and Radiance files as other programs write them.

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, SmallVec, WritableImage as _,
};
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;

use super::read::{read_bytes, read_made};

/// A part of 2 x 1 pixels whose channels hold a number and then its double.
fn part(name: &str, channels: &[(&str, f32)]) -> Layer<AnyChannels<FlatSamples>> {
    let channel = |&(name, value): &(&str, f32)| {
        AnyChannel::new(name, FlatSamples::F32(vec![value, 2.0 * value]))
    };
    let channels: SmallVec<_> = channels.iter().map(channel).collect();
    let attributes = LayerAttributes::named(name);
    Layer::new((2, 1), attributes, Encoding::UNCOMPRESSED, AnyChannels::sort(channels))
}

fn read_parts(parts: &[&[(&str, f32)]]) -> Result<Film> {
    let layers: SmallVec<_> =
        (0..).zip(parts).map(|(i, all)| part(&format!("p{i}"), all)).collect();
    let window = IntegerBounds::from_dimensions((2, 1));
    let image = Image::from_layers(ImageAttributes::new(window), layers);
    read_made("a.exr", |path| image.write().to_file(path).expect("a file"))
}

fn told(result: Result<Film>) -> String {
    result.map_or_else(|error| error.to_string(), |film| format!("{:?}", film.pixels()))
}

#[test]
fn colours_of_an_exr_file_are_found_by_their_names() {
    for (parts, right) in [
        (&[&[("Y", 0.5)][..]][..], [0.5; 3]),
        (&[&[("b", 1.0), ("g", 0.5), ("r", 0.25)]], [0.25, 0.5, 1.0]),
        // A layer of colours among others, with one beside that has coordinates.
        (
            &[&[
                ("diffuse.B", 1.0),
                ("diffuse.G", 0.5),
                ("diffuse.R", 0.25),
                ("N.X", 7.0),
                ("N.Y", 8.0),
                ("Z", 9.0),
            ]],
            [0.25, 0.5, 1.0],
        ),
        // The colours of the file come before those of a layer.
        (
            &[&[("R", 0.25), ("G", 0.5), ("B", 1.0), ("a.R", 7.0), ("a.G", 8.0), ("a.B", 9.0)]],
            [0.25, 0.5, 1.0],
        ),
        // The first part with any.
        (&[&[("Z", 3.0)], &[("R", 0.25), ("G", 0.5), ("B", 1.0)], &[("Y", 6.0)]], [0.25, 0.5, 1.0]),
    ] {
        let film = read_parts(parts).expect("an image");
        assert_eq!(film.pixels(), [right, right.map(|value| 2.0 * value)], "{parts:?}");
    }
}

#[test]
fn an_exr_file_without_colours_or_with_many_is_refused() {
    assert_eq!(
        told(read_parts(&[&[("Z", 1.0), ("N.X", 1.0), ("N.Y", 1.0)], &[("id", 1.0)]])),
        "a.exr: cannot read the image: it has no channels of colour; save it with the channels \
         R, G and B, or Y"
    );
    assert_eq!(
        told(read_parts(&[&[("a.Y", 1.0), ("b.Y", 1.0)]])),
        "a.exr: cannot read the image: it has several layers of colours, such as a and b; save \
         the one that you want as R, G and B"
    );
}

#[test]
fn a_compression_that_cannot_be_read_is_told_with_the_command_that_changes_it() {
    let image = Image::from_layer(part("", &[("R", 0.0), ("G", 0.0), ("B", 0.0)]));
    let made = read_made("a.exr", |path| {
        image.write().to_file(path).expect("a file");
        let mut bytes = std::fs::read(path).expect("a file");
        let name = b"compression\0compression\0";
        let place = bytes.windows(name.len()).position(|all| all == name).expect("its place");
        // After the name and its length, the number of DWAA.
        bytes[place + name.len() + 4] = 8;
        std::fs::write(path, bytes).expect("a file");
    });
    assert_eq!(
        told(made),
        "a.exr: cannot read the image: dwaa compression cannot be read; save it with a value for \
         each pixel: oiiotool IN --compression zip -o OUT"
    );
}

#[test]
fn a_radiance_file_is_read_whatever_wrote_its_header() {
    let read = |head: &str| read_bytes("a.hdr", &[head.as_bytes(), &[128, 64, 32, 129]].concat());
    for (head, right) in [
        ("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n", [1.0, 0.5, 0.25]),
        ("#?RGBE\n# made\nGAMMA=1\n\n-Y 1 +X 1\n", [1.0, 0.5, 0.25]),
        ("#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n", [1.0, 0.5, 0.25]),
        // Those of the file itself, and not of one that it was made of.
        ("#?RADIANCE\n\tEXPOSURE=9\nEXPOSURE=4\nEXPOSURE= 0.5\n\n-Y 1 +X 1\n", [0.5, 0.25, 0.125]),
        ("#?RADIANCE\nCOLORCORR=1 2 4\n\n-Y 1 +X 1\n", [1.0, 0.25, 0.0625]),
    ] {
        assert_eq!(read(head).expect(head).pixels(), [right], "{head}");
    }
    let start = "a.hdr: cannot read the image: ";
    for (head, right) in [
        (
            "#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n",
            "EXPOSURE of its header is \"0\"; EXPOSURE is one number above 0, COLORCORR three",
        ),
        (
            "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n",
            "its format \"32-bit_rle_xyze\" is unknown; use: ra_xyze -r IN OUT",
        ),
        (
            "#?RADIANCE\n\n+Y 1 +X 1\n",
            "its rows are in the unusual order \"+Y 1 +X 1\"; save it with the top row first",
        ),
        ("#?RADIANCE\nGAMMA=1", "its header has no end; check that the file is whole"),
    ] {
        assert_eq!(told(read(head)), format!("{start}{right}"));
    }
}
