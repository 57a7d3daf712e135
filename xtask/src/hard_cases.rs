//! The table of hard cases, with the assertions and the values reached.

use ::tests::stability::{self, CaseResult, Effort, HardCase};
use contact_model::ContactModel as _;
use contact_model::Table;
use paper::evaluation::{TableOf, markdown_table};
use runs::files::{create_directory, write_whole};
use runs::{Header, Progress, Result, write_csv};
use std::path::{Path, PathBuf};

/// Solves hard cases ([`stability::cases`]) and writes `stability.csv` and `stability.md` into `out`. Returns
/// the results in the order of the cases, and the files.
///
/// # Errors
/// [`runs::Error::File`] where a file cannot be written. A case that fails is not an error; it has a row.
pub fn hard_cases(
    cases: &[HardCase],
    effort: Effort,
    out: &Path,
    progress: &dyn Progress,
) -> Result<(Vec<CaseResult>, Vec<PathBuf>)> {
    create_directory(out)?;
    progress.begin(&format!("{} hard cases", cases.len()), cases.len() as u64);
    let verdicts = stability::run(cases, effort, &|_| progress.advance(1, false));
    progress.end();
    let [csv, text] = ["stability.csv", "stability.md"].map(|name| out.join(name));
    let command = format!("cargo xtask stability{}", effort.pick("", " --thorough"));
    let header = Header { command, ..Header::default() }.with_sources(bem3d::Bem3d::default().sources());
    write_csv(&csv, &table(&verdicts)?, &header)?;
    write_whole(&text, markdown(&verdicts, effort).as_bytes())?;
    Ok((verdicts, vec![csv, text]))
}

fn table(verdicts: &[CaseResult]) -> Result<Table> {
    const STATUS: &str = "passed, or failed: the figure is beyond its bound or an assertion is broken";
    TableOf::new("Hard cases and what they reach", verdicts)
        .column("case", "-", "name of the case", |v| v.case.name)
        .column("why", "-", "why a solver may fail here", |v| v.case.why)
        .column("asserted", "-", "what must hold besides the certificate of every state", |v| v.case.asserted)
        .column("figure", "1", "largest deviation found; empty where it is no finite number", |v| v.figure)
        .column("bound", "1", "largest figure that passes; 0 where bits or counts are compared", |v| {
            v.case.bound
        })
        .column("status", "-", STATUS, CaseResult::status)
        .table()
}

fn markdown(verdicts: &[CaseResult], effort: Effort) -> String {
    let passed = verdicts.iter().filter(|v| v.passed()).count();
    let row = |v: &CaseResult| {
        let figure = v.figure.map_or_else(|| "none".to_owned(), short);
        let [name, why, asserted, status] =
            [v.case.name, v.case.why, v.case.asserted, v.status()].map(str::to_owned);
        [name, why, asserted, figure, short(v.case.bound), status]
    };
    let mut text = format!(
        "# Hard cases\n\n{passed} of {} pass{}. A figure is the largest relative deviation from what is asserted, or the number of things that \
         differ where the bound is 0; every state meets its tolerance, and most have a witness by plain sums besides.\n\n{}",
        verdicts.len(),
        effort.pick("", ", thorough"),
        markdown_table(
            "| case | why it is hard | what is asserted | figure reached | bound | |\n|---|---|---|---|---|---|",
            verdicts.iter().map(row)
        )
    );
    for v in verdicts.iter().filter(|v| !v.broken.is_empty()) {
        let broken = v.broken.iter().map(|line| ["- ", &line.replace('\n', " "), "\n"].concat());
        text += &["\n", v.case.name, ":\n\n", &broken.collect::<String>()].concat();
    }
    text
}

/// Two digits; 0 where nothing differs.
fn short(v: f64) -> String {
    if v.abs() > 0.0 { format!("{v:.1e}") } else { "0".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::Value;
    use runs::{CsvFile, Silent};

    #[test]
    fn the_table_has_a_row_for_every_case_in_their_order() {
        let dir = tempfile::tempdir().unwrap();
        let cases: Vec<HardCase> = stability::cases().into_iter().take(3).collect();
        let (verdicts, files) = hard_cases(&cases, Effort::Quick, dir.path(), &Silent).unwrap();
        assert_eq!(verdicts.len(), 3);
        let csv = CsvFile::read(&files[0]).unwrap();
        assert_eq!(csv.columns, ["case", "why", "asserted", "figure", "bound", "status"]);
        assert_eq!(csv.texts("case").unwrap(), cases.iter().map(|c| c.name).collect::<Vec<_>>());
        assert_eq!(csv.texts("status").unwrap(), ["passed"; 3]);
        assert_eq!(csv.numbers("figure").unwrap(), verdicts.iter().map(|v| v.figure).collect::<Vec<_>>());
        assert_eq!(csv.numbers("bound").unwrap(), cases.iter().map(|c| Some(c.bound)).collect::<Vec<_>>());
        assert!(csv.comments.contains(&"command: cargo xtask stability".to_owned()));
        let text = std::fs::read_to_string(&files[1]).unwrap();
        assert!(text.contains("3 of 3 pass.") && text.contains("| one cell |"), "{text}");
    }

    #[test]
    fn a_failed_case_is_a_row_with_its_reason() {
        let mut case = stability::cases()[1];
        case.bound = 1e-30;
        let mut verdict = case.run(Effort::Quick);
        verdict.broken.push("k is | off".to_owned());
        let text = markdown(&[verdict.clone()], Effort::Thorough);
        assert!(text.contains("0 of 1 pass, thorough.") && text.contains("| failed |"), "{text}");
        assert!(text.ends_with("- k is | off\n"), "{text}");
        assert_eq!(table(&[CaseResult { figure: None, ..verdict }]).unwrap().rows()[0][3], Value::Empty);
    }
}
