//! The markup written so far.

use crate::markup::escape;

/// The markup written so far, with counters.
#[derive(Debug, Default)]
pub(super) struct Writer {
    pub text: String,
    /// Numbered figures so far.
    pub figures: usize,
    /// Numbered tables so far.
    pub tables: usize,
}

impl Writer {
    /// Adds markup.
    pub(super) fn add(&mut self, markup: &str) {
        self.text.push_str(markup);
    }

    /// Adds text between the tags of an element.
    pub(super) fn element(&mut self, tag: &str, text: &str) {
        let name = tag.split(' ').next().unwrap_or(tag);
        self.add(&format!("<{tag}>{}</{name}>\n", inline(text)));
    }
}

/// Text as markup, with words between backticks as code.
pub(super) fn inline(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    // With an odd number of backticks the last one is literal.
    let paired = parts.len() - usize::from(parts.len().is_multiple_of(2));
    let mut out = String::new();
    for (index, part) in parts.iter().enumerate() {
        match index {
            _ if index >= paired => out.push('`'),
            _ if index % 2 == 1 => {
                // A path may break only between its parts.
                let code = escape(part).replace('/', "/<wbr>");
                out.push_str(&format!("<code>{code}</code>"));
                continue;
            }
            _ => {}
        }
        out.push_str(&escape(part));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_between_backticks_are_code() {
        assert_eq!(inline("run `a<b` & go"), "run <code>a&lt;b</code> &amp; go");
        assert_eq!(inline("a ` b"), "a ` b");
        assert_eq!(inline("`a` and `b"), "<code>a</code> and `b");
        assert_eq!(inline("`a/b`/c"), "<code>a/<wbr>b</code>/c");
        assert_eq!((inline(""), inline("``")), (String::new(), "<code></code>".to_owned()));
    }
}
