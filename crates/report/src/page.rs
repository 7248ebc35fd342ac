//! A report as one standalone HTML file, with styles, script, charts and images.
//!
//! A [`Page`] is data: sections of [`Block`]s in reading order. All text is plain and is escaped;
//! words between backticks become code. The page loads nothing from any network, and its policy
//! forbids it. It is complete without JavaScript. With it, charts show values at their points, tables
//! can be sorted, and light or dark can be chosen independently of the system.

mod blocks;
mod document;
#[cfg(test)]
mod tests;

pub(crate) use blocks::file_name;

use super::plot::Chart;
use super::plot::number::figure;

/// The whole report.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The title, in the window and above the text.
    pub title: String,
    /// The question and the results, in a few sentences.
    pub lead: String,
    /// The answer in short, before the table of contents.
    pub first: Vec<Block>,
    /// Its sections, listed in the table of contents.
    pub sections: Vec<Section>,
}

/// A part with a heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// Its contents, in reading order.
    pub blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A heading of a lower level.
    Heading(String),
    /// Running text.
    Paragraph(String),
    /// An important note, such as a warning.
    Warning(String),
    /// A chart with its caption, its values as a table, and a download as CSV.
    Chart(Chart),
    /// A table.
    Table(Table),
    /// Images in a row, each with its caption.
    Pictures(Vec<Picture>),
    /// Code or a command, unchanged.
    Code(String),
    /// Named facts: the machine, versions, settings.
    Facts(Vec<Fact>),
    /// Details, shown on demand.
    Details(Section),
}

/// Rows under a header.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Its caption; may be empty.
    pub caption: String,
    /// The columns. The first names the rows.
    pub columns: Vec<Column>,
    /// A cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column of a [`Table`].
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// Its heading.
    pub name: String,
    /// Whether it has numbers, which are aligned on the right.
    pub is_number: bool,
}

/// A cell of a [`Table`].
#[derive(Clone, Debug, Default)]
pub struct Cell {
    /// The visible text.
    pub text: String,
    /// The number behind it, by which rows are sorted; `None` for words, which are sorted as text.
    pub value: Option<f64>,
}

/// An embedded image, whose pixels stay visible when it is enlarged.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// The bytes of a PNG file.
    pub png: Vec<u8>,
    /// The alternative text.
    pub alt: String,
    /// The caption.
    pub caption: String,
}

/// A named fact.
#[derive(Clone, Debug, Default)]
pub struct Fact {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: String,
}

impl Section {
    /// A section with these blocks.
    pub fn new(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self { title: title.into(), blocks }
    }
}

impl Table {
    /// A table whose columns are named in `header`, separated by `|`, with `>` before those of
    /// numbers.
    pub fn new(caption: impl Into<String>, header: &str, rows: Vec<Vec<Cell>>) -> Self {
        let column = |name: &str| {
            let number = name.strip_prefix('>');
            Column { name: number.unwrap_or(name).to_owned(), is_number: number.is_some() }
        };
        Self { caption: caption.into(), columns: header.split('|').map(column).collect(), rows }
    }
}

impl Cell {
    /// Words.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), value: None }
    }

    /// A number with this many decimals.
    pub fn decimals(value: f64, decimals: usize) -> Self {
        Self::number(value, format!("{value:.decimals$}"))
    }

    /// A number with a few digits.
    pub fn figure(value: f64) -> Self {
        Self::number(value, figure(value))
    }

    /// A number with its text.
    pub fn number(value: f64, text: impl Into<String>) -> Self {
        Self { text: text.into(), value: Some(value) }
    }
}

impl Fact {
    /// A named fact.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}
