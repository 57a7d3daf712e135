//! Means over the surfaces of a scene.

use crate::scenes::read::loads::Loading;
use crate::scenes::read::scene_file::SceneFile;
use analysis::{Column, Table, Value, mean_and_deviation};
use contact_model::Status;

/// A quantity that is averaged, with the columns of the standard error of the mean and of the standard deviation of one surface.
type Quantity = [&'static str; 3];

macro_rules! quantities {
    ($($name:literal),*) => { [$([$name, concat!($name, "_se"), concat!($name, "_sd")]),*] };
}

/// A mean, and the standard deviation of one number where there are two.
type MeanAndDeviation = (f64, Option<f64>);

/// What is averaged, where the table has it.
const QUANTITIES: [Quantity; 18] = quantities!(
    "force",
    "force_bar",
    "approach",
    "mean_gap",
    "stiffness",
    "stiffness_bar",
    "stiffness_fixed_area",
    "area",
    "area_corrected",
    "contact_fraction",
    "conductance",
    "largest_pressure",
    "stiffness_grid_error",
    "stiffness_fixed_area_grid_error",
    "area_grid_error",
    "area_corrected_grid_error",
    "conductance_grid_error",
    "mean_gap_grid_error"
);

/// One model under one load, over the surfaces on which it reached its tolerance.
pub(crate) struct Mean {
    pub model: &'static str,
    pub state: usize,
    /// The number that the load prescribes; none along a path.
    pub prescribed: Value,
    pub surfaces: usize,
    /// Mean and standard deviation of each quantity of the table; `None` where a surface does not have it.
    values: Vec<(Quantity, Option<MeanAndDeviation>)>,
}

impl Mean {
    /// Mean and, for two surfaces or more, its standard error.
    pub fn of(&self, name: &str) -> Option<MeanAndDeviation> {
        if let ("prescribed", Value::Number(value)) = (name, &self.prescribed) {
            return Some((*value, None));
        }
        let (_, value) = self.values.iter().find(|([quantity, ..], _)| *quantity == name)?;
        let (mean, deviation) = (*value)?;
        Some((mean, deviation.map(|deviation| deviation / (self.surfaces as f64).sqrt())))
    }
}

/// The means in the order of models and loads.
pub(crate) fn means(scene: &SceneFile, table: &Table) -> Vec<Mean> {
    let place = |name: &str| table.columns().iter().position(|c| c.name == name);
    let (Some(model), Some(state), Some(status)) = (place("model"), place("state"), place("status")) else {
        return Vec::new();
    };
    let quantities: Vec<(Quantity, usize)> =
        QUANTITIES.into_iter().filter_map(|quantity| Some((quantity, place(quantity[0])?))).collect();
    let count = scene.request.count();
    let prescribed = match &scene.request {
        Loading::Loads(loads) => loads.values.as_slice(),
        Loading::Path(_) => &[],
    };
    let mut found = vec![Vec::new(); scene.models.len() * count];
    for row in table.rows() {
        let of = scene.models.iter().position(|m| row[model] == Value::from(m.name()));
        if let (Some(of), Value::Count(state)) = (of, &row[state])
            && row[status] == Value::from(Status::Converged.as_str())
        {
            found[of * count + *state as usize].push(row);
        }
    }
    let mean = |(at, rows): (usize, &Vec<&Vec<Value>>)| {
        let value = |&(quantity, column): &(Quantity, usize)| {
            let number = |row: &&Vec<Value>| match row[column] {
                Value::Number(v) => Some(v),
                _ => None,
            };
            let numbers: Option<Vec<f64>> = rows.iter().map(number).collect();
            (quantity, numbers.and_then(|numbers| mean_and_deviation(&numbers)))
        };
        let (model, state) = (scene.models[at / count].name(), at % count);
        let prescribed = prescribed.get(state).copied().into();
        Mean {
            model,
            state,
            prescribed,
            surfaces: rows.len(),
            values: quantities.iter().map(value).collect(),
        }
    };
    found.iter().enumerate().map(mean).collect()
}

/// The means as a table: `surfaces`, and for each quantity its mean, standard error and standard deviation.
pub(crate) fn table(title: String, columns: &[Column], means: &[Mean]) -> contact_model::Result<Table> {
    let prescribed = columns.iter().find(|c| c.name == "prescribed").map_or("1", |c| c.unit);
    let mut all = vec![
        Column { name: "model", unit: "-", meaning: "who answers" },
        Column { name: "state", unit: "1", meaning: "number of the load or step, from 0" },
        Column {
            name: "prescribed",
            unit: prescribed,
            meaning: "what the load prescribes; empty along a path",
        },
        Column { name: "surfaces", unit: "1", meaning: "surfaces on which the state reached its tolerance" },
    ];
    for [mean, error, deviation] in QUANTITIES {
        let Some(column) = columns.iter().find(|c| c.name == mean) else { continue };
        all.push(column.clone());
        all.push(Column { name: error, unit: column.unit, meaning: "standard error of this mean" });
        all.push(Column { name: deviation, unit: column.unit, meaning: "standard deviation of one surface" });
    }
    let mut table = Table::new(title, all);
    for of in means {
        let mut row: Vec<Value> =
            vec![of.model.into(), of.state.into(), of.prescribed.clone(), of.surfaces.into()];
        for (_, value) in &of.values {
            let deviation = value.and_then(|(_, deviation)| deviation);
            let error = deviation.map(|deviation| deviation / (of.surfaces as f64).sqrt());
            row.extend([value.map(|(mean, _)| mean).into(), error.into(), deviation.into()]);
        }
        table.push(row)?;
    }
    Ok(table)
}
