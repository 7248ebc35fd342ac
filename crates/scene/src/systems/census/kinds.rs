//! Kinds of primitives: those that rays may meet count.

use super::{Census, Found, count, present};
use wavecrest_core::geometry::Primitive;
use wavecrest_core::prepared::Shape;

impl Census<'_> {
    /// The shapes of a kind that rays may meet.
    fn of_kind(&self, is: impl Fn(Primitive) -> bool) -> impl Iterator<Item = &Shape> {
        let is_one = move |shape: &&Shape| {
            shape.primitives.clone().next().is_some_and(|first| is(self.geometry.primitive(first)))
        };
        self.shapes.iter().map(|facts| facts.shape).filter(is_one)
    }

    /// The number of primitives of a kind that rays may meet, or the reason for none.
    pub(super) fn kind(&self, is: impl Fn(Primitive) -> bool, thing: &str, none: &str) -> Found {
        count(self.of_kind(is).map(|shape| shape.primitives.len()).sum(), thing, none)
    }

    pub(super) fn triangles(&self) -> Found {
        let is_own = |primitive| matches!(primitive, Primitive::Triangle(_));
        let is_shown = |primitive| matches!(primitive, Primitive::Instanced(_));
        let instances: Vec<&Shape> = self.of_kind(is_shown).collect();
        if instances.is_empty() {
            return self.kind(is_own, "triangle", "rays meet no triangle and no mesh");
        }
        // Each has instances, and those without triangles are not met.
        let prototypes = self.geometry.prototypes.iter().map(|one| one.triangles.len());
        let held: usize = prototypes.clone().sum();
        let (_, meshes) = count(prototypes.filter(|&triangles| triangles > 0).count(), "mesh", "");
        let number = |shape: &Shape| shape.primitives.len();
        let instanced: usize = instances.iter().copied().map(number).sum();
        let (_, instances) = count(instances.len(), "instance", "");
        let own = match self.of_kind(is_own).map(number).sum::<usize>() {
            0 => String::new(),
            own => format!("{own}, and "),
        };
        present(format!("{own}{instanced} in {instances} of {meshes}; {held} are stored"))
    }

    /// The number of spheres, or else of disks.
    pub(super) fn quadrics(&self, are_spheres: bool, thing: &str) -> Found {
        let is_sphere = |i: usize| self.geometry.quadrics[i].sphere().is_some();
        let is = |one| matches!(one, Primitive::Quadric(i) if is_sphere(i) == are_spheres);
        self.kind(is, thing, &format!("rays meet no {thing}"))
    }
}
