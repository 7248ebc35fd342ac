//! The explanation as text.

use std::fmt::Write as _;

use super::{Buffer, Explanation};
use crate::common::{grouped, rounded, size};
use wavecrest_report::statistics::{Rays, Samples};

/// The width of the column of names.
const NAMES: usize = 20;

/// The whole text, the estimate first.
pub(super) fn of(e: &Explanation) -> String {
    let mut text = verdict(e);
    let _ = writeln!(text, "passes (+ runs, - skipped)");
    for pass in &e.passes {
        let name = format!("{}{}", if pass.part_of.is_some() { "  " } else { "" }, pass.name);
        let _ = writeln!(text, "  {} {name:<NAMES$}{}", mark(pass.runs), pass.reason);
    }
    let _ = writeln!(text, "effects (+ simulated, - skipped)");
    for decision in e.plan.decisions() {
        let (mark, name) = (mark(decision.present), decision.effect.name());
        let _ = writeln!(text, "  {mark} {name:<NAMES$}{}", decision.reason);
    }
    let precision = e.precision;
    let _ = writeln!(text, "precision\n    {:<NAMES$}{}", precision.name(), precision.meaning());
    if let Some([x, y, z]) = e.moved_by {
        let _ = writeln!(text, "    {:<NAMES$}scene moved by {x}, {y}, {z} towards the origin", "");
    }
    let _ = writeln!(text, "BVH\n    {:<NAMES$}{}", e.bvh.preset.name(), e.bvh.reason);
    if let Some(rule) = &e.bvh.rule {
        let _ = writeln!(text, "    {:<NAMES$}{rule}", "");
    }
    if let Some([built, all]) = e.chunks.map(|chunks| chunks.map(|n| grouped(n as u64))) {
        let _ = writeln!(text, "    {:<NAMES$}{built} of {all} chunks built", "");
    }
    text += &buffers(&e.bytes_per_path);
    text += &work(e);
    text += &memory_text(e);
    text
}

/// The expected time, rays and memory.
fn verdict(e: &Explanation) -> String {
    let seconds = |seconds: f64| format!("{} s", rounded((seconds * 1e3).round() / 1e3, 2));
    let time = &e.time;
    let all = time.load + time.build + time.trace;
    let parts = [("read", time.load), ("build", time.build), ("trace", time.trace)];
    let parts = parts.map(|(what, of_it)| format!("{} to {what}", seconds(of_it)));
    let threads =
        if time.threads == 1 { "1 thread".into() } else { format!("{} threads", time.threads) };
    let mut text = format!("about {} on {threads}: {}\n", seconds(all), parts.join(", "));
    let Rays { primary, secondary, shadow } = e.expected.rays;
    let about = |n: u64| grouped(rounded(n as f64, 3) as u64);
    let kinds = [(primary, "camera"), (secondary, "mirror"), (shadow, "shadow")];
    let kinds = kinds.into_iter().filter(|(n, _)| *n > 0);
    let kinds: Vec<_> = kinds.map(|(n, kind)| format!("{} {kind}", about(n))).collect();
    let _ = writeln!(text, "about {} rays: {}", about(e.expected.rays.all()), kinds.join(", "));
    let _ = writeln!(text, "about {} of memory", size(e.memory_total));
    text
}

fn buffers(buffers: &[Buffer]) -> String {
    let mut text = "buffers of the wavefront tracer, in bytes per path\n".to_owned();
    for Buffer { name, bytes, written_by, read_by } in buffers {
        let _ = match bytes {
            0 => writeln!(text, "  - {name:<NAMES$}{bytes:>6}  not needed"),
            _ => {
                let (written, read) = (written_by.join(", "), read_by.join(", "));
                writeln!(text, "  + {name:<NAMES$}{bytes:>6}  written by {written}; read by {read}")
            }
        };
    }
    let all: usize = buffers.iter().map(|c| c.bytes).sum();
    let _ = writeln!(text, "    {:<NAMES$}{all:>6}", "total");
    text
}

/// Estimates, with counts beside them if there are any.
fn work(e: &Explanation) -> String {
    let rows = |rays: &Rays, samples: &Samples| {
        [
            ("camera rays", rays.primary),
            ("mirror rays", rays.secondary),
            ("shadow rays", rays.shadow),
            ("points on the lens", samples.lens),
            ("points on lights", samples.light),
            ("texels read", samples.texels),
        ]
    };
    let most = rows(&e.estimated.rays, &e.estimated.samples);
    let expected = rows(&e.expected.rays, &e.expected.samples);
    let counted = e.rendered.as_ref().map(|found| rows(&found.rays, &found.samples));
    let title = if counted.is_some() { "           counted" } else { "" };
    let mut text = format!("{:<24}{:>16}{:>18}{title}\n", "work", "at most", "estimate");
    for (index, (name, most)) in most.into_iter().enumerate() {
        let (most, expected) = (grouped(most), grouped(expected[index].1));
        let _ = write!(text, "    {name:<NAMES$}{most:>16}{expected:>18}");
        if let Some(counted) = counted {
            let _ = write!(text, "{:>18}", grouped(counted[index].1));
        }
        text.push('\n');
    }
    let pixels = grouped(e.expected.pixels);
    let _ = writeln!(text, "    {:<NAMES$}estimated from {pixels} pixels", "");
    text
}

fn memory_text(e: &Explanation) -> String {
    let m = &e.memory;
    let found = e.rendered.as_ref();
    let f = &e.estimated_memory;
    let uses = [
        ("geometry", f.geometry, m.geometry, None),
        ("materials, textures", f.appearance, m.appearance, None),
        ("BVH", f.tree, m.tree, found.map(|found| found.tree)),
        ("building the BVH", f.build, m.build, None),
        ("image", f.film, m.film, None),
        ("wavefront buffers", f.batches, m.batches, found.map(|found| found.batches)),
        ("decoding images", f.decoding, m.decoding, None),
        ("program", f.program, m.program, None),
        ("reading files", f.loading, m.loading, None),
        ("peak", e.estimated_total, e.memory_total, found.and_then(|found| found.peak)),
    ];
    let title = if found.is_some() { "          measured" } else { "" };
    let mut text = format!(
        "{:<24}{:>16}{:>18}{title}\n",
        "memory, estimated", "before reading", "after reading"
    );
    for (name, before, bytes, measured) in uses {
        let _ = write!(text, "    {name:<NAMES$}{:>16}{:>18}", size(before), size(bytes));
        if let Some(measured) = measured {
            let _ = write!(text, "{:>18}", size(measured));
        }
        text.push('\n');
    }
    text
}

fn mark(present: bool) -> char {
    if present { '+' } else { '-' }
}
