//! The cost of a run, predicted from its sizes alone or from small solves of the same kind.
//!
//! The choice of the grid for an accuracy rests on [`of_sizes`], in which no clock enters. Times
//! that are measured here are printed and decide nothing.

use crate::scenes::plan::{Cost, refining_solves};
use crate::scenes::read::{
    LoadList, LoadRequest, Numerics, PrescribedLoad, Result, SECTION_DEPTHS, STRESS_COMPONENTS, SceneFile,
    SceneSurface, cells, sampled, step_to,
};
use bem3d::{BYTES_PER_CELL, film_memory, solve_bytes};
use contact_model::{Adhesion, Boundary, Cells, ContactState, Coupling, Friction, Rheology, Surface};
use interface::FlowOptions;
use interface::stress::stress_memory;
use mdr1d::BYTES_PER_ELEMENT;
use std::time::Duration;
use web_time::Instant;

/// Cells a side, and elements, of the solves that the cost is predicted from.
const CALIBRATION_CELLS: usize = 65;
/// A large grid is predicted from a quarter of its cells a side, at most these.
const LARGEST_CALIBRATION: usize = 257;
const CALIBRATION_ELEMENTS: usize = 1 << 12;
const WARM_CELLS: usize = 17;
/// Loads solved for it at most, spread over those asked for.
const CALIBRATION_LOADS: usize = 4;
/// It stops by itself after this time.
const CALIBRATION_TIME: Duration = Duration::from_secs(3);
/// Memory of a state until the tables and the report are written, in bytes: a path of 10 000 states takes 8500
/// for each.
const BYTES_PER_STATE: f64 = 1e4;
/// Time of one load over cells a side: N^1.9 to N^2.6 as measured by `cargo xtask bench --scaling`.
pub(crate) const TIME_EXPONENT: f64 = 2.3;
/// Applications of the operator over cells a side, as measured by the same.
const APPLICATIONS_EXPONENT: f64 = 0.3;
/// The same two with adhesion of short range: N^2.7 to N^2.9 and N^0.4 to N^0.8 as measured by the examples
/// `effects` and `adhesion map` of `bem3d`.
const FRONTS_TIME_EXPONENT: f64 = 2.9;
const FRONTS_APPLICATIONS_EXPONENT: f64 = 0.8;
/// A prepared contact and its map, in bytes for each cell.
const PREPARED_BYTES: f64 = 18.0;
/// Up to this number of cells a side a dense state takes a microsecond for each cell, and beyond it the time
/// grows with [`TIME_EXPONENT`]: 0.7 to 1.0 us at 513, 0.9 to 1.8 at 2049, 1.5 to 5 at 4097 and 8193
/// (`data/bench/scaling.csv`, `data/bench/large.csv`). A light contact takes down to a thirtieth of that.
const DENSE_CELLS: f64 = 513.0;
/// Solves of a state of a viscoelastic history: three for each step of time, and a step or two for each state.
const SOLVES_OF_STEPS: f64 = 5.0;
/// Time with an adhesion of short range over that without at this number of cells a side, by the table of
/// `book/src/effects-cost.md`: 6 to 9 there, 10 to 31 at 1025. With a finite range it is about a third.
const FRONTS_CELLS: f64 = 257.0;
const FRONTS_TIME: f64 = 9.0;
const RANGE_TIME: f64 = 3.0;

/// Microseconds for each cell of the flow through a gap with its bounds and what the error of the gap does to it, of a
/// film, and of the stress at one depth; on the machine of the book's table of leakage.
const MICROSECONDS_OF_A_FLOW: f64 = 6.0;
const MICROSECONDS_OF_A_FILM: f64 = 2.0;
const MICROSECONDS_OF_A_DEPTH: f64 = 1.2;
const MICROSECONDS_OF_A_PERIODIC_DEPTH: f64 = 0.25;
/// Depths between those of the scene at which the largest stress is refined.
const REFINED_DEPTHS: f64 = 12.0;

