//! Renders in parts: who looks on sees the image come together and may end it.

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use serde_json::Value;
use wavecrest_core::film::Film;
use wavecrest_core::render::{RenderOptions, Rendered, Watch, render};
use wavecrest_core::tile::Tile;

use crate::support::{
    TRACERS, matte, options, pinhole, places, point_light, prepare, render_on, scene, sphere, wall,
    with,
};

/// A ball before a wall, with so many samples a side for each pixel.
pub(crate) fn ball(size: [u32; 2], antialias: u32) -> Value {
    let camera = with(pinhole(size, 40.0, 5.0), "antialias", antialias);
    let light = point_light(40.0, [2.0, 3.0, 4.0], [1.0; 3]);
    let mirror = with(matte(0.7, [0.9, 0.3, 0.1]), "kr", 0.25);
    let shapes = [sphere([0.0; 3], 1.0, mirror), wall(4.0, -2.0, matte(0.8, [0.2, 0.4, 0.9]))];
    scene(1, &camera, &[light], &shapes)
}

/// Collects what it is told, and cancels after so many tiles.
struct Collector {
    film: Mutex<Film>,
    tiles: Mutex<Vec<Tile>>,
    done: AtomicU64,
    most: usize,
}

impl Collector {
    fn new([width, height]: [u32; 2], most: usize) -> Self {
        Self {
            film: Mutex::new(Film::new(width, height).expect("a film")),
            tiles: Mutex::default(),
            done: AtomicU64::new(0),
            most,
        }
    }
}

impl Watch for Collector {
    fn progress(&self, done: u64, all: u64) {
        assert!(done <= all);
        self.done.fetch_max(done, Ordering::Relaxed);
    }

    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        assert_eq!(pixels.len(), tile.len());
        self.film.lock().expect("no panic").paste([tile.x, tile.y], tile.width, pixels);
        self.tiles.lock().expect("no panic").push(*tile);
    }

    fn cancelled(&self) -> bool {
        self.tiles.lock().expect("no panic").len() >= self.most
    }
}

#[test]
fn a_watcher_sees_every_tile_once_and_the_whole_image() {
    let size = [45, 37];
    let scene = prepare(&ball(size, 2));
    for tracer in TRACERS {
        let watch = Collector::new(size, usize::MAX);
        let rendered =
            render(&scene, &RenderOptions { tracer, ..options() }, &watch).expect("an image");
        assert!(rendered.finished);
        assert!(watch.film.into_inner().expect("no panic").same_bits(&rendered.film));
        let mut seen = watch.tiles.into_inner().expect("no panic");
        seen.sort_by_key(|tile| (tile.y, tile.x));
        assert_eq!(seen, rendered.tiles);
        assert_eq!(rendered.tiles.iter().map(Tile::len).sum::<usize>(), 45 * 37);
        assert_eq!(watch.done.into_inner(), 45 * 37);
    }
}

#[test]
fn a_render_that_is_cancelled_keeps_what_was_finished() {
    let size = [45, 37];
    let scene = prepare(&ball(size, 4));
    let whole = render_on(1, &scene, &options()).film;
    for most in [0, 1, 5, 28] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool");
        let watch = Collector::new(size, most);
        let part = pool.install(|| render(&scene, &options(), &watch)).expect("a part");
        assert!(!part.finished);
        // The other thread may finish its tile.
        assert!((most..=most + usize::from(most > 0)).contains(&part.tiles.len()));
        let there: BTreeSet<(u32, u32)> = pixels_of(&part).collect();
        for (x, y) in places(45, 37) {
            let expected = if there.contains(&(x, y)) { whole.pixel(x, y) } else { Some([0.0; 3]) };
            assert_eq!(part.film.pixel(x, y), expected, "{x}, {y} after {most} tiles");
        }
    }
}

fn pixels_of(part: &Rendered) -> impl Iterator<Item = (u32, u32)> {
    part.tiles.iter().flat_map(|tile| (0..tile.len() as u32).map(|index| tile.pixel(index)))
}

/// Against another camera of as many rays.
#[test]
fn a_pixel_is_the_mean_of_all_its_samples() {
    let scene = prepare(&ball([3, 3], 32));
    let one = render_on(1, &prepare(&ball([96, 96], 1)), &options()).film;
    let found = render_on(1, &scene, &options()).film;
    for (x, y) in places(3, 3) {
        let inside = (0..32 * 32).map(|i| one.pixel(x * 32 + i % 32, y * 32 + i / 32));
        let mean = inside.map(|p| f64::from(p.expect("a pixel")[0])).sum::<f64>() / 1024.0;
        let pixel = f64::from(found.pixel(x, y).expect("a pixel")[0]);
        assert!((pixel - mean).abs() < 0.02, "{x}, {y}: {pixel} and {mean}");
    }
}
