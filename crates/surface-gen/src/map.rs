//! Self-affine maps (Eqs. 2-5).

use crate::phases::{Stream, Turns};
use crate::spectrum::MapSpectrum;
use crate::turn::Circle;
use contact_model::{Error, HeightMap, Result, SelfAffine};
use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner};
use rustfft::{Fft, FftPlanner, num_complex::Complex};
use std::fmt;
use std::sync::Arc;

type C = Complex<f64>;

/// Rows that are gathered from the columns at a time: 16 complex numbers are four cache lines.
const ROWS: usize = 16;

/// From this size on one map is worth several threads; below, ensembles are parallel over their surfaces.
const PARALLEL_CELLS: usize = 4096;

/// Plans self-affine maps of one size: amplitudes normalised, transforms planned.
///
/// Cheap to clone and shared between threads; [`MapGenerator::map`] draws as many surfaces as are wanted.
#[derive(Clone)]
pub struct MapGenerator {
    cells: usize,
    side: f64,
    spectrum: MapSpectrum,
    /// `m / (2 N)` turns in units of 2^-64: moves the samples from the cells' corners to their centres.
    shifts: Arc<[u64]>,
    along_y: Arc<dyn Fft<f64>>,
    along_x: Arc<dyn ComplexToReal<f64>>,
}

impl fmt::Debug for MapGenerator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MapGenerator")
            .field("cells", &self.cells)
            .field("side", &self.side)
            .field("spectrum", &self.spectrum)
            .finish_non_exhaustive()
    }
}

impl MapGenerator {
    /// Plans maps of `cells` x `cells` cells.
    ///
    /// # Errors
    /// [`Error::Domain`] for parameters that make no sense, for `cells` of 0 or above 2^17, and where no wave is left: the grids of
    /// 1 and 2 cells a side and short cut-offs below the longest wave.
    pub fn new(surface: &SelfAffine, cells: usize) -> Result<Self> {
        let spectrum = MapSpectrum::new(surface, cells)?;
        let shifts = (0..=(cells / 2) as u128).map(|m| ((m << 63) / cells as u128) as u64).collect();
        Ok(Self {
            cells,
            side: surface.side,
            spectrum,
            shifts,
            along_y: FftPlanner::new().plan_fft_inverse(cells),
            along_x: RealFftPlanner::new().plan_fft_inverse(cells),
        })
    }

    /// The rms height that every surface of this generator has, from the amplitudes alone: `sqrt(sum B^2)`.
    ///
    /// Cost O(N^2), without any transform.
    pub fn rms_height(&self) -> f64 {
        self.spectrum.moment(0).sqrt()
    }

    /// The rms slope that every surface of this generator has, from the amplitudes alone: `sqrt(sum q^2 B^2)`.
    ///
    /// Cost O(N^2), without any transform.
    pub fn rms_slope(&self) -> f64 {
        std::f64::consts::TAU / self.side * self.spectrum.moment(1).sqrt()
    }

    /// Draws the surface with this seed.
    ///
    /// The same bytes for any number of threads. Cost O(N^2 log N), memory twice that of the map.
    ///
    /// # Errors
    /// [`Error::Domain`] when the map does not fit in memory or its heights overflow.
    pub fn map(&self, seed: u64) -> Result<HeightMap> {
        self.synthesise(seed, self.cells >= PARALLEL_CELLS)
    }

    fn synthesise(&self, seed: u64, parallel: bool) -> Result<HeightMap> {
        let n = self.cells;
        let mut columns = zeroed(n, self.spectrum.columns(), C::new(0.0, 0.0))?;
        let mut heights = zeroed(n, n, 0.0)?;

        let column_scratch = || vec![C::new(0.0, 0.0); self.along_y.get_inplace_scratch_len()];
        let fill = |scratch: &mut Vec<C>, (mx, column): (usize, &mut [C])| {
            self.fill_column(seed, mx as u64, column);
            self.along_y.process_with_scratch(column, scratch);
        };
        let row_scratch = || RowScratch {
            gathered: vec![C::new(0.0, 0.0); ROWS * (n / 2 + 1)],
            fft: self.along_x.make_scratch_vec(),
        };
        if parallel {
            columns.par_chunks_exact_mut(n).enumerate().for_each_init(column_scratch, fill);
            heights
                .par_chunks_mut(ROWS * n)
                .enumerate()
                .for_each_init(row_scratch, |scratch, (i, rows)| self.rows(&columns, i, rows, scratch));
        } else {
            let mut scratch = column_scratch();
            columns.chunks_exact_mut(n).enumerate().for_each(|item| fill(&mut scratch, item));
            let mut scratch = row_scratch();
            for (i, rows) in heights.chunks_mut(ROWS * n).enumerate() {
                self.rows(&columns, i, rows, &mut scratch);
            }
        }
        drop(columns);
        HeightMap::new(n, self.side, heights)
    }

