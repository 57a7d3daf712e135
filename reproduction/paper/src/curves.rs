//! The common parts of Figs. 2 and 6: k_bar over F_bar, files and picture.

use crate::claims;
use crate::evaluation::{
    EnsembleModel, Measured, Outcome, Run, Session, compact_table, curves_table, describe, flags, header,
    measure_showing, samples_table, write_budget,
};
use crate::judged::Judged;
use crate::output::save;
use crate::words;
use contact_model::Table;
use plots::{
    Axis, LegendKey, LineStyle, Mark, MarkShape, NEUTRAL, Picture, REFERENCE, color, logarithmic, shape,
};
use runs::{CsvFile, Error, Header, Progress, Result, write_csv};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// A figure of mean curves.
pub(crate) struct CurveFigure {
    pub name: &'static str,
    pub title: &'static str,
    pub model: EnsembleModel,
}

impl CurveFigure {
    /// The figure and its ensemble, which is solved where it is not stored.
    pub fn reproduce(&self, run: &Run, progress: &dyn Progress) -> Result<(Judged, Measured)> {
        check(run.over.as_deref())?;
        if let Some(directory) = &run.samples {
            // Its table has certificates and work, which compact tables have not.
            let expected = "no flag for a table of solved surfaces: Figs. 3, 4, 7 and verify have it";
            return Err(Error::parameter("samples", directory.display(), expected));
        }
        let session = Session::open(&run.out, run.fresh)?;
        let so_far = FigureSoFar { figure: self, run, progress, told: AtomicBool::new(false) };
        let measured = measure_showing(self.model, run, &session.store, progress, &|seen| so_far.draw(seen))?;
        let mut outcome = Outcome::of(self.name, self.write(run, &measured)?, &[&measured]);
        so_far.remove()?;
        outcome.add_budget(write_budget(self.name, run, &measured)?);
        let claims = claims::of_figure(self.name, &[&measured])?;
        Ok((Judged::new(session.close(outcome)?, claims), measured))
    }

    /// Writes `name.csv`, `name-samples.csv`, `name-compact.csv`, `name.svg`, `name.png`.
    fn write(&self, run: &Run, measured: &Measured) -> Result<Vec<PathBuf>> {
        let Self { name, title, model } = *self;
        let header =
            describe(header(run.command(&format!("reproduce-{name}"), flags(model))), run, &[measured]);
        let samples = run.out.join(format!("{name}-samples.csv"));
        let all = samples_table(&format!("{title}: every surface and load"), measured)?;
        write_csv(&samples, &all, &header)?;
        let compact = run.out.join(format!("{name}-compact.csv"));
        write_csv(
            &compact,
            &compact_table(&format!("{title}: every surface in one row"), measured)?,
            &header,
        )?;
        let draw = |csv: &Path| draw(name, csv, run.over.as_deref(), &run.out);
        let mut files = written(run, name, &curves_table(title, measured)?, &header, draw)?;
        files.splice(1..1, [samples, compact]);
        Ok(files)
    }
}

/// The figure while it is solved: `name-so-far.csv`, `.svg`, `.png`, first from coarser grids, then from the
/// surfaces that are complete. The name differs from that of the figure, so that the files of an earlier run
/// are kept until this one is done.
struct FigureSoFar<'a> {
    figure: &'a CurveFigure,
    run: &'a Run,
    progress: &'a dyn Progress,
    told: AtomicBool,
}

