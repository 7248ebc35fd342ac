//! The part file: sums of finished units, and the identity of their image.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `WAVEPART` |
//! | 4 | the format's version, 3 |
//! | 4 | the length of the header |
//! | ... | the [`PartHeader`], in JSON |
//! | 8 | the hash of everything above |
//! | | then for each unit, in the order of tiles and, within a tile, of samples: |
//! | 4, 4, 4 | tile, number of samples of each pixel, number of pixels |
//! | 8 | samples that were not finite |
//! | 24 for each pixel | the sums, row by row: red, green and blue, as 64-bit floats |
//! | 8 | the hash of the unit, seeded with that of the header |
//!
//! All numbers are little-endian; hashes are XXH3 with 64 bits. They detect damage, not attacks. A
//! reader allocates memory for one unit at a time, and a unit is no longer than its tile requires.

use std::fs::File;
use std::io::{BufReader, ErrorKind as IoKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64_with_seed;

use super::identity::Identity;
use super::shard::Shard;
use crate::transfer::Transfer;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::read::open;
use wavecrest_base::replace::{Sink, replace_file, write_error};
use wavecrest_core::render::work::Summed;

/// The first bytes of a part.
const MAGIC: &[u8; 8] = b"WAVEPART";

/// The format's version.
const VERSION: u32 = 3;

/// Largest header in bytes: the system limits a command line to 2 MiB.
const MAX_HEADER_BYTES: u32 = 4 << 20;

/// Bytes of a unit without its sums.
const UNIT_BYTES: u64 = 3 * 4 + 8 + 8;

/// The origin of a render, recorded in its files.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Author {
    /// The scene's file as given; informative only.
    pub scene: String,
    /// The command; informative only.
    pub command: Vec<String>,
    /// The transfer curve of 8-bit images: a merge uses the same unless another is requested.
    pub transfer: Transfer,
}

/// The header of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartHeader {
    /// The image that it belongs to.
    pub identity: Identity,
    /// The shard to render; `None` for all.
    pub shard: Option<Shard>,
    /// Its origin.
    #[serde(flatten)]
    pub author: Author,
    /// The passes so far.
    pub pass: Pass,
    /// Number of units in the file.
    pub units: u64,
}

/// The passes of a render so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// The number of samples of each pixel after the last finished pass.
    pub from: u32,
    /// That after the pass that is begun; the same if none is.
    pub to: u32,
    /// The error of the image after the last finished pass, if it is known: root mean squared error of linear values.
    pub error: Option<f64>,
    /// The number of samples after the last pass that doubled it.
    pub half: u32,
    /// The error then, and half of the difference between the first half of these samples and the second.
    pub half_error: Option<[f64; 2]>,
}

/// The samples of a tile of [`Identity::grid`] so far.
#[derive(Clone, Debug)]
pub struct StoredUnit {
    /// The tile's number.
    pub tile: u32,
    /// The number of samples of each pixel.
    pub samples: u32,
    /// How many of them were not finite.
    pub invalid: u64,
    /// Their sum for each pixel, row by row.
    pub sums: Arc<[[f64; 3]]>,
}

impl StoredUnit {
    /// The same, borrowed.
    pub(super) fn summed(&self) -> Summed<'_> {
        let Self { tile, samples, invalid, ref sums } = *self;
        Summed { tile, samples, invalid, sums }
    }
}

/// Writes a part with these units, in order, or leaves the file at `path` unchanged.
///
/// # Errors
/// As [`replace_file`].
pub fn write<'a>(
    path: &Path,
    header: &PartHeader,
    units: impl IntoIterator<Item = &'a StoredUnit>,
) -> Result<()> {
    replace_file(path, |sink| {
        let json = serde_json::to_vec(header).map_err(|error| {
            Error::new(ErrorKind::Io, format!("cannot write JSON: {error}")).because(error)
        })?;
        let length = json.len() as u32;
        let bytes = [&MAGIC[..], &VERSION.to_le_bytes(), &length.to_le_bytes(), &json].concat();
        let seed = put(sink, path, 0, &bytes)?;
        units.into_iter().try_for_each(|unit| put(sink, path, seed, &unit_bytes(unit)).map(drop))
    })
}

