//! The contents of sections, as HTML.

use super::writer::{Writer, inline};
use super::{Block, Details, Fact, figures, tables};
use crate::markup::escape;

/// Writes all of `blocks`.
pub(super) fn all(writer: &mut Writer, blocks: &[Block]) {
    blocks.iter().for_each(|block| one(writer, block));
}

fn one(writer: &mut Writer, block: &Block) {
    match block {
        Block::Heading(text) => writer.element("h3", text),
        Block::Paragraph(text) => writer.element("p", text),
        Block::Warning(text) => warning(writer, text),
        Block::Chart(chart) => figures::chart(writer, chart),
        Block::Table(table) => tables::table(writer, table),
        Block::Pictures(pictures) => figures::pictures(writer, pictures),
        Block::Code(text) => {
            let text = escape(text.trim_end());
            writer.add(&format!("<pre tabindex=\"0\"><code>{text}</code></pre>\n"));
        }
        Block::Facts(facts) => self::facts(writer, facts),
        Block::Details(details) => self::details(writer, details),
    }
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

fn details(writer: &mut Writer, details: &Details) {
    let summary = inline(&details.summary);
    writer.add(&format!("<details class=\"aside\">\n<summary>{summary}</summary>\n<div>\n"));
    all(writer, &details.blocks);
    writer.add("</div>\n</details>\n");
}
