//! Extension of displacements from the contact set into the gaps between, for the preconditioner.
//!
//! For every extension E of a function on the set C to a whole window, `E' G^-1 E >= (G_CC)^-1`, with
//! equality for the displacement that the pressure makes. Zeros are an extension too, but a poor one: the
//! jump at every edge of contact weighs as much as what is asked. Here a gap takes the mean of the contact
//! around it on the finest of ever coarser grids that has contact there, times a decay for each level; this
//! halves the number of steps where contact is full of holes.

use crate::geometry::{CellSet, Window};
use crate::tuning::{BAND, EXTENSION_LEVELS};
use numerics::parallel::map;
use std::iter::zip;

/// Sums over blocks of 2^l x 2^l cells of a window, for a set.
#[derive(Debug, Default)]
pub struct Extension {
    window: Option<Window>,
    decay: f32,
    levels: Vec<Level>,
}

#[derive(Debug, Default)]
struct Level {
    /// Blocks in a row, and one more of weight 0 where their number is odd.
    width: usize,
    /// 1 / number of contact cells in the block; 0 for none.
    weight: Vec<f32>,
    value: Vec<f32>,
}

impl Extension {
    /// Takes a set inside a window; a decay of 0 extends by zeros.
    pub fn set(&mut self, set: &CellSet, window: Window, decay: f32) {
        if decay <= 0.0 {
            (self.window, self.levels) = (None, Vec::new());
        } else if self.window != Some(window) {
            let mut levels = Vec::new();
            let (mut width, mut height) = (window.width, window.height);
            while (width > 1 || height > 1) && levels.len() < EXTENSION_LEVELS {
                (width, height) = (width.div_ceil(2), height.div_ceil(2));
                let even = width.next_multiple_of(2);
                let blank = || vec![0.0; even * height];
                levels.push(Level { width: even, weight: blank(), value: blank() });
            }
            (self.window, self.levels) = (Some(window), levels);
        }
        self.decay = decay;
        let Some(first) = self.levels.first_mut() else { return };
        first.weight.fill(0.0);
        let width = first.width;
        map(set.len(), first.weight.chunks_mut(BAND / 2 * width).enumerate(), |(band, weights)| {
            let mut line = vec![0.0; window.width];
            for row in set.rows_within(window.y + band * BAND..window.y + (band + 1) * BAND) {
                row.fill(1.0, &mut line, window.x);
                gather(&line, &mut weights[(row.y - window.y) % BAND / 2 * width..][..width]);
                row.fill(0.0, &mut line, window.x);
            }
        });
        for l in 1..self.levels.len() {
            let (fine, coarse) = neighbours(&mut self.levels, l);
            coarse.weight.fill(0.0);
            for (y, row) in fine.weight.chunks_exact(fine.width).enumerate() {
                gather(row, &mut coarse.weight[y / 2 * coarse.width..][..coarse.width]);
            }
        }
        for weight in self.levels.iter_mut().flat_map(|l| &mut l.weight) {
            *weight = if *weight > 0.0 { weight.recip() } else { 0.0 };
        }
    }

    /// Whether there are levels: without, an extension by zeros needs no sums.
    pub fn is_wanted(&self) -> bool {
        !self.levels.is_empty()
    }

    /// What a gap takes over of a coarser value.
    pub fn decay(&self) -> f32 {
        self.decay
    }

    /// Begins a new set of sums.
    pub fn clear(&mut self) {
        if let Some(first) = self.levels.first_mut() {
            first.value.fill(0.0);
        }
    }

