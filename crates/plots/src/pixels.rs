//! The cell that each pixel of a map shows, so that a picture with fewer pixels than cells keeps their shares.

use contact_model::{Cells, Size};
use std::ops::Range;

/// Sides of a picture whose ratio to a whole number of pixels a cell differs by less than this have that
/// number of pixels a cell.
const WHOLE: f64 = 0.01;

/// Steps of the thresholds along the columns and the rows: 1/g and 1/g^2 with g^3 = g + 1. Their multiples
/// modulo 1 are spread evenly over every neighbourhood and over every lattice of pixels.
///
/// Source: M. Roberts, "The unreasonable effectiveness of quasirandom sequences" (2018), R2.
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// A picture of a field on cells, of another number of pixels.
///
/// Each pixel shows one of the cells that lie on it, never a value between them. In the order of their values
/// these cells take up parts of the numbers from 0 to 1 that are as long as their areas on the pixel; the
/// pixel shows the cell with its threshold, and the thresholds of neighbouring pixels are spread evenly from 0
/// to 1. The share of the area in contact, or in any class, the mean, and the distribution of the values are
/// therefore those of the field, to within 0.7 over the root of the number of pixels in parts of the area.
///
/// The pixels with the smallest and the largest value show these, so that a single cell in contact is seen.
pub(crate) struct Pixels<'a> {
    cells: Cells,
    /// Columns and rows of pixels.
    grid: Cells,
    values: &'a [f64],
    /// Pixels that show the smallest and the largest finite value, with the cells of these.
    ends: [Option<(usize, usize)>; 2],
}

impl<'a> Pixels<'a> {
    /// A picture with this number of columns and rows of pixels; values row-major, not finite where undefined.
    ///
    /// Cost: linear in the number of cells.
    pub fn new(cells: Cells, pixels: Cells, values: &'a [f64]) -> Self {
        let reduced = pixels.columns < cells.columns || pixels.rows < cells.rows;
        let defined = || values.iter().enumerate().filter(|(_, v)| reduced && v.is_finite());
        let ends = [defined().min_by(|a, b| a.1.total_cmp(b.1)), defined().max_by(|a, b| a.1.total_cmp(b.1))];
        let pixel = |cell: usize| {
            let over = |i: usize, pixels: usize, cells: usize| (2 * i + 1) * pixels / (2 * cells);
            let (x, y) = (cell % cells.columns, cell / cells.columns);
            over(y, pixels.rows, cells.rows) * pixels.columns + over(x, pixels.columns, cells.columns)
        };
        Self { cells, grid: pixels, values, ends: ends.map(|end| end.map(|(cell, _)| (pixel(cell), cell))) }
    }

    /// The cell that a pixel shows, both counted along rows from the lower left corner.
    pub fn cell(&self, x: usize, y: usize) -> usize {
        let columns = self.cells.columns;
        if self.grid == self.cells {
            return y * columns + x;
        }
        let (across, up) =
            (covered(x, self.grid.columns, columns), covered(y, self.grid.rows, self.cells.rows));
        if across.len() == 1 && up.len() == 1 {
            return up.start * columns + across.start;
        }
        let pixel = y * self.grid.columns + x;
        if let Some((_, cell)) = self.ends.iter().flatten().find(|(at, _)| *at == pixel) {
            return *cell;
        }
        let wide: Vec<usize> = across.clone().map(|i| overlap(x, i, self.grid.columns, columns)).collect();
        let mut parts: Vec<(usize, usize)> = Vec::with_capacity(across.len() * up.len());
        for row in up {
            let high = overlap(y, row, self.grid.rows, self.cells.rows);
            let cells = across.clone().zip(&wide);
            parts.extend(cells.map(|(column, wide)| (row * columns + column, wide * high)));
        }
        parts.sort_by(|a, b| self.values[a.0].total_cmp(&self.values[b.0]));
        let area = columns as f64 * self.cells.rows as f64;
        let mut left = threshold(x, y) * area;
        let shown = parts.iter().find(|(_, part)| {
            left -= *part as f64;
            left < 0.0
        });
        shown.or(parts.last()).map_or(0, |(cell, _)| *cell)
    }
}

