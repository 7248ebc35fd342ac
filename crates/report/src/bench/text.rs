//! A benchmark as text: aligned tables for a terminal, with the work beside the time.

use std::fmt::Write as _;

use super::machine::Machine;
use super::report::SceneBench;
use super::rows::{Row, rows};
use super::tracer::{Ratio, TracerBench};
use super::words::{average, contents, count, pairs_of_runs, peak, plural, prepared};
use crate::plot::number::time_unit;
use crate::statistics::ClassUse;

mod compared;

pub use super::words::verdict;
pub use compared::comparison;

/// The machine on one line.
pub fn machine(machine: &Machine) -> String {
    let processor = machine.processor.as_deref().unwrap_or("unknown processor");
    let Machine { cores, threads, os, .. } = machine;
    let (cores, threads) = (plural(*cores, "core"), plural(*threads, "thread"));
    let mut text = format!("{processor}, {cores}, {threads}, {os}\n");
    if let Some(why) = &machine.hardware_missing {
        let _ = writeln!(text, "no hardware counters: {why}");
    }
    text
}

/// The table of one scene.
pub fn scene(report: &SceneBench) -> String {
    let mut text = head(report);
    match &report.difference {
        Some(difference) => {
            let _ = writeln!(text, "\n{}", verdict(difference));
        }
        None => {
            if let (Some(wavefront), Some(recursive)) = (&report.wavefront, &report.recursive) {
                text += &table(report, wavefront, recursive);
                text += &passes(wavefront);
                text += &kernels(report, wavefront);
            }
            if let Some(ratio) = &report.ratio {
                let _ = writeln!(text, "  wavefront speed / recursive speed");
                let _ = writeln!(text, "    {}; {}", interval(ratio), ratio.verdict());
            }
            report.comparisons.iter().for_each(|compared| text += &comparison(compared));
        }
    }
    text
}

/// One line for each scene, if there are several.
pub fn summary(reports: &[SceneBench]) -> String {
    let names = reports.iter().map(|r| r.scene.chars().count());
    let width = names.max().unwrap_or(0).max("scene".len());
    let mut text = format!(
        "{:<width$}{:>12}{:>12}{:>14}{:>14}  wavefront / recursive (interval)\n",
        "scene", "triangles", "rays", "wavefront", "recursive"
    );
    let _ = writeln!(text, "{:<width$}{:>12}{:>12}{:>14}{:>14}", "", "", "", "Mrays/s", "Mrays/s");
    for report in reports {
        let (name, triangles, rays) = (&report.scene, report.triangles, report.rays.all());
        let _ = write!(text, "{name:<width$}{triangles:>12}{rays:>12}");
        let _ = match (&report.wavefront, &report.recursive, &report.ratio) {
            (Some(w), Some(r), Some(ratio)) => {
                let (w, r, i) = (w.mrays_s, r.mrays_s, &ratio.interval);
                writeln!(
                    text,
                    "{w:>14.3}{r:>14.3}  {:.3} ({:.3} to {:.3})",
                    i.median, i.low, i.high
                )
            }
            _ => writeln!(text, "{:>14}{:>14}  THE TRACERS DISAGREE", "-", "-"),
        };
    }
    text
}

fn head(report: &SceneBench) -> String {
    let image = &report.image;
    let mut text = format!("{}\n", report.scene);
    let mut row = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<14}{value}");
    };
    let size = format!("{} x {} pixels", image.width, image.height);
    row(
        "image",
        format!("{size}, {} per pixel", plural(image.samples_per_pixel as usize, "camera ray")),
    );
    row("scene", contents(report));
    row("prepared", prepared(report));
    if let Some(peak) = peak(report) {
        row("peak memory", peak);
    }
    let rays = &report.rays;
    let (primary, secondary, shadow) = (rays.primary, rays.secondary, rays.shadow);
    let [primary, secondary, shadow] = [primary, secondary, shadow].map(count);
    row("rays per run", format!("{primary} primary, {secondary} secondary, {shadow} shadow"));
    if let Some(ratio) = &report.ratio {
        row("runs", format!("{}, all images bit-identical", pairs_of_runs(ratio.pairs)));
    }
    text
}

/// Time, rate and tests of the two side by side.
fn table(report: &SceneBench, wavefront: &TracerBench, recursive: &TracerBench) -> String {
    let mut text = format!("\n  {:<24}{:>12}{:>12}\n", "", "wavefront", "recursive");
    for Row { name, values: [a, b], unit } in rows(report, wavefront, recursive) {
        let _ = writeln!(text, "  {name:<24}{a:>12.3}{b:>12.3}  {unit}");
    }
    text
}

/// The wavefront's time by pass.
fn passes(wavefront: &TracerBench) -> String {
    let number = |pass: &serde_json::Value, key| pass[key].as_f64().unwrap_or_default();
    let seconds = wavefront.passes.values().map(|pass| number(pass, "seconds"));
    let (scale, second) = time_unit(seconds.fold(0.0, f64::max));
    let mut text = "  passes of the wavefront, summed over threads\n".to_owned();
    for (name, pass) in &wavefront.passes {
        let (time, share) = (scale * number(pass, "seconds"), 100.0 * number(pass, "share"));
        let _ = writeln!(text, "    {name:<22}{time:>12.3} {second:<2}{share:>8.1} %");
    }
    text
}

/// The wavefront's rays by kernel.
fn kernels(report: &SceneBench, wavefront: &TracerBench) -> String {
    let (kernel, simd) = (report.kernel.name(), report.simd.name());
    let mut text = format!("  rays of the wavefront by kernel ({kernel}, {simd})\n");
    let mut class = |name: &str, rays: u64, used: &ClassUse| {
        if rays == 0 {
            return;
        }
        let ClassUse { packet, handed_over, stream, single, .. } = *used;
        let [packet, handed_over, stream, single] =
            [packet, handed_over, stream, single].map(count);
        let _ = writeln!(
            text,
            "    {name:<14}{packet} in packets ({handed_over} handed over), {stream} in streams, \
             {single} alone\n    {:<14}average: {} rays of a packet at a node, {} rays in flight per round",
            "",
            average(used.rays_a_node),
            average(used.rays_a_round)
        );
    };
    let (rays, used) = (&report.rays, &wavefront.kernels);
    class("closest hit", rays.primary + rays.secondary, &used.closest);
    class("shadow", rays.shadow, &used.shadow);
    text
}

fn interval(ratio: &Ratio) -> String {
    let (i, n) = (&ratio.interval, pairs_of_runs(ratio.pairs));
    let percent = 100.0 * i.confidence;
    format!("{:.3} ({:.3} to {:.3} with {percent:.1} % confidence, {n})", i.median, i.low, i.high)
}
