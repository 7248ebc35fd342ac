//! The rows of a PLY body: many binary ones of constant length as blocks of bytes, any others number
//! by number, from text or from binary of either byte order.
//!
//! In a text a row may span several lines, as long lists do, but a line may not contain several
//! rows: a row that ends inside a line means that the header does not fit the body, and everything
//! after it would be misread.

use std::sync::atomic::{AtomicU64, Ordering};

use super::header::{BodyEncoding, Element, Header, PropertyType};
use crate::mesh::faults::{read_failure, syntax};
use crate::mesh::number;
use crate::mesh::place::ReadAt;
use crate::mesh::scalar::{Scalar, with_type};
use wavecrest_base::error::{Error, Result};
use wavecrest_base::parallel;

/// Longest valid number of a text; messages quote no more of longer words.
const LONGEST: usize = 256;

/// The used numbers of a row.
#[derive(Debug, Default)]
pub(super) struct Row {
    /// Whether each property is used.
    pub(super) used: Vec<bool>,
    /// Those of lists without their count.
    pub(super) numbers: Vec<f64>,
    /// For each property, the end of its numbers.
    ends: Vec<usize>,
}

impl Row {
    /// The numbers of a property.
    pub(super) fn of(&self, property: usize) -> &[f64] {
        let start = property.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.numbers[start..self.ends[property]]
    }
}

/// A body that is being read.
pub(super) struct Numbers<'a> {
    file: &'a dyn ReadAt,
    /// Whose rows are read, for messages.
    pub(super) element: Option<&'a Element>,
    pub(super) encoding: BodyEncoding,
    /// Bytes that a thread reads at once where many rows can be read together; 0 for never.
    pub(super) block: usize,
    /// Bytes of the body, of which those before `at` are read.
    buffer: Vec<u8>,
    at: usize,
    /// The most bytes in the buffer.
    most: usize,
    /// The end of the body.
    end: u64,
    /// Bytes that are not read yet.
    pub(super) left: u64,
    /// The current line of a text.
    line: u64,
}

impl<'a> Numbers<'a> {
    /// The body of a `file` of `length` bytes, with a buffer of this size.
    pub(super) fn new(file: &'a dyn ReadAt, header: &Header, length: u64, buffer: usize) -> Self {
        let encoding = header.encoding;
        Self {
            file,
            element: None,
            encoding,
            block: if encoding == BodyEncoding::Ascii { 0 } else { buffer },
            buffer: Vec::new(),
            at: 0,
            most: buffer.max(2 * LONGEST),
            end: length,
            left: length.saturating_sub(header.bytes),
            line: header.lines + 1,
        }
    }

    /// Reads a row of the element, of which the used properties are kept.
    pub(super) fn row(&mut self, into: &mut Row) -> Result<()> {
        into.numbers.clear();
        into.ends.clear();
        let properties = self.element.into_iter().flat_map(|element| &element.properties);
        for (property, &is_used) in properties.zip(&into.used) {
            let (kind, count) = match property.shape {
                PropertyType::One(kind) => (kind, 1),
                PropertyType::List { count, item } => (item, self.list_length(count, item)?),
            };
            if is_used {
                for _ in 0..count {
                    into.numbers.push(self.value(kind)?);
                }
            } else if self.encoding == BodyEncoding::Ascii {
                (0..count).try_for_each(|_| self.word().map(drop))?;
            } else {
                self.advance(self.least(kind, count))?;
            }
            into.ends.push(into.numbers.len());
        }
        Ok(())
    }

    /// The number of rows of a block, if `count` rows of `stride` bytes can be read in blocks.
    pub(super) fn rows_at_once(&self, stride: usize, count: u64) -> Option<usize> {
        let is_there = (stride as u64).checked_mul(count).is_some_and(|bytes| bytes <= self.left);
        (self.block > 0 && is_there).then(|| (self.block / stride).max(1))
    }

