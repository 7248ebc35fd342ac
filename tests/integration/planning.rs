//! The plan: leaving out what a scene does not call for changes no bit of an image, and every row of the
//! table of passes is there for a reason.

use std::path::Path;

use rayon::prelude::*;
use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_core::plan::schedule::{Needs, PASSES, Pass, UNPLANNED};
use wavecrest_core::plan::{Effect, Plan};
use wavecrest_core::prepared::{PreparedScene, SampleCounts};
use wavecrest_core::render::{RenderOptions, Rendered, camera_rays};
use wavecrest_report::effects::scenes::{SceneVariant, variants};
use wavecrest_scene::systems::SceneOptions;

use crate::parity::work;
use crate::support::{
    ODD, both, both_alone, edited, folder, options, pinhole, point_light, prepare_in, put_texture,
    scene,
};
use crate::unseen::differences;

/// A set of effects: a bit for each, in the order of [`Effect::ALL`].
#[derive(Clone, Copy)]
struct Set(u32);

/// Effects that cast shadow rays.
const LIGHTS: [Effect; 4] =
    [Effect::PointLights, Effect::SpotLights, Effect::DirectionalLights, Effect::AreaLights];

/// Kinds of shapes.
const KINDS: [Effect; 4] = [Effect::Triangles, Effect::Quads, Effect::Disks, Effect::Spheres];

/// The effect of this name.
pub(crate) fn effect(name: &str) -> Effect {
    Effect::ALL.into_iter().find(|effect| effect.name() == name).expect("an effect")
}

impl Set {
    const NUMBER: u32 = 1 << Effect::ALL.len();
    /// Sets that are drawn, of those that are neither small nor nearly full.
    const DRAWN: u64 = 512;

    /// Every set of up to two effects, every one that lacks up to two, and others drawn by their number.
    fn all() -> impl ParallelIterator<Item = Self> {
        let is_tried = |set: &u32| {
            let present = set.count_ones() as usize;
            let drawn = u64::from(set.wrapping_mul(0x9E37_79B9));
            present.min(Effect::ALL.len() - present) <= 2
                || (drawn * u64::from(Self::NUMBER)) >> u32::BITS < Self::DRAWN
        };
        (0..Self::NUMBER).into_par_iter().filter(is_tried).map(Self)
    }

    fn of(effects: &[Effect]) -> Self {
        let bit = |effect: &Effect| 1 << Effect::ALL.iter().position(|e| e == effect).expect("one");
        Self(effects.iter().map(bit).sum())
    }

    fn has(self, effect: Effect) -> bool {
        self.0 & Self::of(&[effect]).0 != 0
    }

