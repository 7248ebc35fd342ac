//! What sections hold, as HTML.

use super::document::{Writer, inline};
use super::figures;
use super::{Align, Block, Cell, Column, Details, Fact, Table};
use crate::markup::escape;
use wavecrest_base::error::Result;

/// Writes all of `blocks`.
pub(super) fn all(writer: &mut Writer, blocks: &[Block]) -> Result<()> {
    blocks.iter().try_for_each(|block| one(writer, block))
}

fn one(writer: &mut Writer, block: &Block) -> Result<()> {
    match block {
        Block::Heading(text) => writer.element("h3", text),
        Block::Paragraph(text) => writer.element("p", text),
        Block::Warning(text) => warning(writer, text),
        Block::Chart(chart) => figures::drawing(writer, chart)?,
        Block::Bars(bars) => figures::drawing(writer, bars)?,
        Block::Table(table) => self::table(writer, table),
        Block::Compare(pair) => figures::compare(writer, pair),
        Block::Pictures(pictures) => figures::pictures(writer, pictures),
        Block::Code(text) => {
            let text = escape(text.trim_end());
            writer.add(&format!("<pre tabindex=\"0\"><code>{text}</code></pre>\n"));
        }
        Block::Facts(facts) => self::facts(writer, facts),
        Block::Details(details) => self::details(writer, details)?,
    }
    Ok(())
}

fn warning(writer: &mut Writer, text: &str) {
    let text = inline(text);
    writer
        .add(&format!("<p class=\"warning\" role=\"note\"><strong>Warning</strong> {text}</p>\n"));
}

fn facts(writer: &mut Writer, facts: &[Fact]) {
    writer.add("<dl>\n");
    for Fact { name, value } in facts {
        let (name, value) = (inline(name), inline(value));
        writer.add(&format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"));
    }
    writer.add("</dl>\n");
}

fn details(writer: &mut Writer, details: &Details) -> Result<()> {
    let summary = inline(&details.summary);
    writer.add(&format!("<details class=\"aside\">\n<summary>{summary}</summary>\n<div>\n"));
    all(writer, &details.blocks)?;
    writer.add("</div>\n</details>\n");
    Ok(())
}

/// A table with its caption, if it has one. It can be moved to and fro where it is wider than the page;
/// the caption stays.
pub(super) fn table(writer: &mut Writer, table: &Table) {
    let name = if table.caption.is_empty() {
        "aria-label=\"Values\"".to_owned()
    } else {
        writer.tables += 1;
        let (number, caption) = (writer.tables, inline(&table.caption));
        writer.add(&format!(
            "<figure class=\"table\">\n<figcaption id=\"table-{number}\">\
             <b>Table {number}</b> {caption}</figcaption>\n"
        ));
        format!("aria-labelledby=\"table-{number}\"")
    };
    writer.add(&format!("<div class=\"scroll\" role=\"region\" {name} tabindex=\"0\">\n"));
    writer.add(&format!("<table {name}>\n"));
    rows(writer, table);
    writer.add("</table>\n</div>\n");
    if !table.caption.is_empty() {
        writer.add("</figure>\n");
    }
}

fn rows(writer: &mut Writer, Table { columns, rows, .. }: &Table) {
    writer.add("<thead><tr>");
    for column in columns {
        let (class, name) = (class(Some(column)), inline(&column.name));
        writer.add(&format!("<th scope=\"col\"{class}>{name}</th>"));
    }
    writer.add("</tr></thead>\n<tbody>\n");
    for row in rows {
        writer.add("<tr>");
        for (index, cell) in row.iter().enumerate() {
            self::cell(writer, cell, columns.get(index), index == 0);
        }
        writer.add("</tr>\n");
    }
    writer.add("</tbody>\n");
}

fn cell(writer: &mut Writer, cell: &Cell, column: Option<&Column>, names_row: bool) {
    let tag = if names_row { "th scope=\"row\"" } else { "td" };
    let (class, text) = (class(column), inline(&cell.text));
    let value = cell.value.filter(|value| value.is_finite());
    let value = value.map(|value| format!(" data-value=\"{value}\"")).unwrap_or_default();
    let name = &tag[..2];
    writer.add(&format!("<{tag}{class}{value}>{text}</{name}>"));
}

fn class(column: Option<&Column>) -> &'static str {
    match column.map(|column| column.align) {
        None | Some(Align::Left) => "",
        Some(Align::Right) => " class=\"right\"",
        Some(Align::Center) => " class=\"center\"",
    }
}
