//! `explain`: the plan of a render, without rendering.

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::DVec3;
use serde::Serialize;

use super::common::{SceneOptions, print, to_json};
use crate::accel::build::Preset;
use crate::error::Result;
use crate::kernels::precision::Precision;
use crate::memory::{self, Prediction};
use crate::plan::{Plan, schedule};
use crate::prepared::PreparedScene;
use crate::systems::{self, Extracted};
use crate::wavefront::DEFAULT_BATCH;
use crate::wavefront::batch::Batch;

/// Says which passes a render runs, why the others are left out, and what it will need.
#[derive(Clone, Debug, clap::Args)]
pub struct ExplainArgs {
    /// The scene, in JSON
    pub scene: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Paths in a batch of the wavefront
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub batch: u32,
    /// What is read and how
    #[command(flatten)]
    pub scene_options: SceneOptions,
}

/// What is printed.
#[derive(Serialize)]
struct Explanation {
    passes: Vec<Pass>,
    plan: Plan,
    precision: Precision,
    /// How far the scene is moved towards the origin, if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    moved_by: Option<[f64; 3]>,
    bvh: Choice,
    bytes_per_path: Vec<Column>,
    memory: Prediction,
    memory_total: u64,
}

/// A pass, and whether it runs.
#[derive(Serialize)]
struct Pass {
    name: &'static str,
    /// The pass that it is a part of, unless it is a whole one.
    #[serde(skip_serializing_if = "Option::is_none")]
    part_of: Option<&'static str>,
    runs: bool,
    reason: String,
}

/// The preset and why.
#[derive(Serialize)]
struct Choice {
    preset: Preset,
    reason: String,
    /// What the rays for each primitive make of it, unless it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    rule: Option<String>,
}

/// A group of columns.
#[derive(Serialize)]
struct Column {
    name: &'static str,
    bytes: usize,
}

/// Explains as the arguments say.
///
/// # Errors
/// When the scene cannot be rendered.
pub fn run(args: &ExplainArgs) -> Result<()> {
    args.scene_options.threads.run(|| {
        let loaded = args.scene_options.load(&args.scene)?;
        let extracted = args.scene_options.extract(loaded)?;
        let warnings = systems::warnings(extracted.dropped(), extracted.file());
        args.scene_options.warn(&warnings);
        let explanation = explain(&extracted, args);
        print(&if args.json { to_json(&explanation)? } else { text(&explanation) })
    })
}

fn explain(extracted: &Extracted, args: &ExplainArgs) -> Explanation {
    let scene = extracted.scene();
    let bvh = choice(extracted, args.scene_options.bvh);
    let memory = memory::predict(extracted, extracted.pixels(), bvh.preset, args.batch as usize);
    let columns = Batch::bytes_per_path(scene);
    Explanation {
        passes: passes(scene),
        plan: scene.plan.clone(),
        precision: args.scene_options.precision,
        moved_by: (scene.origin != DVec3::ZERO).then(|| (-scene.origin).to_array()),
        bytes_per_path: columns.into_iter().map(|(name, bytes)| Column { name, bytes }).collect(),
        memory_total: memory.total(),
        memory,
        bvh,
    }
}

fn choice(extracted: &Extracted, asked: Option<Preset>) -> Choice {
    match asked {
        Some(preset) => Choice { preset, reason: "asked for".to_owned(), rule: None },
        None => {
            let (primitives, rays) = (extracted.geometry().len() as u64, extracted.expected_rays());
            Choice {
                preset: extracted.preset(),
                reason: format!("{primitives} primitives, up to {rays} rays"),
                rule: Some(Preset::reason(primitives, rays)),
            }
        }
    }
}

fn passes(scene: &PreparedScene) -> Vec<Pass> {
    let row = |pass: &schedule::Pass| Pass {
        name: pass.name,
        part_of: pass.part_of.map(|whole| schedule::PASSES[whole as usize].name),
        runs: scene.plan.schedule().runs(pass.step),
        reason: scene.plan.reason(pass),
    };
    schedule::PASSES.iter().map(row).collect()
}

fn text(e: &Explanation) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "passes");
    for pass in &e.passes {
        let name = format!("{}{}", if pass.part_of.is_some() { "  " } else { "" }, pass.name);
        let _ = writeln!(text, "  {} {name:<16}{}", mark(pass.runs), pass.reason);
    }
    let _ = writeln!(text, "effects");
    for decision in e.plan.decisions() {
        let name = decision.effect.name();
        let _ = writeln!(text, "  {} {name:<16}{}", mark(decision.present), decision.reason);
    }
    let precision = e.precision;
    let _ = writeln!(text, "precision\n    {:<16}{}", precision.name(), precision.meaning());
    if let Some([x, y, z]) = e.moved_by {
        let _ = writeln!(text, "    {:<16}moved by {x}, {y}, {z} towards the camera", "");
    }
    let _ = writeln!(text, "bvh\n    {:<16}{}", e.bvh.preset.name(), e.bvh.reason);
    if let Some(rule) = &e.bvh.rule {
        let _ = writeln!(text, "    {:<16}{rule}", "");
    }
    let _ = writeln!(text, "bytes for each path");
    for column in &e.bytes_per_path {
        let _ = writeln!(text, "    {:<16}{:>6}", column.name, column.bytes);
    }
    let all: usize = e.bytes_per_path.iter().map(|c| c.bytes).sum();
    let _ = writeln!(text, "    {:<16}{all:>6}", "together");
    let _ = writeln!(text, "memory predicted");
    let m = &e.memory;
    let uses = [
        ("geometry", m.geometry),
        ("looks", m.looks),
        ("tree", m.tree),
        ("building it", m.build),
        ("film", m.film),
        ("batches", m.batches),
        ("program", m.program),
        ("reading", m.so_far),
        ("peak", e.memory_total),
    ];
    for (name, bytes) in uses {
        let _ = writeln!(text, "    {name:<16}{:>10.1} MB", bytes as f64 / 1e6);
    }
    text
}

fn mark(present: bool) -> char {
    if present { '+' } else { '-' }
}
