//! Signals that end a render early: SIGINT, which Ctrl-C sends, and SIGTERM, which schedulers send.
//!
//! The first signal is recorded and the render ends by itself; the second ends the process at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use wavecrest_base::error::{Error, ErrorKind, Result};

/// The signals, with their names.
const SIGNALS: [(i32, &str); 2] = [(SIGINT, "SIGINT"), (SIGTERM, "SIGTERM")];

/// Offset from the number of a signal to the exit code of a process that it ended, as in shells.
const SIGNALLED: u8 = 128;

/// The exit code of a process that a signal ended.
pub(super) fn exit_code(signal: u8) -> u8 {
    SIGNALLED.saturating_add(signal)
}

/// The signal received, if any.
#[derive(Clone, Debug, Default)]
pub(super) struct Interrupt {
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Records signals from now on, as long as the process lives.
    ///
    /// # Errors
    /// If the system does not allow handlers for the signals.
    pub(super) fn listen() -> Result<Self> {
        let signal = Arc::new(AtomicUsize::new(0));
        let seen = Arc::new(AtomicBool::new(false));
        for (number, name) in SIGNALS {
            let code = i32::from(exit_code(number as u8));
            // In this order: the first signal must not see its own record.
            let noted = flag::register_conditional_shutdown(number, code, Arc::clone(&seen))
                .and_then(|_| flag::register_usize(number, Arc::clone(&signal), number as usize))
                .and_then(|_| flag::register(number, Arc::clone(&seen)));
            noted.map_err(|error| {
                Error::new(ErrorKind::Io, format!("cannot handle {name}: {error}")).because(error)
            })?;
        }
        Ok(Self { signal })
    }

    /// The signal received, if any.
    pub(super) fn signal(&self) -> Option<u8> {
        let number = self.signal.load(Ordering::Relaxed) as u8;
        (number > 0).then_some(number)
    }

    /// The error that it ended the work, of which `share` (0 to 1) was finished.
    pub(super) fn error(&self, share: f64) -> Error {
        let signal = self.signal().unwrap_or_default();
        let named = SIGNALS.iter().find(|(number, _)| *number == i32::from(signal));
        let name = named.map_or("a signal", |(_, name)| name);
        // Rounded down: unfinished work is never 100 %.
        let percent = (share * 1000.0).floor() / 10.0;
        let message = format!("stopped by {name} at {percent} %");
        Error::new(ErrorKind::Interrupted(signal), message)
    }
}
