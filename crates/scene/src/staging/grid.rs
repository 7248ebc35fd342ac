//! Hits of parallel rays through a file along its axes: enough to tell a room from a statue, and a
//! floor from a wall; and of the rays of a camera: enough to tell how bright lamps make its image.
//!
//! The box around the file, or the pyramid before the camera, is cut into columns. The triangles
//! that meet the ray through the centre of each column are found triangle by triangle, so that no
//! tree is needed and every triangle is read once. Most triangles of a large mesh are between the
//! rays, as the places of their corners tell, which are found once for each point.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;

use super::Scenery;
use super::fit::{NEAREST, axes};
use crate::components::View;
use wavecrest_base::parallel;
use wavecrest_core::kernels::camera::half_extent;

/// Columns along each side of a face of the box.
pub(super) const COLUMNS: usize = 24;
/// Triangles in a batch.
const BATCH: usize = 1 << 16;
/// Largest total number of ray-triangle tests: about a second's work.
const MOST_TESTS: u64 = 1 << 28;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct MetTriangle {
    /// From 0 at the low end of the box to 1 at the high end.
    pub(super) at: f64,
    /// Whether the front faces the high end.
    pub(super) faces_high: bool,
    /// Normal to it in the file, of any length.
    normal: [f64; 3],
}

/// The hits of the ray through the centre of a column.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ColumnHits {
    /// Nearest to the low end, and to the high end.
    pub(super) ends: Option<[MetTriangle; 2]>,
    /// Nearest to the centre of the box, below it and above.
    pub(super) below: Option<MetTriangle>,
    pub(super) above: Option<MetTriangle>,
}

/// The columns along x, y and z.
pub(super) struct Grid {
    columns: Vec<ColumnHits>,
}

impl Grid {
    /// The grid of the box around the `contents`. `None` without points, or if it takes too long.
    pub(super) fn of(contents: &Scenery<'_>) -> Option<Self> {
        let [low, high] = contents.ends;
        let size = high - low;
        if !size.is_finite() {
            return None;
        }
        let unit = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
        let scale = DVec3::new(unit(size.x), unit(size.y), unit(size.z));
        let into = |point| (point - low) * scale;
        Self::filled(
            contents,
            |point| place(into(point)),
            |part, file| {
                let corners = file.map(into);
                (0..3).map(|axis| part.add(axis, &corners, &file)).sum()
            },
        )
    }

    /// Points that a camera sees, one in each cell of its image, with normals of any length. `None` if
    /// it takes too long.
    pub(super) fn seen(contents: &Scenery<'_>, view: &View) -> Option<Vec<[DVec3; 2]>> {
        let axes = axes(view.up, (view.location - view.look).normalize());
        let [across, along] = half_extent(&view.placement());
        let near = contents.sphere.radius * NEAREST;
        let into = |point: DVec3| {
            let DVec3 { x, y, z } = axes.transpose() * (point - view.location);
            DVec3::new(x / across, y / along, -z)
        };
        // Planes remain planes: the high end of the unit cube is the nearest.
        let project = |DVec3 { x, y, z }: DVec3| {
            DVec3::new((x / z + 1.0) / 2.0, (y / z + 1.0) / 2.0, near / z)
        };
        let place = |point| match into(point) {
            point if point.z >= near => place(project(point)),
            _ => BEFORE_NEAR,
        };
        let grid = Self::filled(contents, place, |part, file| {
            let parts = clipped(file.map(into), near);
            parts.map(|corners| part.add(2, &corners.map(project), &file)).sum()
        })?;
        let center = |cell: usize| (cell as f64 + 0.5) / COLUMNS as f64 * 2.0 - 1.0;
        let point = |(i, column): (usize, &ColumnHits)| {
            let [_, nearest] = column.ends?;
            let (x, y) = (center(i % COLUMNS), center(i / COLUMNS));
            let way = axes * DVec3::new(x * across, y * along, -1.0);
            Some([view.location + way * (near / nearest.at), nearest.normal.into()])
        };
        Some(grid.along(2).iter().enumerate().filter_map(point).collect())
    }