/// The cells that a pixel covers along one side, which has this number of pixels and of cells.
fn covered(pixel: usize, pixels: usize, cells: usize) -> Range<usize> {
    pixel * cells / pixels..((pixel + 1) * cells).div_ceil(pixels)
}

/// Length that a cell and a pixel have in common, in parts of which a pixel has as many as there are cells.
fn overlap(pixel: usize, cell: usize, pixels: usize, cells: usize) -> usize {
    ((pixel + 1) * cells).min((cell + 1) * pixels) - (pixel * cells).max(cell * pixels)
}

/// A number from 0 to 1.
fn threshold(x: usize, y: usize) -> f64 {
    (0.5 + x as f64 * STEPS[0] + y as f64 * STEPS[1]).fract()
}

/// Pixels of a picture with about `side` of them along its longer side: a whole number for each cell up to
/// `side` cells, and square ones. The shorter side has at least the share `shortest` of the longer one.
pub(crate) fn raster(cells: Cells, size: Size, side: usize, shortest: f64) -> Cells {
    let longer = size.x.max(size.y);
    let share = [size.x / longer, size.y / longer];
    let counts = [cells.columns, cells.rows];
    // The finest cells along the longer side.
    let finest = (counts[0] as f64 / share[0]).max(counts[1] as f64 / share[1]);
    let each = (side as f64 / finest * (1.0 + 1e-9)).round();
    let most = if finest <= side as f64 * (1.0 + 1e-9) { each.max(1.0) * finest } else { side as f64 };
    let along = |share: f64, count: usize| {
        let ideal = most * share.max(shortest);
        let whole = (ideal / count as f64).round() * count as f64;
        let near = (whole - ideal).abs() <= WHOLE * ideal;
        (if near { whole } else { ideal.round() }).max(1.0) as usize
    };
    Cells { columns: along(share[0], counts[0]), rows: along(share[1], counts[1]) }
}

/// The cells that a picture of at most `most` pixels along a side shows, row-major, and its columns and rows:
/// every cell where there are no more. Of several cells on a pixel one is shown, chosen so that shares, means
/// and the smallest and largest value are kept.
///
/// Values are row-major, not finite where undefined. Cost: linear in the number of cells.
///
/// ```
/// // A checkerboard, of which a quarter of the pixels keeps half black.
/// let values: Vec<f64> = (0..400 * 400).map(|i| f64::from((i + i / 400) % 2)).collect();
/// let (pixels, shown) = plots::shown_cells([400, 400].into(), 200, &values);
/// let black = shown.iter().filter(|cell| values[**cell] > 0.5).count();
/// assert_eq!((pixels.columns, pixels.rows, shown.len()), (200, 200, 40_000));
/// assert!(black.abs_diff(20_000) < 100, "{black}");
/// ```
pub fn shown_cells(cells: Cells, most: usize, values: &[f64]) -> (Cells, Vec<usize>) {
    let Cells { columns, rows } = cells;
    let longer = columns.max(rows);
    let along = |count: usize| {
        if longer <= most { count } else { ((count * most + longer / 2) / longer).max(1) }
    };
    let pixels = Cells { columns: along(columns), rows: along(rows) };
    let picture = Pixels::new(cells, pixels, values);
    let shown = (0..pixels.rows).flat_map(|y| (0..pixels.columns).map(move |x| (x, y)));
    (pixels, shown.map(|(x, y)| picture.cell(x, y)).collect())
}

/// What a picture with fewer pixels than cells says of itself; `None` where each cell has a pixel.
///
/// ```
/// let said = plots::reduction([2049, 2049].into(), [1040, 1040].into()).unwrap();
/// assert_eq!(said, "A pixel shows one of about 2.0 × 2.0 cells; areas keep their shares.");
/// assert_eq!(plots::reduction([512, 512].into(), [1024, 1024].into()), None);
/// ```
pub fn reduction(cells: Cells, pixels: Cells) -> Option<String> {
    let ratio = |cells: usize, pixels: usize| (cells as f64 / pixels as f64).max(1.0);
    let (across, up) = (ratio(cells.columns, pixels.columns), ratio(cells.rows, pixels.rows));
    (across.max(up) > 1.0)
        .then(|| format!("A pixel shows one of about {across:.1} × {up:.1} cells; areas keep their shares."))
}
