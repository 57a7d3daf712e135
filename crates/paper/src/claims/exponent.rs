//! alpha: the abstract's range, Eqs. 6 and 24, 1D against 3D, 1D at small forces.

use super::common::{INTERVAL, Law, difference, label, laws, mean_of, ratio, stiffness_at};
use crate::claim::{Claim, Estimate, Statement};
use analysis::{Bootstrap, FitWindow, FittedPowerLaw, fit_power_law, sum};
use evaluation::{FLOOR_CELLS, Measured, Series, laws_within};

const ENDS: Statement = Statement {
    quotation: "a power law, with the exponent varying from 0.50 to 0.85, depending on the fractal dimension",
    place: "abstract; Secs. II, IV",
    reading: "the exponents at D_f = 2 and 3, to 0.03: Eq. 6, a straight fit of the same points, has 0.53 and 0.80 there",
};

/// How far the paper's own ends and its fit are apart, half of it at least.
const ENDS_TO: f64 = 0.03;

const FIT: Statement = Statement {
    quotation: "The power alpha can be fitted as alpha ≈ 0.266 D_f",
    place: "Eq. 6, Fig. 3",
    reading: "the straight line through the origin that fits the exponents best has this slope, to 0.01: the paper's own ends are that far from it",
};

const LINE: Statement = Statement {
    quotation: "alpha ≈ 0.266 D_f",
    place: "Eq. 6, Fig. 3",
    reading: "the law of each D_f, to 0.01, below F_bar = 0.086; and not Eq. 24",
};

const ZOOM: Statement = Statement {
    quotation: "directly supplying a value for the exponent: alpha = 1/(1 + H)",
    place: "Eq. 24, Sec. IV",
    reading: "the law of each D_f, to 0.01, in the same window, where Fig. 3 shows it; and not Eq. 6 (at smaller force: the study of the exponent)",
};

const ALIKE: Statement = Statement {
    quotation: "In the region of practically relevant fractal dimensions between 2 and 2.5, they coincide almost exactly",
    place: "Sec. III, Fig. 3",
    reading: "the exponents of 1D and 3D differ by less than 0.03: a symbol of Fig. 3",
};

const VERY_WELL: Statement = Statement {
    quotation: "It is seen that the 1D and 3D results agree very well",
    place: "Sec. III, Figs. 3, 7",
    reading: "above D_f = 2.5 the exponents of 1D and 3D differ by less than 0.05",
};

/// What counts as very good agreement of exponents.
const AGREE: f64 = 0.05;

const DIFFERS: Statement = Statement {
    quotation: "This result qualitatively differs from the prediction k ≈ ξF/h of the Greenwood and Williamson model",
    place: "Sec. II",
    reading: "the exponent of a fractal surface is below 1, by 0.1 or more",
};

const ALL_DIMENSIONS: Statement = Statement {
    quotation: "they agree well both qualitatively and quantitatively over many orders of magnitude of normal forces and for all fractal dimensions between 2 and 3",
    place: "Sec. IV",
    reading: "k_1D/k_3D, where every surface has 100 cells in contact, is 0.75 to 1.33 at every load",
};

const NO_SIZE_EFFECTS: Statement = Statement {
    quotation: "The extremely high spatial resolution used in this approach will exclude all doubts of size effects in the simulations",
    place: "Sec. II",
    reading: "half as many cells a side change the mean stiffness by less than 5 %, wherever every surface has 10 cells in contact",
};

const LONG_WAVES: Statement = Statement {
    quotation: "determined first of all by the long wavelength part of the power spectrum",
    place: "Sec. II",
    reading: "at F_bar = 0.01 half as many cells a side change the stiffness of a surface by less (rms) than it scatters between surfaces",
};

const ONLY_CROSSOVER: Statement = Statement {
    quotation: "The only region where there is a systematical discrepancy between 1D and 3D cases is the region of crossover",
    place: "Sec. III",
    reading: "below F_bar = 0.086 the stiffnesses of line and surface are equal to 10 %: lines of a plot over six decades",
};

const DOWN: Statement = Statement {
    quotation: "if the surface is still fractal at very small wavelengths, the law can be extended to areas with lower forces. In the 1D case, the power-law dependencies remain correct up to forces of 10^-7",
    place: "Sec. III",
    reading: "the exponent below F_bar = 1e-4 is that above, to 0.03",
};

/// What counts as the same exponent.
const SAME: f64 = 0.03;

