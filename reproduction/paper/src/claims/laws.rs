//! Numbers of the fitted power laws: alpha, zeta, where the laws meet, how straight the curves are.

use super::ensemble::{EnsembleLaws, ONE_SURFACE, SeriesLaw, law_of, resampled};
use super::table::{ClaimRow, ClaimedNumber, Reason};
use crate::claim::Estimate;
use crate::evaluation::{FLOOR_CELLS, Series, laws};
use analysis::{Bootstrap, Crossing, FitWindow, crossing, interpolate, sum};

/// The sources of error in the intervals of exponents, in words.
const INTERVAL: &str = "the interval holds scatter, floors of 10, 30 and 100 cells, upper ends of 0.086 and 0.03, and the remaining discretisation error";

pub(super) fn exponents(ensemble: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    ensemble.each_law(|_, law| Ok((law.alpha, format!("{}; {INTERVAL}", law.window()))))
}

pub(super) fn factors(ensemble: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    let conditions = "F_bar counts the measured rms height; the interval holds scatter and window";
    ensemble.each_law(|_, law| Ok((law.zeta, format!("{}; {conditions}", law.window()))))
}

/// alpha of lines over the forces of surfaces, with alpha over the lines' own forces in the remark.
pub(super) fn exponents_over_same_forces(line: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    (line.measured.series.iter().zip(&line.laws).zip(&line.same_forces))
        .map(|((series, own), law)| {
            let remark = |law: &SeriesLaw| {
                let own = own.as_ref().map(|own| {
                    let Estimate { value, half_width } = own.alpha;
                    format!("; {value:.3} +- {half_width:.3} over {}", own.window())
                });
                format!("{}: the forces of surfaces; {INTERVAL}{}", law.window(), own.unwrap_or_default())
            };
            let law = law.as_ref().map_err(Reason::clone);
            ClaimRow::at(series.fractal_dimension, law.map(|law| (law.alpha, remark(law))))
        })
        .collect()
}

/// alpha of lines minus alpha of surfaces, both over the same forces.
pub(super) fn differences(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    (solid.measured.series.iter().zip(&solid.laws).zip(&line.same_forces))
        .map(|((series, solid), line)| {
            let both = || {
                let (solid, line) = (solid.as_ref()?, line.as_ref()?);
                let remark = format!(
                    "both over the same forces, 3D {}; 1D {}; {INTERVAL}",
                    solid.window(),
                    line.window()
                );
                Ok((line.alpha.minus(solid.alpha), remark))
            };
            ClaimRow::at(series.fractal_dimension, both().map_err(Reason::clone))
        })
        .collect()
}

/// alpha over D_f, with the own window of each D_f and with the window that all have in common.
pub(super) fn over_dimension(ensemble: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    let own: Result<Vec<&SeriesLaw>, &Reason> = ensemble.laws.iter().map(Result::as_ref).collect();
    let own = match own {
        Ok(own) if own.len() >= 3 => own,
        Ok(_) => return ClaimRow::only(Err("at least three fractal dimensions are needed".into())),
        Err(reason) => return ClaimRow::only(Err(reason.clone())),
    };
    // Through the origin: sum D alpha / sum D^2.
    let square = sum(own.iter().map(|l| l.fractal_dimension.powi(2)));
    let through =
        |alphas: &[f64]| sum(own.iter().zip(alphas).map(|(l, alpha)| l.fractal_dimension * alpha)) / square;
    // All D_f share phases: they are redrawn together.
    let slope = |windows: &[FitWindow], draw: &[usize]| -> Option<f64> {
        let alpha = |(s, w): (&Series, &FitWindow)| Some(law_of(&s.curves, w, draw)?.alpha);
        let alphas: Option<Vec<f64>> = ensemble.measured.series.iter().zip(windows).map(alpha).collect();
        Some(through(&alphas?))
    };
    // The remaining discretisation error has one sign for all D_f: it adds up.
    let grid = through(&own.iter().map(|l| l.grid).collect::<Vec<_>>());
    let lowest = own.iter().map(|l| l.fit.force_bar_min).fold(0.0, f64::max);
    let everywhere = |window: FitWindow| vec![window; own.len()];
    let floor = |min_contact_cells| everywhere(FitWindow { min_contact_cells, ..FitWindow::PAPER });
    let each = own.iter().map(|l| l.loads()).collect();
    let lower = own.iter().map(|l| FitWindow::between(l.fit.force_bar_min, 0.03)).collect();
    let common = everywhere(FitWindow::between(lowest, FitWindow::PAPER.max_force_bar));
    let ways = [
        (", each D_f's own window".to_owned(), each, vec![floor(30), floor(100), lower]),
        (
            format!(", F_bar from {lowest:.1e} to 0.086"),
            common,
            vec![everywhere(FitWindow::between(lowest, 0.03))],
        ),
    ];
    let all: Vec<usize> = (0..ensemble.surfaces()).collect();
    let row = |(words, windows, others): (String, Vec<FitWindow>, Vec<Vec<FitWindow>>)| {
        let found = resampled(all.len(), |draw| slope(&windows, draw)).map(|found| {
            let moved = others.iter().filter_map(|other| Some((slope(other, &all)? - found.value).abs()));
            (found.widened(moved.fold(0.0, f64::max)).widened(grid), INTERVAL.to_owned())
        });
        ClaimRow::of(words, found.ok_or(ONE_SURFACE.into()))
    };
    ways.into_iter().map(row).collect()
}

