//! Where the files of a run are: in a directory, or in memory where there is no file system.

use crate::scenes::read::Result;
use runs::fnv1a_128;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A file that belongs to a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredFile {
    /// Relative to the folder of the results.
    pub name: String,
    pub bytes: u64,
    /// [`fnv1a_128`] of its bytes.
    pub digest: u128,
}

impl StoredFile {
    /// The record of a file with these bytes.
    pub fn of(name: String, content: &[u8]) -> Self {
        Self { name, bytes: content.len() as u64, digest: fnv1a_128(content) }
    }
}

/// The files of a run by their names, which are relative to the folder.
#[derive(Debug, Clone)]
pub(crate) enum Folder {
    Directory(Arc<Path>),
    Memory(Arc<Mutex<BTreeMap<String, Arc<[u8]>>>>),
}

impl From<&Path> for Folder {
    fn from(directory: &Path) -> Self {
        Self::Directory(directory.into())
    }
}

impl Folder {
    /// An empty folder in memory.
    pub fn in_memory() -> Self {
        Self::Memory(Arc::default())
    }

    /// The directory; `None` in memory.
    pub fn directory(&self) -> Option<&Path> {
        match self {
            Self::Directory(directory) => Some(directory),
            Self::Memory(_) => None,
        }
    }

    /// The path of a file, for messages; in memory its name alone.
    pub fn path(&self, name: &str) -> PathBuf {
        self.directory().map_or_else(|| name.into(), |directory| directory.join(name))
    }

    /// Writes a file of the results, whole or not at all, in the place of one of the same name.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write(&self, name: String, bytes: &[u8]) -> Result<StoredFile> {
        match self {
            Self::Directory(directory) => runs::files::write_whole(&directory.join(&name), bytes)?,
            Self::Memory(files) => insert(files, &name, bytes),
        }
        Ok(StoredFile::of(name, bytes))
    }

    /// Writes a file for the program's own use. It is not synchronised with the disk: what a crash of the machine
    /// takes is solved again.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn keep(&self, name: String, bytes: &[u8]) -> Result<StoredFile> {
        match self {
            Self::Directory(directory) => {
                let path = directory.join(&name);
                // A new file, not what a link of this name leads to.
                let _ = std::fs::remove_file(&path);
                let file = std::fs::File::options().write(true).create_new(true).open(&path);
                let written = file.and_then(|mut file| file.write_all(bytes));
                written.map_err(runs::Error::file("write", &path))?;
            }
            Self::Memory(files) => insert(files, &name, bytes),
        }
        Ok(StoredFile::of(name, bytes))
    }

    /// The bytes of a file; `None` where it is not there or cannot be read.
    pub fn read(&self, name: &str) -> Option<Arc<[u8]>> {
        match self {
            Self::Directory(directory) => {
                runs::files::read(&directory.join(name), u64::MAX).ok().map(Into::into)
            }
            Self::Memory(files) => files.lock().unwrap_or_else(PoisonError::into_inner).get(name).cloned(),
        }
    }

    /// Whether a file is there and unchanged.
    pub fn holds(&self, file: &StoredFile) -> bool {
        self.read(&file.name).is_some_and(|bytes| StoredFile::of(file.name.clone(), &bytes) == *file)
    }

    /// The files of a folder in memory.
    pub fn into_files(self) -> BTreeMap<String, Arc<[u8]>> {
        match self {
            Self::Directory(_) => BTreeMap::new(),
            Self::Memory(files) => std::mem::take(&mut *files.lock().unwrap_or_else(PoisonError::into_inner)),
        }
    }

    /// Removes a file that is not needed any more. That it may be gone already, or stays, does no harm.
    pub fn remove(&self, name: &str) {
        match self {
            Self::Directory(directory) => drop(std::fs::remove_file(directory.join(name))),
            Self::Memory(files) => {
                files.lock().unwrap_or_else(PoisonError::into_inner).remove(name);
            }
        }
    }
}

fn insert(files: &Mutex<BTreeMap<String, Arc<[u8]>>>, name: &str, bytes: &[u8]) {
    files.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), bytes.into());
}
