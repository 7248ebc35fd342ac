//! `explain`: the plan of a render, and on request the counts of the render.

use std::path::PathBuf;
use std::time::Instant;

use glam::DVec3;
use serde::Serialize;
use serde_json::{Value, json};

use super::common::{grouped, known, print, rounded, seconds, to_json, whole};
use super::input::SceneOptions;
use wavecrest_api::session::Session;
use wavecrest_base::error::Result;
use wavecrest_base::memory;
use wavecrest_base::words::{Size, counted};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::{RayCounts, SampleCounts};
use wavecrest_core::plan::Plan;
use wavecrest_core::plan::schedule::{ColumnGroup, PASSES, Pass, Step};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, render};
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_core::wavefront::batch::Batch;
use wavecrest_report::expected::Expected;

/// Explain which passes a render runs and why, measure its memory once prepared, and estimate its rays and time.
///
/// With `--render`, render the scene and print the counts and the time beside the estimates.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExplainArgs {
    /// Scene (.json), glTF file (.gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Render the scene without writing an image, and print the counts and the time beside the estimates
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
    bvh: BvhChoice,
    /// The numbers of chunks of the tree that rays of the pilot built, and of all.
    chunks: Option<[usize; 2]>,
    /// What is measured after the pilot.
    memory: PreparedMemory,
    /// The expectation from a pilot.
    expected: Expected,
    /// Seconds measured, without those in which rays build.
    load: f64,
    build: f64,
    /// The render, if requested.
    rendered: Option<Rendered>,
}

/// The preset and the reason.
#[derive(Serialize)]
struct BvhChoice {
    preset: Preset,
    reason: String,
}

/// Bytes of a scene after a pilot has done what most of its rays do.
#[derive(Serialize)]
struct PreparedMemory {
    /// Positions, indices, spheres.
    geometry: u64,
    /// Mesh attributes and decoded textures.
    appearance: u64,
    tree: u64,
    /// The columns of the pilot's batches.
    batches: u64,
    /// Of the whole process, at that time and before, if the system reports it.
    held: Option<u64>,
    peak: Option<u64>,
}

/// A group of columns of the wavefront's batch.
#[derive(Serialize)]
struct ColumnMemory {
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
        let start = Instant::now();
        let options = args.scene_options.preparing(None);
        let session = args.scene_options.session(&args.scene, &options, |_| Ok(()))?;
        let (scene, build) = (&session.scene, session.seconds[1]);
        let load = start.elapsed().as_secs_f64() - build;
        let bvh = choice(&session, args.scene_options.bvh);
        let options = RenderOptions { batch: args.batch as usize, ..RenderOptions::default() };
        let expected = Expected::of(scene, &options)?;
        let process = memory::process();
        let memory = PreparedMemory {
            geometry: scene.accel.geometry().bytes(),
            appearance: scene.appearance.bytes(),
            tree: scene.accel.tree_bytes(),
            batches: expected.columns,
            held: process.map(|[held, _]| held),
            peak: process.map(|[_, peak]| peak),
        };
        let explanation = Explanation {
            scene,
            bvh,
            chunks: scene.accel.chunks(),
            memory,
            expected,
            load,
            build,
            rendered: args.render.then(|| render(scene, &options, &())).transpose()?,
        };
        print(&if args.json { to_json(&explanation.json())? } else { text(&explanation) })
    })
}

