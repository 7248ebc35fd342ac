//! Animations, read by the decoders of the crate `image`.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use image::AnimationDecoder;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_image::animation::{Animated, Animation};
use wavecrest_image::write::Transfer;

use crate::support::folder;

fn frame(number: u32) -> Result<Film> {
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Film::from_pixels(3, 2, vec![colors[number as usize]; 6])
}

fn animation(path: &Path) -> Animation<'_> {
    let format = Animated::from_path(path).expect("a format");
    let (size, frames, transfer) = ([3, 2], 3, Transfer::Linear);
    Animation { path, format, size, frames, transfer, entries: &[] }
}

#[test]
fn every_frame_is_in_the_file() {
    let folder = folder();
    let path = folder.path().join("a.gif");
    animation(&path).write(frame).unwrap();
    let decoder = image::codecs::gif::GifDecoder::new(BufReader::new(File::open(&path).unwrap()));
    let gif = decoder.unwrap().into_frames().collect_frames().unwrap();
    let path = folder.path().join("a.png");
    animation(&path).write(frame).unwrap();
    let decoder = image::codecs::png::PngDecoder::new(BufReader::new(File::open(&path).unwrap()));
    let png = decoder.unwrap().apng().unwrap().into_frames().collect_frames().unwrap();
    for frames in [gif, png] {
        let colors = frames.iter().map(|frame| frame.buffer().get_pixel(2, 1).0);
        let expected = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]];
        assert_eq!(colors.collect::<Vec<_>>(), expected);
        let (numerator, denominator) = frames[0].delay().numer_denom_ms();
        assert_eq!(numerator / denominator, 80);
    }
}
