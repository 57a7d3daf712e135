//! Presets for the size of the study, and the methods that follow from their sizes.

use super::row::Way;
use super::sizes::StudySizes;
use crate::evaluation::run::distinct;
use bem3d::Method;

/// How much is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Depth {
    /// Up to 257 cells, under a minute.
    Quick,
    /// Up to 1025 cells, some ten minutes.
    #[default]
    Default,
    /// Up to 2049 cells, hours.
    Thorough,
}

const LADDER: [f64; 10] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];
/// The tolerance at which operators are compared: that of the figures.
const OPERATORS: f64 = crate::evaluation::run::TOLERANCE;

impl Depth {
    /// The word on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Default => "default",
            Self::Thorough => "thorough",
        }
    }

    pub(crate) fn sizes(self) -> StudySizes {
        match self {
            Self::Quick => StudySizes {
                grids: &[65, 129, 257],
                between: &[97, 193],
                tolerances: &[1e-1, 1e-2, 1e-4],
                finest: &[1e-2],
                ladder: 129,
                tight: 1e-8,
                elements: &[1 << 10, 1 << 12, 1 << 14, 1 << 16],
                surfaces: 12,
                ensembles: &[65, 129],
            },
            Self::Default => StudySizes {
                grids: &[129, 257, 513, 1025],
                between: &[193, 385, 769],
                tolerances: &[1e-1, 1e-2, 1e-3, 1e-4, 1e-6],
                finest: &[1e-2, 1e-4],
                ladder: 257,
                tight: 1e-8,
                elements: &[1 << 10, 1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20],
                surfaces: 60,
                ensembles: &[65, 129, 257],
            },
            Self::Thorough => StudySizes {
                grids: &[129, 257, 513, 1025, 2049],
                between: &[193, 385, 769, 1537],
                tolerances: &[1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8],
                finest: &[1e-2, 1e-4, 1e-6],
                ladder: 513,
                tight: 1e-10,
                elements: &[1 << 10, 1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20],
                surfaces: 60,
                ensembles: &[65, 129, 257, 513],
            },
        }
    }
}

impl StudySizes {
    /// Everything that is solved in three dimensions on one surface, coarse grids first.
    pub fn solids(&self) -> Vec<Way> {
        let last = self.grids.last().copied();
        let mut all = Vec::new();
        for &cells in self.grids.iter().chain(self.between) {
            let mut tolerances = vec![self.tight];
            if cells == self.ladder {
                tolerances.extend(LADDER);
            } else if Some(cells) == last {
                tolerances.extend(self.finest);
            } else if self.grids.contains(&cells) {
                tolerances.extend(self.tolerances);
            }
            all.extend(
                distinct(tolerances).into_iter().rev().map(|tolerance| (cells, tolerance, Method::Auto)),
            );
            if cells == self.ladder {
                all.extend([Method::Iterative, Method::SingleLevel].map(|m| (cells, OPERATORS, m)));
            }
        }
        all.sort_by_key(|w| w.0);
        all.into_iter().map(|(cells, tolerance, method)| Way::Solid { cells, tolerance, method }).collect()
    }

    /// Grids at the tightest tolerance, coarsest first.
    pub fn sequence(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.grids.iter().chain(self.between).copied().collect();
        all.sort_unstable();
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_way_once_and_references_among_them() {
        for depth in [Depth::Quick, Depth::Default, Depth::Thorough] {
            let sizes = depth.sizes();
            let ways = sizes.solids();
            for (i, a) in ways.iter().enumerate() {
                assert!(ways[..i].iter().all(|b| b != a), "{a:?}");
            }
            for n in sizes.sequence() {
                let tight = Way::Solid { cells: n, tolerance: sizes.tight, method: Method::Auto };
                assert!(ways.contains(&tight));
            }
            assert!(sizes.grids.contains(&sizes.ladder));
        }
    }
}
