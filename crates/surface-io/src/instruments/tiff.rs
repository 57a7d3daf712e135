//! TIFF with one number per pixel: each grey image of 16 bits or more, integers or floats, is a channel.
//!
//! Sources: TIFF 6.0 with its supplements (tags), for the description and the resolution
//! `ij/io/FileOpener.java` and `FileSaver.java` of
//! <https://github.com/imagej/ImageJ>.
//!
//! - **Unit and scale.** TIFF states neither, so [`crate::ReadOptions::height_scale`] or a unit is required,
//!   unless ImageJ's description has them (`cf=0` with `c0` and `c1` makes values `c0 + c1 * number`, `vunit`
//!   is their unit; another `cf` makes them no heights), or GDAL's metadata (`scale`, `offset`, `unittype`).
//! - **Size.** By ImageJ's `unit` (and `yunit`), pixels per unit in the tags of the resolution. Resolutions
//!   per inch, and those without that description, are those of print or screens.
//! - **Order.** The first row is the top one and y = 0; the orientations 2, 3 and 4 are turned, 5 to 8 are
//!   refused.
//! - **Undefined points.** NaN, what GDAL's tag of no data says, and points that a mask page leaves out.
//! - **Passed** are images of less resolution (`NewSubfileType` 1), which are listed as no heights.
//!
//! Pictures of 8 bits or in colours, and those where white is zero, are refused. Read are uncompressed data,
//! LZW, Deflate and `PackBits` in strips and tiles. Of OME's description the physical size of a pixel counts
//! (<https://docs.openmicroscopy.org/ome-model>).
//!
//! Files of Park Systems (one map in private tags) and JPK (private tags of each image) have descriptions of
//! their own.

mod directory;
mod gdal;
mod jpk;
mod lext;
mod mask;
mod park;

use super::prelude::*;
use crate::array::{Array, ArrayDimension as Along, Numbers};
use crate::channel::{FileAxes, undefined_heights};
use crate::error::{ContentError, Error, Place};
use crate::inflate::RATIO;
use crate::number_type::exact;
use crate::quantity::{Dimension, Quantity, Unit};
use directory::{Directories, MOST};
use gdal::Gdal;
use jpk::Jpk;
use lext::Lext;
use mask::Mask;
use quick_xml::events::Event;
use std::collections::HashMap;
use std::io::{Read, Seek};
use tiff::decoder::ifd::Value;
use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError, TiffResult};

/// Bits of `NewSubfileType`: an image of less resolution, a mask.
const REDUCED: u32 = 1;
const MASK: u32 = 4;
/// Longest description of an image but the first: its name.
const NAME: usize = 64;
/// Longest text or list in a directory, in bytes.
const LONGEST: usize = 1 << 20;

pub(crate) const READER: Reader =
    Reader { format: Format::Tiff, recognises: super::magic::is_tiff, channels };

/// A decoder that stands at the first image.
fn open(source: &mut OpenedFile<'_>) -> Result<Decoder<impl Read + Seek>> {
    let length = source.length();
    let mut limits = Limits::default();
    limits.decoding_buffer_size = usize::try_from(RATIO.saturating_mul(length)).unwrap_or(usize::MAX);
    limits.intermediate_buffer_size = length as usize;
    limits.ifd_value_size = LONGEST.min(length as usize);
    let path = source.path().to_owned();
    let decoder = Decoder::new(source.whole()?).map_err(|e| Error::content(&path)(unreadable(&e)))?;
    Ok(decoder.with_limits(limits))
}

