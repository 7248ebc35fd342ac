//! The nearest camera position from which a whole file is in the image.
//!
//! A point is in the image if it lies before four planes through the camera. With the camera's
//! direction given, each plane is moved to the farthest point: one pass over all points, from which
//! the distance follows. The same holds for a camera that goes around the file, with the circles on
//! which it sees the points move.

use std::cmp::Ordering;

use glam::{DMat3, DVec3};

use super::Scenery;
use crate::components::View;

/// Smallest distance of the camera from an object seen from outside, as a share of its radius.
pub(super) const NEAREST: f64 = 0.01;
/// Sine of the angle between the view and up below which they count as parallel.
pub(super) const PARALLEL: f64 = 1e-3;

/// The axes of a view: right, up, and `back` from the object, where `up` is up in the image.
pub(super) fn axes(up: DVec3, back: DVec3) -> DMat3 {
    let right = up.cross(back).normalize();
    DMat3::from_cols(right, back.cross(right), back)
}

/// The position of a camera that sees all points within `tangents` of half its angles of view.
/// `axes` point right, up and back from the object. `None` without points; `least` is the smallest
/// distance to one.
pub(super) fn position(
    contents: &Scenery<'_>,
    axes: &DMat3,
    tangents: [f64; 2],
    least: f64,
) -> Option<DVec3> {
    let [across, along] = tangents;
    let into = axes.transpose();
    // Perpendicular to the planes to the right and to the left, upward and downward; and towards the
    // camera.
    let of = |point: DVec3| {
        let DVec3 { x, y, z } = into * point;
        [x + across * z, across * z - x, y + along * z, along * z - y, z]
    };
    let none = [f64::NEG_INFINITY; 5];
    let merge = |a: [f64; 5], b: [f64; 5]| [0, 1, 2, 3, 4].map(|i| a[i].max(b[i]));
    let [right, left, up, down, nearest] = contents.outermost(none, of, merge);
    let middle = [(right - left) / 2.0, (up - down) / 2.0];
    let distance = ((right + left) / (2.0 * across)).max((up + down) / (2.0 * along));
    let mut position = DVec3::new(middle[0], middle[1], distance.max(nearest + least));
    if !position.is_finite() {
        return None;
    }
    // The planes of one pair touch points and fix the camera; those of the other leave it free.
    let free = usize::from(right + left >= (up + down) * across / along);
    for _ in 0..CENTRED {
        position[free] = centred(contents, &into, &position, free);
    }
    Some(*axes * position)
}

/// Number of centring steps: mostly the second finds the centre, when the outermost points are
/// known.
const CENTRED: u32 = 3;

/// The position along the `axis` across the view, for a camera at `position`, at which the outermost
/// points on both sides are equally far from the centre of the image.
fn centred(contents: &Scenery<'_>, into: &DMat3, position: &DVec3, axis: usize) -> f64 {
    // The tangent of the angle, the point's position and its distance.
    let none = [[f64::NEG_INFINITY, 0.0, 1.0]; 2];
    let of = |point: DVec3| {
        let point = *into * point;
        let (at, distance) = (point[axis], position.z - point.z);
        // No point is so near, but the corner of a box may be, which is not left out then.
        if distance < contents.sphere.radius * NEAREST / 2.0 {
            return [[f64::INFINITY, at, distance]; 2];
        }
        let tangent = (at - position[axis]) / distance;
        [[tangent, at, distance], [-tangent, at, distance]]
    };
    let higher = |a: [f64; 3], b: [f64; 3]| {
        if a.partial_cmp(&b).is_some_and(Ordering::is_lt) { b } else { a }
    };
    let merge = |a: [[f64; 3]; 2], b: [[f64; 3]; 2]| [higher(a[0], b[0]), higher(a[1], b[1])];
    let found = contents.outermost(none, of, merge);
    let [[_, high, to_high], [_, low, to_low]] = found;
    (high * to_low + low * to_high) / (to_high + to_low)
}

