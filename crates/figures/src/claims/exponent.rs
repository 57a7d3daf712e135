//! alpha: the abstract's range, Eqs. 6 and 24, 1D against 3D, 1D at small forces.

use super::common::{INTERVAL, Law, difference, label, laws, ratio, stiffness_at};
use analysis::{Bootstrap, FitWindow, FittedPowerLaw, sum};
use evaluation::{Claim, Estimate, FLOOR_CELLS, Measured, Series, Statement, laws_within};

const ENDS: Statement = Statement {
    quotation: "a power law, with the exponent varying from 0.50 to 0.85, depending on the fractal dimension",
    place: "abstract; Secs. II, IV",
    reading: "the exponents at D_f = 2 and 3, to 0.03: Eq. 6, a straight fit of the same points, has 0.53 and 0.80 there",
};

/// How far the paper's own ends and its fit are apart, half of it at least.
const ENDS_TO: f64 = 0.03;

const FIT: Statement = Statement {
    quotation: "The power alpha can be fitted as alpha = 0.266 D_f",
    place: "Eq. 6, Fig. 3",
    reading: "the straight line through the origin that fits the exponents best has this slope, to 0.005",
};

const LINE: Statement = Statement {
    quotation: "alpha = 0.266 D_f",
    place: "Eq. 6, Fig. 3",
    reading: "as a law of each D_f, to the digits printed",
};

const ZOOM: Statement = Statement {
    quotation: "directly supplying a value for the exponent: alpha = 1/(1 + H)",
    place: "Eq. 24, Sec. IV",
    reading: "the exponent at small force, where the contact is one region of the surface; argued for small D_f, called exact",
};

const ALIKE: Statement = Statement {
    quotation: "In the region of practically relevant fractal dimensions between 2 and 2.5, they coincide almost exactly",
    place: "Sec. III, Fig. 3",
    reading: "the exponents of 1D and 3D differ by less than 0.03: a symbol of Fig. 3",
};

const ONLY_CROSSOVER: Statement = Statement {
    quotation: "The only region where there is a systematical discrepancy between 1D and 3D cases is the region of crossover",
    place: "Sec. III",
    reading: "below F_bar = 0.086 the stiffnesses of line and surface are equal to 10 %: lines of a plot over six decades",
};

const DOWN: Statement = Statement {
    quotation: "In the 1D case, the power-law dependencies remain correct up to forces of 10^-7",
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
    let (name, paper) = (format!("alpha over D_f, {}", label(measured)), [0.261, 0.271]);
    let own: Result<Vec<Law>, String> = laws(measured).into_iter().collect();
    let own = match own {
        Ok(own) if own.len() >= 3 => own,
        Ok(_) => {
            return vec![Claim::unresolved(name, FIT, paper, "at least three fractal dimensions are needed")];
        }
        Err(reason) => return vec![Claim::unresolved(name, FIT, paper, reason)],
    };
    // Through the origin: sum D alpha / sum D^2. All D_f share phases and window: their errors are taken to add up.
    let square = sum(own.iter().map(|l| l.fractal_dimension.powi(2)));
    let through = |alphas: &[Estimate]| Estimate {
        value: sum(own.iter().zip(alphas).map(|(l, a)| l.fractal_dimension * a.value)) / square,
        half_width: sum(own.iter().zip(alphas).map(|(l, a)| l.fractal_dimension * a.half_width)) / square,
    };
    let alphas: Vec<Estimate> = own.iter().map(|l| l.alpha).collect();
    let mut claims = vec![Claim::judge(
        format!("{name}, each D_f's own window"),
        FIT,
        paper,
        through(&alphas),
        format!("errors of different D_f taken to add up; {INTERVAL}"),
    )];
    let lowest = own.iter().map(|l| l.fit.force_bar_min).fold(0.0, f64::max);
    let window = FitWindow { min_force_bar: lowest * (1.0 - 1e-9), ..FitWindow::PAPER };
    let common: Option<Vec<Estimate>> = laws_within(measured, &window)
        .iter()
        .map(|law| law.fit.as_ref().ok().and_then(|fit| Estimate::normal(fit.alpha, fit.alpha_se)))
        .collect();
    if let Some(common) = common {
        let remark =
            format!("F_bar from {lowest:.1e} to 0.086 for every D_f; the interval holds the scatter");
        claims.push(Claim::judge(format!("{name}, common window"), FIT, paper, through(&common), remark));
    }
    claims
}

/// Each exponent beside Eq. 6 and Eq. 24, each of which is the other's rival.
pub(super) fn laws_of_each(measured: &Measured) -> Vec<Claim> {
    let scaling = |d: f64| analytic::exponent_scaling(3.0 - d);
    let name = |law: &'static str| move |d: f64| format!("alpha {} at D_f = {d:?}, {law}", label(measured));
    // A coefficient of three digits.
    let printed = |d: f64| [0.2655 * d, 0.2665 * d];
    let mut claims = Vec::new();
    // The paper fits Eq. 6 to surfaces; lines are not said to follow it more closely than Fig. 3 shows.
    if label(measured) == "3D" {
        claims.extend(with_laws(measured, name("Eq. 6"), LINE, printed, |law, claim| {
            claim.beside("1/(1 + H)", scaling(law.fractal_dimension))
        }));
    }
    let exactly = |d: f64| [scaling(d); 2];
    claims.extend(with_laws(measured, name("Eq. 24"), ZOOM, exactly, |law, claim| {
        // A law that is exact has no width of its own: its interval confirms it where it holds it and no rival.
        let claim = match claim.here {
            Some(here) if here.holds(scaling(law.fractal_dimension)) => {
                Claim { verdict: evaluation::Verdict::Confirmed, ..claim }
            }
            _ => claim,
        };
        claim.beside("0.266 D_f", analytic::exponent_fit(law.fractal_dimension))
    }));
    claims
}

/// Exponents of line and surface.
pub(super) fn line_against_solid(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let dimensions = solid.series.iter().map(|s| s.fractal_dimension);
    (dimensions.zip(laws(solid)).zip(laws(line)))
        .filter(|((d, _), _)| *d <= 2.5)
        .map(|((d, a), b)| {
            let name = format!("alpha 1D minus alpha 3D at D_f = {d:?}");
            match (a, b) {
                (Ok(a), Ok(b)) => {
                    let remark = format!("3D: {}; 1D: {}; {INTERVAL}", a.window(), b.window());
                    Claim::judge(name, ALIKE, [-SAME, SAME], difference(b.alpha, a.alpha), remark)
                }
                (Err(reason), _) | (_, Err(reason)) => Claim::unresolved(name, ALIKE, [-SAME, SAME], reason),
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
    const PAPER: [f64; 2] = [-0.05, 0.05];
    (measured.series.iter().zip(laws(measured)))
        .map(|(series, law)| {
            let d = series.fractal_dimension;
            let name =
                format!("alpha {} of the upper half minus the lower half, D_f = {d:?}", label(measured));
            let law = match law {
                Ok(law) => law,
                Err(reason) => return Claim::unresolved(name, STRAIGHT, PAPER, reason),
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
                let [upper, lower] = windows.map(|w| analysis::fit_power_law(&curves, &w, &once).ok());
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
                    Claim::judge(name, STRAIGHT, PAPER, found, remark)
                }
                None => Claim::unresolved(name, STRAIGHT, PAPER, "fewer than three loads in a half"),
            }
        })
        .collect()
}