    fn names(self) -> Vec<&'static str> {
        Effect::ALL.into_iter().filter(|&e| self.has(e)).map(Effect::name).collect()
    }

    /// A scene of these effects, as far as they can be seen, by the lines of `effects.txt`: effects that it needs, and an
    /// edit of the scene or of each shape in it. What mirrors and rays of ambient light meet is behind the eye. Its texture is in `folder`.
    fn scene(self, folder: &Path) -> Value {
        // By a light without power surfaces show their colours even where no other light is.
        let dark = point_light(0.0, [0.0, 9.0, 9.0], [1.0; 3]);
        let mut scene = scene(2, &pinhole([8, 6], 40.0, 5.0), &[dark], &[]);
        let image = json!(folder.join("t.png")).to_string();
        let edits = include_str!("effects.txt").replace("$shape", self.light_shape());
        for line in edits.replace("$image", &image).lines() {
            let (effects, edit) = line.split_once(": ").expect("effects and an edit");
            if !effects.split_terminator(", ").all(|name| self.has(effect(name))) {
                continue;
            }
            match edit.strip_prefix("/each") {
                Some(edit) => {
                    let shapes = scene["scene"]["shapes"].as_array_mut().expect("shapes");
                    shapes.iter_mut().for_each(|shape| *shape = edited(shape.take(), edit));
                }
                None => scene = edited(scene, edit),
            }
        }
        scene
    }

    /// A shape for the area light, of a kind that is there in any case, if one is.
    fn light_shape(self) -> &'static str {
        if self.has(Effect::Triangles) {
            r#"{"type": "triangle", "points": [[-3, 3, 3], [-2, 3, 3], [-3, 3, 2]]}"#
        } else if self.has(Effect::Quads) {
            r#"{"type": "plane", "points": [[-3, 3, 3], [-2, 3, 3], [-2, 3, 2], [-3, 3, 2]]}"#
        } else if self.has(Effect::Disks) {
            r#"{"type": "disk", "center": [-3, 3, 3], "normal": [1, -1, 1], "radius": 0.5}"#
        } else {
            r#"{"type": "sphere", "center": [-3, 3, 3], "radius": 0.5}"#
        }
    }

    /// Whether a plan has to find the effect: something leads to it.
    fn expected(self, effect: Effect) -> bool {
        let any = |effects: &[Effect]| effects.iter().any(|&effect| self.has(effect));
        let surfaces = any(&KINDS);
        let is_lit = any(&LIGHTS) || self.has(Effect::Mirrors);
        let shows_normals = is_lit || any(&[Effect::Transparency, Effect::HemisphereLight]);
        let is_traced = self.has(Effect::AmbientOcclusion) && self.has(Effect::HemisphereLight);
        let is_led_to = match effect {
            Effect::Environment => true,
            kind if KINDS.contains(&kind) => true,
            // The shape of the light is not in view, and lights nothing.
            Effect::DepthOfField | Effect::Antialiasing => {
                surfaces || self.has(Effect::Environment)
            }
            Effect::VertexColors => self.has(Effect::Triangles),
            Effect::SmoothShading => self.has(Effect::Triangles) && shows_normals,
            Effect::NormalMaps => surfaces && shows_normals,
            Effect::TintedHighlights => surfaces && is_lit,
            Effect::RayDifferentials => surfaces && self.has(Effect::Textures),
            Effect::AmbientOcclusion => surfaces && is_traced,
            // Rays find what the map would tell.
            Effect::MaterialTextures => surfaces && !is_traced,
            _ => surfaces,
        };
        self.has(effect) && is_led_to
    }
}

/// A scene made ready by a table.
fn prepare_by(passes: &'static [Pass], scene: &Value) -> PreparedScene {
    prepare_in(Path::new(""), scene, SceneOptions { passes, ..SceneOptions::default() })
}

/// Effects that look texels up, if they have an image.
const LOOK_UPS: [Effect; 4] =
    [Effect::Textures, Effect::NormalMaps, Effect::MaterialTextures, Effect::Emission];

/// Checks that what is absent is not counted.
pub(crate) fn check_work(
    what: &str,
    scene: &PreparedScene,
    rendered: &Rendered,
    options: &RenderOptions,
) {
    let c = &rendered.counters;
    let cast = camera_rays(scene, options).expect("an image");
    let drawn = if scene.camera.has_lens() { cast } else { 0 };
    assert_eq!((c.rays.primary, c.samples.lens), (cast, drawn), "{what}");
    let schedule = scene.plan.schedule();
    let draws_lights = scene.lights.iter().any(|light| light.is_sampled());
    let looks_up = !scene.appearance.images.is_empty()
        && LOOK_UPS.iter().any(|&effect| scene.plan.has(effect));
    for (counted, called_for) in [
        (c.rays.secondary, schedule.goes_on()),
        (c.rays.shadow, schedule.has_shadows()),
        (c.samples.light, draws_lights),
        (c.samples.colors, scene.plan.has(Effect::VertexColors)),
        (c.samples.texels, looks_up),
        (c.samples.lens, scene.plan.has(Effect::DepthOfField)),
        (c.samples.footprints, scene.plan.has(Effect::RayDifferentials)),
        (c.tests.primitives.triangles, scene.plan.has(Effect::Triangles)),
        (c.tests.primitives.quads, scene.plan.has(Effect::Quads)),
        (c.tests.cutouts, scene.plan.has(Effect::CutOuts)),
        (c.tests.primitives.spheres, scene.plan.has(Effect::Spheres)),
        (c.tests.primitives.disks, scene.plan.has(Effect::Disks)),
    ] {
        assert!(called_for || counted == 0, "{what}: {c:?}");
    }
}

