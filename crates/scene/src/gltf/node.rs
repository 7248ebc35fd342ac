//! Nodes: the tree that places meshes, cameras and lights.
//!
//! The format requires a tree; invalid files may contain loops, or a node with two parents. Both
//! are refused before the tree is walked. The walk keeps its own list, so that no depth of a file
//! overflows the stack.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use crate::corners::direction;
use crate::format::Range;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::math::float::MAX_COORDINATE;

use super::accessor::Accessor;
use super::fields::Fields;
use super::instancing::Instancing;

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

/// The lengths of the lists that a node has indices into.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lengths {
    pub(super) nodes: usize,
    pub(super) meshes: usize,
    pub(super) cameras: usize,
    pub(super) lights: usize,
}

impl Node {
    /// Reads an element of `nodes`.
    pub(super) fn read(
        fields: &Fields<'_>,
        lengths: Lengths,
        accessors: Option<&[Accessor]>,
    ) -> Result<Self> {
        let light = fields.extension("KHR_lights_punctual", |found| {
            found.need_index("light", "lights", lengths.lights)
        });
        Ok(Self {
            name: fields.text("name")?.filter(|name| !name.is_empty()),
            mesh: fields.index("mesh", "meshes", lengths.meshes)?,
            camera: fields.index("camera", "cameras", lengths.cameras)?,
            light: light?,
            instancing: Instancing::read(fields, accessors)?,
            children: fields.indices("children", "nodes", lengths.nodes)?,
            local: local(fields)?,
        })
    }
}

fn local(fields: &Fields<'_>) -> Result<DAffine3> {
    let parts = ["translation", "rotation", "scale"];
    let part = parts.into_iter().find(|part| fields.get(part).is_some());
    let matrix = fields.numbers::<16>("matrix", Range::COORDINATE)?;
    match (matrix, part) {
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
        let cursor = fields.need("matrix", "16 numbers")?;
        let error = cursor.error("the last row must be 0, 0, 0, 1");
        return Err(error.remedy("store the matrix by columns, with the translation last"));
    }
    let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
    let matrix3 = DMat3::from_cols(column(0), column(4), column(8));
    Ok(DAffine3 { matrix3, translation: column(12) })
}

fn translation_rotation_scale(fields: &Fields<'_>) -> Result<DAffine3> {
    let vector = |key: &str| fields.numbers::<3>(key, Range::COORDINATE);
    let translation = vector("translation")?.map_or(DVec3::ZERO, DVec3::from_array);
    let scale = vector("scale")?.map_or(DVec3::ONE, DVec3::from_array);
    let rotation = match fields.numbers::<4>("rotation", Range::COORDINATE)? {
        None => DMat3::IDENTITY,
        Some(parts) => {
            let parts = DVec4::from_array(parts);
            let length = parts.length();
            if !(length > 0.0 && length.is_finite()) {
                let cursor = fields.need("rotation", "a quaternion")?;
                let error = cursor.error("must be a quaternion of length 1");
                return Err(error.remedy("use [0, 0, 0, 1] for no rotation"));
            }
            DMat3::from_quat(DQuat::from_vec4(parts / length))
        }
    };
    Ok(DAffine3 { matrix3: rotation * DMat3::from_diagonal(scale), translation })
}

/// A node of the scene with its transform.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// The index of the node.
    pub(super) node: usize,
    /// The transform from its own space to the world.
    pub(super) world: DAffine3,
}

/// The nodes of the scene, each before its children, in the order of the file.
///
/// # Errors
/// If the nodes do not form a tree.
pub(super) fn placed(top: &Fields<'_>, nodes: &[Node]) -> Result<Vec<Placed>> {
    check_tree(top, nodes)?;
    let mut found = Vec::new();
    // Nodes still to visit, the next one last.
    let identity = |node| Placed { node, world: DAffine3::IDENTITY };
    let mut left: Vec<Placed> = roots(top, nodes)?.into_iter().rev().map(identity).collect();
    while let Some(Placed { node, world: parent }) = left.pop() {
        let world = parent * nodes[node].local;
        check_place(top, node, &world)?;
        found.push(Placed { node, world });
        left.extend(nodes[node].children.iter().rev().map(|&node| Placed { node, world }));
    }
    Ok(found)
}

/// The root nodes: those of the default scene, or of the first one, or all nodes without a parent.
fn roots(top: &Fields<'_>, nodes: &[Node]) -> Result<Vec<usize>> {
    let count = top.length("scenes");
    let chosen = top.index("scene", "scenes", count)?;
    let scenes = top.list("scenes", "a scene", |scene| {
        let roots = scene.indices("nodes", "nodes", nodes.len())?;
        check_roots(scene, &roots, nodes)?;
        Ok(roots)
    })?;
    if let Some(roots) = scenes.into_iter().nth(chosen.unwrap_or(0)) {
        return Ok(roots);
    }
    let parents = parents(nodes);
    Ok((0..nodes.len()).filter(|&node| parents[node].is_none()).collect())
}

/// Refuses a root that a scene names twice or that is a child of another node: it would be shown
/// twice.
fn check_roots(scene: &Fields<'_>, roots: &[usize], nodes: &[Node]) -> Result<()> {
    let mut sorted = roots.to_vec();
    sorted.sort_unstable();
    let parents = parents(nodes);
    let twice = sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
    let held = || roots.iter().copied().find(|&root| parents[root].is_some());
    match twice.or_else(held) {
        None => Ok(()),
        Some(node) => Err(scene
            .error(format!("node {node} must appear once, as a root of the scene"))
            .remedy("list each root once, and no child of another node")),
    }
}

/// The parent of each node, the last one if there are several.
fn parents(nodes: &[Node]) -> Vec<Option<usize>> {
    let mut parents = vec![None; nodes.len()];
    for (number, node) in nodes.iter().enumerate() {
        node.children.iter().for_each(|&child| parents[child] = Some(number));
    }
    parents
}

fn check_tree(top: &Fields<'_>, nodes: &[Node]) -> Result<()> {
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
    Ok(())
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

/// Whether a transform is valid in a scene.
pub(super) fn is_place(world: &DAffine3) -> bool {
    world.is_finite() && greatest(world) <= f64::from(MAX_COORDINATE)
}

fn greatest(world: &DAffine3) -> f64 {
    world.to_cols_array().iter().fold(0.0_f64, |a, x| a.max(x.abs()))
}

/// Whether a transform flattens everything.
pub(super) fn flattens(world: &DAffine3) -> bool {
    let m = world.matrix3;
    match [m.x_axis, m.y_axis, m.z_axis].map(direction) {
        // As in scene files: each of the six products of the determinant is rounded five times, and
        // none is larger than 1.
        [Some(x), Some(y), Some(z)] => x.dot(y.cross(z)).abs() <= 4.0 * f64::EPSILON * 6.0,
        _ => true,
    }
}
