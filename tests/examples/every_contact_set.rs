//! A map that is small enough to try every contact set: compares the one that satisfies the contact
//! conditions with that of the solver.
//!
//! `cargo run -p tests --example every_contact_set`
//!
//! ```text
//! force  cells   approach          k   error of d  error of k
//!   0.1      3   0.286260   0.510034      2.2e-16     2.2e-16
//!     1      8   1.575010   0.837866      1.1e-16       0.0e0
//! ```

use bem3d::Bem3d;
use contact_model::{ContactModel, Load, NormalLoad};
use std::error::Error;
use tests::stability::{every_contact_set, rough_map, scene};

fn main() -> Result<(), Box<dyn Error>> {
    let map = rough_map(2.6, 4, 3)?; // D_f, cells a side, seed; E* = L = rms height = 1
    let cells: Vec<usize> = (0..16).collect();
    let model = Bem3d { cells: 4, tolerance: 1e-10, ..Bem3d::default() };
    let mut contact = model.prepare(&scene(map.clone()), 0)?;
    println!(
        "{:>5} {:>6} {:>10} {:>10} {:>12} {:>11}",
        "force", "cells", "approach", "k", "error of d", "error of k"
    );
    for force in [0.1, 1.0] {
        // All 65536 sets, by elimination: exactly one has p > 0 inside and g > 0 outside.
        let [reference] = &every_contact_set(&map, &cells, NormalLoad::Force(force))[..] else {
            return Err("not one contact set".into());
        };
        let state = contact.solve(Load::force(force))?;
        let (d, k) = (state.approach.unwrap_or(0.0), state.stiffness.unwrap_or(0.0));
        let (error_d, error_k) =
            ((d / reference.approach - 1.0).abs(), (k / reference.stiffness - 1.0).abs());
        let count = reference.contact.len();
        println!("{force:>5} {count:>6} {d:>10.6} {k:>10.6} {error_d:>12.1e} {error_k:>11.1e}");
        assert_eq!(state.report.contact_cells, Some(count));
        assert!(error_d < 1e-9 && error_k < 1e-9);
    }
    Ok(())
}
