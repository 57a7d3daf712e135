//! Distributions of pressure, gap and contact areas in one state.

use contact_model::{Field, Patches};

/// Bins of pressures and gaps: the square root of the number of values, within these.
const BINS: (usize, usize) = (4, 50);
/// The quantity of a distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Distributed {
    /// The pressure of the cells in contact, as a density over the nominal area: its integral is the contact
    /// fraction.
    Pressure,
    /// The gap of the others, in the same way.
    Gap,
    /// Areas of connected contacts, as the number of contacts per area.
    Patches,
    /// The pressure of the cells in contact, as a density over the contact area: its integral is 1.
    ContactPressure,
}

impl Distributed {
    /// All of them with their names in `[outputs]`.
    pub const ALL: [(&'static str, Self); 4] = [
        ("pressure", Self::Pressure),
        ("gap", Self::Gap),
        ("patches", Self::Patches),
        ("contact_pressure", Self::ContactPressure),
    ];

    /// Its name in `[outputs]` and in names of files.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }

    pub(crate) fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Pressure => ("pressure", "Pa", "1/Pa"),
            Self::Gap => ("gap", "m", "1/m"),
            Self::Patches => ("area of a contact", "m^2", "1/m^2"),
            Self::ContactPressure => ("pressure in contact", "Pa", "1/Pa"),
        }
    }
}

/// A bin: its ends and the density in it.
pub(crate) type Bin = [f64; 3];

/// The requested distributions of a state with pressure, gap and contacts; `cell` is the area of a cell.
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
        Distributed::ContactPressure => {
            let in_contact = pressure?.values().iter().copied().filter(|p| *p > 0.0);
            Some(of_cells(&in_contact.collect::<Vec<_>>()))
        }
    };
    asked.iter().filter_map(|&name| Some((name, of(name)?))).collect()
}

/// Densities of the positive values in equal bins from 0 to the largest, with all values (cells) as the
/// whole.
pub(crate) fn of_cells(values: &[f64]) -> Vec<Bin> {
    let positive = || values.iter().copied().filter(|v| *v > 0.0 && v.is_finite());
    let largest = positive().fold(0.0, f64::max);
    let bins = (positive().count() as f64).sqrt().round().clamp(BINS.0 as f64, BINS.1 as f64) as usize;
    let width = largest / bins as f64;
    if width == 0.0 {
        return Vec::new();
    }
    let mut counts = vec![0_usize; bins];
    for value in positive() {
        counts[((value / width) as usize).min(bins - 1)] += 1;
    }
    let whole = values.len() as f64 * width;
    counts
        .iter()
        .enumerate()
        .map(|(i, &n)| [i as f64 * width, (i + 1) as f64 * width, n as f64 / whole])
        .collect()
}

/// Numbers of contacts per area in bins that double, the first of which holds contacts of one cell alone;
/// empty bins are left out.
pub(crate) fn of_patches(areas: &[f64], cell: f64) -> Vec<Bin> {
    let bin = |area: &f64| (area / (0.75 * cell)).log2().floor().max(0.0) as i32;
    let last = areas.iter().map(bin).max().unwrap_or(-1);
    let count = |i: i32| areas.iter().filter(|area| bin(area) == i).count();
    let ends = |i: i32| [0.75 * cell * f64::from(i).exp2(), 1.5 * cell * f64::from(i).exp2()];
    let density = |i: i32| count(i) as f64 / (ends(i)[1] - ends(i)[0]);
    (0..=last).filter(|&i| count(i) > 0).map(|i| [ends(i)[0], ends(i)[1], density(i)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_integrate_to_shares_and_numbers() {
        let values = [0.0, 0.0, 1.0, 2.0, 50.0, f64::NAN, f64::INFINITY, 0.5];
        let bins = of_cells(&values);
        assert_eq!((bins.len(), bins[0], bins[3][1]), (4, [0.0, 12.5, 3.0 / 100.0], 50.0));
        assert_eq!([100, 10_000].map(|n| of_cells(&vec![1.0; n]).len()), [10, 50]);
        let integral = |bins: &[Bin]| bins.iter().map(|[a, b, d]| (b - a) * d).sum::<f64>();
        approx::assert_relative_eq!(integral(&bins), 0.5, max_relative = 1e-14);
        assert_eq!(of_cells(&[0.0, f64::NAN]), Vec::<Bin>::new());
        // Contacts of 1, 1, 2, 3 and 1000 cells.
        let areas = [500.0, 1.5, 1.0, 0.5, 0.5];
        let bins = of_patches(&areas, 0.5);
        assert_eq!(bins[..2], [[0.375, 0.75, 2.0 / 0.375], [0.75, 1.5, 1.0 / 0.75]]);
        approx::assert_relative_eq!(integral(&bins), 5.0, max_relative = 1e-14);
        assert_eq!(of_patches(&[], 1.0), Vec::<Bin>::new());
        // Over the contact area, which is three eighths of the cells.
        let pressure = Field::new([4, 2], 1.0, vec![0.0, 0.0, 1.0, 2.0, 50.0, 0.0, 0.0, 0.0]).unwrap();
        let both = [Distributed::Pressure, Distributed::ContactPressure];
        let found = of_state(&both, (Some(&pressure), None, None), 0.125);
        approx::assert_relative_eq!(integral(&found[0].1), 0.375, max_relative = 1e-14);
        approx::assert_relative_eq!(integral(&found[1].1), 1.0, max_relative = 1e-14);
        for (place, (name, of)) in Distributed::ALL.into_iter().enumerate() {
            assert_eq!((of as usize, of.name()), (place, name));
        }
    }
}
