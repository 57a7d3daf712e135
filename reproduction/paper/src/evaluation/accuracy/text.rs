//! Writes the text about the study from its tables: the cost of a given accuracy, when cheaper methods
//! suffice, and which part of the error dominates.

use super::picture::{AccuracyPoint, TARGETS, read, values};
use crate::evaluation::table_of::{markdown_rows, read_rows};
use runs::{CsvFile, Result};
use serde::Deserialize;
use std::path::Path;

/// The paper's settings, and the tolerance of its preset here.
const PAPER_CELLS: f64 = 2049.0;
const PAPER_TOLERANCE: f64 = 1e-3;

/// The text with placeholders for values from the tables.
const TEMPLATE: &str = include_str!("text.template");

pub(crate) fn text(csv: &Path, order: &Path) -> Result<String> {
    let points = read(csv)?;
    let orders = Orders::read(order)?;
    let command =
        CsvFile::read(csv)?.comments.into_iter().find_map(|c| Some(c.strip_prefix("command: ")?.to_owned()));
    let (parts, counts) = parts(&points, &orders);
    let found = [
        ("{command}", command.unwrap_or_default()),
        ("{short}", short(&points)),
        ("{takes}", takes(&points)),
        ("{less}", less(&points)),
        ("{parts}", parts),
        ("{counts}", counts),
        ("{orders}", orders.text()),
        ("{paper_cells}", format!("{PAPER_CELLS:.0}")),
        ("{paper_tolerance}", format!("{PAPER_TOLERANCE:e}")),
    ];
    Ok(found.into_iter().fold(TEMPLATE.to_owned(), |text, (place, words)| text.replace(place, &words)))
}

fn percent(v: f64) -> String {
    let v = 100.0 * v;
    match v {
        _ if v >= 10.0 => format!("{v:.0} %"),
        _ if v >= 1.0 => format!("{v:.1} %"),
        _ if v >= 0.01 => format!("{v:.2} %"),
        _ if v <= 0.0 => "0".to_owned(),
        _ => format!("{v:.0e} %"),
    }
}

fn or_dash<T>(v: Option<T>, words: impl Fn(T) -> String) -> String {
    v.map_or_else(|| "-".to_owned(), words)
}

fn maybe(v: Option<f64>) -> String {
    or_dash(v, percent)
}

fn seconds(v: Option<f64>) -> String {
    match v {
        Some(v) if v >= 1.0 => format!("{v:.1} s"),
        Some(v) if v >= 1e-3 => format!("{:.0} ms", 1e3 * v),
        Some(v) => format!("{:.0} us", 1e6 * v),
        None => "no time".to_owned(),
    }
}

/// The problems of a family, in order.
fn problems<'a>(points: &'a [AccuracyPoint], family: &str) -> Vec<&'a AccuracyPoint> {
    let mut all: Vec<&AccuracyPoint> = Vec::new();
    for p in points.iter().filter(|p| p.family == family) {
        if !all.iter().any(|q| q.same_problem(p)) {
            all.push(p);
        }
    }
    all
}

/// D_f and F_bar, or the name of a body.
fn label(p: &AccuracyPoint) -> [String; 2] {
    match (p.fractal_dimension, p.force_bar) {
        (Some(d), Some(f)) => [d, f].map(|v| format!("{v:?}")),
        _ => [p.family.clone(), "-".to_owned()],
    }
}

/// The cheapest row in three dimensions within an error that every finer grid also keeps, so that a grid that
/// is accurate by chance does not count.
fn cheapest<'a>(
    points: &'a [AccuracyPoint],
    problem: &AccuracyPoint,
    target: f64,
) -> Option<&'a AccuracyPoint> {
    let solid = || points.iter().filter(|p| p.same_problem(problem) && p.model == "bem3d");
    let within = |p: &AccuracyPoint| p.error.is_some_and(|e| e <= target);
    // The row at the tightest tolerance of each grid has an algebraic error of zero.
    let tight = |p: &AccuracyPoint| p.algebraic.is_some_and(|a| a <= 0.0);
    let kept = |size: Option<f64>| solid().all(|p| p.size <= size || !tight(p) || within(p));
    solid()
        .filter(|p| p.seconds.is_some() && within(p) && kept(p.size))
        .min_by(|a, b| a.seconds.unwrap_or(0.0).total_cmp(&b.seconds.unwrap_or(0.0)))
}

