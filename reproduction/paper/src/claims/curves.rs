//! Numbers of the curves themselves: the crossing, saturation, the collapse, lines over surfaces, finer
//! grids.

use super::ensemble::{EnsembleLaws, ONE_SURFACE, resampled, stiffness_at};
use super::solved::height_over_continuous;
use super::table::{ClaimRow, Reason};
use crate::claim::Estimate;
use crate::evaluation::{Measured, Series, transformed};
use analysis::{
    Bootstrap, CollapsePoint, Curves, FitWindow, Residual, collapse as residual, decades_within, interpolate,
    sum,
};
use contact_model::PAPER_STIFFNESS_FACTOR;
use runs::Result;
use std::ops::RangeInclusive;

pub(super) const NO_LOAD: &str = "outside the loads of this run";

/// k_bar at a load, and at the same load where F_bar is counted by the rms height of the continuous spectrum.
pub(super) fn stiffnesses(solid: &EnsembleLaws<'_>, load: f64) -> Result<Vec<ClaimRow>> {
    let row = |series: &Series| {
        let d = series.fractal_dimension;
        let log_means: Vec<Option<f64>> =
            series.points.iter().map(|p| p.stiffness_bar.map(|k| k.log_mean)).collect();
        let log_mean = interpolate(series.curves.force_bar(), &log_means, load);
        let conditions = format!(
            "arithmetic mean, F_bar by the measured rms height; the logarithmic mean is {:.4}",
            log_mean.unwrap_or_default()
        );
        let found = stiffness_at(series, load).map(|k| (k, conditions)).ok_or(NO_LOAD.into());
        let ratio = height_over_continuous(d, solid.measured.discretisation.size())?;
        let continuous = stiffness_at(series, load / ratio).filter(|_| found.is_ok());
        Ok(ClaimRow { in_convention: continuous.map(|k| k.value), ..ClaimRow::at(d, found) })
    };
    solid.measured.series.iter().map(row).collect()
}

/// Standard deviation of ln k_bar over the curves of all D_f at a load, over that at another.
pub(super) fn spread(solid: &EnsembleLaws<'_>, load: f64, other: f64) -> Vec<ClaimRow> {
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
    ClaimRow::only(found.ok_or("fewer than two curves, or surfaces, at these loads".into()))
}

