//! A file of surfaces: its channels, and the scan of each.

use crate::channel::{StoredChannel, StoredHeights, StoredUnit, chosen};
use crate::detect::detect;
use crate::error::{ContentError, Error, Result};
use crate::format::Format;
use crate::instruments::READERS;
use crate::layout::{self, Layout};
use crate::options::ReadOptions;
use crate::reader::SNIFF;
use crate::scan::{DecodedChannel, Scan};
use crate::source::{Input, OpenedFile};
use crate::{points, text};
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;

/// An opened file whose headers are read: one channel or more, whose heights are not read yet.
///
/// ```
/// use surface_io::{ReadOptions, SurfaceFile};
/// let options = ReadOptions::default();
/// let file = SurfaceFile::from_bytes("a.txt", b"# Channel: Topography\n# Width: 3 um\n1 2 3\n4 nan 6\n", &options)?;
/// assert_eq!(file.len(), 1);
/// let scans: Vec<_> = file.scans().collect::<Result<_, _>>()?;
/// assert_eq!(scans[0].metadata().name.as_deref(), Some("Topography"));
/// # Ok::<(), surface_io::Error>(())
/// ```
pub struct SurfaceFile<'a> {
    source: OpenedFile<'a>,
    format: Format,
    channels: Vec<StoredChannel>,
    declared: ReadOptions,
}

impl std::fmt::Debug for SurfaceFile<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SurfaceFile")
            .field("path", &self.source.path())
            .field("format", &self.format)
            .finish()
    }
}

impl<'a> SurfaceFile<'a> {
    /// Opens a file and reads its headers; text is read as a whole.
    ///
    /// # Errors
    /// [`Error::System`] where the system refuses; [`Error::Content`] for everything that is wrong in the
    /// headers.
    pub fn open(path: impl AsRef<Path>, declared: &ReadOptions) -> Result<Self> {
        let path = path.as_ref();
        let (input, length) = opened(path)?;
        Self::new(path, input, length, declared)
    }

    /// Opens the bytes of a file. Messages show `name`, and its ending is used as that of a file's name.
    ///
    /// # Errors
    /// As [`SurfaceFile::open`].
    pub fn from_bytes(name: impl AsRef<Path>, bytes: &'a [u8], declared: &ReadOptions) -> Result<Self> {
        Self::new(name.as_ref(), Cursor::new(bytes), bytes.len() as u64, declared)
    }

    fn new(path: &Path, input: impl Input + 'a, length: u64, declared: &ReadOptions) -> Result<Self> {
        let (mut source, format) = told(path, input, length, declared)?;
        let (format, mut channels) = match format {
            None | Some(Format::Text | Format::Xyz | Format::Profile) => {
                of_text(&mut source, format, declared)?
            }
            Some(format) => {
                no_lines(declared).map_err(Error::content(path))?;
                let reader = READERS.iter().find(|reader| reader.format == format);
                let other = || Error::content(path)(ContentError::Other { expected: format });
                (format, (reader.ok_or_else(other)?.channels)(&mut source)?)
            }
        };
        if channels.is_empty() {
            return Err(source.wrong(0, "one map at least"));
        }
        check_readable(&channels).map_err(|e| source.content(e))?;
        channels.iter_mut().for_each(StoredChannel::escape);
        Ok(Self { source, format, channels, declared: declared.clone() })
    }

    /// The format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Number of channels.
    #[allow(clippy::len_without_is_empty)] // A file without a channel is an error.
    pub fn len(&self) -> usize {
        self.channels.len()
    }

    /// Whether the file says of each channel that its values are no heights, but phases or currents, for instance.
    pub fn has_no_heights(&self) -> bool {
        self.channels.iter().all(|channel| matches!(channel.unit, StoredUnit::NoHeights(_)))
    }

    /// The scan of the channel that was chosen ([`ReadOptions::channel`]), or of the only one that can be
    /// heights.
    ///
    /// # Errors
    /// [`ContentError::Channel`] where none or several are; otherwise as [`SurfaceFile::scans`].
    pub fn scan(mut self) -> Result<Scan> {
        let number = chosen(&self.channels, self.declared.channel.as_ref());
        let number = number.map_err(|e| self.source.content(e))?;
        let channel = self.channels.swap_remove(number);
        scan(&mut self.source, self.format, (number, channel), &self.declared)
    }

    /// The scans of all channels, one after another.
    ///
    /// # Errors
    /// Of each: [`ContentError::Unread`] where this channel cannot be read and others can; [`Error::System`]
    /// where the system refuses; [`Error::Content`] for heights that are not all there, that are infinite or
    /// that no double holds, and for contradictions to what is declared.
    pub fn scans(self) -> impl Iterator<Item = Result<Scan>> {
        let Self { mut source, format, channels, declared } = self;
        channels.into_iter().enumerate().map(move |channel| scan(&mut source, format, channel, &declared))
    }
}

/// Where no channel can be read, the first says why.
pub(crate) fn check_readable(channels: &[StoredChannel]) -> Result<(), ContentError> {
    match channels {
        [StoredChannel { heights: StoredHeights::Unread(problem), .. }, rest @ ..]
            if rest.iter().all(|channel| matches!(channel.heights, StoredHeights::Unread(_))) =>
        {
            Err(problem.clone())
        }
        _ => Ok(()),
    }
}

