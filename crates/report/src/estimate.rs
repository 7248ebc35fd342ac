//! Bounds on the work of a render, computed before the first ray.

use serde::Serialize;

use crate::statistics::{Rays, Samples};
use wavecrest_core::kernels::texture::Filter;
use wavecrest_core::prepared::PreparedScene;

/// Upper bounds on the counts of a render; they are 0 only for work that cannot occur.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Estimated {
    /// Rays by kind.
    pub rays: Rays,
    /// Samples by kind.
    pub samples: Samples,
}

impl Estimated {
    /// The bounds for a render of this number of `pixels` of `scene`: every camera ray is traced and meets
    /// mirrors up to the largest number of bounces, every hit samples all lights, and every hit is
    /// on the shape whose textures read the most texels.
    pub fn of(scene: &PreparedScene, pixels: u64) -> Self {
        let primary = pixels * u64::from(scene.camera.rays_per_pixel());
        let secondary = primary.saturating_mul(u64::from(scene.bounces));
        let hits = primary.saturating_add(secondary);
        let points = |sampled_alone: bool| -> u64 {
            let lights = scene.lights.iter().filter(|l| !sampled_alone || l.is_sampled());
            lights.map(|light| u64::from(light.samples())).sum()
        };
        let most = |count: fn(Filter) -> u64| -> u64 {
            let of = |shape| scene.appearance.textures(shape).map(|t| count(t.filter)).sum();
            scene.appearance.shapes.iter().map(of).max().unwrap_or(0)
        };
        let texels = most(|filter| filter.texels() * filter.levels());
        let spreads = most(|filter| u64::from(filter == Filter::Trilinear));
        let is_colored = scene.appearance.shapes.iter().any(|shape| shape.colored);
        let colors = if is_colored { hits } else { 0 };
        let carried = if scene.carries_differentials() { secondary } else { 0 };
        let footprints = hits.saturating_mul(spreads).saturating_add(carried);
        let shadow = hits.saturating_mul(points(false));
        let light = hits.saturating_mul(points(true));
        let lens = if scene.camera.has_lens() { primary } else { 0 };
        Self {
            rays: Rays { primary, secondary, shadow },
            samples: Samples {
                lens,
                light,
                colors,
                texels: hits.saturating_mul(texels),
                footprints,
            },
        }
    }
}
