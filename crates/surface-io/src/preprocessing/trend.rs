//! Least-squares polynomials in x and y, and which trend is subtracted.

use super::form::{Form, FormKind};
use super::normal_equations::{MOST, NormalEquations};
use crate::error::ContentError;
use crate::keyword::keywords;
use contact_model::Cells;
use contact_model::units::number;

keywords! {
    /// Trend that is subtracted from the heights.
    #[derive(Default)]
    Detrend: "detrend";
    /// No trend.
    #[default]
    Nothing = "none",
    /// The mean height.
    Mean = "mean",
    /// The plane `a + b x + c y` of least squares: a tilted specimen.
    Plane = "plane",
    /// `a + b x + c y + d x^2 + e x y + f y^2` of least squares: a curved one.
    Quadric = "quadric",
    /// The sphere of least squares: a ball, a lens.
    Sphere = "sphere",
    /// The circular cylinder of least squares, its axis in any direction, tilted or not: a roller, a wire.
    Cylinder = "cylinder",
}

/// The trend of least squares, before it is subtracted.
#[derive(Debug)]
pub(super) enum FittedTrend {
    /// A mean height, a plane or a quadric.
    Polynomial(Trend),
    /// A sphere or a cylinder.
    Form(Form),
}

impl FittedTrend {
    /// Fits the heights that are not NaN; `None` for nothing to subtract.
    pub(super) fn new(
        detrend: Detrend,
        cells: Cells,
        cell: [f64; 2],
        heights: &[f64],
    ) -> Result<Option<Self>, ContentError> {
        let form = |kind| Form::fit(kind, cells, cell, heights).map(|form| Some(Self::Form(form)));
        match detrend {
            Detrend::Sphere => form(FormKind::Sphere),
            Detrend::Cylinder => form(FormKind::Cylinder),
            _ => Ok(detrend.fit(cells, heights)?.map(Self::Polynomial)),
        }
    }

    pub(super) fn subtract(&self, heights: &mut [f64]) {
        match self {
            Self::Polynomial(trend) => trend.subtract(heights),
            Self::Form(form) => form.subtract(heights),
        }
    }

    /// What is subtracted, for records.
    pub(super) fn words(&self, detrend: Detrend) -> String {
        let subtracted = format!("the {} of least squares subtracted", detrend.word());
        let Self::Form(form) = self else { return subtracted };
        let radius = form.radius();
        let side = if radius > 0.0 { "a hill" } else { "a hollow" };
        format!("{subtracted}: radius {} ({side})", number(radius.abs()))
    }
}

/// Coefficients of Legendre's polynomials in coordinates that run from -1 to 1 along each side.
#[derive(Debug)]
pub(super) struct Trend {
    cells: Cells,
    unknowns: usize,
    coefficients: [f64; MOST],
    /// What the coefficients are multiplied by.
    unit: f64,
    middle: f64,
}

impl Detrend {
    /// Unknowns of a polynomial in x and y, of x alone along one row; none where it is no polynomial.
    fn unknowns(self, rows: usize) -> usize {
        match self {
            Self::Nothing | Self::Sphere | Self::Cylinder => 0,
            Self::Mean => 1,
            Self::Plane => 2 + usize::from(rows > 1),
            Self::Quadric => 3 * (1 + usize::from(rows > 1)),
        }
    }

    /// Fits the heights that are not NaN; `None` for nothing to subtract.
    pub(super) fn fit(self, cells: Cells, heights: &[f64]) -> Result<Option<Trend>, ContentError> {
        let unknowns = self.unknowns(cells.rows);
        if unknowns == 0 {
            return Ok(None);
        }
        let measured = || heights.iter().enumerate().filter(|(_, h)| !h.is_nan());
        let (low, high) =
            measured().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (_, &h)| (a.min(h), b.max(h)));
        // About the middle of the range and in units of half of it: nothing overflows, and an offset costs
        // its own rounding only.
        let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
        let unit = if half > 0.0 { half } else { 1.0 };
        let mut equations = NormalEquations::new(unknowns);
        let mut present = 0;
        for (row, heights) in heights.chunks_exact(cells.columns).enumerate() {
            // Row by row: sums of sums lose fewer digits than one long sum.
            let mut of_row = NormalEquations::new(unknowns);
            for (column, &h) in heights.iter().enumerate() {
                if !h.is_nan() {
                    present += 1;
                    of_row.add(&basis(row, column, cells), (h - middle) / unit);
                }
            }
            equations.add_all(&of_row);
        }
        let coefficients = equations.solve().ok_or(ContentError::Trend { present, unknowns })?;
        Ok(Some(Trend { cells, unknowns, coefficients, unit, middle }))
    }
}

impl Trend {
    fn at(&self, i: usize) -> f64 {
        let basis = basis(i / self.cells.columns, i % self.cells.columns, self.cells);
        (0..self.unknowns).map(|i| self.coefficients[i] * basis[i]).sum()
    }

    pub(super) fn subtract(&self, heights: &mut [f64]) {
        for (i, h) in heights.iter_mut().enumerate() {
            *h = (*h - self.middle) - self.unit * self.at(i);
        }
    }

    /// Puts its own heights at the undefined points.
    pub(super) fn fill(&self, heights: &mut [f64]) {
        for (i, h) in heights.iter_mut().enumerate().filter(|(_, h)| h.is_nan()) {
            *h = self.middle + self.unit * self.at(i);
        }
    }
}

/// 1, x, y and the three products of second order, nearly orthogonal over the whole rectangle; along one row
/// 1, x and x^2.
fn basis(row: usize, column: usize, cells: Cells) -> [f64; MOST] {
    let to_unit = |i: usize, count: usize| (2.0 * i as f64 + 1.0) / count as f64 - 1.0;
    let (x, y) = (to_unit(column, cells.columns), to_unit(row, cells.rows));
    let square = 1.5 * x * x - 0.5;
    if cells.rows == 1 {
        return [1.0, x, square, 0.0, 0.0, 0.0];
    }
    [1.0, x, y, square, x * y, 1.5 * y * y - 0.5]
}
