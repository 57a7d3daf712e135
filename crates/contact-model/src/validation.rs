//! Checks of sides, cells and fields. They are apart from these types, because errors hold states and states
//! hold fields.

use crate::cells::{Cells, Size};
use crate::error::{Error, Result, positive};
use crate::fields::Field;

/// Largest ratio of the sides of a cell. Beyond it the influence coefficients lose too many digits, and no
/// instrument samples like that.
const LARGEST_CELL_ASPECT: f64 = 1e4;

impl Size {
    /// Checks both sides.
    ///
    /// # Errors
    /// [`Error::Domain`] for a side that is not positive and finite: `side` where both are the same, else
    /// `side along x` or `side along y`.
    pub fn validate(self) -> Result<()> {
        if self.is_square() {
            return positive("side", self.x).map(|_| ());
        }
        positive("side along x", self.x)?;
        positive("side along y", self.y).map(|_| ())
    }

    /// Checks that a round contact of this radius fits into the rectangle, outside of which the half-space is
    /// free; `name` names the radius in the error.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a radius beyond half the shorter side.
    pub fn admit_radius(self, name: &'static str, radius: f64) -> Result<()> {
        /// A radius of exactly half the shorter side may come out a few roundings larger.
        const ROUNDED_UP: f64 = 1.0 + 8.0 * f64::EPSILON;
        let largest = 0.5 * self.shorter();
        if radius <= largest * ROUNDED_UP {
            Ok(())
        } else {
            Err(Error::OutOfRange { name: name.into(), value: radius, min: 0.0, max: largest })
        }
    }
}

impl Cells {
    /// Checks that these cells can divide a rectangle of this size.
    ///
    /// # Errors
    /// [`Error::Domain`] for no columns or rows, a side that is not positive, or cells whose sides differ by
    /// a factor of more than 1e4.
    ///
    /// ```
    /// use contact_model::{Cells, Size};
    /// assert!(Cells { columns: 100, rows: 1 }.validate(Size { x: 2.0, y: 1.0 }).is_ok());
    /// assert!(Cells { columns: 1, rows: 1 }.validate(Size { x: 1e5, y: 1.0 }).is_err());
    /// ```
    pub fn validate(self, size: Size) -> Result<()> {
        for (name, count) in [("columns", self.columns), ("rows", self.rows)] {
            if count == 0 {
                return Err(Error::domain(name, 0.0, "at least 1"));
            }
        }
        size.validate()?;
        let aspect = (size.x / self.columns as f64) / (size.y / self.rows as f64);
        if !(1.0 / LARGEST_CELL_ASPECT..=LARGEST_CELL_ASPECT).contains(&aspect) {
            let expected = format!("between 1/{LARGEST_CELL_ASPECT} and {LARGEST_CELL_ASPECT}");
            return Err(Error::domain("dx / dy (ratio of the sides of a cell)", aspect, expected));
        }
        Ok(())
    }
}

impl Field {
    /// A field of `columns * rows` values on a rectangle of the given size.
    ///
    /// # Errors
    /// Those of [`Cells::validate`]; [`Error::Shape`] for another number of values.
    pub fn new(cells: impl Into<Cells>, size: impl Into<Size>, values: Vec<f64>) -> Result<Self> {
        let (cells, size) = (cells.into(), size.into());
        cells.validate(size)?;
        if cells.checked_count() != Some(values.len()) {
            let expected = format!("{} rows x {} columns", cells.rows, cells.columns).into();
            return Err(Error::Shape { name: "values".into(), found: values.len(), expected });
        }
        Ok(Self { cells, size, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_number_of_values_is_named() {
        let e = Field::new([3, 2], 1.0, vec![0.0; 5]).unwrap_err();
        assert_eq!(e.to_string(), "values has 5 values: expected 2 rows x 3 columns");
        assert!(Field::new(0, 1.0, vec![]).is_err());
        approx::assert_relative_eq!(Field::new(2, [3.0, 1.0], vec![2.0; 4]).unwrap().integral(), 6.0);
    }
}
