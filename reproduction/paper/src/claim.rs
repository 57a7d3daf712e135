//! Statements of the paper, their fair reading, and the results here.

use crate::evaluation::{TableOf, markdown_table};
use contact_model::Table;
use runs::Result;
use std::fmt;

/// The verdict on a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The interval found lies outside the fair reading.
    Contradicted,
    /// The interval found lies partly inside and partly outside the fair reading; the remark says what would
    /// decide.
    Unresolved,
    /// This run has no number; the remark says why.
    NoNumber,
    /// The statement holds in one convention and not in another; the remark names them.
    Convention,
    /// The interval found lies inside the fair reading.
    Confirmed,
}

impl Verdict {
    /// All verdicts, in the order of tables.
    pub const ALL: [Self; 5] =
        [Self::Contradicted, Self::Unresolved, Self::NoNumber, Self::Convention, Self::Confirmed];

    /// The word in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Contradicted => "contradicted",
            Self::Unresolved => "not resolved at this size",
            Self::NoNumber => "no number here",
            Self::Convention => "matter of convention",
            Self::Confirmed => "confirmed",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// A sentence of the paper and its reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Statement {
    /// The statement that the sentence belongs to: rows with the same name are judged together.
    pub name: &'static str,
    /// The words, or the formula.
    pub quotation: &'static str,
    /// Where the sentence is in the paper.
    pub place: &'static str,
    /// Their fair reading, fixed before the comparison.
    pub reading: &'static str,
}

/// A number with the half-width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Half-width of the 95 % interval, from the scatter of the surfaces and all other sources; 0 where the
    /// number is exact.
    pub half_width: f64,
}

impl Estimate {
    /// A number that is exact for the purpose.
    pub fn exact(value: f64) -> Self {
        Self { value, half_width: 0.0 }
    }

    /// From a standard error; `None` without one.
    ///
    /// ```
    /// use paper::{Estimate};
    /// assert_eq!(Estimate::normal(1.0, Some(0.5)), Some(Estimate { value: 1.0, half_width: 0.98 }));
    /// ```
    pub fn normal(value: f64, standard_error: Option<f64>) -> Option<Self> {
        standard_error.map(|error| Self { value, half_width: 1.96 * error })
    }

    /// With another uncertainty, in quadrature.
    pub(crate) fn widened(self, by: f64) -> Self {
        Self { half_width: self.half_width.hypot(by), ..self }
    }

    /// Its quotient with an independent number.
    pub(crate) fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        let relative = (self.half_width / self.value).hypot(other.half_width / other.value);
        Self { value, half_width: value.abs() * relative }
    }

    /// The distance of a ratio from 1, in either direction.
    pub(crate) fn distance_from_one(&self) -> f64 {
        self.value.ln().abs()
    }

    /// Its difference from an independent number.
    pub(crate) fn minus(self, other: Self) -> Self {
        Self { value: self.value - other.value, half_width: self.half_width.hypot(other.half_width) }
    }

    /// The mean of independent numbers with Student's interval; `None` for fewer than two.
    pub(crate) fn mean(each: &[f64]) -> Option<Self> {
        let (value, deviation) = analysis::mean_and_deviation(each)?;
        Some(Self { value, half_width: analysis::half_width_of_mean(deviation?, each.len()) })
    }
}

/// A statement of the paper, compared with the number found here.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// The quantity.
    pub quantity: String,
    /// The paper's words.
    pub statement: Statement,
    /// The range of the quantity that the reading allows; infinite ends for "above" and "below".
    pub paper: [f64; 2],
    /// The number found; `None` where this run has none.
    pub here: Option<Estimate>,
    /// The verdict.
    pub verdict: Verdict,
    /// Conditions of the number; where there is no number, what would decide.
    pub remark: String,
    /// The half-width below which an interval about the same number would decide the statement, where this
    /// one does not.
    pub decided_by: Option<f64>,
    /// Factor on the half-width with which all numbers of the statement are covered together with 95 %
    /// ([`together`]); 1 for a number that stands alone.
    pub factor: f64,
    /// Whether the numbers depend on the machine (run times): such a claim stays out of files.
    pub timed: bool,
}

