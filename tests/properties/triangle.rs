use glam::{DVec2, Vec3};
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use wavecrest_core::kernels::triangle::{Meeting, ShearedSpace, T_TOLERANCE, is_degenerate};
use wavecrest_core::math::float::{UNIT_ROUNDOFF, max_abs};
use wavecrest_core::math::ray::Ray;

use crate::exact::{Exact, cross, exact, exact3, minus, rounded};
use crate::inputs::{coordinate, moderate, vector};

/// Three of a list: often ones that lie on a line.
fn corners() -> impl Strategy<Value = [Vec3; 3]> {
    let on_a_line = (vector(coordinate), vector(coordinate), -4_i8..=4).prop_map(|(a, b, k)| {
        let c = a + (b - a) * f32::from(k);
        [a, b, c]
    });
    let any = [vector(coordinate), vector(coordinate), vector(coordinate)];
    prop_oneof![any, on_a_line].prop_filter("coordinates that may be", |corners| {
        corners.iter().all(|&c| max_abs(c) <= wavecrest_core::math::float::MAX_COORDINATE)
    })
}

/// As seen along z: the signs of the areas that the origin forms with each edge.
fn sides(corners: &[Vec3; 3]) -> [f64; 3] {
    let p = |i: usize| robust::Coord { x: f64::from(corners[i].x), y: f64::from(corners[i].y) };
    let origin = robust::Coord { x: 0.0, y: 0.0 };
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| robust::orient2d(origin, p(i), p(j)).signum_or_zero())
}

trait Sign {
    fn signum_or_zero(self) -> Self;
}

impl Sign for f64 {
    fn signum_or_zero(self) -> Self {
        if self == 0.0 { 0.0 } else { self.signum() }
    }
}

/// Vertices as the exact ray sees them, without rounding: across the ray along two axes, and t.
fn seen(ray: &Ray, corners: &[Vec3; 3]) -> [[Exact; 3]; 3] {
    let size = ray.direction.abs();
    let k = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).expect("there are three axes");
    let (origin, direction) = (exact3(ray.origin), exact3(ray.direction));
    corners.map(|corner| {
        let v = minus(&exact3(corner), &origin);
        let t = &v[k] / &direction[k];
        let across = |i: usize| &v[i] - &t * &direction[i];
        [across((k + 1) % 3), across((k + 2) % 3), t.clone()]
    })
}

