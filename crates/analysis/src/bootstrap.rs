//! Errors by resampling surfaces.

use crate::ensemble::Statistics;
use numerics::sum::sum;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Bootstrap over surfaces: number of resamples, and seed of the generator (xoshiro256++).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bootstrap {
    /// Number of resamples.
    pub resamples: usize,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for Bootstrap {
    /// 400 resamples: the error itself is then known to about 4 per cent.
    fn default() -> Self {
        Self { resamples: 400, seed: 0x00B0_0757_12A9 }
    }
}

impl Bootstrap {
    /// The draws: for each resample, `surfaces` indices in `0..surfaces` with repetition.
    ///
    /// They depend on the seed and the number of surfaces alone, so that all curves of a run are resampled
    /// with the same surfaces (curves of different D_f share phases, and their errors are correlated).
    ///
    /// ```
    /// let b = analysis::Bootstrap { resamples: 3, seed: 1 };
    /// assert_eq!(b.draws(5), b.draws(5));
    /// assert!(b.draws(5).iter().flatten().all(|&i| i < 5));
    /// ```
    pub fn draws(&self, surfaces: usize) -> Vec<Vec<usize>> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(self.seed);
        // Multiply-and-shift: the bias is below surfaces / 2^64.
        let mut pick = || ((u128::from(random.next_u64()) * surfaces as u128) >> 64) as usize;
        (0..self.resamples).map(|_| (0..surfaces).map(|_| pick()).collect()).collect()
    }

    /// Standard error of any number computed from a choice of surfaces: the standard deviation of `quantity`
    /// over the draws.
    ///
    /// `None` for fewer than two surfaces, or when `quantity` exists for fewer than half of the draws (or
    /// two).
    pub fn standard_error(
        &self,
        surfaces: usize,
        quantity: impl FnMut(&[usize]) -> Option<f64>,
    ) -> Option<f64> {
        let values = self.values(surfaces, quantity)?;
        let n = values.len() as f64;
        let mean = sum(values.iter().copied()) / n;
        Some((sum(values.iter().map(|v| (v - mean) * (v - mean))) / (n - 1.0)).sqrt())
    }

    /// Half the width of the interval that holds the central 68.3 % of the draws: the standard error of a
    /// normal quantity, and still a sensible number for one with long tails (a ratio, a crossing of nearly
    /// parallel lines).
    ///
    /// `None` as for [`Bootstrap::standard_error`].
    pub fn half_width(&self, surfaces: usize, quantity: impl FnMut(&[usize]) -> Option<f64>) -> Option<f64> {
        let mut values = self.values(surfaces, quantity)?;
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
        Some((at(0.8413) - at(0.1587)) / 2.0)
    }

    /// The quantity of every draw for which it exists; `None` when those are too few to speak of scatter.
    fn values(&self, surfaces: usize, mut quantity: impl FnMut(&[usize]) -> Option<f64>) -> Option<Vec<f64>> {
        if surfaces < 2 {
            return None;
        }
        let values: Vec<f64> =
            self.draws(surfaces).iter().filter_map(|d| quantity(d)).filter(|v| v.is_finite()).collect();
        (values.len() >= 2 && 2 * values.len() >= self.resamples).then_some(values)
    }
}

impl Statistics {
    /// Relative standard error, where there is one.
    pub fn relative_error(&self) -> Option<f64> {
        self.standard_error.map(|e| e / self.mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bootstrap error of a mean has itself a relative error of 1/sqrt(2 x 400) = 3.5 %, and counts n,
    /// not n - 1.
    const BOOTSTRAP_SCATTER: f64 = 0.12;

    #[test]
    fn the_error_of_a_mean_is_the_textbook_one() {
        let x: Vec<f64> = (0..30).map(|i| 1.0 + f64::from(i % 7)).collect();
        let se = Bootstrap::default()
            .standard_error(x.len(), |d| Some(d.iter().map(|&i| x[i]).sum::<f64>() / d.len() as f64))
            .unwrap();
        let textbook = crate::statistics(&x).unwrap().standard_error.unwrap();
        approx::assert_relative_eq!(se, textbook, max_relative = BOOTSTRAP_SCATTER);
        // One wild draw in a hundred ruins a standard deviation and not an interval.
        let mut count = 0;
        let wild = Bootstrap::default().half_width(x.len(), |d| {
            count += 1;
            let mean = d.iter().map(|&i| x[i]).sum::<f64>() / d.len() as f64;
            Some(if count % 100 == 0 { 1e9 } else { mean })
        });
        approx::assert_relative_eq!(wild.unwrap(), textbook, max_relative = 2.0 * BOOTSTRAP_SCATTER);
    }

    #[test]
    fn no_error_without_scatter_to_resample() {
        let b = Bootstrap::default();
        assert_eq!(b.standard_error(1, |_| Some(1.0)), None);
        assert_eq!(b.standard_error(0, |_| Some(1.0)), None);
        assert_eq!(b.standard_error(5, |_| None), None);
        assert_eq!(b.half_width(5, |_| None), None);
        assert_eq!(b.standard_error(5, |_| Some(f64::NAN)), None);
    }

    #[test]
    fn the_stream_is_written_down() {
        // xoshiro256++ seeded by splitmix64 from 7, computed independently: results must stay reproducible
        // for years.
        let b = Bootstrap { resamples: 1, seed: 7 };
        assert_eq!(b.draws(10), [[0, 1, 7, 4, 9, 4, 7, 3, 9, 0]]);
        assert_ne!(b.draws(10), Bootstrap { seed: 8, ..b }.draws(10));
    }
}
