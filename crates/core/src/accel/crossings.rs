//! Traversal that ends at no hit: every leaf whose box a ray meets is visited, and every triangle that it
//! crosses is kept. Rays are traced one by one, but many in a call.

use std::marker::PhantomData;

use super::arena::{Kind, Ref};
use super::best::Best;
use super::leaf;
use super::node::{self, place};
use super::query::Occluded;
use super::rays::Rays;
use super::tree::{Root, Searched};
use super::{Hit, Traversal, single};
use crate::counters::TestCounts;
use crate::geometry::{Geometry, PreparedRay, Primitive};
use crate::kernels::precision::Arithmetic;
use crate::kernels::slab::SlabRay;
use crate::kernels::{quad, triangle};
use crate::math::float::{max, min};
use crate::math::ray::Ray;
use crate::math::simd::{Kernel, Lanes};

/// Some rays, in turn.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) rays: Rays<'a>,
    /// The number of the first.
    pub(super) first: usize,
    /// Which of all rays to leave out.
    pub(super) left_out: &'a [bool],
}

impl Asked<'_> {
    /// Calls `cross` for each ray, which adds what it crosses to `hits`, and `each` with its number and
    /// its hits in order, until that returns false. Returns the number of the next ray.
    #[inline(always)]
    pub(super) fn run(
        self,
        geometry: &Geometry,
        hits: &mut Vec<Hit>,
        mut cross: impl FnMut(&Ray, &mut Vec<Hit>),
        each: &mut Each<'_>,
    ) -> usize {
        let Self { rays, first, left_out } = self;
        for (number, _) in left_out.iter().enumerate().skip(first).filter(|(_, is_out)| !**is_out) {
            hits.clear();
            let ray = rays.ray(number);
            if ray.is_valid() {
                cross(&ray, hits);
            }
            if hits.len() > 1 {
                geometry.sort(&ray, hits);
            }
            if !each(number, hits) {
                return number + 1;
            }
        }
        left_out.len()
    }
}

/// Receives the number of a ray and its hits, and says whether to go on.
pub(super) type Each<'a> = dyn FnMut(usize, &[Hit]) -> bool + 'a;

/// Rays and all that each crosses.
pub(super) struct Crossings<'a, 'b, P> {
    pub(super) searched: Searched<'a>,
    pub(super) asked: Asked<'a>,
    pub(super) traversal: &'a mut Traversal,
    pub(super) hits: &'a mut Vec<Hit>,
    pub(super) each: &'a mut Each<'b>,
    pub(super) precision: PhantomData<P>,
}

impl<P: Arithmetic> Kernel for Crossings<'_, '_, P> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Lanes>(self, simd: S) -> usize {
        let Self { searched, asked, hits, each, .. } = self;
        let Traversal { stack, tests, .. } = self.traversal;
        let Some(root) = searched.tree.root() else { return asked.left_out.len() };
        asked.run(
            searched.geometry,
            hits,
            #[inline(always)]
            |ray, hits| {
                if may_meet(&root, ray) {
                    one::<S, P>(simd, searched, ray, stack, (hits, tests));
                }
            },
            each,
        )
    }
}

/// Whether the ray may meet what is below the root.
#[inline(always)]
fn may_meet(root: &Root, ray: &Ray) -> bool {
    let slab = SlabRay::new(ray);
    let met = slab.interval(&root.bounds);
    max(met.near, ray.t_min) <= min(met.far, slab.reach(ray.t_max))
}

/// Adds what the ray crosses.
#[inline(always)]
fn one<S: Lanes, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    ray: &Ray,
    stack: &mut [u64],
    (hits, tests): (&mut Vec<Hit>, &mut TestCounts),
) {
    let ray = &PreparedRay::new(ray);
    let mut height = single::start(searched.tree, stack);
    let arena = searched.tree.arena.view();
    let range = [ray.ray.t_min, ray.ray.t_max];
    while height > 0 {
        height -= 1;
        let mut next = Some(place(stack[height]));
        while let Some(at) = next {
            next = match at.kind() {
                Kind::Node => {
                    tests.nodes += 1;
                    let node = arena.node(at);
                    // Like an any-hit query: no hit cuts the range.
                    let entered;
                    (entered, height) =
                        node::enter::<S, Occluded>(simd, node, at, &ray.slab, range, stack, height);
                    entered
                }
                Kind::List => {
                    let chunk = searched.chunk(at);
                    if chunk.is_none() {
                        tests.leaves += 1;
                        let numbers = arena.list(at).iter().copied();
                        each::<P>(searched.geometry, numbers, &ray.ray, (hits, tests));
                    }
                    chunk
                }
                Kind::Patch | Kind::Soup => {
                    visit::<S, P>(simd, searched, ray, at, (hits, tests));
                    None
                }
            };
        }
    }
}

