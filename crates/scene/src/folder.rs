//! Restricts references between files: files beside the referring file or below it are read, others
//! only if the user allows it. A mesh or a scene from elsewhere must not be able to read any file
//! of this machine.

use std::path::{Component, Path, PathBuf};

/// The folder of a file, and the files that it may refer to.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    /// Whether files outside the folder are allowed.
    is_open: bool,
}

/// Why a reference fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Denied {
    /// There is no such file.
    Missing,
    /// It is neither beside the file nor below it.
    Outside,
}

impl Folder {
    /// The folder of `file`; other folders are allowed too if it is `open`.
    pub(crate) fn of(file: &Path, is_open: bool) -> Self {
        Self { path: file.parent().unwrap_or(Path::new("")).to_owned(), is_open }
    }

    /// The folder itself.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The file `name`, referred to by a file in the folder `from`, which is this folder or below
    /// it.
    pub(crate) fn find(&self, from: &Path, name: &str) -> Result<PathBuf, Denied> {
        let path = from.join(name);
        if self.is_open {
            return if path.is_file() { Ok(path) } else { Err(Denied::Missing) };
        }
        // By its name first: files outside are not even looked up.
        let depth = from.strip_prefix(&self.path).map_err(|_| Denied::Outside)?;
        if !stays_within(depth.components().chain(Path::new(name).components())) {
            return Err(Denied::Outside);
        }
        let Ok(file) = path.canonicalize() else { return Err(Denied::Missing) };
        match self.holds(&file) {
            false => Err(Denied::Outside),
            true if file.is_file() => Ok(path),
            true => Err(Denied::Missing),
        }
    }

    /// Whether `file` may be read: it is in the folder or below after following links, or all files
    /// are allowed.
    pub(crate) fn holds(&self, file: &Path) -> bool {
        let own = if self.path.as_os_str().is_empty() { Path::new(".") } else { &self.path };
        let real = (file.canonicalize(), own.canonicalize());
        self.is_open || matches!(real, (Ok(file), Ok(folder)) if file.starts_with(&folder))
    }
}

/// What a path that was written on another system or machine means here: its parts joined with `/`,
/// and if it is absolute on any system, its last part alone.
pub(crate) fn translated(path: &str) -> String {
    let slashed = path.replace('\\', "/");
    if is_absolute(&slashed) { last_part(&slashed).to_owned() } else { slashed }
}

/// The last part of a path with slashes.
pub(crate) fn last_part(slashed: &str) -> &str {
    slashed.rsplit('/').next().unwrap_or_default()
}

/// Whether a path with slashes begins at a root or at a drive.
fn is_absolute(slashed: &str) -> bool {
    let drive = slashed.split_once(':').map_or("", |(drive, _)| drive);
    slashed.starts_with('/') || drive.len() == 1 && drive.as_bytes()[0].is_ascii_alphabetic()
}

/// Whether a path stays below its start at every step.
fn stays_within<'a>(mut steps: impl Iterator<Item = Component<'a>>) -> bool {
    let end = steps.try_fold(0_usize, |depth, step| match step {
        Component::Normal(_) => Some(depth + 1),
        Component::CurDir => Some(depth),
        Component::ParentDir => depth.checked_sub(1),
        Component::RootDir | Component::Prefix(_) => None,
    });
    end.is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_beside_and_below_are_found_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["a", "a/b"] {
            std::fs::create_dir(at(name)).unwrap();
        }
        for name in ["out", "a/in", "a/b/below"] {
            std::fs::write(at(name), "").unwrap();
        }
        let own = Folder::of(&at("a/m.obj"), false);
        let find = |name: &str| own.find(&at("a"), name);
        assert_eq!(find("in"), Ok(at("a/in")));
        assert_eq!(find("./b/../b/below"), Ok(at("a/./b/../b/below")));
        assert_eq!(own.find(&at("a/b"), "../in"), Ok(at("a/b/../in")));
        assert_eq!(find("none"), Err(Denied::Missing));
        assert_eq!(find("b"), Err(Denied::Missing));
        let absolute = at("a/in").display().to_string();
        for name in ["../out", "b/../../out", "../none", &absolute] {
            assert_eq!(find(name), Err(Denied::Outside), "{name}");
        }
        let open = Folder::of(&at("a/m.obj"), true);
        for name in ["../out", &absolute] {
            assert!(open.find(&at("a"), name).is_ok(), "{name}");
        }
        assert_eq!(open.find(&at("a"), "../none"), Err(Denied::Missing));
    }

    #[test]
    fn paths_of_other_machines_are_translated() {
        for (path, here) in [
            ("C:/Users/me/out.jpg", "out.jpg"),
            ("c:\\Users\\me\\out.jpg", "out.jpg"),
            ("\\\\server\\share\\out.jpg", "out.jpg"),
            ("/home/me/out.jpg", "out.jpg"),
            ("images\\out.jpg", "images/out.jpg"),
            ("images/out.jpg", "images/out.jpg"),
            ("out:1.jpg", "out:1.jpg"),
            ("/", ""),
        ] {
            assert_eq!(translated(path), here, "{path}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_does_not_lead_out() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("a")).unwrap();
        std::fs::write(at("out"), "").unwrap();
        std::fs::write(at("a/in"), "").unwrap();
        std::os::unix::fs::symlink(at("out"), at("a/link")).unwrap();
        std::os::unix::fs::symlink(at("a/in"), at("a/near")).unwrap();
        let own = Folder::of(&at("a/m.obj"), false);
        assert_eq!(own.find(&at("a"), "link"), Err(Denied::Outside));
        assert_eq!(own.find(&at("a"), "near"), Ok(at("a/near")));
    }
}