/// The view in the same direction at a point of the axis, from which the object is in the image at
/// any rotation about the axis.
///
/// A point at distance r from the axis and at height h moves along a circle; its outermost
/// positions on each side follow in closed form, with e the elevation and t the tangent of half an
/// angle of view.
pub(super) fn around(view: &View, contents: &Scenery<'_>, tangents: [f64; 2], axis: DVec3) -> View {
    let back = (view.location - view.look).normalize();
    let [across, along] = tangents;
    let sine = back.dot(axis).clamp(-1.0, 1.0);
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let center = contents.sphere.center;
    let sideways = (across.powi(-2) + cosine * cosine).sqrt();
    let [upward, downward] = [1.0, -1.0]
        .map(|sign| ((cosine - sign * sine / along).abs(), sine + sign * cosine / along));
    let of = |point: DVec3| {
        let arm = point - center;
        let h = arm.dot(axis);
        let r = (arm - axis * h).length();
        [upward, downward].map(|(out, up)| r * out + h * up).map(|d| [d, r * sideways + h * sine])
    };
    let merge =
        |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| [0, 1].map(|i| [0, 1].map(|j| a[i][j].max(b[i][j])));
    let none = [[f64::NEG_INFINITY; 2]; 2];
    let found = contents.outermost(none, of, merge);
    let [[up, side], [down, _]] = found;
    if !(up.is_finite() && down.is_finite()) {
        return *view;
    }
    // The height at which both touch the image's border, not only one.
    let height = if cosine > PARALLEL { (up - down) * along / (2.0 * cosine) } else { 0.0 };
    let distance =
        (up - height * upward.1).max(down - height * downward.1).max(side - height * sine);
    // A single point is seen from a little away.
    let distance = distance.max(contents.sphere.radius * NEAREST);
    let look = center + axis * height;
    View { location: look + back * distance, look, ..*view }
}

#[cfg(test)]
mod tests {
    use super::super::tests::contents;
    use super::*;
    use crate::options::LoadOptions;
    use crate::options::framing::{Framing, Up};
    use crate::staging::{Upward, framed};
    use glam::Vec3;

    const POINTS: [Vec3; 4] = [
        Vec3::new(4.0, 1.0, -3.0),
        Vec3::new(-2.0, 0.5, 2.0),
        Vec3::new(1.0, 5.0, 0.0),
        Vec3::new(0.0, -3.0, 1.0),
    ];

    /// The positions of the points in the image of a camera, from -1 to 1.
    fn places([eye, look, up]: [DVec3; 3], tangents: [f64; 2]) -> [[f64; 2]; 4] {
        let back = (eye - look).normalize();
        let right = up.cross(back).normalize();
        POINTS.map(|p| {
            let p = p.as_dvec3() - eye;
            let depth = -p.dot(back);
            [p.dot(right) / depth / tangents[0], p.dot(back.cross(right)) / depth / tangents[1]]
        })
    }

    #[test]
    fn a_point_is_seen_from_a_little_away_and_nothing_from_nowhere() {
        let seen = |points: Vec<Vec3>| {
            position(&contents(&(points, vec![])), &DMat3::IDENTITY, [0.4, 0.3], 0.5)
        };
        assert_eq!(seen(vec![Vec3::X]), Some(DVec3::new(1.0, 0.0, 0.5)));
        assert_eq!(seen(vec![]), None);
    }

    #[test]
    fn what_turns_stays_in_the_image_and_fills_it() {
        for (up, side) in
            [(Up::Y, "front"), (Up::Z, "30,20"), (Up::NegativeX, "-100,-60"), (Up::Y, "top")]
        {
            let side = Some(side.parse().unwrap());
            let turntable = Some(720);
            let framing = Framing { side, up: Some(up), turntable, ..Framing::default() };
            let options = LoadOptions { framing, ..LoadOptions::default() };
            let mesh = (POINTS.to_vec(), vec![]);
            let found = framed(&contents(&mesh), Upward::Stated(Up::Y), &options).unwrap();
            let keys = found.path.unwrap().keys;
            assert_eq!((keys.len(), keys[0].frame, keys[719].frame), (720, 1, 720));
            assert_eq!((found.view.location, found.view.look), (keys[0].location, keys[0].look));
            let tangent = (20.0_f64).to_radians().tan();
            let tangents = [tangent * 4.0 / 3.0, tangent];
            let seen =
                keys.iter().flat_map(|key| places([key.location, key.look, key.up], tangents));
            let farthest = seen.flatten().fold(0.0, |most: f64, at| most.max(at.abs()));
            // The share to fill, reached in one frame of many.
            assert!(farthest < 0.92 + 1e-9 && farthest > 0.91, "{up:?} {side:?}: {farthest}");
        }
    }
}