#[test]
fn effects_together_give_one_image_planned_or_not_with_either_tracer() {
    let folder = folder();
    put_texture(folder.path());
    let by = RenderOptions { batch: ODD, ..options() };
    Set::all().for_each(|set| {
        let json = set.scene(folder.path());
        let what = format!("{:?}", set.names());
        let mut scene = prepare_by(&PASSES, &json);
        for effect in Effect::ALL {
            let found = scene.plan.has(effect);
            assert_eq!(found, set.expected(effect), "{what}: {}", effect.name());
        }
        let planned = both(&scene);
        for rendered in &planned {
            check_work(&what, &scene, rendered, &by);
            assert!(rendered.film.same_bits(&planned[0].film), "{what}: the tracers differ");
            assert_eq!(work(&rendered.counters), work(&planned[0].counters), "{what}");
            assert_eq!(rendered.counters.invalid, 0, "{what}");
        }
        // Everything is prepared, run and stored; or prepared as planned, and then run and stored.
        let all = prepare_by(&UNPLANNED, &json);
        scene.plan = Plan::of(scene.plan.decisions().to_vec(), &UNPLANNED);
        for (scene, how) in [(all, "unplanned"), (scene, "planned, all of it run")] {
            for rendered in both(&scene) {
                assert!(rendered.film.same_bits(&planned[0].film), "{what}: {how}");
            }
        }
    });
}

/// The scenes of the price list, smaller.
fn price_list(folder: &Path) -> Vec<SceneVariant> {
    let smaller = |mut variant: SceneVariant| {
        variant.scene["camera"]["width"] = 12.into();
        variant.scene["camera"]["height"] = 9.into();
        variant
    };
    variants(folder).expect("scenes").into_iter().map(smaller).collect()
}

#[test]
fn a_hidden_effect_changes_no_bit_and_no_count() {
    let folder = folder();
    let list = price_list(folder.path());
    let mut pairs = 0;
    for variant in list.iter().filter(|variant| !variant.reached) {
        let base = &list[variant.added_to.expect("it is added to a scene")];
        let [scene, before] = [variant, base].map(|v| prepare_by(&PASSES, &v.scene));
        let mut differing = differences(&scene, &before);
        // Triangles without area have attributes.
        differing.retain(|what| !what.ends_with(" held"));
        assert_eq!(differing, <[&str; 0]>::default(), "{}", variant.name);
        pairs += 1;
    }
    assert!(pairs >= 11, "{pairs}");
}

#[test]
fn effects_of_the_price_list_are_those_that_the_plan_finds() {
    let folder = folder();
    let list = price_list(folder.path());
    let plans: Vec<Plan> = list.iter().map(|v| prepare_by(&PASSES, &v.scene).plan).collect();
    for effect in Effect::ALL {
        let added = list.iter().zip(&plans).any(|(variant, plan)| {
            let before = variant.added_to.map(|base| &plans[base]);
            plan.has(effect) && before.is_none_or(|before| !before.has(effect))
        });
        assert!(added, "no scene of the list adds {}", effect.name());
    }
}

/// The table with `change` made to the needs of the rows that `of` chooses.
fn table(of: impl Fn(&Pass) -> bool, change: impl Fn(Needs) -> Needs) -> &'static [Pass] {
    let row =
        |pass: Pass| if of(&pass) { Pass { needs: change(pass.needs), ..pass } } else { pass };
    Vec::leak(PASSES.into_iter().map(row).collect())
}

