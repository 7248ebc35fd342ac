//! What charts show and keep, whatever their figures.

use super::drawing::{Frame, Shape};
use super::figure::Figure;
use super::*;

/// Two series with intervals, on two logarithmic axes.
fn chart() -> Chart {
    let points = |scale: f64| {
        let point = |k: i32| {
            let x = 2.0_f64.powi(k);
            let y = scale / x.sqrt();
            Point::new(x, y).within(0.8 * y, 1.3 * y).labelled(format!("run <{k}>"))
        };
        (0..6).map(point).collect()
    };
    let series =
        |name: &str, draw, scale| Series { name: name.to_owned(), draw, points: points(scale) };
    Chart {
        title: "Error & time".to_owned(),
        x: Axis::new("samples", "", Scale::Log),
        y: Axis::new("error", "%", Scale::Log),
        series: vec![series("one", Draw::Line, 1.0), series("other", Draw::Line, 2.0)],
        guides: vec![Guide {
            name: "−1/2".to_owned(),
            course: Course::Power { slope: -0.5, through: [1.0, 1.5] },
        }],
        caption: "Less is <better>.".to_owned(),
    }
}

fn bars() -> StackedBars {
    let segment = |stage: &str, seconds| Segment { stage: stage.to_owned(), seconds };
    StackedBars {
        title: "Time by stage".to_owned(),
        bars: vec![
            Bar {
                name: "a".to_owned(),
                segments: vec![segment("load", 0.5), segment("trace", 1.5)],
            },
            Bar { name: "b".to_owned(), segments: vec![segment("trace", 0.25)] },
        ],
        caption: String::new(),
    }
}

/// The values of an attribute, in the order of the text.
pub(super) fn attributes<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    text.split(&start).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// The titles of all marks.
pub(super) fn titles(svg: &str) -> Vec<&str> {
    let marks = svg.split("<g class=\"mark\"").skip(1);
    marks.filter_map(|mark| mark.split("<title>").nth(1)?.split("</title>").next()).collect()
}

#[test]
fn csv_json_and_svg_have_the_same_figures() {
    let chart = chart();
    let svg = chart.svg();
    let csv = chart.csv();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|row| row.split(',').collect()).collect();
    assert_eq!(csv.lines().next(), Some("series,samples,error (%),low,high,label"));
    assert_eq!(rows.len(), 12);
    let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<_>>();
    for (index, name) in [(1, "data-x"), (2, "data-y"), (3, "data-low"), (4, "data-high")] {
        assert_eq!(attributes(&svg, name), column(index), "{name}");
    }
    let titles = titles(&svg);
    assert_eq!(titles.len(), rows.len());
    let json: serde_json::Value = serde_json::to_value(&chart).unwrap();
    for (index, (row, title)) in rows.iter().zip(titles).enumerate() {
        let point = &json["series"][index / 6]["points"][index % 6];
        for (key, column) in [("x", 1), ("y", 2), ("low", 3), ("high", 4)] {
            let value: f64 = row[column].parse().unwrap();
            assert_eq!(point[key].as_f64(), Some(value), "{key}");
            assert!(title.contains(&number::figure(value)), "{title}: {value}");
        }
        assert!(title.starts_with(row[0]) && title.contains(&format!("run &lt;{}&gt;", index % 6)));
    }
    assert_eq!(json["guides"][0]["course"]["power"]["slope"], -0.5);
    assert_eq!((&json["x"]["scale"], &json["series"][1]["draw"]), (&"log".into(), &"line".into()));
}

#[test]
fn bars_tell_each_segment() {
    let bars = bars();
    let svg = bars.svg();
    assert_eq!(bars.csv(), "bar,stage,seconds\r\na,load,0.5\r\na,trace,1.5\r\nb,trace,0.25\r\n");
    assert_eq!(attributes(&svg, "data-seconds"), ["0.5", "1.5", "0.25"]);
    let expected = [
        "a\nload: 500\u{202f}ms, 25% of the bar",
        "a\ntrace: 1.5\u{202f}s, 75% of the bar",
        "b\ntrace: 250\u{202f}ms, 100% of the bar",
    ];
    assert_eq!(titles(&svg), expected);
    // A stage has its colour in every bar.
    let colours: Vec<_> = svg.split("<g class=\"mark\"").skip(1).collect();
    assert!(colours[0].contains("class=\"f-s0\""));
    assert!(colours[1].contains("class=\"f-s1\"") && colours[2].contains("class=\"f-s1\""));
}

