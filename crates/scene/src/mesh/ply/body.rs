//! The elements of a PLY body, in the order of the header: vertices, faces and triangle strips are
//! kept, others are skipped.

use super::faces::FaceArrays;
use super::header::{Element, Header, PropertyType};
use super::layout::{ListLayout, SLOTS, VertexLayout};
use super::numbers::{Numbers, malformed};
use super::vertices::VertexArrays;
use crate::mesh::data::{Attribute, MeshData, NO_VALUE, NamedMaterials, Read};
use crate::mesh::faults::{check_count, no_triangles, syntax, too_few_corners};
use crate::mesh::polygon::{self, Polygon};
use crate::mesh::scalar::Scalar;
use crate::mesh::validate::{bad_index, check_positions, mend, scale_byte_colors};
use glam::Vec2;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Reads the whole body into a mesh.
pub(super) fn read<'a>(
    header: &'a Header,
    mut numbers: Numbers<'a>,
) -> Result<(Read, NamedMaterials)> {
    let vertex = header.elements.iter().find(|e| e.name == "vertex").ok_or_else(|| {
        syntax("the header declares no element \"vertex\"")
            .remedy("declare one, with the properties x, y and z")
    })?;
    let notes = super::layout::unread(header, vertex).into_iter().collect();
    let mut body = Body { vertex_count: vertex.count as usize, notes, ..Body::default() };
    body.faces.images.textures.clone_from(&header.textures);
    for element in header.elements.iter().filter(|e| !e.properties.is_empty() || e.count > 0) {
        numbers.element = Some(element);
        body.element(element, &mut numbers)?;
    }
    body.note_trailing(&mut numbers)?;
    body.finish()
}

/// The contents so far.
#[derive(Debug, Default)]
struct Body {
    /// Number of vertices declared: faces may come before them.
    vertex_count: usize,
    vertices: VertexArrays,
    faces: FaceArrays,
    /// The corners of the current face.
    corners: Vec<u32>,
    /// Their texture coordinates, and the number of the face's image.
    corner_uvs: Vec<f32>,
    image: usize,
    /// Number of faces with fewer than three corners.
    too_few_corners: u64,
    /// Number of faces whose lines have more values than were declared.
    longer_faces: u64,
    notes: Vec<Error>,
}

/// What the rows of an element are.
enum RowKind {
    VertexArrays(VertexLayout),
    /// Faces, or strips of triangles.
    Lists(ListLayout),
    /// Unused ones.
    Other,
}

impl RowKind {
    fn of(element: &Element) -> Result<Self> {
        Ok(match element.name.as_str() {
            "vertex" => Self::VertexArrays(VertexLayout::of(element)?),
            "face" | "tristrips" if element.count > 0 => Self::Lists(ListLayout::of(element)?),
            _ => Self::Other,
        })
    }
}