fn with_laws(
    measured: &Measured,
    quantity: impl Fn(f64) -> String,
    statement: Statement,
    paper: impl Fn(f64) -> [f64; 2],
    judge: impl Fn(&Law, Claim) -> Claim,
) -> Vec<Claim> {
    let dimensions = measured.series.iter().map(|s| s.fractal_dimension);
    dimensions
        .zip(laws(measured))
        .map(|(d, law)| match law {
            Ok(law) => {
                let remark = format!("{}; {INTERVAL}", law.window());
                judge(&law, Claim::judge(quantity(d), statement, paper(d), law.alpha, remark))
            }
            Err(reason) => Claim::unresolved(quantity(d), statement, paper(d), reason),
        })
        .collect()
}

/// The ends of the abstract.
pub(super) fn ends(measured: &Measured) -> Vec<Claim> {
    let end = |d: f64| if d < 2.5 { 0.50 } else { 0.85 };
    let name = |d: f64| format!("alpha {} at D_f = {d:?}", label(measured));
    let all = with_laws(measured, name, ENDS, |d| [end(d) - ENDS_TO, end(d) + ENDS_TO], |_, claim| claim);
    let at_end = |d: f64| (d - 2.0).abs() < 1e-9 || (d - 3.0).abs() < 1e-9;
    measured.series.iter().zip(all).filter(|(s, _)| at_end(s.fractal_dimension)).map(|(_, c)| c).collect()
}

/// The coefficient of Eq. 6: over each D_f's own window, and over the window that all have.
pub(super) fn coefficient(measured: &Measured) -> Vec<Claim> {
    let (name, paper) = (format!("alpha over D_f, {}", label(measured)), [0.256, 0.276]);
    let own: Result<Vec<Law>, String> = laws(measured).into_iter().collect();
    let own = match own {
        Ok(own) if own.len() >= 3 => own,
        Ok(_) => {
            return vec![Claim::unresolved(name, FIT, paper, "at least three fractal dimensions are needed")];
        }
        Err(reason) => return vec![Claim::unresolved(name, FIT, paper, reason)],
    };
    // Through the origin: sum D alpha / sum D^2.
    let square = sum(own.iter().map(|l| l.fractal_dimension.powi(2)));
    let through =
        |alphas: &[f64]| sum(own.iter().zip(alphas).map(|(l, alpha)| l.fractal_dimension * alpha)) / square;
    let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
    let slope = |windows: &[FitWindow], draw: &[usize]| -> Option<f64> {
        let alpha = |(s, w): (&Series, &FitWindow)| {
            Some(fit_power_law(&s.curves.resampled(draw), w, &once).ok()?.alpha)
        };
        let alphas: Option<Vec<f64>> = measured.series.iter().zip(windows).map(alpha).collect();
        Some(through(&alphas?))
    };
    let surfaces = measured.series.first().map_or(0, |s| s.units.len());
    let all: Vec<usize> = (0..surfaces).collect();
    // What the grid leaves has one sign for all D_f: it adds up.
    let grid = through(&own.iter().map(|l| l.grid).collect::<Vec<_>>());
    let lowest = own.iter().map(|l| l.fit.force_bar_min).fold(0.0, f64::max);
    let between = |min: f64, max: f64| FitWindow {
        min_force_bar: min * (1.0 - 1e-9),
        max_force_bar: max * (1.0 + 1e-9),
        min_contact_cells: 0,
    };
    let each: Vec<FitWindow> =
        own.iter().map(|l| between(l.fit.force_bar_min, l.fit.force_bar_max)).collect();
    let common = vec![between(lowest, FitWindow::PAPER.max_force_bar); own.len()];
    let floors = [30, 100].map(|min_contact_cells| FitWindow { min_contact_cells, ..FitWindow::PAPER });
    let lower: Vec<FitWindow> = own.iter().map(|l| between(l.fit.force_bar_min, 0.03)).collect();
    let mut others: Vec<Vec<FitWindow>> = floors.iter().map(|w| vec![*w; own.len()]).collect();
    others.push(lower);
    let ways = [
        ("each D_f's own window".to_owned(), each, others),
        (format!("F_bar from {lowest:.1e} to 0.086"), common, vec![vec![between(lowest, 0.03); own.len()]]),
    ];
    ways.into_iter()
        .map(|(words, windows, others)| {
            // All D_f share phases: they are redrawn together.
            let error = Bootstrap::default().standard_error(surfaces, |draw| slope(&windows, draw));
            let found = slope(&windows, &all).and_then(|value| Estimate::normal(value, error));
            let name = format!("{name}, {words}");
            match found {
                Some(found) => {
                    let moved = |other: &Vec<FitWindow>| Some((slope(other, &all)? - found.value).abs());
                    let window = others.iter().filter_map(moved).fold(0.0, f64::max);
                    let half_width = found.half_width.hypot(window).hypot(grid);
                    Claim::judge(name, FIT, paper, Estimate { half_width, ..found }, INTERVAL)
                }
                None => Claim::unresolved(name, FIT, paper, "one surface has no scatter"),
            }
        })
        .collect()
}