/// Eq. 13 from the solved stiffness: Lambda (rho_1 + rho_2)/L, mean over D_f.
pub(super) fn conductance(solid: &EnsembleLaws<'_>, load: f64) -> Vec<ClaimRow> {
    let values: Vec<Estimate> =
        solid.measured.series.iter().filter_map(|series| stiffness_at(series, load)).collect();
    // Shared phases: the errors of different D_f add, they do not average out.
    let mean = |pick: fn(&Estimate) -> f64| sum(values.iter().map(pick)) / values.len() as f64;
    let (k, half_width) = (mean(|e| e.value), mean(|e| e.half_width));
    ClaimRow::only(match analysis::conductance(k * PAPER_STIFFNESS_FACTOR, 1.0, 0.5, 0.5) {
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

pub(super) fn force_at_share(ensemble: &EnsembleLaws<'_>, share: f64) -> Vec<ClaimRow> {
    ensemble.each(|series| {
        let force = force_of(ensemble.measured, series, share).ok_or(NO_LOAD)?;
        let last = series.curves.force_bar().last().copied().unwrap_or_default();
        let k = stiffness_at(series, last).map_or(0.0, |k| k.value);
        let plateau = ensemble.measured.discretisation.complete_contact();
        Ok((force, format!("the plateau of this grid is {plateau:.4}, k_bar = {k:.4} at F_bar = {last}")))
    })
}

pub(super) fn area_at_share(solid: &EnsembleLaws<'_>, share: f64) -> Vec<ClaimRow> {
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
pub(super) fn sooner(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>, share: f64) -> Result<Vec<ClaimRow>> {
    compared(solid, line, |of_solid, of_line, heights| {
        let forces = force_of(line.measured, of_line, share).zip(force_of(solid.measured, of_solid, share));
        let (line, solid) = forces.ok_or(NO_LOAD)?;
        let ratio = line.over(solid);
        Ok((ratio, "each of its own plateau".to_owned(), Some(ratio.value * heights)))
    })
}

/// A number with its conditions and, where it has one, its value where line and surface have one spectrum.
type FoundInBoth = std::result::Result<(Estimate, String, Option<f64>), Reason>;

/// A row for each D_f from the series of both models and the ratio of their rms heights in one spectrum.
fn compared(
    solid: &EnsembleLaws<'_>,
    line: &EnsembleLaws<'_>,
    found: impl Fn(&Series, &Series, f64) -> FoundInBoth,
) -> Result<Vec<ClaimRow>> {
    let row = |(of_solid, of_line): (&Series, &Series)| {
        let d = of_solid.fractal_dimension;
        Ok(match found(of_solid, of_line, line.height_ratio(solid, d)?) {
            Ok((value, remark, in_convention)) => {
                ClaimRow { in_convention, ..ClaimRow::at(d, Ok((value, remark))) }
            }
            Err(reason) => ClaimRow::at(d, Err(reason)),
        })
    };
    solid.beside(line).map(row).collect()
}

/// k_1D/k_3D at a load of the surface, where that of the line is `over` times smaller: 1 where each has the force of
/// its own rms height, and the ratio of the heights where both have one spectrum.
fn ratio_at(solid: &Series, line: &Series, load: f64, over: f64) -> Option<Estimate> {
    Some(stiffness_at(line, load / over)?.over(stiffness_at(solid, load)?))
}

pub(super) fn largest_ratio(
    solid: &EnsembleLaws<'_>,
    line: &EnsembleLaws<'_>,
    loads: RangeInclusive<f64>,
) -> Result<Vec<ClaimRow>> {
    let mut largest: [Option<(Estimate, String)>; 2] = [None, None];
    for (of_solid, of_line) in solid.beside(line) {
        let d = of_solid.fractal_dimension;
        let heights = line.height_ratio(solid, d)?;
        for &load in of_solid.curves.force_bar().iter().filter(|load| loads.contains(*load)) {
            for (over, largest) in [1.0, heights].into_iter().zip(&mut largest) {
                let Some(ratio) = ratio_at(of_solid, of_line, load, over) else { continue };
                if largest.as_ref().is_none_or(|(most, _)| ratio.value > most.value) {
                    *largest = Some((ratio, format!("at F_bar = {load:.3}, D_f = {d:?}")));
                }
            }
        }
    }
    let [own, in_one_spectrum] = largest;
    let none = || format!("no load of the two models in common above {}", loads.start()).into();
    let in_convention = in_one_spectrum.map(|(ratio, _)| ratio.value);
    Ok(vec![ClaimRow { in_convention, ..ClaimRow::of("", own.ok_or_else(none)) }])
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

/// k_1D/k_3D at the smallest resolved load over that at the end of the power law.
pub(super) fn change_of_ratio(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>) -> Result<Vec<ClaimRow>> {
    let largest = FitWindow::PAPER.max_force_bar;
    // Half a decade below, at least.
    let below = largest / 10_f64.sqrt();
    compared(solid, line, |of_solid, of_line, heights| {
        let smallest = resolved(of_solid).next().filter(|load| *load <= below).ok_or_else(|| {
            format!("no load up to {below:.3} with {RESOLVED} contact cells on every surface: finer grids have one")
        })?;
        // Both loads of the same surfaces and lines: their scatter goes together.
        let change = |over: f64, of_line: &Curves, of_solid: &Curves| {
            let at = |curves: &Curves, load: f64| {
                interpolate(curves.force_bar(), &curves.mean_of(&curves.all()), load)
            };
            let ratio = |load: f64| Some(at(of_line, load / over)? / at(of_solid, load)?);
            Some(ratio(smallest)? / ratio(largest)?)
        };
        let value = change(1.0, &of_line.curves, &of_solid.curves).ok_or(NO_LOAD)?;
        let scatter = |surfaces: usize, number: &dyn Fn(&[usize]) -> Option<f64>| {
            Bootstrap::default().standard_error(surfaces, number)
        };
        let of_lines = scatter(of_line.realisations.len(), &|draw| {
            change(1.0, &of_line.curves.resampled(draw), &of_solid.curves)
        });
        let of_surfaces = scatter(of_solid.realisations.len(), &|draw| {
            change(1.0, &of_line.curves, &of_solid.curves.resampled(draw))
        });
        let error = of_lines.zip(of_surfaces).map(|(a, b)| a.hypot(b));
        let found = Estimate::normal(value, error).ok_or(ONE_SURFACE)?;
        let remark = format!(
            "from F_bar = {smallest:.2e}, the smallest load at which every surface has {RESOLVED} cells in contact, to {largest}"
        );
        Ok((found, remark, change(heights, &of_line.curves, &of_solid.curves)))
    })
}

pub(super) fn farthest_ratio(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>) -> Result<Vec<ClaimRow>> {
    compared(solid, line, |solid, line, heights| {
        let farthest = |over: f64| {
            let ratios = resolved(solid).filter_map(|load| Some((load, ratio_at(solid, line, load, over)?)));
            ratios.max_by(|a, b| a.1.distance_from_one().total_cmp(&b.1.distance_from_one()))
        };
        let (load, ratio) = farthest(1.0)
            .ok_or_else(|| format!("no common load with {RESOLVED} contact cells on every surface"))?;
        let remark =
            format!("at F_bar = {load:.2e}; loads at which every surface has {RESOLVED} cells in contact");
        Ok((ratio, remark, farthest(heights).map(|(_, ratio)| ratio.value)))
    })
}

/// Relative change of the mean stiffness with cells twice as large, where it is largest in the window of the
/// power law.
pub(super) fn change_with_grid(solid: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
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
pub(super) fn change_over_scatter(solid: &EnsembleLaws<'_>, load: f64) -> Vec<ClaimRow> {
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
fn master_curves(solid: &EnsembleLaws<'_>, draw: Option<&[usize]>) -> Vec<Vec<CollapsePoint>> {
    let above_floor = |series: &Series| -> Vec<CollapsePoint> {
        transformed(series).into_iter().filter(|p| !p.1).map(|p| p.0).collect()
    };
    let series = solid.measured.series.iter();
    series.map(|s| draw.map_or_else(|| above_floor(s), |draw| above_floor(&s.redrawn(draw)))).collect()
}

/// A residual of the master curve in decades of F_tilde, up to a load.
pub(super) fn collapse(
    solid: &EnsembleLaws<'_>,
    top: f64,
    pick: fn(&Residual) -> Option<f64>,
) -> Vec<ClaimRow> {
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
    ClaimRow::only(
        found.ok_or("no fractal dimension has a window of a decade or more, or one surface".into()),
    )
}

/// Decades of F_bar within a factor of the master curve, for the best D_f.
pub(super) fn decades(solid: &EnsembleLaws<'_>, factor: f64) -> Vec<ClaimRow> {
    let each: Vec<(f64, f64)> = (solid.measured.series.iter().zip(master_curves(solid, None)))
        .map(|(s, curve)| (s.fractal_dimension, decades_within(&curve, factor)))
        .collect();
    let words: Vec<String> = each.iter().map(|(d, decades)| format!("{decades:.2} at {d:?}")).collect();
    let (words, cells) = (words.join(", "), solid.measured.discretisation.size());
    ClaimRow::only(match each.iter().map(|e| e.1).max_by(f64::total_cmp) {
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
pub(super) fn run_times(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
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
    ClaimRow::only(if t1 <= 0.0 {
        Err("surfaces that are read from a table have no times".into())
    } else if cells < 2049 || elements < 1 << 20 {
        Err(format!("here {ratio:.3e}: {sizes}; the statement is about 2049 cells and 2^20 elements").into())
    } else {
        Ok((Estimate::exact(ratio), sizes))
    })
}
