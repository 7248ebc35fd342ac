//! The elements of a PLY body, in the order of the header: vertices, faces and triangle strips are
//! kept, others are skipped.

use super::faces::FaceArrays;
use super::header::{Element, Header};
use super::layout::{ListLayout, VertexLayout};
use super::numbers::{Numbers, Row};
use super::vertices::VertexArrays;
use crate::mesh::data::{Attribute, MeshData, NamedMaterials, Read};
use crate::mesh::faults::{check_count, no_triangles, syntax, too_few_corners};
use crate::mesh::polygon;
use crate::mesh::validate::{mend, scale_byte_colors};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Reads the whole body into a mesh. That of a part of the faces has no vertices behind those that these use.
pub(super) fn read<'a>(
    header: &'a Header,
    mut numbers: Numbers<'a>,
    is_part: bool,
) -> Result<Read> {
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
    if is_part {
        let last = body.faces.triangles.as_flattened().iter().max();
        body.vertices.truncate(last.map_or(0, |&last| last as usize + 1));
        return body.finish();
    }
    let bytes = numbers.trailing()?;
    if bytes > 0 {
        let note = syntax("there is more after the last element, which is ignored");
        let note = note.at("end of the body").value(format_args!("{bytes} bytes"));
        body.notes.push(note.remedy("check the counts in the header"));
    }
    body.finish()
}

/// The contents so far.
#[derive(Debug, Default)]
struct Body {
    /// Number of vertices declared: faces may come before them.
    vertex_count: usize,
    vertices: VertexArrays,
    faces: FaceArrays,
    /// Number of faces whose lines have more values than were declared.
    longer_faces: u64,
    /// The current row.
    row: Row,
    notes: Vec<Error>,
}

/// What the rows of an element are.
enum RowKind {
    /// With their layout in a binary file, and in doubles.
    Vertices(Box<[VertexLayout; 2]>),
    /// Faces, or strips of triangles.
    Lists(ListLayout),
    /// Unused ones.
    Other,
}

impl RowKind {
    fn of(element: &Element) -> Result<Self> {
        Ok(match element.name.as_str() {
            "vertex" => {
                let layout = VertexLayout::of(element)?;
                let in_doubles = layout.in_doubles();
                Self::Vertices(Box::new([layout, in_doubles]))
            }
            "face" | "tristrips" if element.count > 0 => Self::Lists(ListLayout::of(element)?),
            _ => Self::Other,
        })
    }

    /// The used properties.
    fn used(&self) -> Vec<usize> {
        match self {
            Self::Vertices(layouts) => {
                layouts[0].sources.iter().flatten().map(|source| source.property).collect()
            }
            &Self::Lists(ListLayout { property, uvs, texture, .. }) => {
                [Some(property), uvs, texture].into_iter().flatten().collect()
            }
            Self::Other => Vec::new(),
        }
    }
}

impl Body {
    fn element(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Result<()> {
        let kind = RowKind::of(element)?;
        if element.properties.is_empty() {
            return Ok(());
        }
        check_room(element, numbers)?;
        if let RowKind::Vertices(layouts) = &kind {
            self.vertices = VertexArrays::new(self.vertex_count, &layouts[0]);
        }
        let used = kind.used();
        self.row.used = (0..element.properties.len()).map(|i| used.contains(&i)).collect();
        let mut index = 0;
        while index < element.count {
            let rows = self.rows(&kind, index, numbers);
            index += rows.map_err(|error| {
                let line = numbers.line().map_or(String::new(), |line| format!(" (line {line})"));
                error.at(format!("{} {index}{line}", element.name))
            })?;
        }
        Ok(())
    }

    /// Reads the row `index`, or many rows together if they are of a common form; returns their
    /// number.
    fn rows(&mut self, kind: &RowKind, index: u64, numbers: &mut Numbers<'_>) -> Result<u64> {
        let many = match kind {
            // The first vertex gives the origin.
            RowKind::Vertices(layouts) if index == 1 => self.vertices.read(&layouts[0], numbers)?,
            RowKind::Lists(layout) if index == 0 => {
                self.faces.read(*layout, self.vertex_count, numbers)?
            }
            _ => 0,
        };
        if many > 0 {
            return Ok(many);
        }
        numbers.row(&mut self.row)?;
        // Some programs write colours of corners at the end of faces, and declare those of faces.
        let is_longer = numbers.end_row(matches!(kind, RowKind::Lists(_)))?;
        self.longer_faces += u64::from(is_longer);
        match kind {
            RowKind::Vertices(layouts) => {
                self.vertices.set(index as usize, &layouts[1], &self.row.numbers)?;
            }
            RowKind::Lists(layout) => self.faces.push(&self.row, *layout, self.vertex_count)?,
            RowKind::Other => {}
        }
        Ok(1)
    }

    fn finish(mut self) -> Result<Read> {
        check_count("triangles", self.faces.triangles.len() as u64)?;
        if self.faces.triangles.is_empty() {
            return Err(no_triangles());
        }
        let VertexArrays { positions, origin, mut normals, mut uvs, mut colors } = self.vertices;
        let FaceArrays { mut triangles, polygons, uvs: mut of_faces, mut of_uvs, .. } = self.faces;
        let mut images = self.faces.images;
        self.notes.extend(too_few_corners(self.faces.too_few_corners));
        if self.longer_faces > 0 {
            let message = "lines of faces have more values than the header declares";
            let warning = Error::new(ErrorKind::Mesh, message).value(self.longer_faces);
            self.notes.push(warning.remedy("these are ignored"));
        }
        let attributes = &mut [&mut of_uvs[..]];
        self.notes.extend(polygon::split(&polygons, &positions, &mut triangles, attributes));
        self.notes.extend(mend(&mut normals, &mut uvs, &mut colors));
        self.notes.extend(scale_byte_colors(&mut colors));
        self.notes.extend(mend(&mut [], &mut of_faces, &mut []));
        triangles.shrink_to_fit();
        let of_corners = Attribute { values: of_faces.into(), indices: Some(of_uvs.into()) };
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
            positions: positions.into(),
            origin,
            triangles: triangles.into(),
            normals: attribute(normals),
            uvs,
            colors: (!colors.is_empty()).then_some(colors.into()),
            alphas: None,
        };
        Ok((mesh, self.notes, images))
    }
}

fn attribute<T>(values: Vec<T>) -> Option<Attribute<T>> {
    (!values.is_empty()).then_some(values.into())
}

/// Checks that the file is long enough for the declared rows.
fn check_room(element: &Element, numbers: &Numbers<'_>) -> Result<()> {
    let (row, left) = (element.least_row(|kind| numbers.least(kind, 1)), numbers.left);
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
