//! Preconditioners of the influence matrix on a set of cells.

use super::extension::Extension;
use crate::geometry::CellSet;
use crate::operator::FftConvolution;
use crate::real::{Real, dot, largest, sum};
use std::cell::RefCell;

/// What one application of a preconditioner finds.
#[derive(Debug, Clone, Copy)]
pub struct Preconditioned {
    /// Largest magnitude of the residual.
    pub largest: f64,
    /// `r' z`.
    pub product: f64,
    /// Sum of z.
    pub sum: f64,
}

/// A symmetric positive definite M that stands for the inverse of the influence matrix on a set.
pub trait Preconditioner<T> {
    /// Lowers the residual `r` by `offset` and writes `z = M r`.
    fn apply(&mut self, set: &CellSet, offset: T, r: &mut [T], z: &mut [T]) -> Preconditioned;

    /// The energy `r' G^-1 r` is at most so many times `r' M r`.
    fn energy_factor(&self) -> f64;
}

/// `M = 1`: for scattered contact, where every cell feels little of the others.
#[derive(Debug, Clone, Copy)]
pub struct Identity {
    /// Lower bound of the eigenvalues of the influence matrix.
    pub smallest_eigenvalue: f64,
}

impl<T: Real> Preconditioner<T> for Identity {
    fn apply(&mut self, _: &CellSet, offset: T, r: &mut [T], z: &mut [T]) -> Preconditioned {
        for (r, z) in r.iter_mut().zip(&mut *z) {
            *r = *r - offset;
            *z = *r;
        }
        Preconditioned { largest: largest(r).to_f64(), product: dot(r, z), sum: sum(z) }
    }

    fn energy_factor(&self) -> f64 {
        self.smallest_eigenvalue.recip()
    }
}

/// `M = E' B E`: the residual is extended into the gaps between contacts ([`Extension`]), the inverse of the kernel on a torus around
/// the window is applied (about |q| / 2 pi), and the transpose leads back. A quarter of the cost of an application of G or less.
#[derive(Debug)]
pub struct TorusInverse<'a> {
    /// The inverse on the torus.
    pub transform: &'a mut FftConvolution<f32>,
    /// The extension, for this set.
    pub extension: &'a mut Extension,
}

impl TorusInverse<'_> {
    /// Safety factor of the energy on a torus.
    ///
    /// `(G_CC)^-1 <= (G^-1)_CC` for every set C, so that the inverse on the whole lattice gives a bound; wrapping the lattice on a torus
    /// makes it an estimate that a residual as wide as the torus can exceed by some ten per cent.
    pub const SAFETY: f64 = 2.0;
}

impl Preconditioner<f32> for TorusInverse<'_> {
    fn apply(&mut self, set: &CellSet, offset: f32, r: &mut [f32], z: &mut [f32]) -> Preconditioned {
        let Self { transform, extension, .. } = self;
        let window = transform.window();
        let (x0, y0) = (window.x, window.y);
        let mut line = vec![0.0; window.width];
        let mut largest_residual = 0.0f32;
        extension.clear();
        for row in set.rows() {
            let values = &mut r[row.span()];
            for r in values.iter_mut() {
                *r -= offset;
            }
            largest_residual = largest_residual.max(largest(values));
            row.spread(r, &mut line, x0);
            extension.add(row.y - y0, &line);
            row.fill(0.0, &mut line, x0);
        }
        extension.extend();
        let shared = RefCell::new(&mut **extension);
        let (mut sources, mut targets) = (set.rows().peekable(), set.rows().peekable());
        transform.rows(
            |_| true,
            |y, out| {
                shared.borrow().fill(y, out);
                if let Some(row) = sources.next_if(|row| row.y == y + y0) {
                    row.spread(r, out, x0);
                }
            },
            |_| true,
            |y, u| {
                let mut extension = shared.borrow_mut();
                if y == 0 {
                    extension.clear(); // All rows have been filled.
                }
                line.copy_from_slice(u);
                if let Some(row) = targets.next_if(|row| row.y == y + y0) {
                    row.collect(u, z, x0);
                    row.fill(0.0, &mut line, x0);
                }
                extension.add_outside(y, &mut line);
            },
        );
        extension.collect();
        let (mut product, mut total) = (0.0, 0.0);
        for row in set.rows() {
            extension.take(row.y - y0, &mut line);
            row.add(&line, z, x0);
            product += dot(&r[row.span()], &z[row.span()]);
            total += sum(&z[row.span()]);
        }
        Preconditioned { largest: f64::from(largest_residual), product, sum: total }
    }

    fn energy_factor(&self) -> f64 {
        Self::SAFETY
    }
}
