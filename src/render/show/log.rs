//! The log: a line for each action, choice and result, with the seconds since the start.
//!
//! Lines are appended at once, so that those of a killed render are kept, and those of earlier
//! renders stay. A log that can no longer be written, on a full disk, does not end a render.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use wavecrest_base::error::{Error, Result};

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
    /// If it cannot be written to.
    pub(super) fn open(file: Option<&Path>) -> Result<Self> {
        let open = |file: &Path| -> Result<Sink> {
            if file == Path::new("-") {
                return Ok(Box::new(std::io::stdout()));
            }
            let opened = OpenOptions::new().append(true).create(true).open(file);
            let opened = opened.map_err(|e| {
                Error::io("cannot write the log", file, e).remedy("use a file that you can write")
            })?;
            Ok(Box::new(opened))
        };
        let sink = file.map(open).transpose()?.map(Mutex::new);
        Ok(Self { start: Instant::now(), sink })
    }

    /// Adds a line; its text is computed only if there is a log.
    pub(super) fn line(&self, topic: &str, text: impl FnOnce() -> String) {
        let Some(sink) = &self.sink else { return };
        let seconds = self.start.elapsed().as_secs_f64();
        let text = text().replace(char::is_control, " ");
        let line = format!("{seconds:10.3} s  {topic:<8} {text}\n");
        let mut sink = sink.lock().unwrap_or_else(PoisonError::into_inner);
        // In one write, so that the lines of two processes do not mix.
        let _ = sink.write_all(line.as_bytes()).and_then(|()| sink.flush());
    }
}
