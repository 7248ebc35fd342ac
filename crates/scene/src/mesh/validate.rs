//! Checks of every mesh before it is traced.
//!
//! A NaN or an index out of range found later would appear in the middle of a build or of a ray,
//! where its vertex is no longer known. Each check is one parallel pass that stops early and
//! reports the error with the lowest number, whatever the threads did.

use std::path::Path;

use glam::{Vec2, Vec3};

use super::data::{Attribute, MeshData, NO_VALUE};
use super::faults::check_count;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::parallel;
use wavecrest_core::math::float::MAX_COORDINATE;

/// The items of a task: passes over fewer end before other threads wake.
const PART: usize = 1 << 15;

/// Checks a mesh from any source: counts, positions, indices.
///
/// # Errors
///
/// Of kind [`ErrorKind::Mesh`] or [`ErrorKind::Limit`], naming `file` and the first invalid vertex
/// or triangle.
pub fn validate(mesh: &MeshData, file: &Path) -> Result<()> {
    check_all(mesh).map_err(|error| error.in_file(file))
}

fn check_all(mesh: &MeshData) -> Result<()> {
    check_count("vertices", mesh.positions.len() as u64)?;
    check_count("triangles", mesh.triangles.len() as u64)?;
    if let Some(i) = parallel::find_first(&mesh.positions, |p| !is_good_position(*p)) {
        return Err(bad_position(mesh.positions[i]).at(format!("vertex {i}")));
    }
    check_indices("vertex", &mesh.triangles, mesh.positions.len(), false)?;
    check_attribute("normal", mesh, mesh.normals.as_ref())?;
    check_attribute("texture coordinate", mesh, mesh.uvs.as_ref())?;
    let Some(colors) = &mesh.colors else { return Ok(()) };
    check_length("colour", "vertices", colors.len(), mesh.positions.len())
}

/// Whether a vertex at `p` is valid.
pub(crate) fn is_good_position(p: Vec3) -> bool {
    // A NaN compares false, so this test rejects it too.
    p.abs().cmple(Vec3::splat(MAX_COORDINATE)).all()
}

/// The error of an invalid position; the caller names the place.
pub(crate) fn bad_position(p: Vec3) -> Error {
    Error::new(ErrorKind::Mesh, "the coordinates of a vertex must be finite and within 2^40")
        .value(format_args!("({}, {}, {})", p.x, p.y, p.z))
        .remedy("correct the vertex, or scale the mesh down")
}

/// The error of an index beyond the `count` items of the kind `what`.
pub(super) fn bad_index(what: &str, index: impl std::fmt::Display, count: usize) -> Error {
    Error::new(ErrorKind::Mesh, format!("the {what} index is out of range"))
        .value(index)
        .remedy(format!("the mesh has {count}: check that the file is whole"))
}

/// Checks the indices of corners into `count` values; those `without` a value have [`NO_VALUE`].
fn check_indices(what: &str, indices: &[[u32; 3]], count: usize, without: bool) -> Result<()> {
    let indices = indices.as_flattened();
    match parallel::find_first(indices, |&i| i as usize >= count && !(without && i == NO_VALUE)) {
        Some(i) => Err(bad_index(what, indices[i], count).at(format!("triangle {}", i / 3))),
        None => Ok(()),
    }
}

fn check_attribute<T: Sync>(
    what: &str,
    mesh: &MeshData,
    found: Option<&Attribute<T>>,
) -> Result<()> {
    let Some(Attribute { values, indices }) = found else { return Ok(()) };
    let Some(indices) = indices else {
        return check_length(what, "vertices", values.len(), mesh.positions.len());
    };
    check_length(what, "triangles", indices.len(), mesh.triangles.len())?;
    check_indices(what, indices, values.len(), true)
}

fn check_length(what: &str, of: &str, found: usize, right: usize) -> Result<()> {
    if found == right {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Mesh, format!("there must be as many {what} entries as {of}"))
        .value(found)
        .remedy(format!("give {right}, or none")))
}

