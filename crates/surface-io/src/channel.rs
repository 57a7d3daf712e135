//! Channels: the maps in one file, and where the file has the heights of each.

use crate::choice::ChannelChoice;
use crate::error::{ContentError, Error, Place, Result};
use crate::extent::Extent;
use crate::number_type::NumberType;
use crate::options::Axes;
use crate::quantity::{Dimension, QuantityError, Unit};
use crate::source::OpenedFile;
use contact_model::escaped;
use contact_model::units::number;

/// Unit of a channel's values as stated in the file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum StoredUnit {
    /// Nothing.
    Unknown,
    /// A length, or that heights are plain numbers.
    Heights(Unit),
    /// The values are no heights: a phase, a voltage, counts; the unit as written, where there is one.
    NoHeights(Option<String>),
}

impl StoredUnit {
    /// The unit as a file writes it: a length makes heights, nothing is unknown, all else no heights.
    pub(crate) fn written(text: &str) -> Self {
        let text = text.trim();
        if text.is_empty() {
            return Self::Unknown;
        }
        match Unit::of_file(text) {
            Ok(unit) if unit.dimension() == Dimension::LENGTH => Self::Heights(unit),
            _ => Self::NoHeights(Some(text.chars().take(32).collect())),
        }
    }
}

/// Words in the names of signals of probe microscopes that are no heights, even if their unit is the metre.
const SIGNALS: [&str; 3] = ["amplitude", "deflection", "error"];

impl StoredUnit {
    /// The unit of a signal of a probe microscope. A signal of the cantilever is no height, even if it is a
    /// length.
    pub(crate) fn of_signal(name: &str, unit: &str) -> Self {
        let name = name.to_lowercase();
        match Self::written(unit) {
            Self::Heights(unit) if SIGNALS.iter().any(|signal| name.contains(signal)) => {
                Self::NoHeights(Some(unit.to_string()))
            }
            unit => unit,
        }
    }
}

/// One channel as the header of its file describes it.
pub(crate) struct StoredChannel {
    /// Name, where the file gives one.
    pub(crate) name: Option<String>,
    /// Type of the numbers, order, compression.
    pub(crate) details: String,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    pub(crate) unit: StoredUnit,
    /// Along x and y, where the file says it.
    pub(crate) extent: [Option<Extent>; 2],
    pub(crate) axes: FileAxes,
    /// Notes for people: statements of the file that are not used or that are ambiguous.
    pub(crate) notes: Vec<String>,
    /// The type in which the heights are compared with [`crate::ReadOptions::missing`]: that of the numbers
    /// where these are the heights.
    pub(crate) compared: NumberType,
    pub(crate) heights: StoredHeights,
}

/// How a file states which axis the first index of an array counts along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FileAxes {
    /// The file states nothing, because the format has only one order.
    Fixed,
    /// The file names the axes.
    Said(Axes),
    /// The file states nothing; this order is the custom of the format.
    Assumed(Axes),
}

impl FileAxes {
    /// Which index of the map runs fastest, the last of the array.
    pub(crate) fn order(self) -> AxisOrder {
        match self {
            Self::Said(Axes::Xy) | Self::Assumed(Axes::Xy) => AxisOrder::Columns,
            _ => AxisOrder::Rows,
        }
    }
}

/// How a note on the order of the axes begins.
const TAKEN: &str = "the first index is taken for";

/// Where the heights are.
pub(crate) enum StoredHeights {
    /// In memory: text is read as a whole.
    Read(Vec<f64>),
    /// Numbers in the file or in memory, decoded on request.
    Raw(RawHeights),
    /// Heights that another reader makes from the file.
    Deferred(Box<Deferred>),
    /// The error of this channel, where others of its file can be read.
    Unread(ContentError),
}

