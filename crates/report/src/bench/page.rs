//! A benchmark as a page: the results, then each scene, then the method. A terminal shows the same
//! blocks as [text](crate::text).

mod comparison;

use std::path::Path;

use super::compare::VariantBench;
use super::machine::{Cache, Circumstances, Machine};
use super::report::{BenchReport, SceneBench, waiting};
use crate::measure;
use crate::page::{Block, Cell, Page, Section, Table, file_name};
use crate::plot::number::{figure, plural};
use crate::plot::{ChartAxis, Scale, Series};
use crate::summary::{CONFIDENCE, MedianInterval};
use comparison::{comparison, point, speeds};
use wavecrest_base::error::Result;
use wavecrest_base::replace::make_folder;
use wavecrest_base::words::{self, Size};

/// The page of a report.
pub fn page(report: &BenchReport) -> Page {
    let mut sections = Vec::new();
    if report.scenes.iter().any(|scene| scene.tracers().is_some()) {
        sections.push(Section::new("Speed", overview(&report.scenes)));
    }
    for scene in &report.scenes {
        let title = format!("`{}`", name(scene, &report.scenes));
        sections.push(Section::new(title, self::scene(scene, &report.circumstances.machine)));
    }
    let arguments = &report.circumstances.command;
    let measured = recorded(&report.circumstances, report.version, arguments);
    sections.push(Section::new("How it was measured", measured.to_vec()));
    let title = "Wavefront against recursive".to_owned();
    let mut first = Vec::from_iter(busy(&report.scenes).map(Block::Warning));
    first.push(Block::Paragraph(STEPS.to_owned()));
    Page { title, lead: lead(&report.scenes), first, sections }
}

/// The name of a scene's file; its path if `all` have another file of this name.
fn name<'a>(scene: &'a SceneBench, all: &'a [SceneBench]) -> &'a str {
    let file = |path: &'a str| path.rsplit(std::path::is_separator).next().unwrap_or(path);
    let (path, name) = (&scene.setting.scene, file(&scene.setting.scene));
    let same = all.iter().filter(|other| file(&other.setting.scene) == name);
    if same.count() == 1 { name } else { path }
}

/// What other programs did to the measurement, in all scenes together.
fn busy(scenes: &[SceneBench]) -> Option<String> {
    let lists = || scenes.iter().flat_map(|scene| &scene.comparisons);
    measure::busy(lists().map(|found| found.rounds)).or_else(|| lists().find_map(waiting))
}

/// What the steps from the recursive tracer to the wavefront are.
pub const STEPS: &str = "The steps to the wavefront: order, many paths go through each pass together instead of one to \
                         its end; flight, 64 rays are in the tree at once, so that none waits for memory alone; \
                         packets, rays of neighbouring pixels go through the tree as one.";

/// Writes every chart of the `page` to `folder`, which is made. Names begin with that of the scene.
///
/// # Errors
/// If a file cannot be written.
pub fn write_figures(page: &Page, folder: &Path) -> Result<()> {
    make_folder(folder)?;
    for section in &page.sections {
        let scene = Path::new(section.title.trim_matches('`')).file_stem().unwrap_or_default();
        for block in &section.blocks {
            if let Block::Chart(chart) = block {
                let name = format!("{} {}", scene.to_string_lossy(), chart.title);
                chart.write(folder, &file_name(&name))?;
            }
        }
    }
    Ok(())
}

/// The results in a few sentences.
fn lead(scenes: &[SceneBench]) -> String {
    let tracers = scenes.iter().filter_map(SceneBench::tracers);
    let ratios: Vec<&MedianInterval> = tracers.map(|[_, v]| &v.ratio.interval).collect();
    let mut sentences: Vec<String> = match (&ratios[..], scenes) {
        ([], []) => vec!["Nothing was measured.".to_owned()],
        ([], _) => Vec::new(),
        ([_], [scene]) => answer(scene).into_iter().collect(),
        _ => {
            let least = ratios.iter().map(|ratio| ratio.low).fold(f64::INFINITY, f64::min);
            let most = ratios.iter().map(|ratio| ratio.high).fold(0.0, f64::max);
            vec![format!(
                "In {} scenes, the wavefront is {least:.3} to {most:.3} times as fast as the recursive tracer, by the ends \
                 of all intervals.",
                ratios.len()
            )]
        }
    };
    sentences
        .extend(busy(scenes).and_then(|words| Some(format!("{}.", words.split_once(": ")?.0))));
    let different = scenes.iter().filter(|scene| !scene.equal).count();
    match different {
        0 if scenes.is_empty() => {}
        0 => sentences.push("All images are bit-identical.".to_owned()),
        _ => sentences.push(format!("Images differ in {}.", plural(different, "scene"))),
    }
    sentences.join(" ")
}

/// The speed of the wavefront, the gain of each step to it, and what takes most of its time, in a sentence.
fn answer(scene: &SceneBench) -> Option<String> {
    let [_, wavefront] = scene.tracers()?;
    let (ratio, most) = (&wavefront.ratio, largest(wavefront));
    let i = &ratio.interval;
    let steps = gains(&scene.ladder()?.variants);
    let steps = if steps.is_empty() { String::new() } else { format!(": {steps}") };
    let doubt = match i {
        _ if i.confidence < CONFIDENCE => " There were too few rounds to say which is faster.",
        _ if i.low <= 1.0 && 1.0 <= i.high => " The difference is within the noise.",
        _ => "",
    };
    Some(format!(
        "The wavefront is {:.2} times as fast as the recursive tracer ({:.3} to {:.3} with {:.1}\u{a0}% confidence, {} \
         rounds){steps}{most}.{doubt}",
        i.median,
        i.low,
        i.high,
        100.0 * i.confidence,
        ratio.pairs
    ))
}

