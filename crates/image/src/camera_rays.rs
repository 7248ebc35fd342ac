//! A pass over the camera rays of a render, the same to the last bit and through the same kernels.
//!
//! They are followed straight on, as the tracers follow them, through what lets them pass: to what shows first, and to
//! the background.
//!
//! Bands of rows are processed in turn, each tile by tile on all threads, so that little memory is
//! needed beyond the result. The samples of a pixel are gathered in order.

use glam::Vec3;

use wavecrest_base::parallel;
use wavecrest_core::accel::{Hit, Traversal};
use wavecrest_core::kernels::precision::Arithmetic;
use wavecrest_core::math::float::dot;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::{
    Branch, Interaction, MOST_RAYS, MediumStack, PathState, PreparedScene, SampleCounts, surface,
};
use wavecrest_core::render::Watch;
use wavecrest_core::render::units::Grid;
use wavecrest_core::tile::Tile;
use wavecrest_core::with_precision;

/// The side of a tile in pixels: its rays are coherent.
const TILE_EDGE: u32 = 64;

/// Largest number of rays traced together.
const BATCH_RAYS: usize = 4096;

/// What the camera rays of a pixel show, summed over its samples.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HitSums {
    /// Number of samples that show something. The other sums are over these.
    pub(crate) hits: u32,
    /// The share of the background that arrives straight, of all samples: the mean of red, green and blue.
    pub(crate) passed: f64,
    /// Distances along the view axis.
    pub(crate) depth: f64,
    pub(crate) normal: [f64; 3],
    /// The colours that the caller gives hits.
    pub(crate) color: [f64; 3],
    /// Points in the space of the scene.
    pub(crate) position: [f64; 3],
    /// The number of the shape that the first sample shows, from 1; 0 for nothing.
    pub(crate) shape: u32,
}

/// The visible properties of a hit on a surface or a light.
pub(crate) struct VisibleHit {
    pub(crate) hit: Hit,
    point: Vec3,
    /// The shading normal, on the side of the ray.
    pub(crate) normal: Vec3,
    pub(crate) albedo: Vec3,
}

/// The hit that shows first of a camera ray, which meets `hit` first, and the share of the background that arrives
/// straight.
fn straight_on<P: Arithmetic>(
    scene: &PreparedScene,
    (media, ray, mut hit): (&MediumStack, &Ray, Hit),
    traversal: &mut Traversal,
) -> (Option<VisibleHit>, f64) {
    let transmits = scene.plan.schedule().has_transmission();
    let look_ups = &mut SampleCounts::default();
    let (mut first, mut passed, mut waiting) = (None, 0.0, Vec::new());
    let state = PathState { media: *media, ..PathState::default() };
    let mut at = Branch { ray: *ray, throughput: Vec3::ONE, state, differential: None };
    for _ in 0..MOST_RAYS {
        if transmits {
            at.throughput *= scene.remaining(&at.ray, &at.state.media, hit.t);
        }
        let mut own = at.throughput;
        let (point, normal, albedo) =
            match scene.interaction::<P>(&at.ray, &hit, at.differential, look_ups) {
                Interaction::Nothing => {
                    passed += f64::from(own.element_sum()) / 3.0;
                    own = Vec3::ZERO;
                    Default::default()
                }
                Interaction::Surface(point, class) => {
                    if let Some(through) = class.transparency.as_ref().filter(|_| transmits) {
                        let memory = (&mut *traversal, &mut *look_ups);
                        let scattered = scene.scatter::<P>(&at, &hit, through, &point, memory);
                        own = scattered.0;
                        let straight = |branch: &Branch| !branch.state.turned;
                        waiting.extend(scattered.1.into_iter().rev().flatten().filter(straight));
                    }
                    (point.point.into(), point.shading_normal.into(), point.color.into())
                }
                Interaction::Light(albedo) => {
                    let at = surface::<P>(scene.accel.geometry(), &at.ray, &hit);
                    let normal: Vec3 = at.normal.into();
                    let is_behind = dot(ray.direction, normal) > 0.0;
                    (at.point.into(), if is_behind { -normal } else { normal }, albedo)
                }
            };
        if own != Vec3::ZERO {
            first.get_or_insert(VisibleHit { hit, point, normal, albedo });
        }
        let Some(next) = waiting.pop() else { break };
        at = next;
        hit = at.state.next;
        if hit.is_miss() {
            hit = scene.accel.search::<P>().closest(&at.ray, traversal);
        }
    }
    (first, passed)
}

/// The sums of a ray's pixel, and memory to follow it further.
type Place<'a, S> = (&'a mut S, &'a mut Traversal);

/// The camera rays of a window.
#[derive(Clone, Copy)]
pub(crate) struct CameraRays<'a> {
    pub(crate) scene: &'a PreparedScene,
    pub(crate) window: Tile,
    /// The seed of the render.
    pub(crate) seed: u64,
    /// Ends the pass early.
    pub(crate) watch: &'a dyn Watch,
}

