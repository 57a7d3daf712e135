//! The quantities that a load may prescribe.

use surface_io::Dimension;

/// What a list of loads prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrescribedLoad {
    /// Normal force F.
    Force,
    /// F over E* h L, with the measured rms height of each surface.
    ForceBar,
    /// Force over the nominal contact area Lx Ly, undefined points included.
    MeanPressure,
    /// Approach.
    Approach,
    /// Mean gap, with periodic boundaries.
    MeanGap,
}

impl PrescribedLoad {
    /// Its key in the file, its dimension and unit in SI, and its description in tables.
    pub(crate) fn record(self) -> (&'static str, Dimension, &'static str, &'static str) {
        match self {
            Self::Force => ("force", Dimension::FORCE, "N", "force"),
            Self::ForceBar => {
                let meaning = "F_bar = F/(E* h L) with this surface's measured rms height h, L = sqrt(Lx Ly)";
                ("force_bar", Dimension::NONE, "1", meaning)
            }
            Self::MeanPressure => {
                let meaning = "mean pressure, F/(Lx Ly), undefined points included";
                ("mean_pressure", Dimension::PRESSURE, "Pa", meaning)
            }
            Self::Approach => ("approach", Dimension::LENGTH, "m", "approach"),
            Self::MeanGap => ("mean_gap", Dimension::LENGTH, "m", "mean gap"),
        }
    }

    /// Its key in the file.
    pub fn key(self) -> &'static str {
        self.record().0
    }

    /// Its unit in SI.
    pub(crate) fn unit(self) -> &'static str {
        self.record().2
    }

    /// A description in a phrase.
    pub(crate) fn meaning(self) -> &'static str {
        self.record().3
    }
}
