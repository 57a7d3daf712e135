//! The energy of each cycle of a path.

use crate::scenes::read::{Result, SceneFile, amount, cycles};
use crate::scenes::run::SolvedUnit;
use crate::scenes::tell::stated_error::PLUS_MINUS;
use crate::scenes::tell::{StateTable, columns};
use analysis::{half_width_of_mean, mean_and_deviation};
use contact_model::quantities::StateQuantity;
use contact_model::{Table, Value};

/// The file with the energy of each cycle.
pub(crate) const FILE: &str = "cycles.csv";
/// The energies that are counted from the first step on. A cycle takes what they grow by.
const ENERGIES: [&str; 2] = ["dissipated", "plastic_work"];
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
                _ => "energy dissipated by plastic flow in the cycle",
            },
            ..column
        }
    }));
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
        let energies: Vec<String> = energies.iter().filter_map(mean).collect();
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
