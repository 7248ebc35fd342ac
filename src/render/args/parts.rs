//! Checkpoints and shards of a render.

use std::path::PathBuf;
use std::time::Duration;

use super::array::Choice;
use crate::common::above_zero;
use wavecrest_base::error::Result;
use wavecrest_image::farm::Shard;
use wavecrest_image::farm::checkpoint::Checkpoint;

/// Default number of seconds between checkpoints.
const USUAL_PAUSE: f64 = 60.0;

/// Options on what is kept, and which share is rendered.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct PartOptions {
    /// Save finished work to this file at intervals, and when SIGINT or SIGTERM stops the render
    #[arg(long, value_name = "FILE", conflicts_with_all = ["target_error", "time_budget"])]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Interval between checkpoints, in seconds [default: 60]
    #[arg(long, value_name = "SECONDS", requires = "checkpoint", value_parser = above_zero)]
    pub(crate) every: Option<f64>,
    /// Resume from the checkpoint, if it exists
    #[arg(long, requires = "checkpoint")]
    pub(crate) resume: bool,
    /// Render shard I of N to a .part file for `wavecrest merge`; auto or auto/N takes I from the scheduler's
    /// array job
    #[arg(long, value_name = "I/N", conflicts_with_all = ["target_error", "time_budget", "stats", "also", "aov", "save_every"])]
    pub(crate) shard: Option<Choice>,
}

impl PartOptions {
    /// The shard to render, if requested.
    pub(in crate::render) fn shard(&self) -> Result<Option<Shard>> {
        self.shard.map(|choice| choice.resolve(|name| std::env::var(name).ok())).transpose()
    }

    /// Bytes of a checkpoint's or a shard's sums in memory for this number of pixels, in addition to the image.
    pub(in crate::render) fn kept_bytes(&self, pixels: u64) -> u64 {
        let keeps = self.checkpoint.is_some() || self.shard.is_some();
        if keeps { pixels * size_of::<[f64; 3]>() as u64 } else { 0 }
    }

    /// The checkpoint, if requested.
    pub(in crate::render) fn checkpoint(&self) -> Option<Checkpoint> {
        let every = self.every.unwrap_or(USUAL_PAUSE);
        Some(Checkpoint {
            file: self.checkpoint.clone()?,
            // Intervals that are too long mean never.
            every: Duration::try_from_secs_f64(every).unwrap_or(Duration::MAX),
            resume: self.resume,
        })
    }
}
