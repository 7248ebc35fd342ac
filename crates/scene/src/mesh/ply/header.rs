//! The header of a PLY file: the elements, their counts and properties.
//!
//! Lines may end in CR LF, begin and end with blanks, be empty or be comments. A header is at most
//! [`MAX_HEADER`] long, so that a large file without one is not read to its end.

use crate::mesh::data::MAX_COUNT;
use crate::mesh::faults::{check_count, read_failure, syntax};
use crate::mesh::place::ReadAt;
use crate::mesh::scalar::Scalar;
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};

/// Largest length of a header in bytes.
const MAX_HEADER: u64 = 1 << 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BodyEncoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The names of the types, the older and the newer.
pub(super) const TYPE_NAMES: [(&str, &str, Scalar); 8] = [
    ("char", "int8", Scalar::I8),
    ("uchar", "uint8", Scalar::U8),
    ("short", "int16", Scalar::I16),
    ("ushort", "uint16", Scalar::U16),
    ("int", "int32", Scalar::I32),
    ("uint", "uint32", Scalar::U32),
    ("float", "float32", Scalar::F32),
    ("double", "float64", Scalar::F64),
];

const KEYWORDS: [&str; 6] = ["format", "comment", "obj_info", "element", "property", "end_header"];

/// The content of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PropertyType {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A named part of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) shape: PropertyType,
}

/// A table of the body: `count` rows of the same properties.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The line of its declaration.
    pub(super) line: u64,
}

/// A whole header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) encoding: BodyEncoding,
    pub(super) elements: Vec<Element>,
    /// The images that comments name, as MeshLab does.
    pub(super) textures: Vec<String>,
    /// Its length, the offset of the body.
    pub(super) bytes: u64,
    /// Its number of lines.
    pub(super) lines: u64,
}

/// The place of `line` in messages.
pub(super) fn place(line: u64) -> String {
    format!("header line {line}")
}

impl Element {
    /// The smallest number of bytes of a row, if a number of each kind has `least` bytes: that with
    /// empty lists.
    pub(super) fn least_row(&self, least: impl Fn(Scalar) -> u64) -> u64 {
        let of = |property: &Property| match property.shape {
            PropertyType::One(kind) | PropertyType::List { count: kind, .. } => least(kind),
        };
        self.properties.iter().map(of).sum()
    }
}

/// Reads up to the line `end_header`.
pub(super) fn read(file: &dyn ReadAt, length: u64) -> Result<Header> {
    let mut text = vec![0; length.min(MAX_HEADER) as usize];
    let filled = file.fill_at(&mut text, 0).map_err(read_failure)?;
    read_lines(&text[..filled])
}

fn read_lines(text: &[u8]) -> Result<Header> {
    let (mut encoding, mut elements, mut textures) = (None, Vec::new(), Vec::new());
    let (mut bytes, mut lines) = (0, 0);
    for line in text.split_inclusive(|byte| *byte == b'\n') {
        bytes += line.len() as u64;
        lines += 1;
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            _ if lines == 1 && line.trim() == "ply" => {}
            _ if lines == 1 => {
                let error = syntax("a PLY file begins with the line \"ply\"").at(place(1));
                let error = error.value(format_args!("{:?}", line.trim()));
                return Err(error.remedy("check that this is a PLY file"));
            }
            ["end_header"] => {
                let missing = syntax("the header has no format line");
                let remedy = "add one, such as \"format ascii 1.0\"";
                let encoding = encoding.ok_or_else(|| missing.remedy(remedy))?;
                return Ok(Header { encoding, elements, textures, bytes, lines });
            }
            ["comment", word, _, ..] if word.eq_ignore_ascii_case("TextureFile") => {
                textures.push(words[2..].join(" "));
            }
            _ => statement(&words, lines, &mut encoding, &mut elements)
                .map_err(|error| error.at(place(lines)))?,
        }
    }
    if lines == 0 {
        return Err(syntax("the file is empty").remedy("export it again"));
    }
    let error = syntax("the header does not end").at(place(lines + 1));
    if bytes >= MAX_HEADER {
        let remedy = format!("end it with \"end_header\" within {MAX_HEADER} bytes");
        return Err(error.remedy(remedy));
    }
    Err(error.remedy("end it with a line \"end_header\"; the file may be cut off"))
}

