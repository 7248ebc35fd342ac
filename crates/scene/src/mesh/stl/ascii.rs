//! Text STL: `facet normal`, `outer loop`, three times `vertex`, `endloop`, `endfacet`, each on its
//! own line, in upper or lower case, between `solid` and `endsolid`. Several solids in a file form
//! one mesh.

use std::io::{BufRead, BufReader, Read as _};

use glam::Vec3;

use super::{check_count, corner, ignored_colours};
use crate::mesh::faults::{read_failure, syntax};
use crate::mesh::number;
use crate::mesh::place::{ReadAt, Section};
use wavecrest_base::error::{Error, Result};

/// The longest line in bytes: only names are longer than a few numbers.
const LONGEST_LINE: u64 = 1 << 16;

/// First words of lines without positions.
const FRAME: [&str; 5] = ["solid", "endsolid", "facet", "outer", "endfacet"];

/// The corners of all triangles, and warnings.
pub(super) fn read(
    file: &dyn ReadAt,
    length: u64,
    buffer: usize,
) -> Result<(Vec<[Vec3; 3]>, Vec<Error>)> {
    let mut text = Text::default();
    each_line(file, length, buffer, |line| text.line(line))?;
    if !text.corners.is_empty() {
        let error = syntax("the last triangle is incomplete").value(text.corners.len());
        return Err(error.remedy("the file may be cut off"));
    }
    let notes = text.has_colours.then(|| ignored_colours("colours of triangles"));
    Ok((text.triangles, notes.into_iter().collect()))
}

/// Upper bound on the number of triangles: each has at least three vertex lines.
pub(super) fn count(file: &dyn ReadAt, length: u64) -> Result<u64> {
    let mut corners = 0;
    each_line(file, length, super::BUFFER, |line| {
        corners += u64::from(words(line).next().is_some_and(|w| w.eq_ignore_ascii_case("vertex")));
        Ok(())
    })?;
    Ok(corners / 3)
}

/// What has been read.
#[derive(Default)]
struct Text {
    triangles: Vec<[Vec3; 3]>,
    /// The corners of the current triangle.
    corners: Vec<Vec3>,
    has_colours: bool,
}

impl Text {
    fn line(&mut self, line: &str) -> Result<()> {
        let mut words = words(line);
        let Some(keyword) = words.next().map(str::to_ascii_lowercase) else { return Ok(()) };
        match keyword.as_str() {
            "vertex" => self.vertex(words),
            "endloop" => self.end_triangle(),
            "color" => {
                self.has_colours = true;
                Ok(())
            }
            other if FRAME.contains(&other) => Ok(()),
            other => Err(syntax("unknown line")
                .value(format_args!("\"{other}\""))
                .remedy("check that the file is an STL file and is whole")),
        }
    }

    fn vertex<'a>(&mut self, mut words: impl Iterator<Item = &'a str>) -> Result<()> {
        if self.corners.len() == 3 {
            let error = syntax("a triangle has more than three corners");
            return Err(error.remedy("export triangles only, or use PLY or OBJ"));
        }
        let mut number = || {
            let word = words.next().unwrap_or("");
            number::parse(word.as_bytes()).ok_or_else(|| {
                let error = syntax("a corner is three numbers").value(format_args!("\"{word}\""));
                error.remedy("write them as 12 or -0.5e3; the file may be cut off")
            })
        };
        let position = Vec3::new(number()?, number()?, number()?);
        self.corners.push(corner(position)?);
        Ok(())
    }

    fn end_triangle(&mut self) -> Result<()> {
        let [a, b, c] = self.corners[..] else {
            let error = syntax("a triangle needs three corners").value(self.corners.len());
            return Err(error.remedy("complete it, or remove it"));
        };
        self.triangles.push([a, b, c]);
        self.corners.clear();
        check_count(self.triangles.len() as u64)
    }
}

fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split_ascii_whitespace()
}

/// Passes each line to `take`, and adds its number to errors.
fn each_line(
    file: &dyn ReadAt,
    length: u64,
    buffer: usize,
    mut take: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let mut reader = BufReader::with_capacity(buffer, Section::new(file, 0, length));
    let mut line = Vec::new();
    for number in 1_u64.. {
        line.clear();
        let mut limited = reader.by_ref().take(LONGEST_LINE);
        let read = limited.read_until(b'\n', &mut line).map_err(read_failure)?;
        if read == 0 {
            break;
        }
        let place = || format!("line {number}");
        if read as u64 == LONGEST_LINE && !line.ends_with(b"\n") {
            let error = syntax(format!("a line can have at most {LONGEST_LINE} bytes")).at(place());
            return Err(error.remedy("check that the file is an STL file"));
        }
        take(&String::from_utf8_lossy(&line)).map_err(|error| error.at(place()))?;
    }
    Ok(())
}
