//! The error budget of a small ensemble: the parts of solver, grid and number of surfaces in the error of the
//! mean stiffness.
//!
//! `cargo run -p fractal-contact-paper --example error_budget -- DIRECTORY`
//!
//! ```text
//!   F_bar    k_bar     solver           grid  surfaces
//!    0.01   0.0641   0.0000 %         18.3 %    30.6 %
//!     0.1   0.2453   0.0000 %          3.8 %    15.9 %
//!       1   0.6490   0.0016 %          1.1 %     6.6 %
//!      10   0.9899   0.0021 %          0.4 %     0.1 %
//! fig2: accuracy reached (95 % half-width of the mean k_bar, 3 rows without floor): 16.30 % or better, half of them 6.72 %; the widest at D_f = 2.4, F_bar = 1.000e-1
//! ```

use paper::evaluation::{EnsembleModel, Request, Result, Run, state_budgets};
use runs::{CsvFile, Reporter};
use std::path::PathBuf;

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let request = Request {
        cells: Some(65),
        surfaces: Some(6),
        fractal_dimensions: Some(vec![2.4]),
        forces: Some("0.01:10:4".to_owned()),
        out: Some(out.join("error-budget")),
        ..Request::default()
    };
    // Solved surfaces are kept in the directory: the second run of this example reads them back.
    let outcome = state_budgets(&Run::new(&request)?, &[EnsembleModel::Bem3d], &Reporter::new())?;
    let table = CsvFile::read(&outcome.files[0])?;
    println!("{:>7} {:>8} {:>10} {:>14} {:>9}", "F_bar", "k_bar", "solver", "grid", "surfaces");
    let column = |name| table.numbers(name);
    let (force, value) = (column("force_bar")?, column("value")?);
    let (solver, grid, surfaces) = (column("algebraic")?, column("discretisation")?, column("ensemble")?);
    for i in 0..force.len() {
        let (Some(f), Some(k), Some(a), Some(d), Some(e)) =
            (force[i], value[i], solver[i], grid[i], surfaces[i])
        else {
            continue; // rows of alpha and zeta have no force
        };
        println!(
            "{f:>7} {k:>8.4} {:>8.4} % {:>12.1} % {:>7.1} %",
            100.0 * a / k,
            100.0 * d / k,
            100.0 * e / k
        );
        assert!(a < d && a < e); // the solver is never what limits
    }
    println!("{}", outcome.reached.join("\n"));
    Ok(())
}
