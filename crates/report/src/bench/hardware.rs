//! Hardware counters of the processor: cycles, instructions, and misses.
//!
//! Linux provides these counters, unless its settings forbid it or it runs in a virtual machine
//! without them. If there are no counts, the report says why.

/// Counts of all threads in one run, by event: cycles of the clock, instructions completed, accesses
/// to the last level of the caches and those that had to go to memory, and branches predicted
/// wrongly. `null` if the machine does not count the event.
pub type HardwareCounts = serde_json::Map<String, serde_json::Value>;

/// Does `work` and returns the counts of all threads of the current pool, or why they are unknown.
pub fn count<R>(work: impl FnOnce() -> R) -> (R, Result<HardwareCounts, String>) {
    system::count(work)
}

/// Why nothing is counted on this machine; `None` if something is.
pub fn missing() -> Option<String> {
    count(|| ()).1.err()
}

#[cfg(target_os = "linux")]
mod system {
    use std::io;

    use perf_event::events::Hardware;
    use perf_event::{Builder, Counter, ReadFormat};

    use super::HardwareCounts;

    /// The counters of one event, one for each thread.
    type OfThreads = Vec<Counter>;

    const EVENTS: [(&str, Hardware); 5] = [
        ("cycles", Hardware::CPU_CYCLES),
        ("instructions", Hardware::INSTRUCTIONS),
        ("cache_references", Hardware::CACHE_REFERENCES),
        ("cache_misses", Hardware::CACHE_MISSES),
        ("branch_misses", Hardware::BRANCH_MISSES),
    ];

    pub(super) fn count<R>(work: impl FnOnce() -> R) -> (R, Result<HardwareCounts, String>) {
        let mut counters = EVENTS.map(|(_, event)| open(event));
        let started = counters.each_mut().map(|each| switch(each, Counter::enable));
        let result = work();
        let stopped = counters.each_mut().map(|each| switch(each, Counter::disable));
        let counts = counters.each_mut().map(read);
        let all = started.into_iter().chain(stopped).all(|is_done| is_done);
        let why_not = counters.into_iter().find_map(Result::err);
        let counted = match counts {
            _ if counts.iter().all(Option::is_none) => Err(why(why_not)),
            _ if !all => Err(why(None)),
            _ => {
                let named = EVENTS.iter().zip(counts);
                Ok(named.map(|((name, _), count)| ((*name).to_owned(), count.into())).collect())
            }
        };
        (result, counted)
    }

    fn why(error: Option<io::Error>) -> String {
        match error {
            None => "the counters returned nothing".to_owned(),
            Some(error) if error.kind() == io::ErrorKind::PermissionDenied => format!(
                "not permitted ({error}): \
                 see /proc/sys/kernel/perf_event_paranoid"
            ),
            Some(error) => format!("not available on this machine ({error})"),
        }
    }

    /// Each thread opens its own counter: existing threads do not inherit one.
    fn open(event: Hardware) -> io::Result<OfThreads> {
        let times = ReadFormat::TOTAL_TIME_ENABLED | ReadFormat::TOTAL_TIME_RUNNING;
        let one = |_: rayon::BroadcastContext<'_>| Builder::new(event).read_format(times).build();
        rayon::broadcast(one).into_iter().collect()
    }

    /// Whether everything succeeded; counters that were not opened are skipped.
    fn switch(
        counters: &mut io::Result<OfThreads>,
        turn: impl Fn(&mut Counter) -> io::Result<()>,
    ) -> bool {
        counters.as_mut().map_or(true, |all| all.iter_mut().all(|each| turn(each).is_ok()))
    }

    /// The sum over threads.
    fn read(counters: &mut io::Result<OfThreads>) -> Option<u64> {
        counters.as_mut().ok()?.iter_mut().map(read_one).sum()
    }

    fn read_one(counter: &mut Counter) -> Option<u64> {
        let found = counter.read_count_and_time().ok()?;
        match found.time_running {
            // A thread without work ran no counter.
            0 if found.time_enabled == 0 => Some(0),
            0 => None,
            // Multiplexed counters are scaled.
            running => {
                let all = u128::from(found.count) * u128::from(found.time_enabled);
                u64::try_from(all / u128::from(running)).ok()
            }
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use super::HardwareCounts;

    pub(super) fn count<R>(work: impl FnOnce() -> R) -> (R, Result<HardwareCounts, String>) {
        (work(), Err("only read on Linux".to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever machine this is: either something is counted, or it is said why nothing is.
    #[test]
    fn work_is_done_whether_it_is_counted_or_not() {
        let (sum, counted) = count(|| (0..1000_u64).sum::<u64>());
        assert_eq!(sum, 499_500);
        match counted {
            Ok(counts) => {
                assert!(counts.values().any(|count| count.is_u64()));
                assert_eq!(missing(), None);
            }
            Err(why) => assert!(!why.is_empty() && missing().is_some()),
        }
    }
}
