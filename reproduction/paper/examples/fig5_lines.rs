//! Fig. 5 of the paper: equivalent lines of three fractal dimensions, as CSV, SVG, PNG and NPY.
//!
//! `cargo run -p fractal-contact-paper --example fig5_lines -- DIRECTORY`
//!
//! ```text
//! fig5-df3.0.npy, fig5-df2.5.npy, fig5-df2.0.npy, fig5.csv, fig5.svg, fig5.png
//! column fractal_dimension [1]: D_f = 3 - H of the 3D surface
//! column x [L]: centre of the element, 0 to L_1D = (2/sqrt(pi)) L
//! column height [h]: in units of the rms height of the whole line, mean 0
//! command: cargo xtask reproduce-fig5 --preset default --elements 16384 --seed 86026710
//! 6000 rows
//! ```

use paper::evaluation::{Request, Result, Run};
use runs::{CsvFile, Silent};
use std::path::PathBuf;

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let request =
        Request { elements: Some(1 << 14), out: Some(out.join("fig5-lines")), ..Request::default() };
    let outcome = paper::fig5(&Run::new(&request)?, &Silent)?;
    println!("{}", runs::file_names(&outcome.files).join(", "));
    // The header of a CSV says what made it.
    let csv = outcome.files.iter().find(|f| f.extension().is_some_and(|e| e == "csv"));
    let table = CsvFile::read(csv.unwrap_or(&outcome.files[0]))?;
    for line in table.comments.iter().filter(|c| c.starts_with("column") || c.starts_with("command")) {
        println!("{line}");
    }
    println!("{} rows", table.rows.len());
    assert!(outcome.files.iter().all(|f| f.exists()));
    Ok(())
}
