//! Renders a scene as a variant says.

use std::collections::BTreeMap;

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::variant::Variant;
use crate::measure::Timing;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::plan::Plan;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, render};

/// One run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its duration.
    pub timing: Timing,
    /// Its image and its work.
    pub rendered: Rendered,
}

impl Run {
    /// Renders `scene` on the threads of the current pool.
    ///
    /// # Errors
    /// Those of [`render`].
    pub fn of(scene: &PreparedScene, options: &RenderOptions) -> Result<Self> {
        let (rendered, timing) = Timing::of(|| render(scene, options, &()));
        let rendered = rendered?;
        Ok(Self { timing: timing.lasting(rendered.seconds), rendered })
    }
}

/// A scene to render in many ways.
pub(super) struct Runner<'a> {
    scene: &'a mut PreparedScene,
    seed: u64,
    planned: Plan,
    pools: BTreeMap<usize, ThreadPool>,
}

impl<'a> Runner<'a> {
    pub(super) fn new(scene: &'a mut PreparedScene, seed: u64) -> Self {
        let planned = scene.plan.clone();
        Self { scene, seed, planned, pools: BTreeMap::new() }
    }

    /// One run of `variant`.
    pub(super) fn run(&mut self, variant: &Variant) -> Result<Run> {
        let &Variant { tracer, time_passes, kernel, simd, batch, threads, planned } = variant;
        self.scene.accel.kernel = kernel;
        if let Some(level) = simd.token() {
            self.scene.accel.level = level;
        }
        self.scene.plan = match planned {
            true => self.planned.clone(),
            false => Plan::of(self.planned.decisions().to_vec(), &unplanned(&PASSES)),
        };
        let options = RenderOptions { tracer, time_passes, batch, seed: self.seed, crop: None };
        let scene = &*self.scene;
        if threads == rayon::current_num_threads() {
            return Run::of(scene, &options);
        }
        let pool = match self.pools.remove(&threads) {
            Some(pool) => pool,
            None => ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
                Error::new(ErrorKind::Usage, format!("cannot start threads: {e}"))
                    .remedy("raise the limits of the process (ulimit -u, -v)")
            })?,
        };
        let run = pool.install(|| Run::of(scene, &options));
        self.pools.insert(threads, pool);
        run
    }
}
