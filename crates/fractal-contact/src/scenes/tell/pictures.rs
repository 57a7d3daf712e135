//! Curves drawn from the rows of the table.

use crate::scenes::read::error::Result;
use crate::scenes::read::loads::{Loading, Prescribed};
use crate::scenes::read::scene_file::{SceneFile, depends_on_path};
use crate::scenes::read::words;
use crate::scenes::tell::ensemble::Mean;
use analysis::{Table, Value};
use contact_model::Boundary;
use plots::{Chart, Curve};
use std::path::{Path, PathBuf};

/// What is drawn over what: of loads, and of paths.
const OVER_LOAD: [&str; 8] = [
    "force",
    "stiffness",
    "stiffness_fixed_area",
    "area",
    "conductance",
    "approach",
    "mean_gap",
    "largest_pressure",
];
const OVER_TIME: [&str; 2] = ["force", "approach"];

/// `curve-Y.svg` and `.png` for every column that the scene asked for.
pub(crate) fn curves(scene: &SceneFile, table: &Table, means: &[Mean], out: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for (y, chart) in charts(scene, table, means) {
        files.extend(chart.save(out, &format!("curve-{y}"))?);
    }
    Ok(files)
}

/// A chart for every column that the scene asked for and that varies, by the column's name.
pub(crate) fn charts(scene: &SceneFile, table: &Table, means: &[Mean]) -> Vec<(&'static str, Chart)> {
    let has = |name: &str| table.columns().iter().any(|c| c.name == name);
    let drawn = pairs(scene).into_iter().filter(|(x, y)| has(x) && has(y));
    drawn
        .map(|(x, y)| (y, chart(scene, table, means, x, y)))
        .filter(|(_, chart)| chart.curves.iter().any(|c| varies(&c.points)))
        .collect()
}

/// The names of all files that [`curves`] may write.
pub(crate) fn curve_files(scene: &SceneFile) -> Vec<String> {
    pairs(scene).iter().flat_map(|(_, y)| ["svg", "png"].map(|end| format!("curve-{y}.{end}"))).collect()
}

/// What is drawn over what, where the table has it.
fn pairs(scene: &SceneFile) -> Vec<(&'static str, &'static str)> {
    if let Loading::Loads(loads) = &scene.request {
        let x = match loads.prescribed {
            Prescribed::Force => "force",
            Prescribed::ForceBar => "force_bar",
            Prescribed::MeanPressure => "prescribed",
            Prescribed::Approach => "approach",
            Prescribed::MeanGap => "mean_gap",
        };
        // A force that is prescribed in other words is no answer.
        let answers = match loads.prescribed {
            Prescribed::Approach | Prescribed::MeanGap => &OVER_LOAD[..],
            _ => &OVER_LOAD[1..],
        };
        return answers.iter().filter(|y| **y != x).map(|y| (x, *y)).collect();
    }
    if depends_on_path(&scene.effects) {
        return match scene.effects.boundary {
            Boundary::Periodic => vec![("mean_gap", "force"), ("force", "area")],
            _ => vec![("approach", "force"), ("force", "area")],
        };
    }
    if scene.effects.friction == contact_model::Friction::Off {
        return OVER_TIME.map(|y| ("time", y)).to_vec();
    }
    vec![("tangential_displacement", "tangential_force")]
}

/// A constant, such as a force that is held, is no picture.
fn varies(points: &[(f64, f64)]) -> bool {
    let Some(first) = points.first() else { return false };
    points.len() == 1 || points.iter().any(|p| p.1.total_cmp(&first.1).is_ne())
}

