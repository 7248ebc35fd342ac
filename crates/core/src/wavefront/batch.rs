//! The columns of a batch: structures of arrays, each with its unit, writer and readers.
//!
//! Positions are in world space, moved by the scene's origin; radiance is linear. Passes read and write eight rows at a
//! time, or one where instructions are not wide. Columns have room for a whole vector after the last row, with
//! unspecified values.

#[macro_use]
mod columns;
mod branches;
mod carried;
mod lit;

use glam::Vec3;

use crate::accel::{Hit, RayColumns, Rays as AllRays};
use crate::kernels::{Differential, Footprint};
use crate::math::{LANES, Line, Mask, Ray, Single, Vector, set_bits};
use crate::plan::schedule::ColumnGroup;
use crate::prepared::{MediumStack, PreparedScene, ScatteredRays, ShadowCrossings};
use crate::wavefront::Seen;
use crate::wavefront::faces::SortedHits;
use columns::Column;

pub use branches::BranchStacks;
pub use carried::CarriedRows;
pub use columns::Vectors;
pub(super) use columns::{is_row, room};
pub use lit::{LitPoints, Tints};

columns! {
    /// Rays from the camera or from surfaces, t from 0, or from the row of [`CarriedRows::starts`], to infinity. Written by
    /// generate, shade and advance, read by intersect and shade.
    Rays {
        /// Origin.
        origin: Vectors,
        /// Of unit length.
        direction: Vectors,
        /// Throughput of the path; 1 for camera rays.
        throughput: Vectors,
        /// The path, by its number in the batch.
        path: Vec<u32>,
    }
}

impl Rays {
    /// The `i`th ray.
    #[inline(always)]
    pub fn ray(&self, i: usize) -> Ray {
        Ray::new(self.origin.get(i), self.direction.get(i))
    }

    /// Appends a ray.
    #[inline(always)]
    pub fn push(&mut self, ray: &Ray, throughput: Vec3, path: u32) {
        let i = self.rows;
        self.origin.set(i, ray.origin);
        self.direction.set(i, ray.direction);
        self.throughput.set(i, throughput);
        self.path[i] = path;
        self.rows += 1;
    }

    /// Appends camera rays of the paths from `path` on; the first `count` lanes are used.
    #[inline(always)]
    pub fn push_camera<F: Single>(&mut self, line: &Line<F>, path: u32, count: usize) {
        let (i, token) = (self.rows, line.origin.x.token());
        self.origin.store(i, line.origin);
        self.direction.store(i, line.direction);
        self.throughput.store::<F>(i, Vector::splat(token, Vec3::ONE));
        for (row, path) in self.path[i..i + F::LANES].iter_mut().zip(path..) {
            *row = path;
        }
        self.rows += count;
    }

    /// Appends the lanes of `asked`, of these paths. Returns their number.
    #[inline(always)]
    pub fn push_lanes<F: Single>(
        &mut self,
        line: &Line<F>,
        throughput: Vector<F>,
        asked: F::Mask,
        path: &[u32],
    ) -> u64 {
        let i = self.rows;
        self.origin.pack(i, line.origin, asked);
        self.direction.pack(i, line.direction, asked);
        self.throughput.pack(i, throughput, asked);
        F::pack_integers(throughput.x.token(), path, asked, &mut self.path[i..i + F::LANES]);
        let count = asked.bits().count_ones();
        self.rows += count as usize;
        u64::from(count)
    }

    /// The rays in the form of kernels, with these ends of their ranges.
    pub fn all<'a>(&'a self, t_min: Option<&'a [f32]>, t_max: f32) -> AllRays<'a> {
        let (origin, direction) = (self.origin.columns(), self.direction.columns());
        AllRays::Columns(RayColumns { count: self.rows, origin, direction, t_min, t_max })
    }
}

columns! {
    /// The paths of the batch. Written by generate, shade and shadow, read by shade, shadow and resolve.
    Paths {
        /// Radiance gathered so far.
        radiance: Vectors,
        /// The pixel, by its number in the image.
        pixel: Vec<u32>,
        /// The camera ray within the pixel.
        sample: Vec<u32>,
        /// The pixel, by its number in the tile.
        pixel_of_tile: Vec<u32>,
    }
}

