//! The study of partial slip on several grids, and the numbers of its page, computed again from the samples by
//! independent code.

use crate::committed::{Row, list, mean_and_error, number, rows, student, text};
use std::collections::BTreeMap;

const PAGE: &str = "book/src/partial-slip.md";
const SHARES: [f64; 10] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95];
const FORCES: [f64; 3] = [0.05, 0.2, 1.0];
const DIMENSIONS: [f64; 2] = [2.2, 2.8];
/// Surfaces below this number were known when the hypotheses were written.
const SEEN: usize = 10;

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

fn share(at: f64) -> usize {
    SHARES.iter().position(|s| same(*s, at)).unwrap()
}

/// A number of each surface, from the coarsest grid to the finest.
type SurfaceNumbers = BTreeMap<usize, Vec<f64>>;

fn on_grids(all: &[Row], column: &str, [d, force, nu]: [f64; 3], at: f64) -> SurfaceNumbers {
    let mut found: BTreeMap<usize, BTreeMap<usize, f64>> = BTreeMap::new();
    for row in all.iter().filter(|row| {
        let is = |column, value| same(number(row, column), value);
        is("fractal_dimension", d) && is("force_bar", force) && is("poisson", nu)
    }) {
        let surface = found.entry(number(row, "surface") as usize).or_default();
        surface.insert(number(row, "cells") as usize, list(row, column)[share(at)].unwrap());
    }
    found.into_iter().map(|(surface, by_cells)| (surface, by_cells.into_values().collect())).collect()
}

/// Mean, standard error and discretisation error.
#[derive(Clone, Copy)]
struct StudyMean {
    mean: f64,
    error: f64,
    grid: f64,
    surfaces: usize,
}

impl StudyMean {
    fn half(&self) -> f64 {
        student(self.surfaces as f64 - 1.0) * self.error
    }

    /// Scatter at 95 % and grid together.
    fn whole(&self) -> f64 {
        self.half() + self.grid
    }
}

/// The limit of small cells, as `hypotheses.md` defines it.
fn limit(surfaces: &[Vec<f64>]) -> StudyMean {
    let line = |values: &[f64], n: usize| 2.0 * values[n] - values[n - 1];
    let last = surfaces[0].len() - 1;
    let limits: Vec<f64> = surfaces.iter().map(|values| line(values, last)).collect();
    let (mean, error) = mean_and_error(&limits);
    let of =
        |value: &dyn Fn(&Vec<f64>) -> f64| surfaces.iter().map(value).sum::<f64>() / surfaces.len() as f64;
    let reach = (mean - of(&|values| values[last])).abs();
    let grid =
        if last == 1 { reach } else { (1.5 * (mean - of(&|values| line(values, 1))).abs()).max(0.5 * reach) };
    StudyMean { mean, error, grid, surfaces: surfaces.len() }
}

/// The finest grid.
fn finest(surfaces: &[Vec<f64>]) -> StudyMean {
    let of = |n: usize| surfaces.iter().map(|values| values[n]).collect::<Vec<f64>>();
    let (mean, error) = mean_and_error(&of(2));
    let differences: Vec<[f64; 2]> = surfaces.iter().map(|v| [v[1] - v[2], v[0] - v[1]]).collect();
    let known = analysis::KnownPart::default();
    let grid = analysis::mean_grid_error(&differences, known, surfaces.len()).unwrap();
    StudyMean { mean, error, grid, surfaces: surfaces.len() }
}

fn samples() -> Vec<Row> {
    rows("data/partial-slip/partial-slip-grid-samples.csv")
}

fn whole(surfaces: SurfaceNumbers) -> Vec<Vec<f64>> {
    surfaces.into_values().collect()
}

/// Samples have six decimals.
const DIGITS: f64 = 3e-6;