/// Reads the heights row by row, NaN where undefined.
type Deferred = dyn Fn(&mut OpenedFile<'_>) -> Result<Vec<f64>> + Send + Sync;

/// Numbers one after another: `height = scale * number + shift`.
pub(crate) struct RawHeights {
    pub(crate) bytes: Bytes,
    pub(crate) number: NumberType,
    /// Which index runs fastest.
    pub(crate) order: AxisOrder,
    /// Bytes from the beginning of one line of numbers to the next, where lines are padded.
    pub(crate) line_bytes: Option<u64>,
    /// Whether the first number along x, along y is that of the last column, the last row.
    pub(crate) reversed: [bool; 2],
    pub(crate) scale: f64,
    pub(crate) shift: f64,
    /// Which numbers stand for undefined points, besides NaN.
    pub(crate) undefined: Undefined,
    /// The lowest and the highest number that is a height; all others are undefined.
    pub(crate) valid: [f64; 2],
}

/// Numbers that are undefined where those of a mask are not 0.
pub(crate) struct MaskedHeights {
    pub(crate) raw: RawHeights,
    pub(crate) mask: RawHeights,
    /// What the mask does, for people.
    pub(crate) detail: &'static str,
}

/// Where numbers are.
#[derive(Clone)]
pub(crate) enum Bytes {
    /// In the file, from an offset on.
    File(u64),
    /// In memory, unpacked.
    Held(Vec<u8>),
}

/// Which index runs fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AxisOrder {
    /// x: row by row.
    Rows,
    /// y: column by column.
    Columns,
}

impl AxisOrder {
    fn other(self) -> Self {
        match self {
            Self::Rows => Self::Columns,
            Self::Columns => Self::Rows,
        }
    }

    /// Converts `[lines, numbers along a line]` to `[rows, columns]`, and the reverse.
    pub(crate) fn shape<N>(self, [lines, along]: [N; 2]) -> [N; 2] {
        match self {
            Self::Rows => [lines, along],
            Self::Columns => [along, lines],
        }
    }

    /// In words of people.
    fn words(self) -> &'static str {
        match self {
            Self::Rows => "row by row",
            Self::Columns => "column by column",
        }
    }
}

/// Numbers that stand for undefined points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Undefined {
    /// None.
    None,
    /// One number.
    Equal(f64),
    /// One of two numbers.
    Either(f64, f64),
    /// One number within the seven digits that a header prints of a float32.
    Near(f64),
    /// This one and all larger ones.
    AtLeast(f64),
}

impl Undefined {
    /// The numbers of the attributes `_FillValue` and `missing_value`, as NetCDF and HDF5 have them.
    pub(crate) fn either(fill: Option<f64>, missing: Option<f64>) -> Self {
        match (fill, missing) {
            (Some(fill), Some(missing)) => Self::Either(fill, missing),
            (Some(mark), None) | (None, Some(mark)) => Self::Equal(mark),
            (None, None) => Self::None,
        }
    }

    /// The same with other numbers.
    pub(crate) fn map(self, other: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::None => Self::None,
            Self::Equal(mark) => Self::Equal(other(mark)),
            Self::Either(a, b) => Self::Either(other(a), other(b)),
            Self::Near(mark) => Self::Near(other(mark)),
            Self::AtLeast(mark) => Self::AtLeast(other(mark)),
        }
    }

    /// Whether a number that is stored in this type stands for an undefined point.
    pub(crate) fn holds(self, stored: NumberType, number: f64) -> bool {
        match self {
            Self::None => false,
            Self::Equal(mark) => stored.same(number, mark),
            Self::Either(a, b) => stored.same(number, a) || stored.same(number, b),
            Self::Near(mark) => (number - mark).abs() <= 1.5e-7 * mark.abs(),
            Self::AtLeast(mark) => number >= mark || stored.same(number, mark),
        }
    }
}

impl RawHeights {
    /// Numbers of a type in the file from an offset on, as [`RawHeights::new`].
    pub(crate) fn at(offset: u64, number: NumberType) -> Self {
        Self::new(Bytes::File(offset), number)
    }