/// Time of one model from the sizes of its solves and from times that were measured once
/// ([`milliseconds_of_sizes`]), within a factor of ten. Operator applications and linear solves are not
/// predicted.
///
/// `None` where no time is known: for models of the user's own, and for adhesion and coupled friction, whose
/// sweeps depend on the contact more than on its size.
pub(crate) fn from_sizes(scene: &SceneFile, model: usize) -> Option<Cost> {
    let numerics = &scene.models[model];
    let coupled = matches!(scene.effects.friction, Friction::Slip { coupling: Some(Coupling::Full), .. });
    let known = match numerics {
        Numerics::Bem3d(_) | Numerics::Equivalent(_) => scene.effects.adhesion == Adhesion::Off && !coupled,
        Numerics::Registered(_) => false,
        _ => true,
    };
    known.then(|| of_sizes(scene, model))
}

/// The cost of one model by the sizes of its solves and by times that are compiled in, those of a thread of a
/// Xeon of 2.5 GHz: a function of the scene and of nothing else. With adhesion and for models of the user's
/// own it is a guess.
pub(crate) fn of_sizes(scene: &SceneFile, model: usize) -> Cost {
    let numerics = &scene.models[model];
    let surfaces = scene.surfaces_of(numerics) as f64;
    let milliseconds = milliseconds_of_sizes(scene, numerics) as f64;
    let states = scene.request.count() as f64 * surfaces;
    let (fields, field_bytes) = fields(scene, numerics, states);
    let has_cells = numerics.boundary_elements().is_some();
    Cost {
        seconds: 1e-3 * milliseconds * surfaces * with_coarser_grids(scene, numerics),
        memory: if has_cells { memory(scene, numerics) } else { 0.0 },
        fields,
        field_bytes,
        ..Cost::default()
    }
}

/// Exponent with which the time of a state grows with its cells a side.
pub(crate) fn time_exponent(scene: &SceneFile) -> f64 {
    if scene.effects.adhesion == Adhesion::Off { TIME_EXPONENT } else { FRONTS_TIME_EXPONENT }
}

/// Milliseconds of all states of a model on one surface, on a thread of the machine of `data/bench`, by the sizes
/// alone; at least 1.
pub(crate) fn milliseconds_of_sizes(scene: &SceneFile, numerics: &Numerics) -> u64 {
    1 + (1e3 * seconds_of_sizes(scene, numerics)).min(1e15) as u64
}

fn seconds_of_sizes(scene: &SceneFile, numerics: &Numerics) -> f64 {
    let count = scene.request.count() as f64;
    let states = count + refining_solves(scene);
    let of_contact = match numerics {
        Numerics::Bem3d(model) => match rough_sweep(scene, model) {
            Some(seconds) => seconds * states / count,
            None => states * steps_of_time(scene) * seconds_of_dense(scene, numerics),
        },
        // The profile has about 49 nodes, each a state of the boundary elements, before the first load.
        Numerics::Equivalent(_) => (states + 49.0) * seconds_of_dense(scene, numerics),
        // One sort and one transform; the loads cost nothing beside them.
        Numerics::Mdr1d(model) => {
            let n = model.elements as f64;
            1e-9 * n * n.log2()
        }
        _ => 0.0,
    };
    of_contact + seconds_of_interface(scene, numerics)
}

/// Solves that a state takes: of a viscoelastic history three for each step of time.
fn steps_of_time(scene: &SceneFile) -> f64 {
    if scene.effects.rheology == Rheology::Elastic { 1.0 } else { SOLVES_OF_STEPS }
}

/// Seconds of all loads by [`seconds_of_rough_sweep`]; `None` for loads and surfaces other than normalised forces
/// on a self-affine surface, and for contacts with an effect.
fn rough_sweep(scene: &SceneFile, model: &bem3d::Bem3d) -> Option<f64> {
    let SceneSurface::Plain(Surface::SelfAffine(surface)) = &scene.surface else { return None };
    let LoadRequest::Loads(LoadList { kind: PrescribedLoad::ForceBar, values }) = &scene.request else {
        return None;
    };
    if scene.effects.named().next().is_some() {
        return None;
    }
    let Cells { columns, rows } = model.grid(surface.size);
    let side = (columns as f64 * rows as f64).sqrt();
    Some(seconds_of_rough_sweep(side, model.tolerance, surface.fractal_dimension(), values))
}

