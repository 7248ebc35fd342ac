//! The colours of a look, sample by sample.

use super::Look;
use crate::aov::Seen;
use crate::camera_rays::Gather;
use crate::colormap::distinct;
use wavecrest_core::accel::Hit;
use wavecrest_core::kernels::precision::Arithmetic;
use wavecrest_core::math::float::dot;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::PreparedScene;

/// Colours each sample.
pub(super) struct Paint<'a> {
    pub(super) scene: &'a PreparedScene,
    pub(super) look: Look,
}

/// The sums of a pixel's samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Painted {
    /// Number of samples that hit something.
    pub(super) hits: u32,
    pub(super) color: [f64; 3],
    depth: f64,
}

impl Painted {
    /// The mean over samples that hit something; `None` if none does.
    pub(super) fn mean_depth(&self) -> Option<f64> {
        (self.hits > 0).then(|| self.depth / f64::from(self.hits))
    }
}

impl Gather for Paint<'_> {
    type Sums = Painted;

    fn add<P: Arithmetic>(&self, ray: &Ray, hit: &Hit, _: bool, sums: &mut Painted) {
        let Some(seen) = Seen::of::<P>(self.scene, ray, hit) else { return };
        let [_, _, forward] = self.scene.camera.basis();
        sums.hits += 1;
        sums.depth += f64::from(hit.t) * f64::from(dot(ray.direction, forward));
        let color = match self.look {
            Look::Normals => seen.normal.to_array().map(|value| 0.5 + 0.5 * value),
            Look::Uv => seen.albedo.to_array(),
            Look::Ids => distinct(self.number(hit)),
            Look::Clay | Look::Depth | Look::Wireframe => [0.0; 3],
        };
        sums.color.iter_mut().zip(color).for_each(|(sum, value)| *sum += f64::from(value));
    }
}

impl Paint<'_> {
    /// The number of the object that was hit, or of the triangle if there is only one object.
    fn number(&self, hit: &Hit) -> u32 {
        let appearance = &self.scene.appearance;
        match appearance.shapes.len() {
            0 | 1 => hit.primitive,
            _ => appearance.shape_of(hit.primitive) as u32,
        }
    }
}
