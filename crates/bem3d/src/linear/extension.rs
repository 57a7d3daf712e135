//! Extension of displacements from the contact set into the gaps between, for the preconditioner.
//!
//! For every extension E of a function on the set C to a whole window, `E' G^-1 E >= (G_CC)^-1`, with
//! equality for the displacement under the pressure. Zeros are also an extension, but a poor one: the energy
//! of the jumps at the edges of the contact is as large as that of the displacement itself. Here a gap takes
//! the mean of the contact around it on the finest of ever coarser grids that has contact there, times a
//! decay for each level, interpolated linearly from level to level. Constant blocks would have jumps at their
//! own edges, whose energy grows with the logarithm of the size of the gap: with half of the cells in contact
//! at N = 1024, six digits then take 21 steps instead of 14.

use crate::geometry::{CellSet, Window};
use crate::tuning::{BAND, EXTENSION_LEVELS};
use numerics::parallel::{map, widest};
use std::iter::zip;

/// Sums over blocks of 2^l x 2^l cells of a window, for a set.
#[derive(Debug, Default)]
pub struct Extension {
    window: Option<Window>,
    decay: f32,
    levels: Vec<Level>,
    /// The contribution of each band of rows of the window to the row of blocks above it and to the one
    /// below.
    beyond: Vec<f32>,
}

#[derive(Debug, Default)]
struct Level {
    /// Number of blocks in a row, with one more of weight 0 where the number is odd.
    width: usize,
    /// 1 / number of contact cells in the block; 0 for none.
    weight: Vec<f32>,
    value: Vec<f32>,
}

impl Extension {
    /// Prepares the extension of a set inside a window; a decay of 0 extends by zeros.
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
        self.beyond.resize(2 * width * window.height.div_ceil(BAND), 0.0);
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

    /// The window it is prepared for; `None` where it extends by zeros.
    pub fn window(&self) -> Option<Window> {
        self.window
    }

    /// Whether there are levels; without levels, an extension by zeros needs no sums.
    pub fn is_wanted(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Begins a new set of sums.
    pub fn clear(&mut self) {
        if let Some(first) = self.levels.first_mut() {
            first.value.fill(0.0);
            self.beyond.fill(0.0);
        }
    }

    /// The sums over blocks, of each of `count` bands of rows of the window; empty where there are no levels.
    pub fn bands(&mut self, count: usize) -> Vec<BandSums<'_>> {
        let Some(first) = self.levels.first_mut() else {
            return (0..count).map(|_| BandSums::default()).collect();
        };
        let (width, decay) = (first.width, self.decay);
        let bands = zip(first.value.chunks_mut(BAND / 2 * width), self.beyond.chunks_exact_mut(2 * width));
        bands
            .map(|(values, beyond)| BandSums { width, decay, values, beyond, line: vec![0.0; width] })
            .collect()
    }

    /// From sums over the contact of each block to the values that their open cells take.
    pub fn extend(&mut self) {
        for l in 1..self.levels.len() {
            let (fine, coarse) = neighbours(&mut self.levels, l);
            coarse.value.fill(0.0);
            for_rows(fine, coarse, |row, _, above| gather(row, above));
        }
        self.weigh_last();
        for l in (1..self.levels.len()).rev() {
            let decay = self.decay;
            let (fine, coarse) = neighbours(&mut self.levels, l);
            let (width, coarse) = (fine.width, &*coarse);
            let bands = fine.value.chunks_mut(BAND * width).zip(fine.weight.chunks(BAND * width));
            map(fine.weight.len(), bands.enumerate(), |(band, (values, weights))| {
                let mut passed = vec![0.0; width];
                let rows = zip(values.chunks_exact_mut(width), weights.chunks_exact(width));
                for (y, (values, weights)) in rows.enumerate() {
                    coarse.interpolate(band * BAND + y, decay, &mut passed);
                    for ((value, &weight), &passed) in zip(zip(values, weights), &passed) {
                        *value = *value * weight + if weight > 0.0 { 0.0 } else { passed };
                    }
                }
            });
        }
    }

