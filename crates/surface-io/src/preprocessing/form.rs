//! Spheres and cylinders of least squares: the nominal form of a ball, a lens, a roller.
//!
//! Both are written so that a plane is one of them: `A (x^2 + y^2 + z^2) + B x + C y + z + E = 0` is a sphere
//! of radius `sqrt(1 + B^2 + C^2 - 4 A E)/(2 |A|)`, in which z is a smooth function of A at 0. The squares of
//! the vertical distances are made smallest by Gauss and Newton's iteration, which starts at the paraboloid.

use super::normal_equations::{MOST, NormalEquations};
use crate::error::ContentError;
use contact_model::Cells;

/// Steps of the iteration; a dozen are enough for half a ball.
const STEPS: usize = 60;
/// The iteration ends where a step changes every height by less than this share of their range.
const SETTLED: f64 = 1e-12;

/// What is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FormKind {
    /// A sphere.
    Sphere,
    /// A circular cylinder whose axis lies in any direction and may be tilted.
    Cylinder,
}

/// A fitted form.
#[derive(Debug)]
pub(super) struct Form {
    kind: FormKind,
    /// A, B, C, E; or A, B, E, direction and slope of the axis: in units of half the diagonal.
    parameters: [f64; MOST],
    places: ScaledPoints,
    middle: f64,
}

/// Places of the points about the middle of the map in units of half its diagonal.
#[derive(Debug, Clone, Copy)]
struct ScaledPoints {
    cells: Cells,
    cell: [f64; 2],
    unit: f64,
}

impl ScaledPoints {
    fn new(cells: Cells, cell: [f64; 2]) -> Self {
        let unit = 0.5 * (cells.columns as f64 * cell[0]).hypot(cells.rows as f64 * cell[1]);
        Self { cells, cell, unit }
    }

    fn at(self, i: usize) -> [f64; 2] {
        let place = |i: usize, count: usize| i as f64 - 0.5 * (count as f64 - 1.0);
        let (row, column) = (i / self.cells.columns, i % self.cells.columns);
        [
            place(column, self.cells.columns) * self.cell[0] / self.unit,
            place(row, self.cells.rows) * self.cell[1] / self.unit,
        ]
    }
}

/// Height of a form at a place and its derivatives; `None` beyond its equator.
fn height(kind: FormKind, p: &[f64; MOST], [x, y]: [f64; 2]) -> Option<(f64, [f64; MOST])> {
    // a z^2 + z + g = 0: the root that stays when a goes to 0.
    let root = |a: f64, g: f64| {
        let square = 1.0 - 4.0 * a * g;
        (square > 0.0).then(|| -2.0 * g / (1.0 + square.sqrt()))
    };
    let mut derivatives = [0.0; MOST];
    match kind {
        FormKind::Sphere => {
            let [a, b, c, e, ..] = *p;
            let z = root(a, a * (x * x + y * y) + b * x + c * y + e)?;
            let over = -1.0 / (1.0 + 2.0 * a * z);
            for (d, part) in derivatives.iter_mut().zip([x * x + y * y + z * z, x, y, 1.0]) {
                *d = over * part;
            }
            Some((z, derivatives))
        }
        FormKind::Cylinder => {
            let [a, b, e, angle, slope, ..] = *p;
            let (sin, cos) = angle.sin_cos();
            let (along, across) = (x * cos + y * sin, y * cos - x * sin);
            let w = root(a, a * across * across + b * across + e)?;
            let over = -1.0 / (1.0 + 2.0 * a * w);
            let stretched = slope.hypot(1.0);
            // Across the axis z is stretched by its tilt.
            let turned = -(2.0 * a * across + b) * along;
            let parts = [across * across + w * w, across, 1.0, turned];
            for (d, part) in derivatives.iter_mut().zip(parts) {
                *d = over * part * stretched;
            }
            derivatives[3] += slope * across;
            derivatives[4] = along + w * slope / stretched;
            Some((slope * along + w * stretched, derivatives))
        }
    }
}

