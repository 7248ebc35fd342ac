//! Meshes at rest: moved by morph targets, and by the joints of a skin.
//!
//! Morph targets add their values by the weights of the node, or else of the mesh. A vertex of a
//! skin is where its joints put it, by its weights: from the mesh's own space to that of the joint
//! as both were bound (the inverse bind matrix), and from there to the world. The transform of the
//! mesh's own node does not count.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_core::math::float::normalize_f64;

use super::accessor::Storage;
use super::document::Document;
use super::fields::Fields;
use super::mesh::{PrimitiveReader, SIGNED, Types, UNSIGNED, Vertices};
use super::primitive::Primitive;
use crate::mesh::{MeshData, Scalar, origin, relative};

/// An element of `skins`.
pub(super) struct Skin {
    /// The transform of each joint from the mesh's own space to the world; `None` for joints that are
    /// not in the scene.
    joints: Vec<Option<DAffine3>>,
}

impl Skin {
    /// Reads an element of `skins`; `worlds` has the transforms of all nodes of the scene.
    pub(super) fn read(
        fields: &Fields<'_>,
        storage: &Storage,
        worlds: &[Option<DAffine3>],
    ) -> Result<Self> {
        fields.need("joints", "a list of indices into nodes")?;
        let nodes = fields.indices("joints", "nodes")?;
        let matrices = fields.index("inverseBindMatrices", "accessors")?;
        let wrong = |message: String| {
            let error = fields.error_at("inverseBindMatrices", message);
            Err(error.remedy("export the file again"))
        };
        if let Some(accessor) = matrices.map(|index| &storage.accessors[index]) {
            if (accessor.width, accessor.component) != (MATRIX, Scalar::F32) {
                return wrong("must be MAT4 of floats".to_owned());
            }
            if accessor.count < nodes.len() {
                let (there, needed) = (accessor.count, nodes.len());
                return wrong(format!("has {there} matrices for {needed} joints"));
            }
        }
        let mut joints = Vec::new();
        for (i, &node) in nodes.iter().enumerate() {
            let matrix: Option<[f64; MATRIX]> =
                matrices.map(|index| storage.elements(index).get(i));
            let bound = matrix.as_ref().map_or(DAffine3::IDENTITY, affine);
            if !bound.is_finite() {
                return wrong(format!("matrix {i} is not finite"));
            }
            joints.push(worlds[node].map(|world| world * bound));
        }
        Ok(Self { joints })
    }
}

/// The numbers of a matrix of four rows and columns.
const MATRIX: usize = 16;

/// A matrix by columns; its last row is always 0, 0, 0, 1.
fn affine(m: &[f64; MATRIX]) -> DAffine3 {
    let [x, y, z, translation] =
        [0, 4, 8, 12].map(|first| DVec3::new(m[first], m[first + 1], m[first + 2]));
    DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation }
}

/// What moves the vertices of a mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct Pose {
    /// The weights of the mesh's targets; none if all are 0.
    weights: Vec<f64>,
    skin: Option<usize>,
}

impl Pose {
    /// The pose of a node with a mesh.
    pub(super) fn of(document: &Document, node: usize, mesh: usize) -> Self {
        let node = &document.nodes[node];
        let weights = node.weights.as_ref().unwrap_or(&document.meshes[mesh].weights);
        let moves = weights.iter().any(|&weight| weight != 0.0);
        Self { weights: if moves { weights.clone() } else { Vec::new() }, skin: node.skin }
    }

    /// Meshes in poses of one key are equal.
    pub(super) fn key(&self) -> (Option<usize>, Vec<u64>) {
        (self.skin, self.weights.iter().map(|weight| weight.to_bits()).collect())
    }
}

/// Four joints of each vertex with their weights, of which a mesh may have several sets.
struct Influences {
    joints: Vec<[u16; 4]>,
    weights: Vec<[f32; 4]>,
}

/// The types of a joint's number.
const JOINTS: &Types = &[(Scalar::U8, false), (Scalar::U16, false)];

