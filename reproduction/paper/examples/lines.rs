//! Exponents of ensembles of equivalent lines for three fractal dimensions, compared with the scaling 1/(1 +
//! H) of Eq. 24.
//!
//! `cargo run -p fractal-contact-paper --example lines -- DIRECTORY`
//!
//! ```text
//! quantity                              paper          here, 95 %  verdict
//! alpha of lines, D_f = 2        0.47 to 0.53      0.4994 +- 0.02  confirmed
//! alpha of lines, D_f = 2.2  0.5256 to 0.5856      0.5561 +- 0.01  confirmed
//! alpha of lines, D_f = 2.4    0.595 to 0.655       0.629 +- 0.01  confirmed
//! 3 comparisons: 0 contradicted, 0 not resolved at this size, 0 matter of convention, 3 confirmed
//! ```

use analysis::FitWindow;
use paper::evaluation::{EnsembleModel, Request, Result, Run, Session, laws, measure};
use paper::{Claim, Estimate, Statement, Verdict, plain};
use runs::Silent;
use std::path::PathBuf;

const SCALING: Statement = Statement {
    name: "Eq. 24",
    quotation: "alpha = 1/(1 + H)",
    place: "Eq. 24",
    reading: "to 0.03, on lines of 2^16 elements",
};

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let request = Request {
        elements: Some(1 << 16),
        lines: Some(40),
        fractal_dimensions: Some(vec![2.0, 2.2, 2.4]),
        forces: Some("1e-5:0.086:16".to_owned()),
        out: Some(out.join("lines")),
        ..Request::default()
    };
    let run = Run::new(&request)?;
    let measured = measure(EnsembleModel::Mdr1d, &run, &Session::open(&run.out, run.fresh)?.store, &Silent)?;
    let mut claims = Vec::new();
    for (series, fit) in measured.series.iter().zip(laws(&measured, &FitWindow::PAPER)) {
        let (Ok(fit), d) = (fit, series.fractal_dimension) else { continue };
        let scaling = analytic::exponent_scaling(3.0 - d);
        let name = format!("alpha of lines, D_f = {d}");
        let Some(alpha) = Estimate::normal(fit.alpha, fit.alpha_se) else { continue };
        // Finite lines bend the law; the book's table has the same at 2^20 elements.
        claims.push(Claim::judge(name, SCALING, [scaling - 0.03, scaling + 0.03], alpha, ""));
    }
    println!("{}", plain(&claims));
    assert_eq!(claims.len(), 3);
    assert!(claims.iter().all(|c| c.verdict == Verdict::Confirmed));
    Ok(())
}
