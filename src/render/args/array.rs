//! The shard of a process: given explicitly, or by its array job of Slurm.

use std::str::FromStr;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_image::farm::Shard;

/// The value of `--shard`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShardChoice {
    /// This shard.
    Given(Shard),
    /// The shard from the array job, with the number of shards if given.
    Auto(Option<u32>),
}

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
        let number = |of: &str| variable(&format!("{TASK}{of}"))?.trim().parse::<u64>().ok();
        let Some(task) = number("ID") else {
            return Err(Error::new(ErrorKind::Usage, "no array job of Slurm was found")
                .remedy("name the shard instead, such as --shard 3/7"));
        };
        let (first, tasks) = match count {
            Some(count) => (1, count),
            None => range(["MIN", "MAX", "COUNT"].map(number))?,
        };
        let index = task.checked_sub(first).and_then(|index| u32::try_from(index + 1).ok());
        let shard = index.and_then(|index| Shard::new(index, tasks));
        shard.ok_or_else(|| {
            let last = first + u64::from(tasks) - 1;
            Error::new(ErrorKind::Usage, format!("the task has no shard: {TASK}ID"))
                .value(task)
                .remedy(format!("number the tasks of the array from {first} to {last}"))
        })
    }
}

/// What the variables of a task begin with: its number, the first and the last number, and how many there are.
const TASK: &str = "SLURM_ARRAY_TASK_";

/// The number of the first task, and the number of tasks, of the first and the last number and the count in the variables.
fn range(variables: [Option<u64>; 3]) -> Result<(u64, u32)> {
    let [Some(first), Some(last), Some(count)] = variables else {
        let message = "the array job does not say how many shards there are";
        return Err(Error::new(ErrorKind::Usage, message)
            .value(format!("{TASK}ID without MIN, MAX and COUNT"))
            .remedy("add it, such as --shard auto/7, and number the tasks from 1"));
    };
    let is_whole = last.checked_sub(first).and_then(|rest| rest.checked_add(1)) == Some(count);
    let tasks = u32::try_from(count).ok().filter(|_| is_whole);
    tasks.map(|tasks| (first, tasks)).ok_or_else(|| {
        Error::new(ErrorKind::Usage, "the task numbers of the array have gaps")
            .value(format!("{first} to {last}, some left out"))
            .remedy("number them without gaps, or give their count with --shard auto/7")
    })
}
