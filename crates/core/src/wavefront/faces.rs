//! Hits on surfaces, collected to be shaded together.
//!
//! The data of hits is spread over memory. It is fetched for a block of hits, loop by loop, so that
//! many loads are in flight at a time, before any computation. Hits on classes with maps, or that
//! are transparent, wait in larger numbers and are [sorted](SortedHits) before.

use std::ops::Range;

use crate::geometry::ShadingKind;
use crate::math::{Ray, Single};
use crate::prepared::{Face, Group, PreparedScene};

/// Groups of hits that are fetched together: a block.
pub(super) const GROUPS: usize = 8;

/// Fetches the data of a block of hits, with corners only if needed.
#[inline(always)]
pub(super) fn fetch<'a, F: Single>(
    groups: &'a mut [Group<F>; GROUPS],
    faces: &[Face],
    with_corners: bool,
    scene: &PreparedScene,
    ray: impl Fn(usize) -> Ray + Copy,
) -> &'a [Group<F>] {
    for face in if with_corners { faces } else { &[] } {
        face.prefetch_corners(scene.accel.geometry());
    }
    let count = faces.len().div_ceil(F::LANES).min(GROUPS);
    for (group, faces) in groups.iter_mut().zip(faces.chunks(F::LANES)) {
        group.begin(faces, &scene.appearance);
    }
    let asked = if with_corners { count } else { 0 };
    for group in &mut groups[..asked] {
        for lane in 0..F::LANES {
            let number = group.faces[lane].ray as usize;
            group.fetch(lane, scene, || ray(number));
        }
    }
    &groups[..count]
}

/// Hits that wait to be sorted by class and kind: enough for long spans, and so few that what one
/// span sends on starts near to what the next one does.
const SORTED: usize = 1024;

/// Hits that are sorted by class and kind.
#[derive(Debug, Default)]
pub(super) struct SortedHits {
    waiting: Vec<(u32, Face)>,
    sorted: Vec<Face>,
    /// For each class and kind the slot of its next hit; a number of hits while these are counted.
    /// Empty before the first hit: there may be many classes, all of them plain.
    slots: Vec<u32>,
    classes: usize,
    /// Classes and kinds that occur, in the order of their first hits.
    found: Vec<u32>,
    /// Memory for the spans, each with its kind.
    spans: Vec<(ShadingKind, Range<usize>)>,
}

impl SortedHits {
    /// For hits on this number of classes.
    pub(super) fn new(classes: usize) -> Self {
        Self { classes, ..Self::default() }
    }

    /// Adds a hit. Returns whether to sort them.
    #[inline(always)]
    pub(super) fn push(&mut self, face: Face, class: u32, kind: ShadingKind) -> bool {
        let key = class * ShadingKind::ALL.len() as u32 + kind as u32;
        if self.slots.is_empty() {
            self.slots.resize(self.classes * ShadingKind::ALL.len(), 0);
        }
        let hits = &mut self.slots[key as usize];
        if *hits == 0 {
            self.found.push(key);
        }
        *hits += 1;
        self.waiting.push((key, face));
        self.waiting.len() == SORTED
    }

    /// Whether none waits.
    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Sorts the hits, those of a class in their order. Returns those of each class and kind.
    pub(super) fn sort(&mut self) -> impl Iterator<Item = (ShadingKind, &[Face])> {
        let Self { waiting, sorted, slots, found, spans, .. } = self;
        let mut end = 0;
        spans.extend(found.iter().map(|&key| {
            let slot = &mut slots[key as usize];
            let faces = end..end + *slot as usize;
            (*slot, end) = (end as u32, faces.end);
            (ShadingKind::ALL[key as usize % ShadingKind::ALL.len()], faces)
        }));
        sorted.resize(waiting.len(), Face::default());
        for (key, face) in waiting.drain(..) {
            let slot = &mut slots[key as usize];
            sorted[*slot as usize] = face;
            *slot += 1;
        }
        found.drain(..).for_each(|key| slots[key as usize] = 0);
        spans.drain(..).map(|(kind, faces)| (kind, &sorted[faces]))
    }
}
