//! Distributions of pressure, gap and contact areas: `distribution-NAME.csv`, and a picture of surface 0.

use crate::scenes::entries::System;
use crate::scenes::error::Result;
use crate::scenes::model_on_surface::StateResult;
use crate::scenes::pictures;
use crate::scenes::scene_file::SceneFile;
use analysis::{Column, Table};
use contact_model::{Field, Patches};
use plots::{Chart, Curve};

/// Bins of pressures and gaps.
const BINS: usize = 50;
/// Curves of a model in one picture.
const CURVES: usize = 5;

/// What may be distributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distributed {
    /// The pressure of the cells in contact, as a density over the nominal area: its integral is the contact fraction.
    Pressure,
    /// The gap of the others, in the same way.
    Gap,
    /// Areas of connected contacts: number of contacts per area.
    Patches,
}

impl Distributed {
    /// All of them with their names in `[outputs]`.
    pub const ALL: [(&'static str, Self); 3] =
        [("pressure", Self::Pressure), ("gap", Self::Gap), ("patches", Self::Patches)];

    /// Its name in `[outputs]` and in names of files.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }

    fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Pressure => ("pressure", "Pa", "1/Pa"),
            Self::Gap => ("gap", "m", "1/m"),
            Self::Patches => ("area of a contact", "m^2", "1/m^2"),
        }
    }
}

/// The names of all files that a scene may have of them.
pub(crate) fn files(scene: &SceneFile) -> Vec<String> {
    let names = scene.requested.distributions.iter().map(|of| of.name());
    names.flat_map(|name| ["csv", "svg", "png"].map(|end| format!("distribution-{name}.{end}"))).collect()
}

/// A bin: its ends and the density in it.
pub(crate) type Bin = [f64; 3];

/// Those of a state with pressure, gap and contacts, as far as they were asked for; each cell has this area.
pub(crate) fn of_state(
    asked: &[Distributed],
    (pressure, gap, patches): (Option<&Field>, Option<&Field>, Option<&Patches>),
    cell: f64,
) -> Vec<(Distributed, Vec<Bin>)> {
    let of = |of: Distributed| match of {
        Distributed::Pressure => Some(of_cells(pressure?.values())),
        Distributed::Gap => {
            // Where there is contact, the gap is rounding.
            let open = |(g, p): (&f64, &f64)| if *p > 0.0 { 0.0 } else { *g };
            Some(of_cells(&gap?.values().iter().zip(pressure?.values()).map(open).collect::<Vec<_>>()))
        }
        Distributed::Patches => Some(of_patches(patches?.areas(), cell)),
    };
    asked.iter().filter_map(|&name| Some((name, of(name)?))).collect()
}

/// Densities of the positive values in [`BINS`] equal bins from 0 to the largest, with all values (cells) as the whole.
pub(crate) fn of_cells(values: &[f64]) -> Vec<Bin> {
    let positive = || values.iter().copied().filter(|v| *v > 0.0 && v.is_finite());
    let largest = positive().fold(0.0, f64::max);
    let width = largest / BINS as f64;
    if width == 0.0 {
        return Vec::new();
    }
    let mut counts = [0_usize; BINS];
    for value in positive() {
        counts[((value / width) as usize).min(BINS - 1)] += 1;
    }
    let whole = values.len() as f64 * width;
    counts
        .iter()
        .enumerate()
        .map(|(i, &n)| [i as f64 * width, (i + 1) as f64 * width, n as f64 / whole])
        .collect()
}

/// Numbers of contacts per area in bins that double, the first of which holds contacts of one cell alone; empty bins are left out.
pub(crate) fn of_patches(areas: &[f64], cell: f64) -> Vec<Bin> {
    let bin = |area: &f64| (area / (0.75 * cell)).log2().floor().max(0.0) as i32;
    let last = areas.iter().map(bin).max().unwrap_or(-1);
    let count = |i: i32| areas.iter().filter(|area| bin(area) == i).count();
    let ends = |i: i32| [0.75 * cell * f64::from(i).exp2(), 1.5 * cell * f64::from(i).exp2()];
    let density = |i: i32| count(i) as f64 / (ends(i)[1] - ends(i)[0]);
    (0..=last).filter(|&i| count(i) > 0).map(|i| [ends(i)[0], ends(i)[1], density(i)]).collect()
}