/// What the other crate says about the file.
fn unreadable(said: &dyn std::fmt::Display) -> ContentError {
    let said: String = said.to_string().chars().take(200).collect();
    let expected = format!("a file as its specification has it ({said})");
    ContentError::Binary { format: Format::Tiff, offset: 0, expected }
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let tags = Directories::read(source)?;
    if let Some(channel) = park::channel(source, &tags)? {
        return Ok(vec![channel]);
    }
    let path = source.path().to_owned();
    let mut pages = Vec::new();
    let mut decoder = open(source)?;
    loop {
        let mut page =
            Page::of(&mut decoder, pages.len()).map_err(|e| Error::content(&path)(unreadable(&e)))?;
        if !pages.is_empty() {
            // All images may share one long text, and of others than the first only names are looked at.
            page.description = page.description.filter(|text| text.len() <= NAME);
        }
        pages.push(page);
        if !decoder.more_images() || pages.len() == MOST {
            break;
        }
        decoder.next_image().map_err(|e| Error::content(&path)(unreadable(&e)))?;
    }
    drop(decoder);
    // ImageJ describes a stack in its first image.
    let text = pages.first().and_then(|page| page.description.as_deref());
    let first = First {
        image_j: ImageJ::of(text),
        microscope: text.map_or([None; 2], of_microscope),
        lext: Lext::of(text),
        alone: pages.iter().filter(|page| page.subfile & MASK == 0).count() == 1,
    };
    let mut channels = Vec::new();
    let masked: Vec<bool> = pages.iter().skip(1).map(|page| page.subfile & MASK > 0).collect();
    for page in pages {
        if page.bits.is_none() || page.subfile & MASK > 0 {
            continue;
        }
        let jpk = Jpk::of(source, &tags, page.number)?;
        let shape = [page.size.1 as usize, page.size.0 as usize];
        let mask = masked.get(page.number).is_some_and(|&mask| mask);
        let mask = mask.then(|| Mask::of(source, &tags, page.number + 1, shape)).transpose()?;
        channels.extend(channel(source, page, &first, jpk, mask)?);
    }
    if channels.is_empty() {
        let what = "a TIFF picture of 8 bits, in colours or with white as zero";
        let remedy = "grey values are no heights; export the heights as TIFF of floats, as text or as NPY";
        return Err(source.content(ContentError::Foreign { what, remedy }));
    }
    Ok(channels)
}

/// What the directory of one image says.
struct Page {
    /// Number of the image, from 0.
    number: usize,
    size: (u32, u32),
    /// Bits of a grey number; `None` for pictures.
    bits: Option<u8>,
    sample_format: u16,
    orientation: u16,
    /// Pixels per unit along x and y, and the unit: 1 none, 2 inch, 3 cm.
    resolution: [Option<f64>; 2],
    resolution_unit: u16,
    description: Option<String>,
    /// What kind of image it is.
    subfile: u32,
    gdal: Gdal,
}

/// What the first image says of all.
struct First {
    image_j: Option<ImageJ>,
    microscope: [Option<Extent>; 2],
    lext: Option<Lext>,
    /// Whether there is no other image.
    alone: bool,
}

impl Page {
    fn of<R: Read + Seek>(decoder: &mut Decoder<R>, number: usize) -> TiffResult<Self> {
        let size = decoder.dimensions()?;
        let short = |decoder: &mut Decoder<R>, tag, absent| {
            decoder.find_tag_unsigned(tag).map(|found| found.unwrap_or(absent))
        };
        let black_is_zero = short(decoder, Tag::PhotometricInterpretation, 1)? == 1;
        let bits = match decoder.colortype() {
            Ok(ColorType::Gray(bits @ (16 | 32 | 64))) if black_is_zero => Some(bits),
            _ => None,
        };
        let ratio = |decoder: &mut Decoder<R>, tag| {
            decoder.find_tag(tag).map(|found| match found {
                Some(Value::Rational(a, b)) if a > 0 && b > 0 => Some(f64::from(a) / f64::from(b)),
                _ => None,
            })
        };
        let sample_format = match decoder.find_tag_unsigned_vec(Tag::SampleFormat)? {
            Some(formats) => formats.first().copied().unwrap_or(1),
            None => 1,
        };
        let description = match decoder.find_tag(Tag::ImageDescription)? {
            Some(Value::Ascii(text)) => Some(text),
            _ => None,
        };
        Ok(Self {
            gdal: Gdal::of(decoder)?,
            subfile: decoder.find_tag_unsigned(Tag::NewSubfileType)?.unwrap_or(0),
            number,
            size,
            bits,
            sample_format,
            orientation: short(decoder, Tag::Orientation, 1)?,
            resolution: [ratio(decoder, Tag::XResolution)?, ratio(decoder, Tag::YResolution)?],
            resolution_unit: short(decoder, Tag::ResolutionUnit, 2)?,
            description,
        })
    }

    /// Whether the first number along x, along y is that of the last column, the last row.
    fn reversed(&self, source: &OpenedFile<'_>) -> Result<[bool; 2]> {
        match self.orientation {
            1 => Ok([false, false]),
            2 => Ok([true, false]),
            3 => Ok([true, true]),
            4 => Ok([false, true]),
            other => {
                let expected = format!("an orientation of 1 to 4 in image {}, found {other}", self.number);
                Err(source.wrong(0, expected))
            }
        }
    }

