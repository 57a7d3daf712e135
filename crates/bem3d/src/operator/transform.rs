//! Transforms of fields on a window of the grid, along pairs of their rows and along their columns.
//!
//! Two real rows a and b are one complex row `z = a + i b`, whose transform contains those of both:
//! `A(k) = (Z(k) + Z*(-k)) / 2` and `B(k) = (Z(k) - Z*(-k)) / 2i`. They are separated when the spectra of
//! rows are stored, and combined when these are read: a complex transform of length n is as fast as a real
//! one, which is a complex one of half the length and a pass over its result.

use crate::geometry::{Lengths, Window};
use crate::real::Real;
use crate::tasks::for_each;
use crate::tuning::{BAND, CACHE_LINE, GROUP, GROUPED_BYTES, SQUARE, STRIPE_BYTES, WAVES};
use contact_model::{Interrupted, Stop};
use numerics::parallel::{threads_for, widest};
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::fmt;
use std::iter::zip;
use std::ops::{Deref, DerefMut, Range};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Numbers that begin at a cache line: the vector instructions of a transform are slower across two of them.
#[derive(Debug)]
struct Aligned<A> {
    values: Vec<A>,
    start: usize,
}

impl<A> Default for Aligned<A> {
    fn default() -> Self {
        Self { values: Vec::new(), start: 0 }
    }
}

impl<A: Clone + Default> Aligned<A> {
    fn new(length: usize) -> Self {
        let most = CACHE_LINE / size_of::<A>();
        let mut values = vec![A::default(); length + most];
        let start = values.as_ptr().align_offset(CACHE_LINE).min(most);
        values.truncate(start + length);
        Self { values, start }
    }
}

impl<A> Deref for Aligned<A> {
    type Target = [A];

    fn deref(&self) -> &[A] {
        &self.values[self.start..]
    }
}

impl<A> DerefMut for Aligned<A> {
    fn deref_mut(&mut self) -> &mut [A] {
        &mut self.values[self.start..]
    }
}

/// Room for the spectrum of one transform at a time, which lends it to the next: what lies in the cache is used
/// again.
#[derive(Debug)]
pub struct Room<T>(Arc<Mutex<Aligned<Complex<T>>>>);

impl<T> Default for Room<T> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

impl<T> Clone for Room<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: Real> Room<T> {
    fn place(&self) -> MutexGuard<'_, Aligned<Complex<T>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Room for at least this number of values, which are undefined.
    fn take(&self, length: usize) -> Aligned<Complex<T>> {
        let room = std::mem::take(&mut *self.place());
        if room.len() < length { Aligned::new(length) } else { room }
    }

    /// Gives room back.
    fn give(&self, room: Aligned<Complex<T>>) {
        let mut place = self.place();
        if place.len() < room.len() {
            *place = room;
        }
    }
}

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
    row_forward: Arc<dyn Fft<T>>,
    row_inverse: Arc<dyn Fft<T>>,
    column_forward: Arc<dyn Fft<T>>,
    column_inverse: Arc<dyn Fft<T>>,
    /// Row spectra while they are changed: of each stripe all rows, of each row the columns of the stripe.
    spectrum: Aligned<Complex<T>>,
    /// Their number, and where their room comes from.
    length: usize,
    room: Room<T>,
    /// The bands of rows that were given last.
    given: Vec<bool>,
    buffers: Vec<Buffers<T>>,
}

