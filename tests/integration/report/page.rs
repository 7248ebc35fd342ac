//! What a page holds, with and without JavaScript, and that it asks for nothing from outside.

use wavecrest_report::page::{Block, Cell, Column, Page, Picture, Section, Table};
use wavecrest_report::plot::{Chart, ChartAxis, Point, Scale, Series};

fn picture(words: &str) -> Picture {
    Picture { png: vec![1, 2, 3], alt: words.to_owned(), caption: words.to_owned() }
}

fn chart(words: &str) -> Chart {
    let point = Point { x: 1.0, y: 2.0, low: 1.5, high: 2.5, label: words.to_owned() };
    let series = Series { name: words.to_owned(), points: vec![point], ..Series::default() };
    Chart {
        title: words.to_owned(),
        x: ChartAxis::new(words, words, Scale::Linear),
        y: ChartAxis::new(words, words, Scale::Linear),
        series: vec![series],
        caption: words.to_owned(),
        ..Chart::default()
    }
}

/// A page with every block, all of whose text is `words`.
fn page(words: &'static str) -> Page {
    let text = || words.to_owned();
    let blocks = vec![
        Block::Heading(text()),
        Block::Paragraph(text()),
        Block::Warning(text()),
        Block::Chart(chart(words)),
        Block::Table(Table {
            caption: text(),
            columns: [false, true].map(|is_number| Column { name: text(), is_number }).into(),
            rows: vec![vec![Cell::text(words), Cell::number(1.5, words)]],
        }),
        Block::Pictures(vec![picture(words), picture(words)]),
        Block::Code(text()),
        Block::Facts(vec![(words, text())]),
        Block::Details(Section::new(words, vec![Block::Paragraph(text())])),
    ];
    let sections = vec![Section::new(words, blocks)];
    Page { title: text(), lead: text(), first: vec![Block::Paragraph(text())], sections }
}

#[test]
fn all_text_is_escaped() {
    let html = page("<img src=x onerror=\"alert('1')\">&amp;\u{0}").html();
    let body = html.split("<body>").nth(1).unwrap().split("<script>").next().unwrap();
    let escaped = "&lt;img src=x onerror=&quot;alert(&#39;1&#39;)&quot;&gt;&amp;amp;\u{fffd}";
    assert!(body.matches(escaped).count() > 30, "{}", body.matches(escaped).count());
    assert!(!body.contains("<img src=x") && !body.contains("\"alert") && !body.contains('\u{0}'));
    // Each quote that opens an attribute is closed before its tag ends.
    for tag in body.split('<').skip(1).filter_map(|rest| rest.split('>').next()) {
        assert!(tag.matches('"').count().is_multiple_of(2), "<{tag}>");
    }
}

#[test]
fn every_element_that_is_opened_is_closed() {
    let html = page("words").html();
    let body = html.split("<body>").nth(1).unwrap().split("</body>").next().unwrap();
    let (before, after) = body.split_once("<script>").unwrap();
    let body = format!("{before}{}", after.split_once("</script>").unwrap().1);
    let mut open = Vec::new();
    for tag in body.split('<').skip(1).filter_map(|rest| rest.split('>').next()) {
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap();
        match tag.starts_with('/') {
            true => assert_eq!(open.pop(), Some(name), "</{name}>"),
            false if tag.ends_with('/') || matches!(name, "img" | "wbr") => {}
            false => open.push(name),
        }
    }
    assert!(open.is_empty(), "{open:?} are not closed");
}

#[test]
fn a_page_is_standalone() {
    let html = page("words").html();
    assert!(
        html.contains("Content-Security-Policy") && html.contains("default-src &#39;none&#39;")
    );
    // Addresses outside itself: none but the name of a name space would be one.
    for bad in ["http://", "https://", "url(", "@import", "src=\"/", "href=\"/"] {
        assert!(!html.contains(bad), "{bad}");
    }
    let sources = html.split(" src=\"").skip(1);
    assert!(
        sources.clone().count() == 2 && sources.clone().all(|s| s.starts_with("data:image/png"))
    );
}

#[test]
fn the_parts_have_names_that_lead_to_them() {
    let mut page = page("Some words");
    page.sections.push(Section::new("Some words", Vec::new()));
    let html = page.html();
    for id in ["section-1", "section-2"] {
        assert_eq!(html.matches(&format!("id=\"{id}\"")).count(), 1);
        assert_eq!(html.matches(&format!("href=\"#{id}\"")).count(), 2, "contents and heading");
    }
    let ids: Vec<&str> =
        html.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let distinct: std::collections::BTreeSet<_> = ids.iter().collect();
    assert_eq!(ids.len(), distinct.len(), "{ids:?}");
}

/// The figures that can be saved are those of the chart.
#[test]
fn figures_can_be_saved() {
    use base64::Engine as _;
    let chart = chart("words");
    let page = Page {
        sections: vec![Section::new("", vec![Block::Chart(chart.clone())])],
        ..Page::default()
    };
    let html = page.html();
    let saved = |kind: &str| {
        let data = html.split(kind).nth(1).unwrap().split('"').next().unwrap();
        let bytes = base64::engine::general_purpose::STANDARD.decode(data).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    assert_eq!(saved("data:text/csv;charset=utf-8;base64,"), chart.csv());
    assert!(html.contains("download=\"words.csv\""));
}
