//! Maps as HDF5.

use super::{LABELS, SIZE, SIZE_UNIT, UNIT};
use crate::error::ContentError;
use crate::write::{Metric, with_nan};
use contact_model::HeightMap;
use hdf5_pure::{AttrValue, FileBuilder};

/// The bytes of an HDF5 file: the data set `heights` of float64 `[row, column]`, NaN at undefined points,
/// with the attributes `unit`, `size` (along x and y), `size_unit` and `DIMENSION_LABELS` (`y`, `x`).
///
/// # Errors
/// [`ContentError::Unwritten`] where the library refuses.
///
/// ```
/// use surface_io::{Metric, ReadOptions, Scan, hdf5};
/// let map = contact_model::HeightMap::new(2, [1e-6, 2e-6], vec![0.0, 1e-9, 2e-9, 3.5e-9])?;
/// let scan = Scan::from_bytes("a.h5", &hdf5(&map, Metric::Metres)?, &ReadOptions::default())?;
/// assert_eq!(scan.map(&Default::default())?, map);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hdf5(map: &HeightMap, metric: Metric) -> Result<Vec<u8>, ContentError> {
    let text = |text: &str| AttrValue::AsciiString(text.to_owned());
    // Of any length, as H5DSget_label takes them for granted: it crashes on others.
    let labels = AttrValue::VarLenAsciiStringArray(vec!["y".to_owned(), "x".to_owned()]);
    let mut file = FileBuilder::new();
    file.create_dataset("heights")
        .with_f64_data(&with_nan(map))
        .with_shape(&[map.rows() as u64, map.columns() as u64])
        .set_attr(UNIT, text(metric.name()))
        .set_attr(SIZE, AttrValue::F64Array(vec![map.size().x, map.size().y]))
        .set_attr(SIZE_UNIT, text(metric.name()))
        .set_attr(LABELS, labels);
    file.finish().map_err(|e| ContentError::Unwritten { reason: e.to_string() })
}
