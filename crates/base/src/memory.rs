//! Counts the memory of the process, keeps its limit, and records what it is for, so that a message can say what the
//! refused memory was for.
//!
//! The command's allocator counts what it hands out, and whoever maps memory counts that. Each thread keeps a count of its
//! own and adds it to the common one in steps, so that small allocations do not contend.

use std::cell::Cell;
use std::fmt::{self, Display};
use std::sync::atomic::{AtomicIsize, AtomicU8, AtomicUsize, Ordering};
use std::sync::{Mutex, Once};

use crate::error::{Error, ErrorKind, Result};
use crate::lock;
use crate::words::Size;

crate::choices! {
    /// The current activity of the process.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Stage {
        /// None of the other stages.
        Other = "working",
        /// Reading the scene and its meshes.
        Read = "reading the scene",
        /// Extracting primitives, lights and textures.
        Extract = "preparing the scene",
        /// Building the BVH.
        Build = "building the BVH",
        /// Tracing rays.
        Trace = "tracing rays",
        /// Writing files.
        Write = "writing files",
    }
}

impl Stage {
    /// Sets the current stage.
    pub fn begin(self) {
        STAGE.store(self as u8, Ordering::Relaxed);
    }

    /// The current stage.
    pub fn now() -> Self {
        Self::ALL.get(usize::from(STAGE.load(Ordering::Relaxed))).copied().unwrap_or(Self::Other)
    }
}

static STAGE: AtomicU8 = AtomicU8::new(0);

/// Says more of the current activity than the [`Stage`], such as "reading a.png", until it is dropped.
#[derive(Debug)]
pub struct Activity(String);

impl Activity {
    /// Begins this one.
    pub fn new(what: String) -> Self {
        lock(&ACTIVITIES).push(what.clone());
        Self(what)
    }
}

impl Drop for Activity {
    fn drop(&mut self) {
        let mut all = lock(&ACTIVITIES);
        if let Some(own) = all.iter().position(|what| *what == self.0) {
            all.remove(own);
        }
    }
}

/// The activities that have begun on any thread.
static ACTIVITIES: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// What the process does now, by its activities or else by its stage. Takes no memory.
pub fn activity() -> impl Display {
    fmt::from_fn(|to| match ACTIVITIES.try_lock() {
        Ok(all) if !all.is_empty() => all.iter().enumerate().try_for_each(|(number, what)| {
            write!(to, "{}{what}", if number == 0 { "" } else { ", " })
        }),
        // The caller may hold the lock.
        _ => to.write_str(Stage::now().name()),
    })
}

/// Bytes that are held, but for what threads have not told yet.
static HELD: AtomicIsize = AtomicIsize::new(0);

/// Bytes that may be held.
static LIMIT: AtomicIsize = AtomicIsize::new(isize::MAX);

/// Bytes that a thread takes or frees before it tells.
const STEP: isize = 1 << 16;

thread_local! {
    /// Bytes that this thread has taken and not told; below 0 if it has freed more.
    static UNTOLD: Cell<isize> = const { Cell::new(0) };
    static IS_TRYING: Cell<bool> = const { Cell::new(false) };
}

/// Counts bytes that are now held in addition, or fewer ones, whatever the limit.
#[inline]
pub fn count(change: isize) {
    let untold = UNTOLD.get().saturating_add(change);
    if untold.abs() < STEP {
        UNTOLD.set(untold);
        return;
    }
    UNTOLD.set(0);
    HELD.fetch_add(untold, Ordering::Relaxed);
}

/// Counts bytes that an allocator is asked for; false, and they are not counted, if that would exceed the limit.
#[inline]
pub fn take(bytes: usize) -> bool {
    let untold = UNTOLD.get().saturating_add_unsigned(bytes);
    if untold < STEP {
        UNTOLD.set(untold);
        return true;
    }
    let limit = LIMIT.load(Ordering::Relaxed);
    let more = |held: isize| held.checked_add(untold).filter(|&held| held <= limit);
    let told = HELD.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).is_ok();
    if told {
        UNTOLD.set(0);
    }
    told
}

/// Lets the process hold so many bytes from now on, with the program itself.
pub fn limit(bytes: u64) {
    static BEGIN: Once = Once::new();
    // No allocator counts code and stacks.
    BEGIN.call_once(|| {
        let held = HELD.load(Ordering::Relaxed).unsigned_abs() as u64;
        let program = process().map_or(0, |[now, _]| now.saturating_sub(held));
        count(isize::try_from(program).unwrap_or(0));
    });
    LIMIT.store(isize::try_from(bytes).unwrap_or(isize::MAX), Ordering::Relaxed);
}

/// Counts memory that is mapped, as far as it is used, until it is dropped.
#[derive(Debug, Default)]
pub struct Mapped(AtomicUsize);

impl Mapped {
    /// Counts so many bytes more.
    pub fn add(&self, bytes: usize) {
        self.0.fetch_add(bytes, Ordering::Relaxed);
        count(bytes.cast_signed());
    }
}

