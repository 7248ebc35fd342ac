//! Nodes: the tree that places meshes, cameras and lights.
//!
//! The format requires a tree; invalid files may contain loops, or a node with two parents. Both
//! are refused before the tree is walked. The walk keeps its own list, so that no depth of a file
//! overflows the stack.

use glam::{DAffine3, DMat3, DVec3};

use crate::format::Range;
use wavecrest_base::error::{Error, ErrorKind, Result};

use super::accessor::Accessor;
use super::fields::{Fields, LIGHTS};
use super::transform::{Instancing, UNTURNED, greatest, is_place, transform};

/// A node.
#[derive(Clone, Debug, Default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) mesh: Option<usize>,
    pub(super) camera: Option<usize>,
    pub(super) light: Option<usize>,
    /// Where it shows its mesh, if not only at its own place.
    pub(super) instancing: Option<Instancing>,
    children: Vec<usize>,
    /// The transform to the space of its parent.
    local: DAffine3,
}

impl Node {
    /// Reads an element of `nodes`.
    pub(super) fn read(fields: &Fields<'_>, accessors: Option<&[Accessor]>) -> Result<Self> {
        let light = fields.extension(LIGHTS, |found| found.need_index("light", "lights"));
        Ok(Self {
            name: fields.name()?,
            mesh: fields.index("mesh", "meshes")?,
            camera: fields.index("camera", "cameras")?,
            light: light?,
            instancing: Instancing::read(fields, accessors)?,
            children: fields.indices("children", "nodes")?,
            local: local(fields)?,
        })
    }
}

fn local(fields: &Fields<'_>) -> Result<DAffine3> {
    let parts = ["translation", "rotation", "scale"];
    let part = parts.into_iter().find(|part| fields.get(part).is_some());
    match (fields.numbers("matrix", Range::COORDINATE)?, part) {
        (Some(_), Some(part)) => Err(fields
            .error(format!("has both a matrix and a {part}"))
            .remedy("keep one of the two")),
        (Some(matrix), None) => affine(fields, &matrix),
        (None, _) => translation_rotation_scale(fields),
    }
}

/// A matrix, column by column.
fn affine(fields: &Fields<'_>, m: &[f64; 16]) -> Result<DAffine3> {
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
        let error = fields.error_at("matrix", "the last row must be 0, 0, 0, 1");
        return Err(error.remedy("store the matrix by columns, with the translation last"));
    }
    let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
    let matrix3 = DMat3::from_cols(column(0), column(4), column(8));
    Ok(DAffine3 { matrix3, translation: column(12) })
}

fn translation_rotation_scale(fields: &Fields<'_>) -> Result<DAffine3> {
    let vector = |key, default| fields.vector_or(key, Range::COORDINATE, default);
    let translation = vector("translation", DVec3::ZERO)?;
    let scale = vector("scale", DVec3::ONE)?;
    let rotation = fields.numbers("rotation", Range::COORDINATE)?.unwrap_or(UNTURNED);
    transform(translation, rotation, scale).ok_or_else(|| {
        let error = fields.error_at("rotation", "must be a quaternion of length 1");
        error.remedy("use [0, 0, 0, 1] for no rotation")
    })
}

/// A node of the scene with its transform.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedNode {
    /// The index of the node.
    pub(super) node: usize,
    /// The transform from its own space to the world.
    pub(super) world: DAffine3,
}

/// The nodes of the scene, each before its children, in the order of the file.
///
/// # Errors
/// If the nodes do not form a tree.
pub(super) fn placed(top: &Fields<'_>, nodes: &[Node]) -> Result<Vec<PlacedNode>> {
    let parents = parents(top, nodes)?;
    let mut found = Vec::new();
    // Nodes still to visit, the next one last.
    let identity = |node| PlacedNode { node, world: DAffine3::IDENTITY };
    let mut left: Vec<PlacedNode> = roots(top, &parents)?.into_iter().rev().map(identity).collect();
    while let Some(PlacedNode { node, world: parent }) = left.pop() {
        let world = parent * nodes[node].local;
        check_place(top, node, &world)?;
        found.push(PlacedNode { node, world });
        left.extend(nodes[node].children.iter().rev().map(|&node| PlacedNode { node, world }));
    }
    Ok(found)
}

/// The root nodes: those of the default scene, or of the first one, or all nodes without a parent.
fn roots(top: &Fields<'_>, parents: &[Option<usize>]) -> Result<Vec<usize>> {
    let chosen = top.index("scene", "scenes")?;
    let scenes = top.list("scenes", "a scene", |scene| {
        let roots = scene.indices("nodes", "nodes")?;
        check_roots(scene, &roots, parents)?;
        Ok(roots)
    })?;
    let all = || (0..parents.len()).filter(|&node| parents[node].is_none()).collect();
    Ok(scenes.into_iter().nth(chosen.unwrap_or(0)).unwrap_or_else(all))
}

/// Refuses a root that a scene names twice or that is a child of another node: it would be shown
/// twice.
fn check_roots(scene: &Fields<'_>, roots: &[usize], parents: &[Option<usize>]) -> Result<()> {
    let mut sorted = roots.to_vec();
    sorted.sort_unstable();
    let twice = sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
    let held = || roots.iter().copied().find(|&root| parents[root].is_some());
    match twice.or_else(held) {
        None => Ok(()),
        Some(node) => Err(scene
            .error(format!("node {node} must appear once, as a root of the scene"))
            .remedy("list each root once, and no child of another node")),
    }
}

/// The parent of each node.
///
/// # Errors
/// If a node has several, or is its own descendant.
fn parents(top: &Fields<'_>, nodes: &[Node]) -> Result<Vec<Option<usize>>> {
    let mut parents: Vec<Option<usize>> = vec![None; nodes.len()];
    for (number, node) in nodes.iter().enumerate() {
        for (place, &child) in node.children.iter().enumerate() {
            if let Some(other) = parents[child] {
                let message = format!("node {child} is already a child of node {other}");
                return Err(at(top, &format!("nodes[{number}].children[{place}]"), message)
                    .remedy("give each node one parent; a mesh may be used by several nodes"));
            }
            parents[child] = Some(number);
        }
    }
    // Each has one parent at most. Nodes in a circle, or below one, never reach a root.
    let mut is_sound = vec![false; nodes.len()];
    for start in 0..nodes.len() {
        let mut path = Vec::new();
        let mut next = Some(start);
        while let Some(node) = next.filter(|&node| !is_sound[node]) {
            if path.len() == nodes.len() {
                let message = "the node is its own descendant".to_owned();
                return Err(at(top, &format!("nodes[{node}]"), message)
                    .remedy("remove it from the children of its descendants"));
            }
            path.push(node);
            next = parents[node];
        }
        path.into_iter().for_each(|node| is_sound[node] = true);
    }
    Ok(parents)
}

fn at(top: &Fields<'_>, place: &str, message: String) -> Error {
    top.cursor().notes().error(ErrorKind::Scene, place, message)
}

fn check_place(top: &Fields<'_>, node: usize, world: &DAffine3) -> Result<()> {
    if is_place(world) {
        return Ok(());
    }
    let greatest = greatest(world);
    let message = "the combined transform of the node and its parents is too large";
    Err(at(top, &format!("nodes[{node}]"), message.to_owned()).value(format!("{greatest:e}")))
}
