//! The plane of least squares.

use contact_model::Cells;

/// The plane of least squares through heights at every cell of a rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPlane {
    cells: Cells,
    /// Mean height.
    pub mean: f64,
    /// Rise from one column, and from one row, to the next.
    pub slopes: [f64; 2],
}

/// Coordinates of mean 0: along both axes they are orthogonal on a full rectangle.
fn about(i: usize, count: usize) -> f64 {
    i as f64 - 0.5 * (count as f64 - 1.0)
}

/// Sum of the squares of these coordinates along one axis.
fn square(count: usize) -> f64 {
    (0..count).map(|i| about(i, count).powi(2)).sum()
}

impl MapPlane {
    /// Fits the heights of all cells, row-major. Along an axis of one cell the slope is 0. Cost O(N).
    ///
    /// ```
    /// use surface_gen::MapPlane;
    /// let plane = MapPlane::fit([3, 2].into(), [0.0, 1.0, 2.0, 4.0, 5.0, 6.0]);
    /// assert_eq!((plane.mean, plane.slopes), (3.0, [1.0, 4.0]));
    /// assert_eq!(plane.height(4), 5.0);
    /// // Variances 2/3 along x and 4 along y.
    /// assert!((plane.variance() - 14.0 / 3.0).abs() < 1e-14);
    /// ```
    pub fn fit(cells: Cells, heights: impl IntoIterator<Item = f64>) -> Self {
        let Cells { columns, rows } = cells;
        let (mut mean, mut x, mut y) = (0.0, 0.0, 0.0);
        for (i, h) in heights.into_iter().enumerate() {
            mean += h;
            x += h * about(i % columns, columns);
            y += h * about(i / columns, rows);
        }
        let slope = |sum: f64, count: usize, others: usize| {
            if count > 1 { sum / (square(count) * others as f64) } else { 0.0 }
        };
        let slopes = [slope(x, columns, rows), slope(y, rows, columns)];
        Self { cells, mean: mean / (columns * rows) as f64, slopes }
    }

    /// Height of the plane at cell number i.
    pub fn height(&self, i: usize) -> f64 {
        let Cells { columns, rows } = self.cells;
        self.mean + self.slopes[0] * about(i % columns, columns) + self.slopes[1] * about(i / columns, rows)
    }

    /// Variance of the heights of the plane.
    pub fn variance(&self) -> f64 {
        let along = |slope: f64, count: usize| slope * slope * (square(count) / count as f64);
        along(self.slopes[0], self.cells.columns) + along(self.slopes[1], self.cells.rows)
    }
}
