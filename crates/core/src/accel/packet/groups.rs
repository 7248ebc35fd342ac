//! Patches that many rays of a tile meet: sixteen rays against one triangle at a time.
//!
//! The waiting tests of all tiles go through four short loops together: shear the vertices for the
//! rays, find the triangles that are not missed, find where these are met, and store the results.
//! No loop has a data-dependent branch, so the processor never mispredicts.

mod fast;
mod report;
mod settle;

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, mask32x16};

use super::tile::{Column, GROUPS, Tile, WIDTH};
use crate::accel::TestCounts;
use crate::accel::arena::{Patch, Ref, View};
use crate::accel::query::Query;
use crate::accel::tree::Searched;
use crate::kernels::precision::Arithmetic;
use crate::kernels::triangle::lanes::ORDERS;
use crate::kernels::triangle::{Decision, Edges, RayRange, Sheared, decide};
use crate::math::real::Mask;
use crate::math::simd::{LANES, Lanes};

/// Largest number of waiting tests.
pub(super) const MOST_GROUPS: usize = 16;

/// A number for each of sixteen rays.
type Row = [f32; WIDTH];

/// Up to sixteen rays of a tile at a patch. The order of fields is that of [`Tile`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct PatchRays {
    /// The vertices in sheared space.
    vertices: [[Row; 3]; LANES],
    depth: Row,
    t_min: Row,
    t_max: Row,
    /// The closest t of the rays so far.
    best: Row,
    primitive: [u32; WIDTH],
    /// The rays' positions in the tile, and the used lanes, a bit each.
    positions: [u32; WIDTH],
    used: u32,
    /// Whether this is a whole group of the tile, in its order.
    is_whole: bool,
    tile: usize,
    place: Ref,
    /// The rays that hit a triangle here, a bit each.
    hit: u32,
    /// The rays that need the single test, and for each triangle which rays.
    open: u32,
    left: [u32; LANES],
}

/// A triangle and a group.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    group: u8,
    triangle: u8,
    /// The rays that are not outside the triangle.
    inside: u16,
}

/// The waiting tests.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    groups: Box<[PatchRays; MOST_GROUPS]>,
    count: usize,
    pairs: Box<[Pair; MOST_GROUPS * LANES + LANES]>,
}

/// A ray that needs the single test for some of a patch's triangles, a bit each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub(super) tile: usize,
    pub(super) place: Ref,
    pub(super) triangles: u32,
    pub(super) ray: usize,
}

impl Default for Groups {
    fn default() -> Self {
        let group = PatchRays {
            vertices: [[[0.0; WIDTH]; 3]; LANES],
            depth: [0.0; WIDTH],
            t_min: [0.0; WIDTH],
            t_max: [0.0; WIDTH],
            best: [0.0; WIDTH],
            primitive: [0; WIDTH],
            positions: [0; WIDTH],
            used: 0,
            is_whole: false,
            tile: 0,
            place: Ref::ROOT,
            hit: 0,
            open: 0,
            left: [0; LANES],
        };
        Self {
            groups: Box::new(std::array::from_fn(|_| group.clone())),
            count: 0,
            pairs: Box::new([Pair::default(); MOST_GROUPS * LANES + LANES]),
        }
    }
}

impl Groups {
    pub(super) fn is_full(&self) -> bool {
        self.count == MOST_GROUPS
    }

    /// Queues the rays at the `used` ones of `positions`, a bit each, for the patch at `place`.
    #[inline(always)]
    pub(super) fn add(&mut self, tile: usize, place: Ref, positions: [u32; WIDTH], used: u32) {
        let group = &mut self.groups[self.count % MOST_GROUPS];
        (group.tile, group.place) = (tile, place);
        (group.positions, group.used) = (positions, used);
        group.is_whole = false;
        self.count += 1;
    }

    /// As [`Groups::add`], for the `g`th whole group of the tile.
    #[inline(always)]
    pub(super) fn add_whole(&mut self, tile: usize, place: Ref, g: usize, used: u32) {
        let mut positions = [0; WIDTH];
        for (position, i) in positions.iter_mut().zip(g * WIDTH..) {
            *position = i as u32;
        }
        self.add(tile, place, positions, used);
        self.groups[(self.count - 1) % MOST_GROUPS].is_whole = true;
    }