/// Adds the triangles of a leaf that the ray crosses.
#[inline(always)]
fn visit<S: Lanes, P: Arithmetic>(
    simd: S,
    searched: Searched<'_>,
    ray: &PreparedRay,
    place: Ref,
    (hits, tests): (&mut Vec<Hit>, &mut TestCounts),
) {
    tests.leaves += 1;
    let arena = searched.tree.arena.view();
    let Ray { t_max, .. } = ray.ray;
    let found = leaf::test::<S, P>(simd, arena, (&ray.ray, &ray.space), place, t_max, tests);
    let mut met = found.certain | found.open;
    while met != 0 {
        let lane = met.trailing_zeros() as usize % 8;
        met &= met - 1;
        let hit = if found.certain >> lane & 1 == 1 {
            // It passes beside every edge.
            Best::in_leaf(place, lane, [found.low[lane], found.high[lane]])
        } else {
            tests.settled += 1;
            let t = triangle::crossing(&ray.ray, &arena.triangle(place, lane));
            let Some(t) = t else { continue };
            Best::in_leaf(place, lane, [t, t])
        };
        if !searched.is_hole::<P>(&ray.ray, &hit, tests) {
            hits.push(hit.finished(arena, &ray.ray));
        }
    }
}

/// Adds those of the primitives with these numbers that the ray crosses, testing each.
#[inline(never)]
pub(super) fn each<P: Arithmetic>(
    geometry: &Geometry,
    numbers: impl Iterator<Item = u32>,
    ray: &Ray,
    (hits, tests): (&mut Vec<Hit>, &mut TestCounts),
) {
    for primitive in numbers {
        let found = match geometry.primitive(primitive) {
            Primitive::Triangle(i) => {
                tests.triangles += 1;
                [triangle::crossing(ray, &geometry.triangle(i)), None]
            }
            Primitive::Quad(i) => {
                tests.quads += 2;
                let halves = quad::halves(&geometry.quad(i));
                halves.map(|half| triangle::crossing(ray, &half))
            }
            Primitive::Quadric(i) => {
                geometry.quadrics[i].count(tests, 1);
                geometry.quadrics[i].crossings::<P>(ray)
            }
            Primitive::Instanced(_) => [None; 2],
        };
        let is_there = |t: &f32| !geometry.is_hole::<P>(primitive, ray, *t, tests);
        hits.extend(found.into_iter().flatten().filter(is_there).map(|t| Hit { t, primitive }));
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::tests::{Numbers, add_triangle, bumpy_sphere};
    use super::super::{Accel, KernelChoice};
    use super::*;
    use crate::accel::build::Preset;
    use crate::geometry::Quadric;
    use crate::kernels::disk::{self, Disk};
    use crate::kernels::precision::Reference;
    use crate::kernels::sphere;
    use crate::math::simd::Level;

    fn crossings(accel: &Accel, ray: &Ray) -> Vec<Hit> {
        let mut hits = vec![Hit::MISS];
        accel.crossings(ray, &mut accel.traversal(), &mut hits);
        hits
    }

    /// The crossings of rays by brute force, which every tree and instruction level must find.
    fn checked(geometry: &Geometry, rays: &[Ray]) -> Vec<Vec<Hit>> {
        let brute = Accel::new(geometry.clone(), Preset::Brute);
        let expected: Vec<_> = rays.iter().map(|ray| crossings(&brute, ray)).collect();
        for preset in [Preset::OnDemand, Preset::VeryFast, Preset::Slow] {
            let mut accel = Accel::new(geometry.clone(), preset);
            for level in Level::available() {
                accel.level = level.token().expect("it is available");
                for (ray, expected) in rays.iter().zip(&expected) {
                    assert_eq!(&crossings(&accel, ray), expected, "{preset:?} {level:?} {ray}");
                }
            }
            accel.kernel = KernelChoice::Reference;
            for (ray, expected) in rays.iter().zip(&expected) {
                assert_eq!(&crossings(&accel, ray), expected, "{preset:?} reference {ray}");
            }
        }
        expected
    }

    /// Ties, rays in planes and along edges.
    #[test]
    fn hc03_crossings_on_a_grid_are_those_of_brute_force_and_are_met() {
        let mut numbers = Numbers(110_000);
        let mut geometry = Geometry::default();
        let mut point = || Vec3::from([0; 3].map(|_| numbers.below(7) as f32));
        for _ in 0..300 {
            add_triangle(&mut geometry, [point(), point(), point()]);
        }
        let first = geometry.positions.len() as u32;
        geometry.positions.extend([
            Vec3::ZERO,
            Vec3::X * 6.0,
            Vec3::ONE * 6.0,
            Vec3::new(0.0, 6.0, 6.0),
        ]);
        geometry.quads.push([first, first + 1, first + 2, first + 3]);
        let rays: Vec<Ray> = (0..600)
            .map(|i| {
                let (from, to) = (point(), point());
                Ray {
                    t_max: if i % 4 == 0 { 1.0 } else { f32::INFINITY },
                    ..Ray::new(from, to - from)
                }
            })
            .collect();
        let all = checked(&geometry, &rays);
        let mut skipped = 0;
        for (ray, hits) in rays.iter().zip(&all) {
            let met = (0..geometry.triangles.len() as u32).filter_map(|primitive| {
                let t = triangle::meet(ray, &geometry.triangle(primitive as usize))?;
                Some(Hit { t, primitive })
            });
            let met: Vec<Hit> = met.collect();
            let own = hits.iter().filter(|hit| (hit.primitive as usize) < geometry.triangles.len());
            assert!(own.clone().all(|hit| met.contains(hit)), "{ray}");
            skipped += met.len() - own.count();
        }
        assert!(skipped > 500, "{skipped}");
        assert!(all.iter().flatten().any(|hit| hit.primitive as usize == geometry.triangles.len()));
    }

    /// Spheres are entered and left, also by rays that touch them or start inside.
    #[test]
    fn hc05_spheres_are_crossed_twice_and_disks_once() {
        let mut numbers = Numbers(130_000);
        let mut geometry = Geometry::default();
        let mut point = || Vec3::from([0; 3].map(|_| numbers.below(5) as f32));
        for i in 0..60 {
            let (center, normal) = (point(), (point() - 2.0).normalize_or(Vec3::X));
            geometry.quadrics.push(match i % 2 {
                0 => Quadric::Sphere(center, 1.0),
                _ => Quadric::Disk(Disk { center, normal, radius: 1.0 }),
            });
        }
        let rays: Vec<Ray> = (0..600)
            .map(|i| {
                let (from, to) = (point(), point());
                let t_max = if i % 4 == 0 { 1.0 } else { f32::INFINITY };
                Ray { t_max, ..Ray::new(from, to - from) }
            })
            .filter(Ray::is_valid)
            .collect();
        let mut twice = 0;
        for (ray, hits) in rays.iter().zip(checked(&geometry, &rays)) {
            for (number, quadric) in (0..).zip(&geometry.quadrics) {
                let found = hits.iter().filter(|hit| hit.primitive == number);
                let found: Vec<f32> = found.map(|hit| hit.t).collect();
                let expected = match *quadric {
                    Quadric::Sphere(center, radius) => {
                        sphere::crossings::<Reference>(ray, center, radius)
                    }
                    Quadric::Disk(disk) => [disk::intersect_exactly(ray, &disk), None],
                };
                let expected: Vec<f32> = expected.into_iter().flatten().collect();
                assert_eq!(found, expected, "{ray} {quadric:?}");
                twice += usize::from(found.len() == 2);
            }
        }
        assert!(twice > 500, "{twice}");
    }

    /// From outside, rays through corners and edges enter a closed surface as often as they leave
    /// it, alternately.
    #[test]
    fn hc01_hc02_a_closed_surface_is_left_as_often_as_it_is_entered() {
        let mut numbers = Numbers(120_000);
        for mut geometry in [cube(), bumpy_sphere(12)] {
            if geometry.triangles.len() > 12 {
                weld(&mut geometry, 12);
            }
            let mut target = |geometry: &Geometry, i: usize| {
                let [a, b, c] = geometry.triangle(numbers.below(geometry.triangles.len()));
                // A corner, the middle of an edge, a point inside.
                [a, (a + b) * 0.5, (a + b + c) * 0.25][i % 3]
            };
            let rays: Vec<Ray> = (0..600)
                .map(|i| {
                    let (p, q) = (target(&geometry, i), target(&geometry, i / 3));
                    let from = if i % 2 == 0 { p - (q - p) * 8.0 } else { p.with_z(-9.0) };
                    Ray::new(from, p - from)
                })
                .collect();
            let mut found = 0;
            for (ray, hits) in rays.iter().zip(checked(&geometry, &rays)) {
                let enters = |hit: &Hit| {
                    let corners = geometry.triangle(hit.primitive as usize);
                    triangle::normal(&corners).dot(ray.direction.as_dvec3()) < 0.0
                };
                let entered = hits.iter().filter(|hit| enters(hit)).count();
                assert_eq!(2 * entered, hits.len(), "{ray}: {hits:?}");
                found += hits.len();
            }
            assert!(found > 600, "{found}");
        }
    }

    /// Of integers, with sides along the axes: many rays run in their planes or along edges.
    fn cube() -> Geometry {
        let corner = |i: u8| Vec3::from([0, 1, 2].map(|k| f32::from(i >> k & 1)));
        let sides =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Geometry {
            positions: (0..8).map(corner).collect(),
            triangles: halves.collect(),
            ..Geometry::default()
        }
    }

    /// Closes the seam and the poles of a sphere of `n` times `n` pairs.
    fn weld(geometry: &mut Geometry, n: u32) {
        for i in 0..geometry.positions.len() as u32 {
            let (u, v) = (i % (n + 1), i / (n + 1));
            let like = if v == 0 || v == n { v * (n + 1) } else { i - u + u % n };
            geometry.positions[i as usize] = geometry.positions[like as usize];
        }
    }
}
