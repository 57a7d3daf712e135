//! Reads the map of `bench`: heights on square cells, from an NPY file.

use contact_model::{Cells, HeightMap, Size};
use runs::Result;
use runs::files::Error;
use std::path::Path;
use surface_io::{ContentError, Dimension, Format, Preprocessing, Quantity, ReadOptions, Scan, Sides};

/// Reads an NPY array `[row, column]` of numbers as heights on square cells with `sqrt(Lx Ly) = 1`, without
/// preprocessing.
///
/// Either byte order and either order of the axes; the shape is compared with the length of the file before
/// anything is allocated.
///
/// # Errors
/// [`Error::System`] when it cannot be read; [`Error::Content`] when it is not an NPY file or not of real
/// numbers, when its length differs from that in its header, or when it holds a number that is not finite
/// (with its row and column).
pub(crate) fn read_map(path: &Path) -> Result<HeightMap> {
    let wrong = |reason: String| Error::content(path, reason);
    let cell = Quantity::new(1.0, Dimension::NONE).map_err(|e| wrong(e.to_string()))?;
    let declared =
        ReadOptions { format: Some(Format::Npy), cell: Some(Sides::One(cell)), ..ReadOptions::default() };
    let scan = Scan::read(path, &declared).map_err(in_words)?;
    let map = scan.map(&Preprocessing::default()).map_err(|error| match error.problem() {
        // What could be done about it elsewhere is not offered here.
        Some(ContentError::Undefined { undefined, points, first }) => wrong(format!(
            "{undefined} of {points} numbers are NaN, the first in {first}: expected finite heights"
        )),
        _ => in_words(error),
    })?;
    let size = unit_area(map.cells());
    Ok(HeightMap::new(map.cells(), size, map.heights().to_vec()).map_err(|e| wrong(e.to_string()))?)
}

/// An error of a surface's file with its problem in words.
fn in_words(error: surface_io::Error) -> Error {
    match error {
        surface_io::Error::System { action, path, source } => Error::System { action, path, source },
        surface_io::Error::Content { path, problem } => Error::content(&path, problem.to_string()),
        other => Error::content(Path::new("the map"), other.to_string()),
    }
}

/// Sides of a rectangle of square cells with `sqrt(Lx Ly) = 1`.
pub(crate) fn unit_area(cells: Cells) -> Size {
    let aspect = cells.columns as f64 / cells.rows as f64;
    Size { x: aspect.sqrt(), y: aspect.recip().sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use surface_io::npy;

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
        fs::write(&path, npy(&[2, 2], &[0.0, 1.0, 2.0, 3.0]).unwrap()).unwrap();
        let map = read_map(&path).unwrap();
        assert_eq!((map.columns(), map.heights()), (2, &[0.0, 1.0, 2.0, 3.0][..]));
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
    fn a_rectangle_has_square_cells_and_area_one() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("map.npy");
        fs::write(&path, npy(&[2, 8], &[0.5; 16]).unwrap()).unwrap();
        let map = read_map(&path).unwrap();
        assert_eq!((map.columns(), map.rows()), (8, 2));
        approx::assert_relative_eq!(map.size().area(), 1.0, max_relative = 1e-15);
        approx::assert_relative_eq!(map.dx(), map.dy(), max_relative = 1e-15);
    }

    #[test]
    fn every_bad_file_says_what_is_wrong() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("map.npy");
        let reason = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            read_map(&path).unwrap_err().to_string()
        };
        assert!(reason(b"").contains("no data"));
        assert!(reason(b"1 2 3\n").contains("NPY"));
        let of = |kind: &str, shape: &str| {
            header(&format!("{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}"))
        };
        for kind in ["'<c16'", "'|S8'", "'|O'"] {
            let text = reason(&of(kind, "(2, 2)"));
            assert!(text.contains(kind.trim_matches('\'')) && text.contains("float64"), "{text}");
        }
        let text = reason(&of("[('x', '<f8')]", "(2, 2)"));
        assert!(text.contains("offset") || text.contains("type"), "{text}");
        assert!(!reason(&of("'<f8'", "(0, 0)")).is_empty());
        assert!(reason(&of("'<f8'", "(4,)")).contains("expected two"));
        assert!(reason(&of("'<f8'", "()")).contains("expected two"));
        assert!(reason(&of("'<f8'", "(4000000, 4000000)")).contains("cut short"));
        let whole: Vec<u8> = [of("'<f8'", "(2, 2)"), vec![0; 32]].concat();
        assert!(reason(&whole[..whole.len() - 1]).contains("31 bytes after the header"));
        assert!(reason(&[&whole[..], &[0]].concat()).contains("more than one array"));
        assert!(reason(&whole[..20]).contains("offset"));
        let of_four = |last: f64| {
            let values = [0.0, 1.0, 2.0, last].into_iter().flat_map(f64::to_le_bytes);
            [of("'<f8'", "(2, 2)"), values.collect()].concat()
        };
        let text = reason(&of_four(f64::NAN));
        assert!(text.contains("1 of 4 numbers are NaN"), "{text}");
        let text = reason(&of_four(f64::INFINITY));
        assert!(text.contains("expected a finite height"), "{text}");
        assert!(read_map(&dir.path().join("none.npy")).unwrap_err().to_string().contains("cannot open"));
    }
}
