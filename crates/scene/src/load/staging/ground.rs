//! The ground that receives shadows in files without lights.
//!
//! Its colour is such that it matches the background wherever it is not in shadow, so that it has
//! no visible edge, like a photographer's paper. So it need not be larger than the shadows, and few
//! shadow rays start from it.

use glam::{DAffine3, DVec2, DVec3, Vec3};
use hecs::{EntityBuilder, World};

use wavecrest_core::math::float::MAX_COORDINATE;

use super::Sphere;
use super::light::Subject;
use crate::components::{
    DirectionalLight, JsonPath, Material, Mesh, Name, Order, Shading, Sides, Transform,
};
use crate::mesh::MeshData;

/// Its place in messages, which no file has.
pub(crate) const GROUND: &str = "the ground";

/// Its distance below the object, in radii: less than is visible, and more than rounding, so that a
/// floor of the file lies above it.
const GAP: f64 = 1.0 / 4096.0;

/// The ground of an object this many times its size away from the origin has the object's centre as
/// its origin: farther out, single-precision rounding reaches a thousandth of the gap.
const FAR: f64 = 4.0;

/// Number of directions that represent the edge of a lamp.
const SIDES: u32 = 8;

/// The box around everything, to the right, up, and back.
type Bounds = (DVec3, DVec3);

/// Adds the ground below a `subject` with these axes to the `world`. It matches the background
/// `colors.0` under the lamps and a sky that sends it `colors.1`. There is none if the camera would
/// be below it, or too much of it too far out.
pub(super) fn spawn(
    world: &mut World,
    subject: &Subject<'_>,
    axes: &[DVec3; 3],
    lamps: &[DirectionalLight],
    colors: (DVec3, DVec3),
) {
    let [right, up, back] = *axes;
    let Some((low, high)) = bounds(subject, axes) else { return };
    let height = low.y - GAP * subject.bounds.radius;
    let keys = subject.path.iter().flat_map(|path| path.keys.iter().map(|key| key.location));
    if keys.chain([subject.view.location]).any(|location| location.dot(up) <= height) {
        return;
    }
    let Sphere { center, radius } = *subject.bounds;
    // Far from the origin single precision would round the gap away.
    let is_far = center.abs().max_element() > FAR * radius;
    let origin = if is_far { center } else { DVec3::ZERO };
    let corners: Vec<Vec3> = hull(shadows(lamps, axes, &(low, high), height))
        .into_iter()
        .map(|at| (right * at.x + up * height + back * at.y - origin).as_vec3())
        .collect();
    let is_within = |p: &Vec3| p.abs().max_element() < MAX_COORDINATE;
    if corners.len() < 3 || !corners.iter().all(is_within) {
        return;
    }
    let arriving: DVec3 = lamps.iter().map(|lamp| lamp.color * mean_cosine(lamp, up)).sum();
    let material = Material {
        ks: 0.0,
        kd: 1.0,
        specular_exponent: 1.0,
        diffuse_color: colors.0 / (arriving + colors.1),
        emission: DVec3::ZERO,
        specular_color: DVec3::ONE,
        kr: 0.0,
    };
    let triangles = (1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]).collect();
    let data = MeshData { positions: corners, triangles, ..MeshData::default() };
    // Behind all shapes of the file.
    let place = (Order(u32::MAX), JsonPath(GROUND.into()), Name("ground".into()));
    let mesh = Mesh { data, ..Mesh::default() };
    let mut ground = EntityBuilder::new();
    ground.add_bundle(place).add_bundle((material, mesh, Sides::Front, Shading::Flat));
    if is_far {
        ground.add(Transform(DAffine3::from_translation(origin)));
    }
    world.spawn(ground.build());
}

/// The box around all points along the axes; `None` without points.
fn bounds(subject: &Subject<'_>, [right, up, back]: &[DVec3; 3]) -> Option<Bounds> {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let merge = |a: Bounds, b: Bounds| (a.0.min(b.0), a.1.max(b.1));
    let boxes = subject.all.iter().map(|placed| {
        let along = |p: DVec3| {
            let at = DVec3::new(p.dot(*right), p.dot(*up), p.dot(*back));
            (at, at)
        };
        placed.reduce(none, along, merge)
    });
    let (low, high) = boxes.fold(none, merge);
    (low.is_finite() && high.is_finite()).then_some((low, high))
}

/// Points around all shadows that a box casts on the plane at this height, to the right and back.
fn shadows(
    lamps: &[DirectionalLight],
    axes: &[DVec3; 3],
    (low, high): &Bounds,
    height: f64,
) -> Vec<DVec2> {
    let slopes: Vec<DVec2> = lamps.iter().flat_map(|lamp| slopes(lamp, axes)).collect();
    let side = |i: u32, axis: u32| if i >> axis & 1 == 1 { high } else { low };
    let corners = (0..8).map(|i| DVec3::new(side(i, 0).x, side(i, 1).y, side(i, 2).z));
    corners
        .flat_map(|corner| {
            let (foot, above) = (DVec2::new(corner.x, corner.z), corner.y - height);
            slopes.iter().map(move |slope| foot + *slope * above).chain([foot])
        })
        .collect()
}

/// The horizontal displacement of a lamp's light, to the right and back, while it falls by 1: along
/// the sides of a cone around it.
fn slopes(lamp: &DirectionalLight, [right, up, back]: &[DVec3; 3]) -> impl Iterator<Item = DVec2> {
    let axis = lamp.direction.normalize();
    let across = axis.any_orthonormal_vector();
    let (half, step) =
        ((lamp.angle_degrees / 2.0).to_radians(), std::f64::consts::TAU / f64::from(SIDES));
    // A polygon about the circle.
    let radius = libm::tan(half) / libm::cos(step / 2.0);
    let [along_right, along_up, along_back] = [*right, *up, *back];
    (0..SIDES).map(move |i| {
        let (sin, cos) = libm::sincos(f64::from(i) * step);
        let ray = axis + (across * cos + axis.cross(across) * sin) * radius;
        DVec2::new(ray.dot(along_right), ray.dot(along_back)) / -ray.dot(along_up)
    })
}

/// The corners of the convex hull, in the winding of a face that looks up (Andrew, *Another
/// Efficient Algorithm for Convex Hulls in Two Dimensions*, 1979).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
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
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let found = shadows(&[lamp], &axes, &(DVec3::ZERO, DVec3::ONE), 0.0);
        let most = found.iter().map(|p| p.x).fold(0.0, f64::max);
        // The lower edge of the lamp, from the top of the box.
        let edge = 1.0 + (libm::atan(0.75) + 5_f64.to_radians()).tan();
        assert!(most >= edge && most < edge * 1.1, "{most}, {edge}");
        let arriving = mean_cosine(&lamp, DVec3::Y);
        assert!((arriving - 0.8).abs() < 2e-3 && arriving < 0.8, "{arriving}");
    }
}
