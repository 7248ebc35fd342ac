//! Pass 3: what every hit shows at once, and what it asks for.

use super::batch::Batch;
use crate::accel::Rays;
use crate::counters::Counters;
use crate::kernels::shade;
use crate::prepared::{Arrival, PreparedScene};

/// Adds background, emitted and ambient light to the paths; collects points that lights reach and,
/// while bounces are left, mirror rays.
pub(super) fn run(scene: &PreparedScene, bounce: u32, batch: &mut Batch, counters: &mut Counters) {
    let shadows = scene.plan.has_shadows();
    batch.lit.clear();
    for i in 0..batch.rays.len() {
        let ray = batch.rays.ray(i);
        let hit = batch.hits.hit[i];
        let throughput = batch.rays.throughput.get(i);
        let path = batch.rays.path[i];
        let radiance = &mut batch.paths.radiance;
        let point = match scene.arrival(&ray, &hit, &mut counters.texels) {
            Arrival::Surface(point) => point,
            Arrival::Light(color) => {
                radiance.add(path as usize, throughput * color);
                continue;
            }
            Arrival::Nothing => {
                if bounce == 0 {
                    radiance.add(path as usize, scene.background);
                }
                continue;
            }
        };
        let local = shade::local_light(&point, scene.ambient);
        radiance.add(path as usize, throughput * local);
        if shadows && point.lit {
            batch.lit.push(&point, throughput, path);
        }
        if bounce < scene.bounces
            && let Some((next, weight)) = shade::mirror(&point, throughput)
        {
            counters.secondary_rays += 1;
            batch.next.push(&next, weight, path);
        }
    }
}
