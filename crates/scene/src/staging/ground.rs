//! The ground that receives shadows in files without lights.
//!
//! Its colour is such that it matches the background wherever it is not in shadow, so that it has
//! no visible edge, like a photographer's paper. So it need not be larger than the shadows, and few
//! shadow rays start from it.

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3, Vec3Swizzles};
use hecs::{EntityBuilder, World};

use wavecrest_core::math::float::MAX_COORDINATE;

use super::camera::Framed;
use super::{BoundingSphere, Scenery};
use crate::components::{
    Added, DirectionalLight, JsonPath, Material, Mesh, Name, Order, Shading, Sides, Transform,
};
use crate::mesh::MeshData;
use crate::systems::bounds::{EMPTY, Ends, corners, joined};

/// Its distance below the object, in radii: less than is visible, and more than rounding, so that a
/// floor of the file lies above it.
const GAP: f64 = 1.0 / 4096.0;

/// The ground of an object this many times its size away from the origin has the object's centre as
/// its origin: farther out, single-precision rounding reaches a thousandth of the gap.
const FAR: f64 = 4.0;

/// Number of directions that represent the edge of a lamp.
const SIDES: u32 = 8;

/// Adds the ground below everything, along these axes to the right, up, and back, to the `world`. It
/// matches the background `colors.0` under the lamps and a sky that sends it `colors.1`. There is
/// none if the camera would be below it, or too much of it too far out. Returns its height along up, unless there is nothing.
pub(super) fn spawn(
    world: &mut World,
    contents: &Scenery<'_>,
    framed: &Framed,
    axes: &DMat3,
    lamps: &[DirectionalLight],
    colors: (DVec3, DVec3),
) -> Option<f64> {
    let (up, into) = (axes.y_axis, axes.transpose());
    let ends = contents.outermost(EMPTY, |point| [into * point; 2], joined);
    let height = ends[0].y - GAP * contents.sphere.radius;
    let keys = framed.path.iter().flat_map(|path| path.keys.iter().map(|key| key.location));
    if !keys.chain([framed.view.location]).all(|location| is_above(height, up, location)) {
        return Some(height);
    }
    let BoundingSphere { center, radius } = contents.sphere;
    // Far from the origin single precision would round the gap away.
    let is_far = center.abs().max_element() > FAR * radius;
    let origin = if is_far { center } else { DVec3::ZERO };
    let point = |at: DVec2| (*axes * DVec3::new(at.x, height, at.y) - origin).as_vec3();
    let corners: Vec<Vec3> =
        hull(shadows(lamps, axes, ends, height)).into_iter().map(point).collect();
    let is_within = |p: &Vec3| p.abs().max_element() < MAX_COORDINATE;
    if corners.len() < 3 || !corners.iter().all(is_within) {
        return Some(height);
    }
    let arriving: DVec3 = lamps.iter().map(|lamp| lamp.color * mean_cosine(lamp, up)).sum();
    let material = Material { diffuse_color: colors.0 / (arriving + colors.1), ..Material::MATTE };
    let triangles = (1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]).collect();
    let data = MeshData { positions: corners.into(), triangles, ..MeshData::default() };
    // Behind all shapes of the file.
    let names = (Order(u32::MAX), JsonPath("the ground".into()), Name("ground".into()));
    let mesh = Mesh { data, ..Mesh::default() };
    let mut ground = EntityBuilder::new();
    ground.add_bundle(names).add_bundle((
        Added::Ground,
        material,
        mesh,
        Sides::Front,
        Shading::Flat,
    ));
    if is_far {
        ground.add(Transform(DAffine3::from_translation(origin)));
    }
    world.spawn(ground.build());
    Some(height)
}

/// Whether a camera is above a ground at this height along `up`.
pub(super) fn is_above(height: f64, up: DVec3, location: DVec3) -> bool {
    location.dot(up) > height
}

/// Points around all shadows that a box casts on the plane at this height, to the right and back.
fn shadows(lamps: &[DirectionalLight], axes: &DMat3, ends: Ends, height: f64) -> Vec<DVec2> {
    let slopes: Vec<DVec2> = lamps.iter().flat_map(|lamp| slopes(lamp, axes)).collect();
    let of = |corner: DVec3| {
        let above = corner.y - height;
        slopes.iter().map(move |slope| corner.xz() + *slope * above).chain([corner.xz()])
    };
    corners(ends).into_iter().flat_map(of).collect()
}

/// The horizontal displacement of a lamp's light, to the right and back, while it falls by 1: along
/// the sides of a cone around it.
fn slopes(lamp: &DirectionalLight, axes: &DMat3) -> impl Iterator<Item = DVec2> {
    let axis = lamp.direction.normalize();
    let across = axis.any_orthonormal_vector();
    let step = std::f64::consts::TAU / f64::from(SIDES);
    // A polygon about the circle.
    let radius = libm::tan((lamp.angle_degrees / 2.0).to_radians()) / libm::cos(step / 2.0);
    let into = axes.transpose();
    (0..SIDES).map(move |i| {
        let (sin, cos) = libm::sincos(f64::from(i) * step);
        let ray = into * (axis + (across * cos + axis.cross(across) * sin) * radius);
        ray.xz() / -ray.y
    })
}

/// The corners of the convex hull, in the winding of a face that looks up (Andrew, *Another
/// Efficient Algorithm for Convex Hulls in Two Dimensions*, 1979).
pub(super) fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) >= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        // The last point is the first of the other half.
        chain.pop();
        chain
    };
    let mut corners = half(&mut points.iter().copied());
    corners.extend(half(&mut points.iter().rev().copied()));
    corners
}

/// The mean of the cosines between a normal and the directions to a lamp, all of which are in front
/// of the surface.
fn mean_cosine(lamp: &DirectionalLight, normal: DVec3) -> f64 {
    let radius = (lamp.angle_degrees / 2.0).to_radians();
    -lamp.direction.normalize().dot(normal) * (1.0 + libm::cos(radius)) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::Sampling;

    #[test]
    fn the_hull_has_the_outer_points_alone_and_looks_up() {
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0], [1.0, 0.0]];
        let corners = hull(points.map(DVec2::from_array).to_vec());
        assert_eq!(corners.len(), 4, "{corners:?}");
        // Back is z: its product with x points down, so the order is clockwise in these two.
        let [a, b, c] = [0, 1, 2].map(|i: usize| DVec3::new(corners[i].x, 0.0, corners[i].y));
        assert!((b - a).cross(c - a).y > 0.0);
        assert!(hull(Vec::new()).is_empty());
    }

    #[test]
    fn all_shadows_fall_within_the_points() {
        let lamp = DirectionalLight {
            intensity: 1.0,
            color: DVec3::ONE,
            direction: DVec3::new(3.0, -4.0, 0.0),
            angle_degrees: 10.0,
            sampling: Sampling::Sobol,
            samples: 1,
        };
        let found = shadows(&[lamp], &DMat3::IDENTITY, [DVec3::ZERO, DVec3::ONE], 0.0);
        let most = found.iter().map(|p| p.x).fold(0.0, f64::max);
        // The lower edge of the lamp, from the top of the box.
        let edge = 1.0 + (libm::atan(0.75) + 5_f64.to_radians()).tan();
        assert!(most >= edge && most < edge * 1.1, "{most}, {edge}");
        let arriving = mean_cosine(&lamp, DVec3::Y);
        assert!((arriving - 0.8).abs() < 2e-3 && arriving < 0.8, "{arriving}");
    }
}
