//! Frames of a moving camera.

use std::str::FromStr;

use crate::common::whole;
use wavecrest_image::farm::Shard;

/// Largest number of frames in a range.
const MAX_FRAMES: u32 = 1_000_000;

/// Options on frames.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FrameOptions {
    /// Render this frame of the camera's path
    #[arg(long, value_name = "N", value_parser = whole(0..=u32::MAX))]
    pub(crate) frame: Option<u32>,
    /// Render frames A to B, one image each; every # in the output's name stands for a digit of the frame number.
    /// With --shard, each shard renders whole frames
    #[arg(long, value_name = "A..B", conflicts_with_all = ["frame", "stats", "checkpoint", "target_error", "time_budget", "save_every"])]
    pub(crate) frames: Option<Frames>,
}

/// A range of frames, inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Frames {
    first: u32,
    last: u32,
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parsed = text.split_once("..").and_then(|(first, last)| {
            let (first, last) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
            (first <= last && last - first < MAX_FRAMES).then_some(Self { first, last })
        });
        parsed.ok_or_else(|| {
            format!("write the first frame and the last, such as 1..24; at most {MAX_FRAMES}")
        })
    }
}

impl Frames {
    /// `count` frames, at least one, from 1 on.
    pub(in crate::render) fn first(count: u32) -> Self {
        Self { first: 1, last: count }
    }

    /// The frames of a shard: each of N shards takes every N-th.
    pub(in crate::render) fn of(self, shard: Option<Shard>) -> Vec<u32> {
        let (number, count) = shard.map_or((1, 1), |shard| (shard.number(), shard.count()));
        (self.first..=self.last).skip(number as usize - 1).step_by(count as usize).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_take_every_frame_once() {
        let frames: Frames = "3..12".parse().unwrap();
        let mut all: Vec<u32> =
            (1..=4).flat_map(|i| frames.of(Some(Shard::new(i, 4).unwrap()))).collect();
        all.sort_unstable();
        assert_eq!(all, (3..=12).collect::<Vec<_>>());
        for wrong in ["12..3", "1", "a..b", "0..1000000", "-1..3"] {
            assert!(wrong.parse::<Frames>().is_err(), "{wrong}");
        }
    }
}
