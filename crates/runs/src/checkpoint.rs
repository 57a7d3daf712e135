//! Checkpoints: the data that an interrupted job needs, besides its partial results in the store, to continue
//! with identical bits.
//!
//! A checkpoint is one file of a job, beside the packs, and is always replaced as a whole. Its head names the
//! job, the build of the program and the kind of processor, and states how much was done and the digest of
//! the bytes that follow. Where any of these differs, the checkpoint is not used.

use crate::error::{Error, Result};
use crate::files;
use crate::store::fnv1a_128;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Ending of a checkpoint's name.
const ENDING: &str = "checkpoint";
/// First words of a checkpoint; the number of its format follows.
const CHECKPOINT: &str = "# fractal-contact checkpoint ";
/// Number of the format of checkpoints.
const FORMAT: u32 = 1;
/// Longest head, in bytes.
const LONGEST_HEAD: usize = 4096;
const DAMAGED: &str = "it is damaged or cut off";

/// The checkpoint of a job.
#[derive(Debug, Clone)]
pub struct Checkpoint {
    path: PathBuf,
    /// Line of the head that names the job.
    key: String,
}

/// Why a checkpoint is not used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unused {
    path: PathBuf,
    reason: String,
}

impl fmt::Display for Unused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.reason)
    }
}

impl Checkpoint {
    /// The checkpoint called `name` in the store of a directory, of the job of a key.
    pub fn new(out: &Path, name: &str, key: &str) -> Self {
        let path = crate::store::directory(out).join(format!("{name}.{ENDING}"));
        Self { path, key: format!("# key {:032x}", fnv1a_128(key.as_bytes())) }
    }

    /// The amount of finished work and the stored bytes; `None` where there is no checkpoint.
    ///
    /// # Errors
    /// The reason why it is not used.
    pub fn read(&self) -> Result<Option<(u64, Vec<u8>)>, Unused> {
        if std::fs::symlink_metadata(&self.path).is_err_and(|e| e.kind() == std::io::ErrorKind::NotFound) {
            return Ok(None);
        }
        let mut all = match files::read(&self.path, u64::MAX) {
            Ok(all) => all,
            Err(error) => return Err(self.unused(&error.to_string())),
        };
        let start = self.check(&all).map_err(|reason| self.unused(reason))?;
        let bytes = all.split_off(start);
        match bytes.split_first_chunk() {
            Some((done, bytes)) => Ok(Some((u64::from_le_bytes(*done), bytes.to_vec()))),
            None => Err(self.unused(DAMAGED)),
        }
    }

    /// Where the head ends.
    fn check(&self, all: &[u8]) -> Result<usize, &'static str> {
        let end = all.windows(2).take(LONGEST_HEAD).position(|pair| pair == b"\n\n").ok_or(DAMAGED)?;
        let head = std::str::from_utf8(&all[..end]).map_err(|_| DAMAGED)?;
        let lines: Vec<&str> = head.lines().collect();
        let [format, build, instructions, key, digest] = lines[..] else { return Err(DAMAGED) };
        if format != format!("{CHECKPOINT}{FORMAT}") || build != build_line() {
            return Err("it is of another build of the program");
        }
        if instructions != instructions_line() {
            return Err("it was made on a processor with other vector instructions");
        }
        if key != self.key {
            return Err("it is of another scene, or of other numerics");
        }
        let start = end + 2;
        if digest == digest_line(&all[start..]) { Ok(start) } else { Err(DAMAGED) }
    }

    /// The error that says why its content is not used.
    pub fn unused(&self, reason: &str) -> Unused {
        Unused { path: self.path.clone(), reason: reason.to_owned() }
    }

    /// Replaces the stored bytes.
    ///
    /// # Errors
    /// [`crate::Error::File`] where it cannot be written; the bytes stored before then remain.
    pub fn write(&self, done: u64, bytes: &[u8]) -> Result<()> {
        let (build, instructions, key) = (build_line(), instructions_line(), &self.key);
        let bytes = [&done.to_le_bytes(), bytes].concat();
        let digest = digest_line(&bytes);
        let head = format!("{CHECKPOINT}{FORMAT}\n{build}\n{instructions}\n{key}\n{digest}\n\n");
        if self.path.is_symlink() {
            // A new file, not what a link of this name leads to.
            std::fs::remove_file(&self.path).map_err(Error::file("remove", &self.path))?;
        }
        Ok(files::write_whole(&self.path, &[head.as_bytes(), &bytes].concat())?)
    }

    /// Removes it, where there is one.
    pub fn remove(&self) {
        // It is the program's own folder; what cannot be removed is not used by another job.
        let _ = std::fs::remove_file(&self.path);
    }

    /// Removes all checkpoints of a directory.
    pub fn remove_all(out: &Path) {
        let entries = std::fs::read_dir(crate::store::directory(out)).into_iter().flatten().flatten();
        let ours = |path: &PathBuf| path.extension().is_some_and(|ending| ending == ENDING);
        for path in entries.map(|entry| entry.path()).filter(ours) {
            let _ = std::fs::remove_file(path);
        }
    }
}

