//! Transforms of real maps.

use contact_model::Cells;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner, num_complex::Complex64};
use std::sync::Arc;

/// Forward and inverse transforms of maps of one size, on the half plane `0 <= mx <= columns/2`: wave (mx,
/// my) has the index `mx rows + my`, negative my from the end.
#[derive(Clone)]
pub(crate) struct MapTransform {
    cells: Cells,
    forward: (Arc<dyn RealToComplex<f64>>, Arc<dyn Fft<f64>>),
    inverse: (Arc<dyn ComplexToReal<f64>>, Arc<dyn Fft<f64>>),
}

impl MapTransform {
    pub(crate) fn new(cells: Cells) -> Self {
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        let Cells { columns, rows } = cells;
        Self {
            cells,
            forward: (real.plan_fft_forward(columns), complex.plan_fft_forward(rows)),
            inverse: (real.plan_fft_inverse(columns), complex.plan_fft_inverse(rows)),
        }
    }

    /// `1/columns sum h exp(-2 pi i (mx ix / columns + my iy / rows))` of the heights `(h - middle)/unit`.
    pub(crate) fn forward(&self, heights: &[f64], middle: f64, unit: f64) -> Vec<Complex64> {
        let Cells { columns, rows } = self.cells;
        let mut waves = vec![Complex64::new(0.0, 0.0); (columns / 2 + 1) * rows];
        let (along_x, along_y) = &self.forward;
        let (mut input, mut output) = (along_x.make_input_vec(), along_x.make_output_vec());
        let mut scratch = along_x.make_scratch_vec();
        for (iy, row) in heights.chunks_exact(columns).enumerate() {
            for (x, h) in input.iter_mut().zip(row) {
                *x = (h - middle) / unit / columns as f64;
            }
            let done = along_x.process_with_scratch(&mut input, &mut output, &mut scratch);
            debug_assert!(done.is_ok(), "buffers come from the plan");
            for (mx, value) in output.iter().enumerate() {
                waves[mx * rows + iy] = *value;
            }
        }
        along_y.process(&mut waves);
        waves
    }

    /// `h = sum H exp(2 pi i (mx ix / columns + my iy / rows))` over the whole plane; waves that are their
    /// own conjugates count with their real parts.
    pub(crate) fn inverse(&self, mut waves: Vec<Complex64>) -> Vec<f64> {
        let Cells { columns, rows } = self.cells;
        let (along_x, along_y) = &self.inverse;
        along_y.process(&mut waves);
        let mut spectrum = along_x.make_input_vec();
        let mut scratch = along_x.make_scratch_vec();
        let mut heights = vec![0.0; columns * rows];
        for (iy, row) in heights.chunks_exact_mut(columns).enumerate() {
            for (value, column) in spectrum.iter_mut().zip(waves.chunks_exact(rows)) {
                *value = column[iy];
            }
            // Real but for rounding: the waves (0, my) and (0, -my) are conjugate.
            spectrum[0].im = 0.0;
            if columns.is_multiple_of(2) {
                spectrum[columns / 2].im = 0.0;
            }
            let done = along_x.process_with_scratch(&mut spectrum, row, &mut scratch);
            debug_assert!(done.is_ok(), "buffers come from the plan, the ends are real");
        }
        heights
    }
}
