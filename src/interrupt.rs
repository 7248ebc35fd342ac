//! Signals that end a command early: SIGINT, which Ctrl-C sends, and SIGTERM, which schedulers send.
//!
//! A render records the first signal and ends by itself; the second ends the process at once, as the first does to other
//! commands. Temporary files are removed before, and the message lists the files that remain.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

#[cfg(unix)]
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::low_level::signal_name;

use wavecrest_base::error::{Error, ErrorKind};

/// The signals.
#[cfg(unix)]
const SIGNALS: [i32; 2] = [SIGINT, SIGTERM];

/// Offset from the number of a signal to the exit code of a process that it ended, as in shells.
const SIGNALLED: u8 = 128;

/// Whether a render records the first signal.
static IS_RECORDED: AtomicBool = AtomicBool::new(false);

/// The recorded signal; 0 for none.
static RECORDED: AtomicU8 = AtomicU8::new(0);

/// Whether Ctrl-C is how the command ends.
static IS_EXPECTED: AtomicBool = AtomicBool::new(false);

/// The exit code of a process that a signal ended.
pub(super) fn exit_code(signal: u8) -> u8 {
    SIGNALLED.saturating_add(signal)
}

/// Removes temporary files before a signal ends the process, from now on. Where the system allows no handler or no thread
/// for that, as Windows, signals end the process as usual.
#[cfg(not(unix))]
pub(super) fn clean_up() {}

/// As elsewhere.
#[cfg(unix)]
pub(super) fn clean_up() {
    use std::sync::Arc;
    use std::thread;

    use signal_hook::iterator::Signals;
    use signal_hook::{flag, low_level};
    use wavecrest_base::replace::remove_temporary_files;

    let Ok(mut signals) = Signals::new(SIGNALS) else { return };
    let wait = move || {
        for number in signals.forever() {
            let is_recorded = IS_RECORDED.load(Ordering::Relaxed);
            if is_recorded && RECORDED.swap(number as u8, Ordering::Relaxed) == 0 {
                continue;
            }
            remove_temporary_files();
            if number == SIGINT && IS_EXPECTED.load(Ordering::Relaxed) {
                low_level::exit(0);
            }
            let name = signal_name(number).unwrap_or("a signal");
            crate::common::tell_last(&format!("stopped by {name}; {}", left()));
            if !is_recorded {
                // The parent sees what ended the process.
                let _ = low_level::emulate_default_handler(number);
            }
            low_level::exit(exit_code(number as u8).into());
        }
    };
    if thread::Builder::new().spawn(wait).is_err() {
        for number in SIGNALS {
            let _ = flag::register_conditional_default(number, Arc::new(AtomicBool::new(true)));
        }
    }
}

/// Records the first signal from now on, as long as the process lives.
pub(super) fn record() {
    IS_RECORDED.store(true, Ordering::Relaxed);
}

/// Ctrl-C ends the command from now on without a failure: nothing else does.
pub(super) fn expect() {
    IS_EXPECTED.store(true, Ordering::Relaxed);
}

/// The recorded signal, if any.
pub(super) fn signal() -> Option<u8> {
    Some(RECORDED.load(Ordering::Relaxed)).filter(|number| *number > 0)
}

/// The error that the recorded signal ended the work, of which `share` (0 to 1) was finished.
pub(super) fn error(share: f64) -> Error {
    // Rounded down: unfinished work is never 100 %.
    error_at(&format!("{} %", (share * 1000.0).floor() / 10.0))
}

/// The error that the recorded signal ended the work when so much was finished.
pub(super) fn error_at(done: &str) -> Error {
    let signal = signal().unwrap_or_default();
    let name = signal_name(signal.into()).unwrap_or("a signal");
    Error::new(ErrorKind::Interrupted(signal), format!("stopped by {name} at {done}"))
}

/// The files that the process leaves behind, in words.
#[cfg(unix)]
fn left() -> String {
    let files = wavecrest_base::replace::written();
    let left = files.iter().filter(|file| file.exists());
    match &left.map(|file| file.display().to_string()).collect::<Vec<_>>()[..] {
        [] => "no file is written".to_owned(),
        files => format!("written: {}", files.join(", ")),
    }
}
