//! Solves every problem in every way and compares.

use super::job::{StudyJob, StudyPart, jobs};
use super::limit::{Limit, limit, slope};
use super::problem::{Family, StudyProblem};
use super::row::{Answer, Parts, StudyRow, Way, mark_pareto, measure};
use super::sizes::{Order, StudySizes};
use super::{means, pressure};
use analytic::Hertz;
use analytic::flat_punch::SQUARE_STIFFNESS_UNCERTAINTY;
use bem3d::{Bem3d, Method};
use contact_model::{ContactModel, Stop, never};
use mdr1d::Mdr1d;
use runs::{Error, Progress, Result, Store, Threads, collect, run_stored};

/// How much is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Depth {
    /// Up to 257 cells, under a minute.
    Quick,
    /// Up to 1025 cells, some ten minutes.
    #[default]
    Default,
    /// Up to 2049 cells, hours.
    Thorough,
}

const LADDER: [f64; 10] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];
/// The tolerance at which operators are compared: that of the figures.
const OPERATORS: f64 = crate::run::TOLERANCE;

impl Depth {
    /// The word on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Default => "default",
            Self::Thorough => "thorough",
        }
    }

    pub(crate) fn sizes(self) -> StudySizes {
        match self {
            Self::Quick => StudySizes {
                grids: &[65, 129, 257],
                between: &[97, 193],
                tolerances: &[1e-1, 1e-2, 1e-4],
                finest: &[1e-2],
                ladder: 129,
                tight: 1e-8,
                elements: &[1 << 10, 1 << 12, 1 << 14, 1 << 16],
                surfaces: 12,
                ensembles: &[65, 129],
            },
            Self::Default => StudySizes {
                grids: &[129, 257, 513, 1025],
                between: &[193, 385, 769],
                tolerances: &[1e-1, 1e-2, 1e-3, 1e-4, 1e-6],
                finest: &[1e-2, 1e-4],
                ladder: 257,
                tight: 1e-8,
                elements: &[1 << 10, 1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20],
                surfaces: 60,
                ensembles: &[65, 129, 257],
            },
            Self::Thorough => StudySizes {
                grids: &[129, 257, 513, 1025, 2049],
                between: &[193, 385, 769, 1537],
                tolerances: &[1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8],
                finest: &[1e-2, 1e-4, 1e-6],
                ladder: 513,
                tight: 1e-10,
                elements: &[1 << 10, 1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20],
                surfaces: 60,
                ensembles: &[65, 129, 257, 513],
            },
        }
    }
}

impl StudySizes {
    /// Everything that is solved in three dimensions on one surface, coarse grids first.
    pub fn solids(&self) -> Vec<Way> {
        let last = self.grids.last().copied();
        let mut all = Vec::new();
        for &cells in self.grids.iter().chain(self.between) {
            let mut tolerances = vec![self.tight];
            if cells == self.ladder {
                tolerances.extend(LADDER);
            } else if Some(cells) == last {
                tolerances.extend(self.finest);
            } else if self.grids.contains(&cells) {
                tolerances.extend(self.tolerances);
            }
            tolerances.sort_by(|a, b| b.total_cmp(a));
            tolerances.dedup_by(|a, b| a.total_cmp(b).is_eq());
            all.extend(tolerances.into_iter().map(|tolerance| (cells, tolerance, Method::Auto)));
            if cells == self.ladder {
                all.extend([Method::Iterative, Method::SingleLevel].map(|m| (cells, OPERATORS, m)));
            }
        }
        all.sort_by_key(|w| w.0);
        all.into_iter().map(|(cells, tolerance, method)| Way::Solid { cells, tolerance, method }).collect()
    }

    /// Grids at the tightest tolerance, coarsest first.
    pub fn sequence(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.grids.iter().chain(self.between).copied().collect();
        all.sort_unstable();
        all
    }
}

/// Everything that was found.
#[derive(Debug, Default)]
pub(crate) struct Study {
    pub rows: Vec<StudyRow>,
    pub orders: Vec<Order>,
}

/// Quantities that have a sequence.
pub(crate) const QUANTITIES: [&str; 4] = ["stiffness", "approach", "area", "pressure"];

