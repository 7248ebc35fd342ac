//! What became of each comparison, as text and as a page.

use std::fmt::Write as _;
use std::path::Path;

use super::{Change, Ratio, Regression, Side, TOLERANCE, Verdict};
use crate::files::{to_json, write_text};
use crate::page::{Block, Cell, Fact, Page, Section, Table};
use crate::plot::{Axis, Chart, Draw, Guide, Point, Scale, Series};
use wavecrest_base::error::Result;

impl Verdict {
    /// The verdict in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Worse => "worse",
            Self::Better => "better",
            Self::Same => "as before",
        }
    }
}

impl Regression {
    /// Writes `compare.html` and `compare.json` into `folder`, which is made if it is not there.
    ///
    /// # Errors
    /// When one of them cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder)
            .map_err(|e| wavecrest_base::error::Error::io("cannot make the folder", folder, e))?;
        let json = folder.join("compare.json");
        write_text(&json, &to_json(self).map_err(|e| e.in_file(&json))?)?;
        self.page().write(&folder.join("compare.html"))
    }

    /// For a terminal: every comparison, and the answer.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for r in &self.ratios {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{:<9}  {:.3} ({:.3} to {:.3})  {}: {}, {}",
                r.verdict.word(),
                r.ratio,
                r.low,
                r.high,
                r.scene,
                r.of,
                r.what
            );
        }
        for c in &self.changes {
            let word = c.verdict.word();
            let _ = writeln!(
                text,
                "{word:<9}  {}: {}: {}, then {}",
                c.scene, c.what, c.before, c.after
            );
        }
        text + &self.answer() + "\n"
    }

    /// The page.
    pub fn page(&self) -> Page {
        let mut sections = vec![Section::new("What became of it", self.found())];
        let curves = self.ratios.iter().filter(|ratio| !ratio.curves.is_empty());
        let curves: Vec<Block> = curves.map(|ratio| Block::Chart(curve(ratio))).collect();
        if !curves.is_empty() {
            sections.push(Section::new("Error against time", curves));
        }
        sections
            .push(Section::new("What was compared", vec![side(&self.before), side(&self.after)]));
        let (title, lead) = ("Before and after".to_owned(), self.answer());
        Page { title, lead, sections, ..Page::default() }
    }

    fn found(&self) -> Vec<Block> {
        let mut blocks: Vec<Block> = self.warnings.iter().cloned().map(Block::Warning).collect();
        blocks.push(Block::Chart(forest(&self.ratios)));
        if !self.changes.is_empty() {
            let rows = self.changes.iter().map(change).collect();
            let caption = "What follows from the program alone, and is not as it was";
            blocks.push(Block::Table(Table::new(caption, "scene|what|before|after|verdict", rows)));
        }
        let rows = self.ratios.iter().map(row).collect();
        let caption = "Every ratio, after over before, and the chance of as much where nothing changed, corrected \
                       for the number of comparisons";
        let header = "scene|what|of|>ratio|>interval|>chance|verdict";
        blocks.push(Block::Table(Table::new(caption, header, rows)));
        blocks
    }
}

/// All ratios, a row each.
fn forest(ratios: &[Ratio]) -> Chart {
    let several = ratios.iter().any(|ratio| ratio.scene != ratios[0].scene);
    let name = |r: &Ratio| {
        let scene = if several { format!("{}: ", r.scene) } else { String::new() };
        format!("{scene}{}, {}", r.what, r.of)
    };
    let series = |verdict: Verdict| {
        let rows = ratios.iter().enumerate().filter(|(_, ratio)| ratio.verdict == verdict);
        let point =
            |(row, r): (usize, &Ratio)| Point::new(row as f64, r.ratio).within(r.low, r.high);
        Series::of(verdict.word(), rows.map(point).collect())
    };
    Chart {
        title: "After over before".to_owned(),
        x: Axis::new("", "", Scale::Names(ratios.iter().map(name).collect())),
        y: Axis::new("ratio", "", Scale::Linear),
        series: [Verdict::Same, Verdict::Worse, Verdict::Better].map(series).to_vec(),
        guides: vec![Guide::at("as before", 1.0)],
        caption: format!(
            "Right of the line is worse. The intervals hold together with 99 per cent; up to {} per cent is \
             not called a change.",
            TOLERANCE * 100.0
        ),
    }
}

fn row(r: &Ratio) -> Vec<Cell> {
    vec![
        Cell::text(r.scene.clone()),
        Cell::text(r.what.clone()),
        Cell::text(r.of),
        Cell::decimals(r.ratio, 3),
        Cell::text(format!("{:.3} to {:.3}", r.low, r.high)),
        Cell::number(r.p, if r.p < 1e-4 { "< 0.0001".to_owned() } else { format!("{:.4}", r.p) }),
        Cell::text(r.verdict.word()),
    ]
}

fn change(c: &Change) -> Vec<Cell> {
    [&*c.scene, &*c.what, &*c.before, &*c.after, c.verdict.word()].map(Cell::text).to_vec()
}

/// Error against time on both sides.
fn curve(ratio: &Ratio) -> Chart {
    let series = |(name, points): (&str, &Vec<[f64; 2]>)| Series {
        name: name.to_owned(),
        draw: Draw::Line,
        points: points.iter().map(|[x, y]| Point::new(*x, *y)).collect(),
    };
    Chart {
        title: format!("{}: {}", ratio.scene, ratio.what),
        x: Axis::new("time", "s", Scale::Log),
        y: Axis::new("RMSE", "", Scale::Log),
        series: ["before", "after"].into_iter().zip(&ratio.curves).map(series).collect(),
        guides: Vec::new(),
        caption: format!("{:.3} times the time to an equal error.", ratio.ratio),
    }
}

fn side(side: &Side) -> Block {
    let told = |key: &str| match &side.machine[key] {
        serde_json::Value::Null => "not told".to_owned(),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    Block::Facts(vec![
        Fact::new("Of", side.path.clone()),
        Fact::new("wavecrest", side.version.clone()),
        Fact::new("Commit", side.commit.clone().unwrap_or_else(|| "not told".to_owned())),
        Fact::new("Processor", told("processor")),
        Fact::new("Cores, threads", format!("{}, {}", told("cores"), told("threads"))),
    ])
}
