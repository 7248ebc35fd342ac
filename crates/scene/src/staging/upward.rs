//! Guesses the up axis of a mesh, if neither its format nor its user states it.
//!
//! Scans, printed parts and models have y or z up, and seldom lie or stand on their heads. Four features
//! count as evidence against the usual axis of a format. The mesh would stand in another direction, and
//! would fall over along the usual one. Or it is its own mirror image along the usual axis alone, and
//! would fall over along it, as a fish or an aeroplane: left and right may be alike, top and bottom
//! hardly ever are. Or it is a wide, thin surface of one layer that faces along the other axis, as
//! terrain does; or wide and low with a ground below it, a sheet that faces up, as a courtyard has.
//!
//! A mesh stands if its centre is above its support polygon, the convex hull of its lowest points: so
//! a chair stands on its legs. Of all directions in which it stands, the one with the largest polygon
//! is up. What is wide, low and above its ground nearly everywhere does not fall over, even if a well
//! is below the ground.

use super::Scenery;
use super::grid::Grid;
use super::pose::{BASE_DEPTH, Heights, Pose, RAISED, SYMMETRIC};
use crate::options::framing::Up;

/// The up axis of a file unless the user states one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Upward {
    /// That of the format.
    Stated(Up),
    /// That of most files of a format that states none, unless the shape suggests another.
    Guessed(Up),
}

/// Smallest share of the bounding rectangle that a support polygon covers along the other of y and z:
/// the feet of a figure with its arms spread out cover no more,
const STANDS: f64 = 0.15;
/// and in directions that are rarely up.
const SURELY: f64 = 0.2;
/// These directions.
const RARE: [Up; 4] = [Up::X, Up::NegativeX, Up::NegativeY, Up::NegativeZ];
/// Smallest difference between a mesh and its mirror image in the direction that is up, as a share of
/// that along the usual axis: a statue is not laid on its side.
const AS_ODD: f64 = 1.0 / 3.0;
/// The difference from which on the bottom and the top are taken for such without a support.
const ASYMMETRIC: f64 = 0.2;
/// Smallest height of what is set up without a support, as a share of its height so far: masks and
/// shields are not laid down.
const LOWER: f64 = 0.7;
/// Largest height of what is set up for its two sides, as a share of its shorter side: swords lie.
const TALLEST: f64 = 5.0;
/// Largest height of what is on a ground, as a share of its shorter side.
const WIDE: f64 = 0.5;