/// How far the ray's line passes from the triangle, and how deep inside of it, both across the ray.
/// One of them is zero.
fn distances(seen: &[[Exact; 3]; 3]) -> (f64, f64) {
    let area = |i: usize, j: usize| &seen[i][0] * &seen[j][1] - &seen[i][1] * &seen[j][0];
    let edges = [(1, 2), (2, 0), (0, 1)];
    let point = |i: usize| DVec2::new(rounded(&seen[i][0]), rounded(&seen[i][1]));
    let nearest = edges.map(|(i, j)| {
        let (p, q) = (point(i), point(j));
        let along = (-p.dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
        let along = if along.is_nan() { 0.0 } else { along };
        (p + (q - p) * along).length()
    });
    let nearest = nearest.into_iter().fold(f64::INFINITY, f64::min);
    let areas = edges.map(|(i, j)| area(i, j));
    let inside = areas.iter().all(Signed::is_positive) || areas.iter().all(Signed::is_negative);
    if inside { (0.0, nearest) } else { (nearest, 0.0) }
}

proptest! {
    #![proptest_config(crate::config())]

    /// Corners on one line, and no others, make no triangle.
    #[test]
    fn degenerate_is_what_has_exactly_no_area(corners in corners()) {
        let [a, b, c] = corners.map(exact3);
        let area = cross(&minus(&b, &a), &minus(&c, &a));
        prop_assert_eq!(is_degenerate(&corners), area.iter().all(Zero::is_zero));
    }

    /// Along z from the origin nothing is rounded before the edge functions: their signs are then
    /// those of the exact orientation, however near the ray passes an edge.
    #[test]
    fn the_signs_of_edge_functions_are_exact(corners in corners(), length in -3_i32..=3) {
        let direction = Vec3::new(0.0, 0.0, 2.0_f32.powi(length));
        // Across the ray and in front of it, so that the signs decide alone.
        let corners = corners.map(|v| Vec3::new(v.x, v.y, 1.0));
        let sides = sides(&corners);
        let inside = sides.iter().any(|&s| s != 0.0)
            && !(sides.contains(&1.0) && sides.contains(&-1.0));
        let space = ShearedSpace::new(&Ray::new(Vec3::ZERO, direction));
        let t = 1.0 / direction.z;
        prop_assert_eq!(space.intersect(&corners), inside.then_some(t), "{:?}", sides);
    }

    /// What the exact ray meets with room to spare is met, and what it misses by as much is missed:
    /// the room is the bound that boxes are padded by.
    #[test]
    fn a_hit_is_decided_within_the_stated_bound(
        corners in [vector(coordinate), vector(coordinate), vector(coordinate)],
        origin in vector(coordinate),
        weights in (0.0_f32..1.0, 0.0_f32..1.0),
        aside in vector(moderate),
        aims in any::<bool>(),
    ) {
        let [a, b, c] = corners;
        let (v, w) = (weights.0 * (1.0 - weights.1), weights.0 * weights.1);
        let target = a + (b - a) * v + (c - a) * w;
        let ray = Ray::new(origin, if aims { target - origin } else { aside });
        prop_assume!(ray.is_valid() && !is_degenerate(&corners));
        let size = [a, b, c, origin].map(max_abs);
        let room = 10.0 * f64::from(UNIT_ROUNDOFF)
            * (f64::from(size[0].max(size[1]).max(size[2])) + f64::from(size[3]))
            + f64::from(f32::MIN_POSITIVE);
        let seen = seen(&ray, &corners);
        let (outside, inside) = distances(&seen);
        let hit = ShearedSpace::new(&ray).intersect(&corners);
        // Distances are measured along two axes that need not be at right angles to the ray, and
        // bounds along each axis: twice the room covers both.
        if outside > 2.0 * room {
            prop_assert_eq!(hit, None, "{} outside, of {}", outside, room);
        }
        // Away from the start, so that there is no doubt of the sign of t.
        let t = [0, 1, 2].map(|i| rounded(&seen[i][2]));
        let near = t.into_iter().fold(f64::INFINITY, f64::min);
        let far = t.into_iter().fold(0.0, f64::max);
        if inside > 2.0 * room && near > 1e-3 * far && near > 1e-30 && far < 1e30 {
            prop_assert!(hit.is_some(), "{} inside, of {}", inside, room);
        }
    }

    /// From integers t is within the stated tolerance of the exact one.
    #[test]
    fn t_is_near_the_exact_one(
        corners in prop::array::uniform3(prop::array::uniform3(-100_i16..=100)),
        origin in prop::array::uniform3(-100_i16..=100),
        direction in prop::array::uniform3(-100_i16..=100),
    ) {
        let vector = |v: [i16; 3]| Vec3::from(v.map(f32::from));
        let (corners, ray) = (corners.map(vector), Ray::new(vector(origin), vector(direction)));
        prop_assume!(ray.is_valid());
        let Some(t) = ShearedSpace::new(&ray).intersect(&corners) else { return Ok(()) };
        let [a, b, c] = corners.map(exact3);
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let dot = |u: &[Exact; 3]| (0..3).map(|k| &normal[k] * &u[k]).sum::<Exact>();
        let along = dot(&exact3(ray.direction));
        prop_assert!(!along.is_zero(), "the ray runs in the plane");
        let right = dot(&minus(&a, &exact3(ray.origin))) / along;
        let off = (exact(t) - &right).abs();
        prop_assert!(off <= exact(T_TOLERANCE) * right.abs(), "{} and not {}", t, rounded(&right));
    }

    /// Where single precision does not suffice, as on a floor that is large beside its distance, t is the exact one
    /// rounded once; and no order of the corners changes a bit of any t.
    #[test]
    fn t_on_large_triangles_is_the_exact_one_rounded(
        corners in [vector(moderate), vector(moderate), vector(moderate)],
        weights in (0.01_f32..0.99, 0.01_f32..0.99),
        direction in vector(moderate),
        distance in 1e-6_f32..1e-2,
    ) {
        let [a, b, c] = corners.map(|corner| corner * 1000.0);
        let (v, w) = (weights.0 * (1.0 - weights.1), weights.0 * weights.1);
        let target = a + (b - a) * v + (c - a) * w;
        let ray = Ray::new(target - direction * distance, direction);
        prop_assume!(ray.is_valid() && !is_degenerate(&[a, b, c]));
        let space = ShearedSpace::new(&ray);
        let meeting = space.meet(&[a, b, c]);
        for turned in [[b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]] {
            prop_assert_eq!(space.meet(&turned), meeting);
        }
        let Meeting::Hit(t) = meeting else { return Ok(()) };
        if space.error_of(&[a, b, c], t) == Some(UNIT_ROUNDOFF * t.abs()) {
            let [a, b, c] = [a, b, c].map(exact3);
            let normal = cross(&minus(&b, &a), &minus(&c, &a));
            let dot = |u: &[Exact; 3]| (0..3).map(|k| &normal[k] * &u[k]).sum::<Exact>();
            let right = dot(&minus(&a, &exact3(ray.origin))) / dot(&exact3(ray.direction));
            prop_assert_eq!(rounded(&right) as f32, t);
        }
    }
}