/// Seconds of boundary elements with `side` cells a side on a self-affine surface under all these normalised
/// forces, within a factor of two of what was measured on the machine of `data/bench`.
///
/// One load on 512 x 512 cells takes a few ms where little is in contact and a second where much is
/// (`data/bench/single.csv`). In a sweep each begins where the one before ended, which leaves a fifth of it at a
/// tolerance of 1e-3.
pub fn seconds_of_rough_sweep(side: f64, tolerance: f64, fractal_dimension: f64, force_bar: &[f64]) -> f64 {
    let loads: f64 = force_bar.iter().map(|&force| 0.005 + 1.2 * filled(force)).sum();
    let digits = 1.0 + 0.2 * (-tolerance.log10() - 3.0);
    // Under one load the contact of a rougher surface has fewer cells.
    let rough = 2_f64.powf(1.3 * (2.45 - fractal_dimension));
    0.2 * digits * rough * (side / 512.0).powf(2.2) * loads
}

/// About the share of a self-affine surface that a normalised force fills, rather too much.
fn filled(force_bar: f64) -> f64 {
    force_bar.powf(0.9) / (force_bar.powf(0.9) + 0.5)
}

/// Seconds of a state that fills its grid: a microsecond for each cell, more on large grids and with adhesion.
fn seconds_of_dense(scene: &SceneFile, numerics: &Numerics) -> f64 {
    let Cells { columns, rows } = cells(scene, numerics);
    let count = columns as f64 * rows as f64;
    let side = count.sqrt();
    let fronts = (side / FRONTS_CELLS).max(1.0).powf(FRONTS_TIME_EXPONENT - TIME_EXPONENT);
    let adhesion = match scene.effects.adhesion {
        Adhesion::Off => 1.0,
        Adhesion::FiniteRange { .. } => RANGE_TIME * fronts,
        _ => FRONTS_TIME * fronts,
    };
    1e-6 * count * adhesion * (side / DENSE_CELLS).max(1.0).powf(TIME_EXPONENT - 2.0)
}

/// Memory of one surface of a model with cells in a contact that fills the grid, in bytes: the most that a
/// state takes.
pub(crate) fn largest_memory(scene: &SceneFile, model: usize) -> f64 {
    memory_at(scene, &scene.models[model], 1.0)
}

/// The work of a state with that of its coarser grids, over its own.
fn with_coarser_grids(scene: &SceneFile, numerics: &Numerics) -> f64 {
    if scene.requested.grid_error && matches!(numerics, Numerics::Bem3d(_)) {
        1.0 + 0.5f64.powf(TIME_EXPONENT) + 0.25f64.powf(TIME_EXPONENT)
    } else {
        1.0
    }
}

/// Number of the fields of all states, and their bytes; both zero for a model without cells.
fn fields(scene: &SceneFile, numerics: &Numerics, states: f64) -> (f64, f64) {
    let (Numerics::Bem3d(_) | Numerics::Equivalent(_)) = numerics else { return (0.0, 0.0) };
    let Cells { columns, rows } = cells(scene, numerics);
    let count = columns as f64 * rows as f64;
    let outputs = &scene.requested.outputs;
    let named = [outputs.pressure, outputs.displacement, outputs.gap, outputs.plastic_depth];
    let of_state = named.iter().filter(|f| **f).count() as f64;
    (of_state * states, of_state * states * count * 8.0)
}

