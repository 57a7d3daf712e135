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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_is_that_of_the_dense_matrix() {
        // Rows of 0 to 10 values.
        let dense: Vec<Vec<f32>> = (0..11)
            .map(|i| {
                (0..11).map(|j| if (i * 5 + j * 3) % 11 < i { (i + 2 * j) as f32 } else { 0.0 }).collect()
            })
            .collect();
        let row = |row: &Vec<f32>| {
            let pairs: Vec<(u32, f32)> = (0..).zip(row.iter().copied()).filter(|(_, v)| *v != 0.0).collect();
            pairs.into_iter()
        };
        let pairs = Pairs::new(dense.iter().map(row));
        let v: Vec<f64> = (0..11).map(|i| f64::from(i * i) - 20.0).collect();
        let mut product = vec![1.0; 11];
        pairs.add_product(-2.0, &v, &mut product);
        for i in 0..11 {
            let sum: f64 = (0..11).map(|j| f64::from(dense[i][j]) * v[j]).sum();
            assert!((product[i] - (1.0 - 2.0 * sum)).abs() < 1e-9);
        }
    }
}
