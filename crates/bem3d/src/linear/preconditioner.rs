//! Preconditioners of the influence matrix on a set of cells.

use super::extension::Extension;
use crate::geometry::{CellSet, Window};
use crate::kernel::Tensor;
use crate::operator::Convolution;
use crate::parts::{Part, Recorder};
use crate::real::{Real, dot, each, largest, sum};
use crate::tuning::BAND;
use contact_model::{Interrupted, Stop};
use numerics::parallel::map;

/// The result of one application of a preconditioner.
#[derive(Debug, Clone, Copy)]
pub struct Preconditioned {
    /// Largest magnitude of the residual.
    pub largest: f64,
    /// `r' z`.
    pub product: f64,
    /// Sum of z.
    pub sum: f64,
}

/// A symmetric positive definite M that approximates the inverse of the influence matrix on a set.
pub trait Preconditioner<T> {
    /// Lowers the residual `r` by `offset` and writes `z = M r`.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `z` is then undefined.
    fn apply(
        &mut self,
        set: &CellSet,
        offset: T,
        r: &mut [T],
        z: &mut [T],
        stop: Stop<'_>,
    ) -> Result<Preconditioned, Interrupted>;

    /// Upper bound of the ratio of the energy `r' G^-1 r` to `r' M r`.
    fn energy_factor(&self) -> f64;
}

/// `M = 1`: for scattered contact, where the cells hardly interact.
#[derive(Debug, Clone, Copy)]
pub struct Identity {
    /// Lower bound of the eigenvalues of the influence matrix.
    pub smallest_eigenvalue: f64,
}

impl<T: Real> Preconditioner<T> for Identity {
    fn apply(
        &mut self,
        _: &CellSet,
        offset: T,
        r: &mut [T],
        z: &mut [T],
        _: Stop<'_>,
    ) -> Result<Preconditioned, Interrupted> {
        each(r, |r| *r = *r - offset);
        z.copy_from_slice(r);
        Ok(Preconditioned { largest: largest(r).to_f64(), product: dot(r, z), sum: sum(z) })
    }

    fn energy_factor(&self) -> f64 {
        self.smallest_eigenvalue.recip()
    }
}

/// `M = E' B E`: the residual is extended into the gaps between contacts ([`Extension`]), the inverse of the
/// kernel on a torus around the window is applied (for pressures about |q| / 2 pi), and the transpose leads back.
/// A quarter of the cost of an application of the kernel or less.
#[derive(Debug)]
pub struct TorusInverse<'a, const N: usize, const E: usize> {
    /// The inverse on the torus.
    pub transform: &'a mut Convolution<f32, N, E>,
    /// The extension of each component, for this set.
    pub extensions: &'a mut [Extension; N],
    /// The recorder that its time is charged to.
    pub recorder: Recorder,
}

/// Upper bound of the ratio of the energy `r' K^-1 r` to `r' M r` on a torus.
///
/// `(K_CC)^-1 <= (K^-1)_CC` for every set C, so that the inverse on the whole lattice gives a bound; wrapping the
/// lattice on a torus turns the bound into an estimate, which residuals as wide as the torus can exceed by some
/// ten per cent.
pub const TORUS_ENERGY: f64 = 2.0;

