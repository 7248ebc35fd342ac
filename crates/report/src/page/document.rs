//! The page around its blocks: head, title, table of contents, sections.

use std::path::Path;

use super::writer::{Writer, inline};
use super::{Page, blocks};
use crate::files::write_text;
use crate::markup::escape;
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
        let mut writer = Writer::default();
        head(&mut writer, self);
        writer.add("<main id=\"content\">\n");
        blocks::all(&mut writer, &self.first);
        contents(&mut writer, self);
        for (number, section) in (1..).zip(&self.sections) {
            let (name, title) = (format!("section-{number}"), inline(&section.title));
            writer.add(&format!("<section id=\"{name}\" aria-labelledby=\"{name}-title\">\n"));
            writer.add(&format!("<h2 id=\"{name}-title\"><a href=\"#{name}\">{title}</a></h2>\n"));
            blocks::all(&mut writer, &section.blocks);
            writer.add("</section>\n");
        }
        writer.add("</main>\n");
        writer.add(&format!("<script>\n{SCRIPT}</script>\n</body>\n</html>\n"));
        writer.text
    }

    /// Writes the page to a file, atomically.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        write_text(path, &self.html())
    }
}

fn head(writer: &mut Writer, page: &Page) {
    let (title, version) = (escape(&page.title), env!("CARGO_PKG_VERSION"));
    let policy = escape(POLICY.trim());
    writer.add(&format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta name=\"generator\" content=\"wavecrest {version}\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n\
         <style>\n{CHART_STYLE}{STYLE}</style>\n</head>\n<body>\n\
         <a class=\"skip\" href=\"#content\">Skip to the report</a>\n<header>\n"
    ));
    writer.element("h1", &page.title);
    if !page.lead.is_empty() {
        writer.element("p class=\"lead\"", &page.lead);
    }
    writer.add("</header>\n");
}

fn contents(writer: &mut Writer, page: &Page) {
    if page.sections.is_empty() {
        return;
    }
    writer.add("<nav aria-labelledby=\"contents\">\n<p id=\"contents\">Contents</p>\n<ol>\n");
    for (number, section) in (1..).zip(&page.sections) {
        let title = inline(&section.title);
        writer.add(&format!("<li><a href=\"#section-{number}\">{title}</a></li>\n"));
    }
    writer.add("</ol>\n</nav>\n");
}
