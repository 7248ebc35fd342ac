//! The price list as blocks of a page, and as text.

use super::list::{Cost, Price, PriceList};
use crate::bench::Ratio;
use crate::bench::page::machine;
use crate::page::{Block, Cell, Table};

/// The list for a terminal, with the machine.
pub fn text(list: &PriceList) -> String {
    let mut blocks = vec![Block::Facts(machine(&list.machine))];
    match &list.difference {
        None => blocks.extend(self::blocks(list)),
        Some(differs) => {
            blocks.push(Block::Warning(differs.words()));
        }
    }
    crate::text::text(&blocks)
}

/// The cost of each effect with both tracers.
pub fn blocks(list: &PriceList) -> Vec<Block> {
    let table = |caption: &str, reached: bool| {
        let header = "effect|added to|>wavefront|>ns a ray|>recursive|>ns a ray|>bytes a path";
        let rows = list.effects.iter().filter(|p| p.reached == reached).map(row).collect();
        Block::Table(Table::new(caption, header, rows))
    };
    let [width, height] = list.image.map_or([0; 2], |image| [image.width, image.height]);
    let left_out = match list.rounds.left_out {
        0 => String::new(),
        n => format!(", without {n} in which other programs used the processors"),
    };
    let lead = format!(
        "Each effect is added on its own to a small scene of {} x {} pixels. The ratio is the time with the effect \
         over the time without it, round by round, in {} rounds{left_out}. Bytes are those of the columns of the \
         wavefront tracer.",
        width, height, list.rounds.rounds
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

/// The ratio, and the time of a ray.
fn cells(cost: &Cost) -> Vec<Cell> {
    let ratio = cost.price.as_ref().map_or_else(|| Cell::text("1"), Ratio::cell);
    vec![ratio, Cell::decimals(cost.seconds_per_mray * 1e3, 1)]
}
