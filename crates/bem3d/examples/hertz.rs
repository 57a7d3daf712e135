//! A sphere on finer and finer grids: the force and the stiffness converge to those of Hertz.
//!
//! `cargo run -p bem3d --example hertz`
//!
//! ```text
//!  cells in contact   error of F   error of k
//!     33        385       3.3e-4      -3.1e-3
//!     65       1481       1.7e-4      -3.5e-3
//!    129       5845       2.4e-5       5.0e-4
//!    257      23109       9.0e-6      -2.0e-4
//! ```

use bem3d::{Bem3d, ContactModel, Load, Result, Scene, Surface};

fn main() -> Result<()> {
    let (radius, approach) = (1.0_f64, 0.04_f64);
    let scene = Scene::new(Surface::Sphere { radius, size: 0.6.into() }, 1.0);
    // a = sqrt(R d), F = (4/3) E* sqrt(R) d^(3/2), k = 2 E* a.
    let (a, force) = ((radius * approach).sqrt(), 4.0 / 3.0 * radius.sqrt() * approach.powf(1.5));
    println!("{:>6} {:>10} {:>12} {:>12}", "cells", "in contact", "error of F", "error of k");
    let mut errors = [0.0; 2];
    for cells in [33, 65, 129, 257] {
        let model = Bem3d { cells, tolerance: 1e-8, ..Bem3d::default() };
        let state = model.prepare(&scene, 0)?.solve(Load::approach(approach))?;
        errors = [state.force / force - 1.0, state.stiffness.unwrap_or(0.0) / (2.0 * a) - 1.0];
        let count = state.report.contact_cells.unwrap_or(0);
        println!("{cells:>6} {count:>10} {:>12.1e} {:>12.1e}", errors[0], errors[1]);
    }
    // About 170 cells across the contact; k knows its edge to a fraction of a cell only.
    assert!(errors[0].abs() < 1e-4 && errors[1].abs() < 1e-3);
    Ok(())
}
