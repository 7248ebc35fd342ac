//! Primitives of meshes: from accessors to the arrays of a mesh.

use glam::{DVec3, Vec2, Vec3};

use crate::format::Notes;
use crate::mesh::{Attribute, MeshData, Scalar, bad_position, is_good_position};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::shared::Shared;

use super::accessor::{Accessor, is_index};
use super::document::Document;
use super::pose::Pose;
use super::primitive::{COLORS, Mode, Primitive};
use super::texture::coordinates;

/// Reads primitives, and counts the bytes read.
pub(super) struct PrimitiveReader<'a> {
    pub(super) document: &'a Document,
    pub(super) notes: &'a Notes<'a>,
    /// Bytes that may still be read. Accessors may share bytes: without a limit, a small file could
    /// use the same ones any number of times.
    left: u64,
}

/// Bytes that may be read in any file, 64 MiB.
const READ_ANYHOW: u64 = 1 << 26;
/// How often all bytes of all buffers may be read. Files with primitives that share vertices read
/// each a few times.
const READ_AGAIN: u64 = 64;

/// The vertices of a primitive.
pub(super) struct Vertices<'p> {
    pub(super) of: &'p Primitive,
    count: usize,
    /// Those at corners, if most are at none.
    used: Option<Vec<u32>>,
}

impl Vertices<'_> {
    /// The number in the file of the vertex read as number `i`.
    pub(super) fn number(&self, i: usize) -> usize {
        self.used.as_ref().map_or(i, |used| used[i] as usize)
    }
}

/// The types of an attribute's numbers, and whether they are normalised.
pub(super) type Types = [(Scalar, bool)];

/// The types of texture coordinates, colours and weights.
pub(super) const UNSIGNED: &Types =
    &[(Scalar::F32, false), (Scalar::U8, true), (Scalar::U16, true)];
/// The types of normals in quantised meshes; the first one of normals and positions in others.
pub(super) const SIGNED: &Types = &[(Scalar::F32, false), (Scalar::I8, true), (Scalar::I16, true)];

impl<'a> PrimitiveReader<'a> {
    /// Reads primitives of a file.
    pub(super) fn new(document: &'a Document, notes: &'a Notes<'a>) -> Self {
        let again = READ_AGAIN.saturating_mul(document.storage.len() as u64);
        Self { document, notes, left: READ_ANYHOW.saturating_add(again) }
    }

    /// The arrays of a primitive in a pose, with a set of texture coordinates if a texture uses it, and
    /// the alphas of vertices if the material does. `None` for primitives without triangles.
    pub(super) fn mesh(
        &mut self,
        primitive: &Primitive,
        pose: &Pose,
        set: Option<u32>,
        uses_alpha: bool,
    ) -> Result<Option<MeshData>> {
        let note = |message, remedy| self.notes.note(&primitive.path, message, remedy);
        let Some(mode) = primitive.mode else { return Ok(None) };
        let Some(&positions) = primitive.attributes.get("POSITION") else {
            note("a primitive without positions is left out", "add the attribute POSITION");
            return Ok(None);
        };
        let count = self.accessor(positions).count;
        let corners = self.corners(primitive, count)?;
        let (corners, used) = compacted(corners, count);
        let mut triangles = triangles(mode, &corners, self.notes, &primitive.path);
        if triangles.is_empty() {
            note("a primitive without a triangle is left out", "a triangle needs three vertices");
            return Ok(None);
        }
        triangles.shrink_to_fit();
        let vertices = Vertices { of: primitive, count, used };
        let normals = self.normals(&vertices)?;
        let uvs = set.map_or(Ok(None), |set| self.uvs(&vertices, set))?;
        let positions = self.positions(&vertices)?;
        let colors = self.colors(&vertices)?;
        let alphas = if uses_alpha { self.alphas(&vertices)? } else { None };
        let origin = DVec3::ZERO;
        let mut mesh = MeshData {
            positions: positions.into(),
            origin,
            triangles: triangles.into(),
            normals,
            uvs,
            colors: colors.map(Shared::from),
            alphas: alphas.map(Shared::from),
        };
        self.posed(&vertices, pose, &mut mesh)?;
        Ok(Some(mesh))
    }

