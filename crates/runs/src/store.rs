//! The result store: packs of results in `DIR/.units`, each written by one process and read by all.
//!
//! A pack is a text file. Its head names the process and the plan that wrote it. Then follow the results,
//! each with the hash of its key, its length and a digest. Results are appended whole and never changed. A
//! result that was cut off or damaged fails its digest and counts as absent, and the results after it are
//! still read. No two processes write to one pack, so that no lock is needed, and there are only as many
//! files as there were processes.

use crate::error::{Error, Result};
use crate::files;
use crate::progress::Progress;
use contact_model::Stop;
use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

/// First words of a pack; the number of its format follows.
const PACK: &str = "# fractal-contact results ";
/// Number of the format of packs. Raise it when results of all kinds are written in another way: packs of
/// another format are not read, and a run reports them.
const FORMAT: u32 = 2;
/// First words of each result in it; the hash of its key and the bytes after this line follow.
const RESULT: &str = "# fractal-contact result ";
/// Before the digest of a result, its last line.
const DIGEST: &str = "# whole ";
/// Packs that a note names before "and N more".
const LISTED: usize = 5;
/// Ending of a pack's name.
const ENDING: &str = "pack";
/// Shortest time between two flushes to the disk: a crash of the machine, not of the process, loses later
/// results.
const SYNC_EVERY: Duration = Duration::from_secs(1);
/// Time between two attempts to lock a store that another process holds.
const WAIT: Duration = Duration::from_millis(50);
/// A pack is rewritten when more than this number of bytes, and more than half of it, belong to results that
/// were replaced.
const LEAST_WASTE: u64 = 1 << 20;

/// The writer of a pack.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PackHead {
    /// Digest of the plan whose shard it was; `None` for a run that was not sharded.
    pub plan: Option<String>,
    /// The shard, as `index/count`.
    pub shard: Option<String>,
    /// Vector instructions of the processor: results are the same bytes where they are the same.
    pub instructions: String,
}

impl PackHead {
    fn text(&self) -> String {
        let Self { plan, shard, instructions } = self;
        let or = |word: &Option<String>| word.clone().unwrap_or_else(|| "-".to_owned());
        let (plan, shard) = (or(plan), or(shard));
        format!("{PACK}{FORMAT}\n# plan {plan}\n# shard {shard}\n# instructions {instructions}\n")
    }

    fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        format_of(lines.next()?).filter(|format| *format == FORMAT)?;
        let mut next =
            |word: &str| Some(lines.next()?.strip_prefix("# ")?.strip_prefix(word)?.trim().to_owned());
        let given = |word: String| (word != "-").then_some(word);
        Some(Self {
            plan: given(next("plan")?),
            shard: given(next("shard")?),
            instructions: next("instructions")?,
        })
    }
}

/// The format of a pack, from its first line.
fn format_of(line: &str) -> Option<u32> {
    line.strip_prefix(PACK)?.parse().ok()
}

/// Whether a file is a pack of another format.
fn is_of_another_format(path: &Path) -> bool {
    // A pipe would wait for its other end.
    if !path.metadata().is_ok_and(|about| about.is_file()) {
        return false;
    }
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEADER).read_to_end(&mut start));
    let text = String::from_utf8_lossy(&start);
    read.is_ok() && text.lines().next().and_then(format_of).is_some_and(|format| format != FORMAT)
}

/// Where a result lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ResultPlace {
    /// Number of its pack.
    pack: usize,
    offset: u64,
    bytes: u64,
}

/// A pack that was found.
#[derive(Debug, Clone)]
pub struct Pack {
    /// Its path.
    pub path: PathBuf,
    /// Its writer.
    pub head: PackHead,
    /// Hashes of the keys of its results, in their order.
    pub results: Vec<u128>,
    /// Bytes that belong to no result, after a kill, a full disk or damage.
    pub damaged_bytes: u64,
}

/// The store of results of finished jobs, each under a key that names everything that decides its numbers.
#[derive(Debug, Clone)]
pub struct Store(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    directory: PathBuf,
    head: PackHead,
    /// What is stored, and what is written now.
    packs: Mutex<Packs>,
    /// `None` for a shard, which shares the directory with others, and where the file system has no locks.
    _lock: Option<Arc<Lock>>,
}

