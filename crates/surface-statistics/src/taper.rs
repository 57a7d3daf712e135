//! Windows over maps that are not periodic.

use contact_model::{Cells, HeightMap, Result, Size};
use std::f64::consts::{PI, TAU};
use surface_gen::{hann_window, windowed};

/// Differences of indices between which waves are correlated: those of Hann's window reach 2.
const NEAR: isize = 3;
/// Squared correlations below this are neglected.
const NEGLIGIBLE: f64 = 1e-4;

/// A window that multiplies the heights of a map before its spectrum is computed, scaled so that its mean
/// square is 1 and a homogeneous surface keeps its spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Taper {
    /// No window, for periodic maps.
    None,
    /// Hann's window along x times that along y, `sin^2(pi x/Lx) sin^2(pi y/Ly)` at the cells' centres: that
    /// of [`surface_gen::windowed`].
    #[default]
    Hann,
    /// `(1 + cos(pi r/R))/2` for `r < R = min(Lx, Ly)/2` about the corner `(columns/2, rows/2)` (integer
    /// division), 0 beyond: the window of the program SurfaceTopography. It uses less of the map than
    /// [`Taper::Hann`].
    RadialHann,
}

impl Taper {
    /// Factors of the heights, row-major, with a mean square of 1.
    pub(crate) fn factors(self, cells: Cells, size: Size) -> Vec<f64> {
        let Cells { columns, rows } = cells;
        let mut factors = match self {
            Self::None => return vec![1.0; columns * rows],
            Self::Hann => {
                let (across, down) = (hann_window(columns), hann_window(rows));
                down.iter().flat_map(|d| across.iter().map(move |a| a * d)).collect()
            }
            Self::RadialHann => radial(cells, size),
        };
        let square = factors.iter().map(|f| f * f).sum::<f64>() / factors.len() as f64;
        let scale = square.sqrt().recip();
        for factor in &mut factors {
            *factor *= scale;
        }
        factors
    }

    /// Squared correlations of the amplitudes of two waves whose indices differ by a vector, where the
    /// spectrum is smooth: of the vectors of up to 3 along each axis those that count, among them the vector
    /// 0 with 1.
    ///
    /// `|sum w^2 exp(-2 pi i (dx ix/columns + dy iy/rows))|^2/(sum w^2)^2`. Cost O(N).
    pub(crate) fn correlations(self, cells: Cells, size: Size) -> Vec<([isize; 2], f64)> {
        if self == Self::None {
            return vec![([0, 0], 1.0)];
        }
        let Cells { columns, rows } = cells;
        let factors = self.factors(cells, size);
        let count = factors.len() as f64;
        // Sums over rows first: the transform along x of each for 7 differences, then along y.
        let turns = |d: isize, n: usize| -> Vec<[f64; 2]> {
            (0..n).map(|i| TAU * d as f64 * (i as f64 / n as f64)).map(|a| [a.cos(), a.sin()]).collect()
        };
        let mut found = Vec::new();
        for dx in -NEAR..=NEAR {
            let along_x = turns(dx, columns);
            let sums: Vec<[f64; 2]> = factors
                .chunks_exact(columns)
                .map(|row| {
                    let terms = row.iter().zip(&along_x).map(|(f, [c, s])| [f * f * c, f * f * s]);
                    terms.fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]])
                })
                .collect();
            for dy in -NEAR..=NEAR {
                let terms = sums.iter().zip(turns(dy, rows));
                let [re, im] = terms
                    .fold([0.0; 2], |sum, ([a, b], [c, s])| [sum[0] + a * c - b * s, sum[1] + a * s + b * c]);
                let square = (re / count).powi(2) + (im / count).powi(2);
                if square > NEGLIGIBLE {
                    found.push(([dx, dy], square));
                }
            }
        }
        found
    }

    /// The map about its mean under the window.
    ///
    /// # Errors
    /// Those of [`windowed`].
    pub(crate) fn over(self, map: &HeightMap) -> Result<HeightMap> {
        match self {
            Self::None => return Ok(map.clone()),
            Self::Hann => return windowed(map),
            Self::RadialHann => {}
        }
        let count = map.heights().len() as f64;
        let mean: f64 =
            map.heights().chunks(map.columns()).map(|row| row.iter().map(|h| h / count).sum::<f64>()).sum();
        let factors = self.factors(map.cells(), map.size());
        let heights = map.heights().iter().zip(factors).map(|(h, f)| (h - mean) * f).collect();
        HeightMap::new(map.cells(), map.size(), heights)
    }
}

fn radial(cells: Cells, size: Size) -> Vec<f64> {
    let Cells { columns, rows } = cells;
    let reach = 0.5 * size.shorter();
    let about = |i: usize, count: usize, side: f64| side * (i as f64 - (count / 2) as f64) / count as f64;
    let mut factors = Vec::with_capacity(columns * rows);
    for iy in 0..rows {
        let y = about(iy, rows, size.y);
        factors.extend((0..columns).map(|ix| {
            let r = about(ix, columns, size.x).hypot(y);
            if r > reach { 0.0 } else { 0.5 + 0.5 * (PI * r / reach).cos() }
        }));
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn factors_and_correlations_are_those_of_the_hann_window() {
        let map = HeightMap::from_fn([12, 9], [2.0, 1.0], |ix, iy| ((ix * 7 + iy * 5) % 11) as f64).unwrap();
        let mean = map.heights().iter().sum::<f64>() / 108.0;
        let factors = Taper::Hann.factors(map.cells(), map.size());
        let over = Taper::Hann.over(&map).unwrap();
        for ((h, f), over) in map.heights().iter().zip(factors).zip(over.heights()) {
            assert!(((h - mean) * f - over).abs() < 1e-13);
        }
        let correlations = Taper::Hann.correlations(map.cells(), map.size());
        let at = |lag: [isize; 2]| correlations.iter().find(|c| c.0 == lag).unwrap().1;
        assert_relative_eq!(at([0, 0]), 1.0, max_relative = 1e-12);
        assert_relative_eq!(at([-1, 0]), 4.0 / 9.0, max_relative = 1e-12);
        assert_relative_eq!(at([2, 1]), 4.0 / 9.0 / 36.0, max_relative = 1e-12);
        let sum: f64 = correlations.iter().map(|c| c.1).sum();
        assert_relative_eq!(sum, (35.0_f64 / 18.0).powi(2), max_relative = 1e-3);
    }
}
