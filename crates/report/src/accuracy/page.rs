//! The report: an HTML page, and its charts as SVG and CSV.

mod crops;
mod figures;

use std::path::Path;

use super::AccuracyReport;
use super::report::{FastestSetting, FastestSettings, SceneAccuracy};
use super::subject::Subject;
use crate::bench::page::recorded;
use crate::files::{to_json, write_text};
use crate::measure::{busy, waiting};
use crate::page::{Block, Cell, Page, Section, Table};
use crate::plot::number::{figure, seconds};
use crate::summary::Uncertain;
use wavecrest_base::error::Result;

/// Writes `report` to the folder `results`: `accuracy.json`, `report.html`, and each chart as SVG and CSV.
///
/// # Errors
/// If a file cannot be written, or a scene can no longer be rendered for its crops.
pub fn write(report: &AccuracyReport, swept: &mut [Subject], results: &Path) -> Result<()> {
    let file = results.join("accuracy.json");
    write_text(&file, &to_json(report).map_err(|e| e.in_file(&file))?)?;
    let mut first = Vec::from_iter(disturbed(report.scenes.iter()).map(Block::Warning));
    first.extend(answers(report));
    let mut sections = Vec::new();
    for (scene, subject) in report.scenes.iter().zip(swept) {
        // What each time buys: the chart of the answer's samplers, and crops.
        if let Some(family) = scene.family(scene.answer.family) {
            first.push(Block::Chart(figures::against_time(family, scene)));
            first.extend(crops::rows(subject, family, &scene.answer)?);
        }
        sections.push(section(scene, results)?);
    }
    sections.push(about(report));
    let (title, lead) = ("What accuracy costs in time".to_owned(), lead(report));
    Page { title, lead, first, sections }.write(&results.join("report.html"))
}

/// That the machine was busy, in some rounds or all the time.
fn disturbed<'a>(scenes: impl Iterator<Item = &'a SceneAccuracy> + Clone) -> Option<String> {
    busy(scenes.clone().map(|scene| scene.rounds))
        .or_else(|| waiting(scenes.filter_map(|scene| scene.share)))
}

/// The answers, and for each scene the slopes: for a terminal.
pub fn summary(report: &AccuracyReport) -> Vec<Block> {
    let mut blocks = answers(report);
    for scene in &report.scenes {
        blocks.push(Block::Heading(scene.scene.scene.clone()));
        blocks.extend(scene.families.iter().filter_map(figures::slopes).map(Block::Table));
    }
    blocks
}

/// The circumstances of the measurement: machine, program and command.
fn about(report: &AccuracyReport) -> Section {
    let mut blocks = vec![Block::Paragraph(format!(
        "Each setting was rendered {} times with different random numbers, all settings of a scene in random order. \
         Errors are against a reference in exact arithmetic; an error below three standard errors of the reference \
         counts as noise. Intervals have 95 per cent confidence.",
        report.seeds
    ))];
    let mut distinct = report.circumstances.clone();
    // Entries of a resumed sweep with the same command are shown once.
    distinct.dedup();
    for circumstances in &distinct {
        let arguments = circumstances.command.get(1..).unwrap_or_default();
        blocks.extend(recorded(circumstances, &report.header.version, arguments));
    }
    Section::new("How it was measured", blocks)
}

fn section(scene: &SceneAccuracy, folder: &Path) -> Result<Section> {
    let [width, height] = scene.scene.size;
    let mut blocks = vec![Block::Paragraph(format!(
        "{width} x {height} pixels, {} primitives. {}",
        scene.scene.primitives,
        figures::references(scene)
    ))];
    let answered = format!("{}-time", scene.answer.family);
    for family in scene.families.iter().filter(|family| family.name != "precision") {
        blocks.push(Block::Heading(family.title.to_owned()));
        for (name, chart) in figures::charts(family, scene) {
            chart.write(folder, &format!("{}-{name}", scene.scene.scene))?;
            // The answer's is on the first screen.
            if name != answered {
                blocks.push(Block::Chart(chart));
            }
        }
        blocks.extend(figures::tables(family));
    }
    blocks.push(Block::Heading("Cost and accuracy of each precision".to_owned()));
    blocks.extend(figures::precision(scene));
    Ok(Section::new(scene.scene.scene.clone(), blocks))
}

/// The scenes and the sizes of their images.
fn lead(report: &AccuracyReport) -> String {
    let name = |scene: &SceneAccuracy| {
        let [width, height] = scene.scene.size;
        format!("{} at {width} x {height} pixels", scene.scene.scene)
    };
    let names: Vec<String> = report.scenes.iter().map(name).collect();
    format!("Error against time for {}.", names.join(", "))
}

/// The costs of errors in each scene.
fn answers(report: &AccuracyReport) -> Vec<Block> {
    let all = || report.scenes.iter().map(|scene| (scene, &scene.answer));
    let sentence = |(scene, answer): (&SceneAccuracy, &FastestSettings)| {
        let busy = disturbed([scene].into_iter());
        let busy = busy.map_or_else(String::new, |words| format!(" {words}."));
        let name = &scene.scene.scene;
        Block::Paragraph(format!("`{name}`: {}{busy}", answer.sentence()))
    };
    let rows = all().flat_map(|(scene, a)| a.errors.iter().map(move |e| row(scene, a, e)));
    let caption = "The fastest measured setting that reaches each error (RMSE of linear values, 1 is white): its time of \
                   tracing, and that of random points; in all, with loading and building";
    let header = "scene|>error|>time|setting|>random takes|>in all";
    let table = Table::new(caption, header, rows.collect());
    all().map(sentence).chain([Block::Table(table)]).collect()
}

fn row(scene: &SceneAccuracy, answer: &FastestSettings, at: &FastestSetting) -> Vec<Cell> {
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
fn times(at: &FastestSetting, ratio: &Uncertain) -> String {
    match at.at_least {
        true if ratio.value >= 1.0 => format!("over {}; not reached", ratio.times()),
        true => "not reached".to_owned(),
        false => ratio.times(),
    }
}
