//! Results as tables.

use crate::accuracy::report::{SLOPE_FROM, SceneAccuracy, SettingResult};
use crate::accuracy::setting::{Family, SettingSeries, Target, converges};
use crate::accuracy::store::{ReferenceRecord, StepRecord};
use crate::page::{Block, Cell, Section, Table};
use crate::plot::number::figure;
use crate::selftest::errors::{Distribution, HitErrors, ulps};

/// The references of the scene's errors, in sentences.
pub(super) fn references(scene: &SceneAccuracy) -> String {
    let of = |r: &ReferenceRecord| {
        let target = match r.target {
            Target::Scene => "the scene",
            Target::Pixel => "whole pixels",
        };
        if r.standard_error == 0.0 {
            return format!("The reference for {target} is exact, as nothing is sampled.");
        }
        format!(
            "The reference for {target} is the mean of {} renders, with {} points of each kind per pixel in total; its \
             standard error is {}.",
            r.replicates,
            figure(r.samples as f64),
            figure(r.standard_error)
        )
    };
    scene.references.iter().map(of).collect::<Vec<_>>().join(" ")
}

/// The tables of a family.
pub(super) fn of(family: &Family<SettingResult>) -> Vec<Block> {
    let mut blocks: Vec<Block> = slopes(family).map(Block::Table).into_iter().collect();
    let points = Block::Table(points(family));
    blocks.push(match family.series.len() {
        1 => points,
        _ => Block::Details(Section::new("Every setting", vec![points])),
    });
    blocks
}

pub(super) fn slopes(family: &Family<SettingResult>) -> Option<Table> {
    let row = |series: &SettingSeries<SettingResult>| {
        let counts = |p: &&SettingResult| p.x >= SLOPE_FROM && converges(&p.key);
        let Some(slope) = series.slope else {
            let row = [&*series.name, "no longer falls above the noise", "", "", ""];
            let is_long = series.points.iter().filter(counts).count() > 2;
            return is_long.then(|| row.map(Cell::text).to_vec());
        };
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

fn points(family: &Family<SettingResult>) -> Table {
    let header =
        "setting|>time, ms|>RMSE|>95% interval|>relative MSE|>PSNR, dB|>FLIP|>bias|above noise";
    let row = |series: &SettingSeries<SettingResult>, p: &SettingResult| {
        let name = if family.series.len() > 1 {
            format!("{} {}", series.name, p.label)
        } else {
            p.label.clone()
        };
        vec![
            Cell::text(name),
            Cell::decimals(p.seconds.median * 1e3, 2),
            Cell::figure(p.rmse.value),
            Cell::text(format!("{} to {}", figure(p.rmse.low), figure(p.rmse.high))),
            Cell::figure(p.relative_mse),
            p.psnr.map_or(Cell::text("identical"), |v| Cell::decimals(v, 2)),
            Cell::figure(p.flip),
            Cell::figure(p.bias),
            Cell::text(if p.above_noise { "yes" } else { "no" }),
        ]
    };
    let rows = family.series.iter().flat_map(|s| s.points.iter().map(move |p| row(s, p))).collect();
    Table::new("", header, rows)
}

/// Time and error of each precision, with leaks and self-hits.
pub(super) fn precision(scene: &SceneAccuracy) -> Vec<Block> {
    let family = scene.family("precision");
    let Some(points) = family.and_then(|f| f.series.first()).map(|series| &series.points) else {
        return Vec::new();
    };
    let fast = points.first().map_or(1.0, |p| p.seconds.median);
    let share =
        |[tried, failed]: [u64; 2]| Cell::number(failed as f64, format!("{failed} of {tried}"));
    let row = |p: &SettingResult| {
        let trial = scene.trials.iter().find(|trial| trial.precision == p.label);
        let missing = || Cell::text("no triangles");
        let errors = trial.map(|trial| &*trial.errors);
        let worst = |of: fn(&HitErrors) -> &Distribution| {
            errors.map_or_else(missing, |e| Cell::number(of(e).worst, ulps(of(e).worst)))
        };
        let ratio = p.seconds.median / fast;
        vec![
            Cell::text(p.label.clone()),
            Cell::decimals(ratio, 2),
            Cell::figure(p.rmse.value),
            trial.map_or_else(missing, |t| share(t.leaks)),
            trial.map_or_else(missing, |t| share(t.self_hits)),
            worst(|errors| &errors.t),
            worst(|errors| &errors.point),
            worst(|errors| &errors.normal),
        ]
    };
    let caption = "Leaks: rays aimed at an edge that pass between its two triangles. Self-hits: rays that leave a \
                   triangle and hit it again (acne). Then the largest errors of hits";
    let header = "precision|>time / fast|>RMSE|>leaks|>self-hits|>t|>point|>normal";
    vec![Block::Table(Table::new(caption, header, points.iter().map(row).collect()))]
}

/// What each step to an exact hit costs, and all of them together.
pub(super) fn steps(scene: &SceneAccuracy) -> Vec<Block> {
    let Some(found) = &scene.steps else { return Vec::new() };
    if !found.has_any() {
        let words =
            "The scene has no triangles and no quads: exact hits take none of the steps of theirs.";
        return vec![Block::Paragraph(words.to_owned())];
    }
    let row = |step: &StepRecord| {
        vec![
            Cell::text(step.step.clone()),
            Cell::figure(found.times(step)),
            Cell::decimals(step.nanoseconds, 1),
            Cell::decimals(found.nanoseconds(step), 2),
        ]
    };
    let caption = "What exact hits on triangles cost: how often each step is taken for a ray of the scene, and its \
                   time in one thread. Pairs of a ray and a triangle are filtered eight at a time, one ray at a leaf; \
                   packets share more";
    let header = "step|>times a ray|>ns each|>ns a ray";
    let table = Table::new(caption, header, found.steps.iter().map(row).collect());
    vec![Block::Table(table), Block::Paragraph(found.sentence())]
}
