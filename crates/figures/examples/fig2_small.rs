//! Fig. 2 of the paper in small: stiffness over force of an ensemble in three dimensions, with the paper's
//! claims beside it.
//!
//! `cargo run -p figures --example fig2_small -- DIRECTORY`
//!
//! ```text
//! OUT
//! ```

use evaluation::{Request, Result, Run, Verdict, plain};
use runs::Reporter;
use std::path::PathBuf;

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let request = Request {
        cells: Some(129),
        surfaces: Some(4),
        fractal_dimensions: Some(vec![2.0, 2.4, 3.0]),
        forces: Some("1e-3:20:9,0.086,1".to_owned()),
        out: Some(out.join("fig2-small")),
        ..Request::default()
    };
    let outcome = figures::fig2(&Run::new(&request)?, &Reporter::new())?;
    println!("{}", runs::file_names(&outcome.files).join(", "));
    println!("{}", outcome.reached.join("\n"));
    let judged: Vec<_> = outcome.claims.iter().filter(|c| c.verdict != Verdict::NotTested).cloned().collect();
    println!("{}", plain(&judged));
    assert_eq!(outcome.not_converged, 0);
    Ok(())
}
