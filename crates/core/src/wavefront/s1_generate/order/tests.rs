use super::*;

/// Runs of a power of four are squares wherever blocks are whole, and those come first.
#[test]
fn runs_are_squares() {
    let mut walk = TileWalk::new([29, 21], 0);
    let step = |_| {
        let pixel = walk.pixel;
        walk.advance();
        pixel
    };
    let whole: Vec<[u32; 2]> = (0..24 * 16).map(step).collect();
    for side in [2, 4, 8] {
        for run in whole.chunks_exact((side * side) as usize) {
            let [x, y] = run[0];
            assert_eq!([x % side, y % side], [0, 0]);
            let within = |p: &[u32; 2]| p[0] / side == x / side && p[1] / side == y / side;
            assert!(run.iter().all(within), "{run:?}");
        }
    }
}