impl Claim {
    /// Judges a number by its interval alone: confirmed where the interval lies inside the reading,
    /// contradicted where it lies outside, otherwise unresolved.
    ///
    /// ```
    /// use paper::{Claim, Estimate, Statement, Verdict};
    /// let statement = Statement { name: "", quotation: "", place: "", reading: "" };
    /// let judge = |value, half_width| Claim::judge("k", statement, [0.175, 0.185], Estimate { value, half_width }, "").verdict;
    /// assert_eq!(judge(0.180, 0.004), Verdict::Confirmed);
    /// assert_eq!(judge(0.172, 0.004), Verdict::Unresolved);
    /// assert_eq!(judge(0.172, 0.002), Verdict::Contradicted);
    /// ```
    pub fn judge(
        quantity: impl Into<String>,
        statement: Statement,
        paper: [f64; 2],
        here: Estimate,
        remark: impl Into<String>,
    ) -> Self {
        let claim = Self {
            quantity: quantity.into(),
            statement,
            paper,
            here: Some(here),
            verdict: Verdict::Unresolved,
            remark: remark.into(),
            decided_by: None,
            factor: 1.0,
            timed: false,
        };
        claim.judged(here, 1.0)
    }

    /// The same, with an interval that is `factor` times as wide.
    #[must_use]
    fn judged(self, here: Estimate, factor: f64) -> Self {
        let Estimate { value, half_width } = here;
        let [low, high] = [value - factor * half_width, value + factor * half_width];
        let paper = self.paper;
        let verdict = if high < paper[0] || low > paper[1] || !value.is_finite() {
            Verdict::Contradicted
        } else if low >= paper[0] && high <= paper[1] {
            Verdict::Confirmed
        } else {
            Verdict::Unresolved
        };
        let nearest = paper.iter().map(|end| (end - value).abs()).fold(f64::INFINITY, f64::min);
        let decided_by = (verdict == Verdict::Unresolved).then_some(nearest / factor);
        Self { verdict, decided_by, factor, ..self }
    }

    /// Compares with the same quantity in another convention: where one is confirmed and the other
    /// contradicted, the verdict is that the convention decides.
    #[must_use]
    pub fn in_convention(mut self, convention: &str, value: f64) -> Self {
        // With the same half-width, so that both are judged alike.
        let half_width = self.here.map_or(0.0, |here| here.half_width);
        let other = Self::judge("", self.statement, self.paper, Estimate { value, half_width }, "");
        self.remark = joined(&self.remark, &format!("{}: {convention}", short(value)));
        let both = [self.verdict, other.verdict];
        if both.contains(&Verdict::Confirmed) && both.contains(&Verdict::Contradicted) {
            self.verdict = Verdict::Convention;
        }
        self
    }

    /// A statement on which this run has no number; the remark says what would decide.
    pub fn unresolved(
        quantity: impl Into<String>,
        statement: Statement,
        paper: [f64; 2],
        remark: impl Into<String>,
    ) -> Self {
        let here = Estimate::exact(0.0);
        let claim = Self::judge(quantity, statement, paper, here, remark);
        Self { here: None, verdict: Verdict::NoNumber, decided_by: None, ..claim }
    }

    /// The same without numbers that depend on the machine.
    #[must_use]
    pub fn without_times(&self) -> Self {
        if !self.timed {
            return self.clone();
        }
        let remark = "depends on the machine: the seconds of both models are in manifest.json";
        Self { timed: true, ..Self::unresolved(self.quantity.clone(), self.statement, self.paper, remark) }
    }

    /// The range that the reading allows, in words.
    fn allowed(&self) -> String {
        match self.paper {
            [low, high] if !high.is_finite() => format!(">= {}", short(low)),
            [low, high] if !low.is_finite() => format!("<= {}", short(high)),
            [low, high] if (high - low).abs() <= f64::EPSILON * low.abs() => short(low),
            [low, high] => format!("{} to {}", short(low), short(high)),
        }
    }

    /// Quantity, range that the reading allows, number found, and verdict.
    fn short_cells(&self) -> [String; 4] {
        [self.quantity.clone(), self.allowed(), self.found(), self.verdict.to_string()]
    }

    /// The half-width with which all numbers of the statement are covered together.
    fn half_width_together(&self) -> Option<f64> {
        self.here.map(|here| self.factor * here.half_width)
    }

    /// The remark and, where this interval does not decide, what would.
    fn conditions(&self) -> String {
        let Some(half_width) = self.decided_by else { return self.remark.clone() };
        let two_digits = format!("{half_width:.1e}").parse().unwrap_or(half_width);
        let decides =
            format!("decided by a half-width below {}: more surfaces or finer grids", short(two_digits));
        joined(&self.remark, &decides)
    }

