//! The errors of hits in each precision.

use crate::accuracy::findings::SceneFindings;
use crate::accuracy::store::TrialRecord;
use crate::page::{Block, Cell, Table};
use crate::plot::{Axis, Chart, Draw, Point, Scale, Series};
use crate::selftest::errors::{Distribution, HitErrors, SITUATIONS, SIZES, ulps};
use crate::selftest::{Count, Effort};
use wavecrest_core::kernels::precision::Precision;

/// A sentence for each precision: its cost, and its worst hit.
pub(super) fn sentence(scene: &SceneFindings) -> Option<Block> {
    let precisions = scene.families.iter().find(|family| family.name == "precision")?;
    let points = &precisions.series.first()?.points;
    let fast = points.first()?.seconds.median;
    let word = |p: &crate::accuracy::findings::PointFindings| {
        let errors = of(scene, &p.label)?;
        let worst = |errors: &Distribution| ulps(errors.worst);
        Some(format!(
            "`{}` takes {:.2} times as long as `fast`; its largest error of t is {}, of a point {}, of a normal {}.",
            p.label,
            p.seconds.median / fast,
            worst(&errors.t),
            worst(&errors.point),
            worst(&errors.normal)
        ))
    };
    let words: Vec<String> = points.iter().filter_map(word).collect();
    (!words.is_empty()).then(|| Block::paragraph(words.join(" ")))
}

/// The number of hits above each error in ulp, for t, points and normals in each precision.
pub(super) fn charts(scene: &SceneFindings) -> Vec<(String, Chart)> {
    let quantity = |name: &str, of: fn(&HitErrors) -> &Distribution| {
        let line = |trial: &TrialRecord| Series {
            name: trial.precision.clone(),
            draw: Draw::Line,
            points: trial.errors.as_ref().map_or_else(Vec::new, |errors| beyond(of(errors))),
        };
        let chart = Chart {
            title: format!("{}: error of {name}", scene.scene.scene),
            x: Axis::new("error above", "ulp", Scale::Log),
            y: Axis::new("share of hits", "", Scale::Log),
            series: scene.trials.iter().map(line).collect(),
            guides: Vec::new(),
            caption: "Rounding the exact value once gives an error of up to half an ulp. Each line ends at its \
                      largest error."
                .to_owned(),
        };
        (format!("errors-{}", name.replace(' ', "-")), chart)
    };
    // A single point makes no curve: the sentence above the charts has it.
    let is_worth = |chart: &Chart| chart.series.iter().any(|series| series.points.len() > 1);
    let all = [
        quantity("t", |errors| &errors.t),
        quantity("points", |errors| &errors.point),
        quantity("normals", |errors| &errors.normal),
    ];
    all.into_iter().filter(|(_, chart)| is_worth(chart)).collect()
}

/// The errors of every precision in difficult situations.
pub(super) fn by_situation() -> Vec<Block> {
    let row = |(name, precision, errors): (&str, Precision, &HitErrors)| {
        let within = |errors: &Distribution| {
            let most = errors.within(0.999).map_or(0.0, |bound| bound.min(errors.worst));
            let number = |ulp: f64| ulps(ulp).trim_end_matches(" ulp").to_owned();
            Cell::number(errors.worst, format!("{}; {}", number(most), number(errors.worst)))
        };
        let beside = errors.lost + errors.extra;
        vec![
            Cell::text(name),
            Cell::text(precision.name()),
            within(&errors.t),
            within(&errors.point),
            within(&errors.normal),
            Cell::number(beside as f64, format!("{beside} of {}", errors.t.total() + beside)),
        ]
    };
    let rows = SITUATIONS.iter().flat_map(|situation| {
        Precision::ALL.into_iter().map(move |precision| {
            let effort = Effort { precision, seed: 1, count: Count::Quick };
            row((situation.name, precision, &situation.errors(&effort)))
        })
    });
    let caption = "Errors in ulp: the bound for 999 of 1000 hits, then the largest error. The error of a point is \
                   its distance from the triangle's plane. Disputed rays pass so close to an edge that they hit the \
                   triangle in one arithmetic and miss it in the other";
    let header = "ray and triangle|precision|>t|>point|>normal|>disputed";
    vec![Block::Table(Table::new(caption, header, rows.collect()))]
}

fn of<'a>(scene: &'a SceneFindings, precision: &str) -> Option<&'a HitErrors> {
    scene.trials.iter().find(|trial| trial.precision == precision)?.errors.as_deref()
}

/// The share of errors above each bound, until it is 0.
fn beyond(errors: &Distribution) -> Vec<Point> {
    let total = errors.total();
    let mut rest = total;
    let mut points = Vec::new();
    for (index, count) in errors.counts.iter().enumerate().take(SIZES - 1) {
        rest -= count;
        if rest == 0 {
            break;
        }
        points.push(Point::new(Distribution::bound(index), rest as f64 / total as f64));
    }
    points
}