#[test]
fn limits_of_small_cells_are_those_of_the_samples() {
    let all = samples();
    let table = rows("data/partial-slip/partial-slip-grids.csv");
    let limits: Vec<&Row> = table.iter().filter(|row| row["cells"].is_empty()).collect();
    assert_eq!(limits.len(), 2 * 3 * 2 * SHARES.len());
    for row in limits {
        let [d, force, nu, at] =
            ["fractal_dimension", "force_bar", "poisson", "share"].map(|column| number(row, column));
        let agree = |found: StudyMean, column: &str| {
            let stated = [column.to_owned(), format!("{column}_half"), format!("{column}_grid")]
                .map(|c| number(row, &c));
            for (stated, found) in stated.into_iter().zip([found.mean, found.half(), found.grid]) {
                assert!((stated - found).abs() < DIGITS + 1e-3 * found, "{column} {row:?}: {found}");
            }
            assert_eq!(number(row, "surfaces") as usize, found.surfaces);
        };
        let surfaces = |column| whole(on_grids(&all, column, [d, force, nu], at));
        agree(limit(&surfaces("stick")), "stick");
        if same(nu, 0.0) {
            agree(limit(&surfaces("stick_corrected")), "stick_corrected");
            agree(finest(&surfaces("stiffness")), "stiffness");
        } else {
            assert!(row["stick_corrected"].is_empty() && row["stiffness"].is_empty());
        }
    }
}

/// The number that a test of `hypotheses.md` is about, of the surfaces that it takes.
fn tested(all: &[Row], row: &Row) -> StudyMean {
    let [force, at] = ["force_bar", "share"].map(|column| number(row, column));
    let dimensions: Vec<f64> = row["fractal_dimension"].split(" - ").map(|d| d.parse().unwrap()).collect();
    let column = if row["family"] == "C" { "stiffness" } else { "stick" };
    let mut surfaces = on_grids(all, column, [dimensions[0], force, 0.0], at);
    if let Some(&other) = dimensions.get(1) {
        for (i, values) in on_grids(all, column, [other, force, 0.0], at) {
            surfaces.get_mut(&i).unwrap().iter_mut().zip(values).for_each(|(a, b)| *a -= b);
        }
    }
    surfaces.retain(|&i, _| match row["sample"].as_str() {
        "seen" => i < SEEN,
        "new" => i >= SEEN,
        _ => true,
    });
    if row["family"] == "C" { finest(&whole(surfaces)) } else { limit(&whole(surfaces)) }
}

#[test]
fn tests_of_the_hypotheses_are_those_of_the_samples() {
    let all = samples();
    let table = rows("data/partial-slip/partial-slip-grid-tests.csv");
    assert_eq!(table.len(), 3 * (12 + 6 + 3 + 6));
    for row in &table {
        let found = tested(&all, row);
        let near = |column: &str, value: f64| {
            let stated = number(row, column);
            assert!((stated - value).abs() < DIGITS + 1e-3 * value.abs(), "{column} {row:?}: {value}");
        };
        let at = number(row, "share");
        let (of, expected) = match row["family"].as_str() {
            "A" => (12.0, 1.0 - at),
            "B" => (6.0, 0.0),
            "C" => (3.0, 0.0),
            _ => (6.0, (1.0 - at).powf(0.93)),
        };
        near("of", of);
        near("expected", expected);
        near("surfaces", found.surfaces as f64);
        near("found", found.mean);
        near("grid", found.grid);
        let level = 1.0 - 0.5 * 0.05 / of;
        let scatter = analysis::student_at(level, found.surfaces as f64 - 1.0) * found.error;
        near("scatter", scatter);
        let away = (found.mean - expected).abs() - scatter - found.grid;
        let verdict = if away > 0.0 { "rejected" } else { "not rejected" };
        assert!(away.abs() < 1e-5 || row["verdict"] == verdict, "{row:?}");
    }
}

/// All of a surface in the first study: boundary, model and the place of the row.
fn first_study<'a>(all: &'a [Row], model: &str, boundary: &str, [d, force, nu]: [f64; 3]) -> Vec<&'a Row> {
    let own = all.iter().filter(|row| {
        let is = |column, value| same(number(row, column), value);
        row["model"] == model
            && row["boundary"] == boundary
            && is("fractal_dimension", d)
            && is("force_bar", force)
            && (model == "equivalent" || is("poisson", nu))
    });
    own.collect()
}

/// The page without its line ends.
fn page() -> String {
    text(PAGE).split_whitespace().collect::<Vec<_>>().join(" ")
}

fn mindlin(nu: f64) -> f64 {
    (2.0 - 2.0 * nu) / (2.0 - nu)
}