impl Paths {
    /// Appends paths without radiance, of these pixels, samples and pixels of the tile; the first `count` lanes
    /// are used.
    #[inline(always)]
    pub fn push_lanes<F: Single>(
        &mut self,
        token: F::Token,
        [pixel, sample, pixel_of_tile]: [&[u32; LANES]; 3],
        count: usize,
    ) {
        let lanes = self.rows..self.rows + F::LANES;
        self.radiance.store::<F>(self.rows, Vector::splat(token, Vec3::ZERO));
        self.pixel[lanes.clone()].copy_from_slice(&pixel[..F::LANES]);
        self.sample[lanes.clone()].copy_from_slice(&sample[..F::LANES]);
        self.pixel_of_tile[lanes].copy_from_slice(&pixel_of_tile[..F::LANES]);
        self.rows += count;
    }
}

/// The memory of one wavefront.
#[derive(Debug)]
pub struct Batch {
    capacity: usize,
    /// The paths.
    pub paths: Paths,
    /// The rays of this bounce.
    pub rays: Rays,
    /// Their hits: t, infinite for a miss, and the primitive's number; where nothing needs it, t may be more than that
    /// of the hit. Written by intersect, read by shade.
    pub hits: Vec<Hit>,
    /// Their hits that lights may reach.
    pub lit: LitPoints,
    /// The highlight colours of these.
    pub tints: Tints,
    /// Queued shadow rays, t from 0 to [`SHADOW_END`](crate::kernels::shade::SHADOW_END), whose throughput is the
    /// radiance to add to the path if nothing occludes them. Written and read by shadow, like the following.
    pub shadows: Rays,
    /// Whether each of them is occluded.
    pub occluded: Vec<bool>,
    /// The rays of the next bounce.
    pub next: Rays,
    /// What the rays of this bounce carry. Written by advance, read by intersect and shade.
    pub carried: CarriedRows,
    /// What the next rays carry. Written by shade and advance.
    pub next_carried: CarriedRows,
    /// For each path what its ray of this bounce is inside of, if surfaces let light through. Written by
    /// shade, read by shadow.
    pub media: Vec<MediumStack>,
    /// Rays that wait until the rays before them on their path are done.
    pub waiting: BranchStacks,
    /// What each path shows, if that is asked for in place of light: see [`Sight`](super::Sight).
    pub seen: Vec<Seen>,
    /// Memory for which paths have a next ray.
    continued: Vec<bool>,
    /// Memory for sorting hits, for shade and shadow.
    pub(super) sorted: SortedHits,
    /// The transparent surfaces on shadow rays. Written and read by shadow.
    pub crossings: ShadowCrossings,
}

impl Batch {
    /// A batch of up to `capacity` paths, with the columns that may need storage in `scene`: each
    /// is allocated at its first row.
    pub fn new(scene: &PreparedScene, capacity: usize) -> Self {
        let capacity = capacity.max(1);
        let schedule = scene.plan.schedule();
        let room = |group: ColumnGroup| if schedule.has(group) { capacity } else { 0 };
        Self {
            capacity,
            paths: Paths::with_capacity(room(ColumnGroup::Paths)),
            rays: Rays::with_capacity(room(ColumnGroup::Rays)),
            hits: Vec::new(),
            lit: LitPoints::with_capacity(room(ColumnGroup::LitPoints)),
            tints: Tints::with_capacity(room(ColumnGroup::Tints)),
            shadows: Rays::with_capacity(room(ColumnGroup::ShadowRays)),
            occluded: Vec::new(),
            next: Rays::with_capacity(room(ColumnGroup::NextRays)),
            carried: CarriedRows::with_capacity(capacity),
            next_carried: CarriedRows::with_capacity(capacity),
            media: Vec::new(),
            waiting: BranchStacks::with_capacity(room(ColumnGroup::Branches)),
            seen: Vec::new(),
            continued: Vec::new(),
            sorted: SortedHits::new(scene.appearance.classes.len()),
            crossings: ShadowCrossings::default(),
        }
    }

    /// The largest number of paths.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// The `i`th ray of this bounce.
    #[inline(always)]
    pub fn ray(&self, i: usize) -> Ray {
        let t_min = self.carried.starts().map_or(0.0, |starts| starts[i]);
        Ray { t_min, ..self.rays.ray(i) }
    }

