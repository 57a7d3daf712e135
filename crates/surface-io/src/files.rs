//! Files written whole or not at all.

use crate::error::{Error, Result};
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Prefix of a file that is being written; the process that writes it follows.
const PREFIX: &str = ".partial-";

/// A left-over whose writer cannot be asked for (no /proc) is cleaned after this age.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// Creates a directory and those above it.
///
/// # Errors
/// [`Error::System`] where the system refuses.
pub fn create_directory(path: &Path) -> Result<()> {
    fs::create_dir_all(path).map_err(Error::system("create the directory", path))
}

/// Writes a file whole: into a temporary name beside it, then renamed over it. A failure leaves no file, and
/// an old one as it was.
///
/// # Errors
/// [`Error::System`] where the system refuses (permission, full disk).
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = COUNTER.fetch_add(1, Ordering::Relaxed);
    let partial = path.with_file_name(format!("{PREFIX}{}-{number}-{name}", std::process::id()));
    let written = fs::File::create(&partial)
        .and_then(|mut file| file.write_all(bytes))
        .and_then(|()| fs::rename(&partial, path));
    if written.is_err() {
        // Nothing more can be done when this fails too; the next start cleans up.
        let _ = fs::remove_file(&partial);
    }
    written.map_err(Error::system("write", path))
}

/// Removes what interrupted runs left half-written in a directory; files of a running process stay.
///
/// # Errors
/// [`Error::System`] when the directory cannot be read.
pub fn clean(directory: &Path) -> Result<()> {
    for entry in fs::read_dir(directory).map_err(Error::system("read the directory", directory))? {
        let entry = entry.map_err(Error::system("read the directory", directory))?;
        let name = entry.file_name();
        let Some(rest) = name.to_str().and_then(|n| n.strip_prefix(PREFIX)) else { continue };
        if abandoned(rest, &entry) {
            // Somebody else may have cleaned it a moment ago.
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(())
}

fn abandoned(rest: &str, entry: &fs::DirEntry) -> bool {
    let writer = rest.split('-').next().unwrap_or_default();
    if Path::new("/proc/self").exists() {
        return !Path::new("/proc").join(writer).exists();
    }
    let age = entry.metadata().and_then(|m| m.modified()).ok().and_then(|t| t.elapsed().ok());
    age.is_some_and(|age| age > ABANDONED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_nothing() {
        let dir = tempfile::tempdir().unwrap();
        create_directory(&dir.path().join("a/b")).unwrap();
        // A directory of that name: the rename is refused.
        let error = write_whole(&dir.path().join("a"), b"x").unwrap_err();
        assert!(error.to_string().starts_with("cannot write "), "{error}");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
        assert!(write_whole(&dir.path().join("missing/a.csv"), b"x").is_err());
        write_whole(&dir.path().join("a/c.txt"), b"x").unwrap();
        write_whole(&dir.path().join("a/c.txt"), b"y").unwrap();
        assert_eq!(fs::read(dir.path().join("a/c.txt")).unwrap(), b"y");
        assert_eq!(fs::read_dir(dir.path().join("a")).unwrap().count(), 2);
    }

    #[test]
    fn left_overs_of_the_dead_are_cleaned() {
        let dir = tempfile::tempdir().unwrap();
        // No process has the number 0; our own is alive.
        let dead = dir.path().join(format!("{PREFIX}0-1-a.csv"));
        let alive = dir.path().join(format!("{PREFIX}{}-1-a.csv", std::process::id()));
        fs::write(&dead, "half").unwrap();
        fs::write(&alive, "half").unwrap();
        clean(dir.path()).unwrap();
        if Path::new("/proc/self").exists() {
            assert!(!dead.exists());
        }
        assert!(alive.exists());
        assert!(clean(&dir.path().join("nowhere")).is_err());
    }
}
