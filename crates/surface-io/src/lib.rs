//! Reading and writing of surfaces, and quantities with units.
//!
//! How do you get heights in metres out of a file of an instrument, without a silent mistake? Reading has two
//! steps, so that a person can check the data between them. A [`Scan`] has the content of a file, with its
//! undefined points and in its own unit. Its [`Metadata`] report what was read. [`Scan::map`] then makes a
//! [`contact_model::HeightMap`] of it, with only the steps that a [`Preprocessing`] names.
//!
//! ```
//! use surface_io::{ReadOptions, Fill, Scan, Preprocessing, Undefined, describe};
//! // Three columns over 3 um and two rows over 1 um: cells of 1 um x 0.5 um.
//! let file = b"# Width: 3 um\n# Height: 1 um\n# Value units: nm\n1 2 3\n4 nan 8\n";
//! let scan = Scan::from_bytes("a.txt", file, &ReadOptions::default())?;
//! assert_eq!(scan.metadata().undefined, 1);
//! // An undefined point is an error until the caller states how to treat it.
//! assert!(scan.map(&Preprocessing::default()).is_err());
//! let map = scan.map(&Preprocessing { undefined: Some(Undefined::NoContact), ..Preprocessing::default() })?;
//! assert_eq!((map.columns(), map.rows(), map.undefined(), map.size().y), (3, 2, 1, 1e-6));
//! let map = scan.map(&Preprocessing { fill: Some(Fill::Neighbours), ..Preprocessing::default() })?;
//! // Neighbours along y are nearer and weigh 2, those along x 1/2: (2 * 2 + (4 + 8) / 2) / 3.
//! assert!((map.heights()[4] - 10e-9 / 3.0).abs() < 1e-18);
//! println!("{}", describe(&map));
//! # Ok::<(), surface_io::Error>(())
//! ```
//!
//! # Nothing is guessed silently
//!
//! ## Formats
//!
//! * **Recognition.** Binary formats are recognised by their first bytes. XYZ is recognised by the ending of
//!   the name or by [`ReadOptions::format`]. Everything else is a text matrix. Errors name other files that
//!   people try (archives, pictures).
//! * **Three columns** without either are points or a matrix according to their comments. Without such
//!   comments they are points if the first two columns are all places of a grid, and otherwise an error.
//!   **Two columns** of more than eight lines are a profile if the numbers in the first ascend or descend.
//! * **NPY.** An array has two axes of float64, float32, float16 or integers, in either byte order, row by
//!   row or column by column. An integer that no double holds is an error.
//! * **Channels** that cannot be read are listed, with the reason, beside those that can.
//!
//! ## Text
//!
//! * **Delimiter.** The first line of data sets it: semicolon, else tab, else comma, else whitespace.
//! * **Header.** Comments begin with `#` or `%` at the beginning of a line or behind white space. Lines
//!   before the numbers that begin with a word are a header like them. The keys `Width`, `Height`,
//!   `Value units` and `Lateral units` are used in both, as Gwyddion's exports and this crate write them. So
//!   are the keys of SPIP, Nanoscope and profilers (`x-length`, `Scan Size`, `Pixel size`, `Z unit`, ...).
//! * **Contradictions.** Two statements that differ are an error. So is a stated number of columns or rows
//!   that is not the actual one.
//! * **Decimal commas** are read on request ([`Decimal::Comma`]), or where every comma can be nothing else.
//! * **Undefined points** are an empty place between two delimiters, `nan`, words such as `---` or `BAD`, and
//!   the C library's `1.#QNAN`.
//! * **Several maps.** A heading or an empty line between numbers ends a map. Several maps are channels.
//! * **Coordinates at the border.** Where the first line or the first column may be coordinates, the caller
//!   must decide ([`ReadOptions::border`]).
//! * **Headings of columns.** A line above the numbers with a name for each column (`x [um]`, `Y_mm`, `z/nm`,
//!   `row`, `lat`) says what the columns are, in any order. x, y and heights are points; x and heights are a
//!   profile. Other columns are noted if there are heights, and otherwise each of them is a channel. Numbers
//!   of rows and columns need [`ReadOptions::cell`]. Degrees, and columns without a coordinate, are an error
//!   ([`ContentError::Columns`]).
//!
//! ## Size and axes
//!
//! * **Size.** It is given by two sides of the map or of a cell. One value means a square map or square
//!   cells. Cells are also square where a header has only a width or only a height, and where both make
//!   square cells within their printed decimals. Cells whose sides differ by a factor of more than 1e4 are an
//!   error.
//! * **Profiles.** Points x, z with equal steps become a map of one row. So does a row of an instrument whose
//!   file says its length along x alone ([`Metadata::profile`]). It is a body that is uniform along y, on
//!   square cells.
//! * **Points** may have any order. The spacing along each axis is the smallest step, refined over the whole
//!   range. Both axes get the same spacing where the two differ by no more than the scatter of the points. A
//!   point may deviate from its place by a tenth of a spacing that was found, or by a quarter of a given one.
//!   The largest deviation is reported. Two points at one place are an error, and so is a grid that is more
//!   than half empty.
//! * **Axes.** Names of dimensions decide the order of an array (`x`, `lon`, `easting`, ... and `y`, `lat`,
//!   `northing`, ...). Arrays without such names (HDF5, MATLAB, NetCDF) are read by the custom of the format,
//!   and this is noted. [`ReadOptions::axes`] says which index is x. It is an error where the file or the
//!   format defines it.
//! * **Coordinates** of named dimensions in equal steps and in a unit of length give the size, and turn an
//!   axis on which they descend. Other units are noted, and the caller must give the size. Unequal steps are
//!   an error.
//! * **Order.** Row j is y, column i is x, and the first row is y = 0: `heights[j * columns + i]`. NPY arrays
//!   are `[row, column]`.
//!
//! ## Heights
//!
//! * **Units.** Heights with a unit become metres, and the sides must then have a unit too. Without any unit
//!   both stay as they are. A value that is given in addition to that of the file must agree with it within
//!   the digits of a header (0.5 %).
//! * **Counts.** Grey levels and other numbers without a unit become heights only by
//!   [`ReadOptions::height_scale`]. Integers of an HDF5 file that have a unit of length and no scale are
//!   counts too.
//! * **Marks** of undefined points are compared as the numbers are stored: -9999.9 is that number in float32.
//! * **Undefined points** are refused without a [`Fill`] or [`Undefined::NoContact`], and with both. Infinite
//!   heights are always refused.
//! * **Notes.** Statements of a file that are not used are in [`Metadata::notes`], and so is a value far from
//!   all others. Both are also in the error about missing information.
//!
//! # Accuracy
//!
//! Numbers are the doubles nearest to the written ones, also with a unit of a power of ten behind them
//! ([`Quantity`]). Heights of a scan are converted with one rounding.
//!
//! Heights that this crate writes are read again with identical bits ([`text()`], [`xyz`], [`npy`], [`hdf5`],
//! [`x3p`], [`gwy`], [`netcdf`]). So are the sides, except in NPY, which has none, and in X3P, where the last
//! bit may differ. Trends are exact to 1e-13 of the range of the heights, and filled points to 1e-10.
//!
//! # Hostile files
//!
//! Readers never panic. They need at most 24 bytes of memory for each byte of the file, and 100 kB. The worst
//! case is a half-empty grid of points whose numbers have one digit. NPY needs 1 byte, and text about 2.
//! Sizes that a header claims are compared with the length of the file before anything is allocated. Files
//! beyond [`ReadOptions::largest_bytes`] are not read. `tests/hostile.rs` measures the memory.
//!
//! # Speed
//!
//! On one core of a busy machine of the 2020s a map of 1024 x 1024 cells takes these times:
//!
//! | format | read | written |
//! |---|---|---|
//! | NPY | 0.02 s | 0.02 s |
//! | text | 0.12 s | 0.2 s |
//! | points | 0.45 s | 0.5 s |
//! | VTI | | 0.07 s |
//!
//! It is described in 0.03 s. [`Fill::Neighbours`] takes as many sweeps over the undefined points as the
//! largest patch of them is wide.
//!
//! # Writing
//!
//! [`map_file`] returns the bytes of a map in the format of a name's ending. [`npy`], [`hdf5`], [`text()`],
//! [`xyz`], [`x3p`], [`gwy`], [`netcdf`] and [`vti`] (for ParaView) return the bytes of one format. The caller
//! writes them into a file.
//!
//! # Features
//!
//! `hdf5`, `tiff` and `x3p`, all on by default, bring the crates that these formats need (12 packages). If a
//! build leaves a format out, reading such a file is an error that names the feature
//! ([`ContentError::LeftOut`]).
//!
//! # What it does not do
//!
//! It makes no surfaces with finer cells than measured, and reads no formats that are not in [`Format`].

