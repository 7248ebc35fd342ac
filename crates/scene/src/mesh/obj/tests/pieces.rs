//! Pieces read on all threads against the whole text read from its beginning: the same mesh, or the
//! same words about the same line.

use super::*;
use crate::mesh::tests::Dice;

fn check(text: &str) -> Result<Read> {
    // First as one piece.
    let ways = [(1 << 20, 1 << 20), (50, 1), (700, 100), (1 << 20, 300)];
    alike(ways, |&(block, piece)| read_all(text.as_bytes(), block, piece))
}

/// A text of about `lines` statements. One in `wrong` words is wrong; 0 for none. With `back`,
/// indices count backward as well.
fn random_text(seed: u64, lines: u64, wrong: u64, back: bool) -> String {
    let mut dice = Dice(seed);
    let mut text = String::new();
    let mut counts = [0_u64; 3];
    let number = |dice: &mut Dice| {
        let bad = wrong > 0 && dice.one_in(8 * wrong);
        match dice.below(8) {
            _ if bad => dice.of(&["1e99", "x", "1,5", "nan"]).to_owned(),
            0 => format!("{}e-{}", dice.below(100), dice.below(9)),
            1 => format!("-.{}", dice.below(1000)),
            k => format!("{}.{:0w$}", dice.below(100), dice.below(100_000), w = k as usize + 4),
        }
    };
    for line in 0..lines {
        let kind = if line < 3 { 0 } else { dice.below(9) };
        text += dice.of(&["", "  "]);
        let end = dice.of(&["\n", " \r\n", " # f 1\n"]);
        match kind {
            0..4 => {
                let keyword = kind.min(2) as usize;
                counts[keyword] += 1;
                text += ["v", "vt", "vn"][keyword];
                (0..3).for_each(|_| text += &format!(" {}", number(&mut dice)));
            }
            4 => text += dice.of(&["# f 9 9 9", "g a \\", "", "usemtl f 1"]),
            _ => {
                text += "f";
                for _ in 0..3 + dice.below(3) {
                    let parts = [0, 1, 2].map(|k| {
                        let bad = wrong > 0 && dice.one_in(wrong);
                        match counts[k] {
                            _ if bad => "0".to_owned(),
                            0 => String::new(),
                            n if back && dice.one_in(4) => format!("-{}", 1 + dice.below(n)),
                            n => (1 + dice.below(n)).to_string(),
                        }
                    });
                    text += [" ", " \\\n ", "\t"][dice.below(20).saturating_sub(17) as usize];
                    text += &parts[..1 + dice.below(3) as usize].join("/");
                }
            }
        }
        text += end;
    }
    text + "f 1 2 3"
}

#[test]
fn random_texts_are_read_alike() {
    for seed in 0..120 {
        let text = random_text(seed, 60 + seed, 0, seed % 2 == 0);
        assert!(check(&text).is_ok(), "{text}");
    }
}

#[test]
fn the_first_error_is_reported_for_any_cuts() {
    let wrong =
        |seed| check(&random_text(seed, 200, [30, 200, 1000][seed as usize % 3], seed % 2 == 0));
    let right = (0..200).filter(|&seed| wrong(seed).is_ok()).count();
    assert!((10..190).contains(&right), "{right}");
}

#[test]
fn a_far_index_is_found_in_the_whole_file_at_its_line() {
    for line in [0, 77, 150] {
        let mut text = random_text(5, 120, 0, true).lines().map(str::to_owned).collect::<Vec<_>>();
        text.insert(line.min(text.len()), "f 1 2 99999".to_owned());
        let text = text.join("\n");
        assert!(check(&text).unwrap_err().to_string().contains("found 99999"));
    }
}
