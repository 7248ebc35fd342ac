//! A report as one standalone HTML file, with styles, script, charts and images.
//!
//! A [`Page`] is data: sections of [`Block`]s in reading order. All text is plain and is escaped;
//! words between backticks become code. The page loads nothing from any network, and its policy
//! forbids it. It is complete without JavaScript. With it, charts show values at their points, tables
//! can be sorted, and light or dark can be chosen independently of the system.

mod blocks;

use std::path::Path;

pub(crate) use blocks::file_name;

use crate::files::write_text;
use crate::markup::{element, escape, inline};
use crate::plot::Chart;
use crate::plot::number::figure;
use wavecrest_base::error::Result;

/// The style sheet of what pages share: the colours and fonts, light and dark, and those of charts.
pub const THEME: &str = concat!(include_str!("plot/chart.css"), include_str!("page/theme.css"));

/// The rest of the style sheet of a page.
const STYLE: &str = include_str!("page/style.css");

/// The page's JavaScript.
const SCRIPT: &str = include_str!("page/script.js");

/// A policy with which the browser forbids all outside resources.
const POLICY: &str = include_str!("page/policy.txt");

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
    /// Facts, each with its name: the machine, versions, settings.
    Facts(Vec<(&'static str, String)>),
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

impl Page {
    /// The page as HTML.
    pub fn html(&self) -> String {
        let (head, first, contents) = (self.head(), blocks::all(&self.first), self.contents());
        let sections: String = (1..).zip(&self.sections).map(section).collect();
        format!(
            "{head}<main id=\"content\">\n{first}{contents}{sections}</main>\n\
             <script>\n{SCRIPT}</script>\n</body>\n</html>\n"
        )
    }

    /// Writes the page to a file, atomically.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        write_text(path, &self.html())
    }

    fn head(&self) -> String {
        let (title, version) = (escape(&self.title), env!("CARGO_PKG_VERSION"));
        let (policy, heading) = (escape(POLICY.trim()), element("h1", &self.title));
        let lead = element("p class=\"lead\"", &self.lead);
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <meta name=\"generator\" content=\"wavecrest {version}\">\n\
             <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n\
             <style>\n{THEME}{STYLE}</style>\n</head>\n<body>\n\
             <a class=\"skip\" href=\"#content\">Skip to the report</a>\n\
             <header>\n{heading}{lead}</header>\n"
        )
    }

    fn contents(&self) -> String {
        if self.sections.is_empty() {
            return String::new();
        }
        let entry = |(number, section): (usize, &Section)| {
            format!("<li><a href=\"#section-{number}\">{}</a></li>\n", inline(&section.title))
        };
        let entries: String = (1..).zip(&self.sections).map(entry).collect();
        let start = "<nav aria-labelledby=\"contents\">\n<p id=\"contents\">Contents</p>\n";
        format!("{start}<ol>\n{entries}</ol>\n</nav>\n")
    }
}

fn section((number, section): (usize, &Section)) -> String {
    let (title, blocks) = (inline(&section.title), blocks::all(&section.blocks));
    let (name, label) = (format!("section-{number}"), format!("section-{number}-title"));
    format!(
        "<section id=\"{name}\" aria-labelledby=\"{label}\">\n\
         <h2 id=\"{label}\"><a href=\"#{name}\">{title}</a></h2>\n{blocks}</section>\n"
    )
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
