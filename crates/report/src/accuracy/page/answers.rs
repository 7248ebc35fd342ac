//! The answer, on the first screen.

use crate::accuracy::Findings;
use crate::accuracy::answer::{Answer, AtError, Price};
use crate::accuracy::findings::SceneFindings;
use crate::accuracy::fit::Interval;
use crate::effects::PriceList;
use crate::page::{Block, Cell, Table};
use crate::plot::number::{figure, seconds};
use wavecrest_core::kernels::precision::Precision;

/// The scenes and the sizes of their images.
pub(super) fn lead(findings: &Findings) -> String {
    let name = |scene: &SceneFindings| {
        let [width, height] = scene.scene.size;
        format!("{} at {width} x {height} pixels", scene.scene.scene)
    };
    let names: Vec<String> = findings.scenes.iter().map(name).collect();
    format!("Error against time for {}.", names.join(", "))
}

/// The costs of errors in each scene, and of precision and effects.
pub(super) fn blocks(findings: &Findings) -> Vec<Block> {
    let answers = || findings.scenes.iter().map(|scene| (scene, &scene.answer));
    let rows = answers().flat_map(|(scene, a)| a.errors.iter().map(move |e| row(scene, a, e)));
    let caption = "The fastest measured setting that reaches each error (RMSE of linear values): the sampler, its points, \
                   its time of loading, building and tracing, and the speedup of tracing over random points";
    let header = "scene|>error|sampler|>points|>total time|>speedup over random";
    vec![Block::Table(Table::new(caption, header, rows.collect())), costs(findings)]
}

fn row(scene: &SceneFindings, answer: &Answer, at: &AtError) -> Vec<Cell> {
    let missing = || Cell::text("not reached");
    let points = at.points.map(|n| format!("{} {}", figure(n as f64), per(answer.counted)));
    let faster = at.times_as_fast.map(|ratio| Cell::number(ratio.value, speedup(at, &ratio)));
    vec![
        Cell::text(scene.scene.scene.clone()),
        Cell::number(at.error, at.error.to_string()),
        at.sampler.clone().map_or_else(missing, Cell::text),
        points.map_or_else(missing, |text| Cell::number(at.points.unwrap_or(0) as f64, text)),
        at.seconds.map_or_else(missing, |s| Cell::number(s, seconds(s))),
        faster.unwrap_or_else(missing),
    ]
}

/// The speedup over random points, or a lower bound.
fn speedup(at: &AtError, ratio: &Interval) -> String {
    let &Interval { value, low, high } = ratio;
    match at.at_least {
        true if value >= 1.0 => format!("above {value:.1}; random did not reach this error"),
        true => "random did not reach it".to_owned(),
        false if low == high => format!("{value:.1}"),
        false => format!("{value:.1} ({low:.1} to {high:.1})"),
    }
}

/// The counted item after a number: "a light" for "points on each light".
fn per(counted: &str) -> &str {
    counted.strip_prefix("points ").or(counted.strip_prefix("rays ")).unwrap_or(counted)
}

/// The costs of precision and effects in each scene.
fn costs(findings: &Findings) -> Block {
    let missing = || Cell::text("-");
    let ratio = |price: &Price| {
        let Interval { value, low, high } = price.ratio;
        let decimals = if value < 10.0 { 2 } else { 1 };
        Cell::number(value, format!("{value:.decimals$} ({low:.decimals$} to {high:.decimals$})"))
    };
    let row = |scene: &SceneFindings| {
        let Answer { precisions, effects, pass, share, .. } = &scene.answer;
        let of = |precision: Precision| precisions.iter().find(|p| p.name == precision.name());
        let exact = of(Precision::Exact);
        let worst = exact.and_then(|price| price.worst_t);
        let effect = effects.first();
        let share = |name: &String| format!("`{name}`, {:.0}%", share * 100.0);
        vec![
            Cell::text(scene.scene.scene.clone()),
            exact.map_or_else(missing, ratio),
            worst.map_or_else(missing, |ulp| Cell::decimals(ulp, 1)),
            effect.map_or_else(missing, |effect| Cell::text(effect.name.clone())),
            effect.map_or_else(missing, ratio),
            pass.as_ref().map_or_else(missing, |name| Cell::text(share(name))),
        ]
    };
    let caption = "Cost of precision and effects, as ratios of tracing time: `exact` over `fast`, and the scene \
                   over the same scene without its most expensive effect, or with one point for it. Also the \
                   largest error of t in `exact`, in ulp, and the pass that takes the most time";
    let header = "scene|>exact|>error of t|most expensive effect|>its cost|longest pass";
    Block::Table(Table::new(caption, header, findings.scenes.iter().map(row).collect()))
}

/// The most expensive effect.
pub(super) fn dearest(prices: &PriceList) -> Option<Block> {
    let ratio = |price: &crate::effects::Price| {
        price.wavefront.price.as_ref().map(|ratio| ratio.interval.median)
    };
    let reached = prices.effects.iter().filter(|price| price.reached);
    let (price, ratio) = reached
        .filter_map(|price| Some((price, ratio(price)?)))
        .max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let to = price.added_to.unwrap_or("nothing");
    Some(Block::paragraph(format!(
        "Of all effects, each added on its own to a small scene, {} is the most expensive: the scene takes {ratio:.1} \
         times as long as with {to} only.",
        price.effect
    )))
}