/// Buffers of one thread.
struct Buffers<T: Real> {
    /// Two rows, one after the other.
    rows: Aligned<T>,
    /// Both as one complex row.
    pair: Aligned<Complex<T>>,
    /// The spectra of a group of such pairs, each with its first value once more at the end.
    spectra: Vec<Aligned<Complex<T>>>,
    /// Columns that share cache lines, one after the other.
    columns: Aligned<Complex<T>>,
    scratch: Aligned<Complex<T>>,
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
    /// Memory: `N * height * (lx / 2 + 1)` complex numbers, of which one copy serves all transforms with the same
    /// room, and a few columns for each thread.
    pub fn new(window: Window, lengths: Lengths, room: &Room<T>) -> Self {
        let stripes = (lengths.x / 2 + 1).div_ceil(Self::STRIPE);
        let field = if N == 1 { window.height } else { window.height.next_multiple_of(BAND) };
        let rows = N * field;
        Self {
            window,
            lengths,
            height: window.height,
            field,
            row_forward: T::forward(lengths.x),
            row_inverse: T::inverse(lengths.x),
            column_forward: T::forward(lengths.y),
            column_inverse: T::inverse(lengths.y),
            spectrum: Aligned::default(),
            length: stripes * Self::STRIPE * rows,
            room: room.clone(),
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

    /// Buffers for as many threads as the size of the transform justifies.
    fn make_buffers(&mut self) {
        let Lengths { x, y } = self.lengths;
        let scratch = [
            self.row_forward.get_outofplace_scratch_len(),
            self.row_inverse.get_outofplace_scratch_len(),
            self.column_forward.get_inplace_scratch_len(),
            self.column_inverse.get_inplace_scratch_len(),
        ];
        let scratch = scratch.into_iter().max().unwrap_or(0);
        let pairs = if self.length * size_of::<Complex<T>>() < GROUPED_BYTES { 1 } else { GROUP };
        self.buffers.resize_with(threads_for(self.lengths.points()), || Buffers {
            rows: Aligned::new(2 * self.window.width),
            pair: Aligned::new(x),
            spectra: (0..pairs).map(|_| Aligned::new(x + 1)).collect(),
            columns: Aligned::new(N * Self::TOGETHER * Self::pitch(y)),
            scratch: Aligned::new(scratch),
        });
    }

    /// Distance of columns that are transformed one after the other: at a multiple of a page they would share
    /// few lines of the cache.
    fn pitch(length: usize) -> usize {
        length + Self::TOGETHER
    }

    /// Transforms the rows of the fields: `fill` writes row y, which is zero before, for all y with `given`.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop, which is asked between bands of rows.
    pub fn forward(
        &mut self,
        given: impl Fn(usize) -> bool + Sync,
        fill: impl Fn(usize, &mut [T]) + Sync,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        self.make_buffers();
        if self.spectrum.len() < self.length {
            self.spectrum = self.room.take(self.length);
        }
        let Self { window: Window { width, .. }, field, row_forward, buffers, .. } = self;
        let (width, height) = (*width, N * *field);
        for (band, any) in self.given.iter_mut().enumerate() {
            *any = (band * BAND..((band + 1) * BAND).min(height)).any(&given);
        }
        let mut bands: Vec<Vec<&mut [Complex<T>]>> = self.given.iter().map(|_| Vec::new()).collect();
        for stripe in self.spectrum[..self.length].chunks_exact_mut(Self::STRIPE * height) {
            for (band, piece) in bands.iter_mut().zip(stripe.chunks_mut(Self::STRIPE * BAND)) {
                band.push(piece);
            }
        }
        let known = &self.given;
        let bands: Vec<_> = bands.into_iter().enumerate().filter(|(band, _)| known[*band]).collect();
        for_each(buffers, bands.into_iter(), stop, |buffer, (band, mut pieces)| {
            let Buffers { rows, pair, spectra, scratch, .. } = buffer;
            let (first, length) = (band * BAND, pair.len());
            let mut numbers = Vec::with_capacity(BAND);
            for y in first..(first + BAND).min(height) {
                if given(y) {
                    numbers.push(y);
                } else {
                    for piece in &mut pieces {
                        piece[(y - first) * Self::STRIPE..][..Self::STRIPE].fill(Complex::default());
                    }
                }
            }
            for group in numbers.chunks(2 * spectra.len()) {
                let mut places = [[None; 2]; GROUP];
                for (numbers, (spectrum, place)) in zip(group.chunks(2), zip(&mut *spectra, &mut places)) {
                    rows.fill(T::default());
                    for (&y, row) in zip(numbers, rows.chunks_exact_mut(width)) {
                        fill(y, row);
                    }
                    let (a, b) = rows.split_at(width);
                    pair_up(a, b, pair);
                    row_forward.process_outofplace_with_scratch(pair, &mut spectrum[..length], scratch);
                    spectrum[length] = spectrum[0];
                    let at = |i: usize| Some((numbers.get(i)? - first) * Self::STRIPE);
                    *place = [at(0), at(1)];
                }
                let pairs = group.len().div_ceil(2);
                take_apart(&spectra[..pairs], &mut pieces, Self::STRIPE, &places[..pairs]);
            }
        })
    }

    /// Changes the spectra: a transform of each column forward and back, between them `act` on the columns of
    /// all fields at wave kx. Only the bands of rows in `wanted` are valid afterwards.
    ///
    /// Cost: O(N lx ly log) with [`Self::forward`] and [`Self::backward`]; rows of zeros are not transformed.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop, which is asked between stripes of columns.
    pub fn change(
        &mut self,
        wanted: impl Fn(usize) -> bool,
        act: impl Fn(usize, [&mut [Complex<T>]; N]) + Sync,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
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
        let stripes = self.spectrum[..self.length].chunks_exact_mut(Self::STRIPE * N * field);
        for_each(buffers, stripes.enumerate(), stop, |buffer, (number, stripe)| {
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
                        to_columns::<T>(&stripe[first..], Self::STRIPE, rows.clone(), columns, pitch);
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
                        to_rows::<T>(columns, pitch, &mut stripe[first..], Self::STRIPE, rows.clone());
                    }
                }
            }
        })
    }

    /// Transforms rows back: `take` reads row y where it is `wanted`, and may write over it. Each band of rows
    /// has its own output, of those given in order.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop, which is asked between bands of rows.
    pub fn backward<O: Send>(
        &mut self,
        wanted: impl Fn(usize) -> bool + Sync,
        outputs: impl ExactSizeIterator<Item = O> + Send,
        take: impl Fn(&mut O, usize, &mut [T]) + Sync,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Self { window: Window { width, .. }, field, row_inverse, buffers, .. } = self;
        let (width, height) = (*width, N * *field);
        let stripes: Vec<_> = self.spectrum[..self.length].chunks_exact(Self::STRIPE * height).collect();
        for_each(buffers, outputs.enumerate(), stop, |buffer, (band, mut output)| {
            let Buffers { rows, pair, spectra, scratch, .. } = buffer;
            let length = pair.len();
            let mut numbers = (band * BAND..((band + 1) * BAND).min(height)).filter(|&y| wanted(y));
            loop {
                let mut group = [[0; 2]; GROUP];
                let mut pairs = 0;
                while pairs < spectra.len()
                    && let Some(y) = numbers.next()
                {
                    // The last one may be alone: then it is both.
                    group[pairs] = [y, numbers.next().unwrap_or(y)];
                    pairs += 1;
                }
                if pairs == 0 {
                    break;
                }
                let places = group.map(|numbers| numbers.map(|y| y * Self::STRIPE));
                put_together(&stripes, Self::STRIPE, &places[..pairs], &mut spectra[..pairs]);
                for (&[y, other], spectrum) in zip(&group[..pairs], &mut *spectra) {
                    row_inverse.process_outofplace_with_scratch(&mut spectrum[..length], pair, scratch);
                    let (a, b) = rows.split_at_mut(width);
                    separate(pair, a, b);
                    take(&mut output, y, a);
                    if other != y {
                        take(&mut output, other, b);
                    }
                }
            }
        })?;
        self.room.give(std::mem::take(&mut self.spectrum));
        Ok(())
    }
}

