//! `bench --effects`: the price list of the effects.

use std::path::Path;

use super::{BenchArgs, ROUNDS};
use crate::common::{Extent, SearchOptions, print, tell, to_json, with_bar, write_text};
use wavecrest_base::error::{Error, Result};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::render::render;
use wavecrest_report::effects::scenes::{Variant, variants};
use wavecrest_report::effects::{Entry, Setting, measure, text};
use wavecrest_scene::load::{LoadOptions, load_str};

/// Measures every effect, prints the results, and returns whether all images were right.
pub(super) fn run(args: &BenchArgs) -> Result<bool> {
    let folder = tempfile::tempdir().map_err(|e| {
        Error::io("cannot create a folder for the texture", std::env::temp_dir(), e)
    })?;
    let variants = variants(folder.path())?.into_iter();
    let entries: Vec<Entry> =
        variants.map(|variant| prepare(args, variant, folder.path())).collect::<Result<_>>()?;
    let SearchOptions { simd, kernel } = args.search;
    let precision = args.scene_options.precision;
    let setting = Setting { simd, kernel, precision, batch: args.batch as usize };
    let trace = |scene: &_, tracer| render(scene, &args.options(tracer), &());
    let list = with_bar(args.scene_options.quiet, ROUNDS, |progress| {
        measure(&entries, setting, &args.schedule(), trace, progress)
    })?;
    if let Some(differs) = &list.difference {
        tell(&format!("error: {}: the image or the ray counts are wrong", differs.label));
    }
    let json = to_json(&list)?;
    if let Some(file) = &args.output {
        write_text(file, &json)?;
    }
    print(&if args.json { json } else { text(&list) })?;
    Ok(list.difference.is_none())
}

fn prepare(args: &BenchArgs, variant: Variant, folder: &Path) -> Result<Entry> {
    let (width, height) = (args.scene_options.input.width, args.scene_options.input.height);
    let options = LoadOptions { strict: true, width, height, ..LoadOptions::default() };
    // Warnings would be about built-in scenes.
    let loaded = load_str(&variant.scene.to_string(), &folder.join("effect.json"), &options)?;
    let extracted = args.scene_options.extract(loaded, &Extent::whole(args.batch))?;
    extracted.scene().appearance.decode()?;
    // The same for all, so that no effect has a better tree.
    let preset = args.scene_options.bvh.unwrap_or(Preset::Medium);
    let mut scene = args.scene_options.build(extracted, preset)?;
    args.search.apply(&mut scene.accel);
    Ok(Entry { variant, scene })
}
