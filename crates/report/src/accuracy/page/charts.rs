//! Results as charts.

use crate::accuracy::report::{SceneAccuracy, SettingResult};
use crate::accuracy::setting::Family;
use crate::plot::number::plural;
use crate::plot::{self, Chart, ChartAxis, Draw, Guide, Scale, Series};

/// The charts of a family, each with its file name.
pub(super) fn of(family: &Family<SettingResult>, scene: &SceneAccuracy) -> Vec<(String, Chart)> {
    let name = family.name;
    match name {
        "bounces" => vec![(name.to_owned(), bounces(family))],
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

fn bounces(family: &Family<SettingResult>) -> Chart {
    let title = "Error against the number of bounces".to_owned();
    let caption = "With the scene's own samples. The last point has all bounces: only sampling contributes to its \
                   error.";
    let axis = ChartAxis::new(&family.counted, "", Scale::Linear);
    chart(title, family, axis, |p| p.x, caption.to_owned())
}

/// The error of a family along an axis of a value of each setting.
fn chart(
    title: String,
    family: &Family<SettingResult>,
    axis: ChartAxis,
    x: fn(&SettingResult) -> f64,
    caption: String,
) -> Chart {
    let series = family.series.iter().map(|line| Series {
        name: line.name.clone(),
        draw: Draw::Line,
        points: line.points.iter().map(|p| mark(p, x(p))).collect(),
    });
    let (series, guides) = (series.collect(), Vec::new());
    Chart { title, x: axis, y: log("RMSE", ""), series, guides, caption }
}

/// A setting with the interval of its error.
fn mark(p: &SettingResult, x: f64) -> plot::Point {
    let noise = if p.above_noise { "" } else { ", below the noise of the reference" };
    let points = plural(p.x as usize, "point");
    let label = format!("{points}, {:.3} ms{noise}", p.seconds.median * 1e3);
    plot::Point { x, y: p.rmse.value, low: p.rmse.low, high: p.rmse.high, label }
}