#[derive(Debug, Default)]
struct Packs {
    /// The pack of each number.
    paths: Vec<PathBuf>,
    /// Places of each key, the newest last.
    places: HashMap<u128, Vec<ResultPlace>>,
    own: Option<Own>,
    /// Packs of another format, which are not read.
    unused: Vec<PathBuf>,
}

/// The pack that this process writes.
#[derive(Debug)]
struct Own {
    file: File,
    number: usize,
    bytes: u64,
    /// Bytes of results that were replaced.
    waste: u64,
    synced: Instant,
}

/// A locked file.
#[derive(Debug)]
struct Lock(File);

impl Drop for Lock {
    fn drop(&mut self) {
        // Closing is not enough while a child process is being started, which has a copy of the file for a
        // moment.
        let _ = self.0.unlock();
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        let packs = self.packs.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(own) = &packs.own {
            // Each result was written; what cannot be synced now is for the system to bring to the disk.
            let _ = own.file.sync_data();
        }
    }
}

impl Store {
    /// Opens (and creates) `out/.units` for a run that has the directory for itself: as long as it is open,
    /// no other such run can open it. Removes incomplete files of interrupted runs. With `fresh` no stored
    /// result is read.
    ///
    /// # Errors
    /// [`crate::Error::File`] when the directory cannot be made or read; [`crate::Error::Parameter`] when
    /// another process uses it.
    pub fn open(out: &Path, fresh: bool) -> Result<Self> {
        let directory = directory(out);
        files::create_directory(&directory)?;
        let lock = lock(&directory.join("lock"), out)?;
        files::clean(&directory)?;
        let head =
            PackHead { instructions: crate::manifest::instructions().join(" "), ..PackHead::default() };
        let packs = if fresh { Packs::default() } else { Packs::read(&directory, &|_| true)? };
        Ok(Self(Arc::new(Shared { directory, head, packs: Mutex::new(packs), _lock: lock })))
    }

    /// Opens a store that other shards use at the same time, for a shard of a plan. Packs of other shards of
    /// the same division have none of its jobs and are not read.
    ///
    /// # Errors
    /// [`crate::Error::File`] when the directory cannot be made or read.
    pub fn open_shared(out: &Path, plan: &str, shard: crate::Shard) -> Result<Self> {
        let directory = directory(out);
        files::create_directory(&directory)?;
        let instructions = crate::manifest::instructions().join(" ");
        let head = PackHead { plan: Some(plan.to_owned()), shard: Some(shard.to_string()), instructions };
        let of_others = |found: &PackHead| {
            let theirs = found.shard.as_deref().and_then(|s| s.parse::<crate::Shard>().ok());
            found.plan == head.plan
                && theirs.is_some_and(|theirs| theirs.count == shard.count && theirs != shard)
        };
        let packs = Packs::read(&directory, &|found| !of_others(found))?;
        Ok(Self(Arc::new(Shared { directory, head, packs: Mutex::new(packs), _lock: None })))
    }

    /// Opens a store for results that all shards need before their jobs are known. Others may use the directory
    /// at the same time, but one process at a time holds such a store: the next one waits for it, and finds
    /// its results. With `fresh` no stored result is read.
    ///
    /// # Errors
    /// [`crate::Error::File`] when the directory cannot be made or read; [`crate::Error::Model`] with
    /// [`contact_model::Error::Stopped`] when `stop` said so while it waited.
    pub fn open_for_all(out: &Path, fresh: bool, stop: Stop<'_>) -> Result<Self> {
        let directory = directory(out);
        files::create_directory(&directory)?;
        let path = directory.join("lock-for-all");
        let lock = loop {
            match lock(&path, out) {
                Err(Error::Parameter { .. }) if stop.stops() => {
                    let waited = Error::model("waiting for another process that solves the same states");
                    return Err(waited(contact_model::Error::Stopped { best: None }));
                }
                Err(Error::Parameter { .. }) => std::thread::sleep(WAIT),
                other => break other?,
            }
        };
        let head =
            PackHead { instructions: crate::manifest::instructions().join(" "), ..PackHead::default() };
        let packs = if fresh { Packs::default() } else { Packs::read(&directory, &|_| true)? };
        Ok(Self(Arc::new(Shared { directory, head, packs: Mutex::new(packs), _lock: lock })))
    }

