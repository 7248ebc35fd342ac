//! The recursive tracer: one path after the other, depth first, over the same kernels as the
//! wavefront. It is the wavefront's rival, and its reference.
//!
//! Each hit spawns at most one mirror ray, so the recursion of Whitted (1980) is a loop that carries
//! its throughput: any number of bounces needs no stack. Light is added in the order in which the
//! wavefront adds it, hit by hit, light by light, sample by sample.

use std::marker::PhantomData;
use std::time::Instant;

use glam::Vec3;

use crate::accel::Traversal;
use crate::counters::Counters;
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::{self, ShadingPoint};
use crate::math::random::Stream;
use crate::prepared::{Arrival, PreparedScene};
use crate::tile::{Tile, TraceSettings, Tracer, add_sample};

/// The tracer.
#[derive(Debug)]
pub struct Recursive<P> {
    seed: u64,
    traversal: Traversal,
    counters: Counters,
    seconds: f64,
    precision: PhantomData<P>,
}

impl<P: Arithmetic> Tracer for Recursive<P> {
    fn new(scene: &PreparedScene, settings: &TraceSettings) -> Self {
        Self {
            seed: settings.seed,
            traversal: scene.accel.traversal(),
            counters: Counters::default(),
            seconds: 0.0,
            precision: PhantomData,
        }
    }

    fn render(&mut self, scene: &PreparedScene, tile: &Tile, sums: &mut [[f64; 3]]) {
        let start = Instant::now();
        let width = scene.camera.size()[0];
        for (index, sum) in sums.iter_mut().enumerate() {
            let (x, y) = tile.pixel(index as u32);
            for sample in 0..scene.camera.rays_per_pixel() {
                let stream = Stream { seed: self.seed, pixel: y * width + x, sample, bounce: 0 };
                let radiance = self.path(scene, x, y, stream);
                add_sample(sum, radiance.to_array(), &mut self.counters);
            }
        }
        self.seconds += start.elapsed().as_secs_f64();
    }

    fn counters(&self) -> Counters {
        let Traversal { tests, kernels, .. } = self.traversal;
        Counters { tests, kernels, ..self.counters }
    }

    fn pass_seconds(&self) -> Vec<(&'static str, f64)> {
        vec![("recursive", self.seconds)]
    }
}

impl<P: Arithmetic> Recursive<P> {
    /// The radiance along one camera ray.
    fn path(&mut self, scene: &PreparedScene, x: u32, y: u32, mut stream: Stream) -> Vec3 {
        let mut ray = scene.camera.ray(x, y, &stream);
        self.counters.primary_rays += 1;
        self.counters.lens_samples += u64::from(scene.camera.has_lens());
        let mut throughput = Vec3::ONE;
        let mut radiance = Vec3::ZERO;
        loop {
            let hit = scene.accel.closest(&ray, &mut self.traversal);
            let point = match scene.arrival::<P>(&ray, &hit, &mut self.counters.texels) {
                Arrival::Surface(point) => point,
                Arrival::Light(color) => return radiance + throughput * color,
                Arrival::Nothing if stream.bounce == 0 => return radiance + scene.background,
                Arrival::Nothing => return radiance,
            };
            radiance += throughput * shade::local_light(&point, scene.ambient);
            if point.lit {
                self.direct_light(scene, &point, throughput, &stream, &mut radiance);
            }
            if stream.bounce == scene.bounces {
                return radiance;
            }
            let Some((next, weight)) = shade::mirror(&point, throughput) else { return radiance };
            self.counters.secondary_rays += 1;
            (ray, throughput) = (next, weight);
            stream.bounce += 1;
        }
    }

    /// Adds what each point of each light contributes, where nothing is in the way.
    #[inline]
    fn direct_light(
        &mut self,
        scene: &PreparedScene,
        point: &ShadingPoint,
        throughput: Vec3,
        stream: &Stream,
        radiance: &mut Vec3,
    ) {
        for light in &scene.lights {
            for index in 0..light.samples() {
                let target = light.point(index, stream);
                self.counters.light_samples += u64::from(light.is_sampled());
                let Some(request) = shade::shadow_request(point, throughput, light, &target) else {
                    continue;
                };
                self.counters.shadow_rays += 1;
                self.counters.lights_at_surface += u64::from(request.at_light);
                if !scene.accel.occluded(&request.ray, &mut self.traversal) {
                    *radiance += request.contribution;
                }
            }
        }
    }
}
