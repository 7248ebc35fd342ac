//! The hard cases: inputs that break ray tracers, tried on the machine at hand.
//!
//! Each [`Case`] is a question with a stated bound, asked in a precision of every kernel with all
//! instructions that the processor has. All hold in robust and in exact arithmetic; what fast arithmetic
//! fails is the price of its speed. Its inputs follow from a seed, so that whoever sees it fail can see it again.
//! What is expected is worked out in double precision or follows from how the input was made, and
//! shares no code with what is tested.

mod case;
mod closed;
mod convex;
mod directions;
pub mod examine;
mod lights;
mod meshes;
mod mirrors;
mod moved;
mod refused;
mod scenes;
mod spheres;
mod surfaces;
mod textures;
mod topology;
mod trees;
mod views;
mod watertight;
mod ways;

pub use case::{Count, Effort, Outcome};

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
        number: 7,
        name: "scenes moved by up to 2^17",
        bound: "at most 1 of 10 000 pixels shows another primitive, none that faces a light is dark",
        run: moved::moved,
    },
    Case {
        number: 8,
        name: "scenes scaled by 2^-20 to 2^20, and with the axes turned",
        bound: "the same image to the last bit",
        run: moved::scaled,
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
        number: 17,
        name: "radii that are none",
        bound: "refused, and the sphere named",
        run: refused::radii,
    },
    Case {
        number: 18,
        name: "triangles without area among others",
        bound: "counted, and the image as without them",
        run: meshes::without_area,
    },
    Case {
        number: 19,
        name: "slivers of 1 to 1 000 000, seen along their planes",
        bound: "no hit more than 8 ulp outside the triangle's box",
        run: meshes::slivers,
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
        number: 24,
        name: "scenes with one shape or none, with one light or none",
        bound: "the background where nothing is, and black where no light is",
        run: views::next_to_nothing,
    },
    Case {
        number: 25,
        name: "meshes that are broken, or of random bits",
        bound: "refused with file and place, or rendered",
        run: refused::meshes,
    },
    Case {
        number: 26,
        name: "rays that are not numbers, or go nowhere",
        bound: "they visit no node and hit nothing",
        run: directions::invalid,
    },
    Case {
        number: 27,
        name: "cameras that look along their up",
        bound: "at right angles within 4 ulp, and the user is told",
        run: views::upright,
    },
    Case {
        number: 28,
        name: "angles of view of 0.001 to 179 degrees, images of one row",
        bound: "every ray has a direction",
        run: views::angles,
    },
    Case {
        number: 29,
        name: "lenses without an extent, and without a focus",
        bound: "the pinhole's image; refused, and the key named",
        run: views::lenses,
    },
    Case {
        number: 30,
        name: "textures at their ends and repeated a million times",
        bound: "within a texel",
        run: textures::look_ups,
    },
    Case {
        number: 31,
        name: "lights without area, or seen edge on",
        bound: "refused, and the light named; a number",
        run: lights::edge_on,
    },
    Case {
        number: 32,
        name: "point lights at a surface",
        bound: "no stronger than at the rounding error, and counted",
        run: lights::at_the_surface,
    },
    Case {
        number: 33,
        name: "smooth normals where the light sets",
        bound: "no face that the light is behind is lit",
        run: lights::horizon,
    },
    Case {
        number: 34,
        name: "quads that are not flat",
        bound: "told, divided from the first corner to the third, and no ray leaves",
        run: meshes::crooked_quads,
    },
    Case {
        number: 35,
        name: "mirrors that face each other, for up to 1000 bounces",
        bound: "within 1e-4 of the sum worked out, the same with both tracers",
        run: mirrors::facing,
    },
    Case {
        number: 36,
        name: "exponents of 0 to 1 000 000, light against the view",
        bound: "a number, no more than the material returns",
        run: lights::highlights,
    },
];

/// The case of that number.
pub fn case(number: u32) -> Option<&'static Case> {
    CASES.iter().find(|case| case.number == number)
}
