//! The header of every CSV about ensembles: the paper, the command, the ensembles.

use crate::evaluation::measured::Measured;
use crate::evaluation::realisation::{Discretisation, EnsembleModel};
use crate::evaluation::run::{Flag, Run, list};
use runs::Header;

/// The paper that this project reproduces.
pub const PAPER: &str = "R. Pohrt, V. L. Popov, A. E. Filippov, Normal contact stiffness of elastic solids with fractal rough \
     surfaces for one- and three-dimensional systems, Phys. Rev. E 86, 026710 (2012)";

/// A header with the paper as its first source.
pub fn header(command: String) -> Header {
    Header { sources: vec![PAPER.to_owned()], ..Header::new(command) }
}

/// The flags on which the results of an ensemble of a model depend.
pub const fn flags(model: EnsembleModel) -> &'static [Flag] {
    const BEM3D: [Flag; 6] =
        [Flag::CELLS, Flag::SURFACES, Flag::FRACTAL_DIMENSIONS, Flag::FORCES, Flag::TOLERANCE, Flag::SEED];
    const MDR1D: [Flag; 5] =
        [Flag::ELEMENTS, Flag::LINES, Flag::FRACTAL_DIMENSIONS, Flag::FORCES, Flag::SEED];
    match model {
        EnsembleModel::Bem3d => &BEM3D,
        EnsembleModel::Mdr1d => &MDR1D,
    }
}

/// Header lines about an ensemble.
pub fn describe(mut header: Header, run: &Run, measured: &[&Measured]) -> Header {
    header = header
        .with_note("normalisation: F_bar = F/(E* h L) with the measured rms height h of each surface, k_bar = k/(1.1419 E* L)")
        .with_note("surfaces: fixed amplitudes, uniform phases, no roll-off, spectrum to the end of the grid on a circle")
        .with_note(format!("fractal_dimensions: {}", list(&run.dimensions())))
        .with_note(format!("seed: {} (surface i: surface_seed(seed, i); D_f does not enter)", run.seed));
    for m in measured {
        let size = match m.discretisation {
            Discretisation::Bem3d { cells, tolerance } => {
                format!("{cells} cells a side, tolerance {tolerance:?}")
            }
            Discretisation::Mdr1d { elements } => format!("{elements} elements"),
        };
        let (_, count, forces) = run.ensemble(m.discretisation.of());
        header = header
            .with_sources(m.discretisation.sources())
            .with_note(format!(
                "{}: {size}, {count} surfaces per D_f, loads {}",
                m.discretisation.name(),
                forces.spec()
            ))
            .with_note(format!("{}: {} solves not converged", m.discretisation.name(), m.not_converged()));
    }
    header
}