/// The line of a head that says of which build it is.
fn build_line() -> String {
    format!("# build {} {:032x}", env!("CARGO_PKG_VERSION"), digest_of_program())
}

/// The line that says on which kind of processor it was made.
fn instructions_line() -> String {
    format!("# instructions {}", crate::manifest::instructions().join(" "))
}

/// The last line of a head: the digest of what follows it.
fn digest_line(bytes: &[u8]) -> String {
    format!("# digest {:032x}", fnv1a_128(bytes))
}

/// Digest of the running program, which decides how numbers are rounded; 0 where the system does not show it.
fn digest_of_program() -> u128 {
    static DIGEST: OnceLock<u128> = OnceLock::new();
    *DIGEST.get_or_init(|| {
        let program = std::env::current_exe().ok().and_then(|path| files::read(&path, u64::MAX).ok());
        program.map_or(0, |bytes| fnv1a_128(&bytes))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_whole_and_of_its_job_or_says_why_not() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::create_dir(dir.path().join(".units")).unwrap();
        let of = |key: &str| Checkpoint::new(dir.path(), "bem3d-0", key);
        let (mine, other) = (of("mine"), of("other"));
        assert_eq!(mine.read(), Ok(None));
        let bytes: Vec<u8> = (0..200).collect();
        for done in [3, 4] {
            mine.write(done, &bytes).unwrap();
            assert_eq!(mine.read(), Ok(Some((done, bytes.clone()))));
        }
        assert!(
            other.read().unwrap_err().to_string().ends_with("it is of another scene, or of other numerics")
        );
        let file = dir.path().join(".units/bem3d-0.checkpoint");
        let whole = std::fs::read(&file).unwrap();
        for cut in 0..whole.len() {
            std::fs::write(&file, &whole[..cut]).unwrap();
            assert!(mine.read().is_err(), "{cut}");
        }
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 1;
            std::fs::write(&file, &damaged).unwrap();
            assert!(mine.read().is_err(), "{at}");
        }
        std::fs::write(&file, [&whole[..], b"x"].concat()).unwrap();
        assert!(mine.read().is_err());
        mine.remove();
        assert_eq!(mine.read(), Ok(None));
        mine.write(1, &[]).unwrap();
        assert_eq!(mine.read(), Ok(Some((1, Vec::new()))));
        Checkpoint::remove_all(dir.path());
        assert_eq!(mine.read(), Ok(None));
        // A directory in its place, and no directory for it.
        std::fs::create_dir(&file).unwrap();
        assert!(mine.read().is_err() && mine.write(1, &bytes).is_err());
        assert!(Checkpoint::new(&dir.path().join("nowhere"), "a", "b").write(1, &bytes).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn links_are_not_followed() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::create_dir(dir.path().join(".units")).unwrap();
        let target = dir.path().join("target");
        std::fs::write(&target, "somebody else's").unwrap();
        std::os::unix::fs::symlink(&target, dir.path().join(".units/a.checkpoint")).unwrap();
        Checkpoint::new(dir.path(), "a", "key").write(1, b"state").unwrap();
        assert_eq!(std::fs::read(&target).unwrap(), b"somebody else's");
    }
}
