//! Shards: the assignment of units to processes.
//!
//! Tiles are ordered along a Z-order curve, so that neighbours in the order are close together, and
//! dealt in turn. So every shard has a tile in each part of the image: equal shares of the easy and
//! the hard parts.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use wavecrest_core::render::units::Grid;

/// One of several equal shares of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    number: u32,
    count: u32,
}

impl Shard {
    /// The whole render.
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// Shard `number` of `count`, counted from 1; `None` if there is no such shard.
    pub fn new(number: u32, count: u32) -> Option<Self> {
        (1..=count).contains(&number).then_some(Self { number, count })
    }

    /// Its number, from 1.
    pub fn number(self) -> u32 {
        self.number
    }

    /// The number of shards.
    pub fn count(self) -> u32 {
        self.count
    }

    /// Its share of the tiles of an image, in order.
    pub fn tiles(self, grid: &Grid) -> Vec<u32> {
        let mut tiles: Vec<u32> = (0..grid.len()).collect();
        tiles.sort_by_key(|tile| along_z(tile % grid.columns(), tile / grid.columns()));
        let (first, count) = (self.number as usize - 1, self.count as usize);
        let mut own: Vec<u32> = tiles.into_iter().skip(first).step_by(count).collect();
        own.sort_unstable();
        own
    }
}

/// The interleaved bits of column and row: the Z-order.
fn along_z(column: u32, row: u32) -> u64 {
    let spread = |value: u32| {
        (0..u32::BITS).fold(0, |all, bit| all | u64::from(value >> bit & 1) << (2 * bit))
    };
    spread(column) | spread(row) << 1
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

/// `I/N`, such as `3/7`.
impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let numbers = text.split_once('/').map(|(one, other)| (one.parse(), other.parse()));
        let Some((Ok(number), Ok(count))) = numbers else {
            return Err("write the shard's number and their count, such as 3/7".to_owned());
        };
        Self::new(number, count).ok_or_else(|| match count {
            0 => "there must be at least one shard, such as 1/1".to_owned(),
            _ => format!("shards are numbered from 1 to {count}"),
        })
    }
}
