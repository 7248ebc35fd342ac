//! Whole files: what is accepted, what is refused and how it is said.

use glam::{Vec2, Vec3};

mod colors;
mod pictures;
mod short_cuts;

use super::*;
use crate::mesh::tests::{Dice, alike};
use crate::mesh::{BUFFER, MeshData};

fn load(bytes: &[u8]) -> Result<Read> {
    // A small buffer, so that rows lie across its ends.
    alike([29, BUFFER], |buffer| super::read(&bytes, bytes.len() as u64, *buffer, None))
}

fn mesh(bytes: &[u8]) -> MeshData {
    let (mesh, notes, _) = load(bytes).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    mesh
}

fn message(bytes: &[u8]) -> String {
    load(bytes).unwrap_err().to_string()
}

/// A file with this header and body.
fn file(format: &str, header: &str, body: &[u8]) -> Vec<u8> {
    let head = format!("ply\nformat {format} 1.0\n{header}\nend_header\n");
    [head.as_bytes(), body].concat()
}

fn ascii(header: &str, body: &str) -> Vec<u8> {
    file("ascii", header, body.as_bytes())
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

fn square_header(faces: u32) -> String {
    format!("element vertex 4\n{XYZ}element face {faces}\nproperty list uchar int vertex_indices")
}

const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

fn square() -> Vec<Vec3> {
    vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]
}

/// Numbers in binary, of either byte order.
struct Bytes {
    big: bool,
    bytes: Vec<u8>,
}

impl Bytes {
    fn new(big: bool) -> Self {
        Self { big, bytes: Vec::new() }
    }

    fn add<const N: usize>(&mut self, mut little: [u8; N]) -> &mut Self {
        if self.big {
            little.reverse();
        }
        self.bytes.extend(little);
        self
    }

    fn format(&self) -> &'static str {
        if self.big { "binary_big_endian" } else { "binary_little_endian" }
    }
}

/// The plainest binary form, with these faces.
fn packed(big: bool, faces: &[&[i32]]) -> Vec<u8> {
    let mut body = Bytes::new(big);
    square().iter().flat_map(|p| p.to_array()).for_each(|x| {
        body.add(x.to_le_bytes());
    });
    for face in faces {
        body.add([face.len() as u8]);
        face.iter().for_each(|i| {
            body.add(i.to_le_bytes());
        });
    }
    file(body.format(), &square_header(faces.len() as u32), &body.bytes)
}

#[test]
fn the_plainest_binary_form_is_read_in_both_byte_orders() {
    for big in [false, true] {
        let read = mesh(&packed(big, &[&[0, 1, 2], &[0, 2, 3], &[3, 1, 1]]));
        assert_eq!(read.positions, square());
        assert_eq!(read.triangles, [[0, 1, 2], [0, 2, 3], [3, 1, 1]]);
        assert_eq!((read.normals, read.uvs), (None, None));
        // Polygons among triangles expand in place.
        let read = mesh(&packed(big, &[&[0, 1, 2], &[1, 2, 3, 0], &[0, 2, 3]]));
        assert_eq!(read.triangles, [[0, 1, 2], [1, 2, 3], [1, 3, 0], [0, 2, 3]]);
    }
}

#[test]
fn any_order_type_and_extra_element_is_read() {
    let header = "element face 1\nproperty ushort flag\nproperty list uint uchar other\n\
                  property list short short vertex_index\nproperty double after\n\
                  element junk 2\nproperty list char double w\nproperty char c\n\
                  element vertex 3\nproperty uchar red\nproperty double z\nproperty int8 x\n\
                  property float32 nz\nproperty uint16 y\nproperty float nx\nproperty float ny\n\
                  property uchar texture_u\nproperty float texture_v";
    for big in [false, true] {
        let mut body = Bytes::new(big);
        body.add(7_u16.to_le_bytes()).add(2_u32.to_le_bytes()).add([1]).add([2]);
        body.add(3_i16.to_le_bytes());
        for i in [2_i16, 0, 1] {
            body.add(i.to_le_bytes());
        }
        body.add(1_f64.to_le_bytes());
        body.add([1]).add(5_f64.to_le_bytes()).add([9]).add([0]).add([9]);
        for i in 0..3_u8 {
            body.add([200]).add((f64::from(i) + 0.5).to_le_bytes()).add((-(i as i8)).to_le_bytes());
            body.add(1_f32.to_le_bytes()).add((u16::from(i) * 1000).to_le_bytes());
            body.add(2_f32.to_le_bytes()).add(3_f32.to_le_bytes());
            body.add([255]).add(0.25_f32.to_le_bytes());
        }
        let read = mesh(&file(body.format(), header, &body.bytes));
        assert_eq!(read.triangles, [[2, 0, 1]]);
        assert_eq!(read.positions[2], Vec3::new(-2.0, 2000.0, 2.5));
        let normals = read.normals.unwrap();
        assert_eq!((normals.values[1], normals.indices), (Vec3::new(2.0, 3.0, 1.0), None));
        assert_eq!(read.uvs.unwrap().values, [Vec2::new(1.0, 0.25); 3]);
    }
}

