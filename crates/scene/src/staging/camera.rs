//! The camera of files without one, and the size of the image.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use hecs::{EntityBuilder, World};

use wavecrest_base::error::Result;
use wavecrest_core::kernels::camera::half_extent;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::math::sampling::Sampling;

use super::fit::{self, NEAREST, PARALLEL};
use super::grid::Grid;
use super::pose::FLAT;
use super::room::{self, Room};
use super::upward::{self, Upward};
use super::{BoundingSphere, Scenery};
use crate::camera;
use crate::components::{CameraPath, FovAxis, Interpolation, View};
use crate::options::LoadOptions;
use crate::options::framing::{Fov, Framing, Side, Up, toward};

/// Default width of the image in pixels; the height for upright images.
const LONGER_SIDE: u32 = 1024;
/// The default width divided by the height.
const ASPECT: f64 = 4.0 / 3.0;
/// Rays along each side of a pixel.
const ANTIALIAS: u32 = 2;
/// Default full angle of view, in degrees.
const FOV_DEGREES: f64 = 40.0;
/// The same inside a room.
const ROOM_FOV_DEGREES: f64 = 60.0;
/// Objects this many times as long as wide are seen from the side.
const LONG: f64 = 1.25;
/// Direction of the default camera from the centre: in front, above and slightly to the right.
const CAMERA_SIDE: DVec3 = DVec3::new(0.5, 0.4, 1.0);
/// The same for what lies flat, as a courtyard: over its walls.
const OVERHEAD: DVec3 = DVec3::new(0.5, 0.8, 1.0);

/// A view without a position yet, of the size requested; otherwise with this `aspect`, width by height, or 4
/// by 3.
///
/// # Errors
/// If the requested size is too large or zero.
pub(crate) fn view(options: &LoadOptions, aspect: Option<f64>) -> Result<View> {
    let (aspect, longer) = (aspect.unwrap_or(ASPECT), f64::from(LONGER_SIDE));
    let own = [longer * aspect.min(1.0), longer / aspect.max(1.0)];
    let (width, height) = camera::in_proportion(options, own);
    camera::check_size(width, height)?;
    Ok(View {
        location: DVec3::Z,
        look: DVec3::ZERO,
        up: DVec3::Y,
        fov_degrees: FOV_DEGREES,
        fov_axis: FovAxis::Smaller,
        width,
        height,
        antialias: options.antialias_or(ANTIALIAS),
        sampling: Sampling::Jittered,
    })
}

/// The chosen camera, and a description for the user.
#[derive(Clone, Debug)]
pub(crate) struct Framed {
    pub(crate) view: View,
    /// Its path, if it turns.
    pub(crate) path: Option<CameraPath>,
    /// The up axis, of unit length; not necessarily up in the image.
    pub(crate) up: DVec3,
    /// The corners of a lamp, for rooms seen from inside, which light from outside does not reach.
    pub(crate) lamp: Option<[DVec3; 4]>,
    /// Such as "z is taken for up".
    pub(crate) told: String,
}

impl Framed {
    /// A camera of the file, which has +y up.
    pub(crate) fn own(view: View) -> Self {
        Self { view, path: None, up: DVec3::Y, lamp: None, told: String::new() }
    }

    /// Adds the camera to a `world`.
    pub(crate) fn spawn(self, world: &mut World) {
        let mut camera = EntityBuilder::new();
        camera.add(self.view);
        self.path.map(|path| camera.add(path));
        world.spawn(camera.build());
    }
}

/// A view of all `contents`. `usual` is the up axis unless one is requested.
///
/// # Errors
/// As [`view`].
pub(crate) fn framed(
    contents: &Scenery<'_>,
    usual: Upward,
    options: &LoadOptions,
) -> Result<Framed> {
    let blank = view(options, None)?;
    let framing = &options.framing;
    let from_outside = matches!(framing.side, Some(Side::Around { .. }));
    let needs_grid = !from_outside || (framing.up.is_none() && matches!(usual, Upward::Guessed(_)));
    let grid = if needs_grid { Grid::of(contents) } else { None };
    let (up, told) = upward(contents, grid.as_ref(), framing.up.map_or(usual, Upward::Stated));
    let stage = ToFrame { contents, grid, up, framing };
    let (view, room) = stage.seen_from(framing.side, blank);
    let strays = match contents.strays {
        0 => String::new(),
        count => format!("{count} triangles far from the rest are left out of the view; "),
    };
    let told = told + room.map_or("", Room::told) + &strays;
    let lamp = match room {
        Some(Room::Closed { lamp, .. }) => Some(lamp),
        _ => None,
    };
    let upward = up.axes().y_axis;
    let turned = framing.turntable.map(|frames| stage.turned(&view, frames, lamp.is_some()));
    let view = turned.as_ref().and_then(|views| views.first().copied()).unwrap_or(view);
    let path = turned.map(|views| path(&views));
    Ok(Framed { view, path, up: upward, lamp, told })
}

/// A path with these views as frames, from 1 on: each is a key, so that interpolation does not
/// matter and a scene file can store the path.
fn path(views: &[View]) -> CameraPath {
    let keys = (1..).zip(views).map(|(frame, view)| view.key(frame)).collect();
    CameraPath { keys, interpolation: Interpolation::Linear }
}

/// The up axis, and a description for the user if the shape suggests another than usual.
fn upward(contents: &Scenery<'_>, grid: Option<&Grid>, axis: Upward) -> (Up, String) {
    let (Upward::Stated(up) | Upward::Guessed(up)) = axis;
    let (Upward::Guessed(_), Some(grid)) = (axis, grid) else { return (up, String::new()) };
    let (up, why) = upward::guess(contents, grid, up);
    let told = |why| format!("{} is up, because {why} (change with --up); ", up.name());
    (up, why.map_or_else(String::new, told))
}