    /// Refuses more numbers than can be packed in the file.
    fn check_size(&self, source: &OpenedFile<'_>, bits: u8) -> Result<()> {
        let (columns, rows) = self.size;
        let claimed = u128::from(rows) * u128::from(columns) * u128::from(bits / 8);
        if claimed > u128::from(RATIO.saturating_mul(source.length())) {
            let expected = format!("{columns} x {rows} numbers in {} bytes (cut short?)", source.length());
            return Err(source.wrong(0, expected));
        }
        Ok(())
    }

    /// The type of the numbers. Byte order and packing are the other crate's; what it decodes has this type.
    fn number_type(&self, bits: u8) -> Option<NumberType> {
        let letter = match self.sample_format {
            2 => b'i',
            3 => b'f',
            _ => b'u',
        };
        NumberType::new(letter, bits / 8, true)
    }
}

/// The sides of a pixel by OME's description; without a unit they are micrometres.
fn of_microscope(description: &str) -> [Option<Extent>; 2] {
    let mut reader = quick_xml::Reader::from_str(description);
    loop {
        match reader.read_event() {
            Ok(Event::Start(element) | Event::Empty(element))
                if element.local_name().as_ref() == "Pixels" =>
            {
                let text = |name: String| {
                    let attribute = element.try_get_attribute(name.as_str()).ok()??;
                    Some(attribute.value.to_string())
                };
                return ["X", "Y"].map(|axis| {
                    let unit = text(format!("PhysicalSize{axis}Unit")).unwrap_or_else(|| "um".to_owned());
                    Extent::of_cell(text(format!("PhysicalSize{axis}"))?.parse().ok()?, &unit)
                });
            }
            Ok(Event::Eof) | Err(_) => return [None; 2],
            Ok(_) => {}
        }
    }
}

/// The lines `key=value` of ImageJ's description.
struct ImageJ(HashMap<String, String>);

impl ImageJ {
    fn of(description: Option<&str>) -> Option<Self> {
        let text = description?.strip_prefix("ImageJ=")?;
        let line = |line: &str| line.split_once('=').map(|(k, v)| (k.trim().to_owned(), v.trim().to_owned()));
        Some(Self(text.lines().skip(1).filter_map(line).collect()))
    }

