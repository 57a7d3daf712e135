//! What the curves themselves say: the crossing, saturation, the crossover, the collapse.

use super::common::{label, laws, ratio, stiffness_at};
use crate::claim::{Claim, Estimate, Statement};
use analysis::{
    Bootstrap, CollapsePoint, FitWindow, collapse as residual, decades_within, fit_power_law, interpolate,
    sum,
};
use analytic::{F_BAR_UL, K_BAR_UL};
use contact_model::PAPER_STIFFNESS_FACTOR;
use evaluation::{Measured, Series, transformed};

const THROUGH: Statement = Statement {
    quotation: "all curves collapse for k̄_ul = 0.18 and F̄_ul = 0.086",
    place: "Sec. II, Fig. 2",
    reading: "every curve passes there within 10 %: the width of a line of Fig. 2",
};

const UPPER_LIMIT: Statement = Statement {
    quotation: "giving the upper limit for which the power law is valid",
    place: "Sec. II",
    reading: "half a decade above, at F_bar = 0.3, k has fallen below the fitted law by more than 5 %",
};

const NARROWEST: Statement = Statement {
    quotation: "all curves collapse for k̄_ul = 0.18 and F̄_ul = 0.086 ... This intersection",
    place: "Sec. II, Fig. 2",
    reading: "a crossing: the curves are closer together there than half a decade above, at 0.3",
};

const TOGETHER: Statement = Statement {
    reading: "they come together: their spread there is less than half of that at F_bar = 0.01",
    ..NARROWEST
};

const CONDUCTANCE: Statement = Statement {
    quotation: "Lambda = 0.411 sqrt(A_0)/(rho_1 + rho_2) (F/(0.086 E* h sqrt(A_0)))^(0.266 D_f)",
    place: "Eq. 13",
    reading: "the mean over D_f at F_bar = 0.086, to 5 %: 0.18 has two digits",
};

const SATURATED: Statement = Statement {
    quotation: "The saturation value of the stiffness is reached in both cases for forces of about F = 20 E* h sqrt(A_0)",
    place: "Sec. III, Figs. 2, 6",
    reading: "the mean stiffness has 97 % of its plateau at F_bar = 20 or before: the line of a plot",
};

const SMALL_AREA: Statement = Statement {
    quotation: "as long as contact spots are equally spread over the apparent contact zone, a relatively small real contact area suffices for causing the stiffness to be comparable to the full-contact indenter",
    place: "Sec. I",
    reading: "less than half of the area is in contact where k is 90 % of its plateau",
};

const CROSSOVER: Statement = Statement {
    quotation: "In the 1D case, the stiffness is overestimated by up to 25 % in this region",
    place: "Sec. III",
    reading: "the largest k_1D/k_3D above F_bar = 0.086, over all D_f, is 1.15 to 1.30",
};

const SOONER: Statement = Statement {
    quotation: "and the saturation is reached more quickly",
    place: "Sec. III",
    reading: "the line has 90 % of its plateau at a smaller force than the surface",
};

const COLLAPSE: Statement = Statement {
    quotation: "The data for all forces and all fractal dimensions collapse to one master curve",
    place: "Sec. II, Fig. 4",
    reading: "up to F_bar = 0.086, the upper limit of Eq. 12: rms scatter below 0.1 decades of F_tilde, 2 % of the width of Fig. 4",
};

const ALL_FORCES: Statement = Statement {
    reading: "literally, at all forces up to 20: rms scatter below 0.1 decades of F_tilde",
    ..COLLAPSE
};

const ON_THE_LINE: Statement = Statement {
    quotation: "To prove this relation, the value of F_tilde is plotted versus F_bar",
    place: "Eq. 12, Fig. 4",
    reading: "rms distance from F_tilde = F_bar below a factor 1.5 (0.18 decades) where every surface has 10 cells in contact",
};

const DECADES: Statement = Statement {
    quotation: "the valid range for Eq. (12) comprises four orders of magnitude ... valid over more than three orders of magnitude",
    place: "Fig. 4; conclusion",
    reading: "at the best D_f Eq. 12 holds within a factor 1.5 in F_bar over more than three decades",
};

fn named(what: &str, measured: &Measured, series: &Series) -> String {
    format!("{what} {}, D_f = {:?}", label(measured), series.fractal_dimension)
}

const NO_LOAD: &str = "outside the loads of this run";

