//! Leaves, as the rays of a tile meet them.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16, u32x16};

use super::tile::{GROUPS, RayGroup, Tile, WIDTH, number_of};
use super::{Batch, TILE};
use crate::accel::arena::{Kind, Patch, Ref, View};
use crate::accel::geometry::PreparedRay;
use crate::accel::stream::{Found, Query, Rays};
use crate::accel::{Hit, TestCounts, leaf};
use crate::kernels::triangle::T_TOLERANCE;
use crate::kernels::triangle::lanes::{ORDERS, decide, edges};
use crate::math::simd::{LANES, Lanes};

/// So many rays, or fewer, are tested each for itself.
const ALONE: u64 = 5;

/// A group with so many rays in a leaf is tested as it is.
const MANY_IN_GROUP: u32 = 8;

/// A ray of a tile that is to be tested alone with a patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alone {
    place: Ref,
    tile: u8,
    ray: u8,
}

impl<Q: Query, R: Rays + ?Sized> Batch<'_, Q, R> {
    /// Tests the leaf with each of `rays`.
    #[inline(always)]
    pub(super) fn visit_leaf<S: Lanes>(
        &mut self,
        simd: S,
        (tile, k): (&mut Tile, usize),
        arena: View<'_>,
        at: Ref,
        rays: u64,
        tests: &mut TestCounts,
    ) {
        let lights = Q::ANY && !self.geometry.lights.is_empty();
        match tile.longest {
            Some(longest) if at.kind() == Kind::Patch && !lights => {
                let leaf = arena.patch(at);
                arena.prefetch_numbers(leaf.first);
                let count = u64::from(rays.count_ones());
                tests.leaves += count;
                tests.triangles += count * u64::from(leaf.count);
                if !tile.is_sheared {
                    tile.shear(simd, longest);
                }
                if count <= ALONE {
                    let mut rest = rays;
                    while rest != 0 {
                        let ray = rest.trailing_zeros() as u8;
                        rest &= rest - 1;
                        self.alone.push(Alone { place: at, tile: k as u8, ray });
                    }
                } else {
                    self.visit_patch(simd, tile, arena, leaf, ORDERS[longest.min(2)], rays);
                }
            }
            _ => {
                let mut rest = rays;
                while rest != 0 {
                    let i = rest.trailing_zeros() as usize & (TILE - 1);
                    rest &= rest - 1;
                    let ray = PreparedRay::new(&self.rays.ray(tile.start + number_of(i)));
                    if Q::ANY {
                        if leaf::occluded(simd, arena, self.geometry, &ray, at, tests) {
                            tile.set_done(i);
                        }
                    } else {
                        let mut best = tile.best(i);
                        if leaf::closest(simd, arena, self.geometry, &ray, at, &mut best, tests) {
                            tile.set_best(i, best);
                        }
                    }
                }
            }
        }
        tile.is_reach_stale = true;
    }

    /// Tests all triangles of patches at once with each ray that waits alone.
    #[inline(always)]
    pub(super) fn test_alone<S: Lanes>(&mut self, simd: S, tiles: &mut [Tile]) {
        let arena = self.tree.arena.view();
        // Two loops: the first has no branches that depend on what is found.
        self.found.resize(self.alone.len().max(self.found.len()), Found::default());
        for (alone, found) in self.alone.iter().zip(self.found.iter_mut()) {
            let tile = &tiles[alone.tile as usize];
            let leaf = arena.patch(alone.place);
            let used = (1 << (leaf.count & 15)) - 1;
            let space = tile.space(tile.longest.unwrap_or(0), alone.ray as usize);
            found.hits = space.intersect_patch(simd, &leaf.positions, leaf.corners, used);
            found.first = leaf.first;
        }
        for n in 0..self.alone.len() {
            let (Alone { place, tile, ray }, Found { hits, first }) =
                (self.alone[n], self.found[n]);
            let (tile, i) = (&mut tiles[tile as usize], ray as usize);
            if Q::ANY {
                tile.done |= u64::from(hits.certain != 0) << i;
            } else {
                let mut certain = hits.certain;
                let mut best = tile.best(i);
                let before = best;
                while certain != 0 {
                    let lane = certain.trailing_zeros() as usize & (LANES - 1);
                    certain &= certain - 1;
                    let t = hits.t[lane];
                    if t <= before.t {
                        let number = arena.number(first, lane);
                        if t < best.t || (t == best.t && number < best.primitive) {
                            best = Hit { t, primitive: number };
                        }
                    }
                }
                if best != before {
                    tile.set_best(i, best);
                }
            }
            if hits.open != 0 {
                self.ask_again(tile, arena, arena.patch(place), hits.open, i);
            }
        }
        self.alone.clear();
    }

    /// Tests the triangles of a patch with `rays`: groups with many of them as they are, the others
    /// put together.
    #[inline(always)]
    fn visit_patch<S: Lanes>(
        &mut self,
        simd: S,
        tile: &mut Tile,
        arena: View<'_>,
        leaf: &Patch,
        order: [usize; 3],
        rays: u64,
    ) {
        let mut scattered = 0;
        for g in 0..GROUPS {
            let group = (rays >> (g * WIDTH)) as u32 & 0xFFFF;
            if group.count_ones() < MANY_IN_GROUP {
                scattered |= u64::from(group) << (g * WIDTH);
            } else {
                let lanes = tile.group(simd, order, g);
                let found = self.test_patch(simd, arena, leaf, lanes, group);
                if Q::ANY {
                    tile.done |= u64::from(found.hit) << (g * WIDTH);
                } else if found.hit != 0 {
                    tile.best[g] = found.best.into();
                    tile.primitive[g] = found.primitive.into();
                    let reach = found.best + found.best.abs() * (4.0 * T_TOLERANCE);
                    tile.reach[g] = reach.into();
                }
                let mut open = found.open;
                while open != 0 {
                    let l = open.trailing_zeros() as usize % WIDTH;
                    open &= open - 1;
                    self.ask_again(tile, arena, leaf, found.asks(l), g * WIDTH + l);
                }
            }
        }
        while scattered != 0 {
            let positions = simd.positions(scattered);
            let mut count = 0;
            while scattered != 0 && count < WIDTH {
                scattered &= scattered - 1;
                count += 1;
            }
            let lanes = tile.pick(simd, order, positions);
            let found = self.test_patch(simd, arena, leaf, lanes, (1 << count) - 1);
            let mut hit = found.hit;
            if hit != 0 {
                let best = <[f32; WIDTH]>::from(found.best);
                let primitive = <[u32; WIDTH]>::from(found.primitive);
                while hit != 0 {
                    let l = hit.trailing_zeros() as usize % WIDTH;
                    hit &= hit - 1;
                    let i = positions[l] as usize & (TILE - 1);
                    if Q::ANY {
                        tile.set_done(i);
                    } else {
                        tile.set_best(i, Hit { t: best[l], primitive: primitive[l] });
                    }
                }
            }
            let mut open = found.open;
            while open != 0 {
                let l = open.trailing_zeros() as usize % WIDTH;
                open &= open - 1;
                let i = positions[l] as usize & (TILE - 1);
                self.ask_again(tile, arena, leaf, found.asks(l), i);
            }
        }
    }

    /// Tests those of a patch's `triangles`, a bit each, with the `i`th ray, each alone.
    #[cold]
    #[inline(never)]
    fn ask_again(
        &mut self,
        tile: &mut Tile,
        arena: View<'_>,
        leaf: &Patch,
        mut triangles: u32,
        i: usize,
    ) {
        let ray = PreparedRay::new(&self.rays.ray(tile.start + number_of(i)));
        while triangles != 0 {
            let number = arena.number(leaf.first, triangles.trailing_zeros() as usize);
            triangles &= triangles - 1;
            let Some(t) = self.geometry.hit_again(number, &ray) else { continue };
            if Q::ANY {
                tile.set_done(i);
                return;
            }
            let best = tile.best(i);
            if t < best.t || (t == best.t && number < best.primitive) {
                tile.set_best(i, Hit { t, primitive: number });
            }
        }
    }

    /// Tests the triangles of a patch with the rays of `used`.
    #[inline(always)]
    fn test_patch<S: Lanes>(
        &mut self,
        simd: S,
        arena: View<'_>,
        leaf: &Patch,
        rays: RayGroup<S>,
        used: u32,
    ) -> FoundByGroup<S> {
        let [kx, ky, kz] = rays.order;
        let vertices = &mut self.vertices;
        for v in 0..leaf.vertices as usize & 15 {
            let vertex = &mut vertices[v & (LANES - 1)];
            let x =
                f32x16::splat(simd, leaf.positions[kx.min(2)][v & (LANES - 1)]) - rays.origin[0];
            let y =
                f32x16::splat(simd, leaf.positions[ky.min(2)][v & (LANES - 1)]) - rays.origin[1];
            let z =
                f32x16::splat(simd, leaf.positions[kz.min(2)][v & (LANES - 1)]) - rays.origin[2];
            vertex[0] = (x - rays.shear[0] * z).into();
            vertex[1] = (y - rays.shear[1] * z).into();
            vertex[2] = (rays.shear[2] * z).into();
        }
        // Which rays are not outside of which triangle, without a branch.
        let mut inside = [0_u32; LANES];
        let mut met = 0_u32;
        for triangle in 0..leaf.count as usize & 15 {
            let [a, b, c] = corners(leaf, vertices, triangle);
            let xy = [plane(simd, a), plane(simd, b), plane(simd, c)];
            let (_, candidates) = edges(xy, used);
            inside[triangle & (LANES - 1)] = candidates;
            met |= u32::from(candidates != 0) << triangle;
        }
        let mut found = FoundByGroup {
            best: rays.best,
            primitive: rays.primitive,
            hit: 0,
            open: 0,
            left: inside,
        };
        while met != 0 {
            let triangle = met.trailing_zeros() as usize & (LANES - 1);
            met &= met - 1;
            let [a, b, c] = corners(leaf, vertices, triangle);
            let xy = [plane(simd, a), plane(simd, b), plane(simd, c)];
            let (edges, _) = edges(xy, used);
            let z = [a[2].simd_into(simd), b[2].simd_into(simd), c[2].simd_into(simd)];
            let (t, certain, open) = decide(xy, z, edges, rays.range, inside[triangle]);
            found.open |= open;
            found.left[triangle] = open;
            if Q::ANY {
                found.hit |= certain;
            } else {
                let number = arena.number(leaf.first, triangle);
                let closer = t.simd_lt(found.best)
                    | (t.simd_eq(found.best) & found.primitive.simd_gt(number));
                let closer = closer & mask32x16::from_bitmask(simd, u64::from(certain));
                found.best = closer.select(t, found.best);
                found.primitive = closer.select(u32x16::splat(simd, number), found.primitive);
                found.hit |= closer.to_bitmask() as u32;
            }
        }
        found
    }
}

