//! A moving camera: keys at frames, and the interpolation between them.

use std::ops::RangeInclusive;

use glam::DVec3;

use super::{Camera, Placement};

/// Sine of the angle between the view and `up` below which they count as parallel. The right vector is their cross
/// product: at this angle, rounding in double precision turns it by less than 1e-9 radians.
const PARALLEL: f64 = 1e-6;

wavecrest_base::choices! {
    /// How the camera moves from key to key.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Interpolation {
        // Tangents are the mean of what goes before and of what comes after, for keys at any distance.
        /// Without a bend at a key: cubic curves (Catmull and Rom 1974).
        #[default]
        Smooth = "smooth",
        /// Straight from key to key.
        Linear = "linear",
    }
}

/// The camera at a frame.
#[derive(Clone, Copy, Debug)]
pub struct Keyframe {
    /// The frame.
    pub frame: u32,
    /// Position and view.
    pub placement: Placement,
    /// Distance of the plane in focus, for a lens.
    pub focal: f32,
}

/// The path of a camera.
#[derive(Clone, Debug)]
pub struct Path {
    keys: Vec<Keyframe>,
    interpolation: Interpolation,
    camera: Camera,
}

impl Path {
    /// The path of a `camera` through `keys`, at least one, in the order of their frames.
    pub fn new(keys: Vec<Keyframe>, interpolation: Interpolation, camera: Camera) -> Self {
        Self { keys, interpolation, camera }
    }

    /// The frames from the first key to the last. Before and after, the camera stands still.
    pub fn frames(&self) -> RangeInclusive<u32> {
        let frame = |key: Option<&Keyframe>| key.map_or(0, |key| key.frame);
        frame(self.keys.first())..=frame(self.keys.last())
    }

    /// The camera at `frame`; `None` if its position would coincide with its look-at point.
    pub fn at(&self, frame: u32) -> Option<Camera> {
        let after = self.keys.partition_point(|key| key.frame <= frame);
        let (a, b) = (after.saturating_sub(1), after.min(self.keys.len().saturating_sub(1)));
        let (first, second) = (self.keys.get(a)?, self.keys.get(b)?);
        let length = f64::from(second.frame) - f64::from(first.frame);
        let passed = f64::from(frame) - f64::from(first.frame);
        let part = if length > 0.0 { passed / length } else { 0.0 };
        let point = |of: &dyn Fn(&Keyframe) -> DVec3| self.point(a, b, part, of);
        let between = |a: f64, b: f64| a + (b - a) * part;
        let location = point(&|key| key.placement.location);
        let look = point(&|key| key.placement.look);
        let forward = (look - location).try_normalize()?;
        let [from, to] = [first, second].map(|key| key.placement.up);
        let placement = Placement {
            location,
            look,
            up: across(from + (to - from) * part, forward),
            fov_degrees: between(first.placement.fov_degrees, second.placement.fov_degrees),
            ..first.placement
        };
        let focal = between(first.focal.into(), second.focal.into()) as f32;
        let mut camera = self.camera.placed(&placement);
        camera.lens.iter_mut().for_each(|lens| lens.focal = focal);
        Some(camera)
    }

    fn point(&self, a: usize, b: usize, part: f64, of: &dyn Fn(&Keyframe) -> DVec3) -> DVec3 {
        let (from, to) = (of(&self.keys[a]), of(&self.keys[b]));
        if a == b || self.interpolation == Interpolation::Linear {
            return from + (to - from) * part;
        }
        let length = f64::from(self.keys[b].frame) - f64::from(self.keys[a].frame);
        let [out, into] = [a, b].map(|key| self.tangent(key, of) * length);
        // Hermite's cubic.
        let (s, t) = (part * part, part * part * part);
        from * (2.0 * t - 3.0 * s + 1.0)
            + out * (t - 2.0 * s + part)
            + to * (3.0 * s - 2.0 * t)
            + into * (t - s)
    }

    /// The movement of a point per frame at the key.
    fn tangent(&self, key: usize, of: &dyn Fn(&Keyframe) -> DVec3) -> DVec3 {
        let speed = |a: usize, b: usize| {
            let frames = f64::from(self.keys[b].frame) - f64::from(self.keys[a].frame);
            (of(&self.keys[b]) - of(&self.keys[a])) / frames
        };
        let last = self.keys.len() - 1;
        match key {
            0 => speed(0, 1),
            _ if key == last => speed(last - 1, last),
            _ => (speed(key - 1, key) + speed(key, key + 1)) / 2.0,
        }
    }
}

/// `up`, or the axis least aligned with the unit vector `forward` if the two are parallel.
fn across(up: DVec3, forward: DVec3) -> DVec3 {
    match up.try_normalize() {
        Some(unit) if unit.cross(forward).length() >= PARALLEL => up,
        _ => least_aligned_axis(forward),
    }
}

/// The axis at the greatest angle to `v`; the first of equals.
pub fn least_aligned_axis(v: DVec3) -> DVec3 {
    let v = v.abs();
    if v.x <= v.y && v.x <= v.z {
        DVec3::X
    } else if v.y <= v.z {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::camera::FovAxis;
    use crate::math::sampling::Sampling;

    fn path(points: &[(u32, [f64; 3])], interpolation: Interpolation) -> Path {
        let key = |&(frame, at): &(u32, [f64; 3])| Keyframe {
            frame,
            placement: Placement {
                location: at.into(),
                look: DVec3::from(at) - DVec3::Z,
                up: DVec3::Y,
                fov_degrees: 40.0 + f64::from(frame),
                fov_axis: FovAxis::X,
                size: [4, 2],
            },
            focal: 1.0,
        };
        let keys: Vec<Keyframe> = points.iter().map(key).collect();
        let camera = Camera::new(&keys[0].placement, 1, Sampling::Jittered, None);
        Path::new(keys, interpolation, camera)
    }

    #[test]
    fn keys_are_met_and_straight_lines_are_kept() {
        let points = [(0, [0.0, 0.0, 9.0]), (10, [1.0, 2.0, 9.0]), (30, [3.0, 6.0, 9.0])];
        for interpolation in [Interpolation::Smooth, Interpolation::Linear] {
            let path = path(&points, interpolation);
            assert_eq!(path.frames(), 0..=30);
            for frame in 0..=40 {
                let t = f64::from(frame.min(30)) / 10.0;
                let origin = path.at(frame).unwrap().origin.as_dvec3();
                assert!(
                    (origin - DVec3::new(t, 2.0 * t, 9.0)).length() < 1e-6,
                    "{frame}: {origin}"
                );
            }
        }
    }

    #[test]
    fn a_smooth_path_has_no_bend_at_a_key() {
        let points = [(0, [0.0, 0.0, 9.0]), (100, [1.0, 2.0, 9.0]), (150, [3.0, 1.0, 9.0])];
        let path = path(&points, Interpolation::Smooth);
        let at = |frame| path.at(frame).unwrap().origin.as_dvec3();
        let (before, after) = (at(100) - at(99), at(101) - at(100));
        assert!((before - after).length() < 0.1 * before.length(), "{before} {after}");
        assert!((at(100) - DVec3::new(1.0, 2.0, 9.0)).length() < 1e-6);
    }

    #[test]
    fn a_camera_that_stands_where_it_looks_is_none() {
        let mut path = path(&[(0, [0.0, 0.0, 1.0]), (2, [0.0, 0.0, -1.0])], Interpolation::Linear);
        path.keys[0].placement.look = DVec3::ZERO;
        path.keys[1].placement.look = DVec3::ZERO;
        assert!(path.at(0).is_some() && path.at(1).is_none() && path.at(2).is_some());
    }
}