    /// The number found, with its interval.
    fn found(&self) -> String {
        match self.here {
            None => String::new(),
            Some(Estimate { value, half_width }) if half_width <= 0.0 => short(value),
            Some(Estimate { value, half_width }) => format!("{} +- {}", short(value), rounded(half_width)),
        }
    }
}

fn joined(a: &str, b: &str) -> String {
    if a.is_empty() { b.to_owned() } else { format!("{a}; {b}") }
}

/// In the order of [`Verdict::ALL`], otherwise in the order given.
pub fn sort(claims: &mut [Claim]) {
    claims.sort_by_key(|c| c.verdict);
}

/// Judges the rows of each statement together: by intervals that cover all of its numbers with 95 %
/// (Bonferroni).
///
/// A statement of the paper is about several fractal dimensions, loads or models. The more rows it has, the
/// more likely one of them misses by chance. Each interval is therefore widened so that it is wrong with a
/// probability of 5 % divided by the number of rows. This is valid for any dependence of the rows (they share
/// surfaces, and surfaces of different D_f share phases), and unlike Holm's procedure it gives intervals. The
/// factor is that of the normal law. Numbers without an interval, and rows that a convention decides, are
/// unchanged.
pub fn together(claims: &mut [Claim]) {
    let scatters = |c: &Claim| c.here.is_some_and(|here| here.half_width > 0.0);
    let names: Vec<&str> = claims.iter().filter(|c| scatters(c)).map(|c| c.statement.name).collect();
    for claim in claims.iter_mut().filter(|c| scatters(c) && c.verdict != Verdict::Convention) {
        let rows = names.iter().filter(|name| **name == claim.statement.name).count() as f64;
        let factor = analysis::student_at(1.0 - 0.025 / rows, f64::MAX) / analysis::student(f64::MAX);
        if let Some(here) = claim.here {
            *claim = claim.clone().judged(here, factor.max(1.0));
        }
    }
}

/// A statement of the paper with the verdicts of its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedStatement {
    /// Its name.
    pub name: &'static str,
    /// The paper's words, of its first row.
    pub quotation: &'static str,
    /// Where the sentence is in the paper.
    pub place: &'static str,
    /// Verdict of each row.
    pub rows: Vec<Verdict>,
    /// The verdict on all rows: contradicted where one row is; otherwise that of the row that is farthest
    /// from confirmed, and unresolved where some rows have no number.
    pub verdict: Verdict,
}

impl JudgedStatement {
    /// Number of rows with each verdict.
    fn rows_in_words(&self) -> String {
        let count = |verdict: Verdict| self.rows.iter().filter(|row| **row == verdict).count();
        let each = Verdict::ALL.iter().filter(|v| count(**v) > 0).map(|v| format!("{} {v}", count(*v)));
        each.collect::<Vec<_>>().join(", ")
    }
}

/// The statements of claims that were judged [`together`], contradictions first.
pub fn statements(claims: &[Claim]) -> Vec<JudgedStatement> {
    let mut all: Vec<JudgedStatement> = Vec::new();
    for claim in claims {
        let Statement { name, quotation, place, .. } = claim.statement;
        if let Some(own) = all.iter_mut().find(|s| s.name == name) {
            own.rows.push(claim.verdict);
            own.verdict = own.verdict.min(claim.verdict);
        } else {
            let (rows, verdict) = (vec![claim.verdict], claim.verdict);
            all.push(JudgedStatement { name, quotation, place, rows, verdict });
        }
    }
    for statement in &mut all {
        if statement.verdict == Verdict::NoNumber && statement.rows.iter().any(|v| *v != Verdict::NoNumber) {
            statement.verdict = Verdict::Unresolved;
        }
    }
    all.sort_by_key(|s| s.verdict);
    all
}

/// The numbers of statements and rows with each verdict, in one line.
///
/// ```
/// assert_eq!(
///     paper::counts(&[]),
///     "0 statements: 0 contradicted, 0 not resolved at this size, 0 no number here, 0 matter of convention, 0 confirmed (0 comparisons: 0, 0, 0, 0, 0)"
/// );
/// ```
pub fn counts(claims: &[Claim]) -> String {
    let statements = statements(claims);
    let each = Verdict::ALL.map(|v| format!("{} {v}", statements.iter().filter(|s| s.verdict == v).count()));
    let rows = Verdict::ALL.map(|v| claims.iter().filter(|c| c.verdict == v).count().to_string());
    format!(
        "{} statements: {} ({} comparisons: {})",
        statements.len(),
        each.join(", "),
        claims.len(),
        rows.join(", ")
    )
}

