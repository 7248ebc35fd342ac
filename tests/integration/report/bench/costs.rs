//! Time by pass: what passes handle, and which pass takes most.

use wavecrest_core::film::Film;
use wavecrest_image::write::{Transfer, write};

use wavecrest_report::bench::PassCost;

use super::*;

/// Two mirrors with two maps each, of two classes, that see each other beside the ball.
fn with_maps(folder: &Path) -> PreparedScene {
    let picture = folder.join("grey.png");
    let mut film = Film::new(1, 1).unwrap();
    film.pixels_mut()[0] = [0.5, 0.5, 0.9];
    write(&film, &picture, Transfer::Linear).unwrap();
    let mut scene: Value = serde_json::from_str(SCENE).unwrap();
    let shapes = scene["scene"]["shapes"].as_array_mut().unwrap();
    for (y, kr) in [(0.0, 0.4), (1.85, 0.5)] {
        shapes.push(json!({
            "type": "sphere", "center": [-2, y, 0], "radius": 0.9,
            "texture": picture, "normalmap": {"file": picture},
            "material": {"ks": 0.2, "kd": 0.5, "kr": kr, "specularexponent": 9,
                         "diffusecolor": [1, 1, 1]},
        }));
    }
    let prepared = prepared(&scene.to_string());
    prepared.appearance.decode().unwrap();
    prepared
}

#[test]
fn passes_are_told_by_what_they_handle() {
    let folder = tempfile::tempdir().unwrap();
    let ladder = compared_in(&with_maps(folder.path()), Varied::Ladder, 2, |_, _| 0.1, |_, _| {});
    assert_eq!(ladder.difference, None);
    let wavefront = ladder.wavefront().unwrap();
    let counts = ladder.counters;
    let (hits, rays) = (counts.samples, counts.rays.primary + counts.rays.secondary);
    assert!(hits.plain > 0 && hits.mapped > 0 && hits.plain + hits.mapped < rays, "{counts:?}");
    assert_eq!(hits.maps, 2 * hits.mapped);
    let expected = [
        ("camera ray", counts.rays.primary),
        ("ray", rays),
        ("plain hit", hits.plain),
        ("mapped hit", hits.mapped),
        ("look-up of a map", hits.maps),
        ("shadow ray", counts.rays.shadow),
        ("sample", counts.rays.primary),
    ];
    let found: Vec<_> = wavefront.costs.iter().map(|cost| (cost.of, cost.count)).collect();
    assert_eq!(found, expected);
    for PassCost { pass, count, nanoseconds, .. } in &wavefront.costs {
        let (_, seconds) = wavefront.passes.iter().find(|(name, _)| name == pass).unwrap();
        assert!((nanoseconds * *count as f64 / 1e9 / seconds - 1.0).abs() < 1e-9, "{pass}");
        assert!(*nanoseconds > 0.0, "{pass}");
    }
    let recursive = &ladder.variants[0];
    assert!(recursive.costs.is_empty() && recursive.passes.is_empty());
    assert_eq!(wavefront.passes.len(), TimedPass::ALL.len());
    let found = report("maps.json", ladder);
    let shown = text(&scene(&found, &Machine::this()));
    assert!(shown.contains("maps       look-up of a map"), "{shown}");
    assert!(shown.lines().all(|line| line.chars().count() <= 100), "{shown}");
}

#[test]
fn the_first_sentence_names_the_pass_that_takes_most() {
    for (pass, words) in [
        ("maps", "maps take 80\u{a0}% of its time."),
        ("shade", "shade takes 80\u{a0}% of its time."),
    ] {
        let spoil = |_: usize, run: &mut TimedRender| {
            run.rendered.pass_seconds = vec![("generate", 0.1), (pass, 0.4)];
        };
        let found = report("a", compared(Varied::Ladder, 6, |_, _| 0.1, spoil));
        let lead = page(&report_of(vec![found])).lead;
        assert!(
            lead.starts_with("The wavefront is 1.00 times as fast") && lead.contains(words),
            "{lead}"
        );
    }
}
