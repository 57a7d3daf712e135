//! Memory of a solve, from the sizes of its grid and of its contact.
//!
//! The constants are peaks of allocated bytes beyond what a prepared contact holds, rounded up. They count plans,
//! tables, vectors, coarser grids and requested fields (2026-11). `tests/memory.rs` compares them with real solves.

use contact_model::{Adhesion, Cells, Effects, Friction, Output, Outputs, Rheology};

/// A contact that fills the grid, bytes for each cell ...
const DENSE: f64 = 200.0;
/// ... and for each cell of a side: lines of transforms and of the preconditioner.
const DENSE_SIDE: f64 = 7000.0;
/// An increment of friction beside it, bytes for each cell ...
const FRICTION: f64 = 300.0;
/// ... and its stiffnesses.
const TANGENTIAL_STIFFNESS: f64 = 210.0;
/// Attraction, bytes for each cell.
const ATTRACTION: f64 = 200.0;
/// The histories of a viscoelastic body: for each cell in contact and each arm of its relaxation, and once more ...
const HISTORY: f64 = 56.0;
/// ... and the displacement that they leave, bytes for each cell of the grid.
const CREPT: f64 = 110.0;
/// Rough contact with a share s of the cells takes this multiple of `sqrt(s)` of what contact everywhere takes: its
/// window is the grid, and its candidates are many times as many cells as touch.
const SCATTERED: f64 = 2.2;
/// A Cholesky factor, bytes for each square of its cells ...
const FACTOR: f64 = 8.0;
/// ... and what products of matrices reserve once on each thread, here on one, twice the largest cache: of 32 MB. It is
/// address space, of which little is touched.
const PRODUCTS: f64 = 6.8e7;
/// Number of cells whose factor needs none of that.
const FEWEST: usize = 64;

/// Under any load: the kernel at all lags, bytes for each cell ...
const TABLE: f64 = 8.0;
/// ... and a displacement of the whole grid for its fields, with the plan that it takes.
const DISPLACED: f64 = 70.0;

/// Memory of a solve on a grid in bytes, beyond that of the prepared contact, where a share of the cells touches:
/// at least the peak of the solve, and of contact nearly everywhere at most 1.5 times the peak, twice with effects.
/// Factors of small sets are not counted.
///
/// With an attraction every cell counts, because it is not known before how far it reaches.
///
/// ```
/// use bem3d::{Cells, Effects, Outputs, solve_bytes};
/// let cells = Cells { columns: 1025, rows: 1025 };
/// let bytes = solve_bytes(&Effects::default(), &Outputs::default(), cells, 1.0);
/// assert!(bytes > 0.21e9 && bytes < 0.25e9);
/// ```
pub fn solve_bytes(effects: &Effects, outputs: &Outputs, cells: Cells, contact: f64) -> f64 {
    let count = cells.columns as f64 * cells.rows as f64;
    let mut of_cell = DENSE;
    let mut share = (SCATTERED * contact.sqrt()).min(1.0);
    if effects.friction != Friction::Off {
        of_cell += FRICTION;
        if outputs.tangential_stiffness || outputs.tangential_stiffness_stuck {
            of_cell += TANGENTIAL_STIFFNESS;
        }
    }
    if effects.adhesion != Adhesion::Off {
        of_cell += ATTRACTION;
        share = 1.0;
    }
    let mut always = TABLE;
    if let Ok(Some(spectrum)) = effects.rheology.spectrum(1.0) {
        // Of pressures, and of the two components of tractions.
        let components = if effects.friction == Friction::Off { 1 } else { 3 };
        of_cell += HISTORY * (components * (1 + spectrum.arms.len())) as f64;
        always += CREPT;
    }
    let dense = of_cell * count + DENSE_SIDE * count.sqrt();
    let components = outputs.asked().filter_map(Output::field).map(|field| field.components).sum::<usize>();
    always += 8.0 * components as f64;
    if outputs.gap || outputs.displacement {
        always += DISPLACED;
    }
    // Of an elastic body, contact everywhere needs all that lighter loads do.
    let most = if effects.rheology == Rheology::Elastic { dense } else { f64::INFINITY };
    (share * dense + always * count).min(most)
}

/// Memory of factors in bytes: of the largest set of cells that may be factored on the grid, and of sets on coarser
/// grids, which scattered contact has whose set is too large, `None`.
pub(super) fn factor_bytes(largest: Option<usize>, contact: f64) -> f64 {
    match largest {
        Some(cells) if cells <= FEWEST => FACTOR * (cells as f64).powi(2),
        Some(cells) => PRODUCTS + FACTOR * (cells as f64).powi(2),
        None if SCATTERED * contact.sqrt() < 1.0 => PRODUCTS,
        None => 0.0,
    }
}
