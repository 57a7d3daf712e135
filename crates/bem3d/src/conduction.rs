//! Conduction from one body to the other through the contact and through a film in the gap around it.
//!
//! How much better does a contact conduct if a film fills the gap around it? Where the surfaces touch, a current
//! passes without resistance; elsewhere it crosses a film of the thickness of the gap. Both share the potential in
//! the bodies, so that the film cannot be counted as a conductor in parallel: on fine grids the cells beside the
//! contact, whose gaps are as small as one likes, would conduct without limit.
//!
//! With the resistivity rho_f of the film and the sum rho of those of both bodies, the current density i satisfies
//!
//! ```text
//! (rho_f g + (rho/2 pi) G) i = V,    (G i)(x) = integral of i(y)/|x - y|
//! ```
//!
//! in all cells, under the potential difference V of the bodies far from the interface. G is the operator that gives
//! the displacement of a half-space under pressures. Without a film the current is confined to the contact, and the
//! conductance is [`contact_model::Conductance`].
//!
//! # Bounds on both sides
//!
//! The matrix A of the left side is symmetric and positive, so that the conductance `1' A^-1 1` has a bound on each
//! side from any current x with its residual `r = 1 - A x`: it is at least `1' x + r' x`, and larger than that by
//! `r' A^-1 r`, which is at most `r' (D + lambda)^-1 r` with the diagonal part D of the film and a lower bound lambda
//! of the eigenvalues of G. They hold for the equations on the cells; what the cells change is another error.
//!
//! # Cost
//!
//! Conjugate gradients, one application of G in double precision over all cells for each step, preconditioned by the
//! inverse of G on a torus where the film is thin, and elsewhere by the diagonal. A rough contact of which 2 % touch,
//! with films that add between 1 % and 16 times the conductance of the contact, takes 10 to 25 steps on 256 cells a
//! side, 12 to 29 on 512 and 15 to 34 on 1024, where this is 1.0 to 2.8 s on one thread of an AMD EPYC: as long as the
//! contact itself, or up to three times as long.

use crate::geometry::{CellSet, Grid};
use crate::kernel::NormalTable;
use crate::operator::Operators;
use crate::parts::Recorder;
use crate::real::{dot, sum, sum_of_pairs, update};
use crate::tuning::Tuning;
use contact_model::{Boundary, Cells, Error, Field, Interrupted, Result, Stop, never};
use std::f64::consts::TAU;

/// Steps of conjugate gradients at most; the bounds are then as wide as they are.
const STEPS: usize = 3000;
/// Maps in memory at most.
const MAPS: f64 = 18.0;
/// Steps between two exact residuals at most.
const RESTART: usize = 200;
/// A film counts as thin where it resists less than this share of a cell of the bodies: the inverse of G on a torus is
/// the preconditioner there.
const THIN: f64 = 0.1;
/// A round aims at this share of the width that is wanted.
const AIM: f64 = 0.1;
/// Rounds end where one of them leaves more than this share of the width: rounding is then all that is left.
const PROGRESS: f64 = 0.5;

/// The resistivities of a film in the gap and of the bodies on both sides of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Resistivity of the film, > 0: resistance times length, or length and temperature over power for heat.
    pub resistivity: f64,
    /// Sum of the resistivities of both bodies, > 0, in the same unit.
    pub bodies: f64,
}

/// The conductance through the contact and the film around it.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmConductance {
    /// Lower bound of the current per potential difference: of the sample with free boundaries; with periodic ones of
    /// the interface alone, whose resistance adds to that of the bodies above and below it.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
    /// Current density in each cell for a potential difference of 1 between the bodies: between points far away with
    /// free boundaries, with periodic ones between the planes to which their own resistance is counted.
    pub current_density: Field,
    /// Steps of conjugate gradients.
    pub steps: usize,
}

impl FilmConductance {
    /// The middle of both bounds.
    pub fn middle(&self) -> f64 {
        0.5 * (self.lower + self.upper)
    }
}

/// [`film_conductance_until`] to a relative width of 1e-8.
///
/// # Errors
/// As [`film_conductance_until`].
pub fn film_conductance(gap: &Field, film: Film, boundary: Boundary) -> Result<FilmConductance> {
    film_conductance_until(gap, film, boundary, 1e-8, &never)
}

