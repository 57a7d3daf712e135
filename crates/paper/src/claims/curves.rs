//! Numbers of the curves themselves: the crossing, saturation, the collapse, lines over surfaces, finer
//! grids.

use super::ensemble::{Ensemble, resampled, stiffness_at};
use super::table::{Found, Row};
use crate::claim::Estimate;
use analysis::{
    Bootstrap, CollapsePoint, FitWindow, Residual, collapse as residual, decades_within, interpolate, sum,
};
use contact_model::PAPER_STIFFNESS_FACTOR;
use evaluation::{Measured, Series, transformed};
use std::ops::RangeInclusive;

pub(super) const NO_LOAD: &str = "outside the loads of this run";

/// k_bar at a load, and its logarithmic mean.
pub(super) fn stiffnesses(solid: &Ensemble<'_>, load: f64) -> Vec<Row> {
    let row = |series: &Series| {
        let conditions = "arithmetic mean, F_bar by the measured rms height".to_owned();
        let found = stiffness_at(series, load).map(|k| (k, conditions)).ok_or(NO_LOAD.into());
        let log_means: Vec<Option<f64>> =
            series.points.iter().map(|p| p.stiffness_bar.map(|k| k.log_mean)).collect();
        let log_mean = interpolate(series.curves.force_bar(), &log_means, load).filter(|_| found.is_ok());
        Row { in_convention: log_mean, ..Row::at(series.fractal_dimension, found) }
    };
    solid.measured.series.iter().map(row).collect()
}

/// Standard deviation of ln k_bar over the curves of all D_f at a load, over that at another.
pub(super) fn spread(solid: &Ensemble<'_>, load: f64, other: f64) -> Vec<Row> {
    let spread = |load: f64, draw: &[usize]| -> Option<f64> {
        let log = |s: &Series| interpolate(s.curves.force_bar(), &s.curves.mean_of(draw), load).map(f64::ln);
        let logs: Option<Vec<f64>> = solid.measured.series.iter().map(log).collect();
        analysis::mean_and_deviation(&logs?)?.1
    };
    let surfaces = solid.surfaces();
    let all: Vec<usize> = (0..surfaces).collect();
    let quotient = |draw: &[usize]| Some(spread(load, draw)? / spread(other, draw)?);
    let found = quotient(&all)
        .and_then(|value| Estimate::normal(value, Bootstrap::default().half_width(surfaces, quotient)))
        .map(|found| {
            (found, format!("relative spread {:.3} at {load}", spread(load, &all).unwrap_or_default()))
        });
    Row::only(found.ok_or("fewer than two curves, or surfaces, at these loads".into()))
}

/// Eq. 13 from the solved stiffness: Lambda (rho_1 + rho_2)/L, mean over D_f.
pub(super) fn conductance(solid: &Ensemble<'_>, load: f64) -> Vec<Row> {
    let values: Vec<Estimate> =
        solid.measured.series.iter().filter_map(|series| stiffness_at(series, load)).collect();
    // Shared phases: the errors of different D_f add, they do not average out.
    let mean = |pick: fn(&Estimate) -> f64| sum(values.iter().map(pick)) / values.len() as f64;
    let (k, half_width) = (mean(|e| e.value), mean(|e| e.half_width));
    Row::only(match analysis::conductance(k * PAPER_STIFFNESS_FACTOR, 1.0, 0.5, 0.5) {
        Ok(value) if !values.is_empty() => {
            let found = Estimate { value, half_width: half_width * 2.0 * PAPER_STIFFNESS_FACTOR };
            Ok((found, "2 k/(E* L), exact (Barber); errors of all D_f taken to add up".to_owned()))
        }
        _ => Err(NO_LOAD.into()),
    })
}

/// F_bar at which a mean curve reaches a share of its plateau, by straight lines in ln-ln; `None` outside the
/// loads.
fn reaches(measured: &Measured, series: &Series, share: f64, draw: &[usize]) -> Option<f64> {
    let stiffness_bar = share * measured.discretisation.complete_contact();
    let points: Vec<(f64, f64)> = (series.curves.force_bar().iter().zip(series.curves.mean_of(draw)))
        .filter_map(|(&f, k)| Some((f, k?)))
        .collect();
    let pair = points.windows(2).find(|p| p[0].1 < stiffness_bar && p[1].1 >= stiffness_bar)?;
    let t = (stiffness_bar / pair[0].1).ln() / (pair[1].1 / pair[0].1).ln();
    Some(pair[0].0 * (pair[1].0 / pair[0].0).powf(t))
}

