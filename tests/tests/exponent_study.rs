//! The study of the exponent, computed again from its samples by independent code.

use crate::committed::{Row, list, mean_and_error, number, of_dimension, rows, slope, student, text};
use std::collections::BTreeMap;

/// Loads and, for each level, its surfaces: k_bar on the coarsest grid, then differences.
pub(crate) struct ExponentStudy {
    pub(crate) forces: Vec<f64>,
    pub(crate) levels: Vec<Vec<Vec<f64>>>,
}

/// Tables of samples that a command names in its flag.
fn sources(flag: &str) -> Vec<String> {
    let tables = text("data/exponent/exponent.md");
    let words: Vec<&str> = tables.lines().next().unwrap().trim_matches('`').split(' ').collect();
    let at = words.iter().position(|word| *word == flag).unwrap();
    words[at + 1].split(',').map(str::to_owned).collect()
}

/// The surfaces or lines of a fractal dimension, of all runs together, at the loads that all of them have.
pub(crate) fn study(flag: &str, model: &str, d: f64) -> ExponentStudy {
    let mut found = ExponentStudy { forces: Vec::new(), levels: Vec::new() };
    for path in sources(flag) {
        let own: Vec<Row> =
            of_dimension(rows(&path), d).into_iter().filter(|row| row["model"] == model).collect();
        if own.is_empty() {
            continue;
        }
        let forces = loads(&path, model);
        let kept: Vec<usize> = (0..forces.len())
            .filter(|&j| {
                found.forces.is_empty() || found.forces.iter().any(|f| (f / forces[j] - 1.0).abs() < 1e-6)
            })
            .collect();
        // What earlier runs have and this one has not is dropped.
        let stays: Vec<usize> = (0..found.forces.len())
            .filter(|&i| forces.iter().any(|f| (f / found.forces[i] - 1.0).abs() < 1e-6))
            .collect();
        for surface in found.levels.iter_mut().flatten() {
            *surface = stays.iter().filter_map(|&i| surface.get(i).copied()).collect();
        }
        found.forces = kept.iter().map(|&j| forces[j]).collect();
        for row in &own {
            let level = number(row, "level") as usize;
            if found.levels.len() <= level {
                found.levels.resize(level + 1, Vec::new());
            }
            let fine: Option<Vec<f64>> = list(row, "stiffness_bar").into_iter().collect();
            let coarse: Option<Vec<f64>> = match row["coarse_stiffness_bar"].as_str() {
                "" => fine.as_ref().map(|fine| vec![0.0; fine.len()]),
                _ => list(row, "coarse_stiffness_bar").into_iter().collect(),
            };
            // A pair with a solve that missed its tolerance is left out whole.
            if let (Some(fine), Some(coarse)) = (fine, coarse) {
                let value = |&j: &usize| Some(fine.get(j)? - coarse.get(j)?);
                found.levels[level].push(kept.iter().map_while(value).collect());
            }
        }
    }
    found
}

/// Loads of a table of samples: those of the command in its header.
fn loads(path: &str, model: &str) -> Vec<f64> {
    let header = crate::committed::comments(path);
    let command = header.iter().find(|line| line.starts_with("command: ")).unwrap();
    let flag = if model == "bem3d" { " --forces " } else { " --line-forces " };
    let range = command.split(flag).nth(1).unwrap().split(' ').next().unwrap();
    let parts: Vec<f64> = range.split(':').map(|part| part.parse().unwrap()).collect();
    let (low, high, count) = (parts[0], parts[1], parts[2] as i32);
    (0..count).map(|i| low * (high / low).powf(f64::from(i) / f64::from(count - 1))).collect()
}

impl ExponentStudy {
    /// Mean curve of the first levels.
    pub(crate) fn mean(&self, levels: usize) -> Vec<f64> {
        let of = |level: &Vec<Vec<f64>>, j: usize| {
            let all: Vec<f64> = level.iter().filter_map(|s| s.get(j).copied()).collect();
            if all.is_empty() { 0.0 } else { all.iter().sum::<f64>() / all.len() as f64 }
        };
        (0..self.forces.len()).map(|j| self.levels[..levels].iter().map(|level| of(level, j)).sum()).collect()
    }

    /// The loads of a window.
    pub(crate) fn window(&self, from: f64, to: f64) -> Vec<usize> {
        let inside = |j: &usize| (from * 0.9..=to * 1.1).contains(&self.forces[*j]);
        (0..self.forces.len()).filter(inside).collect()
    }