/// Bytes that [`film_conductance_until`] needs at its peak for a map of these cells: vectors of conjugate gradients,
/// tables and transforms. 11 to 15 maps were measured on 512 to 2048 cells a side.
pub fn film_memory(cells: impl Into<Cells>) -> f64 {
    MAPS * cells.into().map_bytes()
}

/// The conductance from one body to the other through the contact and a film that fills the gap.
///
/// Cells whose gap is 0 are in contact. Where a gap is infinite, as at undefined points, nothing conducts. `tolerance`
/// is the relative width of the bounds at which the solver ends; where it needs too many steps they are wider, and
/// hold.
///
/// ```
/// use bem3d::{Boundary, Field, Film, film_conductance};
/// // A film of constant thickness: its resistance is rho_f g/A, and the interface has no other one.
/// let gap = Field::new([8, 8], 2.0, vec![0.1; 64])?;
/// let film = Film { resistivity: 3.0, bodies: 1.0 };
/// let found = film_conductance(&gap, film, Boundary::Periodic)?;
/// assert!((found.middle() - 4.0 / 0.3).abs() < 1e-6);
/// # Ok::<(), contact_model::Error>(())
/// ```
///
/// # Errors
/// [`Error::Domain`] for gaps that are negative or not numbers, resistivities and a tolerance that are not positive, an
/// interface without resistance, and numbers beyond the range of f64; [`Error::Unsupported`] for a map that repeats along one axis only; [`Error::Stopped`].
pub fn film_conductance_until(
    gap: &Field,
    film: Film,
    boundary: Boundary,
    tolerance: f64,
    stop: Stop<'_>,
) -> Result<FilmConductance> {
    let Film { resistivity, bodies } = film;
    for (name, value) in [
        ("resistivity of the film", resistivity),
        ("resistivity of both bodies", bodies),
        ("tolerance", tolerance),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::of_positive(name, value));
        }
    }
    if !matches!(boundary, Boundary::Free | Boundary::Periodic) {
        return Err(Error::unsupported("bem3d", format!("a film with {}", boundary.words())));
    }
    if let Some(wrong) = gap.values().iter().find(|g| g.is_nan() || **g < 0.0) {
        return Err(Error::domain("gap", *wrong, "numbers of at least 0"));
    }
    let grid = Grid::of_cells(gap.cells(), gap.dx(), gap.dy());
    // Resistances are counted in that of the bodies for a unit of G, lengths in the mean side of a cell.
    let length = gap.dx().sqrt() * gap.dy().sqrt();
    let unit = bodies * length / TAU;
    let cells = CellSet::of_grid(grid, gap.values(), f64::is_finite);
    let mut resistances = Vec::with_capacity(cells.len());
    resistances.extend(cells.index(grid).map(|i| gap.values()[i] * (resistivity / unit)));
    if let Some(wrong) = resistances.iter().find(|d| !d.is_finite()) {
        return Err(Error::not_representable("resistance of the film", *wrong));
    }
    let table = NormalTable::shared(grid, boundary);
    let shift = table.shift();
    let mut system = FilmSystem {
        thin: cells.filter(&resistances, |d| d < THIN * table.own()),
        on_thin: Vec::new(),
        own: table.own(),
        smallest: table.smallest_eigenvalue(),
        shift,
        operators: Operators::recorded(table, &Tuning::DEFAULT, &Recorder::default()),
        cells,
        resistances,
    };
    let found = system.solve(tolerance, stop).map_err(Interrupted::without_state)?;
    // A periodic kernel has a constant that makes it positive, the resistance of a part of the bodies.
    let of_interface = |sum: f64| {
        let resistance = 1.0 / sum - shift;
        if sum <= 0.0 {
            0.0
        } else if resistance > 0.0 {
            gap.dx() * gap.dy() / (unit * resistance)
        } else {
            f64::INFINITY
        }
    };
    let (lower, upper) = (of_interface(found.lower), of_interface(found.upper));
    if !upper.is_finite() {
        return Err(Error::domain(
            "conductance",
            upper,
            "a finite number: where nothing resists the current, as in full contact, there is none",
        ));
    }
    let mut density = vec![0.0; gap.values().len()];
    let scale = lower / (found.lower * gap.dx() * gap.dy());
    for (i, x) in system.cells.index(grid).zip(&found.current) {
        density[i] = if found.lower > 0.0 { x * scale } else { 0.0 };
    }
    let current_density = Field::new(gap.cells(), gap.size(), density)?;
    Ok(FilmConductance { lower, upper, current_density, steps: found.steps })
}

