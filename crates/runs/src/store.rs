//! The result store: `DIR/.units/<hash>.csv`, one file per job, written whole and checked on reading.

use crate::error::{Error, Result};
use crate::files;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// First line of every stored result, of ensembles and of scenes alike; older results of ensembles have it and are still read.
const TITLE: &str = "# fractal-contact unit: one surface under all its loads";

/// Where the results of finished jobs are kept, each under a key that names everything that decides its numbers.
///
/// As long as it is open, no other process can open one in the same directory.
#[derive(Debug, Clone)]
pub struct Store {
    directory: PathBuf,
    fresh: bool,
    /// `None` where the file system has no locks.
    _lock: Option<Arc<Lock>>,
}

/// A locked file.
#[derive(Debug)]
struct Lock(File);

impl Drop for Lock {
    fn drop(&mut self) {
        // Closing is not enough while a child process is being started, which has a copy of the file for a moment.
        let _ = self.0.unlock();
    }
}

impl Store {
    /// Opens (and creates) `out/.units` and removes what interrupted runs left half-written. With `fresh` nothing stored is read.
    ///
    /// # Errors
    /// [`crate::Error::File`] when the directory cannot be made or read; [`crate::Error::Parameter`] when another process uses it.
    pub fn open(out: &Path, fresh: bool) -> Result<Self> {
        let directory = out.join(".units");
        files::create_directory(&directory)?;
        let lock = lock(&directory.join("lock"), out)?;
        files::clean(&directory)?;
        Ok(Self { directory, fresh, _lock: lock })
    }

    /// Number of results that the store of a directory holds; 0 where there is none.
    pub fn count(out: &Path) -> usize {
        let names =
            fs::read_dir(out.join(".units")).into_iter().flatten().flatten().map(|entry| entry.file_name());
        names.filter(|name| Path::new(name).extension().is_some_and(|end| end == "csv")).count()
    }

    fn path(&self, key: &str) -> PathBuf {
        self.directory.join(format!("{:032x}.csv", fnv1a_128(key.as_bytes())))
    }

    /// The text stored under this key, if the file is there, whole and of the same key: anything else is as good as absent.
    pub fn load(&self, key: &str) -> Option<String> {
        if self.fresh {
            return None;
        }
        let text = String::from_utf8(files::read(&self.path(key), u64::MAX).ok()?).ok()?;
        let (body, digest) = text.split_at(text.rfind("# whole ")?);
        let digest = u128::from_str_radix(digest.strip_prefix("# whole ")?.trim_end(), 16).ok()?;
        let whole = digest == fnv1a_128(body.as_bytes());
        body.strip_prefix(&head(key)).filter(|_| whole).map(str::to_owned)
    }

    /// Stores a text of whole lines.
    ///
    /// # Errors
    /// [`crate::Error::File`] when it cannot be written.
    pub fn save(&self, key: &str, text: &str) -> Result<()> {
        let body = head(key) + text;
        let digest = fnv1a_128(body.as_bytes());
        files::write_whole(&self.path(key), format!("{body}# whole {digest:032x}\n").as_bytes())
    }
}

/// The lock of a directory. The system lets go of it when the process ends, however it ends; within the process all stores of a
/// directory share it.
fn lock(path: &Path, out: &Path) -> Result<Option<Arc<Lock>>> {
    static HELD: Mutex<Vec<(PathBuf, Weak<Lock>)>> = Mutex::new(Vec::new());
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    // Opening a pipe would wait for its other end.
    if path.symlink_metadata().is_ok_and(|about| !about.is_file()) {
        return Err(Error::content(path, "not a regular file: remove it"));
    }
    let file = File::options().create(true).append(true).open(path).map_err(Error::file("write", path))?;
    let path = fs::canonicalize(path).map_err(Error::file("read", path))?;
    held.retain(|(_, lock)| lock.strong_count() > 0);
    if let Some(lock) = held.iter().find(|(of, _)| *of == path).and_then(|(_, lock)| lock.upgrade()) {
        return Ok(Some(lock));
    }
    match file.try_lock() {
        Ok(()) => {
            let lock = Arc::new(Lock(file));
            held.push((path, Arc::downgrade(&lock)));
            Ok(Some(lock))
        }
        Err(TryLockError::WouldBlock) => {
            let expected = "a directory that no other process is writing results into";
            Err(Error::parameter("out", out.display(), expected))
        }
        // Not every network file system has locks.
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

fn head(key: &str) -> String {
    let key: String = key.lines().flat_map(|line| ["# ", line, "\n"]).collect();
    format!("{TITLE}\n{key}")
}

/// FNV-1a of 128 bits (Fowler, Noll, Vo; offset basis and prime of draft-eastlake-fnv): the same for ever, unlike the hasher of
/// the standard library. It names files; on reading the whole key is compared.
///
/// ```
/// // The published test vector of the letter a.
/// assert_eq!(runs::fnv1a_128(b"a"), 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
/// ```
pub fn fnv1a_128(bytes: &[u8]) -> u128 {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    bytes.iter().fold(BASIS, |hash, &byte| (hash ^ u128::from(byte)).wrapping_mul(PRIME))
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "seed 1\nload 2\n";
    const TEXT: &str = "a,b\n1,0.25\n";

    #[test]
    fn results_come_back_byte_for_byte() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        assert_eq!(store.load(KEY), None);
        store.save(KEY, TEXT).unwrap();
        assert_eq!(store.load(KEY).as_deref(), Some(TEXT));
        assert_eq!((Store::count(dir.path()), Store::count(&dir.path().join("nowhere"))), (1, 0));
        assert_eq!(store.load("seed 2\nload 2\n"), None);
        assert_eq!(Store::open(dir.path(), true).unwrap().load(KEY), None);
    }

    #[test]
    fn one_process_at_a_time() {
        let dir = tempfile::tempdir().unwrap();
        // A lock of a file that was opened on its own, as by another process.
        fs::create_dir(dir.path().join(".units")).unwrap();
        let other = File::options().create(true).append(true).open(dir.path().join(".units/lock")).unwrap();
        other.lock().unwrap();
        let refused = Store::open(dir.path(), false).unwrap_err().to_string();
        assert!(refused.contains("no other process"), "{refused}");
        drop(other);
        let store = Store::open(dir.path(), false).unwrap();
        let again = Store::open(dir.path(), false).unwrap();
        drop((store, again));
        assert!(File::open(dir.path().join(".units/lock")).unwrap().try_lock().is_ok());
    }

    #[test]
    fn damaged_and_foreign_results_are_as_good_as_absent() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        let path = store.path(KEY);
        store.save(KEY, TEXT).unwrap();
        let whole = fs::read_to_string(&path).unwrap();
        for cut in 0..whole.len() - 1 {
            fs::write(&path, &whole[..cut]).unwrap();
            assert_eq!(store.load(KEY), None, "{cut} bytes");
        }
        fs::write(&path, whole.replace("0.25", "0.26")).unwrap();
        assert_eq!(store.load(KEY), None);
        fs::write(&path, [0xff, 0xfe]).unwrap();
        assert_eq!(store.load(KEY), None);
        // Whole, but of another key, under the name of this one.
        store.save("seed 2\n", TEXT).unwrap();
        fs::copy(store.path("seed 2\n"), &path).unwrap();
        assert_eq!(store.load(KEY), None);
        fs::write(&path, whole).unwrap();
        assert!(store.load(KEY).is_some());
    }
}
