//! Solves one problem with every method, and finds references, errors and their parts.

use super::limit::{Limit, limit};
use super::pressure;
use super::problem::{Family, StudyProblem};
use super::row::{Formula, MeasuredSolution, Parts, StudyRow, Way, measure, unless_stopped};
use super::sizes::{Order, SequenceErrors, SizeQuantity, StudySizes};
use analytic::Hertz;
use analytic::flat_punch::SQUARE_STIFFNESS_UNCERTAINTY;
use bem3d::{Bem3d, Method};
use contact_model::{ContactModel, Stop};
use mdr1d::Mdr1d;
use runs::Result;

/// Solves one problem with every method; polls `stop` between the methods.
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

/// Lines and closed forms for the bodies with a known solution; for rough surfaces these are means.
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
        ways.push((Way::Formula(Formula::Hertz), Box::new(Hertz)));
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
    let of = |a: &MeasuredSolution, q: usize| [a.stiffness, a.approach, a.area][q];
    let sequence = sizes.sequence();
    let tight: Vec<MeasuredSolution> =
        sequence.iter().filter_map(|&n| on(rows, n, sizes.tight)).cloned().collect();
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
        orders.push(order(problem, SizeQuantity::ALL[q], Some(found), known.is_some(), &errors));
    }
    let pressures: Vec<(f64, f64)> = tight
        .iter()
        .enumerate()
        .filter_map(|(i, a)| Some((cell(i), pressure_error(problem, a, tight.last()?)?)))
        .collect();
    if !pressures.is_empty() {
        orders.push(order(
            problem,
            SizeQuantity::Pressure,
            None,
            problem.key.family == Family::Sphere,
            &pressures,
        ));
    }
    for i in 0..rows.len() {
        let row = &rows[i];
        let Some(cells) = row.way.size() else { continue };
        let same = on(rows, cells, sizes.tight).cloned();
        let answer = &row.answer;
        let mut errors = [None; 4];
        for (q, limit) in limits.iter().enumerate() {
            // The error is never smaller than the uncertainty of the reference.
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

/// The result on a grid at a tolerance.
fn on(rows: &[StudyRow], n: usize, t: f64) -> Option<&MeasuredSolution> {
    let same = |r: &&StudyRow| {
        matches!(r.way, Way::Solid { cells, tolerance, method: Method::Auto }
            if cells == n && tolerance.total_cmp(&t).is_eq())
    };
    rows.iter().find(same).map(|r| &r.answer)
}

/// L2 distance from Hertz or from the finest grid; a grid is not compared with itself.
fn pressure_error(
    problem: &StudyProblem,
    answer: &MeasuredSolution,
    finest: &MeasuredSolution,
) -> Option<f64> {
    let p = answer.pressure.as_ref()?;
    if let Some(exact) = problem.exact_pressure(p.len().isqrt()) {
        return pressure::distance(p, &exact);
    }
    let finest = finest.pressure.as_ref().filter(|finest| finest.len() != p.len())?;
    pressure::distance(p, finest)
}

fn order(
    problem: &StudyProblem,
    quantity: SizeQuantity,
    limit: Option<Limit>,
    exact: bool,
    errors: &[(f64, f64)],
) -> Order {
    // Against the finest grid the last errors are too small: the grids at least twice as coarse show the
    // slope.
    let last = errors.last().map_or(0.0, |e| e.0);
    let far: Vec<(f64, f64)> = errors.iter().copied().filter(|e| exact || e.0 > 1.9 * last).collect();
    Order::new(problem.key, quantity, limit, &SequenceErrors { exact, all: errors, far: &far })
}