    /// Runs all waiting tests, and lists the rays that single precision leaves open.
    #[inline(always)]
    pub(super) fn test<S: Lanes, Q: Query, P: Arithmetic>(
        &mut self,
        simd: S,
        searched: Searched<'_>,
        tiles: &mut [Tile],
        asks: &mut Vec<Open>,
        tests: &mut TestCounts,
    ) {
        let Searched { tree, geometry, .. } = searched;
        let arena = tree.arena.view();
        let pairs = self.see::<S, P>(simd, arena, tiles, tests);
        // The fast test has no separate step that rejects triangles.
        let pairs = if P::IS_FAST { pairs } else { self.leave_out(simd, arena, pairs) };
        let groups = &mut self.groups[..self.count.min(MOST_GROUPS)];
        for pair in &self.pairs[..pairs] {
            let group = &mut groups[usize::from(pair.group) % MOST_GROUPS];
            if Q::ANY && !geometry.lights.is_empty() {
                let first = arena.patch(group.place).first;
                if geometry.is_light(arena.number(first, usize::from(pair.triangle))) {
                    continue;
                }
            }
            let tile = &tiles[group.tile];
            if P::IS_FAST {
                fast::meet::<S, Q, P>(simd, searched, tile, group, *pair);
            } else {
                meet::<S, Q, P>(simd, searched, tile, group, *pair);
            }
        }
        for group in groups {
            let tile = &mut tiles[group.tile];
            if group.is_whole {
                report::whole::<S, Q, P>(simd, geometry, tile, group);
            } else {
                report::each::<Q, P>(geometry, tile, group, group.hit);
            }
            group.list_open(asks);
        }
        self.count = 0;
    }

    /// Shears the vertices of the patches for all groups, and lists every pair of a group and a
    /// triangle. Returns the number of pairs.
    #[inline(always)]
    fn see<S: Lanes, P: Arithmetic>(
        &mut self,
        simd: S,
        arena: View<'_>,
        tiles: &[Tile],
        tests: &mut TestCounts,
    ) -> usize {
        let mut count = 0;
        let groups = self.groups[..self.count.min(MOST_GROUPS)].iter_mut();
        for (g, group) in groups.enumerate() {
            let leaf = arena.patch(group.place);
            arena.prefetch_numbers(leaf.first);
            tests.count_triangles(leaf.count, leaf.quads, group.used.count_ones());
            let tile = &tiles[group.tile];
            if P::IS_FAST {
                fast::see(simd, tile, group);
            } else if tile.beam.has_one_origin {
                see::<S, true>(simd, leaf, tile, group);
            } else {
                see::<S, false>(simd, leaf, tile, group);
            }
            for triangle in 0..LANES as u8 {
                let pair = Pair { group: g as u8, triangle, inside: 0 };
                self.pairs[count + usize::from(triangle)] = pair;
            }
            count += leaf.count as usize & 15;
        }
        count
    }

    /// Of the first `all` pairs, keeps those with a ray that is not outside the triangle. Returns
    /// their number.
    #[inline(always)]
    fn leave_out<S: Lanes>(&mut self, simd: S, arena: View<'_>, all: usize) -> usize {
        let mut count = 0;
        for i in 0..all {
            let pair = self.pairs[i];
            let group = &self.groups[usize::from(pair.group) % MOST_GROUPS];
            let [a, b, c] = corners(arena.patch(group.place), group, pair.triangle);
            let xy = [plane(simd, a), plane(simd, b), plane(simd, c)];
            let inside = group.used & !Edges::outside_of(&xy).bits();
            self.pairs[count] = Pair { inside: inside as u16, ..pair };
            count += usize::from(inside != 0);
        }
        count
    }
}

impl PatchRays {
    /// Lists the rays that need the single test.
    #[inline(always)]
    fn list_open(&self, asks: &mut Vec<Open>) {
        let mut open = self.open;
        while open != 0 {
            let lane = open.trailing_zeros() as usize % WIDTH;
            open &= open - 1;
            let mut triangles = 0;
            for (triangle, rays) in self.left.iter().enumerate() {
                triangles |= (rays >> lane & 1) << triangle;
            }
            let ray = self.positions[lane] as usize;
            asks.push(Open { tile: self.tile, place: self.place, triangles, ray });
        }
    }
}

