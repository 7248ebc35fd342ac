//! A tile at an instance.

use glam::Vec3;

use super::{RayTile, TILE, TileBatch};
use crate::accel::{Hit, Query, Rays};
use crate::geometry::instance::Instance;
use crate::kernels::Arithmetic;
use crate::math::{Lanes, Ray, set_bits};

impl<S: Lanes, Q: Query, P: Arithmetic> TileBatch<'_, S, Q, P> {
    /// Takes `rays` through the prototype of an instance, as a batch of their own.
    #[inline(never)]
    pub(super) fn visit_instance(&mut self, tile: &mut RayTile, instance: &Instance, rays: u64) {
        let Self { searched, search, .. } = *self;
        let (mut carried, mut numbers) = ([Ray::new(Vec3::ZERO, Vec3::X); TILE], [0; TILE]);
        let mut count = 0;
        for i in set_bits::<TILE>(rays) {
            self.tests.instances += 1;
            if let Some(ray) = searched.carried(instance, &tile.ray(i), &tile.best(i)) {
                (carried[count], numbers[count]) = (ray, i);
                count += 1;
            }
        }
        let mut answers = [Q::answer(Hit::MISS); TILE];
        let prototype = searched.prototype(instance);
        let inside = self.inside.get_or_insert_with(|| Box::new(search.accel.traversal()));
        std::mem::swap(&mut inside.tests, self.tests);
        let (batch, query) = (Rays::Rows(&carried[..count]), &mut Q::default());
        search.all_in_tree(&prototype, batch, &mut answers[..count], query, inside);
        std::mem::swap(&mut inside.tests, self.tests);
        for (&i, &answer) in numbers[..count].iter().zip(&answers) {
            let hit = Q::hit(answer);
            if Q::ANY {
                tile.done |= u64::from(!hit.is_miss()) << i;
                continue;
            }
            let mut best = tile.best(i);
            searched.offer::<P>(instance, hit, (&tile.ray(i), &mut best), self.tests);
            tile.set_best(i, best);
        }
        if Q::NEAREST {
            tile.tighten(self.simd);
        }
    }
}
