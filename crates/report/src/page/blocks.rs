//! Blocks, as HTML.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::{Block, Cell, Column, Picture, Section, Table};
use crate::markup::{element, escape, inline};
use crate::plot::Chart;

/// Tables with at least this many columns extend into the margins of the page.
const WIDE: usize = 6;

/// All of `blocks`.
pub(super) fn all(blocks: &[Block]) -> String {
    blocks.iter().map(one).collect()
}

fn one(block: &Block) -> String {
    match block {
        Block::Heading(text) => element("h3", text),
        Block::Paragraph(text) => element("p", text),
        Block::Warning(text) => {
            let text = inline(text);
            format!("<p class=\"warning\" role=\"note\"><strong>Warning</strong> {text}</p>\n")
        }
        Block::Chart(chart) => self::chart(chart),
        Block::Table(table) => self::table(table),
        Block::Pictures(pictures) => {
            let pictures: String = pictures.iter().map(picture).collect();
            format!("<div class=\"pictures\">\n{pictures}</div>\n")
        }
        Block::Code(text) => {
            let text = escape(text.trim_end());
            format!("<pre tabindex=\"0\"><code>{text}</code></pre>\n")
        }
        Block::Facts(facts) => {
            let fact = |(name, value): &(&str, String)| {
                format!("<div><dt>{}</dt><dd>{}</dd></div>\n", inline(name), inline(value))
            };
            let facts: String = facts.iter().map(fact).collect();
            format!("<dl>\n{facts}</dl>\n")
        }
        Block::Details(Section { title, blocks }) => {
            let (summary, blocks) = (inline(title), all(blocks));
            let start = format!("<details class=\"aside\">\n<summary>{summary}</summary>\n");
            format!("{start}<div>\n{blocks}</div>\n</details>\n")
        }
    }
}

fn picture(Picture { png, alt, caption }: &Picture) -> String {
    let (png, alt, caption) = (STANDARD.encode(png), escape(alt), inline(caption));
    format!(
        "<figure class=\"picture\">\n<figcaption>{caption}</figcaption>\n\
         <img class=\"pixels\" alt=\"{alt}\" src=\"data:image/png;base64,{png}\">\n</figure>\n"
    )
}

/// A chart with its caption, its note, and its values as a table and as a download.
fn chart(chart: &Chart) -> String {
    let (title, caption) = (inline(&chart.title), inline(&chart.caption));
    let (drawings, values) = (chart.elements().concat(), table(&values(chart)));
    let note = chart.note().map(|note| element("p class=\"note\"", &note)).unwrap_or_default();
    let (name, csv) = (escape(&file_name(&chart.title)), STANDARD.encode(chart.csv()));
    format!(
        "<figure class=\"drawing\">\n<figcaption><span>{title}</span> {caption}</figcaption>\n\
         {drawings}{note}<details class=\"figures\">\n<summary>Values</summary>\n<div>\n{values}\
         <p class=\"files\">Save as <a download=\"{name}.csv\" \
         href=\"data:text/csv;charset=utf-8;base64,{csv}\">CSV</a></p>\n\
         </div>\n</details>\n</figure>\n"
    )
}

/// The values, rounded: CSV has all digits.
fn values(chart: &Chart) -> Table {
    let cell = |text: String| match text.parse().ok().filter(|value: &f64| value.is_finite()) {
        Some(value) => Cell::figure(value),
        None => Cell::text(text),
    };
    let mut rows = chart.rows().into_iter();
    let header = rows.next().unwrap_or_default().into_iter().enumerate();
    let rows: Vec<Vec<Cell>> = rows.map(|row| row.into_iter().map(cell).collect()).collect();
    let column = |(index, name): (usize, String)| {
        let is_number = rows.iter().any(|row| row[index].value.is_some());
        Column { name, is_number }
    };
    Table { caption: String::new(), columns: header.map(column).collect(), rows }
}

/// The name of a file for what has this title.
pub(crate) fn file_name(title: &str) -> String {
    let words = title.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_lowercase()
}

/// A table with its caption, if any. It scrolls if it is wider than the page; the caption stays.
fn table(Table { caption, columns, rows }: &Table) -> String {
    let name = escape(if caption.is_empty() { "Values" } else { caption }).replace('`', "");
    let broad = if columns.len() >= WIDE { " broad" } else { "" };
    let heading = |of: &Column| format!("<th scope=\"col\"{}>{}</th>", class(of), inline(&of.name));
    let header: String = columns.iter().map(heading).collect();
    let row = |row: &Vec<Cell>| {
        let cells = row.iter().zip(columns).enumerate();
        let cells: String = cells.map(|(index, (cell, of))| self::cell(cell, of, index)).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = rows.iter().map(row).collect();
    let table = format!(
        "role=\"region\" aria-label=\"{name}\" tabindex=\"0\">\n<table aria-label=\"{name}\">\n\
         <thead><tr>{header}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n</div>\n"
    );
    if caption.is_empty() {
        return format!("<div class=\"scroll{broad}\" {table}");
    }
    let caption = element("figcaption", caption);
    format!("<figure class=\"table{broad}\">\n{caption}<div class=\"scroll\" {table}</figure>\n")
}

/// A cell; the first of a row names it.
fn cell(cell: &Cell, column: &Column, index: usize) -> String {
    let (start, end) = if index == 0 { ("th scope=\"row\"", "th") } else { ("td", "td") };
    let (class, text) = (class(column), inline(&cell.text));
    let value = cell.value.filter(|value| value.is_finite());
    let value = value.map(|value| format!(" data-value=\"{value}\"")).unwrap_or_default();
    format!("<{start}{class}{value}>{text}</{end}>")
}

fn class(column: &Column) -> &'static str {
    if column.is_number { " class=\"right\"" } else { "" }
}
