//! What passes cost for each of what they handle.

#![allow(missing_docs, reason = "the tables of crate::bench say it once")]

use serde::Serialize;

use wavecrest_core::counters::Counters;
use wavecrest_core::tile::Timed;

/// The cost of a pass for one of what it handles.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    pub pass: &'static str,
    pub of: &'static str,
    pub count: u64,
    pub nanoseconds: f64,
}

/// The costs of those of the `passes` that have work, with their seconds. A tracer without a clock has none.
pub(super) fn costs(passes: &[(&'static str, f64)], c: &Counters) -> Vec<Cost> {
    let handled = [
        (Timed::Generate, "camera ray", c.primary_rays),
        (Timed::Intersect, "ray", c.primary_rays + c.secondary_rays),
        (Timed::Shade, "plain hit", c.look_ups.plain),
        (Timed::Maps, "mapped hit", c.look_ups.mapped),
        (Timed::Maps, "look-up of a map", c.look_ups.maps),
        (Timed::Shadow, "shadow ray", c.shadow_rays),
        (Timed::Resolve, "sample", c.primary_rays),
    ];
    let with_work = handled.into_iter().filter(|(.., count)| *count > 0);
    let cost = |(pass, of, count): (Timed, _, _)| {
        let &(pass, seconds) = passes.iter().find(|(name, _)| *name == pass.name())?;
        Some(Cost { pass, of, count, nanoseconds: 1e9 * seconds / count as f64 })
    };
    with_work.filter_map(cost).collect()
}
