//! Colour spaces: linear light with the primaries of sRGB, XYZ, and CIELAB.
//!
//! XYZ is relative to white everywhere: white is (1, 1, 1). The matrix follows from the primaries
//! of sRGB (IEC 61966-2-1) and its white D65 as ratios of integers, each row divided by its sum.
//!
//! CIELAB is that of CIE 15. Everything is in double precision, with functions of `libm`: no bit
//! depends on the machine.

/// The weights of red, green and blue in X, Y and Z, before each row is divided by its sum.
///
/// The numbers are those of the authors of FLIP: primaries at (0.64, 0.33), (0.30, 0.60) and (0.15,
/// 0.06), and a white that rounds to (0.3127, 0.3290).
const WEIGHTS: [[f64; 3]; 3] = [
    [10_135_552.0, 8_788_810.0, 4_435_075.0],
    [2_613_072.0, 8_788_810.0, 887_015.0],
    [1_425_312.0, 8_788_810.0, 70_074_185.0],
];

const TO_XYZ: [[f64; 3]; 3] = [parts(WEIGHTS[0]), parts(WEIGHTS[1]), parts(WEIGHTS[2])];

const TO_RGB: [[f64; 3]; 3] = inverse(TO_XYZ);

/// The root at which CIELAB changes from the cube root to a straight line.
const KNEE: f64 = 6.0 / 29.0;

/// Linear red, green and blue as XYZ, relative to white.
pub(super) fn rgb_to_xyz(rgb: [f64; 3]) -> [f64; 3] {
    times(&TO_XYZ, rgb)
}

/// The inverse of [`rgb_to_xyz`].
pub(super) fn xyz_to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    times(&TO_RGB, xyz)
}

/// XYZ, relative to white, as L* from 0 to 100, a* and b*.
pub(super) fn xyz_to_lab(xyz: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = xyz.map(|value| {
        if value > KNEE * KNEE * KNEE {
            libm::cbrt(value)
        } else {
            value / (3.0 * KNEE * KNEE) + 4.0 / 29.0
        }
    });
    opponents([x, y, z])
}

/// The inverse of [`xyz_to_lab`].
pub(super) fn lab_to_xyz(lab: [f64; 3]) -> [f64; 3] {
    from_opponents(lab).map(|root| {
        if root > KNEE { root * root * root } else { (root - 4.0 / 29.0) * (3.0 * KNEE * KNEE) }
    })
}

/// The three opponent channels: lightness, red against green, and yellow against blue. CIELAB
/// applies this to the roots of XYZ, and YCxCz to XYZ itself.
pub(super) fn opponents([x, y, z]: [f64; 3]) -> [f64; 3] {
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The inverse of [`opponents`].
pub(super) fn from_opponents([lightness, red_green, yellow_blue]: [f64; 3]) -> [f64; 3] {
    let y = (lightness + 16.0) / 116.0;
    [y + red_green / 500.0, y, y - yellow_blue / 200.0]
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

const fn parts([a, b, c]: [f64; 3]) -> [f64; 3] {
    let whole = a + b + c;
    [a / whole, b / whole, c / whole]
}

/// The inverse of a matrix, from its cofactors: the columns are products of the rows.
const fn inverse([a, b, c]: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = [cross(b, c), cross(c, a), cross(a, b)];
    let all = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
    [
        [x[0] / all, y[0] / all, z[0] / all],
        [x[1] / all, y[1] / all, z[1] / all],
        [x[2] / all, y[2] / all, z[2] / all],
    ]
}

const fn cross([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> [f64; 3] {
    [b * f - c * e, c * d - a * f, a * e - b * d]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
        for (f, e) in found.into_iter().zip(expected) {
            assert!((f - e).abs() <= tolerance, "{found:?} is not {expected:?}");
        }
    }

    #[test]
    fn the_matrix_is_that_of_the_primaries() {
        // White, with Y = 1: the sums by which the rows are divided.
        let sums = WEIGHTS.map(|row| row.iter().sum::<f64>());
        let white = [sums[0] / 24_577_794.0, sums[1] / 12_288_897.0, sums[2] / 73_733_382.0];
        let chromaticity = |xyz: [f64; 3]| xyz.map(|value| value / xyz.iter().sum::<f64>());
        near(chromaticity(white), [0.3127, 0.3290, 0.3583], 5e-5);
        let primaries = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
        for (i, [x, y]) in primaries.into_iter().enumerate() {
            let mut rgb = [0.0; 3];
            rgb[i] = 1.0;
            let xyz = rgb_to_xyz(rgb);
            let whole = [0, 1, 2].map(|j| xyz[j] * white[j]);
            near(chromaticity(whole), [x, y, 1.0 - x - y], 1e-7);
        }
        near(rgb_to_xyz([1.0; 3]), [1.0; 3], 1e-15);
    }

    #[test]
    fn every_way_leads_back() {
        for i in 0..1000 {
            let rgb = [i % 10, i / 10 % 10, i / 100].map(|part| f64::from(part) / 9.0);
            let xyz = rgb_to_xyz(rgb);
            near(xyz_to_rgb(xyz), rgb, 1e-14);
            near(lab_to_xyz(xyz_to_lab(xyz)), xyz, 1e-14);
            near(from_opponents(opponents(xyz)), xyz, 1e-14);
        }
    }

    #[test]
    fn white_is_100_and_the_curve_has_no_step() {
        near(xyz_to_lab([1.0; 3]), [100.0, 0.0, 0.0], 1e-12);
        near(xyz_to_lab([0.0; 3]), [0.0; 3], 1e-12);
        let knee = KNEE * KNEE * KNEE;
        near(xyz_to_lab([knee.next_up(); 3]), xyz_to_lab([knee.next_down(); 3]), 1e-12);
        // The middle of the lightness scale is some 18.4 per cent of white's light.
        assert!((xyz_to_lab([0.184_186_518_5; 3])[0] - 50.0).abs() < 1e-7);
    }
}