    /// The grid that `add` fills with each triangle that may meet a ray, as the `place` of its corners
    /// tells; it returns the number of rays tested. `None` if it takes too long.
    fn filled(
        contents: &Scenery<'_>,
        place: impl Fn(DVec3) -> Place + Sync,
        add: impl Fn(&mut Self, [DVec3; 3]) -> u64 + Sync,
    ) -> Option<Self> {
        let tests = AtomicU64::new(0);
        let mut grid = Self::empty();
        for instance in &contents.all {
            let mut places = vec![Place::default(); instance.points.len()];
            parallel::each_mut(&mut places, |i, own| *own = place(instance.point(i)));
            let batches = instance.triangles.chunks(BATCH);
            let parts = parallel::with_state(batches, Self::empty, |part, triangles| {
                if tests.load(Ordering::Relaxed) <= MOST_TESTS {
                    let add = |triangle: &[u32; 3]| {
                        let is_met = may_meet(triangle.map(|i| places[i as usize]));
                        if is_met { add(part, instance.corners(*triangle)) } else { 0 }
                    };
                    let count = triangles.iter().map(add).sum();
                    tests.fetch_add(count, Ordering::Relaxed);
                }
            });
            grid = parts.into_iter().fold(grid, Self::merged);
        }
        (tests.into_inner() <= MOST_TESTS).then_some(grid)
    }

    fn empty() -> Self {
        Self { columns: vec![ColumnHits::default(); 3 * COLUMNS * COLUMNS] }
    }

    /// The columns along an axis, in rows of the next axis but one.
    pub(super) fn along(&self, axis: usize) -> &[ColumnHits] {
        let count = COLUMNS * COLUMNS;
        &self.columns[axis * count..(axis + 1) * count]
    }

    /// Adds a triangle of the unit cube, with these corners in the `file`, to the columns along an axis;
    /// returns the number of rays tested.
    fn add(&mut self, axis: usize, corners: &[DVec3; 3], file: &[DVec3; 3]) -> u64 {
        let [next, last] = across(axis);
        let cells = |side: usize| corners.map(|p| among_rays(p)[side]);
        let u = cells(next);
        let Some(columns) = rays_within(u) else { return 0 };
        let v = cells(last);
        let Some(rows) = rays_within(v) else { return 0 };
        let edge = |i: usize, j: usize, x: f64, y: f64| {
            (u[j] - u[i]) * (y - v[i]) - (v[j] - v[i]) * (x - u[i])
        };
        let area = edge(0, 1, u[2], v[2]);
        if area == 0.0 || !area.is_finite() {
            return 0;
        }
        for row in rows.clone() {
            for column in columns.clone() {
                let (x, y) = (column as f64, row as f64);
                let weights = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| edge(i, j, x, y) / area);
                if weights.iter().all(|&weight| weight >= 0.0) {
                    let at = (0..3).map(|i| weights[i] * corners[i][axis]).sum();
                    let normal = (file[1] - file[0]).cross(file[2] - file[0]).into();
                    let met = MetTriangle { at, faces_high: area > 0.0, normal };
                    // Stray parts are far outside of the box.
                    if (at - 0.5).abs() < 1.0 {
                        self.columns[(axis * COLUMNS + row) * COLUMNS + column].meet(met);
                    }
                }
            }
        }
        (rows.len() * columns.len()) as u64
    }

    fn merged(mut self, other: Self) -> Self {
        for (own, other) in self.columns.iter_mut().zip(other.columns) {
            let ends = other.ends.into_iter().flatten();
            ends.chain(other.below).chain(other.above).for_each(|met| own.meet(met));
        }
        self
    }
}

/// The axes next to an axis, and next but one.
pub(super) fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Where a point of the unit cube is among the rays in the direction of x, y and z: the number of ends
/// of gaps between the rays that it is at or past.
type Place = [u8; 4];

/// That of a point of which no place is known: no other is the same in any direction.
const BEFORE_NEAR: Place = [u8::MAX; 4];

/// The place of a point of the unit cube.
fn place(point: DVec3) -> Place {
    let along = |x: f64| {
        let ray = (x as i32).min(COLUMNS as i32);
        (2 * ray.max(0) + i32::from(x >= 0.0) + i32::from(x > f64::from(ray))) as u8
    };
    let [x, y, z] = among_rays(point).to_array().map(along);
    [x, y, z, 0]
}

