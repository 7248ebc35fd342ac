//! Counts of work while searching.

/// Exact counts of the work while tracing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TestCounts {
    /// Inner nodes visited, each testing the boxes of its children.
    pub nodes: u64,
    /// Leaves visited.
    pub leaves: u64,
    /// Triangles tested.
    pub triangles: u64,
    /// Halves of quads tested.
    pub quads: u64,
    /// Spheres tested.
    pub spheres: u64,
    /// Hits on cut-outs, each with a look-up of alpha.
    pub cutouts: u64,
    /// Instances visited, counted for each ray.
    pub instances: u64,
    /// Triangles that single precision left open, settled in double precision.
    pub settled: u64,
    /// Triangles that double precision left open too, decided in exact arithmetic.
    pub exact: u64,
    /// Hits whose t was found when their ray was done.
    pub finished: u64,
}

impl TestCounts {
    /// Counts tests of `count` triangles, `quads` of them halves of quads, by `rays` rays.
    #[inline(always)]
    pub(super) fn count_triangles(&mut self, count: u32, quads: u32, rays: u32) {
        self.triangles += u64::from((count - quads) * rays);
        self.quads += u64::from(quads * rays);
    }

    fn zip(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            nodes: f(self.nodes, other.nodes),
            leaves: f(self.leaves, other.leaves),
            triangles: f(self.triangles, other.triangles),
            quads: f(self.quads, other.quads),
            spheres: f(self.spheres, other.spheres),
            cutouts: f(self.cutouts, other.cutouts),
            instances: f(self.instances, other.instances),
            settled: f(self.settled, other.settled),
            exact: f(self.exact, other.exact),
            finished: f(self.finished, other.finished),
        }
    }
}

impl std::ops::Add for TestCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl std::ops::Sub for TestCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl std::ops::AddAssign for TestCounts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
