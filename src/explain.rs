//! `explain`: the plan of a render, and on request the counts of the render.

mod text;

use std::path::PathBuf;
use std::time::Instant;

use glam::DVec3;
use serde::Serialize;
use serde_json::{Value, json};

use super::common::{Extent, SceneOptions, grouped, known, print, to_json, warn, whole};
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::plan::schedule::{Column, PASSES, Pass};
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

/// The plan of a render, and what is known of it before and after.
struct Explanation<'a> {
    scene: &'a PreparedScene,
    precision: Precision,
    bvh: Choice,
    /// The numbers of chunks of the tree that rays of the pilot built, and of all.
    chunks: Option<[usize; 2]>,
    /// The estimates before a mesh or a texture is read, and after.
    memory: [Estimate; 2],
    /// Upper bounds on the work of the render.
    estimated: Estimated,
    /// The expectation from a pilot.
    expected: Expected,
    /// Seconds measured, without those in which rays build.
    load: f64,
    build: f64,
    /// The render, if requested.
    rendered: Option<Rendered>,
}

/// The preset and the reason.
struct Choice {
    preset: Preset,
    reason: String,
    /// The rule by rays per primitive; `None` for a requested preset.
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
        explain(extracted, estimated, start, args)
    })
}

fn explain(
    extracted: Extracted,
    estimated: Estimate,
    start: Instant,
    args: &ExplainArgs,
) -> Result<()> {
    let load = start.elapsed().as_secs_f64();
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
    let explanation = Explanation {
        scene,
        precision: args.scene_options.precision,
        bvh,
        chunks,
        memory: [estimated, memory],
        estimated: Estimated::of(scene, pixels),
        expected,
        load,
        build,
        rendered: args.render.then(|| render(scene, &options, &())).transpose()?,
    };
    print(&if args.json { to_json(&explanation.json())? } else { text::of(&explanation) })
}

impl Explanation<'_> {
    fn json(&self) -> Value {
        let Self { scene, bvh, expected, .. } = self;
        let pass = |pass: &Pass| {
            known(json!({
                "name": pass.name,
                "part_of": pass.part_of.map(|whole| PASSES[whole as usize].name),
                "runs": scene.plan.schedule().runs(pass.step),
                "reason": scene.plan.reason(pass),
            }))
        };
        let counted = |Rendered { counters, columns, .. }: &Rendered| {
            json!({
                "rays": Rays::from(counters),
                "samples": Samples::from(counters),
                "tree": scene.accel.tree_bytes(),
                "batches": columns,
                "peak": memory::peak(),
            })
        };
        let [before, after] = &self.memory;
        let (preset, reason, rule) = (bvh.preset, &bvh.reason, &bvh.rule);
        known(json!({
            "passes": PASSES.iter().map(pass).collect::<Vec<_>>(),
            "plan": scene.plan,
            "precision": self.precision,
            "moved_by": self.moved_by(),
            "bvh": known(json!({ "preset": preset, "reason": reason, "rule": rule })),
            "chunks": self.chunks,
            "bytes_per_path": buffers(scene),
            "estimated_memory": before,
            "estimated_total": before.total(),
            "memory": after,
            "memory_total": after.total(),
            "estimated": self.estimated,
            "expected": expected,
            "time": {
                "threads": rayon::current_num_threads(),
                "load": self.load,
                "build": self.build + expected.building,
                "trace": expected.seconds,
            },
            "rendered": self.rendered.as_ref().map(counted),
        }))
    }

    /// The offset of the scene towards the origin, if any.
    fn moved_by(&self) -> Option<[f64; 3]> {
        let origin = self.scene.origin;
        (origin != DVec3::ZERO).then(|| (-origin).to_array())
    }
}

fn buffers(scene: &PreparedScene) -> Vec<Buffer> {
    let held = Batch::bytes_per_path(scene);
    let buffer = |column: Column| {
        let name = column.name();
        let by = |columns: fn(&Pass) -> &'static [Column]| {
            let passes = PASSES.iter().filter(|pass| columns(pass).contains(&column));
            passes.map(|pass| pass.name).collect()
        };
        Buffer {
            name,
            bytes: held.iter().find(|(held, _)| *held == name).map_or(0, |(_, bytes)| *bytes),
            written_by: by(|pass| pass.writes),
            read_by: by(|pass| pass.reads),
        }
    };
    Column::ALL.into_iter().map(buffer).collect()
}

fn choice(extracted: &Extracted, asked: Option<Preset>) -> Choice {
    if let Some(preset) = asked {
        return Choice { preset, reason: "chosen with --bvh".to_owned(), rule: None };
    }
    let (primitives, rays) = (extracted.geometry().held() as u64, extracted.expected_rays());
    let some = match primitives {
        1 => "1 primitive".to_owned(),
        n => format!("{} primitives", grouped(n)),
    };
    Choice {
        preset: extracted.preset(),
        reason: format!("{some}, up to {} rays", grouped(rays)),
        rule: Some(Preset::reason(primitives, rays)),
    }
}