/// How near a law is to the exponents it describes, at least: to a third of the distance between the paper's own ends and its fit.
const LAW_TO: f64 = 0.01;

/// Each exponent beside Eq. 6 and Eq. 24, each of which is the other's rival.
pub(super) fn laws_of_each(measured: &Measured) -> Vec<Claim> {
    let about = |alpha: f64| [alpha - LAW_TO, alpha + LAW_TO];
    let line = |d: f64| about(analytic::exponent_fit(d));
    let zoom = |d: f64| about(analytic::exponent_scaling(3.0 - d));
    let name = |law: &'static str| move |d: f64| format!("alpha {} at D_f = {d:?}, {law}", label(measured));
    let mut claims = Vec::new();
    // The paper fits Eq. 6 to surfaces; lines are not said to follow it more closely than Fig. 3 shows.
    if label(measured) == "3D" {
        claims.extend(with_laws(measured, name("Eq. 6"), LINE, line, |law, claim| {
            claim.beside("Eq. 24", zoom(law.fractal_dimension))
        }));
    }
    claims.extend(with_laws(measured, name("Eq. 24"), ZOOM, zoom, |law, claim| {
        claim.beside("Eq. 6", line(law.fractal_dimension))
    }));
    claims
}

/// Exponents of line and surface.
pub(super) fn line_against_solid(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let dimensions = solid.series.iter().map(|s| s.fractal_dimension);
    (dimensions.zip(laws(solid)).zip(laws(line)))
        .map(|((d, a), b)| {
            let name = format!("alpha 1D minus alpha 3D at D_f = {d:?}");
            let (statement, paper) =
                if d <= 2.5 { (ALIKE, [-SAME, SAME]) } else { (VERY_WELL, [-AGREE, AGREE]) };
            match (a, b) {
                (Ok(a), Ok(b)) => {
                    let remark = format!("3D: {}; 1D: {}; {INTERVAL}", a.window(), b.window());
                    Claim::judge(name, statement, paper, difference(b.alpha, a.alpha), remark)
                }
                (Err(reason), _) | (_, Err(reason)) => Claim::unresolved(name, statement, paper, reason),
            }
        })
        .collect()
}

/// k_1D/k_3D below the crossover, at the load where the surface resolves its contact: 100 cells on every surface.
pub(super) fn below_the_crossover(solid: &Measured, line: &Measured) -> Vec<Claim> {
    const CELLS: usize = 100;
    const PAPER: [f64; 2] = [0.9, 1.1];
    let lowest = |s: &Series| {
        let resolved = s.points.iter().find(|p| {
            p.missing == 0
                && p.force_bar >= 1e-3 * (1.0 - 1e-9)
                && p.min_contact_cells.is_some_and(|c| c >= CELLS)
        });
        resolved.map(|p| p.force_bar).filter(|f| *f <= 0.086)
    };
    (solid.series.iter().zip(&line.series))
        .map(|(a, b)| {
            let name = format!("k 1D over k 3D in the power-law range, D_f = {:?}", a.fractal_dimension);
            let found = lowest(a).and_then(|f| Some((f, stiffness_at(b, f)?, stiffness_at(a, f)?)));
            if let Some((f, line, solid)) = found {
                    let remark = format!(
                        "at F_bar = {f:.2e}, the smallest load from 1e-3 on at which every surface has {CELLS} cells in contact"
                    );
                    Claim::judge(name, ONLY_CROSSOVER, PAPER, ratio(line, solid), remark)
                } else {
                    let reason = format!("no common load up to 0.086 with {CELLS} contact cells on every surface: finer grids have one");
                    Claim::unresolved(name, ONLY_CROSSOVER, PAPER, reason)
                }
        })
        .collect()
}

