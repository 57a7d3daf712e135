//! One surface of one case, as a job that is stored.

use super::study::{CaseSolve, Solves, SurfaceCase, TwoCases};
use analysis::StiffnessSample;
use bem3d::Bem3d;
use contact_model::{ContactModel as _, ContactState, Stop};
use evaluation::{Discretisation, Realisation};
use runs::{Error, Job, Result, number};
use std::sync::Arc;

/// Raised when the meaning of the stored lines changes.
const FORMAT: u32 = 1;

/// One surface of one case under all loads.
#[derive(Debug, Clone)]
pub(super) struct CaseJob {
    pub(super) study: Arc<TwoCases>,
    pub(super) case: SurfaceCase,
    pub(super) seed: u64,
}

impl CaseJob {
    // A periodic square takes no more than a free one.
    pub(super) fn discretisation(&self) -> Discretisation {
        Discretisation::Bem3d { cells: self.study.cells, tolerance: self.study.tolerance }
    }
}

impl Job for CaseJob {
    type Output = Solves;
    type Error = Error;

    fn key(&self) -> String {
        let Self { study, case, seed } = self;
        let forces: Vec<String> = study.forces.values().iter().map(|f| format!("{f:?}")).collect();
        format!(
            "two cases {FORMAT}\nmodel bem3d\nmodel_format {}\ncells {}\ntolerance {:?}\nboundary {:?}\nfractal_dimension {:?}\n\
             roll_off {:?}\nshortest {:?}\nseed {seed}\nforce_bar {}\n",
            bem3d::FORMAT,
            study.cells,
            study.tolerance,
            case.boundary,
            case.fractal_dimension,
            case.roll_off,
            study.shortest(),
            forces.join(" "),
        )
    }

    fn name(&self) -> String {
        format!("{}, {} cells a side, seed {}", self.case.label(), self.study.cells, self.seed)
    }

    // Free squares are those of Fig. 2, and periodic ones take about as long.
    fn cost(&self) -> u64 {
        let unit = Realisation {
            discretisation: self.discretisation(),
            fractal_dimension: self.case.fractal_dimension,
            index: 0,
            seed: self.seed,
            forces: self.study.forces.values().into(),
        };
        unit.cost()
    }

    fn memory(&self) -> f64 {
        self.discretisation().memory()
    }

    fn stored_bytes(&self) -> u64 {
        1000 + 60 * self.study.forces.values().len() as u64
    }

    fn solve(&self, stop: Stop<'_>) -> Result<Solves> {
        let mut scene = self.case.scene(&self.study)?;
        scene.outputs.area = true;
        let model = Bem3d { cells: self.study.cells, tolerance: self.study.tolerance, ..Bem3d::default() };
        let mut solves = Vec::new();
        let mut solve = || {
            let mut contact = model.prepare(&scene, self.seed)?;
            let normalisation = contact.normalisation();
            contact.sweep(&normalisation.loads(self.study.forces.values())?, stop, &mut |_, state| {
                solves.push(match state {
                    Err(contact_model::Error::NotConverged { .. }) => CaseSolve::NotConverged,
                    Err(error) => return Err(error),
                    Ok(ContactState { stiffness: Some(k), area: Some(area), report, .. }) => {
                        let stiffness_bar = normalisation.stiffness_bar(k);
                        let sample = StiffnessSample { stiffness_bar, contact_cells: report.contact_cells };
                        CaseSolve::StiffnessSample(sample, area)
                    }
                    Ok(_) => CaseSolve::FullContact,
                });
                Ok(())
            })
        };
        solve().map_err(Error::model(format!("bem3d ({}, seed {})", self.case.label(), self.seed)))?;
        Ok(solves)
    }

    fn encode(&self, solves: &Solves) -> String {
        let line = |solve: &CaseSolve| match solve {
            CaseSolve::StiffnessSample(sample, area) => {
                let cells = sample.contact_cells.map_or_else(|| "-".to_owned(), |n| n.to_string());
                format!("{} {} {cells}\n", number(sample.stiffness_bar), number(*area))
            }
            CaseSolve::FullContact => "full contact\n".to_owned(),
            CaseSolve::NotConverged => "not converged\n".to_owned(),
        };
        solves.iter().map(line).collect()
    }

    fn decode(&self, text: &str) -> Option<Solves> {
        let finite = |word: &str| word.parse::<f64>().ok().filter(|v| v.is_finite());
        let solve = |line: &str| match line {
            "full contact" => Some(CaseSolve::FullContact),
            "not converged" => Some(CaseSolve::NotConverged),
            _ => {
                let mut words = line.split(' ');
                let (stiffness_bar, area) = (finite(words.next()?)?, finite(words.next()?)?);
                let contact_cells = match words.next()? {
                    "-" => None,
                    count => Some(count.parse().ok()?),
                };
                let sample = StiffnessSample { stiffness_bar, contact_cells };
                words.next().is_none().then_some(CaseSolve::StiffnessSample(sample, area))
            }
        };
        let solves: Solves = text.lines().map(solve).collect::<Option<_>>()?;
        (solves.len() == self.study.forces.values().len()).then_some(solves)
    }
}