/// The equations on the cells that conduct, in the resistance of the bodies for a unit of the kernel.
struct FilmSystem {
    /// All cells that conduct.
    cells: CellSet,
    /// Resistance of the film in each of them.
    resistances: Vec<f64>,
    /// Those in which the film is thin.
    thin: CellSet,
    /// Room for values on them.
    on_thin: Vec<f64>,
    operators: Operators,
    /// Entry of the diagonal of the kernel.
    own: f64,
    /// A lower bound of the eigenvalues of the kernel.
    smallest: f64,
    /// The constant in a periodic kernel.
    shift: f64,
}

/// Currents under a unit of the potential, and the bounds of their sum.
struct SolvedFilm {
    current: Vec<f64>,
    lower: f64,
    upper: f64,
    steps: usize,
}

impl FilmSystem {
    /// Conjugate gradients until the bounds are within the tolerance.
    fn solve(&mut self, tolerance: f64, stop: Stop<'_>) -> std::result::Result<SolvedFilm, Interrupted> {
        let n = self.cells.len();
        let mut x = vec![0.0; n];
        let (mut steps, mut before) = (0, f64::INFINITY);
        loop {
            // The exact residual; it is what the bounds rest on.
            let mut r = vec![0.0; n];
            self.multiply(&x, &mut r, stop)?;
            for r in &mut r {
                *r = 1.0 - *r;
            }
            let (lower, beyond) = (sum(&x) + dot(&r, &x), self.bound_of_energy(&r));
            // What is left of the resistance without the constant of a periodic kernel has to be known as well.
            let aim = tolerance * (1.0 - self.shift * lower).clamp(0.0, 1.0);
            let stuck = steps > 0 && beyond > PROGRESS * before;
            if n == 0 || beyond <= aim * lower || stuck || steps >= STEPS {
                return Ok(SolvedFilm { current: x, lower, upper: lower + beyond, steps });
            }
            before = beyond;
            steps += self.improve(&mut x, r, AIM * aim, stop)?;
        }
    }

    /// Conjugate gradients from a residual on; returns the number of steps.
    fn improve(
        &mut self,
        x: &mut [f64],
        mut r: Vec<f64>,
        tolerance: f64,
        stop: Stop<'_>,
    ) -> std::result::Result<usize, Interrupted> {
        let n = r.len();
        let (mut z, mut image) = (vec![0.0; n], vec![0.0; n]);
        self.precondition(&r, &mut z, stop)?;
        let (mut direction, mut product) = (z.clone(), dot(&r, &z));
        for step in 1..=RESTART {
            self.multiply(&direction, &mut image, stop)?;
            let curvature = dot(&direction, &image);
            if !(curvature > 0.0 && product > 0.0) {
                return Ok(step);
            }
            let length = product / curvature;
            update(x, &direction, |x, d| *x += length * d);
            update(&mut r, &image, |r, t| *r -= length * t);
            if self.bound_of_energy(&r) <= tolerance * sum(x) {
                return Ok(step);
            }
            let before = z.clone();
            self.precondition(&r, &mut z, stop)?;
            // The preconditioner is of single precision and changes by its rounding from step to step.
            let turned = dot(&r, &z) - dot(&r, &before);
            let turn = (turned / product).max(0.0);
            product = dot(&r, &z);
            update(&mut direction, &z, |d, z| *d = turn * *d + z);
        }
        Ok(RESTART)
    }

    /// `out = A x`.
    fn multiply(
        &mut self,
        x: &[f64],
        out: &mut Vec<f64>,
        stop: Stop<'_>,
    ) -> std::result::Result<(), Interrupted> {
        self.operators.exact(&self.cells, x, &self.cells, out, stop)?;
        for ((out, d), x) in out.iter_mut().zip(&self.resistances).zip(x) {
            *out += d * x;
        }
        Ok(())
    }

