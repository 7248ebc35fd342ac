//! The hard cases: inputs that break ray tracers, tried on the machine at hand.
//!
//! Each [`Case`] is a question with a stated bound, asked in a precision of every kernel with all
//! instructions that the processor has. All hold in robust and in exact arithmetic; what fast arithmetic
//! fails is the price of its speed. Its inputs follow from a seed, so that whoever sees it fail can see it again.
//! What is expected is worked out in double precision or follows from how the input was made, and
//! shares no code with what is tested.

mod closed;
mod directions;
pub mod examine;
mod spheres;
mod surfaces;
mod topology;
mod trees;
mod watertight;
mod ways;

use crate::accel::Accel;
use crate::accel::build::Preset;
use crate::accel::geometry::Geometry;
use crate::kernels::precision::Precision;

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// Little enough for every run of the tests.
    Quick,
    /// What the case's bound speaks of.
    Full,
}

/// How a case is run.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// The arithmetic that is tried.
    pub precision: Precision,
    /// What its inputs follow from.
    pub seed: u64,
    /// How many there are.
    pub count: Count,
}

impl Effort {
    /// What finds hits on `geometry` in the precision that is tried.
    fn accel(&self, geometry: Geometry, preset: Preset) -> Accel {
        Accel::new(Geometry { precision: self.precision, ..geometry }, preset)
    }

    /// `full`, or a hundredth of it.
    fn of(&self, full: u32) -> u32 {
        match self.count {
            Count::Quick => full / 100,
            Count::Full => full,
        }
    }
}

/// What came of a case.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Outcome {
    /// How many questions were asked.
    pub tried: u64,
    /// How many of the answers broke the bound.
    pub failed: u64,
    /// The first of these, in words.
    pub first: Option<String>,
    /// Answers whose time was taken.
    pub timed: u64,
    /// Seconds that these took, summed over threads.
    pub seconds: f64,
}

impl Outcome {
    /// Nanoseconds for an answer; `None` where no time was taken.
    pub fn nanoseconds(&self) -> Option<f64> {
        (self.timed > 0).then(|| self.seconds * 1e9 / self.timed as f64)
    }

    /// Whether it was tried, and the bound held.
    pub fn holds(&self) -> bool {
        self.tried > 0 && self.failed == 0
    }

    /// Counts an answer; `failure` says what is wrong with it, if anything is.
    fn count(&mut self, failure: Option<String>) {
        self.tried += 1;
        if let Some(failure) = failure {
            self.failed += 1;
            self.first.get_or_insert(failure);
        }
    }

    /// Counts what another has counted.
    fn add(&mut self, other: Self) {
        self.tried += other.tried;
        self.failed += other.failed;
        self.timed += other.timed;
        self.seconds += other.seconds;
        if self.first.is_none() {
            self.first = other.first;
        }
    }
}

/// A hard case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its number, by which it is asked for.
    pub number: u32,
    /// What is tried.
    pub name: &'static str,
    /// What has to hold.
    pub bound: &'static str,
    run: fn(&Effort) -> Outcome,
}

impl Case {
    /// Tries it.
    pub fn run(&self, effort: &Effort) -> Outcome {
        (self.run)(effort)
    }
}

/// All there are, by number.
pub const CASES: &[Case] = &[
    Case {
        number: 1,
        name: "rays through shared edges",
        bound: "no ray leaves a closed mesh",
        run: watertight::edges,
    },
    Case {
        number: 2,
        name: "rays through vertices of 3 to 64 triangles",
        bound: "no ray leaves a closed mesh",
        run: watertight::vertices,
    },
    Case {
        number: 3,
        name: "boxes of the tree, with rays on their faces",
        bound: "the hits of brute force, with every preset at three scales",
        run: trees::boxes,
    },
    Case {
        number: 4,
        name: "rays along an axis that start in the plane of a face",
        bound: "every one hits what lies ahead",
        run: directions::along_axes,
    },
    Case {
        number: 5,
        name: "directions with 0 and with -0",
        bound: "both hit the same",
        run: directions::signed_zeros,
    },
    Case {
        number: 6,
        name: "directions with a component of 1e-45 to 1e-6",
        bound: "no box of 1 cm is missed, up to t = 1e6",
        run: directions::tiny_components,
    },
    Case {
        number: 9,
        name: "rays that leave a surface",
        bound: "none meets it again",
        run: surfaces::leaving,
    },
    Case {
        number: 10,
        name: "plates 64 to 256 ulp apart",
        bound: "the one above blocks, the one below does not",
        run: surfaces::contact,
    },
    Case {
        number: 11,
        name: "rays to lights on surfaces",
        bound: "none is blocked by that surface",
        run: surfaces::towards_a_light_on_a_surface,
    },
    Case {
        number: 12,
        name: "occluders 64 ulp before a light",
        bound: "every one blocks",
        run: surfaces::just_before_a_light,
    },
    Case {
        number: 13,
        name: "spheres seen from up to 100 000 radii away",
        bound: "hit up to 0.99 radii off the centre, t within 4 ulp",
        run: spheres::far_away,
    },
    Case {
        number: 14,
        name: "huge spheres seen from just above",
        bound: "t within 4 ulp of the radius or the distance",
        run: spheres::from_just_above,
    },
    Case {
        number: 15,
        name: "rays that graze a sphere",
        bound: "t is a number, or there is no hit",
        run: spheres::grazing,
    },
    Case {
        number: 16,
        name: "rays from inside a sphere",
        bound: "every one hits, within 4 ulp of the sphere",
        run: spheres::from_inside,
    },
    Case {
        number: 20,
        name: "rays in a triangle's plane",
        bound: "a number or no hit, the same in every way",
        run: trees::in_the_plane,
    },
    Case {
        number: 21,
        name: "triangles that are there several times, in any order",
        bound: "the first of those at the least t",
        run: trees::duplicates,
    },
    Case {
        number: 22,
        name: "up to a million triangles about one point",
        bound: "the hits of brute force, in no more than twice as many tests",
        run: trees::one_centroid,
    },
    Case {
        number: 23,
        name: "500 triangles within each other",
        bound: "the hits of brute force",
        run: trees::nested,
    },
    Case {
        number: 26,
        name: "rays that are not numbers, or go nowhere",
        bound: "they visit no node and hit nothing",
        run: directions::invalid,
    },
];

/// The case of that number.
pub fn case(number: u32) -> Option<&'static Case> {
    CASES.iter().find(|case| case.number == number)
}
