//! The wavefront against itself, on the page.

use super::scene::{average, bar};
use super::{interval, ratio_cell, ratio_chart, verdict};
use crate::report::bench::SceneBench;
use crate::report::bench::compare::{Comparison, VariantBench};
use crate::report::bench::rows::unit;
use crate::report::bench::text::plural;
use crate::report::page::{Block, Cell, Column, Table};
use crate::report::plot::{Axis, Point, Scale, StackedBars};

/// What was found of several choices.
pub(super) fn blocks(scene: &SceneBench, found: &Comparison) -> Vec<Block> {
    let name = found.of.name();
    let mut blocks = vec![Block::Heading(format!("The wavefront by {name}"))];
    if let Some(different) = &found.difference {
        let label = found.of.label(&different.variant);
        let text = format!("With {label}: {}", verdict(&different.difference));
        blocks.push(Block::Warning(text));
        return blocks;
    }
    let labels: Vec<String> =
        found.variants.iter().map(|each| found.of.label(&each.variant)).collect();
    let points = found.variants.iter().enumerate().map(|(row, each)| {
        let i = &each.ratio.interval;
        Point::new(row as f64, i.median).within(i.low, i.high).labelled(interval(&each.ratio))
    });
    let usual = labels.first().cloned().unwrap_or_default();
    blocks.push(Block::Chart(ratio_chart(
        &format!("Speed by {name}"),
        &format!(
            "Over that of {usual}, the usual choice, round by round: {}, every image the same. \
             Right of the line a choice is faster.",
            plural(found.rounds, "round")
        ),
        Axis::new(name, "", Scale::Names(labels.clone())),
        points.collect(),
    )));
    blocks.push(Block::Table(table(found)));
    let bars = found.variants.iter().zip(&labels);
    blocks.push(Block::Bars(StackedBars {
        title: format!("Time by pass and {name}"),
        bars: bars.map(|(each, label)| bar(label, &each.bench.passes)).collect(),
        caption: "Medians of the runs, summed over threads.".to_owned(),
    }));
    blocks.extend(hardware(scene, found).map(Block::Table));
    blocks
}

fn table(found: &Comparison) -> Table {
    let longest = found.variants.iter().map(|each| each.bench.seconds.median).fold(0.0, f64::max);
    let (scale, second) = unit(longest);
    let row = |each: &VariantBench| {
        let bench = &each.bench;
        let number = |value: f64, digits: usize| Cell::number(value, format!("{value:.digits$}"));
        let spread = 100.0 * bench.seconds.spread();
        let closest = &bench.kernels.closest;
        vec![
            Cell::text(found.of.label(&each.variant)),
            number(scale * bench.seconds.median, 3),
            Cell::number(spread, format!("{spread:.1} %")),
            number(bench.mrays_s, 3),
            number(bench.tests_per_ray.nodes, 2),
            number(bench.tests_per_ray.primitives, 2),
            average(closest.rays_a_node),
            average(closest.rays_a_round),
            ratio_cell(&each.ratio),
        ]
    };
    let names = [
        &format!("median, {second}"),
        "spread",
        "Mrays/s",
        "nodes a ray",
        "primitives a ray",
        "at a node",
        "in a round",
        "ratio",
    ];
    let first = Column::words(found.of.name());
    Table {
        caption:
            "Median and spread between the quartiles, work, and how many rays that look for the \
                  closest hit go together: of a packet at a node, and in flight in a round."
                .to_owned(),
        columns: std::iter::once(first).chain(names.map(Column::numbers)).collect(),
        rows: found.variants.iter().map(row).collect(),
    }
}

/// What the processor counted, for each ray, where it did.
fn hardware(scene: &SceneBench, found: &Comparison) -> Option<Table> {
    let first = found.variants.first()?.bench.hardware?;
    let rays = scene.rays.all().max(1) as f64;
    let row = |each: &VariantBench| {
        let counts = each.bench.hardware.unwrap_or_default().each();
        let cell = |count: Option<u64>| match count {
            Some(count) => {
                let value = count as f64 / rays;
                Cell::number(value, format!("{value:.3}"))
            }
            None => Cell::text("–"),
        };
        let label = Cell::text(found.of.label(&each.variant));
        std::iter::once(label).chain(counts.map(|(_, count)| cell(count))).collect()
    };
    let names = first.each().map(|(name, _)| Column::numbers(name));
    Some(Table {
        caption: "Counted by the processor, for each ray.".to_owned(),
        columns: std::iter::once(Column::words(found.of.name())).chain(names).collect(),
        rows: found.variants.iter().map(row).collect(),
    })
}
