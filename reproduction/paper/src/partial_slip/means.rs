//! Means over surfaces, with their 95 % intervals.

use super::study::{
    AMPLITUDES, PartialSlipStudy, SHARES, SlipCase, SlipPoint, SlippedSurface, SurfaceSlips, mindlin,
};
use crate::claim::Estimate;
use analysis::Multilevel;

/// Surfaces of a case, solved.
#[derive(Clone, Copy)]
pub(super) struct SolvedCase<'a> {
    pub(super) case: SlipCase,
    pub(super) surfaces: &'a [SurfaceSlips],
}

/// Ratio of tangential to normal stiffness in full stick, over Mindlin's ratio.
pub(super) struct StiffnessRow {
    pub(super) case: SlipCase,
    pub(super) force_bar: f64,
    pub(super) poisson: f64,
    /// Share of the square in contact.
    pub(super) contact: Option<Estimate>,
    pub(super) min_contact_cells: usize,
    /// The ratio for the mean of both directions.
    pub(super) ratio: Option<Estimate>,
    pub(super) along_x: Option<Estimate>,
    pub(super) along_y: Option<Estimate>,
    /// Difference of the largest and the smallest stiffness over directions, over their mean.
    pub(super) anisotropy: Option<Estimate>,
    pub(super) surfaces: usize,
    pub(super) left_out: usize,
}

/// A state of first loading, and the errors of the approximations: approximation over solution less 1, for
/// each surface.
pub(super) struct SlipRow {
    pub(super) case: SlipCase,
    pub(super) force_bar: f64,
    pub(super) poisson: f64,
    pub(super) share: f64,
    pub(super) displacement: Option<Estimate>,
    pub(super) stick: Option<Estimate>,
    pub(super) stiffness: Option<Estimate>,
    /// Rms difference of tractions from those of Ciavarella and Jaeger.
    pub(super) traction_miss: Option<Estimate>,
    pub(super) displacement_miss: Option<Estimate>,
    pub(super) stick_miss: Option<Estimate>,
    pub(super) profile_displacement_miss: Option<Estimate>,
    pub(super) profile_stick_miss: Option<Estimate>,
    pub(super) surfaces: usize,
}

/// Loops of one amplitude.
pub(super) struct LoopRow {
    pub(super) case: SlipCase,
    pub(super) force_bar: f64,
    pub(super) poisson: f64,
    pub(super) amplitude: f64,
    pub(super) dissipated: Option<Estimate>,
    pub(super) miss: Option<Estimate>,
    pub(super) profile_miss: Option<Estimate>,
    pub(super) surfaces: usize,
}

/// Mean and half-width by Student's distribution; `None` for fewer than two values.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<Estimate> {
    let curves = values.map(|value| vec![value]).collect();
    let of = Multilevel::new(vec![curves]).ok()?;
    let value = of.means(1)[0];
    Some(Estimate { value, half_width: of.propagated(value, &[1.0]).half_width() })
}

/// Over Mindlin's ratio: the mean of both directions, along x, along y; and the anisotropy.
fn ratios(slipped: &SlippedSurface, poisson: f64) -> [f64; 4] {
    let [xx, yy, xy] = slipped.stiffness;
    let mindlin = mindlin(poisson);
    let middle = 0.5 * (xx + yy);
    [middle / mindlin, xx / mindlin, yy / mindlin, (xx - yy).hypot(2.0 * xy) / middle]
}

/// Loads and Poisson's ratios with their indices.
fn places(study: &PartialSlipStudy) -> impl Iterator<Item = ((usize, f64), (usize, f64))> + '_ {
    let forces = study.forces.values().iter().copied().enumerate();
    forces.flat_map(|force| study.poissons.iter().copied().enumerate().map(move |nu| (force, nu)))
}

