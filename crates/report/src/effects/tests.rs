use super::*;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::{RenderOptions, render};

fn schedule() -> RoundLimits {
    RoundLimits { warmup: 1, most: 2, seconds: 0.0 }
}

fn setting() -> EffectSetting {
    EffectSetting {
        simd: Level::best(),
        kernel: KernelChoice::default(),
        precision: Precision::default(),
        batch: 64,
    }
}

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

fn trace(scene: &PreparedScene, tracer: TracerKind) -> Result<Rendered> {
    render(scene, &RenderOptions { tracer, ..RenderOptions::default() }, &())
}

#[test]
fn every_effect_has_a_cost_and_hidden_effects_change_nothing() {
    let entries = entries();
    let mut reported = Vec::new();
    let progress = &mut |done, planned| reported.push((done, planned));
    let found = measure(&entries, setting(), &schedule(), trace, progress).expect("prices");
    assert_eq!(found.difference, None);
    assert_eq!((found.rounds.rounds, found.effects.len()), (2, entries.len()));
    assert_eq!(reported.last(), Some(&(2, 2)));
    let of = |name: &str| {
        found.effects.iter().find(|price| price.effect == name).unwrap_or_else(|| panic!("{name}"))
    };
    for price in &found.effects {
        for cost in [&price.wavefront, &price.recursive] {
            assert_eq!(cost.seconds.each.len(), 2);
            assert_eq!(cost.price.is_some(), price.added_to.is_some());
            let per_ray = cost.seconds.median * 1e6 / price.rays.all() as f64;
            assert!((cost.seconds_per_mray / per_ray - 1.0).abs() < 1e-9, "{}", price.effect);
        }
        let Some(base) = price.added_to.as_deref().map(of) else { continue };
        let same = price.simulated == base.simulated && price.bytes_per_path == base.bytes_per_path;
        let is_more_of_the_same =
            ["a second point light", "instances, 4"].contains(&&*price.effect);
        assert_eq!(same, !price.reached || is_more_of_the_same, "{}", price.effect);
    }
    let rays = |name: &str| of(name).rays;
    assert_eq!(rays("ambient light").shadow, 0);
    assert!(rays("a point light").shadow > 0 && rays("mirrors, 1 bounce").secondary > 0);
    assert!(rays("mirrors, 4 bounces").secondary > rays("mirrors, 1 bounce").secondary);
    assert!(of("a texture, bilinear").samples.texels > of("a texture, nearest").samples.texels);
    assert_eq!(rays("antialiasing, 2 x 2").primary, 4 * rays("a point light").primary);
    assert!(of("depth of field, 2 x 2").samples.lens > 0);
    let text = text(&found);
    assert!(found.effects.iter().all(|price| text.contains(&price.effect)), "{text}");
}

#[test]
fn a_visible_effect_that_should_be_hidden_ends_the_measurement() {
    let entries = entries();
    let spoilt = entries.iter().position(|e| !e.variant.reached).expect("one");
    let trace = |scene: &PreparedScene, tracer| {
        let mut run = trace(scene, tracer)?;
        if std::ptr::eq(scene, &raw const entries[spoilt].scene) {
            run.counters.texels += 1;
        }
        Ok(run)
    };
    let found = measure(&entries, setting(), &schedule(), trace, &mut |_, _| {}).expect("a list");
    let differs = found.difference.as_ref().expect("a difference");
    assert!(differs.label.starts_with(&entries[spoilt].variant.name));
    assert!(found.effects.is_empty() && text(&found).contains("THE WORK DIFFERS"));
}

#[test]
fn tracers_that_disagree_end_it_too() {
    let entries = entries();
    let trace = |scene: &PreparedScene, tracer| {
        let mut run = trace(scene, tracer)?;
        if tracer == TracerKind::Recursive {
            run.film = Film::new(16, 12)?;
        }
        Ok(run)
    };
    let found = measure(&entries, setting(), &schedule(), trace, &mut |_, _| {}).expect("a list");
    let differs = found.difference.expect("a difference");
    assert_eq!(differs.label, format!("{} (Recursive)", entries[0].variant.name));
}
