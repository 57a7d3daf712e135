//! Fig. 2 of the paper in small: stiffness over force of an ensemble in three dimensions, with the paper's
//! claims beside it.
//!
//! `cargo run -p fractal-contact-figures --example fig2_small -- DIRECTORY`
//!
//! ```text
//! fig2.csv, fig2-samples.csv, fig2.svg, fig2.png, fig2-budget.csv
//! fig2: accuracy reached (95 % half-width of the mean k_bar, 27 rows without floor): 39.60 % or better, half of them 11.56 %; the widest at D_f = 2.0, F_bar = 3.448e-3
//! claim                                                       paper        here       s.e.    allowed  verdict
//! k_bar 3D at F_bar = 0.086, D_f = 2.0                         0.18      0.2071    0.00442    0.01884  disagrees
//!     all curves through (0.086, 0.18) (Sec. II); 0.01 for a value read off six curves to two digits; allowed: this + 2 s.e.
//! k_bar 3D at F_bar = 0.086, D_f = 2.4                         0.18      0.2032   0.008457    0.02691  agrees
//! k_bar 3D at F_bar = 0.086, D_f = 3.0                         0.18      0.1889   0.003574    0.01715  agrees
//! conductance at F_bar = 0.086, mean over D_f, Eq. 13         0.411      0.4561    0.01252    0.04789  agrees
//! k_bar 3D at F_bar = 20 over its plateau, D_f = 2.0              1      0.9997   8.557e-5    0.01017  agrees
//! contact fraction 3D at F_bar = 20, D_f = 2.0            below 0.5      0.9656                        disagrees
//!     "long before a full material contact", "a relatively small real contact area suffices" (Sec. I); half is our reading; a smooth surface (small D_f) does touch almost everywhere, and so does one without its finer waves: here 129 cells a side
//! k_bar 3D at F_bar = 20 over its plateau, D_f = 2.4              1      0.9973  0.0001269    0.01025  agrees
//! ...
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
    let judged: Vec<_> =
        outcome.claims.iter().filter(|c| c.verdict != Verdict::Unresolved).cloned().collect();
    println!("{}", plain(&judged));
    assert_eq!(outcome.not_converged, 0);
    Ok(())
}