    /// Keeps what the `i`th ray of this bounce is inside of, for shadow rays from its hit.
    pub fn set_media(&mut self, i: usize, media: MediumStack) {
        if self.media.is_empty() {
            self.media.resize(self.capacity, MediumStack::default());
        }
        self.media[self.rays.path[i] as usize] = media;
    }

    /// Appends those of the scattered rays that come `next`, a bit each, of these paths.
    #[inline(always)]
    pub fn push_scattered<F: Single>(
        &mut self,
        token: F::Token,
        rays: &ScatteredRays<F>,
        next: u32,
        path: &[u32; LANES],
    ) {
        let ScatteredRays { line, t_min, throughput, states, differential, .. } = rays;
        self.next.provide();
        self.next.push_lanes(line, *throughput, F::mask(token, next), path);
        for lane in set_bits::<LANES>(next) {
            self.next_carried.push_state(states[lane], t_min.lane(lane));
            if let Some(differential) = differential {
                self.next_carried.push_differential(differential.lane(lane));
            }
        }
    }

    /// Makes the next rays the current ones: paths without one go on with a ray that waits. Returns
    /// whether there are any.
    pub fn advance(&mut self) -> bool {
        if !self.waiting.is_empty() {
            self.wake();
        }
        // Where no ray goes on, the next rays have no storage and must not become the current ones.
        if self.next.is_empty() {
            return false;
        }
        std::mem::swap(&mut self.rays, &mut self.next);
        self.next.clear();
        std::mem::swap(&mut self.carried, &mut self.next_carried);
        self.next_carried.clear();
        true
    }

    /// Appends the last waiting ray of every path of this bounce that has no next ray.
    fn wake(&mut self) {
        let Self { next, continued, paths, .. } = &mut *self;
        continued.clear();
        continued.resize(paths.len(), false);
        for &path in &next.path[..next.len()] {
            continued[path as usize] = true;
        }
        for i in 0..self.rays.len() {
            let path = self.rays.path[i];
            if !self.continued[path as usize]
                && let Some(branch) = self.waiting.pop(path)
            {
                self.next.provide();
                self.next.push(&branch.ray, branch.throughput, path);
                self.next_carried.push_state(branch.state, branch.ray.t_min);
                if let Footprint::Carried(differential) = branch.footprint {
                    self.next_carried.push_differential(differential);
                }
            }
        }
    }

    /// Bytes for each path of the columns with storage in `scene`, by the name of the group; without rays that wait.
    pub fn bytes_per_path(scene: &PreparedScene) -> Vec<(&'static str, usize)> {
        let groups = scene.plan.schedule().columns();
        groups.map(|group| (group.name(), row_bytes(group))).collect()
    }

    /// Measured bytes of its columns.
    pub fn bytes(&self) -> u64 {
        let Self { paths, rays, lit, tints, shadows, next, .. } = self;
        let lit = lit.bytes() + tints.bytes();
        let groups = [paths.bytes(), rays.bytes(), lit, shadows.bytes()];
        let lists = self.carried.bytes()
            + self.next_carried.bytes()
            + self.media.capacity() * size_of::<MediumStack>()
            + self.hits.capacity() * size_of::<Hit>()
            + self.occluded.capacity()
            + self.crossings.bytes();
        (groups.iter().sum::<usize>() + next.bytes() + lists + self.waiting.bytes()) as u64
    }
}

/// Bytes of one row of a group of columns.
fn row_bytes(group: ColumnGroup) -> usize {
    match group {
        ColumnGroup::Paths => Paths::ROW_BYTES,
        ColumnGroup::Rays | ColumnGroup::NextRays => Rays::ROW_BYTES,
        ColumnGroup::Hits => size_of::<Hit>(),
        ColumnGroup::LitPoints => LitPoints::ROW_BYTES,
        ColumnGroup::Tints => Tints::ROW_BYTES,
        ColumnGroup::ShadowRays => Rays::ROW_BYTES + size_of::<bool>(),
        // For this bounce and the next.
        ColumnGroup::Differentials => 2 * size_of::<Differential>(),
        ColumnGroup::Branches => {
            2 * CarriedRows::STATE_BYTES + size_of::<MediumStack>() + BranchStacks::ROW_BYTES
        }
    }
}
