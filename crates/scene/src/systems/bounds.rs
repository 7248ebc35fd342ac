//! Bounds of a scene.

use glam::{DVec3, Vec3};

use wavecrest_base::parallel;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::prepared::PreparedScene;

/// The lowest and the highest coordinates in a box.
pub(crate) type Ends = [DVec3; 2];

/// Those of the empty box.
pub(crate) const EMPTY: Ends = [DVec3::INFINITY, DVec3::NEG_INFINITY];

/// The box around two boxes.
pub(crate) fn joined([low, high]: Ends, [other_low, other_high]: Ends) -> Ends {
    [low.min(other_low), high.max(other_high)]
}

/// The corners of a box: the one with number i is at the high end of each axis whose bit is set in i.
pub(crate) fn corners([low, high]: Ends) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let is_high = |axis: usize| i >> axis & 1 == 1;
        DVec3::select([is_high(0), is_high(1), is_high(2)].into(), high, low)
    })
}

/// The smallest box around points; [`Aabb::EMPTY`] without points.
pub(crate) fn around(points: &[Vec3]) -> Aabb {
    let point = |i: usize| Aabb { low: points[i], high: points[i] };
    parallel::reduce(points.len(), Aabb::EMPTY, point, Aabb::union)
}

/// The lowest and the highest coordinates of all primitives, in their space; for an instance, those
/// of the box around it. `None` without primitives.
pub fn of(geometry: &Geometry) -> Option<[DVec3; 2]> {
    let own = (!geometry.positions.is_empty()).then(|| wide(around(&geometry.positions)));
    with_others(geometry, own)
}

/// As [`of`], of what a file has: without the ground that is added to files without lights.
pub fn of_file(scene: &PreparedScene) -> Option<[DVec3; 2]> {
    let (geometry, appearance) = (scene.accel.geometry(), &scene.appearance);
    let Some(ground) = appearance.ground else { return of(geometry) };
    let ground = &appearance.shapes[ground].primitives;
    let of = |number: usize| match ground.contains(&(number as u32)) {
        true => Aabb::EMPTY,
        false => geometry.bounds(number as u32),
    };
    let meshes = geometry.own() - geometry.quadrics.len();
    let own = parallel::reduce(meshes, Aabb::EMPTY, of, Aabb::union);
    with_others(geometry, (own.low.x <= own.high.x).then(|| wide(own)))
}

/// A box in double precision.
pub(crate) fn wide(bounds: Aabb) -> Ends {
    [bounds.low.as_dvec3(), bounds.high.as_dvec3()]
}

/// The box of its own triangles and quads, with its spheres and disks, and its instances.
fn with_others(geometry: &Geometry, own: Option<Ends>) -> Option<Ends> {
    let quadrics = geometry.quadrics.iter().map(|quadric| {
        let (center, half) = quadric.extent();
        [center - half, center + half]
    });
    let prototypes: Vec<Ends> =
        geometry.prototypes.iter().map(|prototype| wide(around(&prototype.positions))).collect();
    let instances = geometry.instances.iter().map(|instance| {
        let ([low, high], to_world) = (prototypes[instance.prototype()], instance.to_world());
        let (middle, half) = (to_world.transform_point3((low + high) / 2.0), (high - low) / 2.0);
        let axes = to_world.matrix3;
        let half =
            axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        [middle - half, middle + half]
    });
    own.into_iter().chain(quadrics).chain(instances).reduce(joined)
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use wavecrest_core::geometry::Quadric;
    use wavecrest_core::geometry::instance::Instance;

    use super::*;

    #[test]
    fn all_kinds_of_shapes_count_and_instances_where_they_are_shown() {
        assert_eq!(of(&Geometry::default()), None);
        let positions = vec![Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)];
        let bounds = around(&positions);
        let prototype = Geometry { positions: positions.clone().into(), ..Geometry::default() };
        let turned = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let moved = DAffine3::from_translation(DVec3::new(10.0, 0.0, 0.0)) * turned;
        let geometry = Geometry {
            positions: positions.into(),
            quadrics: vec![Quadric::Sphere(Vec3::new(0.0, 0.0, -5.0), 2.0)],
            prototypes: vec![prototype],
            instances: vec![Instance::new(0, 1, moved, &bounds)],
            ..Geometry::default()
        };
        let [low, high] = of(&geometry).unwrap();
        assert!((low - DVec3::new(-2.0, -2.0, -7.0)).length() < 1e-9, "{low}");
        assert!((high - DVec3::new(10.0, 2.0, 3.0)).length() < 1e-9, "{high}");
    }
}