#[test]
fn vertices_with_lists_are_read_row_by_row() {
    let header = "element vertex 3\nproperty float x\nproperty list uchar short l\n\
                  property float y\nproperty float z\n\
                  element face 1\nproperty list uchar uint vertex_indices";
    let mut body = Bytes::new(false);
    for i in 0..3_u8 {
        body.add(f32::from(i).to_le_bytes()).add([i]);
        (0..i).for_each(|_| {
            body.add([9, 9]);
        });
        body.add(4_f32.to_le_bytes()).add(5_f32.to_le_bytes());
    }
    body.add([3]).add([0; 4]).add(1_u32.to_le_bytes()).add(2_u32.to_le_bytes());
    let read = mesh(&file(body.format(), header, &body.bytes));
    assert_eq!(read.positions[2], Vec3::new(2.0, 4.0, 5.0));
}

#[test]
fn text_is_read() {
    let header = format!(
        "element vertex 4\n{XYZ}property int id\nproperty float s\nproperty float t\n\
         element edge 1\nproperty int a\nelement face 2\nproperty list int int vertex_index\n\
         property char kind"
    );
    let body = "-.5 +1e1 2. 7 0 1\r\n\r\n1 0 0 1 .5 .5\t\n1 1 0 2 1 1\n0 1 0 3 0 0\n5\n\
                4 0 1\n2 3 1\n3 0 2 3 90";
    let read = mesh(&ascii(&header, body));
    assert_eq!(read.positions[0], Vec3::new(-0.5, 10.0, 2.0));
    assert_eq!(read.triangles.len(), 3);
    assert_eq!(read.triangles[2], [0, 2, 3]);
    assert_eq!(read.uvs.unwrap().values[1], Vec2::splat(0.5));
}

#[test]
fn faces_before_vertices_are_split_all_the_same() {
    let header =
        format!("element face 1\nproperty list uchar int vertex_indices\nelement vertex 4\n{XYZ}");
    let read = mesh(&ascii(&header, "4 0 1 2 3\n0 0 0\n2 1 0\n0 2 0\n1 1 0\n"));
    assert!(read.triangles.iter().all(|t| t.contains(&1) && t.contains(&3)));
}

#[test]
fn strips_turn_every_second_triangle_and_skip_stitches() {
    let header =
        format!("element vertex 5\n{XYZ}element tristrips 1\nproperty list int int vertex_indices");
    let body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n12 0 1 2 3 3 4 -1 -1 2 1 0 -1";
    let read = mesh(&ascii(&header, body));
    assert_eq!(read.triangles, [[0, 1, 2], [2, 1, 3], [2, 1, 0]]);
    let error = message(&ascii(&header, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n3 0 1 -2"));
    assert!(error.contains("tristrips 0") && error.contains("-2"), "{error}");
}

#[test]
fn a_body_cut_anywhere_is_refused() {
    let files = [
        packed(false, &[&[0, 1, 2], &[0, 1, 2, 3]]),
        packed(true, &[&[0, 1, 2], &[0, 1, 2, 3]]),
        ascii(&square_header(2), &format!("{SQUARE}3 0 1 2\n4 0 1 2 3")),
    ];
    for whole in &files {
        load(whole).unwrap();
        for length in 0..whole.len() {
            let error = message(&whole[..length]);
            assert!(error.contains("; "), "{length}: {error}");
        }
    }
    let error = message(&files[0][..files[0].len() - 1]);
    assert!(error.starts_with("face 1: "), "{error}");
}

#[test]
fn what_follows_the_body_is_a_warning() {
    let mut bytes = packed(false, &[&[0, 1, 2]]);
    bytes.extend([1, 2, 3]);
    let (read, notes, _) = load(&bytes).unwrap();
    assert_eq!(read.triangles.len(), 1);
    assert!(notes.len() == 1 && notes[0].to_string().contains("3 bytes"), "{notes:?}");
    let text = ascii(&square_header(1), &format!("{SQUARE}3 0 1 2\n \r\n"));
    assert_eq!(mesh(&text).triangles.len(), 1);
    let text = ascii(&square_header(1), &format!("{SQUARE}3 0 1 2\n3 0 1 2\n"));
    assert_eq!(load(&text).unwrap().1.len(), 1);
}

#[test]
fn an_element_without_properties_takes_no_time() {
    let header = format!("element nothing 4294967294\n{}", square_header(1));
    assert_eq!(mesh(&ascii(&header, &format!("{SQUARE}3 0 1 2"))).triangles.len(), 1);
}