    /// The sums over blocks, of each of `count` bands of rows of the window; empty where there are no levels.
    pub fn bands(&mut self, count: usize) -> Vec<BandSums<'_>> {
        let Some(first) = self.levels.first_mut() else {
            return (0..count).map(|_| BandSums { width: 0, values: &mut [] }).collect();
        };
        let width = first.width;
        first.value.chunks_mut(BAND / 2 * width).map(|values| BandSums { width, values }).collect()
    }

    /// From sums over the contact of each block to the values that their open cells take.
    pub fn extend(&mut self) {
        let decay = self.decay;
        for l in 1..self.levels.len() {
            let (fine, coarse) = neighbours(&mut self.levels, l);
            coarse.value.fill(0.0);
            for_rows(fine, coarse, |row, _, above| gather(row, above));
        }
        self.weigh_last();
        for l in (1..self.levels.len()).rev() {
            let (fine, coarse) = neighbours(&mut self.levels, l);
            for_rows(fine, coarse, |row, weights, above| {
                for ((pair, weights), above) in zip(pairs_mut(row), pairs(weights)).zip(above) {
                    let passed = decay * *above;
                    *pair = std::array::from_fn(|i| {
                        pair[i] * weights[i] + if weights[i] > 0.0 { 0.0 } else { passed }
                    });
                }
            });
        }
    }

    /// The transpose of [`Self::extend`], from what [`BandSums::add`] summed to what each contact cell of a
    /// block receives.
    pub fn collect(&mut self) {
        let decay = self.decay;
        for l in 1..self.levels.len() {
            let (fine, coarse) = neighbours(&mut self.levels, l);
            coarse.value.fill(0.0);
            for_rows(fine, coarse, |row, weights, above| {
                for ((pair, weights), above) in zip(pairs_mut(row), pairs(weights)).zip(above) {
                    let open = |i: usize| if weights[i] > 0.0 { 0.0 } else { pair[i] };
                    *above += decay * (open(0) + open(1));
                    *pair = [pair[0] * weights[0], pair[1] * weights[1]];
                }
            });
        }
        self.weigh_last();
        for l in (1..self.levels.len()).rev() {
            let (fine, coarse) = neighbours(&mut self.levels, l);
            for_rows(fine, coarse, |row, _, above| {
                for (pair, above) in zip(pairs_mut(row), above) {
                    *pair = [pair[0] + *above, pair[1] + *above];
                }
            });
        }
    }

    fn weigh_last(&mut self) {
        if let Some(last) = self.levels.last_mut() {
            for (value, weight) in last.value.iter_mut().zip(&last.weight) {
                *value *= weight;
            }
        }
    }

    /// What is passed to the cells of row y that are outside the set.
    pub fn fill(&self, y: usize, row: &mut [f32]) {
        self.pass(y, self.decay, row);
    }

    /// What was collected for the cells of row y that are on the set.
    pub fn take(&self, y: usize, row: &mut [f32]) {
        self.pass(y, 1.0, row);
    }

    /// The values of the finest blocks on row y of the window.
    fn pass(&self, y: usize, factor: f32, row: &mut [f32]) {
        let Some(first) = self.levels.first() else { return row.fill(0.0) };
        let above = &first.value[y / 2 * first.width..][..first.width];
        let (pairs, odd) = row.as_chunks_mut::<2>();
        let (above, rest) = above.split_at(pairs.len());
        for (pair, above) in zip(pairs, above) {
            *pair = [factor * above; 2];
        }
        for (value, above) in zip(odd, rest) {
            *value = factor * above;
        }
    }
}

/// Sums over the finest blocks in one band of rows.
#[derive(Debug)]
pub struct BandSums<'a> {
    width: usize,
    values: &'a mut [f32],
}

impl BandSums<'_> {
    /// Whether there are any: without levels, an extension by zeros needs no sums.
    pub fn is_wanted(&self) -> bool {
        self.width > 0
    }

    /// Adds row y of the window: zero outside the set for [`Extension::extend`]; zero on it, and times the
    /// decay, for
    /// [`Extension::collect`].
    pub fn add(&mut self, y: usize, row: &[f32]) {
        gather(row, &mut self.values[y % BAND / 2 * self.width..][..self.width]);
    }
}

/// Shows each row of a level with its weights and the row of the coarser level above it.
fn for_rows(fine: &mut Level, coarse: &mut Level, show: impl Fn(&mut [f32], &[f32], &mut [f32]) + Sync) {
    let (total, width, above) = (fine.value.len(), fine.width, coarse.width);
    let bands = fine.value.chunks_mut(BAND * width).zip(fine.weight.chunks(BAND * width));
    map(total, bands.zip(coarse.value.chunks_mut(BAND / 2 * above)), |((values, weights), coarse)| {
        for (y, (row, weights)) in values.chunks_exact_mut(width).zip(weights.chunks_exact(width)).enumerate()
        {
            show(row, weights, &mut coarse[y / 2 * above..][..above]);
        }
    });
}

/// Adds neighbouring pairs of a row to its sums.
fn gather(row: &[f32], sums: &mut [f32]) {
    let (pairs, odd) = row.as_chunks::<2>();
    let (sums, rest) = sums.split_at_mut(pairs.len());
    for (sum, pair) in zip(sums, pairs) {
        *sum += pair[0] + pair[1];
    }
    for (sum, value) in zip(rest, odd) {
        *sum += value;
    }
}

/// A row of even length as pairs.
fn pairs(row: &[f32]) -> &[[f32; 2]] {
    row.as_chunks().0
}

fn pairs_mut(row: &mut [f32]) -> &mut [[f32; 2]] {
    row.as_chunks_mut().0
}

