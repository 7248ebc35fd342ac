//! The byte layouts of the Netpbm family: binary PGM and PPM (`P5`, `P6`) and PFM (`Pf`, `PF`).
//!
//! All have a header of words separated by white space, then rows of numbers. PPM is written with 8
//! bits a value, the top row first. PFM has 32-bit floats, the bottom row first; its header ends in
//! a number that is negative for little-endian floats. The magnitude of that number is a unit of
//! light, which programs ignore by convention, as does this reader.
//!
//! The `pnm` codec of the crate `image` does not suffice: it has no PFM, whose header is shared
//! here, writes no comments, and has other errors; and it reads a whole file where this reader
//! needs a row.
//!
//! Formats: <https://netpbm.sourceforge.net/doc/ppm.html> and
//! <https://netpbm.sourceforge.net/doc/pfm.html>.

use std::io::{BufRead, Result as IoResult, Write};

use super::metadata::{Entry, full_name};
use super::transfer::{Transfer, row_to_bytes};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::{Film, checked_pixel_count};

/// The longest word in a header.
const LONGEST_WORD: usize = 32;

/// Writes a binary PPM with 8 bits a value, and a comment for each entry.
pub(super) fn write_ppm(
    sink: &mut impl Write,
    film: &Film,
    transfer: Transfer,
    comments: &[Entry],
) -> IoResult<()> {
    sink.write_all(b"P6\n")?;
    for Entry { name, text } in comments {
        // A line must not end early: the rest would be read as the size.
        let line = text.replace(char::is_control, " ");
        writeln!(sink, "# {}: {line}", full_name(name))?;
    }
    write!(sink, "{} {}\n255\n", film.width(), film.height())?;
    film.rows().try_for_each(|row| sink.write_all(&row_to_bytes(row, transfer)))
}

/// Writes a little-endian colour PFM.
pub(super) fn write_pfm(sink: &mut impl Write, film: &Film) -> IoResult<()> {
    write!(sink, "PF\n{} {}\n-1.0\n", film.width(), film.height())?;
    for value in film.rows().rev().flatten().flatten() {
        sink.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

/// Whether [`read`] can read a file with this start.
pub(super) fn is_netpbm(start: &[u8]) -> bool {
    matches!(start, [b'P', b'5' | b'6' | b'f' | b'F', after, ..] if after.is_ascii_whitespace())
}

/// Reads a binary PGM or PPM (as 0 to 1) or a PFM (unchanged) from a file of `length` bytes.
pub(super) fn read(source: &mut impl BufRead, length: u64) -> Result<Film> {
    let mut header = HeaderReader { source, taken: 0 };
    let magic = header.word()?;
    let (width, height) = (header.number("width")?, header.number("height")?);
    let last = header.word()?;
    let sample = match magic.as_str() {
        "P5" | "P6" => white_value(&last)?,
        "Pf" | "PF" => byte_order(&last)?,
        _ => return Err(syntax("not a binary PGM, PPM or PFM image").value(magic)),
    };
    let count = checked_pixel_count(width, height)?;
    let channels = if matches!(magic.as_str(), "P6" | "PF") { 3 } else { 1 };
    let pixel_bytes = channels * sample.bytes();
    let needed = count as u64 * pixel_bytes as u64;
    let left = length.saturating_sub(header.taken);
    if needed > left {
        let message =
            format!("an image of {width} x {height} pixels needs {needed} bytes after its header");
        return Err(syntax(message).value(left).remedy("the file may be cut off"));
    }
    let mut film = Film::new(width, height)?;
    let mut rows: Vec<&mut [[f32; 3]]> = film.pixels_mut().chunks_mut(width as usize).collect();
    if !matches!(sample, NumberFormat::Integer(_)) {
        rows.reverse();
    }
    let mut row = vec![0; width as usize * pixel_bytes];
    for pixels in rows {
        source.read_exact(&mut row).map_err(read_error)?;
        for (pixel, bytes) in pixels.iter_mut().zip(row.chunks_exact(pixel_bytes)) {
            let mut values = bytes.chunks_exact(sample.bytes()).map(|bytes| sample.value(bytes));
            let first = values.next().unwrap_or(0.0);
            *pixel = [first, values.next().unwrap_or(first), values.next().unwrap_or(first)];
        }
    }
    Ok(film)
}

/// The storage of a number.
enum NumberFormat {
    /// An integer of one or two bytes, big-endian, with this value for white.
    Integer(u16),
    /// A little-endian float.
    Little,
    /// A big-endian float.
    Big,
}

impl NumberFormat {
    fn bytes(&self) -> usize {
        match self {
            Self::Integer(..=255) => 1,
            Self::Integer(_) => 2,
            Self::Little | Self::Big => 4,
        }
    }

    fn value(&self, bytes: &[u8]) -> f32 {
        match (self, bytes) {
            (Self::Integer(white), bytes) => {
                let value = bytes.iter().fold(0, |value, byte| value << 8 | u16::from(*byte));
                f32::from(value.min(*white)) / f32::from(*white)
            }
            (Self::Little, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            (Self::Big, &[a, b, c, d]) => f32::from_be_bytes([a, b, c, d]),
            _ => 0.0,
        }
    }
}

fn white_value(word: &str) -> Result<NumberFormat> {
    match word.parse() {
        Ok(white) if white > 0 => Ok(NumberFormat::Integer(white)),
        _ => Err(syntax("the maximum value must be an integer from 1 to 65535").value(word)),
    }
}

fn byte_order(word: &str) -> Result<NumberFormat> {
    match word.parse::<f32>() {
        Ok(scale) if scale < 0.0 => Ok(NumberFormat::Little),
        Ok(scale) if scale > 0.0 => Ok(NumberFormat::Big),
        _ => Err(syntax("the scale of a PFM image must be a number other than 0").value(word)),
    }
}

/// Reads the words of a header and counts its bytes.
struct HeaderReader<'a, R> {
    source: &'a mut R,
    taken: u64,
}

impl<R: BufRead> HeaderReader<'_, R> {
    /// The next word, including the white space that ends it: after the last word the numbers
    /// follow at once. A `#` before a word starts a comment.
    fn word(&mut self) -> Result<String> {
        let mut word = String::new();
        loop {
            match self.byte()? {
                b'#' if word.is_empty() => while self.byte()? != b'\n' {},
                space if space.is_ascii_whitespace() && word.is_empty() => {}
                space if space.is_ascii_whitespace() => return Ok(word),
                other => word.push(char::from(other)),
            }
            if word.len() > LONGEST_WORD {
                return Err(syntax("a word in the image's header is too long").value(word));
            }
        }
    }

    fn number(&mut self, name: &str) -> Result<u32> {
        let word = self.word()?;
        word.parse()
            .map_err(|_| syntax(format!("the {name} of an image must be a number")).value(word))
    }

    fn byte(&mut self) -> Result<u8> {
        let mut byte = [0];
        self.source.read_exact(&mut byte).map_err(read_error)?;
        self.taken += 1;
        Ok(byte[0])
    }
}

fn syntax(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Syntax, message)
}