/// k_bar at F_bar = 0.086.
pub(super) fn near_the_crossing(measured: &Measured) -> Vec<Claim> {
    let paper = [0.9 * K_BAR_UL, 1.1 * K_BAR_UL];
    let each = |s: &Series| {
        let name = named("k_bar at F_bar = 0.086,", measured, s);
        match stiffness_at(s, F_BAR_UL) {
            Some(k) => {
                let claim = Claim::judge(
                    name,
                    THROUGH,
                    paper,
                    k,
                    "arithmetic mean, F_bar by the measured rms height",
                );
                let log_means: Vec<Option<f64>> =
                    s.points.iter().map(|p| p.stiffness_bar.map(|k| k.log_mean)).collect();
                match interpolate(s.curves.force_bar(), &log_means, F_BAR_UL) {
                    Some(log_mean) => claim.in_convention("logarithmic mean", log_mean),
                    None => claim,
                }
            }
            None => Claim::unresolved(name, THROUGH, paper, NO_LOAD),
        }
    };
    measured.series.iter().map(each).collect()
}

/// Standard deviation of ln k_bar over the curves of all D_f at a force, for one draw of the surfaces.
fn spread(measured: &Measured, force_bar: f64, draw: &[usize]) -> Option<f64> {
    let logs: Option<Vec<f64>> = (measured.series.iter())
        .map(|s| interpolate(s.curves.force_bar(), &s.curves.mean_of(draw), force_bar).map(f64::ln))
        .collect();
    analysis::mean_and_deviation(&logs?)?.1
}

/// Whether the curves come together, and whether they cross: their spread at 0.086 over those at 0.01 and 0.3.
pub(super) fn narrowest(measured: &Measured) -> Vec<Claim> {
    let surfaces = measured.series.first().map_or(0, |s| s.units.len());
    let all: Vec<usize> = (0..surfaces).collect();
    let beside = |other: f64, statement: Statement, paper: [f64; 2]| {
        let name = format!("spread of the 3D curves over D_f, at F_bar = 0.086 over {other}");
        let quotient =
            |draw: &[usize]| Some(spread(measured, F_BAR_UL, draw)? / spread(measured, other, draw)?);
        let found = quotient(&all)
            .and_then(|value| Estimate::normal(value, Bootstrap::default().half_width(surfaces, quotient)));
        let Some(found) = found else {
            let reason = "fewer than two curves, or surfaces, at these loads";
            return Claim::unresolved(name, statement, paper, reason);
        };
        let relative = spread(measured, F_BAR_UL, &all).unwrap_or_default();
        Claim::judge(name, statement, paper, found, format!("relative spread {relative:.3} at 0.086"))
    };
    vec![beside(0.01, TOGETHER, [0.0, 0.5]), beside(0.3, NARROWEST, [0.0, 1.0])]
}

/// The fitted law above its window.
pub(super) fn upper_limit(measured: &Measured) -> Vec<Claim> {
    const BEYOND: f64 = 0.3;
    let paper = [0.0, 0.95];
    (measured.series.iter().zip(laws(measured)))
        .map(|(s, law)| {
            let name = named("k at F_bar = 0.3 over the law fitted below 0.086,", measured, s);
            let law = match law {
                Ok(law) => law,
                Err(reason) => return Claim::unresolved(name, UPPER_LIMIT, paper, reason),
            };
            // Law and stiffness of the same draw; the loads of the fit stay.
            let window = FitWindow {
                min_force_bar: law.fit.force_bar_min,
                max_force_bar: law.fit.force_bar_max,
                min_contact_cells: 0,
            };
            let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
            let over = |window: &FitWindow, draw: &[usize]| {
                let fit = fit_power_law(&s.curves.resampled(draw), window, &once).ok()?;
                let k = interpolate(s.curves.force_bar(), &s.curves.mean_of(draw), BEYOND)?;
                Some(k / (fit.zeta * BEYOND.powf(fit.alpha)))
            };
            let all = s.curves.all();
            let error = Bootstrap::default().standard_error(all.len(), |draw| over(&window, draw));
            let found = over(&window, &all).and_then(|value| Estimate::normal(value, error));
            let upper_half =
                FitWindow { min_force_bar: (window.min_force_bar * window.max_force_bar).sqrt(), ..window };
            match found {
                Some(found) => {
                    let moved = over(&upper_half, &all).map_or(0.0, |other| (other - found.value).abs());
                    let found = Estimate { half_width: found.half_width.hypot(moved), ..found };
                    let remark = format!(
                        "{}; the interval holds the scatter and the law of the upper half of its window",
                        law.window()
                    );
                    Claim::judge(name, UPPER_LIMIT, paper, found, remark)
                }
                None => Claim::unresolved(name, UPPER_LIMIT, paper, NO_LOAD),
            }
        })
        .collect()
}

