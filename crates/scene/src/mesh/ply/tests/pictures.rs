//! Images that comments name, and texture coordinates of faces.

use super::*;
use crate::mesh::NamedMaterials;

fn read(bytes: &[u8]) -> Read {
    super::super::read(&bytes, bytes.len() as u64, BUFFER, None).unwrap()
}

const CORNERS: &str = "property list uchar float texcoord";

#[test]
fn coordinates_of_faces_belong_to_corners() {
    let header = format!("comment TextureFile a b.png\n{}\n{CORNERS}", square_header(2));
    let rows = "3 0 1 2 6 0 0 1 0 1 1\n4 0 1 2 3 8 0 0 .5 0 .5 .5 0 .5\n";
    let (mesh, notes, images) = read(&ascii(&header, &format!("{SQUARE}{rows}")));
    assert!(notes.is_empty(), "{notes:?}");
    let uvs = mesh.uvs.unwrap();
    let of = |triangle: &[u32; 3]| triangle.map(|i| uvs.values[i as usize]);
    let found: Vec<_> = uvs.indices.as_ref().unwrap().iter().map(of).collect();
    let half = Vec2::splat(0.5);
    assert_eq!(found[0], [Vec2::ZERO, Vec2::X, Vec2::ONE]);
    assert_eq!(found[1], [Vec2::ZERO, Vec2::new(0.5, 0.0), half]);
    assert_eq!(found[2], [Vec2::ZERO, half, Vec2::new(0.0, 0.5)]);
    assert_eq!(images.runs, [(0, "a b.png".to_owned())]);
    // A face without them has none, and lists are checked against the length of the file.
    let rows = rows.replace("6 0 0 1 0 1 1", "0");
    let (mesh, ..) = read(&ascii(&header, &format!("{SQUARE}{rows}")));
    assert_eq!(mesh.uvs.unwrap().indices.unwrap()[0], [u32::MAX; 3]);
    let long = ascii(
        &header.replace("uchar float", "uint float"),
        &format!("{SQUARE}3 0 1 2 4000000000 0\n"),
    );
    assert!(message(&long).contains("face 0"), "{}", message(&long));
}

#[test]
fn faces_choose_one_of_several_images() {
    let names = "comment texturefile a.png\ncomment TextureFile b.png";
    let header = format!("{names}\n{}\n{CORNERS}\nproperty int texnumber", square_header(3));
    let row = |number: i32| format!("3 0 1 2 6 0 0 1 0 1 1 {number}\n");
    let body = [SQUARE.to_owned(), row(1), row(0), row(9)].concat();
    let (.., images) = read(&ascii(&header, &body));
    let runs = |names: [&str; 3]| [0, 1, 2].map(|i| (i as u32, names[i].to_owned()));
    assert_eq!(images.runs, runs(["b.png", "a.png", ""]), "there is no image 9");
    let body = [SQUARE.to_owned(), row(1), row(-1), row(0)].concat();
    let (.., images) = read(&ascii(&header, &body));
    assert_eq!(images.runs, runs(["b.png", "", "a.png"]));
}

#[test]
fn an_image_without_coordinates_is_named() {
    let header = format!("comment TextureFile a.png\n{}", square_header(1));
    let (_, notes, images) = read(&ascii(&header, &format!("{SQUARE}3 0 1 2\n")));
    assert!(notes[0].to_string().contains("found a.png"), "{notes:?}");
    assert_eq!(images, NamedMaterials::default());
}

#[test]
fn undeclared_values_after_a_face_are_told_and_ignored() {
    let rows = "3 0 1 2 9 1 1 1 1 1 1 1 1 1 \n3 0 1 2\n";
    let (mesh, notes, _) = read(&ascii(&square_header(2), &format!("{SQUARE}{rows}")));
    assert_eq!(mesh.triangles, [[0, 1, 2]; 2]);
    assert!(notes[0].to_string().contains("more values") && notes.len() == 1, "{notes:?}");
    let one_line = ascii(&square_header(2), &format!("{SQUARE}3 0 1 2 3 0 1 2\n"));
    assert!(message(&one_line).contains("cut off"), "{}", message(&one_line));
}
