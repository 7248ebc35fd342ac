//! Ambient light from a sky and the ground, or from the environment.

use glam::DVec3;

use super::{MOST_SAMPLES, check_samples};
use crate::camera::Sampling;
use crate::format::{Declaration, Kind, Range, component, declared};

/// The object of ambient light.
pub(crate) const SKY: Kind = Kind::entity(
    "",
    "ambient light (or a number)",
    "Ambient light from a sky and the ground, or from the environment, by the direction of the normal.",
    &[Declaration::of::<Sky>()],
);

component! {
    /// Ambient light from a sky and the ground, or from the environment, added once, weighted by the
    /// normal.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Sky {
        /// The light on a surface that faces up; by default that of the environment, from everywhere.
        pub sky: Option<DVec3> = "sky": Color;
        /// The light on a surface that faces down; by default the same.
        pub ground: Option<DVec3> = "ground": Color;
        /// Direction of the sky.
        pub up: DVec3 = "up": Direction("[0, 1, 0]"), Are([0.0, 1.0, 0.0]) => "sky" | "ground";
        /// Directions in which rays look for what is in the way of this light; with jittered
        /// sampling, along each side of the grid. At 0 nothing is in the way.
        pub samples: u32 = "samples": Integer(0, MOST_SAMPLES), Is(0.0);
        /// Distribution of the directions: random, one in each cell of a grid, or Sobol.
        pub sampling: Sampling = "sampling": word::<Sampling>(), Says("sobol") => "samples";
        /// How far rays look; by default to the end of the scene.
        pub distance: Option<f64> = "distance": Number(Range::POSITIVE) => "samples";
    }
}

declared!(Sky, |sky: &mut Self, object| check_samples(object, sky.sampling, sky.samples));
