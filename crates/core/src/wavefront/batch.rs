//! The columns of a batch: structures of arrays, each with its unit, writer and readers.
//!
//! Positions are in world space, moved by the scene's origin; radiance is linear. Passes read and write eight rows at a
//! time, or one where instructions are not wide. Columns have room for a whole vector after the last row, with
//! unspecified values.

#[macro_use]
mod columns;
mod branches;
mod lit;

use glam::Vec3;

use crate::accel::{Hit, RayColumns, Rays as AllRays};
use crate::kernels::shade::SHADOW_END;
use crate::kernels::{Differential, MirrorRequest, ShadowRequest};
use crate::math::{LANES, Line, Mask, Ray, Single, Vector};
use crate::plan::schedule::ColumnGroup;
use crate::prepared::{MediumStack, PathState, PreparedScene, ShadowCrossings};
use crate::wavefront::faces::SortedHits;
use columns::Column;

pub use branches::BranchStacks;
pub use columns::Vectors;
pub use lit::{LitPoints, Tints};

columns! {
    /// Rays from the camera or from surfaces, t from 0, or from the row of [`Batch::starts`], to infinity. Written by
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

    /// Appends the lanes with a mirror ray, of these paths.
    #[inline(always)]
    pub fn push_lanes<F: Single>(&mut self, rays: &MirrorRequest<F>, path: &[u32; LANES]) {
        let (i, asked) = (self.rows, rays.asked);
        self.origin.pack(i, rays.line.origin, asked);
        self.direction.pack(i, rays.line.direction, asked);
        self.throughput.pack(i, rays.throughput, asked);
        F::pack_integers(rays.throughput.x.token(), path, asked, &mut self.path[i..i + F::LANES]);
        self.rows += asked.bits().count_ones() as usize;
    }
}

/// Rays in the form of kernels.
fn columns_of<'a>(
    count: usize,
    origin: &'a Vectors,
    direction: &'a Vectors,
    (t_min, t_max): (Option<&'a [f32]>, f32),
) -> AllRays<'a> {
    let (origin, direction) = (origin.columns(), direction.columns());
    AllRays::Columns(RayColumns { count, origin, direction, t_min, t_max })
}

columns! {
    /// A hit for each ray. Written by intersect, read by shade.
    Hits {
        /// t, infinite for a miss, and the primitive's number; where nothing needs it, t may be more than that of the hit.
        hit: Vec<Hit>,
    }
}

columns! {
    /// Shadow rays, t from 0 to [`SHADOW_END`]. Written and read by shadow.
    ShadowRays {
        /// Origin.
        origin: Vectors,
        /// To the light; its length is the distance.
        direction: Vectors,
        /// The radiance to add to the path if the ray is not occluded.
        contribution: Vectors,
        /// The path, by its number in the batch.
        path: Vec<u32>,
        /// Whether the ray is occluded.
        occluded: Vec<bool>,
    }
}

impl<'a> From<&'a ShadowRays> for AllRays<'a> {
    fn from(rays: &'a ShadowRays) -> Self {
        columns_of(rays.rows, &rays.origin, &rays.direction, (None, SHADOW_END))
    }
}

impl ShadowRays {
    /// Appends the lanes with a request, of these paths. Returns their number.
    #[inline(always)]
    pub fn push_lanes<F: Single>(&mut self, requests: &ShadowRequest<F>, path: &[u32]) -> usize {
        let (i, asked) = (self.rows, requests.asked);
        self.origin.pack(i, requests.line.origin, asked);
        self.direction.pack(i, requests.line.direction, asked);
        self.contribution.pack(i, requests.contribution, asked);
        let token = requests.contribution.x.token();
        F::pack_integers(token, path, asked, &mut self.path[i..i + F::LANES]);
        let count = asked.bits().count_ones() as usize;
        self.rows += count;
        count
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
        place: Vec<u32>,
    }
}

