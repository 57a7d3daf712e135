//! Every hard case of the registry is solved, checked by the reference implementation and within its bound.

use tests::stability::{CaseResult, Effort};

#[test]
fn every_hard_case_holds() {
    let verdicts = tests::stability::run(&tests::stability::cases(), Effort::Quick, &|_| ());
    for v in &verdicts {
        println!(
            "{:<42} {:>10.1e} of {:.0e} {}",
            v.case.name,
            v.figure.unwrap_or(f64::NAN),
            v.case.bound,
            v.status()
        );
    }
    let failed: Vec<&CaseResult> = verdicts.iter().filter(|v| !v.passed()).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}
