//! Surfaces from and to files, and quantities with units.
mod describe;
mod error;
pub mod files;
mod format;
mod npy;
mod points;
mod quantity;
mod scan;
mod text;
mod treatment;
mod vti;
mod word;
mod write;

pub use describe::{Description, describe};
pub use error::{Error, NumberKind, Place, Problem, Result};
pub use format::Format;
pub use npy::npy;
pub use quantity::{Dimension, Quantity, QuantityError, Unit};
pub use scan::{Decimal, Declared, Said, Scan, Speaker, Understood};
pub use treatment::{Crop, Detrend, Fill, Treatment};
pub use vti::{Encoding, Field, vti};
pub use word::WordError;
pub use write::{Metric, text, write_map, xyz};
