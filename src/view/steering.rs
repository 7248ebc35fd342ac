//! The camera that the user of the page moves: around a point, across the image, towards a point, on foot, and to named
//! sides.
//!
//! Its location, the direction ahead and the distance of the look-at point are kept as they are, and the view follows from
//! them: the difference of two points that are close has few bits left, and a camera that takes its direction from there
//! turns a little with each movement.

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
/// Notches are counted in whole parts of one, so that sums of them are exact. Wheels turn by decimal numbers.
const NOTCH_PARTS: f64 = 10_000.0;
/// The least distance of the look-at point in a view, as a share of the largest coordinate. Its direction is then that of the
/// camera within 2⁻²⁶, the last bits of double precision over this share: less than single precision tells apart.
const LEAST_REACH: f64 = 1.0 / (1 << 26) as f64;
/// Within which share of the way that is left a surface has to be found again from the end of a movement towards it. That
/// way is then at least eight times as long as all roundings: those of rays, and of the surface in other coordinates.
const FOUND_AGAIN: f64 = 0.125;

/// What is seen at a place of the image.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    pub(super) point: DVec3,
    /// Whether a surface is there; otherwise the point is as far away as the look-at point.
    pub(super) is_met: bool,
}

/// Notches of the wheel at one place of the image.
#[derive(Clone, Copy)]
struct Zoom {
    at: [f64; 2],
    towards: Seen,
    /// The view and the distance before the first of them.
    from: View,
    distance: f64,
    /// Their sum, in parts.
    parts: f64,
}

/// A view, and what its movements are relative to. Movements are shares of the image's height.
#[derive(Clone, Copy)]
pub(super) struct Steering {
    /// What is shown. Before the first movement it has the bits of the file.
    pub(super) view: View,
    /// The unit direction ahead, and the distance of the look-at point.
    ahead: DVec3,
    distance: f64,
    start: View,
    /// Right, up and front of the scene. Its up is the coordinate axis nearest to that of the first view.
    axes: DMat3,
    /// The point that turns leave in its place, and that follows the cursor as the view moves across the image.
    pub(super) pivot: DVec3,
    /// The last movement, if it was one of the wheel.
    zoom: Option<Zoom>,
}

impl Steering {
    pub(super) fn new(view: View) -> Self {
        let axes = Up::nearest(view.up).axes();
        let arm = view.look - view.location;
        let (ahead, distance) = (arm.normalize(), arm.length());
        Self { view, ahead, distance, start: view, axes, pivot: view.look, zoom: None }
    }

    /// The first view.
    pub(super) fn start(&self) -> &View {
        &self.start
    }

    /// Stays where another camera has been moved to, if it has.
    pub(super) fn stay_at(&mut self, other: &Self) {
        let place = |view: &View| (view.location, view.look, view.up);
        if place(&other.view) != place(&other.start) {
            let (location, look, up) = place(&other.view);
            self.view = View { location, look, up, ..self.view };
            (self.ahead, self.distance) = (other.ahead, other.distance);
        }
    }

    /// Gives the image another size, in pixels.
    pub(super) fn resize(&mut self, [width, height]: [u32; 2]) {
        for view in [&mut self.view, &mut self.start] {
            (view.width, view.height) = (width, height);
        }
        self.zoom = None;
    }

    /// Right, up and ahead in the image.
    fn basis(&self) -> [DVec3; 3] {
        let right = self.ahead.cross(self.view.up).normalize();
        [right, right.cross(self.ahead), self.ahead]
    }

