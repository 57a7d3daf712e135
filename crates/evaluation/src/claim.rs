//! One line per claim of the paper.

use crate::table_of::TableOf;
use analysis::{Table, Value};
use runs::Result;
use std::fmt;

/// What the comparison says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The difference is larger than allowed.
    Disagrees,
    /// The difference is within what is allowed.
    Agrees,
    /// This run cannot tell; the reason is in `why`.
    NotTested,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Disagrees => "disagrees",
            Self::Agrees => "agrees",
            Self::NotTested => "not tested",
        })
    }
}

/// A claim of the paper beside what was found here.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// The quantity.
    pub claim: String,
    /// What the paper says: a number, or words where it gives none.
    pub paper: Value,
    /// What was found.
    pub here: Value,
    /// Standard error of what was found; `None` for one surface or an exact number.
    pub standard_error: Option<f64>,
    /// Found minus paper.
    pub difference: Option<f64>,
    /// Largest difference that counts as agreement, stated before the run.
    pub allowed: Option<f64>,
    /// The verdict.
    pub verdict: Verdict,
    /// Why so much is allowed, where it comes from, what explains a difference.
    pub why: String,
    /// Whether the numbers depend on the machine (run times): such a claim stays out of figures.
    pub timed: bool,
}

impl Claim {
    /// `|here - paper| <= allowed` agrees.
    ///
    /// ```
    /// use evaluation::{Claim, Verdict};
    /// let c = Claim::compare("alpha", 0.532, 0.54, Some(0.01), 0.03, "two digits of the print");
    /// assert_eq!(c.verdict, Verdict::Agrees);
    /// assert_eq!(Claim::compare("alpha", 0.532, 0.60, None, 0.03, "").verdict, Verdict::Disagrees);
    /// ```
    pub fn compare(
        claim: impl Into<String>,
        paper: f64,
        here: f64,
        standard_error: Option<f64>,
        allowed: f64,
        why: impl Into<String>,
    ) -> Self {
        let difference = here - paper;
        let verdict = if difference.abs() <= allowed { Verdict::Agrees } else { Verdict::Disagrees };
        Self {
            claim: claim.into(),
            paper: paper.into(),
            here: here.into(),
            standard_error,
            difference: Some(difference),
            allowed: Some(allowed),
            verdict,
            why: why.into(),
            timed: false,
        }
    }

    /// Agrees within `tolerance` + 2 standard errors; but where 2 standard errors are more than twice the tolerance, an agreement
    /// would say nothing: not tested, with the numbers.
    ///
    /// ```
    /// use evaluation::{Claim, Verdict};
    /// let verdict = |here, error| Claim::within("zeta", 0.66, here, Some(error), 0.05, "").verdict;
    /// assert_eq!(verdict(0.70, 0.02), Verdict::Agrees);
    /// assert_eq!(verdict(0.90, 0.02), Verdict::Disagrees);
    /// assert_eq!(verdict(0.90, 0.15), Verdict::NotTested);
    /// ```
    pub fn within(
        claim: impl Into<String>,
        paper: f64,
        here: f64,
        standard_error: Option<f64>,
        tolerance: f64,
        why: impl Into<String>,
    ) -> Self {
        let scatter = 2.0 * standard_error.unwrap_or(0.0);
        let why = format!("{}; allowed: this + 2 s.e.", why.into());
        let mut claim = Self::compare(claim, paper, here, standard_error, tolerance + scatter, why);
        if claim.verdict == Verdict::Agrees && scatter > 2.0 * tolerance {
            claim.verdict = Verdict::NotTested;
            claim.why = format!("the scatter of so few surfaces hides it; {}", claim.why);
        }
        claim
    }

    /// The same without numbers that depend on the machine.
    #[must_use]
    pub fn without_times(&self) -> Self {
        if !self.timed {
            return self.clone();
        }
        let reason = "depends on the machine: the seconds of both models are in manifest.json";
        Self { timed: true, ..Self::not_tested(self.claim.clone(), self.paper.clone(), reason) }
    }

