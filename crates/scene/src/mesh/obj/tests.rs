//! Whole files: what is accepted, what is refused and how it is said.

mod pieces;

use super::*;
use crate::mesh::BUFFER;
use crate::mesh::data::{NO_VALUE, NamedMaterials};
use crate::mesh::tests::alike;
use crate::tests::approved;

fn read_all(text: &[u8], block: usize, piece: usize) -> Result<Read> {
    read(&text, text.len() as u64, block, piece)
}

/// The materials that `text` names, wherever it is cut.
fn materials(text: &str) -> NamedMaterials {
    let read = |block, piece| read_all(text.as_bytes(), block, piece).unwrap().2;
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

/// What is read of a text, but for lists that are empty.
fn contents(text: &str) -> String {
    let (MeshData { positions, triangles, uvs, normals, colors, .. }, notes, _) =
        load(text).unwrap();
    let NamedMaterials { libraries, runs, .. } = materials(text);
    let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
    let lists = [
        format!("positions: {positions:?}"),
        format!("triangles: {triangles:?}"),
        format!("coordinates: {uvs:?}"),
        format!("normals: {normals:?}"),
        format!("colours: {colors:?}"),
        format!("libraries: {libraries:?}"),
        format!("materials: {runs:?}"),
        format!("told: {notes:?}"),
    ];
    let lists = lists.into_iter().filter(|list| !list.ends_with("None") && !list.ends_with("[]"));
    lists.collect::<Vec<_>>().join("\n").replace(&NO_VALUE.to_string(), "none")
}

#[test]
fn texts_have_these_contents() {
    approved::compare("src/mesh/obj/contents.txt", |text| contents(&text.replace("\\r", "\r")));
}

#[test]
fn marks_of_encodings_are_told_apart() {
    let marked = "\u{feff}v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3";
    let (read, ..) = read_all(marked.as_bytes(), BLOCK, BUFFER).unwrap();
    assert_eq!(read.positions.len(), 3);
    for text in [&b"\xFE\xFF\0v\0 \x001"[..], b"\xFF\xFEv\0 \0", b"v\0 \x001\0"] {
        let error = read_all(text, BLOCK, BUFFER).unwrap_err().to_string();
        assert!(error.contains("UTF-16"), "{error}");
    }
}
