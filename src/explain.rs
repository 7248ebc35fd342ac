//! `explain`: the plan of a render, and on request the counts of the render.

mod text;

use std::path::PathBuf;
use std::time::Instant;

use glam::DVec3;
use serde::Serialize;

use super::common::{Extent, SceneOptions, grouped, print, to_json, warn, whole};
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
use wavecrest_report::expected::Expected;
use wavecrest_report::statistics::{Rays, Samples};
use wavecrest_scene::memory::{self, Estimate};
use wavecrest_scene::systems::{self, Extracted};

/// Explain which passes a render runs and why, and estimate its rays, memory and time.
///
/// With `--render`, render the scene and print the counts beside the estimates.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExplainArgs {
    /// Scene (.json), glTF file (.gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Render the scene without writing an image, and print the counts beside the estimates
    #[arg(long)]
    pub(crate) render: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Paths in a batch of the wavefront tracer
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = whole(1..=1_u32 << 20))]
    pub(crate) batch: u32,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

/// The output.
#[derive(Serialize)]
struct Explanation {
    passes: Vec<Pass>,
    plan: Plan,
    precision: Precision,
    /// The offset of the scene towards the origin, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    moved_by: Option<[f64; 3]>,
    bvh: Choice,
    /// The numbers of chunks of the tree that rays of the pilot built, and of all.
    #[serde(skip_serializing_if = "Option::is_none")]
    chunks: Option<[usize; 2]>,
    bytes_per_path: Vec<Buffer>,
    /// The estimate before a mesh or a texture is read.
    estimated_memory: Estimate,
    estimated_total: u64,
    memory: Estimate,
    memory_total: u64,
    /// Upper bounds on the work of the render.
    estimated: Estimated,
    /// The expectation from a pilot.
    expected: Expected,
    time: Time,
    /// The counts, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    rendered: Option<Found>,
}

/// Seconds: measured for reading and building, expected for tracing and for what rays build.
#[derive(Serialize)]
struct Time {
    threads: usize,
    load: f64,
    build: f64,
    trace: f64,
}

/// The counts of a render.
#[derive(Serialize)]
struct Found {
    rays: Rays,
    samples: Samples,
    /// Bytes of the tree, and of the batches of all threads.
    tree: u64,
    batches: u64,
    /// Peak bytes of the process, if the system reports them.
    peak: Option<u64>,
}

/// A pass, and whether it runs.
#[derive(Serialize)]
struct Pass {
    name: &'static str,
    /// The pass that it is a part of; `None` for whole passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    part_of: Option<&'static str>,
    runs: bool,
    reason: String,
}

/// The preset and the reason.
#[derive(Serialize)]
struct Choice {
    preset: Preset,
    reason: String,
    /// The rule by rays per primitive; `None` for a requested preset.
    #[serde(skip_serializing_if = "Option::is_none")]
    rule: Option<String>,
}

/// A group of columns of the wavefront's batch.
#[derive(Serialize)]
struct Buffer {
    name: &'static str,
    /// For each path; 0 without storage.
    bytes: usize,
    /// The passes and parts of passes that write it, and those that read it, whether or not they
    /// run.
    written_by: Vec<&'static str>,
    read_by: Vec<&'static str>,
}

/// Runs the explanation.
///
/// # Errors
/// If the scene cannot be rendered.
pub(crate) fn run(args: &ExplainArgs) -> Result<()> {
    args.scene_options.threads.run(|| {
        let extent = &Extent::whole(args.batch);
        let estimated = args.scene_options.estimate(&args.scene, extent)?;
        let start = Instant::now();
        let loaded = args.scene_options.load(&args.scene, extent, &[])?;
        let extracted = args.scene_options.extract(loaded, extent)?;
        let load = start.elapsed().as_secs_f64();
        let explanation = explain(extracted, estimated, load, args)?;
        print(&if args.json { to_json(&explanation)? } else { text::of(&explanation) })
    })
}

fn explain(
    extracted: Extracted,
    estimated: Estimate,
    load: f64,
    args: &ExplainArgs,
) -> Result<Explanation> {
    let bvh = choice(&extracted, args.scene_options.bvh);
    let batch = args.batch as usize;
    let memory = memory::estimate_extracted(&extracted, extracted.pixels(), bvh.preset, batch);
    let start = Instant::now();
    let (pixels, file) = (extracted.pixels(), extracted.file().to_owned());
    let scene = &args.scene_options.build(extracted, bvh.preset)?;
    let build = start.elapsed().as_secs_f64();
    warn(&systems::warnings(scene, &file));
    let options = RenderOptions { batch, ..RenderOptions::default() };
    let expected = Expected::of(scene, &options)?;
    let chunks = scene.accel.chunks();
    let memory = chunks.map_or(memory, |_| memory.with_tree(scene.accel.tree_bytes()));
    let threads = rayon::current_num_threads();
    Ok(Explanation {
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
        estimated: Estimated::of(scene, pixels),
        time: Time { threads, load, build: build + expected.building, trace: expected.seconds },
        expected,
        rendered: if args.render { Some(trace(scene, &options)?) } else { None },
        chunks,
    })
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

/// Renders the scene and returns the counts.
fn trace(scene: &PreparedScene, options: &RenderOptions) -> Result<Found> {
    let Rendered { counters, columns, .. } = render(scene, options, &())?;
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
        Some(preset) => Choice { preset, reason: "chosen with --bvh".to_owned(), rule: None },
        None => {
            let (primitives, rays) =
                (extracted.geometry().held() as u64, extracted.expected_rays());
            Choice {
                preset: extracted.preset(),
                reason: match (primitives, grouped(rays)) {
                    (1, rays) => format!("1 primitive, up to {rays} rays"),
                    (n, rays) => format!("{} primitives, up to {rays} rays", grouped(n)),
                },
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
