//! What Figs. 2 and 6 have in common: k_bar over F_bar, files and picture.

use evaluation::Measured;
use evaluation::{Flag, Run, describe, header};
use evaluation::{curves_table, samples_table};
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use plots::{Axis, Key, Mark, Picture, color, logarithmic};
use runs::Result;
use runs::{CsvFile, write_csv};
use std::path::{Path, PathBuf};

/// Writes `name.csv`, `name-samples.csv`, `name.svg`, `name.png`.
pub(crate) fn write(
    name: &'static str,
    title: &str,
    flags: &[Flag],
    run: &Run,
    measured: &Measured,
) -> Result<Vec<PathBuf>> {
    let header = describe(header(run.command(&format!("reproduce-{name}"), flags)), run, &[measured]);
    let csv = run.out.join(format!("{name}.csv"));
    let samples = run.out.join(format!("{name}-samples.csv"));
    write_csv(&csv, &curves_table(title, measured)?, &header)?;
    let all = samples_table(&format!("{title}: every surface and load"), measured)?;
    write_csv(&samples, &all, &header)?;
    let mut files = vec![csv.clone(), samples];
    files.extend(draw(name, title, &csv, run.over.as_deref(), &run.out)?);
    Ok(files)
}

/// The curves of a CSV file: (D_f, points with their floor mark).
type CurvePoints = (f64, Vec<(f64, f64, bool)>);

fn read(csv: &Path) -> Result<Vec<CurvePoints>> {
    let file = CsvFile::read(csv)?;
    let d = file.numbers("fractal_dimension")?;
    let force = file.numbers("force_bar")?;
    let k = file.numbers("stiffness_bar")?;
    let floor = file.texts("below_floor")?;
    let mut curves: Vec<CurvePoints> = Vec::new();
    for i in 0..d.len() {
        let (Some(d), Some(f), Some(k)) = (d[i], force[i], k[i]) else { continue };
        if curves.last().is_none_or(|c| c.0.total_cmp(&d).is_ne()) {
            curves.push((d, Vec::new()));
        }
        if let Some(curve) = curves.last_mut() {
            curve.1.push((f, k, floor[i] == "true"));
        }
    }
    Ok(curves)
}

fn draw(name: &str, title: &str, csv: &Path, over: Option<&Path>, out: &Path) -> Result<Vec<PathBuf>> {
    let curves = read(csv)?;
    let below = over.map(read).transpose()?.unwrap_or_default();
    let points = || curves.iter().chain(&below).flat_map(|c| &c.1);
    let x = logarithmic(points().map(|p| p.0));
    let y = logarithmic(points().map(|p| p.1));
    let mut picture = Picture::new(x, y, "force  F / (E* h L)", "stiffness  k / (1.1419 E* L)")
        .with_title(title)
        .with_legend_below();
    let circle = MarkerShape::Circle;
    for (d, points) in &below {
        let inside: Vec<(f64, f64)> = points.iter().filter(|p| !p.2).map(|p| (p.0, p.1)).collect();
        picture.line(&inside, &color(*d), 1.0, &LineStyle::Solid);
        picture.points(&inside, &color(*d), 2.6, Mark::Hollow(MarkerShape::Square));
    }
    for (d, points) in &curves {
        let color = color(*d);
        let inside: Vec<(f64, f64)> = points.iter().filter(|p| !p.2).map(|p| (p.0, p.1)).collect();
        let floor: Vec<(f64, f64)> = points.iter().filter(|p| p.2).map(|p| (p.0, p.1)).collect();
        picture.line(&paper_law(*d, x, y), &color, 1.0, &LineStyle::Dashed);
        picture.line(&inside, &color, 1.8, &LineStyle::Solid);
        picture.points(&inside, &color, 3.4, Mark::Solid(circle));
        picture.points(&floor, &color, 3.0, Mark::Hollow(circle));
        picture.legend(&format!("D_f = {d:?}"), &color, Key::Mark(circle));
    }
    picture.legend("paper, Eq. 12", "#444444", Key::Dashed);
    if let Some(over) = over {
        let name = over.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        picture.legend(
            &format!("squares: {name} of the other run"),
            "#444444",
            Key::Mark(MarkerShape::Square),
        );
    }
    if curves.iter().flat_map(|c| &c.1).any(|p| p.2) {
        picture.legend("fewer than 10 contact cells", "", Key::Open);
    }
    picture.save(out, name)
}

/// Eq. 12 where it is claimed to hold, `k_bar <= 0.18`, within the axes.
fn paper_law(d: f64, x: Axis, y: Axis) -> Vec<(f64, f64)> {
    let (Axis::Log(x0, _) | Axis::Linear(x0, _), Axis::Log(y0, _) | Axis::Linear(y0, _)) = (x, y);
    let alpha = analytic::exponent_fit(d);
    let law = |f: f64| analytic::K_BAR_UL * (f / analytic::F_BAR_UL).powf(alpha);
    let inverse = |k: f64| analytic::F_BAR_UL * (k / analytic::K_BAR_UL).powf(1.0 / alpha);
    // Just inside the frame, so that rounding does not put the end outside.
    let start = x0.max(inverse(y0)) * (1.0 + 1e-9);
    vec![(start, law(start).max(y0)), (analytic::F_BAR_UL, analytic::K_BAR_UL)]
}