    /// A claim in words (`at least 4`), judged by the caller.
    pub fn judge(
        claim: impl Into<String>,
        paper: &str,
        here: f64,
        standard_error: Option<f64>,
        holds: bool,
        why: impl Into<String>,
    ) -> Self {
        let verdict = if holds { Verdict::Agrees } else { Verdict::Disagrees };
        Self {
            paper: paper.into(),
            difference: None,
            allowed: None,
            verdict,
            ..Self::compare(claim, 0.0, here, standard_error, 0.0, why)
        }
    }

    /// A claim that this run cannot judge.
    pub fn not_tested(claim: impl Into<String>, paper: impl Into<Value>, reason: impl Into<String>) -> Self {
        Self {
            claim: claim.into(),
            paper: paper.into(),
            here: Value::Empty,
            standard_error: None,
            difference: None,
            allowed: None,
            verdict: Verdict::NotTested,
            why: reason.into(),
            timed: false,
        }
    }
}

/// Disagreements first, then agreements, then what was not tested; otherwise in the order given.
pub fn sort(claims: &mut [Claim]) {
    claims.sort_by_key(|c| c.verdict);
}

/// The table of `verify.csv`.
///
/// # Errors
/// A row that does not fit the columns, which would be a mistake of this crate.
pub fn claims_table(title: &str, claims: &[Claim]) -> Result<Table> {
    TableOf::new(title, claims)
        .column("claim", "-", "the quantity, dimensionless", |c| c.claim.as_str())
        .column("paper", "1", "what the paper says; words where it gives no number", |c| c.paper.clone())
        .column("here", "1", "what was found; empty where this run cannot tell", |c| c.here.clone())
        .column("standard_error", "1", "of what was found; empty for one surface or an exact number", |c| {
            c.standard_error
        })
        .column("difference", "1", "here minus paper", |c| c.difference)
        .column("allowed", "1", "largest difference that counts as agreement, fixed beforehand", |c| {
            c.allowed
        })
        .column("verdict", "-", "agrees, disagrees or not tested", |c| c.verdict.to_string())
        .column("why", "-", "where it comes from and why so much is allowed", |c| c.why.as_str())
        .table()
}

/// The claims as a Markdown table, with short numbers: for `verify.md` and the README.
///
/// ```
/// let c = evaluation::Claim::compare("alpha | D_f = 2", 0.532, 0.54, Some(0.01), 0.03, "");
/// let text = evaluation::markdown(&[c]);
/// assert!(text.ends_with("| alpha \\| D_f = 2 | 0.532 | 0.54 | 0.01 | 0.008 | 0.03 | agrees |  |\n"));
/// ```
pub fn markdown(claims: &[Claim]) -> String {
    let mut text = String::from(
        "| claim | paper | here | standard error | difference | allowed | verdict | why |\n|---|---|---|---|---|---|---|---|\n",
    );
    for c in claims {
        let cells = [
            c.claim.clone(),
            value(&c.paper),
            value(&c.here),
            c.standard_error.map(short).unwrap_or_default(),
            c.difference.map(short).unwrap_or_default(),
            c.allowed.map(short).unwrap_or_default(),
            if c.verdict == Verdict::Disagrees { "**disagrees**".to_owned() } else { c.verdict.to_string() },
            c.why.clone(),
        ];
        let cells = cells.map(|c| c.replace('|', "\\|"));
        text += &format!("| {} |\n", cells.join(" | "));
    }
    text
}