/// Replaces values that are not finite, and negative colours, and returns the warnings. Some files
/// contain them, if an exporter divided by the area of a degenerate triangle; they do not make the
/// mesh unusable, as a zero normal is an unknown one.
pub(super) fn mend(normals: &mut [Vec3], uvs: &mut [Vec2], colors: &mut [Vec3]) -> Vec<Error> {
    let is_color = |c: Vec3| c.is_finite() && c.min_element() >= 0.0;
    let zeroed = |what: &str| format!("some {what} are not finite; zero is used");
    let white = "some vertex colours are negative or not finite; white is used";
    let found = [
        (replace_bad(normals, Vec3::is_finite, Vec3::ZERO), zeroed("normals")),
        (replace_bad(uvs, Vec2::is_finite, Vec2::ZERO), zeroed("texture coordinates")),
        (replace_bad(colors, is_color, Vec3::ONE), white.to_owned()),
    ];
    let warning = |(count, message): (usize, String)| {
        Error::new(ErrorKind::Mesh, message).value(count).remedy("export them again")
    };
    found.into_iter().filter(|(count, _)| *count > 0).map(warning).collect()
}

/// The least that some channel of colours from 0 to 255 has; from 0 to 1 it is out of reach.
const BYTES: f32 = 2.0;

/// Scales colours to 1 at most, where the file has them from 0 to 255, and says so.
pub(super) fn scale_byte_colors(colors: &mut [Vec3]) -> Option<Error> {
    let has_bytes = parallel::find_first(colors, |color| color.max_element() >= BYTES).is_some();
    has_bytes.then(|| {
        parallel::each_mut(colors, |_, color| *color /= f32::from(u8::MAX));
        let message = "vertex colours above 1 are taken as 0 to 255";
        Error::new(ErrorKind::Mesh, message).remedy("export them as 0 to 1 if they are not")
    })
}

/// Replaces the values that are not `good`, and counts them.
fn replace_bad<T: Send + Sync + Copy>(values: &mut [T], good: fn(T) -> bool, by: T) -> usize {
    let mend = |values: &mut [T]| {
        values.iter_mut().filter(|value| !good(**value)).map(|value| *value = by).count()
    };
    parallel::map(values.chunks_mut(PART), mend).into_iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::strip;

    #[test]
    fn the_first_bad_vertex_is_named() {
        for (index, value) in [(3, f32::NAN), (69_999, f32::INFINITY), (40_000, 1.2e12)] {
            let mut mesh = strip(70_000);
            mesh.positions[index].y = value;
            mesh.positions[70_001].z = f32::NAN;
            let error = validate(&mesh, Path::new("m.ply")).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Mesh);
            assert_eq!(error.place(), Some(format!("vertex {index}").as_str()));
            assert_eq!(error.file(), Some(Path::new("m.ply")));
        }
    }

    #[test]
    fn an_index_out_of_range_is_named() {
        let mut mesh = strip(50_000);
        mesh.triangles[41_234][2] = 50_002;
        mesh.triangles[41_235][0] = 60_000;
        let error = validate(&mesh, Path::new("m.ply")).unwrap_err().to_string();
        assert!(error.contains("triangle 41234") && error.contains("found 50002"), "{error}");
    }

    #[test]
    fn attributes_fit_the_mesh() {
        let mut mesh = strip(2);
        mesh.uvs = Some(Attribute { values: vec![Vec2::ZERO; 3].into(), indices: None });
        assert!(validate(&mesh, Path::new("m")).unwrap_err().to_string().contains("vertices"));
        let indices = Some(vec![[0, 1, 2], [NO_VALUE; 3]]);
        mesh.uvs = Some(Attribute {
            values: vec![Vec2::ZERO; 3].into(),
            indices: indices.map(Into::into),
        });
        validate(&mesh, Path::new("m")).unwrap();
        let indices = Some(vec![[0, 1, 2], [0, 3, 1]]);
        mesh.uvs = Some(Attribute {
            values: vec![Vec2::ZERO; 3].into(),
            indices: indices.map(Into::into),
        });
        let error = validate(&mesh, Path::new("m")).unwrap_err().to_string();
        assert!(error.contains("texture coordinate index"), "{error}");
    }

    #[test]
    fn bad_normals_become_zero() {
        let mut normals = vec![Vec3::X, Vec3::NAN, Vec3::new(0.0, f32::INFINITY, 0.0)];
        let notes = mend(&mut normals, &mut [Vec2::ONE], &mut []);
        assert_eq!(normals, [Vec3::X, Vec3::ZERO, Vec3::ZERO]);
        assert!(matches!(&notes[..], [note] if note.to_string().contains("normals")), "{notes:?}");
        assert!(mend(&mut normals, &mut [], &mut [Vec3::ONE]).is_empty());
    }
}
