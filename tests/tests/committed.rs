//! The numbers in README and the book, computed again from the committed tables by independent code.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

pub(crate) type Row = BTreeMap<String, String>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

pub(crate) fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// Rows of a CSV, packed or not, below its comments, by column.
pub(crate) fn rows(path: &str) -> Vec<Row> {
    let file = std::fs::File::open(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"));
    let input: Box<dyn std::io::Read> = match path.strip_suffix(".gz") {
        Some(_) => Box::new(flate2::read::GzDecoder::new(file)),
        None => Box::new(file),
    };
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(input);
    reader.deserialize().map(Result::unwrap).collect()
}

/// The `#` lines of a CSV, packed or not, without their mark.
pub(crate) fn comments(path: &str) -> Vec<String> {
    let bytes = std::fs::read(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"));
    let mut text = String::new();
    let read = match path.strip_suffix(".gz") {
        Some(_) => flate2::read::GzDecoder::new(bytes.as_slice()).read_to_string(&mut text),
        None => bytes.as_slice().read_to_string(&mut text),
    };
    read.unwrap();
    text.lines().map_while(|line| line.strip_prefix("# ")).map(str::to_owned).collect()
}

pub(crate) fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {:?}", row[column]))
}

/// Numbers separated by blanks; `None` for `-`.
pub(crate) fn list(row: &Row, column: &str) -> Vec<Option<f64>> {
    row[column].split(' ').map(|word| (word != "-").then(|| word.parse().unwrap())).collect()
}

pub(crate) fn of_dimension(rows: Vec<Row>, d: f64) -> Vec<Row> {
    rows.into_iter().filter(|row| (number(row, "fractal_dimension") - d).abs() < 1e-9).collect()
}

const DIMENSIONS: [f64; 6] = [2.0, 2.2, 2.4, 2.6, 2.8, 3.0];

fn close(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * a.abs().max(b.abs())
}

pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (square / n).sqrt())
}

/// Slope of y over x by least squares.
pub(crate) fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0);
    for p in points {
        x += p.0;
        y += p.1;
        xx += p.0 * p.0;
        xy += p.0 * p.1;
    }
    (n * xy - x * y) / (n * xx - x * x)
}

/// `0.515 ± 0.018`: the number, its half-width, and a unit of the last digit.
fn stated(cell: &str) -> (f64, f64, f64) {
    let (value, half_width) = cell.trim().split_once(" ± ").unwrap_or_else(|| panic!("{cell}"));
    let digits = value.split_once('.').map_or(0, |(_, digits)| digits.len());
    (value.parse().unwrap(), half_width.parse().unwrap(), 0.1_f64.powf(digits as f64))
}

