//! The shard of a process: given explicitly, or by the scheduler of its array job.

use std::str::FromStr;

use Numbering::{Between, FromZero, Unsaid};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_image::farm::Shard;

/// The value of `--shard`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShardChoice {
    /// This shard.
    Given(Shard),
    /// The shard from the scheduler, with the number of shards if given.
    Auto(Option<u32>),
}

/// How a process finds its task in a scheduler's array: the variable with the task's number, and
/// the numbering.
struct Scheduler(&'static str, Numbering);

/// How the tasks of an array are numbered.
enum Numbering {
    /// Chosen by the user: variables with the first number, with the last, and with a number that
    /// shows, beside the count from the first to the last, whether none between them is left out.
    Between([&'static str; 3], fn(u64, u64) -> bool),
    /// From 0: a variable with the number of tasks, if any.
    FromZero(Option<&'static str>),
    /// Chosen by the user, without a variable for the range.
    Unsaid,
}

/// The schedulers, in the order of the checks.
const SCHEDULERS: [Scheduler; 7] = [
    Scheduler(
        "SLURM_ARRAY_TASK_ID",
        Between(
            ["SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX", "SLURM_ARRAY_TASK_COUNT"],
            |tasks, count| tasks == count,
        ),
    ),
    // Grid Engine. Outside an array the value is "undefined".
    Scheduler(
        "SGE_TASK_ID",
        Between(["SGE_TASK_FIRST", "SGE_TASK_LAST", "SGE_TASK_STEPSIZE"], |step, _| step == 1),
    ),
    Scheduler("AWS_BATCH_JOB_ARRAY_INDEX", FromZero(Some("AWS_BATCH_JOB_ARRAY_SIZE"))),
    // Google Cloud Batch.
    Scheduler("BATCH_TASK_INDEX", FromZero(Some("BATCH_TASK_COUNT"))),
    // Kubernetes.
    Scheduler("JOB_COMPLETION_INDEX", FromZero(None)),
    Scheduler("PBS_ARRAY_INDEX", Unsaid),
    // LSF. Outside an array the value is 0.
    Scheduler("LSB_JOBINDEX", Unsaid),
];

impl FromStr for ShardChoice {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text.strip_prefix("auto") {
            Some("") => Ok(Self::Auto(None)),
            Some(rest) => {
                let count = rest.strip_prefix('/').and_then(|count| count.parse().ok());
                let count = count.filter(|count| *count > 0);
                let wrong = || "write how many shards there are, such as auto/7".to_owned();
                count.map(|count| Self::Auto(Some(count))).ok_or_else(wrong)
            }
            None => text.parse().map(Self::Given),
        }
    }
}

impl ShardChoice {
    /// The shard, given the environment variables.
    ///
    /// # Errors
    /// If there is no array job, its number of tasks is unknown, or it has no task with this
    /// number.
    pub(super) fn resolve(self, variable: impl Fn(&str) -> Option<String>) -> Result<Shard> {
        let count = match self {
            Self::Given(shard) => return Ok(shard),
            Self::Auto(count) => count,
        };
        let number = |name: &str| variable(name)?.trim().parse::<u64>().ok();
        let found = SCHEDULERS.iter().find_map(|one| Some((one, number(one.0)?)));
        let Some((scheduler, task)) = found else {
            return Err(Error::new(ErrorKind::Usage, "no array job of a scheduler was found")
                .remedy("name the shard instead, such as --shard 3/7"));
        };
        let (first, tasks) = scheduler.range(count, number)?;
        let index = task.checked_sub(first).and_then(|index| u32::try_from(index + 1).ok());
        let shard = index.and_then(|index| Shard::new(index, tasks));
        shard.ok_or_else(|| {
            let last = first + u64::from(tasks) - 1;
            Error::new(ErrorKind::Usage, format!("the task has no shard: {}", scheduler.0))
                .value(task)
                .remedy(format!("number the tasks of the array from {first} to {last}"))
        })
    }
}

impl Scheduler {
    /// The number of the first task, and the number of tasks.
    fn range(
        &self,
        count: Option<u32>,
        number: impl Fn(&str) -> Option<u64>,
    ) -> Result<(u64, u32)> {
        let unknown = || {
            Error::new(ErrorKind::Usage, "the scheduler does not say how many shards there are")
                .value(self.0)
                .remedy("add it, such as --shard auto/7, and number the tasks from 1")
        };
        let tasks = |count: Option<u64>| count.and_then(|count| u32::try_from(count).ok());
        match (&self.1, count) {
            (FromZero(_), Some(count)) => Ok((0, count)),
            (_, Some(count)) => Ok((1, count)),
            (FromZero(Some(name)), None) => Ok((0, tasks(number(name)).ok_or_else(unknown)?)),
            (FromZero(None) | Unsaid, None) => Err(unknown()),
            (Between([first, last, third], is_whole), None) => {
                let (first, last) = number(first).zip(number(last)).ok_or_else(unknown)?;
                let count = last.checked_sub(first).and_then(|count| count.checked_add(1));
                let is_whole = |count: &u64| number(third).is_some_and(|n| is_whole(n, *count));
                let count = tasks(count.filter(is_whole));
                count.map(|count| (first, count)).ok_or_else(|| {
                    Error::new(ErrorKind::Usage, "the task numbers of the array have gaps")
                        .value(format!("{first} to {last}, some left out"))
                        .remedy("number them without gaps, or give their count with --shard auto/7")
                })
            }
        }
    }
}
