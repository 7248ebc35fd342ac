//! Exact counts of the work of a render: they show that a scene pays only for the effects it uses.

use crate::accel::{Kernels, TestCounts};

/// Counts for one thread or for a whole render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Camera rays.
    pub primary_rays: u64,
    /// Mirror rays.
    pub secondary_rays: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Points sampled on the lens.
    pub lens_samples: u64,
    /// Points sampled on area lights.
    pub light_samples: u64,
    /// Hits whose colour was interpolated between vertices.
    pub colors: u64,
    /// Texels read.
    pub texels: u64,
    /// Footprints of rays on surfaces: one for each look-up in a trilinear texture, and one for
    /// each mirror ray if there are such textures.
    pub footprints: u64,
    /// Tests of boxes and primitives.
    pub tests: TestCounts,
    /// Rays by the kernel that traced them.
    pub kernels: Kernels,
    /// Samples that were not finite; they count as black.
    pub invalid: u64,
    /// The first of these in the order of pixels.
    pub first_invalid: Option<Sample>,
    /// Shadow rays to a light within the rounding error of the surface: its distance counts as that
    /// error.
    pub lights_at_surface: u64,
}

/// A sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Sample {
    /// The pixel: its row times the image's width plus its column.
    pub pixel: u32,
    /// The camera ray within the pixel.
    pub sample: u32,
}

impl Counters {
    /// Counts samples that were not finite; `first` is the first of them.
    pub fn add_invalid(&mut self, count: u64, first: Option<Sample>) {
        self.invalid += count;
        self.first_invalid = [self.first_invalid, first].into_iter().flatten().min();
    }
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.primary_rays += other.primary_rays;
        self.secondary_rays += other.secondary_rays;
        self.shadow_rays += other.shadow_rays;
        self.lens_samples += other.lens_samples;
        self.light_samples += other.light_samples;
        self.colors += other.colors;
        self.texels += other.texels;
        self.footprints += other.footprints;
        self.tests += other.tests;
        self.kernels += other.kernels;
        self.add_invalid(other.invalid, other.first_invalid);
        self.lights_at_surface += other.lights_at_surface;
    }
}
