use super::*;

fn pixels(tile: [u32; 2]) -> Vec<[u32; 2]> {
    let mut walk = TileWalk::new(tile, 0);
    let step = |_| {
        let pixel = walk.pixel;
        walk.advance();
        pixel
    };
    (0..tile[0] * tile[1]).map(step).collect()
}

#[test]
fn every_pixel_is_taken_once() {
    for tile in [[64, 64], [32, 24], [8, 3], [3, 8], [1, 1], [13, 7], [29, 45], [61, 8]] {
        let mut found = pixels(tile);
        found.sort_unstable();
        let columns = 0..tile[0];
        let all: Vec<_> = columns.flat_map(|x| (0..tile[1]).map(move |y| [x, y])).collect();
        assert_eq!(found, all, "{tile:?}");
    }
}

#[test]
fn a_walk_can_begin_anywhere() {
    let tile = [29, 21];
    for (taken, pixel) in pixels(tile).into_iter().enumerate() {
        assert_eq!(TileWalk::new(tile, taken as u32).pixel, pixel, "{taken}");
    }
}

/// Runs of a power of four are squares wherever blocks are whole, and those come first.
#[test]
fn runs_are_squares() {
    let all = pixels([29, 21]);
    for side in [2, 4, 8] {
        let whole = &all[..24 * 16];
        for run in whole.chunks_exact((side * side) as usize) {
            let [x, y] = run[0];
            assert_eq!([x % side, y % side], [0, 0]);
            let within = |p: &[u32; 2]| p[0] / side == x / side && p[1] / side == y / side;
            assert!(run.iter().all(within), "{run:?}");
        }
    }
}
