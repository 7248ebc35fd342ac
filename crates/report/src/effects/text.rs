//! The price list as text.

use std::fmt::Write as _;

use super::list::{Cost, Price, PriceList};
use crate::bench::text::{machine, verdict};

/// A line for each effect: its work, and its time and price with each tracer.
pub fn text(list: &PriceList) -> String {
    let mut text = machine(&list.machine);
    if let Some(differs) = &list.difference {
        let _ = writeln!(text, "\n{}: {}", differs.effect, verdict(&differs.difference));
        return text;
    }
    let names = list.effects.iter().map(|price| price.effect.len() + 2);
    let width = names.max().unwrap_or_default();
    let image =
        format!("{} x {} pixels, {} rounds", list.image.width, list.image.height, list.rounds);
    let _ = writeln!(
        text,
        "\n{image}\n{:<width$}{:>10}{:>7}{:>52}{:>52}",
        "", "rays", "bytes", "wavefront", "recursive"
    );
    let of = format!("{:>11}{:>11}  {:>28}", "s/Mpixel", "s/Mray", "ratio (interval)");
    let _ = writeln!(text, "{:<width$}{:>10}{:>7}{of}{of}", "", "per pixel", "per path");
    let (reached, unreached): (Vec<&Price>, Vec<&Price>) =
        list.effects.iter().partition(|price| price.reached);
    let pixels = f64::from(list.image.width) * f64::from(list.image.height);
    rows(&mut text, &reached, width, pixels);
    let _ = writeln!(text, "effects that nothing in view shows");
    rows(&mut text, &unreached, width, pixels);
    text
}

/// Each group under the scene that it was added to.
fn rows(text: &mut String, prices: &[&Price], width: usize, pixels: f64) {
    let mut group = None;
    for price in prices {
        if price.added_to != group {
            group = price.added_to;
            let _ = writeln!(text, "added to {}", group.unwrap_or_default());
        }
        let name = format!("  {}", price.effect);
        let rays = price.rays.all() as f64 / pixels;
        let _ = write!(text, "{name:<width$}{rays:>10.2}{:>7}", price.bytes_per_path);
        let costs = [&price.wavefront, &price.recursive].map(columns).concat();
        let _ = writeln!(text, "{}", costs.trim_end());
    }
}

fn columns(cost: &Cost) -> String {
    let price = cost.price.map_or_else(String::new, |price| {
        let i = price.interval;
        format!("{:.3} ({:.3} to {:.3})", i.median, i.low, i.high)
    });
    format!("{:>11.4}{:>11.4}  {price:>28}", cost.seconds_per_mpixel, cost.seconds_per_mray)
}
