//! The blocks of a page as text, for a terminal: the same sentences and tables. Charts and pictures
//! are left out.

use std::fmt::Write as _;

use crate::page::{Block, Cell, Table};

/// Largest length of a line of running text.
const LINE: usize = 100;

/// Distance of all text from the left.
const INDENT: &str = "  ";

/// Distance between columns.
const BETWEEN: &str = "  ";

/// All of `blocks`.
pub fn text(blocks: &[Block]) -> String {
    let mut text = String::new();
    blocks.iter().for_each(|block| add(&mut text, block));
    text
}

fn add(text: &mut String, block: &Block) {
    match block {
        Block::Heading(words) => {
            let _ = writeln!(text, "\n{INDENT}{}", plain(words));
        }
        Block::Paragraph(words) => wrapped(text, words),
        Block::Warning(words) => wrapped(text, &format!("warning: {words}")),
        Block::Facts(facts) => {
            let width = facts.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
            for (name, value) in facts {
                let (name, value) = (plain(name), plain(value));
                let _ = writeln!(text, "{INDENT}{name:<width$}{BETWEEN}{value}");
            }
        }
        Block::Table(found) => table(text, found),
        Block::Details(details) => details.blocks.iter().for_each(|block| add(text, block)),
        Block::Code(code) => text.push_str(code),
        Block::Chart(_) | Block::Pictures(_) => {}
    }
}

/// Without marks of code, and with spaces where a page may not break a line.
fn plain(words: &str) -> String {
    words.replace('`', "").replace(['\u{a0}', '\u{202f}'], " ")
}

fn wrapped(text: &mut String, words: &str) {
    let mut used = 0;
    for word in plain(words).split(' ') {
        let length = word.chars().count();
        if used == 0 || used + 1 + length > LINE {
            text.push_str(if used == 0 { "" } else { "\n" });
            text.push_str(INDENT);
            used = INDENT.len();
        } else {
            text.push(' ');
            used += 1;
        }
        text.push_str(word);
        used += length;
    }
    text.push('\n');
}

fn table(text: &mut String, table: &Table) {
    text.push('\n');
    if !table.caption.is_empty() {
        wrapped(text, &table.caption);
    }
    let header = table.columns.iter().map(|column| plain(&column.name)).collect();
    let cells = |row: &Vec<Cell>| row.iter().map(|cell| plain(&cell.text)).collect();
    let rows: Vec<Vec<String>> =
        std::iter::once(header).chain(table.rows.iter().map(cells)).collect();
    let length =
        |row: &Vec<String>, column: usize| row.get(column).map_or(0, |c| c.chars().count());
    let width = |column| rows.iter().map(|row| length(row, column)).max().unwrap_or(0);
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    for row in &rows {
        let mut line = String::new();
        for ((cell, column), width) in row.iter().zip(&table.columns).zip(&widths) {
            line += if line.is_empty() { INDENT } else { BETWEEN };
            line += &match column.is_number {
                true => format!("{cell:>width$}"),
                false => format!("{cell:<width$}"),
            };
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_lines_are_short() {
        let rows = vec![
            vec![Cell::text("`a`"), Cell::decimals(1.5, 1)],
            vec![Cell::text("longer"), Cell::decimals(12.25, 2)],
        ];
        let words = "word ".repeat(60);
        let blocks = [
            Block::Paragraph(words.trim().to_owned()),
            Block::Facts(vec![("x", "1".to_owned()), ("name", "2".to_owned())]),
            Block::Table(Table::new("", "variant|>ms", rows)),
        ];
        let text = text(&blocks);
        assert!(text.lines().all(|line| line.len() <= LINE), "{text}");
        assert_eq!(text.matches("word").count(), 60);
        let end = "  x     1\n  name  2\n\n  variant     ms\n  a          1.5\n  longer   12.25\n";
        assert!(text.ends_with(end), "{text}");
    }
}
