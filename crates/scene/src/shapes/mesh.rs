//! Triangle meshes: inline as a strip or with indices, or in a file.
//!
//! In a scene file the front of a triangle is where its corners run clockwise, as for a plane whose
//! points go around from bottom left to bottom right. [`MeshData`] has the opposite winding, as
//! mesh files do; the corners are reordered here, and nowhere else.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2};
use serde_json::{Value, json};

use crate::format::{
    Cursor, Declaration, Declared, Key, Kind, Object, Range, Takes, Writer, keys, words,
};
use crate::mesh::{Attribute, MeshData, VertexColors};
use crate::surface::existing_file;
use wavecrest_base::error::Result;
use wavecrest_base::shared::Shared;

const POINTS: &str = "an array of at least three points [[x, y, z], ...]";
const INDICES: &str = "an array of triangles [[a, b, c], ...], at least one";

pub(super) const FROM_FILE: Kind = Kind {
    discriminator: "file",
    ..Kind::entity(
        "trimesh",
        "a trimesh from a file",
        "A mesh from a file.",
        &[Declaration::of::<MeshFile>()],
    )
};

pub(super) const INDEXED: Kind = Kind {
    discriminator: "indices",
    keys: keys! {
        /// Triangles, as indices of their points from 0, clockwise as seen from the front.
        "indices": INDICES_TAKE, Required;
        /// A mesh file, PLY, OBJ or STL: a path from the scene's folder.
        "file": Text;
    },
    ..Kind::entity("trimesh", "a trimesh with indices", "A mesh.", &[Declaration::of::<Mesh>()])
};

// Includes the keys of other kinds of mesh: a misspelt key may mean one of them.
pub(super) const STRIP: Kind = Kind {
    keys: keys! {
        /// For each triangle of a strip, 0 to keep its winding or -1 to reverse it.
        "normal": AtLeast(1, &OneOf(&[0, -1]));
        /// Triangles, as indices of their points from 0, clockwise as seen from the front.
        "indices": INDICES_TAKE;
        /// A mesh file, PLY, OBJ or STL: a path from the scene's folder.
        "file": Text;
    },
    ..Kind::entity(
        "trimesh",
        "a trimesh that is a strip",
        "A strip of triangles.",
        &[Declaration::of::<Mesh>()],
    )
};

const INDICES_TAKE: Takes = Takes::AtLeast(1, &Takes::Exactly(3, &Takes::Integer(0, u32::MAX)));

words!(VertexColors, Materials);

wavecrest_base::choices! {
    /// The source of the materials of a mesh file's faces.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Materials {
        /// The shape's.
        #[default]
        Shape = "shape",
        /// The file's, if it has any.
        File = "file",
    }
}

/// A mesh file that is not read yet: a [`Mesh`] takes its place.
#[derive(Clone, Debug)]
pub struct MeshFile {
    /// The path, already joined to the scene file's folder.
    pub file: PathBuf,
    /// The encoding of its vertex colours.
    pub colors: VertexColors,
    /// The source of its faces' materials.
    pub materials: Materials,
}

impl Declared for MeshFile {
    const KEYS: &'static [Key] = keys! {
        /// A mesh file, PLY, OBJ or STL: a path from the scene's folder.
        "file": Text, Required;
        /// Encoding of the vertex colours; `none` ignores them.
        "vertexcolors": word::<VertexColors>(), Says("srgb");
        /// Source of the materials of faces: the shape's, or the MTL files of an OBJ file and the images
        /// of a PLY file, if there are any.
        "materials": word::<Materials>(), Says("shape");
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let cursor = object.cursor();
        let is_given = |key: &&str| cursor.value().get(*key).is_some();
        if let Some(other) = ["points", "indices"].into_iter().find(is_given) {
            let error = cursor.error(format!("a trimesh has \"file\" or {other:?}, not both"));
            return Err(error.remedy("remove one of them"));
        }
        let file = mesh_file(&object.need("file", "the path of a mesh")?)?;
        let (colors, materials) = (object.read("vertexcolors"), object.read("materials"));
        Ok(Some(Self { file, colors, materials }))
    }

    fn write(&self, _: &mut Writer<'_>) {}
}