#[test]
fn values_outside_an_axis_are_left_out_with_a_note() {
    let mut chart = chart();
    chart.series[0].points[2].y = 0.0;
    chart.series[0].points[3].y = f64::NAN;
    chart.series[1].points[0].x = -1.0;
    let why = "a logarithmic axis has no place for 0, less, or what is not finite.";
    assert_eq!(chart.notes(), [format!("3 points are not shown: {why}")]);
    let svg = chart.svg();
    assert_eq!(titles(&svg).len(), 9);
    assert!(svg.contains("3 points are not shown: "));
    let rows = chart.csv().lines().count();
    assert_eq!(rows, 13, "CSV has all of them");
    let json = serde_json::to_value(&chart).unwrap();
    let points = &json["series"][0]["points"];
    assert!(points[3]["y"].is_null() && points[2]["y"] == 0.0);
    // The line ends before the points that are missing and begins after them.
    let lines = svg.matches("stroke=\"#0072b2\" class=\"k-s0\" stroke-width=\"2\"").count();
    assert_eq!(lines, 3, "two runs, and the sample in the legend");

    chart.x.scale = Scale::Linear;
    chart.y.scale = Scale::Linear;
    let notes = chart.notes();
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(notes[0].starts_with("1 point is not shown"), "{notes:?}");
    assert!(notes[1].starts_with("1 line to compare with is not shown"), "{notes:?}");

    let mut bars = bars();
    bars.bars[0].segments[0].seconds = -1.0;
    bars.bars[1].segments[0].seconds = f64::INFINITY;
    assert_eq!(bars.notes(), ["2 times are not shown: it is below 0 or not finite."]);
    assert_eq!(titles(&bars.svg()).len(), 1);
}

#[test]
fn a_whisker_that_reaches_zero_ends_at_the_edge() {
    let mut chart = chart();
    chart.series.truncate(1);
    chart.series[0].points = vec![Point::new(1.0, 1.0).within(0.0, 2.0)];
    let svg = chart.svg();
    assert_eq!((titles(&svg).len(), chart.notes().len()), (1, 0));
    assert!(svg.contains("(0 to 2)"));
}

/// Charts that ask for trouble.
fn odd() -> Vec<Chart> {
    let all = |points: &[(f64, f64)], x: Scale, y: Scale| {
        let points = points.iter().map(|&(x, y)| Point::new(x, y).within(y, y)).collect();
        let each = |draw| Series { name: format!("{draw:?}"), draw, points: Vec::clone(&points) };
        Chart {
            title: "odd".to_owned(),
            x: Axis::new("x", "m", x),
            y: Axis::new("y", "s", y),
            series: [Draw::Points, Draw::Line].map(each).to_vec(),
            guides: vec![
                Guide { name: "y".to_owned(), course: Course::AtY(1.0) },
                Guide {
                    name: "p".to_owned(),
                    course: Course::Power { slope: 1e9, through: [1.0, 1.0] },
                },
            ],
            caption: String::new(),
        }
    };
    let mut odd = vec![Chart::default()];
    for points in [
        &[][..],
        &[(1.0, 1.0)],
        &[(0.0, 0.0)],
        &[(f64::NAN, 1.0), (1.0, f64::INFINITY)],
        &[(1e-308, 1e308), (5e-324, -1e308), (1.0, 0.0)],
        &[(1.0, 1.0), (1.0, 1.0), (1.0, 1.0 + f64::EPSILON)],
        &[(1e300, 1e300), (2e300, 1.1e300)],
    ] {
        for scale in [Scale::Linear, Scale::FromZero, Scale::Log] {
            odd.push(all(points, scale.clone(), Scale::Log));
            odd.push(all(points, Scale::Log, scale));
        }
        let names = vec!["a name".repeat(40), "<b>".to_owned()];
        odd.push(all(points, Scale::Names(names), Scale::Linear));
        odd.push(all(points, Scale::Names(Vec::new()), Scale::Linear));
    }
    odd
}

#[test]
fn odd_figures_are_drawn_within_the_picture() {
    for chart in odd() {
        for frame in [Frame::FILE, Frame::WIDE, Frame::NARROW] {
            let drawing = chart.drawing(frame);
            for shape in &drawing.shapes {
                let points = match shape {
                    Shape::Line { points, .. } | Shape::Area { points, .. } => points.clone(),
                    Shape::Disk { center, .. } => vec![*center],
                    Shape::Text(text) => {
                        let start = text.at[0] - text.anchor * text.width();
                        vec![[start, text.at[1]], [start + text.width(), text.at[1]]]
                    }
                    Shape::Begin(_) | Shape::End => continue,
                };
                // Marks at an end stand out by their radius.
                let room = 6.0;
                let is_within = |&[x, y]: &[f64; 2]| {
                    (-room..=frame.width + room).contains(&x)
                        && (-room..=drawing.height + room).contains(&y)
                };
                assert!(points.iter().all(is_within), "{chart:?}\n{shape:?} {frame:?}");
            }
        }
        let svg = chart.svg();
        for bad in ["NaN", "inf", "<b>"] {
            assert!(!svg.contains(bad), "{bad}\n{svg}");
        }
        assert!(chart.csv().lines().count() > chart.series.iter().map(|s| s.points.len()).sum());
    }
}