/// One model on one surface with its states.
pub(crate) type Solved<'a> = (&'static str, usize, &'a [StateResult]);

/// The distribution of all states as a table.
pub(crate) fn table(
    scene: &SceneFile,
    of: Distributed,
    title: String,
    solved: &[Solved<'_>],
) -> Result<Table> {
    let (_, unit, per_unit) = of.words();
    let units = if scene.system == System::Si { [unit, per_unit] } else { ["scene"; 2] };
    let density = match of {
        Distributed::Patches => "contacts per area: its integral is their number",
        _ => "share of the nominal area per unit: its integral is the share of the cells above zero",
    };
    let column = |name, unit, meaning| Column { name, unit, meaning };
    let columns = vec![
        column("model", "-", "who answers"),
        column("surface", "1", "number of the surface, from 0"),
        column("state", "1", "number of the load, from 0"),
        column("lower", units[0], "lower end of the bin"),
        column("upper", units[0], "upper end of the bin"),
        column("density", units[1], density),
    ];
    let mut table = Table::new(title, columns);
    for &(model, surface, states) in solved {
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
pub(crate) fn chart(scene: &SceneFile, of: Distributed, solved: &[Solved<'_>]) -> Option<Chart> {
    let mut curves = Vec::new();
    for &(model, _, states) in solved.iter().filter(|(_, surface, _)| *surface == 0) {
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
            let load = pictures::load(scene, state);
            let label = if scene.models.len() > 1 {
                format!("{}, {load}", pictures::model_name(model))
            } else {
                load
            };
            curves.push(Curve { label, points: bins.iter().map(middle).collect(), band: Vec::new() });
        }
    }
    let (words, unit, per_unit) = of.words();
    let with = |unit: &str| match scene.system {
        System::Si => format!(" ({})", pictures::unit_label(unit)),
        System::None => String::new(),
    };
    let density =
        if of == Distributed::Patches { "contacts per area" } else { "density over the nominal area" };
    let mut title = format!("{words}: distribution");
    title[..1].make_ascii_uppercase();
    let number = if scene.sampling.surfaces > 1 { ", surface 0" } else { "" };
    (!curves.is_empty()).then(|| Chart {
        title,
        subtitle: format!("scene: {}{number}", pictures::scene_name(scene)),
        x_label: format!("{words}{}", with(unit)),
        y_label: format!("{density}{}", with(per_unit)),
        curves,
        logarithmic: of == Distributed::Patches,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_integrate_to_shares_and_numbers() {
        let values = [0.0, 0.0, 1.0, 2.0, 50.0, f64::NAN, f64::INFINITY, 0.5];
        let bins = of_cells(&values);
        assert_eq!((bins.len(), bins[0], bins[49][1]), (BINS, [0.0, 1.0, 1.0 / 8.0], 50.0));
        let integral = |bins: &[Bin]| bins.iter().map(|[a, b, d]| (b - a) * d).sum::<f64>();
        approx::assert_relative_eq!(integral(&bins), 0.5, max_relative = 1e-14);
        assert_eq!(of_cells(&[0.0, f64::NAN]), Vec::<Bin>::new());
        // Contacts of 1, 1, 2, 3 and 1000 cells.
        let areas = [500.0, 1.5, 1.0, 0.5, 0.5];
        let bins = of_patches(&areas, 0.5);
        assert_eq!(bins[..2], [[0.375, 0.75, 2.0 / 0.375], [0.75, 1.5, 1.0 / 0.75]]);
        approx::assert_relative_eq!(integral(&bins), 5.0, max_relative = 1e-14);
        assert_eq!(of_patches(&[], 1.0), Vec::<Bin>::new());
        for (place, (name, of)) in Distributed::ALL.into_iter().enumerate() {
            assert_eq!((of as usize, of.name()), (place, name));
        }
    }
}
