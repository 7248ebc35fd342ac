//! Findings as tables.

use crate::accuracy::findings::{FamilyFindings, PointFindings, SceneFindings, SeriesFindings};
use crate::accuracy::fit::Interval;
use crate::accuracy::setting::Target;
use crate::accuracy::store::StepRecord;
use crate::page::{Block, Cell, Details, Table};
use crate::plot::number::figure;

/// Number of errors whose time is reported, from the largest that all samplers reach to the
/// smallest.
const ERRORS: usize = 4;

/// The description of a reference.
fn target(target: Target) -> &'static str {
    match target {
        Target::Scene => "the scene",
        Target::Pixel => "whole pixels",
    }
}

/// The references of the scene's errors, in a sentence.
pub(super) fn references(scene: &SceneFindings) -> String {
    let of = |r: &crate::accuracy::store::ReferenceRecord| {
        if r.standard_error == 0.0 {
            return format!(
                "The reference for {} is exact, as nothing is sampled.",
                target(r.target)
            );
        }
        format!(
            "The reference for {} is the mean of {} renders, with {} points of each kind per pixel in total; its \
             standard error is {:.2e}.",
            target(r.target),
            r.replicates,
            figure(r.samples as f64),
            r.standard_error
        )
    };
    scene.references.iter().map(of).collect::<Vec<_>>().join(" ")
}

/// A number rounded to its significant digits.
fn digits(value: f64) -> Cell {
    let text = match value.abs() {
        0.0 => "0".to_owned(),
        v if (1e-2..1e4).contains(&v) => format!("{value:.4}"),
        _ => format!("{value:.3e}"),
    };
    Cell::number(value, text)
}

fn milliseconds(seconds: f64) -> Cell {
    Cell::number(seconds, format!("{:.2}", seconds * 1e3))
}

/// The tables of a family.
pub(super) fn of(family: &FamilyFindings) -> Vec<Block> {
    let mut blocks = Vec::new();
    blocks.extend(slopes(family).map(Block::Table));
    blocks.extend(time_to_error(family).map(Block::Table));
    blocks.extend(efficiency(family).map(Block::Table));
    let points = Block::Table(points(family));
    blocks.push(if family.series.len() > 1 {
        Block::Details(Details { summary: "Every setting".to_owned(), blocks: vec![points] })
    } else {
        points
    });
    blocks
}

fn slopes(family: &FamilyFindings) -> Option<Table> {
    let row = |series: &SeriesFindings| {
        let slope = series.slope?;
        let interval = |low: f64, high: f64| Cell::text(format!("{low:.3} to {high:.3}"));
        Some(vec![
            Cell::text(series.name.clone()),
            Cell::decimals(slope.value, 3),
            interval(slope.low, slope.high),
            Cell::decimals(slope.value / 2.0, 3),
            interval(slope.low / 2.0, slope.high / 2.0),
        ])
    };
    let rows: Vec<_> = family.series.iter().filter_map(row).collect();
    let caption = format!(
        "Convergence: the exponent of the error as a function of the number of {}",
        family.counted
    );
    let header = "sampler|>slope of MSE|>interval|>slope of RMSE|>interval";
    (!rows.is_empty()).then(|| Table::new(caption, header, rows))
}

/// The times of the fastest settings that reach some errors.
fn time_to_error(family: &FamilyFindings) -> Option<Table> {
    let errors = common_errors(family)?;
    let first = family.series.first()?;
    let row = |series: &SeriesFindings| {
        let mut cells = vec![Cell::text(series.name.clone())];
        for &error in &errors {
            let time = time_at(series, error);
            let ratio = time.zip(time_at(first, error)).map(|(time, first)| first / time);
            cells.push(match (time, ratio) {
                (Some(time), Some(ratio)) => {
                    Cell::number(time, format!("{:.2} ({ratio:.2} x)", time * 1e3))
                }
                (Some(time), None) => milliseconds(time),
                _ => Cell::text("not reached"),
            });
        }
        cells
    };
    let errors = errors.iter().map(|error| format!("|>RMSE {error:.2e}"));
    let header = "sampler".to_owned() + &errors.collect::<String>();
    let caption = format!(
        "Tracing time in ms of the fastest setting that reaches an error, and the speedup over {}",
        first.name
    );
    Some(Table::new(caption, &header, family.series.iter().map(row).collect()))
}

