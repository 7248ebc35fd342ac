//! Merges parts into an image, if they belong to the same image and are complete.
//!
//! Parts are read in turn, in any order, unit by unit. A tile whose blocks are all in one unit is
//! painted at once; separate blocks wait for those before them, as they are added in order.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use xxhash_rust::xxh3::xxh3_64;

use super::identity::Identity;
use super::part::{PartHeader, PartReader, UnitSums};
use super::shard::Shard;
use crate::transfer::Transfer;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::Film;
use wavecrest_core::render::Canvas;
use wavecrest_core::render::units::Grid;
use wavecrest_core::render::work::{Summed, add};
use wavecrest_core::tile::Tile;

/// Largest number of shards in a message.
const MAX_NAMED_SHARDS: usize = 8;

/// The merged image.
#[derive(Clone, Debug)]
pub struct Merged {
    /// Its inputs.
    pub identity: Identity,
    /// The transfer curve of 8-bit images.
    pub transfer: Transfer,
    /// The image.
    pub film: Film,
    /// Samples that were not finite; they count as black.
    pub invalid: u64,
}

/// Merges the parts at `paths`. Repeated parts count once.
///
/// # Errors
/// If a part cannot be read, is damaged, or belongs to another image than the first; if two differ
/// where they overlap; or if something is missing.
pub fn merge(paths: &[PathBuf]) -> Result<Merged> {
    let Some((first, rest)) = paths.split_first() else {
        return Err(Error::new(ErrorKind::Usage, "there is nothing to merge")
            .remedy("name the parts that render --shard wrote"));
    };
    let header = PartReader::open(first)?.header().clone();
    let mut shards = vec![header.shard];
    for path in rest {
        let other = PartReader::open(path)?.header().clone();
        check_same(path, &other, first, &header)?;
        shards.push(other.shard);
    }
    let (grid, blocks) = (header.identity.grid(), header.identity.blocks());
    // Allocate only an image that the parts can fill, whatever size they claim.
    let length = |path: &PathBuf| match path.metadata() {
        Ok(data) => Ok(data.len()),
        Err(error) => Err(Error::io("cannot read the part", path, error)),
    };
    let held: u64 = paths.iter().map(length).sum::<Result<_>>()?;
    let pixels = grid.window().len() as u64;
    if held < pixels * size_of::<[f64; 3]>() as u64 {
        return Err(incomplete(&shards, format!("{held} bytes of parts for {pixels} pixels")));
    }
    let mut mosaic = Mosaic {
        canvas: Canvas::new(grid, blocks, &())?,
        paths,
        grid,
        blocks: blocks.count(),
        units: BTreeMap::new(),
        waiting: BTreeMap::new(),
        invalid: 0,
    };
    for (number, path) in paths.iter().enumerate() {
        let mut reader = PartReader::open(path)?;
        check_same(path, reader.header(), first, &header)?;
        while let Some(unit) = reader.next_unit()? {
            mosaic.put(number, unit)?;
        }
    }
    let invalid = mosaic.invalid;
    let film = mosaic.finish().map_err(|gap| incomplete(&shards, gap))?;
    Ok(Merged { identity: header.identity, transfer: header.transfer, film, invalid })
}

fn check_same(path: &Path, other: &PartHeader, first: &Path, header: &PartHeader) -> Result<()> {
    let Some((what, values)) = other.identity.difference(&header.identity) else {
        return Ok(());
    };
    let first = first.display();
    let message = format!("the {what} differs from that of {first}");
    let error = Error::new(ErrorKind::Usage, message).in_file(path);
    Err(match values {
        Some([found, expected]) => {
            error.value(found).remedy(format!("{first} has {expected}; merge parts of one image"))
        }
        None => error.remedy("merge parts of one scene, and do not change it between renders"),
    })
}

/// The error for missing parts: whole shards, or else `found`.
fn incomplete(shards: &[Option<Shard>], found: String) -> Error {
    let error = |message: String| Error::new(ErrorKind::Usage, message);
    match missing(shards).as_slice() {
        [] => error("the parts do not make a whole image".to_owned())
            .value(found)
            .remedy("render what is missing and merge again"),
        [one] => error(format!("shard {one} is missing"))
            .remedy(format!("render it with --shard {one}, or add its file, and merge again")),
        several => error(format!("shards {} are missing", list(several)))
            .remedy("render them with --shard, or add their files, and merge again"),
    }
}

/// The shards without a part, if all parts are shards with the same count.
fn missing(shards: &[Option<Shard>]) -> Vec<Shard> {
    let there: Option<BTreeSet<(u32, u32)>> =
        shards.iter().map(|shard| shard.map(|s| (s.count(), s.number()))).collect();
    let Some(there) = there else { return Vec::new() };
    let Some(&(count, _)) = there.first() else { return Vec::new() };
    if there.iter().any(|(other, _)| *other != count) {
        return Vec::new();
    }
    let absent = (1..=count).filter(|number| !there.contains(&(count, *number)));
    absent.take(MAX_NAMED_SHARDS + 1).filter_map(|number| Shard::new(number, count)).collect()
}