/// Solves everything that the store does not hold, one job at a time and on one thread: times are what the study
/// is about.
pub(crate) fn study(sizes: &StudySizes, seed: u64, store: &Store, progress: &dyn Progress) -> Result<Study> {
    let jobs = jobs(sizes, seed)?;
    // First what measures memory: it counts from what the process holds.
    let (problems, means) = jobs.split_at(jobs.partition_point(StudyJob::is_problem));
    let solve =
        |what, jobs| collect(run_stored(what, jobs, store, Threads { total: 1, jobs: 1 }, progress, &never)?);
    let mut study = Study::default();
    let (mut ensembles, mut forms) = (Vec::new(), Vec::new());
    let mut parts = solve("accuracy against time: single surfaces", problems)?;
    parts.extend(solve("accuracy against time: ensembles", means)?);
    for part in parts {
        match part {
            StudyPart::Problem(rows, orders) => {
                study.rows.extend(rows);
                study.orders.extend(orders);
            }
            StudyPart::Ensemble(found) => ensembles.push(found),
            StudyPart::ClosedForms(found) => forms.push(found),
        }
    }
    study.rows.extend(means::means(sizes, &ensembles, &forms, &mut study.orders));
    mark_pareto(&mut study.rows);
    Ok(study)
}

/// One problem in every way; asks `stop` between the ways.
pub(crate) fn solve_problem(
    problem: &StudyProblem,
    sizes: &StudySizes,
    seed: u64,
    stop: Stop<'_>,
) -> Result<(Vec<StudyRow>, Vec<Order>)> {
    let surface_seed = surface_gen::surface_seed(seed, 0);
    let (mut rows, mut orders) = (Vec::new(), Vec::new());
    for way in sizes.solids() {
        let Way::Solid { cells, tolerance, method } = way else { continue };
        unless_stopped(stop)?;
        let model = Bem3d { cells, tolerance, method, ..Bem3d::default() };
        if let Some(answer) = measure(&model, &problem.scene, problem.load, surface_seed)? {
            rows.push(StudyRow::new(problem.key, way, answer));
        }
    }
    compare(problem, sizes, &mut rows, &mut orders);
    rows.extend(others(problem, sizes)?);
    for row in &mut rows {
        row.answer.pressure = None;
    }
    Ok((rows, orders))
}

/// A measurement has a thread of its own, to which `stop` cannot be sent: it is asked before each measurement.
pub(crate) fn unless_stopped(stop: Stop<'_>) -> Result<()> {
    if stop() {
        return Err(Error::model("accuracy against time")(contact_model::Error::Stopped { best: None }));
    }
    Ok(())
}

/// Lines and closed forms for the bodies whose answer is known; rough surfaces have theirs as means.
fn others(problem: &StudyProblem, sizes: &StudySizes) -> Result<Vec<StudyRow>> {
    let exact = problem.exact();
    if exact[0].is_none() {
        return Ok(Vec::new());
    }
    let elements = sizes.elements[0];
    let scene = problem.line(elements)?;
    let mut ways: Vec<(Way, Box<dyn ContactModel>)> =
        vec![(Way::Line { elements }, Box::new(Mdr1d { elements }))];
    if problem.key.family == Family::Sphere {
        ways.push((Way::Formula("hertz"), Box::new(Hertz)));
    }
    let mut rows = Vec::new();
    for (way, model) in ways {
        let Some(answer) = measure(&*model, &scene, problem.load, 0)? else { continue };
        let mut row = StudyRow::new(problem.key, way, answer);
        let relative = |v: Option<f64>, exact: Option<f64>| v.zip(exact).map(|(v, e)| (v / e - 1.0).abs());
        row.errors = [
            relative(row.answer.stiffness, exact[0]),
            relative(row.answer.approach, exact[1]),
            relative(row.answer.area, exact[2]),
            None,
        ];
        row.reference_error = Some(uncertainty(problem));
        row.parts.model = row.errors[0];
        rows.push(row);
    }
    Ok(rows)
}

fn uncertainty(problem: &StudyProblem) -> f64 {
    if problem.key.family == Family::Square { SQUARE_STIFFNESS_UNCERTAINTY } else { 0.0 }
}