fn neighbours(levels: &mut [Level], coarse: usize) -> (&mut Level, &mut Level) {
    let (fine, rest) = levels.split_at_mut(coarse);
    (&mut fine[coarse - 1], &mut rest[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 21;
    const HEIGHT: usize = 26;

    /// A set that leaves the right third of the grid open, and one that reaches its last, odd column and row.
    fn masks() -> [Vec<f32>; 2] {
        [14, WIDTH].map(|width| {
            let inside = |i: usize| (i * i + i / 5) % 7 < 2 && i % WIDTH < width || i == WIDTH * HEIGHT - 1;
            (0..WIDTH * HEIGHT).map(|i| f32::from(u8::from(inside(i)))).collect()
        })
    }

    fn values(seed: f32, mask: &[f32]) -> Vec<f32> {
        mask.iter().enumerate().map(|(i, m)| m * (seed * i as f32).sin()).collect()
    }

    const DECAY: f32 = 0.7;
    /// The rows and columns of the window begin where those of the grid do not.
    const WINDOW: Window = Window { x: 3, y: 5, width: WIDTH, height: HEIGHT };

    fn extension(mask: &[f32]) -> Extension {
        let columns =
            |y: usize| (0..WIDTH).filter(move |x| mask[y * WIDTH + x] > 0.0).map(|x| (x + 3) as u32);
        let set = CellSet::from_rows((0..HEIGHT).map(|y| (y + 5, columns(y))));
        let mut extension = Extension::default();
        // What it held before does not matter, in the same window and in another one.
        extension.set(&set, Window { x: 0, y: 0, width: 40, height: 50 }, 0.1);
        extension.set(&CellSet::from_rows([(7, [4, 9, 20])]), WINDOW, 0.2);
        extension.set(&set, WINDOW, DECAY);
        extension
    }

    /// r on the set, what is passed on elsewhere.
    fn forward(e: &mut Extension, mask: &[f32], r: &[f32]) -> Vec<f32> {
        e.clear();
        for (y, row) in r.chunks_exact(WIDTH).enumerate() {
            e.bands(1)[y / BAND].add(y, row);
        }
        e.extend();
        let mut out = vec![0.0; r.len()];
        for (y, out) in out.chunks_exact_mut(WIDTH).enumerate() {
            let k = y * WIDTH..(y + 1) * WIDTH;
            e.fill(y, out);
            for ((out, r), m) in out.iter_mut().zip(&r[k.clone()]).zip(&mask[k]) {
                *out = if *m > 0.0 { *r } else { *out };
            }
        }
        out
    }

    fn transposed(e: &mut Extension, mask: &[f32], u: &[f32]) -> Vec<f32> {
        e.clear();
        let outside: Vec<f32> = u.iter().zip(mask).map(|(u, m)| DECAY * u * (1.0 - m)).collect();
        for (y, row) in outside.chunks_exact(WIDTH).enumerate() {
            e.bands(1)[y / BAND].add(y, row);
        }
        e.collect();
        let mut out = vec![0.0; u.len()];
        for (y, out) in out.chunks_exact_mut(WIDTH).enumerate() {
            e.take(y, out);
        }
        out.iter().zip(u).zip(mask).map(|((above, u), m)| m * (u + above)).collect()
    }

    #[test]
    fn it_is_the_identity_on_the_set_and_decays_outside() {
        for mask in masks() {
            let mut e = extension(&mask);
            let out = forward(&mut e, &mask, &mask);
            for (&o, &m) in out.iter().zip(&mask) {
                assert!(
                    if m > 0.0 { (o - 1.0).abs() < 1e-6 } else { o > 0.0 && o <= DECAY + 1e-6 },
                    "{o} {m}"
                );
            }
        }
    }

    #[test]
    fn the_transpose_is_the_transpose() {
        for mask in masks() {
            let mut e = extension(&mask);
            // One column of pressure at a time, so that no column hides behind the others.
            let u = values(0.7, &vec![1.0; mask.len()]);
            let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum::<f64>();
            let back = transposed(&mut e, &mask, &u);
            for x in 0..WIDTH {
                let mut r = values(1.3, &mask);
                for (i, r) in r.iter_mut().enumerate() {
                    *r *= f32::from(u8::from(i % WIDTH == x));
                }
                let (one, two) = (dot(&forward(&mut e, &mask, &r), &u), dot(&r, &back));
                assert!((one - two).abs() < 1e-4 * one.abs().max(1.0), "column {x}: {one} {two}");
            }
        }
    }
}
