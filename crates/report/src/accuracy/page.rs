//! The report: an HTML page, and its charts as SVG, PNG, CSV and JSON.

mod answers;
mod charts;
mod tables;
mod trust;
mod yields;

use std::path::Path;

use super::Findings;
use super::crops::{Crop, Crops, Equal, crops, large};
use super::findings::{FamilyFindings, SceneFindings};
use super::pilot::Axis;
use super::prices::{folder, prices};
use super::sweep::Swept;
use super::{presets, spread};
use crate::files::{to_json, write_text};
use crate::page::{Block, Compare, Fact, Page, Picture, Section};
use crate::plot::figure::Figure;
use crate::plot::number::figure;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_image::error_map::{MapKind, error_map};
use wavecrest_image::write::{Transfer, png};

/// The width of charts as PNG, in pixels.
const CHART_WIDTH: u32 = 1200;

/// Writes `findings` to the folder `results`: `report.html`, and each chart in four forms. With
/// `effects` it also measures the cost of each effect.
///
/// # Errors
/// If a file cannot be written, or a scene can no longer be rendered for its crops.
pub fn write(
    findings: &Findings,
    swept: &mut [Swept],
    results: &Path,
    effects: bool,
) -> Result<()> {
    let mut sections = Vec::new();
    for (scene, swept) in findings.scenes.iter().zip(swept) {
        sections.push(section(scene, swept, results)?);
    }
    let mut first = answers::blocks(findings);
    if effects {
        let prices = prices(folder()?.path())?;
        let json = to_json(&prices).map_err(|e| e.in_file(results))?;
        write_text(&results.join("effects.json"), &json)?;
        first.extend(answers::dearest(&prices));
        sections.push(Section::new("Cost of each effect", crate::effects::blocks(&prices)));
    }
    sections.push(Section::new("Errors of hits in hard cases", yields::by_situation()));
    sections.extend(trust::section(findings));
    sections.push(about(findings));
    let (title, lead) = ("What accuracy costs in time".to_owned(), answers::lead(findings));
    Page { title, lead, first, sections }.write(&results.join("report.html"))
}

