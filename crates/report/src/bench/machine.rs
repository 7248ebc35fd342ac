//! The machine of a benchmark.

use serde::Serialize;

use super::hardware;

/// The machine.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "see crate::bench")]
pub struct Machine {
    pub processor: Option<String>,
    pub cores: usize,
    pub threads: usize,
    pub os: String,
    pub hardware_missing: Option<String>,
}

impl Machine {
    /// The current machine, with the threads of the current pool.
    pub fn this() -> Self {
        Self {
            processor: std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|t| processor(&t)),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
            os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            hardware_missing: hardware::missing(),
        }
    }
}

/// The processor's model in the text of `/proc/cpuinfo`, if present.
pub(super) fn processor(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find_map(|line| line.strip_prefix("model name"))?;
    let name = line.split_once(':')?.1.trim();
    (!name.is_empty()).then(|| name.to_owned())
}