impl Form {
    /// Fits the heights that are not NaN; `cell` has their unit.
    pub(super) fn fit(
        kind: FormKind,
        cells: Cells,
        cell: [f64; 2],
        heights: &[f64],
    ) -> Result<Self, ContentError> {
        let places = ScaledPoints::new(cells, cell);
        let (unit, unknowns) = (places.unit, kind.unknowns());
        let measured = || heights.iter().enumerate().filter(|(_, h)| !h.is_nan());
        let (low, high) =
            measured().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (_, &h)| (a.min(h), b.max(h)));
        let middle = 0.5 * low + 0.5 * high;
        let present = measured().count();
        let undetermined = || ContentError::Trend { present, unknowns };
        let z = |h: f64| (h - middle) / unit;
        let mut parameters =
            kind.start(places, &measured().map(|(i, &h)| (i, z(h)))).ok_or_else(undetermined)?;
        let range = ((high - low) / unit).max(f64::MIN_POSITIVE);
        let squares = |p: &[f64; MOST]| -> Option<f64> {
            let mut sum = 0.0;
            for (i, &h) in measured() {
                sum += (z(h) - height(kind, p, places.at(i))?.0).powi(2);
            }
            Some(sum)
        };
        let mut best = squares(&parameters).ok_or_else(undetermined)?;
        for _ in 0..STEPS {
            let mut equations = NormalEquations::new(unknowns);
            for (i, &h) in measured() {
                let (found, derivatives) =
                    height(kind, &parameters, places.at(i)).ok_or_else(undetermined)?;
                equations.add(&derivatives, z(h) - found);
            }
            let step = equations.solve().ok_or_else(undetermined)?;
            // Half the step, and half again, until it is one down.
            let mut share = 1.0;
            let taken = loop {
                let mut next = parameters;
                next.iter_mut().zip(step).for_each(|(p, s)| *p += share * s);
                if let Some(sum) = squares(&next).filter(|sum| *sum <= best) {
                    best = sum;
                    break Some(next);
                }
                share *= 0.5;
                if share < 1e-6 {
                    break None;
                }
            };
            let Some(next) = taken else { break };
            parameters = next;
            if step.iter().all(|s| share * s.abs() <= SETTLED * range) {
                break;
            }
        }
        Ok(Self { kind, parameters, places, middle })
    }

    /// Radius, in the unit of the heights; infinite for a plane. Positive where it is a hill.
    pub(super) fn radius(&self) -> f64 {
        let p = &self.parameters;
        let (a, square) = match self.kind {
            FormKind::Sphere => (p[0], 1.0 + p[1] * p[1] + p[2] * p[2] - 4.0 * p[0] * p[3]),
            FormKind::Cylinder => (p[0], 1.0 + p[1] * p[1] - 4.0 * p[0] * p[2]),
        };
        self.places.unit * square.max(0.0).sqrt() / (2.0 * a)
    }

    /// Takes the form away from all heights; where it has none (beyond its equator) nothing is left.
    pub(super) fn subtract(&self, heights: &mut [f64]) {
        for (i, h) in heights.iter_mut().enumerate() {
            let form = height(self.kind, &self.parameters, self.places.at(i)).map_or(f64::NAN, |f| f.0);
            *h = (*h - self.middle) - self.places.unit * form;
        }
    }
}

impl FormKind {
    fn unknowns(self) -> usize {
        match self {
            Self::Sphere => 4,
            Self::Cylinder => 5,
        }
    }

    /// The paraboloid or the parabolic cylinder of least squares.
    fn start(
        self,
        places: ScaledPoints,
        points: &(impl Iterator<Item = (usize, f64)> + Clone),
    ) -> Option<[f64; MOST]> {
        let fit = |basis: &dyn Fn([f64; 2]) -> [f64; MOST], unknowns: usize| {
            let mut equations = NormalEquations::new(unknowns);
            for (i, z) in points.clone() {
                equations.add(&basis(places.at(i)), z);
            }
            equations.solve()
        };
        match self {
            Self::Sphere => {
                let c = fit(&|[x, y]| [x * x + y * y, x, y, 1.0, 0.0, 0.0], 4)?;
                Some([-c[0], -c[1], -c[2], -c[3], 0.0, 0.0])
            }
            Self::Cylinder => {
                let c = fit(&|[x, y]| [x * x, x * y, y * y, x, y, 1.0], 6)?;
                // The axis lies along the smaller curvature of the quadric.
                let across = 0.5 * c[1].atan2(c[0] - c[2]);
                let curvature = |angle: f64| {
                    let (sin, cos) = angle.sin_cos();
                    c[0] * cos * cos + c[1] * sin * cos + c[2] * sin * sin
                };
                let quarter = std::f64::consts::FRAC_PI_2;
                let larger = curvature(across).abs() >= curvature(across + quarter).abs();
                let angle = if larger { across + quarter } else { across };
                let (sin, cos) = angle.sin_cos();
                let slope = c[3] * cos + c[4] * sin;
                let tilt = c[4] * cos - c[3] * sin;
                let a = curvature(angle + quarter);
                Some([-a, -tilt, -c[5], angle, slope, 0.0])
            }
        }
    }
}
