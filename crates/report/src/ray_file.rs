//! Ray files: rays with their answers, to compare tracers on the same rays.
//!
//! All numbers are little-endian.
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | 8 bytes | `RAYDUMP1` |
//! | 8 | u32 | version, 1 |
//! | 12 | u32 | 1 for any-hit rays |
//! | 16 | u64 | number of rays n |
//! | 24 | u64 | number of triangles of the mesh |
//! | 32 | 32 bytes | zero |
//! | 64 | n x 8 f32 | origin x y z, t_min, direction x y z, t_max |
//! | 64 + 32 n | n x f32 | closest t, infinite for a miss |
//! | 64 + 36 n | n x u32 | closest triangle, 0xffffffff for a miss |
//! | 64 + 40 n | n x u8 | 1 for a hit |

use std::io::Write;
use std::path::Path;

use bytemuck::cast_slice;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::read::open;
use wavecrest_base::replace::{replace_file, write_error};
use wavecrest_core::accel::Hit;
use wavecrest_core::math::ray::Ray;

const MAGIC: &[u8; 8] = b"RAYDUMP1";
const VERSION: u32 = 1;
const HEADER: usize = 64;
const RAY: usize = size_of::<Ray>();
/// Bytes of a ray with its answers.
const ROW: usize = RAY + 4 + 4 + 1;

/// Rays and their answers.
#[derive(Clone, Debug, PartialEq)]
pub struct RayFile {
    /// Whether the rays are any-hit queries.
    pub any_hit: bool,
    /// Number of triangles of the mesh.
    pub triangles: u64,
    /// The rays.
    pub rays: Vec<Ray>,
    /// The closest hit of each ray.
    pub closest: Vec<Hit>,
    /// Whether each ray hits anything.
    pub occluded: Vec<bool>,
}

impl RayFile {
    /// Reads the ray file at `path`.
    ///
    /// # Errors
    /// If it cannot be read, or does not match its header.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = open(path).and_then(|_| std::fs::read(path));
        let bytes = bytes.map_err(|e| Error::io("cannot read the rays", path, e))?;
        Self::parse(&bytes).map_err(|e| e.in_file(path))
    }

    fn parse(bytes: &[u8]) -> Result<Self> {
        let header = bytes.get(..HEADER).filter(|h| h.starts_with(MAGIC)).ok_or_else(|| {
            Error::new(ErrorKind::Syntax, "this is not a ray file")
                .remedy("a ray file begins with RAYDUMP1 and a header of 64 bytes")
        })?;
        let header: Vec<u32> = words(header).collect();
        let (version, any_hit) = (header[2], header[3] != 0);
        if version != VERSION {
            return Err(Error::new(ErrorKind::Syntax, "the version of the ray file is unknown")
                .at("byte 8")
                .value(version)
                .remedy("use version 1"));
        }
        let long = |at: usize| u64::from(header[at]) | u64::from(header[at + 1]) << 32;
        let (count, triangles) = (long(4), long(6));
        let expected = count.checked_mul(ROW as u64).and_then(|n| n.checked_add(HEADER as u64));
        if expected != Some(bytes.len() as u64) {
            return Err(Error::new(ErrorKind::Syntax, "the length of the ray file is wrong")
                .at("byte 16")
                .value(format!("{count} rays in {} bytes", bytes.len()))
                .remedy(format!("each ray takes {ROW} bytes after a header of {HEADER}")));
        }
        let n = count as usize;
        let (rays, answers) = bytes[HEADER..].split_at(RAY * n);
        let (distances, answers) = answers.split_at(4 * n);
        let (primitives, occluded) = answers.split_at(4 * n);
        let answers = words(distances).map(f32::from_bits).zip(words(primitives));
        Ok(Self {
            any_hit,
            triangles,
            rays: cast_slice(&words(rays).collect::<Vec<u32>>()).to_vec(),
            closest: answers.map(|(t, primitive)| Hit { t, primitive }).collect(),
            occluded: occluded.iter().map(|flag| *flag != 0).collect(),
        })
    }

    /// Writes the file to `path`, atomically.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        replace_file(path, |sink| self.write_to(sink).map_err(|e| write_error(path, e)))
    }

    fn write_to(&self, sink: &mut impl Write) -> std::io::Result<()> {
        sink.write_all(MAGIC)?;
        sink.write_all(&VERSION.to_le_bytes())?;
        sink.write_all(&u32::from(self.any_hit).to_le_bytes())?;
        sink.write_all(&(self.rays.len() as u64).to_le_bytes())?;
        sink.write_all(&self.triangles.to_le_bytes())?;
        sink.write_all(&[0; 32])?;
        let rays: &[u32] = cast_slice(&self.rays);
        let distances = self.closest.iter().map(|hit| hit.t.to_bits());
        let primitives = self.closest.iter().map(|hit| hit.primitive);
        for word in rays.iter().copied().chain(distances).chain(primitives) {
            sink.write_all(&word.to_le_bytes())?;
        }
        let flags: Vec<u8> = self.occluded.iter().map(|&o| u8::from(o)).collect();
        sink.write_all(&flags)
    }
}

/// The numbers of four bytes.
fn words(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn what_is_written_is_read_again_but_not_a_part_of_it() {
        let ray = Ray { t_max: 7.5, ..Ray::new(Vec3::new(1.0, -2.0, 3.0), Vec3::NEG_Z) };
        let sample = RayFile {
            any_hit: true,
            triangles: 12,
            rays: vec![ray, Ray::new(Vec3::ZERO, Vec3::X)],
            closest: vec![Hit { t: 2.5, primitive: 7 }, Hit::MISS],
            occluded: vec![true, false],
        };
        let mut bytes = Vec::new();
        sample.write_to(&mut bytes).unwrap();
        assert_eq!(RayFile::parse(&bytes).unwrap(), sample);
        for end in 0..bytes.len() {
            assert!(RayFile::parse(&bytes[..end]).is_err(), "{end}");
        }
        bytes[16..24].fill(0xff);
        let error = RayFile::parse(&bytes).unwrap_err().to_string();
        assert!(error.contains("the length of the ray file is wrong"), "{error}");
    }
}
