//! The hard cases: inputs that break ray tracers, tested on this machine.
//!
//! Each [`Case`] has a stated bound, and runs in one precision with every kernel and all
//! instruction levels of the processor. All cases pass in robust and in exact precision; some fail
//! in fast. The inputs follow from a seed, so that a failure can be repeated. Expected results are
//! computed in integers or in double precision, or follow from the construction of the input, and
//! share no code with the tested kernels. Faults planted in the sources prove that cases can fail
//! (`tests/mutations`).

mod case;
mod closed;
mod colors;
mod cones;
mod convex;
mod directions;
pub mod errors;
pub mod examine;
mod far;
mod holes;
mod instances;
mod lights;
mod listed;
mod meshes;
mod mirrors;
mod moved;
mod planes;
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
mod whole;

pub use case::{Count, Effort, Outcome};

/// A hard case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its number, as in `selftest --case`.
    pub number: u32,
    /// What is tested.
    pub name: &'static str,
    /// The requirement.
    pub bound: &'static str,
    run: fn(&Effort) -> Outcome,
}

impl Case {
    const fn new(
        number: u32,
        name: &'static str,
        bound: &'static str,
        run: fn(&Effort) -> Outcome,
    ) -> Self {
        Self { number, name, bound, run }
    }

    /// Runs the case.
    pub fn run(&self, effort: &Effort) -> Outcome {
        (self.run)(effort)
    }
}

/// All cases, by number.
#[rustfmt::skip]
pub const CASES: &[Case] = &[
    Case::new(1, "rays through shared edges", "no ray leaves a closed mesh", watertight::edges),
    Case::new(2, "rays through vertices of 3 to 64 triangles", "no ray leaves a closed mesh", watertight::vertices),
    Case::new(3, "boxes of the tree, with rays on their faces",
        "the exact hits, with every preset at three scales", trees::boxes),
    Case::new(4, "rays along an axis that start in the plane of a face",
        "every one hits what lies ahead", directions::along_axes),
    Case::new(5, "directions with 0 and with -0", "the same hits", directions::signed_zeros),
    Case::new(6, "directions with a component of 1e-45 to 1e-6",
        "no box of 1 cm is missed, up to t = 1e6", directions::tiny_components),
    Case::new(7, "scenes moved by up to 2^17",
        "at most 1 of 10 000 pixels shows another primitive, none that faces a light is dark", moved::moved),
    Case::new(8, "scenes scaled by 2^-20 to 2^20, and with the axes turned",
        "the same image to the last bit", moved::scaled),
    Case::new(9, "rays that leave a surface", "none meets it again", surfaces::leaving),
    Case::new(10, "plates 64 to 256 ulp apart", "the one above blocks, the one below does not", surfaces::contact),
    Case::new(11, "rays to lights on surfaces",
        "none is blocked by that surface", surfaces::towards_a_light_on_a_surface),
    Case::new(12, "occluders 64 ulp before a light", "every one blocks", surfaces::just_before_a_light),
    Case::new(13, "spheres seen from up to 100 000 radii away",
        "hit up to 0.99 radii off the centre, t within 4 ulp", spheres::far_away),
    Case::new(14, "huge spheres seen from just above",
        "t within 4 ulp of the radius or the distance", spheres::from_just_above),
    Case::new(15, "rays that graze a sphere", "t is a number, or there is no hit", spheres::grazing),
    Case::new(16, "rays from inside a sphere", "every one hits, within 4 ulp of the sphere", spheres::from_inside),
    Case::new(17, "invalid radii", "refused, with the sphere named", refused::radii),
    Case::new(18, "triangles without area among others",
        "counted, and the image as without them", meshes::without_area),
    Case::new(19, "slivers of 1 to 1 000 000, seen along their planes",
        "no hit more than 8 ulp outside the triangle's box", meshes::slivers),
    Case::new(20, "rays in a triangle's plane", "no hit", trees::in_the_plane),
    Case::new(21, "duplicate triangles, in any order",
        "the first of those at the least t", trees::duplicates),
    Case::new(22, "up to a million triangles about one point",
        "the exact hits, in no more than twice as many tests", trees::one_centroid),
    Case::new(23, "500 triangles within each other", "the exact hits", trees::nested),
    Case::new(24, "scenes with one shape or none, with one light or none",
        "the background where nothing is, and black where no light is", views::next_to_nothing),
    Case::new(25, "meshes that are broken, or of random bits",
        "refused with file and place, or rendered", refused::meshes),
    Case::new(26, "rays that are not finite, or have no direction",
        "they visit no node and hit nothing", directions::invalid),
    Case::new(27, "cameras that look along their up",
        "at right angles within 4 ulp, and the user is warned", views::upright),
    Case::new(28, "angles of view of 0.001 to 179 degrees, images of one row",
        "every ray has a direction", views::angles),
    Case::new(29, "lenses without aperture, and without a focus",
        "the pinhole's image; refused, with the key named", views::lenses),
    Case::new(30, "textures at their ends and repeated a million times", "within a texel", textures::look_ups),
    Case::new(31, "lights without area, or seen edge on", "refused, with the light named; a number", lights::edge_on),
    Case::new(32, "point lights at a surface",
        "no stronger than at the rounding error, and counted", lights::at_the_surface),
    Case::new(33, "smooth normals where the light sets", "no face that the light is behind is lit", lights::horizon),
    Case::new(34, "quads that are not flat",
        "warned of, split from the first corner to the third, and no ray leaves", meshes::crooked_quads),
    Case::new(35, "mirrors that face each other, for up to 1000 bounces",
        "within 1e-4 of the exact sum, the same with both tracers", mirrors::facing),
    Case::new(36, "exponents of 0 to 1 000 000, light against the view",
        "a number, no more than the material returns", lights::highlights),
    Case::new(37, "flat floors, turned, scaled and moved, under a low light", "no floor shadows itself", planes::floors),
    Case::new(38, "copies with corners in any order, coplanar triangles", "the first is hit", planes::copies),
    Case::new(39, "globes with axes of 1e-6 to 1e6, from inside", "no ray leaves", planes::needles),
    Case::new(40, "ranges that begin before the origin", "what lies within is hit", planes::before_the_origin),
    Case::new(41, "cones of 0 to 180 degrees, and light along a floor",
        "lit within the cone and nowhere else, in the plane not at all", cones::cones),
    Case::new(42, "points that a scene lists up to 2^38 from the origin", "every pixel shows its face", listed::listed_points),
    Case::new(43, "edges and vertices from up to 10 000 radii away", "no ray enters a closed mesh", far::aimed),
    Case::new(44, "instances turned, stretched, mirrored and moved",
        "no ray leaves a closed mesh, the hits of brute force", instances::shown),
    Case::new(45, "cut-outs at their threshold, on shared edges, before a copy",
        "what has less alpha is not there, for rays of any kind", holes::cut_out),
    Case::new(46, "colors of vertices from 1e-3 to 1e12", "interpolated, at vertices and edges too", colors::interpolated),
];

/// The case with that number.
pub fn case(number: u32) -> Option<&'static Case> {
    CASES.iter().find(|case| case.number == number)
}
