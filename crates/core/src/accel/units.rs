//! The tree's bytes: on huge pages if the system has them.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

/// Bytes are laid out in units of two cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(128))]
pub struct Unit(pub [u32; 32]);

/// Units, on huge pages if the system has them: rays access memory at random, and with pages of 4
/// KiB the processor would spend its time on page look-ups.
#[derive(Debug, Default)]
pub(super) enum Units {
    #[default]
    None,
    /// The map, and the range of units in use.
    Mapped(memmap2::MmapMut, Range<usize>),
    /// For systems that map no memory.
    Owned(Vec<Unit>),
}

impl Units {
    /// `count` zeroed units. On systems that map memory, unwritten units take none.
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
                // A hint: if it is refused, pages are small.
                #[cfg(target_os = "linux")]
                let _ = map.advise(memmap2::Advice::HugePage);
                Self::Mapped(map, 0..count)
            }
            Err(_) => Self::Owned(vec![Unit::zeroed(); count]),
        }
    }

    /// Keeps the units in `kept`, counted from the current first.
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