/// A summary of the picture in a few sentences.
fn short(points: &[AccuracyPoint]) -> String {
    let mut text = String::new();
    for (family, words) in [
        ("band", "One surface whose waves the grids resolve"),
        ("spectrum", "One fractal surface, waves to the end of each grid"),
    ] {
        let all = problems(points, family);
        let told = TARGETS.map(|target| {
            let mut found: Vec<&AccuracyPoint> =
                all.iter().filter_map(|p| cheapest(points, p, target)).collect();
            found.sort_by(|a, b| a.seconds.unwrap_or(0.0).total_cmp(&b.seconds.unwrap_or(0.0)));
            let count = format!(
                "k within {} % for {} of {} surfaces and loads",
                100.0 * target,
                found.len(),
                all.len()
            );
            match (found.first(), found.last()) {
                (Some(first), Some(last)) => {
                    let finest = found.iter().filter_map(|p| p.size).fold(0.0, f64::max);
                    let times = format!("{} to {}", seconds(first.seconds), seconds(last.seconds));
                    format!("{count} in {times}, at most {finest:.0} cells a side")
                }
                _ => count,
            }
        });
        text += &format!("- {words}: {}.\n", told.join("; "));
    }
    let means = problems(points, "mean");
    for (model, words) in
        [("mdr1d", "The 1D reduction"), ("power_law", "Eq. 12"), ("plateau", "The rigid square")]
    {
        let of = |problem: &&&AccuracyPoint| {
            let row = points.iter().rfind(|p| p.same_problem(problem) && p.model == model)?;
            Some((row.force_bar?, row.error?))
        };
        let found: Vec<(f64, f64)> = means.iter().filter_map(|p| of(&p)).collect();
        let (mut loads, mut told) = (values(points, |p| p.force_bar), Vec::new());
        loads.retain(|f| found.iter().any(|e| e.0.total_cmp(f).is_eq()));
        for load in loads {
            let errors: Vec<f64> =
                found.iter().filter(|e| e.0.total_cmp(&load).is_eq()).map(|e| e.1).collect();
            let (low, high) =
                errors.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), e| (a.min(*e), b.max(*e)));
            told.push(format!("{} to {} at F_bar = {load:?}", percent(low), percent(high)));
        }
        if !told.is_empty() {
            text += &format!("- {words} has the mean of k over surfaces to {}.\n", told.join(", "));
        }
    }
    text
}

fn takes(points: &[AccuracyPoint]) -> String {
    let families = [("sphere", "exact"), ("square", "exact"), ("band", "resolved"), ("spectrum", "fractal")];
    let way = |p: &AccuracyPoint| {
        let method = if p.method == "auto" { String::new() } else { format!(" ({})", p.method) };
        let (cells, tolerance) = (p.size.unwrap_or(0.0), p.tolerance.unwrap_or(0.0));
        format!("{cells:.0}, {tolerance:.0e}{method}, {}", seconds(p.seconds))
    };
    let limit = |e: f64| if e > 0.0 { percent(e) } else { "exactly".to_owned() };
    let row = |(word, problem): (&str, &AccuracyPoint)| {
        let [surface, load] = label(problem);
        let [a, b, c] = TARGETS.map(|target| or_dash(cheapest(points, problem, target), way));
        [word.to_owned(), surface, load, a, b, c, or_dash(problem.reference_error, limit)]
    };
    let all = families
        .into_iter()
        .flat_map(|(family, word)| problems(points, family).into_iter().map(move |problem| (word, problem)));
    markdown_rows(all.map(row))
}

fn less(points: &[AccuracyPoint]) -> String {
    markdown_rows(problems(points, "mean").into_iter().map(|problem| {
        let of = |model: &str| points.iter().rfind(|p| p.same_problem(problem) && p.model == model);
        let error = |model: &str| maybe(of(model).and_then(|p| p.model_error));
        let [surface, load] = label(problem);
        [
            surface,
            load,
            error("mdr1d"),
            seconds(of("mdr1d").and_then(|p| p.seconds)),
            error("power_law"),
            error("plateau"),
            maybe(of("bem3d").and_then(|p| p.ensemble)),
            maybe(problem.reference_error),
        ]
    }))
}

