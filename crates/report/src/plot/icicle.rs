//! Draws an [`Icicle`]: a row for each level, below the part that it divides. Undivided parts are
//! coloured by name.

use super::drawing::{At, BELOW, BESIDE, Drawing, Frame, LABEL, Mark, Shape, Text};
use super::legend::{self, Sample};
use super::number::{exact, figure, seconds};
use super::paint::Paint;
use super::{Icicle, Part, font};

/// The height of a row, and of the last one.
const ROW: f64 = 30.0;
const LAST_ROW: f64 = 20.0;
/// Width of the gap between parts.
const BETWEEN: f64 = 1.5;
/// Distance from the side of a part to its label.
const GAP: f64 = 7.0;
/// Space for labels below the last row.
const UNDER: f64 = LABEL + 10.0;

/// Draws the parts.
pub(super) fn draw(icicle: &Icicle, frame: Frame) -> Drawing {
    let mut drawing = Drawing::new(&icicle.title, frame);
    let names = leaf_names(&icicle.parts);
    let named = names.iter().enumerate();
    legend::draw(&mut drawing, named.map(|(index, name)| (index, *name, Sample::Square)));
    let top = drawing.height;
    let levels = icicle.levels.len();
    let bottom = top + ROW * levels.saturating_sub(1) as f64 + LAST_ROW;
    let all: f64 = icicle.parts.iter().map(Part::time).sum();
    let mut canvas = Canvas { drawing: &mut drawing, names, bottom, scale: frame.width / all };
    if all > 0.0 {
        canvas.draw(&icicle.parts, [0.0, top], &[]);
    }
    drawing.height = bottom + UNDER;
    drawing
}

/// The names of undivided parts, in the order of their first occurrence.
fn leaf_names(parts: &[Part]) -> Vec<&str> {
    let mut names = Vec::new();
    for leaf in parts.iter().flat_map(Part::leaves) {
        if !names.contains(&leaf.name.as_str()) {
            names.push(&leaf.name);
        }
    }
    names
}

struct Canvas<'d> {
    drawing: &'d mut Drawing,
    /// The names with colours.
    names: Vec<&'d str>,
    /// The lower end of undivided parts.
    bottom: f64,
    /// Pixels per second.
    scale: f64,
}

impl Canvas<'_> {
    /// Draws `parts` from a point to the right, and their subdivisions below. `above` are their
    /// parents, the nearest last.
    fn draw(&mut self, parts: &[Part], [mut x, y]: At, above: &[&Part]) {
        for part in parts.iter().filter(|part| part.time() > 0.0) {
            let right = x + self.scale * part.time();
            self.one(part, [x, right], y, above);
            let within: Vec<&Part> = above.iter().copied().chain([part]).collect();
            self.draw(&part.parts, [x, y + ROW], &within);
            x = right;
        }
    }

    fn one(&mut self, part: &Part, [left, right]: [f64; 2], top: f64, above: &[&Part]) {
        let is_leaf = part.parts.is_empty();
        let bottom = if is_leaf { self.bottom } else { top + ROW };
        let index = self.names.iter().position(|name| *name == part.name).unwrap_or_default();
        let paint = match above.len() {
            _ if is_leaf => Paint::Series(index),
            0 => Paint::Grid,
            _ => Paint::Faint,
        };
        let points = vec![[left, top], [right, top], [right, bottom], [left, bottom]];
        self.drawing.shapes.push(Shape::Begin(mark(part, above)));
        self.drawing.shapes.push(Shape::Area { points, paint });
        for line in [[[right, top], [right, bottom]], [[left, bottom], [right, bottom]]] {
            self.drawing.line(line.to_vec(), Paint::Paper, BETWEEN);
        }
        self.drawing.shapes.push(Shape::End);
        let (at, line) = if is_leaf { (bottom + 4.0, BELOW) } else { (top + ROW / 2.0, BESIDE) };
        if let Some(label) = label(part, right - left) {
            let text = Text::new(&label, [(left + right) / 2.0, at], [0.5, line], LABEL);
            self.drawing.text(text.in_ink());
        }
    }
}

/// Name and time of a part, or only its name, if they fit.
fn label(part: &Part, width: f64) -> Option<String> {
    let labels = [format!("{}  {}", part.name, seconds(part.time())), part.name.clone()];
    labels.into_iter().find(|label| font::width(label, LABEL) + 2.0 * GAP <= width)
}

/// The mark of a part.
fn mark(part: &Part, above: &[&Part]) -> Mark {
    let names: Vec<&str> = above.iter().map(|p| &*p.name).chain([&*part.name]).collect();
    let time = part.time();
    let share = |whole: &&Part| {
        let percent = figure(libm::round(1000.0 * time / whole.time()) / 10.0);
        format!(", {percent}% of {}", whole.name)
    };
    let shares: String = above.iter().rev().map(share).collect();
    let title = format!("{}\n{}{shares}", names.join(", "), seconds(time));
    let figures = vec![("part", names.join(", ")), ("seconds", exact(time))];
    Mark { title, figures, near: None }
}

#[cfg(test)]
mod tests {
    use super::super::figure::Figure as _;
    use super::super::tests::{attributes, png, titles};
    use super::*;

