//! Exit codes: each is given where it should be, and told alike in the help, the manual and the guide.

use super::{run, text, with_ball};
use crate::support::{folder, repository};

#[test]
fn each_exit_code_is_given_for_what_it_means() {
    let folder = with_ball();
    let code = |arguments: &[&str]| run(folder.path(), arguments).status.code();
    assert_eq!(code(&["ball.json", "a.exr"]), Some(0));
    assert_eq!(code(&["ball.json", "b.exr", "--precision", "exact", "--seed", "3"]), Some(0));
    assert_eq!(code(&["diff", "a.exr", "a.exr"]), Some(0));
    assert_eq!(code(&["ball.json", "small.exr", "--crop", "0,0,4,4"]), Some(0));
    assert_eq!(code(&["ball.json", "other.exr", "--crop", "6,4,4,4"]), Some(0));
    assert_eq!(code(&["diff", "small.exr", "other.exr"]), Some(1));
    for wrong in [
        &["none.json", "a.exr"][..],
        &["diff", "a.exr", "small.exr"],
        &["ball.json", "a.exr", "--no-such-option"],
        &["ball.json", "a.exr", "--crop", "99,99,1,1"],
        &[],
    ] {
        assert_eq!(code(wrong), Some(2), "{wrong:?}");
    }
    assert_eq!(code(&["--version"]), Some(0));
    assert_eq!(code(&["render", "--help"]), Some(0));
}

#[test]
fn exit_codes_are_documented_alike_everywhere() {
    let folder = folder();
    let said = |arguments: &[&str]| text(&run(folder.path(), arguments).stdout).to_owned();
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let help = words(&said(&["--help"]));
    let manual = words(&said(&["man"]));
    let guide = std::fs::read_to_string(repository("GUIDE.md")).expect("the guide");
    let guide = guide.replace('`', "");
    let page = said(&["man"]);
    let lines: Vec<&str> = page.lines().collect();
    let listed = lines.windows(3).filter(|rows| rows[0] == ".TP" && rows[1].parse::<u8>().is_ok());
    let listed: Vec<(&str, &str)> = listed.map(|rows| (rows[1], rows[2])).collect();
    assert!(listed.len() >= 5, "{listed:?}");
    for (code, meaning) in listed {
        assert!(help.contains(&format!("{code} {meaning}")), "{help}");
        assert!(manual.contains(&format!(".TP {code} {meaning}")), "{manual}");
        assert!(guide.contains(&format!("\n| {code} | {meaning} |\n")), "{code} {meaning}");
    }
}
