//! Values at the corners of a mesh's triangles.

use wavecrest_base::shared::Shared;

/// Values for each corner of each triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CornerValues<T> {
    /// The distinct values.
    pub values: Shared<T>,
    /// The value of each corner of each triangle, [`NO_VALUE`] for none; or `None` if values are
    /// indexed like positions.
    pub indices: Option<Shared<[u32; 3]>>,
}

/// In [`CornerValues::indices`]: this corner has no value.
pub const NO_VALUE: u32 = u32::MAX;

/// Values indexed like positions.
impl<T> From<Vec<T>> for CornerValues<T> {
    fn from(values: Vec<T>) -> Self {
        Shared::from(values).into()
    }
}

/// Values indexed like positions.
impl<T> From<Shared<T>> for CornerValues<T> {
    fn from(values: Shared<T>) -> Self {
        Self { values, indices: None }
    }
}

impl<T: Copy> CornerValues<T> {
    /// The values at the corners of the mesh's `triangle`th triangle, whose positions have the
    /// indices `positions`.
    #[inline(always)]
    pub fn corners(&self, triangle: usize, positions: [u32; 3]) -> Option<[T; 3]> {
        let [a, b, c] = self.indices.as_ref().map_or(positions, |indices| indices[triangle]);
        let value = |index: u32| self.values.get(index as usize).copied();
        Some([value(a)?, value(b)?, value(c)?])
    }
}

impl<T> CornerValues<T> {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
            + self.indices.as_ref().map_or(0, |i| size_of_val(i.as_slice()))
    }
}
