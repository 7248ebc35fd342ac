//! Hits on transparent surfaces, where paths scatter.

use super::{Shade, Shaded};
use crate::geometry::ShadingKind;
use crate::kernels::{Arithmetic, Transparency};
use crate::math::{LANES, Single, set_bits};
use crate::prepared::{Group, Meeting, SampleCounts, Scattered};

impl<P: Arithmetic> Shade<'_, P> {
    /// Shades hits on transparent surfaces of one kind, where paths scatter.
    #[inline(always)]
    pub(super) fn scatter<F: Single>(
        &mut self,
        token: F::Token,
        (group, kind): (&Group<F>, ShadingKind),
        transparency: &Transparency,
    ) {
        let shaded = self.shaded(token, group, kind);
        let Shaded { line, numbers, throughput, point, .. } = &shaded;
        let hits = &numbers.map(|ray| self.tracer.batch.hits[ray as usize]);
        let states = &numbers.map(|ray| self.state(ray as usize));
        let (throughput, used) = (*throughput, group.used);
        let meeting = Meeting { line, used, hits, states, throughput, point };
        let mut scattered =
            meeting.scatter::<P>(self.scene, transparency, &mut self.tracer.traversal);
        if self.differentials {
            let mut look_ups = SampleCounts::default();
            let footprint = |lane: usize| self.footprint(numbers[lane] as usize);
            let hits = (kind, line, shaded.t);
            scattered.turn(group, hits, self.scene, &footprint, (point, &mut look_ups));
            self.tracer.counters.samples += look_ups;
        }
        self.send(token, &scattered, (used, &shaded.path));
        self.add_light(&shaded, scattered.own);
    }

    /// Sends the rays of paths on: of those of a path that are not faint the first is its next one, and the others wait.
    #[inline(always)]
    fn send<F: Single>(
        &mut self,
        token: F::Token,
        scattered: &Scattered<F>,
        (mut free, path): (u32, &[u32; LANES]),
    ) {
        let batch = &mut self.tracer.batch;
        let mut waiting = [0; 3];
        for (rays, waiting) in scattered.rays.iter().zip(&mut waiting) {
            let asked = if self.sees { rays.straight() } else { rays.asked };
            let next = asked & !rays.faint & free;
            free &= !next;
            *waiting = asked & !next;
            if next != 0 {
                batch.push_scattered(token, rays, next, path);
            }
        }
        for (rays, &waiting) in scattered.rays.iter().zip(&waiting).rev() {
            for lane in set_bits::<LANES>(waiting) {
                batch.waiting.push(path[lane], rays.branch(lane));
            }
        }
    }
}
