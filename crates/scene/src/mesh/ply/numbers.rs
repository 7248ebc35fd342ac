//! The numbers of a PLY body in sequence, as text or in binary of either byte order.
//!
//! In a text a row may span several lines, as long lists do, but a line may not contain several
//! rows: a row that ends inside a line means that the header does not fit the body, and everything
//! after it would be misread.

use std::io::{BufRead as _, BufReader, Read as _};

use super::header::{Encoding, Header, Scalar, with_type};
use crate::mesh::number;
use crate::mesh::place::{ReadAt, Section};
use wavecrest_base::error::Error;

/// Longest valid number of a text; messages quote no more of longer words.
const LONGEST: usize = 256;

/// Why a row could not be read.
#[derive(Debug)]
pub(super) enum Fault {
    /// The file ends before or inside a number.
    End,
    /// A number is malformed.
    Malformed(String),
    /// A text row continues after its last value.
    LongRow,
    /// The system failed.
    Io(std::io::Error),
    /// The numbers do not form a mesh.
    Mesh(Error),
}

impl From<std::io::Error> for Fault {
    /// A file can shrink while it is read: that counts as its end.
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Self::End,
            _ => Self::Io(error),
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Mesh(error)
    }
}

/// A body that is being read.
pub(super) struct Numbers<'a> {
    pub(super) file: &'a dyn ReadAt,
    pub(super) encoding: Encoding,
    /// Bytes that a thread reads at once where many rows can be read together; 0 for never.
    pub(super) block: usize,
    /// Positioned at the next number.
    reader: BufReader<Section<'a>>,
    /// The end of the body.
    end: u64,
    /// Bytes that are not read yet.
    pub(super) left: u64,
    /// The current line of a text.
    line: u64,
    token: Vec<u8>,
}

impl<'a> Numbers<'a> {
    /// The body of a `file` of `length` bytes, with a buffer of this size.
    pub(super) fn new(file: &'a dyn ReadAt, header: &Header, length: u64, buffer: usize) -> Self {
        let body = Section::new(file, header.bytes, length);
        let encoding = header.encoding;
        Self {
            file,
            encoding,
            block: if encoding == Encoding::Ascii { 0 } else { buffer },
            reader: BufReader::with_capacity(buffer, body),
            end: length,
            left: length.saturating_sub(header.bytes),
            line: header.lines + 1,
            token: Vec::new(),
        }
    }

    /// The next number, of the type `kind`. `f64` represents every value of every type.
    #[allow(clippy::useless_conversion, reason = "one of the types is f64")]
    pub(super) fn value(&mut self, kind: Scalar) -> Result<f64, Fault> {
        if self.encoding != Encoding::Ascii {
            return Ok(with_type!(kind, N => f64::from(N::from_le_bytes(self.bytes()?))));
        }
        if let Some(value) = self.quick(kind)? {
            return Ok(value);
        }
        self.read_token()?;
        parse(&self.token, kind).ok_or_else(|| self.malformed())
    }

    /// Skips `count` numbers of the type `kind`.
    pub(super) fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), Fault> {
        match self.encoding {
            Encoding::Ascii => (0..count).try_for_each(|_| self.read_token()),
            _ => self.advance(self.least(kind, count)),
        }
    }

    /// Skips bytes of a binary body.
    pub(super) fn advance(&mut self, bytes: u64) -> Result<(), Fault> {
        if bytes > self.left {
            return Err(Fault::End);
        }
        self.reader.seek_relative(bytes.cast_signed())?;
        self.left -= bytes;
        Ok(())
    }

    /// Checks that a row of a text ends here.
    pub(super) fn end_row(&mut self) -> Result<(), Fault> {
        while self.encoding == Encoding::Ascii {
            let buffer = self.reader.fill_buf()?;
            let blank = |b: &u8| is_blank(*b) && *b != b'\n';
            let length = buffer.iter().take_while(|b| blank(b)).count();
            let (next, is_end) = (buffer.get(length).copied(), buffer.is_empty());
            self.consume(length);
            match next {
                None if !is_end => {}
                None | Some(b'\n') => break,
                Some(_) => return Err(Fault::LongRow),
            }
        }
        Ok(())
    }

    /// The smallest number of bytes of `count` numbers of the type `kind`: in a text a digit and a
    /// blank each. The last number may lack its blank, but one byte does not matter.
    pub(super) fn least(&self, kind: Scalar, count: u64) -> u64 {
        let one = if self.encoding == Encoding::Ascii { 2 } else { kind.size() as u64 };
        count.saturating_mul(one)
    }

    /// The number of meaningful bytes after the end of the body.
    pub(super) fn trailing(&mut self) -> Result<u64, Fault> {
        let is_blank = self.encoding == Encoding::Ascii && self.skip_blanks()?.is_none();
        Ok(if is_blank { 0 } else { self.left })
    }

    /// The current line, in a text.
    pub(super) fn line(&self) -> Option<u64> {
        (self.encoding == Encoding::Ascii).then_some(self.line)
    }

    /// The offset of the next number in the file.
    pub(super) fn place(&self) -> u64 {
        self.end - self.left
    }

    /// The next `N` bytes, the least significant first.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut bytes = [0; N];
        if N as u64 > self.left {
            return Err(Fault::End);
        }
        self.reader.read_exact(&mut bytes)?;
        self.left -= N as u64;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
        self.left = self.left.saturating_sub(count as u64);
    }

    /// Skips blanks and returns the byte after them; `None` at the end of the file.
    fn skip_blanks(&mut self) -> Result<Option<u8>, Fault> {
        loop {
            let buffer = self.reader.fill_buf()?;
            let is_end = buffer.is_empty();
            let (blank, lines) = blanks(buffer);
            let next = buffer.get(blank).copied();
            self.line += lines;
            self.consume(blank);
            if next.is_some() || is_end {
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
        let (blank, lines) = blanks(buffer);
        let text = &buffer[blank..];
        let found = match kind {
            Scalar::F32 => number::leading(text).map(|(v, length)| (f64::from(v), length)),
            _ => number::leading_whole(text).map(|(v, length)| (f64::from(v), length)),
        };
        let found = found.filter(|f| text.get(f.1).is_some_and(|b| is_blank(*b)));
        Ok(found.map(|(value, length)| {
            self.line += lines;
            self.consume(blank + length);
            value
        }))
    }

    fn malformed(&self) -> Fault {
        Fault::Malformed(String::from_utf8_lossy(&self.token).into_owned())
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

/// The number of blanks at the start of a text, and of line ends among them.
fn blanks(text: &[u8]) -> (usize, u64) {
    let blank = text.iter().take_while(|b| is_blank(**b)).count();
    (blank, text[..blank].iter().filter(|b| **b == b'\n').count() as u64)
}

/// A number of the type `kind`, rounded once.
fn parse(token: &[u8], kind: Scalar) -> Option<f64> {
    if kind == Scalar::F32 {
        return number::parse(token).map(f64::from);
    }
    std::str::from_utf8(token).ok()?.parse().ok()
}