/// An opened file and its length.
pub(crate) fn opened(path: &Path) -> Result<(BufReader<File>, u64)> {
    // Looked at before it is opened: opening a pipe waits for a writer.
    let about = std::fs::metadata(path).map_err(Error::system("open", path))?;
    if !about.is_file() {
        return Err(Error::content(path)(ContentError::NotAFile));
    }
    let file = File::open(path).map_err(Error::system("open", path))?;
    Ok((BufReader::new(file), about.len()))
}

/// The source of an input that is not too long, and its format; `None` for text that may be a matrix or
/// points.
pub(crate) fn told<'a>(
    path: &Path,
    input: impl Input + 'a,
    length: u64,
    declared: &ReadOptions,
) -> Result<(OpenedFile<'a>, Option<Format>)> {
    if length > declared.largest_bytes {
        let problem = ContentError::TooLarge { bytes: length, largest: declared.largest_bytes };
        return Err(Error::content(path)(problem));
    }
    let mut source = OpenedFile::new(path, input, length);
    let start = source.start(SNIFF)?;
    let format = detect(declared.format, path, &start, length).map_err(Error::content(path))?;
    source.read_as(format);
    Ok((source, format))
}

impl Scan {
    /// Reads a file of one channel, or the channel that [`ReadOptions::channel`] names.
    ///
    /// Memory: that of the heights for binary files that are not compressed; for text that of the file and up
    /// to four times its length in addition.
    ///
    /// # Errors
    /// As [`SurfaceFile::open`] and [`SurfaceFile::scan`].
    ///
    /// ```no_run
    /// use surface_io::{ReadOptions, Scan};
    /// let scan = Scan::read("map.txt", &ReadOptions::default())?;
    /// # Ok::<(), surface_io::Error>(())
    /// ```
    pub fn read(path: impl AsRef<Path>, declared: &ReadOptions) -> Result<Self> {
        SurfaceFile::open(path, declared)?.scan()
    }

    /// Reads the bytes of a file. Messages show `name`, and its ending is used as that of a file's name.
    ///
    /// # Errors
    /// As [`Scan::read`].
    ///
    /// ```
    /// use surface_io::{ReadOptions, Scan};
    /// let scan = Scan::from_bytes("a.txt", b"# Width: 3 um\n1 2 3\n4 nan 6\n", &ReadOptions::default())?;
    /// assert_eq!((scan.metadata().rows, scan.metadata().columns), (2, 3));
    /// assert_eq!(scan.height(0, 2), Some(3.0));
    /// assert_eq!(scan.height(1, 1), None);
    /// # Ok::<(), surface_io::Error>(())
    /// ```
    pub fn from_bytes(name: impl AsRef<Path>, bytes: &[u8], declared: &ReadOptions) -> Result<Self> {
        SurfaceFile::from_bytes(name, bytes, declared)?.scan()
    }
}

/// The scan of a channel.
pub(crate) fn scan(
    source: &mut OpenedFile<'_>,
    format: Format,
    (number, mut channel): (usize, StoredChannel),
    declared: &ReadOptions,
) -> Result<Scan> {
    if let StoredHeights::Unread(_) = channel.heights {
        return Err(source.content(ContentError::Unread { channel: channel.line(number) }));
    }
    if let Some(axes) = declared.axes {
        channel.orient(axes).map_err(|e| source.content(e))?;
    }
    let heights = channel.read(source)?;
    let own;
    let declared = if let StoredUnit::NoHeights(_) = channel.unit {
        // A unit of heights is not one of phases.
        own = ReadOptions { unit: None, height_scale: None, ..declared.clone() };
        &own
    } else {
        declared
    };
    let decoded = DecodedChannel { format, number, channel, heights };
    Scan::new(source.path(), decoded, declared).map_err(|e| source.content(e))
}

/// The channels of a text: matrices, points or profiles, as their headings name the columns.
pub(crate) fn of_text(
    source: &mut OpenedFile<'_>,
    requested: Option<Format>,
    declared: &ReadOptions,
) -> Result<(Format, Vec<StoredChannel>)> {
    let length = source.length();
    let bytes = source.start(length)?;
    let tables = text::TextTable::read(&bytes, declared).map_err(|e| source.content(e))?;
    drop(bytes);
    let mut channels = Vec::new();
    let mut first = None;
    for table in tables {
        let layout = layout::layout(&table, requested, declared);
        let name = table.heading.name.clone();
        let mut list = |name, channel: Result<StoredChannel, ContentError>| {
            let channel = channel.map_err(|e| source.content(e));
            channels.push(StoredChannel::listed(name, channel)?);
            Ok(())
        };
        first = first.or(layout.as_ref().ok().map(Layout::format));
        match layout {
            Err(problem) => list(name, Err(problem))?,
            Ok(Layout::Matrix) => list(name, text::matrix(table, declared))?,
            Ok(Layout::Points(maps)) => maps.iter().try_for_each(|columns| {
                list(columns.name.clone().or(name.clone()), points::grid(&table, columns, declared))
            })?,
            Ok(Layout::Profiles(maps)) => maps.iter().try_for_each(|columns| {
                list(columns.name.clone().or(name.clone()), points::row(&table, columns, declared))
            })?,
        }
    }
    Ok((first.unwrap_or(Format::Text), channels))
}

/// Fails for options that only text has a use for.
fn no_lines(declared: &ReadOptions) -> Result<(), ContentError> {
    if declared.lateral_unit.is_some() {
        let reason = "a map has no coordinates; give size or cell with a unit";
        return Err(ContentError::Useless { what: "lateral_unit", reason });
    }
    if declared.skip_lines > 0 {
        let reason = "a binary file has no lines";
        return Err(ContentError::Useless { what: "skip_lines", reason });
    }
    Ok(())
}
