//! The tests of `data/partial-slip/hypotheses.md`, fixed before the surfaces were drawn that decide them.

use super::grid_means::{CaseIndices, GridMean, GridQuantity, SolvedGrids};
use super::study::{PartialSlipStudy, SHARES};

/// The first surfaces of each fractal dimension were known when the hypotheses were written; the others test
/// them.
pub(super) const SEEN: usize = 10;
/// Chance of any false rejection in a family.
const LEVEL: f64 = 0.05;
/// Exponents of area over force that `book/src/results.md` finds lie above this one.
const AREA_EXPONENT: f64 = 0.93;

/// Which surfaces a test takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TestedSurfaces {
    Seen,
    New,
    All,
}

impl TestedSurfaces {
    const EACH: [Self; 3] = [Self::Seen, Self::New, Self::All];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Seen => "seen",
            Self::New => "new",
            Self::All => "all",
        }
    }

    fn has(self, surface: usize) -> bool {
        match self {
            Self::Seen => surface < SEEN,
            Self::New => surface >= SEEN,
            Self::All => true,
        }
    }
}

/// One test of a family, with one sample.
pub(super) struct GridTest {
    pub(super) family: &'static str,
    /// Number of tests of the family.
    pub(super) of: usize,
    pub(super) quantity: &'static str,
    pub(super) fractal_dimension: String,
    pub(super) force_bar: f64,
    pub(super) share: f64,
    pub(super) sample: TestedSurfaces,
    /// The value of the number under the hypothesis.
    pub(super) expected: f64,
    pub(super) found: Option<GridMean>,
}

impl GridTest {
    /// Half-width of the scatter, simultaneous with all of the family.
    pub(super) fn scatter(&self) -> Option<f64> {
        Some(self.found?.mean.half_width_at(LEVEL / self.of as f64))
    }

    /// p-value of this single test, after the difference is reduced by the discretisation error.
    pub(super) fn chance(&self) -> Option<f64> {
        self.found.map(|found| found.mean.chance_of(self.expected, found.grid))
    }

    /// Whether the hypothesis is rejected: its value lies outside the interval of scatter and grid together.
    pub(super) fn verdict(&self) -> &'static str {
        let (Some(found), Some(scatter)) = (self.found, self.scatter()) else { return "no number" };
        let away = (found.mean.value - self.expected).abs();
        if away > scatter + found.grid { "rejected" } else { "not rejected" }
    }
}

/// A family: what is measured of bodies without Poisson's ratio, at which tangential forces, and the value
/// under the hypothesis as a function of Q/(mu F).
struct TestFamily {
    name: &'static str,
    quantity: &'static str,
    of: GridQuantity,
    shares: &'static [f64],
    /// Whether the difference of two fractal dimensions is tested instead of each of them.
    difference: bool,
    expected: fn(f64) -> f64,
}

const FAMILIES: [TestFamily; 4] = [
    TestFamily {
        name: "A",
        quantity: "share that sticks, extrapolated, against 1 - Q/(mu F)",
        of: GridQuantity::Stick,
        shares: &[0.5, 0.9],
        difference: false,
        expected: |share| 1.0 - share,
    },
    TestFamily {
        name: "B",
        quantity: "difference of shares that stick, extrapolated",
        of: GridQuantity::Stick,
        shares: &[0.5, 0.9],
        difference: true,
        expected: |_| 0.0,
    },
    TestFamily {
        name: "C",
        quantity: "difference of k_t(Q)/k_t(0), finest grid",
        of: GridQuantity::Stiffness,
        shares: &[0.5],
        difference: true,
        expected: |_| 0.0,
    },
    TestFamily {
        name: "D",
        quantity: "share that sticks, extrapolated, against (1 - Q/(mu F))^0.93",
        of: GridQuantity::Stick,
        shares: &[0.9],
        difference: false,
        expected: |share| (1.0 - share).powf(AREA_EXPONENT),
    },
];

pub(super) fn tests(study: &PartialSlipStudy, solved: &[SolvedGrids<'_>]) -> Vec<GridTest> {
    // The two ends of the range of fractal dimensions.
    let (Some(&first), Some(&last)) = (solved.first(), solved.last()) else { return Vec::new() };
    let mut tests = Vec::new();
    for family in FAMILIES {
        let curves = if family.difference { vec![[first, last]] } else { vec![[first, first], [last, last]] };
        let count = curves.len() * study.forces.values().len() * family.shares.len();
        for [one, other] in curves {
            for (force, &force_bar) in study.forces.values().iter().enumerate() {
                for &share in family.shares {
                    let at = SHARES.iter().position(|s| (s - share).abs() < 1e-9).unwrap_or_default();
                    let place = CaseIndices { force, poisson: 0, share: at };
                    let [a, b] = [one, other].map(|of| of.values(family.of, place));
                    let each: Vec<Option<Vec<f64>>> = if family.difference {
                        let minus = |(a, b): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                            a.iter().zip(b).map(|(a, b)| a - b).collect()
                        };
                        a.iter().zip(&b).map(|(a, b)| a.as_ref().zip(b.as_ref()).map(minus)).collect()
                    } else {
                        a
                    };
                    for sample in TestedSurfaces::EACH {
                        let own = each.iter().enumerate().filter(|(i, _)| sample.has(*i));
                        let own: Vec<Vec<f64>> = own.filter_map(|(_, values)| values.clone()).collect();
                        let dimensions = [one, other].map(|of| of.fractal_dimension);
                        tests.push(GridTest {
                            family: family.name,
                            of: count,
                            quantity: family.quantity,
                            fractal_dimension: if family.difference {
                                format!("{:?} - {:?}", dimensions[0], dimensions[1])
                            } else {
                                format!("{:?}", dimensions[0])
                            },
                            force_bar,
                            share,
                            sample,
                            expected: (family.expected)(share),
                            found: GridMean::of(family.of, &own),
                        });
                    }
                }
            }
        }
    }
    tests
}
