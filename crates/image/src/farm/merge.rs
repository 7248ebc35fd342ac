//! Merges parts into an image, if they belong to the same image and are complete.
//!
//! Parts are read in turn, in any order, unit by unit.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use xxhash_rust::xxh3::xxh3_64;

use super::identity::Identity;
use super::part::{PartHeader, PartReader, StoredUnit};
use super::shard::Shard;
use crate::transfer::Transfer;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::Film;
use wavecrest_core::render::Canvas;
use wavecrest_core::render::units::Grid;
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
    let PartReader { header, length, .. } = PartReader::open(first)?;
    let (mut shards, mut held) = (vec![header.shard], length);
    for path in rest {
        let PartReader { header: other, length, .. } = PartReader::open(path)?;
        check_same(path, &other, first, &header)?;
        shards.push(other.shard);
        held += length;
    }
    let (grid, samples) = (header.identity.grid(), header.identity.samples);
    // Allocate only an image that the parts can fill, whatever size they claim.
    let pixels = grid.window.len() as u64;
    if held < pixels * size_of::<[f64; 3]>() as u64 {
        return Err(incomplete(&shards, format!("{held} bytes of parts for {pixels} pixels")));
    }
    let mut mosaic = Mosaic {
        canvas: Canvas::new(grid, samples, &())?,
        paths,
        grid,
        samples,
        known: BTreeMap::new(),
        invalid: 0,
    };
    for (number, path) in paths.iter().enumerate() {
        let mut reader = PartReader::open(path)?;
        check_same(path, &reader.header, first, &header)?;
        while let Some(unit) = reader.next_unit()? {
            mosaic.put(number, &unit)?;
        }
    }
    let invalid = mosaic.invalid;
    let film = mosaic.finish().map_err(|gap| incomplete(&shards, gap))?;
    Ok(Merged { identity: header.identity, transfer: header.author.transfer, film, invalid })
}

fn check_same(path: &Path, other: &PartHeader, first: &Path, header: &PartHeader) -> Result<()> {
    let remedies = [
        "merge parts of one image",
        "merge parts of one scene, and do not change it between renders",
    ];
    let first = &*first.to_string_lossy();
    other.identity.check_same(path, &header.identity, [first; 2], remedies)
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
    /// The number of samples of a pixel.
    samples: u32,
    /// The tiles so far: the hash of their sums, and the number of their part.
    known: BTreeMap<u32, (u64, usize)>,
    invalid: u64,
}

impl Mosaic<'_> {
    /// Adds a unit of the `number`th part, if it has all samples.
    fn put(&mut self, number: usize, unit: &StoredUnit) -> Result<()> {
        let hash = xxh3_64(bytemuck::cast_slice(&unit.sums));
        if unit.samples < self.samples {
            return Ok(());
        }
        match self.known.insert(unit.tile, (hash, number)) {
            Some((other, part)) if other != hash => {
                return Err(self.conflict(number, part, unit.tile, "it differs from"));
            }
            Some(_) => {}
            None => {
                self.invalid += unit.invalid;
                self.canvas.keep(&unit.summed());
            }
        }
        Ok(())
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
        let is_missing = |number: &u32| !self.known.contains_key(number);
        let missing: Vec<u32> = (0..self.grid.len()).filter(is_missing).collect();
        match missing.first() {
            None => Ok(self.canvas.finish().film),
            Some(&first) => {
                let Tile { x, y, .. } = self.grid.tile(first);
                Err(format!("{} tiles missing, the first at {x},{y}", missing.len()))
            }
        }
    }
}
