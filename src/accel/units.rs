//! Where the tree's bytes are: on huge pages if the system has them.

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
    Mapped(memmap2::MmapMut),
    /// Where the system maps no memory.
    Owned(Vec<Unit>),
}

impl Units {
    /// `count` units of zeros.
    pub(super) fn zeroed(count: usize) -> Self {
        if count == 0 {
            return Self::None;
        }
        match memmap2::MmapMut::map_anon(count * size_of::<Unit>()) {
            Ok(map) => {
                // A wish: where it is refused, pages are small.
                #[cfg(target_os = "linux")]
                let _ = map.advise(memmap2::Advice::HugePage);
                Self::Mapped(map)
            }
            Err(_) => Self::Owned(vec![Unit::zeroed(); count]),
        }
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [Unit] {
        match self {
            Self::None => &mut [],
            Self::Mapped(map) => bytemuck::cast_slice_mut(map),
            Self::Owned(units) => units,
        }
    }
}

impl std::ops::Deref for Units {
    type Target = [Unit];

    fn deref(&self) -> &[Unit] {
        match self {
            Self::None => &[],
            Self::Mapped(map) => bytemuck::cast_slice(map),
            Self::Owned(units) => units,
        }
    }
}
