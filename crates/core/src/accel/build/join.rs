//! Joins the chunks: one hierarchy above the parts of all, improved by reinsertion, and converted as
//! if there were no chunks.

use obvhs::BvhBuildParams;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance};

use super::piece::{from_obvhs, to_obvhs};
use crate::accel::arena::{Kind, Unit};
use crate::accel::wide::{Converter, Output, Owner, Part};
use crate::geometry::Geometry;
use crate::kernels::slab::Aabb;

/// The share of the nodes above the parts that is reinserted at a time: more gained nothing.
const REINSERTED: f32 = 0.2;

/// The nodes that join the chunks' parts, to be placed up to unit `end`; and the kind of the first
/// with its box.
pub(super) fn join(
    geometry: &Geometry,
    parts: &[Part],
    end: usize,
) -> Option<(Vec<Unit>, Kind, Aabb)> {
    let boxes: Vec<_> = parts.iter().map(|part| to_obvhs(part.bounds)).collect();
    let mut bvh = PlocBuilder::new().build(
        PlocSearchDistance::Low,
        &boxes,
        (0..boxes.len() as u32).collect(),
        BvhBuildParams::medium_build().sort_precision,
        0,
    );
    ReinsertionOptimizer::default().run(&mut bvh, REINSERTED, None);
    let mut converter = Converter::default();
    converter.evaluate(&bvh, |owner| Owner::Part(parts[owner as usize]));
    // The start of the nodes follows from their number: they are written twice.
    let (mut start, mut kind) = (0, Kind::Node);
    let mut output = Output::default();
    for _ in 0..2 {
        output.units.clear();
        let moved = |owner: u32| {
            let part = parts[owner as usize];
            Owner::Part(Part { unit: part.unit - start, ..part })
        };
        kind = converter.emit(geometry, &bvh, moved, 0, &mut output);
        start = end.checked_sub(output.units.len())?;
    }
    Some((output.units, kind, from_obvhs(bvh.nodes.first()?.aabb())))
}