/// The up axis; and the reason if it is not the `usual` one, y or z.
pub(super) fn guess(contents: &Scenery<'_>, grid: &Grid, usual: Up) -> (Up, Option<&'static str>) {
    let size = contents.ends[1] - contents.ends[0];
    let other = if usual == Up::Z { Up::Y } else { Up::Z };
    let heights = Heights::of(contents);
    let pose = |up| Pose::new(up, grid, &heights, size);
    let [own, other] = [usual, other].map(pose);
    if other.is_field() && !own.is_field() {
        return (other.up, Some("the mesh is wide and low, as terrain is"));
    }
    let is_long = other.height() > TALLEST;
    let lies = own.is_flat() && (is_long || own.asymmetry() >= ASYMMETRIC);
    // What is flat is a figure.
    if lies || own.rests() {
        return (usual, None);
    }
    let stands = |pose: &Pose<'_>| {
        let least = if pose.up == other.up { STANDS } else { SURELY };
        let is_on_base = pose.support(BASE_DEPTH) >= least || pose.steps(&own, least);
        let is_odd = pose.differs() && pose.asymmetry() >= own.asymmetry() * AS_ODD;
        own.falls() && is_on_base && is_odd && pose.is_closed()
    };
    // A mushroom does not stand on its head, nor a bowl on its rim: neither tips over.
    let tips = own.support(BASE_DEPTH) == 0.0;
    let may_be = |pose: &Pose<'_>| other.falls() && (tips || pose.axis != own.axis);
    let all = RARE.map(pose).into_iter().filter(may_be).chain([pose(other.up)]).filter(stands);
    let support = |pose: &Pose<'_>| pose.support(RAISED);
    if let Some(best) = all.max_by(|a, b| support(a).total_cmp(&support(b))) {
        return (best.up, Some("the mesh stands along it, and would fall over along the other"));
    }
    if !other.differs() {
        return (usual, None);
    }
    if other.height() <= WIDE && other.has_ground() && other.support(RAISED) >= STANDS {
        return (other.up, Some("the mesh is wide and low, with a ground below it"));
    }
    let is_symmetric = own.asymmetry() < SYMMETRIC && !is_long;
    let is_set_up = other.is_closed()
        && other.asymmetry() >= ASYMMETRIC
        && size[other.axis] >= LOWER * size[own.axis];
    if is_symmetric && is_set_up && own.falls() {
        return (other.up, Some("the mesh is its own mirror image along the other"));
    }
    (usual, None)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Solid, boxes, contents};
    use super::*;
    use glam::Vec3;

    /// What is taken for up where another axis is `usual` in files of the format.
    fn guessed(mesh: &Solid, usual: Up) -> Up {
        let contents = contents(mesh);
        let (up, why) = guess(&contents, &Grid::of(&contents).unwrap(), usual);
        assert_eq!(why.is_some(), up != usual, "what is not usual has a reason");
        up
    }

    /// The points as in a file with another axis up than z.
    fn upright((points, triangles): Solid, up: Up) -> Solid {
        let turn = (up.axes() * Up::Z.axes().transpose()).as_mat3();
        (points.iter().map(|p| turn * *p).collect(), triangles)
    }

    fn turned(mesh: Solid) -> Solid {
        upright(mesh, Up::Y)
    }

    /// A pyramid whose base is a square perpendicular to z; the first two triangles are its base.
    fn pyramid() -> Solid {
        let base = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let points = base.map(|(x, y)| Vec3::new(x, y, 0.0)).into_iter().chain([Vec3::Z * 3.0]);
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        (points.collect(), triangles.to_vec())
    }

    /// A body of 3 by 1 on four legs, with a head at one end and a tail at the other; upright along z.
    fn horse() -> Solid {
        let leg = |x: f32, y: f32| ([x, y, 0.0], [x + 0.2, y + 0.2, 1.0]);
        let legs = [leg(0.3, 0.0), leg(2.4, 0.0), leg(0.3, 0.5), leg(2.4, 0.5)];
        // The stirrups keep it from lying on its flank.
        let stirrups = ([1.2, -0.1, 1.0], [1.4, 0.8, 1.2]);
        let body = ([0.0, 0.0, 1.0], [3.0, 0.7, 1.8]);
        let tail = ([-0.5, 0.3, 1.5], [0.0, 0.4, 1.7]);
        let rest = [body, ([2.8, 0.2, 1.5], [3.6, 0.5, 2.4]), stirrups, tail];
        boxes(&[&legs[..], &rest].concat())
    }

    /// A horse whose body is along y, with a hoof of each pair in the air.
    fn stepping_horse() -> Solid {
        let mut mesh = horse();
        mesh.0.iter_mut().take(16).filter(|p| p.z == 0.0).for_each(|p| p.z = 0.2);
        mesh.0.iter_mut().for_each(|p| *p = Vec3::new(-p.y, p.x, p.z));
        mesh
    }

    /// The ground and the walls of a courtyard of 6 by 10; upright along z.
    fn courtyard() -> Solid {
        let mut mesh = boxes(&[
            ([0.0; 3], [6.0, 10.0, 0.0]),
            ([0.0; 3], [0.5, 10.0, 2.0]),
            ([5.5, 0.0, 0.0], [6.0, 10.0, 2.0]),
            ([0.5, 0.0, 0.0], [5.5, 0.5, 2.0]),
            ([0.5, 9.5, 0.0], [5.5, 10.0, 2.0]),
        ]);
        // The upper side of the ground alone.
        mesh.1.drain(..10);
        mesh
    }

    /// A courtyard of which neither the ground nor the walls are even.
    fn scanned_courtyard() -> Solid {
        let mut mesh = courtyard();
        mesh.0.iter_mut().take(2).for_each(|p| p.z = 0.3);
        mesh.0.iter_mut().skip(32).for_each(|p| p.z *= 0.5);
        mesh
    }

    /// A courtyard in which a well goes down below the ground.
    fn well() -> Solid {
        let (mut points, mut triangles) = courtyard();
        let well = boxes(&[([2.0, 4.0, -1.0], [3.0, 5.0, 0.5])]);
        triangles.extend(well.1.iter().map(|triangle| triangle.map(|i| i + points.len() as u32)));
        points.extend(well.0);
        (points, triangles)
    }

    /// A cupboard without doors: the walls of a courtyard, and a back that is seen from behind.
    fn cupboard() -> Solid {
        let mut mesh = courtyard();
        mesh.1.iter_mut().take(2).for_each(|triangle| triangle.swap(1, 2));
        mesh
    }

    /// A room with an open front; upright along y.
    fn room() -> Solid {
        let mut mesh = boxes(&[([0.0; 3], [4.0, 3.0, 4.0]), ([1.0, 0.0, 1.0], [2.0, 1.0, 2.0])]);
        mesh.1.drain(10..12);
        mesh.1.iter_mut().take(10).for_each(|triangle| triangle.swap(1, 2));
        mesh
    }

    /// A body, a head at one end of it and a tail at the other, seen from its left; upright along z.
    fn bird() -> Solid {
        boxes(&[
            ([0.0, 0.4, 0.5], [2.0, 1.1, 1.2]),
            ([1.8, 0.6, 1.0], [2.4, 0.9, 1.6]),
            ([0.7, 0.0, 1.1], [1.2, 1.5, 1.2]),
        ])
    }

    /// A seat on four legs, with a back; upright along z, seen from -y.
    fn chair() -> Solid {
        let leg = |x: f32, y: f32| ([x, y, 0.0], [x + 0.1, y + 0.1, 0.5]);
        let seat = ([0.0, 0.0, 0.5], [1.0, 1.0, 0.6]);
        let back = ([0.0, 0.9, 0.6], [1.0, 1.0, 1.5]);
        boxes(&[leg(0.0, 0.0), leg(0.9, 0.0), leg(0.0, 0.9), leg(0.9, 0.9), seat, back])
    }

    /// A sheet with hills; upright along z.
    fn terrain() -> Solid {
        let height = |x: i32, y: i32| (x * 7 + y * 3).rem_euclid(5) as f32 / 5.0;
        let points = (0..100).map(|i| (i % 10, i / 10));
        let points = points.map(|(x, y)| Vec3::new(x as f32, y as f32, height(x, y)));
        let corners = (0..81u32).map(|i| i / 9 * 10 + i % 9);
        let triangles = corners.flat_map(|i| [[i, i + 1, i + 11], [i, i + 11, i + 10]]);
        (points.collect(), triangles.collect())
    }

    #[test]
    fn things_stand_as_they_would() {
        let bare = |(points, triangles): Solid| (points, triangles[2..].to_vec());
        for (what, mesh, where_y_is_usual, where_z_is_usual) in [
            ("a pyramid stands on its base", pyramid(), Up::Z, Up::Z),
            ("and so it does where y is up", turned(pyramid()), Up::Y, Up::Y),
            ("without its base it could lie on its rim", bare(turned(pyramid())), Up::Y, Up::Z),
            ("a horse stands on its legs", horse(), Up::Z, Up::Z),
            ("and is never laid down", turned(horse()), Up::Y, Up::Y),
            ("a horse that steps stands too", stepping_horse(), Up::Z, Up::Z),
            ("a courtyard lies on its ground", courtyard(), Up::Z, Up::Z),
            ("and so it does where y is up", turned(courtyard()), Up::Y, Up::Y),
            ("a scan of a courtyard likewise", scanned_courtyard(), Up::Z, Up::Z),
            ("and where y is up", turned(scanned_courtyard()), Up::Y, Up::Y),
            ("a well is no foot to fall over on", turned(well()), Up::Y, Up::Z),
            ("a cupboard stands on its base", cupboard(), Up::Y, Up::Z),
            ("a room is not laid on its back", room(), Up::Y, Up::Z),
            ("a bird in flight is upright by its sides", bird(), Up::Z, Up::Z),
            ("a chair stands on its legs", chair(), Up::Z, Up::Z),
            ("but upright along y it could lie on its back", turned(chair()), Up::Y, Up::Z),
            ("terrain lies on its back", terrain(), Up::Z, Up::Z),
            ("a cube is left as it is", boxes(&[([0.0; 3], [1.0; 3])]), Up::Y, Up::Z),
        ] {
            let found = [Up::Y, Up::Z].map(|usual| guessed(&mesh, usual));
            assert_eq!(found, [where_y_is_usual, where_z_is_usual], "{what}");
        }
        for up in [Up::X, Up::Y, Up::Z, Up::NegativeX, Up::NegativeY, Up::NegativeZ] {
            for mesh in [horse(), stepping_horse()] {
                let mesh = upright(mesh, up);
                assert_eq!([Up::Y, Up::Z].map(|usual| guessed(&mesh, usual)), [up; 2], "a horse");
            }
        }
    }
}