    /// Reports packs that are not used because they are of another format, once in a process, which may open
    /// a directory for each of its tables.
    pub(crate) fn tell_unused(&self, progress: &dyn Progress) {
        static TOLD: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
        let unused = std::mem::take(&mut self.held().unused);
        let names: Vec<_> = unused.iter().filter_map(|path| path.file_name()?.to_str()).collect();
        let directory = &self.0.directory;
        let is_told = || {
            let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
            told.contains(directory) || {
                told.push(directory.clone());
                false
            }
        };
        if names.is_empty() || is_told() {
            return;
        }
        let mut list = names[..names.len().min(LISTED)].join(", ");
        if names.len() > LISTED {
            list += &format!(" and {} more", names.len() - LISTED);
        }
        progress.note(&format!(
            "{} holds results in the format of another version of the program. They are not used, and solved again \
             where they are needed; the files can be removed: {list}",
            directory.display()
        ));
    }

    /// Opens the store of a directory for reading only; nothing is created or removed.
    ///
    /// # Errors
    /// [`crate::Error::File`] when it cannot be read.
    pub fn view(out: &Path) -> Result<Self> {
        let directory = directory(out);
        let packs = Mutex::new(Packs::read(&directory, &|_| true)?);
        Ok(Self(Arc::new(Shared { directory, head: PackHead::default(), packs, _lock: None })))
    }

    /// The packs of a directory; none where it has no store.
    ///
    /// # Errors
    /// [`crate::Error::File`] where one cannot be read.
    pub fn packs(out: &Path) -> Result<Vec<Pack>> {
        names(&directory(out))?
            .iter()
            .filter_map(|path| Pack::read(path, &|_| true).transpose())
            .map(|pack| Ok(pack?.0))
            .collect()
    }

    /// Number of results that the store of a directory holds; 0 where there is none.
    pub fn count(out: &Path) -> usize {
        let mut all: Vec<u128> =
            Self::packs(out).unwrap_or_default().into_iter().flat_map(|pack| pack.results).collect();
        all.sort_unstable();
        all.dedup();
        all.len()
    }

