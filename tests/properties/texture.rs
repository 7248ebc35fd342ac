use glam::{Vec2, Vec3};
use proptest::prelude::*;
use wavecrest_core::kernels::texture::{Filter, Image, Texels, Wrap, sphere_uv};
use wavecrest_core::math::vector::Vector;

use crate::inputs::unit;

fn image() -> impl Strategy<Value = Image> {
    (1_u32..9, 1_u32..9).prop_flat_map(|(width, height)| {
        let count = (width * height) as usize;
        let bytes = prop::collection::vec(any::<[u8; 4]>(), count).prop_map(Texels::Bytes);
        let floats = prop::collection::vec(prop::array::uniform3(-10.0_f32..10.0), count)
            .prop_map(Texels::Floats);
        let levels = prop::collection::vec(any::<[u8; 4]>(), count);
        let levels = (levels, -10.0_f32..10.0).prop_map(|(texels, tint)| {
            let value = |level: usize| Vec3::new(1.0, 2.0, tint) * level as f32;
            Texels::Levels(texels, Box::new(std::array::from_fn(value)))
        });
        prop_oneof![bytes, levels, floats].prop_map(move |texels| Image::new(width, height, texels))
    })
}

fn texels(image: &Image) -> Vec<Vec3> {
    match &image.texels {
        Texels::Bytes(texels) => texels
            .iter()
            .map(|&[r, g, b, _]| Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0)
            .collect(),
        Texels::Levels(texels, values) => texels
            .iter()
            .map(|texel| texel.map(usize::from))
            .map(|[r, g, b, _]| Vec3::new(values[r].x, values[g].y, values[b].z))
            .collect(),
        Texels::Floats(texels) => texels.iter().map(|&t| Vec3::from(t)).collect(),
    }
}

fn look_up(image: &Image, uv: Vec2, filter: Filter, wrap: Wrap) -> Vec3 {
    image.look_up(uv.to_array(), filter, wrap).into()
}

/// Any bits.
fn bits() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        bits(),
        -2.0_f32..2.0,
        (-40_i32..=40).prop_map(|x| x as f32 / 8.0),
        prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(-1e-30), Just(0.999_999_94)],
    ]
}

/// Of detail: within the pyramid, or any bits.
fn level() -> impl Strategy<Value = f32> {
    prop_oneof![-1.0_f32..5.0, bits()]
}

fn wrap() -> impl Strategy<Value = Wrap> {
    prop_oneof![Just(Wrap::Repeat), Just(Wrap::Clamp), Just(Wrap::Mirror)]
}

/// Where a coordinate is in an image of `count` texels, from 0 to that.
fn place(coordinate: f32, count: u32, wrap: Wrap) -> f64 {
    let exact = if coordinate.is_finite() { f64::from(coordinate) } else { 0.0 };
    let place = match wrap {
        Wrap::Repeat => exact - exact.floor(),
        Wrap::Clamp => exact.clamp(0.0, 1.0),
        Wrap::Mirror => 1.0 - (exact.rem_euclid(2.0) - 1.0).abs(),
    };
    (place * f64::from(count)).min(f64::from(count - 1))
}

