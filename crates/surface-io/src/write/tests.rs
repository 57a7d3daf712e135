#![cfg(all(feature = "hdf5", feature = "x3p"))]

use super::*;
use crate::{Preprocessing, ReadOptions, Scan, Undefined};
use proptest::prelude::*;

fn check(name: &str, map: &HeightMap, metric: Metric, declared: &ReadOptions) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    let (_, ending) = name.split_once('.').unwrap();
    std::fs::write(&path, map_file(ending, map, metric).unwrap()).unwrap();
    let keep = Preprocessing { undefined: Some(Undefined::NoContact), ..Preprocessing::default() };
    let read = Scan::read(&path, declared).unwrap().map(&keep).unwrap();
    assert_eq!((read.cells(), read.undefined()), (map.cells(), map.undefined()));
    let bits = |map: &HeightMap| [map.size().x, map.size().y].map(f64::to_bits);
    for (read, side) in bits(&read).into_iter().zip(bits(map)) {
        // X3P says the side of a cell only.
        assert!(read.abs_diff(side) <= u64::from(name.ends_with("x3p")), "{name}");
    }
    for (a, b) in read.heights().iter().zip(map.heights()) {
        assert_eq!(a.to_bits(), b.to_bits(), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_format_comes_back(
        columns in 1..8_usize,
        rows in 1..8_usize,
        side in prop::num::f64::POSITIVE.prop_filter("its cell and its square are normal", |s| (1e-150..1e150).contains(s)),
        aspect in 1e-3..1e3_f64,
        undefined in prop::collection::vec(any::<bool>(), 64),
        values in prop::collection::vec(-1e300..1e300_f64, 64),
        small in prop::collection::vec(prop::num::f64::NORMAL, 64),
    ) {
        let small: Vec<f64> = small.into_iter().map(|v| v % 1e-3).collect();
        for heights in [values, small] {
            let height = |i: usize| if undefined[i] && i > 0 { f64::NAN } else { heights[i] };
            let heights = (0..columns * rows).map(height).collect();
            let map = HeightMap::with_undefined([columns, rows], [side, side * aspect], heights).unwrap();
            let (metres, plain) = (Some("m".parse().unwrap()), ReadOptions::default());
            for metric in [Metric::Metres, Metric::Unitless] {
                check("a.txt", &map, metric, &plain);
                check("a.xyz", &map, metric, &plain);
                check("a.h5", &map, metric, &plain);
            }
            let length = |side: f64| crate::Quantity::new(side, Dimension::LENGTH).unwrap();
            let size = Some([length(map.size().x), length(map.size().y)].into());
            check("a.x3p", &map, Metric::Metres, &plain);
            check("a.gwy", &map, Metric::Metres, &plain);
            check("a.nc", &map, Metric::Metres, &plain);
            check("a.npy", &map, Metric::Metres, &ReadOptions { size, unit: metres, ..plain });
            // Without a unit, binary files say no size.
            let size = Some([map.size().x, map.size().y].map(|s| crate::Quantity::new(s, Dimension::NONE).unwrap()).into());
            check("a.gwy", &map, Metric::Unitless, &ReadOptions { size, ..ReadOptions::default() });
            check("a.nc", &map, Metric::Unitless, &ReadOptions { size, ..ReadOptions::default() });
        }
    }
}

#[test]
fn other_endings_are_named() {
    let map = HeightMap::new(1, 1.0, vec![0.0]).unwrap();
    for ending in ["hdf5", "", "TXT"] {
        let error = map_file(ending, &map, Metric::Metres).unwrap_err().to_string();
        assert!(error.contains("expected npy, h5, txt, xyz, vti, x3p, gwy or nc"), "{error}");
    }
    let error = map_file("x3p", &map, Metric::Unitless).unwrap_err().to_string();
    assert!(error.contains("X3P is in metres"), "{error}");
    let vti = String::from_utf8(map_file("vti", &map, Metric::Metres).unwrap()).unwrap();
    assert!(vti.contains("Name=\"height [m]\""));
}

#[test]
fn units_that_are_no_lengths_have_no_metric() {
    assert_eq!(Metric::of(&"nm".parse().unwrap()), Ok(Metric::Metres));
    assert_eq!(Metric::of(&Unit::none()), Ok(Metric::Unitless));
    assert!(Metric::of(&"Pa".parse().unwrap()).is_err());
}
