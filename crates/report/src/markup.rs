//! Text in HTML and SVG.

/// An element with text between its tags.
pub(super) fn element(tag: &str, text: &str) -> String {
    let name = tag.split(' ').next().unwrap_or(tag);
    format!("<{tag}>{}</{name}>\n", inline(text))
}

/// Text as markup, with words between backticks as code.
pub(super) fn inline(text: &str) -> String {
    let pair =
        text.split_once('`').and_then(|(before, rest)| Some((before, rest.split_once('`')?)));
    let Some((before, (code, rest))) = pair else { return escape(text) };
    // A path may break only between its parts.
    let code = escape(code).replace('/', "/<wbr>");
    format!("{}<code>{code}</code>{}", escape(before), inline(rest))
}

/// `text` escaped for elements and attributes. Characters that XML cannot represent, such as those
/// that move a terminal's cursor, become the replacement character.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(letter),
            '\0'..' ' | '\u{7f}'..'\u{a0}' | '\u{fffe}' | '\u{ffff}' => {
                out.push(char::REPLACEMENT_CHARACTER)
            }
            _ => out.push(letter),
        }
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
