//! The price list: as written in JSON, see [`crate::effects`]; as blocks of a page, and as text.

#![allow(missing_docs, reason = "the table there says it once, for the JSON and for the fields")]

use serde::Serialize;

use crate::bench::equal::RunDifference;
use crate::bench::page::machine;
use crate::bench::{Machine, Ratio};
use crate::measure::{Rounds, busy};
use crate::page::{Block, Cell, Table};
use crate::statistics::{ImageSize, Rays, Samples};
use crate::summary::Summary;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;

/// The list.
#[derive(Clone, Debug, Serialize)]
pub struct PriceList {
    pub version: &'static str,
    pub machine: Machine,
    pub image: Option<ImageSize>,
    #[serde(flatten)]
    pub setting: EffectSetting,
    #[serde(flatten)]
    pub rounds: Rounds,
    pub difference: Option<RunDifference>,
    pub effects: Vec<Price>,
}

/// The settings of the renders.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EffectSetting {
    pub simd: Level,
    pub kernel: KernelChoice,
    pub precision: Precision,
    pub batch: usize,
}

/// The cost of one effect.
#[derive(Clone, Debug, Serialize)]
pub struct Price {
    pub effect: String,
    pub added_to: Option<String>,
    pub reached: bool,
    pub simulated: Vec<&'static str>,
    pub rays: Rays,
    pub samples: Samples,
    pub bytes_per_path: usize,
    pub wavefront: Cost,
    pub recursive: Cost,
}

/// The cost with one tracer.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    pub seconds: Summary,
    pub seconds_per_mray: f64,
    pub price: Option<Ratio>,
    pub nanoseconds_a_hit: Option<f64>,
}

/// The list for a terminal, with the machine.
pub fn text(list: &PriceList) -> String {
    let mut blocks = vec![Block::Facts(machine(&list.machine))];
    match &list.difference {
        None => blocks.extend(self::blocks(list)),
        Some(differs) => blocks.push(Block::Warning(differs.words())),
    }
    crate::text::text(&blocks)
}

/// The cost of each effect with both tracers.
fn blocks(list: &PriceList) -> Vec<Block> {
    let table = |caption: &str, reached: bool| {
        let header = "effect|added to|>wavefront|>ns a ray|>map, ns a hit|>recursive|>ns a ray|>map, ns a hit|>bytes a path";
        let rows = list.effects.iter().filter(|p| p.reached == reached).map(row).collect();
        Block::Table(Table::new(caption, header, rows))
    };
    let [width, height] = list.image.map_or([0; 2], |image| [image.width, image.height]);
    let busy = busy([list.rounds]).map_or_else(String::new, |words| format!(" {words}."));
    let lead = format!(
        "Each effect is added on its own to a small scene of {width} x {height} pixels. The ratio is the time with the effect \
         over the time without it, round by round, in {} rounds.{busy} For maps there are also the \
         nanoseconds of a processor that they add for each hit on a surface. Bytes are those of the columns of the wavefront \
         tracer.",
        list.rounds.rounds
    );
    vec![
        Block::Paragraph(lead),
        table("Effects in view: ratios of times", true),
        table("Effects that nothing in view shows: same image, same work", false),
    ]
}

fn row(p: &Price) -> Vec<Cell> {
    let costs = [&p.wavefront, &p.recursive].map(cells).concat();
    let names = vec![Cell::text(&p.effect), Cell::text(p.added_to.as_deref().unwrap_or("nothing"))];
    [names, costs, vec![Cell::figure(p.bytes_per_path as f64)]].concat()
}

/// The ratio, the time of a ray, and what a map adds for each hit.
fn cells(cost: &Cost) -> Vec<Cell> {
    let ratio = cost.price.as_ref().map_or_else(|| Cell::text("1"), Ratio::cell);
    let a_hit = cost.nanoseconds_a_hit.filter(|ns| ns.is_finite());
    let a_hit = a_hit.map_or_else(Cell::default, |ns| Cell::decimals(ns, 1));
    vec![ratio, Cell::decimals(cost.seconds_per_mray * 1e3, 1), a_hit]
}
