//! Curves drawn from the rows of the table.

use crate::scenes::error::Result;
use crate::scenes::scene_file::SceneFile;
use analysis::{Table, Value};
use plots::{Chart, Curve};
use std::path::{Path, PathBuf};

/// What is drawn over what: of loads, and of paths.
const OVER_FORCE: [&str; 5] = ["stiffness", "area", "conductance", "approach", "mean_gap"];
const OVER_TIME: [&str; 4] = ["force", "approach", "tangential_force", "dissipated"];

/// `curve-Y.svg` and `.png` for every column that the scene asked for.
pub(crate) fn curves(scene: &SceneFile, table: &Table, out: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let has = |name: &str| table.columns().iter().any(|c| c.name == name);
    let mut pairs: Vec<(&str, &str)> = Vec::new();
    if scene.is_history() {
        if has("tangential_force") {
            pairs.push(("tangential_displacement", "tangential_force"));
        } else {
            pairs.extend(OVER_TIME.iter().map(|y| ("time", *y)));
        }
    } else {
        pairs.extend(OVER_FORCE.iter().map(|y| ("force", *y)));
    }
    for (x, y) in pairs {
        if has(x) && has(y) {
            let chart = chart(scene, table, x, y);
            if chart.curves.iter().any(|c| varies(&c.points)) {
                files.extend(chart.save(out, &format!("curve-{y}"))?);
            }
        }
    }
    Ok(files)
}

/// A constant, such as a force that is held, is no picture.
fn varies(points: &[(f64, f64)]) -> bool {
    let Some(first) = points.first() else { return false };
    points.len() == 1 || points.iter().any(|p| p.1.total_cmp(&first.1).is_ne())
}

fn chart(scene: &SceneFile, table: &Table, x: &str, y: &str) -> Chart {
    let place = |name: &str| table.columns().iter().position(|c| c.name == name);
    let label = |name: &str| {
        let unit = place(name).map_or("1", |i| table.columns()[i].unit);
        let (words, symbol) = quantity(name);
        let label = if symbol.is_empty() { words.to_owned() } else { format!("{words} ${symbol}$") };
        match unit {
            "1" | "-" => label,
            "scene" => format!("{label} (units of the scene)"),
            unit => format!("{label} ({})", unit_label(unit)),
        }
    };
    let number = |row: &[Value], name: &str| match place(name).and_then(|i| row.get(i)) {
        Some(Value::Number(v)) => Some(*v),
        _ => None,
    };
    let curves: Vec<Curve> = scene
        .models
        .iter()
        .map(|m| Curve {
            label: model_name(m.name()).to_owned(),
            points: table
                .rows()
                .iter()
                .filter(|row| matches!(row.first(), Some(Value::Text(name)) if name == m.name()))
                .filter_map(|row| Some((number(row, x)?, number(row, y)?)))
                .filter(|(x, y)| scene.is_history() || (*x != 0.0 && *y != 0.0))
                .collect(),
            scattered: scene.sampling.surfaces > 1,
        })
        .filter(|curve: &Curve| !curve.points.is_empty())
        .collect();
    let name = scene.path.file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let mut title = format!("{} over {}", quantity(y).0, quantity(x).0);
    title[..1].make_ascii_uppercase();
    let surfaces = match scene.sampling.surfaces {
        1 => String::new(),
        n => format!(", {n} surfaces"),
    };
    Chart {
        title,
        subtitle: format!("scene: {}{surfaces}", name.replace(['-', '_'], " ")),
        x_label: label(x),
        y_label: label(y),
        curves,
        logarithmic: !scene.is_history(),
    }
}

/// A column in words, and its symbol of the glossary.
fn quantity(column: &str) -> (&str, &str) {
    match column {
        "force" => ("force", "F"),
        "approach" => ("approach", "d"),
        "mean_gap" => ("mean gap", "\\bar{g}"),
        "stiffness" => ("stiffness", "k"),
        "area" => ("contact area", "A"),
        "conductance" => ("conductance", "Λ"),
        "time" => ("time", "t"),
        "tangential_force" => ("tangential force", "T"),
        "tangential_displacement" => ("tangential displacement", "u_x"),
        "dissipated" => ("dissipated energy", ""),
        other => (other, ""),
    }
}

/// A unit with its powers raised: `m^2` and `W/K`.
fn unit_label(unit: &str) -> String {
    format!("$\\rm{{{unit}}}$")
}

/// What a model is called outside code.
fn model_name(name: &str) -> &str {
    match name {
        "bem3d" => "3D boundary elements",
        "mdr1d" => "1D reduction",
        "mdr1d_partial_slip" => "1D reduction with partial slip",
        "mdr1d_viscoelastic" => "viscoelastic 1D reduction",
        "equivalent" => "equivalent profile",
        "hertz" => "Hertz",
        "jkr" => "Johnson, Kendall and Roberts",
        "persson" => "Persson",
        "greenwood_williamson" => "Greenwood and Williamson",
        "westergaard" => "Westergaard",
        "cattaneo_mindlin" => "Cattaneo and Mindlin",
        "power_law" => "power law of the paper",
        "power_law_body" => "Galin",
        "flat_punch" => "flat punch",
        other => other,
    }
}