    /// Exponent of a window.
    pub(crate) fn exponent(&self, window: &[usize]) -> f64 {
        let mean = self.mean(self.levels.len());
        slope(&window.iter().map(|&j| (self.forces[j].ln(), mean[j].ln())).collect::<Vec<_>>())
    }

    /// Variance and degrees of freedom (Welch and Satterthwaite) of a number that depends on the mean curve
    /// by these derivatives, surface by surface.
    pub(crate) fn variance(&self, gradient: &BTreeMap<usize, f64>) -> (f64, f64) {
        let (mut all, mut spread) = (0.0, 0.0);
        for level in &self.levels {
            let each: Vec<f64> = level
                .iter()
                .map(|s| gradient.iter().filter_map(|(&j, g)| Some(g * s.get(j)?)).sum())
                .collect();
            let variance = mean_and_error(&each).1.powi(2);
            all += variance;
            spread += variance * variance / (each.len() as f64 - 1.0);
        }
        (all, all * all / spread)
    }

    /// Variance of the exponent of a window, by the delta method.
    pub(crate) fn exponent_variance(&self, window: &[usize]) -> (f64, f64) {
        let mean = self.mean(self.levels.len());
        let x: Vec<f64> = window.iter().map(|&j| self.forces[j].ln()).collect();
        let middle = x.iter().sum::<f64>() / x.len() as f64;
        let square: f64 = x.iter().map(|x| (x - middle).powi(2)).sum();
        self.variance(&window.iter().zip(&x).map(|(&j, x)| (j, (x - middle) / square / mean[j])).collect())
    }
}

const DECADES: [(&str, f64, f64); 4] = [
    ("2e-2..2e-1", 2e-2, 2e-1),
    ("2e-3..2e-2", 2e-3, 2e-2),
    ("2e-4..2e-3", 2e-4, 2e-3),
    ("2e-5..2e-4", 2e-5, 2e-4),
];

#[test]
fn exponents_and_their_scatter_are_those_of_the_samples() {
    let table = rows("data/exponent/exponent-laws.csv");
    for model in ["bem3d", "mdr1d"] {
        for d in [2.0, 2.2, 2.4, 2.6, 2.8, 3.0] {
            let study = study("--samples", model, d);
            for (name, from, to) in DECADES {
                let row = table.iter().find(|row| {
                    row["model"] == model
                        && row["convention"] == "measured_rms"
                        && row["window"] == name
                        && (number(row, "fractal_dimension") - d).abs() < 1e-9
                });
                let Some(row) = row.filter(|row| row["resolved"] == "true") else { continue };
                let window = study.window(from, to);
                assert_eq!(window.len(), 7, "{model}, D_f {d}, {name}");
                let alpha = study.exponent(&window);
                assert!((alpha - number(row, "alpha")).abs() < 1e-9, "{model}, D_f {d}, {name}: {alpha}");
                let (variance, freedom) = study.exponent_variance(&window);
                let half = student(freedom) * variance.sqrt();
                let stated = number(row, "scatter");
                // Student's quantile by a series: some per cent for few degrees of freedom.
                assert!(
                    (half / stated - 1.0).abs() < 0.03,
                    "{model}, D_f {d}, {name}: {half}, stated {stated}"
                );
            }
        }
    }
}

#[test]
fn the_slope_of_line_over_surface_is_that_of_the_samples() {
    let page = text("book/src/exponent.md");
    let table = rows("data/exponent/exponent-factor.csv");
    for (d, rejected) in [(2.0, true), (2.2, true), (2.4, true), (2.6, false)] {
        let [line, solid] = ["mdr1d", "bem3d"].map(|model| study("--samples", model, d));
        let (on_line, on_solid) = (line.window(2e-3, 2e-2), solid.window(2e-3, 2e-2));
        let difference = line.exponent(&on_line) - solid.exponent(&on_solid);
        let (a, b) = (line.exponent_variance(&on_line), solid.exponent_variance(&on_solid));
        let variance = a.0 + b.0;
        let freedom = variance * variance / (a.0 * a.0 / a.1 + b.0 * b.0 / b.1);
        let half = student(freedom) * variance.sqrt();
        let row = table.iter().find(|row| {
            row["convention"] == "measured_rms"
                && row["window"] == "2e-3..2e-2"
                && (number(row, "fractal_dimension") - d).abs() < 1e-9
        });
        let row = row.unwrap();
        assert!((difference - number(row, "slope")).abs() < 1e-9, "D_f {d}: {difference}");
        assert!((half / number(row, "slope_scatter") - 1.0).abs() < 0.02, "D_f {d}: {half}");
        // By the scatter alone, this one slope.
        assert_eq!(difference.abs() > half, rejected, "D_f {d}: {difference} +- {half}");
        let stated = format!("{difference:.4}");
        assert!(page.contains(&stated), "{stated}");
    }
}