    /// Two precisions; the second has an effect of two passes beside what comes before it.
    fn icicle() -> Icicle {
        let effect = |name: &str, shade, shadow| {
            Part::of(name, vec![Part::new("shade", shade), Part::new("shadow", shadow)])
        };
        Icicle {
            title: "Time".to_owned(),
            levels: ["precision", "effect", "pass"].map(str::to_owned).to_vec(),
            parts: vec![
                Part::of("fast", vec![effect("lights", 0.75, 0.25)]),
                Part::of("exact", vec![Part::new("load", 1.0), effect("lights", 0.5, 1.5)]),
            ],
            caption: "How to <read> it.".to_owned(),
        }
    }

    #[test]
    fn rows_are_the_parts_that_are_not_divided() {
        let expected = "precision,effect,pass,seconds\r\n\
                        fast,lights,shade,0.75\r\nfast,lights,shadow,0.25\r\n\
                        exact,load,,1\r\nexact,lights,shade,0.5\r\nexact,lights,shadow,1.5\r\n";
        assert_eq!(icicle().csv(), expected);
        let json = serde_json::to_value(icicle()).unwrap();
        assert_eq!(json["parts"][1]["seconds"], 3.0);
        assert_eq!(json["parts"][1]["parts"][1]["parts"][0]["name"], "shade");
    }

    #[test]
    fn parts_tell_their_time_and_their_share() {
        let svg = icicle().svg();
        let expected = [
            "fast\n1\u{202f}s",
            "fast, lights\n1\u{202f}s, 100% of fast",
            "fast, lights, shade\n750\u{202f}ms, 75% of lights, 75% of fast",
            "fast, lights, shadow\n250\u{202f}ms, 25% of lights, 25% of fast",
            "exact\n3\u{202f}s",
            "exact, load\n1\u{202f}s, 33.3% of exact",
            "exact, lights\n2\u{202f}s, 66.7% of exact",
            "exact, lights, shade\n500\u{202f}ms, 25% of lights, 16.7% of exact",
            "exact, lights, shadow\n1.5\u{202f}s, 75% of lights, 50% of exact",
        ];
        assert_eq!(titles(&svg), expected);
        let seconds = ["1", "1", "0.75", "0.25", "3", "1", "2", "0.5", "1.5"];
        assert_eq!(attributes(&svg, "data-seconds"), seconds);
    }

    /// Left and right of each part, in the order of the marks.
    fn sides(drawing: &Drawing) -> Vec<[f64; 2]> {
        let areas = drawing.shapes.windows(2).filter_map(|pair| match pair {
            [Shape::Begin(_), Shape::Area { points, .. }] => Some([points[0][0], points[1][0]]),
            _ => None,
        });
        areas.collect()
    }

    #[test]
    fn widths_are_in_proportion_and_labels_fit() {
        for frame in [Frame::FILE, Frame::WIDE, Frame::NARROW] {
            let drawing = icicle().drawing(frame);
            let found = sides(&drawing);
            let quarters =
                [[0, 4], [0, 4], [0, 3], [3, 4], [4, 16], [4, 8], [8, 16], [8, 10], [10, 16]];
            for (sides, quarter) in found.iter().zip(quarters) {
                for (pixel, quarter) in sides.iter().zip(quarter) {
                    assert!((pixel - frame.width * f64::from(quarter) / 16.0).abs() < 1e-9);
                }
            }
            assert_eq!(found.len(), quarters.len());
            let mut labels = 0;
            for shape in &drawing.shapes {
                let Shape::Text(text) = shape else { continue };
                if text.anchor == 0.5 {
                    let ends = [text.at[0] - text.width() / 2.0, text.at[0] + text.width() / 2.0];
                    assert!(found.iter().any(|s| s[0] < ends[0] && ends[1] < s[1]), "{text:?}");
                    labels += 1;
                }
            }
            assert!(labels >= 5, "{labels}");
        }
    }

    #[test]
    fn a_png_shows_what_the_svg_does() {
        let bytes = png(|path| icicle().png(path, 720));
        let image = image::load_from_memory(&bytes).unwrap().to_rgb8();
        let count = |index| {
            let rgb = Paint::Series(index).rgb();
            image.pixels().filter(|pixel| pixel.0 == rgb).count() as f64
        };
        // Shade, shadow, load, the last in two rows; and a block each in the legend.
        let ratio = count(1) / count(0);
        assert!((1.3..1.45).contains(&ratio), "{ratio}");
        assert!((1.8..2.1).contains(&(count(2) / count(0))), "{}", count(2) / count(0));
    }

    #[test]
    fn values_that_are_not_times_are_left_out_with_a_note() {
        let mut icicle = icicle();
        icicle.parts[1].parts[0].seconds = f64::NAN;
        assert_eq!(icicle.notes(), ["1 time is not shown: it is below 0 or not finite."]);
        assert_eq!(sides(&icicle.drawing(Frame::WIDE)).len(), 8);
        let none = Icicle { parts: vec![Part::new("x", 0.0)], ..icicle };
        assert!(sides(&none.drawing(Frame::NARROW)).is_empty());
        assert!(!none.svg().contains("NaN") && !none.svg().contains("inf"));
    }
}
