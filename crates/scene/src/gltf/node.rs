//! Nodes: the tree that places meshes, cameras and lights; and the instances of a node: the extension
//! `EXT_mesh_gpu_instancing`.
//!
//! The format requires a tree; invalid files may contain circles, which are refused, or name a node
//! twice. Walks keep their own list, so that no depth of a file overflows the stack.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use crate::corners::direction;
use crate::format::Range;
use crate::mesh::Scalar;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::math::float::MAX_COORDINATE;

use super::accessor::{Accessor, Storage};
use super::fields::{Fields, LIGHTS};

#[derive(Clone, Debug, Default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) mesh: Option<usize>,
    /// What moves the vertices of its mesh.
    pub(super) skin: Option<usize>,
    /// The weights of its mesh's morph targets, in place of the mesh's.
    pub(super) weights: Option<Vec<f64>>,
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
            skin: fields.index("skin", "skins")?,
            weights: fields.weights()?,
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

/// The nodes of the scene, each before its children, in the order of the file. A node that is named
/// twice is shown once: below the first of its parents, if it has any in the scene.
///
/// # Errors
/// If a node is its own descendant.
pub(super) fn placed(top: &Fields<'_>, nodes: &[Node]) -> Result<Vec<PlacedNode>> {
    check_circles(top, nodes)?;
    let note = |node: usize, message, remedy| {
        top.cursor.notes().note(&format!("nodes[{node}]"), message, remedy);
    };
    let mut found = Vec::new();
    let mut is_found = vec![false; nodes.len()];
    for (root, is_child) in roots(top, nodes)? {
        if is_child && !is_found[root] {
            let message = "the parent of a root is not in the scene";
            note(root, message, "list the parent, or the node's transform is all that it gets");
        }
        // Nodes still to visit, the next one last.
        let mut left = vec![PlacedNode { node: root, world: DAffine3::IDENTITY }];
        while let Some(PlacedNode { node, world: parent }) = left.pop() {
            if std::mem::replace(&mut is_found[node], true) {
                let message = "a node that is named twice is shown once";
                note(node, message, "name it as a root of the scene or as a child, once");
                continue;
            }
            let world = parent * nodes[node].local;
            if !is_place(&world) {
                let message = "the combined transform of the node and its parents is too large";
                return Err(at(top, node, message).value(format!("{:e}", greatest(&world))));
            }
            found.push(PlacedNode { node, world });
            left.extend(nodes[node].children.iter().rev().map(|&node| PlacedNode { node, world }));
        }
    }
    Ok(found)
}

/// The root nodes: those of the default scene, or of the first one, or all nodes without a parent. Those
/// that are children of others come last, and are marked.
fn roots(top: &Fields<'_>, nodes: &[Node]) -> Result<Vec<(usize, bool)>> {
    let chosen = top.index("scene", "scenes")?;
    let scenes = top.list("scenes", "a scene", |scene| scene.indices("nodes", "nodes"))?;
    let mut is_child = vec![false; nodes.len()];
    nodes.iter().flat_map(|node| &node.children).for_each(|&child| is_child[child] = true);
    let all = || (0..nodes.len()).filter(|&node| !is_child[node]).collect();
    let roots: Vec<usize> = scenes.into_iter().nth(chosen.unwrap_or(0)).unwrap_or_else(all);
    let mut roots: Vec<_> = roots.into_iter().map(|root| (root, is_child[root])).collect();
    roots.sort_by_key(|&(_, is_child)| is_child);
    Ok(roots)
}