/// What to frame, and how.
struct ToFrame<'a> {
    contents: &'a Scenery<'a>,
    grid: Option<Grid>,
    up: Up,
    framing: &'a Framing,
}

impl ToFrame<'_> {
    /// The view from the given or default side, of the size of `view`; and the room, if it is seen
    /// from inside.
    fn seen_from(&self, side: Option<Side>, mut view: View) -> (View, Option<Room>) {
        let (ends, upward) = (&self.contents.ends, self.up.axes().y_axis);
        let room = self.grid.as_ref().and_then(|grid| match side {
            Some(Side::Around { .. }) => None,
            Some(Side::Inside) => Some(room::inside(grid, ends, upward)),
            None => room::find(grid, self.contents, self.up),
        });
        view.up = upward;
        let usual =
            if let Some(Room::Closed { .. }) = room { ROOM_FOV_DEGREES } else { FOV_DEGREES };
        view.fov_degrees = self.framing.fov.map_or(usual, Fov::degrees);
        let back = match (room, side) {
            (Some(Room::Closed { eye, look, .. }), _) => {
                (view.location, view.look) = (eye, look);
                return (view, room);
            }
            (Some(Room::Open(outward)), _) => outward,
            (_, Some(Side::Around { azimuth, elevation })) => {
                let [back, overhead] = toward(azimuth, elevation).map(|v| self.up.axes() * v);
                if view.up.cross(back).length() < PARALLEL {
                    view.up = overhead;
                }
                back
            }
            _ => self.up.axes() * self.usual_side(),
        };
        self.stand_back(&mut view, back);
        (view, room)
    }

    /// The default direction of the camera from the object: an object that is deeper than wide is
    /// seen from the side, a wide and low one from farther above.
    fn usual_side(&self) -> DVec3 {
        let [low, high] = self.contents.ends;
        let size = (self.up.axes().transpose() * (high - low)).abs();
        let is_low = size.y <= FLAT * size.x.min(size.z);
        let side = if is_low { OVERHEAD } else { CAMERA_SIDE };
        let DVec3 { x: side, y: up, z: front } = side.normalize();
        let is_long = size.z > LONG * size.x;
        if is_long { DVec3::new(front, up, side) } else { DVec3::new(side, up, front) }
    }

    /// Moves the camera in the direction `back` until everything fills its share of the image.
    fn stand_back(&self, view: &mut View, back: DVec3) {
        let axes = fit::axes(view.up, back);
        let BoundingSphere { center, radius } = self.contents.sphere;
        let least = radius * NEAREST;
        let position = fit::position(self.contents, &axes, self.tangents(view), least);
        let greatest = DVec3::splat(f64::from(MAX_COORDINATE));
        view.location = position.unwrap_or(center + back).clamp(-greatest, greatest);
        let distance = (view.location - center).dot(back).max(least);
        view.look = view.location - back * distance;
    }

    /// The views of one turn in this number of frames, starting at `view`. Inside a room the camera
    /// turns in place. Outside it keeps its distance and its height: the turning object stays in the
    /// image at any angle.
    fn turned(&self, view: &View, frames: u32, inside: bool) -> Vec<View> {
        let axis = self.up.axes().y_axis;
        let start = match inside {
            true => *view,
            false => fit::around(view, self.contents, self.tangents(view), axis),
        };
        let pivot = if inside { start.location } else { start.look };
        let turned = |frame: u32| {
            let turn = DQuat::from_axis_angle(axis, TAU * f64::from(frame) / f64::from(frames));
            let turned = |point: DVec3| pivot + turn * (point - pivot);
            let (location, look) = (turned(start.location), turned(start.look));
            View { location, look, up: turn * start.up, ..start }
        };
        (0..frames).map(turned).collect()
    }

    /// The tangents of half the angles to fill, horizontally and vertically.
    fn tangents(&self, view: &View) -> [f64; 2] {
        let share = self.framing.fit.unwrap_or_default().share();
        half_extent(&view.placement()).map(|tangent| tangent * share)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{boxes, contents};
    use super::*;

    #[test]
    fn one_side_of_the_image_follows_from_the_other() {
        let asked = |width, height, aspect| {
            let options = LoadOptions { width, height, ..LoadOptions::default() };
            view(&options, aspect).map(|view| (view.width, view.height))
        };
        assert_eq!(asked(None, None, None).unwrap(), (1024, 768));
        assert_eq!(asked(None, None, Some(0.5)).unwrap(), (512, 1024));
        assert_eq!(asked(Some(200), None, Some(2.0)).unwrap(), (200, 100));
        assert_eq!(asked(None, Some(300), None).unwrap(), (400, 300));
        assert_eq!(asked(Some(7), Some(9), Some(2.0)).unwrap(), (7, 9));
        assert_eq!(asked(None, Some(9), Some(1e30)).unwrap(), (65_536, 9));
        assert!(asked(Some(0), None, None).is_err() && asked(Some(70_000), None, None).is_err());
        assert!(asked(Some(65_536), Some(65_536), None).is_err());
    }

    #[test]
    fn what_is_wide_and_low_is_seen_from_farther_above() {
        let elevation = |height| {
            let mesh = boxes(&[([0.0; 3], [10.0, height, 10.0])]);
            let options = LoadOptions::default();
            let view = framed(&contents(&mesh), Upward::Stated(Up::Y), &options).unwrap().view;
            (view.location - view.look).normalize().y.asin().to_degrees()
        };
        assert!((elevation(1.0) - 35.6).abs() < 0.1 && (elevation(10.0) - 19.7).abs() < 0.1);
    }
}
