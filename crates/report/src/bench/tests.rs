//! The lists of variants, and the machine.

use super::machine::{Cache, caches, processor};
use super::variant::{BATCHES, Variant, Varied};
use super::*;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::TracerKind;

fn usual() -> Variant {
    Variant {
        tracer: TracerKind::Wavefront,
        kernel: KernelChoice::Auto,
        simd: Level::best(),
        batch: 1024,
        threads: 4,
        planned: true,
    }
}

#[test]
fn lists_have_each_variant_once_and_say_what_it_is_compared_with() {
    for of in Varied::ALL {
        let choices = of.choices(usual(), &BATCHES);
        for (number, choice) in choices.iter().enumerate() {
            let before = &choices[..number];
            assert!(before.iter().all(|other| other.variant != choice.variant), "{choice:?}");
            assert!(before.iter().all(|other| other.label != choice.label), "{choice:?}");
            assert!(choice.over <= number && choice.step.is_none_or(|(from, _)| from < number));
        }
        assert!(choices.iter().any(|choice| choice.variant == usual()), "{of:?}");
    }
    let levels = Varied::Levels.choices(usual(), &[]);
    for choice in &levels {
        let over = &levels[choice.over].variant;
        assert_eq!((over.tracer, over.simd), (TracerKind::Recursive, choice.variant.simd));
    }
}

#[test]
fn the_machine_is_read_from_the_files_of_the_system() {
    let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: other\n";
    assert_eq!(processor(text).as_deref(), Some("Some CPU @ 2 GHz"));
    assert_eq!(processor("model name\t:\n"), None);
    assert_eq!(processor("CPU part : 0xd40\n"), None);
    let folder = tempfile::tempdir().unwrap();
    let kinds = [
        ("1", "Data", "48K", "0"),
        ("1", "Instruction", "32K", "0"),
        ("3", "Unified", "32768K", "0-3,8"),
    ];
    for (number, (level, kind, size, list)) in kinds.into_iter().enumerate() {
        let index = folder.path().join(format!("index{number}"));
        std::fs::create_dir(&index).unwrap();
        for (name, value) in
            [("level", level), ("type", kind), ("size", size), ("shared_cpu_list", list)]
        {
            std::fs::write(index.join(name), format!("{value}\n")).unwrap();
        }
    }
    let caches = caches(folder.path());
    let of = |level, kibibytes: u64, shared_by| Cache { level, bytes: kibibytes << 10, shared_by };
    assert_eq!(caches, [of(1, 48, 1), of(3, 32768, 5)]);
    let machine = Machine { caches, ..Machine::this() };
    let held = |kibibytes: u64, threads| machine.holds(kibibytes << 10, threads).unwrap();
    assert_eq!([held(48, 4), held(49, 1), held(30000, 2)], ["L1", "L3", "memory"]);
    assert_eq!(Machine { caches: Vec::new(), ..machine }.holds(1, 1), None);
}
