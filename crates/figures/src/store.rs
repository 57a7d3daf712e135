//! Finished units on disk: `DIR/.units/<hash>.csv`, written whole, checked on reading.

use crate::error::Result;
use crate::files;
use crate::sample::{FIELDS, Sample, number};
use crate::unit::{Unit, UnitResult};
use std::fs;
use std::path::{Path, PathBuf};

/// First line of every stored unit.
const TITLE: &str = "# fractal-contact unit: one surface under all its loads";

/// Where finished units are kept.
#[derive(Debug, Clone)]
pub struct Store {
    directory: PathBuf,
    fresh: bool,
}

impl Store {
    /// Opens (and creates) `out/.units` and removes what interrupted runs left half-written. With `fresh` nothing stored is read.
    ///
    /// # Errors
    /// [`crate::Error::File`] when the directory cannot be made or read.
    pub fn open(out: &Path, fresh: bool) -> Result<Self> {
        let directory = out.join(".units");
        files::create_directory(&directory)?;
        files::clean(&directory)?;
        Ok(Self { directory, fresh })
    }

    /// File of a unit.
    pub fn path(&self, unit: &Unit) -> PathBuf {
        self.directory.join(format!("{:032x}.csv", fnv1a_128(unit.key().as_bytes())))
    }

    /// The stored result of this very unit, if it is there, whole and of the same key: anything else is as good as absent.
    pub fn load(&self, unit: &Unit) -> Option<UnitResult> {
        if self.fresh {
            return None;
        }
        parse(&fs::read_to_string(self.path(unit)).ok()?, unit)
    }

    /// Stores a result.
    ///
    /// # Errors
    /// [`crate::Error::File`] when it cannot be written.
    pub fn save(&self, unit: &Unit, result: &UnitResult) -> Result<()> {
        files::write_whole(&self.path(unit), format(unit, result).as_bytes())
    }
}

/// FNV-1a of 128 bits (Fowler, Noll, Vo; offset basis and prime of draft-eastlake-fnv): the same for ever, unlike the hasher of
/// the standard library. It names files; on reading the whole key is compared.
///
/// ```
/// // The published test vector of the letter a.
/// assert_eq!(figures::fnv1a_128(b"a"), 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
/// ```
pub fn fnv1a_128(bytes: &[u8]) -> u128 {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    bytes.iter().fold(BASIS, |hash, &byte| (hash ^ u128::from(byte)).wrapping_mul(PRIME))
}

fn head(unit: &Unit) -> String {
    let key: String = unit.key().lines().map(|line| format!("# {line}\n")).collect();
    format!("{TITLE}\n{key}")
}

fn format(unit: &Unit, result: &UnitResult) -> String {
    let mut text = head(unit);
    text += &format!(
        "# measured_rms_height {}\n# seconds {}\n",
        number(result.rms_height),
        number(result.seconds)
    );
    text += &FIELDS.join(",");
    text.push('\n');
    for sample in &result.samples {
        let fields = sample.fields().map(|f| quote(&f));
        text += &fields.join(",");
        text.push('\n');
    }
    let digest = fnv1a_128(text.as_bytes());
    text + &format!("# whole {digest:032x}\n")
}

fn quote(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.into()
    }
}

/// `None` unless the text is whole and belongs to this unit.
fn parse(text: &str, unit: &Unit) -> Option<UnitResult> {
    let end = text.rfind("# whole ")?;
    let (body, digest) = text.split_at(end);
    let digest = u128::from_str_radix(digest.strip_prefix("# whole ")?.trim_end(), 16).ok()?;
    if digest != fnv1a_128(body.as_bytes()) {
        return None;
    }
    let rest = body.strip_prefix(&head(unit))?;
    let (height, rest) = rest.strip_prefix("# measured_rms_height ")?.split_once('\n')?;
    let (seconds, table) = rest.strip_prefix("# seconds ")?.split_once('\n')?;
    let finite = |t: &str| t.parse::<f64>().ok().filter(|v| v.is_finite());
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    if reader.headers().ok()?.iter().ne(FIELDS) {
        return None;
    }
    let samples: Vec<Sample> = reader
        .records()
        .map(|record| record.ok().and_then(|r| Sample::from_fields(r.iter())))
        .collect::<Option<_>>()?;
    // The loads are part of the key; the rows must be those loads.
    let asked = samples.iter().map(|s| s.force_bar.to_bits());
    if asked.ne(unit.forces.iter().map(|f| f.to_bits())) {
        return None;
    }
    Some(UnitResult { rms_height: finite(height)?, seconds: finite(seconds)?, samples })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::tests::sample;
    use crate::unit::Numerics;

    fn unit(seed: u64) -> Unit {
        let numerics = Numerics::Mdr1d { elements: 64 };
        Unit { numerics, fractal_dimension: 2.4, index: 0, seed, forces: [0.1, 1.0].into() }
    }

    fn result() -> UnitResult {
        UnitResult { rms_height: 1.0 / 3.0, seconds: 0.25, samples: vec![sample(0.1), sample(1.0)] }
    }

    #[test]
    fn units_come_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        assert_eq!(store.load(&unit(1)), None);
        store.save(&unit(1), &result()).unwrap();
        assert_eq!(store.load(&unit(1)), Some(result()));
        assert_eq!(store.load(&unit(2)), None);
        assert_eq!(Store::open(dir.path(), true).unwrap().load(&unit(1)), None);
    }

    #[test]
    fn damaged_and_foreign_units_are_as_good_as_absent() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        let path = store.path(&unit(1));
        let whole = format(&unit(1), &result());
        let without_a_row = {
            let cut: Vec<&str> = whole.lines().filter(|l| !l.starts_with("0.1,")).collect();
            cut.join("\n") + "\n"
        };
        for bad in [
            String::new(),
            whole[..whole.len() / 2].to_owned(),
            whole.replace("0.25", "0.26"),
            without_a_row,
            // Whole, but of another seed, under the name of this one.
            format(&unit(2), &result()),
        ] {
            fs::write(&path, bad).unwrap();
            assert_eq!(store.load(&unit(1)), None);
        }
        fs::write(&path, [0xff, 0xfe]).unwrap();
        assert_eq!(store.load(&unit(1)), None);
        fs::write(&path, whole).unwrap();
        assert!(store.load(&unit(1)).is_some());
    }
}
