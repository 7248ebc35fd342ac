//! Which choices are compared, in which order they run, and what ends it.

use super::*;
use crate::bench::tests::prepared;
use crate::bench::text::comparison;
use wavecrest_core::render::{RenderOptions, render};

fn usual() -> Variant {
    Variant { kernel: KernelChoice::Auto, simd: Level::best(), batch: 1024, planned: true }
}

/// Each variant takes twice as long as the one before. `spoil` changes images, given the number of
/// the run.
fn run(of: Axis, spoil: impl Fn(usize, &mut Rendered)) -> (Vec<Variant>, Comparison) {
    let mut scene = prepared();
    let variants = of.variants(usual());
    let mut log = Vec::new();
    let trace = |variant: &Variant| {
        log.push(*variant);
        scene.accel.kernel = variant.kernel;
        scene.accel.level = variant.simd.token().unwrap();
        let options = RenderOptions { batch: variant.batch, ..RenderOptions::default() };
        let place = variants.iter().position(|v| v == variant).unwrap();
        let mut run = render(&scene, &options, &())?;
        run.seconds = 0.25 * f64::from(1 << place);
        spoil(log.len(), &mut run);
        Ok(run)
    };
    let schedule = Schedule { warmup: 1, most: 6, seconds: 0.0 };
    let compared = compare(of, &variants, &schedule, trace, &mut |_, _| {}).unwrap();
    (log, compared)
}

#[test]
fn the_usual_choice_comes_first_and_once() {
    for of in [Axis::Kernels, Axis::Levels, Axis::Batches] {
        for usual in [usual(), Variant { kernel: KernelChoice::Stream, batch: 64, ..usual() }] {
            let variants = of.variants(usual);
            assert_eq!(variants[0], usual);
            assert_eq!(variants.iter().filter(|&&v| v == usual).count(), 1);
        }
    }
    assert_eq!(Axis::Kernels.variants(usual()).len(), KernelChoice::FOR_RENDERS.len());
    assert_eq!(Axis::Levels.variants(usual()).len(), Level::available().len());
    assert_eq!(Axis::Batches.variants(Variant { batch: 7, ..usual() }).len(), BATCHES.len() + 1);
}

#[test]
fn each_runs_once_a_round_and_all_take_turns_to_begin() {
    let (log, compared) = run(Axis::Kernels, |_, _| {});
    assert_eq!((log.len(), compared.rounds), (4 * 7, 6));
    let first: Vec<_> = log.chunks(4).take(5).map(|round| round[0].kernel.name()).collect();
    assert_eq!(first, ["auto", "packet", "stream", "single", "auto"]);
    let speeds = compared.variants.iter().map(|v| v.ratio.interval.median);
    assert_eq!(speeds.collect::<Vec<_>>(), [1.0, 0.5, 0.25, 0.125]);
    let stream = &compared.variants[2].bench.kernels;
    assert!(stream.closest.stream == 24 * 16 && stream.closest.packet == 0);
    let json = serde_json::to_value(&compared).unwrap();
    assert_eq!(json["of"], "kernels");
    assert_eq!(json["variants"][3]["kernel"], "single");
    assert_eq!(json["variants"][3]["seconds"]["median"], 2.0);
}

#[test]
fn the_text_has_a_line_for_each_choice_and_its_passes() {
    for of in [Axis::Kernels, Axis::Levels, Axis::Batches] {
        let (_, compared) = run(of, |_, _| {});
        let text = comparison(&compared);
        assert!(text.contains("6 rounds, all images bit-identical"), "{text}");
        assert!(text.lines().all(|line| line.len() <= 100), "{text}");
        for variant in of.variants(usual()) {
            let start = format!("    {:<9}", of.label(&variant));
            assert_eq!(text.lines().filter(|l| l.starts_with(&start)).count(), 2, "{text}");
        }
    }
}

#[test]
fn an_image_that_differs_ends_it() {
    let spoil = |number: usize, run: &mut Rendered| {
        if number == 3 {
            run.film.pixel_mut(4, 5).unwrap()[0] = 0.5;
        }
    };
    let (log, compared) = run(Axis::Kernels, spoil);
    assert_eq!((log.len(), compared.variants.len()), (3, 0));
    let found = compared.difference.as_ref().unwrap();
    assert_eq!(found.variant.kernel, KernelChoice::Stream);
    assert!(matches!(found.difference, Difference::Pixel { x: 4, y: 5, .. }));
    let text = comparison(&compared);
    assert!(text.contains("with stream, THE IMAGES DIFFER"), "{text}");
}

#[test]
fn without_the_plan_work_may_differ_but_no_image() {
    let spoil = |number: usize, run: &mut Rendered| {
        run.counters.footprints += number as u64 % 2;
    };
    assert!(run(Axis::Kernels, spoil).1.difference.is_some());
    assert_eq!(run(Axis::Plan, spoil).1.difference, None);
    let spoil = |number: usize, run: &mut Rendered| {
        run.film.pixel_mut(4, 5).unwrap()[0] = number as f32;
    };
    assert!(run(Axis::Plan, spoil).1.difference.is_some());
}
