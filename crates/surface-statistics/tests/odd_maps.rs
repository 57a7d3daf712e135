//! Maps that no one measures: every item gives numbers or an error, never NaN and never a panic.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use contact_model::{Boundary, HeightMap};
use std::fmt::Debug;
use surface_gen::MapStatistics;
use surface_statistics::{
    Bins, Derivatives, DifferenceMap, FeatureParameters, FitOptions, HeightParameters, HybridParameters,
    PowerSpectrum, ReliableWavelengths, ScaleDependence, SpatialParameters, SpectrumFit, Taper,
    nayak_parameter, texture_direction,
};

/// No NaN and no infinity in what is printed, an error for it aside.
fn finite<T: Debug>(what: &str, found: contact_model::Result<T>) {
    if let Ok(found) = found {
        let text = format!("{found:?}");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{what}: {text}");
    }
}

fn everything(what: &str, map: &HeightMap) {
    let name = |item: &str| format!("{what}, {item}");
    finite(&name("height"), HeightParameters::new(map));
    finite(&name("hybrid"), HybridParameters::new(map));
    finite(&name("spatial"), SpatialParameters::new(map));
    finite(&name("direction"), texture_direction(map));
    finite(&name("features"), FeatureParameters::new(map));
    finite(&name("Nayak"), MapStatistics::new(map).map(|s| nayak_parameter(&s)));
    for boundary in [Boundary::Free, Boundary::Periodic] {
        finite(&name("derivatives"), Derivatives::new(map, boundary));
        finite(&name("slope"), ScaleDependence::slope_along_x(map, boundary));
        finite(&name("curvature"), ScaleDependence::curvature_along_y(map, boundary));
        finite(&name("fit"), SpectrumFit::new(map, &FitOptions { boundary, ..FitOptions::default() }));
        finite(&name("reliable"), ReliableWavelengths::new(map, boundary, None));
        let differences = DifferenceMap::new(map, boundary);
        finite(&name("along x"), differences.along_x());
        finite(&name("along y"), differences.along_y().map(|d| d.slope()));
        finite(&name("correlation"), Ok(differences.autocorrelation([1, 0])));
        if let Ok(bins) = Bins::of_distances(map, 5.0) {
            finite(&name("radial difference"), differences.radial(&bins));
        }
    }
    for taper in [Taper::None, Taper::Hann, Taper::RadialHann] {
        finite(
            &name("along x"),
            PowerSpectrum::along_x(map, taper).and_then(|s| s.band(0.95).map(|b| (s, b))),
        );
        if let Ok(bins) = Bins::of_wavenumbers(map, 5.0) {
            finite(&name("radial"), PowerSpectrum::radial(map, taper, &bins).and_then(|s| s.band(0.95)));
        }
    }
}

#[test]
fn small_maps_flat_maps_and_holes() {
    let sizes = [[1, 1], [2, 1], [1, 3], [2, 2], [3, 3], [1, 40], [5, 4], [24, 2], [33, 20]];
    for cells in sizes {
        let count = cells[0] * cells[1];
        let rough = |i: usize| ((i * i * 31 + i * 7) % 23) as f64;
        let patterns: [(&str, &dyn Fn(usize) -> f64); 4] = [
            ("flat", &|_| 2.0),
            ("rough", &rough),
            ("one point", &|i| if i == 0 { 1.0 } else { 0.0 }),
            ("holes", &|i| if i % 3 == 1 { f64::NAN } else { rough(i) }),
        ];
        for (pattern, height) in patterns {
            for unit in [1.0, 1e-160, 1e150, 1e300] {
                let heights = (0..count).map(|i| height(i) * unit).collect();
                let map = HeightMap::with_undefined(cells, [2.0, 1.0], heights).unwrap();
                everything(&format!("{cells:?} {pattern} {unit:e}"), &map);
            }
        }
    }
}

#[test]
fn undefined_points_are_left_out_where_the_definition_allows() {
    let height = |i: usize| ((i * 17) % 29) as f64;
    let whole = HeightMap::from_fn([20, 10], [2.0, 1.0], |ix, iy| height(20 * iy + ix)).unwrap();
    // A frame of undefined points around it changes nothing but the area.
    let framed = |i: usize| {
        let (x, y) = (i % 24, i / 24);
        if (2..22).contains(&x) && (2..12).contains(&y) { height(20 * (y - 2) + x - 2) } else { f64::NAN }
    };
    let holes = HeightMap::with_undefined([24, 14], [2.4, 1.4], (0..336).map(framed).collect()).unwrap();
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    let [a, b] = [&whole, &holes].map(|map| HeightParameters::new(map).unwrap());
    close(a.sku, b.sku);
    close(a.sa, b.sa);
    let [a, b] = [&whole, &holes].map(|map| HybridParameters::new(map).unwrap());
    close(a.sdr, b.sdr);
    close(a.sdq, b.sdq);
    let [a, b] = [&whole, &holes].map(|map| Derivatives::new(map, Boundary::Free).unwrap());
    close(a.rms_gradient, b.rms_gradient);
    close(a.rms_curvature, b.rms_curvature);
    let [a, b] = [&whole, &holes].map(|map| SpatialParameters::new(map).unwrap());
    close(a.sal.unwrap(), b.sal.unwrap());
    let [a, b] = [&whole, &holes].map(|map| FeatureParameters::new(map).unwrap());
    assert_eq!(a.hills, b.hills);
    for error in [
        texture_direction(&holes).unwrap_err(),
        PowerSpectrum::along_y(&holes, Taper::Hann).unwrap_err(),
        SpectrumFit::new(&holes, &FitOptions::default()).unwrap_err(),
    ] {
        assert!(error.to_string().starts_with("undefined points = 136: expected 0"), "{error}");
    }
}
