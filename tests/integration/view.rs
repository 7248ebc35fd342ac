//! What is out of view changes no bit of any scene, and neither does leaving it out.

use rayon::prelude::*;
use serde_json::{Value, json};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::random::Stream;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_scene::systems::Options;

use crate::support::{
    both, folder, matte, pinhole, point_light, prepare_in, put_texture, scene, sphere, thin_lens,
    with,
};

/// Numbers from 0 to 1 that follow from a seed.
pub(crate) struct Numbers(pub(crate) Stream, pub(crate) u32);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        self.1 += 1;
        f64::from(self.0.uniform(self.1)[0])
    }

    pub(crate) fn below(&mut self, n: u32) -> u32 {
        (self.next() * f64::from(n)) as u32
    }

    fn point(&mut self, size: f64) -> [f64; 3] {
        [0; 3].map(|_| (self.next() * 2.0 - 1.0) * size)
    }
}

/// A scene of a few shapes and lights all around the eye.
fn around_the_eye(seed: u32) -> Value {
    let n = &mut Numbers(Stream { seed: 5, pixel: seed, sample: 0, bounce: 0 }, 0);
    let far = [0.0, 0.0, 5_000.0][n.below(3) as usize];
    let at = |p: [f64; 3]| p.map(|x| x + far);
    let mut camera = pinhole([8, 6], 20.0 + 120.0 * n.next(), 5.0);
    (camera["location"], camera["look"]) = (json!(at([0.0; 3])), json!(at(n.point(1.0))));
    if n.below(3) == 0 {
        camera = thin_lens(camera, n.next(), 1.0 + 4.0 * n.next(), [2, 1]);
    }
    if n.below(4) == 0 {
        let keys = json!([{"frame": 0}, {"frame": 3, "location": at(n.point(0.5))}]);
        camera["path"] = json!({"keys": keys});
    }
    let mut shapes = Vec::new();
    for _ in 0..1 + n.below(5) {
        let kr = if n.below(5) == 0 { 0.5 } else { 0.0 };
        let material = with(with(matte(0.7, [0.9, 0.6, 0.3]), "kr", kr), "ks", 0.3);
        let [a, b, c] = [n.point(4.0), n.point(4.0), n.point(4.0)];
        let d = [0, 1, 2].map(|k| a[k] + c[k] - b[k]);
        let size = [0.3, 1.0, 8.0][n.below(3) as usize];
        let mut shape = match n.below(4) {
            0 => sphere(at(a), size, material),
            1 => {
                json!({"type": "plane", "points": [at(a), at(b), at(c), at(d)], "material": material})
            }
            2 => json!({"type": "triangle", "points": [at(a), at(b), at(c)], "material": material}),
            _ => {
                json!({"type": "trimesh", "points": [at(a), at(b), at(c), at(d)], "material": material,
                        "indices": [[0, 1, 2], [0, 2, 3]], "shading": "smooth",
                        "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]],
                        "normals": [[0, 0, 1], [0, 1, 1], [1, 0, 1], [0, 0, 1]]})
            }
        };
        if n.below(2) == 0 {
            shape["texture"] = "t.png".into();
            shape["filter"] = ["bilinear", "trilinear"][n.below(2) as usize].into();
        }
        shapes.push(shape);
    }
    let mut lights = vec![point_light(30.0, at(n.point(5.0)), [1.0, 0.9, 0.8])];
    for _ in 0..n.below(3) {
        let center = at(n.point(5.0));
        lights.push(json!({"type": "arealight", "intensity": 20, "color": [0.8, 0.9, 1.0],
                           "sampling": "random", "samples": 2,
                           "shape": {"type": "sphere", "center": center, "radius": 0.1 + n.next()}}));
    }
    let mut scene = scene(n.below(3), &camera, &lights, &shapes);
    if n.below(3) == 0 {
        let instance =
            |shape: &str, by: [f64; 3]| json!({"shape": shape, "transform": {"translate": by}});
        let instances = [instance("one", n.point(6.0)), instance("one", n.point(6.0))];
        shapes[0]["name"] = "one".into();
        scene["scene"]["shapes"] = json!(shapes);
        scene["scene"]["instances"] = json!(instances);
    }
    scene
}

#[test]
fn what_is_out_of_view_changes_no_bit_of_any_scene() {
    let folder = folder();
    put_texture(folder.path());
    let everything = unplanned(&PASSES);
    let left_out: usize = (0..600_u32)
        .into_par_iter()
        .map(|seed| {
            let json = around_the_eye(seed);
            let precision = Precision::ALL[seed as usize % Precision::ALL.len()];
            let [mut planned, mut all] = [&PASSES[..], &everything].map(|passes| {
                prepare_in(
                    folder.path(),
                    &json,
                    Options { passes, precision, ..Options::default() },
                )
            });
            let frames = planned.path.as_ref().map_or(0..=0, |path| path.frames());
            for frame in frames {
                for scene in [&mut planned, &mut all] {
                    let moved = scene.path.as_ref().and_then(|path| path.at(frame));
                    scene.camera = moved.unwrap_or(scene.camera);
                }
                let [found, expected] = [both(&planned), both(&all)];
                for rendered in found.iter().chain(&expected) {
                    let same = rendered.film.same_bits(&found[0].film);
                    assert!(same, "{seed}, frame {frame}: {json}");
                }
            }
            usize::from(planned.plan.decisions().iter().any(|d| d.reason.contains("in view")))
        })
        .sum();
    assert!(left_out > 100, "{left_out}");
}
