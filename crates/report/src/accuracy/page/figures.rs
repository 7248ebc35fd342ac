//! Results as charts and tables.

use crate::accuracy::report::{SLOPE_FROM, SceneAccuracy, SettingResult};
use crate::accuracy::setting::{Family, SettingSeries, Truth, converges};
use crate::accuracy::store::ReferenceRecord;
use crate::page::{Block, Cell, Section, Table};
use crate::plot::number::{figure, plural};
use crate::plot::{self, Chart, ChartAxis, Draw, Guide, Scale, Series};
use crate::selftest::errors::{HitErrors, ulps};

/// The charts of a family, each with its file name.
pub(super) fn charts(
    family: &Family<SettingResult>,
    scene: &SceneAccuracy,
) -> Vec<(String, Chart)> {
    let name = family.name;
    match name {
        "bounces" => {
            let title = "Error against the number of bounces".to_owned();
            let caption = "With the scene's own samples. The last point has all bounces: only sampling contributes to \
                           its error.";
            let axis = ChartAxis::new(&family.counted, "", Scale::Linear);
            vec![(name.to_owned(), chart(title, family, axis, |p| p.x, caption.to_owned()))]
        }
        _ => vec![
            (format!("{name}-samples"), against_samples(family, scene)),
            (format!("{name}-time"), against_time(family, scene)),
        ],
    }
}

fn log(label: &str, unit: &str) -> ChartAxis {
    ChartAxis::new(label, unit, Scale::Log)
}

/// What the guides are.
const SLOPES: &str = "Thin lines show the slopes that theory predicts: \u{2212}1/2 for independent points, \
                      \u{2212}3/4 for jittered points across an edge, \u{2212}1 for jittered points where the \
                      integrand is smooth. ";

/// Why stratified points do less well at odd counts.
const ODD: &str = "Grids with an odd number of columns do slightly worse: a quad is sampled as two triangles, each \
                   with half of the columns, and the middle column lies in both. ";

/// The error against the count, with theoretical slopes.
fn against_samples(family: &Family<SettingResult>, scene: &SceneAccuracy) -> Chart {
    let mut guides = Vec::new();
    let first = family.series.first().and_then(|line| line.points.first());
    if let Some(first) = first.filter(|_| family.series.iter().any(|line| line.slope.is_some())) {
        let last = family.points().map(|p| p.x).fold(first.x, f64::max);
        let lowest = family.points().map(|p| p.rmse.value).fold(first.rmse.value, f64::min);
        for (name, slope) in [("\u{2212}1/2", -0.5), ("\u{2212}3/4", -0.75), ("\u{2212}1", -1.0)] {
            guides.push(Guide::power(name, slope, [first.x, first.rmse.value], [last, lowest]));
        }
    }
    let floor = scene.floor(family.target);
    if floor > 0.0 {
        guides.push(Guide::at("noise", floor));
    }
    let odd = if family.title == "Points on lights" { ODD } else { "" };
    let theory = if family.series.iter().any(|line| line.slope.is_some()) { SLOPES } else { "" };
    let title = format!("{}: error against {}", scene.scene.scene, family.counted);
    let caption = format!(
        "{theory}{odd}Below the line `noise`, an error is not distinguishable from that of the reference."
    );
    Chart { guides, ..chart(title, family, log(&family.counted, ""), |p| p.x, caption) }
}

/// The error against time.
pub(super) fn against_time(family: &Family<SettingResult>, scene: &SceneAccuracy) -> Chart {
    let property = family.title.to_lowercase();
    let title = format!("{}: error against time, {property}", scene.scene.scene);
    let caption = "Median time of tracing, without loading and building; whiskers are intervals of the error.";
    chart(title, family, log("time", "s"), |p| p.seconds.median, caption.to_owned())
}

/// The error of a family along an axis of a value of each setting.
fn chart(
    title: String,
    family: &Family<SettingResult>,
    axis: ChartAxis,
    x: fn(&SettingResult) -> f64,
    caption: String,
) -> Chart {
    // A setting with the interval of its error.
    let mark = |p: &SettingResult| {
        let noise = if p.above_noise { "" } else { ", below the noise of the reference" };
        let points = plural(p.x as usize, "point");
        let label = format!("{points}, {:.3} ms{noise}", p.seconds.median * 1e3);
        plot::Point { x: x(p), y: p.rmse.value, low: p.rmse.low, high: p.rmse.high, label }
    };
    let series = family.series.iter().map(|line| Series {
        name: line.name.clone(),
        draw: Draw::Line,
        points: line.points.iter().map(mark).collect(),
    });
    let (series, guides) = (series.collect(), Vec::new());
    Chart { title, x: axis, y: log("RMSE", ""), series, guides, caption }
}

/// The references of the scene's errors, in sentences.
pub(super) fn references(scene: &SceneAccuracy) -> String {
    let of = |r: &ReferenceRecord| {
        let target = match r.target {
            Truth::Scene => "the scene",
            Truth::Pixel => "whole pixels",
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

pub(super) fn tables(family: &Family<SettingResult>) -> Vec<Block> {
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
        let worst = |of: fn(&HitErrors) -> f64| {
            errors.map_or_else(missing, |e| Cell::number(of(e), ulps(of(e))))
        };
        let ratio = p.seconds.median / fast;
        vec![
            Cell::text(p.label.clone()),
            Cell::decimals(ratio, 2),
            Cell::figure(p.rmse.value),
            trial.map_or_else(missing, |t| share(t.leaks)),
            trial.map_or_else(missing, |t| share(t.self_hits)),
            worst(|errors| errors.t),
            worst(|errors| errors.point),
            worst(|errors| errors.normal),
        ]
    };
    let caption = "Leaks: rays aimed at an edge that pass between its two triangles. Self-hits: rays that leave a \
                   triangle and hit it again (acne). Then the largest errors of hits";
    let header = "precision|>time / fast|>RMSE|>leaks|>self-hits|>t|>point|>normal";
    vec![Block::Table(Table::new(caption, header, points.iter().map(row).collect()))]
}