/// Errors that the first sampler reaches, in equal ratios.
fn common_errors(family: &FamilyFindings) -> Option<Vec<f64>> {
    let points = &family.series.first().filter(|series| series.slope.is_some())?.points;
    let errors: Vec<f64> = points.iter().filter(|p| p.above_noise).map(|p| p.rmse.value).collect();
    let (&most, &least) = (errors.first()?, errors.last()?);
    if errors.len() < 3 || least >= most {
        return None;
    }
    let ratio = libm::log(least / most) / ERRORS as f64;
    Some((1..=ERRORS).map(|i| most * libm::exp(ratio * i as f64)).collect())
}

/// The most efficient setting of each sampler.
fn efficiency(family: &FamilyFindings) -> Option<Table> {
    let best = |series: &SeriesFindings, of: fn(&PointFindings) -> Option<Interval>| {
        let all = series.points.iter().filter(|p| p.above_noise);
        let best =
            all.filter_map(|p| Some((of(p)?, p))).max_by(|a, b| a.0.value.total_cmp(&b.0.value));
        best.map_or([Cell::text("none"), Cell::text("")], |(e, p)| {
            let text = format!("{:.2e} ({:.2e} to {:.2e})", e.value, e.low, e.high);
            [Cell::number(e.value, text), Cell::number(p.x, points_of(&p.label))]
        })
    };
    let row = |series: &SeriesFindings| {
        let cells = [best(series, |p| p.efficiency), best(series, |p| p.efficiency_in_all)];
        std::iter::once(Cell::text(series.name.clone()))
            .chain(cells.into_iter().flatten())
            .collect()
    };
    let sloped = family.series.iter().any(|series| series.slope.is_some());
    let caption = "The best efficiency of each sampler, 1 / (MSE x time) in 1/s, and the setting that reaches it: for \
                   tracing only, and with loading and building";
    let header = "sampler|>tracing only|>at|>total|>at";
    sloped.then(|| Table::new(caption, header, family.series.iter().map(row).collect()))
}

/// The time of a sampler's fastest setting that reaches `error`.
fn time_at(series: &SeriesFindings, error: f64) -> Option<f64> {
    // Rounding must not lose the ends.
    series.reach(error * (1.0 + f64::EPSILON * 8.0)).map(|point| point.seconds.median)
}

/// A number of points in words.
pub(super) fn points_of(count: &str) -> String {
    if count == "1" { "1 point".to_owned() } else { format!("{count} points") }
}

fn points(family: &FamilyFindings) -> Table {
    let header = "setting|>time, ms|>RMSE|>95% interval|>relative MSE|>PSNR, dB|>FLIP|>bias|above noise|Pareto front";
    let mark = |yes: bool| Cell::text(if yes { "yes" } else { "no" });
    let row = |series: &SeriesFindings, p: &PointFindings| {
        let name = if family.series.len() > 1 {
            format!("{} {}", series.name, p.label)
        } else {
            p.label.clone()
        };
        vec![
            Cell::text(name),
            milliseconds(p.seconds.median),
            digits(p.rmse.value),
            Cell::text(format!("{:.2e} to {:.2e}", p.rmse.low, p.rmse.high)),
            digits(p.relative_mse),
            p.psnr.map_or(Cell::text("identical"), |v| Cell::decimals(v, 2)),
            digits(p.flip),
            digits(p.bias),
            mark(p.above_noise),
            mark(p.front),
        ]
    };
    let rows = family.series.iter().flat_map(|s| s.points.iter().map(move |p| row(s, p))).collect();
    Table::new("", header, rows)
}