// What only the formats that are left out need.
#![cfg_attr(not(all(feature = "hdf5", feature = "tiff", feature = "x3p")), allow(dead_code))]

mod array;
mod channel;
mod choice;
mod composite;
mod cursor;
mod describe;
mod detect;
mod entries;
mod error;
mod extent;
mod fields;
mod format;
mod inflate;
mod instruments;
mod keyword;
mod layout;
mod lines;
mod npy;
mod number_type;
mod options;
mod points;
mod preprocessing;
mod provenance;
mod quantity;
mod reader;
mod scan;
mod sides;
mod source;
mod subject;
mod surface_file;
mod text;
mod vti;
mod write;
mod zip;

pub use choice::ChannelChoice;
pub use composite::composite;
pub use describe::{Absent, Description, describe};
pub use error::{ContentError, Error, NumberKind, Place, Result};
pub use format::Format;
pub use instruments::{gwy, hdf5, netcdf, x3p};
pub use keyword::KeywordError;
pub use npy::npy;
pub use options::{Axes, Border, Decimal, ReadOptions};
pub use points::{profile, profile_from_bytes};
pub use preprocessing::{
    AlignLines, Crop, Detrend, Fill, Mirror, Preprocessed, Preprocessing, Undefined, Window, filled,
};
pub use provenance::{Origin, Sourced};
pub use quantity::{Dimension, Quantity, QuantityError, Unit};
pub use scan::{Metadata, Scan};
pub use sides::Sides;
pub use surface_file::SurfaceFile;
pub use vti::{DataArray, Encoding, vti, vti_volume};
pub use write::{Metric, map_file, text, xyz};
