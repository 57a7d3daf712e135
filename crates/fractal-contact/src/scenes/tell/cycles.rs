//! The energy of each cycle of a path.

use crate::scenes::read::{Result, SceneFile, amount, cycles};
use crate::scenes::run::SolvedUnit;
use crate::scenes::tell::stated_error::PLUS_MINUS;
use crate::scenes::tell::{StateTable, columns};
use analysis::{half_width_of_mean, mean_and_deviation};
use contact_model::quantities::StateQuantity;
use contact_model::{Rheology, Table, Value};

/// The file with the energy of each cycle.
pub(crate) const FILE: &str = "cycles.csv";
/// The energies that are counted from the first step on. A cycle takes what they grow by.
const ENERGIES: [&str; 3] = ["dissipated", "plastic_work", "work"];
/// More cycles than these are left to the file.
const MOST: usize = 6;

/// The energies that a scene asks for.
fn energies(scene: &SceneFile) -> Vec<&'static StateQuantity> {
    columns::asked(scene).filter(|quantity| ENERGIES.contains(&quantity.name)).collect()
}

/// Whether a scene has cycles whose energies are counted.
pub(crate) fn are_counted(scene: &SceneFile) -> bool {
    !energies(scene).is_empty() && !cycles(scene.request.pieces()).is_empty()
}

/// What an energy grows by between two states of a path; `None` where the path ended before, or has no such
/// energy.
fn energy(unit: &SolvedUnit<'_>, quantity: &StateQuantity, states: [usize; 2]) -> Option<f64> {
    let at = |state: usize| {
        let place = unit.states.binary_search_by_key(&state, |record| record.index).ok()?;
        let record = &unit.states[place];
        record.converged()?;
        match columns::value(record, quantity) {
            Value::Number(energy) => Some(energy),
            _ => None,
        }
    };
    Some(at(states[1])? - at(states[0])?)
}

/// Whether a scene has cycles in time whose force may run ahead of the distance.
fn has_phase(scene: &SceneFile) -> bool {
    scene.effects.rheology != Rheology::Elastic
}

/// The angle in radians by which the first harmonic of the force runs ahead of that of the distance in a cycle,
/// between -pi and pi; the distance is the approach, or minus the mean gap. `None` where a state of the cycle has no
/// time or no distance, or where nothing moves.
fn phase(unit: &SolvedUnit<'_>, [first, last]: [usize; 2]) -> Option<f64> {
    let mut states = Vec::with_capacity(last - first + 1);
    for state in first..=last {
        let place = unit.states.binary_search_by_key(&state, |record| record.index).ok()?;
        let state = &unit.states[place].converged()?.state;
        let distance = state.approach.or(state.mean_gap.map(|gap| -gap))?;
        states.push((state.time?, state.force, distance));
    }
    let force = first_harmonic(&states.iter().map(|s| (s.0, s.1)).collect::<Vec<_>>())?;
    let distance = first_harmonic(&states.iter().map(|s| (s.0, s.2)).collect::<Vec<_>>())?;
    // The argument of their quotient.
    let (real, imaginary) =
        (force.0 * distance.0 + force.1 * distance.1, force.1 * distance.0 - force.0 * distance.1);
    (real != 0.0 || imaginary != 0.0).then(|| imaginary.atan2(real))
}

/// Real and imaginary part of the integral of `f exp(-i w t)` over one period of w, of a function that is straight
/// between samples (time, f); `None` without a period.
fn first_harmonic(samples: &[(f64, f64)]) -> Option<(f64, f64)> {
    let [(begin, _), .., (end, _)] = samples else { return None };
    let wave = std::f64::consts::TAU / (end - begin);
    if !wave.is_finite() {
        return None;
    }
    let mut sum = (0.0, 0.0);
    for pair in samples.windows(2) {
        let [(t0, f0), (t1, f1)] = [pair[0], pair[1]];
        // Gauss's rule of two points is exact enough for a straight line times a slow wave, piece by piece.
        for node in [0.5 - 0.5 / 3.0_f64.sqrt(), 0.5 + 0.5 / 3.0_f64.sqrt()] {
            let (sine, cosine) = (wave * (t0 + node * (t1 - t0) - begin)).sin_cos();
            let value = 0.5 * (t1 - t0) * (f0 + node * (f1 - f0));
            sum = (sum.0 + value * cosine, sum.1 - value * sine);
        }
    }
    Some(sum)
}

