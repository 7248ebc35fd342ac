//! Triangle meshes: their arrays, and the readers of mesh files.
//!
//! [`load`] reads Stanford PLY, Wavefront OBJ and STL. All readers check once what later code
//! relies on, so that no kernel has to: every index is in range, every position is finite and at
//! most [`MAX_COORDINATE`](wavecrest_core::math::float::MAX_COORDINATE) in size. Sizes in a file
//! are checked against its length before memory is allocated, and an [`Error`] names its place.
//!
//! Files are read on all threads, each at its own offset ([`place`]); neither the arrays nor the
//! reported errors depend on the number of threads.
//!
//! Elements of PLY files and triangles of binary STL are counted from 0, as in the files
//! themselves; errors in OBJ and text STL files name the line.

pub(crate) mod crease;
mod data;
mod faults;
mod join;
mod number;
mod obj;
mod origin;
mod place;
mod ply;
mod polygon;
mod scalar;
mod stl;
mod validate;

use std::path::Path;

use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_base::memory::Activity;
use wavecrest_base::progress;
use wavecrest_base::read::open;

pub use data::{
    Attribute, LoadedMesh, MAX_COUNT, MeshData, NO_VALUE, NamedMaterials, VertexColors,
};
pub(crate) use faults::no_part;
pub use join::first_of_each;
pub use origin::{origin, relative};
pub(crate) use scalar::Scalar;
pub use validate::validate;
pub(crate) use validate::{bad_position, is_good_position};

use place::ReadAt;

/// Reads the mesh file at `path`: PLY, OBJ or STL, by its extension in upper or lower case.
///
/// A mesh without triangles is an error, as it would be invisible.
///
/// # Errors
///
/// Of kind [`ErrorKind::Io`] if the system refuses, [`ErrorKind::Syntax`] if the file violates its
/// format, [`ErrorKind::Mesh`] if its contents do not form a mesh and [`ErrorKind::Limit`] if it is
/// too large.
pub fn load(path: &Path) -> Result<LoadedMesh> {
    load_first(path, None)
}

/// As [`load`], but at most so many faces, those that come first, if their number is given. It is an error
/// if the file is no binary PLY or STL with more.
pub(crate) fn load_first(path: &Path, faces: Option<u64>) -> Result<LoadedMesh> {
    let format = MeshFormat::of(path)?;
    let cannot_open = |error| Error::io("cannot open the mesh file", path, error);
    let (file, length) = open(path).map_err(cannot_open)?;
    let _reading = Activity::new(format!("reading {}", path.display()));
    read(format, &file, length, (faces, None), path)
}

/// Announces to the progress that the file at `path` will be read.
pub(crate) fn announce(path: &Path) {
    progress::expect(path.metadata().map_or(0, |data| data.len()));
}

/// The mesh, checked like one from a file; errors use `name` for the file.
pub(crate) fn checked(mesh: MeshData, name: &Path) -> Result<LoadedMesh> {
    if mesh.triangles.is_empty() {
        return Err(faults::no_triangles().in_file(name));
    }
    validate(&mesh, name)?;
    Ok(LoadedMesh { mesh, ..LoadedMesh::default() })
}

/// Whether `path` has the extension of a mesh file.
pub fn is_mesh_name(path: &Path) -> bool {
    MeshFormat::of(path).is_ok()
}

/// As [`load`], for a file with these `bytes`, read in portions of about `portion` bytes. The
/// result does not depend on `portion`: tests use it to cut small inputs like large files.
///
/// # Errors
///
/// As [`load`].
#[doc(hidden)]
pub fn load_bytes(path: &Path, bytes: &[u8], portion: usize) -> Result<LoadedMesh> {
    read(MeshFormat::of(path)?, &bytes, bytes.len() as u64, (None, Some(portion.max(1))), path)
}

/// Size of the buffer of each thread, and of its pieces of a text.
const BUFFER: usize = 1 << 17;

/// Reads a file of `length` bytes: its first faces if their number is given, in portions of about this size if that is.
fn read(
    format: MeshFormat,
    file: &dyn ReadAt,
    length: u64,
    (faces, portion): (Option<u64>, Option<usize>),
    path: &Path,
) -> Result<LoadedMesh> {
    let buffer = portion.unwrap_or(BUFFER);
    let (block, piece) = portion.map_or((obj::BLOCK, BUFFER), |size| (size, size.div_ceil(4)));
    let loaded = match format {
        MeshFormat::Ply => ply::read(file, length, buffer, faces),
        MeshFormat::Obj if faces.is_some() => Err(faults::no_part()),
        MeshFormat::Obj => obj::read(file, length, block, piece),
        MeshFormat::Stl => stl::read(file, length, buffer, faces),
    };
    let (mesh, notes, materials) = loaded.map_err(|error| error.in_file(path))?;
    let warnings = notes.into_iter().map(|n| Warning::from_error(&n.in_file(path))).collect();
    Ok(LoadedMesh { mesh, warnings, materials })
}

/// A supported mesh format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MeshFormat {
    Ply,
    Obj,
    Stl,
}

impl MeshFormat {
    /// The format for the extension of `path`.
    fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "ply" => Ok(Self::Ply),
            "obj" => Ok(Self::Obj),
            "stl" => Ok(Self::Stl),
            _ => Err(Error::new(ErrorKind::Mesh, "this is not a mesh file")
                .in_file(path)
                .value(format_args!("the extension \"{extension}\""))
                .remedy("use a .ply, .obj or .stl file")),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use glam::Vec3;

    use super::*;