/// The same with its scatter.
fn force_of(measured: &Measured, series: &Series, share: f64) -> Option<Estimate> {
    resampled(series.realisations.len(), |draw| reaches(measured, series, share, draw))
}

pub(super) fn force_at_share(ensemble: &Ensemble<'_>, share: f64) -> Vec<Row> {
    ensemble.each(|series| {
        let force = force_of(ensemble.measured, series, share).ok_or(NO_LOAD)?;
        let last = series.curves.force_bar().last().copied().unwrap_or_default();
        let k = stiffness_at(series, last).map_or(0.0, |k| k.value);
        let plateau = ensemble.measured.discretisation.complete_contact();
        Ok((force, format!("the plateau of this grid is {plateau:.4}, k_bar = {k:.4} at F_bar = {last}")))
    })
}

pub(super) fn area_at_share(solid: &Ensemble<'_>, share: f64) -> Vec<Row> {
    solid.each(|series| {
        let fractions: Vec<Option<f64>> =
            (0..series.points.len()).map(|j| series.contact_fraction(j)).collect();
        let force = reaches(solid.measured, series, share, &series.curves.all()).ok_or(NO_LOAD)?;
        let area = interpolate(series.curves.force_bar(), &fractions, force).ok_or(NO_LOAD)?;
        let remark =
            "mean over the surfaces; waves down to two cells: a finer grid has less area, so an upper bound";
        Ok((Estimate::exact(area), remark.to_owned()))
    })
}

/// The force of a share of the plateau, lines over surfaces.
pub(super) fn sooner(solid: &Ensemble<'_>, line: &Ensemble<'_>, share: f64) -> Vec<Row> {
    compared(solid, line, |of_solid, of_line| {
        let forces = force_of(line.measured, of_line, share).zip(force_of(solid.measured, of_solid, share));
        let (line, solid) = forces.ok_or(NO_LOAD)?;
        Ok((line.over(solid), "each of its own plateau".to_owned()))
    })
}

/// A row for each D_f from the series of both models.
fn compared(
    solid: &Ensemble<'_>,
    line: &Ensemble<'_>,
    found: impl Fn(&Series, &Series) -> Found,
) -> Vec<Row> {
    let row = |(solid, line): (&Series, &Series)| Row::at(solid.fractal_dimension, found(solid, line));
    solid.beside(line).map(row).collect()
}

/// k_1D/k_3D at a load.
fn ratio_at(solid: &Series, line: &Series, load: f64) -> Option<Estimate> {
    Some(stiffness_at(line, load)?.over(stiffness_at(solid, load)?))
}

pub(super) fn largest_ratio(
    solid: &Ensemble<'_>,
    line: &Ensemble<'_>,
    loads: RangeInclusive<f64>,
) -> Vec<Row> {
    let mut largest: Option<(Estimate, String)> = None;
    for (solid, line) in solid.beside(line) {
        for &load in solid.curves.force_bar().iter().filter(|load| loads.contains(*load)) {
            let Some(ratio) = ratio_at(solid, line, load) else { continue };
            if largest.as_ref().is_none_or(|(most, _)| ratio.value > most.value) {
                let d = solid.fractal_dimension;
                largest = Some((ratio, format!("at F_bar = {load:.3}, D_f = {d:?}")));
            }
        }
    }
    let none = || format!("no load of the two models in common above {}", loads.start()).into();
    Row::only(largest.ok_or_else(none))
}

/// Number of cells in contact on every surface from which on k_3D counts as resolved in a ratio.
const RESOLVED: usize = 100;

/// Loads at which the surface resolves its contact.
fn resolved(solid: &Series) -> impl Iterator<Item = f64> {
    let resolved = solid.points.iter();
    resolved
        .filter(|p| p.missing == 0 && p.min_contact_cells.is_some_and(|cells| cells >= RESOLVED))
        .map(|p| p.force_bar)
}

