//! Transforms of nodes, and of their instances: the extension `EXT_mesh_gpu_instancing`.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use crate::corners::direction;
use crate::mesh::Scalar;
use wavecrest_base::error::Result;
use wavecrest_core::math::float::MAX_COORDINATE;

use super::accessor::{Accessor, Storage};
use super::fields::Fields;

/// The quaternion that turns nothing.
pub(super) const UNTURNED: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// The transform of these parts; `None` if the quaternion has no direction.
pub(super) fn transform(translation: DVec3, rotation: [f64; 4], scale: DVec3) -> Option<DAffine3> {
    let parts = DVec4::from_array(rotation);
    let length = parts.length();
    let is_sound = length > 0.0 && length.is_finite();
    let turned = DMat3::from_quat(is_sound.then(|| DQuat::from_vec4(parts / length))?);
    Some(DAffine3 { matrix3: turned * DMat3::from_diagonal(scale), translation })
}

/// Whether a transform is valid in a scene.
pub(super) fn is_place(world: &DAffine3) -> bool {
    world.is_finite() && greatest(world) <= f64::from(MAX_COORDINATE)
}

pub(super) fn greatest(world: &DAffine3) -> f64 {
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
    translation: Option<usize>,
    rotation: Option<usize>,
    scale: Option<usize>,
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
            let (translation, rotation) = (of("TRANSLATION", 3)?, of("ROTATION", 4)?);
            let scale = of("SCALE", 3)?;
            let counts = || {
                let all = [translation, rotation, scale].into_iter().flatten();
                all.map(|index| accessors[index].count)
            };
            let count = counts().next().unwrap_or(0);
            if counts().any(|other| other != count) {
                let error = attributes.error("all accessors must have as many elements");
                return Err(error.remedy("export the file again"));
            }
            Ok(Self { count, translation, rotation, scale })
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
        let rotation = self.rotation.map_or(UNTURNED, |index| storage.elements(index).get(i));
        let translation = vector(self.translation, DVec3::ZERO);
        let own = transform(translation, rotation, vector(self.scale, DVec3::ONE))?;
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