    /// Numbers of a type row by row from the first row on, heights as they are.
    pub(crate) fn new(bytes: Bytes, number: NumberType) -> Self {
        Self {
            bytes,
            number,
            order: AxisOrder::Rows,
            line_bytes: None,
            reversed: [false; 2],
            scale: 1.0,
            shift: 0.0,
            undefined: Undefined::None,
            valid: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The type in which heights are compared with a mark of the caller: scaled ones are doubles.
    pub(crate) fn compared(&self) -> NumberType {
        let plain = (self.scale - 1.0).abs() <= 0.0 && self.shift.abs() <= 0.0;
        if plain { self.number } else { NumberType::F64 }
    }

    /// The type of the numbers and their order, for people.
    pub(crate) fn details(&self) -> String {
        format!("{}, {}", self.number, self.order.words())
    }

    /// Number of bytes of this number of rows and columns; `None` beyond 2^64.
    fn length(&self, rows: usize, columns: usize) -> Option<u64> {
        let [lines, along] = self.order.shape([rows, columns]);
        let own = (along as u64).checked_mul(self.number.bytes() as u64)?;
        let line = self.line_bytes.unwrap_or(own).max(own);
        line.checked_mul(lines as u64 - 1)?.checked_add(own)
    }

    /// An error where the scale would make all heights equal or not finite; called before the channel is
    /// listed.
    pub(crate) fn check_scale(&self, source: &OpenedFile<'_>) -> Result<()> {
        if self.scale.is_finite() && self.scale.abs() > 0.0 && self.shift.is_finite() {
            return Ok(());
        }
        let offset = if let Bytes::File(offset) = self.bytes { offset } else { 0 };
        let expected = format!(
            "a factor other than 0 and a finite shift of the heights, found {} and {}",
            self.scale, self.shift
        );
        Err(source.wrong(offset, expected))
    }

    /// An error where the numbers are not all there, or their scale makes no heights; called before the
    /// channel is listed.
    pub(crate) fn check(&self, source: &OpenedFile<'_>, rows: usize, columns: usize) -> Result<()> {
        source.check_cells([rows, columns])?;
        let (offset, found) = match &self.bytes {
            Bytes::File(offset) => (*offset, source.length().saturating_sub(*offset)),
            Bytes::Held(bytes) => (0, bytes.len() as u64),
        };
        if self.length(rows, columns).is_none_or(|length| length > found) {
            let (what, size) = (self.number, self.number.bytes());
            let held = if matches!(self.bytes, Bytes::Held(_)) { "unpacked " } else { "" };
            let expected = format!(
                "{rows} x {columns} numbers of {size} bytes ({what}), there are {found} {held}bytes (cut short?)"
            );
            return Err(source.wrong(offset, expected));
        }
        self.check_scale(source)
    }

    /// The heights, row-major, NaN where undefined.
    pub(crate) fn read(&self, source: &mut OpenedFile<'_>, rows: usize, columns: usize) -> Result<Vec<f64>> {
        self.check(source, rows, columns)?;
        let mut heights = undefined_heights(source, rows, columns)?;
        self.each(source, rows, columns, &mut |i, height| heights[i] = height)?;
        Ok(heights)
    }

    /// Calls for each height with its place row by row, NaN where undefined, in the order of the file.
    pub(crate) fn each(
        &self,
        source: &mut OpenedFile<'_>,
        rows: usize,
        columns: usize,
        take: &mut dyn FnMut(usize, f64),
    ) -> Result<()> {
        /// Bytes that are read at a time.
        const CHUNK: usize = 1 << 16;
        self.check(source, rows, columns)?;
        let [lines, along] = self.order.shape([rows, columns]);
        let size = self.number.bytes();
        let line_bytes = self.line_bytes.unwrap_or(0).max((along * size) as u64);
        let at_once = (CHUNK / size).min(along);
        let mut buffer = vec![0; if matches!(self.bytes, Bytes::File(_)) { at_once * size } else { 0 }];
        for line in 0..lines {
            let mut done = 0;
            while done < along {
                let count = at_once.min(along - done);
                let from = line as u64 * line_bytes + (done * size) as u64;
                let bytes = match &self.bytes {
                    Bytes::File(offset) => {
                        source.fill(offset + from, &mut buffer[..count * size])?;
                        &buffer[..count * size]
                    }
                    Bytes::Held(bytes) => &bytes[from as usize..][..count * size],
                };
                for (i, raw) in bytes.chunks_exact(size).enumerate() {
                    let (i, height) = self.placed(source, [rows, columns], [line, done + i], raw)?;
                    take(i, height);
                }
                done += count;
            }
        }
        Ok(())
    }

    /// Puts the height of a number that another reader decoded where it belongs.
    pub(crate) fn put_number(&self, heights: &mut [f64], shape: [usize; 2], place: [usize; 2], number: f64) {
        let [row, column] = self.place(shape, place);
        heights[row * shape[1] + column] = self.height(number);
    }

    /// Row and column of a place of a line.
    pub(crate) fn place(&self, [rows, columns]: [usize; 2], [line, at]: [usize; 2]) -> [usize; 2] {
        let [row, column] = self.order.shape([line, at]);
        [
            if self.reversed[1] { rows - 1 - row } else { row },
            if self.reversed[0] { columns - 1 - column } else { column },
        ]
    }

    /// The index, row by row, of the number at a place of a line, and its height.
    pub(crate) fn placed(
        &self,
        source: &OpenedFile<'_>,
        shape: [usize; 2],
        place: [usize; 2],
        raw: &[u8],
    ) -> Result<(usize, f64)> {
        let [row, column] = self.place(shape, place);
        let number = self.number.decode(raw).map_err(|value| {
            source.content(ContentError::Inexact { place: Place::Cell { row, column }, value })
        })?;
        Ok((row * shape[1] + column, self.height(number)))
    }

    fn height(&self, number: f64) -> f64 {
        // An end of the range is inside, as it is stored.
        let [low, high] = self.valid;
        let outside = (number < low && !self.number.same(number, low))
            || (number > high && !self.number.same(number, high));
        if outside || self.undefined.holds(self.number, number) {
            return f64::NAN;
        }
        // Adding nothing would still lose the sign of -0.
        let scaled = self.scale * number;
        if self.shift.abs() > 0.0 { scaled + self.shift } else { scaled }
    }
}

/// A map of undefined points, where there is memory for it.
pub(crate) fn undefined_heights(source: &OpenedFile<'_>, rows: usize, columns: usize) -> Result<Vec<f64>> {
    let mut heights = source.room(rows * columns)?;
    heights.resize(rows * columns, f64::NAN);
    Ok(heights)
}

impl StoredChannel {
    /// A channel without a name, with this number of rows and columns, whose numbers are all in the file.
    pub(crate) fn new(
        source: &OpenedFile<'_>,
        raw: RawHeights,
        [rows, columns]: [usize; 2],
        unit: StoredUnit,
        extent: [Option<Extent>; 2],
    ) -> Result<Self> {
        raw.check(source, rows, columns)?;
        let (details, compared) = (raw.details(), raw.compared());
        Ok(Self { extent, compared, ..Self::of(StoredHeights::Raw(raw), details, [rows, columns], unit) })
    }

    /// A channel without a name whose heights another reader makes.
    pub(crate) fn deferred(
        details: String,
        shape: [usize; 2],
        unit: StoredUnit,
        extent: [Option<Extent>; 2],
        read: impl Fn(&mut OpenedFile<'_>) -> Result<Vec<f64>> + Send + Sync + 'static,
    ) -> Self {
        Self { extent, ..Self::of(StoredHeights::Deferred(Box::new(read)), details, shape, unit) }
    }

    /// A channel without a name and without a size.
    pub(crate) fn of(
        heights: StoredHeights,
        details: String,
        [rows, columns]: [usize; 2],
        unit: StoredUnit,
    ) -> Self {
        let (extent, axes, notes) = ([None; 2], FileAxes::Fixed, Vec::new());
        let compared = NumberType::F64;
        Self { name: None, details, rows, columns, unit, extent, axes, notes, compared, heights }
    }

    /// A channel as that of [`StoredChannel::new`], of numbers with a mask.
    pub(crate) fn masked(
        source: &OpenedFile<'_>,
        masked: MaskedHeights,
        [rows, columns]: [usize; 2],
        unit: StoredUnit,
        extent: [Option<Extent>; 2],
    ) -> Result<Self> {
        let MaskedHeights { raw, mask, detail } = masked;
        raw.check(source, rows, columns)?;
        mask.check(source, rows, columns)?;
        let (details, compared) = (format!("{}, {detail}", raw.details()), raw.compared());
        let read = move |source: &mut OpenedFile<'_>| {
            let mut heights = raw.read(source, rows, columns)?;
            mask.each(source, rows, columns, &mut |i, masked| {
                if masked.abs() > 0.0 {
                    heights[i] = f64::NAN;
                }
            })?;
            Ok(heights)
        };
        Ok(Self { compared, ..Self::deferred(details, [rows, columns], unit, extent, read) })
    }

    /// Notes sides, or those of cells, in a unit that is no length, which are not used.
    pub(crate) fn note_sides(&mut self, what: &str, sides: [Option<f64>; 2], unit: &str) {
        if let ([None, None], [Some(x), Some(y)]) = (self.extent, sides) {
            let unit = if unit.is_empty() { "without a unit" } else { unit };
            self.note(format!(
                "the file has {what} {} x {} {unit}, which is no length",
                number(x),
                number(y)
            ));
        }
    }

    /// A channel, or one that says why it is not read: the others of its file are read all the same.
    pub(crate) fn listed(name: Option<String>, channel: Result<Self>) -> Result<Self> {
        match channel {
            Err(Error::Content { problem, .. }) => {
                let heights = StoredHeights::Unread(problem);
                Ok(Self { name, ..Self::of(heights, String::new(), [0, 0], StoredUnit::NoHeights(None)) })
            }
            channel => channel,
        }
    }

    /// The same with a name, where it is one.
    pub(crate) fn named(self, name: &str) -> Self {
        Self { name: Some(name.trim().to_owned()).filter(|name| !name.is_empty()), ..self }
    }

    /// Adds a detail of how the numbers are stored.
    pub(crate) fn detail(&mut self, detail: &str) {
        self.details.push_str(", ");
        self.details.push_str(detail);
    }

    /// Adds a remark for people.
    pub(crate) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    /// Leaves the unit open where numbers are integers in a unit of length without a scale: a count need not
    /// be one of them.
    pub(crate) fn check_counts(&mut self, number: NumberType, scaled: bool) {
        if let (StoredUnit::Heights(unit), false, false) = (&self.unit, number.is_float(), scaled)
            && *unit != Unit::none()
        {
            let (integers, unit) = (number.name(), unit.clone());
            self.note(format!(
                "the file has {integers} in {unit} and no scale: a count need not be 1 {unit}, height_scale says what it is"
            ));
            self.unit = StoredUnit::Unknown;
        }
    }

    /// Sets the order of the axes; where the file does not state it, a note gives the reason.
    pub(crate) fn take_axes(&mut self, axes: FileAxes, why: &str) {
        self.axes = axes;
        if let FileAxes::Assumed(axes) = axes {
            let (taken, other) = match axes {
                Axes::Xy => ("x", Axes::Yx.word()),
                Axes::Yx => ("y", Axes::Xy.word()),
            };
            self.note(format!("{TAKEN} {taken} ({why}); axes = \"{other}\" takes the other"));
        }
    }

    /// Puts the axes in the requested order.
    ///
    /// # Errors
    /// [`ContentError::Useless`] where the format has one order, [`ContentError::Contradiction`] where the
    /// file names another.
    pub(crate) fn orient(&mut self, declared: Axes) -> Result<(), ContentError> {
        // Who says it need not be told.
        self.notes.retain(|note| !note.starts_with(TAKEN));
        match self.axes {
            FileAxes::Said(axes) | FileAxes::Assumed(axes) if axes == declared => {}
            FileAxes::Assumed(_) => self.transpose(),
            FileAxes::Said(axes) => {
                let (first, second) = (format!("{} in the file", axes.word()), declared.word().to_owned());
                return Err(ContentError::Contradiction { what: "axes", first, second });
            }
            FileAxes::Fixed => {
                let reason = "the format has one order of axes; mirror and rotate turn a map";
                return Err(ContentError::Useless { what: "axes", reason });
            }
        }
        Ok(())
    }

    /// Exchanges x and y of the heights; sides are those of x and y already.
    fn transpose(&mut self) {
        let (rows, columns) = (self.rows, self.columns);
        self.heights = match std::mem::replace(&mut self.heights, StoredHeights::Read(Vec::new())) {
            StoredHeights::Raw(raw) => {
                let order = raw.order.other();
                self.details = self.details.replace(raw.order.words(), order.words());
                StoredHeights::Raw(RawHeights { order, reversed: [raw.reversed[1], raw.reversed[0]], ..raw })
            }
            StoredHeights::Deferred(read) => {
                self.details += ", transposed";
                StoredHeights::Deferred(Box::new(move |source| {
                    let heights = read(source)?;
                    let mut turned = undefined_heights(source, columns, rows)?;
                    for (i, height) in heights.into_iter().enumerate() {
                        turned[i % columns * rows + i / columns] = height;
                    }
                    Ok(turned)
                }))
            }
            other => other,
        };
        (self.rows, self.columns) = (columns, rows);
    }

    /// Escapes the control characters of all that is the file's own text: what is shown is what a channel is
    /// chosen by.
    pub(crate) fn escape(&mut self) {
        let Self { name, details, unit, notes, .. } = self;
        let unit = if let StoredUnit::NoHeights(unit) = unit { unit.as_mut() } else { None };
        for text in [name.as_mut(), Some(details), unit].into_iter().flatten().chain(notes) {
            *text = escaped(text);
        }
    }

    /// The heights, row-major, NaN where undefined.
    pub(crate) fn read(&mut self, source: &mut OpenedFile<'_>) -> Result<Vec<f64>> {
        let heights = match &mut self.heights {
            StoredHeights::Read(heights) => std::mem::take(heights),
            StoredHeights::Raw(raw) => raw.read(source, self.rows, self.columns)?,
            StoredHeights::Deferred(read) => read(source)?,
            StoredHeights::Unread(problem) => return Err(source.content(problem.clone())),
        };
        if heights.len() != self.rows * self.columns {
            let (rows, columns) = (self.rows as u64, self.columns as u64);
            let expected = 8 * u128::from(rows) * u128::from(columns);
            let problem = ContentError::Length { rows, columns, expected, found: 8 * heights.len() as u64 };
            return Err(source.content(problem));
        }
        Ok(heights)
    }

    /// Name and size in one line, for lists.
    pub(crate) fn line(&self, number: usize) -> String {
        let name = self.name.as_deref().unwrap_or("without a name");
        if let StoredHeights::Unread(problem) = &self.heights {
            return format!("{number} {name} (not read: {problem})");
        }
        let unit = match &self.unit {
            StoredUnit::Unknown => "unit unknown".to_owned(),
            StoredUnit::Heights(unit) => format!("heights in {unit}"),
            StoredUnit::NoHeights(Some(unit)) => format!("no heights: {unit}"),
            StoredUnit::NoHeights(None) => "no heights".to_owned(),
        };
        format!("{number} {name} ({} x {}, {unit})", self.columns, self.rows)
    }
}

/// The requested channel, or else the only one that can be heights.
///
/// # Errors
/// [`ContentError::Channel`] with all channels.
pub(crate) fn chosen(
    channels: &[StoredChannel],
    choice: Option<&ChannelChoice>,
) -> Result<usize, ContentError> {
    let matching: Vec<usize> = (0..channels.len())
        .filter(|&i| match choice {
            Some(ChannelChoice::Number(number)) => i == *number,
            Some(ChannelChoice::Name(name)) => channels[i].name.as_ref() == Some(name),
            None => !matches!(channels[i].unit, StoredUnit::NoHeights(_)),
        })
        .collect();
    if let [one] = matching[..] {
        return Ok(one);
    }
    if let (None, [one], []) = (choice, channels, &matching[..]) {
        return Err(ContentError::no_heights(one.line(0), &one.notes));
    }
    let list: Vec<String> = channels.iter().enumerate().map(|(i, c)| c.line(i)).collect();
    Err(ContentError::Channel {
        choice: choice.map(ToString::to_string),
        matching: matching.len(),
        list: list.join(", "),
    })
}

/// Largest number of channels in one file; files of probe microscopes have dozens at most.
pub(crate) const MOST_CHANNELS: usize = 256;

/// An error where a header lists more channels than files have: each takes more memory than its line in the
/// header.
pub(crate) fn check_number(source: &OpenedFile<'_>, offset: u64, channels: usize) -> Result<()> {
    if channels <= MOST_CHANNELS {
        return Ok(());
    }
    Err(source.wrong(offset, format!("at most {MOST_CHANNELS} channels, found {channels}")))
}

/// An error where a line of numbers or more stands behind the last numbers that a header lists: its counts or
/// its type are not those of the file. A few bytes are a note.
pub(crate) fn check_rest(
    channels: &mut [StoredChannel],
    source: &OpenedFile<'_>,
    end: u64,
    line: usize,
) -> Result<()> {
    let rest = source.length().saturating_sub(end);
    if rest >= line.max(1) as u64 {
        let expected =
            format!("the end of the file behind all numbers that the header lists, found {rest} bytes");
        return Err(source.wrong(end, expected));
    }
    if rest > 0 {
        for channel in channels {
            channel.note(format!("{rest} bytes behind the last numbers are not read"));
        }
    }
    Ok(())
}

/// Heights have a length or no unit at all.
pub(crate) fn check_unit(what: &'static str, unit: Option<&Unit>) -> Result<(), ContentError> {
    match unit.map(|u| (u, u.dimension())) {
        None | Some((_, Dimension::LENGTH)) => Ok(()),
        // "%" would be a factor without a meaning here.
        Some((u, Dimension::NONE)) if *u == Unit::none() => Ok(()),
        Some((u, found)) => {
            let source = QuantityError::Dimension { text: u.to_string(), found, expected: Dimension::LENGTH };
            Err(ContentError::Quantity { what, source })
        }
    }
}
