//! Tables, as HTML.

use super::writer::{Writer, inline};
use super::{Cell, Column, Table};

/// Tables with at least this many columns extend into the margins of the page.
const WIDE: usize = 6;

/// A table with its caption, if any. It scrolls if it is wider than the page; the caption stays.
pub(super) fn table(writer: &mut Writer, table: &Table) {
    let wide = if table.columns.len() >= WIDE { " broad" } else { "" };
    let name = if table.caption.is_empty() {
        "aria-label=\"Values\"".to_owned()
    } else {
        writer.tables += 1;
        let (number, caption) = (writer.tables, inline(&table.caption));
        writer.add(&format!(
            "<figure class=\"table{wide}\">\n<figcaption id=\"table-{number}\">\
             <b>Table {number}</b> {caption}</figcaption>\n"
        ));
        format!("aria-labelledby=\"table-{number}\"")
    };
    let wide = if table.caption.is_empty() { wide } else { "" };
    writer.add(&format!("<div class=\"scroll{wide}\" role=\"region\" {name} tabindex=\"0\">\n"));
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
    if column.is_some_and(|column| column.is_number) { " class=\"right\"" } else { "" }
}