    /// The texts stored under this key that are whole and of the same key, the newest first. A job that two
    /// processes did by mistake has two.
    pub fn texts(&self, key: &str) -> impl Iterator<Item = String> + '_ {
        let body = head(key);
        let found: Vec<(PathBuf, ResultPlace)> = {
            let packs = self.held();
            let places = packs.places.get(&fnv1a_128(key.as_bytes()));
            places
                .into_iter()
                .flatten()
                .rev()
                .map(|place| (packs.paths[place.pack].clone(), *place))
                .collect()
        };
        found.into_iter().filter_map(move |(path, place)| whole(&read_at(&path, place).ok()?, &body))
    }

    /// The newest whole text stored under this key; anything else counts as absent.
    pub fn load(&self, key: &str) -> Option<String> {
        self.texts(key).next()
    }

    /// Whether anything is stored under this key, whole or not.
    pub fn has(&self, key: &str) -> bool {
        self.held().places.contains_key(&fnv1a_128(key.as_bytes()))
    }

    /// Stores a text of whole lines; one that this process stored under the same key before is replaced.
    ///
    /// # Errors
    /// [`crate::Error::File`] when it cannot be written: then the pack is as it was.
    pub fn save(&self, key: &str, text: &str) -> Result<()> {
        let hash = fnv1a_128(key.as_bytes());
        let result = result(hash, key, text);
        let mut packs = self.held();
        let packs = &mut *packs;
        let number = match &packs.own {
            Some(own) => own.number,
            None => self.create(packs)?,
        };
        let Some(own) = &mut packs.own else { return Ok(()) };
        let path = &packs.paths[number];
        let offset = own.bytes;
        let written = own.file.write_all(result.as_bytes()).and_then(|()| {
            if own.synced.elapsed() < SYNC_EVERY {
                return Ok(());
            }
            own.synced = Instant::now();
            own.file.sync_data()
        });
        if let Err(error) = written {
            // The next result goes into a pack of its own if the half of this one stays.
            if own.file.set_len(offset).and_then(|()| own.file.seek(SeekFrom::End(0))).is_err() {
                packs.own = None;
            }
            return Err(Error::file("write", path)(error));
        }
        own.bytes += result.len() as u64;
        let places = packs.places.entry(hash).or_default();
        if let Some(old) = places.pop_if(|place| place.pack == number) {
            own.waste += old.bytes;
        }
        places.push(ResultPlace { pack: number, offset, bytes: result.len() as u64 });
        if own.waste > LEAST_WASTE && 2 * own.waste > own.bytes {
            self.compact(packs)?;
        }
        Ok(())
    }

    fn held(&self) -> MutexGuard<'_, Packs> {
        // A poisoned lock means that another thread panicked while it wrote; what it left fails its digest.
        self.0.packs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A new pack of this process: its number.
    fn create(&self, packs: &mut Packs) -> Result<usize> {
        let directory = &self.0.directory;
        // Newer packs have higher numbers, so that their results are found first.
        let mut serial =
            names(directory)?.iter().filter_map(|path| serial(path)).max().map_or(0, |last| last + 1);
        let head = self.0.head.text();
        loop {
            let path = directory.join(format!("{serial:08}.{ENDING}"));
            match File::options().read(true).append(true).create_new(true).open(&path) {
                // Another process was faster.
                Err(taken) if taken.kind() == std::io::ErrorKind::AlreadyExists => serial += 1,
                opened => {
                    let mut file = opened.map_err(Error::file("write", &path))?;
                    if let Err(error) = file.write_all(head.as_bytes()) {
                        let _ = fs::remove_file(&path);
                        return Err(Error::file("write", &path)(error));
                    }
                    // The name, too, is to survive a crash, where the system can be asked for that.
                    let _ = File::open(directory).and_then(|d| d.sync_all());
                    let number = packs.paths.len();
                    packs.paths.push(path);
                    let bytes = head.len() as u64;
                    packs.own = Some(Own { file, number, bytes, waste: 0, synced: Instant::now() });
                    return Ok(number);
                }
            }
        }
    }

    /// Writes the results of the own pack that were not replaced into a new one, and removes the old one.
    fn compact(&self, packs: &mut Packs) -> Result<()> {
        let Some(old) = packs.own.take() else { return Ok(()) };
        let path = packs.paths[old.number].clone();
        let number = self.create(packs)?;
        let Some(own) = &mut packs.own else { return Ok(()) };
        for places in packs.places.values_mut() {
            for place in places.iter_mut().filter(|place| place.pack == old.number) {
                let text = read_at(&path, *place)?;
                own.file.write_all(text.as_bytes()).map_err(Error::file("write", &path))?;
                *place = ResultPlace { pack: number, offset: own.bytes, ..*place };
                own.bytes += place.bytes;
            }
        }
        own.file.sync_data().map_err(Error::file("write", &path))?;
        fs::remove_file(&path).map_err(Error::file("remove", &path))
    }
}

impl Packs {
    /// All packs whose head is wanted.
    fn read(directory: &Path, wanted: &dyn Fn(&PackHead) -> bool) -> Result<Self> {
        let mut packs = Self::default();
        for path in names(directory)? {
            let Some((pack, places)) = Pack::read(&path, wanted)? else {
                if is_of_another_format(&path) {
                    packs.unused.push(path);
                }
                continue;
            };
            let number = packs.paths.len();
            packs.paths.push(path);
            for (hash, (offset, bytes)) in pack.results.into_iter().zip(places) {
                packs.places.entry(hash).or_default().push(ResultPlace { pack: number, offset, bytes });
            }
        }
        Ok(packs)
    }
}

impl Pack {
    /// Reads where the results of a pack lie, not the results; `None` for a file that is none, and one that
    /// is not wanted.
    #[allow(clippy::type_complexity)] // Offset and length of each result.
    fn read(path: &Path, wanted: &dyn Fn(&PackHead) -> bool) -> Result<Option<(Self, Vec<(u64, u64)>)>> {
        // A pipe would wait for its other end.
        if !path.metadata().is_ok_and(|about| about.is_file()) {
            return Ok(None);
        }
        let file = PackFile::open(path)?;
        let first = file.bytes(0, 1024)?;
        let text = String::from_utf8_lossy(&first);
        let Some(head) = PackHead::parse(&text).filter(wanted) else { return Ok(None) };
        let pack = Self { path: path.to_owned(), head, results: Vec::new(), damaged_bytes: 0 };
        let at = pack.head.text().len() as u64;
        let mut scan = PackScan { file, pack, places: Vec::new(), at, searched: 0 };
        while scan.at < scan.file.length {
            if !scan.take_result()? && !scan.skip_damage()? {
                break;
            }
        }
        Ok(Some((scan.pack, scan.places)))
    }
}

