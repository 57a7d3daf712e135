//! The grid of cells, rectangular windows of it, and lengths of transforms.

use crate::tuning::Tuning;
use contact_model::{Cells, HeightMap};
use numerics::fourier::fast_length;

/// Rounding of the ratio of two sides.
const ROUNDING: f64 = 1e-14;

/// A grid of equal cells, row-major. Lengths are counted in `c = sqrt(dx dy)`, so that a cell has area 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Number of columns, along x.
    pub columns: usize,
    /// Number of rows, along y.
    pub rows: usize,
    /// `dx / c`; `dy / c` is its reciprocal.
    pub stretch: f64,
}

impl Grid {
    /// Square cells.
    #[cfg(test)]
    pub fn square(columns: usize, rows: usize) -> Self {
        Self { columns, rows, stretch: 1.0 }
    }

    /// The grid of a map.
    pub fn of(map: &HeightMap) -> Self {
        Self::of_cells(map.cells(), map.dx(), map.dy())
    }

    /// The grid of cells with these sides.
    pub fn of_cells(cells: Cells, dx: f64, dy: f64) -> Self {
        let aspect = dx / dy;
        // A ratio that misses 1 by rounding is a square cell.
        let stretch = if (aspect - 1.0).abs() < ROUNDING { 1.0 } else { aspect.sqrt() };
        Self { columns: cells.columns, rows: cells.rows, stretch }
    }

    /// Number of cells.
    pub fn count(self) -> usize {
        self.columns * self.rows
    }

    /// Whether the cells are squares.
    pub fn has_square_cells(self) -> bool {
        self.stretch.to_bits() == 1f64.to_bits()
    }

    /// Sides of a cell, `(dx / c, dy / c)`.
    pub fn cell(self) -> (f64, f64) {
        (self.stretch, self.stretch.recip())
    }

    /// The window that is the whole grid.
    pub fn window(self) -> Window {
        Window { x: 0, y: 0, width: self.columns, height: self.rows }
    }
}

/// A rectangle of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x: usize,
    /// First row.
    pub y: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

impl Window {
    /// Number of cells.
    pub fn count(self) -> usize {
        self.width * self.height
    }

    /// The smallest window that holds both.
    pub fn union(self, other: Self) -> Self {
        let (x, y) = (self.x.min(other.x), self.y.min(other.y));
        let width = (self.x + self.width).max(other.x + other.width) - x;
        let height = (self.y + self.height).max(other.y + other.height) - y;
        Self { x, y, width, height }
    }

    /// Whether a plan for this window also serves another: it holds it, and is not so large that a new plan
    /// is cheaper.
    pub fn serves(self, wanted: Self, tuning: &Tuning) -> bool {
        self.union(wanted) == self && wanted.count() as f64 >= tuning.kept_window * self.count() as f64
    }
}

/// Circular lengths of the transform of a window (columns, rows).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lengths {
    /// Circular length along x.
    pub x: usize,
    /// Circular length along y.
    pub y: usize,
}

/// A length of transforms from `least` on that is even (of a real transform along x half of the waves are
/// kept) and contains a power of two of about its sixteenth part: 576, 1152 and 2304 took 0.95, 0.86 and 1.02
/// of the time of 540, 1080 and 2160 (2026-11, EPYC, single precision), 1024 0.59 of that of 1000.
fn good_length(least: usize) -> usize {
    let share = (least / 16).max(2);
    fast_length(least, 1 << share.ilog2())
}

impl Lengths {
    fn map(window: Window, length: impl Fn(usize) -> usize) -> Self {
        Self { x: length(window.width), y: length(window.height) }
    }

    /// Shortest good lengths that leave a kernel of full reach free of wrap-around.
    ///
    /// For an even kernel `2 (n - 1)` is enough: the only lag that meets its mirror image is `n - 1`, and it
    /// is equal to it.
    pub fn free(window: Window) -> Self {
        Self::map(window, |n| good_length(2 * (n - 1)))
    }

    /// Good lengths of a torus that represents lags up to `0.5 share n` exactly; farther ones are taken the
    /// shorter way round.
    ///
    /// Positive definite: the kernel's symbol falls as 1/q, what the kink half way round adds as 1/q^2, less
    /// from the first wave on.
    pub fn shortened(window: Window, share: f64) -> Self {
        let free = Self::free(window);
        let short = Self::map(window, |n| good_length((share * n as f64) as usize - 1));
        Self { x: short.x.min(free.x), y: short.y.min(free.y) }
    }

