//! What rays are inside of.
//!
//! A solid is what the front of a surface encloses, if the material refracts or absorbs light. Where
//! solids overlap or nest, one of them is the medium: that of the highest priority (Schmidt and Budge,
//! *Simple Nested Dielectrics in Ray Traced Images*, 2002). So a surface is an interface between two
//! media, and one of a solid that is the medium on neither side is not there.

use glam::{DVec3, Vec3};

use super::{PreparedScene, Shape};
use crate::accel::Traversal;
use crate::kernels::Arithmetic;
use crate::kernels::transmission::remaining;
use crate::math::Ray;

/// What is inside of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Index of refraction, relative to air.
    pub ior: f32,
    /// Light absorbed, by channel, per scene unit (Beer's law).
    pub absorption: Vec3,
}

impl Solid {
    /// Outside of all solids.
    pub const AIR: Self = Self { ior: 1.0, absorption: Vec3::ZERO };
}

/// In place of a solid.
const NONE: u32 = u32::MAX;

/// The solids that a ray is inside of, by their indices in [`PreparedScene::solids`], each as often as
/// it was entered; the medium first. Of more than eight, those of the lowest priority are forgotten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MediumStack([u32; 8]);

impl Default for MediumStack {
    fn default() -> Self {
        Self([NONE; 8])
    }
}

impl MediumStack {
    /// The solid that is the medium; `None` in air.
    pub fn medium(&self) -> Option<u32> {
        Some(self.0[0]).filter(|&solid| solid != NONE)
    }

    /// The solids, the medium first.
    pub fn solids(&self) -> impl Iterator<Item = u32> {
        self.0.into_iter().take_while(|&solid| solid != NONE)
    }

    /// Inside of `solid` too.
    fn enter(mut self, mut solid: u32) -> Self {
        for place in &mut self.0 {
            if solid < *place {
                std::mem::swap(place, &mut solid);
            }
        }
        self
    }

    /// Without the solid at this place.
    fn without(mut self, place: usize) -> Self {
        self.0.copy_within(place + 1.., place);
        self.0[self.0.len() - 1] = NONE;
        self
    }
}

/// The media on both sides of a surface, in the direction of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sides {
    pub(super) before: MediumStack,
    pub(super) beyond: MediumStack,
}

impl PreparedScene {
    /// The medium of a ray inside of these solids.
    pub fn medium(&self, media: &MediumStack) -> Solid {
        media.medium().map_or(Solid::AIR, |solid| self.solids[solid as usize])
    }

    /// The media on both sides of a surface of `shape` that a ray inside of `media` meets from behind
    /// if `leaves`. Surfaces that enclose a solid together may belong to shapes that look alike. A solid that
    /// is left without having been entered, as it has no closed surface, was around the ray before.
    pub(super) fn sides(&self, media: MediumStack, shape: &Shape, leaves: bool) -> Sides {
        let Some(solid) = shape.solid else { return Sides { before: media, beyond: media } };
        if !leaves {
            return Sides { before: media, beyond: media.enter(solid) };
        }
        let alike = |other: u32| self.solids[other as usize] == self.solids[solid as usize];
        let place = media.solids().position(|other| other == solid);
        match place.or_else(|| media.solids().position(alike)) {
            Some(place) => Sides { before: media, beyond: media.without(place) },
            None => Sides { before: media.enter(solid), beyond: media },
        }
    }

    /// The share of light that remains after a way inside of `media`, in scene units.
    pub(super) fn absorbed(&self, media: &MediumStack, way: f64) -> DVec3 {
        remaining(self.medium(media).absorption, way)
    }

    /// What is left if a ray is inside of the second media along this way, instead of the first.
    pub(super) fn more_absorbed(&self, [known, other]: [&MediumStack; 2], way: f64) -> DVec3 {
        let [known, other] = [known, other].map(|media| self.medium(media).absorption);
        remaining((other - known).max(Vec3::ZERO), way)
    }

    /// Whether there is an interface between two media: they differ, or only one of them is air.
    pub(super) fn differ(&self, Sides { before, beyond }: &Sides) -> bool {
        match (before.medium(), beyond.medium()) {
            (Some(a), Some(b)) => self.solids[a as usize] != self.solids[b as usize],
            (a, b) => a != b,
        }
    }

    /// The solids whose closed surfaces contain the camera: along any line from there they are left once
    /// more than entered. What two opposite lines do not agree on is open.
    pub fn media_at_camera<P: Arithmetic>(&self, traversal: &mut Traversal) -> MediumStack {
        let mut media = MediumStack::default();
        if self.solids.is_empty() {
            return media;
        }
        // No usual axis, so that few lines run in planes or through edges.
        let line = Vec3::new(0.48, 0.64, 0.6);
        let mut hits = Vec::new();
        let mut counts = [line, -line].map(|direction| {
            let ray = Ray::new(self.camera.origin(), direction);
            self.accel.search::<P>().crossings(&ray, traversal, &mut hits);
            let mut left = vec![0_i32; self.solids.len()];
            for hit in &hits {
                let shape = &self.appearance.shapes[self.appearance.shape_of(hit.primitive)];
                if let Some(solid) = shape.solid {
                    let (_, leaves) = self.surface_of::<P>(&ray, hit);
                    left[solid as usize] += if leaves { 1 } else { -1 };
                }
            }
            left
        });
        let [along, against] = &mut counts;
        for (solid, (a, b)) in (0..).zip(along.iter().zip(against)) {
            (0..*a.min(b)).for_each(|_| media = media.enter(solid));
        }
        media
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_medium_is_the_solid_of_the_highest_priority() {
        let mut media = MediumStack::default();
        assert_eq!(media.medium(), None);
        for (solid, medium) in [(5, 5), (7, 5), (2, 2), (5, 2)] {
            media = media.enter(solid);
            assert_eq!(media.medium(), Some(medium));
        }
        assert_eq!(media.solids().collect::<Vec<_>>(), [2, 5, 5, 7]);
        assert_eq!(media.without(0).without(1).solids().collect::<Vec<_>>(), [5, 7]);
        (0..9).for_each(|_| media = media.enter(1));
        assert_eq!(media.solids().collect::<Vec<_>>(), [1; 8]);
    }
}
