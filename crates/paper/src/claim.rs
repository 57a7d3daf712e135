//! What the paper states, what a fair reading of it is, and what was found.

use analysis::Table;
use evaluation::{TableOf, markdown_table};
use runs::Result;
use std::fmt;

/// What was found of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The interval found lies outside the fair reading.
    Contradicted,
    /// The interval found holds other readings, or another law, as well; the remark says what would decide.
    Unresolved,
    /// It holds in one convention and not in another; the remark says in which.
    Convention,
    /// The interval found lies inside the fair reading.
    Confirmed,
}

impl Verdict {
    /// All, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Contradicted, Self::Unresolved, Self::Convention, Self::Confirmed];

    /// The words of a table.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Contradicted => "contradicted",
            Self::Unresolved => "not resolved at this size",
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

/// Words of the paper and how they are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Statement {
    /// The words, or the formula.
    pub quotation: &'static str,
    /// Where they stand.
    pub place: &'static str,
    /// What a fair reader takes them to say, fixed before the comparison.
    pub reading: &'static str,
}

/// A number with the half-width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Half-width of the 95 % interval: scatter of the surfaces and whatever else the number depends on; 0
    /// where it is exact.
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

    /// How far a ratio is from 1, whichever way.
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
        let n = each.len() as f64;
        Some(Self { value, half_width: analysis::student(n - 1.0) * deviation? / n.sqrt() })
    }
}

/// A statement of the paper beside what was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// The quantity.
    pub quantity: String,
    /// The paper's words.
    pub statement: Statement,
    /// What the reading allows the quantity to be; infinite ends for "above" and "below".
    pub paper: [f64; 2],
    /// What was found; `None` where this run has nothing to say.
    pub here: Option<Estimate>,
    /// The verdict.
    pub verdict: Verdict,
    /// Conditions of the number; where there is none, what would decide.
    pub remark: String,
    /// Half-width below which an interval about the same number would decide, where this one does not.
    pub decided_by: Option<f64>,
    /// Whether the numbers depend on the machine (run times): such a claim stays out of files.
    pub timed: bool,
}

impl Claim {
    /// Judges a number by its interval alone: confirmed where it lies inside the reading, contradicted where
    /// it misses it, else unresolved.
    ///
    /// ```
    /// use paper::{Claim, Estimate, Statement, Verdict};
    /// let statement = Statement { quotation: "", place: "", reading: "" };
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
        let Estimate { value, half_width } = here;
        let [low, high] = [value - half_width, value + half_width];
        let verdict = if high < paper[0] || low > paper[1] || !value.is_finite() {
            Verdict::Contradicted
        } else if low >= paper[0] && high <= paper[1] {
            Verdict::Confirmed
        } else {
            Verdict::Unresolved
        };
        let nearest = paper.iter().map(|end| (end - value).abs()).fold(f64::INFINITY, f64::min);
        Self {
            quantity: quantity.into(),
            statement,
            paper,
            here: Some(here),
            verdict,
            remark: remark.into(),
            decided_by: (verdict == Verdict::Unresolved).then_some(nearest),
            timed: false,
        }
    }

    /// One of two laws: contradicted where the interval misses the reading of this law, unresolved where it
    /// meets that of the rival as well, else confirmed.
    ///
    /// ```
    /// use paper::{Claim, Estimate, Statement, Verdict};
    /// let statement = Statement { quotation: "", place: "", reading: "" };
    /// let judge = |half_width| {
    ///     let claim = Claim::judge("alpha", statement, [0.52, 0.54], Estimate { value: 0.52, half_width }, "");
    ///     claim.beside("1/(1 + H)", [0.49, 0.51]).verdict
    /// };
    /// assert_eq!(judge(0.005), Verdict::Confirmed);
    /// assert_eq!(judge(0.02), Verdict::Unresolved);
    /// ```
    #[must_use]
    pub fn beside(mut self, law: &str, rival: [f64; 2]) -> Self {
        if let Some(here) = self.here.filter(|_| self.verdict != Verdict::Contradicted) {
            let meets = here.value - here.half_width <= rival[1] && here.value + here.half_width >= rival[0];
            self.verdict = if meets { Verdict::Unresolved } else { Verdict::Confirmed };
            let middle = short(0.5 * (rival[0] + rival[1]));
            let word = if meets { "meets" } else { "misses" };
            self.remark = joined(&self.remark, &format!("the interval {word} {law} = {middle}"));
            let away = (rival[0] - here.value).max(here.value - rival[1]);
            self.decided_by = Some(away).filter(|away| meets && *away > 0.0);
            if meets && self.decided_by.is_none() {
                self.remark = joined(&self.remark, "the number lies within both laws' tolerance");
            }
        }
        self
    }

    /// Beside the same quantity in another convention: where one is confirmed and the other contradicted, the
    /// convention decides.
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
        Self { here: None, verdict: Verdict::Unresolved, decided_by: None, ..claim }
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

    /// What the reading allows, in words.
    fn allowed(&self) -> String {
        match self.paper {
            [low, high] if !high.is_finite() => format!(">= {}", short(low)),
            [low, high] if !low.is_finite() => format!("<= {}", short(high)),
            [low, high] if (high - low).abs() <= f64::EPSILON * low.abs() => short(low),
            [low, high] => format!("{} to {}", short(low), short(high)),
        }
    }

    /// Quantity, what the reading allows, what was found, and the verdict.
    fn short_cells(&self) -> [String; 4] {
        [self.quantity.clone(), self.allowed(), self.found(), self.verdict.to_string()]
    }

    /// The remark, with what would decide where this interval does not.
    fn conditions(&self) -> String {
        let Some(half_width) = self.decided_by else { return self.remark.clone() };
        let two_digits = format!("{half_width:.1e}").parse().unwrap_or(half_width);
        let decides =
            format!("decided by a half-width below {}: more surfaces or finer grids", short(two_digits));
        joined(&self.remark, &decides)
    }

    /// What was found, with its interval.
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

