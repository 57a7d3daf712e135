//! The preconditioner of tangential tractions on a set of cells.

use super::extension::Extension;
use crate::geometry::{CellSet, Window};
use crate::operator::VectorConvolution;
use crate::tuning::BAND;
use numerics::parallel::map;

/// `M = E' B E` of both components, as [`super::preconditioner::TorusInverse`]: the displacement is extended into
/// the gaps between the cells, the inverse of the tensor on a torus around the window is applied, and the
/// transpose leads back.
#[derive(Debug)]
pub struct TensorTorusInverse<'a> {
    /// The inverse on the torus.
    pub transform: &'a mut VectorConvolution<f32>,
    /// The extension of each component, for this set.
    pub extensions: &'a mut [Extension; 2],
}

impl TensorTorusInverse<'_> {
    /// Safety factor of the energy on a torus, as [`super::preconditioner::TorusInverse::SAFETY`].
    pub const SAFETY: f64 = 2.0;

    /// Writes `z = M r`; two numbers a cell.
    pub fn apply(&mut self, set: &CellSet, r: &[f32], z: &mut [f32]) {
        let Self { transform, extensions, .. } = self;
        let Window { x: x0, y: y0, width, .. } = transform.window();
        let (bands, n) = (transform.bands(), set.len());
        let first_rows = || bands.clone().map(|y| y + y0);
        let rows = |y: usize| set.rows_within(y..y + BAND);
        for (extension, r) in extensions.iter_mut().zip(r.chunks_exact(n)) {
            extension.clear();
            if extension.is_wanted() {
                map(n, first_rows().zip(extension.bands(bands.len())), |(y, mut sums)| {
                    let mut line = vec![0.0; width];
                    for row in rows(y) {
                        row.spread(r, &mut line, x0);
                        sums.add(row.y - y0, &line);
                        row.fill(0.0, &mut line, x0);
                    }
                });
                extension.extend();
            }
        }
        let extended = &**extensions;
        transform.forward(
            |_| true,
            |component, y, out| {
                extended[component].fill(y, out);
                if let Some(row) = set.row(y + y0) {
                    row.spread(&r[component * n..][..n], out, x0);
                }
            },
        );
        transform.multiply(|_| true);
        let mut outputs = Vec::with_capacity(2 * bands.len());
        for (extension, z) in extensions.iter_mut().zip(z.chunks_exact_mut(n)) {
            extension.clear();
            outputs.extend(set.split(z, first_rows()).into_iter().zip(extension.bands(bands.len())));
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
        );
        for (extension, z) in extensions.iter_mut().zip(z.chunks_exact_mut(n)) {
            if extension.is_wanted() {
                extension.collect();
                let extension = &*extension;
                map(n, first_rows().zip(set.split(z, first_rows())), |(y, (start, z))| {
                    let mut line = vec![0.0; width];
                    for row in rows(y).map(|row| row.after(start)) {
                        extension.take(row.y - y0, &mut line);
                        row.add(&line, z, x0);
                    }
                });
            }
        }
    }
}
