//! A measured map as text with a tilt and a missing point: the metadata of the file, its preprocessing, and
//! the resulting map.
//!
//! `cargo run -p surface-io --example read_text -- DIRECTORY`
//!
//! ```text
//! format     a text matrix (semicolons between numbers)
//! shape      48 rows of 64
//! size       0.00032 m x 0.00024000000000000003 m (as given)
//! cell       5e-6 m x 5e-6 m
//! heights    in um (as given)
//! range      -6.83e-2 to 6.3478e0, rms about the mean 1.8503e0
//! undefined  1 of 3072 points (0.033 %)
//! refused: true
//! cells              64 x 48 (columns x rows)
//! size               3.2e-4 x 2.4000000000000003e-4
//! cell               5e-6 x 5e-6
//! undefined points   0 of 3072
//! ...
//! ```

use std::error::Error;
use std::path::PathBuf;
use surface_io::{
    Decimal, Detrend, Fill, Metric, Preprocessing, ReadOptions, Scan, Undefined, describe, map_file,
};

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    // Ripples of 0.2 um on a plane that rises by 0.1 um a column; decimal commas, 64 x 48 points 5 um apart.
    let height = |ix: i32, iy: i32| 0.1 * f64::from(ix) + 0.2 * f64::from(ix).sin() * f64::from(iy).cos();
    let entry = |ix, iy| {
        if (ix, iy) == (30, 20) { "BAD".to_owned() } else { format!("{:.4}", height(ix, iy)) }
    };
    let line = |iy| (0..64).map(|ix| entry(ix, iy)).collect::<Vec<_>>().join(";") + "\n";
    let text = (0..48).map(line).collect::<String>().replace('.', ",");
    let path = out.join("profilometer.txt");
    std::fs::write(&path, text)?;

    // What the file does not say is given; the rest is found and can be looked at.
    let options = ReadOptions {
        unit: Some("um".parse()?),
        cell: Some("5 um".parse()?),
        decimal: Decimal::Comma,
        ..ReadOptions::default()
    };
    let scan = Scan::read(&path, &options)?;
    println!("{}", scan.metadata());
    // A missing point is an error until it is said what becomes of it.
    let refused = scan.map(&Preprocessing::default());
    println!("refused: {}", refused.is_err());
    let hole = Preprocessing { undefined: Some(Undefined::NoContact), ..Preprocessing::default() };
    assert_eq!(scan.map(&hole)?.undefined(), 1);

    let filled =
        Preprocessing { fill: Some(Fill::Neighbours), detrend: Detrend::Plane, ..Preprocessing::default() };
    let map = scan.map(&filled)?;
    println!("{}", describe(&map));
    // A ripple sin x cos y has half the amplitude as rms.
    assert!((describe(&map).rms_height / 0.1e-6 - 1.0).abs() < 0.02);
    std::fs::write(out.join("profilometer.npy"), map_file("npy", &map, Metric::Metres)?)?;
    Ok(())
}
