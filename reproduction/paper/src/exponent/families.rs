//! The hypotheses of `data/exponent/hypotheses.md`, fixed before the run that tests them.

use super::curve::{BandedNumber, Convention, MeanCurve};
use super::laws::{DECADES, FREE, FittedLimit, ModelRatio, eq6, eq24, ratios};
use std::ops::Range;

/// One test of a family.
#[derive(Debug, Clone)]
pub struct FamilyTest {
    /// A to D.
    pub family: &'static str,
    /// Number of tests of the family.
    pub of: usize,
    /// The quantity that is tested.
    pub quantity: &'static str,
    /// `bem3d`, `mdr1d` or both.
    pub model: &'static str,
    /// D_f.
    pub fractal_dimension: f64,
    /// Name of the window.
    pub window: &'static str,
    /// The hypothesis in words.
    pub hypothesis: &'static str,
    /// The value of the number under the hypothesis.
    pub expected: f64,
    /// The number; `None` where the run has none.
    pub value: Option<f64>,
    /// Its interval, simultaneous with all of the family.
    pub interval: Option<[f64; 2]>,
    /// p-value of this single test; `None` for intervals of the bootstrap.
    pub chance: Option<f64>,
    /// Whether the window is resolved.
    pub resolved: bool,
}

impl FamilyTest {
    /// Whether the hypothesis is rejected.
    pub fn verdict(&self) -> &'static str {
        match self.interval {
            Some([low, high]) if self.resolved => {
                if (low..=high).contains(&self.expected) {
                    "not rejected"
                } else {
                    "rejected"
                }
            }
            Some(_) => "not resolved",
            None => "no number",
        }
    }
}

/// The hypothesis of a family that exponents follow a law.
struct LawHypothesis {
    family: &'static str,
    words: &'static str,
    /// The exponent as a function of D_f.
    law: fn(f64) -> f64,
}

const LIGHTER: &str = DECADES[2].0;
const HEAVIER: &str = DECADES[1].0;
const CONSTANT: &str = "0: the ratio depends on D_f alone";
const EQ24: &str = "1/(1 + H) (Eq. 24)";
const EQ6: &str = "0.266 D_f (Eq. 6)";

/// Family A: windows and fractal dimensions.
const RATIOS: [(&str, f64); 7] = [
    (HEAVIER, 2.0),
    (HEAVIER, 2.2),
    (HEAVIER, 2.4),
    (HEAVIER, 2.6),
    (HEAVIER, 2.8),
    (LIGHTER, 2.0),
    (LIGHTER, 2.2),
];
/// Families B and C.
const WINDOWS: [(&str, f64); 6] =
    [(HEAVIER, 2.4), (HEAVIER, 2.6), (HEAVIER, 2.8), (HEAVIER, 3.0), (LIGHTER, 2.4), (LIGHTER, 2.6)];
const LAWS: [LawHypothesis; 2] = [
    LawHypothesis { family: "B", words: EQ24, law: eq24 },
    LawHypothesis { family: "C", words: EQ6, law: eq6 },
];
/// Family D, for surfaces and for lines.
const LIMITS: [f64; 4] = [2.4, 2.6, 2.8, 3.0];

/// Number of tests of family D.
pub const LIMITS_TESTED: usize = 2 * LIMITS.len();

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// All tests, made with these curves and the fits of them.
pub fn tests(curves: &[MeanCurve], limits: &[FittedLimit]) -> Vec<FamilyTest> {
    let measured: Vec<MeanCurve> =
        curves.iter().filter(|c| c.convention == Convention::Measured).cloned().collect();
    let (_, factors) = ratios(&measured);
    let mut tests: Vec<FamilyTest> = RATIOS.iter().map(|&at| of_ratio(&factors, at)).collect();
    for law in LAWS {
        tests.extend(WINDOWS.iter().map(|&at| of_window(&measured, &law, at)));
    }
    for model in ["bem3d", "mdr1d"] {
        tests.extend(LIMITS.iter().map(|&d| of_limit(limits, model, d)));
    }
    tests
}