    /// Reads `count` rows of `stride` bytes in blocks, on all threads, each into memory that stays
    /// in the cache of its thread. `decode` takes a block and its destination, and returns the number
    /// of rows before the first that is not good; the whole stops there, and returns the number.
    pub(super) fn blocks<T: Send>(
        &mut self,
        stride: usize,
        count: u64,
        to: impl Iterator<Item = T> + Send,
        decode: impl Fn(&[u8], T) -> usize + Sync,
    ) -> Result<u64> {
        let (file, start) = (self.file, self.place());
        let at_once = (self.block / stride).max(1) as u64;
        let all_good = AtomicU64::new(count);
        parallel::with_state(to.enumerate(), Vec::new, |buffer: &mut Vec<u8>, (block, to)| {
            let first = block as u64 * at_once;
            if all_good.load(Ordering::Relaxed) < first {
                return;
            }
            let rows = at_once.min(count - first);
            buffer.resize(rows as usize * stride, 0);
            // Rows that cannot be read are read again number by number, which reports the error.
            let is_read = file.read_exact_at(buffer, start + first * stride as u64).is_ok();
            let good = if is_read { decode(buffer, to) as u64 } else { 0 };
            if good < rows {
                all_good.fetch_min(first + good, Ordering::Relaxed);
            }
        });
        let good = all_good.into_inner();
        self.advance(good * stride as u64)?;
        Ok(good)
    }

    /// The next number, of the type `kind`. `f64` represents every value of every type.
    #[allow(clippy::useless_conversion, reason = "one of the types is f64")]
    fn value(&mut self, kind: Scalar) -> Result<f64> {
        if self.encoding != BodyEncoding::Ascii {
            return Ok(with_type!(kind, N => f64::from(N::from_le_bytes(self.bytes()?))));
        }
        if let Some(value) = self.quick(kind)? {
            return Ok(value);
        }
        let word = self.word()?;
        parse(word, kind).ok_or_else(|| malformed(word))
    }

    /// The length of the next list, for whose items there must be room.
    fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<u64> {
        let value = self.value(count)?;
        if value < 0.0 || value.fract() != 0.0 || value > f64::from(u32::MAX) {
            let error = syntax("the length of a list must be a whole number, 0 or more");
            return Err(error.value(value).remedy("check the types in the header"));
        }
        let length = value as u64;
        let (need, left) = (self.least(item, length), self.left);
        if need <= left.saturating_add(1) {
            return Ok(length);
        }
        let message = format!(
            "the file is cut off: a list of {length} takes at least {need} bytes, and {left} are left"
        );
        Err(syntax(message).remedy("copy or export it again, or correct the types in its header"))
    }

    /// Skips bytes of a binary body.
    fn advance(&mut self, bytes: u64) -> Result<()> {
        if bytes > self.left {
            return Err(self.cut_off());
        }
        self.consume(bytes);
        Ok(())
    }

    /// Ends a row: in a text at the end of its line, where nothing may stand before, unless more may
    /// follow, which is skipped. Returns whether something stands there.
    pub(super) fn end_row(&mut self, more_may_follow: bool) -> Result<bool> {
        let is_over = self.encoding != BodyEncoding::Ascii
            || self.skip_while(|b| is_blank(b) && b != b'\n')?.is_none_or(|next| next == b'\n');
        if is_over {
            return Ok(false);
        }
        if !more_may_follow {
            let right =
                "declare every value of a line in the header, and put each element on its own line";
            return Err(syntax("the line has too many values").remedy(right));
        }
        self.skip_while(|b| b != b'\n')?;
        Ok(true)
    }

    /// The smallest number of bytes of `count` numbers of the type `kind`: in a text a digit and a
    /// blank each. The last number may lack its blank, but one byte does not matter.
    pub(super) fn least(&self, kind: Scalar, count: u64) -> u64 {
        let one = if self.encoding == BodyEncoding::Ascii { 2 } else { kind.size() as u64 };
        count.saturating_mul(one)
    }

    /// The number of meaningful bytes after the end of the body.
    pub(super) fn trailing(&mut self) -> Result<u64> {
        let is_blank = self.encoding == BodyEncoding::Ascii && self.skip_while(is_blank)?.is_none();
        Ok(if is_blank { 0 } else { self.left })
    }

    /// The current line, in a text.
    pub(super) fn line(&self) -> Option<u64> {
        (self.encoding == BodyEncoding::Ascii).then_some(self.line)
    }

