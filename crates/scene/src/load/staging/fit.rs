//! The nearest camera position from which a whole file is in the image.
//!
//! A point is in the image if it lies before four planes through the camera. With the camera's
//! direction given, each plane is moved to the farthest point: one pass over all points, from which
//! the distance follows.

use std::cmp::Ordering;

use glam::{DMat3, DVec3};

use super::Placed;

/// Distances of the farthest points.
#[derive(Clone, Copy)]
struct Planes {
    /// To the right and to the left, upward and downward, perpendicular to the planes.
    sides: [f64; 4],
    /// Towards the camera.
    nearest: f64,
}

/// The position of a camera that sees all points within `tangents` of half its angles of view.
/// `axes` point right, up and back from the object. `None` without points; `least` is the smallest
/// distance to one.
pub(super) fn place(
    all: &[Placed<'_>],
    axes: &DMat3,
    tangents: [f64; 2],
    least: f64,
) -> Option<DVec3> {
    let [across, along] = tangents;
    let into = axes.transpose();
    let of = |point: DVec3| {
        let DVec3 { x, y, z } = into * point;
        let sides = [x + across * z, across * z - x, y + along * z, along * z - y];
        Planes { sides, nearest: z }
    };
    let none = Planes { sides: [f64::NEG_INFINITY; 4], nearest: f64::NEG_INFINITY };
    let merge = |a: Planes, b: Planes| Planes {
        sides: [0, 1, 2, 3].map(|i| a.sides[i].max(b.sides[i])),
        nearest: a.nearest.max(b.nearest),
    };
    let found = all.iter().map(|placed| placed.reduce(none, of, merge)).fold(none, merge);
    let [right, left, up, down] = found.sides;
    let middle = [(right - left) / 2.0, (up - down) / 2.0];
    let distance = ((right + left) / (2.0 * across)).max((up + down) / (2.0 * along));
    let mut place = DVec3::new(middle[0], middle[1], distance.max(found.nearest + least));
    if !place.is_finite() {
        return None;
    }
    // The planes of one pair touch points and fix the camera; those of the other leave it free.
    let free = usize::from(right + left >= (up + down) * across / along);
    for _ in 0..CENTRED {
        place[free] = centred(all, &into, &place, free);
    }
    Some(*axes * place)
}

/// Number of centring steps: mostly the second finds the centre, when the outermost points are
/// known.
const CENTRED: u32 = 3;

/// The position along the `axis` across the view, for a camera at `place`, at which the outermost
/// points on both sides are equally far from the centre of the image.
fn centred(all: &[Placed<'_>], into: &DMat3, place: &DVec3, axis: usize) -> f64 {
    // The tangent of the angle, the point's position and its distance.
    let none = [[f64::NEG_INFINITY, 0.0, 1.0]; 2];
    let of = |point: DVec3| {
        let point = *into * point;
        let (at, distance) = (point[axis], place.z - point.z);
        let tangent = (at - place[axis]) / distance;
        [[tangent, at, distance], [-tangent, at, distance]]
    };
    let higher = |a: [f64; 3], b: [f64; 3]| {
        if a.partial_cmp(&b).is_some_and(Ordering::is_lt) { b } else { a }
    };
    let merge = |a: [[f64; 3]; 2], b: [[f64; 3]; 2]| [higher(a[0], b[0]), higher(a[1], b[1])];
    let found = all.iter().map(|placed| placed.reduce(none, of, merge)).fold(none, merge);
    let [[_, high, to_high], [_, low, to_low]] = found;
    (high * to_low + low * to_high) / (to_high + to_low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DAffine3, Vec3};

    /// The largest share of the image that points reach, horizontally and vertically.
    fn reached(points: &[Vec3], eye: DVec3, tangents: [f64; 2]) -> [[f64; 2]; 2] {
        let place = |p: &Vec3| {
            let p = p.as_dvec3() - eye;
            [p.x / -p.z / tangents[0], p.y / -p.z / tangents[1]]
        };
        [0, 1].map(|axis| {
            let at = || points.iter().map(|p| place(p)[axis]);
            [at().fold(f64::INFINITY, f64::min), at().fold(f64::NEG_INFINITY, f64::max)]
        })
    }

    #[test]
    fn points_touch_two_sides_of_the_image_and_pass_none() {
        let points = [
            Vec3::new(4.0, 1.0, -3.0),
            Vec3::new(-2.0, 0.5, 2.0),
            Vec3::new(1.0, 5.0, 0.0),
            Vec3::new(0.0, -3.0, 1.0),
        ];
        let placed = [Placed::new(&points, &[], DAffine3::IDENTITY)];
        for tangents in [[0.4, 0.3], [3.0, 0.3], [0.1, 2.0]] {
            let eye = place(&placed, &DMat3::IDENTITY, tangents, 1e-3).unwrap();
            let found = reached(&points, eye, tangents);
            let touches =
                |[low, high]: [f64; 2]| (low + 1.0).abs() < 1e-12 && (high - 1.0).abs() < 1e-12;
            assert!(found.into_iter().any(touches), "{tangents:?} {found:?}");
            // In the other direction the centre is in the middle.
            assert!(found.iter().all(|[low, high]| (low + high).abs() < 1e-6), "{found:?}");
            assert!(found.as_flattened().iter().all(|at| at.abs() < 1.0 + 1e-12), "{found:?}");
        }
    }

    #[test]
    fn a_point_is_seen_from_a_little_away_and_nothing_from_nowhere() {
        let placed = [Placed::new(&[Vec3::X], &[], DAffine3::IDENTITY)];
        let eye = place(&placed, &DMat3::IDENTITY, [0.4, 0.3], 0.5).unwrap();
        assert_eq!(eye, DVec3::new(1.0, 0.0, 0.5));
        assert_eq!(place(&[], &DMat3::IDENTITY, [0.4, 0.3], 0.5), None);
    }
}