impl Drop for Mapped {
    fn drop(&mut self) {
        count(-self.0.get_mut().cast_signed());
    }
}

/// Whether this thread is requesting memory that it can do without: the allocator then reports
/// nothing.
pub fn is_trying() -> bool {
    IS_TRYING.get()
}

/// An empty list with room for `count` values of `what`.
///
/// # Errors
/// If the system has not enough memory, or the limit does not allow it.
pub fn reserve<T>(count: usize, what: &str) -> Result<Vec<T>> {
    let mut values = Vec::new();
    IS_TRYING.set(true);
    let reserved = values.try_reserve_exact(count);
    IS_TRYING.set(false);
    reserved.map_err(|cause| {
        let bytes = count.saturating_mul(size_of::<T>());
        let message = Refuser::of(bytes).message(bytes, what).to_string();
        Error::new(ErrorKind::Limit, message).because(cause)
    })?;
    Ok(values)
}

/// Who refuses memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refuser {
    /// The limit.
    Limit,
    /// The system.
    System,
}

impl Refuser {
    /// Who has refused so many bytes.
    fn of(bytes: usize) -> Self {
        let exceeds = total(bytes) > LIMIT.load(Ordering::Relaxed);
        if exceeds { Self::Limit } else { Self::System }
    }

    /// That it refuses so many bytes for `what`. Takes no memory.
    pub fn message(self, bytes: usize, what: impl Display) -> impl Display {
        fmt::from_fn(move |to| match self {
            Self::Limit => {
                let [limit, all] = [LIMIT.load(Ordering::Relaxed), total(bytes)];
                let [limit, all] = [limit, all].map(|bytes| Size(bytes.unsigned_abs() as u64));
                write!(to, "{what} needs more memory than --memory-limit {limit}, found {all}")
            }
            Self::System => {
                write!(to, "the system refused {} of memory for {what}", Size(bytes as u64))
            }
        })
    }
}

/// The bytes held with so many more.
fn total(more: usize) -> isize {
    HELD.load(Ordering::Relaxed).saturating_add(UNTOLD.get()).saturating_add_unsigned(more)
}

/// Allocates as much memory, and frees it again. Programs with Rust's own allocator, which aborts if
/// memory is refused, can check before they begin.
///
/// # Errors
/// If the system refuses that much.
pub fn check_room(bytes: u64, what: &str) -> Result<()> {
    let room = reserve::<u8>(usize::try_from(bytes).unwrap_or(usize::MAX), what)
        .map_err(|error| error.remedy("free some, or use a smaller mesh, scene or image"))?;
    // The compiler may leave out an allocation that nothing reads.
    std::hint::black_box(room.as_ptr());
    Ok(())
}

/// The memory of this process in bytes, now and at its peak, if the system reports it.
pub fn process() -> Option<[u64; 2]> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let reported = |key| {
        let line = status.lines().find_map(|line| line.strip_prefix(key))?;
        Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
    };
    Some([reported("VmRSS:")?, reported("VmHWM:")?])
}

/// The peak memory of this process so far in bytes, if the system reports it.
pub fn peak() -> Option<u64> {
    process().map(|[_, peak]| peak)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_memory_is_an_error_with_its_size() {
        let error = reserve::<[u8; 16]>(1 << 58, "the image").unwrap_err().to_string();
        assert!(error.starts_with("the system refused 4.6 EB of memory for the image"));
        assert!(reserve::<u8>(10, "the image").unwrap().capacity() >= 10);
        assert!(!is_trying());
    }

    #[test]
    fn stages_and_activities_are_noted() {
        for stage in Stage::ALL {
            stage.begin();
            assert_eq!(Stage::now(), stage);
        }
        // Other tests have activities, too.
        let is_noted = |what: &str| activity().to_string().contains(what);
        let first = Activity::new("reading a.png".to_owned());
        let second = Activity::new("reading b.ply".to_owned());
        assert!(is_noted("reading a.png") && is_noted("reading b.ply"));
        drop(first);
        assert!(!is_noted("reading a.png") && is_noted("reading b.ply"));
        drop(second);
        assert!(!is_noted("reading b.ply") && !activity().to_string().is_empty());
    }

    /// Threads tell in steps what they take and free, and nothing is lost in between.
    #[test]
    fn what_threads_take_and_free_is_counted() {
        let step = STEP.unsigned_abs();
        let before = total(0);
        assert!((0..1000).all(|_| take(100)) && take(10 * step));
        assert_eq!(total(0) - before, 100_000 + 10 * STEP);
        count(-10 * STEP);
        (0..1000).for_each(|_| count(-100));
        assert_eq!(total(0), before);
        let threads = || {
            std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(|| take(3 * step)))))
        };
        threads();
        assert_eq!(total(0) - before, 4 * 3 * STEP);
        let mapped = Mapped::default();
        mapped.add(2 * step);
        assert_eq!(total(0) - before, 14 * STEP);
        drop(mapped);
        count(-12 * STEP);
        assert_eq!(total(0), before);
    }
}
