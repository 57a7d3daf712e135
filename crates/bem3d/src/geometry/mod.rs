//! The grid of cells, windows of it, and sets of cells.

mod cell_set;
mod grid;

pub use cell_set::CellSet;
pub use grid::{Grid, Lengths, Window};