/// alpha and omega of the law zeta F^alpha (1 + c F^omega) that fits best.
pub(crate) fn towards_zero(x: &[f64], y: &[f64], weights: &[f64], held: Option<f64>) -> (f64, f64) {
    let ExponentLaw { alpha, omega, .. } = law(x, y, weights, held);
    (alpha, omega)
}

/// A law zeta F^alpha (1 + c F^omega), c in powers of the largest force, and its misfit.
struct ExponentLaw {
    misfit: f64,
    alpha: f64,
    omega: f64,
    c: f64,
}

/// The law that fits best, by a search of omega and c that is refined fourteen times.
fn law(x: &[f64], y: &[f64], weights: &[f64], held: Option<f64>) -> ExponentLaw {
    let top = x[x.len() - 1];
    let all: f64 = weights.iter().sum();
    let line = |omega: f64, c: f64| {
        let z: Vec<f64> =
            x.iter().zip(y).map(|(x, y)| y - (1.0 + c * (omega * (x - top)).exp()).ln()).collect();
        let mean = |v: &[f64]| v.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>() / all;
        let (x0, z0) = (mean(x), mean(&z));
        let (mut xx, mut xz, mut zz) = (0.0, 0.0, 0.0);
        for ((x, z), w) in x.iter().zip(&z).zip(weights) {
            xx += w * (x - x0).powi(2);
            xz += w * (x - x0) * (z - z0);
            zz += w * (z - z0).powi(2);
        }
        (zz - xz * xz / xx, xz / xx)
    };
    let mut best = (f64::INFINITY, 0.0, 0.8, -0.5);
    let (mut wide, mut deep) = (0.5 * 8_f64.ln(), 0.499);
    for round in 0..14 {
        let (middle, bottom) = if round == 0 { (0.5_f64.sqrt(), -0.5) } else { (best.2, best.3) };
        for i in -12..=12 {
            let omega = (middle * (wide * f64::from(i) / 12.0).exp()).clamp(0.25, 2.0);
            for j in -12..=12 {
                let (omega, c) = (held.unwrap_or(omega), bottom + deep * f64::from(j) / 12.0);
                let (misfit, alpha) = if c > -0.9999 { line(omega, c) } else { continue };
                if misfit < best.0 {
                    best = (misfit, alpha, omega, c);
                }
            }
        }
        wide *= 0.6;
        deep *= 0.6;
    }
    let (misfit, alpha, omega, c) = best;
    ExponentLaw { misfit, alpha, omega, c }
}

