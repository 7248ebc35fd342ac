//! Whole files: what is accepted, what is refused and how it is said.

mod pieces;

use glam::{Vec2, Vec3};

use super::*;
use crate::mesh::BUFFER;
use crate::mesh::data::NO_VALUE;
use crate::mesh::tests::alike;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn read_all(text: &[u8], block: usize, piece: usize) -> Result<Read> {
    read(&text, text.len() as u64, block, piece).map(|(read, _)| read)
}

/// The materials that `text` names, wherever it is cut.
fn materials(text: &str) -> NamedMaterials {
    let read =
        |block, piece| super::read(&text.as_bytes(), text.len() as u64, block, piece).unwrap().1;
    let whole = read(BLOCK, BUFFER);
    for (block, piece) in [(1, 1), (7, 3), (64, 20)] {
        assert_eq!(read(block, piece), whole, "{block} {piece}");
    }
    whole
}

/// Reads `text` with cuts in many places, and checks that they make no difference.
fn load(text: &str) -> Result<Read> {
    let ways = [(BLOCK, BUFFER), (1, 1), (7, 3), (64, 20), (64, 1000)];
    alike(ways, |&(block, piece)| read_all(text.as_bytes(), block, piece))
}

fn mesh(text: &str) -> MeshData {
    let (mesh, notes) = load(text).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    mesh
}

#[test]
fn each_form_of_number_is_read() {
    let read = mesh("v .5 -.5 2.\nv +1 1e2 -1E-2 0.5\nv 1 2 3 nan 0 x\nf 1 2 3\n");
    let right = [[0.5, -0.5, 2.0], [1.0, 100.0, -0.01], [1.0, 2.0, 3.0]];
    assert_eq!(read.positions, right.map(Vec3::from));
}

#[test]
fn statements_of_other_kinds_are_passed_over() {
    let text = format!(
        "# a comment\nmtllib none.mtl\n{SQUARE}o\ng a f 9 9 9\ng f 1 2 3\nusemtl x\ns off\nl 1 99\n\
         p 99\nvp 1\ncurv 0 1 \\\n 2\nbleh\nf9\nvt3 1\nf 1 2 3 # f 4 5 6\n"
    );
    assert_eq!(mesh(&text).triangles, [[0, 1, 2]]);
}

