//! The closest hit as it is defined, in rational numbers: of the closed triangles that a ray meets
//! within its range, the one with the least t; of equal t the lowest number.

use glam::{DVec3, Vec3};
use wavecrest_core::accel::Hit;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::quad::halves;
use wavecrest_core::math::ray::Ray;

use crate::exact::{Exact, meeting, rounded_once};

/// A triangle or half of a quad: the number of its primitive, and its corners.
type Numbered = (u32, [Vec3; 3]);

/// The triangles and halves of quads of a geometry; `None` if there is anything else in it.
pub(crate) fn triangles(geometry: &Geometry) -> Option<Vec<Numbered>> {
    let count = geometry.triangles.len();
    let triangles = (0..).zip((0..count).map(|i| geometry.triangle(i)));
    let quads = (count as u32..).zip((0..geometry.quads.len()).map(|i| halves(&geometry.quad(i))));
    let quads = quads.flat_map(|(number, halves)| halves.map(|half| (number, half)));
    let has_others = geometry.len() != count + geometry.quads.len() || !geometry.cutouts.is_empty();
    (!has_others).then(|| triangles.chain(quads).collect())
}

/// A bound of the error of a sum of three products of three numbers in double precision, relative to
/// the sum of their absolute values; far larger than what roundings add up to.
const DOUBTFUL: f64 = 1e-14;

/// The least t at which a ray may meet a triangle, in double precision; `None` if it surely misses.
fn nearest(ray: &Ray, corners: &[Vec3; 3]) -> Option<f64> {
    let direction = ray.direction.as_dvec3();
    let [a, b, c] = corners.map(|corner| corner.as_dvec3() - ray.origin.as_dvec3());
    let volume = |p: DVec3, q: DVec3, r: DVec3| {
        let [p, q, r] = [p, q, r].map(DVec3::abs);
        let products = p.x * (q.y * r.z + q.z * r.y)
            + p.y * (q.z * r.x + q.x * r.z)
            + p.z * (q.x * r.y + q.y * r.x);
        products * DOUBTFUL
    };
    let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| {
        let (side, error) = (direction.dot(p.cross(q)), volume(direction, p, q));
        [side - error, side + error]
    });
    if sides.iter().any(|side| side[0] > 0.0) && sides.iter().any(|side| side[1] < 0.0) {
        return None;
    }
    let whole: f64 = sides.iter().map(|[low, high]| 0.5 * (low + high)).sum();
    let doubt: f64 = sides.iter().map(|[low, high]| high - low).sum();
    let (height, off) = (a.dot(b.cross(c)), volume(a, b, c));
    let t = height / whole;
    let error = (off + t.abs() * doubt) / (whole.abs() - doubt);
    Some(if whole.abs() > 2.0 * doubt { t - error - t.abs() * 1e-6 } else { f64::NEG_INFINITY })
}

/// The closest hit; a ray that is no ray meets nothing.
pub(crate) fn closest(ray: &Ray, triangles: &[Numbered]) -> Hit {
    let mut first: Option<(Exact, u32)> = None;
    if !ray.is_valid() {
        return Hit::MISS;
    }
    let possible = triangles.iter().filter_map(|(number, corners)| {
        nearest(ray, corners).map(|nearest| (nearest, *number, corners))
    });
    let mut possible: Vec<_> = possible.collect();
    possible.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut reach = f64::INFINITY;
    for (nearest, primitive, corners) in possible {
        if nearest > reach {
            break;
        }
        let new = meeting(ray, corners).map(|t| (t, primitive));
        if let Some(new) = new.filter(|new| first.as_ref().is_none_or(|first| new < first)) {
            reach = f64::from(rounded_once(&new.0).next_up());
            first = Some(new);
        }
    }
    first.map_or(Hit::MISS, |(t, primitive)| Hit { t: rounded_once(&t), primitive })
}
