//! `explain`: the plan of a render, and on demand what the render then did.

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::DVec3;
use serde::Serialize;

use super::common::{SceneOptions, print, to_json};
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::plan::Plan;
use wavecrest_core::plan::schedule::{self, Column, PASSES};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, render};
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_core::wavefront::batch::Batch;
use wavecrest_report::estimate::Estimated;
use wavecrest_report::statistics::{Rays, Samples};
use wavecrest_scene::memory::{self, Estimate};
use wavecrest_scene::systems::{self, Extracted};

/// Says which passes a render runs, why the others are left out, and what it will need.
///
/// With `--render` the scene is rendered, and the estimates are printed beside what was counted.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExplainArgs {
    /// The scene, in JSON
    pub(crate) scene: PathBuf,
    /// Render the scene, keep no image, and print the counts beside the estimates
    #[arg(long)]
    pub(crate) render: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Paths in a batch of the wavefront
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) batch: u32,
    /// What is read and how
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
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
    bytes_per_path: Vec<Buffer>,
    /// As it was estimated before a mesh or a texture was read.
    estimated_memory: Estimate,
    estimated_total: u64,
    memory: Estimate,
    memory_total: u64,
    /// What the render will do at most.
    estimated: Estimated,
    /// What it did, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    rendered: Option<Found>,
}

/// What a render did.
#[derive(Serialize)]
struct Found {
    rays: Rays,
    samples: Samples,
    /// Bytes of the tree, and of the batches of all threads.
    tree: u64,
    batches: u64,
    /// Bytes that the process held at its peak, where the system reports them.
    peak: Option<u64>,
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

/// A group of columns of the wavefront's batch.
#[derive(Serialize)]
struct Buffer {
    name: &'static str,
    /// For each path; 0 where it has no storage.
    bytes: usize,
    /// The passes and parts of passes that write it, and those that read it, whether or not they run.
    written_by: Vec<&'static str>,
    read_by: Vec<&'static str>,
}

/// Explains as the arguments say.
///
/// # Errors
/// When the scene cannot be rendered.
pub(crate) fn run(args: &ExplainArgs) -> Result<()> {
    args.scene_options.threads.run(|| {
        let estimated = args.scene_options.estimate(&args.scene, None, args.batch as usize)?;
        let loaded = args.scene_options.load(&args.scene)?;
        let extracted = args.scene_options.extract(loaded)?;
        let warnings = systems::warnings(extracted.dropped(), extracted.file());
        args.scene_options.warn(&warnings);
        let mut explanation = explain(&extracted, estimated, args);
        if args.render {
            explanation.rendered = Some(trace(extracted, explanation.bvh.preset, args)?);
        }
        print(&if args.json { to_json(&explanation)? } else { text(&explanation) })
    })
}

fn explain(extracted: &Extracted, estimated: Estimate, args: &ExplainArgs) -> Explanation {
    let scene = extracted.scene();
    let bvh = choice(extracted, args.scene_options.bvh);
    let memory =
        memory::estimate_extracted(extracted, extracted.pixels(), bvh.preset, args.batch as usize);
    Explanation {
        passes: passes(scene),
        plan: scene.plan.clone(),
        precision: args.scene_options.precision,
        moved_by: (scene.origin != DVec3::ZERO).then(|| (-scene.origin).to_array()),
        bytes_per_path: Column::ALL.into_iter().map(|column| buffer(scene, column)).collect(),
        estimated_total: estimated.total(),
        estimated_memory: estimated,
        memory_total: memory.total(),
        memory,
        bvh,
        estimated: Estimated::of(scene, extracted.pixels()),
        rendered: None,
    }
}

fn buffer(scene: &PreparedScene, column: Column) -> Buffer {
    let name = column.name();
    let held = Batch::bytes_per_path(scene).into_iter().find(|(held, _)| *held == name);
    let by = |columns: fn(&schedule::Pass) -> &'static [Column]| {
        let passes = PASSES.iter().filter(|pass| columns(pass).contains(&column));
        passes.map(|pass| pass.name).collect()
    };
    Buffer {
        name,
        bytes: held.map_or(0, |(_, bytes)| bytes),
        written_by: by(|pass| pass.writes),
        read_by: by(|pass| pass.reads),
    }
}

