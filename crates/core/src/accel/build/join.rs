//! Joins the chunks: one hierarchy above the parts of all.
//!
//! obvhs builds a hierarchy over some subtrees of each chunk. Their own binary nodes are then put
//! back below it down to the parts, and reinsertion moves misplaced nodes. So only the very top is
//! built anew, and one hierarchy is converted, as if there were no chunks.

use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance};

use super::piece::{UpperNodes, view};
use crate::accel::arena::Unit;
use crate::accel::geometry::Geometry;
use crate::accel::wide::{Converter, Output, Owner, Part};
use crate::kernels::slab::Aabb;

/// Number of subtrees of each chunk that are clustered anew.
const SEEDS: usize = 8;

/// The share of the nodes above the parts that is reinserted at a time: more gained nothing.
const REINSERTED: f32 = 0.2;

/// A subtree of a chunk: the chunk, and a node of its upper part.
#[derive(Clone, Copy)]
struct Seed {
    chunk: usize,
    place: u32,
}

/// Writes the nodes that join the chunks' parts to the end of `top`. Returns their start and the
/// box around all.
pub(super) fn join(
    geometry: &Geometry,
    upper_nodes: &[UpperNodes],
    top: &mut [Unit],
) -> Option<(usize, Aabb)> {
    let parts: Vec<Part> =
        upper_nodes.iter().flat_map(|upper| upper.parts.iter().copied()).collect();
    if parts.is_empty() {
        return None;
    }
    let bvh = hierarchy(upper_nodes, parts.len());
    let mut converter = Converter::default();
    converter.evaluate(view(&bvh), |owner| Owner::Part(parts[owner as usize]));
    // The start of the nodes follows from their number: they are written twice.
    let mut start = 0;
    let mut output = Output::default();
    for _ in 0..2 {
        output.units.clear();
        let moved = |owner: u32| {
            let part = parts[owner as usize];
            Owner::Part(Part { unit: part.unit - start, ..part })
        };
        converter.emit(geometry, view(&bvh), moved, 0, &mut output);
        start = top.len().checked_sub(output.units.len())?;
    }
    top[start..].copy_from_slice(&output.units);
    let bounds = bvh.nodes.first()?.aabb();
    Some((start, Aabb { low: bounds.min.into(), high: bounds.max.into() }))
}

/// One binary hierarchy whose leaves are parts.
fn hierarchy(upper_nodes: &[UpperNodes], parts: usize) -> Bvh2 {
    let seeds: Vec<Seed> =
        upper_nodes.iter().enumerate().flat_map(|(chunk, upper)| seeds(chunk, upper)).collect();
    let node = |seed: &Seed| &upper_nodes[seed.chunk].nodes[seed.place as usize];
    let boxes: Vec<_> = seeds.iter().map(|seed| *node(seed).aabb()).collect();
    let parameters = BvhBuildParams::medium_build();
    let mut bvh = PlocBuilder::new().build(
        PlocSearchDistance::VeryHigh,
        &boxes,
        (0..boxes.len() as u32).collect(),
        parameters.sort_precision,
        0,
    );
    expand(&mut bvh.nodes, &seeds, upper_nodes);
    bvh.primitive_indices = (0..parts as u32).collect();
    bvh.max_depth = bvh.max_depth.max(2 * depth(&bvh.nodes));
    ReinsertionOptimizer::default().run(&mut bvh, REINSERTED, None);
    bvh
}

/// Some subtrees of a chunk; the largest boxes are opened first.
fn seeds(chunk: usize, upper: &UpperNodes) -> Vec<Seed> {
    let area = |seed: &Seed| upper.nodes[seed.place as usize].aabb().half_area();
    if upper.nodes.is_empty() {
        return Vec::new();
    }
    let mut seeds = vec![Seed { chunk, place: 0 }];
    while seeds.len() < SEEDS {
        let inner = |seed: &Seed| !upper.nodes[seed.place as usize].is_leaf();
        let open = (0..seeds.len()).filter(|&i| inner(&seeds[i]));
        let larger = |a: usize, b: usize| if area(&seeds[b]) > area(&seeds[a]) { b } else { a };
        let Some(largest) = open.reduce(larger) else { break };
        let left = upper.nodes[seeds[largest].place as usize].first_index;
        seeds[largest].place = left;
        seeds.push(Seed { chunk, place: left + 1 });
    }
    seeds
}

/// Replaces each leaf by the subtree of its seed.
fn expand(nodes: &mut Vec<Bvh2Node>, seeds: &[Seed], upper_nodes: &[UpperNodes]) {
    let firsts: Vec<u32> = upper_nodes
        .iter()
        .scan(0, |sum, upper| Some(std::mem::replace(sum, *sum + upper.parts.len() as u32)))
        .collect();
    let mut waiting: Vec<(usize, Seed)> = nodes
        .iter()
        .enumerate()
        .filter(|(_, node)| node.is_leaf())
        .map(|(place, node)| (place, seeds[node.first_index as usize]))
        .collect();
    while let Some((copy, Seed { chunk, place })) = waiting.pop() {
        let mut node = upper_nodes[chunk].nodes[place as usize];
        if node.is_leaf() {
            node.first_index += firsts[chunk];
        } else {
            let pair = nodes.len();
            nodes.extend([Bvh2Node::default(); 2]);
            waiting.push((pair, Seed { chunk, place: node.first_index }));
            waiting.push((pair + 1, Seed { chunk, place: node.first_index + 1 }));
            node.first_index = pair as u32;
        }
        nodes[copy] = node;
    }
}

/// The number of nodes on the longest path.
fn depth(nodes: &[Bvh2Node]) -> usize {
    let mut deepest = 0;
    let mut waiting = vec![(0, 1)];
    while let Some((place, depth)) = waiting.pop() {
        deepest = deepest.max(depth);
        let node: &Bvh2Node = &nodes[place as usize];
        if !node.is_leaf() {
            waiting.extend([(node.first_index, depth + 1), (node.first_index + 1, depth + 1)]);
        }
    }
    deepest
}