/// The short table of a README: claim, paper, here (with its standard error), verdict; untested claims and run times are left out.
///
/// ```
/// let c = evaluation::Claim::compare("alpha", 0.532, 0.54, Some(0.01), 0.03, "");
/// assert!(evaluation::readme_table(&[c]).ends_with("| alpha | 0.532 | 0.54 +- 0.01 | agrees |\n"));
/// ```
pub fn readme_table(claims: &[Claim]) -> String {
    let mut text = String::from("| quantity | paper | here | verdict |\n|---|---|---|---|\n");
    for c in claims.iter().filter(|c| c.verdict != Verdict::NotTested && !c.timed) {
        let error = c.standard_error.map(|e| format!(" +- {}", rounded(e))).unwrap_or_default();
        let verdict =
            if c.verdict == Verdict::Disagrees { "**disagrees**".to_owned() } else { c.verdict.to_string() };
        let cells = [c.claim.clone(), value(&c.paper), format!("{}{error}", value(&c.here)), verdict];
        text += &format!("| {} |\n", cells.map(|c| c.replace('|', "\\|")).join(" | "));
    }
    text
}

/// One significant digit: enough for an error.
fn rounded(v: f64) -> String {
    short(format!("{v:.0e}").parse().unwrap_or(v))
}

/// The claims as aligned plain text, `why` below each disagreement and each untested claim.
pub fn plain(claims: &[Claim]) -> String {
    let wide = claims.iter().map(|c| c.claim.chars().count()).max().unwrap_or(0).clamp(5, 64);
    let mut text = format!(
        "{:wide$}  {:>12}  {:>10}  {:>9}  {:>9}  verdict\n",
        "claim", "paper", "here", "s.e.", "allowed"
    );
    for c in claims {
        text += &format!(
            "{:wide$}  {:>12}  {:>10}  {:>9}  {:>9}  {}\n",
            c.claim,
            value(&c.paper),
            value(&c.here),
            c.standard_error.map(short).unwrap_or_default(),
            c.allowed.map(short).unwrap_or_default(),
            c.verdict,
        );
        if c.verdict != Verdict::Agrees && !c.why.is_empty() {
            text += &format!("    {}\n", c.why);
        }
    }
    text
}

fn value(v: &Value) -> String {
    match v {
        Value::Text(t) => t.clone(),
        Value::Number(v) => short(*v),
        Value::Count(n) => n.to_string(),
        Value::Flag(b) => b.to_string(),
        Value::Empty => String::new(),
    }
}

/// Four significant digits.
pub fn short(v: f64) -> String {
    let rounded: f64 = format!("{v:.3e}").parse().unwrap_or(v);
    let size = rounded.abs();
    if size < f64::MIN_POSITIVE {
        return "0".to_owned();
    }
    if (1e-4..1e6).contains(&size) { rounded.to_string() } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disagreements_come_first_and_ties_keep_their_order() {
        let mut claims = vec![
            Claim::not_tested("a", 1.0, "too small"),
            Claim::compare("b", 1.0, 1.0, None, 0.1, ""),
            Claim::compare("c", 1.0, 2.0, None, 0.1, "why c"),
            Claim::judge("d", "at least 4", 3.0, None, false, "why d"),
        ];
        sort(&mut claims);
        let order: Vec<&str> = claims.iter().map(|c| c.claim.as_str()).collect();
        assert_eq!(order, ["c", "d", "b", "a"]);
        let text = plain(&claims);
        assert!(text.contains("why c") && text.contains("too small"), "{text}");
        let table = claims_table("t", &claims).unwrap();
        assert_eq!(table.rows()[0][6], Value::Text("disagrees".into()));
        assert_eq!(table.rows()[3][2], Value::Empty);
    }

    #[test]
    fn a_nan_never_agrees_and_never_reaches_the_table() {
        let c = Claim::compare("x", 1.0, f64::NAN, None, 1.0, "");
        assert_eq!(c.verdict, Verdict::Disagrees);
        assert!(claims_table("t", &[c]).is_err());
    }

    #[test]
    fn short_numbers() {
        assert_eq!(short(0.123_456), "0.1235");
        assert_eq!(short(-2.0), "-2");
        assert_eq!(short(1.234_56e-7), "1.235e-7");
        assert_eq!(short(0.0), "0");
    }
}