/// An open pack.
struct PackFile<'a> {
    path: &'a Path,
    file: File,
    /// Bytes in it when it was opened.
    length: u64,
    /// All of them: a damaged pack is read whole, once.
    all: Option<Vec<u8>>,
}

impl<'a> PackFile<'a> {
    fn open(path: &'a Path) -> Result<Self> {
        let file = File::open(path).map_err(Error::file("read", path))?;
        let length = file.metadata().map_err(Error::file("read", path))?.len();
        Ok(Self { path, file, length, all: None })
    }

    /// Bytes from a place on, at most as many as `most`.
    fn bytes(&self, at: u64, most: u64) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        (&self.file).seek(SeekFrom::Start(at)).map_err(Error::file("read", self.path))?;
        (&self.file).take(most).read_to_end(&mut bytes).map_err(Error::file("read", self.path))?;
        Ok(bytes)
    }

    /// The bytes in which the first line of a result would be.
    fn header(&self, at: u64) -> Result<Vec<u8>> {
        match &self.all {
            Some(all) => Ok(all[at as usize..].iter().copied().take(HEADER as usize).collect()),
            None => self.bytes(at, HEADER),
        }
    }

    /// Where the next line after `from` begins that says that it begins a result, or the end; `None` where the
    /// pack became shorter while it was read, and has no more.
    fn next_result(&mut self, from: u64) -> Result<Option<u64>> {
        let all = match self.all.take() {
            Some(all) => all,
            None => self.bytes(0, self.length)?,
        };
        let all = self.all.insert(all);
        let mark = format!("\n{RESULT}");
        let rest = all.get(from as usize + 1..).unwrap_or_default();
        let found = rest.windows(mark.len()).position(|window| window == mark.as_bytes());
        let next = found.map_or(self.length, |position| from + position as u64 + 2);
        Ok((all.len() as u64 == self.length).then_some(next))
    }
}

/// A pack whose results are looked for, one after the other.
struct PackScan<'a> {
    file: PackFile<'a>,
    pack: Pack,
    /// Offset and length of each result.
    places: Vec<(u64, u64)>,
    /// Where the next result should begin.
    at: u64,
    /// Results whose inside was searched for another one's beginning.
    searched: usize,
}

impl PackScan<'_> {
    /// Takes the result that begins here; `false` where none does that ends within the pack.
    fn take_result(&mut self) -> Result<bool> {
        let Some((hash, line, body)) = parse_header(&self.file.header(self.at)?) else { return Ok(false) };
        let left = self.file.length - self.at;
        let Some(bytes) = line.checked_add(body).filter(|bytes| *bytes <= left) else { return Ok(false) };
        self.pack.results.push(hash);
        self.places.push((self.at, bytes));
        self.at += bytes;
        Ok(true)
    }

    /// Goes on at the next line that begins a result. It may lie inside the last result if that was cut off or
    /// damaged, which then is none. `false` where the pack has no more.
    fn skip_damage(&mut self) -> Result<bool> {
        let last = self.places.last().map_or(self.at, |&(offset, _)| offset);
        let is_searched = self.searched == self.places.len();
        self.searched = self.places.len();
        let Some(next) = self.file.next_result(if is_searched { self.at } else { last })? else {
            return Ok(false);
        };
        if next < self.at {
            self.pack.results.pop();
            self.places.pop();
            self.searched = self.places.len();
            self.pack.damaged_bytes += next - last;
        } else {
            self.pack.damaged_bytes += next - self.at;
        }
        self.at = next;
        Ok(true)
    }
}

/// Bytes that hold the first line of a result.
const HEADER: u64 = 96;

/// Hash, bytes of the line, bytes after it.
fn parse_header(bytes: &[u8]) -> Option<(u128, u64, u64)> {
    let end = bytes.iter().position(|&b| b == b'\n')?;
    let words = std::str::from_utf8(&bytes[..end]).ok()?.strip_prefix(RESULT)?;
    let (hash, length) = words.split_once(' ')?;
    Some((u128::from_str_radix(hash, 16).ok()?, end as u64 + 1, length.parse().ok()?))
}