#[test]
fn names_in_csv_are_quoted_where_they_must_be() {
    let mut chart = chart();
    chart.series.truncate(1);
    chart.series[0].name = "a, \"b\"".to_owned();
    chart.series[0].points.truncate(1);
    chart.x.scale = Scale::Names(vec!["zero".to_owned(), "one,\ntwo".to_owned()]);
    let csv = chart.csv();
    let expected = "\"a, \"\"b\"\"\",\"one,\ntwo\",1,0.8,1.3,run <0>\r\n";
    assert!(csv.ends_with(expected), "{csv}");
}

#[test]
fn all_text_is_escaped() {
    let mut chart = chart();
    let evil = "<script>\"'&\u{1b}";
    chart.title = evil.to_owned();
    chart.caption = evil.to_owned();
    chart.x = Axis::new(evil, evil, Scale::Log);
    chart.y = Axis::new(evil, evil, Scale::Linear);
    for series in &mut chart.series {
        series.name = evil.to_owned();
        series.points[0].label = evil.to_owned();
    }
    chart.guides[0] = Guide { name: evil.to_owned(), course: Course::AtY(1.0) };
    for svg in [chart.svg(), chart.elements()] {
        assert!(!svg.contains("<script") && !svg.contains("\"'") && !svg.contains('\u{1b}'));
        assert!(svg.matches("&lt;script&gt;&quot;&#39;&amp;\u{fffd}").count() > 10, "{svg}");
    }
}

/// The bytes of a PNG, through a file.
pub(super) fn png(draw: impl Fn(&std::path::Path) -> wavecrest_base::error::Result<()>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chart.png");
    draw(&path).unwrap();
    std::fs::read(path).unwrap()
}

/// FNV-1a, 64 bits.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    })
}

/// Whatever the lines are, no name is on another, nor on a level line.
#[test]
fn names_of_guides_are_apart() {
    let mut chart = chart();
    let y = |at: usize, chart: &Chart| chart.series[0].points[at].y;
    let power = |slope| Course::Power { slope, through: [1.0, y(0, &chart)] };
    let guide = |name: &str, course| Guide { name: name.to_owned(), course };
    chart.guides = vec![
        guide("a", power(-0.5)),
        guide("b", power(-0.52)),
        guide("c", power(-1.4)),
        guide("d", Course::AtY(0.9 * y(5, &chart))),
        guide("e", Course::AtY(0.85 * y(5, &chart))),
    ];
    for frame in [Frame::WIDE, Frame::NARROW] {
        let shapes = chart.drawing(frame).shapes;
        let name = |shape: &Shape| match shape {
            Shape::Text(text) if "abcde".contains(&text.text) => Some(text.at),
            _ => None,
        };
        let names: Vec<_> = shapes.iter().filter_map(name).collect();
        assert_eq!(names.len(), 5);
        for (index, a) in names.iter().enumerate() {
            for b in &names[index + 1..] {
                let near = (a[0] - b[0]).abs() < 8.0 && (a[1] - b[1]).abs() < 11.0;
                assert!(!near, "{names:?}");
            }
        }
    }
}

#[test]
fn the_same_bytes_every_time_and_everywhere() {
    let (chart, bars) = (chart(), bars());
    assert_eq!(chart.svg(), chart.svg());
    let first = png(|path| chart.png(path, 900));
    assert_eq!(first, png(|path| chart.png(path, 900)));
    // Of pixels rather than of the file, which another version of the encoder may pack otherwise.
    let pixels = |bytes: &[u8]| hash(image::load_from_memory(bytes).unwrap().to_rgb8().as_raw());
    let found = [pixels(&first), pixels(&png(|path| bars.png(path, 400)))];
    assert_eq!(found.map(|hash| format!("{hash:016x}")), ["2e0120580abe1370", "050d358fe2958ed9"]);
}

#[test]
fn a_png_shows_what_the_svg_does() {
    let bytes = png(|path| bars().png(path, 720));
    let image = image::load_from_memory(&bytes).unwrap().to_rgb8();
    assert_eq!(image.width(), 720);
    let share = |rgb: [u8; 3]| {
        let count = image.pixels().filter(|pixel| pixel.0 == rgb).count();
        count as f64 / f64::from(image.width() * image.height())
    };
    let [load, trace] = [0, 1].map(|index| share(paint::Paint::Series(index).rgb()));
    assert!(share([255; 3]) > 0.5 && load > 0.02, "{load}");
    // 0.5 s of the one stage, 1.75 s of the other; and a block each in the legend.
    assert!((3.0..3.7).contains(&(trace / load)), "{}", trace / load);
}

#[test]
fn a_width_that_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for width in [0, 20_000] {
        let error = chart().png(&folder.path().join("a.png"), width).unwrap_err().to_string();
        assert!(error.contains(&format!("found {width}; use a width from 1 to 16384")), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
}