/// Processes a line of the header but its first and its last.
fn statement(
    words: &[&str],
    line: u64,
    encoding: &mut Option<BodyEncoding>,
    elements: &mut Vec<Element>,
) -> Result<()> {
    match words {
        [] | ["comment" | "obj_info", ..] => {}
        ["format", rest @ ..] if encoding.is_none() => *encoding = Some(format(rest)?),
        ["format", ..] => return Err(syntax("the format is given twice").remedy("keep one line")),
        ["element", rest @ ..] => elements.push(element(rest, line, elements)?),
        ["property", rest @ ..] => {
            let property = property(rest)?;
            let Some(element) = elements.last_mut() else {
                return Err(syntax("a property must follow its element")
                    .value(&property.name)
                    .remedy("add an \"element\" line before it"));
            };
            element.properties.push(property);
        }
        [other, ..] => return Err(unknown("unknown header line", other, KEYWORDS)),
    }
    Ok(())
}

fn format(words: &[&str]) -> Result<BodyEncoding> {
    let encoding = match words {
        ["ascii", _] => BodyEncoding::Ascii,
        ["binary_little_endian", _] => BodyEncoding::LittleEndian,
        ["binary_big_endian", _] => BodyEncoding::BigEndian,
        _ => {
            let right = "use ascii, binary_little_endian or binary_big_endian, and then 1.0";
            return Err(syntax("the format is unknown").value(words.join(" ")).remedy(right));
        }
    };
    match words {
        [_, "1.0"] => Ok(encoding),
        _ => Err(syntax("the version is unknown").value(words.join(" ")).remedy("use 1.0")),
    }
}

fn element(words: &[&str], line: u64, before: &[Element]) -> Result<Element> {
    let [name, digits] = words else {
        return Err(syntax("an element needs a name and a count")
            .value(words.join(" "))
            .remedy("write \"element vertex 8\""));
    };
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(syntax("the count of an element must be a whole number, 0 or more")
            .value(digits)
            .remedy("write \"element vertex 8\""));
    }
    // Only digits, but too large for the type.
    let Ok(count) = digits.parse() else {
        let message = format!("an element can have at most {MAX_COUNT} rows");
        let error = Error::new(ErrorKind::Limit, message).value(digits);
        return Err(error.remedy("check the count"));
    };
    check_count(&format!("rows of the element \"{name}\""), count)?;
    if before.iter().any(|e| e.name == *name) {
        return Err(syntax("an element is declared twice").value(name).remedy("join the two"));
    }
    Ok(Element { name: (*name).to_owned(), count, properties: Vec::new(), line })
}

fn property(words: &[&str]) -> Result<Property> {
    let (name, shape) = match words {
        ["list", count, item, name] => {
            (name, PropertyType::List { count: scalar(count)?, item: scalar(item)? })
        }
        [kind, name] => (name, PropertyType::One(scalar(kind)?)),
        _ => {
            let right = "write \"property float x\" or \"property list uchar int vertex_indices\"";
            let error = syntax("a property needs a type and a name");
            return Err(error.value(words.join(" ")).remedy(right));
        }
    };
    Ok(Property { name: (*name).to_owned(), shape })
}

fn scalar(name: &str) -> Result<Scalar> {
    let found = TYPE_NAMES.iter().find(|t| t.0 == name || t.1 == name).map(|t| t.2);
    let names = TYPE_NAMES.iter().flat_map(|t| [t.0, t.1]);
    found.ok_or_else(|| unknown("the type of the property is unknown", name, names))
}

/// The error of a word that is not one of `names`.
fn unknown<'a>(message: &str, word: &str, names: impl IntoIterator<Item = &'a str>) -> Error {
    let names: Vec<&str> = names.into_iter().collect();
    let remedy = match did_you_mean(word, names.iter().copied()) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("use one of {}", names.join(", ")),
    };
    syntax(message).value(word).remedy(remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Header> {
        read_lines(text.as_bytes())
    }

    #[test]
    fn blanks_comments_and_both_families_of_names_are_read() {
        let text = "ply\r\n \tcomment a \r\n\r\n\t format   binary_big_endian\t1.0 \r\nobj_info x\r\n\
                    element  vertex 7\r\nproperty\tfloat32 x\r\n  property list uint8  int w\r\n\
                    comment b\r\nelement face 0\r\n end_header \r\nBODY";
        let header = parse(text).unwrap();
        assert_eq!(header.encoding, BodyEncoding::BigEndian);
        assert_eq!((header.bytes, header.lines), (text.len() as u64 - 4, 11));
        assert_eq!(header.elements.len(), 2);
        let vertex = &header.elements[0];
        assert_eq!((vertex.name.as_str(), vertex.count, vertex.line), ("vertex", 7, 6));
        assert_eq!(vertex.properties[0].shape, PropertyType::One(Scalar::F32));
        let list = PropertyType::List { count: Scalar::U8, item: Scalar::I32 };
        assert_eq!(vertex.properties[1], Property { name: "w".into(), shape: list });
    }
}
