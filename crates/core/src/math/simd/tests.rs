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

#[inline(always)]
fn entries<S: Lanes>(simd: S, near: [f32; 8], children: [u32; 8], mask: u32) -> [u64; LANES] {
    let mask = mask32x8::from_bitmask(simd, u64::from(mask));
    simd.entries(near.simd_into(simd), children.simd_into(simd), mask)
}

#[test]
fn entries_of_every_mask_come_first_whatever_their_distance() {
    let near = [0.0, -0.0, 1.5, f32::NEG_INFINITY, f32::INFINITY, -2.5, f32::MIN_POSITIVE, 1e-40];
    let children = [9, u32::MAX, 7, 6, 5, 4, 3, 0];
    for level in Level::available() {
        let token = level.token().expect("it is available");
        for mask in 0..256_u32 {
            let mut expected = [0; LANES];
            let met = (0..LANES).filter(|lane| mask >> lane & 1 == 1);
            for (place, lane) in expected.iter_mut().zip(met) {
                *place = entry(near[lane], children[lane]);
            }
            let found = at_level!(token, simd => entries(simd, near, children, mask));
            assert_eq!(found, expected, "{level:?} {mask:#b}");
        }
    }
}