pub(super) fn ratio_at_smallest_load(solid: &Ensemble<'_>, line: &Ensemble<'_>) -> Vec<Row> {
    compared(solid, line, |solid, line| {
        let load = resolved(solid).find(|load| *load >= 1e-3 * (1.0 - 1e-9)).filter(|load| *load <= 0.086);
        let ratio = load.and_then(|load| Some((load, ratio_at(solid, line, load)?)));
        let (load, ratio) = ratio.ok_or_else(|| {
            format!("no common load up to 0.086 with {RESOLVED} contact cells on every surface: finer grids have one")
        })?;
        let remark = format!(
            "at F_bar = {load:.2e}, the smallest load from 1e-3 on at which every surface has {RESOLVED} cells in contact"
        );
        Ok((ratio, remark))
    })
}

pub(super) fn farthest_ratio(solid: &Ensemble<'_>, line: &Ensemble<'_>) -> Vec<Row> {
    compared(solid, line, |solid, line| {
        let ratios = resolved(solid).filter_map(|load| Some((load, ratio_at(solid, line, load)?)));
        let farthest = ratios.max_by(|a, b| a.1.distance_from_one().total_cmp(&b.1.distance_from_one()));
        let (load, ratio) = farthest
            .ok_or_else(|| format!("no common load with {RESOLVED} contact cells on every surface"))?;
        let remark =
            format!("at F_bar = {load:.2e}; loads at which every surface has {RESOLVED} cells in contact");
        Ok((ratio, remark))
    })
}

/// Relative change of the mean stiffness with cells twice as large, where it is largest in the window of the
/// power law.
pub(super) fn change_with_grid(solid: &Ensemble<'_>) -> Vec<Row> {
    solid.each(|series| {
        let window = FitWindow::PAPER;
        let coarser = solid.measured.coarser_at(series.fractal_dimension);
        let inside = series.points.iter().enumerate().filter(|(_, p)| {
            p.force_bar <= window.max_force_bar
                && p.min_contact_cells.is_some_and(|c| c >= window.min_contact_cells)
        });
        let change = |(j, p): (usize, &analysis::EnsemblePoint)| {
            let last = changes(series, coarser, j)?;
            Some((Estimate::mean(&last)?, p.force_bar, last.len()))
        };
        let largest = inside.filter_map(change).max_by(|a, b| a.0.value.abs().total_cmp(&b.0.value.abs()));
        let (found, load, surfaces) = largest.ok_or("no coarser grid, or no resolved load up to 0.086")?;
        let remark = format!(
            "at F_bar = {load:.1e}, where it is largest; mean over {surfaces} surfaces, Student's interval"
        );
        Ok((found, remark))
    })
}

/// Relative changes of k of each surface that is on both grids, at force number `j`.
fn changes(series: &Series, coarser: Option<[&Series; 2]>, j: usize) -> Option<Vec<f64>> {
    Some(series.grid_differences(coarser?, j).iter().map(|d| d[0]).collect())
}

/// rms of these changes over the scatter between surfaces, at the load nearest to one.
pub(super) fn change_over_scatter(solid: &Ensemble<'_>, load: f64) -> Vec<Row> {
    let away = |f: f64| (f / load).ln().abs();
    solid.each(|series| {
        let number = || {
            let nearest = |&a: &usize, &b: &usize| {
                away(series.points[a].force_bar).total_cmp(&away(series.points[b].force_bar))
            };
            let j = (0..series.points.len()).min_by(nearest)?;
            let k =
                series.points[j].stiffness_bar.filter(|_| away(series.points[j].force_bar) < 1.5_f64.ln())?;
            let changes = changes(series, solid.measured.coarser_at(series.fractal_dimension), j)?;
            let scatter = k.standard_error? * (k.count as f64).sqrt() / k.mean;
            let n = changes.len() as f64;
            let value = (sum(changes.iter().map(|change| change.powi(2))) / n).sqrt() / scatter;
            // ln of a sample variance of n normal numbers has the variance 2/n; half of it for the root.
            let ln_error = (0.5 / n + 0.5 / (k.count as f64 - 1.0)).sqrt();
            (value > 0.0).then_some((Estimate { value, half_width: value * 1.96 * ln_error }, changes.len()))
        };
        let none = || format!("no coarser grid, or no load within a factor 1.5 of {load}");
        let (found, surfaces) = number().ok_or_else(none)?;
        let conditions = "the interval takes the logarithms of both variances as normal";
        Ok((found, format!("{surfaces} surfaces on both grids; {conditions}")))
    })
}

