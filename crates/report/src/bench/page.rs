//! A benchmark as a page: the results, then each scene, then the method. A terminal shows the same
//! blocks as [text](crate::text).

mod comparison;
mod files;

use super::compare::VariantBench;
use super::machine::Machine;
use super::ratio::{METHOD, Ratio};
use super::report::{BenchReport, SceneBench};
use crate::page::{Block, Cell, Fact, Page, Section, Table};
use crate::plot::number::figure;
use crate::plot::{Axis, Scale, Series};
use comparison::{comparison, point, ratio, speeds};

pub use files::write_figures;

/// The page of a report.
pub fn page(report: &BenchReport) -> Page {
    let mut sections = Vec::new();
    if report.scenes.iter().any(|scene| scene.tracers().is_some()) {
        sections.push(Section::new("Speed", overview(&report.scenes)));
    }
    for scene in &report.scenes {
        let title = format!("`{}`", scene.setting.scene);
        sections.push(Section::new(title, self::scene(scene, &report.machine)));
    }
    let mut facts = machine(&report.machine);
    facts.push(Fact::new("wavecrest", report.version));
    let command = Block::Code(command(&report.command));
    sections.push(Section::new("How it was measured", vec![Block::Facts(facts), command]));
    let title = "Wavefront against recursive".to_owned();
    Page { title, lead: lead(&report.scenes), sections, ..Page::default() }
}

/// The results in a few sentences.
fn lead(scenes: &[SceneBench]) -> String {
    let ratios: Vec<f64> = scenes.iter().filter_map(speed).map(|r| r.interval.median).collect();
    let mut sentences: Vec<String> = match (&ratios[..], scenes) {
        ([], []) => vec!["Nothing was measured.".to_owned()],
        ([], _) => Vec::new(),
        ([_], [scene]) => answer(scene).into_iter().collect(),
        _ => {
            let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
            let most = ratios.iter().copied().fold(0.0, f64::max);
            vec![format!(
                "In {} scenes, the wavefront is {least:.3} to {most:.3} times as fast as the recursive tracer.",
                ratios.len()
            )]
        }
    };
    let different = scenes.iter().filter(|scene| !scene.equal).count();
    match different {
        0 if scenes.is_empty() => {}
        0 => sentences.push("All images are bit-identical.".to_owned()),
        1 => sentences.push("Images differ in 1 scene.".to_owned()),
        _ => sentences.push(format!("Images differ in {different} scenes.")),
    }
    sentences.join(" ")
}

/// The speed of the wavefront over that of the recursive tracer.
fn speed(scene: &SceneBench) -> Option<&Ratio> {
    scene.tracers().map(|[_, wavefront]| &wavefront.ratio)
}

/// The speed of the wavefront, and the gain of each step to it, in a sentence.
fn answer(scene: &SceneBench) -> Option<String> {
    let ratio = speed(scene)?;
    let i = &ratio.interval;
    let steps = gains(&scene.ladder()?.variants);
    let steps = if steps.is_empty() { String::new() } else { format!(": {steps}") };
    let verdict = match ratio.verdict("wavefront", "recursive tracer") {
        known if known.ends_with("is faster") => String::new(),
        open => format!(" Of the two, {open}."),
    };
    Some(format!(
        "The wavefront is {:.2} times as fast as the recursive tracer ({:.3} to {:.3} with {:.1}\u{a0}% confidence, {} \
         rounds){steps}.{verdict}",
        i.median,
        i.low,
        i.high,
        100.0 * i.confidence,
        ratio.pairs
    ))
}

/// The gain of each step, such as "order 1.08, flight 1.31, packets 1.31". Their product is the
/// ratio of the last variant.
pub(super) fn gains(variants: &[VariantBench]) -> String {
    let gains = variants.iter().filter_map(|v| v.gain.as_ref());
    let words: Vec<String> =
        gains.map(|gain| format!("{} {:.2}", gain.of, gain.ratio.interval.median)).collect();
    words.join(", ")
}

/// All scenes side by side.
pub fn overview(scenes: &[SceneBench]) -> Vec<Block> {
    let measured = || scenes.iter().filter_map(|scene| Some((scene, scene.tracers()?)));
    let points =
        measured().enumerate().map(|(row, (_, [_, wavefront]))| point(row as f64, wavefront));
    let names = measured().map(|(scene, _)| scene.setting.scene.clone()).collect();
    let row = |(scene, [recursive, wavefront]): (&SceneBench, [&VariantBench; 2])| {
        vec![
            Cell::text(format!("`{}`", scene.setting.scene)),
            Cell::count(scene.triangles as u64),
            Cell::count(scene.rays.all()),
            Cell::decimals(wavefront.mrays_s, 3),
            Cell::decimals(recursive.mrays_s, 3),
            ratio(&wavefront.ratio),
            Cell::text(scene.ladder().map(|ladder| gains(&ladder.variants)).unwrap_or_default()),
        ]
    };
    let caption = format!(
        "Millions of rays of all kinds a second, by the median time; the ratio of the speeds, which is the median over \
         rounds of runs, with its confidence interval ({METHOD}); and the gain of each step to the wavefront."
    );
    let header = "scene|>triangles|>rays|>wavefront|>recursive|>ratio|steps";
    vec![
        Block::Chart(speeds(
            "Speed of the wavefront over that of the recursive tracer",
            "Medians over rounds of runs, with their confidence intervals. Right of the line the wavefront is faster.",
            Axis::new("scene", "", Scale::Names(names)),
            Series::of("", points.collect()),
        )),
        Block::Table(Table::new(caption, header, measured().map(row).collect())),
    ]
}

