//! Whole files: what is accepted, what is refused and how it is said.

use super::*;
use crate::mesh::BUFFER;
use crate::mesh::tests::alike;

fn load(bytes: &[u8]) -> Result<Read> {
    // A small buffer, so that lines and triangles lie across its ends.
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

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TETRAHEDRON: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn head(text: &str, triangles: u32) -> Vec<u8> {
    let mut head = text.as_bytes().to_vec();
    head.resize(HEAD - 4, 0);
    head.extend(triangles.to_le_bytes());
    head
}

fn binary(text: &str, attribute: u16) -> Vec<u8> {
    let mut bytes = head(text, 4);
    for triangle in TETRAHEDRON {
        bytes.extend([0; 12]);
        for i in triangle {
            bytes.extend(CORNERS[i].map(f32::to_le_bytes).as_flattened());
        }
        bytes.extend(attribute.to_le_bytes());
    }
    bytes
}

fn text() -> String {
    let mut text = "solid a b\n".to_owned();
    for triangle in TETRAHEDRON {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for [x, y, z] in triangle.map(|i| CORNERS[i]) {
            text += &format!("      vertex {x} {y} {z}\n");
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid a b\n"
}

#[test]
fn both_forms_are_one_mesh_with_shared_corners() {
    let read = mesh(&binary("made by hand", 0));
    assert_eq!(read.positions, [0, 2, 1, 3].map(|i| Vec3::from(CORNERS[i])));
    assert_eq!(read.triangles, [[0, 1, 2], [0, 2, 3], [2, 1, 3], [1, 0, 3]]);
    let written = text();
    let apart = ["loop", "facet", "solid"].iter().fold(written.clone(), |text, word| {
        text.replace(&format!("end{word}"), &format!("end {word}"))
    });
    let others = [
        written.to_uppercase(),
        written.replace('\n', "\r\n"),
        written.replace('\n', "\r"),
        format!("\u{feff}{written}"),
        apart,
    ];
    for other in others {
        assert_eq!(mesh(other.as_bytes()), read);
    }
    assert_eq!(mesh(written.repeat(2).as_bytes()).triangles.len(), 8);
    assert_eq!(mesh(written.repeat(2).as_bytes()).positions.len(), 4);
}

#[test]
fn a_binary_file_may_begin_as_a_text_does() {
    assert_eq!(mesh(&binary("solid work", 0)).triangles.len(), 4);
    // With blanks in the head, and with bytes at its end, where its length says nothing.
    let mut longer = binary(&format!("{:80}", "solid work"), 0);
    longer.push(1);
    let (mesh, notes, _) = load(&longer).unwrap();
    assert_eq!(mesh.triangles.len(), 4);
    assert!(notes[0].to_string().contains("bytes after the last triangle"), "{notes:?}");
}

#[test]
fn colours_are_ignored_by_name() {
    let told = |bytes: &[u8]| {
        let (_, notes, _) = load(bytes).unwrap();
        assert_eq!(notes.len(), 1);
        notes[0].to_string()
    };
    assert!(told(&binary("COLOR=\u{1}\u{2}\u{3}", 7)).contains("Magics"));
    assert!(told(&binary("", 1 << 15)).contains("VisCAM"));
    assert!(told(text().replace("endloop", "endloop\ncolor 1 0 0").as_bytes()).contains("colours"));
}

/// Positions count as one where they are equal, whatever the sign of a zero, and no nearer.
#[test]
fn corners_are_joined_where_they_are_equal() {
    let triangle =
        |x: &str| format!("outer loop\nvertex {x} 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n");
    let two = |a: &str, b: &str| mesh(format!("solid\n{}{}", triangle(a), triangle(b)).as_bytes());
    assert_eq!(two("0", "-0").triangles, [[0, 1, 2], [0, 1, 2]]);
    assert_eq!(two("0", "-0").positions[0].x.to_bits(), 0);
    assert_eq!(two("0", "1e-45").triangles, [[0, 1, 2], [3, 1, 2]]);
}

#[test]
fn a_large_mesh_is_joined_as_a_small_one_is() {
    let side = 200;
    let corner = |i: u32| Vec3::new((i % side) as f32, (i / side) as f32 / 7.0, 1.5);
    let right: Vec<[u32; 3]> = (0..side * (side - 1)).map(|i| [i, i + 1, i + side]).collect();
    let (positions, joined) = join::join(right.iter().map(|t| t.map(corner)).collect());
    assert!(positions.len() <= (side * side) as usize);
    for (t, j) in right.iter().zip(&joined) {
        assert_eq!(t.map(corner), j.map(|i| positions[i as usize]));
    }
    // Vertices come in the order of the file.
    let mut next = 0;
    for &i in joined.as_flattened() {
        assert!(i <= next);
        next = next.max(i + 1);
    }
    assert_eq!(next as usize, positions.len());
}

#[test]
fn faults_name_their_place() {
    let mut bytes = binary("", 0);
    let (at, nan) = (HEAD + 50 * 2 + 12, f32::NAN.to_le_bytes());
    bytes[at..at + 4].copy_from_slice(&nan);
    bytes[at + 50..at + 54].copy_from_slice(&nan);
    assert!(message(&bytes).starts_with("triangle 2: "), "{}", message(&bytes));
}
