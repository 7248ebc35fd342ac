//! Files made, replaced and refused, and links followed.

use super::*;

fn put(path: &Path, text: &str) -> Result<()> {
    replace_file(path, |sink| {
        sink.write_all(text.as_bytes()).map_err(|error| write_error(path, error))
    })
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_file_is_made_and_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    put(&path, "first and longer").unwrap();
    put(&path, "second").unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
    assert_eq!(names(folder.path()), ["a.txt"]);
}

#[test]
fn a_failure_leaves_the_old_file_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    put(&path, "old").unwrap();
    let error = replace_file(&path, |sink| {
        sink.write_all(&[7; 100_000]).map_err(|error| write_error(&path, error))?;
        Err(Error::new(ErrorKind::Io, "the power went"))
    });
    let text = error.unwrap_err().to_string();
    assert_eq!(text, format!("{}: the power went", path.display()));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names(folder.path()), ["a.txt"]);
}

#[test]
fn a_check_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    check_replaceable(&path).unwrap();
    assert!(names(folder.path()).is_empty());
    put(&path, "old").unwrap();
    check_replaceable(&path).unwrap();
    assert_eq!(names(folder.path()), ["a.txt"]);
}

#[test]
fn a_read_only_file_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    put(&path, "old").unwrap();
    let mut permissions = path.metadata().unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    let text = format!(
        "{}: cannot write the file: the existing file is read-only; \
         make it writable or name another file",
        path.display()
    );
    assert_eq!(put(&path, "new").unwrap_err().to_string(), text);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
}

#[test]
fn the_system_s_causes_have_their_remedies() {
    let text = |kind: IoKind| write_error(Path::new("a"), kind.into()).to_string();
    assert!(text(IoKind::StorageFull).ends_with("; free some space or write to another disk"));
    assert!(text(IoKind::PermissionDenied).ends_with("; use a folder that you can write"));
    assert!(text(IoKind::Other).ends_with("; try another folder"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_takes_no_files_is_named_without_the_temporary_file() {
    // Not even the superuser can make a file there.
    let error = check_replaceable(Path::new("/proc/a.ppm")).unwrap_err().to_string();
    assert!(error.starts_with("/proc/a.ppm: cannot write the file: "), "{error}");
    assert!(!error.contains(".part"), "{error}");
}

#[test]
#[cfg(unix)]
fn permissions_are_those_of_any_new_file_or_of_the_file_replaced() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (path, plain) = (folder.path().join("a.txt"), folder.path().join("b.txt"));
    let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o777;
    std::fs::write(&plain, "").unwrap();
    put(&path, "").unwrap();
    assert_eq!(mode(&path), mode(&plain));
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).unwrap();
    put(&path, "new").unwrap();
    assert_eq!(mode(&path), 0o640);
}

#[test]
#[cfg(unix)]
fn a_symbolic_link_stays_a_link() {
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (folder.path().join("a.txt"), folder.path().join("link"));
    put(&path, "old").unwrap();
    std::os::unix::fs::symlink(&path, &link).unwrap();
    put(&link, "new").unwrap();
    assert!(link.symlink_metadata().unwrap().is_symlink());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
}

#[test]
#[cfg(unix)]
fn a_symbolic_link_to_nothing_creates_its_target() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("below")).unwrap();
    symlink("below/a.txt", at("near")).unwrap();
    symlink("near", at("far")).unwrap();
    check_replaceable(&at("far")).unwrap();
    assert!(check_differs(&at("far"), &at("below/a.txt"), "another output").is_err());
    put(&at("far"), "new").unwrap();
    assert_eq!(std::fs::read_to_string(at("below/a.txt")).unwrap(), "new");
    for link in ["near", "far"] {
        assert!(at(link).symlink_metadata().unwrap().is_symlink());
    }
    assert_eq!(names(&at("below")), ["a.txt"]);
    symlink("none/a.txt", at("lost")).unwrap();
    let text = put(&at("lost"), "x").unwrap_err().to_string();
    assert!(text.contains("there is no folder") && text.contains("none"), "{text}");
    symlink("two", at("one")).unwrap();
    symlink("one", at("two")).unwrap();
    let text = put(&at("one"), "x").unwrap_err().to_string();
    assert!(text.contains("one: cannot write the file: its symbolic links form a loop"), "{text}");
    assert!(at("one").symlink_metadata().unwrap().is_symlink());
}