/// What sixteen rays have found so far.
struct FoundByGroup<S: Lanes> {
    best: f32x16<S>,
    primitive: u32x16<S>,
    /// The rays that have found it here.
    hit: u32,
    /// Those that have to be asked alone.
    open: u32,
    /// For each triangle those that have to be asked about it.
    left: [u32; LANES],
}

impl<S: Lanes> FoundByGroup<S> {
    /// The triangles that the ray at `lane` has to be asked about, a bit each.
    fn asks(&self, lane: usize) -> u32 {
        let mut triangles = 0;
        for (triangle, rays) in self.left.iter().enumerate() {
            triangles |= (rays >> lane & 1) << triangle;
        }
        triangles
    }
}

/// The corners of a triangle, in sheared space.
#[inline(always)]
fn corners<'a>(
    leaf: &Patch,
    vertices: &'a [[[f32; WIDTH]; 3]; LANES],
    triangle: usize,
) -> [&'a [[f32; WIDTH]; 3]; 3] {
    let [a, b, c] = leaf.corners;
    let at = 4 * triangle;
    [
        &vertices[(a >> at) as usize & (LANES - 1)],
        &vertices[(b >> at) as usize & (LANES - 1)],
        &vertices[(c >> at) as usize & (LANES - 1)],
    ]
}

/// The first two coordinates.
#[inline(always)]
fn plane<S: Lanes>(simd: S, [x, y, _]: &[[f32; WIDTH]; 3]) -> [f32x16<S>; 2] {
    [(*x).simd_into(simd), (*y).simd_into(simd)]
}
