//! What passes cost for each of what they handle.

#![allow(missing_docs, reason = "the tables of crate::bench say it once")]

use serde::Serialize;

use wavecrest_core::counters::Counters;
use wavecrest_core::tile::TimedPass;

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
        (TimedPass::Generate, "camera ray", c.primary_rays),
        (TimedPass::Intersect, "ray", c.primary_rays + c.secondary_rays),
        (TimedPass::Shade, "plain hit", c.look_ups.plain),
        (TimedPass::Maps, "mapped hit", c.look_ups.mapped),
        (TimedPass::Maps, "look-up of a map", c.look_ups.maps),
        (TimedPass::Shadow, "shadow ray", c.shadow_rays),
        (TimedPass::Resolve, "sample", c.primary_rays),
    ];
    let with_work = handled.into_iter().filter(|(.., count)| *count > 0);
    let cost = |(pass, of, count): (TimedPass, _, _)| {
        let &(pass, seconds) = passes.iter().find(|(name, _)| *name == pass.name())?;
        Some(Cost { pass, of, count, nanoseconds: 1e9 * seconds / count as f64 })
    };
    with_work.filter_map(cost).collect()
}
