//! The results of each variant, a line each.

use std::fmt::Write as _;

use crate::bench::compare::{Axis, Comparison, VariantBench};
use crate::bench::words::{average, plural, verdict};
use crate::plot::number::time_unit;

/// The table of one comparison.
pub fn comparison(compared: &Comparison) -> String {
    let of = compared.of;
    if let Some(found) = &compared.difference {
        let label = of.label(&found.variant);
        return format!("\n  {}: with {label}, {}\n", of.name(), verdict(&found.difference));
    }
    let rounds = plural(compared.rounds, "round");
    let mut text = format!(
        "\n  the wavefront by {}, the default first: {rounds}, all images bit-identical\n",
        of.name()
    );
    let longest = compared.variants.iter().map(|v| v.bench.seconds.median).fold(0.0, f64::max);
    let (scale, second) = time_unit(longest);
    let _ = writeln!(
        text,
        "    {:<9}{second:>9}{:>9}{:>9}{:>8}{:>8}{:>9}{:>9}  speed / default",
        "", "spread", "Mrays/s", "nodes", "prims", "a node", "a round"
    );
    let note =
        "a node: average rays of a packet at a node; a round: rays in flight; closest hits only";
    let _ = writeln!(text, "    ({note})");
    for variant in &compared.variants {
        line(&mut text, of, variant, scale);
    }
    times(&mut text, compared);
    counts(&mut text, compared);
    text
}

/// Time, work and occupancy of one variant.
fn line(text: &mut String, of: Axis, found: &VariantBench, scale: f64) {
    let (bench, label) = (&found.bench, of.label(&found.variant));
    let (median, spread) = (scale * bench.seconds.median, 100.0 * bench.seconds.spread());
    let [nodes, primitives] = [bench.tests_per_ray.nodes, bench.tests_per_ray.primitives];
    let closest = &bench.kernels.closest;
    let [a_node, a_round] = [closest.rays_a_node, closest.rays_a_round].map(average);
    let i = &found.ratio.interval;
    let _ = writeln!(
        text,
        "    {label:<9}{median:>9.3}{spread:>7.1} %{:>9.3}{nodes:>8.2}{primitives:>8.2}{a_node:>9}\
         {a_round:>9}  {:.3} ({:.3} to {:.3})",
        bench.mrays_s, i.median, i.low, i.high
    );
}

/// Time by pass of each variant.
fn times(text: &mut String, compared: &Comparison) {
    let Some(first) = compared.variants.first() else { return };
    let seconds = |pass: &serde_json::Value| pass["seconds"].as_f64().unwrap_or_default();
    let all = compared.variants.iter().flat_map(|v| v.bench.passes.values().map(seconds));
    let (scale, second) = time_unit(all.fold(0.0, f64::max));
    let _ = write!(text, "    {:<9}", "passes");
    for name in first.bench.passes.keys() {
        let _ = write!(text, "{name:>11}");
    }
    let _ = writeln!(text, "  {second}");
    for found in &compared.variants {
        let _ = write!(text, "    {:<9}", compared.of.label(&found.variant));
        for pass in found.bench.passes.values() {
            let _ = write!(text, "{:>11.3}", scale * seconds(pass));
        }
        text.push('\n');
    }
}

/// Hardware counters, if available.
fn counts(text: &mut String, compared: &Comparison) {
    for found in &compared.variants {
        let Some(counts) = found.bench.hardware else { continue };
        let _ = write!(text, "    {:<9}", compared.of.label(&found.variant));
        let known = counts.each().into_iter().filter_map(|(name, count)| Some((name, count?)));
        let words: Vec<_> = known.map(|(name, count)| format!("{count} {name}")).collect();
        let _ = writeln!(text, "{}", words.join(", "));
    }
}