/// A point of the unit cube in distances between rays, from the first rays on.
fn among_rays(point: DVec3) -> DVec3 {
    point * COLUMNS as f64 - 0.5
}

/// Whether a triangle with corners at these places may meet a ray: they differ in two directions. All
/// may be on a ray, which then sees the triangle from its edge.
fn may_meet(corners: [Place; 3]) -> bool {
    let [a, b, c] = corners.map(u32::from_ne_bytes);
    let differing = (a ^ b) | (a ^ c);
    // From its last byte that is not 0 on there is more than that byte.
    differing >> (differing.trailing_zeros() & 24) > u32::from(u8::MAX)
}

/// The parts of a triangle where z is at least `near`: none, one or two triangles.
fn clipped(corners: [DVec3; 3], near: f64) -> impl Iterator<Item = [DVec3; 3]> {
    let (mut polygon, mut count) = ([DVec3::ZERO; 4], 0);
    let mut push = |point| {
        polygon[count] = point;
        count += 1;
    };
    let is_before = |point: DVec3| point.z >= near;
    for i in 0..3 {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        if is_before(from) {
            push(from);
        }
        if is_before(from) != is_before(to) {
            push(from.lerp(to, (near - from.z) / (to.z - from.z)));
        }
    }
    (2..count).map(move |i| [polygon[0], polygon[i - 1], polygon[i]])
}

/// The rays at whole numbers between the least and the greatest of `x`. By conversions: rounding
/// takes a call where the processor is not known to have an instruction.
fn rays_within(x: [f64; 3]) -> Option<Range<usize>> {
    let (least, greatest) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
    let low = least.max(0.0) as usize;
    let low = low + usize::from((low as f64) < least);
    let high = (greatest >= 0.0).then(|| (greatest as usize).min(COLUMNS - 1) + 1)?;
    (low < high).then_some(low..high)
}

impl ColumnHits {
    /// The outermost hits, from the low end on, or from the high end with that end as the low one.
    pub(super) fn outermost(&self, from_high: bool) -> Option<[MetTriangle; 2]> {
        let turned =
            |met: MetTriangle| MetTriangle { at: 1.0 - met.at, faces_high: !met.faces_high, ..met };
        self.ends
            .map(|[low, high]| if from_high { [turned(high), turned(low)] } else { [low, high] })
    }

    /// Records a hit of the ray. The order does not matter.
    fn meet(&mut self, met: MetTriangle) {
        let sorted = |a: MetTriangle, b: MetTriangle| if a <= b { [a, b] } else { [b, a] };
        let ends = self.ends.map(|[low, high]| [sorted(low, met)[0], sorted(high, met)[1]]);
        self.ends = Some(ends.unwrap_or([met; 2]));
        if met.at <= 0.5 {
            self.below = Some(self.below.map_or(met, |below| sorted(below, met)[1]));
        } else {
            self.above = Some(self.above.map_or(met, |above| sorted(above, met)[0]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::contents;
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_sheet_of_many_triangles_is_met_in_each_column_once() {
        for side in [1_u32, 7, 23, 24, 48, 100] {
            let point = |i| Vec3::new((i % (side + 1)) as f32, (i / (side + 1)) as f32, 0.0);
            let points = (0..(side + 1).pow(2)).map(point).collect();
            let corners = (0..side.pow(2)).map(|i| i + i / side);
            let quad = |i| [[i, i + 1, i + side + 2], [i, i + side + 2, i + side + 1]];
            let sheet = (points, corners.flat_map(quad).collect());
            let grid = Grid::of(&contents(&sheet)).unwrap();
            let met = |axis| grid.along(axis).iter().filter(|column| column.ends.is_some()).count();
            assert_eq!([0, 1, 2].map(met), [0, 0, COLUMNS * COLUMNS], "{side}");
            assert!(
                grid.along(2)
                    .iter()
                    .flat_map(|column| column.ends)
                    .flatten()
                    .all(|met| { met.faces_high && met.at == 0.0 && met.normal[2] > 0.0 })
            );
        }
    }
}
