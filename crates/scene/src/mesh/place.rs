//! Reading a file on several threads, each at its own offset.
//!
//! A file is read, not mapped. Measured, both take the same time: the cost is in the newly touched
//! memory of the arrays. And if another program truncates a mapped file, the next access kills the
//! process, the mapped pages count as used memory, and mapping needs `unsafe`.

use std::fs::File;
use std::io::{self, ErrorKind, Read};

use wavecrest_base::parallel;
use wavecrest_base::progress;

/// A source that can be read at any offset.
pub(super) trait ReadAt: Sync {
    /// Reads bytes from `place` on and returns their number; 0 at the end.
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize>;

    /// Fills `to` with the bytes from `place` on, as far as there are any, and returns their number.
    fn fill_at(&self, to: &mut [u8], place: u64) -> io::Result<usize> {
        let mut filled = 0;
        while filled < to.len() {
            match self.read_at(&mut to[filled..], place + filled as u64) {
                Ok(0) => break,
                Ok(count) => filled += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(filled)
    }

    /// Fills all of `to` with the bytes from `place` on.
    fn read_exact_at(&self, to: &mut [u8], place: u64) -> io::Result<()> {
        let is_full = self.fill_at(to, place)? == to.len();
        if is_full { Ok(()) } else { Err(ErrorKind::UnexpectedEof.into()) }
    }
}

impl ReadAt for File {
    #[cfg(unix)]
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize> {
        std::os::unix::fs::FileExt::read_at(self, to, place).inspect(count)
    }

    #[cfg(windows)]
    fn read_at(&self, to: &mut [u8], place: u64) -> io::Result<usize> {
        std::os::windows::fs::FileExt::seek_read(self, to, place).inspect(count)
    }
}

/// Counts bytes that are read, for the progress.
fn count(bytes: &usize) {
    progress::add(*bytes as u64);
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
    let read = |(number, part): (usize, &mut [u8])| {
        file.read_exact_at(part, place + (number * PART) as u64)
    };
    parallel::map(to.chunks_mut(PART).enumerate(), read).into_iter().collect()
}

/// `N` bytes of a row from `offset` on, the least significant first.
#[inline(always)]
pub(super) fn part<const N: usize, const BIG: bool>(row: &[u8], offset: usize) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.copy_from_slice(&row[offset..offset + N]);
    if BIG {
        bytes.reverse();
    }
    bytes
}

/// A file, read in sequence.
pub(super) struct Sequence<'a> {
    pub(super) file: &'a dyn ReadAt,
    pub(super) place: u64,
}

impl Read for Sequence<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read_at(to, self.place)?;
        self.place += count as u64;
        Ok(count)
    }
}
