//! Findings as charts.

use crate::accuracy::findings::{FamilyFindings, PointFindings, SceneFindings, SeriesFindings};
use crate::accuracy::layers::{LayersFindings, PartFindings};
use crate::accuracy::subject::Stages;
use crate::plot::{Axis, Chart, Draw, Guide, Point, Scale, Series};

/// The charts of a family, each with its file name.
pub(super) fn of(family: &FamilyFindings, scene: &SceneFindings) -> Vec<(String, Chart)> {
    let name = family.name;
    match name {
        "bounces" => vec![(name.to_owned(), bounces(family))],
        _ => vec![
            (format!("{name}-samples"), against_samples(family, scene)),
            (format!("{name}-time"), against_time(family, scene)),
        ],
    }
}

fn log(label: &str, unit: &str) -> Axis {
    Axis::new(label, unit, Scale::Log)
}

fn point(p: &PointFindings, x: f64) -> Point {
    let noise = if p.above_noise { "" } else { ", below the noise of the reference" };
    let points = super::tables::points_of(&p.label);
    let label = format!("{points}, {:.3} ms{noise}", p.seconds.median * 1e3);
    Point { x, y: p.rmse.value, low: Some(p.rmse.low), high: Some(p.rmse.high), label }
}

fn line(series: &SeriesFindings, x: fn(&PointFindings) -> f64) -> Series {
    let points = series.points.iter().map(|p| point(p, x(p))).collect();
    Series { name: series.name.clone(), draw: Draw::Line, points }
}

/// What the guides are.
const SLOPES: &str = "Thin lines show the slopes that theory predicts: \u{2212}1/2 for independent points, \
                      \u{2212}3/4 for jittered points across an edge, \u{2212}1 for jittered points where the \
                      integrand is smooth. ";

/// Why stratified points do less well at odd counts.
const ODD: &str = "Grids with an odd number of columns do slightly worse: a quad is sampled as two triangles, each \
                   with half of the columns, and the middle column lies in both. ";

/// The error against the count, with theoretical slopes.
fn against_samples(family: &FamilyFindings, scene: &SceneFindings) -> Chart {
    let mut guides = Vec::new();
    let first = family.series.first().and_then(|line| line.points.first());
    if let Some(first) = first.filter(|_| family.series.iter().any(|line| line.slope.is_some())) {
        let points = || family.series.iter().flat_map(|line| &line.points);
        let last = points().map(|p| p.x).fold(first.x, f64::max);
        let lowest = points().map(|p| p.rmse.value).fold(first.rmse.value, f64::min);
        for (name, slope) in [("\u{2212}1/2", -0.5), ("\u{2212}3/4", -0.75), ("\u{2212}1", -1.0)] {
            guides.push(Guide::power(name, slope, [first.x, first.rmse.value], [last, lowest]));
        }
    }
    let floor = crate::accuracy::reference::FLOOR * scene.standard_error(family.target);
    if floor > 0.0 {
        guides.push(Guide::at("noise", floor));
    }
    let odd = if family.name == "lights" { ODD } else { "" };
    let theory = if family.series.iter().any(|line| line.slope.is_some()) { SLOPES } else { "" };
    Chart {
        title: format!("{}: error against {}", scene.scene.scene, family.counted),
        x: log(family.counted, ""),
        y: log("RMSE", ""),
        series: family.series.iter().map(|series| line(series, |p| p.x)).collect(),
        guides,
        caption: format!(
            "{theory}{odd}Below the line `noise`, an error is not distinguishable from that of the reference."
        ),
    }
}

/// The error against time.
pub(super) fn against_time(family: &FamilyFindings, scene: &SceneFindings) -> Chart {
    Chart {
        title: format!("{}: error against time, {}", scene.scene.scene, family.title.to_lowercase()),
        x: log("time", "s"),
        y: log("RMSE", ""),
        series: family.series.iter().map(|series| line(series, |p| p.seconds.median)).collect(),
        guides: Vec::new(),
        caption: "Median time of tracing, without loading and building; whiskers are intervals of the error.".to_owned(),
    }
}

fn bounces(family: &FamilyFindings) -> Chart {
    Chart {
        title: "Error against the number of mirror bounces".to_owned(),
        x: Axis::new(family.counted, "", Scale::Linear),
        y: log("RMSE", ""),
        series: family.series.iter().map(|series| line(series, |p| p.x)).collect(),
        guides: Vec::new(),
        caption: "With the scene's own samples. The last point has all bounces: only sampling contributes to its \
                  error."
            .to_owned(),
    }
}

/// Seconds by precision, effect and pass, with the time before the first ray.
pub(super) fn time(scene: &SceneFindings) -> Chart {
    let mut bars = Vec::new();
    for LayersFindings { precision, parts } in &scene.layers {
        if let Some(stage) = scene.stages.iter().find(|s| s.precision == *precision) {
            let Stages { load, build } = stage.before;
            let stages = vec![("load".to_owned(), load), ("build".to_owned(), build)];
            bars.push((format!("{precision}, before"), stages));
        }
        let bar = |part: &PartFindings| {
            let passes = part.passes.iter().map(|(pass, seconds)| (pass.to_string(), *seconds));
            (format!("{precision}, {}", part.effect), passes.collect())
        };
        bars.extend(parts.iter().map(bar));
    }
    Chart::bars(
        format!("{}: time by precision, effect and pass", scene.scene.scene),
        "With the scene's own samples. Each effect shows the time that it adds to the effects above it; `camera rays` is \
         one ray through the centre of each pixel, without lights. Passes are summed over threads; loading and building \
         are wall-clock times.",
        &bars,
    )
}