/// Renders the scene and says what was done.
fn trace(extracted: Extracted, preset: Preset, args: &ExplainArgs) -> Result<Found> {
    let scene = extracted.build(preset);
    let options = RenderOptions { batch: args.batch as usize, ..RenderOptions::default() };
    let Rendered { counters, columns, .. } = render(&scene, &options, &())?;
    Ok(Found {
        rays: (&counters).into(),
        samples: (&counters).into(),
        tree: scene.accel.tree_bytes(),
        batches: columns,
        peak: memory::peak(),
    })
}

fn choice(extracted: &Extracted, asked: Option<Preset>) -> Choice {
    match asked {
        Some(preset) => Choice { preset, reason: "asked for".to_owned(), rule: None },
        None => {
            let (primitives, rays) =
                (extracted.geometry().held() as u64, extracted.expected_rays());
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
        part_of: pass.part_of.map(|whole| PASSES[whole as usize].name),
        runs: scene.plan.schedule().runs(pass.step),
        reason: scene.plan.reason(pass),
    };
    PASSES.iter().map(row).collect()
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
        let name = format!("{} ", decision.effect.name());
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
    text += &buffers(&e.bytes_per_path);
    text += &work(&e.estimated, e.rendered.as_ref());
    text += &memory_text(e);
    text
}

fn buffers(buffers: &[Buffer]) -> String {
    let mut text = "bytes for each path\n".to_owned();
    for Buffer { name, bytes, written_by, read_by } in buffers {
        let (written, read) = (written_by.join(", "), read_by.join(", "));
        let mark = mark(*bytes > 0);
        let _ = writeln!(text, "  {mark} {name:<16}{bytes:>6}  from {written} to {read}");
    }
    let all: usize = buffers.iter().map(|c| c.bytes).sum();
    let _ = writeln!(text, "    {:<16}{all:>6}", "together");
    text
}

/// What is estimated, beside what was counted if it was.
fn work(estimated: &Estimated, found: Option<&Found>) -> String {
    let rows = |rays: &Rays, samples: &Samples| {
        [
            ("camera rays", rays.primary),
            ("mirror rays", rays.secondary),
            ("shadow rays", rays.shadow),
            ("lens numbers", samples.lens),
            ("light numbers", samples.light),
            ("texels", samples.texels),
        ]
    };
    let counted = found.map(|found| rows(&found.rays, &found.samples));
    let title = if counted.is_some() { "           counted" } else { "" };
    let mut text = format!("work{:>32}{title}\n", "at most");
    for (index, (name, most)) in rows(&estimated.rays, &estimated.samples).into_iter().enumerate() {
        let _ = write!(text, "    {name:<16}{most:>16}");
        if let Some(counted) = counted {
            let _ = write!(text, "  {:>16}", counted[index].1);
        }
        text.push('\n');
    }
    text
}

fn memory_text(e: &Explanation) -> String {
    let m = &e.memory;
    let found = e.rendered.as_ref();
    let f = &e.estimated_memory;
    let uses = [
        ("geometry", f.geometry, m.geometry, None),
        ("appearance", f.appearance, m.appearance, None),
        ("tree", f.tree, m.tree, found.map(|found| found.tree)),
        ("building it", f.build, m.build, None),
        ("film", f.film, m.film, None),
        ("batches", f.batches, m.batches, found.map(|found| found.batches)),
        ("program", f.program, m.program, None),
        ("reading", f.loading, m.loading, None),
        ("peak", e.estimated_total, e.memory_total, found.and_then(|found| found.peak)),
    ];
    let title = if found.is_some() { "          measured" } else { "" };
    let mut text = format!("memory{:>30}{:>18}{title}\n", "before reading", "once read");
    for (name, before, bytes, measured) in uses {
        let megabytes = |bytes: u64| bytes as f64 / 1e6;
        let _ = write!(text, "    {name:<16}{:>13.3} MB", megabytes(before));
        let _ = write!(text, "{:>15.3} MB", megabytes(bytes));
        if let Some(measured) = measured {
            let _ = write!(text, "{:>15.3} MB", megabytes(measured));
        }
        text.push('\n');
    }
    text
}

fn mark(present: bool) -> char {
    if present { '+' } else { '-' }
}
