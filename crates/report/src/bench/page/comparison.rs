//! The blocks of one comparison.

use super::size;
use crate::bench::compare::{BenchComparison, VariantBench};
use crate::bench::machine::Machine;
use crate::bench::variant::Varied;
use crate::measure::busy;
use crate::page::{Block, Cell, Table};
use crate::plot::number::{plural, time_unit};
use crate::plot::{Chart, ChartAxis, Draw, Guide, Point, Scale, Series};
use wavecrest_core::counters::RayCounts;
use wavecrest_core::render::TracerKind;
use wavecrest_core::tile::TimedPass;

/// A comparison: heading, and what its speeds are relative to.
fn words(of: Varied) -> [&'static str; 2] {
    match of {
        Varied::Ladder => ["From the recursive tracer to the wavefront", "the recursive tracer"],
        Varied::Kernels => ["Wavefront by kernel", "the default"],
        Varied::Levels => {
            ["Steps by instruction set", "the recursive tracer with the same instructions"]
        }
        Varied::Batches => ["Wavefront by batch size", "the recursive tracer"],
        Varied::Threads => ["Both tracers by threads", "the recursive tracer on as many threads"],
        Varied::Plan => ["Wavefront with all passes", "the plan, which skips what is not needed"],
    }
}

/// The results of a list.
pub(super) fn comparison(
    found: &BenchComparison,
    rays: &RayCounts,
    machine: &Machine,
) -> Vec<Block> {
    let [title, over] = words(found.of);
    let mut blocks = vec![Block::Heading(title.to_owned())];
    if let Some(different) = &found.difference {
        blocks.push(Block::Warning(different.words()));
        return blocks;
    }
    let busy = busy([found.rounds]).map_or_else(String::new, |words| format!(" {words}."));
    let note = format!("{}, all images bit-identical.{busy}", plural(found.rounds.rounds, "round"));
    let caption = format!("Speed over that of {over}. {note}");
    let (axis, points) = speeds_of(found);
    let chart = speeds(title, &caption, axis, points);
    blocks.extend([
        Block::Chart(chart),
        Block::Table(times(found, over, &note)),
        Block::Table(passes(found)),
    ]);
    if let (Varied::Ladder, Some(wavefront)) = (found.of, found.wavefront()) {
        blocks.push(Block::Table(costs(wavefront)));
    }
    blocks.push(Block::Table(work(found, rays, machine)));
    blocks
}

/// The speed of each variant but those that others are compared with.
fn speeds_of(found: &BenchComparison) -> (ChartAxis, Series) {
    let shown = found.variants.iter().filter(|v| v.over != v.label);
    let shown: Vec<&VariantBench> = shown.collect();
    if found.of == Varied::Batches {
        let axis = ChartAxis::new("paths in a batch", "", Scale::Log);
        let points = shown.iter().map(|v| point(v.variant.batch as f64, v)).collect();
        return (axis, Series { draw: Draw::Line, points, ..Series::default() });
    }
    let names = shown.iter().map(|v| v.label.clone()).collect();
    let points = shown.iter().enumerate().map(|(row, v)| point(row as f64, v)).collect();
    (ChartAxis::new("", "", Scale::Names(names)), Series { points, ..Series::default() })
}

pub(super) fn point(x: f64, v: &VariantBench) -> Point {
    let i = &v.ratio.interval;
    let label = format!("{:.1} % confidence, {} rounds", 100.0 * i.confidence, v.ratio.pairs);
    Point { x, y: i.median, low: i.low, high: i.high, label }
}

/// Ratios of speeds, and a line at equal speed.
pub(super) fn speeds(title: &str, caption: &str, x: ChartAxis, series: Series) -> Chart {
    Chart {
        title: title.to_owned(),
        x,
        y: ChartAxis::new("times as fast", "", Scale::Linear),
        series: vec![series],
        guides: vec![Guide::at("equally fast", 1.0)],
        caption: caption.to_owned(),
    }
}

/// Times, and ratios of speeds.
fn times(found: &BenchComparison, over: &str, note: &str) -> Table {
    let longest = found.variants.iter().map(|v| v.seconds.median).fold(0.0, f64::max);
    let (scale, second) = time_unit(longest);
    let caption = format!(
        "Median times, the spread of their quartiles, the processors that worked on average, and the speed over that \
         of {over}, with its interval. {note}"
    );
    let has_gains = found.variants.iter().any(|v| v.gain.is_some());
    let names = [&format!("median, {second}"), "spread", "CPUs", "Mrays/s", "speed", "step"];
    table(found, &caption, &names[..if has_gains { 6 } else { 5 }], |v| {
        let (median, spread) = (scale * v.seconds.median, 100.0 * v.seconds.spread());
        let gain = v.gain.as_ref().map(|gain| {
            let median = gain.ratio.interval.median;
            Cell::number(median, format!("{} {median:.3}", gain.of))
        });
        vec![
            Cell::decimals(median, 3),
            Cell::number(spread, format!("{spread:.1} %")),
            optional(v.processors, 2),
            Cell::decimals(v.mrays_s, 3),
            v.ratio.cell(),
            gain.unwrap_or_default(),
        ]
    })
}

