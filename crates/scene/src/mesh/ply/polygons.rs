//! Binary faces of any number of corners, a window of the file at a time, on all threads.
//!
//! Where a row begins depends on all rows before it. One thread therefore walks the window from
//! count to count, which is little work, and notes where pieces of it begin and how many triangles
//! come before; all threads then read the pieces, each into its part of the array.

use rayon::prelude::*;

use super::header::{Property, Scalar, Shape};
use super::source::{FaceRows, Faces};
use super::triangles::{greatest, limit, number};
use crate::mesh::data::MAX_COUNT;
use crate::mesh::place::{ReadAt, fill};
use crate::mesh::polygon::Polygon;

/// How many pieces a window has.
const PIECES: usize = 64;

/// A part of a row.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// So many bytes.
    Fixed(usize),
    /// A list that is not kept.
    List { count: Scalar, item: usize },
}

/// How to walk from row to row.
#[derive(Debug)]
struct Walk {
    before: Vec<Step>,
    count: Scalar,
    item: Scalar,
    /// No index is this or greater.
    limit: u32,
    after: Vec<Step>,
}

/// A row's list, by its place.
struct List {
    corners: u32,
    /// Where the indices begin.
    start: usize,
    /// Where the next row begins.
    end: usize,
}

impl Walk {
    /// `None` where counts or indices are not whole numbers.
    fn of(FaceRows { element, layout, .. }: FaceRows<'_>, vertices: usize) -> Option<Self> {
        let (before, rest) = element.properties.split_at_checked(layout.property)?;
        greatest(layout.count)?;
        Some(Self {
            before: steps(before)?,
            count: layout.count,
            item: layout.item,
            limit: limit(layout.item, vertices)?,
            after: steps(rest.get(1..)?)?,
        })
    }

    /// The row that begins at `at`; `None` where it is not all there, or is no face.
    #[inline(always)]
    fn row<const BIG: bool>(&self, bytes: &[u8], at: usize) -> Option<List> {
        let list = pass::<BIG>(&self.before, bytes, at)?;
        let corners = whole::<BIG>(self.count, bytes, list)?;
        let start = list + self.count.size();
        let end = start.checked_add((corners as usize).checked_mul(self.item.size())?)?;
        let end = pass::<BIG>(&self.after, bytes, end)?;
        (corners >= 3 && end <= bytes.len()).then_some(List { corners, start, end })
    }
}

fn steps(properties: &[Property]) -> Option<Vec<Step>> {
    let step = |p: &Property| match p.shape {
        Shape::One(kind) => Some(Step::Fixed(kind.size())),
        Shape::List { count, item } => {
            greatest(count).map(|_| Step::List { count, item: item.size() })
        }
    };
    properties.iter().map(step).collect()
}

/// Where these parts of a row end that begin at `at`.
#[inline(always)]
fn pass<const BIG: bool>(steps: &[Step], bytes: &[u8], mut at: usize) -> Option<usize> {
    for step in steps {
        at = match *step {
            Step::Fixed(size) => at.checked_add(size)?,
            Step::List { count, item } => {
                let length = whole::<BIG>(count, bytes, at)? as usize;
                at.checked_add(count.size())?.checked_add(length.checked_mul(item)?)?
            }
        };
    }
    Some(at)
}

/// The whole number at `at`, if it is there and not negative.
#[inline(always)]
fn whole<const BIG: bool>(kind: Scalar, bytes: &[u8], at: usize) -> Option<u32> {
    let rest = bytes.get(at..)?;
    let value = match kind.size() {
        1 if !rest.is_empty() => number::<1, BIG>(rest, 0),
        2 if rest.len() >= 2 => number::<2, BIG>(rest, 0),
        4 if rest.len() >= 4 => number::<4, BIG>(rest, 0),
        _ => return None,
    };
    (value <= greatest(kind)?).then_some(value)
}

/// A run of rows in a window.
#[derive(Clone, Copy, Debug, Default)]
struct Run {
    /// Where it begins.
    start: usize,
    rows: usize,
    triangles: usize,
}

/// Cuts the first rows of a window into runs of about `size` bytes: rows that are all there, not
/// over `rows` of them nor `triangles` triangles.
fn runs<const BIG: bool>(
    walk: &Walk,
    window: &[u8],
    size: usize,
    mut rows: u64,
    mut triangles: u64,
) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut run = Run::default();
    let mut at = 0;
    while rows > 0
        && let Some(list) = walk.row::<BIG>(window, at)
        && let Some(left) = triangles.checked_sub(u64::from(list.corners) - 2)
    {
        (rows, triangles) = (rows - 1, left);
        run.rows += 1;
        run.triangles += list.corners as usize - 2;
        at = list.end;
        if at - run.start >= size {
            runs.push(std::mem::replace(&mut run, Run { start: at, ..Run::default() }));
        }
    }
    if run.rows > 0 {
        runs.push(run);
    }
    runs
}

/// What came of a run.
struct Read {
    /// The polygons among its faces, counted from the first triangle of the run.
    polygons: Vec<Polygon>,
    /// How far it was read: rows and triangles, and where the next row begins.
    rows: usize,
    triangles: usize,
    end: usize,
}

