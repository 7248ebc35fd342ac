//! The elements of a PLY body, in the order of the header: vertices, faces and triangle strips are
//! kept, others are skipped.

use super::header::{Element, Header, Shape};
use super::layout::{Column, ListLayout, SLOTS, VertexLayout};
use super::source::{Faces, Fault, Source, Vertices};
use crate::mesh::data::{Attribute, MeshData, Read};
use crate::mesh::faults::{check_count, no_triangles, read_failure};
use crate::mesh::polygon::{self, Polygon};
use crate::mesh::validate::{
    bad_index, check_positions, note_zeroed, whiten_bad_colors, zero_bad_normals, zero_bad_uvs,
};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Reads the whole body into a mesh.
pub(super) fn read<S: Source>(header: &Header, mut source: S) -> Result<Read> {
    let vertex = header.elements.iter().find(|e| e.name == "vertex").ok_or_else(|| {
        Error::new(ErrorKind::Syntax, "the header declares no element \"vertex\"")
            .remedy("declare one, with the properties x, y and z")
    })?;
    let notes = super::layout::unread(header, vertex);
    let mut body = Body { vertex_count: vertex.count as usize, notes, ..Body::default() };
    for element in header.elements.iter().filter(|e| !e.properties.is_empty() || e.count > 0) {
        body.element(element, &mut source)?;
    }
    body.note_trailing(&mut source)?;
    body.finish()
}

/// The contents so far.
#[derive(Debug, Default)]
struct Body {
    /// Number of vertices declared: faces may come before them.
    vertex_count: usize,
    vertices: Vertices,
    faces: Faces,
    /// The corners of the current face.
    corners: Vec<u32>,
    notes: Vec<Error>,
}

/// A row of an element, for messages.
#[derive(Clone, Copy, Debug)]
struct Row<'a> {
    element: &'a Element,
    index: u64,
}

impl Row<'_> {
    /// Adds the place to an `error`: the row, and in a text the line.
    fn locate(self, error: Error, source: &impl Source) -> Error {
        let row = format!("{} {}", self.element.name, self.index);
        error.at(match source.line() {
            Some(line) => format!("{row} (line {line})"),
            None => row,
        })
    }

    /// The error of a `fault` in this row.
    fn fault(self, fault: Fault, source: &impl Source) -> Error {
        let syntax = |message: &str| Error::new(ErrorKind::Syntax, message);
        let Element { name, count, .. } = self.element;
        let error = match fault {
            Fault::End => {
                syntax(&format!("the file is cut off: its header promises {count} of \"{name}\""))
                    .remedy("copy or export it again")
            }
            Fault::Malformed(text) => {
                syntax("a number is malformed").value(text).remedy("write it as 12 or -0.5e3")
            }
            Fault::LongRow => syntax("the line has too many values").remedy(
                "declare every value of a line in the header, and put each element on its own line",
            ),
            Fault::Io(error) => read_failure(error),
        };
        self.locate(error, source)
    }
}

impl Body {
    fn element<S: Source>(&mut self, element: &Element, source: &mut S) -> Result<()> {
        match element.name.as_str() {
            "vertex" => self.read_vertices(element, source),
            "face" if element.count > 0 => self.read_faces(element, source),
            "tristrips" if element.count > 0 => self.read_strips(element, source),
            _ => pass_over(element, source),
        }
    }

    fn read_vertices<S: Source>(&mut self, element: &Element, source: &mut S) -> Result<()> {
        let layout = VertexLayout::of(element)?;
        check_room(element, source)?;
        self.vertices = Vertices::new(self.vertex_count, &layout);
        let first = source
            .vertices(&layout, &mut self.vertices)
            .map_err(|fault| Row { element, index: 0 }.fault(fault, source))?;
        if first == element.count {
            return Ok(());
        }
        for index in first..element.count {
            let row = Row { element, index };
            let mut values =
                read_vertex(element, &layout, source).map_err(|f| row.fault(f, source))?;
            if layout.is_double() {
                self.vertices.relate(index, &mut values);
            }
            for Column { slot, scale, .. } in layout.columns.iter().flatten() {
                self.vertices.set(index as usize, *slot, values[*slot] as f32 * scale);
            }
        }
        check_positions(&self.vertices.positions)
    }

