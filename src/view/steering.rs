//! The camera that the user of the page moves: around a point, across the image, towards a point, on foot, and to named
//! sides.

use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3};

use wavecrest_core::kernels::camera::half_extent;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_scene::components::View;
use wavecrest_scene::load::framing::{Fit, Side, Up, toward};

/// The least angle between the view and the vertical after a turn, in radians: left and right stay where they are.
const STEEPEST: f64 = 0.01;
/// Sine of the angle between the view and the vertical below which the image keeps its own direction of up.
const PARALLEL: f64 = 1e-3;
/// The distance before a notch of the wheel towards a point, as a multiple of that after it.
const NOTCH: f64 = 1.2;
/// The most notches at a time.
const MOST_NOTCHES: f64 = 20.0;

/// A view, and what its movements are relative to. Movements are shares of the image's height.
pub(super) struct Steering {
    pub(super) view: View,
    start: View,
    /// Right, up and front of the scene. Its up is the coordinate axis nearest to that of the first view.
    axes: DMat3,
    /// The point that turns leave in its place, and that follows the cursor as the view moves across the image.
    pub(super) pivot: DVec3,
}

impl Steering {
    pub(super) fn new(view: View) -> Self {
        let along = |up: &Up| up.axes().y_axis.dot(view.up);
        let up = Up::ALL.into_iter().max_by(|a, b| along(a).total_cmp(&along(b)));
        let axes = up.unwrap_or(Up::Y).axes();
        Self { view, start: view, axes, pivot: view.look }
    }

    /// Right, up and ahead in the image.
    fn basis(&self) -> [DVec3; 3] {
        let ahead = (self.view.look - self.view.location).normalize();
        let right = ahead.cross(self.view.up).normalize();
        [right, right.cross(ahead), ahead]
    }

