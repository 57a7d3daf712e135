//! The states of a run as a table for a terminal.

use crate::scenes::read::human_readable::short;
use crate::scenes::read::scene_file::SceneFile;
use crate::scenes::tell::ensemble::Mean;
use analysis::{Table, Value};

/// Columns that are shown where the table has them: each number that a scene can ask for, and what its effects add.
const SHOWN: [&str; 24] = [
    "prescribed",
    "time",
    "force",
    "approach",
    "mean_gap",
    "mean_gap_grid_error",
    "stiffness",
    "stiffness_grid_error",
    "stiffness_fixed_area",
    "stiffness_fixed_area_grid_error",
    "area",
    "area_corrected",
    "area_corrected_grid_error",
    "contact_fraction",
    "conductance",
    "conductance_grid_error",
    "patches",
    "largest_patch",
    "plastic_area",
    "plastic_volume",
    "branch",
    "stability",
    "largest_pressure",
    "contact_cells",
];
/// More states of a model than these are left to the files.
const MOST: usize = 24;

/// A few columns of the states of a model.
pub(crate) struct ModelStates {
    pub name: &'static str,
    /// Cells of the table, its head first.
    pub lines: Vec<Vec<String>>,
    /// States that are left to the files.
    pub left_out: usize,
}

/// The states of each model as aligned text.
pub(crate) fn summary(scene: &SceneFile, table: &Table, means: &[Mean]) -> String {
    let mut text = String::new();
    for ModelStates { name, lines, left_out } in of_models(scene, table, means) {
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
    }
    text
}

/// A few columns of the states of each model; of several surfaces their means with the standard errors in brackets.
pub(crate) fn of_models(scene: &SceneFile, table: &Table, means: &[Mean]) -> Vec<ModelStates> {
    let place = |name: &str| table.columns().iter().position(|c| c.name == name);
    let mut of_models = Vec::new();
    for model in scene.models.iter().map(crate::scenes::Numerics::name) {
        let rows: Vec<&Vec<Value>> =
            table.rows().iter().filter(|row| row.first() == Some(&Value::from(model))).collect();
        let of: Vec<&Mean> = means.iter().filter(|mean| mean.model == model).collect();
        let mut lines: Vec<Vec<String>> = Vec::new();
        let shown: Vec<(&str, usize)> =
            SHOWN.into_iter().filter_map(|name| Some((name, place(name)?))).collect();
        if means.is_empty() {
            let cell = |row: &Vec<Value>, at: usize| match &row[at] {
                Value::Number(v) => short(*v),
                Value::Count(n) => n.to_string(),
                _ => "-".to_owned(),
            };
            lines.extend(rows.iter().map(|row| shown.iter().map(|&(_, at)| cell(row, at)).collect()));
        } else {
            let cell = |mean: &Mean, name: &str| match (name, &mean.prescribed, mean.of(name)) {
                ("prescribed", Value::Number(v), _) => short(*v),
                // The force is what is prescribed, or its error is rounding.
                (_, _, Some((mean, Some(error)))) if error < 1e-9 * mean.abs() => short(mean),
                (.., of) => match of {
                    Some((mean, Some(error))) => format!("{} ({})", short(mean), error_of(error, mean)),
                    Some((mean, None)) => short(mean),
                    None => "-".to_owned(),
                },
            };
            lines.extend(of.iter().map(|mean| shown.iter().map(|&(name, _)| cell(mean, name)).collect()));
        }
        // A column without a number says nothing.
        let kept: Vec<usize> =
            (0..shown.len()).filter(|&i| lines.iter().any(|line| line[i] != "-")).collect();
        let unit = |at: usize| match table.columns()[at].unit {
            "1" | "-" => String::new(),
            unit => format!(" [{unit}]"),
        };
        let mut all: Vec<Vec<String>> =
            vec![shown.iter().map(|&(name, at)| format!("{name}{}", unit(at))).collect()];
        let states = lines.len();
        all.extend(lines.into_iter().take(MOST));
        let lines = all.iter().map(|line| kept.iter().map(|&i| line[i].clone()).collect()).collect();
        of_models.push(ModelStates { name: model, lines, left_out: states.saturating_sub(MOST) });
    }
    of_models
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
