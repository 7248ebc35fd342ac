//! What a reader of a page meets, in a real browser.
//!
//! `cargo test --test browser` needs Chromium, and says so where there is none. Screenshots are left
//! in `target/tmp/browser/`.

#![cfg(unix)]
#![allow(
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests fail as tests do; clippy knows only the test functions themselves"
)]

mod chromium;
mod controls;
mod view;
mod viewer;

use std::path::{Path, PathBuf};
use std::process::Command;

use chromium::Browser;
use serde_json::json;
use tempfile::TempDir;
use wavecrest_report::accuracy::store::{Store, SweepHeader};
use wavecrest_report::accuracy::{self, AccuracyReport, sweep};
use wavecrest_report::page::{Block, Cell, Page, Picture, Section, Table};
use wavecrest_report::plot::{Chart, ChartAxis, Draw, Guide, Point, Scale, Series};

/// Where screenshots are left.
fn pictures() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser");
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

/// A picture of one colour.
fn picture(name: &str, rgb: [u8; 3]) -> Picture {
    let image = image::RgbImage::from_pixel(320, 200, image::Rgb(rgb));
    let mut png = std::io::Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png).expect("a picture");
    let (alt, caption) = (format!("all {name}"), name.to_owned());
    Picture { png: png.into_inner(), alt, caption }
}

/// A page with every block. Its words are told apart by their numbers.
fn page() -> Page {
    let error = |n: i32| {
        let x = 4.0_f64.powi(n);
        let [low, y, high] = [0.4, 0.5, 0.7].map(|error| error / x.sqrt());
        Point { x, y, low, high, label: String::new() }
    };
    let chart = Chart {
        title: "Error against samples".to_owned(),
        x: ChartAxis::new("samples", "", Scale::Log),
        y: ChartAxis::new("error", "", Scale::Log),
        series: vec![Series {
            name: "stratified".to_owned(),
            draw: Draw::Line,
            points: (0..6).map(error).collect(),
        }],
        guides: vec![Guide::power("−1/2", -0.5, [1.0, 0.6], [1024.0, 0.01])],
        caption: "Words in a caption.".to_owned(),
    };
    let rows = [("b", 2.0), ("a", 10.0), ("c", 1.0)];
    let row = |(name, value): (&str, f64)| {
        vec![Cell::text(name), Cell::number(value, format!("{value}"))]
    };
    let rows = rows.into_iter().map(row).collect();
    let table = Table::new("Words over a table.", "name|>value", rows);
    Page {
        title: "A page of everything".to_owned(),
        lead: "Words that lead in.".to_owned(),
        first: vec![Block::Paragraph("Words that answer.".to_owned())],
        sections: vec![
            Section::new("Charts", vec![Block::Chart(chart), Block::Table(table)]),
            Section::new(
                "Pictures",
                vec![Block::Pictures(vec![
                    picture("red", [200, 0, 0]),
                    picture("blue", [0, 0, 200]),
                ])],
            ),
            Section::new(
                "The rest",
                vec![
                    Block::Paragraph("Words in a paragraph.".to_owned()),
                    Block::Warning("Words that warn.".to_owned()),
                    Block::Facts(vec![("a name", "Words that are known.".to_owned())]),
                    Block::Code(format!("wavecrest {}", "bench ".repeat(60))),
                    Block::Details(Section::new(
                        "More",
                        vec![Block::Paragraph("Words when asked for.".to_owned())],
                    )),
                ],
            ),
        ],
    }
}

/// The page in a file, in a folder that is removed when the test ends.
fn written() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("page.html");
    page().write(&file).expect("a page");
    (folder, file)
}

/// The page in a browser, in a window of this width.
fn opened(test: &str, width: u32) -> Option<(TempDir, Browser)> {
    let mut browser = Browser::start(test)?;
    let (folder, file) = written();
    browser.resize(width, 900);
    browser.prefer("light");
    browser.open(&file);
    Some((folder, browser))
}

