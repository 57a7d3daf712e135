//! Surfaces from and to files, and quantities with units.
mod error;
mod format;
mod npy;
mod points;
mod quantity;
mod scan;
mod text;
mod treatment;

pub use error::{Error, NumberKind, Place, Problem, Result};
pub use format::Format;
pub use npy::npy;
pub use quantity::{Dimension, Quantity, QuantityError, Unit};
pub use scan::{Decimal, Declared, Said, Scan, Speaker, Understood};
pub use treatment::{Crop, Detrend, Fill, Treatment};
