//! Reading a file on several threads, each at its own offset.
//!
//! A file is read, not mapped. Measured, both take the same time: the cost is in the newly touched
//! memory of the arrays. And if another program truncates a mapped file, the next access kills the
//! process, the mapped pages count as used memory, and mapping needs `unsafe`.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};

use rayon::prelude::*;

/// A source that can be read at any offset.
pub(super) trait ReadAt: Sync {
    /// Reads bytes from `place` on and returns their number; 0 at the end.
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize>;

    /// Fills `to` with the bytes from `place` on.
    fn read_exact_at(&self, mut to: &mut [u8], mut place: u64) -> io::Result<()> {
        while !to.is_empty() {
            match self.read_at(to, place) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => {
                    to = &mut to[count..];
                    place += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

impl ReadAt for File {
    #[cfg(unix)]
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize> {
        std::os::unix::fs::FileExt::read_at(self, to, place)
    }

    #[cfg(windows)]
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize> {
        std::os::windows::fs::FileExt::seek_read(self, to, place)
    }

    /// Elsewhere a file has a single position: threads take turns.
    #[cfg(not(any(unix, windows)))]
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize> {
        static TURN: std::sync::Mutex<()> = std::sync::Mutex::new(());
        let _turn = TURN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut file = self;
        file.seek(SeekFrom::Start(place))?;
        file.read(to)
    }
}

impl ReadAt for &[u8] {
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize> {
        let from = usize::try_from(place).ok().and_then(|place| self.get(place..)).unwrap_or(&[]);
        let count = from.len().min(to.len());
        to[..count].copy_from_slice(&from[..count]);
        Ok(count)
    }
}

/// Fills `to` with the bytes of `file` from `place` on, on all threads.
pub(super) fn fill(file: &dyn ReadAt, place: u64, to: &mut [u8]) -> io::Result<()> {
    const PART: usize = 1 << 18;
    to.par_chunks_mut(PART)
        .enumerate()
        .try_for_each(|(number, part)| file.read_exact_at(part, place + (number * PART) as u64))
}

/// A part of a file, read in sequence.
pub(super) struct Section<'a> {
    file: &'a dyn ReadAt,
    place: u64,
    end: u64,
}

impl<'a> Section<'a> {
    /// From `place` to `end`, exclusive.
    pub(super) fn new(file: &'a dyn ReadAt, place: u64, end: u64) -> Self {
        Self { file, place, end }
    }
}

impl Read for Section<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.place)).unwrap_or(usize::MAX);
        let most = left.min(to.len());
        let count = self.file.read_at(&mut to[..most], self.place)?;
        self.place += count as u64;
        Ok(count)
    }
}

/// Positions are those of the file.
impl Seek for Section<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::End(by) => self.end.checked_add_signed(by),
            SeekFrom::Current(by) => self.place.checked_add_signed(by),
        };
        self.place = place.ok_or(ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufReader, Write as _};

    use super::*;

    #[test]
    fn a_file_and_an_array_are_read_alike_at_any_place() {
        let bytes: Vec<u8> = (0..200).collect();
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&bytes).unwrap();
        for place in [0, 1, 150, 199, 200, 201, u64::MAX >> 1] {
            let mut found = [[0; 10]; 2];
            let [a, b] = &mut found;
            let ends = (file.read_exact_at(a, place), (&bytes[..]).read_exact_at(b, place));
            assert_eq!(ends.0.is_ok(), ends.1.is_ok(), "{place}");
            assert_eq!(ends.0.is_ok(), place <= 190);
            assert!(ends.0.is_err() || (found[0] == found[1] && u64::from(found[0][0]) == place));
        }
    }

    #[test]
    fn a_section_ends_where_it_was_told() {
        let bytes: Vec<u8> = (0..200).collect();
        let slice = &bytes[..];
        let mut section = BufReader::with_capacity(7, Section::new(&slice, 20, 50));
        let mut found = Vec::new();
        section.by_ref().take(4).read_to_end(&mut found).unwrap();
        section.seek_relative(3).unwrap();
        section.by_ref().take(1).read_to_end(&mut found).unwrap();
        section.seek_relative(19).unwrap();
        section.read_to_end(&mut found).unwrap();
        assert_eq!(found, [20, 21, 22, 23, 27, 47, 48, 49]);
        section.seek_relative(100).unwrap();
        assert_eq!(section.read(&mut [0; 4]).unwrap(), 0);
    }
}
