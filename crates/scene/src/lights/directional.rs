//! Directional lights.

use glam::DVec3;

use super::{MOST_SAMPLES, check_samples, warn_of_strength};
use crate::camera::Sampling;
use crate::format::{Declaration, Kind, Range, component, declared};

pub(super) const KIND: Kind = Kind::entity(
    "directionallight",
    "a directional light",
    "A light infinitely far away, equally strong everywhere.",
    &[Declaration::of::<DirectionalLight>()],
);

component! {
    /// A light infinitely far away.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct DirectionalLight {
        /// Strength, the same everywhere.
        pub intensity: f64 = "intensity": Number(Range::NOT_NEGATIVE), Required;
        /// The colour of the light.
        pub color: DVec3 = "color": Color, Required;
        /// Direction in which the light shines.
        pub direction: DVec3 = "direction": Direction("[0, -1, 0]"), Required;
        /// Diameter of the light in the sky, in degrees: 0.53 for the sun. It softens shadows; at 0
        /// rays are parallel.
        pub angle_degrees: f64 = "angle": Number(Range::new(0.0, 180.0)), Is(0.0);
        /// Distribution of the directions to the light: random, one in each cell of a grid, or
        /// Sobol.
        pub sampling: Sampling = "sampling": word::<Sampling>(), Says("sobol") => "angle";
        /// Directions to the light, which share its strength; with jittered sampling, along each side of the grid.
        pub samples: u32 = "samples": Integer(1, MOST_SAMPLES), Is(1.0) => "angle";
    }
}

declared!(DirectionalLight, |light: &mut Self, object| {
    warn_of_strength(object, light.intensity, light.color);
    check_samples(object, light.sampling, light.samples)
});