/// The circumstances of the measurement: machine, program and command.
fn about(findings: &Findings) -> Section {
    let mut blocks = vec![Block::paragraph(format!(
        "Each setting was rendered {} times with different random numbers, all settings of a scene in random order. \
         Errors are against a reference in exact arithmetic; an error below three standard errors of the reference \
         counts as noise. Intervals have 95 per cent confidence.",
        findings.seeds
    ))];
    let mut distinct = findings.circumstances.clone();
    // Entries of a resumed sweep with the same command are shown once.
    distinct.dedup();
    for circumstances in &distinct {
        let of = |key: &str| match &circumstances.machine[key] {
            serde_json::Value::Null => "unknown".to_owned(),
            serde_json::Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        blocks.push(Block::Facts(vec![
            Fact::new("Processor", of("processor")),
            Fact::new("Cores, threads", format!("{}, {}", of("cores"), of("threads"))),
            Fact::new("System", of("os")),
            Fact::new("wavecrest", findings.header.version.clone()),
            Fact::new("Commit", circumstances.commit.clone().unwrap_or_else(|| "unknown".into())),
        ]));
        blocks.push(Block::Code(command(&circumstances.command)));
    }
    Section::new("How it was measured", blocks)
}

/// The arguments as typed, with only the name of the program.
fn command(arguments: &[String]) -> String {
    let mut words = vec!["wavecrest".to_owned()];
    for argument in arguments.iter().skip(1) {
        let is_plain = argument.chars().all(|c| c.is_ascii_alphanumeric() || "-_./,=:".contains(c));
        words.push(if is_plain { argument.clone() } else { format!("'{argument}'") });
    }
    words.join(" ")
}

fn section(scene: &SceneFindings, swept: &mut Swept, folder: &Path) -> Result<Section> {
    let [width, height] = scene.scene.size;
    let mut blocks = vec![Block::paragraph(format!(
        "{width} x {height} pixels, {} primitives. {}",
        scene.scene.primitives,
        tables::references(scene)
    ))];
    for family in &scene.families {
        blocks.push(Block::Heading(family.title.to_owned()));
        for (name, chart) in charts::of(family, scene) {
            write_chart(&chart, &folder.join(format!("{}-{name}", scene.scene.scene)))?;
            blocks.push(Block::Chart(chart));
        }
        blocks.extend(tables::of(family));
        blocks.extend(pictures(family, swept)?);
    }
    blocks.push(Block::Heading("Where the time goes".to_owned()));
    let time = charts::time(scene);
    write_chart(&time, &folder.join(format!("{}-layers", scene.scene.scene)))?;
    blocks.push(Block::Icicle(time));
    if presets::matter(&scene.presets) {
        blocks.push(Block::Chart(charts::presets(scene)));
    }
    blocks.push(Block::Heading("Bias and variance".to_owned()));
    blocks.extend(trust::spread(scene));
    blocks.extend(standard_errors(scene, swept)?);
    blocks.push(Block::Heading("Cost and accuracy of each precision".to_owned()));
    blocks.extend(yields::sentence(scene));
    blocks.extend(tables::precision(scene));
    blocks.extend(tables::steps(scene));
    for (name, chart) in yields::charts(scene) {
        write_chart(&chart, &folder.join(format!("{}-{name}", scene.scene.scene)))?;
        blocks.push(Block::Chart(chart));
    }
    blocks.push(Block::Heading("Settings that must not change the image".to_owned()));
    blocks.extend(tables::neutral(scene));
    Ok(Section::new(scene.scene.scene.clone(), blocks))
}

/// The standard error of each pixel, for each sampler.
fn standard_errors(scene: &SceneFindings, swept: &mut Swept) -> Result<Vec<Block>> {
    let Swept { subject, families, .. } = swept;
    let main = Axis::of(&subject.facts()).family();
    let mut films = Vec::new();
    for line in families.iter().filter(|f| f.name == main).flat_map(|family| &family.series) {
        let measured = |key: &str| scene.spread.iter().any(|s| s.key == key);
        if let Some((_, count, setting)) = line.points.iter().find(|p| measured(&p.2.key())) {
            let words = format!("{}, {}", line.name, tables::points_of(count));
            films.push((words, spread::map(subject, setting)?));
        }
    }
    let black = Film::new(subject.size()[0], subject.size()[1])?;
    let ends = large(films.iter().map(|(_, film)| film), &black);
    let gain = if ends > 0.0 { 1.0 / (ends * ends) } else { 1.0 };
    let map = |(words, film): &(String, Film)| {
        let map = error_map(film, &black, MapKind::Squared, gain as f32)?;
        picture(&map, format!("{words}: standard error"))
    };
    let maps = films.iter().map(map).collect::<Result<Vec<_>>>()?;
    let words = format!(
        "Variance of each pixel in one render: black is none, the lightest colour a standard error of {} or more.",
        figure(ends)
    );
    Ok(if maps.is_empty() {
        Vec::new()
    } else {
        vec![Block::paragraph(words), Block::Pictures(maps)]
    })
}

/// A chart in four forms.
fn write_chart(chart: &impl Figure, stem: &Path) -> Result<()> {
    let with = |extension: &str| stem.with_extension(extension);
    write_text(&with("svg"), &chart.svg())?;
    write_text(&with("csv"), &chart.csv())?;
    write_text(&with("json"), &to_json(chart).map_err(|e| e.in_file(stem))?)?;
    chart.png(&with("png"), CHART_WIDTH)
}

/// Crops of a family's samplers in equal time, and at equal error.
fn pictures(found: &FamilyFindings, swept: &mut Swept) -> Result<Vec<Block>> {
    let Swept { subject, families, references } = swept;
    let family = families.iter().find(|f| f.name == found.name && f.has_slope);
    let (Some(family), Some(reference)) = (family, references.get(found.target.name())) else {
        return Ok(Vec::new());
    };
    let mut blocks = Vec::new();
    for equal in [Equal::Time, Equal::Error] {
        if let Some(crops) = crops(subject, family, found, reference, equal)? {
            blocks.extend(side_by_side(&crops, equal)?);
        }
    }
    Ok(blocks)
}

fn side_by_side(Crops { reference, crops, ends }: &Crops, equal: Equal) -> Result<Vec<Block>> {
    let title = match equal {
        Equal::Time => "in equal time",
        Equal::Error => "at equal error",
    };
    let mut row = vec![picture(reference, "reference".to_owned())?];
    let mut maps = vec![scale(reference, *ends)?];
    for crop in crops {
        row.push(picture(&crop.film, words(crop))?);
        maps.push(picture(&crop.map, format!("{}: error", crop.name))?);
    }
    let mut blocks = vec![
        Block::paragraph(format!(
            "The part of the image where the first sampler has its largest error, {title}; the errors are below. \
             Click an image to zoom into the row."
        )),
        Block::Pictures(row),
        Block::Pictures(maps),
    ];
    if let [first, .., last] = crops.as_slice() {
        blocks.push(Block::Compare(Compare {
            left: picture(&first.whole, words(first))?,
            right: picture(&last.whole, words(last))?,
            caption: format!("The whole image, {title}."),
        }));
    }
    Ok(blocks)
}

/// The colour scale of signed errors, the size of the crops beside it.
fn scale(like: &Film, end: f64) -> Result<Picture> {
    let [width, height] = [like.width(), like.height()];
    let value = |x: u32| (2.0 * x as f32 + 1.0) / width as f32 - 1.0;
    let ramp = (0..height).flat_map(|_| (0..width).map(|x| [value(x); 3])).collect();
    let ramp = Film::from_pixels(width, height, ramp)?;
    let map = error_map(&ramp, &Film::new(width, height)?, MapKind::Signed, 1.0)?;
    let caption = format!("scale of the error, from \u{2212}{0} to {0}", figure(end));
    picture(&map, caption)
}

fn words(crop: &Crop) -> String {
    let Crop { name, point, .. } = crop;
    let (points, time) = (tables::points_of(&point.label), point.seconds.median * 1e3);
    format!("{name}, {points}, {time:.1} ms, error {}", figure(point.rmse.value))
}

fn picture(film: &Film, caption: String) -> Result<Picture> {
    let alt = format!("Rendered image: {caption}");
    Ok(Picture { png: png(film, Transfer::Linear)?, alt, caption, pixels: true })
}
