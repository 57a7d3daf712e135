//! Mask pages (TIFF 6.0, `NewSubfileType` with bit 2, as GDAL writes them): one number of 1 or 8 bits per
//! pixel of the image before, 0 where that has no height. The crate tiff reads no such pages.

use super::directory::Directories;
use crate::error::Result;
use crate::inflate::RATIO;
use crate::source::OpenedFile;
use flate2::read::ZlibDecoder;
use std::io::Read as _;

const COMPRESSION: u16 = 259;
const BITS: u16 = 258;
/// Offsets, lengths, rows and columns of strips, and of tiles.
const STRIPS: [u16; 3] = [273, 279, 278];
const TILES: [u16; 4] = [324, 325, 323, 322];

/// Where a mask is.
pub(super) struct Mask {
    bits: usize,
    packed: bool,
    /// Offset and length of each strip or tile, row by row.
    pieces: Vec<(u64, u64)>,
    /// Rows and columns of one of them.
    tall: usize,
    wide: usize,
    columns: usize,
    rows: usize,
}

impl Mask {
    /// The mask in an image of this shape.
    ///
    /// # Errors
    /// Where it cannot be read: points without a height would be heights.
    pub(super) fn of(
        source: &mut OpenedFile<'_>,
        tags: &Directories,
        image: usize,
        [rows, columns]: [usize; 2],
    ) -> Result<Self> {
        let mut number = |tag| tags.number(source, image, tag);
        let (bits, compression) =
            (number(BITS)?.unwrap_or(1.0) as usize, number(COMPRESSION)?.unwrap_or(1.0));
        let tiles = number(TILES[0])?.is_some();
        let (tall, wide) = if tiles {
            (number(TILES[2])?.unwrap_or(0.0) as usize, number(TILES[3])?.unwrap_or(0.0) as usize)
        } else {
            (number(STRIPS[2])?.unwrap_or(f64::MAX).min(rows as f64) as usize, columns)
        };
        let compression = compression as u32;
        if !matches!((bits, compression), (1 | 8, 1 | 8 | 32946)) {
            let expected = format!(
                "a mask in image {image} of 1 or 8 bits, plain or packed by Deflate; found {bits} bits and compression {compression}"
            );
            return Err(source.wrong(0, expected));
        }
        let [offsets, lengths] = if tiles { [TILES[0], TILES[1]] } else { [STRIPS[0], STRIPS[1]] };
        let [offsets, lengths] = [tags.whole(source, image, offsets)?, tags.whole(source, image, lengths)?];
        let pieces: Vec<(u64, u64)> = offsets.into_iter().zip(lengths).collect();
        let mask = Self { bits, packed: compression != 1, pieces, tall, wide, columns, rows };
        let count = tall > 0 && wide > 0 && mask.across() * rows.div_ceil(tall) == mask.pieces.len();
        let claimed = (mask.pieces.len() as u64).checked_mul(mask.bytes() as u64);
        if count && claimed.is_some_and(|claimed| claimed <= RATIO.saturating_mul(source.length())) {
            return Ok(mask);
        }
        let found = mask.pieces.len();
        Err(source.wrong(0, format!("strips or tiles for all of the mask in image {image}, found {found}")))
    }

    /// Pieces side by side.
    fn across(&self) -> usize {
        self.columns.div_ceil(self.wide.max(1))
    }

    /// Bytes of a row of a piece.
    fn line(&self) -> usize {
        self.wide.saturating_mul(self.bits).div_ceil(8)
    }

    /// Bytes of a piece.
    fn bytes(&self) -> usize {
        self.line().saturating_mul(self.tall)
    }

    /// Calls for each point without a height with its row and column.
    pub(super) fn each(&self, source: &mut OpenedFile<'_>, take: &mut dyn FnMut([usize; 2])) -> Result<()> {
        for (i, &(offset, length)) in self.pieces.iter().enumerate() {
            let (top, left) = (i / self.across() * self.tall, i % self.across() * self.wide);
            let mut bytes = source.bytes(offset, length)?;
            if self.packed {
                let mut plain = Vec::new();
                let read = ZlibDecoder::new(&bytes[..]).take(self.bytes() as u64).read_to_end(&mut plain);
                read.map_err(|_| source.wrong(offset, "a mask packed by Deflate"))?;
                bytes = plain;
            }
            let (tall, wide) = (self.tall.min(self.rows - top), self.wide.min(self.columns - left));
            if bytes.len() < self.line() * tall {
                let expected = format!("{} bytes of a mask, found {}", self.line() * tall, bytes.len());
                return Err(source.wrong(offset, expected));
            }
            for row in 0..tall {
                for column in 0..wide {
                    let at = row * self.line();
                    let valid = match self.bits {
                        1 => bytes[at + column / 8] >> (7 - column % 8) & 1 == 1,
                        _ => bytes[at + column] != 0,
                    };
                    if !valid {
                        take([top + row, left + column]);
                    }
                }
            }
        }
        Ok(())
    }
}
