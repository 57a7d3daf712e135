//! Means over ensembles: how far surfaces scatter, and what lines and closed forms are worth as an answer for the mean.

use super::limit::{Limit, limit, slope};
use super::problem::{DIMENSIONS, Family, LOADS, ProblemKey};
use super::row::{Answer, Parts, StudyRow, Way, measure};
use super::sizes::{Order, StudySizes};
use crate::realisation::{Discretisation, Models, Realisation};
use analysis::{Statistics, statistics};
use analytic::PowerLaw;
use analytic::flat_punch::SQUARE_STIFFNESS;
use contact_model::{Load, PAPER_STIFFNESS_FACTOR, Scene, SelfAffine, Status, Surface, never};
use runs::{Error, Progress, Result, cpu_seconds, on_one_thread};
use std::sync::Arc;

/// Tolerance of the ensembles: far below their scatter.
const TOLERANCE: f64 = crate::run::TOLERANCE;
/// Surfaces of the paper, for the ensemble part.
const PAPER_SURFACES: f64 = 60.0;

/// One ensemble: statistics of k/(E* L) and mean approach at each load, with the cost of all its surfaces.
struct EnsembleMeans {
    way: Way,
    stiffness: Vec<Option<Statistics>>,
    approach: Vec<Option<f64>>,
    answer: Answer,
    surfaces: usize,
}

/// Rows of all ensembles, references and closed forms.
pub(crate) fn means(
    sizes: &StudySizes,
    seed: u64,
    orders: &mut Vec<Order>,
    progress: &dyn Progress,
) -> Result<Vec<StudyRow>> {
    let solids = sizes.ensembles.iter().map(|&cells| Discretisation::Bem3d { cells, tolerance: TOLERANCE });
    let lines = sizes.elements.iter().map(|&elements| Discretisation::Mdr1d { elements });
    let all: Vec<Discretisation> = solids.chain(lines).collect();
    let cost = |n: &Discretisation| unit(*n, 2.0, 0, seed).cost() * sizes.surfaces as u64;
    progress.begin("accuracy against time: ensembles", all.iter().map(cost).sum::<u64>() * 3);
    let mut rows = Vec::new();
    for d in DIMENSIONS {
        let mut found = Vec::new();
        for &discretisation in &all {
            found.push(on_one_thread(|| ensemble(discretisation, d, sizes.surfaces, seed))?);
            progress.advance(cost(&discretisation), false);
        }
        for (j, &force_bar) in LOADS.iter().enumerate() {
            rows.extend(at_load(d, force_bar, j, &found, orders)?);
        }
    }
    progress.end();
    Ok(rows)
}

fn unit(discretisation: Discretisation, d: f64, index: usize, seed: u64) -> Realisation {
    let seed = surface_gen::surface_seed(seed, index as u64);
    Realisation { discretisation, fractal_dimension: d, index, seed, forces: Arc::from(LOADS) }
}

fn ensemble(discretisation: Discretisation, d: f64, surfaces: usize, seed: u64) -> Result<EnsembleMeans> {
    let models = Models::default();
    let way = match discretisation {
        Discretisation::Bem3d { cells, tolerance } => {
            Way::Solid { cells, tolerance, method: bem3d::Method::Auto }
        }
        Discretisation::Mdr1d { elements } => Way::Line { elements },
    };
    let mut answer = Answer { status: Status::Converged.as_str().to_owned(), ..Answer::default() };
    let mut k: Vec<Vec<f64>> = vec![Vec::new(); LOADS.len()];
    let mut approach = k.clone();
    let start = cpu_seconds();
    for index in 0..surfaces {
        let result = unit(discretisation, d, index, seed).solve_among(&models, &never)?;
        for (j, s) in result.samples.iter().enumerate().filter(|(_, s)| s.converged()) {
            k[j].extend(s.stiffness_bar.map(|k| k * PAPER_STIFFNESS_FACTOR));
            approach[j].extend(s.approach_over_h);
            answer.iterations += s.iterations;
            answer.applications += s.applications;
        }
    }
    // The loads of one surface are solved together: each has its share.
    answer.cpu_seconds = cpu_seconds().zip(start).map(|(end, start)| (end - start) / LOADS.len() as f64);
    answer.iterations /= LOADS.len();
    answer.applications /= LOADS.len();
    let stiffness = k.iter().map(|k| statistics(k)).collect();
    let approach = approach.iter().map(|d| statistics(d).map(|s| s.mean)).collect();
    Ok(EnsembleMeans { way, stiffness, approach, answer, surfaces })
}