pub(super) fn stiffness(study: &PartialSlipStudy, solved: &[SolvedCase<'_>]) -> Vec<StiffnessRow> {
    let mut rows = Vec::new();
    for &SolvedCase { case, surfaces } in solved {
        for ((j, force_bar), (i, poisson)) in places(study) {
            let found: Vec<&SlippedSurface> = surfaces.iter().filter_map(|s| s.at(study, j, i)).collect();
            let of = |which: usize| mean(found.iter().map(|s| ratios(s, poisson)[which]));
            rows.push(StiffnessRow {
                case,
                force_bar,
                poisson,
                contact: mean(found.iter().map(|s| s.contact)),
                min_contact_cells: found.iter().map(|s| s.contact_cells).min().unwrap_or(0),
                ratio: of(0),
                along_x: of(1),
                along_y: of(2),
                anisotropy: of(3),
                surfaces: found.len(),
                left_out: surfaces.len() - found.len(),
            });
        }
    }
    rows
}

/// An approximation compared with the solution of each surface.
fn missed(pairs: impl Iterator<Item = [Option<f64>; 2]>) -> Option<Estimate> {
    let both = pairs.filter_map(|[approximation, solution]| Some(approximation? / solution? - 1.0));
    mean(both.filter(|miss| miss.is_finite()))
}

pub(super) fn slips(study: &PartialSlipStudy, solved: &[SolvedCase<'_>]) -> Vec<SlipRow> {
    let mut rows = Vec::new();
    for &SolvedCase { case, surfaces } in solved.iter().filter(|s| s.case.is_free()) {
        for ((j, force_bar), (i, poisson)) in places(study) {
            for (n, share) in SHARES.into_iter().enumerate() {
                let point = |s: &SurfaceSlips, i: usize| s.at(study, j, i)?.points.get(n).copied();
                let profile = |s: &SurfaceSlips| s.equivalent.get(j)?.as_ref()?.0.get(n).copied();
                let all = || surfaces.iter().filter_map(|s| point(s, i));
                let miss = |of: fn(SlipPoint) -> f64,
                            approximation: &dyn Fn(&SurfaceSlips) -> Option<f64>| {
                    let solution = |s: &SurfaceSlips| point(s, i).map(of);
                    missed(surfaces.iter().map(|s| [approximation(s), solution(s)]))
                };
                let [displacement, stick]: [fn(SlipPoint) -> f64; 2] = [|p| p.displacement, |p| p.stick];
                rows.push(SlipRow {
                    case,
                    force_bar,
                    poisson,
                    share,
                    displacement: mean(all().map(displacement)),
                    stick: mean(all().map(stick)),
                    stiffness: mean(all().filter_map(|p| p.stiffness)),
                    traction_miss: mean(all().filter_map(|p| p.traction)),
                    // Bodies without Poisson's ratio: that solution is Ciavarella and Jaeger's.
                    displacement_miss: miss(displacement, &|s| point(s, 0).map(displacement)),
                    stick_miss: miss(stick, &|s| point(s, 0).map(stick)),
                    profile_displacement_miss: miss(displacement, &|s| profile(s).map(displacement)),
                    profile_stick_miss: miss(stick, &|s| profile(s).map(stick)),
                    surfaces: all().count(),
                });
            }
        }
    }
    rows
}

pub(super) fn loops(study: &PartialSlipStudy, solved: &[SolvedCase<'_>]) -> Vec<LoopRow> {
    let mut rows = Vec::new();
    for &SolvedCase { case, surfaces } in solved.iter().filter(|s| s.case.is_free()) {
        for ((j, force_bar), (i, poisson)) in places(study) {
            for (n, amplitude) in AMPLITUDES.into_iter().enumerate() {
                let solution = |s: &SurfaceSlips, i: usize| s.at(study, j, i)?.dissipated.get(n).copied();
                let profile = |s: &SurfaceSlips| s.equivalent.get(j)?.as_ref()?.1.get(n).copied();
                let miss = |approximation: &dyn Fn(&SurfaceSlips) -> Option<f64>| {
                    missed(surfaces.iter().map(|s| [approximation(s), solution(s, i)]))
                };
                rows.push(LoopRow {
                    case,
                    force_bar,
                    poisson,
                    amplitude,
                    dissipated: mean(surfaces.iter().filter_map(|s| solution(s, i))),
                    miss: miss(&|s| solution(s, 0)),
                    profile_miss: miss(&profile),
                    surfaces: surfaces.iter().filter(|s| solution(s, i).is_some()).count(),
                });
            }
        }
    }
    rows
}
