//! The states of a run as a table for a terminal.

use crate::scenes::read::{SceneFile, short};
use crate::scenes::run::{SolvedUnit, StateRecord};
use crate::scenes::tell::{Mean, columns};
use analysis::Value;
use contact_model::quantities::{Quantity, Role};

/// More states of a model than these are left to the files.
const MOST: usize = 24;
/// What stands where there is nothing.
const NOTHING: &str = "-";

/// A few columns of the states of a model.
pub(crate) struct ModelStates {
    pub name: &'static str,
    /// Cells of the table, its head first.
    pub lines: Vec<Vec<String>>,
    /// States that are left to the files.
    pub left_out: usize,
    /// What is told of each path as a whole, one line a surface or one of means.
    pub of_paths: Vec<String>,
}

/// The states of each model as aligned text.
pub(crate) fn summary(scene: &SceneFile, units: &[SolvedUnit<'_>], means: &[Mean]) -> String {
    let mut text = String::new();
    for ModelStates { name, lines, left_out, of_paths } in of_models(scene, units, means) {
        let brackets = if means.is_empty() { "" } else { ": means over surfaces (standard error)" };
        text += &format!("{name}{brackets}\n");
        let columns = lines.first().map_or(0, Vec::len);
        let width = |i: usize| lines.iter().map(|line| line[i].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for line in &lines {
            for (cell, width) in line.iter().zip(&widths) {
                text += &format!("  {cell:>width$}");
            }
            text.push('\n');
        }
        if left_out > 0 {
            text += &format!("  ... {left_out} more states\n");
        }
        for line in of_paths {
            text += &format!("  {line}\n");
        }
    }
    text
}

/// What is shown of a state: an answer, or what the grid leaves in it.
#[derive(Clone, Copy)]
enum Shown {
    Answer(&'static Quantity),
    GridError(&'static Quantity),
}

/// Every answer that a scene asks for, each with the error of its grid.
fn shown(scene: &SceneFile) -> Vec<Shown> {
    let mut shown = Vec::new();
    for quantity in columns::asked(scene).filter(|quantity| quantity.role == Role::Answer) {
        shown.push(Shown::Answer(quantity));
        if columns::with_grid_errors(scene).any(|compared| compared.name == quantity.name) {
            shown.push(Shown::GridError(quantity));
        }
    }
    shown
}

/// Names of the answers that are shown, those of paths as a whole among them.
#[cfg(test)]
pub(crate) fn names(scene: &SceneFile) -> impl Iterator<Item = &'static str> {
    let of_paths = columns::asked(scene).filter(|quantity| quantity.role == Role::OfPath);
    let of_paths: Vec<Shown> = of_paths.map(Shown::Answer).collect();
    shown(scene).into_iter().chain(of_paths).filter_map(|of| match of {
        Shown::Answer(quantity) => Some(quantity.name),
        Shown::GridError(_) => None,
    })
}

impl Shown {
    fn head(self, scene: &SceneFile) -> String {
        match self {
            Self::Answer(quantity) => with_unit(quantity.name, columns::column(scene, quantity).unit),
            Self::GridError(quantity) => quantity.columns[2].to_owned(),
        }
    }

    fn of_state(self, record: &StateRecord) -> String {
        let value = match self {
            Self::Answer(quantity) => columns::value(record, quantity),
            Self::GridError(quantity) => {
                let grid = record.solved().and_then(|solved| solved.grid.as_ref());
                grid.and_then(|grid| grid.of(quantity.name)).map(|error| error.error).into()
            }
        };
        match value {
            Value::Number(v) => short(v),
            Value::Count(n) => n.to_string(),
            Value::Text(word) => word,
            _ => NOTHING.to_owned(),
        }
    }

    fn of_mean(self, mean: &Mean) -> String {
        let found = match self {
            Self::Answer(quantity) => mean.of(quantity),
            Self::GridError(quantity) => mean.grid_error(quantity),
        };
        match found {
            // The force is what is prescribed, or its error is rounding.
            Some((mean, Some(error))) if error < 1e-9 * mean.abs() => short(mean),
            Some((mean, Some(error))) => format!("{} ({})", short(mean), error_of(error, mean)),
            Some((mean, None)) => short(mean),
            None => NOTHING.to_owned(),
        }
    }
}

fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "1" | "-" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

/// The answers of each model; of several surfaces their means with the standard errors in brackets.
pub(crate) fn of_models(scene: &SceneFile, units: &[SolvedUnit<'_>], means: &[Mean]) -> Vec<ModelStates> {
    let shown = shown(scene);
    let prescribed = columns::prescribed(scene);
    let load = |value: Option<f64>| value.map_or_else(|| NOTHING.to_owned(), short);
    let mut of_models = Vec::new();
    for name in scene.models.iter().map(crate::scenes::Numerics::name) {
        let mut lines: Vec<Vec<String>> = Vec::new();
        if means.is_empty() {
            for record in units.iter().filter(|unit| unit.model == name).flat_map(|unit| unit.states) {
                let mut line = vec![load(scene.request.prescribed(record.index))];
                line.extend(shown.iter().map(|of| of.of_state(record)));
                lines.push(line);
            }
        } else {
            for mean in means.iter().filter(|mean| mean.model == name) {
                let mut line = vec![load(mean.prescribed)];
                line.extend(shown.iter().map(|of| of.of_mean(mean)));
                lines.push(line);
            }
        }
        // A column without anything says nothing.
        let kept: Vec<usize> =
            (0..=shown.len()).filter(|&i| lines.iter().any(|line| line[i] != NOTHING)).collect();
        let mut head = vec![prescribed.as_ref().map_or_else(String::new, |c| with_unit(c.name, c.unit))];
        head.extend(shown.iter().map(|of| of.head(scene)));
        let left_out = lines.len().saturating_sub(MOST);
        let lines = std::iter::once(head).chain(lines.into_iter().take(MOST));
        let lines = lines.map(|line| kept.iter().map(|&i| line[i].clone()).collect()).collect();
        of_models.push(ModelStates { name, lines, left_out, of_paths: of_paths(scene, name, units, means) });
    }
    of_models
}

/// What a model's paths are as a whole: the quantities of paths at their ends, in words.
fn of_paths(scene: &SceneFile, model: &str, units: &[SolvedUnit<'_>], means: &[Mean]) -> Vec<String> {
    let quantities: Vec<&'static Quantity> =
        columns::asked(scene).filter(|quantity| quantity.role == Role::OfPath).collect();
    let line = |of: &dyn Fn(Shown) -> String| {
        let known = quantities.iter().filter_map(|&quantity| {
            let shown = Shown::Answer(quantity);
            let value = of(shown);
            (value != NOTHING).then(|| format!("{} {value}", shown.head(scene)))
        });
        known.collect::<Vec<_>>().join(", ")
    };
    let mut lines: Vec<String> = Vec::new();
    if means.is_empty() {
        let of_model = units.iter().filter(|unit| unit.model == model);
        let ends = of_model.filter_map(|unit| unit.states.iter().rfind(|record| record.solved().is_some()));
        lines.extend(ends.map(|end| line(&|shown| shown.of_state(end))));
    } else if let Some(end) = means.iter().rfind(|mean| mean.model == model) {
        lines.push(line(&|shown| shown.of_mean(end)));
    }
    lines.retain(|line| !line.is_empty());
    lines.into_iter().map(|line| format!("path as a whole: {line}")).collect()
}

/// A standard error as a share of its mean.
fn error_of(error: f64, mean: f64) -> String {
    format!("{:.1} %", 100.0 * error / mean.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.000"),
            (0.012_345, "0.01235"),
            (98_765.4, "98765"),
            (1e5, "1.000e5"),
            (-1.5e-9, "-1.500e-9"),
        ] {
            assert_eq!(short(value), text);
        }
        assert_eq!(error_of(0.5, -10.0), "5.0 %");
    }
}