    fn read_faces<S: Source>(&mut self, element: &Element, source: &mut S) -> Result<()> {
        let layout = ListLayout::of(element)?;
        check_room(element, source)?;
        let likely = likely_triangles(element, layout, source);
        let first = source
            .faces(element, layout, self.vertex_count, &mut self.faces)
            .map_err(|fault| Row { element, index: 0 }.fault(fault, source))?;
        if first < element.count {
            self.faces.triangles.reserve(likely.saturating_sub(self.faces.triangles.len()));
        }
        for index in first..element.count {
            let row = Row { element, index };
            self.read_row(row, layout, source)?;
            self.push_face().map_err(|error| row.locate(error, source))?;
        }
        Ok(())
    }

    fn read_strips<S: Source>(&mut self, element: &Element, source: &mut S) -> Result<()> {
        let layout = ListLayout::of(element)?;
        check_room(element, source)?;
        for index in 0..element.count {
            self.read_row(Row { element, index }, layout, source)?;
            // Every index but two makes a triangle at most.
            self.faces.triangles.reserve(self.corners.len().saturating_sub(2));
            for strip in self.corners.split(|&i| i == STRIP_END) {
                self.faces.triangles.extend(strip_triangles(strip));
            }
        }
        Ok(())
    }

    /// Reads a row, with its list of vertices into `self.corners`.
    fn read_row<S: Source>(&mut self, row: Row, layout: ListLayout, source: &mut S) -> Result<()> {
        for (property, p) in row.element.properties.iter().enumerate() {
            if property == layout.property {
                self.read_corners(row, layout, source)?;
            } else {
                skip(p.shape, source).map_err(|fault| row.fault(fault, source))?;
            }
        }
        source.end_row().map_err(|fault| row.fault(fault, source))
    }

    fn read_corners<S: Source>(
        &mut self,
        row: Row,
        layout: ListLayout,
        source: &mut S,
    ) -> Result<()> {
        let length = source.value(layout.count).map_err(|fault| row.fault(fault, source))?;
        let length = list_length(length).map_err(|error| row.locate(error, source))?;
        let (need, left) = (source.least(layout.item, length), source.left());
        if need > left.saturating_add(1) {
            return Err(row.locate(too_long(length, need, left), source));
        }
        let strips = row.element.name == "tristrips";
        self.corners.clear();
        for _ in 0..length {
            let value = source.value(layout.item).map_err(|fault| row.fault(fault, source))?;
            let corner = match value {
                // -1, also if it was written as an unsigned number.
                -1.0 | 4_294_967_295.0 if strips => STRIP_END,
                value => vertex_index(value, self.vertex_count)
                    .map_err(|error| row.locate(error, source))?,
            };
            self.corners.push(corner);
        }
        Ok(())
    }

    /// Triangulates the face in `self.corners`.
    fn push_face(&mut self) -> Result<()> {
        let corners = self.corners.len();
        if corners < 3 {
            return Err(Error::new(ErrorKind::Mesh, "a face needs at least 3 vertices")
                .value(corners)
                .remedy("remove the face"));
        }
        if corners > 3 {
            check_count("triangles", (self.faces.triangles.len() + corners) as u64)?;
            let (first, corners) = (self.faces.triangles.len() as u32, corners as u32);
            self.faces.polygons.push(Polygon { first, corners });
        }
        self.faces.triangles.extend(polygon::fan(&self.corners));
        Ok(())
    }