/// One scene.
pub fn scene(scene: &SceneBench, machine: &Machine) -> Vec<Block> {
    let mut blocks: Vec<Block> = answer(scene).into_iter().map(Block::Paragraph).collect();
    blocks.extend(scene.warnings.iter().cloned().map(Block::Warning));
    blocks.push(Block::Facts(facts(scene, machine)));
    for found in &scene.comparisons {
        blocks.extend(comparison(found, &scene.rays, machine));
    }
    blocks
}

fn facts(scene: &SceneBench, machine: &Machine) -> Vec<Fact> {
    let (image, rays, setting) = (&scene.image, &scene.rays, &scene.setting);
    let [primary, secondary, shadow] =
        [rays.primary, rays.secondary, rays.shadow].map(|count| figure(count as f64));
    let samples = plural(image.samples_per_pixel as usize, "camera ray");
    let kinds = [
        (scene.triangles, "triangle"),
        (scene.quads, "quad"),
        (scene.spheres, "sphere"),
        (scene.lights, "light"),
    ];
    let kinds = kinds.iter().filter(|(count, _)| *count > 0).map(|(n, name)| plural(*n, name));
    let (load, build, preset) = (setting.time.load, setting.time.build, setting.preset.name());
    let batch = scene.bytes_per_path * setting.batch;
    let caches = machine.caches.iter().map(|c| format!("L{} {}", c.level, size(c.bytes)));
    let caches = caches.collect::<Vec<_>>().join(", ");
    let mut facts = vec![
        Fact::new("image", format!("{} × {} pixels, {samples} each", image.width, image.height)),
        Fact::new("scene", kinds.collect::<Vec<_>>().join(", ")),
        Fact::new(
            "rays a run",
            format!("{primary} primary, {secondary} secondary, {shadow} shadow"),
        ),
        Fact::new(
            "prepared",
            format!("loaded in {load:.3} s, BVH ({preset}) built in {build:.3} s"),
        ),
        Fact::new(
            "ray state",
            format!(
                "{} bytes a path, {} a batch of {}{}{caches}",
                scene.bytes_per_path,
                size(batch as u64),
                setting.batch,
                if caches.is_empty() { "" } else { "; caches: " }
            ),
        ),
        Fact::new(
            "settings",
            format!(
                "kernel {}, {}, {} precision, seed {}",
                setting.kernel.name(),
                setting.simd.name(),
                setting.precision.name(),
                setting.seed
            ),
        ),
    ];
    if let Some(peak) = scene.memory.peak {
        let peak = format!("{:.1} MB, whole process so far", peak as f64 / 1e6);
        facts.push(Fact::new("peak memory", peak));
    }
    facts
}

/// A number of bytes in units of 1024.
fn size(bytes: u64) -> String {
    let kibibytes = bytes as f64 / 1024.0;
    let tenths = |value: f64| figure((10.0 * value).round() / 10.0);
    match kibibytes {
        ..1024.0 => format!("{} KiB", tenths(kibibytes)),
        _ => format!("{} MiB", tenths(kibibytes / 1024.0)),
    }
}

/// A number with a noun.
fn plural(count: usize, name: &str) -> String {
    if count == 1 { format!("1 {name}") } else { format!("{} {name}s", figure(count as f64)) }
}

/// The machine.
pub fn machine(machine: &Machine) -> Vec<Fact> {
    let Machine { processor, cores, threads, os, hardware_missing, .. } = machine;
    let mut facts = vec![
        Fact::new("processor", processor.as_deref().unwrap_or("unknown")),
        Fact::new("cores, threads", format!("{cores}, {threads}")),
        Fact::new("system", os),
    ];
    let why =
        hardware_missing.iter().map(|why| Fact::new("hardware counters", format!("none: {why}")));
    facts.extend(why);
    facts
}

/// A command with these arguments, as typed.
pub(crate) fn command(arguments: &[String]) -> String {
    let words = arguments.iter().map(|word| format!(" {}", quoted(word)));
    words.fold("wavecrest".to_owned(), |command, word| command + &word)
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
