//! Variants of the wavefront, on the page.

use super::parts::{average, bar, interval, ratio_cell, ratio_chart};
use crate::bench::compare::{Axis as Compared, Comparison, VariantBench};
use crate::bench::report::SceneBench;
use crate::bench::words::{plural, verdict};
use crate::page::{Block, Cell, Column, Table};
use crate::plot::number::time_unit;
use crate::plot::{Axis, Point, Scale, StackedBars};

/// The results of several variants.
pub(super) fn blocks(scene: &SceneBench, found: &Comparison) -> Vec<Block> {
    let name = name(found.of);
    let mut blocks = vec![Block::Heading(format!("Wavefront tracer by {name}"))];
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
            "Relative to {usual}, the default, round by round: {}, all images bit-identical. Right of the line is \
             faster.",
            plural(found.rounds, "round")
        ),
        Axis::new(name, "", Scale::Names(labels.clone())),
        points.collect(),
    )));
    blocks.push(Block::Table(times(found)));
    let bars = found.variants.iter().zip(&labels);
    blocks.push(Block::Bars(StackedBars {
        title: format!("Time by pass, for each {name}"),
        bars: bars.map(|(each, label)| bar(label, &each.bench.passes)).collect(),
        caption: "Medians of the runs, summed over threads.".to_owned(),
    }));
    blocks.push(Block::Table(work(found)));
    blocks.extend(hardware(scene, found).map(Block::Table));
    blocks
}

/// The name of the compared property.
fn name(of: Compared) -> &'static str {
    match of {
        Compared::Kernels => "kernel",
        Compared::Levels => "set of vector instructions",
        Compared::Batches => "size of batches",
        Compared::Plan => "plan",
    }
}

/// A table with a row for each variant.
fn table<const N: usize>(
    found: &Comparison,
    caption: &str,
    names: [&str; N],
    cells: impl Fn(&VariantBench) -> [Cell; N],
) -> Table {
    let row = |each: &VariantBench| {
        let label = Cell::text(found.of.label(&each.variant));
        std::iter::once(label).chain(cells(each)).collect()
    };
    let first = Column::words(name(found.of));
    let columns = std::iter::once(first).chain(names.map(Column::numbers)).collect();
    let rows = found.variants.iter().map(row).collect();
    Table { caption: caption.to_owned(), columns, rows }
}

fn times(found: &Comparison) -> Table {
    let longest = found.variants.iter().map(|each| each.bench.seconds.median).fold(0.0, f64::max);
    let (scale, second) = time_unit(longest);
    let caption = "Median times, the spread of their quartiles, and the ratio of the speeds with its interval.";
    let names = [&format!("median, {second}"), "spread", "Mrays/s", "ratio"];
    table(found, caption, names, |each| {
        let bench = &each.bench;
        let (median, spread) = (scale * bench.seconds.median, 100.0 * bench.seconds.spread());
        [
            Cell::decimals(median, 3),
            Cell::number(spread, format!("{spread:.1} %")),
            Cell::decimals(bench.mrays_s, 3),
            ratio_cell(&each.ratio),
        ]
    })
}

fn work(found: &Comparison) -> Table {
    let caption = "Tests per ray, and the average number of closest-hit rays that are traced together: of a packet at \
                   a node, and in flight per round.";
    let names = ["nodes per ray", "primitives per ray", "rays at a node", "rays in flight"];
    table(found, caption, names, |each| {
        let tests = &each.bench.tests_per_ray;
        let [nodes, primitives] =
            [tests.nodes, tests.primitives].map(|tests| Cell::decimals(tests, 2));
        let closest = &each.bench.kernels.closest;
        [nodes, primitives, average(closest.rays_a_node), average(closest.rays_a_round)]
    })
}

/// Hardware counters for each ray, if available.
fn hardware(scene: &SceneBench, found: &Comparison) -> Option<Table> {
    let names = found.variants.first()?.bench.hardware?.each().map(|(name, _)| name);
    let rays = scene.rays.all().max(1) as f64;
    let cell = |count: Option<u64>| match count {
        Some(count) => Cell::decimals(count as f64 / rays, 3),
        None => Cell::text("–"),
    };
    Some(table(found, "Hardware counters, per ray.", names, |each| {
        let counts = each.bench.hardware.unwrap_or_default().each();
        counts.map(|(_, count)| cell(count))
    }))
}