/// Seconds in which the flow, the film and the stress of all states of a model on one surface are computed.
fn seconds_of_interface(scene: &SceneFile, numerics: &Numerics) -> f64 {
    let Cells { columns, rows } = cells(scene, numerics);
    let interface = &scene.requested.interface;
    let of_section = if scene.requested.stress_section.is_empty() { 0.0 } else { SECTION_DEPTHS as f64 };
    let depths = interface
        .stress_below
        .as_ref()
        .map_or(0.0, |of| of.depths.len() as f64 + REFINED_DEPTHS + of_section + volume_layers(scene));
    let of_a_depth = if scene.effects.boundary == Boundary::Periodic {
        MICROSECONDS_OF_A_PERIODIC_DEPTH
    } else {
        MICROSECONDS_OF_A_DEPTH
    };
    let mut microseconds = of_a_depth * depths;
    for (asked, time) in [
        (interface.leakage.is_some(), MICROSECONDS_OF_A_FLOW),
        (interface.film.is_some(), MICROSECONDS_OF_A_FILM),
        (interface.film.is_some_and(|film| film.along.is_some()), MICROSECONDS_OF_A_FLOW),
    ] {
        microseconds += if asked { time } else { 0.0 };
    }
    let states = scene.request.count() as f64 + refining_solves(scene);
    1e-6 * microseconds * columns as f64 * rows as f64 * states
}

/// Layers in which the stress is written; 0 where it is not requested.
fn volume_layers(scene: &SceneFile) -> f64 {
    let stress = scene.requested.interface.stress_below.as_ref();
    let stress = stress.filter(|_| !scene.requested.stress_volume.is_empty());
    stress.map_or(0.0, |of| of.layers().0 as f64)
}

/// Bytes that they need beside the contact.
fn bytes_of_interface(scene: &SceneFile, numerics: &Numerics) -> f64 {
    let cells = cells(scene, numerics);
    let interface = &scene.requested.interface;
    let flow = |continuum| interface::flow_memory(cells, FlowOptions { continuum, ..FlowOptions::default() });
    let along = interface.film.is_some_and(|film| film.along.is_some());
    let each = [
        if interface.leakage.is_some() { flow(true) } else { 0.0 },
        if along { flow(false) } else { 0.0 },
        if interface.film.is_some() { film_memory(cells) } else { 0.0 },
        if interface.stress_below.is_some() {
            let has_tractions = scene.effects.friction != Friction::Off;
            stress_memory(cells, scene.effects.boundary, has_tractions)
                + STRESS_COMPONENTS.len() as f64 * volume_layers(scene) * cells.map_bytes()
        } else {
            0.0
        },
    ];
    // One after the other.
    each.into_iter().fold(0.0, f64::max)
}

