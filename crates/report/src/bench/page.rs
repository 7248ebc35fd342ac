//! A benchmark as a page: the results, then each scene, then the method.

mod compared;
mod parts;
mod scene;

use self::parts::{Both, interval, ratio_cell, ratio_chart, speed};
use super::machine::Machine;
use super::report::{BenchReport, SceneBench};
use super::tracer::{METHOD, Ratio};
use super::words::plural;
use crate::page::{Block, Cell, Fact, Page, Section, Table};
use crate::plot::number::figure;
use crate::plot::{Axis, Chart, Point, Scale, Series};

/// The page of a report.
pub fn page(report: &BenchReport) -> Page {
    let mut sections = Vec::new();
    sections.extend(overview(&report.scenes));
    sections.extend(report.scenes.iter().map(scene::section));
    sections.push(measured(report));
    let title = "Wavefront against recursive".to_owned();
    Page { title, lead: lead(&report.scenes), sections, ..Page::default() }
}

/// The results in a few sentences.
fn lead(scenes: &[SceneBench]) -> String {
    let ratios: Vec<&Ratio> = scenes.iter().filter_map(|scene| scene.ratio.as_ref()).collect();
    let mut sentences = Vec::new();
    match ratios[..] {
        [] => {}
        [only] => sentences.push(speed(only)),
        _ => {
            let faster = |is_so: fn(&Ratio) -> bool| ratios.iter().filter(|r| is_so(r)).count();
            let wavefront = faster(|r| r.verdict() == "the wavefront is faster");
            let recursive = faster(|r| r.verdict() == "the recursive tracer is faster");
            let medians = ratios.iter().map(|ratio| ratio.interval.median);
            let least = medians.clone().fold(f64::INFINITY, f64::min);
            let most = medians.fold(0.0, f64::max);
            sentences.push(format!(
                "Of {}, the wavefront is faster in {wavefront} and the recursive tracer in {recursive}; in {} the \
                 difference is within noise. The wavefront is {least:.3} to {most:.3} times as fast as the recursive \
                 tracer.",
                plural(ratios.len(), "scene"),
                ratios.len() - wavefront - recursive,
            ));
        }
    }
    let different = scenes.iter().filter(|scene| !scene.equal).count();
    sentences.push(match different {
        0 if scenes.is_empty() => "Nothing was measured.".to_owned(),
        0 => "All images are bit-identical.".to_owned(),
        _ => {
            format!(
                "The tracers disagree in {}: no times are given there.",
                plural(different, "scene")
            )
        }
    });
    sentences.join(" ")
}

/// All scenes side by side.
fn overview(scenes: &[SceneBench]) -> Option<Section> {
    let measured: Vec<Both<'_>> = scenes.iter().filter_map(Both::of).collect();
    if measured.is_empty() {
        return None;
    }
    let blocks = vec![
        Block::paragraph(
            "The tracers run in turns, so that slow phases of the machine affect both alike. The ratio is that of the \
             two times in each pair of runs.",
        ),
        Block::Chart(ratios(&measured)),
        Block::Table(table(&measured)),
        Block::Chart(rates(&measured)),
    ];
    Some(Section::new("Speed", blocks))
}

fn ratios(measured: &[Both<'_>]) -> Chart {
    let points = measured.iter().enumerate().map(|(row, both)| {
        let i = &both.ratio.interval;
        let label = format!("{}; {}", interval(both.ratio), both.ratio.verdict());
        Point::new(row as f64, i.median).within(i.low, i.high).labelled(label)
    });
    let names = measured.iter().map(|both| both.scene.scene.clone()).collect();
    ratio_chart(
        "Speed of the wavefront over that of the recursive tracer",
        &format!(
            "Points are medians over pairs of runs, whiskers their confidence intervals ({METHOD}). Right of the \
             line the wavefront is faster."
        ),
        Axis::new("scene", "", Scale::Names(names)),
        points.collect(),
    )
}

/// Rays of each kind per second.
fn rates(measured: &[Both<'_>]) -> Chart {
    let (mut names, mut wavefront, mut recursive) = (Vec::new(), Vec::new(), Vec::new());
    for both in measured {
        let rays = &both.scene.rays;
        let (w, r) = (&both.wavefront.rays_s, &both.recursive.rays_s);
        let kinds = [
            ("primary", rays.primary, w.primary, r.primary),
            ("secondary", rays.secondary, w.secondary, r.secondary),
            ("shadow", rays.shadow, w.shadow, r.shadow),
        ];
        for (kind, count, w, r) in kinds.into_iter().filter(|(_, count, ..)| *count > 0) {
            let row = names.len() as f64;
            let label = format!("{} rays in a run", figure(count as f64));
            wavefront.push(Point::new(row, w / 1e6).labelled(label.clone()));
            recursive.push(Point::new(row, r / 1e6).labelled(label));
            names.push(match measured {
                [_] => kind.to_owned(),
                _ => format!("{}, {kind}", both.scene.scene),
            });
        }
    }
    Chart {
        title: "Rays by kind".to_owned(),
        x: Axis::new("rays", "", Scale::Names(names)),
        y: Axis::new("million rays a second", "", Scale::FromZero),
        series: vec![Series::of("wavefront", wavefront), Series::of("recursive", recursive)],
        guides: Vec::new(),
        caption:
            "Rays of each kind, divided by the median time of a whole run with rays of all kinds."
                .to_owned(),
    }
}

fn table(measured: &[Both<'_>]) -> Table {
    let row = |both: &Both<'_>| {
        let Both { scene, wavefront, recursive, ratio } = both;
        vec![
            Cell::text(format!("`{}`", scene.scene)),
            Cell::count(scene.triangles as u64),
            Cell::count(scene.rays.all()),
            Cell::decimals(wavefront.mrays_s, 3),
            Cell::decimals(recursive.mrays_s, 3),
            ratio_cell(ratio),
        ]
    };
    let caption = "Millions of rays of all kinds a second, by the median time, and the ratio of the speeds with its \
                   interval.";
    let header = "scene|>triangles|>rays|>wavefront|>recursive|>ratio";
    Table::new(caption, header, measured.iter().map(row).collect())
}

/// The machine, the program and the command.
fn measured(report: &BenchReport) -> Section {
    let Machine { processor, cores, threads, os, hardware_missing } = &report.machine;
    let mut facts = vec![
        Fact::new("processor", processor.as_deref().unwrap_or("unknown")),
        Fact::new("cores", cores.to_string()),
        Fact::new("threads", threads.to_string()),
        Fact::new("system", os),
        Fact::new("wavecrest", report.version),
    ];
    let why =
        hardware_missing.iter().map(|why| Fact::new("hardware counters", format!("none: {why}")));
    facts.extend(why);
    let words: Vec<String> = report.command.iter().map(|word| quoted(word)).collect();
    Section::new(
        "How it was measured",
        vec![Block::Facts(facts), Block::Code(format!("wavecrest {}", words.join(" ")))],
    )
}

/// A word of a command, quoted for a shell if necessary.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:+%@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_each_word_for_one() {
        let words = ["a/b.json", "two words", "it's", "", "$x"].map(quoted);
        assert_eq!(words, ["a/b.json", "'two words'", "'it'\\''s'", "''", "'$x'"]);
    }
}
