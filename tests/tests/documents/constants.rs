//! Tables of the tuned constants, from their source and from the measured cost of half and of twice the
//! value.

use super::sources::{DocumentedConstant, constants, files, members};
use super::{readmes::plain, root, table};
use std::collections::BTreeMap;

/// Columns of `data/bench/tuning.csv` for one constant.
type Multiples = BTreeMap<String, [String; 2]>;

/// Applications, and time in brackets, with half and with twice of each constant.
fn measured() -> Multiples {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(root().join("data/bench/tuning.csv"))
        .unwrap();
    let heads = [
        "time_half",
        "time_twice",
        "applications_half",
        "applications_twice",
        "converged_half",
        "converged_twice",
    ];
    assert_eq!(reader.headers().unwrap().iter().skip(1).collect::<Vec<_>>(), heads);
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        let multiple = |i: usize| {
            let missed = if &row[5 + i] == "yes" { "" } else { ", not converged" };
            format!("{:.2} ({:.2}){missed}", number(3 + i), number(1 + i))
        };
        (row[0].to_owned(), [multiple(0), multiple(1)])
    });
    rows.collect()
}

/// Members of `Tuning`.
pub fn tuning() -> String {
    let measured = measured();
    let mut used = 0;
    let found = members(&root().join("crates/bem3d/src/tuning.rs"));
    let mut rows = Vec::new();
    for constant in &found {
        let ends: Vec<&[String; 2]> = ["", ".0", ".1"]
            .iter()
            .filter_map(|end| measured.get(&format!("{}{end}", constant.name)))
            .collect();
        used += ends.len();
        let cell = |i: usize| match ends[..] {
            [] => "not measured".to_owned(),
            _ => ends.iter().map(|end| end[i].as_str()).collect::<Vec<_>>().join("; "),
        };
        let mut row = cells(constant);
        row.extend([cell(0), cell(1)]);
        rows.push(row);
    }
    assert_eq!(used, measured.len(), "rows of data/bench/tuning.csv that name no constant");
    table(&["constant", "value", "meaning", "half of it", "twice of it"], rows)
}

/// Constants of the compiled code in the same file.
pub fn layout() -> String {
    let found = constants(&root().join("crates/bem3d/src/tuning.rs"));
    table(&["constant", "value", "meaning"], found.iter().map(cells))
}

/// The other constants of `bem3d`.
pub fn others() -> String {
    let source = root().join("crates/bem3d/src");
    let mut rows = Vec::new();
    for file in files(&source, ".rs") {
        let name = file.strip_prefix(&source).unwrap().to_string_lossy().replace('\\', "/");
        if name != "tuning.rs" && name != "lib.rs" {
            let place = |constant: &DocumentedConstant| [vec![format!("`{name}`")], cells(constant)].concat();
            rows.extend(constants(&file).iter().map(place));
        }
    }
    table(&["file", "constant", "value", "meaning"], rows)
}

fn cells(constant: &DocumentedConstant) -> Vec<String> {
    vec![format!("`{}`", constant.name), format!("`{}`", constant.value), plain(&constant.meaning)]
}

#[test]
fn every_constant_has_a_meaning() {
    for file in files(&root().join("crates/bem3d/src"), ".rs") {
        for constant in constants(&file) {
            assert!(!constant.meaning.is_empty(), "{}: {}", file.display(), constant.name);
        }
    }
}