/// The smallest and the largest number, in per cent with these decimals: `0.26 to 0.28 %`.
fn range(values: &[f64], decimals: usize) -> String {
    let [low, high] = [f64::min, f64::max].map(|f| 100.0 * values.iter().copied().reduce(f).unwrap());
    format!("{low:.decimals$} to {high:.decimals$} %")
}

/// The samples of the first study.
fn first_samples() -> Vec<Row> {
    rows("data/partial-slip/partial-slip-samples.csv")
}

/// The mean tangential over the normal stiffness, over Mindlin's ratio, less 1.
fn over_mindlin(row: &Row) -> f64 {
    0.5 * (number(row, "k_xx") + number(row, "k_yy")) / mindlin(number(row, "poisson")) - 1.0
}

#[test]
fn the_samples_hold_the_bound_and_the_page_has_their_range() {
    let (all, page) = (first_samples(), page());
    // The theorem, with the tolerance 1e-5 of the solves.
    let own: Vec<&Row> = all.iter().filter(|row| row["model"] == "bem3d").collect();
    assert_eq!(own.len(), 600);
    assert!(own.iter().all(|row| over_mindlin(row) > -1e-5));
    let with: Vec<f64> =
        own.iter().filter(|row| number(row, "poisson") > 0.0).map(|row| over_mindlin(row)).collect();
    assert_eq!(with.len(), 480);
    let said = format!("in the {} solved states with nu > 0 is {}", with.len(), range(&with, 2));
    assert!(page.contains(&said), "{said}");
}

#[test]
fn the_page_has_the_mean_ratios_of_stiffnesses_of_the_samples() {
    let (all, page) = (first_samples(), page());
    // In units of (nu/(2 - nu))^2.
    let mut largest: f64 = 0.0;
    for boundary in ["free", "periodic"] {
        let mut in_squares = Vec::new();
        for d in DIMENSIONS {
            let mut cells = vec![boundary.to_owned(), format!("{d}")];
            for nu in [0.15, 0.3, 0.45, 0.5] {
                let means = FORCES.map(|force| {
                    let surfaces = first_study(&all, "bem3d", boundary, [d, force, nu]);
                    let each: Vec<f64> = surfaces.into_iter().map(over_mindlin).collect();
                    assert_eq!(each.len(), 10);
                    let (mean, error) = mean_and_error(&each);
                    largest = largest.max(student(9.0) * error);
                    mean
                });
                in_squares.extend(means.map(|mean| mean / (nu / (2.0 - nu)).powi(2)));
                if nu > 0.2 && !same(nu, 0.45) {
                    cells.push(range(&means, 2));
                }
            }
            let row = format!("| {} |", cells.join(" | "));
            assert!(page.contains(&row), "{row}");
        }
        let [low, high] = [f64::min, f64::max].map(|f| in_squares.iter().copied().reduce(f).unwrap());
        let said = format!("{low:.2} to {high:.2} with {boundary} boundaries");
        assert!(page.contains(&said), "{said}");
    }
    let said = format!("half-widths are at most {:.2} %", 100.0 * largest);
    assert!(page.contains(&said), "{said}");
}

#[test]
fn the_page_has_the_shares_in_contact_of_the_samples() {
    let (all, page) = (first_samples(), page());
    let contacts: Vec<f64> = rows("data/partial-slip/partial-slip-stiffness.csv")
        .iter()
        .map(|row| {
            let at = ["fractal_dimension", "force_bar", "poisson"].map(|column| number(row, column));
            let surfaces = first_study(&all, "bem3d", &row["boundary"], at);
            mean_and_error(&surfaces.iter().map(|s| number(s, "contact")).collect::<Vec<_>>()).0
        })
        .collect();
    let [low, high] = [f64::min, f64::max].map(|f| 100.0 * contacts.iter().copied().reduce(f).unwrap());
    let said = format!("In the mean {low:.1} to {high:.0} % of the square are in contact");
    assert!(page.contains(&said), "{said}");
}

