//! The law of an interface, which other programs take: what it bears and lets through over its mean gap.

use crate::scenes::read::Result;
use crate::scenes::run::{SolvedUnit, StateRecord};
use crate::scenes::tell::stated_error::relative_error;
use crate::scenes::tell::{StateTable, columns};
use analysis::{half_width_of_mean, mean_and_deviation};
use contact_model::quantities::StateQuantity;
use contact_model::{Column, Table, Value};

/// The file with the law.
pub(crate) const FILE: &str = "law.csv";

/// One number of the law.
struct LawColumn {
    /// The quantity of the states.
    of: &'static str,
    /// Its column, and that of its error.
    names: [&'static str; 2],
    /// Its unit; empty for that of a conductance per nominal area.
    unit: &'static str,
    meaning: &'static str,
}

const COLUMNS: [LawColumn; 6] = [
    LawColumn {
        of: "mean_gap",
        names: ["mean_gap", "mean_gap_error"],
        unit: "m",
        meaning: "distance of the mean planes of both surfaces",
    },
    LawColumn {
        of: "contact_fraction",
        names: ["contact_fraction", "contact_fraction_error"],
        unit: "1",
        meaning: "real contact area over the nominal one",
    },
    LawColumn {
        of: "stiffness",
        names: ["stiffness_per_area", "stiffness_per_area_error"],
        unit: "Pa/m",
        meaning: "growth of the mean pressure for each unit by which the mean gap falls",
    },
    LawColumn {
        of: "conductance",
        names: ["conductance_per_area", "conductance_per_area_error"],
        unit: "",
        meaning: "conductance through the contact, per nominal area",
    },
    LawColumn {
        of: "film_conductance_per_area",
        names: ["film_conductance_per_area", "film_conductance_per_area_error"],
        unit: "",
        meaning: "conductance through the contact and the film in the gap, per nominal area",
    },
    LawColumn {
        of: "flow_factor",
        names: ["flow_factor", "flow_factor_error"],
        unit: "1",
        meaning: "flow along the interface over that between smooth surfaces at the mean gap",
    },
];

/// A mean over surfaces and its error: that of the grid and the solver, and half of the 95 % interval of the mean.
fn mean_with_error(records: &[&StateRecord], of: &StateQuantity, scale: f64) -> Option<(f64, Option<f64>)> {
    let number = |record: &&StateRecord| {
        let solved = record.converged()?;
        of.number(&solved.state, &solved.normalisation)
    };
    let values = records.iter().map(number).collect::<Option<Vec<f64>>>()?;
    let (mean, deviation) = mean_and_deviation(&values)?;
    let errors: Vec<f64> = records
        .iter()
        .zip(&values)
        .filter_map(|(record, value)| Some(value.abs() * relative_error(record, of)?))
        .collect();
    let of_cells = mean_and_deviation(&errors).map(|(mean, _)| mean);
    let of_mean = deviation.map(|deviation| half_width_of_mean(deviation, values.len()));
    let error = match (of_cells, of_mean) {
        (None, None) => None,
        (cells, mean) => Some(cells.unwrap_or(0.0) + mean.unwrap_or(0.0)),
    };
    Some((scale * mean, error.map(|error| scale * error)))
}

/// One row for each load of each model, means over the surfaces, in the order of growing pressures.
pub(crate) fn table(states: &StateTable<'_>) -> Result<Table> {
    let scene = states.scene;
    let area = scene.surface.size().area();
    let asked_columns: Vec<(&LawColumn, &StateQuantity)> = COLUMNS
        .iter()
        .filter_map(|column| Some((column, columns::asked(scene).find(|asked| asked.name == column.of)?)))
        .collect();
    let mut all = vec![columns::plain(columns::MODEL)];
    let pascal = scene.system.unit("Pa");
    all.push(Column { name: "mean_pressure", unit: pascal, meaning: "normal force over the nominal area" });
    for (column, quantity) in &asked_columns {
        let unit = match (column.unit, quantity.unit.si(&scene.requested.outputs)) {
            ("", "S") => "S/m^2",
            ("", "W/K") => "W/(m^2 K)",
            ("", per_area) => per_area,
            (unit, _) => unit,
        };
        let unit = scene.system.unit(unit);
        let [name, error] = column.names;
        all.push(Column { name, unit, meaning: column.meaning });
        let meaning = "its error: that of the grid and of the solver, as far as they are known, and half of the 95 % interval of \
                       the mean over several surfaces";
        all.push(Column { name: error, unit, meaning });
    }
    let mut table = Table::new(format!("{}: law of the interface", states.title), all);
    for model in scene.models.iter().map(crate::scenes::Numerics::name) {
        let units: Vec<&SolvedUnit<'_>> = states.units.iter().filter(|unit| unit.model == model).collect();
        let mut rows: Vec<(f64, Vec<Value>)> = Vec::new();
        for state in 0..scene.request.count() {
            let of_units = units.iter().map(|unit| unit.states.iter().find(|record| record.index == state));
            let Some(records) = of_units.collect::<Option<Vec<_>>>() else { continue };
            let Some((pressure, _)) =
                StateQuantity::named("force").and_then(|force| mean_with_error(&records, force, 1.0 / area))
            else {
                continue;
            };
            let mut row: Vec<Value> = vec![model.into(), pressure.into()];
            for (column, quantity) in &asked_columns {
                let per_area = ["stiffness", "conductance"].contains(&column.of);
                let found = mean_with_error(&records, quantity, if per_area { 1.0 / area } else { 1.0 });
                row.push(found.map(|(mean, _)| mean).into());
                row.push(found.and_then(|(_, error)| error).into());
            }
            rows.push((pressure, row));
        }
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, row) in rows {
            table.push(row).map_err(runs::Error::model("the law of the interface"))?;
        }
    }
    Ok(table)
}