    fn accessor(&self, index: usize) -> &'a Accessor {
        &self.document.storage.accessors[index]
    }

    /// Checks that `count` elements may be read, and counts them.
    fn pay(&mut self, primitive: &Primitive, accessor: &Accessor, count: usize) -> Result<()> {
        let cost =
            (count as u64).saturating_mul((accessor.component.size() * accessor.width) as u64);
        let left = self.left.checked_sub(cost).ok_or_else(|| {
            self.error(&primitive.path, "the accessors of the file overlap too much")
                .remedy("store the data of each mesh once, or use one mesh in several nodes")
        });
        self.left = left?;
        Ok(())
    }

    /// The vertices at the corners, in order.
    fn corners(&mut self, primitive: &Primitive, count: usize) -> Result<Vec<u32>> {
        let place = || format!("{}.indices", primitive.path);
        let Some(index) = primitive.indices else {
            // Without positions in the file, at most as many as it has bytes: see `Accessor::read`.
            self.pay(primitive, self.accessor(primitive.attributes["POSITION"]), count)?;
            let all = u32::try_from(count).map_err(|_| {
                let error = Error::new(ErrorKind::Limit, "a mesh has too many vertices");
                error.at(&*primitive.path).value(count).remedy("split the mesh into several")
            });
            return Ok((0..all?).collect());
        };
        let accessor = self.accessor(index);
        if !is_index(accessor.component) || accessor.width != 1 || accessor.normalized {
            let message = "indices must be SCALAR, of type 5121, 5123 or 5125";
            return Err(self.error(&place(), message).value(format!("accessors[{index}]")));
        }
        self.pay(primitive, accessor, accessor.count)?;
        let corners = self.document.storage.elements(index).indices();
        let restart = accessor.component.greatest();
        let Some(at) = corners.iter().position(|&i| i as usize >= count || Some(i) == restart)
        else {
            return Ok(corners);
        };
        let place = format!("{}[{at}]", place());
        if Some(corners[at]) == restart {
            let error = self
                .error(&place, "the greatest number of a type is reserved for primitive restart");
            return Err(error.value(corners[at]).remedy("split the mesh into several primitives"));
        }
        let error = self.error(&place, "there is no such vertex").value(corners[at]);
        Err(error.remedy(format!("the mesh has {count}; check that the file is whole")))
    }

    /// An attribute's elements, if the primitive has it.
    pub(super) fn attribute<T: Clone + Default + Send, const N: usize>(
        &mut self,
        vertices: &Vertices<'_>,
        name: &str,
        types: (usize, &Types),
        make: impl Fn([f64; N]) -> T + Sync + Send,
    ) -> Result<Option<Vec<T>>> {
        let Some(&index) = vertices.of.attributes.get(name) else { return Ok(None) };
        let place = format!("{}.attributes.{name}", vertices.of.path);
        self.elements(vertices, index, &place, types, make).map(Some)
    }

    /// The elements of the accessor that is named at `place`, with this number of components, one for
    /// each used vertex, as `make` converts them.
    pub(super) fn elements<T: Clone + Default + Send, const N: usize>(
        &mut self,
        Vertices { of, count, used }: &Vertices<'_>,
        index: usize,
        place: &str,
        (width, types): (usize, &Types),
        make: impl Fn([f64; N]) -> T + Sync + Send,
    ) -> Result<Vec<T>> {
        let accessor = self.accessor(index);
        let has_floats = types.contains(&(Scalar::F32, false));
        let is_known = types.contains(&(accessor.component, accessor.normalized))
            || self.document.is_quantized && has_floats && accessor.component != Scalar::U32;
        if accessor.width != width || !is_known {
            let types = match (has_floats, types.len()) {
                (false, _) => "of integers of 8 or 16 bits, not negative",
                (true, 1) => "of floats",
                (true, _) => "of floats or of normalized integers",
            };
            let error = self.error(place, &format!("must be VEC{width} {types}"));
            return Err(error.value(format!("accessors[{index}]")).remedy("export the file again"));
        }
        if accessor.count != *count {
            let message = format!("must have as many elements as POSITION, {count}");
            return Err(self.error(place, &message).value(accessor.count));
        }
        self.pay(of, accessor, used.as_ref().map_or(*count, Vec::len))?;
        Ok(self.document.storage.elements(index).each(used.as_deref(), make))
    }

    fn positions(&mut self, vertices: &Vertices<'_>) -> Result<Vec<Vec3>> {
        let points = self.attribute(vertices, "POSITION", (3, &SIGNED[..1]), |p| {
            DVec3::from_array(p).as_vec3()
        })?;
        let points = points.unwrap_or_default();
        self.check_positions(vertices, &points)?;
        Ok(points)
    }

    /// Checks that all vertices are where they may be.
    pub(super) fn check_positions(&self, vertices: &Vertices<'_>, points: &[Vec3]) -> Result<()> {
        let Some(bad) = points.iter().position(|p| !is_good_position(*p)) else {
            return Ok(());
        };
        let number = vertices.number(bad);
        let place = format!("{}.attributes.POSITION[{number}]", vertices.of.path);
        Err(bad_position(points[bad]).in_file(self.notes.file()).at(place))
    }

    fn normals(&mut self, vertices: &Vertices<'_>) -> Result<Option<Attribute<Vec3>>> {
        let types = if self.document.is_quantized { SIGNED } else { &SIGNED[..1] };
        let values = self.attribute(vertices, "NORMAL", (3, types), |normal| {
            // A zero vector is an unknown normal.
            let normal = DVec3::from_array(normal).as_vec3();
            if normal.is_finite() { normal } else { Vec3::ZERO }
        })?;
        if values.as_ref().is_some_and(|values| values.contains(&Vec3::ZERO)) {
            let message = "some normals are zero or not finite";
            self.notes.note(&vertices.of.path, message, "their triangles are shaded flat");
        }
        Ok(values.map(Attribute::from))
    }

    fn uvs(&mut self, vertices: &Vertices<'_>, set: u32) -> Result<Option<Attribute<Vec2>>> {
        let name = format!("TEXCOORD_{set}");
        let values = self.attribute(vertices, &name, (2, UNSIGNED), |uv| {
            Some(coordinates(uv)).filter(|uv| uv.is_finite()).unwrap_or(Vec2::ZERO)
        })?;
        if values.is_none() {
            let message = "the mesh has no texture coordinates";
            let remedy = format!("its textures are left out; add the attribute {name}");
            self.notes.note(&vertices.of.path, message, &remedy);
        }
        Ok(values.map(Attribute::from))
    }

    /// Colours, without alpha.
    fn colors(&mut self, vertices: &Vertices<'_>) -> Result<Option<Vec<Vec3>>> {
        let accessor = vertices.of.attributes.get(COLORS).map(|&index| self.accessor(index));
        let width = accessor.map_or(3, |accessor| accessor.width.clamp(3, 4));
        let part = |x: f64| if x.is_finite() { x.max(0.0) as f32 } else { 1.0 };
        let color = |[r, g, b]: [f64; 3]| Vec3::new(part(r), part(g), part(b));
        self.attribute(vertices, COLORS, (width, UNSIGNED), color)
    }

    /// The alphas of colours, if some are below 1.
    fn alphas(&mut self, vertices: &Vertices<'_>) -> Result<Option<Vec<f32>>> {
        let accessor = vertices.of.attributes.get(COLORS).map(|&index| self.accessor(index));
        if accessor.is_none_or(|accessor| accessor.width != 4) {
            return Ok(None);
        }
        let alpha =
            |[_, _, _, a]: [f64; 4]| if a.is_nan() { 1.0 } else { a.clamp(0.0, 1.0) as f32 };
        let alphas = self.attribute(vertices, COLORS, (4, UNSIGNED), alpha)?;
        Ok(alphas.filter(|alphas| alphas.iter().any(|&alpha| alpha < 1.0)))
    }

    pub(super) fn error(&self, place: &str, message: &str) -> Error {
        self.notes.error(ErrorKind::Mesh, place, message)
    }
}

