//! The log: a line for each action, choice and result, with the seconds since the start.
//!
//! Lines are appended at once, so that those of a killed render are kept, and those of earlier
//! renders stay. A log that can no longer be written, on a full disk, does not end a render. Lines are
//! never added to a file that is no log, such as a mesh.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use wavecrest_base::error::{Error, ErrorKind, Result};

/// The destination of lines.
type Sink = Box<dyn Write + Send>;

/// A log, if requested.
pub(super) struct Log {
    start: Instant,
    sink: Option<Mutex<Sink>>,
}

impl Log {
    /// Opens the file, or standard output for `-`.
    ///
    /// # Errors
    /// If it cannot be written to, or holds something other than a log.
    pub(super) fn open(file: Option<&Path>) -> Result<Self> {
        let open = |file: &Path| -> Result<Sink> {
            if file == Path::new("-") {
                return Ok(Box::new(std::io::stdout()));
            }
            let failed = |e| {
                Error::io("cannot write the log", file, e).remedy("use a file that you can write")
            };
            check_is_log(file, failed)?;
            let opened = OpenOptions::new().append(true).create(true).open(file);
            Ok(Box::new(opened.map_err(failed)?))
        };
        let sink = file.map(open).transpose()?.map(Mutex::new);
        Ok(Self { start: Instant::now(), sink })
    }

    /// Adds a line; its text is computed only if there is a log.
    pub(super) fn line(&self, topic: &str, text: impl FnOnce() -> String) {
        let Some(sink) = &self.sink else { return };
        let seconds = self.start.elapsed().as_secs_f64();
        let text = text().replace(char::is_control, " ");
        let line = format!("{seconds:10.3}{UNIT}{topic:<8} {text}\n");
        let mut sink = sink.lock().unwrap_or_else(PoisonError::into_inner);
        // In one write, so that the lines of two processes do not mix.
        let _ = sink.write_all(line.as_bytes()).and_then(|()| sink.flush());
    }
}

/// Between the seconds at the start of a line and what follows.
const UNIT: &str = " s  ";

/// Longer than the start of any line.
const START: u64 = 64;

/// Refuses a file with something else in it than a log.
fn check_is_log(file: &Path, failed: impl Fn(std::io::Error) -> Error) -> Result<()> {
    if !file.is_file() {
        return Ok(());
    }
    let mut start = Vec::new();
    File::open(file).and_then(|file| file.take(START).read_to_end(&mut start)).map_err(failed)?;
    let text = String::from_utf8_lossy(&start);
    let seconds = text.split_once(UNIT).map(|(seconds, _)| seconds.trim().parse::<f64>());
    if start.is_empty() || matches!(seconds, Some(Ok(_))) {
        return Ok(());
    }
    let error = Error::new(ErrorKind::Usage, "cannot add to the log: this file is not a log");
    Err(error.in_file(file).remedy("name a new file, or the log of an earlier render"))
}
