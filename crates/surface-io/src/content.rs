//! What the reader of one format finds.

use crate::error::ContentError;
use crate::extent::Extent;
use crate::format::Format;
use crate::quantity::{Dimension, QuantityError, Unit};

/// What a reader of one format found.
pub(crate) struct FileContent {
    pub(crate) format: Format,
    pub(crate) details: String,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    pub(crate) heights: Vec<f64>,
    pub(crate) unit: Option<Unit>,
    /// Along x and y, where the file says it.
    pub(crate) extent: [Option<Extent>; 2],
}

/// Heights have a length or no unit at all.
pub(crate) fn check_unit(what: &'static str, unit: Option<&Unit>) -> Result<(), ContentError> {
    match unit.map(|u| (u, u.dimension())) {
        None | Some((_, Dimension::LENGTH)) => Ok(()),
        // "%" would be a factor without a meaning here.
        Some((u, Dimension::NONE)) if *u == Unit::none() => Ok(()),
        Some((u, found)) => {
            let source = QuantityError::Dimension { text: u.to_string(), found, expected: Dimension::LENGTH };
            Err(ContentError::Quantity { what, source })
        }
    }
}
