//! Where the tree's bytes are: on huge pages if the system has them.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

/// Bytes are laid out in units of two cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(128))]
pub struct Unit(pub [u32; 32]);

/// Units on huge pages where the system has them: a ray goes from place to place, and with pages of
/// 4 KiB the processor spends its time looking up where they are.
#[derive(Debug, Default)]
pub(super) enum Units {
    #[default]
    None,
    /// The map, and which units of it count.
    Mapped(memmap2::MmapMut, Range<usize>),
    /// Where the system maps no memory.
    Owned(Vec<Unit>),
}

impl Units {
    /// `count` units of zeros. What is not written takes no memory where the system maps it.
    pub(super) fn zeroed(count: usize) -> Self {
        if count == 0 {
            return Self::None;
        }
        match memmap2::MmapOptions::new()
            .len(count * size_of::<Unit>())
            .no_reserve_swap()
            .map_anon()
        {
            Ok(map) => {
                // A wish: where it is refused, pages are small.
                #[cfg(target_os = "linux")]
                let _ = map.advise(memmap2::Advice::HugePage);
                Self::Mapped(map, 0..count)
            }
            Err(_) => Self::Owned(vec![Unit::zeroed(); count]),
        }
    }

    /// Leaves the units in `kept`, counted from the first of them.
    pub(super) fn keep(&mut self, kept: Range<usize>) {
        match self {
            Self::None => {}
            Self::Mapped(_, range) => *range = range.start + kept.start..range.start + kept.end,
            Self::Owned(units) => {
                units.truncate(kept.end);
                units.drain(..kept.start);
                units.shrink_to_fit();
            }
        }
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [Unit] {
        match self {
            Self::None => &mut [],
            Self::Mapped(map, range) => &mut bytemuck::cast_slice_mut(map)[range.clone()],
            Self::Owned(units) => units,
        }
    }
}

impl std::ops::Deref for Units {
    type Target = [Unit];

    fn deref(&self) -> &[Unit] {
        match self {
            Self::None => &[],
            Self::Mapped(map, range) => &bytemuck::cast_slice(map)[range.clone()],
            Self::Owned(units) => units,
        }
    }
}