impl FigureSoFar<'_> {
    fn name(&self) -> String {
        format!("{}-so-far", self.figure.name)
    }

    fn draw(&self, measured: &Measured) -> Result<()> {
        let (Self { figure, run, .. }, name) = (self, self.name());
        let surfaces = measured.series.first().map_or(0, |series| series.realisations.len());
        let sized = run.with_sizes(figure.model, measured.discretisation.size(), surfaces);
        let command = sized.command(&format!("reproduce-{}", figure.name), flags(figure.model));
        let header = describe(header(command), &sized, &[measured]);
        let table = curves_table(&format!("{}, so far", figure.title), measured)?;
        let csv = run.out.join(format!("{name}.csv"));
        write_csv(&csv, &table, &header)?;
        draw(&name, &csv, run.over.as_deref(), &run.out)?;
        if !self.told.swap(true, Ordering::Relaxed) {
            let picture = run.out.join(format!("{name}.png"));
            self.progress.note(&format!(
                "a first picture is in {}; it is drawn anew as surfaces come in",
                picture.display()
            ));
        }
        Ok(())
    }

    /// The figure itself is there.
    fn remove(&self) -> Result<()> {
        for extension in ["csv", "svg", "png"] {
            let path = self.run.out.join(format!("{}.{extension}", self.name()));
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(Error::file("remove", &path)(error));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Writes `name.csv` and draws its pictures from it: the files.
pub(crate) fn written(
    run: &Run,
    name: &str,
    table: &Table,
    header: &Header,
    draw: impl FnOnce(&Path) -> Result<Vec<PathBuf>>,
) -> Result<Vec<PathBuf>> {
    let csv = run.out.join(format!("{name}.csv"));
    write_csv(&csv, table, header)?;
    let mut files = vec![csv.clone()];
    files.extend(draw(&csv)?);
    Ok(files)
}

/// A mean of a CSV file.
#[derive(Debug, Clone, Copy)]
struct CurvePoint {
    force: f64,
    stiffness: f64,
    error: Option<f64>,
    below_floor: bool,
}

/// The means of one fractal dimension.
type CurvePoints = (f64, Vec<CurvePoint>);

/// Reads the table of another run that will be drawn below the curves, before anything is solved.
///
/// # Errors
/// As [`read`].
fn check(over: Option<&Path>) -> Result<()> {
    over.map_or(Ok(()), |over| read(over, &CsvFile::read(over)?).map(|_| ()))
}

/// The means of a table; a row without a mean has no point.
///
/// # Errors
/// [`Error::File`] for a missing column, and for a force, stiffness or fractal dimension that is not finite and positive, with its row.
fn read(path: &Path, file: &CsvFile) -> Result<Vec<CurvePoints>> {
    let here = |error: Error| Error::content(path, error.to_string());
    let numbers = |name: &str, zero: bool| -> Result<Vec<Option<f64>>> {
        let texts = file.texts(name).map_err(here)?;
        let number = |(row, text): (usize, &&str)| match text.parse::<f64>() {
            _ if text.is_empty() => Ok(None),
            Ok(v) if v.is_finite() && (v > 0.0 || zero && v >= 0.0) => Ok(Some(v)),
            _ => {
                let reason = format!(
                    "{name} = {text} in row {} of the data: expected a finite number above 0 (an error may be 0)",
                    row + 1
                );
                Err(Error::content(path, reason))
            }
        };
        texts.iter().enumerate().map(number).collect()
    };
    let d = numbers("fractal_dimension", false)?;
    let force = numbers("force_bar", false)?;
    let k = numbers("stiffness_bar", false)?;
    let error = numbers("stiffness_bar_se", true)?;
    let floor = file.texts("below_floor").map_err(here)?;
    let mut curves: Vec<CurvePoints> = Vec::new();
    for i in 0..d.len() {
        let (Some(d), Some(force), Some(stiffness)) = (d[i], force[i], k[i]) else { continue };
        if curves.last().is_none_or(|c| c.0.total_cmp(&d).is_ne()) {
            curves.push((d, Vec::new()));
        }
        if let Some(curve) = curves.last_mut() {
            curve.1.push(CurvePoint { force, stiffness, error: error[i], below_floor: floor[i] == "true" });
        }
    }
    Ok(curves)
}

/// Draws `name.svg` and `name.png` from a table of Fig. 2 or 6; `over` is a table of the same figure on a
/// coarser grid, drawn below the curves.
pub(crate) fn draw(name: &str, csv: &Path, over: Option<&Path>, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let curves = read(csv, &file)?;
    let below = over.map(CsvFile::read).transpose()?;
    let coarse =
        over.zip(below.as_ref()).map(|(path, file)| read(path, file)).transpose()?.unwrap_or_default();
    let points = || curves.iter().chain(&coarse).flat_map(|c| &c.1);
    let (x, y) = (logarithmic(points().map(|p| p.force)), logarithmic(points().map(|p| p.stiffness)));
    let one = file.texts("model")?.first() == Some(&"mdr1d");
    let (model, cells) = if one { ("mdr1d", "elements") } else { ("bem3d", "cells") };
    let mut title = words::title(&file);
    if below.is_some() {
        title = title.replacen(':', " continued to smaller forces:", 1);
    }
    let mut subtitle = words::subtitle(&file, model);
    if let Some(coarse) = below.as_ref().and_then(|b| words::ensemble(b, model)) {
        subtitle += &format!("; thin lines without marks: {coarse}");
    }
    let mut picture =
        Picture::new(x, y, words::FORCE, words::STIFFNESS).with_title(&title).with_subtitle(&subtitle);
    for (d, points) in &curves {
        let inside: Vec<(f64, f64, f64)> = (points.iter().filter(|p| !p.below_floor))
            .filter_map(|p| p.error.map(|e| (p.force, p.stiffness - 2.0 * e, p.stiffness + 2.0 * e)))
            .collect();
        picture.band(&inside, &color(*d));
    }
    for (d, points) in &coarse {
        picture.line(&above_floor(points), &color(*d), 1.2, LineStyle::Solid);
    }
    for (d, _) in &curves {
        picture.line(&paper_law(*d, x, y), &color(*d), 1.1, LineStyle::Dashed);
    }
    for (d, points) in &curves {
        let points: Vec<_> = points.iter().map(|p| (p.force, p.stiffness, p.below_floor)).collect();
        draw_curve(&mut picture, *d, &points, [1.8, 3.0, 3.8]);
    }
    picture.legend("paper, Eq. 12", REFERENCE, LegendKey::Line(LineStyle::Dashed));
    let ring = Mark::Ring(MarkShape::Circle);
    picture.points(&[(analytic::F_BAR_UL, analytic::K_BAR_UL)], REFERENCE, 10.0, ring);
    let crossing = format!("paper: curves cross at $({}, {})$", analytic::F_BAR_UL, analytic::K_BAR_UL);
    picture.legend(&crossing, REFERENCE, LegendKey::Sized(ring, 7.0));
    if curves.iter().flat_map(|c| &c.1).any(|p| p.error.is_some()) {
        picture.legend("shaded: ± 2 standard errors", NEUTRAL, LegendKey::Band);
    }
    if curves.iter().flat_map(|c| &c.1).any(|p| p.below_floor) {
        let label = format!("fewer than {} contact {cells}", crate::evaluation::FLOOR_CELLS);
        picture.legend(&label, NEUTRAL, LegendKey::Mark(Mark::Hollow(MarkShape::Circle)));
    }
    save(picture.files(name), out)
}

/// The points (x, y, below the floor of the grid) of one fractal dimension with their line and legend, in
/// these widths of the line, of marks below the floor and of marks above it.
pub(crate) fn draw_curve(picture: &mut Picture, d: f64, points: &[(f64, f64, bool)], widths: [f64; 3]) {
    let (color, shape) = (color(d), shape(d));
    let alone = apart(&points.iter().map(|p| p.0).collect::<Vec<_>>());
    let marked = |floor: bool| -> Vec<(f64, f64)> {
        let marked = points.iter().zip(&alone).filter(|(p, alone)| **alone && p.2 == floor);
        marked.map(|(p, _)| (p.0, p.1)).collect()
    };
    let line: Vec<(f64, f64)> = points.iter().filter(|p| !p.2).map(|p| (p.0, p.1)).collect();
    picture.line(&line, &color, widths[0], LineStyle::Solid);
    picture.points(&marked(true), &color, widths[1], Mark::Hollow(shape));
    picture.points(&marked(false), &color, widths[2], Mark::Solid(shape));
    picture.legend(&words::dimension(d), &color, LegendKey::Curve(Mark::Solid(shape)));
}

fn above_floor(points: &[CurvePoint]) -> Vec<(f64, f64)> {
    points.iter().filter(|p| !p.below_floor).map(|p| (p.force, p.stiffness)).collect()
}

/// Whether each of these increasing loads has a mark. A single load next to one of the regular loads has
/// none, because two marks would overlap.
fn apart(forces: &[f64]) -> Vec<bool> {
    let step = |a: f64, b: f64| (b / a).ln();
    let mut steps: Vec<f64> = forces.windows(2).map(|w| step(w[0], w[1])).collect();
    steps.sort_by(f64::total_cmp);
    let regular = steps.get(steps.len() / 2).copied().unwrap_or_default();
    let close = |i: usize| i + 1 < forces.len() && step(forces[i], forces[i + 1]) < 0.7 * regular;
    // How far a load is from where the load before the pair would have its neighbour.
    let off =
        |from: Option<usize>, i: usize| from.map_or(0.0, |f| (step(forces[f], forces[i]) - regular).abs());
    let mut kept = vec![true; forces.len()];
    for i in (0..forces.len()).filter(|i| close(*i)) {
        let before = i.checked_sub(1);
        kept[if off(before, i) > off(before, i + 1) { i } else { i + 1 }] = false;
    }
    kept
}

/// Eq. 12 in the range in which the paper claims it, `k_bar <= 0.18`, within the axes.
fn paper_law(d: f64, x: Axis, y: Axis) -> Vec<(f64, f64)> {
    let (x0, y0) = (x.ends().0, y.ends().0);
    let alpha = analytic::exponent_fit(d);
    let law = |f: f64| analytic::K_BAR_UL * (f / analytic::F_BAR_UL).powf(alpha);
    let inverse = |k: f64| analytic::F_BAR_UL * (k / analytic::K_BAR_UL).powf(1.0 / alpha);
    let start = x0.max(inverse(y0));
    vec![(start, law(start)), (analytic::F_BAR_UL, analytic::K_BAR_UL)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_with_a_row_that_cannot_be_drawn_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("over.csv");
        let head = "fractal_dimension,force_bar,stiffness_bar,stiffness_bar_se,below_floor\n";
        for (row, wrong) in [
            ("2,inf,0.1,,false", "force_bar = inf"),
            ("2,1,1e400,,false", "stiffness_bar = 1e400"),
            ("2,-1,0.1,,false", "force_bar = -1"),
            ("2,1,0.1,-1,false", "stiffness_bar_se = -1"),
            ("two,1,0.1,0,false", "fractal_dimension = two"),
        ] {
            std::fs::write(&path, format!("{head}2,1,0.1,0,false\n2,2,,,false\n{row}\n")).unwrap();
            let error = check(Some(&path)).unwrap_err().to_string();
            assert!(
                error.contains("over.csv") && error.contains(wrong) && error.contains("row 3"),
                "{error}"
            );
        }
        std::fs::write(&path, "force_bar\n1\n").unwrap();
        assert!(check(Some(&path)).unwrap_err().to_string().contains("over.csv"));
        assert!(check(None).is_ok());
    }

    #[test]
    fn single_loads_beside_regular_ones_have_no_mark() {
        let forces = [0.0440, 0.086, 0.0946, 0.2032, 0.4366, 0.9382, 1.0, 2.016, 4.332];
        let kept: Vec<f64> =
            forces.iter().zip(apart(&forces)).filter_map(|(f, kept)| kept.then_some(*f)).collect();
        assert_eq!(kept, [0.0440, 0.0946, 0.2032, 0.4366, 0.9382, 2.016, 4.332]);
        assert_eq!((apart(&[1.0]), apart(&[]).len()), (vec![true], 0));
    }
}