impl Paths {
    /// Appends paths without radiance, of these pixels, samples and places; the first `count` lanes
    /// are used.
    #[inline(always)]
    pub fn push_lanes<F: Single>(
        &mut self,
        token: F::Token,
        [pixel, sample, place]: [&[u32; LANES]; 3],
        count: usize,
    ) {
        let lanes = self.rows..self.rows + F::LANES;
        self.radiance.store::<F>(self.rows, Vector::splat(token, Vec3::ZERO));
        self.pixel[lanes.clone()].copy_from_slice(&pixel[..F::LANES]);
        self.sample[lanes.clone()].copy_from_slice(&sample[..F::LANES]);
        self.place[lanes].copy_from_slice(&place[..F::LANES]);
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
    /// Their hits.
    pub hits: Hits,
    /// Their hits that lights may reach.
    pub lit: LitPoints,
    /// The highlight colours of these.
    pub tints: Tints,
    /// Queued shadow rays.
    pub shadows: ShadowRays,
    /// The rays of the next bounce.
    pub next: Rays,
    /// The differentials of the rays after the first bounce, if the scene needs them. Those of camera
    /// rays follow from their directions and have no rows. Written and read by shade.
    pub differentials: Vec<Differential>,
    /// The differentials of the next rays.
    pub next_differentials: Vec<Differential>,
    /// The states of the rays after the first bounce, if surfaces let light through. Written and read
    /// by shade.
    pub states: Vec<PathState>,
    /// The states of the next rays.
    pub next_states: Vec<PathState>,
    /// The least t of the rays after the first bounce, if surfaces let light through: those that go straight
    /// on begin behind a hit. Written by shade, read by intersect and shade.
    pub starts: Vec<f32>,
    /// Those of the next rays.
    pub next_starts: Vec<f32>,
    /// For each path what its ray of this bounce is inside of, if surfaces let light through. Written by
    /// shade, read by shadow.
    pub media: Vec<MediumStack>,
    /// Rays that wait until the rays before them on their path are done.
    pub waiting: BranchStacks,
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
            hits: Hits::with_capacity(room(ColumnGroup::Hits)),
            lit: LitPoints::with_capacity(room(ColumnGroup::LitPoints)),
            tints: Tints::with_capacity(room(ColumnGroup::Tints)),
            shadows: ShadowRays::with_capacity(room(ColumnGroup::ShadowRays)),
            next: Rays::with_capacity(room(ColumnGroup::NextRays)),
            differentials: Vec::new(),
            next_differentials: Vec::new(),
            states: Vec::new(),
            next_states: Vec::new(),
            starts: Vec::new(),
            next_starts: Vec::new(),
            media: Vec::new(),
            waiting: BranchStacks::with_capacity(room(ColumnGroup::Branches)),
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
        let t_min = if self.states.is_empty() { 0.0 } else { self.starts[i] };
        Ray { t_min, ..self.rays.ray(i) }
    }

    /// Keeps what the `i`th ray of this bounce is inside of, for shadow rays from its hit.
    pub fn set_media(&mut self, i: usize, media: MediumStack) {
        if self.media.is_empty() {
            self.media.resize(self.capacity, MediumStack::default());
        }
        self.media[self.rays.path[i] as usize] = media;
    }

    /// The rays of this bounce in the form of kernels.
    pub fn all_rays(&self) -> AllRays<'_> {
        let Rays { rows, origin, direction, .. } = &self.rays;
        let t_min = Some(self.starts.as_slice()).filter(|_| !self.states.is_empty());
        columns_of(*rows, origin, direction, (t_min, f32::INFINITY))
    }

    /// Appends the state of a next ray, and its least t.
    pub fn push_state(&mut self, state: PathState, t_min: f32) {
        append(&mut self.next_states, self.capacity, state);
        if self.next_starts.is_empty() {
            self.next_starts.resize(columns::room(self.capacity), 0.0);
        }
        self.next_starts[self.next_states.len() - 1] = t_min;
    }

    /// Appends the differential of a next ray.
    pub fn push_differential(&mut self, differential: Differential) {
        append(&mut self.next_differentials, self.capacity, differential);
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
        std::mem::swap(&mut self.differentials, &mut self.next_differentials);
        self.next_differentials.clear();
        std::mem::swap(&mut self.states, &mut self.next_states);
        self.next_states.clear();
        std::mem::swap(&mut self.starts, &mut self.next_starts);
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
                self.push_state(branch.state, branch.ray.t_min);
                if let Some(differential) = branch.differential {
                    self.push_differential(differential);
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
        let Self { capacity: _, paths, rays, hits, lit, tints, shadows, next, .. } = self;
        let lit = lit.bytes() + tints.bytes();
        let groups = [paths.bytes(), rays.bytes(), hits.bytes(), lit, shadows.bytes()];
        let differentials = self.differentials.capacity() + self.next_differentials.capacity();
        let states = self.states.capacity() + self.next_states.capacity();
        let lists = differentials * size_of::<Differential>()
            + states * STATE_BYTES
            + self.media.capacity() * size_of::<MediumStack>()
            + self.crossings.bytes();
        (groups.iter().sum::<usize>() + next.bytes() + lists + self.waiting.bytes()) as u64
    }
}

/// Appends a row to a list that has room for all `paths` from its first row on.
fn append<T>(rows: &mut Vec<T>, paths: usize, row: T) {
    if rows.is_empty() {
        rows.reserve_exact(columns::room(paths));
    }
    rows.push(row);
}

/// Bytes of a state and a least t.
const STATE_BYTES: usize = size_of::<PathState>() + size_of::<f32>();

/// Bytes of one row of a group of columns.
fn row_bytes(group: ColumnGroup) -> usize {
    match group {
        ColumnGroup::Paths => Paths::ROW_BYTES,
        ColumnGroup::Rays | ColumnGroup::NextRays => Rays::ROW_BYTES,
        ColumnGroup::Hits => Hits::ROW_BYTES,
        ColumnGroup::LitPoints => LitPoints::ROW_BYTES,
        ColumnGroup::Tints => Tints::ROW_BYTES,
        ColumnGroup::ShadowRays => ShadowRays::ROW_BYTES,
        // For this bounce and the next.
        ColumnGroup::Differentials => 2 * size_of::<Differential>(),
        ColumnGroup::Branches => {
            2 * STATE_BYTES + size_of::<MediumStack>() + BranchStacks::ROW_BYTES
        }
    }
}
