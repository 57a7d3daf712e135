//! Means over the surfaces of a scene.

use crate::scenes::read::SceneFile;
use crate::scenes::run::{AnsweredState, SolvedUnit, StateRecord};
use crate::scenes::tell::columns;
use analysis::{half_width_of_mean, mean_and_deviation};
use contact_model::quantities::{Average, Role, StateQuantity};
use contact_model::{Column, Table, Value};

/// A mean, and the standard deviation of one number where there are two.
type MeanAndDeviation = (f64, Option<f64>);

/// A quantity, or its discretisation error.
type Averaged = (&'static StateQuantity, bool);

/// The numbers that are averaged over the surfaces of a scene, in the order of columns: quantities, then
/// discretisation errors.
fn averaged(scene: &SceneFile) -> Vec<Averaged> {
    let quantities = columns::asked(scene).filter(|quantity| quantity.average != Average::No);
    // Where a pressure does not converge there is no error to be averaged.
    let errors = columns::with_grid_errors(scene)
        .filter(|quantity| quantity.compared == contact_model::quantities::Compared::Yes);
    quantities.map(|quantity| (quantity, false)).chain(errors.map(|quantity| (quantity, true))).collect()
}

/// One model under one load, over the surfaces on which it reached its tolerance.
pub(crate) struct Mean {
    pub model: &'static str,
    pub state: usize,
    /// The number that the load prescribes; none along a path.
    pub prescribed: Option<f64>,
    pub surfaces: usize,
    /// Mean and standard deviation of each quantity, with the number of surfaces; `None` where a surface does
    /// not have it.
    values: Vec<(Averaged, Option<MeanAndDeviation>, usize)>,
}

impl Mean {
    /// Mean and, for two surfaces or more, its standard error, of a quantity.
    pub fn of(&self, quantity: &StateQuantity) -> Option<MeanAndDeviation> {
        self.with_error(quantity, false)
    }

    /// Mean and, for two surfaces or more, half of its 95 % interval, from Student's distribution with one
    /// degree of freedom less than there are surfaces.
    pub fn interval(&self, quantity: &StateQuantity) -> Option<MeanAndDeviation> {
        let (mean, deviation, surfaces) = self.find(quantity, false)?;
        Some((mean, deviation.map(|deviation| half_width_of_mean(deviation, surfaces))))
    }

    /// The same for its discretisation error.
    pub fn grid_error(&self, quantity: &StateQuantity) -> Option<MeanAndDeviation> {
        self.with_error(quantity, true)
    }

    fn with_error(&self, quantity: &StateQuantity, of_grid: bool) -> Option<MeanAndDeviation> {
        let (mean, deviation, surfaces) = self.find(quantity, of_grid)?;
        Some((mean, deviation.map(|deviation| deviation / (surfaces as f64).sqrt())))
    }

    /// Mean, standard deviation and number of surfaces.
    fn find(&self, quantity: &StateQuantity, of_grid: bool) -> Option<(f64, Option<f64>, usize)> {
        let is = |(of, grid): &Averaged| of.name == quantity.name && *grid == of_grid;
        let (_, value, surfaces) = self.values.iter().find(|(of, ..)| is(of))?;
        let (mean, deviation) = (*value)?;
        Some((mean, deviation, *surfaces))
    }
}

/// The means in the order of models and loads.
pub(crate) fn means<'a>(scene: &SceneFile, units: &[SolvedUnit<'a>]) -> Vec<Mean> {
    let averaged = averaged(scene);
    let mut means = Vec::new();
    for model in scene.models.iter().map(crate::scenes::Numerics::name) {
        for state in 0..scene.request.count() {
            let of_model = || units.iter().filter(|unit| unit.model == model);
            let at = |unit: &SolvedUnit<'a>| unit.states.iter().find(|record| record.index == state);
            let solved: Vec<&AnsweredState> =
                of_model().filter_map(at).filter_map(StateRecord::converged).collect();
            // A path that has ended keeps the quantities of the path as a whole.
            let until = |unit: &SolvedUnit<'a>| {
                let records = unit.states.iter().filter(|record| record.index <= state);
                records.filter_map(StateRecord::solved).next_back()
            };
            let of_paths: Vec<&AnsweredState> = of_model().filter_map(until).collect();
            let value = |&(quantity, of_grid): &Averaged| {
                let solved = if quantity.role == Role::OfPath { &of_paths } else { &solved };
                let number = |solved: &&AnsweredState| {
                    if of_grid {
                        return Some(solved.grid.as_ref()?.of(quantity.name)?.error);
                    }
                    quantity.number(&solved.state, &solved.normalisation)
                };
                let numbers: Option<Vec<f64>> = solved.iter().map(number).collect();
                let value = numbers.and_then(|numbers| mean_and_deviation(&numbers));
                ((quantity, of_grid), value, solved.len())
            };
            means.push(Mean {
                model,
                state,
                prescribed: scene.request.prescribed(state),
                surfaces: solved.len(),
                values: averaged.iter().map(value).collect(),
            });
        }
    }
    means
}

