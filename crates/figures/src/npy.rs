//! Height maps from NPY files.

use crate::error::{Error, Result};
use contact_model::HeightMap;
use npyz::{DType, NpyFile, NpyHeader, Order, TypeChar};
use std::fs::File;
use std::io::{BufReader, Seek as _};
use std::path::Path;

/// Reads a square float64 NPY array as heights on a square of side 1, as they are: row-major means `[iy][ix]`.
///
/// Either byte order and either order of the axes; the shape is compared with the length of the file before anything is allocated.
///
/// # Errors
/// [`Error::File`] when it cannot be read; [`Error::Content`] when it is no NPY file, no square, not float64, shorter or longer than
/// it says, or holds a number that is not finite (with its row and column).
pub fn read_map(path: &Path) -> Result<HeightMap> {
    let wrong = |reason: String| Error::content(path, reason);
    let file = File::open(path).map_err(Error::file("open", path))?;
    let length = file.metadata().map_err(Error::file("read", path))?.len();
    let mut reader = BufReader::new(file);
    let header =
        NpyHeader::from_reader(&mut reader).map_err(|e| wrong(format!("not an NPY file of numbers: {e}")))?;
    let length = length.saturating_sub(reader.stream_position().map_err(Error::file("read", path))?);
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
    if bytes != length {
        let what = if bytes > length { "cut short" } else { "more than one array?" };
        return Err(wrong(format!(
            "{length} bytes after the header: a map of {rows} x {rows} takes {bytes} ({what})"
        )));
    }
    let order = header.order();
    let npy = NpyFile::with_header(header, reader);
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
        let mut bytes = header("{'descr': '>f8', 'fortran_order': False, 'shape': (2, 2), }");
        bytes.extend([0.0f64, 1.0, 2.0, 3.0].iter().flat_map(|v| v.to_be_bytes()));
        fs::write(&path, bytes).unwrap();
        assert_eq!(read_map(&path).unwrap().heights(), [0.0, 1.0, 2.0, 3.0]);
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
        let of = |kind: &str, shape: &str| {
            header(&format!("{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}"))
        };
        for kind in ["'<f4'", "'<i8'", "'<c16'", "'|b1'", "'<f2'", "'|O'"] {
            let text = reason(&of(kind, "(2, 2)"));
            assert!(text.contains(kind.trim_matches('\'')) && text.contains("float64"), "{text}");
        }
        assert!(reason(&of("[('x', '<f8')]", "(2, 2)")).contains("structured"));
        assert!(reason(&of("'<f8'", "(2, 3)")).contains("square"));
        assert!(reason(&of("'<f8'", "(0, 0)")).contains("at least one cell"));
        assert!(reason(&of("'<f8'", "(4,)")).contains("expected two"));
        assert!(reason(&of("'<f8'", "()")).contains("expected two"));
        assert!(reason(&of("'<f8'", "(4000000, 4000000)")).contains("cut short"));
        let whole: Vec<u8> = [of("'<f8'", "(2, 2)"), vec![0; 32]].concat();
        assert!(reason(&whole[..whole.len() - 1]).contains("31 bytes after the header"));
        assert!(reason(&[&whole[..], &[0]].concat()).contains("more than one array"));
        assert!(reason(&whole[..20]).contains("not an NPY file"));
        let mut bytes = header("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1), }");
        bytes.extend(f64::NAN.to_le_bytes());
        assert!(reason(&bytes).contains("NaN in row 0, column 0"));
        assert!(read_map(&dir.path().join("none.npy")).unwrap_err().to_string().contains("cannot open"));
    }
}
