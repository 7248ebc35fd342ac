use super::*;
use crate::components::Transparency;

fn read(text: &str) -> Library {
    let mut library = Library::default();
    library.add("a.mtl", text.as_bytes());
    library
}

/// The only material of a text, and its texture.
fn made(text: &str) -> (Material, Option<TextureRef>) {
    let look = looked(text);
    (look.material, look.texture)
}

fn looked(text: &str) -> MtlSurface {
    let library = read(&format!("newmtl a b\n{text}"));
    assert_eq!(library.malformed, [""; 0]);
    surface(&library.materials["a b"], |name| Some(PathBuf::from(name)))
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
}

#[test]
fn the_first_of_equal_names_counts_and_unsupported_statements_are_named() {
    let library =
        read("newmtl a\nKd 1 0 0\nmap_Bump n.png\nKa 1 1 1\nnewmtl a\nKd 0 1 0\nnorm x\n");
    assert_eq!(library.materials["a"].kd, Some(DVec3::X));
    assert_eq!(library.skipped.into_iter().collect::<Vec<_>>(), ["map_bump", "norm"]);
}

#[test]
fn malformed_lines_are_named_and_skipped() {
    let library =
        read("Kd 1 1 1\nnewmtl a\nKd 1 x 1\nKd 0.5 0.25 0\nNs -1\nillum two\nmap_Kd\nKs nan\n");
    assert_eq!(library.malformed, ["a.mtl, line 1", "a.mtl, line 3", "a.mtl, line 5"]);
    assert_eq!(library.materials["a"].kd, Some(DVec3::new(0.5, 0.25, 0.0)));
    assert_eq!(library.materials["a"].ns, None);
}

#[test]
fn highlights_and_mirrors_follow_the_model() {
    let text = "Kd 0.2 0.4 0.6\nKs 0.3 0.6 0.9\nNs 1e9\n";
    let of = |model: &str| made(&format!("{text}{model}")).0;
    let usual = of("");
    assert_eq!(usual.diffuse_color, DVec3::new(0.2, 0.4, 0.6));
    assert!((usual.ks - 0.6).abs() < 1e-12 && usual.specular_exponent == 1e6);
    assert_eq!((usual.kd, usual.kr, usual.emission), (1.0, 0.0, DVec3::ZERO));
    assert_eq!(made("Ke 0 2 0.5").0.emission, DVec3::new(0.0, 2.0, 0.5));
    for matt in ["illum 0", "illum 1", "Ns 0"] {
        assert_eq!(of(matt).ks, 0.0, "{matt}");
    }
    for mirror in ["illum 3", "illum 5", "illum 8"] {
        let found = of(mirror);
        assert!((found.kr - 0.6).abs() < 1e-12 && (found.kd - 0.4).abs() < 1e-12, "{mirror}");
    }
    assert_eq!(made("illum 3\nKs 9 9 9").0.kr, 1.0);
}

#[test]
fn maps_have_options_and_names_with_blanks() {
    let map = |text: &str| {
        let mut options = BTreeSet::new();
        let map = MtlMap::read(text, &mut options).map(|map| (map.name, map.clamp));
        (map, options.into_iter().collect::<Vec<_>>().join(" "))
    };
    let named = |name: &str, clamp| Some((name.to_owned(), clamp));
    assert_eq!(map("a b.png "), (named("a b.png", false), String::new()));
    assert_eq!(map("-clamp on a.png"), (named("a.png", true), String::new()));
    assert_eq!(map("-clamp off -o 0.1 a.png"), (named("a.png", false), String::new()));
    assert_eq!(map("-s 1 2 3 -mm 0 1 a.png"), (named("a.png", false), String::new()));
    assert_eq!(map("-mm 0.1 1 a.png"), (named("a.png", false), "-mm".into()), "with an offset");
    assert_eq!(map("a.png -bm 1.5"), (named("a.png", false), "-bm".into()));
    assert_eq!(map("-BlendU on -type sphere C:\\x\\a.png").0, named("C:\\x\\a.png", false));
    for none in ["", " ", "-bm", "-o 1 2", "-mm 1"] {
        assert_eq!(map(none).0, None, "{none:?}");
    }
}

