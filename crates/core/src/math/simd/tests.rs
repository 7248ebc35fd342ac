use super::*;

#[inline(always)]
fn all<S: Lanes>(
    simd: S,
    entries: &[u64; LANES],
    count: usize,
    indices: [u32; 8],
) -> (Vec<u64>, [f32; 8]) {
    let mut sorted = [0; LANES];
    simd.far_to_near(entries, count, &mut sorted);
    let values: [f32; 8] = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5];
    let permuted = simd.permute(values.simd_into(simd), indices.simd_into(simd));
    (sorted[..count].to_vec(), permuted.into())
}

#[test]
fn every_level_sorts_and_permutes() {
    for level in Level::available() {
        let token = level.token().expect("it is available");
        for seed in 0..2000_u32 {
            let random = |i: u32| (seed * 8 + i).wrapping_mul(0x9E37_79B1) >> 8;
            let count = random(99) as usize % (LANES + 1);
            let mut expected: Vec<u64> =
                (0..count as u32).map(|i| entry((random(i) % 1000) as f32 / 8.0, 10 + i)).collect();
            let mut entries = [0; LANES];
            entries[..count].copy_from_slice(&expected);
            let indices = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| random(i) % 8);
            let (sorted, permuted) = at_level!(token, simd => all(simd, &entries, count, indices));
            expected.sort_unstable_by(|a, b| b.cmp(a));
            assert_eq!(sorted, expected, "{level:?}");
            assert_eq!(permuted, indices.map(|i| i as f32 + 0.5), "{level:?}");
        }
    }
}