/// Writes bytes and their hash, which it returns.
fn put(sink: &mut Sink<'_>, path: &Path, seed: u64, bytes: &[u8]) -> Result<u64> {
    let hash = xxh3_64_with_seed(bytes, seed);
    let written = sink.write_all(bytes).and_then(|()| sink.write_all(&hash.to_le_bytes()));
    written.map(|()| hash).map_err(|error| write_error(path, error))
}

fn unit_bytes(StoredUnit { tile, samples, invalid, sums }: &StoredUnit) -> Vec<u8> {
    let numbers = [*tile, *samples, sums.len() as u32];
    let mut bytes = numbers.map(u32::to_le_bytes).concat();
    bytes.extend(invalid.to_le_bytes());
    bytes.extend(sums.as_flattened().iter().flat_map(|sum| sum.to_le_bytes()));
    bytes
}

/// A part read unit by unit.
#[derive(Debug)]
pub struct PartReader {
    path: PathBuf,
    /// The header.
    pub header: PartHeader,
    /// The length of the file, in bytes.
    pub length: u64,
    file: BufReader<File>,
    /// The hash of the header.
    seed: u64,
    read: u64,
    /// The tile of the last unit, and its number of samples.
    last: Option<(u32, u32)>,
}

impl PartReader {
    /// Reads the header of the part at `path`.
    ///
    /// # Errors
    /// If the file cannot be read, is not a part, has another version, or is damaged.
    pub fn open(path: &Path) -> Result<Self> {
        Self::open_it(path).map_err(|error| error.in_file(path))
    }

    fn open_it(path: &Path) -> Result<Self> {
        let failed = |error| Error::io("cannot read the part", path, error);
        let (file, length) = open(path).map_err(failed)?;
        let mut file = BufReader::new(file);
        let (header, seed) = header(&mut file, length)?;
        header.identity.check()?;
        let Pass { half, from, to, .. } = header.pass;
        if half > from || from > to || to > header.identity.samples {
            return Err(damaged("its numbers of samples are wrong"));
        }
        Ok(Self { path: path.to_owned(), header, length, file, seed, read: 0, last: None })
    }

    /// The next unit, or `None` after the last.
    ///
    /// # Errors
    /// If the file is truncated or damaged, or continues after its last unit.
    pub fn next_unit(&mut self) -> Result<Option<StoredUnit>> {
        let place = format!("unit {} of {}", self.read + 1, self.header.units);
        self.read_unit().map_err(|error| error.in_file(&self.path).at(place))
    }

    fn read_unit(&mut self) -> Result<Option<StoredUnit>> {
        if self.read == self.header.units {
            let mut more = [0];
            return match self.file.read(&mut more) {
                Ok(0) => Ok(None),
                Ok(_) => Err(damaged("there is more after its last unit")),
                Err(error) => Err(read_error(error)),
            };
        }
        let mut bytes = Vec::new();
        extend(&mut self.file, &mut bytes, 3 * 4)?;
        let [tile, samples, pixels] = [0, 1, 2].map(|n| number(&bytes, n));
        let length = self.length(tile, samples, pixels)?;
        extend(&mut self.file, &mut bytes, 8)?;
        let invalid = long(&bytes[3 * 4..], 0);
        let start = bytes.len();
        extend(&mut self.file, &mut bytes, length * size_of::<[f64; 3]>())?;
        check_hash(&mut self.file, &bytes, self.seed)?;
        let sum = |bytes: &[u8]| [0, 1, 2].map(|n| f64::from_bits(long(bytes, n)));
        let sums = bytes[start..].chunks_exact(size_of::<[f64; 3]>()).map(sum).collect();
        self.read += 1;
        self.last = Some((tile, samples));
        Ok(Some(StoredUnit { tile, samples, invalid, sums }))
    }

