//! Finds the properties of a mesh in the declared elements, and their place in a row.

use super::header::{Element, Header, Property, PropertyType, place};
use crate::mesh::faults::syntax;
use crate::mesh::scalar::Scalar;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The numbers of a vertex have slots: those of its position from 0 on, and of its normal, texture
/// coordinates and colour from these on.
pub(super) const NORMAL: usize = 3;
pub(super) const UV: usize = 6;
pub(super) const COLOR: usize = 8;
/// The names in files of what begins at each of these slots, in any case.
const NAMES: [(usize, &[&str]); 9] = [
    (0, &["x", "y", "z"]),
    (NORMAL, &["nx", "ny", "nz"]),
    (UV, &["u", "v"]),
    (UV, &["s", "t"]),
    (UV, &["texture_u", "texture_v"]),
    (UV, &["texture_s", "texture_t"]),
    (COLOR, &["red", "green", "blue"]),
    (COLOR, &["diffuse_red", "diffuse_green", "diffuse_blue"]),
    (COLOR, &["r", "g", "b"]),
];
/// Names of the lists of vertices.
const LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The source of a number of a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NumberSource {
    /// The index of the property.
    pub(super) property: usize,
    pub(super) kind: Scalar,
    /// Its offset in a binary row without lists.
    pub(super) offset: usize,
    /// Factor on the number.
    pub(super) scale: f32,
}

/// The rows of the element `vertex`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VertexLayout {
    /// By slot: 0 to 2 are the position, 3 to 5 the normal, 6 and 7 the texture coordinates, 8 to 10 the
    /// colour. The file has all of these or none.
    pub(super) sources: [Option<NumberSource>; COLOR + 3],
    /// The length of a binary row, if it is constant.
    pub(super) stride: Option<usize>,
    /// Whether positions are in double precision.
    pub(super) is_double: bool,
}

impl VertexLayout {
    pub(super) fn of(element: &Element) -> Result<Self> {
        let mut sources = [None; COLOR + 3];
        for (first, names) in NAMES {
            let all = names.iter().zip(first..).map(|(name, slot)| find(element, name, slot));
            let found = match all.collect::<Result<Option<Vec<NumberSource>>>>() {
                // Properties with these names that are not colours are skipped.
                Err(_) if first == COLOR => None,
                found => found.map_err(|error| error.at(place(element.line)))?,
            };
            match found {
                Some(found) if sources[first].is_none() => {
                    sources[first..].iter_mut().zip(found).for_each(|(to, own)| *to = Some(own));
                }
                None if first == 0 => return Err(no_position(element).at(place(element.line))),
                _ => {}
            }
        }
        let is_double = sources[..NORMAL].iter().flatten().all(|own| own.kind == Scalar::F64);
        Ok(Self { sources, stride: stride(&element.properties), is_double })
    }

    /// The sources of the `N` slots from `first` on, if the file has them.
    pub(super) fn sources<const N: usize>(&self, first: usize) -> Option<[NumberSource; N]> {
        let any = self.sources[first]?;
        Some(std::array::from_fn(|i| self.sources[first + i].unwrap_or(any)))
    }

    /// The sources of the position, if it is in double precision.
    pub(super) fn double(&self) -> Option<[NumberSource; 3]> {
        if self.is_double { self.sources(0) } else { None }
    }

    /// The layout of a row of only the used numbers, each as a double.
    pub(super) fn in_doubles(&self) -> Self {
        let (kind, size) = (Scalar::F64, size_of::<f64>());
        let used = || self.sources.iter().flatten();
        let before = |own: NumberSource| used().filter(|c| c.property < own.property).count();
        let moved = |own| NumberSource { kind, offset: before(own) * size, ..own };
        let sources = self.sources.map(|own| own.map(moved));
        Self { sources, stride: Some(used().count() * size), is_double: self.is_double }
    }
}

/// The factor on numbers of a slot. Texture coordinates in small integers are fractions of the
/// largest value: integers would all refer to the same corner of the texture. So are colours; in
/// 32-bit integers, of a byte's.
fn scale(slot: usize, kind: Scalar) -> f32 {
    match kind.greatest() {
        Some(greatest) if slot >= UV && kind.size() < 4 => 1.0 / greatest as f32,
        Some(_) if slot >= COLOR => 1.0 / f32::from(u8::MAX),
        _ => 1.0,
    }
}

