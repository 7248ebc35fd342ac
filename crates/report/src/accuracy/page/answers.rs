//! The answer, on the first screen.

use crate::accuracy::Findings;
use crate::accuracy::answer::{Answer, AtError};
use crate::accuracy::findings::SceneFindings;
use crate::accuracy::fit::Interval;
use crate::page::{Block, Cell, Table};
use crate::plot::number::{figure, seconds};

/// The scenes and the sizes of their images.
pub(super) fn lead(findings: &Findings) -> String {
    let name = |scene: &SceneFindings| {
        let [width, height] = scene.scene.size;
        format!("{} at {width} x {height} pixels", scene.scene.scene)
    };
    let names: Vec<String> = findings.scenes.iter().map(name).collect();
    format!("Error against time for {}.", names.join(", "))
}

/// The costs of errors in each scene.
pub(super) fn blocks(findings: &Findings) -> Vec<Block> {
    let answers = || findings.scenes.iter().map(|scene| (scene, &scene.answer));
    let sentence = |(scene, answer): (&SceneFindings, &Answer)| {
        Block::Paragraph(format!("`{}`: {}", scene.scene.scene, answer.sentence()))
    };
    let rows = answers().flat_map(|(scene, a)| a.errors.iter().map(move |e| row(scene, a, e)));
    let caption = "The fastest measured setting that reaches each error (RMSE of linear values, 1 is white): its time of \
                   tracing, and that of random points; in all, with loading and building";
    let header = "scene|>error|>time|setting|>random takes|>in all";
    let table = Table::new(caption, header, rows.collect());
    answers().map(sentence).chain([Block::Table(table)]).collect()
}

fn row(scene: &SceneFindings, answer: &Answer, at: &AtError) -> Vec<Cell> {
    let missing = || Cell::text("not reached");
    let time = |time: Option<f64>| time.map_or_else(missing, |s| Cell::number(s, seconds(s)));
    let setting = at.sampler.as_ref().zip(at.points).map(|(sampler, points)| {
        let thing = answer.counted.split(' ').next().unwrap_or_default();
        Cell::text(format!("{} {sampler} {thing}", figure(points as f64)))
    });
    let random = at.times_as_fast.map(|ratio| Cell::number(ratio.value, times(at, &ratio)));
    vec![
        Cell::text(scene.scene.scene.clone()),
        Cell::number(at.error, format!("{} %", figure(at.error * 100.0))),
        time(at.tracing),
        setting.unwrap_or_else(missing),
        random.unwrap_or_else(missing),
        time(at.seconds),
    ]
}

/// The time of random points relative to the answer's, or a lower bound.
fn times(at: &AtError, ratio: &Interval) -> String {
    let &Interval { value, low, high } = ratio;
    match at.at_least {
        true if value >= 1.0 => format!("over {value:.1} times; not reached"),
        true => "not reached".to_owned(),
        false if low == high => format!("{value:.1} times"),
        false => format!("{value:.1} times ({low:.1} to {high:.1})"),
    }
}