/// The table of `verify.csv`.
///
/// # Errors
/// A row that does not fit the columns, which would be an error of this crate.
pub fn claims_table(title: &str, claims: &[Claim]) -> Result<Table> {
    const TOGETHER: &str = "of the interval that holds with 95 % for all numbers of the statement together (Bonferroni): it decides";
    const VERDICT: &str =
        "confirmed, contradicted, not resolved at this size, no number here, matter of convention";
    let end = |value: f64| Some(value).filter(|v| v.is_finite());
    TableOf::new(title, claims)
        .column("statement", "-", "rows of one statement are judged together", |c| c.statement.name)
        .column("quantity", "-", "what is compared, dimensionless", |c| c.quantity.as_str())
        .column("quotation", "-", "the paper's words or formula", |c| c.statement.quotation)
        .column("place", "-", "where they stand", |c| c.statement.place)
        .column("reading", "-", "what a fair reader takes them to say", |c| c.statement.reading)
        .column("paper_min", "1", "smallest value that this reading allows; empty for none", |c| {
            end(c.paper[0])
        })
        .column("paper_max", "1", "largest value that this reading allows; empty for none", |c| {
            end(c.paper[1])
        })
        .column("here", "1", "what was found; empty where this run has no number", |c| {
            c.here.map(|h| h.value)
        })
        .column("half_width", "1", "of its 95 % interval; 0 where it is exact", |c| {
            c.here.map(|h| h.half_width)
        })
        .column("half_width_together", "1", TOGETHER, Claim::half_width_together)
        .column("verdict", "-", VERDICT, |c| c.verdict.as_str())
        .column("remark", "-", "conditions, and what would decide", Claim::conditions)
        .table()
}

/// The claims as a Markdown table, with short numbers: for `verify.md`.
pub fn markdown(claims: &[Claim]) -> String {
    let head = "| quantity | statement | the paper | fair reading | allowed | here, 95 % | verdict | remark |\n|---|---|---|---|---|---|---|---|";
    let row = |c: &Claim| {
        let Statement { name, quotation, place, reading } = c.statement;
        let paper = format!("{quotation} ({place})");
        let [quantity, allowed, found, verdict] = c.short_cells();
        let [name, reading] = [name, reading].map(str::to_owned);
        [quantity, name, paper, reading, allowed, found, verdict, c.conditions()]
    };
    format!("{}\n\n{}", counts(claims), markdown_table(head, claims.iter().map(row)))
}

/// The short tables: statements, then rows (quantity, what the paper allows, what was found, verdict); run
/// times are left out.
///
/// ```
/// use paper::{Claim, Estimate, Statement};
/// let statement = Statement { name: "power law", quotation: "", place: "", reading: "" };
/// let c = Claim::judge("alpha", statement, [0.5, 0.6], Estimate { value: 0.54, half_width: 0.012 }, "");
/// assert!(paper::short_table(&[c]).ends_with("| alpha | 0.5 to 0.6 | 0.54 +- 0.01 | confirmed |\n"));
/// ```
pub fn short_table(claims: &[Claim]) -> String {
    let head = "| statement | where | rows | verdict |\n|---|---|---|---|";
    let statements = statements(claims)
        .into_iter()
        .map(|s| [s.name.to_owned(), s.place.to_owned(), s.rows_in_words(), s.verdict.to_string()]);
    let statements = markdown_table(head, statements);
    let head = "| quantity | paper | here, 95 % | verdict |\n|---|---|---|---|";
    let rows = claims.iter().filter(|c| !c.timed).map(Claim::short_cells);
    format!("{}\n\n{statements}\nThe rows:\n\n{}", counts(claims), markdown_table(head, rows))
}

/// One significant digit, which is enough for an error.
fn rounded(v: f64) -> String {
    short(format!("{v:.0e}").parse().unwrap_or(v))
}