/// k_1D/k_3D wherever the surface resolves its contact: the load where both are farthest apart.
pub(super) fn at_every_load(solid: &Measured, line: &Measured) -> Vec<Claim> {
    const CELLS: usize = 100;
    const PAPER: [f64; 2] = [0.75, 1.0 / 0.75];
    (solid.series.iter().zip(&line.series))
        .map(|(a, b)| {
            let name = format!("k 1D over k 3D, load where farthest from 1, D_f = {:?}", a.fractal_dimension);
            let resolved =
                a.points.iter().filter(|p| p.missing == 0 && p.min_contact_cells.is_some_and(|c| c >= CELLS));
            let farthest = resolved
                .filter_map(|p| {
                    let f = p.force_bar;
                    Some((f, ratio(stiffness_at(b, f)?, stiffness_at(a, f)?)))
                })
                .max_by(|a, b| a.1.value.ln().abs().total_cmp(&b.1.value.ln().abs()));
            let Some((f, found)) = farthest else {
                let reason = format!("no common load with {CELLS} contact cells on every surface");
                return Claim::unresolved(name, ALL_DIMENSIONS, PAPER, reason);
            };
            let remark =
                format!("at F_bar = {f:.2e}; loads at which every surface has {CELLS} cells in contact");
            Claim::judge(name, ALL_DIMENSIONS, PAPER, found, remark)
        })
        .collect()
}

/// Whether every exponent is below that of a proportionality.
pub(super) fn below_one(measured: &Measured) -> Vec<Claim> {
    let name = |d: f64| format!("alpha {} at D_f = {d:?}, beside 1", label(measured));
    with_laws(measured, name, DIFFERS, |_| [0.0, 0.9], |_, claim| claim)
}

/// What finer grids change, and what the scatter of the surfaces is beside it.
pub(super) fn size_effects(measured: &Measured) -> Vec<Claim> {
    const TO: f64 = 0.05;
    const LOAD: f64 = 0.01;
    let mut claims = Vec::new();
    for series in &measured.series {
        let d = series.fractal_dimension;
        let name = format!("k with half as many cells a side over k, minus 1, D_f = {d:?}");
        let window = FitWindow::PAPER;
        let inside = (0..series.points.len()).filter(|&j| {
            let p = &series.points[j];
            p.force_bar <= window.max_force_bar
                && p.min_contact_cells.is_some_and(|c| c >= window.min_contact_cells)
        });
        let coarser = measured.coarser_at(d);
        let change = |j: usize| {
            let last: Vec<f64> = series.grid_differences(coarser?, j).iter().map(|d| d[0]).collect();
            Some((j, last.len(), mean_of(&last)?))
        };
        let largest = inside.filter_map(change).max_by(|a, b| a.2.value.abs().total_cmp(&b.2.value.abs()));
        claims.push(match largest {
            Some((j, surfaces, found)) => {
                let load = series.points[j].force_bar;
                let remark =
                    format!("at F_bar = {load:.1e}, where it is largest; mean over {surfaces} surfaces, Student's interval");
                Claim::judge(name, NO_SIZE_EFFECTS, [-TO, TO], found, remark)
            }
            None => Claim::unresolved(name, NO_SIZE_EFFECTS, [-TO, TO], "no coarser grid, or no resolved load up to 0.086"),
        });
        let name = format!("rms change of k by half as many cells, over its scatter, D_f = {d:?}");
        claims.push(match long_waves(series, coarser, LOAD) {
            Some((found, surfaces)) => Claim::judge(
                name,
                LONG_WAVES,
                [0.0, 1.0],
                found,
                format!("{surfaces} surfaces on both grids; the interval takes the logarithms of both variances as normal"),
            ),
            None => Claim::unresolved(name, LONG_WAVES, [0.0, 1.0], "no coarser grid, or no load within a factor 1.5 of 0.01"),
        });
    }
    claims
}

/// Ratio of rms change to scatter at the load nearest to `force_bar`, and the number of surfaces that are on both grids.
fn long_waves(series: &Series, coarser: Option<[&Series; 2]>, force_bar: f64) -> Option<(Estimate, usize)> {
    let away = |f: f64| (f / force_bar).ln().abs();
    let j = (0..series.points.len())
        .min_by(|&a, &b| away(series.points[a].force_bar).total_cmp(&away(series.points[b].force_bar)))
        .filter(|&j| away(series.points[j].force_bar) < 1.5_f64.ln())?;
    let changes: Vec<f64> = series.grid_differences(coarser?, j).iter().map(|d| d[0].powi(2)).collect();
    let k = series.points[j].stiffness_bar?;
    let scatter = k.standard_error? * (k.count as f64).sqrt() / k.mean;
    let n = changes.len() as f64;
    let value = (sum(changes.iter().copied()) / n).sqrt() / scatter;
    // ln of a sample variance of n normal numbers has the variance 2/n; half of it for the root.
    let ln_error = (0.5 / n + 0.5 / (k.count as f64 - 1.0)).sqrt();
    (value > 0.0).then_some((Estimate { value, half_width: value * 1.96 * ln_error }, changes.len()))
}

