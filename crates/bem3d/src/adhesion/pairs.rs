//! A sparse matrix between the cells of a set that lie near each other.

use crate::real::Real;
use crate::tuning::CHUNK;
use numerics::parallel::map;

/// Rows and columns are numbered as the cells of the set.
#[derive(Debug, Default)]
pub struct Pairs {
    /// Where each row begins, and where the last one ends.
    first: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f32>,
}

impl Pairs {
    /// From the columns and values of each row.
    pub fn new(rows: impl Iterator<Item = impl Iterator<Item = (u32, f32)>>) -> Self {
        let mut pairs = Self { first: vec![0], ..Self::default() };
        for row in rows {
            for (column, value) in row {
                pairs.columns.push(column);
                pairs.values.push(value);
            }
            pairs.first.push(pairs.columns.len());
        }
        pairs
    }

    /// The transpose of a square matrix.
    pub fn transposed(&self) -> Self {
        let mut first = vec![0; self.first.len()];
        for &column in &self.columns {
            first[column as usize + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut next = first.clone();
        let (mut columns, mut values) = (vec![0; self.columns.len()], vec![0.0; self.values.len()]);
        for (row, ends) in self.first.windows(2).enumerate() {
            for k in ends[0]..ends[1] {
                let at = &mut next[self.columns[k] as usize];
                (columns[*at], values[*at]) = (row as u32, self.values[k]);
                *at += 1;
            }
        }
        Self { first, columns, values }
    }

    /// Adds a multiple of the product with a vector. The order of the sums is that of the columns.
    pub fn add_product<T: Real>(&self, factor: T, v: &[T], out: &mut [T]) {
        let rows = out.chunks_mut(CHUNK).zip(self.first.chunks(CHUNK)).enumerate();
        map(self.values.len(), rows, |(k, (out, first))| {
            for (i, (out, &begin)) in out.iter_mut().zip(first).enumerate() {
                let row = begin..self.first[k * CHUNK + i + 1];
                let mut sum = T::default();
                for (&column, &value) in self.columns[row.clone()].iter().zip(&self.values[row]) {
                    sum += T::of(f64::from(value)) * v[column as usize];
                }
                *out += factor * sum;
            }
        });
    }
}