    fn note_trailing(&mut self, source: &mut impl Source) -> Result<()> {
        let bytes = source.trailing().map_err(|fault| match fault {
            Fault::Io(error) => read_failure(error),
            _ => Error::new(ErrorKind::Syntax, "the end of the file cannot be read"),
        })?;
        if bytes > 0 {
            let message = "there is more after the last element, which is ignored";
            let note = Error::new(ErrorKind::Syntax, message).at("end of the body");
            let remedy = "check the counts in the header";
            self.notes.push(note.value(format_args!("{bytes} bytes")).remedy(remedy));
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Read> {
        check_count("triangles", self.faces.triangles.len() as u64)?;
        if self.faces.triangles.is_empty() {
            return Err(no_triangles());
        }
        let Vertices { positions, origin, mut normals, mut uvs, mut colors } = self.vertices;
        let Faces { mut triangles, polygons } = self.faces;
        let large = polygon::split(&polygons, &positions, &mut triangles, &mut []);
        self.notes.extend(polygon::note_large(large));
        self.notes.extend(note_zeroed("normals", zero_bad_normals(&mut normals)));
        self.notes.extend(note_zeroed("texture coordinates", zero_bad_uvs(&mut uvs)));
        self.notes.extend(whiten_bad_colors(&mut colors));
        triangles.shrink_to_fit();
        let mesh = MeshData {
            positions,
            origin,
            triangles,
            normals: attribute(normals),
            uvs: attribute(uvs),
            colors: (!colors.is_empty()).then_some(colors),
        };
        Ok((mesh, self.notes))
    }
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

/// Reads a vertex and stores its numbers in use.
fn read_vertex<S: Source>(
    element: &Element,
    layout: &VertexLayout,
    source: &mut S,
) -> std::result::Result<[f64; SLOTS], Fault> {
    let mut values = [0.0; SLOTS];
    for (p, column) in element.properties.iter().zip(&layout.columns) {
        match column {
            Some(column) => values[column.slot] = source.value(column.kind)?,
            None => skip(p.shape, source)?,
        }
    }
    source.end_row()?;
    Ok(values)
}

/// Skips a property.
fn skip<S: Source>(shape: Shape, source: &mut S) -> std::result::Result<(), Fault> {
    match shape {
        Shape::One(kind) => source.skip(kind, 1),
        Shape::List { count, item } => {
            let length = source.value(count)?;
            let length = list_length(length).map_err(|_| Fault::Malformed(length.to_string()))?;
            source.skip(item, length)
        }
    }
}

/// Skips an unused element.
fn pass_over<S: Source>(element: &Element, source: &mut S) -> Result<()> {
    if element.properties.is_empty() {
        return Ok(());
    }
    check_room(element, source)?;
    for index in 0..element.count {
        let row = Row { element, index };
        let skipped = element.properties.iter().try_for_each(|p| skip(p.shape, source));
        skipped.and_then(|()| source.end_row()).map_err(|fault| row.fault(fault, source))?;
    }
    Ok(())
}

/// Checks that the file is long enough for the declared rows.
fn check_room(element: &Element, source: &impl Source) -> Result<()> {
    let (row, left) = (source.least_row(&element.properties), source.left());
    // The last number of a text needs no line end.
    let need = row.saturating_mul(element.count);
    if need <= left.saturating_add(u64::from(source.line().is_some())) {
        return Ok(());
    }
    let Element { name, count, .. } = element;
    let held = left / row.max(1);
    let message = format!(
        "the file is cut off: its header promises {count} of \"{name}\", and there is room for {held}"
    );
    Err(Error::new(ErrorKind::Syntax, message)
        .at(format!("{name} {held}"))
        .remedy("copy or export it again"))
}

/// The number of triangles to allocate. Exact if the faces come last and have only the list, since
/// every index but two of a face makes a triangle; at most two for each face, for which the file
/// was checked to have room.
fn likely_triangles(element: &Element, layout: ListLayout, source: &impl Source) -> usize {
    let faces = element.count;
    let row = source.least_row(&element.properties).saturating_mul(faces);
    let indices = source.left().saturating_sub(row) / source.least(layout.item, 1).max(1);
    indices.saturating_sub(2 * faces).clamp(0, 2 * faces) as usize
}

/// A list's length, from its number.
fn list_length(value: f64) -> Result<u64> {
    if value >= 0.0 && value.fract() == 0.0 && value <= f64::from(u32::MAX) {
        return Ok(value as u64);
    }
    Err(Error::new(ErrorKind::Syntax, "the length of a list must be a whole number, 0 or more")
        .value(value)
        .remedy("check the types in the header"))
}

fn too_long(length: u64, need: u64, left: u64) -> Error {
    let message = format!(
        "the file is cut off: a list of {length} takes at least {need} bytes, and {left} are left"
    );
    Error::new(ErrorKind::Syntax, message)
        .remedy("copy or export it again, or correct the types in its header")
}

/// A vertex index, from its number.
fn vertex_index(value: f64, count: usize) -> Result<u32> {
    if value >= 0.0 && value < count as f64 && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    Err(bad_index("vertex", value, count))
}
