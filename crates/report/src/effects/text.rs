//! The price list as text.

use super::list::{Cost, PriceList};
use crate::bench::page::machine;
use crate::page::{Block, Cell, Fact, Table};

/// A line for each effect: its work, and its time and price with each tracer.
pub fn text(list: &PriceList) -> String {
    let mut facts = machine(&list.machine);
    let image = &list.image;
    let rounds =
        format!("{}, {} others left out as the machine was busy", list.rounds, list.left_out);
    facts.push(Fact::new("image", format!("{} x {} pixels", image.width, image.height)));
    facts.push(Fact::new("rounds", rounds));
    let mut blocks = vec![Block::Facts(facts)];
    if let Some(differs) = &list.difference {
        let name = format!("{} ({:?})", differs.effect, differs.tracer);
        blocks.push(Block::Warning(differs.difference.words(&name, "the first render")));
        return crate::text::text(&blocks);
    }
    for (reached, caption) in [
        (
            true,
            "Effects: rays a pixel, bytes of ray state a path, and for each tracer the time of a million rays and the \
                price, as a ratio with its interval.",
        ),
        (false, "Effects that nothing in view shows."),
    ] {
        blocks.push(Block::Table(table(list, reached, caption)));
    }
    crate::text::text(&blocks)
}

fn table(list: &PriceList, reached: bool, caption: &str) -> Table {
    let pixels = f64::from(list.image.width) * f64::from(list.image.height);
    let mut group = None;
    let mut rows = Vec::new();
    for price in list.effects.iter().filter(|price| price.reached == reached) {
        if price.added_to != group {
            group = price.added_to;
            rows.push(vec![Cell::text(format!("added to {}:", group.unwrap_or_default()))]);
        }
        let rays = Cell::decimals(price.rays.all() as f64 / pixels, 2);
        let bytes = Cell::count(price.bytes_per_path as u64);
        let costs = [&price.wavefront, &price.recursive].map(cells).concat();
        rows.push([vec![Cell::text(price.effect), rays, bytes], costs].concat());
    }
    let header = "|>rays|>bytes|>wavefront, s|>price|>recursive, s|>price";
    Table::new(caption, header, rows)
}

fn cells(cost: &Cost) -> Vec<Cell> {
    let price = cost
        .price
        .map_or_else(Cell::default, |price| Cell::number(price.interval.median, price.words()));
    vec![Cell::decimals(cost.seconds_per_mray, 4), price]
}
