//! The page: one HTML file, with its style sheet and its script, of which pointers and keys and the panels have files of
//! their own.

use std::sync::LazyLock;

use wavecrest_report::page::THEME;

/// What the page may load: nothing but what this server sends it.
pub(super) const POLICY: &str = "default-src 'none'; connect-src 'self'; img-src 'self' data:; \
     style-src 'unsafe-inline'; script-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The whole page.
pub(super) static HTML: LazyLock<String> = LazyLock::new(|| {
    let style = format!("{THEME}{}", include_str!("page.css"));
    let (controls, panels) = (include_str!("controls.js"), include_str!("panels.js"));
    let script = include_str!("page.js").replacen("// {{controls}}", controls, 1);
    let script = script.replacen("// {{panels}}", panels, 1);
    include_str!("page.html").replacen("{{style}}", &style, 1).replacen("{{script}}", &script, 1)
});
