//! Random numbers as a pure function of their place in the render.
//!
//! Philox 4x32-10 of Salmon, Moraes, Dror and Shaw, *Parallel Random Numbers: As Easy as 1, 2, 3*
//! (SC 2011): a keyed bijection of a 128-bit counter, whose output passes BigCrush for any counter
//! order. The key is the seed; the counter is (pixel, sample, bounce, dimension). A number
//! therefore does not depend on threads, batches, tracer or machine.

use std::convert::Infallible;

use rand::TryRng;
use rand::rand_core::block::{self, BlockRng};

/// The place of a random number in a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    /// The render's seed.
    pub seed: u64,
    /// The pixel: its row times the image's width plus its column.
    pub pixel: u32,
    /// The camera ray within the pixel.
    pub sample: u32,
    /// The number of rays of the path before this one.
    pub bounce: u32,
}

impl Stream {
    /// The four random words of `dimension`.
    #[inline(always)]
    pub fn words(&self, dimension: u32) -> [u32; 4] {
        let key = [self.seed as u32, (self.seed >> 32) as u32];
        philox_4x32_10([self.pixel, self.sample, self.bounce, dimension], key)
    }

    /// The four random numbers of `dimension`, each uniform in \[0, 1).
    #[inline(always)]
    pub fn uniform(&self, dimension: u32) -> [f32; 4] {
        self.words(dimension).map(unit_interval)
    }

    /// A generator for the `rand` crate: the words from `dimension` on, in order.
    pub fn generator(self, dimension: u32) -> Generator {
        Generator(BlockRng::new(Blocks { stream: self, dimension }))
    }
}

/// The words of a [`Stream`], from a dimension on, in blocks.
#[derive(Clone, Debug)]
struct Blocks {
    stream: Stream,
    dimension: u32,
}

impl block::Generator for Blocks {
    type Output = [u32; 4];

    fn generate(&mut self, words: &mut [u32; 4]) {
        *words = self.stream.words(self.dimension);
        self.dimension = self.dimension.wrapping_add(1);
    }
}

/// The words of a [`Stream`] as a generator of the `rand` crate.
#[derive(Clone, Debug)]
pub struct Generator(BlockRng<Blocks>);

impl TryRng for Generator {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.0.next_word())
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.0.next_u64_from_u32())
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.0.fill_bytes(bytes);
        Ok(())
    }
}

/// The upper 24 bits of `word` as a fraction in \[0, 1): every value is exact in `f32`.
#[inline(always)]
pub fn unit_interval(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

/// Philox 4x32 with ten rounds.
#[inline(always)]
pub fn philox_4x32_10(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    const MULTIPLIER: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    for _ in 0..10 {
        let a = MULTIPLIER[0] * u64::from(counter[0]);
        let b = MULTIPLIER[1] * u64::from(counter[2]);
        counter = [
            (b >> 32) as u32 ^ counter[1] ^ key[0],
            b as u32,
            (a >> 32) as u32 ^ counter[3] ^ key[1],
            a as u32,
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;

    /// The known answers that the authors publish with Random123.
    #[test]
    fn philox_gives_the_published_answers() {
        let cases = [
            ([0; 4], [0; 2], [0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8]),
            ([!0; 4], [!0; 2], [0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd]),
            (
                [0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344],
                [0xa4093822, 0x299f31d0],
                [0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1],
            ),
        ];
        for (counter, key, answer) in cases {
            assert_eq!(philox_4x32_10(counter, key), answer);
        }
    }

    #[test]
    fn the_generator_hands_out_the_same_words() {
        let stream = Stream { seed: 3, pixel: 1, sample: 4, bounce: 1 };
        let mut generator = stream.generator(5);
        let drawn: Vec<u32> = (0..8).map(|_| generator.random()).collect();
        assert_eq!(drawn, [stream.words(5), stream.words(6)].concat());
    }
}
