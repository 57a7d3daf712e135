//! Files written whole or not at all.

use super::error::{Error, Result};
use std::fs;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Prefix of a file that is being written; the process that writes it and a hash of its machine's name
/// follow.
const PREFIX: &str = ".partial-";

/// Temporary files whose writing process cannot be looked up (no /proc) are removed after this age.
const ABANDONED: Duration = Duration::from_hours(24);

/// Creates a directory and those above it.
///
/// # Errors
/// [`Error::System`] where the system refuses.
pub fn create_directory(path: &Path) -> Result<()> {
    fs::create_dir_all(path).map_err(Error::system("create the directory", path))
}

/// Reads a file of at most `largest` bytes. A longer file is refused unread, and so is a pipe or a device,
/// which may never end.
///
/// # Errors
/// [`Error::System`] where the system refuses, [`Error::Content`] for a file that is too long or not a
/// regular file.
pub fn read(path: &Path, largest: u64) -> Result<Vec<u8>> {
    // Looked at before it is opened: opening a pipe waits for a writer.
    let about = fs::metadata(path).map_err(Error::system("read", path))?;
    if !about.is_file() {
        return Err(Error::content(path, "not a regular file: its length is needed before it is read"));
    }
    if about.len() > largest {
        return Err(Error::content(path, format!("{} bytes: at most {largest} are read", about.len())));
    }
    let mut bytes = Vec::new();
    let mut file = fs::File::open(path).map_err(Error::system("read", path))?.take(largest);
    file.read_to_end(&mut bytes).map_err(Error::system("read", path))?;
    Ok(bytes)
}

/// Writes a file whole: under a temporary name in the same directory, which is then renamed. A failure leaves
/// no new file, and an old file unchanged.
///
/// A symbolic link stays a link: the file that it points to is written. A device or a pipe is written into
/// and not replaced.
///
/// # Errors
/// [`Error::System`] where the system refuses (permission, full disk).
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = match fs::metadata(path) {
        Ok(found) if !found.is_file() && !found.is_dir() => {
            fs::File::options().write(true).open(path).and_then(|mut sink| sink.write_all(bytes))
        }
        Ok(_) => fs::canonicalize(path).and_then(|path| replace(&path, bytes)),
        Err(_) => replace(path, bytes),
    };
    written.map_err(Error::system("write", path))
}

/// Writes files of these names and bytes into a directory, each as [`write_whole`] does, and returns their paths
/// in order. Those before one that is refused stay.
///
/// # Errors
/// [`Error::System`] where the system refuses.
pub fn write_all(
    directory: &Path,
    files: impl IntoIterator<Item = (String, Vec<u8>)>,
) -> Result<Vec<PathBuf>> {
    let write = |(name, bytes): (String, Vec<u8>)| {
        let path = directory.join(name);
        write_whole(&path, &bytes)?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (mut file, partial) = loop {
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        let partial = path.with_file_name(partial_name(std::process::id(), &machine(), number, &name));
        // A name that is taken, by a link to another place for instance, is not opened.
        match fs::File::options().write(true).create_new(true).open(&partial) {
            Err(taken) if taken.kind() == std::io::ErrorKind::AlreadyExists => {}
            opened => break (opened?, partial),
        }
    };
    // On the disk before it has its name: a machine that crashes leaves the old file or the new one.
    let written =
        file.write_all(bytes).and_then(|()| file.sync_data()).and_then(|()| fs::rename(&partial, path));
    if written.is_err() {
        // Nothing more can be done when this fails too; the next start cleans up.
        let _ = fs::remove_file(&partial);
    }
    written
}

/// Removes temporary files of interrupted runs from a directory; those of running processes stay.
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

fn partial_name(process: u32, machine: &str, number: u64, name: &str) -> String {
    format!("{PREFIX}{process}-{machine}-{number}-{name}")
}

/// Hash of the name of this machine, if the system knows one.
fn machine() -> String {
    let name = fs::read("/proc/sys/kernel/hostname").unwrap_or_default();
    // FNV-1a of 64 bits.
    let hash = name
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, &b| (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:016x}")
}

fn abandoned(rest: &str, entry: &fs::DirEntry) -> bool {
    let mut words = rest.split('-');
    let writer = words.next().unwrap_or_default();
    // The processes of another machine that shares the directory cannot be asked for.
    let here = words.next() == Some(&machine());
    if here && Path::new("/proc/self").exists() {
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
    fn several_files_are_written_in_their_order() {
        let dir = tempfile::tempdir().unwrap();
        let files = ["b.svg", "a.png"].map(|name| (name.to_owned(), name.as_bytes().to_vec()));
        let paths = write_all(dir.path(), files.clone()).unwrap();
        assert_eq!(paths, ["b.svg", "a.png"].map(|name| dir.path().join(name)));
        assert!(paths.iter().zip(&files).all(|(path, (_, bytes))| fs::read(path).unwrap() == *bytes));
        let error = write_all(&dir.path().join("missing"), files).unwrap_err().to_string();
        assert!(error.contains("cannot write") && error.contains("b.svg"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        use std::os::unix::fs::{FileTypeExt as _, symlink};
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        fs::write(at("target"), "old").unwrap();
        symlink(at("target"), at("link")).unwrap();
        write_whole(&at("link"), b"new").unwrap();
        assert!(at("link").is_symlink() && fs::read(at("target")).unwrap() == b"new");
        // A link that somebody planted under the temporary names is not followed.
        for number in 0..10_000 {
            symlink(at("target"), at(&partial_name(std::process::id(), &machine(), number, "a"))).unwrap();
        }
        write_whole(&at("a"), b"a").unwrap();
        assert_eq!(
            (fs::read(at("a")).unwrap(), fs::read(at("target")).unwrap()),
            (b"a".into(), b"new".into())
        );
        write_whole(Path::new("/dev/null"), b"x").unwrap();
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        if Path::new("/dev/full").exists() {
            let error = write_whole(Path::new("/dev/full"), b"x").unwrap_err();
            assert!(error.to_string().starts_with("cannot write /dev/full"), "{error}");
        }
    }

    #[test]
    fn left_overs_of_the_dead_are_cleaned() {
        let dir = tempfile::tempdir().unwrap();
        // No process has the number 0; our own is alive.
        let name = |process, machine: &str| dir.path().join(partial_name(process, machine, 1, "a.csv"));
        let dead = name(0, &machine());
        let alive = name(std::process::id(), &machine());
        let elsewhere = name(0, "another machine");
        for path in [&dead, &alive, &elsewhere] {
            fs::write(path, "half").unwrap();
        }
        clean(dir.path()).unwrap();
        if Path::new("/proc/self").exists() {
            assert!(!dead.exists());
        }
        assert!(alive.exists() && elsewhere.exists());
        assert!(clean(&dir.path().join("nowhere")).is_err());
    }
}
