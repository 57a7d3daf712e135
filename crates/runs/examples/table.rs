//! A CSV table that explains itself, with units of columns, sources and the command. Absent entries are
//! empty, and numbers keep their bits.
//!
//! `cargo run -p fractal-contact-runs --example table -- DIRECTORY`
//!
//! ```text
//! approach = NaN: expected a finite number (or an empty entry)
//! # Stiffness of a sphere on a half-space of E* = 1 GPa
//! # column approach [m]: approach of a sphere of radius 1 mm
//! # column stiffness [N/m]: 2 E* sqrt(R d); empty without contact
//! # source: H. Hertz, J. reine angew. Math. 92, 156 (1882): k of d
//! # R = 1 mm
//! # version: fractal-contact 0.1.0
//! # command: cargo run -p fractal-contact-runs --example table
//! approach,stiffness
//! 0.0,
//! 1e-7,20000.0
//! 1e-6,63245.55320336759
//! 1e-5,200000.0
//! ```

use contact_model::Source;
use contact_model::{Column, Table};
use runs::{CsvFile, Error, Header, Result, write_csv};
use std::path::PathBuf;

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let columns = vec![
        Column { name: "approach", unit: "m", meaning: "approach of a sphere of radius 1 mm" },
        Column { name: "stiffness", unit: "N/m", meaning: "2 E* sqrt(R d); empty without contact" },
    ];
    let mut table = Table::new("Stiffness of a sphere on a half-space of E* = 1 GPa", columns);
    let stiffness = |d: f64| (d > 0.0).then(|| 2.0 * 1e9 * (1e-3 * d).sqrt());
    let approaches = [0.0, 1e-7, 1e-6, 1e-5];
    for d in approaches {
        table.push(vec![d.into(), stiffness(d).into()]).map_err(Error::model("the table"))?;
    }
    // A NaN never gets into a table.
    let refused = table.push(vec![f64::NAN.into(), 1.0.into()]);
    println!("{}", refused.err().map_or_else(String::new, |e| e.to_string()));

    let hertz = Source { citation: "H. Hertz, J. reine angew. Math. 92, 156 (1882)", what: "k of d" };
    let header = Header::new("cargo run -p fractal-contact-runs --example table")
        .with_sources(&[hertz])
        .with_note("R = 1 mm");
    let path = out.join("sphere.csv");
    write_csv(&path, &table, &header)?;
    println!("{}", std::fs::read_to_string(&path).map_err(Error::file("read", &path))?);
    let back = CsvFile::read(&path)?.numbers("stiffness")?;
    assert_eq!(back, approaches.map(stiffness)); // to the bit
    Ok(())
}
