//! Charts and images, as HTML.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::tables::table;
use super::writer::{Writer, inline};
use super::{Align, Cell, Column, Picture, Table};
use crate::markup::escape;
use crate::plot::figure::Figure;
use crate::plot::number::figure;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// A chart with its caption, its notes, and its figures as a table and as downloads.
pub(super) fn drawing(writer: &mut Writer, figure: &impl Figure) -> Result<()> {
    begin(writer, figure.title(), figure.caption());
    writer.add(&figure.elements());
    for note in figure.notes() {
        writer.element("p class=\"note\"", &note);
    }
    writer.add("<details class=\"figures\">\n<summary>Values</summary>\n<div>\n");
    table(writer, &table_of(figure));
    let json = serde_json::to_string_pretty(figure)
        .map_err(|e| Error::new(ErrorKind::Io, format!("cannot write JSON: {e}")).because(e))?;
    let (csv, json) = (STANDARD.encode(figure.csv()), STANDARD.encode(json));
    let name = escape(&file_name(figure.title()));
    writer.add(&format!(
        "<p class=\"files\">Save as \
         <a download=\"{name}.csv\" href=\"data:text/csv;charset=utf-8;base64,{csv}\">CSV</a> or \
         <a download=\"{name}.json\" href=\"data:application/json;base64,{json}\">JSON</a></p>\n"
    ));
    writer.add("</div>\n</details>\n</figure>\n");
    Ok(())
}

/// The start of a numbered figure.
fn begin(writer: &mut Writer, title: &str, caption: &str) {
    writer.figures += 1;
    let (number, title, caption) = (writer.figures, inline(title), inline(caption));
    let space = if title.is_empty() || caption.is_empty() { "" } else { " " };
    let title = if title.is_empty() { title } else { format!(" <span>{title}</span>") };
    writer.add(&format!(
        "<figure class=\"drawing\" id=\"figure-{number}\">\n\
         <figcaption><b>Figure {number}</b>{title}{space}{caption}</figcaption>\n"
    ));
}

fn table_of(drawn: &impl Figure) -> Table {
    let mut rows = drawn.rows().into_iter();
    let header = rows.next().unwrap_or_default();
    let rows: Vec<Vec<Cell>> = rows.map(|row| row.into_iter().map(figure_cell).collect()).collect();
    let is_number = |index: usize| rows.iter().any(|row| row.get(index).is_some_and(is_number));
    let column = |(index, name)| {
        let align = if is_number(index) { Align::Right } else { Align::Left };
        Column { name, align }
    };
    let columns = header.into_iter().enumerate().map(column).collect();
    Table { caption: String::new(), columns, rows }
}

/// Rounded numbers: CSV and JSON have all digits.
fn figure_cell(text: String) -> Cell {
    match text.parse().ok().filter(|value: &f64| value.is_finite()) {
        Some(value) => Cell::number(value, figure(value)),
        None => Cell::text(text),
    }
}

fn is_number(cell: &Cell) -> bool {
    cell.value.is_some()
}

/// The file name for these figures.
fn file_name(title: &str) -> String {
    let words = title.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let name = words.collect::<Vec<_>>().join("-").to_lowercase();
    if name.is_empty() { "figures".to_owned() } else { name }
}

/// Images in a row.
pub(super) fn pictures(writer: &mut Writer, pictures: &[Picture]) {
    writer.add("<div class=\"pictures\">\n");
    for picture in pictures {
        let (caption, image) = (inline(&picture.caption), image(picture));
        writer.add("<figure class=\"picture\">\n");
        writer.add(&format!("<figcaption>{caption}</figcaption>\n{image}\n</figure>\n"));
    }
    writer.add("</div>\n");
}

fn image(picture: &Picture) -> String {
    let (data, alt) = (STANDARD.encode(&picture.png), escape(&picture.alt));
    let class = if picture.pixels { " class=\"pixels\"" } else { "" };
    let size = size(&picture.png);
    let size = size.map(|[w, h]| format!(" width=\"{w}\" height=\"{h}\"")).unwrap_or_default();
    format!("<img{class}{size} alt=\"{alt}\" src=\"data:image/png;base64,{data}\">")
}

/// Width and height of a PNG, from its first chunk.
fn size(png: &[u8]) -> Option<[u32; 2]> {
    let number = |at: usize| {
        let bytes = png.get(at..at + 4)?;
        Some(u32::from_be_bytes(bytes.try_into().ok()?))
    };
    (png.get(12..16)? == b"IHDR").then_some([number(16)?, number(20)?])
}
