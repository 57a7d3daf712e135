//! Prints the channels of files, one a line, with tabs between: path, name, rows, columns, unit of the
//! heights, sides of a cell in metres or plain numbers, and the heights row by row, `nan` where undefined. A
//! file or a channel that is not read is a line of its path, `error` and the reason. For comparisons with
//! other readers: `cargo run -p surface-io --example channels -- FILE...`.

use surface_io::{Quantity, ReadOptions, Scan, SurfaceFile};

fn main() {
    for path in std::env::args().skip(1) {
        let scans = match SurfaceFile::open(&path, &ReadOptions::default()) {
            Ok(file) => file.scans().collect(),
            Err(error) => vec![Err(error)],
        };
        for scan in scans {
            match scan {
                Ok(scan) => println!("{path}\t{}", line(&scan)),
                Err(error) => println!("{path}\terror\t{error}"),
            }
        }
    }
}

fn line(scan: &Scan) -> String {
    let found = scan.metadata();
    let unit = match (&found.no_heights, &found.unit) {
        (Some(unit), _) => format!("no heights: {unit}"),
        (None, Some(unit)) => unit.value.to_string(),
        (None, None) => String::new(),
    };
    let cell = found.cell.as_ref().map(|cell| cell.value.map(Quantity::value));
    let cell = cell.map_or(String::new(), |[x, y]| format!("{x} {y}"));
    let height = |i: usize| scan.height(i / found.columns, i % found.columns).unwrap_or(f64::NAN).to_string();
    let heights: Vec<String> = (0..found.rows * found.columns).map(height).collect();
    let name = found.name.as_deref().unwrap_or_default();
    format!("{name}\t{}\t{}\t{unit}\t{cell}\t{}", found.rows, found.columns, heights.join(" "))
}
