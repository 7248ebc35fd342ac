//! The hard cases: inputs that break ray tracers, tested on this machine.
//!
//! Each [`Case`] has a stated bound, and runs in one precision with every kernel, the reference
//! among them, and all instruction levels of the processor. All cases pass in exact precision; some
//! fail in fast. A case is data: parts that make inputs with the answers that follow from
//! their construction, run by a few runners. The inputs follow from a seed, so that a failure can
//! be repeated. Expected results are computed in integers or in double precision, or follow from
//! the construction of the input, and share no code with the tested kernels. Faults planted in the
//! sources prove that cases can fail (`tests/mutations`).

pub mod agreement;
mod aim;
mod boxes;
mod case;
mod edges;
pub mod errors;
pub mod examine;
mod flat;
mod holes;
mod instances;
mod lights;
mod numbers;
mod parts;
mod placed;
mod prelude;
mod refused;
mod scenes;
mod shapes;
mod spheres;
mod sums;
mod surfaces;
mod textures;
mod topology;
mod transparency;
mod views;
mod ways;
mod whole;

pub use case::{Count, Effort, Outcome};
use parts::CasePart::{self, Images, Rays, Values};

/// A hard case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its number, as in `selftest --case`.
    pub number: u32,
    /// What is tested.
    pub name: &'static str,
    /// The requirement.
    pub bound: &'static str,
    parts: &'static [CasePart],
}

impl Case {
    const fn new(
        number: u32,
        name: &'static str,
        bound: &'static str,
        parts: &'static [CasePart],
    ) -> Self {
        Self { number, name, bound, parts }
    }

    /// Runs the case.
    pub fn run(&self, effort: &Effort) -> Outcome {
        let parts = (0..).zip(self.parts);
        parts.map(|(place, part)| part.run(effort, self.number, place)).sum()
    }
}

