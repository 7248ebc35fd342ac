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
    let mut hits = std::mem::take(&mut batch.hits.hit);
    let answers = &mut hits[..batch.rays.len()];
    scene.accel.search::<P>().closest_of(batch.all_rays(), answers, traversal);
    for (answer, state) in answers.iter_mut().zip(&batch.states) {
        if !state.next.is_miss() {
            *answer = state.next;
        }
    }
    batch.hits.hit = hits;
}
