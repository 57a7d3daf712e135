//! Height maps from NPY files.

use crate::error::{Error, Result};
use contact_model::HeightMap;
use npyz::{DType, NpyFile, Order, TypeChar};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Reads a square float64 NPY array as heights on a square of side 1, as they are: row-major means `[iy][ix]`.
///
/// The shape is compared with the length of the file before anything is allocated.
///
/// # Errors
/// [`Error::File`] when it cannot be read; [`Error::Content`] when it is no NPY file, no square, not float64, shorter or longer than
/// it says, or holds a number that is not finite (with its row and column).
pub fn read_map(path: &Path) -> Result<HeightMap> {
    let wrong = |reason: String| Error::content(path, reason);
    let file = File::open(path).map_err(Error::file("open", path))?;
    let length = file.metadata().map_err(Error::file("read", path))?.len();
    let npy = NpyFile::new(BufReader::new(file)).map_err(|e| wrong(format!("not an NPY file: {e}")))?;
    let header = npy.header();
    let DType::Plain(kind) = header.dtype() else {
        return Err(wrong("a structured array: expected a square array of float64".into()));
    };
    if kind.type_char() != TypeChar::Float || kind.size_field() != 8 {
        return Err(wrong(format!(
            "numbers of type {kind}: expected float64 ('<f8'); numpy's astype('f8') converts"
        )));
    }
    let shape = header.shape().to_vec();
    let [rows, columns] = shape[..] else {
        return Err(wrong(format!("{} dimensions {shape:?}: expected two", shape.len())));
    };
    if rows != columns || rows == 0 {
        return Err(wrong(format!("{rows} rows of {columns}: expected a square map of at least one cell")));
    }
    let bytes = rows.checked_mul(rows).and_then(|n| n.checked_mul(8)).unwrap_or(u64::MAX);
    if bytes > length {
        return Err(wrong(format!("{length} bytes: a map of {rows} x {rows} takes {bytes} (cut short?)")));
    }
    let order = header.order();
    let mut heights: Vec<f64> = npy.into_vec().map_err(Error::file("read", path))?;
    let side = rows as usize;
    if order == Order::Fortran {
        heights = (0..side * side).map(|i| heights[(i % side) * side + i / side]).collect();
    }
    if let Some(i) = heights.iter().position(|h| !h.is_finite()) {
        return Err(wrong(format!(
            "height {} in row {}, column {}: expected a finite number",
            heights[i],
            i / side,
            i % side
        )));
    }
    HeightMap::new(side, 1.0, heights).map_err(Error::model(path.display().to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arrays::write_npy;
    use std::fs;

    fn header(text: &str) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((text.len() as u16 + 1).to_le_bytes());
        bytes.extend(text.bytes());
        bytes.push(b'\n');
        bytes
    }

    #[test]
    fn a_map_comes_back_and_fortran_order_is_turned() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("map.npy");
        write_npy(&path, &[2, 2], &[0.0, 1.0, 2.0, 3.0]).unwrap();
        let map = read_map(&path).unwrap();
        assert_eq!((map.cells(), map.heights()), (2, &[0.0, 1.0, 2.0, 3.0][..]));
        let mut bytes = header("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 2), }");
        bytes.extend([0.0f64, 1.0, 2.0, 3.0].iter().flat_map(|v| v.to_le_bytes()));
        fs::write(&path, bytes).unwrap();
        assert_eq!(read_map(&path).unwrap().heights(), [0.0, 2.0, 1.0, 3.0]);
    }

    #[test]
    fn every_bad_file_says_what_is_wrong() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("map.npy");
        let reason = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            read_map(&path).unwrap_err().to_string()
        };
        assert!(reason(b"").contains("not an NPY file"));
        assert!(reason(b"1 2 3\n").contains("not an NPY file"));
        assert!(
            reason(&header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }"))
                .contains("float64")
        );
        assert!(
            reason(&header("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }")).contains("square")
        );
        assert!(
            reason(&header("{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }"))
                .contains("expected two")
        );
        let huge = header("{'descr': '<f8', 'fortran_order': False, 'shape': (4000000, 4000000), }");
        assert!(reason(&huge).contains("cut short"));
        let mut bytes = header("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1), }");
        bytes.extend(f64::NAN.to_le_bytes());
        assert!(reason(&bytes).contains("NaN in row 0, column 0"));
        assert!(read_map(&dir.path().join("none.npy")).unwrap_err().to_string().contains("cannot open"));
    }
}
