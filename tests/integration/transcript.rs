//! Transcripts: inputs and what is said of each, word for word, in the files of `messages/`.
//!
//! `# ` begins the rule that the next entries guard, `$ ` an input, and `> ` more lines of it. What follows is the answer, in
//! which `…` stands for any text. To add one, write its input; `WAVECREST_BLESS=1 cargo test --test integration` writes the
//! answer, and answers that have changed.

use crate::support::{blessing, repository};

/// An input, and its answer.
struct Entry<'a> {
    rule: &'a str,
    input: &'a str,
    /// The lines that follow it.
    more: Vec<&'a str>,
    answer: String,
}

impl Entry<'_> {
    fn question(&self) -> String {
        let more = self.more.iter().map(|line| format!("> {line}").trim_end().to_owned() + "\n");
        format!("$ {}\n{}", self.input, more.collect::<String>())
    }
}

fn entries(text: &str) -> Vec<Entry<'_>> {
    let sections = text.trim_end().trim_start_matches("# ").split("\n\n# ");
    let entries = sections.map(|section| section.split_once("\n$ ").expect("a rule and an input"));
    let entries = entries.flat_map(|(rule, rest)| rest.split("\n$ ").map(move |e| (rule, e)));
    let entry = |(rule, entry)| -> Entry<'_> {
        let (input, rest) = str::split_once(entry, '\n').unwrap_or((entry, ""));
        let more = rest.lines().map_while(|line| line.strip_prefix('>'));
        let more: Vec<&str> = more.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
        let answer = rest.lines().skip(more.len()).collect::<Vec<_>>().join("\n");
        Entry { rule, input, more, answer }
    };
    entries.map(entry).collect()
}

/// Whether `found` is the answer, in which `…` stands for any text.
fn is_answer(answer: &str, found: &str) -> bool {
    let Some((first, others)) = answer.split_once('…') else { return answer == found };
    let Some(mut rest) = found.strip_prefix(first) else { return false };
    let (others, last) = others.rsplit_once('…').unwrap_or(("", others));
    for part in others.split('…') {
        let Some(at) = rest.find(part) else { return false };
        rest = &rest[at + part.len()..];
    }
    rest.ends_with(last)
}

/// Checks the answers to all inputs of a topic, each of which is given with its further lines.
pub(crate) fn check(topic: &str, mut answer: impl FnMut(&str, &str) -> String) {
    let file = format!("tests/integration/messages/{topic}.txt");
    let text = std::fs::read_to_string(repository(&file)).expect("a transcript");
    let mut entries = entries(&text);
    let mut wrong = Vec::new();
    for entry in &mut entries {
        let found = answer(entry.input, &entry.more.join("\n")).trim_end().to_owned();
        if !is_answer(&entry.answer, &found) {
            let (rule, question) = (entry.rule, entry.question());
            let old = std::mem::replace(&mut entry.answer, found);
            wrong.push(format!("{rule}\n{question}expected:\n{old}\nfound:\n{}\n", entry.answer));
        }
    }
    if blessing() && !wrong.is_empty() {
        let mut rule = "";
        let written = entries.iter().map(|entry| {
            let head = if entry.rule == rule { "" } else { &format!("\n# {}\n", entry.rule) };
            rule = entry.rule;
            format!("{head}{}{}", entry.question(), entry.answer).trim_end().to_owned() + "\n"
        });
        let written = written.collect::<String>();
        std::fs::write(repository(&file), written.trim_start()).expect("a transcript");
    } else {
        let again = "if the new answer is right: WAVECREST_BLESS=1 cargo test --test integration";
        assert!(wrong.is_empty(), "{file}: {}{again}", wrong.join("\n"));
    }
}
