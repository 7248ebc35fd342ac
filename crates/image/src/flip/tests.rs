use super::*;

/// A picture of values that are whole numbers over 256.
fn picture(width: u32, height: u32, level: impl Fn(u32, u32, u32) -> u32) -> Film {
    let value = |x, y, channel| level(x, y, channel) as f32 / 256.0;
    let pixels = (0..width * height).map(|i| [0, 1, 2].map(|c| value(i % width, i / width, c)));
    Film::from_pixels(width, height, pixels.collect()).unwrap()
}

fn noise(x: u32, y: u32, channel: u32) -> u32 {
    (x * x * 7 + x * y * 3 + y * 131 + channel * 37) % 257
}

fn ramp(x: u32, y: u32, channel: u32) -> u32 {
    (2 * x + y + channel * 40) % 257
}

fn checks(x: u32, y: u32, channel: u32) -> u32 {
    (x / 8 + y / 8) % 2 * (256 - 60 * channel)
}

fn shifted(x: u32, y: u32, channel: u32) -> u32 {
    checks(x + 1, y, channel)
}

fn grey(_: u32, _: u32, _: u32) -> u32 {
    128
}

fn dot(x: u32, y: u32, _: u32) -> u32 {
    if (x, y) == (50, 35) { 256 } else { 128 }
}

fn black(_: u32, _: u32, _: u32) -> u32 {
    0
}

fn white(_: u32, _: u32, _: u32) -> u32 {
    256
}

type Level = fn(u32, u32, u32) -> u32;

/// What the reference implementation finds: two pictures, their size, pixels per degree, the mean,
/// and the error of the first, the middle and the last pixel.
///
/// Measured with flip-evaluator 1.7 by NVIDIA, from the Python package index: the arrays of these
/// pictures as `float32`, `evaluate(reference, test, "LDR", inputsRGB=False, applyMagma=False)`,
/// with `{"ppd": …}` but where it is the default; the mean is of the map, in double precision.
type Measured = (Level, Level, (u32, u32), f64, f64, [f32; 3]);
#[rustfmt::skip]
const MEASURED: [Measured; 8] = [
    (noise, ramp, (100, 70), DEFAULT_PIXELS_PER_DEGREE, 0.678186, [0.634410, 0.538152, 0.889053]),
    (shifted, checks, (100, 70), DEFAULT_PIXELS_PER_DEGREE, 0.316018, [0.035553, 0.277003, 0.168543]),
    (dot, grey, (100, 70), DEFAULT_PIXELS_PER_DEGREE, 0.000318, [0.0, 0.210963, 0.0]),
    (checks, noise, (100, 70), 20.0, 0.913161, [0.977381, 0.980917, 0.983460]),
    (shifted, checks, (100, 70), 150.0, 0.175264, [0.093860, 0.295625, 0.453000]),
    (ramp, checks, (1, 90), DEFAULT_PIXELS_PER_DEGREE, 0.959625, [0.957800, 0.981760, 0.919204]),
    (noise, ramp, (90, 1), DEFAULT_PIXELS_PER_DEGREE, 0.593438, [0.229374, 0.571850, 0.680637]),
    (white, black, (10, 10), DEFAULT_PIXELS_PER_DEGREE, 0.967388, [0.967388; 3]),
];

/// The reference implementation computes in single precision and takes a square root of small
/// differences. Over 109 pairs of pictures at 20, 67.02 and 150 pixels per degree its means were
/// off by 5.2e-5 at most, and its pixels by 1.6e-4.
const MEAN_TOLERANCE: f64 = 1e-4;
const PIXEL_TOLERANCE: f32 = 2e-4;

#[test]
fn the_reference_implementation_finds_the_same() {
    for (i, (a, reference, (width, height), pixels_per_degree, mean, pixels)) in
        MEASURED.into_iter().enumerate()
    {
        let (a, reference) = (picture(width, height, a), picture(width, height, reference));
        let found = flip(&a, &reference, pixels_per_degree).unwrap();
        assert!((found.mean - mean).abs() < MEAN_TOLERANCE, "{i}: {} {mean}", found.mean);
        let middle = (height / 2 * width + width / 2) as usize;
        let last = found.map.len() - 1;
        for (place, expected) in [0, middle, last].into_iter().zip(pixels) {
            let error = found.map[place];
            assert!((error - expected).abs() < PIXEL_TOLERANCE, "{i}: {error} {expected}");
        }
    }
}