fn at_load(
    d: f64,
    force_bar: f64,
    j: usize,
    found: &[EnsembleMeans],
    orders: &mut Vec<Order>,
) -> Result<Vec<StudyRow>> {
    let solids: Vec<(f64, Statistics)> = found
        .iter()
        .filter(|e| matches!(e.way, Way::Solid { .. }))
        .filter_map(|e| Some((1.0 / e.way.size()? as f64, e.stiffness[j]?)))
        .collect();
    let sequence: Vec<(f64, f64)> = solids.iter().map(|s| (s.0, s.1.mean)).collect();
    let Some(&(_, finest)) = solids.last() else { return Ok(Vec::new()) };
    let Some(mut reference) = limit(&sequence) else { return Ok(Vec::new()) };
    // What the number of surfaces leaves open stays open on any grid.
    let scatter = finest.standard_error.unwrap_or(finest.mean);
    let deviation = scatter * (solids.last().map_or(1.0, |s| s.1.count as f64)).sqrt();
    let sixty = deviation / PAPER_SURFACES.sqrt() / finest.mean;
    let problem = ProblemKey::rough(Family::Mean, d, force_bar);
    orders.push(order(problem, reference, &sequence));
    reference.uncertainty = reference.uncertainty.hypot(scatter);
    let mut rows = Vec::new();
    let mut add = |way: Way, surfaces: usize, answer: Answer, own: Option<f64>| {
        let Some(k) = answer.stiffness else { return };
        let mut row = StudyRow::new(problem, way, answer);
        let distance = reference.distance(k);
        row.surfaces = surfaces;
        row.reference_error = Some(reference.relative());
        if matches!(way, Way::Solid { .. }) {
            // The same surfaces on every grid: their scatter is common and not an error of the grid.
            row.errors[0] = Some(distance.hypot(own.unwrap_or(0.0)).max(reference.relative()));
            let (algebraic, discretisation) = (Some(TOLERANCE), Some(distance));
            row.parts = Parts { algebraic, discretisation, ensemble: Some(sixty), model: None };
        } else {
            row.errors[0] = Some(distance.max(reference.relative()));
            row.parts = Parts { model: Some(distance), ensemble: own, ..Parts::default() };
        }
        rows.push(row);
    };
    for e in found {
        let Some(k) = e.stiffness[j] else { continue };
        let answer = Answer { stiffness: Some(k.mean), approach: e.approach[j], ..e.answer.clone() };
        add(e.way, e.surfaces, answer, k.relative_error());
    }
    for (name, answer) in formulas(d, force_bar)? {
        add(Way::Formula(name), 0, answer, None);
    }
    Ok(rows)
}

/// Eq. 12 where it is claimed to hold, and the plateau of the rigid square under the largest load.
fn formulas(d: f64, force_bar: f64) -> Result<Vec<(&'static str, Answer)>> {
    let surface = SelfAffine::new(d, 1.0, 1.0).map_err(Error::model("Eq. 12"))?;
    let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    let law = measure(&PowerLaw, &scene, Load::Force(force_bar), 0)?;
    let mut all: Vec<_> = law.into_iter().map(|answer| ("power_law", answer)).collect();
    if force_bar > 1.0 {
        let status = Status::Converged.as_str().to_owned();
        all.push(("plateau", Answer { stiffness: Some(SQUARE_STIFFNESS), status, ..Answer::default() }));
    }
    Ok(all)
}

fn order(problem: ProblemKey, limit: Limit, sequence: &[(f64, f64)]) -> Order {
    let errors: Vec<(f64, f64)> = sequence.iter().map(|&(h, v)| (h, limit.distance(v))).collect();
    Order {
        problem,
        quantity: "stiffness",
        power: limit.order.or_else(|| slope(&errors[..errors.len().saturating_sub(1)])),
        established: limit.order.is_some(),
        limit: Some(limit),
        errors: [errors.first().map(|e| e.1), errors.last().map(|e| e.1)],
    }
}