/// How many there are of each verdict, in one line.
///
/// ```
/// assert_eq!(
///     paper::counts(&[]),
///     "0 comparisons: 0 contradicted, 0 not resolved at this size, 0 matter of convention, 0 confirmed"
/// );
/// ```
pub fn counts(claims: &[Claim]) -> String {
    let each = Verdict::ALL.map(|v| format!("{} {v}", claims.iter().filter(|c| c.verdict == v).count()));
    format!("{} comparisons: {}", claims.len(), each.join(", "))
}

/// The table of `verify.csv`.
///
/// # Errors
/// A row that does not fit the columns, which would be a mistake of this crate.
pub fn claims_table(title: &str, claims: &[Claim]) -> Result<Table> {
    let end = |value: f64| Some(value).filter(|v| v.is_finite());
    TableOf::new(title, claims)
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
        .column(
            "verdict",
            "-",
            "confirmed, contradicted, not resolved at this size, matter of convention",
            |c| c.verdict.as_str(),
        )
        .column("remark", "-", "conditions, and what would decide", Claim::conditions)
        .table()
}

/// The claims as a Markdown table, with short numbers: for `verify.md`.
pub fn markdown(claims: &[Claim]) -> String {
    let head = "| quantity | the paper | fair reading | allowed | here, 95 % | verdict | remark |\n|---|---|---|---|---|---|---|";
    let row = |c: &Claim| {
        let Statement { quotation, place, reading } = c.statement;
        let paper = format!("{quotation} ({place})");
        let [quantity, allowed, found, verdict] = c.short_cells();
        [quantity, paper, reading.to_owned(), allowed, found, verdict, c.conditions()]
    };
    format!("{}\n\n{}", counts(claims), markdown_table(head, claims.iter().map(row)))
}

/// The short table: quantity, what the paper allows, what was found, verdict; run times are left out.
///
/// ```
/// use paper::{Claim, Estimate, Statement};
/// let statement = Statement { quotation: "", place: "", reading: "" };
/// let c = Claim::judge("alpha", statement, [0.5, 0.6], Estimate { value: 0.54, half_width: 0.012 }, "");
/// assert!(paper::short_table(&[c]).ends_with("| alpha | 0.5 to 0.6 | 0.54 +- 0.01 | confirmed |\n"));
/// ```
pub fn short_table(claims: &[Claim]) -> String {
    let head = "| quantity | paper | here, 95 % | verdict |\n|---|---|---|---|";
    let rows = claims.iter().filter(|c| !c.timed).map(Claim::short_cells);
    format!("{}\n\n{}", counts(claims), markdown_table(head, rows))
}

/// One significant digit: enough for an error.
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

    const STATEMENT: Statement = Statement { quotation: "a | b", place: "Sec. I", reading: "so" };

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
    fn rivals_and_conventions_are_said() {
        let held = claim("x", 1.0, 0.05).beside("Eq. 24", [1.03, 1.05]);
        assert_eq!(held.verdict, Verdict::Unresolved);
        assert!(held.remark.contains("Eq. 24 = 1.04"), "{}", held.remark);
        assert_eq!(claim("x", 1.0, 0.05).beside("Eq. 24", [1.06, 1.08]).verdict, Verdict::Confirmed);
        assert_eq!(claim("x", 1.2, 0.05).beside("Eq. 24", [1.19, 1.21]).verdict, Verdict::Contradicted);
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
            "4 comparisons: 1 contradicted, 1 not resolved at this size, 0 matter of convention, 2 confirmed\n"
        ));
        assert!(
            markdown(&claims)
                .contains("| b | a \\| b (Sec. I) | so | 0.9 to 1.1 | 2 +- 0.05 | contradicted |  |")
        );
        let table = claims_table("t", &claims).unwrap();
        assert_eq!(table.rows()[1][6], analysis::Value::Empty);
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