/// One row for each cycle of each model on each surface.
pub(crate) fn table(states: &StateTable<'_>) -> Result<Table> {
    let scene = states.scene;
    let energies = energies(scene);
    let number = ("cycle", "1", "number of the cycle, from 1");
    let first = ("first_state", "1", "number of the state at which the cycle begins");
    let last = ("last_state", "1", "number of the state at which it ends, with the same load");
    let mut all = [columns::MODEL, columns::SURFACE, number, first, last].map(columns::plain).to_vec();
    all.extend(energies.iter().map(|energy| columns::column(scene, energy)).map(|column| {
        contact_model::Column {
            meaning: match column.name {
                "dissipated" => "energy lost to friction in the cycle",
                "work" => "work of the normal load in the cycle; where cycles repeat, the energy dissipated",
                _ => "energy dissipated by plastic flow in the cycle",
            },
            ..column
        }
    }));
    if has_phase(scene) {
        let meaning = "angle by which the first harmonic of the force runs ahead of that of the distance in the cycle, in radians";
        all.push(columns::plain(("phase", "1", meaning)));
    }
    let mut table = Table::new(format!("{}: energy of each cycle", states.title), all);
    for unit in &states.units {
        for (i, of_cycle) in cycles(scene.request.pieces()).into_iter().enumerate() {
            let taken: Vec<Option<f64>> =
                energies.iter().map(|quantity| energy(unit, quantity, of_cycle)).collect();
            if taken.iter().all(Option::is_none) {
                continue;
            }
            let [first, last] = of_cycle;
            let mut row: Vec<Value> =
                vec![unit.model.into(), unit.surface.into(), (i + 1).into(), first.into(), last.into()];
            row.extend(taken.into_iter().map(Value::from));
            if has_phase(scene) {
                row.push(phase(unit, of_cycle).into());
            }
            table.push(row).map_err(runs::Error::model("a cycle"))?;
        }
    }
    Ok(table)
}

/// The energy of each cycle of a model in words; of several surfaces the mean.
pub(crate) fn lines(states: &StateTable<'_>, model: &str) -> Vec<String> {
    let scene = states.scene;
    let energies = energies(scene);
    let cycles = cycles(scene.request.pieces());
    let line = |(i, &of_cycle): (usize, &[usize; 2])| {
        let mean = |quantity: &&StateQuantity| {
            let of_model = states.units.iter().filter(|unit| unit.model == model);
            let taken: Vec<f64> = of_model.filter_map(|unit| energy(unit, quantity, of_cycle)).collect();
            let (mean, deviation) = mean_and_deviation(&taken)?;
            let unit = columns::column(scene, quantity).unit;
            let half = deviation.map(|deviation| half_width_of_mean(deviation, taken.len()));
            let half = half.map_or_else(String::new, |half| format!(" {PLUS_MINUS} {}", amount(half, unit)));
            Some(format!("{} {}{half}", quantity.name, amount(mean, unit)))
        };
        let mut energies: Vec<String> = energies.iter().filter_map(mean).collect();
        if has_phase(scene) {
            let of_model = states.units.iter().filter(|unit| unit.model == model);
            let phases: Vec<f64> = of_model.filter_map(|unit| phase(unit, of_cycle)).collect();
            energies.extend(mean_and_deviation(&phases).map(|(mean, _)| format!("phase {mean:.3} rad")));
        }
        let [first, last] = of_cycle;
        (!energies.is_empty())
            .then(|| format!("cycle {}, states {first} to {last}: {}", i + 1, energies.join(", ")))
    };
    let mut lines: Vec<String> = cycles.iter().enumerate().filter_map(line).collect();
    if lines.len() > MOST {
        let more = lines.len() - MOST;
        lines.truncate(MOST);
        lines.push(format!("{more} more cycles are in {FILE}"));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_that_comes_later_has_another_phase() {
        let samples = |lag: f64| -> Vec<(f64, f64)> {
            (0..=64)
                .map(|k| 3.0 + f64::from(k) / 64.0 * 0.5)
                .map(|t| (t, 7.0 + 2.0 * (2.0 * std::f64::consts::TAU * t - lag).cos()))
                .collect()
        };
        let [first, later] = [0.0, 0.4].map(|lag| first_harmonic(&samples(lag)).unwrap());
        let ahead = first.1.atan2(first.0) - later.1.atan2(later.0);
        approx::assert_relative_eq!(ahead, 0.4, max_relative = 1e-10);
        assert!(first_harmonic(&[(1.0, 2.0), (1.0, 3.0)]).is_none() && first_harmonic(&[]).is_none());
    }
}