/// Reads the faces of a run into `to`, up to the first that names a vertex that is not there.
fn read_run<const BIG: bool>(
    walk: &Walk,
    window: &[u8],
    run: Run,
    mut to: &mut [[u32; 3]],
) -> Read {
    let mut read = Read { polygons: Vec::new(), rows: 0, triangles: 0, end: run.start };
    while read.rows < run.rows
        && let Some(list) = walk.row::<BIG>(window, read.end)
    {
        let count = list.corners as usize - 2;
        let Some((face, rest)) = std::mem::take(&mut to).split_at_mut_checked(count) else { break };
        let size = walk.item.size();
        let items = &window[list.start..list.start + list.corners as usize * size];
        let greatest = match size {
            1 => fan::<1, BIG>(items, face),
            2 => fan::<2, BIG>(items, face),
            _ => fan::<4, BIG>(items, face),
        };
        if greatest >= walk.limit {
            break;
        }
        if count > 1 {
            // A run has far fewer than 2^32 triangles.
            read.polygons.push(Polygon { first: read.triangles as u32, corners: list.corners });
        }
        to = rest;
        read.rows += 1;
        read.triangles += count;
        read.end = list.end;
    }
    read
}

/// Writes the triangles of a face; returns the greatest index.
#[inline(always)]
fn fan<const N: usize, const BIG: bool>(items: &[u8], to: &mut [[u32; 3]]) -> u32 {
    let index = |i: usize| number::<N, BIG>(items, i * N);
    let (first, mut before) = (index(0), index(1));
    let mut greatest = first.max(before);
    for (i, to) in (2..).zip(to) {
        let next = index(i);
        *to = [first, before, next];
        greatest = greatest.max(next);
        before = next;
    }
    greatest
}

/// Reads the `runs` of a window on all threads, each into its part of `to`.
fn read_runs<const BIG: bool>(
    walk: &Walk,
    window: &[u8],
    runs: &[Run],
    mut to: &mut [[u32; 3]],
) -> Vec<Read> {
    let mut parts = Vec::with_capacity(runs.len());
    for run in runs {
        let (part, rest) = std::mem::take(&mut to).split_at_mut(run.triangles);
        parts.push((*run, part));
        to = rest;
    }
    let read = |(run, to)| read_run::<BIG>(walk, window, run, to);
    parts.into_par_iter().map(read).collect()
}

/// Where faces are read from.
#[derive(Clone, Copy)]
pub(super) struct Span<'a, F: ?Sized> {
    pub(super) file: &'a F,
    pub(super) place: u64,
    /// How many bytes are there.
    pub(super) left: u64,
    /// The size of a window.
    pub(super) window: usize,
}

impl<F: ReadAt + ?Sized> Span<'_, F> {
    /// Reads the window that begins so many bytes `after` the first; false where that fails.
    fn read(&self, after: u64, window: &mut Vec<u8>) -> bool {
        window.resize((self.left - after).min(self.window as u64) as usize, 0);
        fill(self.file, self.place + after, window).is_ok()
    }
}

/// Reads some of the next `most` faces: all up to the first that is at fault or longer than a window.
/// Returns how many faces and how many bytes.
pub(super) fn read<F: ReadAt + ?Sized, const BIG: bool>(
    from: Span<'_, F>,
    rows: FaceRows<'_>,
    most: u64,
    vertices: usize,
    into: &mut Faces,
) -> (u64, u64) {
    let (mut faces, mut bytes) = (0, 0);
    let Some(walk) = Walk::of(rows, vertices) else { return (faces, bytes) };
    let Faces { triangles, polygons } = into;
    let mut filled = triangles.len();
    if triangles.is_empty() {
        *triangles = vec![[0; 3]; rows.likely];
    }
    let mut window = Vec::new();
    let mut whole = true;
    while whole && faces < most && bytes < from.left && from.read(bytes, &mut window) {
        let room = MAX_COUNT.saturating_sub(filled as u64);
        let runs = runs::<BIG>(&walk, &window, from.window / PIECES, most - faces, room);
        let after = filled + runs.iter().map(|run| run.triangles).sum::<usize>();
        triangles.resize(after.max(triangles.len()), [0; 3]);
        let read = read_runs::<BIG>(&walk, &window, &runs, &mut triangles[filled..after]);
        // Up to the first run that was not read to its end.
        let short = runs.iter().zip(&read).position(|(run, read)| read.rows < run.rows);
        whole = !runs.is_empty() && short.is_none();
        let mut end = 0;
        for read in read.into_iter().take(short.map_or(runs.len(), |last| last + 1)) {
            // Triangles are fewer than 2^32.
            let shift = |p: Polygon| Polygon { first: p.first + filled as u32, ..p };
            polygons.extend(read.polygons.into_iter().map(shift));
            filled += read.triangles;
            faces += read.rows as u64;
            end = read.end;
        }
        bytes += end as u64;
    }
    triangles.truncate(filled);
    (faces, bytes)
}