/// Two real rows as a complex one, which is zero beyond them.
fn pair_up<T: Real>(a: &[T], b: &[T], pair: &mut [Complex<T>]) {
    widest(
        #[inline(always)]
        move || {
            let (values, beyond) = pair.split_at_mut(a.len());
            for (value, (&re, &im)) in zip(values, zip(a, b)) {
                *value = Complex { re, im };
            }
            beyond.fill(Complex::default());
        },
    );
}

/// The inverse of [`pair_up`], as far as both rows go.
fn separate<T: Real>(pair: &[Complex<T>], a: &mut [T], b: &mut [T]) {
    widest(
        #[inline(always)]
        move || {
            for (value, (a, b)) in zip(pair, zip(a, b)) {
                (*a, *b) = (value.re, value.im);
            }
        },
    );
}

/// Writes the spectra of pairs of real rows to their places in each stripe, from those of the complex rows that
/// both were, given on all waves and once more at the end on the first.
fn take_apart<T: Real>(
    spectra: &[Aligned<Complex<T>>],
    stripes: &mut [&mut [Complex<T>]],
    width: usize,
    places: &[[Option<usize>; 2]],
) {
    let Some(length) = spectra.first().map(|spectrum| spectrum.len() - 1) else { return };
    let waves = length / 2 + 1;
    let half = T::of(0.5);
    let of_a = move |own: Complex<T>, opposite: Complex<T>| {
        let (re, im) = (own.re + opposite.re, own.im - opposite.im);
        Complex { re: half * re, im: half * im }
    };
    let of_b = move |own: Complex<T>, opposite: Complex<T>| {
        let (re, im) = (own.im + opposite.im, opposite.re - own.re);
        Complex { re: half * re, im: half * im }
    };
    widest(
        #[inline(always)]
        move || {
            for (stripe, first) in zip(stripes, (0..waves).step_by(width)) {
                let end = (first + width).min(waves);
                for (spectrum, at) in zip(spectra, places) {
                    let (own, opposite) =
                        (&spectrum[first..end], &spectrum[length + 1 - end..=length - first]);
                    if let Some(at) = at[0] {
                        from_both(own, opposite, &mut stripe[at..][..own.len()], of_a);
                    }
                    if let Some(at) = at[1] {
                        from_both(own, opposite, &mut stripe[at..][..own.len()], of_b);
                    }
                }
            }
        },
    );
}

