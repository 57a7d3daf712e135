//! Distributions of pressure, gap and contact areas: `distribution-NAME.csv`, and a picture of surface 0.

use crate::scenes::read::{Bin, Distributed, Result, SceneFile, System, multiple, words};
use crate::scenes::run::{SolvedUnit, StateRecord};
use crate::scenes::tell::{StateTable, columns};
use contact_model::{Table, Value};
use plots::{Chart, Curve};

/// Curves of a model in one picture.
const CURVES: usize = 5;

/// The names of all files of distributions that a scene may have.
pub(crate) fn files(scene: &SceneFile) -> Vec<String> {
    let names = scene.requested.distributions.iter().map(|of| of.name());
    names.flat_map(|name| ["csv", "svg", "png"].map(|end| format!("distribution-{name}.{end}"))).collect()
}

/// The distribution of all states as a table.
pub(crate) fn table(states: &StateTable<'_>, of: Distributed) -> Result<Table> {
    let scene = states.scene;
    let title = format!("{}: distribution of {}", states.title, of.name());
    let (_, unit, per_unit) = of.words();
    let [unit, per_unit] = [unit, per_unit].map(|unit| scene.system.unit(unit));
    let density = match of {
        Distributed::Patches => "contacts per area: its integral is their number",
        Distributed::ContactPressure => "share of the contact area per unit: its integral is 1",
        _ => "share of the nominal area per unit: its integral is the share of the cells above zero",
    };
    let columns = [
        columns::MODEL,
        columns::SURFACE,
        columns::LOAD,
        ("lower", unit, "lower end of the bin"),
        ("upper", unit, "upper end of the bin"),
        ("density", per_unit, density),
    ];
    let rows = states.records().flat_map(|(unit, record)| {
        let bins = record.distributions.iter().filter(|d| d.0 == of).flat_map(|d| &d.1);
        bins.map(|bin| {
            let [lower, upper, density] = bin.map(Value::from);
            [unit.model.into(), unit.surface.into(), record.index.into(), lower, upper, density]
        })
    });
    Ok(columns::table(title, columns, rows, "a bin")?)
}

/// The distribution under a few loads on surface 0; `None` without any.
pub(crate) fn chart(states: &StateTable<'_>, of: Distributed) -> Option<Chart> {
    let scene = states.scene;
    let mut curves = Vec::new();
    for &SolvedUnit { model, states, .. } in states.units.iter().filter(|unit| unit.surface == 0) {
        let with: Vec<(&StateRecord, &Vec<Bin>)> = states
            .iter()
            .filter_map(|s| Some((s, &s.distributions.iter().find(|d| d.0 == of)?.1)))
            .filter(|(_, bins)| !bins.is_empty())
            .collect();
        let shown = with.len().min(CURVES);
        for i in 0..shown {
            let (state, bins) = with[i * (with.len() - 1) / (shown - 1).max(1)];
            let middle = |[lower, upper, density]: &Bin| match of {
                Distributed::Patches => ((lower * upper).sqrt(), *density),
                _ => (f64::midpoint(*lower, *upper), *density),
            };
            let load = state.words(scene);
            let label =
                if scene.models.len() > 1 { format!("{}, {load}", words::model_name(model)) } else { load };
            curves.push(Curve { label, points: bins.iter().map(middle).collect(), ..Curve::default() });
        }
    }
    let (words, unit, _) = of.words();
    let largest = curves.iter().flat_map(|curve| &curve.points).map(|point| point.0).fold(0.0, f64::max);
    let (unit, factor) = multiple(scene.system.shown(unit), largest);
    for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
        *point = (factor * point.0, point.1 / factor);
    }
    let with = |unit: &str| match scene.system {
        System::Si => format!(" ({})", words::unit_label(unit)),
        System::None => String::new(),
    };
    let density = match of {
        Distributed::Patches => "contacts per area",
        Distributed::ContactPressure => "density over the contact area",
        Distributed::Pressure | Distributed::Gap => "density over the nominal area",
    };
    let mut title = format!("{words}: distribution");
    title[..1].make_ascii_uppercase();
    let number = if scene.sampling.surfaces > 1 { ", surface 0" } else { "" };
    (!curves.is_empty()).then(|| Chart {
        title,
        subtitle: format!("{}{number}", words::scene_name(scene)),
        x_label: format!("{words}{}", with(&unit)),
        y_label: format!("{density}{}", with(&format!("1/{unit}"))),
        curves,
        logarithmic: of == Distributed::Patches,
        ..Chart::default()
    })
}