/// The pass that takes most of a variant's time, such as "; maps take 46 % of its time".
fn largest(variant: &VariantBench) -> String {
    let largest = variant.passes.iter().max_by(|(_, a), (_, b)| a.total_cmp(b));
    largest.filter(|(_, seconds)| *seconds > 0.0).map_or_else(String::new, |(pass, seconds)| {
        let take = if pass.ends_with('s') { "take" } else { "takes" };
        let all: f64 = variant.passes.iter().map(|(_, seconds)| seconds).sum();
        let share = 100.0 * seconds / all;
        format!("; {pass} {take} {share:.0}\u{a0}% of its time")
    })
}

/// The gain of each step, such as "order 1.08, flight 1.31, packets 1.31". Their product is the
/// ratio of the last variant.
pub fn gains(variants: &[VariantBench]) -> String {
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
    let names = measured().map(|(scene, _)| name(scene, scenes).to_owned()).collect();
    let row = |(scene, [recursive, wavefront]): (&SceneBench, [&VariantBench; 2])| {
        vec![
            Cell::text(format!("`{}`", name(scene, scenes))),
            Cell::figure(scene.shapes.triangles as f64),
            Cell::figure(scene.rays.all() as f64),
            Cell::decimals(wavefront.mrays_s, 3),
            Cell::decimals(recursive.mrays_s, 3),
            wavefront.ratio.cell(),
            Cell::text(scene.ladder().map(|ladder| gains(&ladder.variants)).unwrap_or_default()),
        ]
    };
    let caption = "Millions of rays of all kinds a second, by the median time; the ratio of the speeds, which is the \
                   median over rounds of runs, with its confidence interval (order statistics of paired ratios, \
                   Thompson 1936); and the gain of each step to the wavefront.";
    let header = "scene|>triangles|>rays|>wavefront|>recursive|>ratio|steps";
    vec![
        Block::Chart(speeds(
            "Speed of the wavefront over that of the recursive tracer",
            "Medians over rounds of runs, with their confidence intervals. Right of the line the wavefront is faster.",
            ChartAxis::new("scene", "", Scale::Names(names)),
            Series { points: points.collect(), ..Series::default() },
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

fn facts(scene: &SceneBench, machine: &Machine) -> Vec<(&'static str, String)> {
    let (image, rays, setting) = (&scene.image, &scene.rays, &scene.setting);
    let [primary, secondary, shadow] =
        [rays.primary, rays.secondary, rays.shadow].map(|count| figure(count as f64));
    let samples =
        plural(image.samples_per_pixel as usize, "camera ray") + " each but for background";
    let kinds = [
        (scene.shapes.triangles, "triangle"),
        (scene.shapes.quads, "quad"),
        (scene.shapes.spheres, "sphere"),
        (scene.shapes.disks, "disk"),
        (scene.lights as u64, "light"),
    ];
    let kinds =
        kinds.iter().filter(|(count, _)| *count > 0).map(|(n, name)| plural(*n as usize, name));
    let (load, build, preset) = (setting.time.load, setting.time.build, setting.preset.name());
    let (path, batch) = (scene.bytes_per_path, setting.batch);
    let cache = |c: &Cache| format!(", L{} of {}", c.level, size(c.bytes));
    let caches: String = machine.caches.iter().map(cache).collect();
    let kernel = format!("kernel {}, {}", setting.kernel.name(), setting.simd.name());
    let peak = scene.memory.peak.map(|peak| format!("{}, whole process so far", Size(peak)));
    vec![
        ("image", format!("{} × {} pixels, {samples}", image.width, image.height)),
        ("scene", kinds.collect::<Vec<_>>().join(", ")),
        ("rays a run", format!("{primary} primary, {secondary} secondary, {shadow} shadow")),
        ("prepared", format!("loaded in {load:.3} s, BVH ({preset}) built in {build:.3} s")),
        ("ray state, caches", format!("{path} bytes a path, {batch} paths in a batch{caches}")),
        (
            "settings",
            format!("{kernel}, {} precision, seed {}", setting.precision.name(), setting.seed),
        ),
        ("peak memory", peak.unwrap_or_else(unknown)),
    ]
}

/// A number of bytes in units of 1024, as of caches.
fn size(bytes: u64) -> String {
    let (kibi, mebi) = (bytes as f64 / 1024.0, bytes as f64 / 1_048_576.0);
    let (value, unit) = if kibi < 1024.0 { (kibi, "KiB") } else { (mebi, "MiB") };
    format!("{} {unit}", figure((10.0 * value).round() / 10.0))
}

/// The machine.
pub fn machine(machine: &Machine) -> Vec<(&'static str, String)> {
    vec![
        ("processor", machine.processor.clone().unwrap_or_else(unknown)),
        ("cores, threads", format!("{}, {}", machine.cores, machine.threads)),
        ("system", machine.os.clone()),
    ]
}

fn unknown() -> String {
    "unknown".to_owned()
}

/// The machine, the program and its command of a measurement, with the arguments as typed.
pub(crate) fn recorded(of: &Circumstances, version: &str, arguments: &[String]) -> [Block; 2] {
    let mut facts = machine(&of.machine);
    facts.push(("wavecrest", version.to_owned()));
    let command = ["wavecrest"].into_iter().chain(arguments.iter().map(String::as_str));
    [Block::Facts(facts), Block::Code(words::command(command))]
}