/// Time and error of each precision, with leaks and self-hits.
pub(super) fn precision(scene: &SceneFindings) -> Vec<Block> {
    let family = scene.families.iter().find(|family| family.name == "precision");
    let Some(points) = family.and_then(|f| f.series.first()).map(|series| &series.points) else {
        return Vec::new();
    };
    let fast = points.first().map_or(1.0, |p| p.seconds.median);
    let share =
        |[tried, failed]: [u64; 2]| Cell::number(failed as f64, format!("{failed} of {tried}"));
    let row = |p: &PointFindings| {
        let trial = scene.trials.iter().find(|trial| trial.precision == p.label);
        let missing = || Cell::text("none");
        let ratio = p.seconds.median / fast;
        vec![
            Cell::text(p.label.clone()),
            Cell::decimals(ratio, 2),
            digits(p.rmse.value),
            trial.map_or_else(missing, |t| share(t.leaks)),
            trial.map_or_else(missing, |t| share(t.self_hits)),
        ]
    };
    let caption = "Leaks: rays aimed at an edge that pass between its two triangles. Self-hits: rays that leave a \
                   triangle and hit it again (acne)";
    let header = "precision|>time / fast|>RMSE|>leaks|>self-hits";
    let mut table = Table::new(caption, header, points.iter().map(row).collect());
    if scene.trials.is_empty() {
        // There are no trials without triangles.
        table.caption =
            "The scene has no triangles: no ray can leak, or hit its own triangle".to_owned();
        table.columns.truncate(3);
        table.rows.iter_mut().for_each(|row| row.truncate(3));
    }
    vec![Block::Table(table)]
}

/// What each step to an exact hit costs, and all of them beside the whole.
pub(super) fn steps(scene: &SceneFindings) -> Vec<Block> {
    let Some(found) = &scene.steps else { return Vec::new() };
    if !found.has_any() {
        let words =
            "The scene has no triangles and no quads: exact hits take none of the steps of theirs.";
        return vec![Block::paragraph(words)];
    }
    let row = |step: &StepRecord| {
        vec![
            Cell::text(step.step.clone()),
            digits(found.times(step)),
            Cell::decimals(step.nanoseconds, 1),
            Cell::decimals(found.nanoseconds(step), 2),
        ]
    };
    let caption = "What exact hits on triangles cost: how often each step is taken for a ray of the scene, and its \
                   time in one thread. Pairs of a ray and a triangle are filtered eight at a time, one ray at a leaf; \
                   packets share more";
    let header = "step|>times a ray|>ns each|>ns a ray";
    let table = Table::new(caption, header, found.steps.iter().map(row).collect());
    vec![Block::Table(table), Block::paragraph(found.sentence(scene))]
}

/// Choices that must not change the image.
pub(super) fn neutral(scene: &SceneFindings) -> Vec<Block> {
    let row = |n: &crate::accuracy::store::NeutralRecord| {
        vec![
            Cell::text(n.knob.clone()),
            Cell::text(n.value.clone()),
            digits(n.error_change),
            Cell::text(if n.equal { "bit for bit" } else { "NO" }),
            milliseconds(n.seconds),
        ]
    };
    let wrong = scene.neutral.iter().filter(|n| !n.equal || n.error_change != 0.0).count();
    let verdict = match wrong {
        0 => format!("All {} settings give the same image, bit for bit.", scene.neutral.len()),
        n => format!("{n} of {} settings change the image.", scene.neutral.len()),
    };
    let rows = scene.neutral.iter().map(row).collect();
    let table = Table::new("", "setting|value|>change of error|same image|>time, ms", rows);
    if wrong > 0 {
        return vec![Block::Warning(verdict), Block::Table(table)];
    }
    let summary = "Each setting".to_owned();
    let details = Details { summary, blocks: vec![Block::Table(table)] };
    vec![Block::paragraph(verdict), Block::Details(details)]
}
