//! Pass 2: the closest hit of every ray.

use super::batch::Batch;
use crate::accel::Traversal;
use crate::prepared::PreparedScene;

/// Answers every ray of the batch.
pub(super) fn run(scene: &PreparedScene, batch: &mut Batch, traversal: &mut Traversal) {
    batch.hits.clear();
    for i in 0..batch.rays.len() {
        let hit = scene.accel.closest(&batch.rays.get(i), traversal);
        batch.hits.t.push(hit.t);
        batch.hits.primitive.push(hit.primitive);
    }
}
