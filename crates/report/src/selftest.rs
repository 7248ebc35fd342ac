//! The hard cases: inputs that break ray tracers, tested on this machine.
//!
//! Each [`Case`] has a stated bound, and runs in one precision with every kernel, the reference
//! among them, and all instruction levels of the processor. All cases pass in exact precision; some
//! fail in fast. The inputs follow from a seed, so that a failure can be repeated. Expected results
//! are computed in integers or in double precision, or follow from the construction of the input, and
//! share no code with the tested kernels. Faults planted in the sources prove that cases can fail
//! (`tests/mutations`).

pub mod agreement;
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
    Case::new(3, "rays on the faces of the BVH's boxes",
        "exact hits, with every preset at three scales", trees::boxes),
    Case::new(4, "rays along an axis that start in the plane of a face",
        "every ray hits the surface ahead", directions::along_axes),
    Case::new(5, "directions with 0 and -0", "the same hits", directions::signed_zeros),
    Case::new(6, "directions with a component of 1e-45 to 1e-6",
        "no box of 1 cm is missed, up to t = 1e6", directions::tiny_components),
    Case::new(7, "scenes moved by up to 2^17",
        "at most 1 of 10 000 pixels shows another primitive, and no lit pixel is dark", moved::moved),
    Case::new(8, "scenes scaled by 2^-20 to 2^20, or with permuted axes",
        "the same image, bit for bit", moved::scaled),
    Case::new(9, "rays that leave a surface", "no ray hits it again", surfaces::leaving),
    Case::new(10, "plates 64 to 256 ulp apart", "the upper one blocks light, the lower does not", surfaces::contact),
    Case::new(11, "shadow rays to lights on a surface",
        "the surface blocks no ray", surfaces::towards_a_light_on_a_surface),
    Case::new(12, "occluders 64 ulp in front of a light", "every occluder blocks light", surfaces::just_before_a_light),
    Case::new(13, "spheres from up to 100 000 radii away",
        "hit up to 0.99 radii from the centre, t within 4 ulp", spheres::far_away),
    Case::new(14, "huge spheres seen from just above",
        "t within 4 ulp of the radius or the distance", spheres::from_just_above),
    Case::new(15, "rays that graze a sphere", "t is finite, or the ray misses", spheres::grazing),
    Case::new(16, "rays from inside a sphere", "every ray hits, within 4 ulp of the sphere", spheres::from_inside),
    Case::new(17, "invalid radii", "refused, naming the sphere", refused::radii),
    Case::new(18, "degenerate triangles among others",
        "counted, and the image does not change", meshes::without_area),
    Case::new(19, "slivers with an aspect ratio of 1 000 000, nearly edge-on",
        "no hit more than 8 ulp outside the triangle's box", meshes::slivers),
    Case::new(20, "rays in a triangle's plane", "no hit", trees::in_the_plane),
    Case::new(21, "duplicate triangles, in any order",
        "the closest hit, and of equal ones the first", trees::duplicates),
    Case::new(22, "up to a million triangles around one point",
        "exact hits, with at most twice as many tests", trees::one_centroid),
    Case::new(23, "500 nested triangles", "exact hits", trees::nested),
    Case::new(24, "scenes with at most one shape and one light",
        "background where there is no shape, black where there is no light", views::next_to_nothing),
    Case::new(25, "broken meshes, and random bytes",
        "rendered, or refused with file and place", refused::meshes),
    Case::new(26, "rays that are not finite, or have no direction",
        "they visit no node and hit nothing", directions::invalid),
    Case::new(27, "cameras that look along their up direction",
        "axes at right angles within 4 ulp, and a warning", views::upright),
    Case::new(28, "angles of view of 0.001 to 179 degrees, images of one row",
        "every ray has a valid direction", views::angles),
    Case::new(29, "lenses with aperture 0, and invalid lenses",
        "the pinhole's image; refused, naming the key", views::lenses),
    Case::new(30, "texture coordinates at the edges, and repeated a million times", "off by at most one texel", textures::look_ups),
    Case::new(31, "area lights without area, or seen edge-on", "refused, naming the light; finite", lights::edge_on),
    Case::new(32, "point lights on a surface",
        "no brighter than from the distance of the rounding error, and counted", lights::at_the_surface),
    Case::new(33, "smooth normals where light grazes the surface", "no face turned away from the light is lit", lights::horizon),
    Case::new(34, "non-planar quads",
        "a warning, a fixed diagonal, and no ray leaves", meshes::crooked_quads),
    Case::new(35, "facing mirrors, up to 1000 bounces",
        "within 1e-4 of the exact sum, equal in both tracers", mirrors::facing),
    Case::new(36, "exponents of 0 to 1 000 000, light opposite to the view",
        "finite, and no more light than the material reflects", lights::highlights),
    Case::new(37, "flat floors, turned, scaled and moved, under a low light", "no floor shadows itself", planes::floors),
    Case::new(38, "coplanar triangles, and copies with corners in any order", "the first triangle is hit", planes::copies),
    Case::new(39, "ellipsoids with axes of 1e-6 to 1e6, from inside", "no ray leaves", planes::needles),
    Case::new(40, "t ranges that begin before the origin", "surfaces in the range are hit", planes::before_the_origin),
    Case::new(41, "spot lights of 0 to 180 degrees, and light along a floor",
        "light only within the cone, and none along the floor", cones::cones),
    Case::new(42, "meshes in scene files, up to 2^38 from the origin", "every pixel shows the right face", listed::listed_points),
    Case::new(43, "edges and vertices from up to 10 000 radii away", "no ray enters a closed mesh", far::aimed),
    Case::new(44, "instances rotated, stretched, sheared, mirrored and moved",
        "no ray leaves a closed mesh; the hits of brute force", instances::shown),
    Case::new(45, "cut-outs at the threshold, on shared edges, in front of a copy",
        "parts below the threshold are absent for all kinds of rays", holes::cut_out),
    Case::new(46, "vertex colours from 1e-3 to 1e12", "interpolated, also at vertices and edges", colors::interpolated),
    Case::new(47, "flat quads 20 to 1e10 wide, turned, seen from just above", "no ray that passes the diagonal is lost",
        planes::floors_from_just_above),
    Case::new(48, "rays with integer ends, which are where they meet triangles", "exact hits", trees::at_ends),
    Case::new(49, "edges and vertices of slivers, of sheets a few ulp apart and of wide planes",
        "the hits of the reference", agreement::aimed),
];

/// The case with that number.
pub fn case(number: u32) -> Option<&'static Case> {
    CASES.iter().find(|case| case.number == number)
}