/// The 1D power law "down to 1e-7".
pub(super) fn down_to_small_forces(line: &Measured) -> Vec<Claim> {
    let low = FitWindow { min_force_bar: 1e-7 * (1.0 - 1e-9), max_force_bar: 1e-4, ..FitWindow::PAPER };
    let high = FitWindow { min_force_bar: 1e-4, ..FitWindow::PAPER };
    let estimate = |fit: &FittedPowerLaw| Estimate::normal(fit.alpha, fit.alpha_se);
    laws_within(line, &low)
        .iter()
        .zip(&laws_within(line, &high))
        .map(|(a, b)| {
            let name = format!("alpha 1D below 1e-4 minus above, D_f = {:?}", a.fractal_dimension);
            let too_few = |from: f64| {
                format!("every line has {FLOOR_CELLS} elements in contact only from {from:.1e} on: more elements reach 1e-7")
            };
            let (a, b) = match (&a.fit, &b.fit) {
                // Two loads a decade at least, from within a factor 2.2 of 1e-7.
                (Ok(a), Ok(b)) if a.force_bar_min <= 2.2e-7 => (a, b),
                (Ok(a), Ok(_)) => return Claim::unresolved(name, DOWN, [-SAME, SAME], too_few(a.force_bar_min)),
                _ => return Claim::unresolved(name, DOWN, [-SAME, SAME], too_few(low.max_force_bar)),
            };
            match estimate(a).zip(estimate(b)) {
                Some((below, above)) => {
                    let remark = format!("{:.3} from {:.1e} to 1e-4, {:.3} above", a.alpha, a.force_bar_min, b.alpha);
                    Claim::judge(name, DOWN, [-SAME, SAME], difference(below, above), remark)
                }
                None => Claim::unresolved(name, DOWN, [-SAME, SAME], "one line has no scatter"),
            }
        })
        .collect()
}

/// "Very accurately proportional": the local slopes of the lower and upper half of the window.
pub(super) fn straightness(measured: &Measured) -> Vec<Claim> {
    const STRAIGHT: Statement = Statement {
        quotation: "For low to medium forces, the logarithm of stiffness is very accurately proportional to the logarithm of the normal force",
        place: "Sec. II, Fig. 2",
        reading: "the exponent of the lower half of the window is that of the upper half, to 0.05",
    };
    const STRAIGHT_LINES: Statement = Statement {
        quotation: "the dependencies of the contact stiffness on normal force are power-law functions at small force and transition to a plateau at large normal forces",
        place: "Sec. III, Fig. 6",
        ..STRAIGHT
    };
    const PAPER: [f64; 2] = [-0.05, 0.05];
    let statement = if label(measured) == "3D" { STRAIGHT } else { STRAIGHT_LINES };
    (measured.series.iter().zip(laws(measured)))
        .map(|(series, law)| {
            let d = series.fractal_dimension;
            let name =
                format!("alpha {} of the upper half minus the lower half, D_f = {d:?}", label(measured));
            let law = match law {
                Ok(law) => law,
                Err(reason) => return Claim::unresolved(name, statement, PAPER, reason),
            };
            let middle = (law.fit.force_bar_min * law.fit.force_bar_max).sqrt();
            let half = |min: f64, max: f64| FitWindow {
                min_force_bar: min * (1.0 - 1e-9),
                max_force_bar: max * (1.0 + 1e-9),
                ..FitWindow::PAPER
            };
            let windows = [half(middle, law.fit.force_bar_max), half(law.fit.force_bar_min, middle)];
            let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
            let change = |draw: &[usize]| {
                let curves = series.curves.resampled(draw);
                let [upper, lower] = windows.map(|w| fit_power_law(&curves, &w, &once).ok());
                Some(upper?.alpha - lower?.alpha)
            };
            let all = series.curves.all();
            let error = Bootstrap::default().standard_error(all.len(), change);
            match change(&all).and_then(|value| Estimate::normal(value, error)) {
                Some(found) => {
                    let remark = format!(
                        "{}, halves at {middle:.1e}; the interval holds the scatter; this grid",
                        law.window()
                    );
                    Claim::judge(name, statement, PAPER, found, remark)
                }
                None => Claim::unresolved(name, statement, PAPER, "fewer than three loads in a half"),
            }
        })
        .collect()
}