/// A test without its number, of no family yet.
const WITHOUT_NUMBER: FamilyTest = FamilyTest {
    family: "",
    of: 0,
    quantity: "",
    model: "",
    fractal_dimension: f64::NAN,
    window: "",
    hypothesis: "",
    expected: f64::NAN,
    value: None,
    interval: None,
    chance: None,
    resolved: false,
};

impl FamilyTest {
    fn with(self, number: &BandedNumber, resolved: bool) -> Self {
        let interval = Some(number.interval(0.05 / self.of as f64));
        let chance = Some(number.chance_of(self.expected));
        Self { value: Some(number.value()), interval, chance, resolved, ..self }
    }
}

fn of_ratio(factors: &[ModelRatio], at: (&'static str, f64)) -> FamilyTest {
    let test = FamilyTest {
        family: "A",
        of: RATIOS.len(),
        quantity: "slope of ln(k_1D/k_3D) over ln F",
        model: "mdr1d over bem3d",
        window: at.0,
        fractal_dimension: at.1,
        hypothesis: CONSTANT,
        expected: 0.0,
        ..WITHOUT_NUMBER
    };
    let own = factors.iter().find(|f| f.window == at.0 && close(f.fractal_dimension, at.1));
    match own {
        Some(factor) => test.with(&factor.slope, factor.resolved),
        None => test,
    }
}

fn of_window(curves: &[MeanCurve], law: &LawHypothesis, at: (&'static str, f64)) -> FamilyTest {
    let test = FamilyTest {
        family: law.family,
        of: WINDOWS.len(),
        quantity: "exponent of the window",
        model: "bem3d",
        window: at.0,
        fractal_dimension: at.1,
        hypothesis: law.words,
        expected: (law.law)(at.1),
        ..WITHOUT_NUMBER
    };
    let forces: Option<Range<f64>> =
        DECADES.into_iter().find(|decade| decade.0 == at.0).map(|decade| decade.1);
    let own = curves.iter().find(|c| c.model == "bem3d" && close(c.fractal_dimension, at.1));
    let found = own.zip(forces).and_then(|(curve, forces)| {
        let points = curve.window(&forces)?;
        Some((curve.slope(points.clone())?, curve.resolves(&points)))
    });
    match found {
        Some((alpha, resolved)) => test.with(&alpha, resolved),
        None => test,
    }
}

fn of_limit(limits: &[FittedLimit], model: &'static str, d: f64) -> FamilyTest {
    let test = FamilyTest {
        family: "D",
        of: LIMITS_TESTED,
        quantity: "alpha towards zero force",
        model,
        window: "fit",
        fractal_dimension: d,
        hypothesis: EQ24,
        expected: eq24(d),
        ..WITHOUT_NUMBER
    };
    let judged = |l: &&FittedLimit| l.variant == FREE && l.convention == Convention::Measured;
    let own = |l: &&FittedLimit| l.model == model && close(l.fractal_dimension, d);
    match limits.iter().filter(judged).find(own) {
        Some(limit) => FamilyTest {
            value: Some(limit.law.alpha),
            interval: Some(limit.family),
            resolved: limit.resolved,
            ..test
        },
        None => test,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_needs_a_resolved_number() {
        let test = FamilyTest { family: "A", of: 7, expected: 0.0, ..WITHOUT_NUMBER };
        assert_eq!(test.verdict(), "no number");
        let with =
            |interval, resolved| FamilyTest { interval: Some(interval), resolved, ..test.clone() }.verdict();
        assert_eq!(with([-0.03, -0.01], true), "rejected");
        assert_eq!(with([-0.03, 0.01], true), "not rejected");
        assert_eq!(with([-0.03, -0.01], false), "not resolved");
        assert_eq!(tests(&[], &[]).len(), 7 + 6 + 6 + 8);
    }
}