/// Writes `value` of each number of one list and of the number of another list at the same position from its
/// end.
#[expect(clippy::inline_always, reason = "a call would lose the instructions of its caller")]
#[inline(always)]
fn from_both<T: Real>(
    own: &[Complex<T>],
    opposite: &[Complex<T>],
    to: &mut [Complex<T>],
    value: impl Fn(Complex<T>, Complex<T>) -> Complex<T>,
) {
    let (own, own_rest) = own.as_chunks::<WAVES>();
    let (opposite_rest, opposite) = opposite.as_rchunks::<WAVES>();
    let (to, to_rest) = to.as_chunks_mut::<WAVES>();
    for (to, (own, opposite)) in zip(to, zip(own, opposite.iter().rev())) {
        let mut values = [Complex::default(); WAVES];
        for (to, (&own, &opposite)) in zip(&mut values, zip(own, opposite.iter().rev())) {
            *to = value(own, opposite);
        }
        *to = values;
    }
    for (to, (&own, &opposite)) in zip(to_rest, zip(own_rest, opposite_rest.iter().rev())) {
        *to = value(own, opposite);
    }
}

/// The inverse of [`take_apart`]: the spectra of complex rows from those of pairs of real ones at their places in
/// each stripe.
fn put_together<T: Real>(
    stripes: &[&[Complex<T>]],
    width: usize,
    places: &[[usize; 2]],
    spectra: &mut [Aligned<Complex<T>>],
) {
    let Some(length) = spectra.first().map(|spectrum| spectrum.len() - 1) else { return };
    let waves = length / 2 + 1;
    let all = &mut *spectra;
    widest(
        #[inline(always)]
        move || {
            for (stripe, first) in zip(stripes, (0..waves).step_by(width)) {
                for (spectrum, at) in zip(&mut *all, places) {
                    combine(stripe, *at, first, width, spectrum);
                }
            }
        },
    );
    // The spectrum of a real row has real ends; rounding may say otherwise.
    for (spectrum, at) in zip(spectra, places) {
        let end = |k: usize| {
            let [re, im] = at.map(|at| stripes[k / width][at + k % width].re);
            Complex { re, im }
        };
        spectrum[0] = end(0);
        if length.is_multiple_of(2) {
            spectrum[waves - 1] = end(waves - 1);
        }
    }
}

