//! The price list: what ends it, and what it prices.

use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_report::bench::TimedRender;
use wavecrest_report::effects::scenes::{self, SceneVariant};
use wavecrest_report::effects::{EffectScene, EffectSetting, PriceList, measure, text};
use wavecrest_report::measure::RoundLimits;

/// The list's scenes, some pixels large.
fn entries() -> Vec<EffectScene> {
    let folder = tempfile::tempdir().expect("a folder");
    let variants = scenes::variants(folder.path()).expect("scenes");
    let prepare = |mut variant: SceneVariant| {
        for (side, pixels) in [("width", 16), ("height", 12)] {
            variant.scene["camera"][side] = pixels.into();
        }
        let json = variant.scene.to_string();
        let loaded = wavecrest_scene::load::load_str(&json, folder.path(), &Default::default())
            .unwrap_or_else(|error| panic!("{}: {error}", variant.name));
        let extracted =
            wavecrest_scene::systems::extract(loaded.world, Default::default()).expect("a scene");
        let scene = extracted.build(Preset::Fast);
        // The folder is gone before the first look-up.
        scene.appearance.decode().expect("textures");
        EffectScene { variant, scene }
    };
    variants.into_iter().map(prepare).collect()
}

/// The list, with runs that `spoil` changes.
fn measured(
    entries: &[EffectScene],
    spoil: impl Fn(&PreparedScene, TracerKind, &mut TimedRender),
) -> PriceList {
    let (simd, kernel, precision) = (Level::best(), KernelChoice::default(), Precision::default());
    let setting = EffectSetting { simd, kernel, precision, batch: 64 };
    let schedule = RoundLimits { warmup: 1, most: 2, seconds: 0.0 };
    let trace = |scene: &PreparedScene, tracer| {
        let mut run =
            TimedRender::of(scene, &RenderOptions { tracer, ..RenderOptions::default() })?;
        spoil(scene, tracer, &mut run);
        Ok(run)
    };
    measure(entries, setting, &schedule, trace, &mut |_, _| {}).expect("a list")
}

/// An effect that should be hidden, and a tracer that disagrees.
#[test]
fn a_difference_ends_the_measurement() {
    let entries = entries();
    let hidden = entries.iter().position(|e| !e.variant.reached).expect("one");
    let found = measured(&entries, |scene, _, run| {
        let is_hidden = std::ptr::eq(scene, &raw const entries[hidden].scene);
        run.rendered.counters.samples.texels += u64::from(is_hidden);
    });
    let difference = found.difference.as_ref().expect("a difference");
    assert!(difference.label.starts_with(&entries[hidden].variant.name));
    assert!(found.effects.is_empty() && text(&found).contains("THE WORK DIFFERS"));
    let found = measured(&entries, |_, tracer, run| {
        if tracer == TracerKind::Recursive {
            run.rendered.film = Film::new(16, 12).expect("a film");
        }
    });
    let difference = found.difference.expect("a difference");
    assert_eq!(difference.label, format!("{} (Recursive)", entries[0].variant.name));
}

/// The kinds of maps, cut-outs among them.
#[test]
fn maps_in_view_are_priced_by_the_hit() {
    let found = measured(&entries(), |_, _, _| {});
    let is_map = |name: &str| ["a texture,", "map", "cut-outs"].iter().any(|w| name.contains(w));
    for price in &found.effects {
        let costs = [&price.wavefront, &price.recursive];
        let is_priced = costs.map(|cost| cost.nanoseconds_a_hit.is_some());
        assert_eq!(is_priced, [price.reached && is_map(&price.effect); 2], "{}", price.effect);
    }
}