    /// An upper bound of `r' A^-1 r`.
    fn bound_of_energy(&self, r: &[f64]) -> f64 {
        let smallest = self.smallest;
        sum_of_pairs(r, &self.resistances, |r, d| r * r / (d + smallest))
    }

    /// `z = M r`: the inverse of the diagonal, and where the film is thin that of the kernel on a torus.
    fn precondition(
        &mut self,
        r: &[f64],
        z: &mut [f64],
        stop: Stop<'_>,
    ) -> std::result::Result<(), Interrupted> {
        let Self { cells, resistances, thin, on_thin, operators, own, .. } = self;
        for ((z, d), r) in z.iter_mut().zip(resistances.iter()).zip(r) {
            *z = if *d < THIN * *own { 0.0 } else { r / (d + *own) };
        }
        let on_it = thin.carry(cells, r);
        on_thin.clear();
        on_thin.resize(thin.len(), 0.0);
        operators.torus_inverse(thin, &on_it, on_thin, stop)?;
        cells.add_carried(thin, on_thin, z);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::{Conductance, ContactModel, Load, Outputs, Scene, SelfAffine, Surface};

    /// Potential at (x, y) of a rectangle with the sides (a, b) around the origin and a unit density: the integral of
    /// 1/r.
    fn potential((x, y): (f64, f64), (a, b): (f64, f64)) -> f64 {
        let corner = |u: f64, v: f64| u * (v / u.abs()).asinh() + v * (u / v.abs()).asinh();
        let (left, right, low, high) = (x - 0.5 * a, x + 0.5 * a, y - 0.5 * b, y + 0.5 * b);
        corner(right, high) - corner(left, high) - corner(right, low) + corner(left, low)
    }

    fn eliminate(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
        let n = rows.len();
        for k in 0..n {
            let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs())).unwrap();
            rows.swap(k, pivot);
            let (above, below) = rows.split_at_mut(k + 1);
            for row in below {
                let factor = row[k] / above[k][k];
                row.iter_mut().zip(&above[k]).for_each(|(a, b)| *a -= factor * b);
            }
        }
        let mut x = vec![0.0; n];
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
            x[k] = (rows[k][n] - known) / rows[k][k];
        }
        x
    }

    /// Oblong cells, some in contact and one undefined.
    #[test]
    fn a_dense_solve_of_the_same_equations() {
        let (columns, rows, (dx, dy)) = (6, 5, (0.3, 0.2));
        let mut values: Vec<f64> = (0..30).map(|i| (f64::from(i % 7) - 2.0).max(0.0) * 0.01).collect();
        values[8] = f64::INFINITY;
        let gap = Field::new([columns, rows], [1.8, 1.0], values.clone()).unwrap();
        let film = Film { resistivity: 40.0, bodies: 1.5 };
        let cells: Vec<usize> = (0..30).filter(|&i| values[i].is_finite()).collect();
        let centre = |i: usize| ((i % columns) as f64 * dx, (i / columns) as f64 * dy);
        let row = |&i: &usize| {
            let of = |&j: &usize| {
                let (a, b) = (centre(i), centre(j));
                let own = if i == j { film.resistivity * values[i] } else { 0.0 };
                own + 1.5 / TAU * potential((a.0 - b.0, a.1 - b.1), (dx, dy))
            };
            cells.iter().map(of).chain([1.0]).collect()
        };
        let current = eliminate(cells.iter().map(row).collect());
        let expected = current.iter().sum::<f64>() * dx * dy;
        let found = film_conductance_until(&gap, film, Boundary::Free, 1e-12, &never).unwrap();
        assert_relative_eq!(found.middle(), expected, max_relative = 1e-10);
        assert!(found.lower <= expected * (1.0 + 1e-12) && expected <= found.upper * (1.0 + 1e-12));
        for (&i, current) in cells.iter().zip(&current) {
            assert_relative_eq!(found.current_density.values()[i], *current, max_relative = 1e-5);
        }
    }

    /// The gap of a rough contact, and its conductance without a film.
    fn rough_gap(boundary: Boundary, force: f64) -> (Field, f64) {
        let mut rough = SelfAffine::new(2.2, 1.0, 0.01).unwrap();
        rough.roll_off = Some(20.0);
        let mut scene = Scene::new(Surface::SelfAffine(rough), 1.0);
        scene.effects.boundary = boundary;
        scene.outputs = Outputs { gap: true, pressure: true, ..Outputs::default() };
        scene.outputs.conductance = Conductance::Electrical { first: 0.3, second: 0.7 };
        let model = crate::Bem3d { cells: 64, tolerance: 1e-9, ..crate::Bem3d::default() };
        let state = model.prepare(&scene, 5).unwrap().solve(Load::force(force)).unwrap();
        let mut gap = state.gap().unwrap().clone();
        for (g, p) in gap.values_mut().iter_mut().zip(state.pressure().unwrap().values()) {
            *g = if *p > 0.0 { 0.0 } else { g.max(0.0) };
        }
        (gap, state.conductance.unwrap())
    }

    /// A film that hardly conducts leaves the contact alone, whose conductance follows from the stiffness; a film that
    /// conducts better carries more.
    #[test]
    fn between_the_contact_alone_and_the_film_alone() {
        for (boundary, force) in
            [(Boundary::Free, 0.003), (Boundary::Periodic, 0.003), (Boundary::Periodic, 0.03)]
        {
            let (gap, contact) = rough_gap(boundary, force);
            let with = |resistivity: f64| {
                film_conductance(&gap, Film { resistivity, bodies: 1.0 }, boundary).unwrap()
            };
            assert_relative_eq!(with(1e12).middle(), contact, max_relative = 1e-6);
            let mut before = contact * (1.0 - 1e-6);
            for resistivity in [1e4, 1e2, 1.0, 1e-2] {
                let found = with(resistivity);
                assert!(found.upper <= found.lower * (1.0 + 2e-8), "{found:?}");
                assert!(found.lower > before, "{resistivity}");
                before = found.upper;
                let total = found.current_density.integral();
                assert_relative_eq!(total, found.middle(), max_relative = 1e-6);
            }
            // Less than the film would carry without the contact and without the bodies.
            let alone: f64 = gap.values().iter().filter(|g| **g > 0.0).map(|g| 1.0 / (64.0 * 64.0 * g)).sum();
            assert!(with(1e3).upper < contact + alone / 1e3);
        }
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        let gap = |value: f64| Field::new([4, 4], 1.0, vec![value; 16]).unwrap();
        let film = Film { resistivity: 1.0, bodies: 1.0 };
        for (gap, film, boundary) in [
            (gap(-1.0), film, Boundary::Free),
            (gap(1.0), Film { resistivity: 0.0, ..film }, Boundary::Free),
            (gap(1.0), Film { bodies: f64::NAN, ..film }, Boundary::Free),
            (gap(1.0), film, Boundary::PeriodicAlongX),
            // Full contact of periodic bodies has no resistance.
            (gap(0.0), film, Boundary::Periodic),
            (gap(1e300), Film { resistivity: 1e300, ..film }, Boundary::Free),
            // So thin a film resists less than rounding.
            (gap(1e-300), film, Boundary::Periodic),
        ] {
            assert!(film_conductance(&gap, film, boundary).is_err(), "{gap:?} {film:?} {boundary:?}");
        }
        // A square that touches everywhere conducts as a bonded punch does; nothing conducts without any cell.
        let square = film_conductance(&gap(0.0), film, Boundary::Free).unwrap();
        assert!(square.lower > 2.0 && square.upper < 2.6, "{square:?}");
        let nothing = film_conductance(&gap(f64::INFINITY), film, Boundary::Periodic).unwrap();
        assert_eq!((nothing.lower, nothing.upper), (0.0, 0.0));
        for tolerance in [0.0, -1.0, f64::NAN] {
            assert!(film_conductance_until(&gap(1.0), film, Boundary::Free, tolerance, &never).is_err());
        }
        assert!(matches!(
            film_conductance_until(&gap(1.0), film, Boundary::Free, 1e-8, &|| true),
            Err(Error::Stopped { .. })
        ));
    }
}