/// The rows of the table, and a sentence on how often each part dominates.
fn parts(points: &[AccuracyPoint], orders: &Orders) -> (String, String) {
    let mut counts = [0_usize; 3];
    let rows = markdown_rows(problems(points, "spectrum").into_iter().map(|problem| {
        let (d, f) = (problem.fractal_dimension, problem.force_bar);
        let algebraic = points
            .iter()
            .filter(|p| {
                p.same_problem(problem)
                    && p.tolerance.is_some_and(|t| (t / PAPER_TOLERANCE - 1.0).abs() < 1e-9)
            })
            .filter_map(|p| p.algebraic)
            .reduce(f64::max);
        let discretisation = orders.at("spectrum", d, f).map(|s| s.carried(orders.finest));
        let mean = |of: fn(&AccuracyPoint) -> Option<f64>, model: &str| {
            let mean = |p: &&AccuracyPoint| {
                p.family == "mean" && p.fractal_dimension == d && p.force_bar == f && p.model == model
            };
            points.iter().filter(mean).filter_map(of).next_back()
        };
        let ensemble = mean(|p| p.ensemble, "bem3d");
        let model = mean(|p| p.model_error, "mdr1d");
        let all = [("algebraic", algebraic), ("discretisation", discretisation), ("ensemble", ensemble)];
        let largest =
            all.iter().enumerate().max_by(|a, b| a.1.1.unwrap_or(0.0).total_cmp(&b.1.1.unwrap_or(0.0)));
        let word = largest.map_or("-", |(i, (name, _))| {
            counts[i] += 1;
            name
        });
        let [surface, load] = label(problem);
        let [algebraic, discretisation, ensemble, model] =
            [algebraic, discretisation, ensemble, model].map(maybe);
        [surface, load, algebraic, discretisation, ensemble, model, word.to_owned()]
    }));
    let total: usize = counts.iter().sum();
    let counts = format!(
        "Of {total} rows the ensemble dominates {}, the discretisation {}, the algebraic error {}.",
        counts[2], counts[1], counts[0]
    );
    (rows, counts)
}

/// A row of the second table.
#[derive(Deserialize)]
struct Sequence {
    family: String,
    fractal_dimension: Option<f64>,
    force_bar: Option<f64>,
    quantity: String,
    order: Option<f64>,
    established: bool,
    limit_error: Option<f64>,
    error_coarsest: Option<f64>,
    error_finest: Option<f64>,
}

impl Sequence {
    /// The error of the finest grid, or the uncertainty of the limit, extrapolated to the paper's grid with
    /// the order of convergence (1/2 where none is observed).
    fn carried(&self, finest: f64) -> f64 {
        let error = self.error_finest.unwrap_or(0.0).max(self.limit_error.unwrap_or(0.0));
        error * (finest / PAPER_CELLS).powf(self.order.unwrap_or(0.5).max(0.0))
    }
}

struct Orders {
    rows: Vec<Sequence>,
    /// Cells a side of the finest grid.
    finest: f64,
}

impl Orders {
    fn read(path: &Path) -> Result<Self> {
        let file = CsvFile::read(path)?;
        // The finest grid is in the header: references at tolerance T on [.., N] cells a side.
        let finest = file
            .comments
            .iter()
            .find_map(|c| c.split_once("] cells a side")?.0.rsplit([',', '[']).next()?.trim().parse().ok())
            .unwrap_or(PAPER_CELLS);
        Ok(Self { rows: read_rows(path, &file)?, finest })
    }

    fn at(&self, family: &str, d: Option<f64>, f: Option<f64>) -> Option<&Sequence> {
        self.rows.iter().find(|s| {
            s.family == family && s.quantity == "stiffness" && s.fractal_dimension == d && s.force_bar == f
        })
    }

    fn text(&self) -> String {
        let key = |s: &Sequence| (s.family.clone(), s.fractal_dimension, s.force_bar);
        let mut known = Vec::new();
        let mut first = |s: &&Sequence| {
            let new = !known.contains(&key(s));
            known.push(key(s));
            new
        };
        let problems = self.rows.iter().filter(|s| s.family != "mean" && first(s));
        markdown_rows(problems.map(|s| {
            let cell = |quantity: &str| {
                let found = self.rows.iter().find(|t| key(t) == key(s) && t.quantity == quantity);
                found.map_or_else(String::new, |t| {
                    let order = or_dash(t.order, |o| format!("{o:.1}"));
                    let order = if t.established { order } else { format!("({order})") };
                    format!("{order}: {}, {}", maybe(t.error_coarsest), maybe(t.error_finest))
                })
            };
            let [d, f] =
                [s.fractal_dimension, s.force_bar].map(|v| v.map_or_else(String::new, |v| format!("{v:?}")));
            let [k, approach, area, pressure] = ["stiffness", "approach", "area", "pressure"].map(cell);
            [s.family.clone(), d, f, k, approach, area, pressure]
        }))
    }
}