    /// The transpose of [`Self::extend`], from the sums of [`BandSums::add_transposed`] to the values that
    /// each contact cell of a block receives.
    pub fn collect(&mut self) {
        self.add_beyond();
        for l in 1..self.levels.len() {
            let decay = self.decay;
            let (fine, coarse) = neighbours(&mut self.levels, l);
            let (width, above, fine) = (fine.width, coarse.width, &*fine);
            map(fine.value.len(), coarse.value.chunks_mut(BAND * above).enumerate(), |(band, coarse)| {
                let mut open = vec![0.0; width];
                for (y, coarse) in coarse.chunks_exact_mut(above).enumerate() {
                    fine.open_around(band * BAND + y, decay, &mut open);
                    coarse.fill(0.0);
                    spread_back(&open, coarse);
                }
            });
        }
        self.weigh_last();
        for l in (1..self.levels.len()).rev() {
            let (fine, coarse) = neighbours(&mut self.levels, l);
            for_rows(fine, coarse, |row, weights, above| {
                for ((pair, weights), above) in zip(pairs_mut(row), pairs(weights)).zip(above) {
                    *pair = [pair[0] * weights[0] + *above, pair[1] * weights[1] + *above];
                }
            });
        }
    }

    /// Adds the contributions of bands of rows to the rows of blocks of their neighbours.
    fn add_beyond(&mut self) {
        let Some(first) = self.levels.first_mut() else { return };
        let (width, height) = (first.width, first.value.len() / first.width);
        for (band, beyond) in self.beyond.chunks_exact(2 * width).enumerate() {
            let (above, below) = beyond.split_at(width);
            let begin = band * BAND / 2;
            let end = (begin + BAND / 2).min(height);
            // At the ends of the window the outermost rows stand for those beyond.
            for (row, line) in [(begin.saturating_sub(1), above), (end.min(height - 1), below)] {
                for (value, line) in zip(&mut first.value[row * width..][..width], line) {
                    *value += line;
                }
            }
        }
    }

    fn weigh_last(&mut self) {
        if let Some(last) = self.levels.last_mut() {
            for (value, weight) in last.value.iter_mut().zip(&last.weight) {
                *value *= weight;
            }
        }
    }

    /// The values of the cells of row y outside the set.
    pub fn fill(&self, y: usize, row: &mut [f32]) {
        let Some(first) = self.levels.first() else { return row.fill(0.0) };
        first.interpolate(y, self.decay, row);
    }

    /// The values collected for the cells of row y in the set.
    pub fn take(&self, y: usize, row: &mut [f32]) {
        let Some(first) = self.levels.first() else { return row.fill(0.0) };
        let above = &first.value[y / 2 * first.width..][..first.width];
        let (pairs, odd) = row.as_chunks_mut::<2>();
        let (above, rest) = above.split_at(pairs.len());
        for (pair, above) in zip(pairs, above) {
            *pair = [*above; 2];
        }
        odd.copy_from_slice(&rest[..odd.len()]);
    }
}

/// The share of the nearest block in a linear interpolation, and that of the next.
const NEAR: f32 = 0.75;
/// See `NEAR`.
const NEXT: f32 = 0.25;

/// The row of blocks that contains row y, and the next nearest one; beyond the first and the last of `rows`
/// these are repeated.
fn rows_around(y: usize, rows: usize) -> (usize, usize) {
    let own = y / 2;
    (own, if y.is_multiple_of(2) { own.saturating_sub(1) } else { (own + 1).min(rows - 1) })
}

impl Level {
    fn row(&self, y: usize) -> &[f32] {
        &self.value[y * self.width..][..self.width]
    }

    fn height(&self) -> usize {
        self.value.len() / self.width
    }

    /// `factor` times the values of this level, interpolated at row y of the finer one.
    fn interpolate(&self, y: usize, factor: f32, fine: &mut [f32]) {
        let (own, next) = rows_around(y, self.height());
        let blocks = fine.len().div_ceil(2);
        let (own, next) = (&self.row(own)[..blocks], &self.row(next)[..blocks]);
        widest(
            #[inline(always)]
            move || {
                let at = |own: f32, next: f32| factor * (NEAR * own + NEXT * next);
                let pair = |left: f32, middle: f32, right: f32| {
                    [NEAR * middle + NEXT * left, NEAR * middle + NEXT * right]
                };
                let (pairs, odd) = fine.as_chunks_mut::<2>();
                let inner = zip(own.windows(3), next.windows(3));
                for (fine, (own, next)) in zip(pairs.iter_mut().skip(1), inner) {
                    *fine = pair(at(own[0], next[0]), at(own[1], next[1]), at(own[2], next[2]));
                }
                let at = |x: usize| at(own[x], next[x]);
                for x in [0, blocks - 1] {
                    let ends = pair(at(x.saturating_sub(1)), at(x), at((x + 1).min(blocks - 1)));
                    match pairs.get_mut(x) {
                        Some(fine) => *fine = ends,
                        None => odd.copy_from_slice(&ends[..1]),
                    }
                }
            },
        );
    }

