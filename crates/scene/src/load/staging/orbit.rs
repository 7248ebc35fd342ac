//! A camera that turns around an object, or shows several of its sides.
//!
//! Each frame is a key of the camera's path, so that interpolation does not matter and a scene file
//! can store the path. The camera keeps its distance and its height: the turning object stays in
//! the image at any angle.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::camera::{NEAREST, PARALLEL, Stage};
use crate::components::{CameraKey, CameraPath, Interpolation, View};

/// The path of one turn in this number of frames, starting at `view`. Inside a room the camera
/// turns in place.
pub(super) fn path(view: &View, frames: u32, stage: &Stage<'_>, inside: bool) -> CameraPath {
    let axis = stage.up.axes().y_axis;
    let start = if inside { *view } else { around(view, stage, axis) };
    through((0..frames).map(|frame| {
        let turn = DQuat::from_axis_angle(axis, TAU * f64::from(frame) / f64::from(frames));
        let pivot = if inside { start.location } else { start.look };
        let turned = |point: DVec3| pivot + turn * (point - pivot);
        View {
            location: turned(start.location),
            look: turned(start.look),
            up: turn * start.up,
            ..start
        }
    }))
}

/// The path with these views as frames, from 1 on.
pub(super) fn through(views: impl Iterator<Item = View>) -> CameraPath {
    let key = |(frame, view): (u32, View)| CameraKey {
        frame,
        location: view.location,
        look: view.look,
        up: view.up,
        fov_degrees: view.fov_degrees,
        focal: 1.0,
    };
    CameraPath { keys: (1..).zip(views).map(key).collect(), interpolation: Interpolation::Linear }
}

/// `view` as in the first frame.
pub(super) fn first(view: View, path: &CameraPath) -> View {
    let Some(key) = path.keys.first() else { return view };
    View { location: key.location, look: key.look, up: key.up, ..view }
}

/// The view in the same direction at a point of the axis, from which the object is in the image at
/// any rotation about the axis.
///
/// A point at distance r from the axis and at height h moves along a circle; its outermost
/// positions on each side follow in closed form, with e the elevation and t the tangent of half an
/// angle of view.
fn around(view: &View, stage: &Stage<'_>, axis: DVec3) -> View {
    let back = (view.location - view.look).normalize();
    let [across, along] = stage.tangents(view);
    let sine = back.dot(axis).clamp(-1.0, 1.0);
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let center = stage.bounds.center;
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
    let found = stage.all.iter().map(|p| p.reduce(none, of, merge)).fold(none, merge);
    let [[up, side], [down, _]] = found;
    if !(up.is_finite() && down.is_finite()) {
        return *view;
    }
    // The height at which both touch the image's border, not only one.
    let height = if cosine > PARALLEL { (up - down) * along / (2.0 * cosine) } else { 0.0 };
    let distance =
        (up - height * upward.1).max(down - height * downward.1).max(side - height * sine);
    // A single point is seen from a little away.
    let distance = distance.max(stage.bounds.radius * NEAREST);
    let look = center + axis * height;
    View { location: look + back * distance, look, ..*view }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::LoadOptions;
    use crate::load::framing::{Framing, Up};
    use crate::load::staging::{Placed, Upward, bounds, framed};
    use glam::{DAffine3, Vec3};

    /// The positions of points in the image of a key, from -1 to 1.
    fn places(points: &[Vec3], key: &CameraKey, tangents: [f64; 2]) -> Vec<[f64; 2]> {
        let forward = (key.look - key.location).normalize();
        let right = forward.cross(key.up).normalize();
        let up = right.cross(forward);
        let place = |p: &Vec3| {
            let p = p.as_dvec3() - key.location;
            let depth = p.dot(forward);
            [p.dot(right) / depth / tangents[0], p.dot(up) / depth / tangents[1]]
        };
        points.iter().map(place).collect()
    }

    #[test]
    fn what_turns_stays_in_the_image_and_fills_it() {
        let points = [
            Vec3::new(3.0, 0.0, 0.5),
            Vec3::new(-3.0, 1.0, 0.0),
            Vec3::new(0.0, -1.0, -1.0),
            Vec3::new(0.2, 2.0, 1.0),
        ];
        let all = [Placed::new(&points, &[], DAffine3::IDENTITY)];
        for (up, side) in
            [(Up::Y, "front"), (Up::Z, "30,20"), (Up::NegativeX, "-100,-60"), (Up::Y, "top")]
        {
            let framing = Framing {
                side: Some(side.parse().unwrap()),
                up: Some(up),
                turntable: Some(720),
                ..Framing::default()
            };
            let options = LoadOptions { framing, ..LoadOptions::default() };
            let found = framed(&all, &bounds(&all), Upward::Stated(Up::Y), &options).unwrap();
            let keys = found.path.unwrap().keys;
            assert_eq!((keys.len(), keys[0].frame, keys[719].frame), (720, 1, 720));
            assert_eq!((found.view.location, found.view.look), (keys[0].location, keys[0].look));
            let tangent = (20.0_f64).to_radians().tan();
            let tangents = [tangent * 4.0 / 3.0, tangent];
            let seen = keys.iter().flat_map(|key| places(&points, key, tangents));
            let farthest = seen.flatten().fold(0.0, |most: f64, at| most.max(at.abs()));
            // The share to fill, reached in one frame of many.
            assert!(farthest < 0.92 + 1e-9 && farthest > 0.91, "{up:?} {side}: {farthest}");
        }
    }
}
