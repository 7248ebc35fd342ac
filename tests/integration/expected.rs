//! What a pilot expects of a render is near what the render then counts.

use wavecrest_core::render::render;
use wavecrest_report::expected::Expected;

use crate::support::{extract_small, options, repository};
use wavecrest_core::accel::build::Preset;

#[test]
fn a_pilot_of_some_pixels_tells_the_rays_and_texels_of_all() {
    for name in
        ["testareajitter", "lightbounce", "DoF-aperture8", "texturefilter", "occlusion", "glass"]
    {
        let path = repository(&format!("scenes/{name}.json"));
        let scene = extract_small(&path, 200, 4_000_000).build(Preset::Fast);
        let expected = Expected::of(&scene, &options()).expect("a pilot");
        let again = Expected::of(&scene, &options()).expect("a pilot");
        let c = render(&scene, &options(), &()).expect("an image").counters;
        let (rays, samples) = (expected.rays, expected.samples);
        assert_eq!((rays.primary, samples.lens), (c.rays.primary, c.samples.lens), "{name}");
        for (what, found, counted) in [
            ("mirror rays", rays.secondary, c.rays.secondary),
            ("shadow rays", rays.shadow, c.rays.shadow),
            ("light numbers", samples.light, c.samples.light),
            ("texels", samples.texels, c.samples.texels),
            ("footprints", samples.footprints, c.samples.footprints),
        ] {
            let off = found.abs_diff(counted) as f64 / counted.max(1) as f64;
            assert!(off < 0.05, "{name}, {what}: {found} expected, {counted} counted");
        }
        assert_eq!(again.rays.all(), rays.all(), "{name}: the same in every run");
        assert!(expected.seconds > 0.0 && expected.pixels <= 128 * 128, "{name}: {expected:?}");
    }
}
