//! What the reader came for, on the first screen.

use crate::accuracy::Findings;
use crate::accuracy::answer::{Answer, AtError, Price};
use crate::accuracy::findings::SceneFindings;
use crate::effects::PriceList;
use crate::page::{Block, Cell, Table};
use crate::plot::number::{figure, seconds};

/// Which scenes, and at which size.
pub(super) fn lead(findings: &Findings) -> String {
    let name = |scene: &SceneFindings| {
        let [width, height] = scene.scene.size;
        format!("{} at {width} x {height} pixels", scene.scene.scene)
    };
    let names: Vec<String> = findings.scenes.iter().map(name).collect();
    format!("Error against time for {}.", names.join(", "))
}

/// What errors cost in each scene, and what precision and effects add.
pub(super) fn blocks(findings: &Findings) -> Vec<Block> {
    let answers = || findings.scenes.iter().map(|scene| (scene, &scene.answer));
    let rows = answers().flat_map(|(scene, a)| a.errors.iter().map(move |e| row(scene, a, e)));
    let caption = "To an error (root mean square of linear values): the quickest sampler, its points, the seconds of \
                   loading, building and tracing, and how many times as fast as with random points tracing is";
    let header = "scene|>error|sampler|>points|>seconds in all|>times as fast as random";
    let mut blocks = vec![Block::Table(Table::new(caption, header, rows.collect()))];
    blocks.extend(answers().map(|(scene, answer)| Block::paragraph(costs(scene, answer))));
    blocks
}

fn row(scene: &SceneFindings, answer: &Answer, at: &AtError) -> Vec<Cell> {
    let missing = || Cell::text("not reached");
    let points = at.points.map(|n| format!("{} {}", figure(n as f64), per(answer.counted)));
    let faster = at.times_as_fast.map(|ratio| {
        let least = if at.at_least { "at least " } else { "" };
        let text = format!("{least}{:.1} ({:.1} to {:.1})", ratio.value, ratio.low, ratio.high);
        Cell::number(ratio.value, text)
    });
    vec![
        Cell::text(scene.scene.scene.clone()),
        Cell::number(at.error, at.error.to_string()),
        at.sampler.clone().map_or_else(missing, Cell::text),
        points.map_or_else(missing, |text| Cell::number(at.points.unwrap_or(0) as f64, text)),
        at.seconds.map_or_else(missing, |s| Cell::number(s, seconds(s))),
        faster.unwrap_or_else(missing),
    ]
}

/// What is counted, as it stands after a number: "a light" of "points on each light".
fn per(counted: &str) -> &str {
    counted.strip_prefix("points ").or(counted.strip_prefix("rays ")).unwrap_or(counted)
}

/// What precision and effects cost in a scene, in sentences.
fn costs(scene: &SceneFindings, answer: &Answer) -> String {
    let times = |price: &Price| {
        let r = price.ratio;
        format!("{} takes {:.2} ({:.2} to {:.2})", price.name, r.value, r.low, r.high)
    };
    let mut sentences = Vec::new();
    for price in &answer.precisions {
        let worst =
            price.worst_t.map(|ulp| format!(", and its worst t is {} ulp off", figure(ulp)));
        let worst = worst.unwrap_or_default();
        sentences.push(format!("{} times as long as fast{worst}", times(price)));
    }
    if let Some(effect) = answer.effects.first() {
        let r = effect.ratio;
        sentences.push(format!(
            "of its effects {} cost most, {:.2} ({:.2} to {:.2}) times as long as with one point for them or without",
            effect.name, r.value, r.low, r.high
        ));
    }
    if let Some(pass) = &answer.pass {
        let share = answer.share * 100.0;
        sentences
            .push(format!("most of the time of tracing, {share:.0} per cent, goes into `{pass}`"));
    }
    format!("{}: {}.", scene.scene.scene, sentences.join("; "))
}

/// The dearest effect of the price list.
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
        "Of all effects, added one at a time to a small scene, {} costs most: {ratio:.1} times as long as {to} alone.",
        price.effect
    )))
}