/// Time by pass, a column for each pass that takes time. The recursive tracer has no passes.
fn passes(found: &BenchComparison) -> Table {
    let has_passes = |v: &&VariantBench| v.variant.tracer == TracerKind::Wavefront;
    let variants: Vec<_> = found.variants.iter().filter(has_passes).collect();
    let seconds = |v: &VariantBench, pass: TimedPass| {
        v.passes.iter().find(|(name, _)| *name == pass.name()).map_or(0.0, |(_, seconds)| *seconds)
    };
    let shown = |pass: &TimedPass| variants.iter().any(|v| seconds(v, *pass) > 0.0);
    let shown: Vec<_> = TimedPass::ALL.into_iter().filter(shown).collect();
    let longest = variants.iter().flat_map(|v| v.passes.iter().map(|(_, seconds)| *seconds));
    let (scale, second) = time_unit(longest.fold(0.0, f64::max));
    let row = |v: &&VariantBench| {
        let cells = shown.iter().map(|pass| Cell::decimals(scale * seconds(v, *pass), 3));
        std::iter::once(Cell::text(v.label.clone())).chain(cells).collect()
    };
    let names = shown.iter().map(|pass| format!("|>{}", pass.name())).collect::<String>();
    let caption = format!("Time by pass, {second}. Medians of the runs, summed over threads.");
    Table::new(caption, &names, variants.iter().map(row).collect())
}

/// What the passes of the wavefront cost for each of what they handle.
fn costs(wavefront: &VariantBench) -> Table {
    let caption = "Nanoseconds of each pass of the wavefront for one of what it handles, summed over threads. Plain hits are on opaque \
                   surfaces without maps, mapped hits on all others: their time is given for each hit and for each look-up.";
    let rows = wavefront.costs.iter().map(|cost| {
        vec![
            Cell::text(cost.pass),
            Cell::text(cost.of),
            Cell::figure(cost.count as f64),
            Cell::decimals(cost.nanoseconds, 1),
        ]
    });
    Table::new(caption, "pass|of|>number|>ns", rows.collect())
}

/// Tests, rays that are traced together, and the memory of a batch.
fn work(found: &BenchComparison, rays: &RayCounts, machine: &Machine) -> Table {
    let caption = match found.of {
        Varied::Ladder => {
            "Nodes visited and primitives tested for a ray; closest-hit rays that are traced together, of a packet at a \
             node and in flight; and the ray state of a batch, with a few paths to spare, and the nearest cache that holds it for all threads."
        }
        _ => "Work and ray state, as above.",
    };
    table(found, caption, &["nodes", "prims", "a node", "flight", "batch", "in"], |v| {
        let closest = &v.kernels.closest;
        let per_ray = |tests: u64| tests as f64 / rays.all().max(1) as f64;
        let tests = [v.tests.nodes, v.tests.primitives.all()].map(per_ray);
        let mut cells = tests.map(|tests| Cell::decimals(tests, 2)).to_vec();
        cells.extend(
            [closest.rays_a_node, closest.rays_a_round].map(|rays| optional(rays.into(), 1)),
        );
        let state = v.batch_bytes;
        let held = machine.holds(state, v.variant.threads).filter(|_| state > 0);
        cells.push(Cell::number(state as f64, if state > 0 { size(state) } else { String::new() }));
        cells.push(Cell::text(held.unwrap_or_default()));
        cells
    })
}

/// A table with a row for each variant; cells beyond the columns are left out.
fn table(
    found: &BenchComparison,
    caption: &str,
    names: &[&str],
    cells: impl Fn(&VariantBench) -> Vec<Cell>,
) -> Table {
    let row = |v: &VariantBench| {
        let cells = cells(v).into_iter().take(names.len());
        std::iter::once(Cell::text(v.label.clone())).chain(cells).collect()
    };
    let header = format!("|>{}", names.join("|>"));
    Table::new(caption, &header, found.variants.iter().map(row).collect())
}

fn optional(value: Option<f64>, decimals: usize) -> Cell {
    value.map_or_else(|| Cell::text("–"), |value| Cell::decimals(value, decimals))
}