impl<const N: usize, const E: usize> TorusInverse<'_, N, E>
where
    [f32; E]: Tensor<f32, N>,
{
    /// Lowers the residual `r` by `offset` and writes `z = M r`; n numbers of each component.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `z` is then undefined.
    pub fn precondition(
        &mut self,
        set: &CellSet,
        offset: f32,
        r: &mut [f32],
        z: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<Preconditioned, Interrupted> {
        let largest = self.lower(set, offset, r);
        self.extensions.iter_mut().for_each(Extension::extend);
        self.transform(set, r, z, stop)?;
        self.extensions.iter_mut().for_each(Extension::collect);
        let (product, sum) = self.collect(set, r, z);
        Ok(Preconditioned { largest: f64::from(largest), product, sum })
    }

    /// The first rows of the bands of the window.
    fn first_rows(&self) -> impl Iterator<Item = usize> + Clone + use<N, E> {
        let y0 = self.transform.window().y;
        self.transform.bands().map(move |y| y + y0)
    }

    /// Lowers the residual, and sums it over the blocks of the extension. Returns its largest magnitude.
    fn lower(&mut self, set: &CellSet, offset: f32, r: &mut [f32]) -> f32 {
        let Window { x: x0, y: y0, width, .. } = self.transform.window();
        let (first_rows, n) = (self.first_rows(), set.len());
        let bands = self.transform.bands().len();
        let mut parts = Vec::with_capacity(N * bands);
        for (extension, r) in self.extensions.iter_mut().zip(r.chunks_exact_mut(n)) {
            extension.clear();
            let residuals = set.split(r, first_rows.clone());
            parts.extend(first_rows.clone().zip(residuals).zip(extension.bands(bands)));
        }
        let largest_residuals = map(N * n, parts.into_iter(), |((y, (start, r)), mut sums)| {
            let mut line = vec![0.0; width];
            let mut largest_residual = 0.0f32;
            for row in set.rows_within(y..y + BAND).map(|row| row.after(start)) {
                let values = &mut r[row.span()];
                for r in values.iter_mut() {
                    *r -= offset;
                }
                largest_residual = largest_residual.max(largest(values));
                if sums.is_wanted() {
                    row.spread(r, &mut line, x0);
                    sums.add(row.y - y0, &line);
                    row.fill(0.0, &mut line, x0);
                }
            }
            largest_residual
        });
        largest_residuals.into_iter().fold(0.0, f32::max)
    }

    /// The inverse on the torus of the residual and its extension: z on the set, and outside of it the sums over
    /// blocks that the transpose of the extension takes back.
    fn transform(
        &mut self,
        set: &CellSet,
        r: &[f32],
        z: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let (first_rows, n) = (self.first_rows(), set.len());
        let Self { transform, extensions, .. } = self;
        let Window { x: x0, y: y0, .. } = transform.window();
        let bands = transform.bands().len();
        let extended = &**extensions;
        transform.forward(
            |_, _| true,
            |component, y, out| {
                extended[component].fill(y, out);
                if let Some(row) = set.row(y + y0) {
                    row.spread(&r[component * n..][..n], out, x0);
                }
            },
            stop,
        )?;
        transform.multiply(|_| true, stop)?;
        let mut outputs = Vec::with_capacity(N * bands);
        for (extension, z) in extensions.iter_mut().zip(z.chunks_exact_mut(n)) {
            extension.clear();
            outputs.extend(set.split(z, first_rows.clone()).into_iter().zip(extension.bands(bands)));
        }
        transform.backward(
            |_| true,
            outputs.into_iter(),
            |((start, z), sums), _, y, u| {
                let row = set.row(y + y0).map(|row| row.after(*start));
                if let Some(row) = row {
                    row.collect(u, z, x0);
                }
                if sums.is_wanted() {
                    if let Some(row) = row {
                        row.fill(0.0, u, x0);
                    }
                    sums.add_transposed(y, u);
                }
            },
            stop,
        )
    }

    /// Adds to z what the transpose of the extension gives, and returns `r' z` and the sum of z.
    fn collect(&self, set: &CellSet, r: &[f32], z: &mut [f32]) -> (f64, f64) {
        let Window { x: x0, y: y0, width, .. } = self.transform.window();
        let (first_rows, n) = (self.first_rows(), set.len());
        let mut parts = Vec::with_capacity(N * self.transform.bands().len());
        for ((extension, r), z) in self.extensions.iter().zip(r.chunks_exact(n)).zip(z.chunks_exact_mut(n)) {
            let z = set.split(z, first_rows.clone());
            parts.extend(first_rows.clone().zip(z).map(|(y, z)| (extension, r, y, z)));
        }
        let sums = map(N * n, parts.into_iter(), |(extension, r, y, (start, z))| {
            let mut line = vec![0.0; width];
            let (mut product, mut total) = (0.0, 0.0);
            for row in set.rows_within(y..y + BAND) {
                let (at, z_row) = (row.span(), row.after(start));
                if extension.is_wanted() {
                    extension.take(row.y - y0, &mut line);
                    z_row.add(&line, z, x0);
                }
                let z = &z[z_row.span()];
                product += dot(&r[at], z);
                total += sum(z);
            }
            (product, total)
        });
        sums.into_iter().fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d))
    }
}

impl Preconditioner<f32> for TorusInverse<'_, 1, 1> {
    fn apply(
        &mut self,
        set: &CellSet,
        offset: f32,
        r: &mut [f32],
        z: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<Preconditioned, Interrupted> {
        let recorder = self.recorder.clone();
        recorder.timed(Part::Preconditioner, || self.precondition(set, offset, r, z, stop))
    }

    fn energy_factor(&self) -> f64 {
        TORUS_ENERGY
    }
}
