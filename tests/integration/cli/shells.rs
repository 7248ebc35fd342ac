//! `completions` and `man`.

use std::path::Path;
use std::process::{Command, Stdio};

use super::files;
use crate::support::{folder, put, run, text};

const SHELLS: [&str; 5] = ["bash", "zsh", "fish", "powershell", "elvish"];

fn printed(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{arguments:?}");
    text(&output.stdout).to_owned()
}

/// The commands, as the help lists them.
fn commands(folder: &Path) -> Vec<String> {
    let help = printed(folder, &["--help"]);
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = lines.take_while(|line| !line.is_empty()).filter_map(|line| {
        // A description that goes on in the next line starts further in.
        let line = line.strip_prefix("  ").filter(|line| !line.starts_with(' '))?;
        Some(line.split_whitespace().next()?.to_owned())
    });
    names.filter(|name| name != "help").collect()
}

/// The long options of a command, as its help lists them.
fn options(folder: &Path, command: &str) -> Vec<String> {
    let help = printed(folder, &[command, "--help"]);
    let words = help.split(|c: char| !(c.is_alphanumeric() || c == '-'));
    let mut found: Vec<_> =
        words.filter(|w| w.starts_with("--") && w.len() > 2).map(str::to_owned).collect();
    found.sort();
    found.dedup();
    found
}

#[test]
fn every_shell_has_a_script_with_the_commands_and_their_options() {
    let folder = folder();
    let commands = commands(folder.path());
    assert!(commands.len() > 10, "{commands:?}");
    for shell in SHELLS {
        let script = printed(folder.path(), &["completions", shell]);
        for word in commands.iter().map(String::as_str).chain(["target-error", "recursive"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
#[cfg(unix)]
fn bash_takes_its_script() {
    let folder = folder();
    put(folder.path(), "c.bash", printed(folder.path(), &["completions", "bash"]));
    let has_bash = Command::new("bash").arg("--version").stdout(Stdio::null()).status().is_ok();
    if !has_bash {
        return;
    }
    let bash = |arguments: &[&str]| {
        let output = Command::new("bash").args(arguments).current_dir(folder.path()).output();
        let output = output.expect("bash runs");
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
        text(&output.stdout).to_owned()
    };
    bash(&["-n", "c.bash"]);
    // What is offered after `wavecrest render --tr`.
    let ask = "source ./c.bash; COMP_WORDS=(wavecrest render --tr); COMP_CWORD=2; \
               _wavecrest wavecrest --tr render; echo ${COMPREPLY[@]}";
    let offered = bash(&["-c", ask]);
    assert_eq!(
        offered.split_whitespace().collect::<Vec<_>>(),
        ["--tracer", "--trap-invalid", "--transfer"]
    );
}

#[test]
fn the_manual_has_a_page_for_each_command_with_each_option() {
    let folder = folder();
    let commands = commands(folder.path());
    std::fs::create_dir(folder.path().join("man1")).expect("a folder");
    assert_eq!(printed(folder.path(), &["man", "-o", "man1"]), "");
    let mut expected: Vec<_> = commands.iter().map(|c| format!("wavecrest-{c}.1")).collect();
    expected.push("wavecrest.1".to_owned());
    expected.sort();
    assert_eq!(files(&folder.path().join("man1")), expected);
    for command in &commands {
        let file = folder.path().join("man1").join(format!("wavecrest-{command}.1"));
        let page = std::fs::read_to_string(file).expect("a page").replace('\\', "");
        for option in options(folder.path(), command) {
            assert!(page.contains(&option), "{command}: {option}");
        }
        assert!(page.starts_with(".ie") && page.contains(".TH"), "{command}");
        assert_eq!(page, printed(folder.path(), &["man", command]).replace('\\', ""));
    }
    let page = printed(folder.path(), &["man"]);
    assert!(page.contains(".TH wavecrest 1") && page.contains("EXIT CODES"), "{page}");
}