    /// Writes `B exp(i phi)` of all waves (mx, my); index my, negative ones from the end.
    fn fill_column(&self, seed: u64, mx: u64, column: &mut [C]) {
        let circle = Circle::shared();
        let wave = |amplitude: f64, turn: u64| {
            let [cos, sin] = circle.cos_sin(turn);
            C::new(amplitude * cos, amplitude * sin)
        };
        let mut turns = Turns::new(seed, Stream::Map, mx);
        let shift_x = self.shifts[mx as usize];
        for my in 0..=self.spectrum.reach(mx) {
            let (up, down) = (turns.next(), turns.next());
            let m2 = mx * mx + my * my;
            if m2 == 0 {
                continue;
            }
            let amplitude = self.spectrum.amplitude(m2);
            let shift_y = self.shifts[my as usize];
            let positive = wave(amplitude, up.wrapping_add(shift_x).wrapping_add(shift_y));
            column[my as usize] = positive;
            if my > 0 {
                column[self.cells - my as usize] = if mx == 0 {
                    positive.conj()
                } else {
                    wave(amplitude, down.wrapping_add(shift_x).wrapping_sub(shift_y))
                };
            }
        }
    }

    /// Transforms block number `block` of rows along x.
    fn rows(&self, columns: &[C], block: usize, rows: &mut [f64], scratch: &mut RowScratch) {
        let n = self.cells;
        let (first, width) = (block * ROWS, n / 2 + 1);
        scratch.gathered.fill(C::new(0.0, 0.0));
        for (mx, column) in columns.chunks_exact(n).enumerate() {
            let part = &column[first..first + rows.len() / n];
            for (iy, &value) in part.iter().enumerate() {
                scratch.gathered[iy * width + mx] = value;
            }
        }
        for (spectrum, row) in scratch.gathered.chunks_exact_mut(width).zip(rows.chunks_exact_mut(n)) {
            // Real but for rounding: the waves (0, my) and (0, -my) are conjugate.
            spectrum[0].im = 0.0;
            let done = self.along_x.process_with_scratch(spectrum, row, &mut scratch.fft);
            debug_assert!(done.is_ok(), "buffers come from the plan, the ends are real");
        }
    }
}

#[derive(Debug)]
struct RowScratch {
    gathered: Vec<C>,
    fft: Vec<C>,
}

/// `n * m` zeros, or an error where the memory cannot be had.
fn zeroed<T: Copy>(n: usize, m: usize, zero: T) -> Result<Vec<T>> {
    let mut values = Vec::new();
    match n.checked_mul(m).map(|len| (len, values.try_reserve_exact(len))) {
        Some((len, Ok(()))) => {
            values.resize(len, zero);
            Ok(values)
        }
        _ => Err(Error::domain("cells", n as f64, "a map that fits in memory")),
    }
}

/// A self-affine map of `cells` x `cells` cells: `h(x) = sum over all q of B_2D(q) cos(q x + phi(q))`, `B_2D = (2 pi / L) sqrt(C_2D)`.
///
/// Heights are in the unit of the amplitude, sampled at the cells' centres. Amplitudes are fixed, phases uniform
/// ([`crate::map_phase`]). Waves fill the circle `|q| <= pi / cell` (or the shorter `short_cutoff`) except the Nyquist ones.
/// With `Amplitude::RmsHeight(h)` the rms of the samples is h for every seed; the mean is 0.
///
/// # Errors
/// As [`MapGenerator::new`] and [`MapGenerator::map`]. Cost O(N^2 log N).
///
/// Source: Pohrt, Popov, Filippov 2012, Eqs. 2-5. Differs from the printed form by `phi(-q) = -phi(q)` (printed: `phi(q) = phi(-q)`)
/// and by being a sum over the grid's waves.
///
/// ```
/// let surface = contact_model::SelfAffine::new(2.4, 1.0, 0.5)?;
/// let map = surface_gen::self_affine_map(&surface, 33, 1)?;
/// let rms = surface_gen::rms_height(map.heights());
/// assert!((rms - 0.5).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn self_affine_map(surface: &SelfAffine, cells: usize, seed: u64) -> Result<HeightMap> {
    MapGenerator::new(surface, cells)?.map(seed)
}