impl PrimitiveReader<'_> {
    /// Moves the vertices of a mesh.
    pub(super) fn posed(
        &mut self,
        vertices: &Vertices<'_>,
        pose: &Pose,
        mesh: &mut MeshData,
    ) -> Result<()> {
        if pose.weights.is_empty() && pose.skin.is_none() {
            return Ok(());
        }
        if !pose.weights.is_empty() {
            self.check_targets(vertices.of, &pose.weights)?;
            self.morph(vertices, "POSITION", &pose.weights, &mut mesh.positions)?;
            if let Some(normals) = &mut mesh.normals {
                self.morph(vertices, "NORMAL", &pose.weights, &mut normals.values)?;
                normals.values.iter_mut().filter(|n| !n.is_finite()).for_each(|n| *n = Vec3::ZERO);
            }
        }
        if let Some(skin) = pose.skin {
            self.skin(vertices, &self.document.skins[skin], mesh)?;
        }
        self.check_positions(vertices, &mesh.positions)
    }

    fn check_targets(&self, of: &Primitive, weights: &[f64]) -> Result<()> {
        let (there, needed) = (of.targets.len(), weights.len());
        if there == needed {
            return Ok(());
        }
        let message = "must be as many as the weights of the mesh or node";
        let error = self.error(&format!("{}.targets", of.path), message).value(there);
        Err(error.remedy(format!("there are {needed} weights; export the file again")))
    }

    /// Adds the values of the targets by their `weights`.
    fn morph(
        &mut self,
        vertices: &Vertices<'_>,
        name: &str,
        weights: &[f64],
        values: &mut [Vec3],
    ) -> Result<()> {
        let mut sums: Vec<DVec3> = values.iter().map(|value| value.as_dvec3()).collect();
        for (i, (target, &weight)) in vertices.of.targets.iter().zip(weights).enumerate() {
            let Some(&accessor) = target.get(name).filter(|_| weight != 0.0) else { continue };
            let place = format!("{}.targets[{i}].{name}", vertices.of.path);
            let (types, vector) = ((3, &SIGNED[..1]), |v| DVec3::from_array(v).as_vec3());
            let more = self.elements(vertices, accessor, &place, types, vector)?;
            parallel::each_mut(&mut sums, |k, sum| *sum += more[k].as_dvec3() * weight);
        }
        parallel::each_mut(values, |k, value| *value = sums[k].as_vec3());
        Ok(())
    }

    /// Moves a mesh to where its joints put it in the world.
    fn skin(&mut self, vertices: &Vertices<'_>, skin: &Skin, mesh: &mut MeshData) -> Result<()> {
        let mut sets = Vec::new();
        while let Some(set) = self.influences(vertices, sets.len())? {
            sets.push(set);
        }
        for (number, set) in sets.iter().enumerate() {
            self.check_influences(vertices, number, set, skin)?;
        }
        let blended = |i: usize| blended(&sets, skin, i);
        // A triangle that is mirrored keeps its front.
        parallel::each_mut(&mut mesh.triangles, |_, triangle| {
            if blended(triangle[0] as usize).matrix3.determinant() < 0.0 {
                triangle.swap(1, 2);
            }
        });
        if let Some(normals) = &mut mesh.normals {
            parallel::each_mut(&mut normals.values, |i, normal| {
                *normal = turned(&blended(i).matrix3, *normal);
            });
        }
        let moved = |i: usize, p: Vec3| blended(i).transform_point3(p.as_dvec3());
        mesh.origin = mesh.positions.first().map_or(DVec3::ZERO, |&first| origin(moved(0, first)));
        let origin = mesh.origin;
        parallel::each_mut(&mut mesh.positions, |i, p| *p = relative(moved(i, *p), origin));
        Ok(())
    }

    /// A set of joints and weights; `None` after the last.
    fn influences(&mut self, vertices: &Vertices<'_>, set: usize) -> Result<Option<Influences>> {
        let [joints, weights] = ["JOINTS", "WEIGHTS"].map(|name| format!("{name}_{set}"));
        let has = |name: &String| vertices.of.attributes.contains_key(name);
        if set > 0 && !has(&joints) && !has(&weights) {
            return Ok(None);
        }
        if let Some(missing) = [&joints, &weights].into_iter().find(|name| !has(name)) {
            let place = format!("{}.attributes.{missing}", vertices.of.path);
            let error = self.error(&place, "is missing, but the mesh has a skin");
            return Err(error.remedy("export the file again, or remove the skin of its node"));
        }
        let whole = |joints: [f64; 4]| joints.map(|joint| joint as u16);
        let single = |weights: [f64; 4]| weights.map(|weight| weight as f32);
        let joints = self.attribute(vertices, &joints, (4, JOINTS), whole)?;
        let weights = self.attribute(vertices, &weights, (4, UNSIGNED), single)?;
        Ok(joints.zip(weights).map(|(joints, weights)| Influences { joints, weights }))
    }

    /// Checks all joints that have a weight.
    fn check_influences(
        &self,
        vertices: &Vertices<'_>,
        set: usize,
        Influences { joints, weights }: &Influences,
        skin: &Skin,
    ) -> Result<()> {
        let place = |name: &str, i: usize| {
            format!("{}.attributes.{name}_{set}[{}]", vertices.of.path, vertices.number(i))
        };
        for (i, (joints, weights)) in joints.iter().zip(weights).enumerate() {
            if let Some(bad) = weights.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
                let error = self.error(&place("WEIGHTS", i), "must be finite, and not negative");
                return Err(error.value(bad).remedy("export the file again"));
            }
            let used = joints.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
            for (&joint, _) in used {
                let (message, remedy) = match skin.joints.get(usize::from(joint)) {
                    Some(Some(_)) => continue,
                    Some(None) => (
                        "the joint is not in the scene",
                        "list it, or a parent of it, in the nodes of the scene".to_owned(),
                    ),
                    None => {
                        let there = skin.joints.len();
                        ("there is no such joint", format!("the skin has {there}, counted from 0"))
                    }
                };
                return Err(self.error(&place("JOINTS", i), message).value(joint).remedy(remedy));
            }
        }
        Ok(())
    }
}

/// The mean of the transforms of a vertex's joints by its weights; that of the first joint if all are 0.
fn blended(sets: &[Influences], skin: &Skin, vertex: usize) -> DAffine3 {
    let (mut matrix3, mut translation, mut total) = (DMat3::ZERO, DVec3::ZERO, 0.0);
    for set in sets {
        for (&joint, &weight) in set.joints[vertex].iter().zip(&set.weights[vertex]) {
            let Some(Some(own)) = skin.joints.get(usize::from(joint)) else { continue };
            let weight = f64::from(weight);
            matrix3 += own.matrix3 * weight;
            translation += own.translation * weight;
            total += weight;
        }
    }
    if total == 0.0 {
        let first =
            sets.first().and_then(|set| skin.joints.get(usize::from(set.joints[vertex][0])));
        return first.copied().flatten().unwrap_or(DAffine3::IDENTITY);
    }
    DAffine3 { matrix3: matrix3 * (1.0 / total), translation: translation / total }
}

/// A normal, turned by the cofactors of a matrix: its inverse transpose without its division, but for
/// the sign.
fn turned(m: &DMat3, normal: Vec3) -> Vec3 {
    let cofactors = DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    );
    let sign = m.determinant().signum();
    normalize_f64(cofactors * normal.as_dvec3() * sign).as_vec3()
}
