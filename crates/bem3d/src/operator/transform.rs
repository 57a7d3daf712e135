//! Transforms of fields on a window of the grid: real ones of their rows and complex ones of their columns.

use crate::geometry::{Lengths, Window};
use crate::real::Real;
use crate::tuning::{BAND, CACHE_LINE, SQUARE, STRIPE_BYTES};
use numerics::parallel::{for_each, threads_for};
use realfft::{ComplexToReal, RealToComplex};
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Planned transforms of N fields on a window, from rows to rows.
///
/// The fields lie one below the other: row y of field i is row `i * rows + y` ([`Transform::rows`]); each
/// begins a band of rows. The spectra of rows are kept in stripes of a few columns each, stripe by stripe: a row writes whole cache
/// lines, the columns of a stripe are transformed where it lies in the cache, and threads share rows and
/// stripes among them.
pub struct Transform<T: Real, const N: usize> {
    window: Window,
    lengths: Lengths,
    /// Rows of a field, and those from one field to the next.
    height: usize,
    field: usize,
    row_forward: Arc<dyn RealToComplex<T>>,
    row_inverse: Arc<dyn ComplexToReal<T>>,
    column_forward: Arc<dyn Fft<T>>,
    column_inverse: Arc<dyn Fft<T>>,
    /// Row spectra: of each stripe all rows, of each row the columns of the stripe; from `start` on (where a
    /// cache line begins).
    spectrum: Vec<Complex<T>>,
    start: usize,
    /// Which bands of rows were given last.
    given: Vec<bool>,
    buffers: Vec<Buffers<T>>,
}

/// Buffers of one thread.
struct Buffers<T: Real> {
    row: Vec<T>,
    line: Vec<Complex<T>>,
    /// Columns that share cache lines, one after the other.
    columns: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
}

impl<T: Real, const N: usize> fmt::Debug for Transform<T, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Transform<{}, {N}>({:?}, {:?})", T::NAME, self.window, self.lengths)
    }
}

impl<T: Real, const N: usize> Transform<T, N> {
    /// Columns of a stripe.
    const STRIPE: usize = STRIPE_BYTES / size_of::<Complex<T>>();
    /// Columns of one cache line: they are read and written together.
    const TOGETHER: usize = CACHE_LINE / size_of::<Complex<T>>();

