//! What rays are inside of.
//!
//! A solid is what the front of a surface encloses, if the material refracts or absorbs light. Where
//! solids overlap or nest, one of them is the medium: that of the highest priority (Schmidt and Budge,
//! *Simple Nested Dielectrics in Ray Traced Images*, 2002). So a surface is an interface between two
//! media, and one of a solid that is the medium on neither side is not there.

use glam::{DVec3, Vec3};

use super::{PreparedScene, Shape};
use crate::accel::{Crossings, Traversal};
use crate::kernels::Arithmetic;
use crate::kernels::transmission::remaining;
use crate::math::Ray;
use crate::math::multisets::{EMPTY, Multisets};

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
/// it was entered: a multiset of [`Traversal::media`], the first of which is the medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MediumStack {
    medium: u32,
    solids: u32,
}

impl Default for MediumStack {
    fn default() -> Self {
        Self { medium: NONE, solids: EMPTY }
    }
}

impl MediumStack {
    /// The solid that is the medium; `None` in air.
    pub fn medium(&self) -> Option<u32> {
        Some(self.medium).filter(|&solid| solid != NONE)
    }

    fn of(solids: u32, all: &Multisets) -> Self {
        Self { medium: all.numbers(solids).next().unwrap_or(NONE), solids }
    }

    /// Inside of `solid` too.
    fn enter(self, solid: u32, all: &mut Multisets) -> Self {
        Self::of(all.with(self.solids, solid), all)
    }

    /// Inside of `solid` once less.
    fn leave(self, solid: u32, all: &mut Multisets) -> Self {
        Self::of(all.without(self.solids, solid), all)
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
    pub(super) fn sides(
        &self,
        media: MediumStack,
        shape: &Shape,
        leaves: bool,
        all: &mut Multisets,
    ) -> Sides {
        let Some(solid) = shape.solid else { return Sides { before: media, beyond: media } };
        if !leaves {
            return Sides { before: media, beyond: media.enter(solid, all) };
        }
        let alike = |&other: &u32| self.solids[other as usize] == self.solids[solid as usize];
        let own = all.numbers(media.solids).find(|&other| other == solid);
        match own.or_else(|| all.numbers(media.solids).find(alike)) {
            Some(left) => Sides { before: media, beyond: media.leave(left, all) },
            None => Sides { before: media.enter(solid, all), beyond: media },
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
        let mut crossings = Crossings::default();
        let mut counts = [line, -line].map(|direction| {
            let ray = Ray::new(self.camera.origin(), direction);
            self.accel.search::<P>().crossings(&ray, traversal, &mut crossings);
            let mut left = vec![0_i32; self.solids.len()];
            for hit in crossings.hits() {
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
            (0..*a.min(b)).for_each(|_| media = media.enter(solid, &mut traversal.media));
        }
        media
    }
}