impl Body {
    fn element(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<()> {
        let rows = RowKind::of(element)?;
        if element.properties.is_empty() {
            return Ok(());
        }
        check_room(element, numbers)?;
        let first = self
            .many_rows(&rows, element, numbers)
            .map_err(|error| located(error, element, 0, numbers))?;
        for index in first..element.count {
            self.row(&rows, element, index, numbers)
                .map_err(|error| located(error, element, index, numbers))?;
        }
        match rows {
            // Rows that were read together have been checked.
            RowKind::VertexArrays(_) if first < element.count => {
                check_positions(&self.vertices.positions)
            }
            _ => Ok(()),
        }
    }

    /// Makes room, and reads the first rows together if they are of a common form; returns their
    /// number.
    fn many_rows(
        &mut self,
        rows: &RowKind,
        element: &Element,
        numbers: &mut Numbers<'_>,
    ) -> Result<u64> {
        match rows {
            RowKind::VertexArrays(layout) => {
                self.vertices = VertexArrays::new(self.vertex_count, layout);
                self.vertices.read(layout, numbers)
            }
            RowKind::Lists(layout) if !layout.is_strip => {
                let likely = likely_triangles(element, *layout, numbers);
                let first = self.faces.read(element, *layout, self.vertex_count, numbers)?;
                if first < element.count {
                    self.faces.triangles.reserve(likely.saturating_sub(self.faces.triangles.len()));
                }
                Ok(first)
            }
            _ => Ok(0),
        }
    }

    fn row(
        &mut self,
        rows: &RowKind,
        element: &Element,
        index: u64,
        numbers: &mut Numbers<'_>,
    ) -> Result<()> {
        let mut values = [0.0; SLOTS];
        for (property, p) in element.properties.iter().enumerate() {
            match rows {
                RowKind::VertexArrays(layout) => match layout.columns[property] {
                    Some(column) => values[column.slot] = numbers.value(column.kind)?,
                    None => skip(p.shape, numbers)?,
                },
                RowKind::Lists(layout) if layout.property == property => {
                    self.read_corners(*layout, numbers)?;
                }
                RowKind::Lists(layout) if layout.uvs == Some(property) => {
                    self.read_uvs(p.shape, numbers)?;
                }
                RowKind::Lists(layout) if layout.texture == Some(property) => {
                    let PropertyType::One(kind) = p.shape else { continue };
                    // -1 is none.
                    let number = numbers.value(kind)?;
                    self.image = if number < 0.0 { usize::MAX } else { number as usize };
                }
                _ => skip(p.shape, numbers)?,
            }
        }
        // Some programs write colours of corners at the end of faces, and declare those of faces.
        let is_longer = numbers.end_row(matches!(rows, RowKind::Lists(_)))?;
        self.longer_faces += u64::from(is_longer);
        match rows {
            RowKind::VertexArrays(layout) => self.vertices.set(index as usize, layout, values),
            RowKind::Lists(layout) if layout.is_strip => {
                // Every index but two makes a triangle at most.
                self.faces.triangles.reserve(self.corners.len().saturating_sub(2));
                for strip in self.corners.split(|&i| i == STRIP_END) {
                    self.faces.triangles.extend(strip_triangles(strip));
                }
            }
            RowKind::Lists(layout) => self.push_face(layout.uvs.is_some())?,
            RowKind::Other => {}
        }
        Ok(())
    }

    /// Reads the list of a face or of a strip into `self.corners`.
    fn read_corners(&mut self, layout: ListLayout, numbers: &mut Numbers<'_>) -> Result<()> {
        let length = list_length(layout.count, layout.item, numbers)?;
        self.corners.clear();
        for _ in 0..length {
            let corner = match numbers.value(layout.item)? {
                // -1, also if it was written as an unsigned number.
                -1.0 | 4_294_967_295.0 if layout.is_strip => STRIP_END,
                value => vertex_index(value, self.vertex_count)?,
            };
            self.corners.push(corner);
        }
        Ok(())
    }

    /// Reads the texture coordinates of a face's corners.
    fn read_uvs(&mut self, shape: PropertyType, numbers: &mut Numbers<'_>) -> Result<()> {
        let PropertyType::List { count, item } = shape else { return Ok(()) };
        let length = list_length(count, item, numbers)?;
        self.corner_uvs.clear();
        for _ in 0..length {
            self.corner_uvs.push(numbers.value(item)? as f32);
        }
        Ok(())
    }

    /// Triangulates the face in `self.corners`.
    fn push_face(&mut self, has_uvs: bool) -> Result<()> {
        let corners = self.corners.len();
        if corners < 3 {
            self.too_few_corners += 1;
            return Ok(());
        }
        if corners > 3 {
            check_count("triangles", (self.faces.triangles.len() + corners) as u64)?;
            let (first, corners) = (self.faces.triangles.len() as u32, corners as u32);
            self.faces.polygons.push(Polygon { first, corners });
        }
        let FaceArrays { triangles, uvs, of_uvs, images, .. } = &mut self.faces;
        // No material has the name of none.
        let name = images.textures.get(self.image).map_or("", String::as_str);
        let is_other = images.runs.last().is_none_or(|(_, last)| last != name);
        if is_other && !images.textures.is_empty() {
            images.begin(triangles.len() as u32, name.to_owned());
        }
        triangles.extend(polygon::fan(&self.corners));
        if has_uvs {
            let (first, pairs) = (uvs.len() as u32, self.corner_uvs.chunks_exact(2));
            check_count("texture coordinates", (uvs.len() + corners) as u64)?;
            // A face without them has none at any corner.
            let is_whole = pairs.len() == corners;
            let own = (first..).take(corners).map(|i| if is_whole { i } else { NO_VALUE });
            of_uvs.extend(polygon::fan(&own.collect::<Vec<_>>()));
            uvs.extend(pairs.filter(|_| is_whole).map(|uv| Vec2::new(uv[0], uv[1])));
        }
        Ok(())
    }

    fn note_trailing(&mut self, numbers: &mut Numbers<'_>) -> Result<()> {
        let bytes = numbers.trailing()?;
        if bytes > 0 {
            let note = syntax("there is more after the last element, which is ignored");
            let note = note.at("end of the body").value(format_args!("{bytes} bytes"));
            self.notes.push(note.remedy("check the counts in the header"));
        }
        Ok(())
    }

    fn finish(mut self) -> Result<(Read, NamedMaterials)> {
        check_count("triangles", self.faces.triangles.len() as u64)?;
        if self.faces.triangles.is_empty() {
            return Err(no_triangles());
        }
        let VertexArrays { positions, origin, mut normals, mut uvs, mut colors } = self.vertices;
        let FaceArrays { mut triangles, polygons, uvs: mut of_faces, mut of_uvs, mut images } =
            self.faces;
        self.notes.extend(too_few_corners(self.too_few_corners));
        if self.longer_faces > 0 {
            let message = "lines of faces have more values than the header declares";
            let warning = Error::new(ErrorKind::Mesh, message).value(self.longer_faces);
            self.notes.push(warning.remedy("these are ignored"));
        }
        self.notes.extend(polygon::split(
            &polygons,
            &positions,
            &mut triangles,
            &mut [&mut of_uvs[..]],
        ));
        self.notes.extend(mend(&mut normals, &mut uvs, &mut colors));
        self.notes.extend(scale_byte_colors(&mut colors));
        self.notes.extend(mend(&mut [], &mut of_faces, &mut []));
        triangles.shrink_to_fit();
        let of_corners = Attribute { values: of_faces, indices: Some(of_uvs) };
        let uvs = if of_corners.values.is_empty() { attribute(uvs) } else { Some(of_corners) };
        if uvs.is_none() && !images.textures.is_empty() {
            let message = "the mesh names an image, but has no texture coordinates";
            let warning = Error::new(ErrorKind::Mesh, message).value(images.textures.join(", "));
            self.notes.push(warning.remedy("the image is left out"));
            images = NamedMaterials::default();
        } else if let (Some(name), true) = (images.textures.first(), images.runs.is_empty()) {
            // Of faces read together, all have the first.
            images.runs.push((0, name.clone()));
        }
        let mesh = MeshData {
            positions,
            origin,
            triangles,
            normals: attribute(normals),
            uvs,
            colors: (!colors.is_empty()).then_some(colors),
            alphas: None,
        };
        Ok(((mesh, self.notes), images))
    }
}

/// The `error` of a row of an element, with the row and, in a text, the line.
fn located(error: Error, element: &Element, index: u64, numbers: &Numbers<'_>) -> Error {
    let line = numbers.line().map_or(String::new(), |line| format!(" (line {line})"));
    error.at(format!("{} {index}{line}", element.name))
}

/// In a strip's list: the end of the strip.
const STRIP_END: u32 = u32::MAX;

/// The triangles of a strip. Every second one is reversed, so that all face the same way; those
/// with a repeated corner only join parts of the strip.
fn strip_triangles(strip: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let turn = |(i, w): (usize, &[u32])| {
        if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }
    };
    let plain = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    strip.windows(3).enumerate().map(turn).filter(plain)
}

