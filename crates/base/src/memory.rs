//! Records the purpose of memory, so that a message can say what the refused memory was for.

use std::cell::Cell;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::error::{Error, ErrorKind, Result};
use crate::words::Size;

crate::choices! {
    /// The current activity of the process, by the end of a message: "while it was ...".
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

thread_local! {
    static IS_TRYING: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread is requesting memory that it can do without: the allocator then reports
/// nothing.
pub fn is_trying() -> bool {
    IS_TRYING.try_with(Cell::get).unwrap_or(false)
}

/// An empty list with room for `count` values of `what`.
///
/// # Errors
/// If the system has not enough memory.
pub fn reserve<T>(count: usize, what: &str) -> Result<Vec<T>> {
    let mut values = Vec::new();
    IS_TRYING.set(true);
    let reserved = values.try_reserve_exact(count);
    IS_TRYING.set(false);
    reserved.map_err(|cause| {
        let size = Size(count.saturating_mul(size_of::<T>()) as u64);
        Error::new(ErrorKind::Limit, format!("the system refused {size} of memory for {what}"))
            .because(cause)
    })?;
    Ok(values)
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
    fn stages_are_noted() {
        for stage in Stage::ALL {
            stage.begin();
            assert_eq!(Stage::now(), stage);
        }
    }
}