    /// The length unit of a key; ImageJ escapes the micro sign and calls the micrometre micron.
    fn length(&self, key: &str) -> Option<Unit> {
        let text = self.0.get(key)?.replace("\\u00B5", "u");
        let text = if matches!(text.as_str(), "micron" | "microns") { "um" } else { &text };
        text.parse().ok().filter(|unit: &Unit| unit.dimension() == Dimension::LENGTH)
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.0.get(key)?.parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// Unit, scale and shift of the heights.
    fn heights(&self) -> (StoredUnit, Option<f64>, Option<f64>) {
        /// Numbers of ImageJ's calibrations.
        const STRAIGHT_LINE: f64 = 0.0;
        const NONE: f64 = 20.0;
        let is = |function: f64, known: f64| (function - known).abs() < 0.5;
        match (self.number("cf"), self.number("c0"), self.number("c1")) {
            (None, ..) => (StoredUnit::Unknown, None, None),
            (Some(function), ..) if is(function, NONE) => (StoredUnit::Unknown, None, None),
            (Some(function), Some(shift), Some(scale)) if is(function, STRAIGHT_LINE) => {
                let unit = match (self.length("vunit"), self.0.get("vunit").map(String::as_str)) {
                    (Some(unit), _) => StoredUnit::Heights(unit),
                    // Signed numbers, which ImageJ holds as unsigned ones.
                    (None, None | Some("" | "Gray Value")) => StoredUnit::Unknown,
                    (None, Some(other)) => StoredUnit::NoHeights(Some(other.chars().take(32).collect())),
                };
                (unit, Some(scale), Some(shift))
            }
            _ => (StoredUnit::NoHeights(Some("a calibration that is no straight line".into())), None, None),
        }
    }

    fn extent(&self, resolution: &[Option<f64>; 2], resolution_unit: u16) -> [Option<Extent>; 2] {
        let x = self.length("unit");
        let y = if self.0.contains_key("yunit") { self.length("yunit") } else { x.clone() };
        let cell = |unit: Option<Unit>, per_unit: Option<f64>| {
            let (unit, per_unit) = (unit?, per_unit?);
            let unit = match resolution_unit {
                1 => unit,
                3 => "cm".parse().ok()?,
                _ => return None,
            };
            Quantity::of(1.0 / per_unit, &unit).ok().filter(|q| q.value() > 0.0).map(Extent::Cell)
        };
        [cell(x, resolution[0]), cell(y, resolution[1])]
    }
}

/// The channel of an image; `None` where its numbers have no type of this crate.
fn channel(
    source: &OpenedFile<'_>,
    mut page: Page,
    first: &First,
    jpk: Option<Jpk>,
    mask: Option<Mask>,
) -> Result<Option<StoredChannel>> {
    let Page { number, size, .. } = page;
    let Some(bits) = page.bits else { return Ok(None) };
    let reversed = page.reversed(source)?;
    page.check_size(source, bits)?;
    let Some(kind) = page.number_type(bits) else { return Ok(None) };
    let gdal = std::mem::take(&mut page.gdal);
    if let Some(expected) = gdal.wrong {
        return Err(source.wrong(0, format!("{expected} in image {number}")));
    }
    let (columns, rows) = size;
    let dimensions = [rows, columns].map(|count| Along::of_length(count as usize));
    let name = if first.alone { String::new() } else { format!("image {number}") };
    let mut array = Array {
        reversed,
        undefined: gdal.missing.map_or(Undefined::None, Undefined::Equal),
        notes: gdal.notes,
        scale: gdal.scale,
        shift: gdal.shift,
        extent: gdal.extent,
        unit: StoredUnit::written(gdal.unit.as_deref().unwrap_or_default()),
        ..Array::new(&name, dimensions, kind, (FileAxes::Fixed, ""))
    };
    take_description(source, &mut array, &page, first, jpk)?;
    if page.subfile & REDUCED > 0 {
        array.unit = StoredUnit::NoHeights(Some("an image of less resolution".into()));
    }
    let details = format!("{}, row by row{}", kind.name(), if mask.is_some() { ", with a mask" } else { "" });
    let image = TiffImage { number, size, bytes: u64::from(bits / 8), mask };
    let numbers = Numbers::Decoded("", Box::new(move |raw, source| image.read(raw, source)));
    // Byte order and packing are not those of the file any more.
    Ok(Some(StoredChannel { details, ..array.channel(source, numbers)? }))
}

/// Takes what the program that wrote the image says of it, instead of what GDAL says: JPK's, Olympus's or
/// ImageJ. The sides of a pixel by OME count where nothing else says them.
fn take_description(
    source: &OpenedFile<'_>,
    array: &mut Array,
    page: &Page,
    first: &First,
    jpk: Option<Jpk>,
) -> Result<()> {
    let description = page.description.as_deref().unwrap_or_default().trim();
    if let Some(jpk) = jpk {
        // The first row is the bottom of JPK's image.
        array.reversed[1] ^= !jpk.reflected;
        (array.name, array.unit, array.extent) = (jpk.name, jpk.unit, jpk.extent);
        (array.scale, array.shift) = (Some(jpk.scale), Some(jpk.shift));
    } else if let Some(lext) = &first.lext {
        description.clone_into(&mut array.name);
        (array.unit, array.scale, array.extent) = lext.image(description);
    } else if let Some(image_j) = &first.image_j {
        let (unit, scale, shift) = image_j.heights();
        if array.scale.is_some() && scale.is_some() {
            return Err(source.wrong(0, "one scale of the heights, found those of ImageJ and of GDAL"));
        }
        (array.scale, array.shift) = (array.scale.or(scale), array.shift.or(shift));
        if unit != StoredUnit::Unknown {
            array.unit = unit;
        }
        array.extent = image_j.extent(&page.resolution, page.resolution_unit);
    } else if array.extent == [None; 2] {
        array.extent = first.microscope;
    }
    Ok(())
}

/// What is needed to read one image.
struct TiffImage {
    number: usize,
    size: (u32, u32),
    /// Bytes of a number.
    bytes: u64,
    mask: Option<Mask>,
}

impl TiffImage {
    fn read(&self, raw: &RawHeights, source: &mut OpenedFile<'_>) -> Result<Vec<f64>> {
        let (columns, rows) = (self.size.0 as usize, self.size.1 as usize);
        let mut heights = undefined_heights(source, rows, columns)?;
        let path = source.path().to_owned();
        let most = RATIO.saturating_mul(source.length());
        let mut decoder = open(source)?;
        let read = self.chunks(raw, &mut decoder, most, &mut heights);
        read.map_err(Error::content(&path))?;
        drop(decoder);
        if let Some(mask) = &self.mask {
            mask.each(source, &mut |place| {
                let [row, column] = raw.place([rows, columns], place);
                heights[row * columns + column] = f64::NAN;
            })?;
        }
        Ok(heights)
    }

