//! Other samples of the same scene, for sweeps over samplers and sample counts.

use glam::DAffine3;

use super::PreparedScene;
use crate::kernels::camera::DIMENSION;
use crate::kernels::{Camera, Hemisphere, Light};
use crate::math::sampling::{Points, Sampling};

/// The sampling of a scene. `None` keeps the scene's own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Samples {
    /// On each light with a shape, for each lit hit.
    pub lights: Option<Points>,
    /// On the lens, for each point in the pixel; ignored for a pinhole.
    pub lens: Option<Points>,
    /// In the pixel. A single point is its centre.
    pub pixel: Option<Points>,
}

/// The camera and the lights of a scene as in its file.
#[derive(Clone, Debug)]
pub struct Original {
    camera: Camera,
    lights: Vec<Light>,
    hemisphere: Option<Hemisphere>,
}

impl PreparedScene {
    /// The starting point of [`PreparedScene::resample`].
    pub fn original(&self) -> Original {
        let Self { camera, ref lights, hemisphere, .. } = *self;
        Original { camera, lights: lights.clone(), hemisphere }
    }

    /// The number of rays of the camera.
    pub fn camera_rays(&self) -> u64 {
        let pixels: u64 = self.camera.size().map(u64::from).iter().product();
        pixels.saturating_mul(u64::from(self.camera.rays_per_pixel()))
    }

    /// About the largest number of rays of a render, from which the preset is chosen.
    pub fn expected_rays(&self) -> u64 {
        let lights: u64 = self.lights.iter().map(|l| u64::from(l.samples())).sum();
        // Rays beyond the first surface are rare.
        let goes_on = self.bounces > 0 || self.plan.schedule().has_transmission();
        self.camera_rays().saturating_mul(1 + lights).saturating_mul(1 + u64::from(goes_on))
    }

    /// Moves all lights without a shape, and turns the sky.
    pub fn move_lights(&mut self, by: &DAffine3) {
        self.lights.iter_mut().for_each(|light| light.emitter.moved(by));
        self.hemisphere.iter_mut().for_each(|hemisphere| hemisphere.turn(&by.matrix3));
    }

    /// Changes the sampling of the scene, whose file had `original`, to `samples`. The image is to
    /// the last bit that of a file with these samples.
    pub fn resample(&mut self, original: &Original, samples: &Samples) {
        self.camera = original.camera.resampled(samples.pixel, samples.lens);
        self.lights.clone_from(&original.lights);
        self.hemisphere = original.hemisphere;
        let mut dimension = DIMENSION + 1;
        for light in self.lights.iter_mut() {
            light.dimension = dimension;
            if !light.is_sampled() {
                continue;
            }
            if let Some(points) = samples.lights {
                light.sampling = points.sampling;
                light.grid = match points.sampling {
                    Sampling::Jittered => [points.side, points.side],
                    Sampling::Random | Sampling::Sobol => [points.count(), 1],
                };
            }
            dimension = dimension.saturating_add(light.samples());
        }
    }
}