#[test]
fn the_page_has_the_anisotropy_of_the_samples() {
    let (all, page) = (first_samples(), page());
    let anisotropy = |force| {
        let of = |row: &&Row| {
            let [xx, yy, xy] = ["k_xx", "k_yy", "k_xy"].map(|column| number(row, column));
            (xx - yy).hypot(2.0 * xy) / (0.5 * (xx + yy))
        };
        let each: Vec<f64> = first_study(&all, "bem3d", "free", [2.2, force, 0.5]).iter().map(of).collect();
        let (mean, error) = mean_and_error(&each);
        format!("{:.1} ± {:.1} %", 100.0 * mean, 100.0 * student(9.0) * error)
    };
    for said in [0.05, 1.0].map(anisotropy) {
        assert!(page.contains(&said), "{said}");
    }
}

#[test]
fn the_page_has_the_errors_of_approximations_of_the_samples() {
    let (all, page) = (first_samples(), page());
    // Mean and half-width of approximation over solution less 1 in all six states.
    let errors = |model: &str, column: &str, place: usize, nu: f64| -> Vec<(f64, f64)> {
        let states = DIMENSIONS.into_iter().flat_map(|d| FORCES.map(|force| [d, force]));
        let of = |[d, force]: [f64; 2]| {
            let value = |row: &Row| list(row, column)[place].unwrap();
            let solved = first_study(&all, "bem3d", "free", [d, force, nu]);
            let approximate = first_study(&all, model, "free", [d, force, 0.0]);
            assert_eq!([solved.len(), approximate.len()], [10; 2]);
            let each: Vec<f64> = (solved.iter().zip(&approximate))
                .map(|(s, a)| if column == "traction" { value(s) } else { value(a) / value(s) - 1.0 })
                .collect();
            let (mean, error) = mean_and_error(&each);
            (mean, student(9.0) * error)
        };
        states.map(of).collect()
    };
    for (name, column, at, place, sign, decimals) in [
        ("displacement too large by", "displacement", 0.3, 2, 1.0, 2),
        ("displacement too large by", "displacement", 0.6, 5, 1.0, 2),
        ("energy of a cycle too small by", "dissipated", 0.6, 1, -1.0, 1),
        ("energy of a cycle too small by", "dissipated", 0.9, 2, -1.0, 1),
        ("tractions, root mean square", "traction", 0.3, 2, 1.0, 1),
        ("tractions, root mean square", "traction", 0.9, 8, 1.0, 1),
    ] {
        let cells = [0.3, 0.5].map(|nu| {
            let found = errors("bem3d", column, place, nu);
            let means: Vec<f64> = found.iter().map(|f| sign * f.0).collect();
            let half = found.iter().map(|f| f.1).fold(0.0, f64::max);
            format!("{} | {:.decimals$} %", range(&means, decimals), 100.0 * half)
        });
        let row = format!("| {name} | {at} | {} | {} |", cells[0], cells[1]);
        assert!(page.contains(&row), "{row}");
    }
    // (c/a)^2 of `equivalent` under all tangential forces.
    let stick = (0..SHARES.len()).flat_map(|place| errors("equivalent", "stick", place, 0.3));
    let worst = stick.map(|f| f.0).fold(0.0, f64::min);
    let said = format!("by up to {:.0} %", -100.0 * worst);
    assert!(page.contains(&said), "{said}");
    for (column, words, places) in
        [("displacement", "displacement is", SHARES.len()), ("dissipated", "energies are", 3)]
    {
        let all = (0..places).flat_map(|place| errors("equivalent", column, place, 0.3));
        let worst = all.map(|f| f.0.abs()).fold(0.0, f64::max);
        let said = format!("{words} within {:.1} %", 100.0 * worst);
        assert!(page.contains(&said), "{said}");
    }
}

