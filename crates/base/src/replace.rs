//! Atomic replacement of files: an older file of the same name survives a failure.
//!
//! The bytes go to a temporary file in the same folder and are flushed to the disk; only then is
//! that file renamed over the target. A reader sees the old file or the new one, never a part.

use std::collections::BTreeSet;
use std::fs::{File, Metadata};
use std::io::{BufWriter, ErrorKind as IoKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use tempfile::NamedTempFile;

use crate::error::{Error, ErrorKind, Result};
use crate::lock;
use crate::memory::{Activity, Stage};

/// The writer for a file's content.
pub type Sink<'a> = BufWriter<&'a mut (dyn Write + Send)>;

/// The path that stands for standard output.
pub const STANDARD_OUTPUT: &str = "-";

/// Writes the file at `path` with the content from `fill`, or leaves an existing file unchanged.
/// [`STANDARD_OUTPUT`] gets it when it is complete.
///
/// A new file gets the usual permissions; one that replaces another keeps its permissions. If the
/// path is a symbolic link, its target is created or replaced and the link stays.
///
/// # Errors
/// If `fill` fails, the folder is missing or not writable, the disk is full, or the target is a
/// folder, a device or read-only. The error names the file.
pub fn replace_file(path: &Path, fill: impl FnOnce(&mut Sink<'_>) -> Result<()>) -> Result<()> {
    Stage::Write.begin();
    if path == Path::new(STANDARD_OUTPUT) {
        let mut bytes = Vec::new();
        // Dropped, the writer has written all to memory.
        fill(&mut BufWriter::new(&mut bytes))?;
        return print(&bytes);
    }
    let _writing = Activity::new(format!("writing {}", path.display()));
    let target = OutputFile::new(path)?;
    let mut temporary = target.temporary()?;
    let _listed = Listed::new(temporary.path());
    let mut sink: Sink<'_> = BufWriter::new(temporary.as_file_mut());
    fill(&mut sink).map_err(|error| error.in_file(path))?;
    sink.flush().map_err(|error| write_error(path, error))?;
    drop(sink);
    temporary.as_file().sync_all().map_err(|error| write_error(path, error))?;
    target.persist(temporary)
}

/// As [`replace_file`], with a text.
///
/// # Errors
/// As [`replace_file`].
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    replace_file(path, |sink| sink.write_all(text.as_bytes()).map_err(|e| write_error(path, e)))
}

/// Writes to standard output. A reader that closes it early, such as `head`, is not an error.
///
/// # Errors
/// If it cannot be written to.
pub fn print(bytes: &[u8]) -> Result<()> {
    let mut output = std::io::stdout().lock();
    match output.write_all(bytes).and_then(|()| output.flush()) {
        Err(error) if error.kind() != IoKind::BrokenPipe => {
            Err(Error::io("cannot write the result", "standard output", error))
        }
        _ => Ok(()),
    }
}

/// Checks whether [`replace_file`] could currently write at `path`; call it before long work.
///
/// # Errors
/// As [`replace_file`], except for a full disk; or if standard output is a terminal.
pub fn check_replaceable(path: &Path) -> Result<()> {
    if path == Path::new(STANDARD_OUTPUT) {
        let message = "a terminal cannot show the file";
        let error = Error::new(ErrorKind::Usage, message).in_file(path);
        let is_terminal = std::io::stdout().is_terminal();
        return if is_terminal { Err(error.remedy("name a file, or add a pipe")) } else { Ok(()) };
    }
    // Dropping the temporary file removes it.
    OutputFile::new(path)?.temporary().map(drop)
}

/// Makes a folder, if it is missing, in which files can be written.
///
/// # Errors
/// If it cannot be made, or they cannot be written.
pub fn make_folder(folder: &Path) -> Result<()> {
    let failed = |e| Error::io("cannot create the folder", folder, e).remedy("name another folder");
    std::fs::create_dir_all(folder).map_err(failed)?;
    check_replaceable(&folder.join("file"))
}

/// Refuses to write `file` over `other`; `what` describes the other file.
///
/// # Errors
/// If both are the same file.
pub fn check_differs(file: &Path, other: &Path, what: &str) -> Result<()> {
    if real(file) != real(other) {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Usage, format!("this file is also {what}"))
        .in_file(file)
        .remedy("write to another file"))
}

/// The path with all links followed; of a file that does not exist yet, those of its folder.
fn real(path: &Path) -> PathBuf {
    let path = followed(path).unwrap_or_else(|_| path.to_owned());
    let beside = || Some(folder_of(&path).canonicalize().ok()?.join(path.file_name()?));
    beside().unwrap_or_else(|| path.clone())
}

/// The folder that holds a path.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => PathBuf::from("."),
        Some(parent) => parent.to_path_buf(),
        None => path.to_path_buf(),
    }
}