/// Cells of the rows of a Markdown table below the heading line given.
fn table(text: &str, heading: &str) -> Vec<Vec<String>> {
    let mut lines = text.lines().skip_while(|line| *line != heading);
    assert!(lines.next().is_some(), "no table {heading}");
    let body = lines.skip(1).take_while(|line| line.starts_with('|'));
    body.map(|line| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// k_bar of one fractal dimension on the finest grid, from a table such as `paper/fig2`: surface, load.
fn samples(figure: &str, d: f64) -> Vec<Vec<Option<f64>>> {
    let rows = of_dimension(rows(&format!("data/figures/{figure}-compact.csv")), d);
    let finest = rows.iter().map(|row| number(row, "size")).fold(0.0, f64::max);
    let finest = rows.iter().filter(|row| number(row, "size") >= finest);
    finest.map(|row| list(row, "stiffness_bar")).collect()
}

/// ln F_bar and number of the loads up to 0.086 at which every surface has ten cells in contact.
fn resolved(figure: &str, d: f64) -> Vec<(usize, f64)> {
    let curve = of_dimension(rows(&format!("data/figures/{figure}.csv")), d);
    let is_in = |row: &Row| number(row, "force_bar") <= 0.086 && number(row, "min_contact_cells") >= 10.0;
    let all = curve.iter().enumerate().filter(|(_, row)| is_in(row));
    all.map(|(j, row)| (j, number(row, "force_bar").ln())).collect()
}

/// Exponent of the mean over all surfaces but one.
fn exponent(samples: &[Vec<Option<f64>>], loads: &[(usize, f64)], without: Option<usize>) -> f64 {
    let points: Vec<(f64, f64)> = loads
        .iter()
        .map(|&(j, x)| {
            let kept = samples.iter().enumerate().filter(|(i, _)| Some(*i) != without);
            let values: Vec<f64> = kept.map(|(_, s)| s[j].unwrap()).collect();
            (x, (values.iter().sum::<f64>() / values.len() as f64).ln())
        })
        .collect();
    slope(&points)
}

#[test]
fn means_and_errors_follow_from_the_samples() {
    // Seven digits in the compact tables; a standard error loses some of them where surfaces are nearly
    // equal.
    for figure in ["paper/fig2", "paper/fig6"] {
        for d in DIMENSIONS {
            let samples = samples(figure, d);
            let curve = of_dimension(rows(&format!("data/figures/{figure}.csv")), d);
            for (j, row) in curve.iter().enumerate() {
                let values: Vec<f64> = samples.iter().filter_map(|s| s[j]).collect();
                let (mean, error) = mean_and_error(&values);
                let k = number(row, "stiffness_bar");
                assert!(close(mean, k, 1e-6), "{figure}, D_f {d}, load {j}: {mean} and {k}");
                let of_table = number(row, "stiffness_bar_se");
                assert!(
                    (error - of_table).abs() <= 1e-3 * of_table + 1e-6 * k,
                    "{figure}, D_f {d}, load {j}: {error}"
                );
            }
        }
    }
}

#[test]
fn exponents_of_the_page_follow_from_the_samples() {
    let heading = "| D_f | alpha 3D | alpha 1D, same forces | alpha 1D, own forces | Eq. 6 | Eq. 24 |";
    let page = table(&text("book/src/results.md"), heading);
    assert!(page.len() >= 4);
    let fitted = rows("data/figures/paper/fig3.csv");
    for row in &page {
        let d: f64 = row[0].parse().unwrap();
        let of_surfaces = resolved("paper/fig2", d);
        let ends = [of_surfaces[0].1 - 1e-9, of_surfaces[of_surfaces.len() - 1].1 + 1e-9];
        let same_forces = |loads: Vec<(usize, f64)>| -> Vec<(usize, f64)> {
            loads.into_iter().filter(|load| (ends[0]..=ends[1]).contains(&load.1)).collect()
        };
        for (figure, model, column, loads, cell) in [
            ("paper/fig2", "bem3d", "half_width", of_surfaces.clone(), &row[1]),
            (
                "paper/fig6",
                "mdr1d",
                "same_forces_half_width",
                same_forces(resolved("paper/fig6", d)),
                &row[2],
            ),
            ("paper/fig6", "mdr1d", "half_width", resolved("paper/fig6", d), &row[3]),
        ] {
            let samples = samples(figure, d);
            let alpha = exponent(&samples, &loads, None);
            let (value, half_width, unit) = stated(cell);
            assert!((alpha - value).abs() <= 0.501 * unit, "{figure}, D_f {d}: {alpha}, page {cell}");
            // The half-width holds window and grid as well: at least the delete-one jackknife, which differs
            // from the bootstrap by a tenth or so.
            let n = samples.len();
            let each: Vec<f64> = (0..n).map(|i| exponent(&samples, &loads, Some(i))).collect();
            let scatter = 1.96 * mean_and_error(&each).1 * (n as f64 - 1.0);
            assert!(half_width >= 0.85 * scatter - unit, "{figure}, D_f {d}: {scatter}, page {cell}");
            let of_table = fitted
                .iter()
                .find(|r| r["model"] == model && (number(r, "fractal_dimension") - d).abs() < 1e-9);
            let of_table = number(of_table.unwrap(), column);
            assert!(
                (half_width - of_table).abs() <= 0.501 * unit,
                "{figure}, D_f {d}: {of_table}, page {cell}"
            );
        }
        let h = 3.0 - d;
        assert!((row[4].parse::<f64>().unwrap() - 0.266 * d).abs() < 6e-4);
        assert!((row[5].parse::<f64>().unwrap() - 1.0 / (1.0 + h)).abs() < 6e-4);
    }
}

/// "From 0.50 to 0.85" on the new surfaces: the four numbers of hypotheses.md from the samples, their half-widths
/// widened so that all hold together with 95 %, and the verdicts.
#[test]
fn exponents_of_new_surfaces_are_judged_as_it_was_written_down() {
    // Quantiles of the normal distribution: 1 - 0.05/8 for four numbers together, 1 - 0.05/2 for one.
    const TOGETHER: f64 = 2.4977 / 1.9600;
    let heading = "| new surfaces | alpha | allowed | verdict |";
    let page = table(&text("book/src/results.md"), heading);
    let fitted = rows("data/figures/new-surfaces/fig3.csv");
    let mut found = Vec::new();
    for d in [2.0, 3.0] {
        let of_surfaces = resolved("new-surfaces/fig2", d);
        let (first, last) = (of_surfaces[0].1 - 1e-9, of_surfaces[of_surfaces.len() - 1].1 + 1e-9);
        let mut of_lines = resolved("new-surfaces/fig6", d);
        of_lines.retain(|load| (first..=last).contains(&load.1));
        for (words, figure, model, column, loads) in [
            ("surfaces", "fig2", "bem3d", "half_width", of_surfaces),
            ("lines", "fig6", "mdr1d", "same_forces_half_width", of_lines),
        ] {
            let alpha = exponent(&samples(&format!("new-surfaces/{figure}"), d), &loads, None);
            let row = of_dimension(fitted.clone(), d).into_iter().find(|row| row["model"] == model).unwrap();
            let half_width = TOGETHER * number(&row, column);
            let [low, high] = if d < 2.5 { [0.47, 0.53] } else { [0.82, 0.88] };
            let verdict = if alpha - half_width >= low && alpha + half_width <= high {
                "confirmed"
            } else if alpha + half_width < low || alpha - half_width > high {
                "contradicted"
            } else {
                "not resolved"
            };
            found.push([
                format!("{words} with D_f = {d:?}"),
                format!("{alpha:.3} ± {half_width:.3}"),
                format!("{low} to {high}"),
                verdict.to_owned(),
            ]);
        }
    }
    assert_eq!(page, found);
}

/// The page names each statement of the table once, with the verdict of the table.
#[test]
fn verdicts_of_the_page_are_those_of_the_table() {
    let heading = "| statement | where | rows | verdict |";
    let mut statements: BTreeMap<String, String> =
        table(&text("data/figures/paper/verify-table.md"), heading)
            .into_iter()
            .map(|mut cells| (cells.remove(0), cells.remove(2)))
            .collect();
    for line in text("book/src/results.md").lines() {
        let Some((name, _)) = line.strip_prefix("| **").and_then(|line| line.split_once(".** ")) else {
            continue;
        };
        let verdict = line.trim_matches('|').rsplit('|').next().unwrap().trim();
        let of_table =
            statements.remove(name).unwrap_or_else(|| panic!("{name} is no statement, or stands twice"));
        assert_eq!(verdict, of_table, "{name}");
    }
    assert!(statements.is_empty(), "the page has no {:?}", statements.keys());
}

#[test]
fn verdicts_in_readme_and_book_are_counted_in_the_table() {
    let rows = rows("data/figures/paper/verify.csv");
    let mut statements: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in &rows {
        statements.entry(&row["statement"]).or_default().push(row);
    }
    // From the worst: a statement is as its worst row; not resolved where some rows alone have no number.
    let verdicts =
        ["contradicted", "not resolved at this size", "no number here", "matter of convention", "confirmed"];
    let rank = |row: &&Row| verdicts.iter().position(|v| row["verdict"] == *v).unwrap();
    let worst = |rows: &Vec<&Row>| {
        let ranks: Vec<usize> = rows.iter().map(rank).collect();
        let (least, most) = (*ranks.iter().min().unwrap(), *ranks.iter().max().unwrap());
        if least == 2 && most > 2 { 1 } else { least }
    };
    let worst: Vec<usize> = statements.values().map(worst).collect();
    let count = |of: &[usize], verdict: usize| of.iter().filter(|v| **v == verdict).count();
    let all: Vec<usize> = rows.iter().map(|row| rank(&row)).collect();
    let words = verdicts.iter().enumerate().map(|(v, words)| format!("{} {words}", count(&worst, v)));
    let sentence = format!("{} statements: {}", worst.len(), words.collect::<Vec<_>>().join(", "));
    let numbers = (0..5).map(|v| count(&all, v).to_string()).collect::<Vec<_>>().join(", ");
    let detail = format!("({} comparisons: {numbers})", all.len());
    let short = format!(
        "Of the paper's {} statements {} are confirmed and {} are contradicted",
        worst.len(),
        count(&worst, 4),
        count(&worst, 0)
    );
    let page = "book/src/results.md";
    for (file, sentence) in [("README.md", short.clone()), (page, short), (page, sentence), (page, detail)] {
        let words = text(file).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(&sentence), "{file} does not say: {sentence}");
    }
    // An interval decides each verdict: 95 % for all numbers of a statement together, by Bonferroni.
    for (name, rows) in &statements {
        let scatters = |row: &&&Row| row["half_width"].parse().is_ok_and(|half: f64| half > 0.0);
        let level = 0.05 / rows.iter().filter(scatters).count().max(1) as f64;
        for row in rows.iter().filter(|row| !row["here"].is_empty() && !row["remark"].contains("convention"))
        {
            let (here, half) = (number(row, "here"), number(row, "half_width"));
            let factor = if half > 0.0 { normal_beyond(0.5 * level) / 1.959_964 } else { 1.0 };
            let low = row["paper_min"].parse().unwrap_or(f64::NEG_INFINITY);
            let high = row["paper_max"].parse().unwrap_or(f64::INFINITY);
            let (from, to) = (here - factor * half, here + factor * half);
            let verdict = match (from > high || to < low, from >= low && to <= high) {
                (true, _) => "contradicted",
                (_, true) => "confirmed",
                _ => "not resolved at this size",
            };
            if row["verdict"] != "matter of convention" {
                assert_eq!(row["verdict"], verdict, "{name}, {}: {here} +- {half}", row["quantity"]);
            }
        }
    }
}

/// The number that a normal variable exceeds with this probability, by halving.
fn normal_beyond(probability: f64) -> f64 {
    // Continued fraction of the tail (Laplace), beyond 1.5.
    let tail = |x: f64| {
        let fraction = (1..60).rev().fold(x, |below, k| x + f64::from(k) / below);
        (-0.5 * x * x).exp() / (fraction * (2.0 * std::f64::consts::PI).sqrt())
    };
    let (mut low, mut high) = (1.5, 6.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(middle) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn coverage_in_readme_and_book_is_counted_in_the_tables() {
    let readme = text("README.md");
    let page = text("book/src/certificates.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let mut medians = Vec::new();
    for (file, words) in
        [("budget-check", "of the cases with the default seed"), ("budget-check-seed7", "with seed 7")]
    {
        let rows = rows(&format!("data/accuracy/{file}.csv"));
        let inside =
            |row: &Row| number(row, "error") <= number(row, "algebraic") + number(row, "discretisation");
        let share = 100.0 * rows.iter().filter(|row| inside(row)).count() as f64 / rows.len() as f64;
        assert_eq!(rows.len(), 720);
        let sentence = format!("{share:.1} % {words}");
        assert!(page.contains(&sentence), "{sentence}");
        let short = format!("{share:.1} % of the true errors of 720 random cases lie inside the stated one");
        assert!(file != "budget-check" || readme.contains(&short), "{short}");
        // Cases go round eighteen strata: 33 of 40 is the first number that a two-sided test at 1 % rejects.
        for of in 0..18 {
            let inside = rows.iter().skip(of).step_by(18).filter(|row| inside(row)).count();
            assert!(inside >= 34, "{file}, stratum {of}: {inside} of 40");
        }
        let over_budget =
            |row: &Row| number(row, "error") / (number(row, "algebraic") + number(row, "discretisation"));
        let mut ratios: Vec<f64> = rows.iter().map(over_budget).collect();
        ratios.sort_by(f64::total_cmp);
        let median = 0.5 * (ratios[359] + ratios[360]);
        assert!(median >= 0.2, "{file}: {median}");
        medians.push(format!("{median:.2}"));
    }
    let sentence = format!("the median of error over budget is {}", medians.join(" and "));
    assert!(page.contains(&sentence), "{sentence}");
}

#[test]
fn exponents_of_the_two_problems_are_those_of_their_table() {
    let page = text("book/src/results.md");
    let solved: Vec<Row> = rows("data/figures/two-cases/2048/two-cases.csv")
        .into_iter()
        .filter(|r| r["model"] == "bem3d")
        .collect();
    for d in ["2.0", "2.4", "2.8"] {
        let line = page.lines().find(|line| line.starts_with(&format!("| {d} | 1.0"))).unwrap();
        let columns: Vec<&str> = line.split('|').map(str::trim).collect();
        for (column, case, roll_off) in [
            (2, "periodic, roll-off", "4.0"),
            (3, "periodic, roll-off", "16.0"),
            (4, "periodic, fractal", ""),
            (5, "free, fractal", ""),
        ] {
            let of = |row: &&Row| {
                let share = row["area"].parse().unwrap_or(0.0);
                row["case"] == case
                    && row["fractal_dimension"] == d
                    && row["roll_off"] == roll_off
                    && (0.01..=0.2).contains(&share)
            };
            let point = |row: &Row| (number(row, "force_bar").ln(), number(row, "stiffness_bar").ln());
            let points: Vec<(f64, f64)> = solved.iter().filter(of).map(point).collect();
            let alpha = slope(&points);
            let stated = columns[column].split(' ').next().unwrap();
            let decimals = stated.split_once('.').map_or(0, |(_, decimals)| decimals.len());
            assert_eq!(stated, format!("{alpha:.decimals$}"), "{case} {roll_off}, D_f {d}");
        }
    }
}

/// kappa from areas that are extrapolated to small cells, from the means of the table.
#[test]
fn kappa_of_the_page_is_that_of_extrapolated_areas() {
    let page = text("book/src/results.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let mut cases: BTreeMap<[String; 3], Vec<f64>> = BTreeMap::new();
    for row in rows("data/figures/two-cases/2048/two-cases.csv") {
        if row["model"] != "bem3d" || !(0.005..=0.1).contains(&number(&row, "area")) {
            continue;
        }
        let [area, coarser, kappa] = ["area", "area_coarser", "kappa"].map(|column| number(&row, column));
        let case = ["case", "fractal_dimension", "roll_off"].map(|column| row[column].clone());
        cases.entry(case).or_default().push(kappa * (2.0 * area - coarser) / area);
    }
    assert_eq!(cases.len(), 18);
    let all = || cases.values().flatten().copied();
    let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    let sentence = format!("kappa lies between {least:.2} and {most:.2} in all 18 cases");
    assert!(page.contains(&sentence), "{sentence}");
    assert!(least > (8.0 / std::f64::consts::PI).sqrt() && most < (2.0 * std::f64::consts::PI).sqrt());
}

/// ln F_bar and ln k_bar of a curve, at the loads at which every surface has ten cells or elements in contact.
fn curve(figure: &str, d: f64) -> Vec<(f64, f64)> {
    let rows = of_dimension(rows(&format!("data/figures/paper/{figure}.csv")), d);
    let resolved = rows.iter().filter(|row| row["below_floor"] == "false");
    resolved.map(|row| (number(row, "force_bar").ln(), number(row, "stiffness_bar").ln())).collect()
}

/// Between the points of a curve, along straight lines.
fn interpolated(curve: &[(f64, f64)], x: f64) -> f64 {
    let pair = curve.windows(2).find(|pair| pair[0].0 <= x && x <= pair[1].0).unwrap();
    pair[0].1 + (x - pair[0].0) * (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)
}

/// k_bar at F_bar = 0.086 from the samples of the study of the exponent, along a straight line in logarithms between
/// two of its loads.
#[test]
fn stiffness_at_the_crossing_is_that_of_the_larger_samples() {
    let page = text("book/src/results.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let all = rows("data/exponent/exponent.csv");
    for d in [2.0, 2.2, 2.4, 2.6, 2.8] {
        let own = of_dimension(all.clone(), d);
        let own: Vec<&Row> = own
            .iter()
            .filter(|row| row["model"] == "bem3d" && row["convention"] == "measured_rms")
            .filter(|row| row["resolved"] == "true")
            .collect();
        let x = 0.086_f64.ln();
        let at = own.iter().position(|row| number(row, "force_bar").ln() > x).unwrap();
        let [below, above] = [own[at - 1], own[at]];
        let ln = |row: &Row, column: &str| number(row, column).ln();
        let share = (x - ln(below, "force_bar")) / (ln(above, "force_bar") - ln(below, "force_bar"));
        let k = (ln(below, "stiffness_bar")
            + share * (ln(above, "stiffness_bar") - ln(below, "stiffness_bar")))
        .exp();
        let half = |row: &Row| number(row, "stiffness_scatter") + number(row, "stiffness_grid");
        let stated = format!("{k:.4} ± {:.4} for", half(below).max(half(above)));
        assert!(page.contains(&stated), "D_f = {d}: {stated}");
    }
}

/// How k_1D/k_3D changes below F_bar = 0.086, and where it is farthest from 1, as the page says it, from the mean
/// curves at the loads at which every surface has a hundred cells in contact.
#[test]
fn ratios_of_line_and_surface_of_the_page_are_those_of_the_curves() {
    let page = text("book/src/results.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let mut changes = Vec::new();
    let mut farthest = Vec::new();
    for d in DIMENSIONS {
        let [surfaces, lines] = ["fig2", "fig6"].map(|figure| curve(figure, d));
        let ratio = |x: f64| interpolated(&lines, x) - interpolated(&surfaces, x);
        let rows = of_dimension(rows("data/figures/paper/fig2.csv"), d);
        let enough = rows.iter().filter(|row| number(row, "min_contact_cells") >= 100.0);
        let loads: Vec<f64> = enough.map(|row| number(row, "force_bar").ln()).collect();
        changes.push((ratio(loads[0]) - ratio(0.086_f64.ln())).exp());
        let distance = |x: &f64| ratio(*x).abs();
        let most = loads.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        farthest.push(ratio(*most).exp());
    }
    // Numbers of the page in their order, without the half-widths, which are those of verify.csv.
    let after = |words: &str| -> Vec<f64> {
        let at = page.find(words).unwrap_or_else(|| panic!("{words}")) + words.len();
        let sentence = &page[at..at + page[at..].find(" for D_f").unwrap()];
        sentence
            .split([',', 'd'])
            .filter_map(|part| part.trim_start_matches("an").trim().split(' ').next()?.parse().ok())
            .collect()
    };
    let stated = after("changes by a factor of ");
    assert_eq!(stated.len(), 6, "{stated:?}");
    for (stated, found) in stated.iter().zip(&changes) {
        assert!((stated - found).abs() < 0.0051, "{stated}: {changes:?}");
    }
    for stated in
        ["1.26 ± 0.07 (D_f = 2.0)", "1.18 to 1.20 (2.2 to 2.6)", "0.81 ± 0.05 (2.8)", "0.71 ± 0.02 (3.0)"]
    {
        assert!(page.contains(stated), "{stated}");
    }
    let wanted =
        [[1.255, 1.265], [1.175, 1.205], [1.175, 1.205], [1.175, 1.205], [0.805, 0.815], [0.705, 0.715]];
    for (found, [low, high]) in farthest.iter().zip(wanted) {
        assert!((low..=high).contains(found), "{farthest:?}");
    }
}

/// What the one-dimensional reduction makes of rough surfaces, in the table of the book and in every text
/// that says it.
#[test]
fn stiffness_of_lines_over_that_of_surfaces_is_that_of_the_curves() {
    let curves = DIMENSIONS.map(|d| [curve("fig2", d), curve("fig6", d)]);
    let page = text("book/src/theories-rough.md");
    for row in table(&page, "| F_bar | D_f = 2.0 | 2.2 | 2.4 | 2.6 | 2.8 | 3.0 |") {
        let x = row[0].parse::<f64>().unwrap().ln();
        let ratios = curves.each_ref().map(|[surfaces, lines]| {
            format!("{:.2}", (interpolated(lines, x) - interpolated(surfaces, x)).exp())
        });
        assert_eq!(row[1..], ratios, "F_bar = {}", row[0]);
    }
    let ratios = |from: f64, to: f64| {
        let of = |[surfaces, lines]: &[Vec<(f64, f64)>; 2]| -> Vec<f64> {
            let at = surfaces.iter().filter(|(x, _)| (from..=to).contains(&x.exp()));
            at.map(|(x, k)| (interpolated(lines, *x) - k).exp()).collect()
        };
        let all: Vec<f64> = curves.iter().flat_map(of).collect();
        let [least, most] = [f64::min, f64::max].map(|of| all.iter().copied().reduce(of).unwrap());
        [least, most]
    };
    let [least, most] = ratios(0.0, f64::INFINITY);
    let all = format!("{least:.2} to {most:.2} times");
    let [least, most] = ratios(0.999, 1.001).map(|ratio| 100.0 * (ratio - 1.0));
    let at_one = format!("{least:.0} to {most:.0} %");
    let accuracy = fractal_contact::models::ModelRecord::named("mdr1d").unwrap().accuracy;
    let front = text("crates/mdr1d/src/lib.rs");
    for (what, said) in [(page.as_str(), &all), (accuracy, &all), (&front, &all), (&front, &at_one)] {
        let what = what.replace("\n//!", "").replace('\n', " ");
        assert!(what.contains(said.as_str()), "{said} in {what}");
    }
}

/// The free square is the periodic one and a rigid square punch in series.
#[test]
fn free_and_periodic_stiffnesses_differ_by_a_punch_in_series() {
    let solved = rows("data/figures/two-cases/two-cases.csv");
    let mut worst: f64 = 0.0;
    for spectrum in ["fractal", "roll-off"] {
        let of = |boundary: &str| {
            let case = format!("{boundary}, {spectrum}");
            let rows = solved.iter().filter(|row| row["model"] == "bem3d" && row["case"] == case);
            // k_bar is over 1.1419 E* L.
            rows.map(|row| 1.1419 * number(row, "stiffness_bar")).collect::<Vec<_>>()
        };
        let (free, periodic) = (of("free"), of("periodic"));
        assert_eq!([free.len(), periodic.len()], [19; 2]);
        for (free, periodic) in free.iter().zip(periodic) {
            let rule = 1.0 / (1.0 / periodic + 1.0 / 1.1523);
            worst = worst.max((rule / free - 1.0).abs());
        }
    }
    let said = format!("k_free within {:.1} %", 100.0 * worst);
    assert!(text("book/src/boundaries.md").contains(&said), "{said}");
}

/// The surfaces of the study of partial slip with this load and Poisson's ratio.
fn slip_samples<'a>(all: &'a [Row], boundary: &str, at: [f64; 3]) -> BTreeMap<&'a str, &'a Row> {
    let own = all.iter().filter(|row| {
        row["model"] == "bem3d"
            && row["boundary"] == boundary
            && ["fractal_dimension", "force_bar", "poisson"]
                .iter()
                .zip(at)
                .all(|(column, value)| (number(row, column) - value).abs() < 1e-9)
    });
    own.map(|row| (row["surface"].as_str(), row)).collect()
}

/// Student's 97.5 % quantile, by Cornish and Fisher's series.
pub(crate) fn student(freedom: f64) -> f64 {
    let z = 1.959_964_f64;
    z + (z.powi(3) + z) / (4.0 * freedom)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * freedom * freedom)
}

#[test]
fn means_of_partial_slip_are_those_of_its_samples() {
    let agree = |values: &[f64], row: &Row, column: &str| {
        let (mean, error) = mean_and_error(values);
        let half = student(values.len() as f64 - 1.0) * error;
        let (stated, stated_half) = (number(row, column), number(row, &format!("{column}_half")));
        assert!((mean - stated).abs() < 2e-6, "{column}: {mean}, stated {stated}");
        assert!((half - stated_half).abs() < 0.01 * half + 2e-6, "{column}: {half}, stated {stated_half}");
    };
    let all = rows("data/partial-slip/partial-slip-samples.csv");
    for row in rows("data/partial-slip/partial-slip-stiffness.csv") {
        let [d, force, nu] = ["fractal_dimension", "force_bar", "poisson"].map(|column| number(&row, column));
        let mindlin = (2.0 - 2.0 * nu) / (2.0 - nu);
        let surfaces = slip_samples(&all, &row["boundary"], [d, force, nu]);
        assert!(surfaces.len() >= 8);
        let [xx, yy] =
            ["k_xx", "k_yy"].map(|k| surfaces.values().map(|s| number(s, k) / mindlin).collect::<Vec<_>>());
        agree(&xx, &row, "ratio_x");
        agree(&yy, &row, "ratio_y");
        let middle: Vec<f64> = xx.iter().zip(&yy).map(|(x, y)| 0.5 * (x + y)).collect();
        agree(&middle, &row, "ratio");
    }
    let shares = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95];
    for row in rows("data/partial-slip/partial-slip.csv").iter().filter(|row| number(row, "poisson") > 0.2) {
        let [d, force, nu, share] =
            ["fractal_dimension", "force_bar", "poisson", "share"].map(|column| number(row, column));
        let place = shares.iter().position(|s| (s - share).abs() < 1e-9).unwrap();
        let [solved, without] = [nu, 0.0].map(|nu| slip_samples(&all, "free", [d, force, nu]));
        let value = |row: &Row, column: &str| list(row, column)[place].unwrap();
        agree(&solved.values().map(|s| value(s, "stick")).collect::<Vec<_>>(), row, "stick");
        let miss = solved
            .iter()
            .map(|(surface, s)| value(without[surface], "displacement") / value(s, "displacement") - 1.0);
        agree(&miss.collect::<Vec<_>>(), row, "displacement_miss");
    }
}
