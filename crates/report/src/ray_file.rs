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

use glam::Vec3;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{replace_file, write_error};
use wavecrest_core::accel::Hit;
use wavecrest_core::math::ray::Ray;

const MAGIC: &[u8; 8] = b"RAYDUMP1";
const VERSION: u32 = 1;
const HEADER: usize = 64;
const RAY: usize = 32;
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
        let cannot_read = |e| Error::io("cannot read the rays", path, e);
        if !std::fs::metadata(path).map_err(cannot_read)?.is_file() {
            return Err(Error::new(ErrorKind::Io, "this is not a regular file").in_file(path));
        }
        let bytes = std::fs::read(path).map_err(cannot_read)?;
        Self::parse(&bytes).map_err(|e| e.in_file(path))
    }

    fn parse(bytes: &[u8]) -> Result<Self> {
        let header = bytes.get(..HEADER).filter(|h| h.starts_with(MAGIC)).ok_or_else(|| {
            Error::new(ErrorKind::Syntax, "this is not a ray file")
                .remedy("a ray file begins with RAYDUMP1 and a header of 64 bytes")
        })?;
        let version = word(header, 8);
        if version != VERSION {
            return Err(Error::new(ErrorKind::Syntax, "the version of the ray file is unknown")
                .at("byte 8")
                .value(version)
                .remedy("use version 1"));
        }
        let (count, triangles) = (long(header, 16), long(header, 24));
        let expected = count.checked_mul(ROW as u64).and_then(|n| n.checked_add(HEADER as u64));
        if expected != Some(bytes.len() as u64) {
            return Err(Error::new(ErrorKind::Syntax, "the length of the ray file is wrong")
                .at("byte 16")
                .value(format!("{count} rays in {} bytes", bytes.len()))
                .remedy(format!("each ray takes {ROW} bytes after a header of {HEADER}")));
        }
        let n = count as usize;
        let column = |start: usize, width: usize| {
            let start = HEADER + start * n;
            bytes[start..start + width * n].chunks_exact(width)
        };
        let primitives = column(RAY + 4, 4).map(|b| word(b, 0));
        let closest =
            column(RAY, 4).zip(primitives).map(|(t, primitive)| Hit { t: float(t, 0), primitive });
        Ok(Self {
            any_hit: word(header, 12) != 0,
            triangles,
            rays: column(0, RAY).map(ray).collect(),
            closest: closest.collect(),
            occluded: column(RAY + 8, 1).map(|b| b[0] != 0).collect(),
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
        for Ray { origin: o, direction: d, t_min, t_max } in &self.rays {
            for number in [o.x, o.y, o.z, *t_min, d.x, d.y, d.z, *t_max] {
                sink.write_all(&number.to_le_bytes())?;
            }
        }
        for hit in &self.closest {
            sink.write_all(&hit.t.to_le_bytes())?;
        }
        for hit in &self.closest {
            sink.write_all(&hit.primitive.to_le_bytes())?;
        }
        let flags: Vec<u8> = self.occluded.iter().map(|&o| u8::from(o)).collect();
        sink.write_all(&flags)
    }
}

fn ray(bytes: &[u8]) -> Ray {
    let f = |i: usize| float(bytes, 4 * i);
    Ray {
        origin: Vec3::new(f(0), f(1), f(2)),
        t_min: f(3),
        direction: Vec3::new(f(4), f(5), f(6)),
        t_max: f(7),
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(word)
}

fn long(bytes: &[u8], at: usize) -> u64 {
    u64::from(word(bytes, at)) | u64::from(word(bytes, at + 4)) << 32
}

fn float(bytes: &[u8], at: usize) -> f32 {
    f32::from_bits(word(bytes, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> RayFile {
        let ray = Ray { t_max: 7.5, ..Ray::new(Vec3::new(1.0, -2.0, 3.0), Vec3::NEG_Z) };
        RayFile {
            any_hit: true,
            triangles: 12,
            rays: vec![ray, Ray::new(Vec3::ZERO, Vec3::X)],
            closest: vec![Hit { t: 2.5, primitive: 7 }, Hit::MISS],
            occluded: vec![true, false],
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.rays");
        sample().write(&path).unwrap();
        assert_eq!(RayFile::read(&path).unwrap(), sample());
    }

    #[test]
    fn a_file_cut_at_any_place_is_refused() {
        let mut bytes = Vec::new();
        sample().write_to(&mut bytes).unwrap();
        for end in 0..bytes.len() {
            assert!(RayFile::parse(&bytes[..end]).is_err(), "{end}");
        }
        bytes[16..24].fill(0xff);
        let error = RayFile::parse(&bytes).unwrap_err().to_string();
        assert!(error.contains("the length of the ray file is wrong"), "{error}");
    }
}