fn mesh_file(cursor: &Cursor<'_>) -> Result<PathBuf> {
    let name = cursor.text("the path of a mesh")?;
    let extension = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default();
    if ["gltf", "glb"].contains(&extension.to_ascii_lowercase().as_str()) {
        let error = cursor.error("a glTF file cannot be a shape");
        return Err(
            error.remedy("run wavecrest convert IN OUT.json, and use the meshes that it writes")
        );
    }
    existing_file(cursor, "the path of a mesh")
}

/// A triangle mesh. Its front is where the corners run counter-clockwise, as in mesh files.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The arrays, which the geometry of a prepared scene shares as far as it has them unchanged.
    pub data: MeshData,
    /// Positions of an inline mesh in double precision, if they have more digits than single
    /// precision: they are moved before they are rounded.
    pub points: Option<Shared<DVec3>>,
    /// The file of the mesh, if any. A mesh without one has its attributes by vertex, and is
    /// written into the scene file itself.
    pub file: Option<PathBuf>,
}

impl Mesh {
    /// Whether any of its triangles has an area.
    pub(crate) fn has_area(&self) -> bool {
        let position = |i: u32| match &self.points {
            Some(points) => points[i as usize],
            None => self.data.positions[i as usize].as_dvec3(),
        };
        self.data.triangles.iter().any(|triangle| {
            let [a, b, c] = triangle.map(position);
            (b - a).cross(c - a) != DVec3::ZERO
        })
    }
}

impl Declared for Mesh {
    const KEYS: &'static [Key] = keys! {
        /// The number of points, for a check.
        "size": Integer(0, u32::MAX);
        /// The points of the mesh. Without `indices` it is a strip: triangle i has the points i, i+1,
        /// i+2, and every second triangle is turned so that one side of the strip faces out.
        "points": AtLeast(3, &Point), Required;
        /// Texture coordinates for each point.
        "uvs": AtLeast(3, &Exactly(2, &Number(Range::COORDINATE)));
        /// Normals for each point, for smooth shading.
        "normals": AtLeast(3, &Point) => "shading";
        /// Colours for each point, which multiply the diffuse colour.
        "colors": AtLeast(3, &Color);
        /// Alphas for each point: they multiply what `alphacutoff` tests, and the opacity of a material
        /// with `vertexalpha`.
        "alphas": AtLeast(3, &Number(Range::UNIT));
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let what = format!("{POINTS}, or the path of a mesh as \"file\"");
        let points = object.need("points", &what)?.each_of(3.., POINTS, |item| item.point())?;
        check_size(object, points.len())?;
        let triangles = match object.get("indices") {
            Some(indices) => indices.each_of(1.., INDICES, |item| triangle(&item, points.len()))?,
            None => strip(object, points.len())?,
        };
        let count = points.len();
        let uv = |item: Cursor<'_>| {
            let [u, v] = item.numbers("two numbers [u, v]", Range::COORDINATE)?;
            Ok(Vec2::new(u as f32, v as f32))
        };
        let vector = |item: Cursor<'_>| Ok(item.point()?.as_vec3());
        let color = |item: Cursor<'_>| Ok(item.color()?.as_vec3());
        let alpha = |item: Cursor<'_>| Ok(item.number(Range::UNIT)? as f32);
        let uvs = by_point(object, "uvs", count, "[u, v]", uv)?;
        let normals = by_point(object, "normals", count, "[x, y, z]", vector)?;
        let colors = by_point(object, "colors", count, "[r, g, b]", color)?;
        let alphas = by_point(object, "alphas", count, "an alpha from 0 to 1", alpha)?;
        let data = MeshData {
            positions: points.iter().map(|p| p.as_vec3()).collect(),
            origin: DVec3::ZERO,
            triangles: triangles.into(),
            normals: normals.map(Attribute::from),
            uvs: uvs.map(Attribute::from),
            colors,
            alphas,
        };
        let is_rounded = points.iter().any(|p| p.as_vec3().as_dvec3() != *p);
        Ok(Some(Self { data, points: is_rounded.then_some(points.into()), file: None }))
    }

    fn write(&self, to: &mut Writer<'_>) {
        // Files of meshes have no alphas.
        if self.file.is_some() && self.data.alphas.is_none() {
            let name = to.mesh();
            to.set("file", name);
            if self.data.colors.is_some() {
                to.put("vertexcolors", VertexColors::Linear);
            }
            return;
        }
        let MeshData { positions, triangles, normals, uvs, colors, alphas, .. } = &self.data;
        to.set(
            "points",
            self.points.as_ref().map_or_else(|| json!(**positions), |all| json!(**all)),
        );
        let corners: Vec<_> = triangles.iter().map(|corners| reversed(*corners)).collect();
        to.set("indices", json!(corners));
        normals.iter().for_each(|normals| to.set("normals", json!(*normals.values)));
        colors.iter().for_each(|colors| to.set("colors", json!(**colors)));
        uvs.iter().for_each(|uvs| to.set("uvs", json!(*uvs.values)));
        alphas.iter().for_each(|alphas| to.set("alphas", json!(**alphas)));
    }
}

