//! Exact counts of the work of a render: they show that a scene pays only for the effects it uses.
//!
//! What statistics show of them is serialised under the names of the fields.

use std::ops::AddAssign;

use bytemuck::{Pod, Zeroable};
use serde::Serialize;

/// Declares groups of counts, which add up field by field.
macro_rules! counts {
    ($($(#[$doc:meta])+ $name:ident { $($(#[$about:meta])+ $field:ident: $kind:ty,)+ })+) => {$(
        $(#[$doc])+
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable, Serialize)]
        #[repr(C)]
        pub struct $name {
            $($(#[$about])+ pub $field: $kind,)+
        }

        impl AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                *self = each(*self, other, |a, b| a + b);
            }
        }
    )+};
}

counts! {
    /// Rays by kind.
    RayCounts {
        /// Camera rays.
        primary: u64,
        /// Rays that go on from surfaces: mirrored, refracted, or straight on.
        secondary: u64,
        /// Shadow rays.
        shadow: u64,
    }

    /// Points sampled, hits on surfaces, and look-ups in textures and mesh attributes.
    SampleCounts {
        /// Points sampled on the lens.
        lens: u64,
        /// Points sampled on area lights.
        light: u64,
        /// Hits whose colour was interpolated between vertices.
        colors: u64,
        /// Texels read.
        texels: u64,
        /// Footprints of rays: at each hit one for the coordinates of its trilinear textures, and one for
        /// each ray that goes on from a surface if there are such textures.
        footprints: u64,
        /// Hits on surfaces whose look is constant and that are opaque.
        #[serde(skip)]
        plain: u64,
        /// Other hits on surfaces: on those with maps, and on transparent ones.
        #[serde(skip)]
        mapped: u64,
        /// Look-ups of maps at these hits, each of one map at one hit.
        #[serde(skip)]
        maps: u64,
    }

    /// Primitives by kind, or tests of them.
    PrimitiveCounts {
        /// Triangles.
        triangles: u64,
        /// Quads; of tests, those of their halves.
        quads: u64,
        /// Spheres.
        spheres: u64,
        /// Disks.
        disks: u64,
    }

    /// Work while tracing.
    TestCounts {
        /// Inner nodes visited, each testing the boxes of its children.
        nodes: u64,
        /// Instances visited, counted for each ray.
        instances: u64,
        /// Hits on cut-outs that would replace the ray's best, each with a look-up of alpha.
        cutouts: u64,
        /// Primitives tested.
        primitives: PrimitiveCounts,
        /// Leaves visited.
        #[serde(skip)]
        leaves: u64,
        /// Triangles that single precision left open, settled in double precision.
        #[serde(skip)]
        settled: u64,
        /// Triangles that double precision left open too, decided in exact arithmetic.
        #[serde(skip)]
        exact: u64,
        /// Hits whose t was found when their ray was done.
        #[serde(skip)]
        finished: u64,
    }

    /// The kernels' work for rays of one class. Every ray counts for its first kernel: `packet`, `stream` and
    /// `single` sum up to all rays.
    KernelCounts {
        /// Rays taken by packets.
        packet: u64,
        /// Rays that packets handed over to the kernel in flight.
        handed_over: u64,
        /// Rays in flight from their start.
        stream: u64,
        /// Rays taken alone.
        single: u64,
        /// Rays of a packet that visit a node together.
        rays_a_node: Average,
        /// Rays in flight in a round.
        rays_a_round: Average,
    }

    /// The work of the kernels, by query.
    Kernels {
        /// For closest-hit rays: all but shadow rays.
        closest: KernelCounts,
        /// For any-hit rays: shadow rays.
        shadow: KernelCounts,
        /// For rays of which all is asked for that they cross: those of them that nothing opaque blocks.
        #[serde(skip)]
        crossed: KernelCounts,
    }
}

/// Counts for one thread or for a whole render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Rays.
    pub rays: RayCounts,
    /// Samples and look-ups.
    pub samples: SampleCounts,
    /// Tests of boxes and primitives.
    pub tests: TestCounts,
    /// Rays by the kernel that traced them.
    pub kernels: Kernels,
    /// Samples that were not finite; they count as black.
    pub invalid: u64,
    /// The first of these in the order of pixels.
    pub first_invalid: Option<Sample>,
    /// Shadow rays to a light within the rounding error of the surface: its distance counts as that
    /// error.
    pub lights_at_surface: u64,
    /// Paths that ended at the largest number of rays.
    pub cut_short: u64,
}

/// A sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Sample {
    /// The pixel: its row times the image's width plus its column.
    pub pixel: u32,
    /// The camera ray within the pixel.
    pub sample: u32,
}

impl Counters {
    /// Counts samples that were not finite; `first` is the first of them.
    pub fn add_invalid(&mut self, count: u64, first: Option<Sample>) {
        self.invalid += count;
        self.first_invalid = [self.first_invalid, first].into_iter().flatten().min();
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.samples += other.samples;
        self.tests += other.tests;
        self.kernels += other.kernels;
        self.add_invalid(other.invalid, other.first_invalid);
        self.lights_at_surface += other.lights_at_surface;
        self.cut_short += other.cut_short;
    }
}

impl RayCounts {
    /// Rays of every kind.
    pub fn all(&self) -> u64 {
        self.primary + self.secondary + self.shadow
    }
}

impl PrimitiveCounts {
    /// Those of every kind.
    pub fn all(&self) -> u64 {
        self.triangles + self.quads + self.spheres + self.disks
    }

    /// Counts tests of `count` triangles, `quads` of them halves of quads, by `rays` rays.
    #[inline(always)]
    pub(crate) fn count_triangles(&mut self, count: u32, quads: u32, rays: u32) {
        self.triangles += u64::from((count - quads) * rays);
        self.quads += u64::from(quads * rays);
    }
}

impl KernelCounts {
    /// Rays of the class.
    pub fn rays(&self) -> u64 {
        self.packet + self.stream + self.single
    }
}

/// An average, which is `None` of nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable, Serialize)]
#[repr(C)]
#[serde(into = "Option<f64>")]
pub struct Average {
    sum: u64,
    count: u64,
}

impl Average {
    /// Adds `count` numbers with this sum.
    #[inline(always)]
    pub(crate) fn add(&mut self, sum: u64, count: u64) {
        self.sum += sum;
        self.count += count;
    }
}

impl From<Average> for Option<f64> {
    fn from(Average { sum, count }: Average) -> Self {
        (count > 0).then(|| sum as f64 / count as f64)
    }
}

/// Joins counts field by field: all of them are `u64`.
pub(crate) fn each<T: Pod>(mut counts: T, others: T, join: impl Fn(u64, u64) -> u64) -> T {
    let fields: &mut [u64] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut counts));
    let others: &[u64] = bytemuck::cast_slice(std::slice::from_ref(&others));
    fields.iter_mut().zip(others).for_each(|(count, &other)| *count = join(*count, other));
    counts
}