#[test]
fn the_default_is_that_of_the_paper() {
    // The paper gives 67.02.
    assert!((DEFAULT_PIXELS_PER_DEGREE - 67.02).abs() < 0.005, "{DEFAULT_PIXELS_PER_DEGREE}");
}

#[test]
fn what_a_display_cannot_show_is_clamped_and_no_number_is_black() {
    let (mut odd, mut shown) = (picture(40, 30, ramp), picture(40, 30, ramp));
    let pixels = [
        ([f32::NAN, f32::INFINITY, f32::NEG_INFINITY], [0.0, 1.0, 0.0]),
        ([1e30, -1e30, 2.0], [1.0, 0.0, 1.0]),
        ([f32::MAX, f32::MIN, -f32::MIN_POSITIVE], [1.0, 0.0, 0.0]),
    ];
    for (i, (value, clamped)) in pixels.into_iter().enumerate() {
        odd.pixels_mut()[400 + i] = value;
        shown.pixels_mut()[400 + i] = clamped;
    }
    let reference = picture(40, 30, ramp);
    let found = flip(&odd, &reference, DEFAULT_PIXELS_PER_DEGREE).unwrap();
    assert_eq!(found, flip(&shown, &reference, DEFAULT_PIXELS_PER_DEGREE).unwrap());
    assert!(found.mean.is_finite() && found.mean > 0.0);
}

#[test]
fn every_error_lies_between_0_and_1() {
    let value = |x: u32| f32::from_bits(x.wrapping_mul(0x9e37_79b9) ^ (x << 7));
    let film = |seed: u32| {
        let pixels = (0_u32..90 * 70).map(|i| [0_u32, 1, 2].map(|c| value(seed + 3 * i + c)));
        Film::from_pixels(90, 70, pixels.collect()).unwrap()
    };
    for pixels_per_degree in [MIN_PIXELS_PER_DEGREE, 3.0, 67.0, MAX_PIXELS_PER_DEGREE] {
        let found = flip(&film(1), &film(1 << 20), pixels_per_degree).unwrap();
        assert!(found.map.iter().all(|error| (0.0..=1.0).contains(error)));
        assert!(found.mean > 0.0, "{pixels_per_degree}");
    }
}

/// Filters reach no farther than they say, and a pixel's error does not depend on the tile that
/// it lies in.
#[test]
fn a_part_of_a_picture_differs_as_it_does_in_the_whole() {
    let (width, height, left, top) = (120, 100, 37, 29);
    let pair = |width, height, left: u32, top: u32| {
        let film = |level: Level| picture(width, height, |x, y, c| level(x + left, y + top, c));
        flip(&film(noise), &film(ramp), DEFAULT_PIXELS_PER_DEGREE).unwrap()
    };
    let (whole, part) = (pair(200, 150, 0, 0), pair(width, height, left, top));
    let radius = Filters::new(DEFAULT_PIXELS_PER_DEGREE).radius() as u32;
    for y in radius..height - radius {
        for x in radius..width - radius {
            let in_whole = whole.map[((y + top) * 200 + x + left) as usize];
            assert_eq!(part.map[(y * width + x) as usize], in_whole, "{x} {y}");
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let (a, b) = (picture(150, 200, noise), picture(150, 200, checks));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| flip(&a, &b, DEFAULT_PIXELS_PER_DEGREE)).unwrap()
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let (a, b) = (picture(3, 2, grey), picture(2, 3, grey));
    let error = flip(&a, &b, DEFAULT_PIXELS_PER_DEGREE).unwrap_err().to_string();
    assert!(error.contains("found 3 x 2 and 2 x 3"), "{error}");
    for bad in [0.0, -1.0, 0.999, 1000.1, f64::NAN, f64::INFINITY] {
        let error = flip(&a, &a, bad).unwrap_err().to_string();
        let start = format!("pixels per degree are out of bounds, found {bad}; use 1 to 1000");
        assert_eq!(error, start);
    }
}