/// The middle of an element on a picture of the whole page.
fn on_page(browser: &mut Browser, selector: &str) -> [u32; 2] {
    let script = format!(
        "(b => [b.x + b.width / 2 + scrollX, b.y + b.height / 2 + scrollY])\
         (document.querySelector({selector:?}).getBoundingClientRect())"
    );
    let found = browser.evaluate(&script);
    [0, 1].map(|index| found[index].as_f64().expect("a number") as u32)
}

/// Both pictures of the page are seen, side by side.
fn assert_both_are_seen(browser: &mut Browser, page: &image::RgbImage) {
    for (place, rgb) in [("first", [200, 0, 0]), ("last", [0, 0, 200])] {
        let [x, y] = on_page(browser, &format!(".picture:{place}-child img"));
        assert_eq!(page.get_pixel(x, y).0, rgb, "{place}");
    }
}

#[test]
fn a_page_of_bench_opens_without_complaint_and_asks_no_network() {
    let Some(mut browser) = Browser::start("a page of bench") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let scene = include_str!("../integration/report/bench/ball.json");
    std::fs::write(folder.path().join("s.json"), scene).expect("a file");
    let options = ["--repeats", "2", "--min-time", "0", "--compare", "kernels", "--page", "p.html"];
    let status = Command::new(env!("CARGO_BIN_EXE_wavecrest"))
        .current_dir(folder.path())
        .args(["bench", "s.json", "-q", "-o", "bench.json"])
        .args(options)
        .stdout(std::process::Stdio::null())
        .status()
        .expect("it runs");
    assert!(status.success());
    browser.resize(1100, 900);
    browser.open(&folder.path().join("p.html"));
    assert_eq!(browser.complaints, Vec::<String>::new());
    // The page has the figures of the JSON.
    let text = std::fs::read_to_string(folder.path().join("bench.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let ladder = report["scenes"][0]["comparisons"][0]["variants"].as_array().expect("variants");
    let ratio = &ladder.iter().rfind(|v| v["tracer"] == "wavefront").expect("one")["ratio"];
    for (key, name) in [("median", "y"), ("low", "low"), ("high", "high")] {
        let found =
            browser.evaluate(&format!("Number(document.querySelector('.mark').dataset.{name})"));
        assert_eq!(found.as_f64(), ratio[key].as_f64(), "{key}");
    }
    let picture = browser.picture(&pictures().join("bench.png"));
    assert!(picture.height() > 1000);
}

/// What an error costs stands on the first screen, as the JSON has it; pictures are seen at once.
#[test]
fn the_answer_of_a_sweep_is_on_the_first_screen() {
    let Some(mut browser) = Browser::start("the answer of a sweep") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/testareajitter.json");
    let out = folder.path().join("out");
    let version = env!("CARGO_PKG_VERSION").to_owned();
    let header = SweepHeader { version, longest: 32, most: 64, least: 256 };
    let mut store = Store::open(&out, &header).expect("a folder");
    let mut swept = sweep::run(&[scene], 4, &mut store, &|_| {}).expect("a sweep");
    let findings = AccuracyReport::new(4, &store, &swept, &[0.03, 0.02]);
    accuracy::page::write(&findings, &mut swept, &out).expect("a page");
    browser.resize(1280, 800);
    browser.prefer("light");
    browser.open(&out.join("report.html"));
    assert_eq!(browser.complaints, Vec::<String>::new());
    let text = std::fs::read_to_string(out.join("accuracy.json")).expect("JSON");
    let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let errors = &found["scenes"][0]["answer"]["errors"];
    for (row, error) in errors.as_array().expect("answers").iter().enumerate() {
        let mut cell = |column: u32, what: &str| {
            let row = format!("tbody tr:nth-child({})", row + 1);
            browser.evaluate(&format!(
                "document.querySelector('table {row} > :nth-child({column})').{what}"
            ))
        };
        let value = "dataset.value * 1";
        assert_eq!(cell(2, value).as_f64(), error["error"].as_f64());
        assert_eq!(cell(3, value).as_f64(), error["tracing"].as_f64());
        let setting =
            format!("{} {} points", error["points"], error["sampler"].as_str().expect("a sampler"));
        assert_eq!(cell(4, "textContent"), setting);
        assert_eq!(cell(5, value).as_f64(), error["times_as_fast"]["value"].as_f64());
        assert_eq!(cell(6, value).as_f64(), error["seconds"].as_f64());
        let bottom = cell(1, "getBoundingClientRect().bottom").as_f64();
        assert!(bottom.is_some_and(|bottom| bottom < 800.0), "row {row} ends at {bottom:?}");
    }
    let hidden = "[...document.images].filter(i => !i.checkVisibility()).length";
    assert_eq!(browser.evaluate(hidden), 0);
    for (scheme, width, name) in
        [("light", 1280, "sweep"), ("dark", 1280, "sweep-dark"), ("light", 400, "sweep-narrow")]
    {
        browser.resize(width, 800);
        browser.prefer(scheme);
        browser.picture(&pictures().join(format!("{name}.png")));
        let wide = browser.evaluate("document.documentElement.scrollWidth");
        assert_eq!(wide, width, "nothing stands out of the window");
    }
    std::fs::write(pictures().join("sweep.pdf"), browser.print()).expect("a file");
}

#[test]
fn values_are_shown_under_the_pointer_and_the_keyboard() {
    let Some((_folder, mut browser)) = opened("values of points", 1100) else { return };
    let tip =
        "document.querySelector('.tip').hidden ? '' : document.querySelector('.tip').textContent";
    assert_eq!(browser.evaluate(tip), "");
    let at = browser.middle(".chart.wide .mark:nth-of-type(2) .near");
    browser.mouse("mouseMoved", at);
    let told = "stratified\nsamples: 4\nerror: 0.25 (0.2 to 0.35)";
    assert_eq!(browser.evaluate(tip), told);
    browser.picture(&pictures().join("value.png"));
    assert_eq!(
        browser.evaluate("document.querySelectorAll('svg title').length"),
        0,
        "one tip only"
    );
    browser.mouse("mouseMoved", [1.0, 1.0]);
    assert_eq!(browser.evaluate(tip), "");

    // The chart is one stop; arrows lead from point to point.
    let stops = "document.querySelectorAll('.chart.wide [tabindex=\"0\"]').length";
    assert_eq!(browser.evaluate(stops), 1);
    browser.evaluate("document.querySelector('.chart.wide .mark').focus()");
    let first = browser.evaluate(tip);
    assert!(first.as_str().is_some_and(|tip| tip.contains("samples: 1\n")), "{first}");
    browser.press("ArrowRight", 39);
    assert_eq!(browser.evaluate(tip), told);
    assert_eq!(browser.evaluate("document.activeElement.getAttribute('aria-label')"), told);
    assert_eq!(browser.evaluate(stops), 1);
    browser.press("Escape", 27);
    assert_eq!(browser.evaluate(tip), "");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn rows_are_sorted_by_a_column() {
    let Some((_folder, mut browser)) = opened("sorted rows", 1100) else { return };
    let names = "[...document.querySelectorAll('section > .table tbody th')].map(c => c.textContent).join('')";
    let click = |column: u32| {
        format!("document.querySelector('section > .table th:nth-child({column}) button').click()")
    };
    assert_eq!(browser.evaluate(names), "bac");
    for (column, expected) in [(1, "abc"), (1, "cba"), (2, "cba"), (2, "abc")] {
        browser.evaluate(&click(column));
        assert_eq!(browser.evaluate(names), expected);
    }
}

#[test]
fn without_javascript_everything_is_there() {
    let Some(mut browser) = Browser::start("a page without JavaScript") else { return };
    let (_folder, file) = written();
    browser.resize(1100, 900);
    browser.prefer("light");
    browser.allow_script(false);
    browser.open(&file);
    let picture = browser.picture(&pictures().join("no-script.png"));
    let text = browser.evaluate("document.body.innerText");
    let text = text.as_str().expect("text");
    for words in [
        "A page of everything",
        "Words that lead in.",
        "Words that answer.",
        "Words in a caption.",
        "Words over a table.",
        "Words in a paragraph.",
        "Words that warn.",
        "Words that are known.",
        "wavecrest bench",
        "red",
        "blue",
        "More",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    assert_eq!(browser.evaluate("document.querySelectorAll('.theme, .tip').length"), 0);
    // Values are in titles, which the browser itself shows.
    let title = browser.evaluate("document.querySelector('.mark title').textContent");
    assert_eq!(title, "stratified\nsamples: 1\nerror: 0.5 (0.4 to 0.7)");
    assert_both_are_seen(&mut browser, &picture);
    // What is shown when asked for needs no script to be asked.
    browser.evaluate("document.querySelector('details.aside').open = true");
    let text = browser.evaluate("document.body.innerText");
    assert!(text.as_str().is_some_and(|text| text.contains("Words when asked for.")));
}

#[test]
fn light_dark_and_narrow() {
    let Some((_folder, mut browser)) = opened("light, dark and narrow", 1100) else { return };
    let corner = |picture: &image::RgbImage| picture.get_pixel(2, 2).0;
    let paper = [[255; 3], [21, 23, 27]];
    assert_eq!(corner(&browser.picture(&pictures().join("light.png"))), paper[0]);
    browser.prefer("dark");
    assert_eq!(corner(&browser.picture(&pictures().join("dark.png"))), paper[1]);
    // The reader's choice goes before the system's.
    browser.evaluate("document.querySelector('.theme').click()");
    assert_eq!(corner(&browser.picture(&pictures().join("chosen.png"))), paper[0]);
    browser.evaluate("document.querySelector('.theme').click()");
    assert_eq!(corner(&browser.picture(&pictures().join("chosen.png"))), paper[1]);
    browser.prefer("light");
    browser.evaluate("document.querySelector('.theme').click()");

    let shown = "['wide', 'narrow'].map(c => getComputedStyle(document.querySelector('.chart.' + c)).display)";
    assert_eq!(browser.evaluate(shown), json!(["block", "none"]));
    browser.resize(360, 740);
    let picture = browser.picture(&pictures().join("narrow.png"));
    assert_eq!(picture.width(), 360, "nothing stands out at the side");
    assert_eq!(browser.evaluate("document.documentElement.scrollWidth"), 360);
    assert_eq!(browser.evaluate(shown), json!(["none", "block"]));
    // Text in a chart is as large as it is meant to be.
    let scale = browser.evaluate(
        "(c => c.getBoundingClientRect().width / c.viewBox.baseVal.width)\
         (document.querySelector('.chart.narrow'))",
    );
    assert!(scale.as_f64().is_some_and(|scale| scale > 0.9), "{scale}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn on_paper_all_is_dark_on_white_and_open() {
    let Some((_folder, mut browser)) = opened("a page on paper", 1100) else { return };
    let pdf = browser.print();
    assert!(pdf.starts_with(b"%PDF"));
    std::fs::write(pictures().join("paper.pdf"), pdf).expect("the folder is there");
    let dark = json!([{"name": "prefers-color-scheme", "value": "dark"}]);
    browser.call("Emulation.setEmulatedMedia", json!({"media": "print", "features": dark}));
    let picture = browser.picture(&pictures().join("paper.png"));
    assert_eq!(picture.get_pixel(2, 2).0, [255; 3]);
    let hidden = "[...document.querySelectorAll('.theme, .figures, .narrow')]\
                  .every(e => getComputedStyle(e).display === 'none')";
    assert_eq!(browser.evaluate(hidden), true);
    let height = "document.querySelector('details.aside p').getBoundingClientRect().height";
    assert!(browser.evaluate(height).as_f64().is_some_and(|height| height > 0.0), "it is open");
    assert_both_are_seen(&mut browser, &picture);
}