/// The corners renumbered to omit unused vertices, and the used vertices, if most are unused:
/// primitives often share the vertices of a whole scene.
fn compacted(mut corners: Vec<u32>, count: usize) -> (Vec<u32>, Option<Vec<u32>>) {
    if corners.len() >= count / 2 {
        return (corners, None);
    }
    let mut used = corners.clone();
    used.sort_unstable();
    used.dedup();
    for corner in &mut corners {
        // Each is among them, and they are fewer than the corners, which have 32 bits.
        *corner = used.binary_search(corner).unwrap_or(0) as u32;
    }
    (corners, Some(used))
}

/// The triangles of consecutive vertices, counter-clockwise from the front.
fn triangles(mode: Mode, corners: &[u32], notes: &Notes<'_>, path: &str) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => {
            let (triangles, rest) = corners.as_chunks::<3>();
            if !rest.is_empty() {
                let message = "some vertices are left over";
                notes.note(path, message, "the number of corners should be divisible by 3");
            }
            triangles.to_vec()
        }
        // Every second one is reversed, so that all have the same front.
        Mode::Strip => {
            let turned = |(i, t): (usize, &[u32])| match i % 2 {
                0 => [t[0], t[1], t[2]],
                _ => [t[0], t[2], t[1]],
            };
            corners.windows(3).enumerate().map(turned).collect()
        }
        Mode::Fan => match corners.split_first() {
            Some((first, rest)) => rest.windows(2).map(|t| [t[0], t[1], *first]).collect(),
            None => Vec::new(),
        },
    }
}
