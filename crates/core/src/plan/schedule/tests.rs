use super::*;

fn decisions(present: impl Fn(Effect) -> bool) -> Vec<Decision> {
    let decide = |effect| Decision { effect, present: present(effect), reason: String::new() };
    Effect::ALL.into_iter().map(decide).collect()
}

fn schedule(passes: &[Pass], present: impl Fn(Effect) -> bool) -> Schedule {
    Schedule::new(passes, &decisions(present))
}

/// Checks that what runs reads what is written, and writes what is read.
fn check(passes: &[Pass], found: Schedule) {
    let running: Vec<&Pass> = passes.iter().filter(|pass| found.runs(pass.step)).collect();
    let any = |columns: fn(&Pass) -> &'static [ColumnGroup], column| {
        running.iter().any(|pass| columns(pass).contains(column))
    };
    for pass in &running {
        assert!(pass.reads.iter().all(|column| any(|pass| pass.writes, column)), "{pass:?}");
        assert!(pass.writes.iter().all(|column| any(|pass| pass.reads, column)), "{pass:?}");
    }
}

#[test]
fn every_step_has_one_row_and_parts_follow_their_pass() {
    for (index, pass) in PASSES.iter().enumerate() {
        assert_eq!(PASSES.iter().filter(|other| other.step == pass.step).count(), 1);
        assert_eq!(pass.step as usize, index, "bits are steps in the order of the table");
        if let Some(whole) = pass.part_of {
            let before = PASSES[..index].iter().rev().find(|other| other.part_of.is_none());
            assert_eq!(before.map(|pass| pass.step), Some(whole), "{}", pass.step.name());
        }
    }
}

#[test]
fn no_combination_of_effects_runs_anything_in_vain() {
    // Other effects change no step.
    let needed: Vec<Effect> = Effect::ALL
        .into_iter()
        .filter(|&effect| PASSES.iter().any(|pass| pass.effects().any(|e| e == effect)))
        .collect();
    for set in 0..1_u32 << needed.len() {
        let present =
            |effect| needed.iter().position(|&e| e == effect).is_some_and(|i| set >> i & 1 == 1);
        let found = schedule(&PASSES, present);
        check(&PASSES, found);
        // A step that runs serves an effect that is there.
        for pass in PASSES {
            assert_eq!(found.runs(pass.step), pass.is_needed(present));
        }
    }
}

#[test]
fn without_needs_everything_runs_and_every_column_has_storage() {
    let found = schedule(&UNPLANNED, |_| false);
    check(&PASSES, found);
    assert!(PASSES.iter().all(|pass| found.runs(pass.step) && found.is_unconditional(pass.step)));
    assert_eq!(found.columns().collect::<Vec<_>>(), ColumnGroup::ALL);
}