/// Shears the vertices of the patch for the rays, which may have `ONE` origin.
#[inline(always)]
fn see<S: Lanes, const ONE: bool>(simd: S, leaf: &Patch, tile: &Tile, group: &mut PatchRays) {
    let order = ORDERS[tile.longest.min(2)];
    let rays = if group.is_whole {
        tile.whole(simd, order, group.positions[0] as usize / WIDTH)
    } else {
        tile.pick::<S, ONE>(simd, order, group.positions)
    };
    let [x, y, z] = [order[0].min(2), order[1].min(2), order[2].min(2)];
    let (px, ox) = relative::<S, ONE>(simd, &leaf.positions[x], rays.origin[0], &tile.origin[x]);
    let (py, oy) = relative::<S, ONE>(simd, &leaf.positions[y], rays.origin[1], &tile.origin[y]);
    let (pz, oz) = relative::<S, ONE>(simd, &leaf.positions[z], rays.origin[2], &tile.origin[z]);
    let used = leaf.vertices as usize;
    for (v, vertex) in group.vertices.iter_mut().enumerate().take(used) {
        let mut x = f32x16::splat(simd, px[v]);
        let mut y = f32x16::splat(simd, py[v]);
        let mut z = f32x16::splat(simd, pz[v]);
        if !ONE {
            (x, y, z) = (x - ox, y - oy, z - oz);
        }
        vertex[0] = (x - rays.shear[0] * z).into();
        vertex[1] = (y - rays.shear[1] * z).into();
        vertex[2] = (rays.shear[2] * z).into();
    }
    group.depth = rays.range.depth.into();
    group.t_min = rays.range.t_min.into();
    group.t_max = rays.range.t_max.into();
    group.best = rays.best.into();
    group.primitive = rays.primitive.into();
    (group.hit, group.open, group.left) = (0, 0, [0; LANES]);
}

/// The values of a column for the group's rays; `g` is the number of a whole group.
#[inline(always)]
fn row<S: Lanes>(simd: S, column: &Column, group: &PatchRays, g: usize) -> Row {
    if group.is_whole {
        return column[g % GROUPS];
    }
    simd.pick(column, group.positions).into()
}

/// The coordinates along an axis relative to the `ONE` origin; or unchanged, with the values to
/// subtract for each ray.
#[inline(always)]
fn relative<S: Lanes, const ONE: bool>(
    simd: S,
    positions: &[f32; LANES],
    origins: f32x16<S>,
    column: &Column,
) -> ([f32; LANES], f32x16<S>) {
    if !ONE {
        return (*positions, origins);
    }
    let positions: f32x8<S> = (*positions).simd_into(simd);
    ((positions - column[0][0]).into(), origins)
}

/// Finds the meetings of the group's rays with a triangle.
#[inline(always)]
fn meet<S: Lanes, Q: Query, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    tile: &Tile,
    group: &mut PatchRays,
    pair: Pair,
) {
    let arena = searched.tree.arena.view();
    let leaf = arena.patch(group.place);
    let [a, b, c] = corners(leaf, group, pair.triangle);
    let xy = [plane(simd, a), plane(simd, b), plane(simd, c)];
    let z = [a[2].simd_into(simd), b[2].simd_into(simd), c[2].simd_into(simd)];
    let range = RayRange {
        depth: group.depth.simd_into(simd),
        t_min: group.t_min.simd_into(simd),
        t_max: group.t_max.simd_into(simd),
    };
    let sheared = Sheared { xy, z };
    let edges = Edges::new(&sheared.xy);
    let Decision { t, certain, open, inside } =
        decide(&sheared, &edges, &range, (u32::from(pair.inside), Q::ANY));
    if open == 0 {
        report::note::<S, Q, P>(simd, searched, tile, group, pair.triangle, (t, certain));
        return;
    }
    let settled = settle::settle(simd, leaf, tile, group, (pair.triangle, open & inside.bits()));
    let open = open & !settled.decided;
    group.open |= open;
    group.left[usize::from(pair.triangle) % LANES] |= open;
    let single = mask32x16::from_bitmask(simd, u64::from(certain));
    let t = single.select(t, settled.t.simd_into(simd));
    report::note::<S, Q, P>(simd, searched, tile, group, pair.triangle, (t, certain | settled.hit));
}

/// The corners of a triangle in sheared space.
#[inline(always)]
fn corners<'a>(leaf: &Patch, group: &'a PatchRays, triangle: u8) -> [&'a [Row; 3]; 3] {
    let [a, b, c] = leaf.corners;
    let at = u32::from(4 * triangle) % u32::BITS;
    [
        &group.vertices[(a >> at) as usize % LANES],
        &group.vertices[(b >> at) as usize % LANES],
        &group.vertices[(c >> at) as usize % LANES],
    ]
}

/// The first two coordinates.
#[inline(always)]
fn plane<S: Lanes>(simd: S, [x, y, _]: &[Row; 3]) -> [f32x16<S>; 2] {
    [(*x).simd_into(simd), (*y).simd_into(simd)]
}