#[test]
fn indices_are_kept_apart_for_each_attribute() {
    let text = format!(
        "{SQUARE}vt 0 0\nvt 1\nvt 1 1 9\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1 3 4\nf -4/-1/ -3/-2/ -2/-3\n"
    );
    let read = mesh(&text);
    assert_eq!(read.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    let uvs = read.uvs.unwrap();
    assert_eq!(uvs.values, [Vec2::ZERO, Vec2::X, Vec2::ONE]);
    assert_eq!(uvs.indices.unwrap(), [[0, 1, 2], [NO_VALUE; 3], [2, 1, 0]]);
    let normals = read.normals.unwrap();
    assert_eq!(normals.indices.unwrap(), [[0; 3], [NO_VALUE; 3], [NO_VALUE; 3]]);
}

#[test]
fn indices_equal_to_those_of_the_positions_are_not_kept() {
    let normals = "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n";
    let read = mesh(&format!("{SQUARE}{normals}f 1//1 2//2 3//3 4//4\n"));
    assert_eq!(read.normals.unwrap().indices, None);
    let read = mesh(&format!("{SQUARE}{normals}vn 1 0 0\nf 1//1 2//2 3//3 4//4\n"));
    assert_eq!(read.normals.unwrap().indices.unwrap(), read.triangles);
}

#[test]
fn relative_indices_count_back_from_the_face() {
    let text = format!("{SQUARE}f -4 -3 -2\nv 5 5 5\nf -1 -2 1\nf 1 2 6\nv 6 6 6\n");
    assert_eq!(mesh(&text).triangles, [[0, 1, 2], [4, 3, 0], [0, 1, 5]]);
}

#[test]
fn a_concave_face_is_not_a_fan() {
    let dart = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let read = mesh(&format!("{dart}f 2/2 3/3 4/4 1/1\nf 1/4 2/3 3/2 4/1\n"));
    for t in &read.triangles {
        assert!(t.contains(&1) && t.contains(&3), "{:?}", read.triangles);
    }
    let uvs = read.uvs.unwrap().indices.unwrap();
    let flip = |t: [u32; 3]| t.map(|i| 3 - i);
    assert_eq!(
        uvs,
        [read.triangles[0], read.triangles[1], flip(read.triangles[2]), flip(read.triangles[3])]
    );
}

#[test]
fn continued_lines_carriage_returns_and_degenerate_faces_are_read() {
    let text = "v 0 0 0\r\nv 1 0 \\\r\n 0\r\n# C:\\\r\nv 1 1 0\r\nf 1 \\\r\n2 3\r\nf 1 1 3\r\n";
    assert_eq!(mesh(text).triangles, [[0, 1, 2], [0, 0, 2]]);
    let marked = format!("\u{feff}{SQUARE}f 1 2 3");
    let (read, _) = read_all(marked.as_bytes(), BLOCK, BUFFER).unwrap();
    assert_eq!(read.positions.len(), 4);
}

#[test]
fn utf16_is_told_apart() {
    for text in [&b"\xFE\xFF\0v\0 \x001"[..], b"\xFF\xFEv\0 \0", b"v\0 \x001\0"] {
        let error = read_all(text, BLOCK, BUFFER).unwrap_err().to_string();
        assert!(error.contains("UTF-16"), "{error}");
    }
}

#[test]
fn indices_of_attributes_that_are_never_given_are_ignored_with_a_warning() {
    let (read, notes) = load(&format!("{SQUARE}f 1//1 2//2 3//3\nf 1/7 3/7 4/7\n")).unwrap();
    assert!(read.normals.is_none() && read.uvs.is_none());
    assert_eq!(notes.len(), 2);
    assert!(notes[1].to_string().contains("\"vn\""));
}

#[test]
fn faces_have_the_material_that_was_named_last() {
    let text = format!(
        "mtllib a b.mtl\nusemtl none\n{SQUARE}f 1 2 3\nusemtl red # 1 \nf 1 2 3 4\nusemtl red # 1\nf 1 2 4\n\
         mtllib a b.mtl\r\nusemtl \tblue\r\n\nusemtl green\nf -1 -2 -3\nusemtl end\nmtllib\n"
    );
    let named = materials(&text);
    assert_eq!(named.libraries, ["a b.mtl"]);
    let runs: Vec<(u32, &str)> = named.runs.iter().map(|(at, name)| (*at, name.as_str())).collect();
    assert_eq!(runs, [(0, "none"), (1, "red # 1"), (4, "green"), (5, "end")]);
}

#[test]
fn a_position_may_have_a_colour() {
    let read = mesh("v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0 0.25\nv 1 1 0 0 0 1 1\nf 1 2 3 4\n");
    let white = Vec3::ONE;
    assert_eq!(read.colors.unwrap(), [white, Vec3::new(1.0, 0.5, 0.0), white, Vec3::Z]);
    let (read, notes) = load("v 0 0 0 nan 0 0\nv 1 0 0 1 1 -1\nv 0 1 0 0 0 1\nf 1 2 3\n").unwrap();
    assert_eq!(read.colors.unwrap(), [white, white, Vec3::Z]);
    assert!(notes[0].to_string().contains("white is used"), "{notes:?}");
}

#[test]
fn colours_in_comments_are_named() {
    let text = format!("#MRGB ffff8000ffffffff\n{SQUARE}f 1 2 3 4\n# MRGB\n");
    let (_, notes) = load(&text).unwrap();
    assert!(notes.len() == 1 && notes[0].to_string().contains("#MRGB"), "{notes:?}");
}