    /// Shortest good lengths that leave a kernel free of wrap-around which ends below a lag of `reach` cells.
    pub fn reaching(window: Window, reach: usize) -> Self {
        Self::map(window, |n| good_length(n + reach.min(n) - 1))
    }

    /// Shortest good lengths of a torus that holds the window once, with two cells between its opposite edges:
    /// without them the inverse of the wrapped kernel takes these edges for neighbours.
    pub fn torus(window: Window) -> Self {
        Self::map(window, |n| good_length(n + 2))
    }

    /// The same where the grid itself repeats: never longer than its own period, which is exact at every lag.
    pub fn within_period(self, grid: Grid) -> Self {
        Self { x: self.x.min(grid.columns), y: self.y.min(grid.rows) }
    }

    /// Number of points of the transform.
    pub fn points(self) -> usize {
        self.x * self.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(x: usize, y: usize, width: usize, height: usize) -> Window {
        Window { x, y, width, height }
    }

    #[test]
    fn a_ratio_of_sides_that_misses_one_by_rounding_is_a_square_cell() {
        let map = |width: f64| HeightMap::new([3, 10], [width, 1.0], vec![0.0; 30]).unwrap();
        // A few units in the last place: the root of a single one is 1.
        let rounded = map(0.3 * (1.0 + 4.0 * f64::EPSILON));
        assert!(rounded.dx().total_cmp(&rounded.dy()).is_ne() && Grid::of(&rounded).has_square_cells());
        let (oblong, tall) = (Grid::of(&map(0.33)), Grid::of(&map(0.27)));
        assert!(!oblong.has_square_cells() && !tall.has_square_cells());
        approx::assert_relative_eq!(oblong.stretch, 1.1_f64.sqrt(), max_relative = 1e-14);
    }

    #[test]
    fn lengths_of_windows() {
        assert_eq!(Lengths::free(window(0, 0, 2049, 1)), Lengths { x: 4096, y: 2 });
        assert_eq!(Lengths::shortened(window(0, 0, 48, 48), 1.5), Lengths { x: 72, y: 72 });
        assert_eq!(Lengths::torus(window(0, 0, 13, 2)), Lengths { x: 16, y: 4 });
        assert_eq!(Lengths::torus(window(0, 0, 512, 2049)), Lengths { x: 576, y: 2304 });
        assert_eq!(Lengths::reaching(window(0, 0, 1024, 20), 48), Lengths { x: 1152, y: 40 });
        assert_eq!(Lengths::free(window(0, 0, 1001, 1025)), Lengths { x: 2048, y: 2048 });
        let grid = Grid::square(13, 1);
        assert_eq!(Lengths::free(grid.window()).within_period(grid), Lengths { x: 13, y: 1 });
        assert_eq!(Lengths::free(window(2, 0, 5, 1)).within_period(grid), Lengths { x: 8, y: 1 });
    }

    #[test]
    fn a_plan_serves_what_lies_inside_it() {
        let tuning = Tuning::DEFAULT;
        // Columns 2 to 11, rows 3 to 10.
        let planned = window(2, 3, 10, 8);
        for inside in [planned, window(3, 4, 9, 7)] {
            assert!(planned.serves(inside, &tuning), "{inside:?}");
        }
        // One side sticks out at a time.
        for outside in [window(1, 3, 9, 8), window(2, 2, 10, 7), window(3, 3, 10, 8), window(2, 4, 10, 8)] {
            assert!(!planned.serves(outside, &tuning), "{outside:?}");
        }
        // Kept for six tenths of its area, not for half of it.
        let planned = window(0, 0, 10, 10);
        assert!(
            planned.serves(window(0, 0, 10, 6), &tuning) && !planned.serves(window(0, 0, 10, 5), &tuning)
        );
        assert_eq!(window(3, 9, 1, 1).union(window(7, 4, 1, 1)), window(3, 4, 5, 6));
    }

    #[test]
    fn a_cell_has_area_one() {
        let map = HeightMap::new([4, 2], [1.0, 8.0], vec![0.0; 8]);
        let grid = Grid::of(&map.unwrap());
        assert_eq!((grid.columns, grid.rows, grid.count()), (4, 2, 8));
        let (a, b) = grid.cell();
        approx::assert_relative_eq!(a / b, 1.0 / 16.0, max_relative = 1e-15);
        approx::assert_relative_eq!(a * b, 1.0, max_relative = 1e-15);
    }
}
