//! Pass 2: the closest hit of every ray.

use super::Wavefront;
use crate::kernels::Arithmetic;
use crate::prepared::PreparedScene;

impl<P: Arithmetic> Wavefront<P> {
    /// Finds the closest hit of every ray of the batch.
    pub(super) fn intersect(&mut self, scene: &PreparedScene) {
        let Self { batch, traversal, .. } = self;
        let mut hits = std::mem::take(&mut batch.hits);
        let answers = &mut hits[..batch.rays.len()];
        let rays = batch.rays.all(batch.carried.starts(), f32::INFINITY);
        scene.accel.search::<P>().closest_of(rays, answers, traversal);
        for (answer, state) in answers.iter_mut().zip(batch.carried.states()) {
            if !state.next.is_miss() {
                *answer = state.next;
            }
        }
        batch.hits = hits;
    }
}