/// Time and work of a small solve, scaled. What a small grid refuses is not predicted: its run will tell.
pub(crate) fn predict(scene: &SceneFile, numerics: &Numerics) -> Cost {
    let (grid, size) = (cells(scene, numerics), scene.surface.size());
    let coarse = (grid.columns.max(grid.rows) / 4).clamp(CALIBRATION_CELLS, LARGEST_CALIBRATION);
    let small = numerics.clone().reduced(coarse, CALIBRATION_ELEMENTS, size);
    // Code and memory that are touched for the first time are no part of what grows with N.
    let warm = numerics.clone().reduced(WARM_CELLS, CALIBRATION_ELEMENTS, size);
    let _ = small_solves(scene, &warm, (WARM_CELLS, grid), &contact_model::never);
    let requested = scene.request.count();
    let surfaces = scene.surfaces_of(numerics) as f64;
    let total = requested as f64 * surfaces;
    let begin = Instant::now();
    let stop = || begin.elapsed() > CALIBRATION_TIME;
    let timed = || small_solves(scene, &small, (coarse, grid), &stop);
    let (solved, used) = runs::on_one_thread(timed).unwrap_or_default();
    let mut cost = solved.cost;
    let count = grid.columns as f64 * grid.rows as f64;
    let per_state = total / (solved.states.max(1)) as f64;
    let (time, applications) = match numerics {
        Numerics::Bem3d(_) | Numerics::Equivalent(_) if used > 0 => {
            // Cells a side of the squares of as many cells.
            let ratio = (count / used as f64).sqrt();
            if let Adhesion::ShortRange { .. } = scene.effects.adhesion {
                (ratio.powf(FRONTS_TIME_EXPONENT), ratio.powf(FRONTS_APPLICATIONS_EXPONENT))
            } else {
                (ratio.powf(TIME_EXPONENT), ratio.powf(APPLICATIONS_EXPONENT))
            }
        }
        // Sorted once, in the preparation.
        Numerics::Mdr1d(m) => {
            ((m.elements as f64 / small.size().max(1) as f64).powf(0.5 * TIME_EXPONENT), 1.0)
        }
        _ => (1.0, 1.0),
    };
    // Each surface is prepared once and begins cold; the loads after the first one begin from the one before.
    let after_first = requested.saturating_sub(1) as f64 + refining_solves(scene);
    let later = solved.later / solved.states.saturating_sub(1).max(1) as f64 * after_first;
    cost.seconds =
        surfaces * (solved.prepare * time.powf(2.0 / TIME_EXPONENT) + (solved.first + later) * time);
    cost.seconds += surfaces * seconds_of_interface(scene, numerics);
    cost.seconds *= with_coarser_grids(scene, numerics);
    cost.applications *= applications * per_state;
    cost.linear_solves *= per_state;
    cost.fields *= per_state;
    if let Numerics::Bem3d(_) | Numerics::Equivalent(_) = numerics {
        (cost.fields, cost.field_bytes) = fields(scene, numerics, total);
        cost.memory = memory_at(scene, numerics, solved.filled);
    }
    cost
}

/// Memory that a scene needs where its models are solved one after the other, bytes. It is an upper estimate.
pub fn required_memory(scene: &SceneFile) -> f64 {
    scene.models.iter().map(|numerics| memory(scene, numerics)).fold(0.0, f64::max)
}

/// Memory that a model needs for one surface under the loads of the scene, bytes; at least 1. Where it is not known
/// what they fill, that of contact everywhere.
pub(crate) fn memory(scene: &SceneFile, numerics: &Numerics) -> f64 {
    let contact = match (&scene.surface, &scene.request) {
        (
            SceneSurface::Plain(Surface::SelfAffine(_)),
            LoadRequest::Loads(LoadList { kind: PrescribedLoad::ForceBar, values }),
        ) => filled(values.iter().copied().fold(0.0, f64::max)),
        _ => 1.0,
    };
    memory_at(scene, numerics, contact)
}

/// The same where a share of the cells touches.
fn memory_at(scene: &SceneFile, numerics: &Numerics, contact: f64) -> f64 {
    let cells = cells(scene, numerics);
    let count = cells.columns as f64 * cells.rows as f64;
    let bytes = match numerics {
        Numerics::Bem3d(_) | Numerics::Equivalent(_) => {
            let solve = solve_bytes(&scene.effects, &scene.requested.outputs, cells, contact);
            (PREPARED_BYTES * count + solve).max(BYTES_PER_CELL * count) + bytes_of_interface(scene, numerics)
        }
        _ => BYTES_PER_ELEMENT * numerics.size() as f64,
    };
    bytes.max(1.0)
}

/// As many jobs at the same time as there is memory for.
pub(crate) fn jobs_in_memory(scene: &SceneFile, most: usize) -> Result<usize> {
    let states: usize =
        scene.models.iter().map(|numerics| scene.surfaces_of(numerics) * scene.request.count()).sum();
    let refused = runs::Error::model("the plan");
    runs::check_memory(format!("{states} states"), BYTES_PER_STATE * states as f64).map_err(refused)?;
    let mut jobs = most;
    for numerics in &scene.models {
        let memory = memory(scene, numerics);
        let (name, value) = if numerics.boundary_elements().is_some() {
            let Cells { columns, rows } = cells(scene, numerics);
            let grid = format!("{columns} x {rows}");
            // An error of its own, with both sizes as numbers. The other one also counts what a thread reserves
            // where the address space is limited.
            let what = format!("{} on {grid} cells", numerics.name());
            runs::check_memory(what, memory).map_err(runs::Error::model("the plan"))?;
            ("cells", grid)
        } else {
            ("elements", numerics.size().to_string())
        };
        jobs = runs::threads_for_memory(jobs, memory, name, value)?;
    }
    Ok(jobs)
}

