//! Points x, z along a line.

use crate::channel::{StoredChannel, chosen};
use crate::error::{ContentError, Result};
use crate::format::Format;
use crate::options::ReadOptions;
use crate::preprocessing::Preprocessing;
use crate::source::Input;
use crate::surface_file::{check_readable, of_text, opened, scan, told};
use contact_model::Line;
use std::io::Cursor;
use std::path::Path;

/// Reads a measured profile as a line: text of two columns, x and z, in any order of the points.
/// [`crate::Scan::read`] makes a map of one row of it, the body that is uniform along y.
///
/// The rules are those of points of a map along one axis. The steps of x are equal within a tenth of one
/// ([`ReadOptions::cell`] for noisier ones), and the line is one step longer than the distance between its
/// first and last points. Every place needs a height. Both units are in the file or are given
/// ([`ReadOptions::unit`] or [`ReadOptions::height_scale`], and [`ReadOptions::lateral_unit`]); `none` for
/// both means plain numbers.
///
/// # Errors
/// [`crate::Error::System`] where the system refuses; [`crate::Error::Content`] for everything else.
///
/// ```
/// use surface_io::{ReadOptions, profile_from_bytes};
/// let declared = ReadOptions { unit: Some("nm".parse()?), lateral_unit: Some("um".parse()?), ..ReadOptions::default() };
/// let line = profile_from_bytes("a.txt", b"0.0 5\n0.5 6\n1.0 4\n", &declared)?;
/// assert_eq!((line.elements(), line.length(), line.heights()[1]), (3, 1.5e-6, 6e-9));
/// // The unit of the heights is not guessed.
/// assert!(profile_from_bytes("a.txt", b"0.0 5\n0.5 6\n1.0 4\n", &ReadOptions::default()).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn profile(path: &Path, declared: &ReadOptions) -> Result<Line> {
    let (input, length) = opened(path)?;
    read(path, input, length, declared)
}

/// Reads the bytes of a profile as [`profile`] does; `name` stands in the messages.
///
/// # Errors
/// As [`profile`].
pub fn profile_from_bytes(name: impl AsRef<Path>, bytes: &[u8], declared: &ReadOptions) -> Result<Line> {
    read(name.as_ref(), Cursor::new(bytes), bytes.len() as u64, declared)
}

fn read(path: &Path, input: impl Input, length: u64, declared: &ReadOptions) -> Result<Line> {
    let (mut source, format) = told(path, input, length, declared)?;
    if let Some(found) = format.filter(|f| !matches!(f, Format::Text | Format::Xyz | Format::Profile)) {
        return Err(source.content(ContentError::NotOfFormat { expected: Format::Profile, found }));
    }
    if declared.size.is_some() || declared.width.is_some() {
        let reason = "x says how long a profile is; cell says its steps";
        return Err(source.content(ContentError::Useless { what: "size", reason }));
    }
    let (_, mut channels) = of_text(&mut source, Some(Format::Profile), declared)?;
    check_readable(&channels).map_err(|e| source.content(e))?;
    channels.iter_mut().for_each(StoredChannel::escape);
    let number = chosen(&channels, declared.channel.as_ref()).map_err(|e| source.content(e))?;
    let channel = channels.swap_remove(number);
    let points = channel.columns;
    let scan = scan(&mut source, Format::Profile, (number, channel), declared)?;
    let undefined = scan.metadata().undefined;
    if undefined > 0 {
        return Err(source.content(ContentError::Gaps { undefined, points }));
    }
    if scan.metadata().unit.is_none() {
        return Err(source.content(ContentError::no_unit(&scan.metadata().notes)));
    }
    let map = scan.into_preprocessed(&Preprocessing::default())?.map;
    Line::new(map.size().x, map.heights().to_vec()).map_err(|e| source.content(ContentError::Map(e)))
}
