//! Accessors: the elements in the bytes of a view.
//!
//! An accessor is checked once: its last element must end within its view, and its sparse part may
//! change only existing elements. After that, reading an element cannot fail, so that all threads
//! can read those of a large mesh.

use wavecrest_base::error::Result;
use wavecrest_base::parallel;

use super::buffer::{Buffer, BufferView};
use super::fields::Fields;
use crate::mesh::Scalar;

/// The format's codes of types of numbers.
const COMPONENTS: [(u64, Scalar); 6] = [
    (5120, Scalar::I8),
    (5121, Scalar::U8),
    (5122, Scalar::I16),
    (5123, Scalar::U16),
    (5125, Scalar::U32),
    (5126, Scalar::F32),
];

/// The type of the numbers of an accessor or of its sparse part.
fn component(fields: &Fields<'_>) -> Result<Scalar> {
    let must_be = "5120 (i8), 5121 (u8), 5122 (i16), 5123 (u16), 5125 (u32) or 5126 (f32)";
    fields.need("componentType", "5120 to 5123, 5125 or 5126")?;
    Ok(fields.code("componentType", &COMPONENTS, must_be)?.unwrap_or(Scalar::F32))
}

/// Whether an index may have numbers of a type.
pub(super) fn is_index(component: Scalar) -> bool {
    matches!(component, Scalar::U8 | Scalar::U16 | Scalar::U32)
}

/// The number of components of an element, by the name of its type.
const TYPES: [(&str, usize); 7] =
    [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4), ("MAT2", 4), ("MAT3", 9), ("MAT4", 16)];

/// Evenly spaced elements in a view.
#[derive(Clone, Debug)]
struct Strided {
    view: usize,
    offset: usize,
    stride: usize,
}

/// Elements that replace those of the rows.
#[derive(Clone, Debug)]
struct Sparse {
    /// Their indices, in rising order.
    which: Vec<u32>,
    values: Strided,
}

/// A list of elements with several components each.
#[derive(Clone, Debug)]
pub(super) struct Accessor {
    rows: Option<Strided>,
    sparse: Option<Sparse>,
    pub(super) count: usize,
    pub(super) component: Scalar,
    /// Number of components of an element.
    pub(super) width: usize,
    pub(super) normalized: bool,
}

/// The bytes of a file, and the accessors to them.
pub(super) struct Storage {
    buffers: Vec<Buffer>,
    views: Vec<BufferView>,
    pub(super) accessors: Vec<Accessor>,
}

impl Storage {
    /// Reads the lists of a file, each only if the one before it is right; `binary` is the buffer
    /// without a URI.
    pub(super) fn read(top: &Fields<'_>, binary: Option<&Buffer>) -> Result<Self> {
        let mut number = 0;
        let buffers = top.list("buffers", "a buffer", |fields| {
            number += 1;
            Buffer::read(fields, binary.filter(|_| number == 1))
        })?;
        let views = top.list("bufferViews", "a buffer view", |f| BufferView::read(f, &buffers))?;
        let mut own = Self { buffers, views, accessors: Vec::new() };
        own.accessors = top.list("accessors", "an accessor", |f| Accessor::read(f, &own))?;
        Ok(own)
    }

    /// Bytes of all buffers.
    pub(super) fn len(&self) -> usize {
        self.buffers.iter().map(|buffer| buffer.bytes().len()).sum()
    }

    /// The bytes of a view.
    pub(super) fn bytes(&self, view: usize) -> &[u8] {
        let BufferView { buffer, range, .. } = &self.views[view];
        &self.buffers[*buffer].bytes()[range.clone()]
    }

    /// The elements of an accessor.
    pub(super) fn elements(&self, number: usize) -> Elements<'_> {
        let accessor = &self.accessors[number];
        Elements {
            accessor,
            rows: accessor.rows.as_ref().map(|rows| self.bytes(rows.view)),
            values: accessor.sparse.as_ref().map(|sparse| self.bytes(sparse.values.view)),
        }
    }
}

impl Accessor {
    /// Reads an element of `accessors`, and checks that its elements exist.
    fn read(fields: &Fields<'_>, storage: &Storage) -> Result<Self> {
        let component = component(fields)?;
        let width = fields.need("type", "\"SCALAR\", \"VEC2\", ...")?.choice(&TYPES)?;
        let count = fields.need_count("count")?;
        let view = fields.index("bufferView", "bufferViews")?;
        let (offset, size) = (fields.offset()?, component.size() * width);
        let rows = |view| rows(fields, storage, (view, offset), size, count);
        let rows = view.map(rows).transpose()?;
        let sparse = sparse(fields, storage, size, count)?;
        check_extremes(fields, width)?;
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        // Elements without data are zeros; their number is limited by the bytes of the file.
        if rows.is_none() && count > storage.len().max(ZEROS_ANYHOW) {
            let error = fields.error_at("count", "the data of this many elements is missing");
            return Err(error.remedy("give the accessor a bufferView"));
        }
        let normalized = fields.flag("normalized")? && component != Scalar::F32;
        Ok(Self { rows, sparse, count, component, width, normalized })
    }
}

/// Number of elements that may be zeros in any file.
const ZEROS_ANYHOW: usize = 1 << 16;