fn attribute<T>(values: Vec<T>) -> Option<Attribute<T>> {
    (!values.is_empty()).then_some(Attribute { values, indices: None })
}

fn skip(shape: PropertyType, numbers: &mut Numbers<'_>) -> Result<()> {
    match shape {
        PropertyType::One(kind) => numbers.skip(kind, 1),
        PropertyType::List { count, item } => {
            let length = numbers.value(count)?;
            let length = whole_length(length).ok_or_else(|| malformed(length))?;
            numbers.skip(item, length)
        }
    }
}

/// Checks that the file is long enough for the declared rows.
fn check_room(element: &Element, numbers: &Numbers<'_>) -> Result<()> {
    let (row, left) = (least_row(element, numbers), numbers.left);
    // The last number of a text needs no line end.
    let need = row.saturating_mul(element.count);
    if need <= left.saturating_add(u64::from(numbers.line().is_some())) {
        return Ok(());
    }
    let Element { name, count, .. } = element;
    let held = left / row.max(1);
    let message = format!(
        "the file is cut off: its header promises {count} of \"{name}\", and there is room for {held}"
    );
    Err(syntax(message).at(format!("{name} {held}")).remedy("copy or export it again"))
}

/// The smallest number of bytes of a row.
fn least_row(element: &Element, numbers: &Numbers<'_>) -> u64 {
    element.least_row(|kind| numbers.least(kind, 1))
}

/// The number of triangles to allocate. Exact if the faces come last and have only the list, since
/// every index but two of a face makes a triangle; at most two for each face, for which the file
/// was checked to have room.
fn likely_triangles(element: &Element, layout: ListLayout, numbers: &Numbers<'_>) -> usize {
    let faces = element.count;
    let rows = least_row(element, numbers).saturating_mul(faces);
    let indices = numbers.left.saturating_sub(rows) / numbers.least(layout.item, 1).max(1);
    indices.saturating_sub(2 * faces).clamp(0, 2 * faces) as usize
}

/// A list's length, from its number.
fn whole_length(value: f64) -> Option<u64> {
    let is_length = value >= 0.0 && value.fract() == 0.0 && value <= f64::from(u32::MAX);
    is_length.then_some(value as u64)
}

/// The length of the next list, for whose items there must be room.
fn list_length(count: Scalar, item: Scalar, numbers: &mut Numbers<'_>) -> Result<u64> {
    let value = numbers.value(count)?;
    let length = whole_length(value).ok_or_else(|| {
        syntax("the length of a list must be a whole number, 0 or more")
            .value(value)
            .remedy("check the types in the header")
    })?;
    let (need, left) = (numbers.least(item, length), numbers.left);
    if need <= left.saturating_add(1) {
        return Ok(length);
    }
    let message = format!(
        "the file is cut off: a list of {length} takes at least {need} bytes, and {left} are left"
    );
    Err(syntax(message).remedy("copy or export it again, or correct the types in its header"))
}

/// A vertex index, from its number.
fn vertex_index(value: f64, count: usize) -> Result<u32> {
    if value >= 0.0 && value < count as f64 && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    Err(bad_index("vertex", value, count))
}