    fn chunks<R: Read + Seek>(
        &self,
        raw: &RawHeights,
        decoder: &mut Decoder<R>,
        most: u64,
        heights: &mut [f64],
    ) -> Result<(), ContentError> {
        let failed = |e: TiffError| unreadable(&e);
        decoder.seek_to_image(self.number).map_err(failed)?;
        let (columns, rows) = self.size;
        let [wide, tall]: [u32; 2] = match decoder.get_chunk_type() {
            ChunkType::Strip => {
                let rows_of_one = decoder.find_tag_unsigned::<u32>(Tag::RowsPerStrip).map_err(failed)?;
                [columns, rows_of_one.unwrap_or(rows).clamp(1, rows)]
            }
            ChunkType::Tile => [
                decoder.get_tag_unsigned(Tag::TileWidth).map_err(failed)?,
                decoder.get_tag_unsigned(Tag::TileLength).map_err(failed)?,
            ],
        };
        // All of them together: they may share their bytes, and reach far beyond the image.
        let across = |size: u32, of_one: u32| u128::from(size.div_ceil(of_one.max(1))) * u128::from(of_one);
        let all = across(columns, wide) * across(rows, tall);
        if all == 0 || all.checked_mul(self.bytes.into()).is_none_or(|bytes| bytes > most.into()) {
            return Err(unreadable(&format!("a strip or tile of {wide} x {tall} numbers")));
        }
        for (j, top) in (0..rows).step_by(tall as usize).enumerate() {
            for (i, left) in (0..columns).step_by(wide as usize).enumerate() {
                let number = j as u64 * u64::from(columns.div_ceil(wide)) + i as u64;
                let number = u32::try_from(number).map_err(|e| unreadable(&e))?;
                let decoded = decoder.read_chunk(number).map_err(failed)?;
                let (wide, tall) = (wide.min(columns - left) as usize, tall.min(rows - top) as usize);
                let to = [top as usize, left as usize];
                self.put(raw, &decoded, ([tall, wide], to), heights)?;
            }
        }
        Ok(())
    }

    /// Puts the numbers of a strip or tile, with its numbers of rows and columns, in their places.
    fn put(
        &self,
        raw: &RawHeights,
        decoded: &DecodingResult,
        ([tall, wide], [top, left]): ([usize; 2], [usize; 2]),
        heights: &mut [f64],
    ) -> Result<(), ContentError> {
        let shape = [self.size.1 as usize, self.size.0 as usize];
        for k in 0..tall * wide {
            let place = [top + k / wide, left + k % wide];
            let [row, column] = raw.place(shape, place);
            let inexact = |value| ContentError::Inexact { place: Place::Cell { row, column }, value };
            let number = match decoded {
                DecodingResult::U16(all) => all.get(k).map(|&n| f64::from(n)),
                DecodingResult::I16(all) => all.get(k).map(|&n| f64::from(n)),
                DecodingResult::U32(all) => all.get(k).map(|&n| f64::from(n)),
                DecodingResult::I32(all) => all.get(k).map(|&n| f64::from(n)),
                DecodingResult::U64(all) => {
                    all.get(k).map(|&n| exact(n.into())).transpose().map_err(inexact)?
                }
                DecodingResult::I64(all) => {
                    all.get(k).map(|&n| exact(n.into())).transpose().map_err(inexact)?
                }
                DecodingResult::F16(all) => all.get(k).map(|&n| f64::from(n)),
                DecodingResult::F32(all) => all.get(k).map(|&n| f64::from(n)),
                DecodingResult::F64(all) => all.get(k).copied(),
                DecodingResult::U8(_) | DecodingResult::I8(_) => None,
            };
            let number =
                number.ok_or_else(|| unreadable(&format!("{tall} x {wide} numbers in a strip or tile")))?;
            raw.put_number(heights, shape, place, number);
        }
        Ok(())
    }
}
