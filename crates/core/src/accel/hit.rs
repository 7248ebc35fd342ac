//! The answer to a closest-hit query.

/// The primitive number of a miss.
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// The answer to a closest-hit query.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Hit {
    /// Distance along the ray, in lengths of its direction, rounded once; infinite for a miss.
    pub t: f32,
    /// The primitive: of several the one with the least exact t, of equal t first those that shadow
    /// rays pass, then the one with the lowest number. [`NO_PRIMITIVE`] for a miss.
    pub primitive: u32,
}

impl Default for Hit {
    fn default() -> Self {
        Self::MISS
    }
}

impl Hit {
    /// No hit.
    pub const MISS: Self = Self { t: f32::INFINITY, primitive: NO_PRIMITIVE };

    /// Whether this is a miss.
    #[inline]
    pub fn is_miss(&self) -> bool {
        self.primitive == NO_PRIMITIVE
    }
}
