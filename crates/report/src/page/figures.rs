//! Charts and images, as HTML.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::tables::table;
use super::writer::{Writer, inline};
use super::{Cell, Column, Picture, Table};
use crate::markup::escape;
use crate::plot::Chart;
use crate::plot::number::figure;

/// A numbered chart with its caption, its note, and its values as a table and as a download.
pub(super) fn chart(writer: &mut Writer, chart: &Chart) {
    writer.figures += 1;
    let (number, title, caption) = (writer.figures, inline(&chart.title), inline(&chart.caption));
    writer.add(&format!(
        "<figure class=\"drawing\" id=\"figure-{number}\">\n\
         <figcaption><b>Figure {number}</b> <span>{title}</span> {caption}</figcaption>\n"
    ));
    writer.add(&chart.elements());
    chart.note().iter().for_each(|note| writer.element("p class=\"note\"", note));
    writer.add("<details class=\"figures\">\n<summary>Values</summary>\n<div>\n");
    table(writer, &values(chart));
    let (name, csv) = (escape(&file_name(&chart.title)), STANDARD.encode(chart.csv()));
    writer.add(&format!(
        "<p class=\"files\">Save as \
         <a download=\"{name}.csv\" href=\"data:text/csv;charset=utf-8;base64,{csv}\">CSV</a></p>\n\
         </div>\n</details>\n</figure>\n"
    ));
}

/// The values, rounded: CSV has all digits.
fn values(chart: &Chart) -> Table {
    let cell = |text: String| match text.parse().ok().filter(|value: &f64| value.is_finite()) {
        Some(value) => Cell::number(value, figure(value)),
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
    format!("<img class=\"pixels\" alt=\"{alt}\" src=\"data:image/png;base64,{data}\">")
}
