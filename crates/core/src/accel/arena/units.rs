//! The tree's bytes: on huge pages if the system has them.

#![allow(unsafe_code, reason = "threads write to parts of the memory before these are published")]

use std::cell::UnsafeCell;
use std::sync::atomic::{AtomicUsize, Ordering};

use bytemuck::{Pod, Zeroable};

use wavecrest_base::memory::Mapped;

/// Bytes are laid out in units of two cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(128))]
pub struct Unit(pub [u32; 32]);

/// Units, on huge pages if the system has them: rays access memory at random, and with pages of 4
/// KiB the processor would spend its time on page look-ups. Threads append to them while others
/// read what is there.
#[derive(Debug, Default)]
pub(crate) struct Units {
    memory: UnitMemory,
    /// The number of all units, and of those in use, which are the first.
    room: usize,
    used: AtomicUsize,
    /// The first unit in use: those before it are left out.
    start: usize,
}

#[derive(Debug, Default)]
enum UnitMemory {
    #[default]
    None,
    Mapped(memmap2::MmapRaw, Mapped),
    /// For systems that map no memory.
    Owned(Box<[SharedUnit]>),
}

/// A unit that is written through a shared reference.
#[derive(Debug)]
#[repr(transparent)]
struct SharedUnit(UnsafeCell<Unit>);

// SAFETY: `Units::append` gives each unit to one thread, once.
unsafe impl Sync for SharedUnit {}

impl Units {
    /// Room for `room` units, of which the first `used` are in use, and zero. `None` if the system
    /// maps no memory: there, unwritten units take none.
    pub(crate) fn mapped(room: usize, used: usize) -> Option<Self> {
        let map = memmap2::MmapOptions::new()
            .len(room.max(1) * size_of::<Unit>())
            .no_reserve_swap()
            .map_anon()
            .ok()?;
        // A hint: if it is refused, pages are small.
        #[cfg(target_os = "linux")]
        let _ = map.advise(memmap2::Advice::HugePage);
        let counted = Mapped::default();
        counted.add(used * size_of::<Unit>());
        let memory = UnitMemory::Mapped(map.into(), counted);
        Some(Self { memory, room, used: used.into(), start: 0 })
    }

    /// As [`Self::mapped`], on any system.
    pub(crate) fn zeroed(room: usize, used: usize) -> Self {
        Self::mapped(room, used).unwrap_or_else(|| {
            let units = (0..room).map(|_| SharedUnit(UnsafeCell::new(Unit::zeroed()))).collect();
            Self { memory: UnitMemory::Owned(units), room, used: used.into(), start: 0 }
        })
    }

    /// The number of units in use.
    pub(crate) fn len(&self) -> usize {
        self.used.load(Ordering::Relaxed) - self.start
    }

    /// The first unit in use. All others are behind it.
    #[inline(always)]
    pub(crate) fn as_ptr(&self) -> *const Unit {
        self.base().wrapping_add(self.start)
    }

    #[inline(always)]
    fn base(&self) -> *mut Unit {
        match &self.memory {
            UnitMemory::None => std::ptr::dangling_mut(),
            UnitMemory::Mapped(map, _) => map.as_mut_ptr().cast(),
            UnitMemory::Owned(units) => units.as_ptr().cast::<Unit>().cast_mut(),
        }
    }

    /// Copies `units` behind all in use and returns their place; `None` if there is no room.
    pub(crate) fn append(&self, units: &[Unit]) -> Option<usize> {
        let longer = |used: usize| used.checked_add(units.len()).filter(|&end| end <= self.room);
        let used = self.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, longer).ok()?;
        if let UnitMemory::Mapped(_, counted) = &self.memory {
            counted.add(size_of_val(units));
        }
        // SAFETY: the units from `used` on are within the room, and no other call gets them: `used`
        // only grows. They are read only after the caller has published their place.
        unsafe { self.base().add(used).copy_from_nonoverlapping(units.as_ptr(), units.len()) };
        Some(used - self.start)
    }

    /// Writes `units` to those before `end` and leaves out the units before them.
    pub(crate) fn begin_with(&mut self, units: &[Unit], end: usize) -> Option<()> {
        let start = end.checked_sub(units.len()).filter(|_| end <= *self.used.get_mut())?;
        // SAFETY: the units are in use, and `&mut self` is the only reference to them.
        unsafe { self.base().add(start).copy_from_nonoverlapping(units.as_ptr(), units.len()) };
        self.start = start;
        Some(())
    }

    /// All units in use.
    pub(crate) fn as_mut_slice(&mut self) -> &mut [Unit] {
        let len = self.len();
        // SAFETY: the units are initialised, within the room, and borrowed through `&mut self`.
        unsafe { std::slice::from_raw_parts_mut(self.as_ptr().cast_mut(), len) }
    }
}