#[test]
fn the_page_has_the_limits_of_small_cells_of_the_samples() {
    let (all, page) = (samples(), page());
    let mut over = Vec::new();
    let mut correction: f64 = 0.0;
    let mut friction: f64 = 0.0;
    let mut excess: f64 = 0.0;
    for d in DIMENSIONS {
        for force in FORCES {
            let of = |column, at| whole(on_grids(&all, column, [d, force, 0.0], at));
            let [half, most] = [0.5, 0.9].map(|at| limit(&of("stick", at)));
            let power = |share: f64| share.ln() / 0.1_f64.ln();
            let stiffness = finest(&of("stiffness", 0.5));
            let plain = |of: &StudyMean| format!("{:.3} ± {:.3}", of.mean, of.whole());
            let row = format!(
                "| {d} | {force} | {} | {} | {:.2} ({:.2} to {:.2}) | {} |",
                plain(&half),
                plain(&most),
                power(most.mean),
                power(most.mean + most.whole()),
                power(most.mean - most.whole()),
                plain(&stiffness)
            );
            assert!(page.contains(&row), "{row}");
            for at in SHARES {
                excess = excess.max(limit(&of("stick", at)).mean - (1.0 - at));
            }
            over.push(
                mean_and_error(&of("stick", 0.9).iter().map(|v| v[0]).collect::<Vec<_>>()).0 - most.mean,
            );
            for (at, found) in [(0.5, half), (0.9, most)] {
                correction = correction.max((limit(&of("stick_corrected", at)).mean - found.mean).abs());
            }
            // On 256 cells, under all tangential forces.
            for at in SHARES {
                let with = whole(on_grids(&all, "stick", [d, force, 0.3], at));
                let differences: Vec<f64> =
                    with.iter().zip(of("stick", at)).map(|(a, b)| a[1] - b[1]).collect();
                assert_eq!(differences.len(), 40);
                friction = friction.max(mean_and_error(&differences).0.abs());
            }
        }
    }
    let cells = all.iter().map(|row| number(row, "contact_cells") as usize).min().unwrap();
    let [low, high] = [f64::min, f64::max].map(|f| over.iter().copied().reduce(f).unwrap());
    for said in [
        format!("the lightest contacts have {cells} cells in all"),
        format!("is between 1 - Q/(mu F) and {excess:.2} above it"),
        format!("is too large by {low:.3} to {high:.3}."),
        format!("have the same limit within {correction:.4}."),
        format!("the mean share differs from that of nu = 0 on the same 256 cells by {friction:.4} at most"),
    ] {
        assert!(page.contains(&said), "{said}");
    }
    for h in [0.8_f64, 0.2] {
        let said = format!("{:.2} for H = {h}", 0.5_f64.powf(1.0 / (1.0 + h)));
        assert!(page.contains(&said), "{said}");
    }
}

#[test]
fn the_page_has_the_tests_of_the_hypotheses() {
    let (table, page) = (rows("data/partial-slip/partial-slip-grid-tests.csv"), page());
    let test = |family: &str, force: f64, at: f64| {
        let is = |row: &&Row| {
            row["family"] == family
                && row["sample"] == "new"
                && same(number(row, "force_bar"), force)
                && same(number(row, "share"), at)
        };
        table.iter().filter(is).collect::<Vec<_>>()
    };
    for force in FORCES {
        let cells = [("B", 0.5), ("B", 0.9), ("C", 0.5)].map(|(family, at)| {
            let row = test(family, force, at)[0];
            let half = number(row, "scatter") + number(row, "grid");
            format!("{:.3} ± {half:.3}", number(row, "found"))
        });
        let row = format!("| {force} | {} |", cells.join(" | "));
        assert!(page.contains(&row), "{row}");
    }
    // The verdicts that the page tells: D_f, F_bar and Q/(mu F) of those that are rejected.
    let rejected = |family: &str| -> Vec<String> {
        let own = table.iter().filter(|row| row["family"] == family && row["sample"] == "new");
        let own = own.filter(|row| row["verdict"] == "rejected");
        own.map(|row| [&*row["fractal_dimension"], &*row["force_bar"], &*row["share"]].join(" ")).collect()
    };
    let of_22 = ["2.2 0.05 0.9", "2.2 0.2 0.5", "2.2 0.2 0.9", "2.2 1.0 0.5", "2.2 1.0 0.9"];
    assert_eq!(rejected("A"), [&of_22[..], &["2.8 1.0 0.5", "2.8 1.0 0.9"]].concat());
    assert_eq!(rejected("B"), ["2.2 - 2.8 1.0 0.5", "2.2 - 2.8 1.0 0.9"]);
    assert_eq!(rejected("C"), ["2.2 - 2.8 0.05 0.5", "2.2 - 2.8 0.2 0.5"]);
    assert_eq!(rejected("D"), ["2.8 0.2 0.9", "2.8 1.0 0.9"]);
}