/// The part of [`put_together`] for one pair and the stripe of the waves from `first` on.
#[expect(clippy::inline_always, reason = "a call would lose the instructions of its caller")]
#[inline(always)]
fn combine<T: Real>(
    stripe: &[Complex<T>],
    at: [usize; 2],
    first: usize,
    width: usize,
    spectrum: &mut [Complex<T>],
) {
    let waves = (spectrum.len() - 1) / 2 + 1;
    let (own, opposite) = spectrum.split_at_mut(waves);
    let own = &mut own[first..(first + width).min(waves)];
    let (a, b) = (&stripe[at[0]..][..own.len()], &stripe[at[1]..][..own.len()]);
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<WAVES>(), b.as_chunks::<WAVES>());
    let end = opposite.len().saturating_sub(first);
    let (opposite_rest, opposite) = opposite[end.saturating_sub(own.len())..end].as_rchunks_mut::<WAVES>();
    let (own, own_rest) = own.as_chunks_mut::<WAVES>();
    for (own, (a, b)) in zip(own, zip(a, b)) {
        let mut values = [Complex::default(); WAVES];
        for (value, (a, b)) in zip(&mut values, zip(a, b)) {
            *value = Complex { re: a.re - b.im, im: a.im + b.re };
        }
        *own = values;
    }
    for (own, (a, b)) in zip(own_rest, zip(a_rest, b_rest)) {
        *own = Complex { re: a.re - b.im, im: a.im + b.re };
    }
    let left_out = a.len() - opposite.len();
    for (opposite, (a, b)) in zip(opposite.iter_mut().rev(), zip(a, b)) {
        let mut values = [Complex::default(); WAVES];
        for (value, (a, b)) in zip(values.iter_mut().rev(), zip(a, b)) {
            *value = Complex { re: a.re + b.im, im: b.re - a.im };
        }
        *opposite = values;
    }
    let (a, b) = (&a[a.len() - left_out..], &b[b.len() - left_out..]);
    let rest = zip(a.as_flattened().iter().chain(a_rest), b.as_flattened().iter().chain(b_rest));
    for (opposite, (a, b)) in zip(opposite_rest.iter_mut().rev(), rest) {
        *opposite = Complex { re: a.re + b.im, im: b.re - a.im };
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

/// Reads columns out of some rows of a stripe, which is given from the first of them on, square by square:
/// `columns[i * pitch + y] = stripe[y * width + i]`.
fn to_columns<T: Real>(
    stripe: &[Complex<T>],
    width: usize,
    rows: Range<usize>,
    columns: &mut [Complex<T>],
    pitch: usize,
) {
    let count = columns.len() / pitch;
    let (begin, end) = (rows.start, rows.end - rows.len() % SQUARE);
    let to = &mut *columns;
    widest(
        #[inline(always)]
        move || {
            for y in (begin..end).step_by(SQUARE) {
                for i in (0..count).step_by(SQUARE) {
                    let square = square(&stripe[y * width + i..], width);
                    put_square(&square, &mut to[i * pitch + y..], pitch);
                }
            }
        },
    );
    for y in end..rows.end {
        let line = &stripe[y * width..][..count];
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
    rows: Range<usize>,
) {
    let count = columns.len() / pitch;
    let (begin, end) = (rows.start, rows.end - rows.len() % SQUARE);
    let to = &mut *stripe;
    widest(
        #[inline(always)]
        move || {
            for y in (begin..end).step_by(SQUARE) {
                for i in (0..count).step_by(SQUARE) {
                    let square = square(&columns[i * pitch + y..], pitch);
                    put_square(&square, &mut to[y * width + i..], width);
                }
            }
        },
    );
    for y in end..rows.end {
        let line = &mut stripe[y * width..][..count];
        for (value, column) in line.iter_mut().zip(columns.chunks_exact(pitch)) {
            *value = column[y];
        }
    }
}

/// A square out of lines, with lines and columns exchanged.
#[expect(clippy::inline_always, reason = "a call would lose the instructions of its caller")]
#[inline(always)]
fn square<T: Real>(from: &[Complex<T>], pitch: usize) -> [[Complex<T>; SQUARE]; SQUARE] {
    let mut square = [[Complex::default(); SQUARE]; SQUARE];
    for k in 0..SQUARE {
        for (line, &value) in zip(&mut square, &from[k * pitch..][..SQUARE]) {
            line[k] = value;
        }
    }
    square
}

/// Writes a square to lines.
#[expect(clippy::inline_always, reason = "a call would lose the instructions of its caller")]
#[inline(always)]
fn put_square<T: Real>(square: &[[Complex<T>; SQUARE]; SQUARE], to: &mut [Complex<T>], pitch: usize) {
    for (k, line) in square.iter().enumerate() {
        to[k * pitch..][..SQUARE].copy_from_slice(line);
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
