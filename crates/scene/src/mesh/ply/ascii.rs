//! The text body of a PLY file: numbers between blanks, a row a line.
//!
//! A row may span several lines, as long lists do, but a line may not contain several rows: a row
//! that ends inside a line means that the header does not fit the body, and everything after it
//! would be misread.

use std::io::BufRead;

use super::header::Scalar;
use super::source::{Fault, Source};
use crate::mesh::number;

/// Longest valid number; messages quote no more of longer words.
const LONGEST: usize = 256;

/// A text body.
#[derive(Debug)]
pub(super) struct Ascii<R> {
    reader: R,
    left: u64,
    line: u64,
    token: Vec<u8>,
}

impl<R: BufRead> Ascii<R> {
    /// The body of `left` bytes after a header of `lines` lines.
    pub(super) fn new(reader: R, left: u64, lines: u64) -> Self {
        Self { reader, left, line: lines + 1, token: Vec::new() }
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
        self.left = self.left.saturating_sub(count as u64);
    }

    /// Skips blanks and returns the byte after them; `None` at the end of the file.
    fn skip_blanks(&mut self) -> Result<Option<u8>, Fault> {
        loop {
            let buffer = self.reader.fill_buf()?;
            if buffer.is_empty() {
                return Ok(None);
            }
            let blank = buffer.iter().take_while(|b| is_blank(**b)).count();
            let lines = buffer[..blank].iter().filter(|b| **b == b'\n').count();
            let next = buffer.get(blank).copied();
            self.line += lines as u64;
            self.consume(blank);
            if next.is_some() {
                return Ok(next);
            }
        }
    }

    /// Reads the next word into `self.token`.
    fn read_token(&mut self) -> Result<(), Fault> {
        self.skip_blanks()?.ok_or(Fault::End)?;
        self.token.clear();
        loop {
            let buffer = self.reader.fill_buf()?;
            let length = buffer.iter().position(|b| is_blank(*b)).unwrap_or(buffer.len());
            let ended = length < buffer.len() || buffer.is_empty();
            self.token.extend_from_slice(&buffer[..length.min(LONGEST)]);
            self.consume(length);
            if self.token.len() > LONGEST {
                return Err(self.malformed());
            }
            if ended {
                return Ok(());
            }
        }
    }

    /// The next number, if it has a simple form and lies within the buffer, without copying its
    /// word. Otherwise nothing is read.
    fn quick(&mut self, kind: Scalar) -> Result<Option<f64>, Fault> {
        let buffer = self.reader.fill_buf()?;
        let blank = buffer.iter().take_while(|b| is_blank(**b)).count();
        let (blanks, text) = buffer.split_at(blank);
        let found = match kind {
            Scalar::F32 => number::leading(text).map(|(v, length)| (f64::from(v), length)),
            _ => number::leading_whole(text).map(|(v, length)| (f64::from(v), length)),
        };
        let Some((value, length)) = found.filter(|f| text.get(f.1).is_some_and(|b| is_blank(*b)))
        else {
            return Ok(None);
        };
        self.line += blanks.iter().filter(|b| **b == b'\n').count() as u64;
        self.consume(blank + length);
        Ok(Some(value))
    }

    fn malformed(&self) -> Fault {
        Fault::Malformed(String::from_utf8_lossy(&self.token).into_owned())
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

/// A number of the type `kind`, rounded once.
fn parse(token: &[u8], kind: Scalar) -> Option<f64> {
    if kind == Scalar::F32 {
        return number::parse(token).map(f64::from);
    }
    std::str::from_utf8(token).ok()?.parse().ok()
}

impl<R: BufRead> Source for Ascii<R> {
    fn value(&mut self, kind: Scalar) -> Result<f64, Fault> {
        if let Some(value) = self.quick(kind)? {
            return Ok(value);
        }
        self.read_token()?;
        parse(&self.token, kind).ok_or_else(|| self.malformed())
    }

    fn skip(&mut self, _: Scalar, count: u64) -> Result<(), Fault> {
        (0..count).try_for_each(|_| self.read_token())
    }

    fn end_row(&mut self) -> Result<(), Fault> {
        loop {
            let buffer = self.reader.fill_buf()?;
            let blank = |b: &u8| is_blank(*b) && *b != b'\n';
            let length = buffer.iter().take_while(|b| blank(b)).count();
            let Some(&next) = buffer.get(length) else {
                if buffer.is_empty() {
                    return Ok(());
                }
                self.consume(length);
                continue;
            };
            self.consume(length);
            return if next == b'\n' { Ok(()) } else { Err(Fault::LongRow) };
        }
    }

    fn left(&self) -> u64 {
        self.left
    }

    /// A digit and a blank each. The last number may lack its blank, but one byte does not matter.
    fn least(&self, _: Scalar, count: u64) -> u64 {
        count.saturating_mul(2)
    }

    fn trailing(&mut self) -> Result<u64, Fault> {
        Ok(if self.skip_blanks()?.is_some() { self.left } else { 0 })
    }

    fn line(&self) -> Option<u64> {
        Some(self.line)
    }
}
