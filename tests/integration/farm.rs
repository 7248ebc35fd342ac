//! Images in parts: shards, checkpoints, and what becomes of parts that do not fit.

mod refusals;

use std::path::{Path, PathBuf};
use std::time::Duration;

use wavecrest_base::error::{Error, Result};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, Watch};
use wavecrest_core::tile::Tile;
use wavecrest_image::farm::checkpoint::Checkpoint;
use wavecrest_image::farm::merge::merge;
use wavecrest_image::farm::{Author, Identity, Passes, Shard};

use crate::parts::ball;
use crate::support::{TRACERS, folder, options, prepare, render_on};

/// Ends a session once this share of it is finished.
struct EndAt<'a>(&'a Passes, f64);

impl Watch for EndAt<'_> {
    fn cancelled(&self) -> bool {
        self.0.share() >= self.1
    }
}

/// Renders until that share is finished, on one thread: no other is amid a unit.
fn render_until(scene: &PreparedScene, session: &Passes, share: f64) -> Rendered {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    pool.install(|| session.render(scene, &EndAt(session, share), &no_warning)).expect("a film")
}

/// A warning would be a checkpoint that cannot be written.
fn no_warning(error: &Error) {
    panic!("{error}");
}

fn shard(number: u32, count: u32) -> Shard {
    Shard::new(number, count).expect("there is such a shard")
}

fn begin(
    scene: &PreparedScene,
    options: &RenderOptions,
    shard: Option<Shard>,
    checkpoint: Option<&Checkpoint>,
) -> Result<Passes> {
    Passes::begin(scene, *options, Author::default(), shard, (checkpoint.cloned(), false))
}

/// Renders the tiles of a shard, or the rest of them.
fn advance(scene: &PreparedScene, session: &Passes, watch: &dyn Watch) -> u64 {
    let all = scene.camera.rays_per_pixel();
    let done = session.advance(scene, all, watch, &no_warning).expect("the tiles");
    session.save(&no_warning);
    done.counters.rays.primary
}

/// Renders a shard and writes its part.
fn write_part(scene: &PreparedScene, options: &RenderOptions, shard: Shard, file: &Path) {
    let session = begin(scene, options, Some(shard), None).expect("a session");
    advance(scene, &session, &());
    session.write(file).expect("a part");
}

/// Renders all of `count` shards, and writes their parts in `folder`.
fn write_parts(
    scene: &PreparedScene,
    options: &RenderOptions,
    count: u32,
    folder: &Path,
) -> Vec<PathBuf> {
    let write = |number| {
        let file = folder.join(format!("{number}.part"));
        write_part(scene, options, shard(number, count), &file);
        file
    };
    (1..=count).map(write).collect()
}

/// Renders a shard in two goes, the first of which is ended after one unit.
fn write_part_in_two(scene: &PreparedScene, shard: Shard, file: &Path) {
    let options = options();
    let at = |resume| checkpoint(&file.with_extension("kept"), resume);
    let go = |checkpoint: &Checkpoint, share: f64| {
        let session = begin(scene, &options, Some(shard), Some(checkpoint)).expect("a session");
        let watch = EndAt(&session, share);
        let rays = advance(scene, &session, &watch);
        (session.share(), session.write(file), rays)
    };
    let (share, _, first) = go(&at(false), 1e-9);
    assert!(share > 0.0, "one unit is there");
    let (share, written, second) = go(&at(true), 2.0);
    assert_eq!(share, 1.0);
    written.expect("a part");
    let (_, _, third) = go(&at(true), 2.0);
    assert_eq!(third, 0, "everything is there");
    assert!(first > 0, "{first} rays, then {second}");
}

fn checkpoint(file: &Path, resume: bool) -> Checkpoint {
    Checkpoint { file: file.to_owned(), every: Duration::from_secs(3600), resume }
}

/// Scenes whose pixels have a few samples, and many.
fn scenes() -> [PreparedScene; 2] {
    [([90, 70], 2), ([11, 9], 29)].map(|(size, antialias)| prepare(&ball(size, antialias)))
}