#[derive(Default)]
struct PilotSolve {
    states: usize,
    /// Largest share of the cells in contact.
    filled: f64,
    /// Seconds of preparing a surface, of its first load, and of all others.
    prepare: f64,
    first: f64,
    later: f64,
    cost: Cost,
}

impl PilotSolve {
    /// Counts a state that took so long.
    fn count(&mut self, begun: Instant, state: &ContactState, cells: usize) {
        let seconds = begun.elapsed().as_secs_f64();
        *(if self.states == 0 { &mut self.first } else { &mut self.later }) += seconds;
        self.states += 1;
        let contact = state.report.contact_cells.unwrap_or(0) as f64;
        self.filled = self.filled.max(contact / cells.max(1) as f64);
        self.cost.applications += state.report.applications as f64;
        self.cost.linear_solves += state.report.work.linear_solves as f64;
    }
}

/// A few of the loads on a grid of at most `coarse` cells along its longer side, instead of `full`; the
/// second number is that of its cells.
fn small_solves(
    scene: &SceneFile,
    numerics: &Numerics,
    (coarse, full): (usize, Cells),
    stop: &dyn Fn() -> bool,
) -> contact_model::Result<(PilotSolve, usize)> {
    let seed = scene.seed(0);
    let mut physics = scene.scene(numerics, seed)?;
    let mut grid = numerics.boundary_elements().map(|elements| elements.grid(scene.surface.size()));
    if let Surface::Heights(map) | Surface::Profile(map) = &physics.surface {
        let thin = sampled(map, coarse)?;
        grid = Some(thin.cells());
        let thin = std::sync::Arc::new(thin);
        physics.surface = match physics.surface {
            Surface::Profile(_) => Surface::Profile(thin),
            _ => Surface::Heights(thin),
        };
    }
    // Larger cells resolve an attraction as well whose range is larger by the root of that: so it costs as
    // many sweeps, and is not refused.
    if let (Adhesion::FiniteRange { work, range, law }, Some(grid)) = (physics.effects.adhesion, grid) {
        let larger = (full.columns as f64 / grid.columns as f64).max(full.rows as f64 / grid.rows as f64);
        let range = range * larger.sqrt().max(1.0);
        physics.effects.adhesion = Adhesion::FiniteRange { work, range, law };
    }
    let size = grid.and_then(Cells::checked_count).unwrap_or(0);
    let (mut solved, begun) = (PilotSolve::default(), Instant::now());
    let mut contact = numerics.model().prepare(&physics, seed)?;
    solved.prepare = begun.elapsed().as_secs_f64();
    match &scene.request {
        LoadRequest::Loads(loads) => {
            let normalisation = contact.normalisation();
            let count = loads.values.len();
            let used = count.min(CALIBRATION_LOADS);
            for i in 0..used {
                let requested = loads.values[i * (count - 1) / (used - 1).max(1)];
                let begun = Instant::now();
                let Ok(state) =
                    loads.load(requested, &normalisation).and_then(|load| contact.solve_until(load, &stop))
                else {
                    continue;
                };
                solved.count(begun, &state, size);
            }
        }
        LoadRequest::Path(pieces) => {
            let mut states: Vec<ContactState> = Vec::new();
            for i in 0..scene.request.count() {
                let begun = Instant::now();
                let step = step_to(i, pieces, numerics.name(), |before| states.get(before));
                let Ok(state) = step.and_then(|step| contact.advance_until(step, &stop)) else { break };
                solved.count(begun, &state, size);
                // What is long, as at most 10 000 of them are kept.
                states.push(state.with_fields(None).with_patches(None));
            }
        }
    }
    Ok((solved, size))
}