/// The transformed curves of Fig. 4 above the floor of the grid, of redrawn surfaces or of all.
fn master_curves(solid: &Ensemble<'_>, draw: Option<&[usize]>) -> Vec<Vec<CollapsePoint>> {
    let above_floor = |series: &Series| -> Vec<CollapsePoint> {
        transformed(series).into_iter().filter(|p| !p.1).map(|p| p.0).collect()
    };
    let series = solid.measured.series.iter();
    series.map(|s| draw.map_or_else(|| above_floor(s), |draw| above_floor(&s.redrawn(draw)))).collect()
}

/// A residual of the master curve in decades of F_tilde, up to a load.
pub(super) fn collapse(solid: &Ensemble<'_>, top: f64, pick: fn(&Residual) -> Option<f64>) -> Vec<Row> {
    let of = |draw: Option<&[usize]>| {
        Some(pick(&residual(&master_curves(solid, draw), 0.0, top)?)? / std::f64::consts::LN_10)
    };
    let error = Bootstrap { resamples: 100, ..Bootstrap::default() }
        .standard_error(solid.surfaces(), |draw| of(Some(draw)));
    let found = of(None)
        .and_then(|value| Estimate::normal(value, error))
        // Half a decade of points cannot show a collapse.
        .filter(|_| solid.laws.iter().any(Result::is_ok))
        .map(|found| (found, "at least 10 contact cells on every surface".to_owned()));
    Row::only(found.ok_or("no fractal dimension has a window of a decade or more, or one surface".into()))
}

/// Decades of F_bar within a factor of the master curve, for the best D_f.
pub(super) fn decades(solid: &Ensemble<'_>, factor: f64) -> Vec<Row> {
    let each: Vec<(f64, f64)> = (solid.measured.series.iter().zip(master_curves(solid, None)))
        .map(|(s, curve)| (s.fractal_dimension, decades_within(&curve, factor)))
        .collect();
    let words: Vec<String> = each.iter().map(|(d, decades)| format!("{decades:.2} at {d:?}")).collect();
    let (words, cells) = (words.join(", "), solid.measured.discretisation.size());
    Row::only(match each.iter().map(|e| e.1).max_by(f64::total_cmp) {
        // Loads are a third of a decade apart.
        Some(value) if cells >= 2049 => Ok((
            Estimate { value, half_width: 0.33 },
            format!("{words}; the interval is the distance of the loads"),
        )),
        Some(_) => Err(format!("{words}: {cells} cells a side, the claim is for 2049").into()),
        None => Err("no curve".into()),
    })
}

/// Seconds of the stored jobs of both models, whenever they were solved. They depend on the machine and are
/// therefore not written to files.
pub(super) fn run_times(solid: &Ensemble<'_>, line: &Ensemble<'_>) -> Vec<Row> {
    let (solid, line) = (solid.measured, line.measured);
    let (t3, t1) = (solid.seconds(), line.seconds());
    let count = |m: &Measured| m.series.iter().map(|s| s.realisations.len()).sum::<usize>();
    let (cells, elements) = (solid.discretisation.size(), line.discretisation.size());
    let sizes = format!(
        "{t3:.1} s for {} surfaces of {cells} cells a side, {t1:.1} s for {} lines of {elements} elements (sum over surfaces and lines; depends on the \
         machine); the solver here takes seconds for a surface",
        count(solid),
        count(line)
    );
    let ratio = t3 / t1;
    Row::only(if cells < 2049 || elements < 1 << 20 {
        Err(format!("here {ratio:.3e}: {sizes}; the statement is about 2049 cells and 2^20 elements").into())
    } else {
        Ok((Estimate::exact(ratio), sizes))
    })
}