    /// `factor` times the values that the open blocks of this level pass back to row y of the coarser one:
    /// the transpose of the interpolation between rows.
    fn open_around(&self, y: usize, factor: f32, sums: &mut [f32]) {
        let (height, width) = (self.height(), self.width);
        let coarse = height.div_ceil(2);
        sums.fill(0.0);
        for fine in (2 * y).saturating_sub(1)..(2 * y + 3).min(height) {
            let (own, next) = rows_around(fine, coarse);
            let share = factor * (if own == y { NEAR } else { 0.0 } + if next == y { NEXT } else { 0.0 });
            let (values, weights) = (self.row(fine), &self.weight[fine * width..][..width]);
            let sums = &mut *sums;
            widest(
                #[inline(always)]
                move || {
                    for ((sum, &value), &weight) in zip(zip(sums, values), weights) {
                        // Without a branch: contact and gaps have no order.
                        let share = if weight > 0.0 { 0.0 } else { share };
                        *sum += share * value;
                    }
                },
            );
        }
    }
}

/// Adds a row of cells to its blocks: the transpose of linear interpolation along a row.
fn spread_back(fine: &[f32], blocks: &mut [f32]) {
    widest(
        #[inline(always)]
        move || {
            let count = fine.len().div_ceil(2);
            let at = |i: usize| fine.get(i).copied().unwrap_or(0.0);
            // Two cells, and the nearest one on each side.
            let whole = zip(fine[1..].windows(4).step_by(2), blocks.iter_mut().skip(1));
            let inner = fine.len().saturating_sub(3) / 2;
            for (cells, block) in whole.take(inner) {
                *block += NEAR * (cells[1] + cells[2]) + NEXT * (cells[0] + cells[3]);
            }
            for x in [0].into_iter().chain(inner + 1..count) {
                // At the ends of the row the outermost block stands for the one beyond.
                let left = if x == 0 { at(0) } else { at(2 * x - 1) };
                let right = if x + 1 == count { at(2 * x + 1) } else { at(2 * x + 2) };
                blocks[x] += NEAR * (at(2 * x) + at(2 * x + 1)) + NEXT * (left + right);
            }
        },
    );
}

/// Sums over the finest blocks in one band of rows.
#[derive(Debug, Default)]
pub struct BandSums<'a> {
    width: usize,
    decay: f32,
    values: &'a mut [f32],
    /// The sums for the rows of blocks above and below the band.
    beyond: &'a mut [f32],
    line: Vec<f32>,
}

impl BandSums<'_> {
    /// Whether there are sums; without levels, an extension by zeros needs none.
    pub fn is_wanted(&self) -> bool {
        self.width > 0
    }

    /// Adds row y of the window, zero outside the set, for [`Extension::extend`].
    pub fn add(&mut self, y: usize, row: &[f32]) {
        gather(row, &mut self.values[y % BAND / 2 * self.width..][..self.width]);
    }

    /// Adds row y of the window, zero on the set, for [`Extension::collect`].
    pub fn add_transposed(&mut self, y: usize, row: &[f32]) {
        let Self { width, decay, values, beyond, line } = self;
        line.fill(0.0);
        spread_back(row, line);
        let (own, rows) = (y % BAND / 2, values.len() / *width);
        let (above, below) = beyond.split_at_mut(*width);
        let add = |share: f32, to: &mut [f32]| {
            for (to, &value) in zip(to, &*line) {
                *to += share * value;
            }
        };
        add(NEAR * *decay, &mut values[own * *width..][..*width]);
        let next =
            if y.is_multiple_of(2) { own.checked_sub(1) } else { Some(own + 1).filter(|&own| own < rows) };
        add(
            NEXT * *decay,
            match next {
                Some(next) => &mut values[next * *width..][..*width],
                None if y.is_multiple_of(2) => above,
                None => below,
            },
        );
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
    /// More than two bands of rows.
    const HEIGHT: usize = 70;

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
        extension.set(&set, Window { x: 0, y: 0, width: 40, height: 90 }, 0.1);
        extension.set(&CellSet::from_rows([(7, [4, 9, 20])]), WINDOW, 0.2);
        extension.set(&set, WINDOW, DECAY);
        extension
    }

    /// r on the set, and the extended values elsewhere.
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
        let outside: Vec<f32> = u.iter().zip(mask).map(|(u, m)| u * (1.0 - m)).collect();
        for (y, row) in outside.chunks_exact(WIDTH).enumerate() {
            e.bands(1)[y / BAND].add_transposed(y, row);
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
