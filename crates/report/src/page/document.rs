//! The page around its blocks: head, title, table of contents, sections.

use std::path::Path;

use super::{Page, Section, blocks};
use crate::files::write_text;
use crate::markup::{element, escape, inline};
use crate::plot::svg::STYLE as CHART_STYLE;
use wavecrest_base::error::Result;

/// The style sheet of a page, without that of its charts.
const STYLE: &str = include_str!("style.css");

/// The page's JavaScript.
const SCRIPT: &str = include_str!("script.js");

/// A policy with which the browser forbids all outside resources.
const POLICY: &str = include_str!("policy.txt");

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
             <style>\n{CHART_STYLE}{STYLE}</style>\n</head>\n<body>\n\
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

/// A section with its number.
fn section((number, section): (usize, &Section)) -> String {
    let (title, blocks) = (inline(&section.title), blocks::all(&section.blocks));
    let (name, label) = (format!("section-{number}"), format!("section-{number}-title"));
    format!(
        "<section id=\"{name}\" aria-labelledby=\"{label}\">\n\
         <h2 id=\"{label}\"><a href=\"#{name}\">{title}</a></h2>\n{blocks}</section>\n"
    )
}