/// The number of surfaces of these means and the kind of their intervals, in words; empty where no mean is
/// over several surfaces.
pub(crate) fn words<'a>(means: impl Iterator<Item = &'a Mean>) -> String {
    let counts: Vec<usize> = means.map(|mean| mean.surfaces).filter(|surfaces| *surfaces > 1).collect();
    let (Some(few), Some(many)) = (counts.iter().copied().min(), counts.iter().copied().max()) else {
        return String::new();
    };
    let surfaces = if few == many { few.to_string() } else { format!("{few} to {many}") };
    format!("means over {surfaces} surfaces ± half of the 95 % interval, {}", distribution(few, many))
}

/// The distribution from which intervals of means follow, in words.
pub(crate) fn distribution(few: usize, many: usize) -> String {
    match few {
        2 if few == many => "by Student's t with 1 degree of freedom".to_owned(),
        few if few == many => format!("by Student's t with {} degrees of freedom", few - 1),
        _ => "by Student's t with one degree of freedom less than surfaces".to_owned(),
    }
}

/// The means as a table: `surfaces`, and for each quantity its mean, standard error and standard deviation.
pub(crate) fn table(scene: &SceneFile, title: String, means: &[Mean]) -> contact_model::Result<Table> {
    let unit = columns::prescribed(scene).map_or("1", |column| column.unit);
    let prescribed = ("prescribed", unit, "prescribed value of the load; empty along a path");
    let surfaces = ("surfaces", "1", "surfaces on which the state reached its tolerance");
    let mut all = [columns::MODEL, columns::STATE, prescribed, surfaces].map(columns::plain).to_vec();
    let averaged = averaged(scene);
    for &(quantity, of_grid) in &averaged {
        let [se, sd, error, _, error_se, error_sd] = quantity.columns;
        let column = columns::column(scene, quantity);
        let (name, [se, sd], unit) =
            if of_grid { (error, [error_se, error_sd], "1") } else { (quantity.name, [se, sd], column.unit) };
        let meaning =
            if of_grid { "mean of the estimated relative error of the grid" } else { column.meaning };
        all.push(Column { name, unit, meaning });
        if quantity.average == Average::Mean {
            all.push(Column { name: se, unit, meaning: "standard error of this mean" });
            all.push(Column { name: sd, unit, meaning: "standard deviation of one surface" });
        }
    }
    let mut table = Table::new(title, all);
    for of in means {
        let mut row: Vec<Value> =
            vec![of.model.into(), of.state.into(), of.prescribed.into(), of.surfaces.into()];
        for ((quantity, _), value, surfaces) in &of.values {
            let deviation = value.and_then(|(_, deviation)| deviation);
            let error = deviation.map(|deviation| deviation / (*surfaces as f64).sqrt());
            row.push(value.map(|(mean, _)| mean).into());
            if quantity.average == Average::Mean {
                row.extend([error.into(), deviation.into()]);
            }
        }
        table.push(row)?;
    }
    Ok(table)
}
