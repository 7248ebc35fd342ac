//! The hard cases on this machine: inputs that break ray tracers, and the bits that they must give.
//!
//! Hits in exact precision and the pixels of an image do not depend on the machine. So every case is
//! a set of rays at made geometry, built-in scenes, or both, with the hash of its bits in
//! `selftest/recorded.txt`. Every kernel at every instruction level of the processor must find the
//! same bits. That they are right is for the project's tests to show, which compute them by other
//! means: `tests/stability` in rational numbers, `tests/integration/closed_form` from formulas.
//!
//! Fast precision has no bits to keep. Of it, the rays that it loses are counted.

pub mod agreement;
mod aim;
mod boxes;
mod case;
mod edges;
pub mod errors;
pub mod examine;
mod flat;
mod instances;
mod prelude;
mod scenes;
mod shapes;
mod spheres;
mod surfaces;
mod world;

use std::path::Path;

use serde::Serialize;

pub use case::{Count, Effort, Outcome};
pub use world::Losses;
use world::Worlds;

/// The seed whose bits are recorded.
pub const SEED: u64 = 1;

/// The rays of a case, in all of its worlds together, in full; a hundredth of them are quick.
const MANY: usize = 1_000_000;

/// A hard case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its number, as in `selftest --case`.
    pub number: u32,
    /// What is tested.
    pub name: &'static str,
    worlds: Option<Worlds>,
    scenes: &'static [&'static str],
}

/// What was found for the rays of a case, or one of its scenes.
#[derive(Clone, Debug, Serialize)]
pub struct CasePart {
    /// `rays` with the number of the case, or the scene.
    pub name: String,
    /// The hash of its bits, in hexadecimal digits.
    pub bits: String,
    /// The answers, and those that differ.
    #[serde(flatten)]
    pub outcome: Outcome,
}

impl CasePart {
    fn new(name: String, effort: &Effort, (mut outcome, bits): (Outcome, u64)) -> Self {
        let bits = format!("{bits:016x}");
        if (effort.seed, effort.count) == (SEED, Count::Quick) {
            let lines = include_str!("selftest/recorded.txt").lines();
            let mut parts = lines.filter_map(|line| line.split_once(": "));
            let recorded = parts.find(|(part, _)| *part == name).map_or("none", |(_, bits)| bits);
            let differ = || format!("the bits of {name} are {bits}; recorded are {recorded}");
            outcome.check(bits == recorded, differ);
        }
        Self { name, bits, outcome }
    }
}

impl Case {
    const fn new(
        number: u32,
        name: &'static str,
        worlds: Option<Worlds>,
        scenes: &'static [&'static str],
    ) -> Self {
        Self { number, name, worlds, scenes }
    }

    /// Asks every kernel at every instruction level in exact precision. Scenes are files in
    /// `folder`, as in the repository's `scenes`.
    pub fn exact(&self, effort: &Effort, folder: &Path) -> Vec<CasePart> {
        let rays = self.worlds.map(|_| {
            let name = format!("rays {}", self.number);
            CasePart::new(name, effort, self.exact_hits(effort))
        });
        let scenes = self.scenes.iter().map(|name| {
            let file = folder.join(name).with_extension("json");
            CasePart::new((*name).to_owned(), effort, scenes::exact(effort, &file))
        });
        rays.into_iter().chain(scenes).collect()
    }
}

