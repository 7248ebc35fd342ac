//! Tests spheres and disks against the rays of a tile, eight rays at a time.

use fearless_simd::f32x8;

use super::{GROUPS, RayTile, TILE, TileColumn, WIDTH};
use crate::accel::{Best, Query, Ref, Searched};
use crate::counters::TestCounts;
use crate::geometry::Quadric;
use crate::kernels::Arithmetic;
use crate::math::{LANES, Lanes, Line, Mask, Real, Single, Vector};

impl RayTile {
    /// Tests the quadric of an entry in a list against some `rays`, a bit each.
    #[inline(always)]
    pub(super) fn meet_quadric<S: Lanes, Q: Query, P: Arithmetic>(
        &mut self,
        simd: S,
        searched: Searched<'_>,
        quadric: &Quadric,
        (place, entry): (Ref, usize),
        rays: u64,
        tests: &mut TestCounts,
    ) {
        quadric.count(tests, rays.count_ones());
        let certain = Q::ANY && searched.geometry.cutouts.is_empty();
        for first in (0..TILE).step_by(LANES) {
            let used = (rays >> first) as u32 & 0xFF;
            if used == 0 {
                continue;
            }
            let (g, l) = (first / WIDTH % GROUPS, first % WIDTH);
            let load =
                |column: &TileColumn| <f32x8<S> as Single>::from_slice(simd, &column[g][l..]);
            let vector = |[x, y, z]: &[TileColumn; 3]| Vector::new(load(x), load(y), load(z));
            let line = Line { origin: vector(&self.origin), direction: vector(&self.direction) };
            let range = [load(&self.t_min), load(&self.t_max)];
            let (t, is_hit) = quadric.meet::<_, P>(&line, range);
            let mut hits = is_hit.bits() & used;
            if certain {
                self.done |= u64::from(hits) << first;
                continue;
            }
            hits &= t.le(load(&self.high)).bits();
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize % LANES;
                hits &= hits - 1;
                let hit = Best::in_leaf(place, entry, [t.lane(lane); 2]);
                self.offer::<Q, P>(searched, first + lane, hit, tests);
            }
        }
    }
}