/// A result as it is stored.
fn result(hash: u128, key: &str, text: &str) -> String {
    let body = head(key) + text;
    let body = format!("{body}{DIGEST}{:032x}\n", fnv1a_128(body.as_bytes()));
    format!("{RESULT}{hash:032x} {}\n{body}", body.len())
}

/// The text of a stored result, if it is whole and begins with these lines.
fn whole(stored: &str, head: &str) -> Option<String> {
    let (_, stored) = stored.split_once('\n')?;
    let (body, digest) = stored.split_at(stored.rfind(DIGEST)?);
    let digest = u128::from_str_radix(digest.strip_prefix(DIGEST)?.trim_end(), 16).ok()?;
    let whole = digest == fnv1a_128(body.as_bytes());
    body.strip_prefix(head).filter(|_| whole).map(str::to_owned)
}

fn read_at(path: &Path, place: ResultPlace) -> Result<String> {
    let mut bytes = vec![0; place.bytes as usize];
    let read = File::open(path).and_then(|mut file| {
        file.seek(SeekFrom::Start(place.offset))?;
        file.read_exact(&mut bytes)
    });
    read.map_err(Error::file("read", path))?;
    String::from_utf8(bytes).map_err(|_| Error::content(path, "not text"))
}

/// Where the store of a directory is.
pub(crate) fn directory(out: &Path) -> PathBuf {
    out.join(".units")
}

/// The packs of a store, the oldest first.
fn names(directory: &Path) -> Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(directory) {
        Err(none) if none.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(Error::file("read the directory", directory))?,
    };
    let mut names: Vec<PathBuf> =
        entries.flatten().map(|entry| entry.path()).filter(|path| serial(path).is_some()).collect();
    names.sort();
    Ok(names)
}

fn serial(path: &Path) -> Option<u64> {
    path.extension().filter(|end| *end == ENDING)?;
    path.file_stem()?.to_str()?.parse().ok()
}

/// The lock of a directory. The system lets go of it when the process ends, however it ends; within the
/// process all stores of a directory share it.
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
    key.lines().flat_map(|line| ["# ", line, "\n"]).collect()
}

