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

/// What is offered after a line, in the folder with the scripts. Each takes the line as its argument.
const ASK: [(&str, &str); 3] = [
    (
        "bash",
        r#"source ./bash.script; read -ra COMP_WORDS <<<"$0"; [[ $0 == *' ' ]] && COMP_WORDS+=('')
           COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); ask=$(complete -p wavecrest); ask=${ask##*-F }
           ${ask%% *} wavecrest "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
           [[ ${#COMPREPLY[@]} == 0 ]] && COMPREPLY=($(compgen -f -- "${COMP_WORDS[COMP_CWORD]}"))
           printf 'offer:%s\n' "${COMPREPLY[@]}""#,
    ),
    (
        "zsh",
        // In a terminal: completion needs the line editor. What is offered is printed before it is taken.
        r#"zmodload zsh/zpty; zpty shell env PS1=ready: zsh -f -i; zpty -r -m shell text '*ready:*'
           zpty -w shell 'autoload -U compinit; compinit -u -D; source ./zsh.script; compadd() { local -a hits
               builtin compadd -O hits "$@"; [[ " $* " == *" -[OAD] "* ]] || print -rl -- "offer:"$^hits
               builtin compadd "$@" }; offered() { _main_complete; print end:offers }
               zle -C offered complete-word offered; bindkey "^I" offered; print be""gin'
           zpty -r -m shell text '*begin*'; zpty -w -n shell "$0"$'\t'
           zpty -r -m shell text '*end:offers*'; print -r -- "$text""#,
    ),
    (
        "fish",
        "source fish.script; complete -C $argv[1] | string split --fields 1 \\t | string replace -r '^' offer:",
    ),
];

/// Lines, and what is offered at their ends.
const OFFERED: [(&str, &[&str]); 9] = [
    ("wavecrest render --tr", &["--tracer", "--transfer", "--trap-invalid"]),
    // Without a command, a file is rendered.
    ("wavecrest ball.json --tr", &["--tracer", "--transfer", "--trap-invalid"]),
    ("wavecrest --tr", &["--tracer", "--transfer", "--trap-invalid"]),
    ("wavecrest ball.json --tracer ", &["recursive", "wavefront"]),
    ("wavecrest ball.json out.png --simd avx", &["avx2", "avx512"]),
    ("wavecrest -q ball.json --view to", &["top"]),
    ("wavecrest check --stri", &["--strict"]),
    ("wavecrest ch", &["chart.json", "check"]),
    ("wavecrest ball.json out", &["out.png"]),
];

#[test]
#[cfg(unix)]
fn shells_complete_files_options_and_values() {
    let folder = folder();
    for file in ["ball.json", "chart.json", "out.png"] {
        put(folder.path(), file, "");
    }
    for (shell, ask) in ASK {
        put(
            folder.path(),
            &format!("{shell}.script"),
            printed(folder.path(), &["completions", shell]),
        );
        if Command::new(shell).arg("--version").stdout(Stdio::null()).status().is_err() {
            eprintln!("there is no {shell}: its completions are not tried");
            continue;
        }
        for (line, expected) in OFFERED {
            let output = Command::new(shell)
                .args(["-c", ask, line])
                .current_dir(folder.path())
                .output()
                .expect("the shell runs");
            let said = String::from_utf8_lossy(&output.stdout);
            let offers = said.lines().filter_map(|line| line.split_once("offer:"));
            let mut offered: Vec<&str> = offers.map(|(_, word)| word.trim()).collect();
            offered.sort_unstable();
            offered.dedup();
            let told = String::from_utf8_lossy(&output.stderr);
            assert_eq!(offered, expected, "{shell}: {line}: {said}{told}");
        }
    }
}

#[test]
fn the_manual_has_a_page_for_each_command_with_each_option() {
    let folder = folder();
    let mut commands = commands(folder.path());
    // It is not listed, and has a page like the others.
    commands.push("trace".to_owned());
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
