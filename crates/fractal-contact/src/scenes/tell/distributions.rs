//! Distributions of pressure, gap and contact areas: `distribution-NAME.csv`, and a picture of surface 0.

use crate::scenes::read::distributed::{Bin, Distributed};
use crate::scenes::read::entries::System;
use crate::scenes::read::error::Result;
use crate::scenes::read::scene_file::SceneFile;
use crate::scenes::read::words;
use crate::scenes::run::state_result::SolvedUnit;
use analysis::{Column, Table};
use plots::{Chart, Curve};

/// Curves of a model in one picture.
const CURVES: usize = 5;

/// The names of all files that a scene may have of them.
pub(crate) fn files(scene: &SceneFile) -> Vec<String> {
    let names = scene.requested.distributions.iter().map(|of| of.name());
    names.flat_map(|name| ["csv", "svg", "png"].map(|end| format!("distribution-{name}.{end}"))).collect()
}

/// The distribution of all states as a table.
pub(crate) fn table(
    scene: &SceneFile,
    of: Distributed,
    title: String,
    units: &[SolvedUnit<'_>],
) -> Result<Table> {
    let (_, unit, per_unit) = of.words();
    let shown = if scene.system == System::Si { [unit, per_unit] } else { ["scene"; 2] };
    let density = match of {
        Distributed::Patches => "contacts per area: its integral is their number",
        _ => "share of the nominal area per unit: its integral is the share of the cells above zero",
    };
    let column = |name, unit, meaning| Column { name, unit, meaning };
    let columns = vec![
        column("model", "-", "who answers"),
        column("surface", "1", "number of the surface, from 0"),
        column("state", "1", "number of the load, from 0"),
        column("lower", shown[0], "lower end of the bin"),
        column("upper", shown[0], "upper end of the bin"),
        column("density", shown[1], density),
    ];
    let mut table = Table::new(title, columns);
    for &SolvedUnit { model, surface, states } in units {
        for state in states {
            for [lower, upper, density] in state.distributions.iter().filter(|d| d.0 == of).flat_map(|d| &d.1)
            {
                let row = vec![
                    model.into(),
                    surface.into(),
                    state.index.into(),
                    (*lower).into(),
                    (*upper).into(),
                    (*density).into(),
                ];
                table.push(row).map_err(runs::Error::model("a bin"))?;
            }
        }
    }
    Ok(table)
}

/// The distribution under a few loads on surface 0; `None` without any.
pub(crate) fn chart(scene: &SceneFile, of: Distributed, units: &[SolvedUnit<'_>]) -> Option<Chart> {
    let mut curves = Vec::new();
    for &SolvedUnit { model, states, .. } in units.iter().filter(|unit| unit.surface == 0) {
        let with: Vec<(usize, &Vec<Bin>)> = states
            .iter()
            .filter_map(|s| Some((s.index, &s.distributions.iter().find(|d| d.0 == of)?.1)))
            .filter(|(_, bins)| !bins.is_empty())
            .collect();
        let shown = with.len().min(CURVES);
        for i in 0..shown {
            let (state, bins) = with[i * (with.len() - 1) / (shown - 1).max(1)];
            let middle = |[lower, upper, density]: &Bin| match of {
                Distributed::Patches => ((lower * upper).sqrt(), *density),
                _ => (f64::midpoint(*lower, *upper), *density),
            };
            let load = words::load(scene, state);
            let label =
                if scene.models.len() > 1 { format!("{}, {load}", words::model_name(model)) } else { load };
            curves.push(Curve { label, points: bins.iter().map(middle).collect(), band: Vec::new() });
        }
    }
    let (words, unit, per_unit) = of.words();
    let with = |unit: &str| match scene.system {
        System::Si => format!(" ({})", words::unit_label(unit)),
        System::None => String::new(),
    };
    let density =
        if of == Distributed::Patches { "contacts per area" } else { "density over the nominal area" };
    let mut title = format!("{words}: distribution");
    title[..1].make_ascii_uppercase();
    let number = if scene.sampling.surfaces > 1 { ", surface 0" } else { "" };
    (!curves.is_empty()).then(|| Chart {
        title,
        subtitle: format!("scene: {}{number}", words::scene_name(scene)),
        x_label: format!("{words}{}", with(unit)),
        y_label: format!("{density}{}", with(per_unit)),
        curves,
        logarithmic: of == Distributed::Patches,
    })
}
