//! One scene on the page.

use super::compared;
use super::parts::{Both, average, bar, speed};
use crate::bench::report::SceneBench;
use crate::bench::rows::{Row, rows};
use crate::bench::tracer::TracerBench;
use crate::bench::words::{contents, peak, plural, prepared, verdict};
use crate::page::{Block, Cell, Details, Fact, Section, Table};
use crate::plot::number::{figure, time_unit};
use crate::plot::{Axis, Chart, Guide, Point, Scale, Series, StackedBars};
use crate::statistics::ClassUse;

/// The section of a scene.
pub(super) fn section(scene: &SceneBench) -> Section {
    let mut blocks = Vec::new();
    if let Some(difference) = &scene.difference {
        blocks.push(Block::Warning(verdict(difference)));
    }
    let both = Both::of(scene);
    if let Some(both) = &both {
        blocks.push(Block::Paragraph(speed(both.ratio)));
    }
    blocks.extend(scene.warnings.iter().cloned().map(Block::Warning));
    if let Some(both) = &both {
        let tracers = [("wavefront", both.wavefront), ("recursive", both.recursive)];
        let bars = tracers.map(|(name, tracer)| bar(name, &tracer.passes));
        blocks.push(Block::Bars(StackedBars {
            title: "Time by pass".to_owned(),
            bars: bars.to_vec(),
            caption:
                "Medians of the runs, summed over threads. The recursive tracer has no passes."
                    .to_owned(),
        }));
        blocks.push(Block::Chart(runs(both)));
        blocks.push(Block::Table(table(both)));
    }
    blocks.push(Block::Facts(facts(scene)));
    if let Some(both) = &both {
        blocks.push(Block::Details(kernels(scene, both.wavefront)));
    }
    scene.comparisons.iter().for_each(|found| blocks.extend(compared::blocks(scene, found)));
    Section::new(format!("`{}`", scene.scene), blocks)
}

/// Every run, in order.
fn runs(both: &Both<'_>) -> Chart {
    let slower = f64::max(both.wavefront.seconds.median, both.recursive.seconds.median);
    let (scale, unit) = time_unit(slower);
    let series = |name: &str, tracer: &TracerBench| {
        let each = tracer.seconds.each.iter().enumerate();
        let points = each.map(|(run, seconds)| Point::new(run as f64 + 1.0, seconds * scale));
        Series::of(name, points.collect())
    };
    let median = |tracer: &TracerBench| Guide::at("median", tracer.seconds.median * scale);
    Chart {
        title: "Each run".to_owned(),
        x: Axis::new("pair of runs", "", Scale::Linear),
        y: Axis::new("time", unit, Scale::FromZero),
        series: vec![series("wavefront", both.wavefront), series("recursive", both.recursive)],
        guides: vec![median(both.wavefront), median(both.recursive)],
        caption: "Wall-clock time of each run, in order; lines at the medians.".to_owned(),
    }
}

fn table(both: &Both<'_>) -> Table {
    let cell = |value: f64| Cell::decimals(value, 3);
    let row = |Row { name, values: [a, b], unit }: Row| {
        vec![Cell::text(name), cell(a), cell(b), Cell::text(unit)]
    };
    let rows = rows(both.scene, both.wavefront, both.recursive).into_iter().map(row).collect();
    Table::new("Time, work and rate of one run.", "|>wavefront|>recursive|unit", rows)
}

/// The settings.
fn facts(scene: &SceneBench) -> Vec<Fact> {
    let image = &scene.image;
    let samples = plural(image.samples_per_pixel as usize, "camera ray");
    let rays = &scene.rays;
    let [primary, secondary, shadow] =
        [rays.primary, rays.secondary, rays.shadow].map(|count| figure(count as f64));
    let mut facts = vec![
        Fact::new("image", format!("{} × {} pixels, {samples} each", image.width, image.height)),
        Fact::new("scene", contents(scene)),
        Fact::new(
            "rays per run",
            format!("{primary} primary, {secondary} secondary, {shadow} shadow"),
        ),
        Fact::new("prepared", prepared(scene)),
    ];
    facts.extend(peak(scene).map(|peak| Fact::new("peak memory", peak)));
    facts.extend([
        Fact::new("kernel", scene.kernel.name()),
        Fact::new("vector instructions", scene.simd.name()),
        Fact::new("precision", scene.precision.name()),
        Fact::new("paths in a batch", scene.batch.to_string()),
        Fact::new("seed", scene.seed.to_string()),
    ]);
    facts
}

/// The wavefront's rays by kernel.
fn kernels(scene: &SceneBench, wavefront: &TracerBench) -> Details {
    let rays = &scene.rays;
    let classes = [
        ("closest hit", rays.primary + rays.secondary, &wavefront.kernels.closest),
        ("shadow", rays.shadow, &wavefront.kernels.shadow),
    ];
    let row = |(name, _, used): (&str, u64, &ClassUse)| {
        let counts = [used.packet, used.handed_over, used.stream, used.single].map(Cell::count);
        let together = [used.rays_a_node, used.rays_a_round].map(average);
        [vec![Cell::text(name)], counts.to_vec(), together.to_vec()].concat()
    };
    let rows = classes.into_iter().filter(|(_, rays, _)| *rays > 0).map(row).collect();
    let header = "rays|>in packets|>handed over|>in streams|>alone|>rays of a packet at a node|>rays in flight per \
                  round";
    let blocks = vec![Block::Table(Table::new("", header, rows))];
    Details { summary: "Rays of the wavefront tracer by kernel".to_owned(), blocks }
}