/// alpha of the upper half of the window minus that of the lower half.
pub(super) fn halves(ensemble: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    ensemble.each_law(|series, law| {
        let middle = (law.fit.force_bar_min * law.fit.force_bar_max).sqrt();
        let above_floor =
            |window| FitWindow { min_contact_cells: FitWindow::PAPER.min_contact_cells, ..window };
        let upper = above_floor(FitWindow::between(middle, law.fit.force_bar_max));
        let lower = above_floor(FitWindow::between(law.fit.force_bar_min, middle));
        let found = resampled(series.realisations.len(), |draw| {
            let alpha = |window| Some(law_of(&series.curves, window, draw)?.alpha);
            Some(alpha(&upper)? - alpha(&lower)?)
        });
        let window = law.window();
        let remark = format!("{window}, halves at {middle:.1e}; the interval holds the scatter; this grid");
        Ok((found.ok_or("fewer than three loads in a half")?, remark))
    })
}

/// alpha from the first load to the second minus alpha above the second.
pub(super) fn below_minus_above(line: &EnsembleLaws<'_>, from: f64, middle: f64) -> Vec<ClaimRow> {
    let low = FitWindow { min_force_bar: from * (1.0 - 1e-9), max_force_bar: middle, ..FitWindow::PAPER };
    let high = FitWindow { min_force_bar: middle, ..FitWindow::PAPER };
    let both = laws(line.measured, &low).into_iter().zip(laws(line.measured, &high));
    both.zip(&line.measured.series)
        .map(|((below, above), series)| {
        let too_few = |load: f64| {
            format!("every line has {FLOOR_CELLS} elements in contact only from {load:.1e} on: more elements reach {from:e}")
        };
        let found = || -> ClaimedNumber {
            let (Ok(a), Ok(b)) = (&below, &above) else { return Err(too_few(middle).into()) };
            // Two loads a decade at least: the first of them lies within a factor 2.2.
            if a.force_bar_min > 2.2 * from {
                return Err(too_few(a.force_bar_min).into());
            }
            let below = Estimate::normal(a.alpha, a.alpha_se).ok_or("one line has no scatter")?;
            let above = Estimate::normal(b.alpha, b.alpha_se).ok_or("one line has no scatter")?;
            let (first, low, high) = (a.force_bar_min, a.alpha, b.alpha);
            let remark = format!("{low:.3} from {first:.1e} to {middle:e}, {high:.3} above");
            Ok((below.minus(above), remark))
        };
        ClaimRow::at(series.fractal_dimension, found())
    })
    .collect()
}