/// `2/7, 3/7`.
fn list(shards: &[Shard]) -> String {
    let names: Vec<String> = shards.iter().take(MAX_NAMED_SHARDS).map(Shard::to_string).collect();
    let more = if shards.len() > MAX_NAMED_SHARDS { " and others" } else { "" };
    format!("{}{more}", names.join(", "))
}

/// The image during the merge.
struct Mosaic<'a> {
    canvas: Canvas<'static>,
    paths: &'a [PathBuf],
    grid: Grid,
    /// The number of blocks of a tile.
    blocks: u32,
    /// The units so far, by tile and first block: the end of their blocks (exclusive), the hash of
    /// their sums, and the number of their part.
    units: BTreeMap<(u32, u32), (u32, u64, usize)>,
    /// Tiles whose blocks are in several units.
    waiting: BTreeMap<u32, UnfinishedTile>,
    invalid: u64,
}

/// The blocks of a tile so far.
#[derive(Default)]
struct UnfinishedTile {
    /// Number of blocks added up, from the first on.
    ready: u32,
    sums: Vec<[f64; 3]>,
    /// Later blocks, by the first of each unit.
    later: BTreeMap<u32, UnitSums>,
}

impl Mosaic<'_> {
    /// Adds a unit of the `number`th part.
    fn put(&mut self, number: usize, unit: UnitSums) -> Result<()> {
        if self.is_known(number, &unit)? {
            return Ok(());
        }
        self.invalid += unit.invalid;
        if unit.blocks == (0..self.blocks) {
            self.paint(unit.tile, &unit.sums);
            return Ok(());
        }
        let tile = unit.tile;
        let waiting = self.waiting.entry(tile).or_default();
        waiting.later.insert(unit.blocks.start, unit);
        waiting.add_up();
        if waiting.ready == self.blocks {
            let sums = std::mem::take(&mut waiting.sums);
            self.waiting.remove(&tile);
            self.paint(tile, &sums);
        }
        Ok(())
    }

    fn paint(&mut self, tile: u32, sums: &[[f64; 3]]) {
        let blocks = 0..self.blocks;
        self.canvas.keep(&Summed { tile, blocks, invalid: 0, sums });
    }

    /// Whether the same unit was read already, to the last bit; records it if not.
    fn is_known(&mut self, number: usize, unit: &UnitSums) -> Result<bool> {
        let UnitSums { tile, blocks: Range { start, end }, .. } = *unit;
        let hash = xxh3_64(bytemuck::cast_slice(&unit.sums));
        let others = self.units.range((tile, 0)..(tile, end));
        let Some((&(_, from), &(to, known, part))) = others.rev().find(|(_, unit)| unit.0 > start)
        else {
            self.units.insert((tile, start), (end, hash, number));
            return Ok(false);
        };
        if (from, to) != (start, end) {
            return Err(self.conflict(number, part, tile, "it overlaps"));
        }
        if hash != known {
            return Err(self.conflict(number, part, tile, "it differs from"));
        }
        Ok(true)
    }

    fn conflict(&self, number: usize, other: usize, tile: u32, how: &str) -> Error {
        let Tile { x, y, .. } = self.grid.tile(tile);
        Error::new(ErrorKind::Usage, format!("{how} {}", self.paths[other].display()))
            .in_file(&self.paths[number])
            .at(format!("tile at {x},{y}"))
            .remedy("remove one of the two, or render both again")
    }

    /// The image, or the description of a gap.
    fn finish(self) -> std::result::Result<Film, String> {
        let found = self.canvas.finish();
        let painted: BTreeSet<(u32, u32)> = found.tiles.iter().map(|t| (t.x, t.y)).collect();
        let all = (0..self.grid.len()).map(|number| self.grid.tile(number)).map(|t| (t.x, t.y));
        let missing: Vec<(u32, u32)> = all.filter(|tile| !painted.contains(tile)).collect();
        match missing.first() {
            None => Ok(found.film),
            Some((x, y)) => Err(format!("{} tiles missing, the first at {x},{y}", missing.len())),
        }
    }
}

impl UnfinishedTile {
    /// Adds the blocks whose turn has come.
    fn add_up(&mut self) {
        while let Some(unit) = self.later.remove(&self.ready) {
            if self.ready == 0 {
                self.sums = unit.sums;
            } else {
                add(&mut self.sums, &unit.sums);
            }
            self.ready = unit.blocks.end;
        }
    }
}