/// Refuses a node that is its own descendant.
fn check_circles(top: &Fields<'_>, nodes: &[Node]) -> Result<()> {
    // Whether all below a node is known to be sound; some of it is not, while it is visited.
    let mut is_sound = vec![None; nodes.len()];
    // Nodes to enter, and to leave, the next one last.
    let mut left: Vec<(usize, bool)> = (0..nodes.len()).rev().map(|node| (node, true)).collect();
    while let Some((node, enters)) = left.pop() {
        match (enters, is_sound[node]) {
            (false, _) => is_sound[node] = Some(true),
            (true, Some(true)) => {}
            (true, Some(false)) => {
                let error = at(top, node, "the node is its own descendant");
                return Err(error.remedy("remove it from the children of its descendants"));
            }
            (true, None) => {
                is_sound[node] = Some(false);
                left.push((node, false));
                left.extend(nodes[node].children.iter().map(|&child| (child, true)));
            }
        }
    }
    Ok(())
}

fn at(top: &Fields<'_>, node: usize, message: &str) -> Error {
    top.cursor.notes().error(ErrorKind::Scene, &format!("nodes[{node}]"), message)
}

/// The quaternion that turns nothing.
const UNTURNED: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// The transform of these parts; `None` if the quaternion has no direction.
fn transform(translation: DVec3, rotation: [f64; 4], scale: DVec3) -> Option<DAffine3> {
    let parts = DVec4::from_array(rotation);
    let length = parts.length();
    let is_sound = length > 0.0 && length.is_finite();
    let turned = DMat3::from_quat(is_sound.then(|| DQuat::from_vec4(parts / length))?);
    Some(DAffine3 { matrix3: turned * DMat3::from_diagonal(scale), translation })
}

/// Whether a transform is valid in a scene.
fn is_place(world: &DAffine3) -> bool {
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

/// The accessors of the instances' attributes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instancing {
    pub(super) count: usize,
    translation_rotation_scale: [Option<usize>; 3],
}

impl Instancing {
    /// Reads the extension of a node, if it has it and the file's `accessors` are right.
    pub(super) fn read(
        fields: &Fields<'_>,
        accessors: Option<&[Accessor]>,
    ) -> Result<Option<Self>> {
        let Some(accessors) = accessors else { return Ok(None) };
        let found = fields.extension("EXT_mesh_gpu_instancing", |found| {
            let attributes = found.need_object("attributes", "attributes")?;
            let of = |key: &str, width: usize| accessor(&attributes, key, width, accessors);
            let parts = [of("TRANSLATION", 3)?, of("ROTATION", 4)?, of("SCALE", 3)?];
            let mut counts = parts.into_iter().flatten().map(|index| accessors[index].count);
            let count = counts.next().unwrap_or(0);
            if counts.any(|other| other != count) {
                let error = attributes.error("all accessors must have as many elements");
                return Err(error.remedy("export the file again"));
            }
            Ok(Self { count, translation_rotation_scale: parts })
        })?;
        Ok(found.filter(|found| found.count > 0))
    }

    /// The transform of instance `i` of a node at `world`; `None` if it is not a valid one.
    pub(super) fn transform(
        &self,
        storage: &Storage,
        world: &DAffine3,
        i: usize,
    ) -> Option<DAffine3> {
        let vector = |index: Option<usize>, absent: DVec3| {
            index.map_or(absent, |index| DVec3::from_array(storage.elements(index).get(i)))
        };
        let [translation, rotation, scale] = self.translation_rotation_scale;
        let rotation = rotation.map_or(UNTURNED, |index| storage.elements(index).get(i));
        let translation = vector(translation, DVec3::ZERO);
        let own = transform(translation, rotation, vector(scale, DVec3::ONE))?;
        Some(*world * own).filter(is_place)
    }
}

/// The accessor of an attribute with this number of components.
fn accessor(
    attributes: &Fields<'_>,
    key: &str,
    width: usize,
    accessors: &[Accessor],
) -> Result<Option<usize>> {
    let Some(index) = attributes.index(key, "accessors")? else { return Ok(None) };
    let found = &accessors[index];
    let is_right =
        found.width == width && (found.component == Scalar::F32 || found.normalized && width == 4);
    if is_right {
        return Ok(Some(index));
    }
    let error = attributes.error_at(key, format!("must be VEC{width} of floats"));
    Err(error.remedy("export the file again"))
}
