//! The predicates on corners.

use glam::{DVec3, dvec3};

use crate::corners::{quad_has_area, quad_is_planar, quad_is_simple, triangle_has_area};

/// The unit square in front of the viewer, who looks along -z, in the order of the format.
fn square() -> [DVec3; 4] {
    [dvec3(0.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0), dvec3(1.0, 1.0, 0.0), dvec3(1.0, 0.0, 0.0)]
}

#[test]
fn thin_shapes_have_an_area() {
    let [a, b, _, _] = square();
    assert!(triangle_has_area(&[a, b, dvec3(1e-12, 0.5, 0.0)]));
    assert!(!triangle_has_area(&[a, b, dvec3(0.0, 0.3, 0.0)]));
    // In one line but for the rounding of tenths.
    let tenths = [0.1, 0.2, 0.3].map(|x| dvec3(x, 3.0 * x, 7.0 * x));
    assert!(!triangle_has_area(&tenths));
    assert!(quad_has_area(&square().map(|p| p * dvec3(1e6, 1e-6, 1.0))));
    assert!(quad_has_area(&square().map(|p| p * 1e-30)));
}

#[test]
fn hc34_planarity_is_measured_in_single_precision() {
    let ulp = f64::from(f32::EPSILON);
    let bent = |by: f64| {
        let mut points = square();
        points[2].z = by;
        quad_is_planar(&points)
    };
    assert!(bent(0.0) && bent(60.0 * ulp) && bent(-60.0 * ulp));
    assert!(!bent(140.0 * ulp) && !bent(-140.0 * ulp));
    let far = square().map(|p| p + dvec3(1e6, 0.0, 0.0));
    assert!(quad_is_planar(&far));
}

#[test]
fn edges_that_cross_or_touch() {
    let simple = |corners: [(f64, f64); 4]| {
        // In each of the planes that the axes span.
        let planes: [fn((f64, f64)) -> DVec3; 3] =
            [|(x, y)| dvec3(x, y, 1.0), |(x, y)| dvec3(y, 1.0, x), |(x, y)| dvec3(1.0, x, y)];
        let [a, b, c] = planes.map(|plane| quad_is_simple(&corners.map(plane)));
        assert!(a == b && b == c);
        a
    };
    assert!(simple([(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)]));
    assert!(simple([(0.0, 0.0), (1.0, 3.0), (2.0, 0.0), (1.0, 1.0)]), "an arrowhead");
    assert!(!simple([(0.0, 0.0), (3.0, 1.0), (0.0, 1.0), (1.0, 0.0)]), "a bow tie");
    assert!(!simple([(0.0, 0.0), (0.0, 2.0), (0.0, 1.0), (1.0, 0.0)]), "an edge folded back");
    assert!(!simple([(0.0, 0.0), (0.0, 2.0), (2.0, 1.0), (0.0, 1.0)]), "a corner on an edge");
}