/// The source of a `slot` in the property with this name, if it exists: a single number, declared once.
fn find(element: &Element, name: &str, slot: usize) -> Result<Option<NumberSource>> {
    let mut all = (0..element.properties.len())
        .filter(|&i| element.properties[i].name.eq_ignore_ascii_case(name));
    let Some(property) = all.next() else { return Ok(None) };
    if all.next().is_some() {
        return Err(syntax("a vertex property is declared twice")
            .value(name)
            .remedy("rename one of the two"));
    }
    let PropertyType::One(kind) = element.properties[property].shape else {
        return Err(syntax("a vertex property must be a single number")
            .value(format_args!("a list \"{name}\""))
            .remedy(format!("declare it as \"property float {name}\"")));
    };
    let offset = stride(&element.properties[..property]).unwrap_or(0);
    Ok(Some(NumberSource { property, kind, offset, scale: scale(slot, kind) }))
}

fn no_position(element: &Element) -> Error {
    let names: Vec<&str> = element.properties.iter().map(|p| p.name.as_str()).collect();
    syntax("the vertices need the properties x, y and z")
        .value(if names.is_empty() { "none".to_owned() } else { names.join(", ") })
        .remedy("declare each, as in \"property float x\"")
}

/// The binary length of these properties, if none is a list.
pub(super) fn stride(properties: &[Property]) -> Option<usize> {
    let size = |p: &Property| match p.shape {
        PropertyType::One(kind) => Some(kind.size()),
        PropertyType::List { .. } => None,
    };
    properties.iter().map(size).sum()
}

/// The warning of properties of faces that would change how the mesh looks, but are not read.
pub(super) fn unread(header: &Header, vertex: &Element) -> Option<Error> {
    let has = |element: &Element, name: &str| {
        element.properties.iter().any(|p| p.name.eq_ignore_ascii_case(name))
    };
    let faces = || header.elements.iter().filter(|element| element.name == "face");
    let colors = || NAMES.iter().filter(|(first, _)| *first == COLOR);
    let is_colored =
        |element: &Element| colors().any(|(_, names)| names.iter().all(|n| has(element, n)));
    let warning = Error::new(ErrorKind::Mesh, "the colours of faces are ignored");
    (!is_colored(vertex) && faces().any(is_colored))
        .then(|| warning.remedy("export colours of vertices instead"))
}

/// The rows of an element with lists of vertices: `face` or `tristrips`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ListLayout {
    /// The index of the list property.
    pub(super) property: usize,
    pub(super) count: Scalar,
    pub(super) item: Scalar,
    pub(super) is_strip: bool,
    /// The properties with the texture coordinates of the corners, two numbers each, and with the number of the image.
    pub(super) uvs: Option<usize>,
    pub(super) texture: Option<usize>,
}

impl ListLayout {
    pub(super) fn of(element: &Element) -> Result<Self> {
        let find = |name| element.properties.iter().position(|p| p.name == name);
        let is_list = |i: &usize| !matches!(element.properties[*i].shape, PropertyType::One(_));
        let uvs = find("texcoord").filter(is_list);
        let texture = find("texnumber").filter(|i| !is_list(i));
        let mut lists = (0..).zip(&element.properties).filter_map(|(property, p)| {
            let PropertyType::List { count, item } = p.shape else { return None };
            let is_strip = element.name == "tristrips";
            let layout = Self { property, count, item, is_strip, uvs, texture };
            LISTS.contains(&p.name.as_str()).then_some(layout)
        });
        match (lists.next(), lists.next()) {
            (Some(layout), None) => Ok(layout),
            (found, _) => {
                let name = &element.name;
                let error = syntax(format!("the element \"{name}\" needs one list vertex_indices"));
                let error = error.value(if found.is_some() { "two" } else { "none" });
                let right = "declare \"property list uchar int vertex_indices\"";
                Err(error.at(place(element.line)).remedy(right))
            }
        }
    }
}