/// All cases, by number.
#[rustfmt::skip]
pub const CASES: &[Case] = &[
    Case::new(1, "rays through shared edges", "no ray leaves a closed mesh",
        &[Rays(edges::CLOSED, 10_000_000, edges::edges)]),
    Case::new(2, "rays through vertices of 3 to 64 triangles", "no ray leaves a closed mesh",
        &[Rays(edges::CLOSED, 10_000_000, edges::vertices)]),
    Case::new(3, "rays on the faces of the BVH's boxes", "exact hits, with every preset at three scales",
        &[Rays(18, 1_000_000, boxes::faces)]),
    Case::new(4, "rays along an axis that start in the plane of a face", "every ray hits the surface ahead",
        &[Rays(6, 1_000_000, boxes::along_axes)]),
    Case::new(5, "directions with 0 and -0", "exact hits", &[Rays(6, 1_000_000, boxes::signed_zeros)]),
    Case::new(6, "directions with a component of 1e-45 to 1e-6", "no box of 1 cm is missed, up to t = 1e6",
        &[Rays(6, 1_000_000, boxes::tiny_components)]),
    Case::new(7, "scenes moved by up to 2^17", "the same primitives but at edges, and no lit pixel is dark",
        &[Rays(12, 1_000_000, placed::moved), Images(placed::MOVES, placed::without_acne)]),
    Case::new(8, "scenes scaled by 2^-20 to 2^20, or with permuted axes", "the same image, bit for bit",
        &[Images(placed::SCALES, placed::scaled)]),
    Case::new(9, "rays that leave a surface", "no ray hits it again", &[Rays(1000, 10_000_000, surfaces::leaving)]),
    Case::new(10, "plates 64 to 256 ulp apart", "the upper one blocks light, the lower does not",
        &[Rays(400, 2_000_000, surfaces::contact)]),
    Case::new(11, "shadow rays to lights on a surface", "the surface blocks no ray",
        &[Images([8, 400], surfaces::under_a_ceiling), Values([100_000, 10_000_000], surfaces::towards_a_triangle)]),
    Case::new(12, "occluders 64 ulp in front of a light", "every occluder blocks light",
        &[Rays(100, 1_000_000, surfaces::just_before_a_light)]),
    Case::new(13, "spheres from up to 100 000 radii away", "hit up to 0.99 radii from the centre, t within 4 ulp",
        &[Rays(100, 1_000_000, spheres::far_away)]),
    Case::new(14, "huge spheres seen from just above", "t within 4 ulp of the radius or the distance",
        &[Rays(100, 1_000_000, spheres::from_just_above)]),
    Case::new(15, "rays that graze a sphere", "t is finite, or the ray misses", &[Rays(100, 1_000_000, spheres::grazing)]),
    Case::new(16, "rays from inside a sphere", "every ray hits, within 4 ulp of the sphere",
        &[Rays(100, 1_000_000, spheres::from_inside)]),
    Case::new(17, "invalid radii", "refused, naming the sphere", &[Values([1000, 100_000], refused::radii)]),
    Case::new(18, "degenerate triangles among others", "counted, and the image does not change",
        &[Rays(6, 1_000_000, placed::among_others), Rays(6, 1_000_000, flat::sealed)]),
    Case::new(19, "slivers with an aspect ratio of 1 000 000, nearly edge-on",
        "no hit more than 8 ulp outside the triangle's box", &[Rays(100, 1_000_000, flat::slivers)]),
    Case::new(20, "rays in a triangle's plane", "no hit", &[Rays(100, 1_000_000, boxes::in_the_plane)]),
    Case::new(21, "duplicate triangles, in any order", "the closest hit, and of equal ones the first",
        &[Rays(6, 1_000_000, boxes::duplicates)]),
    Case::new(22, "up to a million triangles around one point", "exact hits, with at most twice as many tests",
        &[Rays(6, 9_600, boxes::one_centroid), Values([3, 3], boxes::tests_of_one_centroid)]),
    Case::new(23, "500 nested triangles", "exact hits", &[Rays(6, 50_000, boxes::nested)]),
    Case::new(24, "scenes with at most one shape and one light",
        "background where there is no shape, black where there is no light", &[Images([3, 100], views::next_to_nothing)]),
    Case::new(25, "broken meshes, and random bytes", "rendered, or refused with file and place", &[Values([100, 1000], refused::meshes)]),
    Case::new(26, "rays that are not finite, or have no direction", "they visit no node and hit nothing", &[Values([10, 1000], boxes::invalid)]),
    Case::new(27, "cameras that look along their up direction", "axes at right angles within 4 ulp, and a warning",
        &[Values([1000, 100_000], views::upright)]),
    Case::new(28, "angles of view of 0.001 to 179 degrees, images of one row", "every ray has a valid direction",
        &[Values([100, 10_000], views::angles), Images([12, 12], views::thin_images), Values([6, 6], views::refused_angles)]),
    Case::new(29, "lenses with aperture 0, and invalid lenses", "the pinhole's image; refused, naming the key",
        &[Values([1000, 100_000], refused::lenses), Images([4, 100], views::closed_lens)]),
    Case::new(30, "texture coordinates at the edges, and repeated a million times", "off by at most one texel",
        &[Values([100_000, 10_000_000], textures::look_ups), Values([30_000, 3_000_000], textures::across_seams)]),
    Case::new(31, "area lights without area, or seen edge-on", "refused, naming the light; finite",
        &[Values([21; 2], lights::without_area), Images([3, 3], lights::hardly_lights), Values([10_000, 1_000_000], lights::edge_on)]),
    Case::new(32, "point lights on a surface", "no brighter than from the distance of the rounding error, and counted",
        &[Images([12, 480], lights::before_a_wall), Values([10_000, 1_000_000], lights::at_a_point)]),
    Case::new(33, "smooth normals where light grazes the surface", "no face turned away from the light is lit",
        &[Images([6, 400], lights::behind_a_sheet)]),
    Case::new(34, "non-planar quads", "a warning, a fixed diagonal, and no ray leaves", &[Rays(10, 1_000_000, flat::crooked_quads)]),
    Case::new(35, "facing mirrors, up to 1000 bounces", "within 1e-4 of the exact sum, equal in both tracers",
        &[Images(sums::MIRRORS, sums::facing_mirrors)]),
    Case::new(36, "exponents of 0 to 1 000 000, light opposite to the view", "finite, and no more light than the material reflects",
        &[Images([7, 700], lights::shiny_ball), Values([100_000, 10_000_000], lights::highlights)]),
    Case::new(37, "flat floors, turned, scaled and moved, under a low light", "no floor shadows itself",
        &[Rays(100, 10_000_000, flat::floors)]),
    Case::new(38, "coplanar triangles, and copies with corners in any order", "the first triangle is hit",
        &[Rays(50, 1_000_000, flat::copies)]),
    Case::new(39, "ellipsoids with axes of 1e-6 to 1e6, from inside", "no ray leaves", &[Rays(12, 4_000_000, edges::needles)]),
    Case::new(40, "t ranges that begin before the origin", "surfaces in the range are hit",
        &[Rays(6, 1_000_000, boxes::before_the_origin)]),
    Case::new(41, "spot lights of 0 to 180 degrees, and light along a floor",
        "light only within the cone, and none along the floor",
        &[Images([7, 140], lights::cones), Images([4, 4], lights::along_the_floor)]),
    Case::new(42, "meshes in scene files, up to 2^38 from the origin", "every pixel shows the right face",
        &[Rays(placed::PLACES, 1_000_000, placed::far_away)]),
    Case::new(43, "edges and vertices from up to 10 000 radii away", "no ray enters a closed mesh",
        &[Rays(6, 5_000_000, edges::from_afar)]),
    Case::new(44, "instances rotated, stretched, sheared, mirrored and moved",
        "no ray leaves a closed mesh; the hits of brute force",
        &[Rays(20, 2_000_000, instances::never_left), Rays(20, 2_000_000, instances::from_afar),
          Rays(6, 51_200, instances::between_numbers)]),
    Case::new(45, "cut-outs at the threshold, on shared edges, in front of a copy",
        "parts below the threshold are absent for all kinds of rays", &[Rays(holes::WORLDS, 1_000_000, holes::cut_out)]),
    Case::new(46, "vertex colours from 1e-3 to 1e12", "interpolated, also at vertices and edges",
        &[Images([4, 100], textures::vertex_colors)]),
    Case::new(47, "flat quads 20 to 1e10 wide, turned, seen from just above", "no ray that passes the diagonal is lost",
        &[Rays(flat::WIDE_FLOORS, 2_000_000, flat::from_just_above)]),
    Case::new(48, "rays with integer ends, which are where they meet triangles", "exact hits",
        &[Rays(6, 1_000_000, boxes::at_ends)]),
    Case::new(49, "edges and vertices of slivers, of sheets a few ulp apart and of wide planes",
        "the hits of the reference", &[Rays(6, 2_048_000, agreement::aimed)]),
    Case::new(50, "normals that maps turn below the surface", "no light from below, and mirrors show what is above",
        &[Images([16, 400], textures::turned_normals)]),
    Case::new(51, "depth images as meshes, seen from where they were taken", "every ray hits what was scanned",
        &[Rays(8, 1_000_000, edges::scans)]),
    Case::new(52, "trilinear footprints of any size, and at grazing angles", "the level of the longer side; the mean where it exceeds the image",
        &[Values([10_000, 1_000_000], textures::footprints), Images([8, 200], textures::grazing)]),
    Case::new(53, "texels that are NaN or infinite", "0 in those channels, and as they are in all others",
        &[Images([4, 100], textures::no_numbers)]),
    Case::new(54, "lenses cut by walls and spheres", "each point of the lens sees its side",
        &[Images([6, 200], views::cut_lens)]),
    Case::new(55, "sums over up to a million rays of a lens, and 65 536 points of a light", "within 1e-6 and 0.4 % of the exact sum",
        &[Images([2, 20], sums::a_million)]),
    Case::new(56, "estimates by every sampler over 48 seeds", "no bias, and no correlation, beyond 6 standard errors",
        &[Values([1, 1], sums::samplers)]),
    Case::new(57, "transparent balls that bend no ray, in and through each other", "each surface counts once, and none casts a shadow",
        &[Images([20, 1000], transparency::unbent), Images([6, 200], transparency::unshadowed)]),
    Case::new(58, "up to 30 panes behind each other, and seen edge-on", "within 1e-5 of the product of their shares",
        &[Images([20, 1000], transparency::panes)]),
    Case::new(59, "shadow rays through edges and vertices of transparent meshes", "each surface takes light once",
        &[Values([100, 10_000], transparency::shadow_rays)]),
    Case::new(60, "transparent balls of any material in white light", "no brighter than the light, by every way to render",
        &[Images([10, 500], transparency::in_white_light)]),
    Case::new(61, "a sky over plates, and outside of closed meshes", "all of its light arrives, and none of it",
        &[Images([20, 1000], lights::under_the_sky)]),
];

/// The case with that number.
pub fn case(number: u32) -> Option<&'static Case> {
    CASES.iter().find(|case| case.number == number)
}