#[test]
fn a_texture_is_tinted_unless_its_colour_is_black() {
    let (_, texture) = made("Kd 0.5 0.5 1\nmap_Kd -clamp on t.png");
    let texture = texture.unwrap();
    assert_eq!((texture.tint, texture.look_up.wrap), (DVec3::new(0.5, 0.5, 1.0), Wrap::Clamp));
    assert_eq!(made("Kd 0 0 0\nmap_Kd t.png").1.unwrap().tint, DVec3::ONE);
    assert_eq!(made("map_Kd t.png").1.unwrap().tint, DVec3::ONE);
    assert!(made("Kd 1 1 1").1.is_none());
}

#[test]
fn maps_are_scaled_and_moved() {
    let placing = |text: &str| made(text).1.unwrap().look_up.placing.map(|placing| placing.0);
    assert_eq!(placing("map_Kd a.png"), None);
    assert_eq!(placing("map_Kd -s 1 1 1 -o 0 a.png"), None);
    let rows = [[10.0, 0.0, 0.25], [0.0, 1.0, 0.5]];
    assert_eq!(placing("map_Kd -s 10 -o 0.25 0.5 a.png"), Some(rows));
    let look = looked("map_d -s 2 2 m.png");
    assert!(look.cutout.unwrap().look_up.unwrap().placing.is_some());
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

#[test]
fn half_transparent_surfaces_are_cut_out() {
    assert!(looked("").cutout.is_none() && looked("").is_there);
    let of = |text: &str| looked(text).cutout.map(|cutout| (cutout.threshold, cutout.is_mask));
    assert_eq!(of("map_d a.png"), Some((0.5, true)));
    assert_eq!(of("d 0.8\nmap_d -clamp on a.png"), Some((0.5, true)));
    assert!(looked("d 0.01").is_there && !looked("d 0").is_there);
}

#[test]
fn opacity_and_glass_follow_the_statements() {
    let of = |text: &str| {
        let Transparency { opacity, kt, ior, .. } = looked(text).transparency;
        (opacity, kt, ior)
    };
    assert_eq!(of(""), (1.0, 0.0, 1.5));
    assert_eq!(of("d 0.25"), (0.25, 0.0, 1.5));
    assert_eq!(of("Tr 0.25\nNi 9999"), (0.75, 0.0, 9999.0));
    assert_eq!(of("Tr 1"), (1.0, 0.0, 1.5), "some programs write it for opaque surfaces");
    assert_eq!(of("Tr 1\nd 0.5"), (0.5, 0.0, 1.5));
    assert_eq!(of("illum 7\nd 0.25\nNi 1.33"), (1.0, 0.75, 1.33));
    assert_eq!(looked("illum 6\nd 0.5\nTf 1 0.5 0").transparency.color, DVec3::new(1.0, 0.5, 0.0));
    assert_eq!(looked("illum 6\nd 0.25").material.kd, 0.25);
    assert_eq!(of("illum 7\nTf 1 1 1\nNi 1.5").1, 1.0);
    assert_eq!(of("illum 7\nTf 0 0 0").1, 0.0);
}

#[test]
fn metals_have_their_colour_and_images_the_range_of_their_values() {
    let metal = made("Kd 0.9 0.6 0.3\nKs 1 1 1\nNs 10\nPm 1\nPr 0.2").0;
    assert_eq!(metal, Material::metal(DVec3::new(0.9, 0.6, 0.3), 1.0, 0.2));
    assert!(metal.kr > 0.5 && metal.specular_color.z < 0.5);
    let look = looked("Pm 1\nPr 0.2\nmap_Kd -mm 0 0.5 a.png");
    assert_eq!(look.texture.unwrap().tint, DVec3::splat(0.5));
    assert_eq!(look.maps.metal.map(|map| [map.metallic, map.roughness]), Some([1.0, 0.2]));
}
