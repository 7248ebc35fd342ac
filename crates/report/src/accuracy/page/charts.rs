//! Findings as charts.

use crate::accuracy::findings::{FamilyFindings, PointFindings, SceneFindings, SeriesFindings};
use crate::accuracy::layers::{LayersFindings, PartFindings};
use crate::accuracy::presets::PresetFindings;
use crate::accuracy::subject::Stages;
use crate::plot::number::figure;
use crate::plot::{Axis, Chart, Course, Draw, Guide, Icicle, Part, Point, Scale, Series};

/// The charts of a family, each with its file name.
pub(super) fn of(family: &FamilyFindings, scene: &SceneFindings) -> Vec<(String, Chart)> {
    let name = family.name;
    match name {
        "precision" => Vec::new(),
        "bounces" => vec![(name.to_owned(), bounces(family))],
        _ => vec![
            (format!("{name}-samples"), against_samples(family, scene)),
            (format!("{name}-time"), against_time(family)),
            (format!("{name}-seen"), seen(family)),
            (format!("{name}-efficiency"), efficiency(family)),
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
        let through = [first.x, first.rmse.value];
        for (name, slope) in [("\u{2212}1/2", -0.5), ("\u{2212}3/4", -0.75), ("\u{2212}1", -1.0)] {
            guides.push(Guide { name: name.to_owned(), course: Course::Power { slope, through } });
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

/// The error against time, with the Pareto front.
fn against_time(family: &FamilyFindings) -> Chart {
    let mut series: Vec<Series> =
        family.series.iter().map(|series| line(series, |p| p.seconds.median)).collect();
    let all = family.series.iter().flat_map(|series| &series.points);
    let mut front: Vec<Point> =
        all.filter(|p| p.front).map(|p| point(p, p.seconds.median)).collect();
    front.sort_by(|a, b| a.x.total_cmp(&b.x));
    series.push(Series { name: "Pareto front".to_owned(), draw: Draw::Front, points: front });
    Chart {
        title: format!("{}: error against time", family.title),
        x: log("time", "s"),
        y: log("RMSE", ""),
        series,
        guides: Vec::new(),
        caption: "Median time of tracing, without loading and building. The Pareto front joins the settings that no \
                  other beats in both time and error."
            .to_owned(),
    }
}

/// The visible difference (FLIP) against time.
fn seen(family: &FamilyFindings) -> Chart {
    let point = |p: &PointFindings| {
        let label = super::tables::points_of(&p.label);
        Point::new(p.seconds.median, p.flip).within(p.flip, p.flip_95).labelled(label)
    };
    let line = |series: &SeriesFindings| {
        let points = series.points.iter().map(point).collect();
        Series { name: series.name.clone(), draw: Draw::Line, points }
    };
    Chart {
        title: format!("{}: visible difference", family.title),
        x: log("time", "s"),
        y: log("FLIP", ""),
        series: family.series.iter().map(line).collect(),
        guides: Vec::new(),
        caption: "Mean FLIP over the image; whiskers reach to the 95th percentile.".to_owned(),
    }
}

/// Efficiency against the count.
fn efficiency(family: &FamilyFindings) -> Chart {
    let point = |p: &PointFindings| {
        let e = p.efficiency_in_all.filter(|_| p.above_noise)?;
        let alone = p.efficiency.map(|e| format!(", {} of tracing alone", figure(e.value)));
        let label = super::tables::points_of(&p.label) + &alone.unwrap_or_default();
        Some(Point::new(p.x, e.value).within(e.low, e.high).labelled(label))
    };
    let line = |series: &SeriesFindings| {
        let points = series.points.iter().filter_map(point).collect();
        Series { name: series.name.clone(), draw: Draw::Line, points }
    };
    Chart {
        title: format!("{}: efficiency", family.title),
        x: log(family.counted, ""),
        y: log("1 / (MSE x time)", "1/s"),
        series: family.series.iter().map(line).collect(),
        guides: Vec::new(),
        caption: "For loading, building and tracing together; higher is better. With independent points, efficiency \
                  is constant once tracing takes most of the time."
            .to_owned(),
    }
}

/// Multiples of a scene's own samples for which presets are compared, as powers of two.
const MULTIPLES: std::ops::RangeInclusive<i32> = -6..=12;

/// Building and tracing with each preset, for increasing numbers of samples.
pub(super) fn presets(scene: &SceneFindings) -> Chart {
    let line = |preset: &PresetFindings| {
        let point = |power| {
            let samples = libm::exp2(f64::from(power));
            Point::new(samples, preset.in_all(samples))
        };
        let points = MULTIPLES.map(point).collect();
        Series { name: preset.preset.clone(), draw: Draw::Line, points }
    };
    let words = |(index, (from, name)): (usize, &(f64, String))| match index {
        0 => format!("`{name}` is fastest for few samples"),
        _ => format!("`{name}` from {} times the scene's own samples", figure(*from)),
    };
    let words: Vec<String> = scene.crossings.iter().enumerate().map(words).collect();
    Chart {
        title: "Building and tracing by BVH preset".to_owned(),
        x: log("samples, relative to the scene's own", ""),
        y: log("time", "s"),
        series: scene.presets.iter().map(line).collect(),
        guides: Vec::new(),
        caption: format!(
            "Median time of building, plus that of tracing in proportion to the samples: {}.",
            words.join(", ")
        ),
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
pub(super) fn time(scene: &SceneFindings) -> Icicle {
    let passes = |part: &PartFindings| {
        part.passes.iter().map(|(name, seconds)| Part::new(name, *seconds)).collect()
    };
    let precision = |layers: &LayersFindings| {
        let mut parts = Vec::new();
        if let Some(stage) = scene.stages.iter().find(|s| s.precision == layers.precision) {
            let Stages { load, build } = stage.before;
            parts.extend([Part::new("load", load), Part::new("build", build)]);
        }
        parts.extend(layers.parts.iter().map(|part| Part::of(&part.effect, passes(part))));
        Part::of(&layers.precision, parts)
    };
    Icicle {
        title: format!("{}: time by precision, effect and pass", scene.scene.scene),
        levels: ["precision", "effect", "pass"].map(str::to_owned).to_vec(),
        parts: scene.layers.iter().map(precision).collect(),
        caption: "With the scene's own samples. Each effect shows the time that it adds to the effects on its left; \
                  `camera rays` is one ray through the centre of each pixel, without lights. Passes are summed over \
                  threads; loading and building are wall-clock times."
            .to_owned(),
    }
}
