//! Windows over maps that are not periodic.

use contact_model::{Cells, HeightMap, Result, Size};
use std::f64::consts::PI;
use surface_gen::hann_window;

/// Mean square of Hann's window along one axis.
const MEAN_SQUARE: f64 = 0.375;

/// What is laid over a map before its spectrum is taken, scaled so that the mean of the squares is 1 and a
/// homogeneous surface keeps its spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Taper {
    /// Nothing: for periodic maps.
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
                down.iter().flat_map(|d| across.iter().map(move |a| a * d / MEAN_SQUARE)).collect()
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

    /// Of how many neighbouring waves one is as good as independent, where the spectrum is smooth: the mean
    /// fourth power of the factors; 1 without a window, (35/18)^2 = 3.8 for [`Taper::Hann`].
    pub(crate) fn correlated_waves(self, cells: Cells, size: Size) -> f64 {
        let factors = self.factors(cells, size);
        factors.iter().map(|f| f.powi(4)).sum::<f64>() / factors.len() as f64
    }

    /// The map about its mean under the window.
    ///
    /// # Errors
    /// Those of [`HeightMap::new`], where a height leaves the range of f64.
    pub(crate) fn over(self, map: &HeightMap) -> Result<HeightMap> {
        if self == Self::None {
            return Ok(map.clone());
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
    fn the_hann_window_is_that_of_surface_gen() {
        let map = HeightMap::from_fn([12, 9], [2.0, 1.0], |ix, iy| ((ix * 7 + iy * 5) % 11) as f64).unwrap();
        let (mine, theirs) = (Taper::Hann.over(&map).unwrap(), surface_gen::windowed(&map).unwrap());
        for (a, b) in mine.heights().iter().zip(theirs.heights()) {
            assert!((a - b).abs() < 1e-13);
        }
        assert_relative_eq!(
            Taper::Hann.correlated_waves(map.cells(), map.size()),
            (35.0_f64 / 18.0).powi(2),
            max_relative = 1e-12
        );
    }
}
