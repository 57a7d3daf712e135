//! Parameters of ISO 25178-2 against the program surfalize: `data/iso25178/surfalize.csv`, made as its
//! README.md says.
//!
//! Where the two differ, the difference is stated as a factor or a tolerance with its reason.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use contact_model::{Amplitude, HeightMap, SelfAffine};
use std::f64::consts::TAU;
use std::path::Path;
use surface_gen::self_affine_map;
use surface_statistics::{
    FeatureParameters, FunctionalParameters, HeightParameters, HybridParameters, SpatialParameters,
    texture_direction,
};

/// Rounding, of sums in another order and of numbers printed with 12 digits.
const SAME: f64 = 1e-9;
/// surfalize interpolates the outline of the autocorrelation by cubic splines along rays to the centres of
/// cells, this crate linearly between neighbouring cells: part of a cell.
const PART_OF_A_CELL: f64 = 0.1;
/// Std in degrees: surfalize takes the largest of 0.5 degree sums of amplitudes of all waves without a
/// window, this crate the largest of 2 degree sums of variances.
const SECTORS: f64 = 2.0;
/// Sk, Spk and Svk: surfalize samples the material ratio curve at 10000 shares, this crate has all points.
const SAMPLED: f64 = 0.01;

/// Sides in micrometres.
fn maps() -> Vec<(&'static str, HeightMap)> {
    let surface = |size: [f64; 2], hurst: f64, roll_off: f64, cut_off: f64| SelfAffine {
        size: size.into(),
        hurst,
        amplitude: Amplitude::RmsHeight(0.3),
        roll_off: Some(TAU / roll_off),
        short_cutoff: Some(TAU / cut_off),
    };
    let isotropic = self_affine_map(&surface([64.0, 64.0], 0.8, 16.0, 2.0), 128, 5).unwrap();
    let oblong = self_affine_map(&surface([80.0, 32.0], 0.5, 8.0, 3.0), [160, 96], 6).unwrap();
    let rough = self_affine_map(&surface([48.0, 48.0], 0.7, 12.0, 1.5), 120, 7).unwrap();
    // Grooves whose wave vector is (4, 3)/48, 36.9 degrees from x.
    let wave = |ix: usize, iy: usize| (TAU * (4.0 * ix as f64 + 3.0 * iy as f64) / 120.0).sin();
    let grooves = HeightMap::from_fn(120, 48.0, wave).unwrap().plus(&rough).unwrap();
    vec![("isotropic", isotropic), ("oblong", oblong), ("grooves", grooves)]
}

/// A column of the table by map and name.
fn table() -> impl Fn(&str, &str) -> f64 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/iso25178/surfalize.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let lines: Vec<Vec<String>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    move |map, name| {
        let column = lines[0].iter().position(|head| head.split(' ').next() == Some(name)).unwrap();
        lines.iter().find(|line| line[0] == map).unwrap()[column].parse().unwrap()
    }
}

fn close(what: &str, found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{what}: {found}, surfalize {wanted}");
}

#[test]
fn parameters_are_those_of_surfalize() {
    let table = table();
    for (name, map) in maps() {
        let of = |parameter: &str| table(name, parameter);
        let same = |what: &str, found: f64, factor: f64| {
            close(&format!("{name}: {what}"), found * factor, of(what), SAME * of(what).abs());
        };
        let heights = HeightParameters::new(&map).unwrap();
        for (what, found) in [
            ("Sa", heights.sa),
            ("Sq", heights.sq),
            ("Ssk", heights.ssk),
            ("Sku", heights.sku),
            ("Sp", heights.sp),
            ("Sv", heights.sv),
            ("Sz", heights.sz),
        ] {
            same(what, found, 1.0);
        }
        let hybrid = HybridParameters::new(&map).unwrap();
        same("Sdq", hybrid.sdq, 1.0);
        // surfalize has per cent.
        same("Sdr", hybrid.sdr, 100.0);
        let functional = FunctionalParameters::new(&map).unwrap();
        for (what, found) in [("Sk", functional.sk), ("Spk", functional.spk), ("Svk", functional.svk)] {
            close(&format!("{name}: {what}"), found, of(what), SAMPLED * of(what));
        }
        let features = FeatureParameters::new(&map).unwrap();
        // surfalize divides by the area between the centres of the outermost cells, this crate by that of all
        // cells.
        let inner = (map.columns() - 1) as f64 * map.dx() * (map.rows() - 1) as f64 * map.dy();
        same("Spd", features.spd, map.size().area() / inner);
        same("Spc", features.spc.unwrap(), 1.0);
        let spatial = SpatialParameters::new(&map).unwrap();
        let cell = PART_OF_A_CELL * map.dx().max(map.dy());
        close(&format!("{name}: Sal"), spatial.sal.unwrap(), of("Sal"), cell);
        // Both have none where the correlation does not decay in all directions.
        assert_eq!(spatial.str.is_none(), of("Str").is_nan(), "{name}");
        if let Some(slowest) = spatial.slowest {
            close(&format!("{name}: slowest decay"), slowest, of("Sal") / of("Str"), cell);
        }
        // Of an isotropic surface the direction is chance.
        if name == "grooves" {
            close("grooves: Std", texture_direction(&map).unwrap(), of("Std"), SECTORS);
        }
    }
}

/// Writes the maps for the script of `data/iso25178/README.md`.
#[test]
#[ignore = "writes files for the script of data/iso25178"]
fn write_maps() {
    for (name, map) in maps() {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.txt"));
        let line = |row: &[f64]| row.iter().map(|h| format!("{h:?}")).collect::<Vec<_>>().join(" ");
        let rows: Vec<String> = map.heights().chunks(map.columns()).map(line).collect();
        std::fs::write(&path, format!("# {:?} {:?}\n{}\n", map.dx(), map.dy(), rows.join("\n"))).unwrap();
        println!("{}", path.display());
    }
}
