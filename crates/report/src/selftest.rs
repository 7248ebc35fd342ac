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
use world::{World, Worlds};

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
            let recorded = recorded(&name).unwrap_or("none");
            let differ = || format!("the bits of {name} are {bits}; recorded are {recorded}");
            outcome.check(bits == recorded, differ);
        }
        Self { name, bits, outcome }
    }
}

/// The recorded hash of a part.
fn recorded(name: &str) -> Option<&'static str> {
    let lines = include_str!("selftest/recorded.txt").lines();
    lines.filter_map(|line| line.split_once(": ")).find(|(part, _)| *part == name).map(|(_, b)| b)
}

impl Case {
    const fn rays(
        number: u32,
        name: &'static str,
        worlds: usize,
        rays: usize,
        make: fn(&mut case::InputRng) -> World,
        scenes: &'static [&'static str],
    ) -> Self {
        Self { number, name, worlds: Some(Worlds { worlds, rays, make }), scenes }
    }

    const fn images(number: u32, name: &'static str, scenes: &'static [&'static str]) -> Self {
        Self { number, name, worlds: None, scenes }
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
    Case::rays(1, "rays through shared edges", edges::CLOSED, MANY, edges::edges, &["hard/inside-mesh"]),
    Case::rays(2, "rays through vertices of 3 to 64 triangles", edges::CLOSED, MANY, edges::vertices, &["hard/vertex-fan"]),
    Case::rays(3, "rays on the faces of the BVH's boxes", 18, MANY, boxes::faces, &[]),
    Case::rays(4, "rays along an axis that start in the plane of a face", 6, MANY, boxes::along_axes, &["hard/axis-parallel"]),
    Case::rays(5, "directions with 0 and -0", 6, MANY, boxes::signed_zeros, &[]),
    Case::rays(6, "directions with a component of 1e-45 to 1e-6", 6, MANY, boxes::tiny_components, &[]),
    Case::images(7, "scenes far from the origin", &["hard/far-from-origin"]),
    Case::images(8, "scenes of a millionth of the size", &["hard/tiny-scene"]),
    Case::rays(9, "rays that leave a surface", 1000, MANY, surfaces::leaving, &[]),
    Case::rays(10, "plates 64 to 256 ulp apart", 400, MANY, surfaces::contact, &["hard/contact"]),
    Case::images(11, "shadow rays to lights on a surface", &["hard/edge-on-light", "hard/light-at-surface", "hard/under-a-ceiling"]),
    Case::rays(12, "occluders 64 ulp in front of a light", 100, MANY, surfaces::just_before_a_light, &["hard/occluded-light"]),
    Case::rays(13, "spheres from up to 100 000 radii away", 100, MANY, spheres::far_away, &["hard/far-spheres"]),
    Case::rays(14, "huge spheres seen from just above", 100, MANY, spheres::from_just_above, &["hard/huge-sphere"]),
    Case::rays(15, "rays that graze a sphere", 100, MANY, spheres::grazing, &["hard/grazing-sphere"]),
    Case::rays(16, "rays from inside a sphere", 100, MANY, spheres::from_inside, &["hard/inside-sphere"]),
    Case::rays(18, "degenerate triangles among others", 6, MANY, flat::sealed, &["hard/degenerate-triangles"]),
    Case::rays(19, "slivers with an aspect ratio of 1 000 000, nearly edge-on", 100, MANY, flat::slivers, &["hard/slivers"]),
    Case::rays(20, "rays in a triangle's plane", 100, MANY, boxes::in_the_plane, &[]),
    Case::rays(21, "duplicate triangles, in any order", 6, MANY, boxes::duplicates, &["hard/coplanar-duplicates"]),
    Case::images(22, "160 triangles around one point", &["hard/shared-centroid"]),
    Case::rays(23, "500 nested triangles", 6, MANY / 20, boxes::nested, &["hard/nested-boxes"]),
    Case::images(24, "scenes without shapes, or without lights", &["hard/empty", "hard/no-lights"]),
    Case::rays(26, "rays that are not finite, or have no direction", 6, MANY, boxes::invalid, &[]),
    Case::images(27, "a camera that looks along its up direction", &["hard/up-parallel"]),
    Case::images(28, "wide angles of view, images of one column", &["hard/wide-fov", "hard/thin-image"]),
    Case::images(29, "a lens with aperture 0", &["hard/aperture-zero"]),
    Case::images(30, "textures at seams and poles", &["hard/pole-texture"]),
    Case::images(33, "smooth normals where light grazes the surface", &["hard/smooth-terminator"]),
    Case::rays(34, "non-planar quads", 10, MANY, flat::crooked_quads, &["hard/nonplanar-quad"]),
    Case::images(35, "facing mirrors, 200 bounces", &["hard/facing-mirrors", "hard/emission-alone"]),
    Case::images(36, "exponents of 0 to 1 000 000", &["hard/exponents"]),
    Case::rays(39, "ellipsoids with axes of 1e-6 to 1e6, from inside", 12, MANY, edges::needles, &[]),
    Case::rays(40, "t ranges that begin before the origin", 6, MANY, boxes::before_the_origin, &[]),
    Case::images(41, "spot lights of 0 to 180 degrees, and light along a floor", &["hard/cones", "hard/cone-without-angle"]),
    Case::rays(44, "instances rotated, stretched, sheared, mirrored and moved", 60, MANY, instances::any, &["instances"]),
    Case::images(45, "cut-outs at the threshold, on shared edges, in front of a copy", &["hard/cut-outs"]),
    Case::images(46, "vertex colours at vertices and edges", &["hard/vertex-colors"]),
    Case::rays(48, "rays with integer ends, which are where they meet triangles", 6, MANY, boxes::at_ends, &[]),
    Case::rays(49, "edges and vertices of slivers, of sheets a few ulp apart and of wide quads", 6, MANY, agreement::aimed, &[]),
    Case::images(50, "normals that maps turn below the surface", &["hard/normal-maps", "materialmaps"]),
    Case::rays(51, "depth images as meshes, seen from where they were taken", 8, MANY, edges::scans, &[]),
    Case::images(52, "trilinear footprints at grazing angles", &["texturefilter"]),
    Case::images(53, "texels that are NaN or infinite", &["hard/no-numbers"]),
    Case::images(54, "rays of a lens, and points of lights", &["DoF-sobol", "testareajitter", "hemisphere"]),
    Case::images(57, "transparent balls and panes, and solids that touch and overlap", &["glass", "drink"]),
    Case::images(61, "ambient light that things around take away", &["occlusion"]),
];

/// The case with that number.
pub fn case(number: u32) -> Option<&'static Case> {
    CASES.iter().find(|case| case.number == number)
}
