//! The work of a render by kind, as it is counted and as it is estimated.

use serde::Serialize;

use wavecrest_core::counters::Counters;

/// Rays by kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::statistics")]
pub struct Rays {
    pub primary: u64,
    pub secondary: u64,
    pub shadow: u64,
}

/// Samples by kind.
#[derive(Clone, Copy, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::statistics")]
pub struct Samples {
    pub lens: u64,
    pub light: u64,
    pub texels: u64,
    pub footprints: u64,
}

impl From<&Counters> for Rays {
    fn from(c: &Counters) -> Self {
        Self { primary: c.primary_rays, secondary: c.secondary_rays, shadow: c.shadow_rays }
    }
}

impl Rays {
    /// Rays of every kind.
    pub fn all(&self) -> u64 {
        self.primary + self.secondary + self.shadow
    }
}

impl From<&Counters> for Samples {
    fn from(c: &Counters) -> Self {
        Self {
            lens: c.lens_samples,
            light: c.light_samples,
            texels: c.texels,
            footprints: c.footprints,
        }
    }
}
