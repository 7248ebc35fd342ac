//! What charts show and keep, whatever their figures.

use wavecrest_report::plot::{Chart, ChartAxis, Draw, Guide, Point, Scale, Series, number};

/// Two series with intervals, on two logarithmic axes.
fn chart() -> Chart {
    let points = |scale: f64| {
        let point = |k: i32| {
            let x = 2.0_f64.powi(k);
            let y = scale / x.sqrt();
            Point { x, y, low: 0.8 * y, high: 1.3 * y, label: format!("run <{k}>") }
        };
        (0..6).map(point).collect()
    };
    let series =
        |name: &str, draw, scale| Series { name: name.to_owned(), draw, points: points(scale) };
    Chart {
        title: "Error & time".to_owned(),
        x: ChartAxis::new("samples", "", Scale::Log),
        y: ChartAxis::new("error", "%", Scale::Log),
        series: vec![series("one", Draw::Line, 1.0), series("other", Draw::Line, 2.0)],
        guides: vec![Guide::power("−1/2", -0.5, [1.0, 1.5], [32.0, 0.1])],
        caption: "Less is <better>.".to_owned(),
    }
}

/// The values of an attribute, in the order of the text.
fn attributes<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    text.split(&start).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// The numbers in a path or a list.
fn numbers(text: &str) -> Vec<f64> {
    let words = text.split(|c: char| !"0123456789.-".contains(c)).filter(|word| !word.is_empty());
    words.map(|word| word.parse().unwrap()).collect()
}

/// The titles of all marks.
fn titles(svg: &str) -> Vec<&str> {
    let marks = svg.split("<g class=\"mark\"").skip(1);
    marks.filter_map(|mark| mark.split("<title>").nth(1)?.split("</title>").next()).collect()
}

#[test]
fn csv_and_svg_have_the_same_figures() {
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
    for (index, (row, title)) in rows.iter().zip(titles).enumerate() {
        for value in &row[1..5] {
            let value: f64 = value.parse().unwrap();
            assert!(title.contains(&number::figure(value)), "{title}: {value}");
        }
        assert!(title.starts_with(row[0]) && title.contains(&format!("run &lt;{}&gt;", index % 6)));
    }
}

#[test]
fn values_outside_an_axis_are_left_out_with_a_note() {
    let mut chart = chart();
    chart.series[0].points[2].y = 0.0;
    chart.series[0].points[3].y = f64::NAN;
    chart.series[1].points[0].x = -1.0;
    let why = "a logarithmic axis has no place for 0, less, or what is not finite.";
    assert_eq!(chart.note(), Some(format!("3 points are not shown: {why}")));
    let svg = chart.svg();
    assert_eq!(titles(&svg).len(), 9);
    assert!(svg.contains("3 points are not shown: "));
    let rows = chart.csv().lines().count();
    assert_eq!(rows, 13, "CSV has all of them");
    // The line ends before the points that are missing and begins after them.
    let lines = svg.matches("stroke=\"#0072b2\" class=\"k-s0\" stroke-width=\"2\"").count();
    assert_eq!(lines, 3, "two runs, and the sample in the legend");

    chart.x.scale = Scale::Linear;
    chart.y.scale = Scale::Linear;
    let note = chart.note();
    assert!(note.is_some_and(|note| note.starts_with("1 point is not shown")));
}

#[test]
fn a_whisker_that_reaches_zero_ends_at_the_edge() {
    let mut chart = chart();
    chart.series.truncate(1);
    chart.series[0].points.truncate(1);
    (chart.series[0].points[0].low, chart.series[0].points[0].high) = (0.0, 2.0);
    let svg = chart.svg();
    assert_eq!((titles(&svg).len(), chart.note()), (1, None));
    assert!(svg.contains("(0 to 2)"));
}

/// Charts that ask for trouble.
fn odd() -> Vec<Chart> {
    let all = |points: &[(f64, f64)], x: Scale, y: Scale| {
        let point = |&(x, y): &(f64, f64)| Point { x, y, low: y, high: y, label: String::new() };
        let points = points.iter().map(point).collect();
        let each = |draw| Series { name: format!("{draw:?}"), draw, points: Vec::clone(&points) };
        Chart {
            title: "odd".to_owned(),
            x: ChartAxis::new("x", "m", x),
            y: ChartAxis::new("y", "s", y),
            series: [Draw::Points, Draw::Line].map(each).to_vec(),
            guides: vec![
                Guide::at("y", 1.0),
                Guide::power("p", -9.0, [1.0, 1.0], [2.0, 0.5]),
                Guide::at("nowhere", f64::NAN),
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
        for scale in [Scale::Linear, Scale::Log] {
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
        for svg in &chart.elements().into_iter().chain([chart.svg()]).collect::<Vec<_>>() {
            let frame: Vec<f64> = numbers(attributes(svg, "viewBox")[0]);
            // Marks at an end stand out by their radius.
            let room = 6.0;
            let is_within = |at: &[f64]| {
                (0..2).all(|side| {
                    let start = frame[side] - room;
                    (start..=frame[side] + frame[side + 2] + room).contains(&at[side])
                })
            };
            let paths = attributes(svg, "d").into_iter().map(numbers);
            let pairs = |x, y| attributes(svg, x).into_iter().zip(attributes(svg, y));
            let others = pairs("x", "y").chain(pairs("cx", "cy"));
            let others = others.map(|(x, y)| numbers(&format!("{x} {y}")));
            for shape in paths.chain(others) {
                assert!(shape.chunks(2).all(is_within), "{chart:?}\n{shape:?} {frame:?}");
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

/// Whatever the lines are, no name is on another.
#[test]
fn names_of_guides_are_apart() {
    let mut chart = chart();
    let y = |at: usize| chart.series[0].points[at].y;
    let power = |name, slope| Guide::power(name, slope, [1.0, y(0)], [32.0, y(5)]);
    chart.guides = vec![
        power("−a", -0.5),
        power("−b", -0.52),
        power("−c", -1.4),
        Guide::at("−d", 0.9 * y(5)),
        Guide::at("−e", 0.85 * y(5)),
    ];
    for svg in chart.elements() {
        let texts = svg.split("<text").skip(1).filter(|text| text.contains(">−"));
        let place = |text: &str| ["x", "y"].map(|name| numbers(attributes(text, name)[0])[0]);
        let names: Vec<_> = texts.map(place).collect();
        assert_eq!(names.len(), 5);
        for (index, a) in names.iter().enumerate() {
            for b in &names[index + 1..] {
                let near = (a[0] - b[0]).abs() < 8.0 && (a[1] - b[1]).abs() < 11.0;
                assert!(!near, "{names:?}");
            }
        }
    }
}