/// The claims as aligned plain text, with the remark below what is not confirmed.
pub fn plain(claims: &[Claim]) -> String {
    let wide = claims.iter().map(|c| c.quantity.chars().count()).max().unwrap_or(0).clamp(8, 64);
    let line = |[quantity, paper, here, verdict]: [String; 4]| {
        format!("{quantity:wide$}  {paper:>16}  {here:>18}  {verdict}\n")
    };
    let mut text = line(["quantity", "paper", "here, 95 %", "verdict"].map(str::to_owned));
    for c in claims {
        text += &line(c.short_cells());
        let conditions = c.conditions();
        if c.verdict != Verdict::Confirmed && !conditions.is_empty() {
            text += &format!("    {conditions}\n");
        }
    }
    text + &format!("{}\n", counts(claims))
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

    const STATEMENT: Statement = Statement { name: "s", quotation: "a | b", place: "Sec. I", reading: "so" };

    fn claim(quantity: &str, value: f64, half_width: f64) -> Claim {
        Claim::judge(quantity, STATEMENT, [0.9, 1.1], Estimate { value, half_width }, "")
    }

    #[test]
    fn the_interval_decides() {
        assert_eq!(claim("inside", 1.0, 0.05).verdict, Verdict::Confirmed);
        assert_eq!(claim("across an end, narrow", 1.12, 0.05).verdict, Verdict::Unresolved);
        assert_eq!(claim("across an end, wide", 1.12, 0.2).verdict, Verdict::Unresolved);
        assert_eq!(claim("wider than the reading", 1.0, 0.2).verdict, Verdict::Unresolved);
        assert_eq!(claim("outside", 1.2, 0.05).verdict, Verdict::Contradicted);
        let above =
            Claim::judge("x", STATEMENT, [3.0, f64::INFINITY], Estimate { value: 3.6, half_width: 0.2 }, "");
        assert_eq!((above.verdict, above.allowed().as_str()), (Verdict::Confirmed, ">= 3"));
    }

    #[test]
    fn conventions_are_said() {
        assert_eq!(claim("x", 1.0, 0.05).in_convention("log mean", 1.2).verdict, Verdict::Convention);
        assert_eq!(claim("x", 1.2, 0.05).in_convention("log mean", 1.0).verdict, Verdict::Convention);
        assert_eq!(claim("x", 1.0, 0.05).in_convention("log mean", 1.05).verdict, Verdict::Confirmed);
    }

    #[test]
    fn contradictions_come_first_and_ties_keep_their_order() {
        let mut claims = vec![
            claim("a", 1.0, 0.05),
            claim("b", 2.0, 0.05),
            Claim::unresolved("c", STATEMENT, [0.0, 1.0], "more cells"),
            claim("d", 1.0, 0.01),
        ];
        sort(&mut claims);
        let order: Vec<&str> = claims.iter().map(|c| c.quantity.as_str()).collect();
        assert_eq!(order, ["b", "c", "a", "d"]);
        assert!(plain(&claims).contains("more cells"));
        assert!(plain(&claims).ends_with(
            "1 statements: 1 contradicted, 0 not resolved at this size, 0 no number here, 0 matter of convention, 0 confirmed (4 comparisons: 1, 0, 1, 0, 2)\n"
        ));
        assert!(
            markdown(&claims)
                .contains("| b | s | a \\| b (Sec. I) | so | 0.9 to 1.1 | 2 +- 0.05 | contradicted |  |")
        );
        let table = claims_table("t", &claims).unwrap();
        assert_eq!(table.rows()[1][7], contact_model::Value::Empty);
    }

    #[test]
    fn rows_of_one_statement_are_judged_together() {
        // 2.394 standard errors in place of 1.960 for three numbers; an exact one does not count.
        let other = Statement { name: "t", ..STATEMENT };
        let mut claims = vec![
            claim("just outside", 1.16, 0.055),
            claim("far outside", 1.2, 0.05),
            claim("just inside", 1.04, 0.055),
            claim("exact", 1.0, 0.0),
            Claim::judge("alone", other, [0.9, 1.1], Estimate { value: 1.16, half_width: 0.055 }, ""),
        ];
        together(&mut claims);
        let verdicts: Vec<Verdict> = claims.iter().map(|c| c.verdict).collect();
        let [no, open, yes] = [Verdict::Contradicted, Verdict::Unresolved, Verdict::Confirmed];
        assert_eq!(verdicts, [open, no, open, yes, no]);
        assert!((claims[0].factor - 2.393_98 / 1.959_964).abs() < 1e-4, "{}", claims[0].factor);
        // The half-width that would decide is that of the row alone.
        assert!((claims[0].decided_by.unwrap() - 0.06 / claims[0].factor).abs() < 1e-12);
        let statements = statements(&claims);
        assert_eq!(statements.len(), 2);
        assert_eq!((statements[0].verdict, statements[0].rows.len()), (no, 4));
        assert_eq!(statements[0].rows_in_words(), "1 contradicted, 2 not resolved at this size, 1 confirmed");
    }

    #[test]
    fn a_nan_never_agrees_and_never_reaches_the_table() {
        let c = claim("x", f64::NAN, 0.0);
        assert_eq!(c.verdict, Verdict::Contradicted);
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