    /// The point at a place of the image, in shares of its sides from the top left, as far away as the look-at point.
    pub(super) fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        let ([right, up, ahead], half) = (self.basis(), half_extent(&self.view.placement()));
        let across = right * (half[0] * (2.0 * x - 1.0)) + up * (half[1] * (1.0 - 2.0 * y));
        self.view.location + (ahead + across) * self.view.look.distance(self.view.location)
    }

    /// Moves to where the view is a valid one; otherwise it stays.
    fn go(&mut self, location: DVec3, look: DVec3, up: DVec3) {
        let greatest = f64::from(MAX_COORDINATE);
        let is_within = |point: DVec3| point.abs().max_element() <= greatest;
        let ahead = (look - location).normalize_or_zero();
        // Also false for numbers that are none.
        if is_within(location) && is_within(look) && ahead.cross(up).length() >= PARALLEL {
            self.view = View { location, look, up, ..self.view };
        }
    }

    /// Up in an upright image, unless the view is along it.
    fn upright(&self, ahead: DVec3) -> Option<DVec3> {
        let up = self.axes.y_axis;
        (ahead.cross(up).length() >= PARALLEL).then_some(up)
    }

    /// Turns around the pivot: half a turn for the whole height.
    pub(super) fn orbit(&mut self, [right, down]: [f64; 2]) {
        let ([side, up, ahead], upright) = (self.basis(), self.axes.y_axis);
        let angle = ahead.angle_between(upright);
        let wanted = (angle + PI * down).clamp(STEEPEST, PI - STEEPEST);
        let turn = DQuat::from_axis_angle(upright, -PI * right)
            * DQuat::from_axis_angle(side, angle - wanted);
        let turned = |point: DVec3| self.pivot + turn * (point - self.pivot);
        let up = self.upright(turn * ahead).unwrap_or(turn * up);
        self.go(turned(self.view.location), turned(self.view.look), up);
    }

    /// Turns in its place, as a head: what is seen follows the cursor.
    pub(super) fn turn(&mut self, [right, down]: [f64; 2]) {
        let pivot = std::mem::replace(&mut self.pivot, self.view.location);
        let angle = 2.0 * half_extent(&self.view.placement())[1].atan() / PI;
        self.orbit([-right * angle, -down * angle]);
        self.pivot = pivot;
    }

    /// Moves across the image, so that the pivot follows the cursor.
    pub(super) fn pan(&mut self, [right, down]: [f64; 2]) {
        let [side, up, ahead] = self.basis();
        let depth = (self.pivot - self.view.location).dot(ahead).max(0.0);
        let height = 2.0 * half_extent(&self.view.placement())[1] * depth;
        self.shift((up * down - side * right) * height);
    }

    /// Moves towards `point`, or away from it with fewer than no notches.
    pub(super) fn zoom(&mut self, point: DVec3, notches: f64) {
        let View { location, look, up, .. } = self.view;
        let left = NOTCH.powf(-notches.clamp(-MOST_NOTCHES, MOST_NOTCHES));
        let nearer = point + (location - point) * left;
        self.go(nearer, nearer + (look - location) * left, up);
    }

    /// Walks to the right, upward and ahead, each as a share of `unit`.
    pub(super) fn walk(&mut self, [right, up, ahead]: [f64; 3], unit: f64) {
        let [side, _, forward] = self.basis();
        self.shift((side * right + self.axes.y_axis * up + forward * ahead) * unit);
    }

    fn shift(&mut self, by: DVec3) {
        let View { location, look, up, .. } = self.view;
        self.go(location + by, look + by, up);
    }

    /// Shows everything in a box from a named side, or with `all` from where the camera is; `start` is the first view.
    pub(super) fn show(&mut self, side: &str, [low, high]: [DVec3; 2]) {
        let [_, up, ahead] = self.basis();
        let named = Side::NAMED.iter().find(|(name, ..)| *name == side);
        let [back, up] = match (side, named) {
            ("start", _) => {
                self.view = self.start;
                return;
            }
            (_, Some(&(_, azimuth, elevation))) => {
                toward(azimuth, elevation).map(|direction| self.axes * direction)
            }
            ("all", None) => [-ahead, up],
            _ => return,
        };
        let up = self.upright(back).unwrap_or(up);
        let right = up.cross(back).normalize();
        let tangents = half_extent(&self.view.placement()).map(|t| t * Fit::default().share());
        let (center, half) = ((low + high) / 2.0, (high - low) / 2.0);
        // How far a camera has to be from each corner to see it.
        let distance = (0..8).map(|corner: u32| {
            let sign = |axis: u32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let arm = half * DVec3::new(sign(0), sign(1), sign(2));
            let across = [arm.dot(right), arm.dot(back.cross(right))];
            arm.dot(back) + (across[0].abs() / tangents[0]).max(across[1].abs() / tangents[1])
        });
        let distance = distance.fold(0.0, f64::max);
        let distance = if distance > 0.0 { distance } else { 1.0 };
        self.pivot = center;
        self.go(center + back * distance, center, up);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavecrest_core::math::sampling::Sampling;
    use wavecrest_scene::components::FovAxis;

    fn steering() -> Steering {
        Steering::new(View {
            width: 40,
            height: 30,
            fov_degrees: 40.0,
            fov_axis: FovAxis::Smaller,
            location: DVec3::new(1.0, 2.0, 9.0),
            look: DVec3::new(0.5, 0.0, 0.0),
            up: DVec3::new(0.1, 1.0, 0.0),
            antialias: 1,
            sampling: Sampling::Jittered,
        })
    }

    /// Where a point is in the image, in shares of half its sides.
    fn seen(steering: &Steering, point: DVec3) -> [f64; 2] {
        let ([right, up, ahead], arm) = (steering.basis(), point - steering.view.location);
        let half = half_extent(&steering.view.placement());
        [arm.dot(right) / arm.dot(ahead) / half[0], arm.dot(up) / arm.dot(ahead) / half[1]]
    }

    #[test]
    fn turns_keep_the_pivot_where_it_is_and_the_image_upright() {
        let mut steering = steering();
        steering.orbit([0.0, 0.0]);
        steering.pivot = DVec3::new(0.3, 0.4, -0.2);
        let before = seen(&steering, steering.pivot);
        for by in [[0.3, 0.1], [-0.7, 0.9], [0.2, -3.0], [5.0, 0.01]] {
            steering.orbit(by);
            let after = seen(&steering, steering.pivot);
            assert!((0..2).all(|i| (after[i] - before[i]).abs() < 1e-9), "{after:?} {before:?}");
            assert_eq!(steering.view.up, DVec3::Y);
        }
    }

    #[test]
    fn a_turn_in_place_keeps_the_place_and_lets_the_scene_follow() {
        let mut steering = steering();
        steering.orbit([0.0, 0.0]);
        let (place, look) = (steering.view.location, steering.view.look);
        steering.turn([0.1, 0.1]);
        let [x, y] = seen(&steering, look);
        assert!(steering.view.location.distance(place) < 1e-12);
        assert!((x - 0.15).abs() < 0.01 && (y + 0.2).abs() < 0.01, "{x} {y}");
    }

    #[test]
    fn the_pivot_follows_the_cursor_and_the_wheel_leaves_its_point() {
        let mut steering = steering();
        let before = seen(&steering, steering.pivot);
        steering.pan([0.25, 0.125]);
        let after = seen(&steering, steering.pivot);
        // Shares of the height, of an image of 4 by 3, and of half the sides.
        let moved = [after[0] - before[0], after[1] - before[1]];
        assert!((moved[0] - 0.375).abs() < 0.01 && (moved[1] + 0.25).abs() < 0.01, "{moved:?}");
        let point = steering.point([0.2, 0.7]);
        let [x, y] = seen(&steering, point);
        assert!((x + 0.6).abs() < 1e-9 && (y + 0.4).abs() < 1e-9);
        steering.zoom(point, 3.0);
        let [x, y] = seen(&steering, point);
        assert!((x + 0.6).abs() < 1e-9 && (y + 0.4).abs() < 1e-9);
    }

    #[test]
    fn every_side_shows_the_whole_box_and_nothing_invalid_is_taken() {
        let (low, high) = (DVec3::new(-1.0, 0.0, -3.0), DVec3::new(2.0, 0.5, 4.0));
        let mut steering = steering();
        for side in Side::NAMED.map(|(name, ..)| name).into_iter().chain(["all"]) {
            steering.show(side, [low, high]);
            for corner in 0..8 {
                let of = |axis: usize| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] };
                let at = seen(&steering, DVec3::new(of(0), of(1), of(2)));
                assert!(at.iter().all(|x| x.abs() < 0.93), "{side} {at:?}");
            }
        }
        let before = steering.view;
        steering.walk([0.0, 0.0, 1.0], f64::INFINITY);
        steering.walk([f64::NAN, 0.0, 1.0], 1.0);
        steering.pan([1e300, 0.0]);
        assert_eq!(steering.view, before);
        steering.show("start", [low, high]);
        assert_eq!(steering.view.location, DVec3::new(1.0, 2.0, 9.0));
    }
}
