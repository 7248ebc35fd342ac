//! Locates samples that were not finite.
//!
//! A render only counts them. To find their pixels, the recursive tracer renders the pixels once
//! more, with the same results as the wavefront: only if the count is not 0, and only until that
//! many are found.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::Request;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::TracerKind;
use wavecrest_core::render::work::tracer;
use wavecrest_core::tile::{Tile, TraceSettings, Unit};

/// Sets the `mask` to 1 at the pixels of `window` with such samples.
pub(super) fn mark(scene: &PreparedScene, window: &Tile, request: &Request<'_>, mask: &mut [f32]) {
    let left = AtomicU64::new(request.invalid);
    // One path at a time: the recursive tracer ignores the batch.
    let settings = TraceSettings { seed: request.seed, batch: 1, time_passes: false };
    let rows = mask.par_chunks_mut(window.width as usize).enumerate();
    rows.for_each(|(row, mask)| {
        let mut tracer = tracer(scene, TracerKind::Recursive, &settings);
        for (column, marked) in mask.iter_mut().enumerate() {
            if left.load(Ordering::Relaxed) == 0 {
                return;
            }
            let (x, y) = (window.x + column as u32, window.y + row as u32);
            let pixel = Unit::whole(scene, Tile { x, y, width: 1, height: 1 });
            let before = tracer.counters().invalid;
            tracer.render(scene, &pixel, &mut [[0.0; 3]]);
            let found = tracer.counters().invalid - before;
            if found > 0 {
                *marked = 1.0;
                left.fetch_sub(found, Ordering::Relaxed);
            }
        }
    });
}
