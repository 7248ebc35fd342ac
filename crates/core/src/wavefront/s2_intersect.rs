//! Pass 2: the closest hit of every ray.

use super::batch::Batch;
use crate::accel::Traversal;
use crate::kernels::precision::Arithmetic;
use crate::prepared::PreparedScene;

/// Answers every ray of the batch.
pub(super) fn run<P: Arithmetic>(
    scene: &PreparedScene,
    batch: &mut Batch,
    traversal: &mut Traversal,
) {
    let hits = &mut batch.hits.hit[..batch.rays.len()];
    scene.accel.search::<P>().closest_of(&batch.rays, hits, traversal);
}
