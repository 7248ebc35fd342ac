use super::*;

fn all<S: Lanes>(
    simd: S,
    near: [f32; 8],
    mask: u8,
    indices: [u32; 8],
) -> (Vec<u64>, Vec<u64>, [f32; 8]) {
    let children = [10, 11, 12, 13, 14, 15, 16, 17].simd_into(simd);
    let (mut sorted, mut compressed) = ([0; LANES], [0; LANES]);
    let entries = simd.entries(near.simd_into(simd), children);
    simd.far_to_near(&entries, mask, &mut sorted);
    simd.compress(&entries, mask, &mut compressed);
    let count = mask.count_ones() as usize;
    let values: [f32; 8] = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5];
    let permuted = simd.permute(values.simd_into(simd), indices.simd_into(simd));
    (sorted[..count].to_vec(), compressed[..count].to_vec(), permuted.into())
}

#[test]
fn every_level_sorts_compresses_and_permutes() {
    for level in Level::available() {
        let token = level.token().expect("it is available");
        for seed in 0..2000_u32 {
            let random = |i: u32| (seed * 8 + i).wrapping_mul(0x9E37_79B1) >> 8;
            let near = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| (random(i) % 1000) as f32 / 8.0);
            let mask = random(99) as u8;
            let indices = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| random(i) % 8);
            let mut expected: Vec<u64> = (0..8)
                .filter(|i| mask >> i & 1 == 1)
                .map(|i| entry(near[i], 10 + i as u32))
                .collect();
            let (sorted, compressed, permuted) =
                at_level!(token, simd => all(simd, near, mask, indices));
            assert_eq!(compressed, expected, "{level:?}");
            expected.sort_unstable_by(|a, b| b.cmp(a));
            assert_eq!(sorted, expected, "{level:?}");
            assert_eq!(permuted, indices.map(|i| i as f32 + 0.5), "{level:?}");
        }
    }
}
