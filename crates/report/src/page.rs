//! A report as one standalone HTML file: styles, script, charts and pictures are in it.
//!
//! A [`Page`] is data: sections of [`Block`]s, in the order of reading. All text is plain text, and
//! is escaped; words between backticks are set as code. The page asks for nothing from any network,
//! and forbids itself to. Without JavaScript all of it can be read; with it, values are shown at the
//! points of a chart, pictures can be compared under a divide that moves, tables can be sorted, and
//! light or dark can be chosen against what the system prefers.

mod blocks;
mod document;
mod figures;
mod tables;
#[cfg(test)]
mod tests;
mod writer;

use super::plot::number::figure;
use super::plot::{Chart, Icicle, StackedBars};

/// The whole report.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The title, in the window and above the text.
    pub title: String,
    /// What was asked and what was found, in a few sentences.
    pub lead: String,
    /// The answer in short, before the table of contents.
    pub first: Vec<Block>,
    /// Its sections; the table of contents has them all.
    pub sections: Vec<Section>,
}

/// A part with a heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// What it holds, in the order of reading.
    pub blocks: Vec<Block>,
}

/// What a section holds.
#[derive(Clone, Debug)]
pub enum Block {
    /// A heading of a lower level.
    Heading(String),
    /// Running text.
    Paragraph(String),
    /// What the reader should not pass over, such as a warning.
    Warning(String),
    /// A chart with its caption, its values as a table, and CSV and JSON to be saved.
    Chart(Chart),
    /// Bars with the same.
    Bars(StackedBars),
    /// An icicle with the same.
    Icicle(Icicle),
    /// A table.
    Table(Table),
    /// Two pictures of one thing, under a divide that moves; side by side without JavaScript.
    Compare(Compare),
    /// Pictures in a row, each with its caption.
    Pictures(Vec<Picture>),
    /// Code or a command, as it is.
    Code(String),
    /// What is known by name: the machine, versions, settings.
    Facts(Vec<Fact>),
    /// What is shown on demand.
    Details(Details),
}

/// Rows under a header.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// What it shows; may be empty.
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
    /// Where its text stands.
    pub align: Align,
}

/// Where the text of a column stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// On the left: words.
    #[default]
    Left,
    /// On the right: numbers.
    Right,
    /// In the middle.
    Center,
}

/// A cell of a [`Table`].
#[derive(Clone, Debug, Default)]
pub struct Cell {
    /// What is read.
    pub text: String,
    /// The number behind it, by which rows are sorted; `None` for words, which are sorted as such.
    pub value: Option<f64>,
}

/// Two pictures of one thing.
#[derive(Clone, Debug, Default)]
pub struct Compare {
    /// On the left of the divide.
    pub left: Picture,
    /// On the right of it, as large as the other.
    pub right: Picture,
    /// What to look for.
    pub caption: String,
}

/// A picture, in the file itself.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// The bytes of a PNG file.
    pub png: Vec<u8>,
    /// What it shows, for those who do not see it.
    pub alt: String,
    /// What is written under it; in a [`Compare`], the short name of its side.
    pub caption: String,
    /// Whether each pixel is to be seen where it is shown enlarged.
    pub pixels: bool,
}

/// Something known by name.
#[derive(Clone, Debug, Default)]
pub struct Fact {
    /// Its name.
    pub name: String,
    /// What is known.
    pub value: String,
}

/// What is shown on demand.
#[derive(Clone, Debug, Default)]
pub struct Details {
    /// The line that opens it.
    pub summary: String,
    /// What it holds.
    pub blocks: Vec<Block>,
}

impl Section {
    /// A section of these blocks.
    pub fn new(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self { title: title.into(), blocks }
    }
}

impl Block {
    /// Running text.
    pub fn paragraph(text: impl Into<String>) -> Self {
        Self::Paragraph(text.into())
    }
}

impl Table {
    /// A table whose columns `header` names, with `|` between the names and `>` before those of numbers.
    pub fn new(caption: impl Into<String>, header: &str, rows: Vec<Vec<Cell>>) -> Self {
        let column = |name: &str| match name.strip_prefix('>') {
            Some(name) => Column::numbers(name),
            None => Column::words(name),
        };
        Self { caption: caption.into(), columns: header.split('|').map(column).collect(), rows }
    }
}

impl Column {
    /// A column of words.
    pub fn words(name: impl Into<String>) -> Self {
        Self { name: name.into(), align: Align::Left }
    }

    /// A column of numbers.
    pub fn numbers(name: impl Into<String>) -> Self {
        Self { name: name.into(), align: Align::Right }
    }
}

impl Cell {
    /// Words.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), value: None }
    }

    /// A number with so many decimals.
    pub fn decimals(value: f64, decimals: usize) -> Self {
        Self::number(value, format!("{value:.decimals$}"))
    }

    /// A number of things.
    pub fn count(count: u64) -> Self {
        Self::number(count as f64, figure(count as f64))
    }

    /// A number, as it is to be read.
    pub fn number(value: f64, text: impl Into<String>) -> Self {
        Self { text: text.into(), value: Some(value) }
    }
}

impl Fact {
    /// Something known by name.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}