/// Eq. 13 at the crossing: Lambda (rho1 + rho2)/L from the solved stiffness.
pub(super) fn conductance(measured: &Measured) -> Vec<Claim> {
    let name = "Lambda (rho_1 + rho_2)/L at F_bar = 0.086, mean over D_f";
    let printed = analytic::conductance_fit(F_BAR_UL, 2.0, 1.0, 1.0).unwrap_or(0.411);
    let paper = [0.95 * printed, 1.05 * printed];
    let values: Vec<Estimate> = measured.series.iter().filter_map(|s| stiffness_at(s, F_BAR_UL)).collect();
    // Shared phases: the errors of different D_f add, they do not average out.
    let mean = |pick: fn(&Estimate) -> f64| sum(values.iter().map(pick)) / values.len() as f64;
    let (k, half_width) = (mean(|e| e.value), mean(|e| e.half_width));
    vec![match analysis::conductance(k * PAPER_STIFFNESS_FACTOR, 1.0, 0.5, 0.5) {
        Ok(lambda) if !values.is_empty() => {
            let found = Estimate { value: lambda, half_width: half_width * 2.0 * PAPER_STIFFNESS_FACTOR };
            Claim::judge(
                name,
                CONDUCTANCE,
                paper,
                found,
                "2 k/(E* L), exact (Barber); errors of all D_f taken to add up",
            )
        }
        _ => Claim::unresolved(name, CONDUCTANCE, paper, NO_LOAD),
    }]
}

/// Saturation at F_bar = 20.
pub(super) fn saturation(measured: &Measured) -> Vec<Claim> {
    const SHARE: f64 = 0.97;
    let paper = [0.0, 20.0];
    let each = |s: &Series| {
        let name = named("F_bar at which the mean k has 97 % of its plateau,", measured, s);
        let at = |draw: &[usize]| force_at(s, SHARE * measured.discretisation.complete_contact(), draw);
        let error = Bootstrap::default().standard_error(s.units.len(), at);
        match at(&s.curves.all()).and_then(|value| Estimate::normal(value, error)) {
            Some(force) => {
                let at_most = s.curves.force_bar().last().copied().unwrap_or_default();
                let k = stiffness_at(s, at_most).map_or(0.0, |k| k.value);
                let remark = format!(
                    "the plateau of this grid is {:.4}, k_bar = {k:.4} at F_bar = {at_most}",
                    measured.discretisation.complete_contact()
                );
                Claim::judge(name, SATURATED, paper, force, remark)
            }
            None => Claim::unresolved(name, SATURATED, paper, NO_LOAD),
        }
    };
    measured.series.iter().map(each).collect()
}

/// F_bar at which a mean curve reaches a stiffness, by straight lines in ln-ln; `None` outside the loads.
fn force_at(series: &Series, stiffness_bar: f64, draw: &[usize]) -> Option<f64> {
    let points: Vec<(f64, f64)> = (series.curves.force_bar().iter().zip(series.curves.mean_of(draw)))
        .filter_map(|(&f, k)| Some((f, k?)))
        .collect();
    let pair = points.windows(2).find(|p| p[0].1 < stiffness_bar && p[1].1 >= stiffness_bar)?;
    let t = (stiffness_bar / pair[0].1).ln() / (pair[1].1 / pair[0].1).ln();
    Some(pair[0].0 * (pair[1].0 / pair[0].0).powf(t))
}

/// The contact area where k is comparable to that of complete contact.
pub(super) fn small_area(measured: &Measured) -> Vec<Claim> {
    let paper = [0.0, 0.5];
    let each = |s: &Series| {
        let name = named("A/A_0 where k is 90 % of its plateau,", measured, s);
        let fractions: Option<Vec<Option<f64>>> =
            Some((0..s.points.len()).map(|j| s.contact_fraction(j)).collect());
        let area = force_at(s, 0.9 * measured.discretisation.complete_contact(), &s.curves.all())
            .and_then(|f| interpolate(s.curves.force_bar(), &fractions?, f));
        match area {
            Some(area) => {
                let remark = "mean over the surfaces; waves down to two cells: a finer grid has less area, so an upper bound";
                Claim::judge(name, SMALL_AREA, paper, Estimate::exact(area), remark)
            }
            None => Claim::unresolved(name, SMALL_AREA, paper, NO_LOAD),
        }
    };
    measured.series.iter().map(each).collect()
}