/// The path with its symbolic links followed, the last of which may lead to a file that does not
/// exist yet.
fn followed(given: &Path) -> Result<PathBuf> {
    let mut path = given.to_path_buf();
    for _ in 0..=MOST_LINKS {
        if let Ok(real) = path.canonicalize() {
            return Ok(real);
        }
        let Ok(target) = path.read_link() else { return Ok(path) };
        path = folder_of(&path).join(target);
    }
    let why = "its symbolic links form a loop";
    Err(refused(given, why, "remove the link or name another file"))
}

/// Largest number of links in a row, as on Linux.
const MOST_LINKS: usize = 40;

/// An error of the operating system while writing `path`, with a remedy.
pub fn write_error(path: &Path, error: std::io::Error) -> Error {
    let remedy = match error.kind() {
        IoKind::StorageFull | IoKind::QuotaExceeded => "free some space or write to another disk",
        IoKind::PermissionDenied | IoKind::ReadOnlyFilesystem => "use a folder that you can write",
        IoKind::InvalidFilename => "use a shorter name",
        _ => "try another folder",
    };
    Error::io("cannot write the file", path, error).remedy(remedy)
}

/// The files that the process has written.
pub fn written() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    static WRITTEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    lock(&WRITTEN)
}

/// The existing temporary files.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes temporary files and folders, before the process ends.
pub fn remove_temporary_files() {
    // The caller may hold the lock.
    let Ok(paths) = TEMPORARY.try_lock() else { return };
    for path in &*paths {
        let _ = std::fs::remove_file(path).or_else(|_| std::fs::remove_dir_all(path));
    }
}

/// Keeps a temporary file or folder among those that [`remove_temporary_files`] removes, until it is dropped.
#[derive(Debug)]
pub struct Listed(PathBuf);

impl Listed {
    /// Adds this one.
    pub fn new(path: &Path) -> Self {
        lock(&TEMPORARY).push(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        lock(&TEMPORARY).retain(|path| *path != self.0);
    }
}

/// A file to create or replace; not a folder or device.
struct OutputFile<'a> {
    /// The path as given, for messages.
    given: &'a Path,
    /// The path with symbolic links followed.
    path: PathBuf,
    /// The folder that holds it.
    folder: PathBuf,
    /// The metadata of the existing file.
    existing: Option<Metadata>,
}

impl<'a> OutputFile<'a> {
    fn new(given: &'a Path) -> Result<Self> {
        let path = followed(given)?;
        let folder = folder_of(&path);
        let existing = match path.metadata() {
            Err(error) if error.kind() == IoKind::InvalidFilename => {
                return Err(write_error(given, error));
            }
            found => found.ok(),
        };
        check_kind(given, existing.as_ref())?;
        check_folder(given, &folder)?;
        Ok(Self { given, path, folder, existing })
    }

    /// An empty file beside the target, removed when dropped.
    fn temporary(&self) -> Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".wavecrest-").suffix(".part");
        // With the usual permissions, and errors without its name, which would confuse.
        let made = builder.make_in(&self.folder, |path| File::create_new(path));
        made.map_err(|error| write_error(self.given, error))
    }

    /// Renames the finished file over the target.
    fn persist(self, temporary: NamedTempFile) -> Result<()> {
        if let Some(existing) = &self.existing {
            // The file may belong to another user, so this may fail: the content matters more.
            let _ = temporary.as_file().set_permissions(existing.permissions());
        }
        temporary.persist(&self.path).map_err(|error| write_error(self.given, error.error))?;
        written().insert(self.given.to_owned());
        // Flushes the new name to the disk, on systems that can flush a folder.
        let _ = File::open(&self.folder).and_then(|folder| folder.sync_all());
        Ok(())
    }
}

/// The error that `given` cannot be written, with the cause and the remedy.
fn refused(given: &Path, why: &str, remedy: &str) -> Error {
    let message = format!("cannot write the file: {why}");
    Error::new(ErrorKind::Io, message).in_file(given).remedy(remedy)
}

fn check_kind(given: &Path, existing: Option<&Metadata>) -> Result<()> {
    let ends_as_a_folder =
        given.to_string_lossy().chars().next_back().is_some_and(std::path::is_separator);
    let (why, remedy) = match existing {
        Some(data) if data.is_dir() => ("this is a folder", "name a file inside it"),
        None if ends_as_a_folder => ("this is the name of a folder", "name a file inside it"),
        Some(data) if !data.is_file() => {
            ("this is neither a file nor a folder", "name a regular file")
        }
        Some(data) if data.permissions().readonly() => {
            ("the existing file is read-only", "make it writable or name another file")
        }
        _ => return Ok(()),
    };
    Err(refused(given, why, remedy))
}

fn check_folder(given: &Path, folder: &Path) -> Result<()> {
    let name = folder.display();
    let (why, remedy) = match folder.metadata() {
        Ok(data) if data.is_dir() => return Ok(()),
        Ok(_) => (format!("{name} is not a folder"), "name a folder that exists"),
        Err(error) if error.kind() == IoKind::NotFound => {
            (format!("there is no folder {name}"), "create it first or name one that exists")
        }
        Err(error) => return Err(write_error(given, error)),
    };
    Err(refused(given, &why, remedy))
}

#[cfg(test)]
mod tests;