fn check_size(object: &Object<'_>, points: usize) -> Result<()> {
    let Some(cursor) = object.get("size") else { return Ok(()) };
    if usize::try_from(cursor.integer(0, u32::MAX)?).is_ok_and(|size| size == points) {
        return Ok(());
    }
    let error = cursor.error("must be the number of points");
    Err(error.remedy(format!("\"points\" has {points}")))
}

/// The triangles of a strip: every three consecutive points.
fn strip(object: &Object<'_>, points: usize) -> Result<Vec<[u32; 3]>> {
    let count = points - 2;
    let flips = object.get("normal").map(|cursor| flips(&cursor, count)).transpose()?;
    let turned = |i: usize| flips.as_ref().map_or(i % 2 == 1, |flips| flips[i]);
    let triangle = |(i, first): (usize, u32)| {
        let clockwise = [first, first + 1, first + 2];
        if turned(i) { clockwise } else { reversed(clockwise) }
    };
    // A file of 256 MiB has fewer than 2^32 points.
    Ok((0..count).zip(0_u32..).map(triangle).collect())
}

/// The `normal` of a strip: which of its triangles are reversed.
fn flips(cursor: &Cursor<'_>, triangles: usize) -> Result<Vec<bool>> {
    let what =
        format!("an array of {triangles} numbers, one for each triangle: 0, or -1 to flip it");
    cursor.each_of(triangles..=triangles, &what, |item| match item.value().as_f64() {
        Some(0.0) => Ok(false),
        Some(-1.0) => Ok(true),
        _ => Err(item.error("must be 0 to keep the triangle's winding, or -1 to flip it")),
    })
}

fn triangle(cursor: &Cursor<'_>, points: usize) -> Result<[u32; 3]> {
    let corner = |value: &Value| {
        let index = value.as_u64().filter(|&i| i < points as u64)?;
        u32::try_from(index).ok()
    };
    let corners: Option<Vec<u32>> =
        cursor.value().as_array().and_then(|items| items.iter().map(corner).collect());
    match corners.as_deref() {
        Some(&[a, b, c]) => Ok(reversed([a, b, c])),
        _ => {
            let last = points - 1;
            Err(cursor.error(format!("must be three indices [a, b, c], each from 0 to {last}")))
        }
    }
}

/// The same first corner, with the opposite winding.
fn reversed([a, b, c]: [u32; 3]) -> [u32; 3] {
    [a, c, b]
}

/// Values under a `key`, if it is given: one for each point, described by `each`.
fn by_point<T>(
    object: &Object<'_>,
    key: &'static str,
    points: usize,
    each: &str,
    read: impl FnMut(Cursor<'_>) -> Result<T>,
) -> Result<Option<Shared<T>>> {
    let Some(cursor) = object.get(key) else { return Ok(None) };
    let what = format!("an array of {points} times {each}, one for each point");
    cursor.each_of(points..=points, &what, read).map(|all| Some(all.into()))
}
