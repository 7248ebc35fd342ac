use glam::Vec3;

use super::*;

/// Red grows along x by tenths, green down y.
fn gradient(width: u32, height: u32) -> Image {
    let texel = |i: u32| [(i % width) as f32 / 10.0, (i / width) as f32 / 10.0, 0.0];
    let texels = (0..width * height).map(texel).collect();
    Image::new(width, height, Texels::Floats(texels))
}

#[test]
fn bilinear_meets_the_texel_at_its_centre_and_averages_between() {
    let image = gradient(4, 1);
    let at = |u| image.look_up([u, 0.5], Filter::Bilinear, Wrap::Repeat).x;
    assert_eq!(at(0.375), 0.1);
    assert!((at(0.5) - 0.15).abs() < 1e-6);
    assert!((at(0.0) - 0.15).abs() < 1e-6, "the seam averages the first and the last");
    assert_eq!(image.look_up([0.0, 0.5], Filter::Bilinear, Wrap::Clamp).x, 0.0);
}

#[test]
fn the_level_is_the_logarithm_of_the_longer_side_in_texels() {
    let mut image = gradient(64, 32);
    let level = |image: &Image, x: [f32; 2], y: [f32; 2]| {
        image.level(&[x, y].map(|[u, v]: [f32; 2]| [u / 64.0, v / 32.0]))
    };
    assert_eq!(level(&image, [64.0, 0.0], [0.0, 32.0]), 0.0, "without a pyramid");
    image.build_pyramid();
    assert_eq!(image.coarsest(), 6);
    assert_eq!(level(&image, [1.0, 0.0], [0.0, 0.5]), 0.0);
    assert_eq!(level(&image, [0.3, 0.0], [0.0, 0.5]), 0.0);
    assert_eq!(level(&image, [0.0, 0.0], [0.0, 0.0]), 0.0);
    assert_eq!(level(&image, [2.0, 0.0], [0.0, 0.5]), 1.0);
    assert_eq!(level(&image, [-2.0, 0.0], [0.0, 4.0]), 2.0, "v counts in rows");
    assert_eq!(level(&image, [1e30, 0.0], [0.0, 0.5]), 6.0);
    for endless in [f32::INFINITY, f32::NAN] {
        assert_eq!(level(&image, [endless, 0.0], [0.0, 0.5]), 6.0);
        assert_eq!(level(&image, [0.3, 0.0], [0.0, endless]), 6.0);
    }
}

#[test]
fn logarithms_are_near_those_in_double_precision() {
    let last = f32::INFINITY.to_bits();
    for x in (1.0_f32.to_bits()..last).step_by(997).map(f32::from_bits) {
        let expected = f64::from(x).log2();
        let error = (f64::from(log2_from_1(x)) - expected).abs();
        assert!(error <= expected * 2.0_f64.powi(-22), "{x}: {error} of {expected}");
    }
    assert_eq!([0.0, 0.5, 1.0].map(log2_from_1::<f32>), [0.0; 3]);
}

#[test]
fn levels_are_bilinear_and_between_them_linear() {
    let mut image = gradient(7, 5);
    image.build_pyramid();
    let uv = [0.4, 0.7];
    let at = |level: f32| {
        let (color, between) = image.look_up_at(uv, level, Wrap::Repeat);
        (Vec3::from(color), between)
    };
    let finest = Vec3::from(image.look_up(uv, Filter::Bilinear, Wrap::Repeat));
    for below in [0.0, -1.0, f32::NEG_INFINITY] {
        assert_eq!(at(below), (finest, 0));
    }
    // The mean of 0 to 0.6 and of 0 to 0.4.
    let (mean, between) = at(2.0);
    assert!(mean.distance(Vec3::new(0.3, 0.2, 0.0)) < 1e-6 && between == 0, "{mean}");
    for above in [2.5, 1e30, f32::INFINITY, f32::NAN] {
        assert_eq!(at(above), (mean, 0));
    }
    let (half, between) = at(0.5);
    assert!(half.distance((finest + at(1.0).0) / 2.0) < 1e-6 && between == 1, "{half}");
    assert_eq!(gradient(7, 5).look_up_at(uv, 1.5, Wrap::Repeat), (finest.into(), 0), "no pyramid");
}

#[test]
fn prefetches_are_of_texels_that_are_read() {
    let mut image = gradient(8, 4);
    image.build_pyramid();
    let addresses = |level| {
        let found = std::cell::RefCell::new(Vec::new());
        image.addresses([0.5, 0.5], level, Wrap::Repeat, |address| {
            found.borrow_mut().push(address.addr());
        });
        found.into_inner()
    };
    let Texels::Floats(texels) = &image.texels else { unreachable!() };
    let in_image = [1, 2].map(|row| (&raw const texels[row * 8 + 3]).addr());
    let above = [0, 1].map(|row| (&raw const image.levels[0].texels[row * 4 + 1]).addr());
    assert_eq!(addresses(None), in_image);
    assert_eq!(addresses(Some(0.0)), in_image);
    assert_eq!(addresses(Some(1.0)), above);
    assert_eq!(addresses(Some(0.5)), [in_image, above].concat());
}

#[test]
fn bytes_are_shares_of_255() {
    let words = (0..=u8::MAX).map(|byte| u32::from_le_bytes([byte, 255 - byte, byte ^ 1, 7]));
    for (byte, word) in words.enumerate() {
        let [green, blue] = [255 - byte, byte ^ 1].map(|byte| SHARES[byte]);
        assert_eq!(around::shares::<f32>((), &[word]), Vec3::new(SHARES[byte], green, blue).into());
    }
}