/// FNV-1a of 128 bits (Fowler, Noll, Vo; offset basis and prime of draft-eastlake-fnv): the same for ever,
/// unlike the hasher of the standard library. It names results; on reading the whole key is compared.
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
    use crate::Shard;

    const KEY: &str = "seed 1\nload 2\n";
    const TEXT: &str = "a,b\n1,0.25\n";

    /// The pack that a store wrote.
    fn pack_of(dir: &Path) -> PathBuf {
        names(&directory(dir)).unwrap().pop().unwrap()
    }

    #[test]
    fn results_come_back_byte_for_byte() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        assert_eq!(store.load(KEY), None);
        store.save(KEY, TEXT).unwrap();
        assert_eq!(store.load(KEY).as_deref(), Some(TEXT));
        assert_eq!((Store::count(dir.path()), Store::count(&dir.path().join("nowhere"))), (1, 0));
        assert_eq!(store.load("seed 2\nload 2\n"), None);
        drop(store);
        assert_eq!(Store::open(dir.path(), false).unwrap().load(KEY).as_deref(), Some(TEXT));
        // Solved again, the newer result counts, also after a run that read the older one.
        let again = Store::open(dir.path(), true).unwrap();
        assert_eq!(again.load(KEY), None);
        again.save(KEY, "b\n").unwrap();
        drop(again);
        let store = Store::open(dir.path(), false).unwrap();
        assert_eq!(store.texts(KEY).collect::<Vec<_>>(), ["b\n", TEXT]);
        assert_eq!(Store::count(dir.path()), 1);
    }

    #[test]
    fn one_run_at_a_time_but_for_shards() {
        let dir = tempfile::tempdir().unwrap();
        // A lock of a file that was opened on its own, as by another process.
        fs::create_dir(dir.path().join(".units")).unwrap();
        let other = File::options().create(true).append(true).open(dir.path().join(".units/lock")).unwrap();
        other.lock().unwrap();
        let refused = Store::open(dir.path(), false).unwrap_err().to_string();
        assert!(refused.contains("no other process"), "{refused}");
        let shard = Shard { index: 0, count: 2 };
        Store::open_shared(dir.path(), "p", shard).unwrap().save(KEY, TEXT).unwrap();
        drop(other);
        let store = Store::open(dir.path(), false).unwrap();
        let again = Store::open(dir.path(), false).unwrap();
        assert_eq!(again.load(KEY).as_deref(), Some(TEXT));
        drop((store, again));
        assert!(File::open(dir.path().join(".units/lock")).unwrap().try_lock().is_ok());
    }

    /// What one process solves for all, the next one finds; a shard may be at work beside them.
    #[test]
    fn a_store_for_all_is_waited_for() {
        let dir = tempfile::tempdir().unwrap();
        let never = || false;
        Store::open_for_all(dir.path(), false, &never).unwrap().save(KEY, TEXT).unwrap();
        let path = dir.path().join(".units/lock-for-all");
        let other = File::options().append(true).open(path).unwrap();
        other.lock().unwrap();
        let asked = std::sync::atomic::AtomicUsize::new(0);
        let third = || asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) == 2;
        let refused = Store::open_for_all(dir.path(), false, &third).unwrap_err();
        let stopped = contact_model::Error::Stopped { best: None };
        assert!(matches!(refused, Error::Model { source, .. } if source == stopped));
        // A run and a shard have locks of their own.
        let run = Store::open(dir.path(), false).unwrap();
        Store::open_shared(dir.path(), "p", Shard { index: 0, count: 2 }).unwrap();
        let release = || {
            other.unlock().unwrap();
            false
        };
        assert_eq!(
            Store::open_for_all(dir.path(), false, &release).unwrap().load(KEY).as_deref(),
            Some(TEXT)
        );
        assert_eq!(Store::open_for_all(dir.path(), true, &never).unwrap().load(KEY), None);
        drop(run);
    }

    #[test]
    fn shards_write_packs_of_their_own() {
        let dir = tempfile::tempdir().unwrap();
        let shard = |index| Store::open_shared(dir.path(), "p", Shard { index, count: 2 }).unwrap();
        let (a, b) = (shard(0), shard(1));
        a.save("a\n", "1\n").unwrap();
        b.save("b\n", "2\n").unwrap();
        // The same job by mistake.
        b.save("a\n", "1\n").unwrap();
        drop((a, b));
        let packs = Store::packs(dir.path()).unwrap();
        assert_eq!(packs.iter().map(|p| p.results.len()).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(packs[1].head.shard.as_deref(), Some("1/2"));
        assert_eq!(Store::count(dir.path()), 2);
        // What another shard of the same division has done is none of its business; of another division, it
        // is.
        assert!(shard(0).load("b\n").is_none() && shard(0).load("a\n").is_some());
        let other = Store::open_shared(dir.path(), "p", Shard { index: 0, count: 3 }).unwrap();
        assert!(other.load("b\n").is_some());
    }

    #[test]
    fn damaged_and_foreign_results_are_as_good_as_absent_and_others_stay() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        store.save(KEY, TEXT).unwrap();
        store.save("second\n", "2\n").unwrap();
        let path = pack_of(dir.path());
        drop(store);
        let all = fs::read(&path).unwrap();
        let read = || {
            let store = Store::open(dir.path(), false).unwrap();
            (store.load(KEY).is_some(), store.load("second\n").is_some())
        };
        assert_eq!(read(), (true, true));
        let mark = all.windows(RESULT.len()).rposition(|w| w == RESULT.as_bytes()).unwrap();
        for cut in 0..all.len() {
            fs::write(&path, &all[..cut]).unwrap();
            assert_eq!(read(), (cut >= mark, false), "{cut} bytes");
        }
        let start =
            PackHead { instructions: crate::manifest::instructions().join(" "), ..PackHead::default() };
        for at in start.text().len()..all.len() {
            let mut damaged = all.clone();
            damaged[at] ^= 0x11;
            fs::write(&path, &damaged).unwrap();
            // The line that begins the second result ends the first one where that has lost its own.
            let (first, second) = read();
            assert!(
                if at < mark { !first && second } else { first && !second },
                "byte {at}: {first} {second}"
            );
        }
        // Whole, but of another key, under the hash of this one.
        let foreign = result(fnv1a_128(KEY.as_bytes()), "seed 2\n", TEXT);
        fs::write(&path, start.text() + &foreign).unwrap();
        assert_eq!(read(), (false, false));
        fs::write(&path, [0xff, 0xfe]).unwrap();
        assert_eq!(read(), (false, false));
        fs::write(&path, &all).unwrap();
        assert_eq!(read(), (true, true));
    }

    #[test]
    fn packs_of_another_format_are_told_once_and_not_used() {
        #[derive(Default)]
        struct Notes(Mutex<Vec<String>>);
        impl Progress for Notes {
            fn begin(&self, _: &str, _: u64) {}
            fn advance(&self, _: u64, _: bool) {}
            fn end(&self) {}
            fn note(&self, text: &str) {
                self.0.lock().unwrap().push(text.to_owned());
            }
        }
        let dir = tempfile::tempdir().unwrap();
        let notes = |store: &Store| {
            let notes = Notes::default();
            store.tell_unused(&notes);
            notes.0.into_inner().unwrap()
        };
        let store = Store::open(dir.path(), false).unwrap();
        store.save(KEY, TEXT).unwrap();
        drop(store);
        let path = pack_of(dir.path());
        let text = fs::read_to_string(&path).unwrap();
        let earlier = text.replacen(&format!("{PACK}{FORMAT}"), &format!("{PACK}{}", FORMAT - 1), 1);
        fs::write(&path, earlier).unwrap();
        for i in 1..LISTED + 3 {
            fs::copy(&path, path.with_file_name(format!("{i:08}.{ENDING}"))).unwrap();
        }
        // No pack at all.
        fs::write(path.with_file_name(format!("00000099.{ENDING}")), "# fractal-contact results\n").unwrap();
        assert_eq!(Store::count(dir.path()), 0);
        // Nothing is read, nothing is told.
        assert_eq!(notes(&Store::open(dir.path(), true).unwrap()), [""; 0]);
        let store = Store::open(dir.path(), false).unwrap();
        assert_eq!(store.load(KEY), None);
        let told = notes(&store);
        assert!(told.len() == 1 && told[0].contains("another version"), "{told:?}");
        assert!(told[0].ends_with("00000003.pack, 00000004.pack and 3 more"), "{told:?}");
        store.save(KEY, TEXT).unwrap();
        drop(store);
        let shard = Store::open_shared(dir.path(), "p", Shard { index: 0, count: 2 }).unwrap();
        assert_eq!((shard.load(KEY).as_deref(), notes(&shard).len()), (Some(TEXT), 0));
    }

    #[test]
    fn lengths_of_nonsense_end_no_process() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        store.save(KEY, TEXT).unwrap();
        drop(store);
        let path = pack_of(dir.path());
        let text = fs::read_to_string(&path).unwrap();
        let whole = format!("{RESULT}{:032x} {}\n", 7, u64::MAX - 76);
        // Far beyond the end, and so that its end is its beginning; and many lines that promise a result.
        for bad in [whole.clone(), whole.repeat(2), format!("{RESULT}x\n").repeat(50_000)] {
            for pack in [text.clone() + &bad, text.replacen(RESULT, &format!("{bad}{RESULT}"), 1)] {
                fs::write(&path, pack).unwrap();
                assert_eq!(Store::open(dir.path(), false).unwrap().load(KEY).as_deref(), Some(TEXT));
            }
        }
    }

    #[test]
    fn what_is_replaced_often_does_not_grow() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        let text = "x".repeat(100_000) + "\n";
        store.save("other\n", TEXT).unwrap();
        for _ in 0..60 {
            store.save(KEY, &text).unwrap();
        }
        assert_eq!(names(&directory(dir.path())).unwrap().len(), 1);
        assert!(fs::metadata(pack_of(dir.path())).unwrap().len() < 3 * LEAST_WASTE);
        assert_eq!(store.load(KEY).unwrap().len(), text.len());
        drop(store);
        let store = Store::open(dir.path(), false).unwrap();
        assert_eq!(
            (store.load(KEY).unwrap().len(), store.load("other\n").as_deref()),
            (text.len(), Some(TEXT))
        );
    }
}