/// The minimum and maximum elements are not used, but if their type differs from the elements', the
/// declared type is doubtful.
fn check_extremes(fields: &Fields<'_>, width: usize) -> Result<()> {
    for cursor in ["min", "max"].into_iter().filter_map(|key| fields.get(key)) {
        let numbers = cursor.value().as_array();
        if !numbers.is_some_and(|all| all.len() == width && all.iter().all(|x| x.is_number())) {
            return Err(cursor.error(format!("must be a list of {width} numbers")));
        }
    }
    Ok(())
}

/// The rows of `count` elements of `size` bytes each in a view, from the offset on.
fn rows(
    fields: &Fields<'_>,
    storage: &Storage,
    (view, offset): (usize, u64),
    size: usize,
    count: u64,
) -> Result<Strided> {
    let BufferView { stride, range, .. } = &storage.views[view];
    let stride = stride.unwrap_or(size);
    // All are at most 2^53.
    let last = u128::from(count.saturating_sub(1)) * stride as u128;
    let end = u128::from(offset) + if count == 0 { 0 } else { last + size as u128 };
    let there = range.len();
    if end > there as u128 {
        let error = fields.error(format!("needs {end} bytes of a buffer view that has {there}"));
        return Err(error.remedy("check that the file is whole, or export it again"));
    }
    Ok(Strided { view, offset: offset as usize, stride })
}

fn sparse(
    fields: &Fields<'_>,
    storage: &Storage,
    size: usize,
    count: u64,
) -> Result<Option<Sparse>> {
    let Some(sparse) = fields.object("sparse")? else { return Ok(None) };
    let changed = sparse.need_count("count")?;
    let place = |fields: &Fields<'_>, size: usize| {
        let at = (fields.need_index("bufferView", "bufferViews")?, fields.offset()?);
        rows(fields, storage, at, size, changed)
    };
    let indices = sparse.need_object("indices", "an object")?;
    let component = component(&indices)?;
    if !is_index(component) {
        let message = "an index must be of the type 5121, 5123 or 5125";
        return Err(indices.error_at("componentType", message));
    }
    let at = place(&indices, component.size())?;
    let values = place(&sparse.need_object("values", "an object")?, size)?;
    let bytes = storage.bytes(at.view);
    // The range was just checked.
    let which: Vec<u32> = (0..changed as usize)
        .filter_map(|i| component.number(bytes.get(at.offset + i * at.stride..)?))
        .map(|index| index as u32)
        .collect();
    let rises = which.is_sorted_by(|a, b| a < b);
    if !rises || which.last().is_some_and(|&last| u64::from(last) >= count) {
        let error =
            indices.error(format!("must increase, and stay below the accessor's count of {count}"));
        return Err(error.remedy("export the file again"));
    }
    Ok(Some(Sparse { which, values }))
}

/// The elements of an accessor.
#[derive(Clone, Copy)]
pub(super) struct Elements<'a> {
    accessor: &'a Accessor,
    rows: Option<&'a [u8]>,
    values: Option<&'a [u8]>,
}

impl Elements<'_> {
    /// The first `N` components of element `i`; zeros for missing ones.
    pub(super) fn get<const N: usize>(&self, i: usize) -> [f64; N] {
        let component = self.accessor.component;
        let bytes = self.bytes_of(i);
        let number = |k: usize| component.number(bytes?.get(k * component.size()..)?);
        let scale = |x: f64| match self.accessor.normalized {
            // The smallest signed integer is slightly below -1, and counts as -1.
            true => (x / f64::from(component.greatest().unwrap_or(1))).max(-1.0),
            false => x,
        };
        std::array::from_fn(|k| number(k).map_or(0.0, scale))
    }

    fn bytes_of(&self, i: usize) -> Option<&[u8]> {
        let changed = self.accessor.sparse.as_ref().and_then(|sparse| {
            let at = sparse.which.binary_search(&u32::try_from(i).ok()?).ok()?;
            Some((self.values?, &sparse.values, at))
        });
        let own = || Some((self.rows?, self.accessor.rows.as_ref()?, i));
        let (bytes, rows, i) = changed.or_else(own)?;
        bytes.get(rows.offset + i * rows.stride..)
    }

    /// The elements of the indices in `which`, or all, converted by `make` on all threads.
    pub(super) fn each<T: Clone + Default + Send, const N: usize>(
        &self,
        which: Option<&[u32]>,
        make: impl Fn([f64; N]) -> T + Sync + Send,
    ) -> Vec<T> {
        let mut values = vec![T::default(); which.map_or(self.accessor.count, <[u32]>::len)];
        parallel::each_mut(&mut values, |i, value| {
            *value = make(self.get(which.map_or(i, |which| which[i] as usize)));
        });
        values
    }

    /// All elements as integers, on all threads.
    pub(super) fn indices(&self) -> Vec<u32> {
        let component = self.accessor.component;
        // Exact: the type is that of indices.
        let index =
            |i| self.bytes_of(i).and_then(|bytes| component.number(bytes)).unwrap_or(0.0) as u32;
        let mut indices = vec![0; self.accessor.count];
        parallel::each_mut(&mut indices, |i, into| *into = index(i));
        indices
    }
}
