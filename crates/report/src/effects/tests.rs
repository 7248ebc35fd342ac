use super::*;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::render::RenderOptions;

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

fn trace(scene: &PreparedScene, tracer: TracerKind) -> Result<Run> {
    Run::of(scene, &RenderOptions { tracer, ..RenderOptions::default() })
}

#[test]
fn a_visible_effect_that_should_be_hidden_ends_the_measurement() {
    let entries = entries();
    let spoilt = entries.iter().position(|e| !e.variant.reached).expect("one");
    let trace = |scene: &PreparedScene, tracer| {
        let mut run = trace(scene, tracer)?;
        if std::ptr::eq(scene, &raw const entries[spoilt].scene) {
            run.rendered.counters.look_ups.texels += 1;
        }
        Ok(run)
    };
    let found = measure(&entries, setting(), &schedule(), trace, &mut |_, _| {}).expect("a list");
    let differs = found.difference.as_ref().expect("a difference");
    assert!(differs.label.starts_with(&entries[spoilt].variant.name));
    assert!(found.effects.is_empty() && text(&found).contains("THE WORK DIFFERS"));
}

/// The kinds of maps, cut-outs among them.
#[test]
fn maps_in_view_are_priced_by_the_hit() {
    let found = measure(&entries(), setting(), &schedule(), trace, &mut |_, _| {}).expect("a list");
    let is_map = |name: &str| ["a texture,", "map", "cut-outs"].iter().any(|w| name.contains(w));
    for price in &found.effects {
        let costs = [&price.wavefront, &price.recursive];
        let is_priced = costs.map(|cost| cost.nanoseconds_a_hit.is_some());
        assert_eq!(is_priced, [price.reached && is_map(&price.effect); 2], "{}", price.effect);
    }
}

#[test]
fn tracers_that_disagree_end_it_too() {
    let entries = entries();
    let trace = |scene: &PreparedScene, tracer| {
        let mut run = trace(scene, tracer)?;
        if tracer == TracerKind::Recursive {
            run.rendered.film = Film::new(16, 12)?;
        }
        Ok(run)
    };
    let found = measure(&entries, setting(), &schedule(), trace, &mut |_, _| {}).expect("a list");
    let differs = found.difference.expect("a difference");
    assert_eq!(differs.label, format!("{} (Recursive)", entries[0].variant.name));
}
