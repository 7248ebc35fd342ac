//! Points on lights.

use super::*;
use crate::math::float::normalize_f64;

fn area_light(emitter: Emitter, sampling: Sampling, grid: [u32; 2]) -> Light {
    Light { emitter, power: Vec3::ONE, falloff: Falloff::Linear, sampling, grid, dimension: 1 }
}

fn points(light: &Light, pixels: u32) -> Vec<Vec3> {
    (0..pixels)
        .flat_map(|pixel| {
            let stream = Stream { seed: 2, pixel, sample: 0, bounce: 0 };
            (0..light.samples()).map(move |i| light.point(i, &stream).position.into())
        })
        .collect()
}

/// A quad of two triangles of unequal area: each receives its share, and the mean is the
/// centroid.
#[test]
fn points_are_spread_by_area() {
    let corners = vec![
        [Vec3::ZERO, Vec3::X * 3.0, Vec3::Y],
        [Vec3::X * 3.0, Vec3::new(3.0, 1.0 / 3.0, 0.0), Vec3::Y],
    ];
    for sampling in Sampling::ALL {
        let emitter = Emitter::Triangles(Triangles::new(corners.clone()).expect("area"));
        let all = points(&area_light(emitter, sampling, [8, 8]), 200);
        let first = all.iter().filter(|p| p.x / 3.0 + p.y < 1.0).count() as f64;
        assert!((first / all.len() as f64 - 0.75).abs() < 0.02, "{first}");
    }
}

#[test]
fn distant_points_fill_their_patch_of_the_sky_evenly() {
    let towards = normalize_f64(DVec3::new(1.0, 2.0, -2.0));
    for angle in [0.53, 20.0, 180.0] {
        let emitter = Emitter::Distant(Distant::new(towards, angle, 3.0));
        let all = points(&area_light(emitter, Sampling::Jittered, [16, 16]), 40);
        let edge = (angle / 2.0).to_radians().cos();
        let cosine = |p: &Vec3| normalize_f64(p.as_dvec3()).dot(towards);
        assert!(all.iter().all(|p| (6.0..=16.0).contains(&p.length()) && cosine(p) > edge - 1e-6));
        // Equal heights of a sphere have equal areas.
        let mean = all.iter().map(cosine).sum::<f64>() / all.len() as f64;
        assert!((mean - (1.0 + edge) / 2.0).abs() < 0.01 * (1.0 - edge), "{angle}: {mean}");
    }
    let parallel = Emitter::Distant(Distant::new(DVec3::Y, 0.0, 3.0));
    assert_eq!(parallel.only_point(), Some(Vec3::Y * 8.0));
}
