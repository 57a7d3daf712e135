//! The claims of the paper: the table `claims.toml`, and how its entries become [`Claim`]s.
//!
//! An entry names its data ([`Data`]), which give [`ClaimRow`]s: one for each D_f, or a single one. The verdict
//! follows from the interval of the row and from what the entry allows ([`Claim::judge`],
//! [`Claim::in_convention`]); the rows of one statement are judged together ([`crate::together`]). Identities
//! that only test code (Eqs. 7, 19 to 23, full contact of a line) are tests, not claims. Area over force is
//! judged where waves are resolved: [`crate::two_cases`].

mod curves;
mod ensemble;
mod laws;
mod solved;
mod table;

use crate::claim::Claim;
use crate::evaluation::{EnsembleModel, Measured};
use runs::Result;
use table::wrong;

pub(crate) use ensemble::{Ensembles, SeriesLaw};
pub(crate) use table::{CaseData, Cases, ClaimEntry, ClaimRow, ClaimedNumber, Data, entries};

/// The commands whose claims `verify` judges, in the order of its table.
pub(crate) const VERIFIED: [&str; 6] = ["fig3", "fig7", "fig4", "fig2", "fig6", "verify"];

/// Judges the claims of a command by its numbers.
///
/// # Errors
/// Errors of solves for a claim alone; an ensemble that the command does not have.
pub(crate) fn judged(command: &str, ensembles: &Ensembles<'_>) -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for group in entries(command)?.chunk_by(|_, next| next.alternates) {
        let mut found = Vec::new();
        for entry in group {
            found.extend(rows(ensembles, entry)?.into_iter().map(|row| (entry, row)));
        }
        // The entries of a group take turns.
        found.sort_by(|a, b| a.1.fractal_dimension.total_cmp(&b.1.fractal_dimension));
        let concerned = found.into_iter().filter(|(entry, row)| entry.speaks_of(row.fractal_dimension));
        claims.extend(concerned.map(|(entry, row)| entry.judge(row)));
    }
    Ok(claims)
}

/// The numbers that an entry of the table is compared with.
///
/// # Errors
/// Errors of a solver; an ensemble that the command does not have.
fn rows(ensembles: &Ensembles<'_>, entry: &'static ClaimEntry) -> Result<Vec<ClaimRow>> {
    let solid = || ensembles.of(EnsembleModel::Bem3d);
    let line = || ensembles.of(EnsembleModel::Mdr1d);
    Ok(match &entry.data {
        Data::Exponent(model) => laws::exponents(ensembles.of(*model)?),
        Data::ExponentOverDimension(model) => laws::over_dimension(ensembles.of(*model)?),
        Data::ExponentOverForcesOfSurfaces => laws::exponents_over_same_forces(line()?),
        Data::ExponentDifference => laws::differences(solid()?, line()?),
        Data::ExponentOfHalves(model) => laws::halves(ensembles.of(*model)?),
        Data::ExponentBelowMinusAbove(from, middle) => laws::below_minus_above(line()?, *from, *middle),
        Data::Factor => laws::factors(solid()?),
        Data::ForceWhereLawsMeet => laws::meeting_point(solid()?, |point| point.force_bar),
        Data::StiffnessWhereLawsMeet => laws::meeting_point(solid()?, |point| point.stiffness_bar),
        Data::FarthestRatioOfFactors => laws::ratio_of_factors(solid()?, line()?),
        Data::FarthestDistanceOfFactors => laws::distance_of_factors(solid()?, line()?),
        Data::ScatterOfCollapse(top) => curves::collapse(solid()?, *top, |residual| residual.scatter),
        Data::DistanceFromCollapse(top) => curves::collapse(solid()?, *top, |residual| Some(residual.rms)),
        Data::DecadesOfCollapse(factor) => curves::decades(solid()?, *factor),
        Data::StiffnessAt(load) => curves::stiffnesses(solid()?, *load)?,
        Data::Spread(load, other) => curves::spread(solid()?, *load, *other),
        Data::StiffnessOverLaw(load) => laws::stiffness_over_law(solid()?, *load),
        Data::ConductanceAt(load) => curves::conductance(solid()?, *load),
        Data::ForceAtPlateauShare(model, share) => curves::force_at_share(ensembles.of(*model)?, *share),
        Data::AreaAtPlateauShare(share) => curves::area_at_share(solid()?, *share),
        Data::RatioOfForcesAtPlateauShare(share) => curves::sooner(solid()?, line()?, *share)?,
        Data::ChangeWithTheGrid => curves::change_with_grid(solid()?),
        Data::ChangeOverScatter(load) => curves::change_over_scatter(solid()?, *load),
        Data::LargestRatio(from, to) => curves::largest_ratio(solid()?, line()?, *from..=*to)?,
        Data::ChangeOfRatio => curves::change_of_ratio(solid()?, line()?)?,
        Data::FarthestRatio => curves::farthest_ratio(solid()?, line()?)?,
        Data::Plateau => solved::plateau()?,
        Data::RatioOfPlateaus => solved::ratio_of_plateaus()?,
        Data::ShareInOneRegion(dimensions) => solved::share_in_one_region(dimensions)?,
        Data::ContactLengthOverDiameters => solved::length_over_diameters()?,
        Data::RatioOfHeights(dimensions) => solved::ratio_of_heights(dimensions)?,
        Data::RunTimes => curves::run_times(solid()?, line()?),
        Data::NotJudged(reason) => ClaimRow::only(Err(reason.as_str().into())),
        Data::TwoCases(_) => {
            return Err(wrong(&format!("{}: the study of the two problems judges it", entry.id)));
        }
    })
}

