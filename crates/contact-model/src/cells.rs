//! Rectangles and their cells.

/// Sides of a rectangle: Lx along x and Ly along y, in one length unit.
///
/// ```
/// use contact_model::Size;
/// let size = Size { x: 4.0, y: 1.0 };
/// assert_eq!((size.length(), size.area()), (2.0, 4.0));
/// assert_eq!(Size::from(3.0), Size { x: 3.0, y: 3.0 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Lx.
    pub x: f64,
    /// Ly.
    pub y: f64,
}

impl Size {
    /// `L = sqrt(Lx Ly)`, the length in `F_bar` and `k_bar`; the side of a square to the last bit.
    pub fn length(self) -> f64 {
        geometric_mean(self.x, self.y)
    }

    /// Nominal contact area `A0 = Lx Ly`.
    pub fn area(self) -> f64 {
        self.x * self.y
    }

    /// Whether both sides are the same.
    pub fn is_square(self) -> bool {
        self.x.to_bits() == self.y.to_bits()
    }

    /// Shorter side.
    pub fn shorter(self) -> f64 {
        self.x.min(self.y)
    }
}

/// A square.
impl From<f64> for Size {
    fn from(side: f64) -> Self {
        Self { x: side, y: side }
    }
}

/// `[Lx, Ly]`.
impl From<[f64; 2]> for Size {
    fn from([x, y]: [f64; 2]) -> Self {
        Self { x, y }
    }
}

/// Number of cells of a grid: columns along x, rows along y.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cells {
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
}

impl Cells {
    /// The grid with this number of columns whose cells are nearest to squares.
    ///
    /// ```
    /// use contact_model::{Cells, Size};
    /// assert_eq!(Cells::nearly_square(64, Size { x: 4.0, y: 3.0 }), Cells { columns: 64, rows: 48 });
    /// assert_eq!(Cells::nearly_square(64, Size::from(0.1)), Cells::from(64));
    /// ```
    pub fn nearly_square(columns: usize, size: Size) -> Self {
        let rows =
            if size.is_square() { columns } else { (columns as f64 * (size.y / size.x)).round() as usize };
        Self { columns, rows: rows.max(usize::from(columns > 0)) }
    }

    /// Bytes of a map: one `f64` for each cell.
    ///
    /// ```
    /// assert_eq!(contact_model::Cells::from(1000).map_bytes(), 8e6);
    /// ```
    pub fn map_bytes(self) -> f64 {
        8.0 * self.columns as f64 * self.rows as f64
    }

    /// Columns times rows, unless no `usize` holds it.
    pub fn checked_count(self) -> Option<usize> {
        self.columns.checked_mul(self.rows)
    }
}

/// As many rows as columns.
impl From<usize> for Cells {
    fn from(cells: usize) -> Self {
        Self { columns: cells, rows: cells }
    }
}

/// `[columns, rows]`.
impl From<[usize; 2]> for Cells {
    fn from([columns, rows]: [usize; 2]) -> Self {
        Self { columns, rows }
    }
}

/// `sqrt(a b)` without overflow on the way; a itself where both are the same.
fn geometric_mean(a: f64, b: f64) -> f64 {
    if a.to_bits() == b.to_bits() { a } else { a.sqrt() * b.sqrt() }
}
