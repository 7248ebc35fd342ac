//! How a mesh would stand with any of its axes up: what it would rest on, and what is above that.

use glam::{DVec2, DVec3};

use super::grid::{Grid, MetTriangle, across};
use super::ground::hull;
use super::{Scenery, visible};
use crate::options::framing::Up;
use wavecrest_base::parallel;

/// Largest distance of a support from the lowest point, as a share of the height.
pub(super) const BASE_DEPTH: f64 = 0.02;
/// The same for what has legs and is not higher than long: some feet of what steps are in the air.
pub(super) const RAISED: f64 = 0.12;
/// Largest share of a support polygon that is above what supports it, for legs.
const LEGS: f64 = 0.3;
/// Smallest share of the bounding rectangle that a support polygon covers: along the usual axis,
/// where little is enough to leave a mesh as it is,
const COULD_STAND: f64 = 0.1;
/// and for all that is at most [`RAISED`], where a mesh is on its ground: more than below four legs.
const RESTS: f64 = 0.75;
/// Smallest share of hits from below on the outside of a mesh that stands: an open mesh that lies on
/// its rim is not a closed one on its base.
const CLOSED: f64 = 0.75;
/// Largest mean difference between a mesh and its mirror image, as a share of its length: that of
/// left and right is below a twelfth, of top and bottom above a fifth.
pub(super) const SYMMETRIC: f64 = 0.1;
/// Smallest share of hits from below on a ground: walls, trees and holes are not hit there,
const GROUND: f64 = 0.5;
/// and largest height of a ground, as a share of that of everything.
const GROUND_DEPTH: f64 = 0.25;
/// Largest height of what lies flat, as a share of its shorter side.
pub(super) const FLAT: f64 = 0.35;
/// Share of the hits from above with a single layer.
const NEARLY_ALL: f64 = 0.9;
/// Smallest share of its bounding rectangle that terrain covers.
const TERRAIN_COVERS: f64 = 0.6;
/// Cells along each side of a face of the box, for the heights above it: feet cover several.
const CELLS: usize = 64;

/// The least heights of the points above the faces of the box around everything, as shares of its
/// size, in cells of each face: for each axis those from the low end, then those from the high end.
/// None are above [`RAISED`], where no support is.
pub(super) struct Heights(Vec<f32>);

impl Heights {
    pub(super) fn of(contents: &Scenery<'_>) -> Self {
        let [low, high] = contents.ends;
        let scale = (high - low).map(|size| if size > 0.0 { 1.0 / size } else { 0.0 });
        let none = || vec![f32::INFINITY; 6 * CELLS * CELLS];
        let add = |heights: &mut Vec<f32>, point: DVec3| {
            let share = (point - low) * scale;
            let cell = |x: f64| ((x * CELLS as f64) as u32 as usize).min(CELLS - 1);
            for axis in 0..3 {
                let [from_low, from_high] = [share[axis], 1.0 - share[axis]].map(|x| x as f32);
                if from_low.min(from_high) > RAISED as f32 {
                    continue;
                }
                let [u, v] = across(axis).map(|side| cell(share[side]));
                let cell = ((2 * axis) * CELLS + v) * CELLS + u;
                heights[cell] = heights[cell].min(from_low);
                heights[cell + CELLS * CELLS] = heights[cell + CELLS * CELLS].min(from_high);
            }
        };
        let merged = |mut a: Vec<f32>, b: Vec<f32>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a = a.min(b));
            a
        };
        let all = parallel::with_state(contents.blocks(), none, |heights, block| {
            visible(block, 1).for_each(|point| add(heights, point));
        });
        Self(all.into_iter().fold(none(), merged))
    }
}

/// A mesh with this axis up.
pub(super) struct Pose<'a> {
    pub(super) up: Up,
    pub(super) axis: usize,
    size: DVec3,
    /// The outermost hits in the columns along the axis, from below and from above.
    columns: Vec<Option<[MetTriangle; 2]>>,
    /// The least heights of its points above its base.
    heights: &'a [f32],
}

impl<'a> Pose<'a> {
    pub(super) fn new(up: Up, grid: &Grid, heights: &'a Heights, size: DVec3) -> Self {
        let upward = up.axes().y_axis;
        let axis = upward.abs().max_position();
        let is_low = upward[axis] < 0.0;
        let columns = grid.along(axis).iter().map(|column| column.outermost(is_low)).collect();
        let face = 2 * axis + usize::from(is_low);
        let heights = &heights.0[face * CELLS * CELLS..(face + 1) * CELLS * CELLS];
        Self { up, axis, size, columns, heights }
    }

