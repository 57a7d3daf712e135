//! Tables that several figures share: the curves and their samples.

use crate::evaluation::measured::Measured;
use crate::evaluation::realisation::RealisationResult;
use crate::evaluation::sample::{FLOOR_CELLS, Sample};
use crate::evaluation::table_of::TableOf;
use contact_model::Table;
use runs::Result;

/// Meaning of a column `model`.
pub const MODEL: &str = "bem3d: 3D boundary elements; mdr1d: 1D reduction";
/// Meaning of a column `fractal_dimension`.
pub const FRACTAL_DIMENSION: &str = "D_f = 3 - H of the 3D surface";
/// Meaning of a column `force_bar`.
pub const FORCE_BAR: &str = "F/(E* h L), h the measured rms height of each surface (Eq. 10)";
const CELLS: &str = "cells a side (bem3d) or elements (mdr1d)";

/// Mean curves: the table of Figs. 2 and 6.
///
/// # Errors
/// As [`TableOf::table`].
pub fn curves_table(title: &str, measured: &Measured) -> Result<Table> {
    const MEAN: &str = "arithmetic mean of k/(1.1419 E* L) (Eq. 8) over the converged surfaces";
    const FEWEST: &str = "fewest cells (elements) in contact on any surface of the mean";
    const FLOOR: &str = "true where some surface has fewer than 10 contact cells: left out of fits and lines";
    const AREA: &str = "mean contact area over A0; empty where the model claims no area";
    let (model, size) = (measured.discretisation.name(), measured.discretisation.size());
    let points: Vec<_> =
        measured.series.iter().flat_map(|s| s.points.iter().enumerate().map(move |p| (s, p))).collect();
    TableOf::new(title, &points)
        .column("model", "-", MODEL, |_| model)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |(s, _)| s.fractal_dimension)
        .column("force_bar", "1", FORCE_BAR, |(_, p)| p.1.force_bar)
        .column("stiffness_bar", "1", MEAN, |(_, p)| p.1.stiffness_bar.map(|k| k.mean))
        .column("stiffness_bar_se", "1", "standard error of that mean; empty for one surface", |(_, p)| {
            p.1.stiffness_bar.and_then(|k| k.standard_error)
        })
        .column("stiffness_bar_log_mean", "1", "exp(mean ln k_bar)", |(_, p)| {
            p.1.stiffness_bar.map(|k| k.log_mean)
        })
        .column("surfaces", "1", "surfaces in the mean", |(_, p)| p.1.stiffness_bar.map_or(0, |k| k.count))
        .column("cells", "1", CELLS, |_| size)
        .column(
            "not_converged",
            "1",
            "surfaces left out because the solver did not meet its tolerance",
            |(_, p)| p.1.missing,
        )
        .column("min_contact_cells", "1", FEWEST, |(_, p)| p.1.min_contact_cells)
        .column("below_floor", "-", FLOOR, |(_, p)| p.1.min_contact_cells.is_some_and(|c| c < FLOOR_CELLS))
        .column("contact_fraction", "1", AREA, |(s, p)| s.contact_fraction(p.0))
        .column("approach_over_h", "1", "mean d/h, d from first touch of the highest point", |(s, p)| {
            s.approach_over_h(p.0)
        })
        .table()
}

fn seven_digits(value: f64) -> String {
    format!("{value:.6e}")
}

/// One row for each surface on its grid and, of the first surfaces, on the two coarser ones, with seven digits.
///
/// # Errors
/// As [`TableOf::table`].
pub fn compact_table(title: &str, measured: &Measured) -> Result<Table> {
    const LOADS: &str =
        "at the loads of the curves' table, from the smallest up, separated by blanks; - where there is none";
    let coarser = measured.coarser.iter().flat_map(|both| both.iter());
    let grids = std::iter::once(measured).chain(coarser);
    let realisations: Vec<_> = grids.flat_map(|m| &m.series).flat_map(|s| &s.realisations).collect();
    let values = |result: &RealisationResult, of: fn(&Sample) -> Option<String>| {
        let each =
            result.samples.iter().map(|s| of(s).filter(|_| s.converged()).unwrap_or_else(|| "-".to_owned()));
        each.collect::<Vec<_>>().join(" ")
    };
    TableOf::new(title, &realisations)
        .column("size", "1", CELLS, |(u, _)| u.discretisation.size())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |(u, _)| u.fractal_dimension)
        .column("surface", "1", "number of the surface in its ensemble", |(u, _)| u.index)
        .column("seed", "1", "seed of this surface", |(u, _)| u.seed())
        .column("stiffness_bar", "1", LOADS, |(_, r)| values(r, |s| s.stiffness_bar.map(seven_digits)))
        .column("approach_over_h", "1", LOADS, |(_, r)| values(r, |s| s.approach_over_h.map(seven_digits)))
        .column("contact_cells", "1", LOADS, |(_, r)| values(r, |s| s.contact_cells.map(|c| c.to_string())))
        .table()
}

