//! The machine of a benchmark.

#![allow(missing_docs, reason = "the tables of crate::bench say it once")]

use std::path::Path;

use serde::{Deserialize, Serialize};

/// The circumstances of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Circumstances {
    /// The arguments.
    pub command: Vec<String>,
    /// The machine.
    pub machine: Machine,
}

impl Circumstances {
    /// Those of this process, with these arguments.
    pub fn here(command: Vec<String>) -> Self {
        Self { command, machine: Machine::this() }
    }
}

/// The machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    pub processor: Option<String>,
    pub cores: usize,
    pub threads: usize,
    pub os: String,
    /// The caches of data, from the nearest to the farthest; none if the system does not tell.
    #[serde(default)]
    pub caches: Vec<Cache>,
}

/// A cache of data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cache {
    pub level: u32,
    pub bytes: u64,
    /// Logical processors that share it.
    pub shared_by: usize,
}

impl Machine {
    /// The current machine, with the threads of the current pool.
    pub fn this() -> Self {
        Self {
            processor: std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|t| processor(&t)),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
            os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            caches: caches(Path::new("/sys/devices/system/cpu/cpu0/cache")),
        }
    }

    /// The nearest cache that holds `bytes` of each of `threads`, by name; `None` if no cache is
    /// known.
    pub fn holds(&self, bytes: u64, threads: usize) -> Option<String> {
        let fits = |cache: &&Cache| bytes * threads.min(cache.shared_by) as u64 <= cache.bytes;
        self.caches.first()?;
        let cache = self.caches.iter().find(fits);
        Some(cache.map_or_else(|| "memory".to_owned(), |cache| format!("L{}", cache.level)))
    }
}

/// The processor's model in the text of `/proc/cpuinfo`, if present.
pub(super) fn processor(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find_map(|line| line.strip_prefix("model name"))?;
    let name = line.split_once(':')?.1.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

/// The caches of data that Linux lists in `folder`.
pub(super) fn caches(folder: &Path) -> Vec<Cache> {
    let cache = |index: u32| {
        let of = |name| std::fs::read_to_string(folder.join(format!("index{index}/{name}"))).ok();
        let kibibytes = of("size")?.trim().strip_suffix('K')?.parse::<u64>().ok()?;
        let cache = Cache {
            level: of("level")?.trim().parse().ok()?,
            bytes: kibibytes << 10,
            shared_by: processors_in(of("shared_cpu_list")?.trim())?,
        };
        Some((of("type")?.trim() != "Instruction").then_some(cache))
    };
    (0..).map_while(cache).flatten().collect()
}

/// The number of processors in a list such as "0-3,8".
fn processors_in(list: &str) -> Option<usize> {
    let count = |range: &str| {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        last.parse::<usize>().ok()?.checked_sub(first.parse().ok()?).map(|more| more + 1)
    };
    list.split(',').map(count).sum()
}