/// Parts in an order that is neither theirs nor its reverse, and one of them twice; of crops too.
#[test]
fn parts_in_any_order_make_the_image_of_one_process() {
    let large = Tile { x: 13, y: 5, width: 41, height: 33 };
    let small = Tile { x: 3, y: 2, width: 7, height: 6 };
    for (scene, crop) in scenes().iter().zip([Some(large), Some(small)]) {
        for (tracer, crop, count) in [
            (TRACERS[0], None, 1),
            (TRACERS[0], None, 2),
            (TRACERS[1], None, 7),
            (TRACERS[0], None, 64),
            (TRACERS[0], crop, 3),
            (TRACERS[1], crop, 3),
        ] {
            let options = RenderOptions { tracer, crop, ..options() };
            let folder = folder();
            let parts = write_parts(scene, &options, count, folder.path());
            let step = if count.is_multiple_of(5) { 3 } else { 5 };
            let mut shuffled: Vec<PathBuf> =
                (0..count).map(|i| parts[((i * step + 2) % count) as usize].clone()).collect();
            let copy = folder.path().join("again.part");
            std::fs::copy(&parts[count as usize - 1], &copy).expect("a copy");
            shuffled.insert(0, copy);
            if options.crop.is_none() && tracer == TRACERS[0] {
                write_part_in_two(
                    scene,
                    shard(count.min(2), count),
                    &parts[count.min(2) as usize - 1],
                );
            }
            let merged = merge(&shuffled).unwrap_or_else(|error| panic!("{error}"));
            let whole = render_on(2, scene, &options).film;
            assert!(merged.film.same_bits(&whole), "{crop:?}, {tracer:?}, {count} shards");
        }
    }
}

/// Every tile is dealt once, shares are equal, and each has some of every quarter.
#[test]
fn shards_have_equal_shares_of_every_part_of_the_image() {
    let scene = prepare(&ball([640, 480], 1));
    let identity = Identity::of(&scene, &options()).expect("an image");
    let grid = identity.grid();
    assert!(grid.len() >= 1024, "{} tiles", grid.len());
    for count in [1, 2, 3, 7, 8, 30, 40, 64] {
        let mut dealt = vec![0; grid.len() as usize];
        for number in 1..=count {
            let tiles = shard(number, count).tiles(&grid);
            let pixels: usize = tiles.iter().map(|&tile| grid.tile(tile).len()).sum();
            let fair = f64::from(640 * 480) / f64::from(count);
            assert!((pixels as f64 / fair - 1.0).abs() < 0.1, "{number}/{count}: {pixels} pixels");
            let mut quarters = [0; 4];
            for &number in &tiles {
                dealt[number as usize] += 1;
                let tile = grid.tile(number);
                quarters[usize::from(tile.x >= 320) + 2 * usize::from(tile.y >= 240)] += 1;
            }
            let fair = tiles.len() as f64 / 4.0;
            for quarter in quarters {
                let near = (f64::from(quarter) - fair).abs() <= (fair * 0.5).max(4.0);
                assert!(near, "{number}/{count}: {quarters:?}");
            }
        }
        assert!(dealt.iter().all(|times| *times == 1), "{count} shards");
    }
}

/// No ray is cast twice; what is complete is not written again, and is a part like any other.
#[test]
fn a_stopped_render_resumes_to_the_same_bits() {
    for scene in &scenes() {
        for tracer in TRACERS {
            let options = RenderOptions { tracer, seed: 4, ..options() };
            let whole = render_on(1, scene, &options);
            let folder = folder();
            let file = folder.path().join("a.kept");
            let go = |resume, share| {
                let checkpoint = checkpoint(&file, resume);
                let session = begin(scene, &options, None, Some(&checkpoint));
                let session = session.unwrap_or_else(|error| panic!("{error}"));
                render_until(scene, &session, share)
            };
            let mut rays = 0;
            for (resume, share) in [(false, 0.2), (true, 0.5), (true, 0.0), (true, 2.0)] {
                let rendered = go(resume, share);
                rays += rendered.counters.rays.primary;
                assert_eq!(rendered.finished, share > 1.0);
                assert!(!rendered.finished || rendered.film.same_bits(&whole.film), "{tracer:?}");
            }
            let at_once = begin(scene, &options, None, None)
                .and_then(|session| session.render(scene, &(), &no_warning));
            assert_eq!(rays, at_once.expect("a film").counters.rays.primary);
            let before = std::fs::read(&file).expect("a checkpoint");
            let again = go(true, 2.0);
            assert_eq!(again.counters.rays.primary, 0);
            assert!(again.finished && again.film.same_bits(&whole.film));
            assert_eq!(std::fs::read(&file).expect("a checkpoint"), before);
            assert!(merge(&[file]).expect("a part").film.same_bits(&whole.film));
        }
    }
}
