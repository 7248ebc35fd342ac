use super::*;
use crate::tests::approved;

fn read(text: &str) -> Library {
    let mut library = Library::default();
    library.add("a.mtl", text.as_bytes());
    library
}

#[test]
fn materials_are_read_in_any_case_with_blanks_and_comments() {
    let library =
        read("# c\r\n\r\nnewmtl one\r\n\tKd 0.1 .2 3e-1\r\n  ns 5\nNEWMTL two\nKs 0.5\nillum 2\n");
    assert_eq!(library.materials.len(), 2);
    let one = &library.materials["one"];
    assert_eq!((one.kd, one.ns), (Some(DVec3::new(0.1, 0.2, 0.3)), Some(5.0)));
    let two = &library.materials["two"];
    assert_eq!((two.ks, two.illum), (Some(DVec3::splat(0.5)), Some(2)));
    assert!(library.skipped.is_empty() && library.malformed.is_empty());
    assert_eq!(read("Kd 1 1 1\nnewmtl a\nKd 1 1 1").malformed, ["a.mtl, line 1"]);
}

/// What the first material of a text is, but for what it is without any statement; and what is said of the text.
fn parts(statements: &str) -> Vec<String> {
    let library = read(&format!("newmtl a\n{statements}"));
    let MtlSurface { material, transparency, texture, metal, cutout, is_there } =
        surface(&library.materials["a"], |name| Some(PathBuf::from(name)));
    vec![
        format!("{material:?}"),
        format!("{transparency:?}"),
        format!("texture: {texture:?}"),
        format!("{:?}", crate::components::Maps { metal, ..Default::default() }),
        format!("cutout: {cutout:?}"),
        format!("is there: {is_there}"),
        format!("skipped: {:?}, {:?}", library.skipped, library.options),
        format!("malformed: {:?}", library.malformed),
    ]
}

#[test]
fn what_statements_make_of_a_material() {
    let plain = parts("");
    approved::compare("src/mtl/surfaces.txt", |statements| {
        let parts = parts(statements).into_iter();
        parts.filter(|part| !plain.contains(part)).collect::<Vec<_>>().join("\n")
    });
}

#[test]
fn what_lacks_its_image_is_grey_unless_it_has_a_colour() {
    let color = |text: &str| {
        let library = read(&format!("newmtl a\n{text}"));
        surface(&library.materials["a"], |_| None).material.diffuse_color
    };
    let grey = DVec3::splat(GREY);
    assert_eq!(["map_Kd a.png", "Kd 0 0 0\nmap_Kd a.png"].map(color), [grey; 2]);
    assert_eq!(color("Kd 1 0 0\nmap_Kd a.png"), DVec3::X);
    assert_eq!(color("Kd 1 1 1"), DVec3::ONE);
}
