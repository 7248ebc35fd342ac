//! The result of a comparison, as text and as a page.

use std::fmt::Write as _;
use std::path::Path;

use super::{Change, Ratio, Regression, Side, TOLERANCE, Verdict};
use crate::files::{to_json, write_text};
use crate::page::{Block, Cell, Details, Fact, Page, Section, Table};
use crate::plot::{Axis, Chart, Draw, Guide, Point, Scale, Series};
use wavecrest_base::error::Result;

impl Verdict {
    /// The verdict in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Worse => "worse",
            Self::Better => "better",
            Self::Same => "unchanged",
        }
    }
}

impl Regression {
    /// Writes `compare.html` and `compare.json` to `folder`, which is created if it is missing.
    ///
    /// # Errors
    /// If one of them cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder)
            .map_err(|e| wavecrest_base::error::Error::io("cannot create the folder", folder, e))?;
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

    /// The page: changes first, then all comparisons.
    pub fn page(&self) -> Page {
        let mut sections = vec![Section::new("All comparisons", self.all())];
        let curves = self.ratios.iter().filter(|ratio| !ratio.curves.is_empty());
        let (changed, unchanged): (Vec<&Ratio>, Vec<&Ratio>) =
            curves.partition(|ratio| ratio.verdict != Verdict::Same);
        let charts = |ratios: Vec<&Ratio>| ratios.into_iter().map(curve).collect::<Vec<Block>>();
        let mut blocks = charts(changed);
        if !unchanged.is_empty() {
            let (summary, blocks_of) = ("Unchanged".to_owned(), charts(unchanged));
            blocks.push(Block::Details(Details { summary, blocks: blocks_of }));
        }
        if !blocks.is_empty() {
            sections.push(Section::new("Error against time", blocks));
        }
        sections
            .push(Section::new("What was compared", vec![side(&self.before), side(&self.after)]));
        let (title, lead) = ("Before and after".to_owned(), self.answer());
        Page { title, lead, first: self.changed(), sections }
    }

    /// Changes for the worse or better, the largest first, and notes on the comparison.
    fn changed(&self) -> Vec<Block> {
        let mut blocks: Vec<Block> = self.warnings.iter().cloned().map(Block::Warning).collect();
        let changed = self.ratios.iter().filter(|ratio| ratio.verdict != Verdict::Same);
        let mut changed: Vec<&Ratio> = changed.collect();
        changed.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        if !changed.is_empty() {
            blocks.push(Block::Table(table("Changes, after over before", changed)));
        }
        if !self.changes.is_empty() {
            let rows = self.changes.iter().map(change).collect();
            let caption = "Deterministic results that differ";
            blocks.push(Block::Table(Table::new(caption, "scene|what|before|after|verdict", rows)));
        }
        blocks
    }

    /// Every ratio, in a chart for each scene.
    fn all(&self) -> Vec<Block> {
        let scenes = self.ratios.chunk_by(|a, b| a.scene == b.scene);
        let mut blocks: Vec<Block> = scenes.map(|ratios| Block::Chart(forest(ratios))).collect();
        let caption =
            "All ratios, after over before, with p-values corrected for the number of comparisons";
        let every = Block::Table(table(caption, self.ratios.iter().collect()));
        let summary = "Every ratio".to_owned();
        blocks.push(Block::Details(Details { summary, blocks: vec![every] }));
        blocks
    }
}

/// The ratios of a scene, a row each, without those that are certainly 1.
fn forest(ratios: &[Ratio]) -> Chart {
    let (title, all) = (format!("{}: after over before", ratios[0].scene), ratios.len());
    let ratios: Vec<&Ratio> = ratios.iter().filter(|r| r.low < 1.0 || r.high > 1.0).collect();
    let name = |r: &&Ratio| format!("{}, {}", r.what, r.of);
    let series = |verdict: Verdict| {
        let rows = ratios.iter().enumerate().filter(|(_, ratio)| ratio.verdict == verdict);
        let point =
            |(row, r): (usize, &&Ratio)| Point::new(row as f64, r.ratio).within(r.low, r.high);
        Series::of(verdict.word(), rows.map(point).collect())
    };
    let equal = match all - ratios.len() {
        0 => String::new(),
        1 => " 1 ratio is exactly 1 and not shown.".to_owned(),
        n => format!(" {n} ratios are exactly 1 and not shown."),
    };
    Chart {
        title,
        x: Axis::new("", "", Scale::Names(ratios.iter().map(name).collect())),
        y: Axis::new("ratio", "", Scale::Linear),
        series: [Verdict::Same, Verdict::Worse, Verdict::Better].map(series).to_vec(),
        guides: vec![Guide::at("unchanged", 1.0)],
        caption: format!(
            "Right of the line is worse. All intervals together have 99 per cent confidence; changes of up to {} per \
             cent are ignored.{equal}",
            TOLERANCE * 100.0
        ),
    }
}

fn table(caption: &str, ratios: Vec<&Ratio>) -> Table {
    let header = "scene|setting|ratio of|>ratio|>interval|>p|verdict";
    Table::new(caption, header, ratios.into_iter().map(row).collect())
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
fn curve(ratio: &Ratio) -> Block {
    let series = |(name, points): (&str, &Vec<[f64; 2]>)| Series {
        name: name.to_owned(),
        draw: Draw::Line,
        points: points.iter().map(|[x, y]| Point::new(*x, *y)).collect(),
    };
    Block::Chart(Chart {
        title: format!("{}: {}", ratio.scene, ratio.what),
        x: Axis::new("time", "s", Scale::Log),
        y: Axis::new("RMSE", "", Scale::Log),
        series: ["before", "after"].into_iter().zip(&ratio.curves).map(series).collect(),
        guides: Vec::new(),
        caption: format!("Time at equal error, after over before: {:.3}.", ratio.ratio),
    })
}

fn side(side: &Side) -> Block {
    let of = |key: &str| match &side.machine[key] {
        serde_json::Value::Null => "unknown".to_owned(),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    Block::Facts(vec![
        Fact::new("Measurement", side.path.clone()),
        Fact::new("wavecrest", side.version.clone()),
        Fact::new("Commit", side.commit.clone().unwrap_or_else(|| "unknown".to_owned())),
        Fact::new("Processor", of("processor")),
        Fact::new("Cores, threads", format!("{}, {}", of("cores"), of("threads"))),
    ])
}