    /// Reads a file in several `ways`, and checks that they give the same mesh, or the same words.
    pub(crate) fn alike<W: std::fmt::Debug>(
        ways: impl IntoIterator<Item = W>,
        read: impl Fn(&W) -> Result<data::Read>,
    ) -> Result<data::Read> {
        let read: Vec<_> = ways.into_iter().map(|way| (read(&way), way)).collect();
        for pair in read.windows(2) {
            let way = &pair[1].1;
            match (&pair[0].0, &pair[1].0) {
                (Ok(one), Ok(other)) => {
                    // Written out, so that a NaN is equal to itself.
                    let is_same = one.0 == other.0 || format!("{one:?}") == format!("{other:?}");
                    assert!(is_same, "{way:?}: {one:?} {other:?}");
                    assert_eq!(format!("{:?}", one.1), format!("{:?}", other.1), "{way:?}");
                }
                (Err(one), Err(other)) => assert_eq!(one.to_string(), other.to_string(), "{way:?}"),
                other => panic!("{way:?}: {other:?}"),
            }
        }
        read.into_iter().next().expect("a way").0
    }

    /// A strip of so many triangles, without attributes.
    pub(crate) fn strip(count: u32) -> MeshData {
        MeshData {
            positions: (0..count + 2).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect(),
            triangles: (0..count).map(|i| [i, i + 1, i + 2]).collect(),
            ..MeshData::default()
        }
    }

    /// Numbers that look random and are the same in every run.
    pub(crate) struct Dice(pub(crate) u64);

    impl Dice {
        /// Random bits.
        pub(crate) fn bits(&mut self) -> u64 {
            self.0 =
                self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
            self.0
        }

        pub(crate) fn below(&mut self, end: u64) -> u64 {
            (self.bits() >> 33) % end
        }

        pub(crate) fn one_in(&mut self, n: u64) -> bool {
            self.below(n) == 0
        }

        pub(crate) fn of<T: Copy>(&mut self, all: &[T]) -> T {
            all[self.below(all.len() as u64) as usize]
        }
    }

    #[test]
    fn the_extension_chooses_the_format_in_any_case() {
        assert_eq!(MeshFormat::of(Path::new("a/b.PLY")).unwrap(), MeshFormat::Ply);
        assert_eq!(MeshFormat::of(Path::new("b.x.Obj")).unwrap(), MeshFormat::Obj);
        assert_eq!(MeshFormat::of(Path::new("b.STL")).unwrap(), MeshFormat::Stl);
        for name in ["b.off", "ply", "b.", "b"] {
            let error = MeshFormat::of(Path::new(name)).unwrap_err().to_string();
            let named = [".ply", ".obj", ".stl"].iter().all(|known| error.contains(known));
            assert!(named, "{error}");
        }
    }

    #[test]
    fn the_first_faces_are_read_without_the_rest() {
        let MeshData { positions, triangles, .. } = strip(10);
        let head = |format| {
            let xyz = "property float x\nproperty float y\nproperty float z\n";
            let of_faces = "element face 10\nproperty list uchar int vertex_indices\nelement rest 1\nproperty int n\n";
            format!("ply\nformat {format} 1.0\nelement vertex 12\n{xyz}{of_faces}end_header\n")
        };
        let mut text = head("ascii");
        text.extend(positions.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)));
        text.extend(triangles.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")));
        let mut binary = head("binary_little_endian").into_bytes();
        let mut stl = [vec![b' '; 80], 10_u32.to_le_bytes().to_vec()].concat();
        let bytes = |p: &Vec3| p.to_array().map(f32::to_le_bytes).as_flattened().to_vec();
        binary.extend(positions.iter().flat_map(bytes));
        for corners in &*triangles {
            binary.extend([&[3][..], corners.map(u32::to_le_bytes).as_flattened()].concat());
            stl.extend([0; 12]);
            stl.extend(corners.iter().flat_map(|&i| bytes(&positions[i as usize])));
            stl.extend([0; 2]);
        }
        text.push_str("7\n");
        binary.extend([7, 0, 0, 0]);
        let files = [("a.ply", text.into_bytes()), ("b.ply", binary), ("c.stl", stl)];
        for (name, bytes) in files {
            let (path, length) = (Path::new(name), bytes.len() as u64);
            let part = |faces| {
                read(
                    MeshFormat::of(path).unwrap(),
                    &&bytes[..],
                    length,
                    (Some(faces), Some(29)),
                    path,
                )
            };
            if name != "a.ply" {
                let LoadedMesh { mesh, warnings, .. } = part(4).unwrap();
                assert!(warnings.is_empty(), "{name}: {warnings:?}");
                assert_eq!(*mesh.triangles, triangles[..4], "{name}");
                assert_eq!(*mesh.positions, positions[..6], "{name}");
                assert!(part(9).is_ok());
            }
            for whole in [10, if name == "a.ply" { 4 } else { 99 }] {
                assert!(part(whole).unwrap_err().to_string().contains("no part"), "{name}");
            }
        }
    }

    /// Opening a pipe without a writer would wait forever, and a device may have no end.
    #[cfg(unix)]
    #[test]
    fn a_pipe_a_socket_and_a_device_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let made = std::process::Command::new("mkfifo").arg(at("pipe.ply")).status();
        let mut names = vec!["device.ply", "socket.obj"];
        names.extend(made.is_ok_and(|status| status.success()).then_some("pipe.ply"));
        std::os::unix::fs::symlink("/dev/zero", at("device.ply")).unwrap();
        let _socket = std::os::unix::net::UnixListener::bind(at("socket.obj")).unwrap();
        for name in names {
            let error = load(&at(name)).unwrap_err();
            assert_eq!((error.kind(), error.file()), (ErrorKind::Io, Some(&*at(name))));
            assert!(error.to_string().contains("not a regular file"), "{error}");
        }
    }
}