/// The samples of a figure: one row for each surface and load.
///
/// # Errors
/// As [`TableOf::table`].
pub fn samples_table(title: &str, measured: &Measured) -> Result<Table> {
    const STATUS: &str = "converged: every number of the certificate is within the tolerance";
    const GAP: &str = "sum p (g - min g)/(F h), the duality gap in its Frank-Wolfe form";
    const AREA: &str = "contact area over A0; empty where the model claims no area";
    let (model, size) = (measured.discretisation.name(), measured.discretisation.size());
    let realisations = measured.series.iter().flat_map(|s| &s.realisations);
    let samples: Vec<_> = realisations.flat_map(|(u, r)| r.samples.iter().map(move |s| (s, u, r))).collect();
    TableOf::new(title, &samples)
        .column("model", "-", MODEL, |_| model)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |(_, u, _)| u.fractal_dimension)
        .column("surface", "1", "number of the surface in its ensemble", |(_, u, _)| u.index)
        .column("seed", "1", "seed of this surface", |(_, u, _)| u.seed())
        .column("force_bar", "1", FORCE_BAR, |(s, ..)| s.force_bar)
        .column("approach_over_h", "1", "d/h, d from first touch of the highest point", |(s, ..)| {
            s.approach_over_h
        })
        .column("stiffness_bar", "1", "k/(1.1419 E* L) (Eq. 8)", |(s, ..)| s.stiffness_bar)
        .column("contact_fraction", "1", AREA, |(s, ..)| s.contact_fraction)
        .column("iterations", "1", "iterations of the solver", |(s, ..)| s.iterations)
        .column("applications", "1", "applications of the elastic operator", |(s, ..)| s.applications)
        .column("contact_cells", "1", "cells (elements) in contact", |(s, ..)| s.contact_cells)
        .column("contact_length", "L", "k/E* (Eq. 1)", |(s, ..)| s.contact_length)
        .column("status", "-", STATUS, |(s, ..)| s.status.as_str())
        .column("duality_gap", "1", GAP, |(s, ..)| s.certificate.duality_gap)
        .column("penetration", "1", "max(0, -min g)/h", |(s, ..)| s.certificate.penetration)
        .column("complementarity", "1", "sum p |g|/(F h)", |(s, ..)| s.certificate.complementarity)
        .column("load_error", "1", "|F - F_asked|/F_asked", |(s, ..)| s.certificate.load_error)
        .column("stiffness_error", "1", "estimated relative error of k", |(s, ..)| {
            s.certificate.stiffness_error
        })
        .column("below_floor", "-", "fewer than 10 contact cells", |(s, ..)| s.below_floor())
        .column("force", "E* L^2", "F", |(s, ..)| s.force)
        .column("rms_height", "L", "measured rms height of this surface", |(.., r)| r.rms_height)
        .column("cells", "1", CELLS, |_| size)
        .column("strategy", "-", "which way the solver took", |(s, ..)| s.strategy.as_str())
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::header::{describe, header};
    use crate::evaluation::realisation::EnsembleModel;
    use crate::evaluation::run::Run;
    use crate::evaluation::{Request, Session, measure};
    use approx::assert_relative_eq;
    use runs::{Silent, write_csv};

    #[test]
    fn an_ensemble_is_read_from_its_table() {
        let dir = tempfile::tempdir().unwrap();
        let request = Request {
            cells: Some(129),
            surfaces: Some(3),
            elements: Some(4096),
            lines: Some(3),
            fractal_dimensions: Some(vec![2.2, 2.6]),
            forces: Some("1e-2:20:3".to_owned()),
            out: Some(dir.path().to_owned()),
            ..Request::default()
        };
        let run = Run::new(&request).unwrap();
        let store = Session::open(&run.out, false).unwrap().store;
        let samples = Some(dir.path().to_owned());
        let read = |request: Request, model| {
            let run = Run::new(&Request { samples: samples.clone(), ..request }).unwrap();
            measure(model, &run, &store, &Silent).map_err(|error| error.to_string())
        };
        for (model, name) in
            [(EnsembleModel::Bem3d, "fig2-compact.csv"), (EnsembleModel::Mdr1d, "fig6-compact.csv")]
        {
            let solved = measure(model, &run, &store, &Silent).unwrap();
            assert!(read(request.clone(), model).unwrap_err().contains(name));
            let header = describe(header("command".to_owned()), &run, &[&solved]);
            write_csv(&dir.path().join(name), &compact_table("surfaces", &solved).unwrap(), &header).unwrap();
            let again = read(request.clone(), model).unwrap();
            let grids = |m: &Measured| -> Vec<Measured> {
                std::iter::once(m.clone())
                    .chain(m.coarser.clone().into_iter().flat_map(|both| *both))
                    .collect()
            };
            assert_eq!(grids(&again).len(), 3);
            for (again, solved) in grids(&again).iter().zip(grids(&solved)) {
                assert_eq!(again.discretisation, solved.discretisation);
                for (again, solved) in again.series.iter().zip(&solved.series) {
                    assert_eq!(again.curves.force_bar(), solved.curves.force_bar());
                    for (again, solved) in again.means().into_iter().zip(solved.means()) {
                        assert_relative_eq!(again.unwrap(), solved.unwrap(), max_relative = 1e-6);
                    }
                    for j in 0..again.points.len() {
                        assert_eq!(again.points[j].min_contact_cells, solved.points[j].min_contact_cells);
                        assert_eq!(again.contact_fraction(j).is_some(), model == EnsembleModel::Bem3d);
                    }
                }
            }
            // What the table has not is named.
            let other = read(Request { forces: Some("1e-2:20:4".to_owned()), ..request.clone() }, model);
            assert!(other.unwrap_err().contains("loads 1e-2:20:4"));
            let more = Request { surfaces: Some(4), lines: Some(4), ..request.clone() };
            let missing = read(more, model).unwrap_err();
            assert!(missing.contains("it has no surface 3 (seed "), "{missing}");
        }
        let tight = read(Request { tolerance: Some(1e-6), ..request }, EnsembleModel::Bem3d).unwrap_err();
        assert!(tight.contains("tolerance 1e-6"), "{tight}");
    }
}
