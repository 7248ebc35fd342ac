//! What shapes in view see: mirrors that show nothing are none, and nothing is in the way of ambient light if no
//! shape is within its distance of another.

use super::{MOST_TESTS, Scene, size};
use crate::components::{Maps, Material, Sky};
use crate::environment;
use crate::systems::geometry::{Form, Occurrence, build};
use crate::systems::materials::mirrored;
use crate::systems::reach::{BEHIND, Extent, Faces, is_convex, is_faced};
use crate::systems::view::visible_faces;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::slab::Aabb;

/// Finds out which mirrors in view show nothing, and whether rays that go on from others, or through shapes,
/// may meet something.
pub(super) fn run(
    scene: &Scene<'_>,
    all: &mut [Occurrence<'_>],
    boxes: &[(Aabb, f32)],
) -> Result<bool> {
    let skies = || scene.world.query::<&mut Sky>();
    let is_enclosed = environment::is_bright(scene.world) || skies().iter().next().is_some();
    let pupils = scene.cameras.iter().map(Extent::of_pupil).collect();
    let mut sight = Sight { scene, boxes, pupils, tests: 0 };
    let mut shows_others = false;
    for (i, one) in all.iter().enumerate().filter(|(_, one)| one.is_seen && one.light.is_none()) {
        shows_others = shows_others
            || one.is_transparent
            || scene.is_mirror(one)
                && (is_enclosed || sight.sees(all, i, false, f64::INFINITY)? == Some(true));
    }
    for i in (0..all.len()).filter(|_| !is_enclosed) {
        if all[i].is_seen && scene.is_mirror(&all[i]) {
            all[i].is_mirror = sight.sees(all, i, shows_others, f64::INFINITY)? != Some(false);
        }
    }
    for sky in skies().iter().filter(|sky| sky.samples > 0) {
        let Some(distance) = sky.distance else { continue };
        // Media absorb what crosses them, and rays replace the maps that tell how much light is kept away.
        let is_plain = |one: &Occurrence<'_>| !one.is_transparent && !scene.is_occluded(one);
        let mut is_open = all.iter().all(is_plain);
        for i in (0..all.len()).filter(|&i| all[i].light.is_none()) {
            is_open = is_open
                && (!shows_others && !all[i].is_seen
                    || sight.sees(all, i, shows_others, distance)? != Some(true));
        }
        if is_open {
            sky.samples = 0;
        }
    }
    Ok(shows_others)
}

impl Scene<'_> {
    fn is_occluded(&self, of: &Occurrence<'_>) -> bool {
        self.world.get::<&Maps>(of.entity).is_ok_and(|maps| maps.occlusion.is_some())
    }

    fn is_mirror(&self, of: &Occurrence<'_>) -> bool {
        let material = self.world.get::<&Material>(of.entity);
        let maps = self.world.get::<&Maps>(of.entity);
        self.settings.bounces > 0
            && (material.is_ok_and(|material| mirrored(&material) > 0.0)
                || maps.is_ok_and(|maps| maps.metal.is_some()))
    }
}

/// Which shapes see others.
struct Sight<'a> {
    scene: &'a Scene<'a>,
    boxes: &'a [(Aabb, f32)],
    pupils: Vec<Extent>,
    tests: u64,
}

impl Sight<'_> {
    /// Whether rays that leave a shape may meet another or itself within a `distance`: from any side, or else from
    /// those that camera rays may meet; `None` if there is no such side.
    fn sees(
        &mut self,
        all: &[Occurrence<'_>],
        number: usize,
        any_side: bool,
        distance: f64,
    ) -> Result<Option<bool>> {
        let Self { scene, boxes, pupils, tests } = self;
        let one = all[number];
        if matches!(one.form, Form::Mesh) {
            return Ok(Some(true));
        }
        let output = build(scene.world, vec![one], true)?;
        let (geometry, shape) = (&output.geometry, &output.shapes[0].shape);
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
        let is_other = |(i, other): &(usize, &Occurrence<'_>)| {
            // Shadow rays, which look no further than a distance, pass the shapes of lights.
            *i != number && (distance.is_infinite() || other.light.is_none())
        };
        let (own, _) = &boxes[number];
        let mut may_meet = |(i, _)| {
            let (bounds, _): &(Aabb, f32) = &boxes[i];
            *tests += 1;
            *tests > MOST_TESTS as u64
                || gap(own, bounds) <= distance
                    && is_faced(shape, faces, &Extent::of_box(bounds), geometry, tests)
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