#[test]
fn exponents_towards_zero_force_are_those_of_the_samples() {
    let table = rows("data/exponent/exponent-limit.csv");
    for (model, d) in [("mdr1d", 2.0), ("mdr1d", 2.4), ("mdr1d", 2.6), ("bem3d", 2.2), ("bem3d", 2.4)] {
        let study = study("--samples", model, d);
        let row = table.iter().find(|row| {
            row["model"] == model
                && row["convention"] == "measured_rms"
                && row["variant"] == "free"
                && (number(row, "fractal_dimension") - d).abs() < 1e-9
        });
        let row = row.unwrap();
        let window = study.window(number(row, "force_bar_min"), number(row, "force_bar_max"));
        assert_eq!(window.len(), number(row, "loads") as usize);
        let mean = study.mean(study.levels.len());
        let x: Vec<f64> = window.iter().map(|&j| study.forces[j].ln()).collect();
        let weights: Vec<f64> =
            (window.iter()).map(|&j| 1.0 / study.variance(&BTreeMap::from([(j, 1.0 / mean[j])])).0).collect();
        let fit = |mean: &[f64], held| {
            let y: Vec<f64> = window.iter().map(|&j| mean[j].ln()).collect();
            towards_zero(&x, &y, &weights, held)
        };
        let (alpha, omega) = fit(&mean, None);
        let stated = number(row, "alpha");
        assert!((alpha - stated).abs() < 2e-3, "{model}, D_f {d}: {alpha}, stated {stated}");
        assert!((omega / number(row, "omega") - 1.0).abs() < 0.1, "{model}, D_f {d}: omega {omega}");
        // The bootstrap's interval without the remaining discretisation error, beside delta's method by refitting a curve
        // that is moved at one load.
        let by = 1e-3;
        let gradient: BTreeMap<usize, f64> = (window.iter())
            .map(|&j| {
                let moved = |factor: f64| {
                    let mut mean = mean.clone();
                    mean[j] *= factor;
                    fit(&mean, None).0
                };
                (j, (moved(1.0 + by) - moved(1.0 - by)) / (2.0 * by * mean[j]))
            })
            .collect();
        let (variance, freedom) = study.variance(&gradient);
        let half = student(freedom) * variance.sqrt();
        let stated = 0.5 * (number(row, "alpha_high") - number(row, "alpha_low")) - number(row, "grid");
        // The bounds of omega cut the bootstrap of the surfaces, and not a derivative.
        assert!((0.5..2.5).contains(&(half / stated)), "{model}, D_f {d}: {half}, stated {stated}");
    }
}

/// Which of the fits describe their curves: the share of curves about the law with a larger misfit, from fewer
/// draws of another generator and by another search.
#[test]
fn the_goodness_of_a_fit_is_that_of_curves_about_its_law() {
    let table = rows("data/exponent/exponent-limit.csv");
    for (d, draws) in [(2.0, 100), (2.4, 60)] {
        let study = study("--samples", "bem3d", d);
        let row = table.iter().find(|row| {
            row["model"] == "bem3d"
                && row["convention"] == "measured_rms"
                && row["variant"] == "free"
                && (number(row, "fractal_dimension") - d).abs() < 1e-9
        });
        let row = row.unwrap();
        let window = study.window(number(row, "force_bar_min"), number(row, "force_bar_max"));
        let mean = study.mean(study.levels.len());
        let x: Vec<f64> = window.iter().map(|&j| study.forces[j].ln()).collect();
        let logarithms = |mean: &[f64]| -> Vec<f64> { window.iter().map(|&j| mean[j].ln()).collect() };
        let weights: Vec<f64> =
            (window.iter()).map(|&j| 1.0 / study.variance(&BTreeMap::from([(j, 1.0 / mean[j])])).0).collect();
        let y = logarithms(&mean);
        let found = law(&x, &y, &weights, None);
        assert!((found.misfit / number(row, "misfit") - 1.0).abs() < 0.02, "D_f {d}: {}", found.misfit);
        // Residuals of the law: what is left of it, up to its factor, which the fit finds again.
        let top = x[x.len() - 1];
        let of_law: Vec<f64> = x
            .iter()
            .map(|x| found.alpha * x + (1.0 + found.c * (found.omega * (x - top)).exp()).ln())
            .collect();
        let larger = (study.drawn_again(draws).iter())
            .filter(|drawn| {
                let moved: Vec<f64> =
                    logarithms(drawn).iter().zip(&y).zip(&of_law).map(|((k, y), law)| law + k - y).collect();
                law(&x, &moved, &weights, None).misfit >= found.misfit
            })
            .count();
        let (share, stated) = (larger as f64 / draws as f64, number(row, "goodness"));
        // Four standard errors of a share.
        let error = 4.0 * (stated.max(0.01) * (1.0 - stated) / draws as f64).sqrt();
        assert!((share - stated).abs() <= error, "D_f {d}: {share}, stated {stated}");
        let fits = !row["conclusion"].starts_with("none");
        assert_eq!(fits, stated >= 0.05, "{row:?}");
    }
}