    /// The point at a place of the image, in shares of its sides from the top left, as far away as the look-at point.
    pub(super) fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        let ([right, up, ahead], half) = (self.basis(), half_extent(&self.view.placement()));
        let across = right * (half[0] * (2.0 * x - 1.0)) + up * (half[1] * (1.0 - 2.0 * y));
        self.view.location + (ahead + across) * self.distance
    }

    /// Moves to where the view is a valid one; otherwise it stays, and the answer is false.
    fn go(&mut self, location: DVec3, ahead: DVec3, distance: f64, up: DVec3) -> bool {
        let greatest = f64::from(MAX_COORDINATE);
        let is_within = |point: DVec3| point.abs().max_element() <= greatest;
        let reach = distance.max(location.abs().max_element() * LEAST_REACH);
        let look = location + ahead * reach;
        let seen = (look - location).normalize_or_zero();
        // Also false for numbers that are none.
        let is_valid = is_within(location)
            && is_within(look)
            && distance > 0.0
            && seen.cross(up).length() >= PARALLEL;
        if is_valid {
            self.view = View { location, look, up, ..self.view };
            (self.ahead, self.distance, self.zoom) = (ahead, distance, None);
        }
        is_valid
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
        let location = self.pivot + turn * (self.view.location - self.pivot);
        let ahead = (turn * ahead).normalize();
        let up = self.upright(ahead).unwrap_or(turn * up);
        self.go(location, ahead, self.distance, up);
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

    /// Moves towards what `see` finds at a place of the image, or away from it with fewer than no notches; never so near to
    /// a surface that it is not certain to be ahead any more.
    ///
    /// Notches at one place count from where the first of them began: as many back lead there again, to the bit.
    pub(super) fn zoom(&mut self, at: [f64; 2], notches: f64, see: impl Fn(&Self) -> Seen) {
        let before = *self;
        let mut zoom = self.zoom.filter(|zoom| zoom.at == at).unwrap_or_else(|| Zoom {
            at,
            towards: see(self),
            from: self.view,
            distance: self.distance,
            parts: 0.0,
        });
        zoom.parts += (notches.clamp(-MOST_NOTCHES, MOST_NOTCHES) * NOTCH_PARTS).round();
        let Zoom { towards: Seen { point, is_met }, from, distance, parts, .. } = zoom;
        let left = NOTCH.powf(-parts / NOTCH_PARTS);
        let arm = (from.location - point) * left;
        if !self.go(point + arm, self.ahead, distance * left, from.up) {
            return;
        }
        if parts == 0.0 {
            self.view = from;
        }
        self.zoom = Some(zoom);
        let is_ahead = || {
            let again = see(self);
            again.is_met && again.point.distance(point) <= FOUND_AGAIN * arm.length()
        };
        if notches > 0.0 && is_met && !is_ahead() {
            *self = before;
        }
    }

    /// Walks to the right, upward and ahead, each as a share of `unit`.
    pub(super) fn walk(&mut self, [right, up, ahead]: [f64; 3], unit: f64) {
        let [side, _, forward] = self.basis();
        self.shift((side * right + self.axes.y_axis * up + forward * ahead) * unit);
    }

    fn shift(&mut self, by: DVec3) {
        self.go(self.view.location + by, self.ahead, self.distance, self.view.up);
    }

    /// Shows everything in a box from a named side, or with `all` from where the camera is; `start` is the first view.
    pub(super) fn show(&mut self, side: &str, [low, high]: [DVec3; 2]) {
        let [_, up, ahead] = self.basis();
        let named = Side::NAMED.iter().find(|(name, ..)| *name == side);
        let [back, up] = match (side, named) {
            ("start", _) => {
                *self = Self { pivot: self.pivot, ..Self::new(self.start) };
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
        self.go(center + back * distance, -back, distance, up);
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
        steering.zoom([0.2, 0.7], 3.0, |_| Seen { point, is_met: false });
        let [x, y] = seen(&steering, point);
        assert!((x + 0.6).abs() < 1e-9 && (y + 0.4).abs() < 1e-9);
    }

    /// What is seen of nothing but sky.
    fn sky(at: [f64; 2]) -> impl Fn(&Steering) -> Seen {
        move |steering| Seen { point: steering.point(at), is_met: false }
    }

    #[test]
    fn as_many_notches_out_as_in_lead_back_to_the_bit() {
        for (by, at) in [(1.0, [0.5, 0.5]), (1.2, [0.9, 0.1]), (-0.2, [0.3, 0.3])] {
            let mut steering = steering();
            let first = (steering.view, steering.ahead, steering.distance);
            (0..200).for_each(|_| steering.zoom(at, by, sky(at)));
            assert_ne!(steering.view.location, first.0.location);
            assert_eq!((steering.ahead, steering.view.up), (first.1, first.0.up));
            // Pages add up what they have not sent yet.
            (0..100).for_each(|_| steering.zoom(at, -(by + by), sky(at)));
            assert_eq!((steering.view, steering.ahead, steering.distance), first);
        }
    }

    #[test]
    fn close_to_its_look_at_point_the_camera_keeps_its_direction() {
        let mut steering = steering();
        let (ahead, at) = (steering.ahead, [0.4, 0.6]);
        for _ in 0..100 {
            (0..5).for_each(|_| steering.zoom(at, 1.0, sky(at)));
            steering.walk([0.3, -0.2, 0.7], 1e-3);
            let View { location, look, .. } = steering.view;
            assert_eq!(steering.ahead, ahead);
            assert!((look - location).normalize().distance(ahead) < LEAST_REACH);
        }
    }

    /// A camera before a floor at a height, seen as by rays of single precision: at any angle, and far from the origin.
    #[test]
    fn no_notch_leads_through_a_surface() {
        for (height, drop) in [(0.1, 1.0), (0.1, 0.01), (-1000.7, 0.3), (3e5, 1.0)] {
            let location = DVec3::new(height + 0.3, height + drop, height - 0.7);
            let look = DVec3::new(height + 1.0, height, height);
            let mut steering = Steering::new(View { location, look, ..steering().view });
            let floor = height as f32;
            let see = |steering: &Steering| {
                let from = steering.view.location;
                let towards = (steering.point([0.5, 0.5]) - from).normalize();
                let (origin, direction) = (from.as_vec3(), towards.as_vec3());
                let t = ((f64::from(floor) - f64::from(origin.y)) / f64::from(direction.y)) as f32;
                Seen { point: from + towards * f64::from(t), is_met: t > 0.0 }
            };
            let mut nearest = drop;
            for _ in 0..3000 {
                steering.zoom([0.5, 0.5], 0.7, see);
                // Some other movement, after which notches count anew.
                steering.walk([0.0; 3], 1.0);
                let above = steering.view.location.y;
                assert!(
                    above > f64::from(floor) && above as f32 > floor,
                    "{height} {drop}: {above}"
                );
                nearest = above - f64::from(floor);
            }
            assert!(nearest < 0.1 * drop || nearest < 1e-6 * height.abs(), "{nearest}");
        }
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
