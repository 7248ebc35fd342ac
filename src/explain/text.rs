//! The explanation as text.

use std::fmt::Write as _;

use super::{Buffer, Explanation};
use crate::common::{grouped, rounded, size};
use wavecrest_report::statistics::{Rays, Samples};

/// The whole text, the verdict first.
pub(super) fn of(e: &Explanation) -> String {
    let mut text = verdict(e);
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
    text += &work(e);
    text += &memory_text(e);
    text
}

/// The expected time, the number of rays, and their purpose.
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
    let kinds = [(primary, "from the camera"), (secondary, "from mirrors"), (shadow, "to lights")];
    let kinds = kinds.into_iter().filter(|(n, _)| *n > 0);
    let kinds: Vec<_> = kinds.map(|(n, of_it)| format!("{} {of_it}", about(n))).collect();
    let _ = writeln!(text, "about {} rays: {}", about(e.expected.rays.all()), kinds.join(", "));
    let effects = e.plan.decisions().iter().filter(|decision| decision.present);
    let effects: Vec<_> = effects.map(|decision| decision.effect.name()).collect();
    let effects = if effects.is_empty() { "nothing".to_owned() } else { effects.join(", ") };
    let _ = writeln!(text, "about {} of memory, for {effects}", size(e.memory_total));
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

/// Estimates, with counts beside them if there are any.
fn work(e: &Explanation) -> String {
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
    let most = rows(&e.estimated.rays, &e.estimated.samples);
    let expected = rows(&e.expected.rays, &e.expected.samples);
    let counted = e.rendered.as_ref().map(|found| rows(&found.rays, &found.samples));
    let title = if counted.is_some() { "           counted" } else { "" };
    let mut text = format!("work{:>32}{:>18}{title}\n", "at most", "expected");
    for (index, (name, most)) in most.into_iter().enumerate() {
        let _ = write!(text, "    {name:<16}{most:>16}  {:>16}", expected[index].1);
        if let Some(counted) = counted {
            let _ = write!(text, "  {:>16}", counted[index].1);
        }
        text.push('\n');
    }
    let pixels = e.expected.pixels;
    let _ = writeln!(text, "    {:<16}expected after a pilot of {pixels} pixels", "");
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
        ("build", f.build, m.build, None),
        ("film", f.film, m.film, None),
        ("batches", f.batches, m.batches, found.map(|found| found.batches)),
        ("decoding images", f.decoding, m.decoding, None),
        ("program", f.program, m.program, None),
        ("reading", f.loading, m.loading, None),
        ("peak", e.estimated_total, e.memory_total, found.and_then(|found| found.peak)),
    ];
    let title = if found.is_some() { "          measured" } else { "" };
    let mut text = format!("memory{:>30}{:>18}{title}\n", "before reading", "after reading");
    for (name, before, bytes, measured) in uses {
        let _ = write!(text, "    {name:<16}{:>16}{:>18}", size(before), size(bytes));
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