proptest! {
    #![proptest_config(crate::config())]

    /// Of whatever bits the coordinates are, the colour is one of the texels', or between them.
    #[test]
    fn colours_are_among_the_texels(
        mut image in image(), uv in (coordinate(), coordinate()), wrap in wrap(), level in level(),
    ) {
        image.build_pyramid();
        let (uv, texels) = (Vec2::from(uv), texels(&image));
        let nearest = look_up(&image, uv, Filter::Nearest, wrap);
        prop_assert!(texels.contains(&nearest), "{}", nearest);
        let between = look_up(&image, uv, Filter::Bilinear, wrap);
        let filtered = image.look_up_at(uv.to_array(), level, wrap).0.into();
        let low = texels.iter().copied().reduce(Vec3::min).expect("there is a texel");
        let high = texels.iter().copied().reduce(Vec3::max).expect("there is a texel");
        // Up to seven interpolations, of a few roundings each.
        let room = 16.0 * f32::EPSILON * low.abs().max(high.abs());
        for found in [between, filtered] {
            let inside = found.cmpge(low - room).all() && found.cmple(high + room).all();
            prop_assert!(inside, "{} of {} to {}", found, low, high);
        }
    }

    /// A repeated image looks the same one image farther on. Eighths are exact.
    #[test]
    fn a_repeated_image_repeats(
        image in image(), eighths in (1_i32..8, 1_i32..8), images in (-50_i32..50, -50_i32..50),
    ) {
        let uv = Vec2::new(eighths.0 as f32, eighths.1 as f32) / 8.0;
        let farther = uv + Vec2::new(images.0 as f32, images.1 as f32);
        for filter in [Filter::Nearest, Filter::Bilinear] {
            let [here, there] = [uv, farther].map(|uv| look_up(&image, uv, filter, Wrap::Repeat));
            prop_assert_eq!(here, there);
        }
    }

    #[test]
    fn a_clamped_image_repeats_its_edge(image in image(), uv in (1.0_f32..1e30, -1e30_f32..0.0)) {
        for filter in [Filter::Nearest, Filter::Bilinear] {
            let beyond = look_up(&image, Vec2::from(uv), filter, Wrap::Clamp);
            let corner = look_up(&image, Vec2::new(1.0, 0.0), filter, Wrap::Clamp);
            prop_assert_eq!(beyond, corner);
        }
    }

    /// At whatever place, a look-up is within a texel of the one that double precision finds, in which the fraction of
    /// a coordinate is exact. Rows start at the top, where v is 1.
    #[test]
    fn hc30_a_look_up_is_off_by_at_most_a_texel(
        size in (1_u32..100, 1_u32..100), uv in (coordinate(), coordinate()), wrap in wrap(),
        far in prop_oneof![Just(1.0), Just(1e4), Just(1e6)],
    ) {
        let (width, height) = size;
        let ramp = (0..width * height).map(|i| [(i % width) as f32, (i / width) as f32, 0.0]);
        let image = Image::new(width, height, Texels::Floats(ramp.collect()));
        let uv = Vec2::new(uv.0, 1.0 - uv.1) * far;
        let right = [place(uv.x, width, wrap), place(1.0 - uv.y, height, wrap)];
        let found = look_up(&image, uv, Filter::Nearest, wrap).to_array();
        for ((right, found), count) in right.into_iter().zip(found).zip([width, height]) {
            let off = (right.floor() - f64::from(found)).abs();
            // At 1 a repeated image restarts: the texel on either side is right.
            let round = if wrap == Wrap::Repeat { f64::from(count) - off } else { off };
            prop_assert!(off.min(round) <= 1.0, "{}: {} and not {}", uv, found, right);
        }
    }

    /// The level of detail of a footprint of any size, also infinite, is within the pyramid.
    #[test]
    fn hc52_every_footprint_has_a_level(mut image in image(), sides in [bits(), bits(), bits(), bits()]) {
        image.build_pyramid();
        let [a, b, c, d] = sides;
        let level = image.level(&[[a, b], [c, d]]);
        let coarsest = image.coarsest() as f32;
        prop_assert!((0.0..=coarsest).contains(&level), "{}", level);
        let is_finite = sides.iter().all(|side| side.is_finite());
        prop_assert!(is_finite || level == coarsest, "{} of {}", level, coarsest);
    }

    #[test]
    fn coordinates_of_a_sphere_are_from_0_to_1(normal in unit()) {
        let uv = Vec2::from(sphere_uv(Vector::from(normal)));
        let bound = 1.0 + f32::EPSILON;
        prop_assert!(uv.min_element() >= -f32::EPSILON && uv.max_element() <= bound, "{}", uv);
    }
}