/// References, errors and parts of the rows of one problem.
fn compare(problem: &StudyProblem, sizes: &StudySizes, rows: &mut [StudyRow], orders: &mut Vec<Order>) {
    let exact = problem.exact();
    let of = |a: &Answer, q: usize| [a.stiffness, a.approach, a.area][q];
    let sequence = sizes.sequence();
    let tight: Vec<Answer> = sequence.iter().filter_map(|&n| on(rows, n, sizes.tight)).cloned().collect();
    let cell = |i: usize| 1.0 / sequence[i] as f64;
    let mut limits: [Option<Limit>; 3] = [None; 3];
    for (q, &known) in exact.iter().enumerate() {
        let values: Vec<(f64, f64)> =
            tight.iter().enumerate().filter_map(|(i, a)| Some((cell(i), of(a, q)?))).collect();
        limits[q] = match known {
            Some(value) => Some(Limit::exact(value)),
            None => limit(&values),
        };
        let Some(found) = limits[q] else { continue };
        let errors: Vec<(f64, f64)> = values.iter().map(|&(h, v)| (h, found.distance(v))).collect();
        orders.push(order(problem, q, Some(found), known.is_some(), &errors));
    }
    let pressures: Vec<(f64, f64)> = tight
        .iter()
        .enumerate()
        .filter_map(|(i, a)| Some((cell(i), pressure_error(problem, a, tight.last()?)?)))
        .collect();
    if !pressures.is_empty() {
        orders.push(order(problem, 3, None, problem.key.family == Family::Sphere, &pressures));
    }
    for i in 0..rows.len() {
        let row = &rows[i];
        let Some(cells) = row.way.size() else { continue };
        let same = on(rows, cells, sizes.tight).cloned();
        let answer = &row.answer;
        let mut errors = [None; 4];
        for (q, limit) in limits.iter().enumerate() {
            // Never nearer than the reference itself is known.
            errors[q] = limit.zip(of(answer, q)).map(|(l, v)| l.distance(v).max(l.relative()));
        }
        errors[3] = tight.last().and_then(|finest| pressure_error(problem, answer, finest));
        let parts = Parts {
            algebraic: answer
                .stiffness
                .zip(same.as_ref().and_then(|s| s.stiffness))
                .map(|(k, tight)| (k / tight - 1.0).abs()),
            discretisation: limits[0]
                .zip(same.and_then(|s| s.stiffness))
                .map(|(l, k)| l.distance(k).max(l.relative())),
            ..Parts::default()
        };
        let reference = limits[0].map(|l| l.relative().max(uncertainty(problem)));
        let row = &mut rows[i];
        (row.errors, row.parts, row.reference_error) = (errors, parts, reference);
    }
}

/// The answer on a grid at a tolerance.
fn on(rows: &[StudyRow], n: usize, t: f64) -> Option<&Answer> {
    let same = |r: &&StudyRow| {
        matches!(r.way, Way::Solid { cells, tolerance, method: Method::Auto }
            if cells == n && tolerance.total_cmp(&t).is_eq())
    };
    rows.iter().find(same).map(|r| &r.answer)
}

/// L2 distance from Hertz or from the finest grid; a grid is not compared with itself.
fn pressure_error(problem: &StudyProblem, answer: &Answer, finest: &Answer) -> Option<f64> {
    let p = answer.pressure.as_ref()?;
    if let Some(exact) = problem.exact_pressure(p.len().isqrt()) {
        return pressure::distance(p, &exact);
    }
    let finest = finest.pressure.as_ref().filter(|finest| finest.len() != p.len())?;
    pressure::distance(p, finest)
}

fn order(
    problem: &StudyProblem,
    q: usize,
    limit: Option<Limit>,
    exact: bool,
    errors: &[(f64, f64)],
) -> Order {
    // Against the finest grid the last errors are too small: the grids at least twice as coarse show the slope.
    let last = errors.last().map_or(0.0, |e| e.0);
    let far: Vec<(f64, f64)> = errors.iter().copied().filter(|e| exact || e.0 > 1.9 * last).collect();
    let extrapolated = limit.and_then(|l| l.order);
    Order {
        problem: problem.key,
        quantity: QUANTITIES[q],
        power: extrapolated.or_else(|| slope(&far)),
        established: exact || extrapolated.is_some(),
        limit,
        errors: [errors.first().map(|e| e.1), errors.last().map(|e| e.1)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_way_once_and_references_among_them() {
        for depth in [Depth::Quick, Depth::Default, Depth::Thorough] {
            let sizes = depth.sizes();
            let ways = sizes.solids();
            for (i, a) in ways.iter().enumerate() {
                assert!(ways[..i].iter().all(|b| b != a), "{a:?}");
            }
            for n in sizes.sequence() {
                let tight = Way::Solid { cells: n, tolerance: sizes.tight, method: Method::Auto };
                assert!(ways.contains(&tight));
            }
            assert!(sizes.grids.contains(&sizes.ladder));
        }
    }
}
