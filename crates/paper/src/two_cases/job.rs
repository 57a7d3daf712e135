//! One surface of one case, as a job that is stored.

use super::study::{CaseSolve, Solves, SurfaceCase, TwoCases};
use analysis::StiffnessSample;
use bem3d::Bem3d;
use contact_model::{ContactModel as _, ContactState, Stop};
use evaluation::{Discretisation, RealisationJob};
use runs::{Error, Job, Result, ResultKind};
use std::sync::Arc;

/// Number of the format of stored solves. Raise it when [`CaseSolve`] changes, or the meaning of its numbers.
const FORMAT: u32 = 2;

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

    const KIND: ResultKind = ResultKind::new("two cases", FORMAT);

    fn key(&self) -> String {
        let Self { study, case, seed } = self;
        let forces: Vec<String> = study.forces.values().iter().map(|f| format!("{f:?}")).collect();
        format!(
            "model bem3d\nmodel_format {}\ncells {}\ntolerance {:?}\nboundary {:?}\nfractal_dimension {:?}\n\
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
        let job = RealisationJob {
            discretisation: self.discretisation(),
            fractal_dimension: self.case.fractal_dimension,
            index: 0,
            seed: self.seed,
            forces: self.study.forces.values().into(),
            models: Arc::default(),
        };
        job.cost()
    }

    fn memory(&self) -> f64 {
        self.discretisation().memory()
    }

    fn stored_bytes(&self) -> u64 {
        1000 + 120 * self.study.forces.values().len() as u64
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

    fn is_whole(&self, solves: &Solves) -> bool {
        solves.len() == self.study.forces.values().len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evaluation::Forces;

    #[test]
    fn solves_come_back_bit_for_bit_and_damage_does_not() {
        let study = TwoCases {
            cells: 64,
            cells_per_wave: 8,
            surfaces: 1,
            fractal_dimensions: vec![2.2],
            roll_offs: Vec::new(),
            forces: Forces::parse("0.1,1,10,20").unwrap(),
            tolerance: 1e-3,
            seed: 1,
            threads: 1,
        };
        let case = study.cases()[0];
        let job = CaseJob { study: Arc::new(study), case, seed: 1 };
        let sample = |stiffness_bar, contact_cells| StiffnessSample { stiffness_bar, contact_cells };
        let solves = vec![
            CaseSolve::StiffnessSample(sample(0.1 + 0.2, Some(12)), 5e-324),
            CaseSolve::StiffnessSample(sample(1e308, None), -0.0),
            CaseSolve::NotConverged,
            CaseSolve::FullContact,
        ];
        let text = CaseJob::KIND.encode(&solves);
        let back = job.decode(&text).unwrap();
        // The text holds every bit, the sign of a zero too.
        assert_eq!(CaseJob::KIND.encode(&back), text);
        assert_eq!(back, solves);
        for cut in 0..text.len() {
            assert_eq!(job.decode(&text[..cut]), None, "{cut} bytes");
        }
        let nan = CaseSolve::StiffnessSample(sample(f64::NAN, None), 1.0);
        for other in [solves[1..].to_vec(), [&solves[..], &solves[..1]].concat(), vec![nan; 4]] {
            assert_eq!(job.decode(&CaseJob::KIND.encode(&other)), None);
        }
    }
}