impl Explanation<'_> {
    fn json(&self) -> Value {
        let Self { scene, bvh, expected, .. } = self;
        let counted = |Rendered { counters, columns, seconds, .. }: &Rendered| {
            json!({
                "rays": counters.rays,
                "samples": counters.samples,
                "tree": scene.accel.tree_bytes(),
                "batches": columns,
                "peak": memory::peak(),
                "seconds": seconds,
            })
        };
        known(json!({
            "passes": passes(&scene.plan),
            "plan": scene.plan,
            "precision": scene.accel.geometry().precision,
            "moved_by": self.moved_by(),
            "bvh": bvh,
            "chunks": self.chunks,
            "bytes_per_path": buffers(scene),
            "memory": self.memory,
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

/// The passes, with whether and why they run.
pub(crate) fn passes(plan: &Plan) -> Vec<Value> {
    let pass = |pass: &Pass| {
        known(json!({
            "name": pass.step.name(),
            "part_of": pass.part_of.map(|whole| whole.name()),
            "runs": plan.schedule().runs(pass.step),
            "reason": plan.reason(pass),
        }))
    };
    PASSES.iter().map(pass).collect()
}

fn buffers(scene: &PreparedScene) -> Vec<ColumnMemory> {
    let held = Batch::bytes_per_path(scene);
    let buffer = |column: ColumnGroup| {
        let name = column.name();
        let by = |columns: fn(&Pass) -> &'static [ColumnGroup]| {
            let passes = PASSES.iter().filter(|pass| columns(pass).contains(&column));
            passes.map(|pass| pass.step.name()).collect()
        };
        ColumnMemory {
            name,
            bytes: held.iter().find(|(held, _)| *held == name).map_or(0, |(_, bytes)| *bytes),
            written_by: by(|pass| pass.writes),
            read_by: by(|pass| pass.reads),
        }
    };
    ColumnGroup::ALL.into_iter().map(buffer).collect()
}

fn choice(Session { scene, preset, .. }: &Session, requested: Option<Preset>) -> BvhChoice {
    if let Some(preset) = requested {
        return BvhChoice { preset, reason: "chosen with --bvh".to_owned() };
    }
    let (primitives, rays) = (scene.accel.geometry().held() as u64, scene.expected_rays());
    let plural = if primitives == 1 { "" } else { "s" };
    let reason = format!("{} primitive{plural}, up to {} rays", grouped(primitives), grouped(rays));
    BvhChoice { preset: *preset, reason }
}

/// The width of the column of names.
const NAMES: usize = 20;

/// The whole text, the estimate first.
fn text(e: &Explanation<'_>) -> String {
    let mut text = verdict(e) + "passes (+ runs, - skipped)\n";
    let plan = &e.scene.plan;
    for pass in &PASSES {
        let name =
            format!("{}{}", if pass.part_of.is_some() { "  " } else { "" }, pass.step.name());
        let (mut reason, share) = (plan.reason(pass), 100.0 * e.expected.maps);
        if pass.step == Step::Shade && share > 0.0 {
            reason += &format!("; for maps and light that passes: about {share:.0} % of tracing");
        }
        text += &marked(plan.schedule().runs(pass.step), &name, &reason);
    }
    text += "effects (+ simulated, - skipped)\n";
    for decision in plan.decisions() {
        text += &marked(decision.present, decision.effect.name(), &decision.reason.to_string());
    }
    text += "precision\n";
    let precision = e.scene.accel.geometry().precision;
    text += &named(precision.name(), precision.meaning());
    if let Some([x, y, z]) = e.moved_by() {
        text += &named("", &format!("scene moved by {x}, {y}, {z} towards the origin"));
    }
    text += "BVH\n";
    text += &named(e.bvh.preset.name(), &e.bvh.reason);
    if let Some([built, all]) = e.chunks.map(|chunks| chunks.map(|n| grouped(n as u64))) {
        text += &named("", &format!("{built} of {all} chunks built"));
    }
    text += "buffers of the wavefront tracer, in bytes per path\n";
    let buffers = buffers(e.scene);
    for ColumnMemory { name, bytes, written_by, read_by } in &buffers {
        let (written, read) = (written_by.join(", "), read_by.join(", "));
        let by = format!("{bytes:>6}  written by {written}; read by {read}");
        let unused = format!("{bytes:>6}  not needed");
        text += &marked(*bytes > 0, name, if *bytes > 0 { &by } else { &unused });
    }
    let all: usize = buffers.iter().map(|buffer| buffer.bytes).sum();
    text + &named("total", &format!("{all:>6}")) + &work(e) + &memory_text(e)
}

fn named(name: &str, text: &str) -> String {
    format!("    {name:<NAMES$}{text}\n")
}

fn marked(present: bool, name: &str, text: &str) -> String {
    format!("  {} {name:<NAMES$}{text}\n", if present { '+' } else { '-' })
}

/// The expected time and rays, and the memory.
fn verdict(e: &Explanation<'_>) -> String {
    let (build, trace) = (e.build + e.expected.building, e.expected.seconds);
    let time = seconds(e.load + build + trace);
    let parts = [("read", e.load), ("build", build), ("trace", trace)];
    let parts = parts.map(|(what, of_it)| format!("{} s to {what}", seconds(of_it))).join(", ");
    let threads = counted(rayon::current_num_threads() as u64, "thread");
    let RayCounts { primary, secondary, shadow } = e.expected.rays;
    let about = |n: u64| grouped(rounded(n as f64, 3) as u64);
    let kinds = [(primary, "camera"), (secondary, "secondary"), (shadow, "shadow")];
    let kinds = kinds.into_iter().filter(|(n, _)| *n > 0);
    let kinds: Vec<_> = kinds.map(|(n, kind)| format!("{} {kind}", about(n))).collect();
    let (all, kinds) = (about(e.expected.rays.all()), kinds.join(", "));
    let memory = match (e.memory.held, e.memory.peak) {
        (Some(held), Some(peak)) => {
            format!("about {} of memory once prepared, {} at the peak\n", Size(held), Size(peak))
        }
        _ => String::new(),
    };
    format!("about {time} s on {threads}: {parts}\nabout {all} rays: {kinds}\n{memory}")
}

/// A row of a table: an estimate, and what was found of a render.
fn row(name: &str, estimate: &str, found: Option<&str>) -> String {
    let found = found.map_or_else(String::new, |found| format!("{found:>18}"));
    format!("{name:<24}{estimate:>16}{found}\n")
}

/// Estimates, with counts beside them if there are any.
fn work(e: &Explanation<'_>) -> String {
    const NAMES: [&str; 6] = [
        "    camera rays",
        "    secondary rays",
        "    shadow rays",
        "    points on the lens",
        "    points on lights",
        "    texels read",
    ];
    let counts = |rays: &RayCounts, samples: &SampleCounts| {
        let RayCounts { primary, secondary, shadow } = *rays;
        [primary, secondary, shadow, samples.lens, samples.light, samples.texels].map(grouped)
    };
    let expected = counts(&e.expected.rays, &e.expected.samples);
    let rendered = e.rendered.as_ref().map(|rendered| &rendered.counters);
    let rendered = rendered.map(|counters| counts(&counters.rays, &counters.samples));
    let mut text = row("work", "estimate", rendered.as_ref().map(|_| "counted"));
    for (i, name) in NAMES.iter().enumerate() {
        let counted = rendered.as_ref().map(|counted| counted[i].as_str());
        text += &row(name, &expected[i], counted);
    }
    let traced = e.rendered.as_ref().map(|rendered| seconds(rendered.seconds));
    text += &row("    seconds to trace", &seconds(e.expected.seconds), traced.as_deref());
    text + &named("", &format!("estimated from {} pixels", grouped(e.expected.pixels)))
}

fn memory_text(e: &Explanation<'_>) -> String {
    let (m, found) = (&e.memory, e.rendered.as_ref());
    let uses = [
        ("    geometry", Some(m.geometry), None),
        ("    materials, textures", Some(m.appearance), None),
        ("    BVH", Some(m.tree), found.map(|_| e.scene.accel.tree_bytes())),
        ("    wavefront buffers", Some(m.batches), found.map(|found| found.columns)),
        ("    the process", m.held, None),
        ("    its peak", m.peak, found.and_then(|_| memory::peak())),
    ];
    let size = |bytes| Size(bytes).to_string();
    let mut text = row("memory", "prepared", found.map(|_| "rendered"));
    for (name, prepared, rendered) in uses {
        let prepared = prepared.map(size).unwrap_or_default();
        text += &row(name, &prepared, rendered.map(size).as_deref());
    }
    text
}
