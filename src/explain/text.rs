//! The explanation as text.

use super::{Buffer, Explanation, buffers};
use crate::common::{grouped, rounded, size};
use wavecrest_core::plan::schedule::PASSES;
use wavecrest_report::statistics::{Rays, Samples};
use wavecrest_scene::memory;

/// The width of the column of names.
const NAMES: usize = 20;

/// The whole text, the estimate first.
pub(super) fn of(e: &Explanation<'_>) -> String {
    let mut text = verdict(e) + "passes (+ runs, - skipped)\n";
    let plan = &e.scene.plan;
    for pass in &PASSES {
        let name = format!("{}{}", if pass.part_of.is_some() { "  " } else { "" }, pass.name);
        text += &marked(plan.schedule().runs(pass.step), &name, &plan.reason(pass));
    }
    text += "effects (+ simulated, - skipped)\n";
    for decision in plan.decisions() {
        text += &marked(decision.present, decision.effect.name(), &decision.reason.to_string());
    }
    text += "precision\n";
    text += &named(e.precision.name(), e.precision.meaning());
    if let Some([x, y, z]) = e.moved_by() {
        text += &named("", &format!("scene moved by {x}, {y}, {z} towards the origin"));
    }
    text += "BVH\n";
    text += &named(e.bvh.preset.name(), &e.bvh.reason);
    if let Some(rule) = &e.bvh.rule {
        text += &named("", rule);
    }
    if let Some([built, all]) = e.chunks.map(|chunks| chunks.map(|n| grouped(n as u64))) {
        text += &named("", &format!("{built} of {all} chunks built"));
    }
    text += "buffers of the wavefront tracer, in bytes per path\n";
    let buffers = buffers(e.scene);
    for Buffer { name, bytes, written_by, read_by } in &buffers {
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

/// The expected time, rays and memory.
fn verdict(e: &Explanation<'_>) -> String {
    let seconds = |seconds: f64| format!("{} s", rounded((seconds * 1e3).round() / 1e3, 2));
    let (build, trace) = (e.build + e.expected.building, e.expected.seconds);
    let time = seconds(e.load + build + trace);
    let parts = [("read", e.load), ("build", build), ("trace", trace)];
    let parts = parts.map(|(what, of_it)| format!("{} to {what}", seconds(of_it))).join(", ");
    let threads = match rayon::current_num_threads() {
        1 => "1 thread".to_owned(),
        n => format!("{n} threads"),
    };
    let Rays { primary, secondary, shadow } = e.expected.rays;
    let about = |n: u64| grouped(rounded(n as f64, 3) as u64);
    let kinds = [(primary, "camera"), (secondary, "mirror"), (shadow, "shadow")];
    let kinds = kinds.into_iter().filter(|(n, _)| *n > 0);
    let kinds: Vec<_> = kinds.map(|(n, kind)| format!("{} {kind}", about(n))).collect();
    let (all, kinds) = (about(e.expected.rays.all()), kinds.join(", "));
    let memory = size(e.memory[1].total());
    format!(
        "about {time} on {threads}: {parts}\nabout {all} rays: {kinds}\nabout {memory} of memory\n"
    )
}

/// A row of a table: two estimates, and what was found of a render.
fn row(name: &str, estimates: [&str; 2], found: Option<&str>) -> String {
    let [first, second] = estimates;
    let found = found.map_or_else(String::new, |found| format!("{found:>18}"));
    format!("{name:<24}{first:>16}{second:>18}{found}\n")
}

/// Estimates, with counts beside them if there are any.
fn work(e: &Explanation<'_>) -> String {
    let rows = |rays: &Rays, samples: &Samples| {
        [
            ("    camera rays", grouped(rays.primary)),
            ("    mirror rays", grouped(rays.secondary)),
            ("    shadow rays", grouped(rays.shadow)),
            ("    points on the lens", grouped(samples.lens)),
            ("    points on lights", grouped(samples.light)),
            ("    texels read", grouped(samples.texels)),
        ]
    };
    let most = rows(&e.estimated.rays, &e.estimated.samples);
    let expected = rows(&e.expected.rays, &e.expected.samples);
    let counters = e.rendered.as_ref().map(|rendered| &rendered.counters);
    let counted = counters.map(|counters| rows(&counters.into(), &counters.into()));
    let mut text = row("work", ["at most", "estimate"], counters.map(|_| "counted"));
    for (i, (name, most)) in most.iter().enumerate() {
        let counted = counted.as_ref().map(|counted| counted[i].1.as_str());
        text += &row(name, [most, &expected[i].1], counted);
    }
    text + &named("", &format!("estimated from {} pixels", grouped(e.expected.pixels)))
}

fn memory_text(e: &Explanation<'_>) -> String {
    let [f, m] = &e.memory;
    let found = e.rendered.as_ref();
    let uses = [
        ("    geometry", f.geometry, m.geometry, None),
        ("    materials, textures", f.appearance, m.appearance, None),
        ("    BVH", f.tree, m.tree, found.map(|_| e.scene.accel.tree_bytes())),
        ("    building the BVH", f.build, m.build, None),
        ("    image", f.film, m.film, None),
        ("    wavefront buffers", f.batches, m.batches, found.map(|found| found.columns)),
        ("    decoding images", f.decoding, m.decoding, None),
        ("    program", f.program, m.program, None),
        ("    reading files", f.loading, m.loading, None),
        ("    peak", f.total(), m.total(), found.and_then(|_| memory::peak())),
    ];
    let estimates = ["before reading", "after reading"];
    let mut text = row("memory, estimated", estimates, found.map(|_| "measured"));
    for (name, before, after, measured) in uses {
        text += &row(name, [&size(before), &size(after)], measured.map(size).as_deref());
    }
    text
}
