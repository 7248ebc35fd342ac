//! The columns of batches.

use glam::Vec3;

use crate::math::{LANES, Single, Vector};

/// Declares a structure of arrays: a column for each field, all of the same length.
macro_rules! columns {
    (
        $(#[$doc:meta])*
        $name:ident { $( $(#[$field_doc:meta])* $field:ident : $kind:ty ),+ $(,)? }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default)]
        pub struct $name {
            $( $(#[$field_doc])* pub $field: $kind, )+
            rows: usize,
            /// Rows to allocate at the first one.
            wanted: usize,
            allocated: usize,
        }

        impl $name {
            /// Columns for up to `capacity` rows, not allocated yet: see [`Self::provide`].
            pub fn with_capacity(capacity: usize) -> Self {
                Self { wanted: capacity, ..Self::default() }
            }

            /// Allocates all rows; call it before appending the first.
            #[inline(always)]
            pub fn provide(&mut self) {
                if self.wanted > 0 {
                    self.set_aside();
                }
            }

            #[cold]
            #[inline(never)]
            fn set_aside(&mut self) {
                let allocated = $crate::wavefront::batch::columns::room(self.wanted);
                *self = Self {
                    $( $field: Column::with_rows(allocated), )+
                    rows: 0,
                    wanted: 0,
                    allocated,
                };
            }

            /// Removes every row and keeps the memory.
            pub fn clear(&mut self) {
                self.rows = 0;
            }

            /// Number of rows.
            pub fn len(&self) -> usize {
                self.rows
            }

            /// Whether there is no row.
            pub fn is_empty(&self) -> bool {
                self.rows == 0
            }

            /// Bytes held.
            pub fn bytes(&self) -> usize {
                self.allocated * Self::ROW_BYTES
            }

            /// Bytes that one row takes.
            pub const ROW_BYTES: usize = 0 $( + <$kind as Column>::ITEM_BYTES )+;
        }
    };
}

/// Allocated rows for a `capacity`. If no row is ever written, neither is a vector.
pub(in crate::wavefront) const fn room(capacity: usize) -> usize {
    if capacity == 0 { 0 } else { capacity + LANES }
}

/// A column: a scalar or a vector for each row.
pub(super) trait Column {
    const ITEM_BYTES: usize;

    fn with_rows(rows: usize) -> Self;
}

impl<T: Copy + Default> Column for Vec<T> {
    const ITEM_BYTES: usize = size_of::<T>();

    fn with_rows(rows: usize) -> Self {
        vec![T::default(); rows]
    }
}

impl Column for Vectors {
    const ITEM_BYTES: usize = 3 * size_of::<f32>();

    fn with_rows(rows: usize) -> Self {
        Self { x: vec![0.0; rows], y: vec![0.0; rows], z: vec![0.0; rows] }
    }
}

/// A column of vectors, stored as a column for each coordinate.
#[derive(Clone, Debug, Default)]
pub struct Vectors {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Vectors {
    /// The `i`th vector.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Replaces the `i`th vector.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    /// Adds `v` to the `i`th vector.
    #[inline(always)]
    pub fn add(&mut self, i: usize, v: Vec3) {
        self.x[i] += v.x;
        self.y[i] += v.y;
        self.z[i] += v.z;
    }

    /// The vectors from the `i`th on.
    #[inline(always)]
    pub fn load<F: Single>(&self, token: F::Token, i: usize) -> Vector<F> {
        let from = |values: &[f32]| F::from_slice(token, &values[i..i + F::LANES]);
        Vector::new(from(&self.x), from(&self.y), from(&self.z))
    }

    /// A column for each axis.
    pub(super) fn columns(&self) -> [&[f32]; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// Replaces the vectors from the `i`th on.
    #[inline(always)]
    pub fn store<F: Single>(&mut self, i: usize, v: Vector<F>) {
        v.x.store(&mut self.x[i..i + F::LANES]);
        v.y.store(&mut self.y[i..i + F::LANES]);
        v.z.store(&mut self.z[i..i + F::LANES]);
    }

    /// The vectors of these rows, one for each lane.
    #[inline(always)]
    pub fn gather<F: Single>(&self, token: F::Token, rows: &[u32; LANES]) -> Vector<F> {
        if is_row::<F>(rows) {
            return self.load(token, rows[0] as usize);
        }
        Vector::lanes(token, |lane| self.get(rows[lane] as usize))
    }

    /// Replaces the vectors from the `i`th on by those of `mask`, packed.
    #[inline(always)]
    pub(super) fn pack<F: Single>(&mut self, i: usize, v: Vector<F>, mask: F::Mask) {
        v.x.pack(mask, &mut self.x[i..i + F::LANES]);
        v.y.pack(mask, &mut self.y[i..i + F::LANES]);
        v.z.pack(mask, &mut self.z[i..i + F::LANES]);
    }
}

/// Whether the lanes' numbers are consecutive.
#[inline(always)]
pub(in crate::wavefront) fn is_row<F: Single>(numbers: &[u32; LANES]) -> bool {
    let mut row = true;
    for (lane, &number) in numbers.iter().enumerate().take(F::LANES) {
        row &= number == numbers[0].wrapping_add(lane as u32);
    }
    row
}