    /// The offset of the next number in the file.
    fn place(&self) -> u64 {
        self.end - self.left
    }

    /// The next bytes: more than [`LONGEST`], or all that are left.
    fn ahead(&mut self) -> Result<&[u8]> {
        let there = self.buffer.len() - self.at;
        if there <= LONGEST && self.left > there as u64 {
            self.buffer.drain(..self.at);
            self.at = 0;
            self.buffer.resize(self.left.min(self.most as u64) as usize, 0);
            let place = self.place() + there as u64;
            let filled = self.file.fill_at(&mut self.buffer[there..], place);
            self.buffer.truncate(there + filled.map_err(read_failure)?);
        }
        Ok(&self.buffer[self.at..])
    }

    /// The next `N` bytes, the least significant first.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N]> {
        let Some(&(mut bytes)) = self.ahead()?.first_chunk() else { return Err(self.cut_off()) };
        self.consume(N as u64);
        if self.encoding == BodyEncoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// The error of a file that ends before or inside a number.
    fn cut_off(&self) -> Error {
        let (name, count) = self.element.map_or(("", 0), |element| (&*element.name, element.count));
        syntax(format!("the file is cut off: its header promises {count} of \"{name}\""))
            .remedy("copy or export it again")
    }

    fn consume(&mut self, count: u64) {
        let there = self.buffer.len() - self.at;
        self.at += usize::try_from(count).unwrap_or(there).min(there);
        self.left = self.left.saturating_sub(count);
    }

    /// Skips bytes that are `blank` and returns the byte after them; `None` at the end of the file.
    fn skip_while(&mut self, blank: impl Fn(u8) -> bool) -> Result<Option<u8>> {
        loop {
            let text = self.ahead()?;
            let length = text.iter().take_while(|b| blank(**b)).count();
            let (next, is_end) = (text.get(length).copied(), text.is_empty());
            let lines = line_ends(&text[..length]);
            self.line += lines;
            self.consume(length as u64);
            if next.is_some() || is_end {
                return Ok(next);
            }
        }
    }

    /// Reads the next word.
    fn word(&mut self) -> Result<&[u8]> {
        if self.skip_while(is_blank)?.is_none() {
            return Err(self.cut_off());
        }
        let text = self.ahead()?;
        let text = &text[..text.len().min(LONGEST + 1)];
        let length = text.iter().position(|b| is_blank(*b)).unwrap_or(text.len());
        if length > LONGEST {
            return Err(malformed(&text[..LONGEST]));
        }
        self.consume(length as u64);
        Ok(&self.buffer[self.at - length..self.at])
    }

    /// The next number, if it has a simple form and lies within the buffer. Otherwise nothing is
    /// read.
    fn quick(&mut self, kind: Scalar) -> Result<Option<f64>> {
        let text = self.ahead()?;
        let blank = text.iter().take_while(|b| is_blank(**b)).count();
        let (blanks, text) = text.split_at(blank);
        let found = match kind {
            Scalar::F32 => number::leading(text).map(|(v, length)| (f64::from(v), length)),
            _ => number::leading_whole(text).map(|(v, length)| (f64::from(v), length)),
        };
        let found = found.filter(|f| text.get(f.1).is_some_and(|b| is_blank(*b)));
        let Some((value, length)) = found else { return Ok(None) };
        let lines = line_ends(blanks);
        self.line += lines;
        self.consume((blank + length) as u64);
        Ok(Some(value))
    }
}

/// The error of a malformed number.
fn malformed(word: &[u8]) -> Error {
    let error = syntax("a number is malformed").value(String::from_utf8_lossy(word));
    error.remedy("write it as 12 or -0.5e3")
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

fn line_ends(text: &[u8]) -> u64 {
    text.iter().filter(|b| **b == b'\n').count() as u64
}

/// A number of the type `kind`, rounded once.
fn parse(token: &[u8], kind: Scalar) -> Option<f64> {
    if kind == Scalar::F32 {
        return number::parse(token).map(f64::from);
    }
    std::str::from_utf8(token).ok()?.parse().ok()
}