    /// The number of pixels of a unit, if such a unit is possible at this place.
    fn length(&self, tile: u32, samples: u32, pixels: u32) -> Result<usize> {
        let follows = self.last.is_none_or(|last| last < (tile, samples));
        let PartHeader { identity, pass, .. } = &self.header;
        let grid = identity.grid();
        if tile >= grid.len() || samples == 0 || samples > pass.to {
            return Err(damaged("there is no such unit in its image"));
        }
        let length = grid.tile(tile).len();
        if !follows || pixels as usize != length {
            return Err(damaged("a unit is malformed"));
        }
        Ok(length)
    }
}

/// The header and its hash, from a file of `length` bytes.
fn header(file: &mut BufReader<File>, length: u64) -> Result<(PartHeader, u64)> {
    let foreign = || {
        Error::new(ErrorKind::Syntax, "this is not a part of a render")
            .remedy("use a file that wavecrest wrote with --shard or --checkpoint")
    };
    let mut bytes = Vec::new();
    if length < 16 {
        return Err(foreign());
    }
    extend(file, &mut bytes, 16)?;
    let [version, json] = [2, 3].map(|n| number(&bytes, n));
    if &bytes[..8] != MAGIC {
        return Err(foreign());
    }
    if version != VERSION {
        return Err(Error::new(ErrorKind::Syntax, "the part has another format version")
            .value(version)
            .remedy(format!("this program reads version {VERSION}; render it again")));
    }
    if json > MAX_HEADER_BYTES || u64::from(json) + 16 > length {
        return Err(damaged("its header is too long"));
    }
    extend(file, &mut bytes, json as usize)?;
    let hash = check_hash(file, &bytes, 0)?;
    let header: PartHeader = serde_json::from_slice(&bytes[16..]).map_err(|error| {
        Error::new(ErrorKind::Syntax, format!("the header is malformed: {error}"))
            .remedy("render it again")
            .because(error)
    })?;
    let rest = length - bytes.len() as u64;
    if header.units > rest / UNIT_BYTES {
        return Err(damaged("it is cut short").value(format!("{length} bytes")));
    }
    Ok((header, hash))
}

/// Reads the hash that follows `bytes` in the file and checks it.
fn check_hash(file: &mut impl Read, bytes: &[u8], seed: u64) -> Result<u64> {
    let mut found = [0; 8];
    file.read_exact(&mut found).map_err(read_error)?;
    let hash = xxh3_64_with_seed(bytes, seed);
    if u64::from_le_bytes(found) == hash {
        return Ok(hash);
    }
    Err(damaged("its checksum is wrong"))
}

/// Appends the next `count` bytes of the file.
fn extend(file: &mut impl Read, bytes: &mut Vec<u8>, count: usize) -> Result<()> {
    let start = bytes.len();
    bytes.resize(start + count, 0);
    file.read_exact(&mut bytes[start..]).map_err(read_error)
}

fn read_error(error: std::io::Error) -> Error {
    if error.kind() == IoKind::UnexpectedEof {
        return damaged("it is cut short");
    }
    Error::new(ErrorKind::Io, format!("cannot read the part: {error}")).because(error)
}

fn damaged(how: &str) -> Error {
    Error::new(ErrorKind::Syntax, format!("the part is damaged: {how}")).remedy("render it again")
}

/// The `n`th number of four bytes; 0 if it is missing.
fn number(bytes: &[u8], n: usize) -> u32 {
    bytes.as_chunks().0.get(n).map_or(0, |bytes| u32::from_le_bytes(*bytes))
}

/// The `n`th number of eight bytes; 0 if it is missing.
fn long(bytes: &[u8], n: usize) -> u64 {
    bytes.as_chunks().0.get(n).map_or(0, |bytes| u64::from_le_bytes(*bytes))
}