/// `needs` but `effect`.
fn without(needs: Needs, effect: Effect) -> Needs {
    let others = |effects: &&[Effect]| -> &'static [Effect] {
        Vec::leak(effects.iter().copied().filter(|&e| e != effect).collect())
    };
    Vec::leak(needs.iter().map(others).collect())
}

/// A scene that shows `effect` and whatever else `needs` must have, of shapes of every kind and, unless
/// that is the effect, under a light.
fn scene_of(effect: Effect, needs: Needs, folder: &Path) -> Value {
    let is_light = LIGHTS.contains(&effect) || effect == Effect::AmbientOcclusion;
    let light = if is_light { effect } else { Effect::PointLights };
    let mut effects = [&KINDS[..], &[light]].concat();
    effects.extend((effect != light).then_some(effect));
    effects.extend((effect == Effect::AmbientOcclusion).then_some(Effect::HemisphereLight));
    if let [some, more] = needs {
        effects.push(if some.contains(&effect) { more[0] } else { some[0] });
        effects.push(Effect::Textures);
    }
    Set::of(&effects).scene(folder)
}

/// What a table makes of a scene.
fn films(passes: &'static [Pass], scene: &Value) -> [Film; 2] {
    both(&prepare_by(passes, scene)).map(|rendered| rendered.film)
}

#[test]
fn a_need_taken_out_of_the_table_is_missed() {
    let folder = folder();
    put_texture(folder.path());
    let mut needs = 0;
    for pass in PASSES {
        for effect in pass.effects() {
            let json = scene_of(effect, pass.needs, folder.path());
            let [right, _] = films(&PASSES, &json);
            let what = format!("{}: {}", pass.step.name(), effect.name());
            // In this row alone; then in all.
            for is_alone in [true, false] {
                let is_changed = |other: &Pass| !is_alone || other.step == pass.step;
                let found = films(table(is_changed, |needs| without(needs, effect)), &json);
                let is_missed = found.iter().all(|film| !film.same_bits(&right));
                assert!(is_missed, "{what} is not missed, alone: {is_alone}");
            }
            needs += 1;
        }
    }
    assert_eq!(needs, 26);
}

/// What a scene costs that shows nothing of it.
fn cost(scene: &PreparedScene, rendered: &Rendered) -> [u64; 8] {
    let c = &rendered.counters;
    let (columns, appearance) = (rendered.columns, scene.appearance.bytes());
    let SampleCounts { lens, light, colors, texels, footprints, .. } = c.samples;
    [lens, light, colors, texels, footprints, c.rays.secondary, columns, appearance]
}

#[test]
fn a_row_that_runs_without_need_costs_something_and_shows_nothing() {
    let folder = folder();
    let list = price_list(folder.path());
    let rendered_by = |passes: &'static [Pass], scene: &Value| {
        let scene = prepare_by(passes, scene);
        both_alone(&scene).map(|rendered| (cost(&scene, &rendered), rendered.film))
    };
    let planned: Vec<_> = list.iter().map(|variant| rendered_by(&PASSES, &variant.scene)).collect();
    for pass in PASSES.into_iter().filter(|pass| !pass.needs.is_empty()) {
        // With those that serve one of its effects.
        let serves = |effect| pass.effects().any(|own| own == effect);
        let passes = table(|other| other.effects().any(serves), |_| &[]);
        let mut dearer = 0;
        for (variant, planned) in list.iter().zip(&planned) {
            let found = rendered_by(passes, &variant.scene);
            for ((cost, film), (usual, right)) in found.iter().zip(planned) {
                let what = format!("{}, {}", pass.step.name(), variant.name);
                assert!(film.same_bits(right), "{what}");
                assert!(cost.iter().zip(usual).all(|(cost, usual)| cost >= usual), "{what}");
                dearer += usize::from(cost != usual);
            }
        }
        // A grid of one ray a pixel is the ray through its centre, which draws no number; and what emits no
        // light has no other row.
        let is_free = ["jitter", "emission"].contains(&pass.step.name());
        assert_eq!(dearer == 0, is_free, "{}", pass.step.name());
    }
}