/// The crossover: how far the line is above, and which saturates first.
pub(super) fn line_above_solid(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let mut largest: Option<(Estimate, f64, f64)> = None;
    for (a, b) in solid.series.iter().zip(&line.series) {
        for &f in a.curves.force_bar().iter().filter(|f| (F_BAR_UL..=20.0).contains(*f)) {
            let (Some(k3), Some(k1)) = (stiffness_at(a, f), stiffness_at(b, f)) else { continue };
            let here = ratio(k1, k3);
            if largest.is_none_or(|(most, ..)| here.value > most.value) {
                largest = Some((here, f, a.fractal_dimension));
            }
        }
    }
    let (name, paper) = ("largest k 1D over k 3D above F_bar = 0.086", [1.15, 1.30]);
    let mut claims = vec![match largest {
        Some((found, f, d)) => {
            Claim::judge(name, CROSSOVER, paper, found, format!("at F_bar = {f:.3}, D_f = {d:?}"))
        }
        None => Claim::unresolved(name, CROSSOVER, paper, "no load of the two models in common above 0.086"),
    }];
    for (a, b) in solid.series.iter().zip(&line.series) {
        let name = format!("F_bar of 90 % of the plateau, 1D over 3D, D_f = {:?}", a.fractal_dimension);
        let force = |measured: &Measured, s: &Series| {
            let at = |draw: &[usize]| force_at(s, 0.9 * measured.discretisation.complete_contact(), draw);
            let error = Bootstrap::default().standard_error(s.units.len(), at);
            Estimate::normal(at(&s.curves.all())?, error)
        };
        let paper = [0.0, 1.0];
        claims.push(match force(line, b).zip(force(solid, a)) {
            Some((line, solid)) => {
                Claim::judge(name, SOONER, paper, ratio(line, solid), "each of its own plateau")
            }
            None => Claim::unresolved(name, SOONER, paper, NO_LOAD),
        });
    }
    claims
}

/// Fig. 4: one master curve, on the line of Eq. 12.
pub(crate) fn collapse(solid: &Measured) -> Vec<Claim> {
    let curves = |draw: Option<&[usize]>| -> Option<Vec<Vec<CollapsePoint>>> {
        solid
            .series
            .iter()
            .map(|s| {
                let series = match draw {
                    Some(draw) => &s.redrawn(draw),
                    None => s,
                };
                Some(transformed(series).into_iter().filter(|p| !p.1).map(|p| p.0).collect())
            })
            .collect()
    };
    let top = FitWindow::PAPER.max_force_bar;
    let per_decade = std::f64::consts::LN_10;
    let factor = 1.5_f64.log10();
    let names = [
        "Fig. 4: rms scatter of log10 F_tilde between D_f, up to F_bar = 0.086",
        "Fig. 4: rms scatter of log10 F_tilde between D_f, up to F_bar = 20",
        "Fig. 4: rms distance of log10 F_tilde from Eq. 12, up to F_bar = 0.086",
    ];
    let papers = [[0.0, 0.1], [0.0, 0.1], [0.0, factor]];
    let surfaces = solid.series.first().map_or(0, |s| s.units.len());
    // Half a decade of points cannot show a collapse.
    let shown = laws(solid).iter().any(Result::is_ok);
    let estimate = |top: f64, pick: fn(&analysis::Residual) -> Option<f64>| {
        let of = |draw: Option<&[usize]>| Some(pick(&residual(&curves(draw)?, 0.0, top)?)? / per_decade);
        let error = Bootstrap { resamples: 100, ..Bootstrap::default() }
            .standard_error(surfaces, |draw| of(Some(draw)));
        Estimate::normal(of(None)?, error).filter(|_| shown)
    };
    let found = [estimate(top, |r| r.scatter), estimate(20.0, |r| r.scatter), estimate(top, |r| Some(r.rms))];
    let statements = [COLLAPSE, ALL_FORCES, ON_THE_LINE];
    let mut claims: Vec<Claim> = (names.into_iter().zip(papers).zip(statements).zip(found))
        .map(|(((name, paper), statement), found)| match found {
            Some(found) => {
                Claim::judge(name, statement, paper, found, "at least 10 contact cells on every surface")
            }
            None => Claim::unresolved(
                name,
                statement,
                paper,
                "no fractal dimension has a window of a decade or more, or one surface",
            ),
        })
        .collect();
    let name = "decades of F_bar over which Eq. 12 holds within a factor 1.5, best D_f";
    let (paper, cells) = ([3.0, f64::INFINITY], solid.discretisation.size());
    let each: Vec<(f64, f64)> = (solid.series.iter().zip(curves(None).unwrap_or_default()))
        .map(|(s, c)| (s.fractal_dimension, decades_within(&c, 1.5)))
        .collect();
    let words: Vec<String> = each.iter().map(|(d, decades)| format!("{decades:.2} at {d:?}")).collect();
    let words = words.join(", ");
    claims.push(match each.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some(&(_, decades)) if cells >= 2049 => {
            // Loads are a third of a decade apart.
            let found = Estimate { value: decades, half_width: 0.33 };
            let remark = format!("{words}; the interval is the distance of the loads");
            Claim::judge(name, DECADES, paper, found, remark)
        }
        Some(_) => {
            let reason = format!("{words}: {cells} cells a side, the claim is for 2049");
            Claim::unresolved(name, DECADES, paper, reason)
        }
        None => Claim::unresolved(name, DECADES, paper, "no curve"),
    });
    claims
}
