//! What shapes in view see: mirrors that show nothing are none, and nothing is in the way of ambient light if no
//! shape is within its distance of another.

use hecs::World;

use super::{MOST_TESTS, size};
use crate::components::Sky;
use crate::systems::environment;
use crate::systems::frame::Frame;
use crate::systems::geometry::build;
use crate::systems::materials::mirrored;
use crate::systems::placement::ShapeInstance;
use crate::systems::reach::{BEHIND, Extent, is_convex, is_faced};
use crate::systems::surface::{SurfaceColumns, SurfaceComponents};
use crate::systems::view::visible_faces;
use crate::systems::visibility::Faces;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::slab::Aabb;

/// Finds out which mirrors in view show nothing, and whether rays that go on from others, or through shapes,
/// may meet something.
pub(super) fn run(world: &World, frame: &Frame, all: &mut [ShapeInstance]) -> Result<bool> {
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let is_mirror = |one: &ShapeInstance| {
        let SurfaceComponents { material, maps, .. } = SurfaceComponents::of(&surfaces, one.entity);
        let mirrors = material.is_some_and(|material| mirrored(material, frame) > 0.0);
        one.visibility.is_seen && frame.settings.bounces > 0 && (mirrors || maps.metal.is_some())
    };
    let skies = || world.query::<&mut Sky>();
    let is_enclosed = environment::is_bright(world) || skies().iter().next().is_some();
    let pupils = frame.cameras.iter().map(Extent::of_pupil).collect();
    let mut sight = Sight { world, pupils, tests: 0 };
    let mut shows_others = false;
    for (i, one) in all.iter().enumerate() {
        if one.visibility.is_seen && !one.is_of_light() {
            shows_others = shows_others
                || one.visibility.is_transparent
                || is_mirror(one)
                    && (is_enclosed || sight.sees(all, i, false, f64::INFINITY)? == Some(true));
        }
    }
    for i in (0..all.len()).filter(|_| !is_enclosed) {
        if is_mirror(&all[i]) {
            let sees = sight.sees(all, i, shows_others, f64::INFINITY)?;
            all[i].visibility.is_mirror = sees != Some(false);
        }
    }
    for sky in skies().iter().filter(|sky| sky.samples > 0) {
        let Some(distance) = sky.distance else { continue };
        // Media absorb what crosses them, and rays replace the maps that tell how much light is kept away.
        let is_plain = |one: &ShapeInstance| {
            let surface = SurfaceComponents::of(&surfaces, one.entity);
            !one.visibility.is_transparent && surface.maps.occlusion.is_none()
        };
        let mut is_open = all.iter().all(is_plain);
        for i in (0..all.len()).filter(|&i| !all[i].is_of_light()) {
            is_open = is_open
                && (!shows_others && !all[i].visibility.is_seen
                    || sight.sees(all, i, shows_others, distance)? != Some(true));
        }
        if is_open {
            sky.samples = 0;
        }
    }
    Ok(shows_others)
}

/// Which shapes see others.
struct Sight<'a> {
    world: &'a World,
    pupils: Vec<Extent>,
    tests: u64,
}

impl Sight<'_> {
    /// Whether rays that leave a shape may meet another or itself within a `distance`: from any side, or else from
    /// those that camera rays may meet; `None` if there is no such side.
    fn sees(
        &mut self,
        all: &[ShapeInstance],
        number: usize,
        any_side: bool,
        distance: f64,
    ) -> Result<Option<bool>> {
        let Self { world, pupils, tests } = self;
        let one = &all[number];
        if one.is_mesh() {
            return Ok(Some(true));
        }
        let (arrays, shapes) = build(world, vec![one.clone()], true)?;
        let (geometry, (_, _, shape, _)) = (&arrays.geometry, &shapes[0]);
        let faces = match any_side {
            true => Faces::lit(shape),
            false => {
                let Faces { front, back } = visible_faces(shape, pupils, geometry, tests);
                // The front of a sphere hides its back.
                let sphere = geometry.quadrics.first().and_then(Quadric::sphere);
                let is_hidden = sphere.is_some_and(|(center, radius)| {
                    !one.is_cut_out && pupils.iter().all(|pupil| pupil.is_beyond(center, radius))
                });
                Faces { front, back: back && !is_hidden }
            }
        };
        if !faces.any() {
            return Ok(None);
        }
        let is_other = |(i, other): &(usize, &ShapeInstance)| {
            // Shadow rays, which look no further than a distance, pass the shapes of lights.
            *i != number && (distance.is_infinite() || !other.is_of_light())
        };
        let mut may_meet = |(_, other): (usize, &ShapeInstance)| {
            *tests += 1;
            *tests > MOST_TESTS as u64
                || gap(&one.bounds, &other.bounds) <= distance
                    && is_faced(shape, faces, &Extent::of_box(&other.bounds), geometry, tests)
        };
        let bends = one.normal_mapped || !is_convex(shape, faces, geometry);
        Ok(Some(bends || all.iter().enumerate().filter(is_other).any(&mut may_meet)))
    }
}

/// A lower bound on the distance of points of one box from those of another.
fn gap(a: &Aabb, b: &Aabb) -> f64 {
    let between = (a.low - b.high).max(b.low - a.high).max_element();
    f64::from(between) * (1.0 - BEHIND) - BEHIND * size(a).max(size(b))
}