    /// Plans for a window.
    ///
    /// Memory: `N * height * (lx / 2 + 1)` complex numbers, and a few columns for each thread.
    pub fn new(window: Window, lengths: Lengths) -> Self {
        let stripes = (lengths.x / 2 + 1).div_ceil(Self::STRIPE);
        let field = if N == 1 { window.height } else { window.height.next_multiple_of(BAND) };
        let rows = N * field;
        let spectrum = vec![Complex::default(); stripes * Self::STRIPE * rows + Self::TOGETHER];
        let start = spectrum.as_ptr().align_offset(CACHE_LINE);
        Self {
            window,
            lengths,
            height: window.height,
            field,
            row_forward: T::real_forward(lengths.x),
            row_inverse: T::real_inverse(lengths.x),
            column_forward: T::forward(lengths.y),
            column_inverse: T::inverse(lengths.y),
            spectrum,
            start: if start <= Self::TOGETHER { start } else { 0 },
            given: vec![false; rows.div_ceil(BAND)],
            buffers: Vec::new(),
        }
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The circular lengths.
    pub fn lengths(&self) -> Lengths {
        self.lengths
    }

    /// The bands of rows of all fields, which threads share: first row of each.
    pub fn bands(&self) -> impl ExactSizeIterator<Item = usize> + Clone + use<T, N> {
        (0..self.given.len()).map(|band| band * BAND)
    }

    /// Rows from one field to the next: row y of field i is row `i * rows + y`.
    pub fn rows(&self) -> usize {
        self.field
    }

    /// Buffers for as many threads as the transform is worth.
    fn make_buffers(&mut self) {
        let zero = Complex::default();
        let Lengths { x, y } = self.lengths;
        let scratch = [
            self.row_forward.get_scratch_len(),
            self.row_inverse.get_scratch_len(),
            self.column_forward.get_inplace_scratch_len(),
            self.column_inverse.get_inplace_scratch_len(),
        ];
        let scratch = scratch.into_iter().max().unwrap_or(0);
        self.buffers.resize_with(threads_for(self.lengths.points()), || Buffers {
            row: vec![T::default(); x],
            line: vec![zero; x / 2 + 1],
            columns: vec![zero; N * Self::TOGETHER * Self::pitch(y)],
            scratch: vec![zero; scratch],
        });
    }

    /// Distance of columns that are transformed one after the other: at a multiple of a page they would share
    /// few lines of the cache.
    fn pitch(length: usize) -> usize {
        length + Self::TOGETHER
    }

    /// Transforms the rows of the fields: `fill` writes row y (given as zeros) where `given` says so.
    pub fn forward(&mut self, given: impl Fn(usize) -> bool + Sync, fill: impl Fn(usize, &mut [T]) + Sync) {
        self.make_buffers();
        let Self { window: Window { width, .. }, field, row_forward, buffers, .. } = self;
        let (width, height) = (*width, N * *field);
        for (band, any) in self.given.iter_mut().enumerate() {
            *any = (band * BAND..((band + 1) * BAND).min(height)).any(&given);
        }
        let mut bands: Vec<Vec<&mut [Complex<T>]>> = self.given.iter().map(|_| Vec::new()).collect();
        for stripe in self.spectrum[self.start..].chunks_exact_mut(Self::STRIPE * height) {
            for (band, piece) in bands.iter_mut().zip(stripe.chunks_mut(Self::STRIPE * BAND)) {
                band.push(piece);
            }
        }
        let known = &self.given;
        let bands: Vec<_> = bands.into_iter().enumerate().filter(|(band, _)| known[*band]).collect();
        for_each(buffers, bands.into_iter(), |buffer, (band, mut pieces)| {
            for (j, y) in (band * BAND..((band + 1) * BAND).min(height)).enumerate() {
                let at = j * Self::STRIPE;
                if !given(y) {
                    for piece in &mut pieces {
                        piece[at..at + Self::STRIPE].fill(Complex::default());
                    }
                    continue;
                }
                buffer.row.fill(T::default());
                fill(y, &mut buffer.row[..width]);
                let Buffers { row, line, scratch, .. } = buffer;
                let done = row_forward.process_with_scratch(row, line, scratch);
                debug_assert!(done.is_ok());
                for (piece, values) in pieces.iter_mut().zip(line.chunks(Self::STRIPE)) {
                    piece[at..at + values.len()].copy_from_slice(values);
                }
            }
        });
    }

    /// Changes the spectra: a transform of each column forward and back, between them `act` on the columns of all
    /// fields at wave kx. Only the bands of rows `wanted` are right afterwards.
    ///
    /// Cost: O(N lx ly log) with [`Self::forward`] and [`Self::backward`]; rows of zeros are not transformed.
    pub fn change(
        &mut self,
        wanted: impl Fn(usize) -> bool,
        act: impl Fn(usize, [&mut [Complex<T>]; N]) + Sync,
    ) {
        let Self { height, field, lengths, column_forward, column_inverse, buffers, .. } = self;
        let (height, field) = (*height, *field);
        let bands = self.given.len() / N;
        let rows = |i: usize, has: &dyn Fn(usize) -> bool| -> Vec<Range<usize>> {
            let runs = runs(bands, |band| has(i * bands + band));
            runs.into_iter().map(|bands| bands.start * BAND..(bands.end * BAND).min(height)).collect()
        };
        let given = |band: usize| self.given[band];
        let any = |band: usize| (band * BAND..((band + 1) * BAND).min(N * field)).any(&wanted);
        let sources: [_; N] = std::array::from_fn(|i| rows(i, &given));
        let targets: [_; N] = std::array::from_fn(|i| rows(i, &any));
        let (pitch, waves) = (Self::pitch(lengths.y), lengths.x / 2 + 1);
        let stripes = self.spectrum[self.start..].chunks_exact_mut(Self::STRIPE * N * field);
        for_each(buffers, stripes.enumerate(), |buffer, (number, stripe)| {
            let Buffers { columns, scratch, .. } = buffer;
            let each = Self::TOGETHER * pitch;
            for first in (0..Self::STRIPE).step_by(Self::TOGETHER) {
                let kx = number * Self::STRIPE + first;
                if kx >= waves {
                    break;
                }
                let fields = columns.chunks_exact_mut(each).zip(stripe.chunks_exact(Self::STRIPE * field));
                for ((columns, stripe), sources) in fields.zip(&sources) {
                    let mut end = 0;
                    for rows in sources {
                        clear(columns, pitch, end..rows.start);
                        to_columns::<T>(stripe, Self::STRIPE, first, rows.clone(), columns, pitch);
                        end = rows.end;
                    }
                    clear(columns, pitch, end..lengths.y);
                }
                for k in 0..Self::TOGETHER.min(waves - kx) {
                    let mut fields = columns.chunks_exact_mut(each);
                    let mut fields: [&mut [Complex<T>]; N] = std::array::from_fn(|_| {
                        fields.next().map_or(&mut [][..], |columns| &mut columns[k * pitch..][..lengths.y])
                    });
                    for column in &mut fields {
                        column_forward.process_with_scratch(column, scratch);
                    }
                    act(kx + k, fields.each_mut().map(|column| &mut **column));
                    for column in &mut fields {
                        column_inverse.process_with_scratch(column, scratch);
                    }
                }
                let fields = columns.chunks_exact(each).zip(stripe.chunks_exact_mut(Self::STRIPE * field));
                for ((columns, stripe), targets) in fields.zip(&targets) {
                    for rows in targets {
                        to_rows::<T>(columns, pitch, stripe, Self::STRIPE, first, rows.clone());
                    }
                }
            }
        });
    }

    /// Transforms rows back: `take` reads row y where it is `wanted`, and may write over it. Each band of rows
    /// has its own output, of those given in order.
    pub fn backward<O: Send>(
        &mut self,
        wanted: impl Fn(usize) -> bool + Sync,
        outputs: impl ExactSizeIterator<Item = O> + Send,
        take: impl Fn(&mut O, usize, &mut [T]) + Sync,
    ) {
        let Self { window: Window { width, .. }, field, lengths, row_inverse, buffers, .. } = self;
        let (width, height, half) = (*width, N * *field, lengths.x / 2 + 1);
        let even = lengths.x.is_multiple_of(2);
        let spectrum = &self.spectrum[self.start..];
        for_each(buffers, outputs.enumerate(), |buffer, (band, mut output)| {
            let Buffers { row, line, scratch, .. } = buffer;
            for y in (band * BAND..((band + 1) * BAND).min(height)).filter(|&y| wanted(y)) {
                let stripes = spectrum.chunks_exact(Self::STRIPE * height);
                for (values, stripe) in line.chunks_mut(Self::STRIPE).zip(stripes) {
                    values.copy_from_slice(&stripe[y * Self::STRIPE..][..values.len()]);
                }
                // The spectrum of a real row has real ends; rounding may say otherwise and the plan would
                // complain.
                line[0].im = T::default();
                if even {
                    line[half - 1].im = T::default();
                }
                let done = row_inverse.process_with_scratch(line, row, scratch);
                debug_assert!(done.is_ok());
                take(&mut output, y, &mut row[..width]);
            }
        });
    }
}

/// Clears the same rows of each column.
fn clear<T: Real>(columns: &mut [Complex<T>], pitch: usize, rows: Range<usize>) {
    for column in columns.chunks_exact_mut(pitch) {
        column[rows.clone()].fill(Complex::default());
    }
}

/// Runs of consecutive numbers below `count` that have a property.
fn runs(count: usize, has: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for i in (0..count).filter(|&i| has(i)) {
        match runs.last_mut() {
            Some(run) if run.end == i => run.end += 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}

/// Reads columns from `first` on out of some rows of a stripe, square by square:
/// `columns[i * pitch + y] = stripe[y * width + first + i]`.
fn to_columns<T: Real>(
    stripe: &[Complex<T>],
    width: usize,
    first: usize,
    rows: Range<usize>,
    columns: &mut [Complex<T>],
    pitch: usize,
) {
    let count = columns.len() / pitch;
    let squares = rows.start..rows.end - rows.len() % SQUARE;
    for y in squares.clone().step_by(SQUARE) {
        let lines: [&[Complex<T>]; SQUARE] =
            std::array::from_fn(|j| &stripe[(y + j) * width + first..][..count]);
        for (i, column) in columns.chunks_exact_mut(pitch).enumerate() {
            column[y..y + SQUARE].copy_from_slice(&lines.map(|line| line[i]));
        }
    }
    for y in squares.end..rows.end {
        let line = &stripe[y * width + first..][..count];
        for (column, &value) in columns.chunks_exact_mut(pitch).zip(line) {
            column[y] = value;
        }
    }
}

/// Writes columns back to some rows of a stripe: the inverse of [`to_columns`].
fn to_rows<T: Real>(
    columns: &[Complex<T>],
    pitch: usize,
    stripe: &mut [Complex<T>],
    width: usize,
    first: usize,
    rows: Range<usize>,
) {
    let count = columns.len() / pitch;
    let squares = rows.start..rows.end - rows.len() % SQUARE;
    for y in squares.clone().step_by(SQUARE) {
        for i in (0..count).step_by(SQUARE) {
            let square: [&[Complex<T>]; SQUARE] =
                std::array::from_fn(|k| &columns[(i + k) * pitch + y..][..SQUARE]);
            for j in 0..SQUARE {
                let line = &mut stripe[(y + j) * width + first + i..][..SQUARE];
                line.copy_from_slice(&square.map(|column| column[j]));
            }
        }
    }
    for y in squares.end..rows.end {
        let line = &mut stripe[y * width + first..][..count];
        for (value, column) in line.iter_mut().zip(columns.chunks_exact(pitch)) {
            *value = column[y];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_tiles() {
        assert_eq!(runs(7, |i| i != 2 && i != 3), [0..2, 4..7]);
        assert!(runs(3, |_| false).is_empty());
    }
}
