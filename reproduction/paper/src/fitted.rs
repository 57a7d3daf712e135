//! The common parts of Figs. 3 and 7: fitted values over the fractal dimension.

use crate::claim::Estimate;
use crate::claims::{self, SeriesLaw};
use crate::evaluation::{
    EnsembleModel, FRACTAL_DIMENSION, Flag, Measured, Outcome, Run, Series, Session, TableOf,
    dense_dimensions, describe, header, laws, measure, read_rows,
};
use crate::judged::Judged;
use crate::output::save;
use crate::{curves, words};
use analysis::{Bootstrap, Curves, FitWindow, FittedPowerLaw, StiffnessSample, fit_power_law};
use plots::{Axis, LegendKey, LineStyle, Mark, MarkShape, Picture, REFERENCE, number};
use runs::{CsvFile, Error, Progress, Result, Store};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Distance between the points of one fractal dimension, so that none hides another.
const BESIDE: f64 = 0.014;

/// A figure of a parameter of `k_bar = zeta F_bar^alpha` over the fractal dimension.
pub(crate) struct FittedFigure {
    pub name: &'static str,
    pub title: &'static str,
    /// Names of the columns of the parameter and of its standard error.
    pub columns: [&'static str; 2],
    pub value: fn(&FittedPowerLaw) -> (f64, Option<f64>),
    /// The parameter with its 95 % interval.
    pub estimate: fn(&SeriesLaw) -> Estimate,
    pub formulas: &'static [FittedFormula],
    /// Title of the picture and label of its axis.
    pub words: [&'static str; 2],
    /// The axis for the largest end of an error bar.
    pub axis: fn(f64) -> Axis,
}

/// A formula of the paper.
pub(crate) struct FittedFormula {
    /// Its name in the column of models.
    pub name: &'static str,
    /// Its text in the column of notes.
    pub note: &'static str,
    /// The parameter at D_f.
    pub of: fn(f64) -> f64,
    pub legend: &'static str,
    pub style: LineStyle,
}

/// The ensembles of both models, surfaces first; they are solved where they are not stored.
pub(crate) fn both(run: &Run, store: &Store, progress: &dyn Progress) -> Result<[Measured; 2]> {
    let [solid, line] = EnsembleModel::BOTH.map(|model| measure(model, run, store, progress));
    Ok([solid?, line?])
}

/// A row of the table: a fit, the reason why there is none, or a formula.
#[derive(Default)]
struct FittedRow {
    model: &'static str,
    fractal_dimension: f64,
    value: Option<f64>,
    error: Option<f64>,
    /// 95 % half-width from scatter, window and grid.
    half_width: Option<f64>,
    /// The parameter over the window that all fractal dimensions of the model resolve, and its standard
    /// error.
    common: Option<(f64, Option<f64>)>,
    /// The parameter of lines over the forces over which surfaces of the same D_f are fitted.
    same_forces: Option<Estimate>,
    fit: Option<FittedPowerLaw>,
    note: Option<String>,
}

impl FittedFigure {
    /// The figure; ensembles are solved where they are not stored.
    pub fn reproduce(&self, run: &Run, progress: &dyn Progress) -> Result<Judged> {
        let session = Session::open(&run.out, run.fresh)?;
        let [solid, line] = both(run, &session.store, progress)?;
        let outcome = session.close(self.write(run, &solid, &line)?)?;
        Ok(Judged::new(outcome, claims::of_figure(self.name, &[&solid, &line])?))
    }

    /// Writes `name.csv`, `name.svg` and `name.png`.
    pub fn write(&self, run: &Run, solid: &Measured, line: &Measured) -> Result<Outcome> {
        const VALUE: &str = "of k_bar = zeta F_bar^alpha; empty where there is no fit";
        const ERROR: &str = "standard error over surfaces; empty for formulas and for one surface";
        const HALF: &str = "95 % half-width: scatter, and in quadrature the largest change with other windows and the remaining discretisation error; empty for a window below a decade";
        const COMMON: &str = "the same over the window that every fractal dimension of the model resolves";
        const SAME: &str =
            "of lines: the same over the forces over which surfaces of the same D_f are fitted";
        let rows = self.rows(run, solid, line);
        let fit = |pick: fn(&FittedPowerLaw) -> f64| move |r: &FittedRow| r.fit.as_ref().map(pick);
        let count = |pick: fn(&FittedPowerLaw) -> usize| move |r: &FittedRow| r.fit.as_ref().map(pick);
        let table = TableOf::new(self.title, &rows)
            .column("model", "-", "bem3d, mdr1d: fitted here; others: formulas of the paper", |r| r.model)
            .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
            .column(self.columns[0], "1", VALUE, |r| r.value)
            .column(self.columns[1], "1", ERROR, |r| r.error)
            .column("half_width", "1", HALF, |r| r.half_width)
            .column("common", "1", COMMON, |r| r.common.map(|c| c.0))
            .column("common_se", "1", "its standard error over surfaces", |r| r.common.and_then(|c| c.1))
            .column("same_forces", "1", SAME, |r| r.same_forces.map(|e| e.value))
            .column("same_forces_half_width", "1", "its 95 % half-width, of the same sources", |r| {
                r.same_forces.map(|e| e.half_width)
            })
            .column("force_bar_min", "1", "smallest F_bar of the fit", fit(|l| l.force_bar_min))
            .column("force_bar_max", "1", "largest F_bar of the fit", fit(|l| l.force_bar_max))
            .column("points", "1", "loads in the fit", count(|l| l.points))
            .column("surfaces", "1", "surfaces in the fit", count(|l| l.surfaces))
            .column("note", "-", "formula, or why there is no fit", |r| r.note.clone())
            .table()?;
        let command = run.command(&format!("reproduce-{}", self.name), &Flag::ALL);
        let header = describe(header(command), run, &[solid, line])
            .with_note(format!(
                "fit: ln of the arithmetic mean of k_bar over ln F_bar, equal weights, {}",
                FitWindow::PAPER
            ))
            .with_note(format!(
                "errors: bootstrap over surfaces, {} resamples; curves of different D_f share phases, their errors are correlated",
                Bootstrap::default().resamples
            ));
        let files = curves::written(run, self.name, &table, &header, |csv| self.draw(csv, None, &run.out))?;
        Ok(Outcome::of(self.name, files, &[solid, line]))
    }

    fn rows(&self, run: &Run, solid: &Measured, line: &Measured) -> Vec<FittedRow> {
        let same_forces = |series: &Series| {
            let surfaces = solid
                .series
                .iter()
                .find(|s| s.fractal_dimension.total_cmp(&series.fractal_dimension).is_eq())?;
            let law = SeriesLaw::over_forces_of(surfaces, line, series).ok()?;
            Some((self.estimate)(&law))
        };
        let of = |measured: &Measured| -> Vec<FittedRow> {
            let lines = measured.discretisation.of() == EnsembleModel::Mdr1d;
            let own = laws(measured, &FitWindow::PAPER);
            let lowest = own.iter().filter_map(|fit| fit.as_ref().ok());
            let lowest = lowest.map(|fit| fit.force_bar_min).fold(0.0, f64::max);
            let window = FitWindow { min_force_bar: lowest * (1.0 - 1e-9), ..FitWindow::PAPER };
            (own.into_iter().zip(laws(measured, &window)).zip(&measured.series))
                .map(|((fit, common), series)| {
                    let note = fit.as_ref().err().map(ToString::to_string);
                    let fit = fit.ok();
                    let (value, error) = fit.as_ref().map(self.value).unzip();
                    let law = SeriesLaw::new(measured, series).ok();
                    FittedRow {
                        model: measured.discretisation.name(),
                        fractal_dimension: series.fractal_dimension,
                        value,
                        error: error.flatten(),
                        half_width: law.map(|law| (self.estimate)(&law).half_width),
                        common: common.as_ref().ok().map(self.value),
                        same_forces: if lines { same_forces(series) } else { None },
                        fit,
                        note,
                    }
                })
                .collect()
        };
        let fitted = of(solid).into_iter().chain(of(line));
        let dimensions = dense_dimensions(&run.dimensions());
        let formulas = self.formulas.iter().flat_map(|formula| {
            dimensions.iter().map(|&fractal_dimension| FittedRow {
                model: formula.name,
                fractal_dimension,
                value: Some((formula.of)(fractal_dimension)),
                note: Some(formula.note.to_owned()),
                ..FittedRow::default()
            })
        });
        fitted.chain(formulas).collect()
    }
}

impl FittedFigure {
    /// Draws `name.svg` and `name.png` from the table; `finer` is a table of Fig. 2 on a finer grid, whose
    /// fitted laws are drawn for comparison.
    pub fn draw(&self, csv: &Path, finer: Option<&Path>, out: &Path) -> Result<Vec<PathBuf>> {
        let file = CsvFile::read(csv)?;
        let rows: Vec<FittedPoint> = read_rows(csv, &file)?;
        let of =
            |model: &str| rows.iter().filter(|r| r.model == model && r.value.is_some()).cloned().collect();
        let mut all: Vec<(String, Vec<FittedPoint>)> = Vec::new();
        for (model, name) in [("bem3d", "3D"), ("mdr1d", "1D")] {
            let label = words::ensemble(&file, model).unwrap_or_default();
            all.push((format!("{name}, {label}"), of(model)));
        }
        if let Some(path) = finer {
            let file = CsvFile::read(path)?;
            let label = words::ensemble(&file, "bem3d").unwrap_or_default();
            let point = |(fractal_dimension, law): (f64, FittedPowerLaw)| FittedPoint {
                fractal_dimension,
                value: Some((self.value)(&law).0),
                force_bar_min: Some(law.force_bar_min),
                force_bar_max: Some(law.force_bar_max),
                ..FittedPoint::default()
            };
            let points = laws_of_means(path, &file)?.into_iter().map(point).collect();
            all.push((format!("3D, {label}"), points));
        }
        let ends = all
            .iter()
            .flat_map(|(_, points)| points)
            .filter_map(|p| Some(p.value? + p.half_width.unwrap_or(0.0)));
        let y = (self.axis)(ends.fold(0.0, f64::max));
        let [title, label] = self.words;
        let mut picture = Picture::new(Axis::Linear(1.9, 3.1), y, words::DIMENSION, label)
            .with_size(800.0, 560.0)
            .with_title(title)
            .with_legend_below();
        for formula in self.formulas {
            let points: Vec<FittedPoint> = of(formula.name);
            let line: Vec<_> = points.iter().filter_map(|p| Some((p.fractal_dimension, p.value?))).collect();
            picture.line(&line, REFERENCE, 1.6, formula.style);
        }
        draw_points(&mut picture, &all);
        for formula in self.formulas {
            picture.legend(formula.legend, REFERENCE, LegendKey::Line(formula.style));
        }
        save(picture.files(self.name), out)
    }
}

/// A fitted value, or one of a formula, read from the table.
#[derive(Debug, Clone, Default, Deserialize)]
struct FittedPoint {
    model: String,
    fractal_dimension: f64,
    #[serde(alias = "alpha", alias = "zeta")]
    value: Option<f64>,
    half_width: Option<f64>,
    force_bar_min: Option<f64>,
    force_bar_max: Option<f64>,
}

/// A mean of a table of Fig. 2.
#[derive(Deserialize)]
struct MeanRow {
    fractal_dimension: f64,
    force_bar: f64,
    stiffness_bar: Option<f64>,
    not_converged: Option<f64>,
    min_contact_cells: Option<usize>,
}

/// The laws of a table of Fig. 2: fitted to its means in the same window by the same code, without errors,
/// because it does not hold the single surfaces.
fn laws_of_means(path: &Path, file: &CsvFile) -> Result<Vec<(f64, FittedPowerLaw)>> {
    let rows: Vec<MeanRow> = read_rows(path, file)?;
    let sample = |r: &MeanRow| {
        let stiffness_bar = r.stiffness_bar.filter(|_| r.not_converged.is_none_or(|n| n < 0.5))?;
        Some(StiffnessSample { stiffness_bar, contact_cells: r.min_contact_cells })
    };
    let mut laws = Vec::new();
    for group in rows.chunk_by(|a, b| a.fractal_dimension.total_cmp(&b.fractal_dimension).is_eq()) {
        let forces = group.iter().map(|r| r.force_bar).collect();
        let means = group.iter().map(sample).collect();
        let curves = Curves::new(forces, vec![means]).map_err(Error::model("the means of a finer run"))?;
        if let Ok(law) = fit_power_law(&curves, &FitWindow::PAPER, &Bootstrap::default()) {
            laws.push((group[0].fractal_dimension, law));
        }
    }
    Ok(laws)
}

/// Both models and, where given, a run on a finer grid, with their error bars and the windows of their fits.
fn draw_points(picture: &mut Picture, all: &[(String, Vec<FittedPoint>)]) {
    let styles = [
        ("#0b559f", Mark::Solid(MarkShape::Circle), -1.0),
        ("#d55e00", Mark::Solid(MarkShape::Square), 1.0),
        ("#0b559f", Mark::Hollow(MarkShape::Diamond), 0.0),
    ];
    for ((label, points), (color, mark, side)) in all.iter().zip(styles) {
        if points.is_empty() {
            continue;
        }
        let bar = |p: &FittedPoint| Some((p.fractal_dimension + side * BESIDE, p.value?, p.half_width));
        let bars: Vec<_> = points.iter().filter_map(bar).collect();
        picture.points(&bars.iter().map(|b| (b.0, b.1)).collect::<Vec<_>>(), color, 4.4, mark);
        picture.errors(&bars, color);
        let key =
            if bars.iter().any(|b| b.2.is_some()) { LegendKey::Bar(mark) } else { LegendKey::Mark(mark) };
        picture.legend(&format!("{label}{}", window(points)), color, key);
    }
    let words = "bars: 95 %, with scatter, window and grid; points of one $D_{\\rm{f}}$ stand side by side";
    picture.legend(words, "#000000", LegendKey::Words);
    if all.len() > 2 {
        picture.legend(
            "open marks: fitted to the means alone, no error is known",
            "#000000",
            LegendKey::Words,
        );
    }
}

/// The ranges of the fits of a series.
fn window(points: &[FittedPoint]) -> String {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return String::new() };
    let (Some(a), Some(b), Some(end)) = (first.force_bar_min, last.force_bar_min, first.force_bar_max) else {
        return String::new();
    };
    let [a, b, end] = [a, b, end].map(|v| number(rounded(v)).replace('$', ""));
    let [from, to] = [first, last].map(|p| words::dimension(p.fractal_dimension));
    format!("; fit: $\\bar{{F}} = {a}$ to ${end}$ ({from}), ${b}$ to ${end}$ ({to})")
}

/// Two digits.
fn rounded(v: f64) -> f64 {
    let unit = 10_f64.powf(v.abs().log10().floor() - 1.0);
    let digits = (v / unit).round();
    // A division gives the shortest decimal where a product with 1e-5 does not.
    if unit < 1.0 { digits / (1.0 / unit).round() } else { digits * unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_fitted_where_every_surface_has_enough_cells_in_contact() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("fig2.csv");
        let mut text =
            "fractal_dimension,force_bar,stiffness_bar,not_converged,min_contact_cells\n".to_owned();
        for (force, cells) in [(1e-6_f64, 3), (1e-5, 10), (1e-4, 50), (1e-3, 200), (1e-2, 900), (1.0, 9999)] {
            text += &format!("2.2,{force:?},{:?},0,{cells}\n", 0.5 * force.powf(0.6));
        }
        std::fs::write(&path, text).unwrap();
        let laws = laws_of_means(&path, &CsvFile::read(&path).unwrap()).unwrap();
        assert_eq!((laws.len(), laws[0].1.points), (1, 4));
        approx::assert_relative_eq!(laws[0].1.alpha, 0.6, max_relative = 1e-12);
        assert_eq!((laws[0].1.force_bar_min, laws[0].1.force_bar_max), (1e-5, 1e-2));
    }

    #[test]
    fn windows_are_short() {
        let shown = [2.0979e-5, 0.086, 2.0647e-3].map(|v| number(rounded(v)));
        assert_eq!(shown, ["$2.1×10^{-5}$", "0.086", "0.0021"]);
    }
}