/// At H = 1 a logarithm of the structure function would give k ~ F^(1/2) ln(c/F)^(-1/4): the exponents of decades that
/// the page quotes for it, and those found.
#[test]
fn a_logarithm_at_h_1_has_other_exponents_than_the_decades() {
    let page = text("book/src/exponent.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let table = rows("data/exponent/exponent-laws.csv");
    for (window, from, quoted) in
        [("2e-4..2e-3", 2e-4, "between 0.526 and 0.541"), ("2e-5..2e-4", 2e-5, "between 0.521 and 0.530")]
    {
        let with = |c: f64| {
            let points: Vec<(f64, f64)> = (0..7)
                .map(|i| from * 10_f64.powf(f64::from(i) / 6.0))
                .map(|force| (force.ln(), 0.5 * force.ln() - 0.25 * (c / force).ln().ln()))
                .collect();
            slope(&points)
        };
        let [low, high] = [with(10.0), with(0.3)];
        assert_eq!(quoted, format!("between {low:.3} and {high:.3}"));
        assert!(page.contains(quoted), "{quoted}");
        for model in ["mdr1d", "bem3d"] {
            let row = table.iter().find(|row| {
                row["model"] == model
                    && row["convention"] == "measured_rms"
                    && row["window"] == window
                    && row["fractal_dimension"] == "2.0"
            });
            let row = row.unwrap();
            let highest = number(row, "alpha") + number(row, "scatter") + number(row, "grid");
            assert!(highest < low, "{model}, {window}: {highest}");
        }
    }
}

#[test]
fn hypotheses_are_judged_by_their_intervals() {
    let tests = rows("data/exponent/exponent-tests.csv");
    let count = |family: &str| tests.iter().filter(|row| row["family"] == family).count();
    assert_eq!(["A", "B", "C", "D"].map(count), [7, 6, 6, 8]);
    for row in tests.iter().filter(|row| !row["found"].is_empty()) {
        let [low, high, expected] = ["low", "high", "expected"].map(|column| number(row, column));
        let inside = (low..=high).contains(&expected);
        let verdict = match (row["resolved"].as_str(), inside) {
            ("true", true) => "not rejected",
            ("true", false) => "rejected",
            _ => "not resolved",
        };
        assert_eq!(row["verdict"], verdict, "{row:?}");
        // A chance below the share of a test in its family rejects, and no other.
        if let Ok(chance) = row["chance"].parse::<f64>() {
            let share = 0.05 / number(row, "tests");
            assert!((chance - share).abs() < 1e-6 || (chance < share) != inside, "{row:?}");
        }
    }
    // Every hypothesis is in the file that was committed before the run.
    let fixed = text("data/exponent/hypotheses.md");
    for (family, words) in [("A", "Seven tests in all"), ("B", "six tests of"), ("D", "Eight tests of")] {
        assert!(fixed.contains(words), "{family}: {words}");
    }
}

/// Budgets of the mean curves of Fig. 2 on 2049 cells, compared with the mean change to 16385 cells from
/// pairs of the study.
#[test]
fn budgets_of_mean_curves_are_checked_on_finer_grids() {
    let budgets = rows("data/figures/paper/fig2-budget.csv");
    let (mut rough, mut smooth) = ([0, 0], [0, 0]);
    for d in [2.0, 2.2, 2.4, 2.6, 2.8, 3.0] {
        let study = study("--samples", "bem3d", d);
        // Levels 4 to 6 are the differences from 2049 to 4097, 8193 and 16385 cells.
        let [coarse, fine] = [4, study.levels.len()].map(|levels| study.mean(levels));
        for row in of_dimension(budgets.clone(), d) {
            let judged = row["quantity"] == "stiffness_bar" && row["below_floor"] == "false";
            if !judged || number(&row, "force_bar") > 0.020_000_1 {
                continue;
            }
            let at = number(&row, "force_bar").ln();
            let above = study.forces.iter().position(|f| f.ln() >= at - 1e-9).unwrap().max(1);
            let [x0, x1] = [above - 1, above].map(|j| study.forces[j].ln());
            let [y0, y1] = [above - 1, above].map(|j| fine[j] - coarse[j]);
            let change = y0 + (y1 - y0) * (at - x0) / (x1 - x0);
            let inside = change.abs() <= number(&row, "discretisation");
            let counts = if d < 2.7 { &mut smooth } else { &mut rough };
            counts[usize::from(inside)] += 1;
        }
    }
    let words = text("book/src/certificates.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let [[rough_out, rough_in], [smooth_out, smooth_in]] = [rough, smooth];
    for sentence in [
        format!("{smooth_in} of {} inside for D_f up to 2.6", smooth_in + smooth_out),
        format!("{rough_in} of {} above", rough_in + rough_out),
    ] {
        assert!(words.contains(&sentence), "{sentence}");
    }
}
