//! A random case of the check of error budgets: its parameters, its budget and its reference.

use super::job::cold_cost;
use crate::evaluation::budget::algebraic;
use crate::evaluation::measured::COARSER_SURFACES;
use crate::evaluation::realisation::{Discretisation, solve_alone};
use crate::evaluation::run::FRACTAL_DIMENSIONS;
use crate::evaluation::sample::{FLOOR_CELLS, Sample};
use analysis::{mean_grid_error, relative_differences};
use contact_model::Stop;
use fractal_contact::scenes::FORMAT;
use runs::{Error, Job, Result, ResultKind};
use serde::{Deserialize, Serialize};
use surface_gen::surface_seed;

/// Number of the format of stored cases. Raise it when [`RandomCase`] changes, or how cases are drawn and
/// budgets predicted.
const STORED: u32 = 2;
/// Tolerance of the references.
pub(super) const REFERENCE: f64 = 1e-10;
/// Ratio of the cell sizes of the grid and of the reference grid.
pub(super) const FINER: usize = 4;
/// Grids and tolerances that are drawn from.
const CELLS: [usize; 5] = [65, 97, 129, 193, 257];
const TOLERANCES: (f64, f64) = (1e-6, 1e-1);
/// Ranges of loads. Each range with each of the paper's fractal dimensions is a stratum, and the cases are
/// distributed evenly over the strata.
const LOADS: [(f64, f64); 3] = [(1e-3, 0.086), (0.086, 2.0), (2.0, 20.0)];
pub(super) const STRATA: usize = LOADS.len() * FRACTAL_DIMENSIONS.len();

/// One case with its reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RandomCase {
    pub fractal_dimension: f64,
    pub seed: u64,
    pub force_bar: f64,
    pub cells: usize,
    pub tolerance: f64,
    pub stiffness_bar: f64,
    pub contact_cells: usize,
    /// Relative half-widths.
    pub algebraic: f64,
    pub discretisation: f64,
    /// k_bar to 1e-10 on the same grid and on the reference grid.
    pub tight: f64,
    pub reference: f64,
}

impl RandomCase {
    pub fn budget(&self) -> f64 {
        self.algebraic + self.discretisation
    }

    pub fn error(&self) -> f64 {
        (self.stiffness_bar / self.reference - 1.0).abs()
    }

    pub fn algebraic_error(&self) -> f64 {
        (self.stiffness_bar / self.tight - 1.0).abs()
    }
}

/// Stratum of a case by its number.
pub(super) fn stratum(number: usize) -> (f64, (f64, f64)) {
    let of = number % STRATA;
    (FRACTAL_DIMENSIONS[of % FRACTAL_DIMENSIONS.len()], LOADS[of / FRACTAL_DIMENSIONS.len()])
}

/// One case, as a job that is stored.
#[derive(Debug, Clone)]
pub(super) struct CaseJob {
    /// Master seed.
    pub seed: u64,
    /// Number of the case, which determines its stratum.
    pub number: u64,
}

impl Job for CaseJob {
    type Output = RandomCase;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("budget check", STORED);

    fn key(&self) -> String {
        let Self { seed, number } = self;
        format!(
            "format {FORMAT}\nmodel bem3d\nmodel_format {}\nreference {REFERENCE:?}, cells {FINER} times smaller\n\
             cells {CELLS:?}\ntolerances {TOLERANCES:?}\nloads {LOADS:?}\nfractal_dimensions {FRACTAL_DIMENSIONS:?}\n\
             coarser_surfaces {COARSER_SURFACES}\nfloor {FLOOR_CELLS}\nmaster_seed {seed}\ncase {number}\n",
            bem3d::FORMAT,
        )
    }

    fn name(&self) -> String {
        let (d, (low, high)) = stratum(self.number as usize);
        format!("random case {}, D_f = {d:?}, F_bar {low:?} to {high:?}", self.number)
    }

    // Of the first draw: few cases are drawn again.
    fn cost(&self) -> u64 {
        let (cells, force_bar, tolerance) = draw(self.seed, self.number, 0);
        let on = |cells, tolerance| cold_cost(cells, tolerance, force_bar);
        let budget: u64 = [cells, cells / 2, cells / 4].map(|cells| on(cells, tolerance)).iter().sum();
        let truth = on(cells, REFERENCE) + on(finer(cells), REFERENCE);
        on(cells, tolerance) + COARSER_SURFACES as u64 * budget + truth
    }

    // Whatever is drawn.
    fn memory(&self) -> f64 {
        let largest = CELLS.into_iter().max().unwrap_or(1);
        Discretisation::Bem3d { cells: finer(largest), tolerance: REFERENCE }.memory()
    }

    fn stored_bytes(&self) -> u64 {
        1000
    }

    fn solve(&self, stop: Stop<'_>) -> Result<RandomCase> {
        case(self.seed, self.number, stop)
    }

    /// Fractal dimension and surface follow from the number.
    fn is_whole(&self, case: &RandomCase) -> bool {
        let (d, _) = stratum(self.number as usize);
        case.fractal_dimension.total_cmp(&d).is_eq() && case.seed == surface(self.seed, self.number)
    }
}

/// A number in [0, 1) from a stream of its own.
fn uniform(seed: u64, case: u64, stream: u64) -> f64 {
    (surface_seed(surface_seed(seed ^ 0xb0d6, case), stream) >> 11) as f64 / (1_u64 << 53) as f64
}

fn logarithmic(u: f64, (low, high): (f64, f64)) -> f64 {
    low * (high / low).powf(u)
}

fn pick<T: Copy>(u: f64, of: &[T]) -> T {
    of[((u * of.len() as f64) as usize).min(of.len() - 1)]
}

