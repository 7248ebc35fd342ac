//! Colours of vertices, in every type and byte order.

use super::*;

/// Whole numbers are parts of their greatest value; floats are as they are, or of 255 if they are larger than 1.
#[test]
fn vertices_may_have_colours() {
    let rows = "0 0 0 255 0 51\n1 0 0 0 255 0\n0 1 0 255 255 255\n3 0 1 2\n";
    let header = |kind: &str| {
        let colors = ["red", "green", "blue", "alpha"].map(|c| format!("property {kind} {c}\n"));
        format!(
            "element vertex 3\n{XYZ}{}element face 1\nproperty list uchar int vertex_indices",
            colors[..3].concat()
        )
    };
    let colors = |kind: &str| mesh(&ascii(&header(kind), rows)).colors.unwrap();
    assert_eq!(colors("uchar")[0], Vec3::new(1.0, 0.0, 51.0 * (1.0 / 255.0)));
    assert_eq!(colors("int"), colors("uchar"));
    let (floats, told, _) = load(&ascii(&header("float"), rows)).unwrap();
    assert_eq!(floats.colors.unwrap()[1], Vec3::Y);
    assert!(told[0].to_string().contains("taken as 0 to 255"), "{told:?}");
    let other = [("red", "R"), ("green", "g"), ("blue", "B")];
    let other = other.iter().fold(header("uchar"), |text, (a, b)| text.replace(a, b));
    assert_eq!(mesh(&ascii(&other, rows)).colors.unwrap(), colors("uchar"));
    assert!((colors("ushort")[2].x - 255.0 / 65535.0).abs() < 1e-9);
    for (big, format) in [(false, "binary_little_endian"), (true, "binary_big_endian")] {
        let mut bytes = Bytes::new(big);
        for (x, y, color) in [(0.0, 0.0, [9_u8, 0, 255]), (1.0, 0.0, [0; 3]), (0.0, 1.0, [255; 3])]
        {
            for x in [x, y, 0.0_f32] {
                bytes.add(x.to_le_bytes());
            }
            bytes.bytes.extend(color);
        }
        bytes.bytes.push(3);
        for i in [0_i32, 1, 2] {
            bytes.add(i.to_le_bytes());
        }
        let read = mesh(&file(format, &header("uchar"), &bytes.bytes));
        assert_eq!(read.colors.unwrap()[0], Vec3::new(9.0 * (1.0 / 255.0), 0.0, 1.0));
    }
    // A list, or two of three, are no colour.
    let one = header("uchar").replace("property uchar blue", "property uchar blu");
    assert!(mesh(&ascii(&one, rows)).colors.is_none());
}