fn chart(scene: &SceneFile, table: &Table, means: &[Mean], x: &str, y: &str) -> Chart {
    let place = |name: &str| table.columns().iter().position(|c| c.name == name);
    let label = |name: &str| {
        let unit = place(name).map_or("1", |i| table.columns()[i].unit);
        let (words, symbol) = quantity(scene, name);
        let label = if symbol.is_empty() { words.to_owned() } else { format!("{words} ${symbol}$") };
        match unit {
            "1" | "-" => label,
            "scene" => format!("{label} (units of the scene)"),
            unit => format!("{label} ({})", words::unit_label(unit)),
        }
    };
    let number = |row: &[Value], name: &str| match place(name).and_then(|i| row.get(i)) {
        Some(Value::Number(v)) => Some(*v),
        _ => None,
    };
    let shown = |(x, y): &(f64, f64)| scene.is_history() || (*x != 0.0 && *y != 0.0);
    let grid_error = format!("{y}_grid_error");
    let curve = |model: &'static str| {
        let label = words::model_name(model).to_owned();
        let of = || means.iter().filter(move |mean| mean.model == model && mean.surfaces > 0);
        if means.is_empty() {
            let rows = table.rows().iter().filter(|row| row.first() == Some(&Value::from(model)));
            let row = |row: &Vec<Value>| Some(((number(row, x)?, number(row, y)?), number(row, &grid_error)));
            let states: Vec<_> = rows.filter_map(row).filter(|(point, _)| shown(point)).collect();
            // By a factor, because an error of more than the number itself has no lower end on these axes.
            let end = |((x, y), error): &((f64, f64), Option<f64>)| {
                error.map(|error| (*x, y / (1.0 + error), y * (1.0 + error)))
            };
            let band = states.iter().filter_map(end).collect();
            return Curve { label, points: states.iter().map(|(point, _)| *point).collect(), band };
        }
        let points = of().filter_map(|mean| Some((mean.of(x)?.0, mean.of(y)?.0)));
        let band = of().filter_map(|mean| {
            let ((x, _), (y, error)) = (mean.of(x)?, mean.of(y)?);
            Some((x, y - 2.0 * error?, y + 2.0 * error?))
        });
        Curve { label, points: points.filter(shown).collect(), band: band.collect() }
    };
    let curves: Vec<Curve> =
        scene.models.iter().map(|m| curve(m.name())).filter(|curve| !curve.points.is_empty()).collect();
    let mut title = format!("{} over {}", quantity(scene, y).0, quantity(scene, x).0);
    title[..1].make_ascii_uppercase();
    let surfaces = match scene.sampling.surfaces {
        1 if place(&grid_error).is_some() => ", shaded: the factor 1 + grid error".to_owned(),
        1 => String::new(),
        asked => {
            // A run that was interrupted has fewer.
            let solved = |mean: &&Mean| mean.surfaces > 1 || asked == 1;
            let counts: Vec<usize> = means.iter().filter(solved).map(|mean| mean.surfaces).collect();
            let surfaces = match (counts.iter().min(), counts.iter().max()) {
                (Some(few), Some(many)) if few == many && *many < asked => format!("{few} of {asked}"),
                (Some(few), Some(many)) if few < many => {
                    format!("{few} to {many} of {asked}")
                }
                _ => asked.to_string(),
            };
            format!(", means of {surfaces} surfaces, shaded: ± 2 standard errors")
        }
    };
    Chart {
        title,
        subtitle: format!("scene: {}{surfaces}", words::scene_name(scene)),
        x_label: label(x),
        y_label: label(y),
        curves,
        logarithmic: !scene.is_history(),
    }
}

/// A column in words, and its symbol of the glossary.
fn quantity<'a>(scene: &SceneFile, column: &'a str) -> (&'a str, &'a str) {
    let of_pressure =
        matches!(&scene.request, Loading::Loads(loads) if loads.prescribed == Prescribed::MeanPressure);
    match column {
        "prescribed" if of_pressure => ("mean pressure", "\\bar{p}"),
        "force_bar" => ("force", "\\bar{F}"),
        "force" => ("force", "F"),
        "approach" => ("approach", "d"),
        "mean_gap" => ("mean gap", "\\bar{g}"),
        "stiffness" => ("stiffness", "k"),
        "stiffness_fixed_area" => ("stiffness of the held area", "k"),
        "area" => ("contact area", "A"),
        "conductance" => ("conductance", "Λ"),
        "largest_pressure" => ("largest pressure", "p_{\\rm{max}}"),
        "time" => ("time", "t"),
        "tangential_force" => ("tangential force", "T"),
        "tangential_displacement" => ("tangential displacement", "u_x"),
        "dissipated" => ("dissipated energy", ""),
        other => (other, ""),
    }
}