    /// The height as a share of the shorter side.
    pub(super) fn height(&self) -> f64 {
        let [a, b] = across(self.axis).map(|side| self.size[side]);
        self.size[self.axis] / a.min(b)
    }

    pub(super) fn is_flat(&self) -> bool {
        self.height() <= FLAT
    }

    /// Whether there is one layer that faces up, and covers most of the ground.
    pub(super) fn is_field(&self) -> bool {
        let covered = self.columns.iter().flatten().count() as f64;
        let is_layer = |[low, high]: [MetTriangle; 2]| low.at == high.at && high.faces_high;
        self.size[self.axis] > 0.0
            && self.is_flat()
            && covered >= TERRAIN_COVERS * self.columns.len() as f64
            && self.share(is_layer) >= NEARLY_ALL
    }

    /// Whether bottom and top differ.
    pub(super) fn differs(&self) -> bool {
        self.size[self.axis] > 0.0 && self.asymmetry() >= SYMMETRIC
    }

    /// The mean of what `of` makes of the outermost hits, over the columns with hits.
    fn mean(&self, of: impl Fn([MetTriangle; 2]) -> f64) -> f64 {
        let met = || self.columns.iter().flatten();
        met().map(|ends| of(*ends)).sum::<f64>() / met().count() as f64
    }

    /// The share of the columns with hits whose outermost hits are such.
    fn share(&self, is: impl Fn([MetTriangle; 2]) -> bool) -> f64 {
        self.mean(|ends| f64::from(u8::from(is(ends))))
    }

    /// Whether hits from below are on the outside.
    pub(super) fn is_closed(&self) -> bool {
        self.share(|[low, _]| !low.faces_high) >= CLOSED
    }

    /// The mean difference between a mesh and its mirror image along the axis.
    pub(super) fn asymmetry(&self) -> f64 {
        self.mean(|[low, high]| (low.at + high.at - 1.0).abs())
    }

    /// Whether the base is a sheet that faces up, as the ground of a courtyard does, and no back of
    /// a cupboard.
    pub(super) fn has_ground(&self) -> bool {
        self.share(|[low, _]| low.faces_high && low.at <= GROUND_DEPTH) >= GROUND
    }

    pub(super) fn falls(&self) -> bool {
        self.support(BASE_DEPTH) < COULD_STAND
    }

    /// Whether nearly all of it is above something low, as a courtyard with a well below its ground.
    pub(super) fn rests(&self) -> bool {
        self.differs() && self.height() <= 1.0 && self.support(RAISED) >= RESTS
    }

    /// Whether it is on legs, some of which are raised, with a wider support than in its `own` pose,
    /// unless that is on one of two like sides.
    pub(super) fn steps(&self, own: &Self, least: f64) -> bool {
        let legs = self.columns.iter().flatten().filter(|[low, _]| low.at <= RAISED).count() as f64;
        let (support, share) = (self.support(RAISED), legs / self.columns.len() as f64);
        let [a, b] = across(self.axis).map(|side| self.size[side]);
        let is_high = self.size[self.axis] > a.max(b);
        let is_wider = own.asymmetry() < SYMMETRIC || own.support(RAISED) < support;
        !is_high && support >= least && share <= LEGS * support && is_wider
    }

    /// The share of the bounding rectangle that the support polygon covers, of what is at most a
    /// `depth` above the lowest point, as a share of the height; 0 if its centre is outside.
    pub(super) fn support(&self, depth: f64) -> f64 {
        let center = |cell: usize| (cell as f64 + 0.5) / CELLS as f64 - 0.5;
        let base = (0..).zip(self.heights).filter(|(_, height)| f64::from(**height) <= depth);
        let points = base.map(|(i, _)| DVec2::new(center(i % CELLS), center(i / CELLS)));
        let corners = hull(points.collect());
        let next = corners.iter().cycle().skip(1);
        let parts = corners.iter().zip(next).map(|(a, b)| b.perp_dot(*a));
        // Twice the areas of triangles from the centre to each edge.
        if parts.clone().all(|area| area >= 0.0) { parts.sum::<f64>() / 2.0 } else { 0.0 }
    }
}