/// All cases, by number. Numbers that are missing are those of cases that only tests have.
#[rustfmt::skip]
pub const CASES: &[Case] = &[
    Case::new(1, "rays through shared edges", Some((edges::CLOSED, MANY, edges::edges)), &["hard/inside-mesh"]),
    Case::new(2, "rays through vertices of 3 to 64 triangles", Some((edges::CLOSED, MANY, edges::vertices)), &["hard/vertex-fan"]),
    Case::new(3, "rays on the faces of the BVH's boxes", Some((18, MANY, boxes::faces)), &[]),
    Case::new(4, "rays along an axis that start in the plane of a face", Some((6, MANY, boxes::along_axes)), &["hard/axis-parallel"]),
    Case::new(5, "directions with 0 and -0", Some((6, MANY, boxes::signed_zeros)), &[]),
    Case::new(6, "directions with a component of 1e-45 to 1e-6", Some((6, MANY, boxes::tiny_components)), &[]),
    Case::new(7, "scenes far from the origin", None, &["hard/far-from-origin"]),
    Case::new(8, "scenes of a millionth of the size", None, &["hard/tiny-scene"]),
    Case::new(9, "rays that leave a surface", Some((1000, MANY, surfaces::leaving)), &[]),
    Case::new(10, "plates 64 to 256 ulp apart", Some((400, MANY, surfaces::contact)), &["hard/contact"]),
    Case::new(11, "shadow rays to lights on a surface", None, &["hard/edge-on-light", "hard/light-at-surface", "hard/under-a-ceiling"]),
    Case::new(12, "occluders 64 ulp in front of a light", Some((100, MANY, surfaces::just_before_a_light)), &["hard/occluded-light"]),
    Case::new(13, "spheres from up to 100 000 radii away", Some((100, MANY, spheres::far_away)), &["hard/far-spheres"]),
    Case::new(14, "huge spheres seen from just above", Some((100, MANY, spheres::from_just_above)), &["hard/huge-sphere"]),
    Case::new(15, "rays that graze a sphere", Some((100, MANY, spheres::grazing)), &["hard/grazing-sphere"]),
    Case::new(16, "rays from inside a sphere", Some((100, MANY, spheres::from_inside)), &["hard/inside-sphere"]),
    Case::new(18, "degenerate triangles among others", Some((6, MANY, flat::sealed)), &["hard/degenerate-triangles"]),
    Case::new(19, "slivers with an aspect ratio of 1 000 000, nearly edge-on", Some((100, MANY, flat::slivers)), &["hard/slivers"]),
    Case::new(20, "rays in a triangle's plane", Some((100, MANY, boxes::in_the_plane)), &[]),
    Case::new(21, "duplicate triangles, in any order", Some((6, MANY, boxes::duplicates)), &["hard/coplanar-duplicates"]),
    Case::new(22, "160 triangles around one point", None, &["hard/shared-centroid"]),
    Case::new(23, "500 nested triangles", Some((6, MANY / 20, boxes::nested)), &["hard/nested-boxes"]),
    Case::new(24, "scenes without shapes, or without lights", None, &["hard/empty", "hard/no-lights"]),
    Case::new(26, "rays that are not finite, or have no direction", Some((6, MANY, boxes::invalid)), &[]),
    Case::new(27, "a camera that looks along its up direction", None, &["hard/up-parallel"]),
    Case::new(28, "wide angles of view, images of one column", None, &["hard/wide-fov", "hard/thin-image"]),
    Case::new(29, "a lens with aperture 0", None, &["hard/aperture-zero"]),
    Case::new(30, "textures at seams and poles", None, &["hard/pole-texture"]),
    Case::new(33, "smooth normals where light grazes the surface", None, &["hard/smooth-terminator"]),
    Case::new(34, "non-planar quads", Some((10, MANY, flat::crooked_quads)), &["hard/nonplanar-quad"]),
    Case::new(35, "facing mirrors, 200 bounces", None, &["hard/facing-mirrors", "hard/emission-alone"]),
    Case::new(36, "exponents of 0 to 1 000 000", None, &["hard/exponents"]),
    Case::new(39, "ellipsoids with axes of 1e-6 to 1e6, from inside", Some((12, MANY, edges::needles)), &[]),
    Case::new(40, "t ranges that begin before the origin", Some((6, MANY, boxes::before_the_origin)), &[]),
    Case::new(41, "spot lights of 0 to 180 degrees, and light along a floor", None, &["hard/cones", "hard/cone-without-angle"]),
    Case::new(44, "instances rotated, stretched, sheared, mirrored and moved", Some((60, MANY, instances::any)), &["instances"]),
    Case::new(45, "cut-outs at the threshold, on shared edges, in front of a copy", None, &["hard/cut-outs"]),
    Case::new(46, "vertex colours at vertices and edges", None, &["hard/vertex-colors"]),
    Case::new(48, "rays with integer ends, which are where they meet triangles", Some((6, MANY, boxes::at_ends)), &[]),
    Case::new(49, "edges and vertices of slivers, of sheets a few ulp apart and of wide quads", Some((6, MANY, agreement::aimed)), &[]),
    Case::new(50, "normals that maps turn below the surface", None, &["hard/normal-maps", "materialmaps"]),
    Case::new(51, "depth images as meshes, seen from where they were taken", Some((8, MANY, edges::scans)), &[]),
    Case::new(52, "trilinear footprints at grazing angles", None, &["texturefilter"]),
    Case::new(53, "texels that are NaN or infinite", None, &["hard/no-numbers"]),
    Case::new(54, "rays of a lens, and points of lights", None, &["DoF-sobol", "testareajitter", "hemisphere"]),
    Case::new(57, "transparent balls and panes, and solids that touch and overlap", None, &["glass", "drink"]),
    Case::new(61, "ambient light that things around take away", None, &["occlusion"]),
];

/// The case with that number.
pub fn case(number: u32) -> Option<&'static Case> {
    CASES.iter().find(|case| case.number == number)
}