impl CameraRays<'_> {
    /// Sums what the rays show, which have the colours that `color` gives them, and calls `put` as
    /// [`CameraRays::run`] does.
    pub(crate) fn sum(
        &self,
        color: impl Fn(&VisibleHit) -> [f32; 3] + Sync,
        put: &mut dyn FnMut(usize, &HitSums),
    ) {
        let scene = self.scene;
        let (precision, traversal) =
            (scene.accel.geometry().precision, &mut scene.accel.traversal());
        let media = with_precision!(precision, P => scene.media_at_camera::<P>(traversal));
        let follow = with_precision!(precision, P => straight_on::<P>);
        let [_, _, forward] = scene.camera.basis();
        let add = |ray: &Ray, hit: &Hit, is_first: bool, (sums, traversal): Place<'_, HitSums>| {
            let (found, passed) = follow(scene, (&media, ray, *hit), traversal);
            sums.passed += passed;
            let Some(found) = found else { return };
            sums.hits += 1;
            sums.depth += f64::from(found.hit.t) * f64::from(dot(ray.direction, forward));
            add_to(&mut sums.normal, found.normal.to_array().map(f64::from));
            add_to(&mut sums.color, color(&found).map(f64::from));
            add_to(&mut sums.position, (found.point.as_dvec3() + scene.origin).to_array());
            if is_first {
                sums.shape = scene.appearance.shape_of(found.hit.primitive) as u32 + 1;
            }
        };
        self.run(&add, put);
    }

    /// Traces the rays, and passes each with its hit, whether it is the pixel's first, and its
    /// [`Place`] to `add`; then calls `put` with the number of each pixel within the window and
    /// its sums.
    pub(crate) fn run<S: Clone + Default + Send>(
        &self,
        add: &(impl Fn(&Ray, &Hit, bool, Place<'_, S>) + Sync),
        put: &mut dyn FnMut(usize, &S),
    ) {
        let window = &self.window;
        let precision = self.scene.accel.geometry().precision;
        let follow = |tile: &Tile| with_precision!(precision, P => self.follow::<P, S>(tile, add));
        for y in (0..window.height).step_by(TILE_EDGE as usize) {
            let height = TILE_EDGE.min(window.height - y);
            let band = Grid::new(Tile { y: window.y + y, height, ..*window }, TILE_EDGE);
            let tiles: Vec<Tile> = (0..band.len()).map(|number| band.tile(number)).collect();
            let found: Vec<Vec<S>> = parallel::map(tiles.iter(), follow);
            for (tile, pixels) in tiles.iter().zip(&found) {
                for (index, sums) in pixels.iter().enumerate() {
                    let (x, y) = tile.pixel(index as u32);
                    let row = (y - window.y) as usize * window.width as usize;
                    put(row + (x - window.x) as usize, sums);
                }
            }
        }
    }

    /// The sums of the tile's pixels.
    fn follow<P: Arithmetic, S: Clone + Default>(
        &self,
        tile: &Tile,
        add: &impl Fn(&Ray, &Hit, bool, Place<'_, S>),
    ) -> Vec<S> {
        let mut sums = vec![S::default(); tile.len()];
        let mut traversal = self.scene.accel.traversal();
        let (mut rays, mut hits) = (Vec::new(), Vec::new());
        let samples = u64::from(self.scene.camera.rays_per_pixel());
        let all = tile.len() as u64 * samples;
        for first in (0..all).step_by(BATCH_RAYS) {
            if self.watch.cancelled() {
                break;
            }
            let paths = first..all.min(first + BATCH_RAYS as u64);
            rays.clear();
            rays.extend(paths.clone().map(|path| self.camera_ray(tile, path)));
            hits.clear();
            hits.resize(rays.len(), Hit::MISS);
            self.scene.accel.search::<P>().closest_of(
                rays.as_slice().into(),
                &mut hits,
                &mut traversal,
            );
            for (path, (ray, hit)) in paths.zip(rays.iter().zip(&hits)) {
                let is_first = path % samples == 0;
                add(ray, hit, is_first, (&mut sums[(path / samples) as usize], &mut traversal));
            }
        }
        sums
    }

    /// The ray of a path: the samples of a pixel are consecutive.
    fn camera_ray(&self, tile: &Tile, path: u64) -> Ray {
        let camera = &self.scene.camera;
        let samples = u64::from(camera.rays_per_pixel());
        let (x, y) = tile.pixel((path / samples) as u32);
        let (pixel, sample) = (y * camera.size()[0] + x, (path % samples) as u32);
        camera.ray(x, y, &Stream { seed: self.seed, pixel, sample, bounce: 0 })
    }
}

fn add_to(sum: &mut [f64; 3], value: [f64; 3]) {
    sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
}