/// Grid, load and tolerance of one attempt at a case.
fn draw(seed: u64, number: u64, attempt: u64) -> (usize, f64, f64) {
    let u = |stream| uniform(seed, number, 16 * attempt + stream);
    let (_, loads) = stratum(number as usize);
    (pick(u(1), &CELLS), logarithmic(u(2), loads), logarithmic(u(3), TOLERANCES))
}

/// Seed of the surface of a case. The seeds of the surfaces for its budget follow from it and differ between
/// cases, so that the cases are independent.
fn surface(seed: u64, number: u64) -> u64 {
    surface_seed(seed ^ 0xca5e, 1 + number)
}

/// Cells of the reference grid.
fn finer(cells: usize) -> usize {
    FINER * (cells - 1) + 1
}

/// Draws until a case lies above the floor.
fn case(seed: u64, number: u64, stop: Stop<'_>) -> Result<RandomCase> {
    let (d, _) = stratum(number as usize);
    let surface = surface(seed, number);
    let solve = |discretisation, seed, force_bar| solve_alone(discretisation, d, seed, force_bar, stop);
    // The heaviest load of a range never lies on the floor of the finest grid; light ones do in a few draws
    // out of ten.
    for attempt in 0_u64.. {
        let (cells, force_bar, tolerance) = draw(seed, number, attempt);
        let discretisation = Discretisation::Bem3d { cells, tolerance };
        let mine = solve(discretisation, surface, force_bar)?;
        let (Some(k), Some(touching)) = (mine.stiffness_bar, mine.contact_cells) else { continue };
        if mine.below_floor() || !mine.converged() {
            continue;
        }
        let Some([half, quarter]) = discretisation.coarser() else { continue };
        let on = |discretisation| -> Result<Vec<Sample>> {
            (0..COARSER_SURFACES as u64)
                .map(|i| solve(discretisation, surface_seed(surface, 1 + i), force_bar))
                .collect()
        };
        let fine = on(discretisation)?;
        if fine.iter().any(Sample::below_floor) {
            continue;
        }
        let differences: Vec<[f64; 2]> = (fine.iter().zip(on(half)?).zip(on(quarter)?))
            .filter_map(|((fine, half), quarter)| {
                relative_differences(fine.stiffness_bar?, half.stiffness_bar?, quarter.stiffness_bar?)
            })
            .collect();
        let stiffnesses: Vec<f64> = fine.iter().filter_map(|s| s.stiffness_bar).collect();
        let mean = analysis::sum(stiffnesses.iter().copied()) / stiffnesses.len().max(1) as f64;
        let edge = discretisation.edge_part(mean);
        let Some(discretisation) = mean_grid_error(&differences, edge, 1) else { continue };
        let truth = |cells| {
            let exact = solve(Discretisation::Bem3d { cells, tolerance: REFERENCE }, surface, force_bar)?;
            exact.stiffness_bar.filter(|_| exact.converged()).ok_or_else(|| {
                Error::parameter("cases", number, "a reference that meets its tolerance (another seed)")
            })
        };
        return Ok(RandomCase {
            fractal_dimension: d,
            seed: surface,
            force_bar,
            cells,
            tolerance,
            stiffness_bar: k,
            contact_cells: touching,
            algebraic: algebraic(&mine),
            discretisation,
            tight: truth(cells)?,
            reference: truth(finer(cells))?,
        });
    }
    Err(Error::parameter("cases", number, "a case above the floor"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_within_their_ranges() {
        for i in 0..50 {
            let u = uniform(1, i, 3);
            assert!((0.0..1.0).contains(&u));
            let f = logarithmic(u, LOADS[0]);
            assert!(f >= LOADS[0].0 && f <= LOADS[0].1 && CELLS.contains(&pick(u, &CELLS)));
        }
        assert_eq!(stratum(0), (2.0, LOADS[0]));
        assert_eq!(stratum(STRATA + 17), (3.0, LOADS[2]));
    }

    fn found() -> RandomCase {
        RandomCase {
            fractal_dimension: stratum(7).0,
            seed: surface(1, 7),
            force_bar: 0.1 + 0.2,
            cells: 97,
            tolerance: 1.0 / 3.0,
            stiffness_bar: 1e-300,
            contact_cells: 50,
            algebraic: -0.0,
            discretisation: 0.02,
            tight: 1.25,
            reference: 5e-324,
        }
    }

    #[test]
    fn a_case_comes_back_bit_for_bit_and_damage_does_not() {
        let job = CaseJob { seed: 1, number: 7 };
        let text = CaseJob::KIND.encode(&found());
        let back = job.decode(&text).unwrap();
        assert_eq!(back, found());
        assert!(back.algebraic.is_sign_negative());
        for cut in 0..text.len() {
            assert_eq!(job.decode(&text[..cut]), None, "{cut} bytes");
        }
        let damaged = [
            ("1.25", "NaN"),
            ("1.25", "1e999"),
            (":50", ":"),
            (":50", ":50.0"),
            ("97", "-97"),
            ("97", "null"),
        ];
        for (from, to) in damaged {
            assert_eq!(job.decode(&text.replace(from, to)), None, "{from} as {to}");
        }
        assert_eq!(job.decode(&format!("{text}1.0\n")), None);
        for other in [CaseJob { seed: 1, number: 8 }, CaseJob { seed: 2, number: 7 }] {
            assert_eq!(other.decode(&text), None);
        }
    }

    #[test]
    fn keys_differ_where_numbers_do() {
        let key = |seed, number| CaseJob { seed, number }.key();
        assert!(key(1, 7) != key(2, 7) && key(1, 7) != key(1, 8) && key(1, 7) == key(1, 7));
    }
}