/// Judges the claims of the figure of a command by these ensembles.
///
/// # Errors
/// As [`judged`].
pub(crate) fn of_figure(command: &str, measured: &[&Measured]) -> Result<Vec<Claim>> {
    judged(command, &Ensembles::new(measured))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::{Request, Run, Session};
    use crate::fitted::both;
    use runs::Silent;
    use std::collections::BTreeSet;

    #[test]
    fn every_entry_is_judged_by_its_command() {
        let commands = VERIFIED.into_iter().chain(["two_cases"]);
        let ids = commands.clone().flat_map(|command| entries(command).unwrap()).map(|entry| &entry.id);
        let (ids, count) = (ids.clone().collect::<BTreeSet<_>>(), ids.count());
        assert_eq!(ids.len(), count);
        assert_eq!(table::commands(), commands.collect::<BTreeSet<_>>());
        // The study of the two problems judges its entries, the ensembles all others.
        for command in VERIFIED.into_iter().chain(["two_cases"]) {
            for entry in entries(command).unwrap() {
                let of_cases = matches!(entry.data, Data::TwoCases(_));
                assert_eq!(of_cases, command == "two_cases", "{}", entry.id);
            }
        }
        let dir = tempfile::tempdir().unwrap();
        let request = Request {
            cells: Some(17),
            surfaces: Some(2),
            elements: Some(256),
            lines: Some(3),
            fractal_dimensions: Some(vec![2.0, 2.6, 3.0]),
            forces: Some("1e-3:20:5,0.086".to_owned()),
            out: Some(dir.path().to_owned()),
            ..Request::default()
        };
        let run = Run::new(&request).unwrap();
        let store = Session::open(&run.out, run.fresh).unwrap().store;
        let [solid, line] = both(&run, &store, &Silent).unwrap();
        // Of small ensembles, so that most have no number; the others are solved for the comparison alone.
        let ensembles = Ensembles::new(&[&solid, &line]);
        for entry in VERIFIED[..5].iter().flat_map(|command| entries(command).unwrap()) {
            let rows = rows(&ensembles, entry).unwrap();
            let judged = rows.into_iter().filter(|row| entry.speaks_of(row.fractal_dimension)).count();
            // A distance of factors has no row of its own where their ratio has no number.
            assert!(judged > 0 || matches!(entry.data, Data::FarthestDistanceOfFactors), "{}", entry.id);
        }
    }
}