/// k_bar over the fitted law at a load above its window.
pub(super) fn stiffness_over_law(ensemble: &EnsembleLaws<'_>, load: f64) -> Vec<ClaimRow> {
    ensemble.each_law(|series, law| {
        // Law and stiffness of the same draw; the loads of the fit stay.
        let over = |window: &FitWindow, draw: &[usize]| {
            let fit = law_of(&series.curves, window, draw)?;
            let k = interpolate(series.curves.force_bar(), &series.curves.mean_of(draw), load)?;
            Some(k / (fit.zeta * load.powf(fit.alpha)))
        };
        let window = law.loads();
        let middle = (law.fit.force_bar_min * law.fit.force_bar_max).sqrt();
        let upper_half = FitWindow { min_force_bar: middle, ..window };
        let found =
            resampled(series.realisations.len(), |draw| over(&window, draw)).ok_or(super::curves::NO_LOAD)?;
        let moved = over(&upper_half, &series.curves.all()).map_or(0.0, |other| (other - found.value).abs());
        let remark = format!(
            "{}; the interval holds the scatter and the law of the upper half of its window",
            law.window()
        );
        Ok((found.widened(moved), remark))
    })
}

/// zeta of lines over zeta of surfaces, both over the same forces, at the D_f where the two differ most.
fn farthest_factors(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>) -> Option<(Estimate, String)> {
    let ratios = solid.laws.iter().zip(&line.same_forces).filter_map(|(solid, line)| {
        let (solid, line) = (solid.as_ref().ok()?, line.as_ref().ok()?);
        Some((line.zeta.over(solid.zeta), solid.fractal_dimension))
    });
    let farthest = ratios.max_by(|a, b| a.0.distance_from_one().total_cmp(&b.0.distance_from_one()));
    farthest.map(|(ratio, d)| (ratio, format!("at D_f = {d:?}")))
}

pub(super) fn ratio_of_factors(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    let found = farthest_factors(solid, line);
    ClaimRow::only(found.ok_or("no fractal dimension has two fits over a decade or more".into()))
}

/// The distance of that ratio from 1, where there is one.
pub(super) fn distance_of_factors(solid: &EnsembleLaws<'_>, line: &EnsembleLaws<'_>) -> Vec<ClaimRow> {
    let distance = |ratio: Estimate| Estimate { value: (ratio.value - 1.0).abs(), ..ratio };
    let found = farthest_factors(solid, line);
    found.into_iter().flat_map(|(ratio, remark)| ClaimRow::only(Ok((distance(ratio), remark)))).collect()
}

/// Where the fitted laws of all fractal dimensions meet.
pub(super) fn meeting_point(solid: &EnsembleLaws<'_>, pick: fn(&Crossing) -> f64) -> Vec<ClaimRow> {
    let used: Vec<(&Series, &SeriesLaw)> = (solid.measured.series.iter().zip(&solid.laws))
        .filter_map(|(s, law)| Some((s, law.as_ref().ok()?)))
        .collect();
    let laws: Vec<(f64, f64)> = used.iter().map(|(_, l)| (l.fit.alpha, l.fit.zeta)).collect();
    let found = || -> ClaimedNumber {
        let Some(here) = crossing(&laws).filter(|_| laws.len() >= 3) else {
            let count = laws.len();
            let reason =
                format!("{count} fractal dimensions have a fit over a decade or more: three are needed");
            return Err(reason.into());
        };
        // All fractal dimensions are resampled with the same surfaces: they share phases. The forces of each
        // fit stay.
        let error = Bootstrap::default().half_width(solid.surfaces(), |draw| {
            let law = |(s, l): &(&Series, &SeriesLaw)| {
                law_of(&s.curves, &l.loads(), draw).map(|l| (l.alpha, l.zeta))
            };
            let drawn: Option<Vec<(f64, f64)>> = used.iter().map(law).collect();
            crossing(&drawn?).map(|c| pick(&c))
        });
        // Lines that meet at a small angle: the point moves with each law that is left out.
        let without =
            (0..laws.len()).filter_map(|leave| crossing(&[&laws[..leave], &laws[leave + 1..]].concat()));
        let moved = without.map(|c| (pick(&c) - pick(&here)).abs()).fold(0.0, f64::max);
        let scatter = Estimate::normal(pick(&here), error).ok_or(ONE_SURFACE)?;
        let remark = format!(
            "{} laws, least spread of ln k_bar {:.3}; the lines meet at a small angle; the interval holds the scatter and what leaving out one D_f changes",
            laws.len(),
            here.spread
        );
        Ok((scatter.widened(moved), remark))
    };
    ClaimRow::only(found())
}
