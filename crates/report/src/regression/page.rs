//! The result of a comparison, as text and as a page.

use std::path::Path;

use super::{Change, Ratio, Regression, Side, TOLERANCE, Verdict};
use crate::bench::page::recorded;
use crate::files::write_json;
use crate::page::{Block, Cell, Fact, Page, Section, Table};
use crate::plot::{Axis, Chart, Guide, Point, Scale, Series};
use crate::text::text;
use wavecrest_base::error::{Error, Result};

impl Regression {
    /// Writes `compare.html` and `compare.json` to `folder`, which is created if it is missing.
    ///
    /// # Errors
    /// If one of them cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::io("cannot create the folder", folder, e))?;
        write_json(&folder.join("compare.json"), self)?;
        self.page().write(&folder.join("compare.html"))
    }

    /// For a terminal: every comparison, and the answer.
    pub fn text(&self) -> String {
        text(&self.tables()) + "\n" + &self.answer() + "\n"
    }

    /// The page: the values that changed, then all comparisons.
    pub fn page(&self) -> Page {
        let scenes = self.ratios.chunk_by(|a, b| a.scene == b.scene);
        let charts = scenes.map(|ratios| Block::Chart(forest(ratios)));
        let sides = vec![side(&self.before), side(&self.after)];
        Page {
            title: "Before and after".to_owned(),
            lead: self.answer(),
            first: self.warnings.iter().cloned().map(Block::Warning).collect(),
            sections: vec![
                Section::new("All comparisons", charts.chain(self.tables()).collect()),
                Section::new("What was compared", sides),
            ],
        }
    }

    /// The ratios, those for the worse first, and deterministic values that changed.
    fn tables(&self) -> Vec<Block> {
        let mut ratios: Vec<&Ratio> = self.ratios.iter().collect();
        ratios.sort_by_key(|ratio| ratio.verdict as u8);
        let caption = "Ratios, after over before: above 1 is worse";
        let header = "verdict|scene|setting|ratio of|>ratio|>interval";
        let mut tables = vec![Table::new(caption, header, ratios.into_iter().map(row).collect())];
        if !self.changes.is_empty() {
            let cells = |c: &Change| {
                [c.verdict.name(), &c.scene, &c.what, &c.before, &c.after].map(Cell::text).to_vec()
            };
            let rows = self.changes.iter().map(cells).collect();
            let header = "verdict|scene|what|before|after";
            tables.push(Table::new("Deterministic results that differ", header, rows));
        }
        tables.into_iter().map(Block::Table).collect()
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
        Series {
            name: verdict.name().to_owned(),
            points: rows.map(point).collect(),
            ..Series::default()
        }
    };
    Chart {
        title,
        x: Axis::new("", "", Scale::Names(ratios.iter().map(name).collect())),
        y: Axis::new("ratio", "", Scale::Linear),
        series: [Verdict::Same, Verdict::Worse, Verdict::Better].map(series).to_vec(),
        guides: vec![Guide::at("unchanged", 1.0)],
        caption: format!(
            "Right of the line is worse. All intervals together have 99 per cent confidence; changes of up to {} per \
             cent are ignored. Ratios that are exactly 1: {}.",
            TOLERANCE * 100.0,
            all - ratios.len()
        ),
    }
}

fn row(r: &Ratio) -> Vec<Cell> {
    let words = [r.verdict.name(), &r.scene, &r.what, r.of].map(Cell::text);
    let interval = Cell::text(format!("{:.3} to {:.3}", r.low, r.high));
    words.into_iter().chain([Cell::decimals(r.ratio, 3), interval]).collect()
}

fn side(side: &Side) -> Block {
    let mut facts = vec![Fact::new("Measurement", side.path.clone())];
    facts.extend(recorded(&side.machine, &side.version, side.commit.as_deref()));
    Block::Facts(facts)
}