fn read_error(error: std::io::Error) -> Error {
    if error.kind() == std::io::ErrorKind::UnexpectedEof {
        return syntax("the image ends too early").remedy("the file may be cut off");
    }
    Error::new(ErrorKind::Io, format!("cannot read the image: {error}")).because(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::approved;

    fn parse(bytes: &[u8]) -> Result<Film> {
        read(&mut { bytes }, bytes.len() as u64)
    }

    fn film() -> Film {
        let pixel = |i: u8| [f32::from(i) / 255.0, 0.2, 0.4];
        Film::from_pixels(2, 3, (0..6).map(pixel).collect()).unwrap()
    }

    #[test]
    fn a_ppm_is_a_header_and_bytes_from_the_top() {
        let mut bytes = Vec::new();
        write_ppm(&mut bytes, &film(), Transfer::Linear, &[]).unwrap();
        assert_eq!(bytes[..11], *b"P6\n2 3\n255\n");
        assert_eq!(
            bytes[11..],
            [0, 51, 102, 1, 51, 102, 2, 51, 102, 3, 51, 102, 4, 51, 102, 5, 51, 102]
        );
        assert!(is_netpbm(&bytes));
        assert!(parse(&bytes).unwrap().same_bits(&film()));
    }

    #[test]
    fn a_pfm_is_little_endian_from_the_bottom() {
        let mut bytes = Vec::new();
        write_pfm(&mut bytes, &film()).unwrap();
        assert_eq!(bytes[..12], *b"PF\n2 3\n-1.0\n");
        assert_eq!(bytes[12..16], (4.0f32 / 255.0).to_le_bytes());
        assert_eq!(bytes.len(), 12 + 6 * 12);
        assert!(parse(&bytes).unwrap().same_bits(&film()));
    }

    /// A grey PFM from its end; white that is any number; comments; pixels like white space or a comment.
    #[test]
    fn files_of_other_programs_are_read() {
        for (bytes, pixels) in [
            (&b"Pf\n1 2\n1.0\n\x3e\x80\0\0\x40\xf0\0\0"[..], &[[7.5; 3], [0.25; 3]][..]),
            (b"P5 # a comment\n#another\n 3\t1 15\n\x00\x03\xff", &[[0.0; 3], [0.2; 3], [1.0; 3]]),
            (b"P6\n1 1\n65535\n\x00\x00\xff\xff\x33\x33", &[[0.0, 1.0, 0.2]]),
            (b"P5\n2 1\n255\n\n#", &[[10.0 / 255.0; 3], [35.0 / 255.0; 3]]),
        ] {
            assert_eq!(parse(bytes).unwrap().pixels(), pixels);
        }
    }

    #[test]
    fn bad_files_have_their_messages() {
        approved::compare("src/netpbm/refused.txt", |text| {
            parse(text.as_bytes()).unwrap_err().to_string()
        });
    }
}
