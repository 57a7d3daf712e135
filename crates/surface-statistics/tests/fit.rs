//! What a fit of the spectrum depends on, and what it refuses.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use contact_model::{Boundary, HeightMap, SelfAffine};
use std::f64::consts::TAU;
use surface_gen::{rms_height, self_affine_map};
use surface_statistics::{FitOptions, Interval, ReliableWavelengths, SpectrumFit, Wavelength};

/// Minima are found to a small part of what ends an interval, about 1 % of its width.
const SAME: f64 = 0.01;

fn map() -> HeightMap {
    let surface = SelfAffine {
        roll_off: Some(TAU / 0.4),
        short_cutoff: Some(TAU / 0.1),
        ..SelfAffine::new(2.3, [8.0, 6.0], 0.5).unwrap()
    };
    self_affine_map(&surface, [256, 192], 3).unwrap().cropped(20..148, 50..146).unwrap()
}

fn fit(map: &HeightMap) -> SpectrumFit {
    SpectrumFit::new(map, &FitOptions::default()).unwrap()
}

fn same(a: Interval, b: Interval, factor: f64) {
    let width = a.high - a.low;
    for (a, b) in [(a.value, b.value), (a.low, b.low), (a.high, b.high)] {
        assert!((a - b * factor).abs() < SAME * width, "{a} {b}");
    }
}

fn interval(wavelength: Wavelength) -> Interval {
    match wavelength {
        Wavelength::Interval(interval) => interval,
        other => panic!("{other:?}"),
    }
}

#[test]
fn units_offset_tilt_and_mirrors_do_not_matter() {
    let plain = fit(&map());
    assert!(
        plain.hurst.contains(0.7) && plain.roll_off.contains(0.4) && plain.cut_off.contains(0.1),
        "{plain:?}"
    );
    let tilt = |ix: usize, iy: usize| 7.0 + 0.02 * ix as f64 - 0.03 * iy as f64;
    let tilted = map().plus(&HeightMap::from_fn(map().cells(), map().size(), tilt).unwrap()).unwrap();
    let others = [
        (map().scaled(1e-6, 1e-9).unwrap(), 1e6),
        (map().scaled(1e6, 1e-60).unwrap(), 1e-6),
        (map().transposed(), 1.0),
        (map().mirrored(), 1.0),
        (tilted, 1.0),
    ];
    for (other, length) in others {
        let found = fit(&other);
        same(plain.hurst, found.hurst, 1.0);
        same(interval(plain.roll_off), interval(found.roll_off), length);
        same(interval(plain.cut_off), interval(found.cut_off), length);
        assert!((plain.goodness - found.goodness).abs() < SAME);
    }
}

#[test]
fn white_noise_is_told_and_does_not_bend_the_exponent() {
    let surface = SelfAffine::new(2.2, 1.0, 1.0).unwrap();
    let map = self_affine_map(&surface, 128, 1).unwrap();
    let periodic = FitOptions { boundary: Boundary::Periodic, ..FitOptions::default() };
    let clean = SpectrumFit::new(&map, &periodic).unwrap();
    assert!(clean.noise.is_none() && clean.hurst.contains(0.8), "{clean:?}");
    // A flat spectrum, of a surface that rolls off at its shortest wave.
    let flat = SelfAffine { roll_off: Some(128.0 * TAU), ..SelfAffine::new(2.2, 1.0, 0.02).unwrap() };
    let noise = self_affine_map(&flat, 128, 2).unwrap();
    let noisy = SpectrumFit::new(&map.plus(&noise).unwrap(), &periodic).unwrap();
    assert!(noisy.hurst.contains(0.8), "{noisy:?}");
    // Its waves fill a circle of the radius pi/dx.
    let density =
        rms_height(noise.heights()).powi(2) / (std::f64::consts::PI * (128.0 * std::f64::consts::PI).powi(2));
    let found = noisy.noise.unwrap();
    assert!((found / density - 1.0).abs() < 0.1, "{found} {density}");
    // Noise alone has no exponent.
    let error = SpectrumFit::new(&noise, &periodic).unwrap_err().to_string();
    assert!(error.contains("Hurst exponent of the spectrum = "), "{error}");
}

#[test]
fn limits_of_the_instrument_make_a_bound() {
    let map = map();
    let limits = ReliableWavelengths::new(&map, Boundary::Free, Some(0.13)).unwrap();
    assert!(limits.limited_by_instrument);
    let found = SpectrumFit::new(&map, &limits.fit_options(Boundary::Free)).unwrap();
    assert!(matches!(found.cut_off, Wavelength::AtMost(bound) if bound >= 0.1), "{found:?}");
    assert!(found.hurst.contains(0.7) && found.fitted[1] <= TAU / 0.13 * (1.0 + 1e-9));
    assert!(ReliableWavelengths::new(&map, Boundary::Free, Some(-1.0)).is_err());
    assert!(ReliableWavelengths::new(&map, Boundary::Free, Some(10.0)).is_err());
}

#[test]
fn what_cannot_be_fitted_is_named() {
    let refused = |map: &HeightMap, options: FitOptions, words: &str| {
        let error = SpectrumFit::new(map, &options).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    let mut heights = map().heights().to_vec();
    heights[5] = f64::NAN;
    let holes = HeightMap::with_undefined(map().cells(), map().size(), heights).unwrap();
    refused(&holes, FitOptions::default(), "undefined points = 1");
    let plane = HeightMap::from_fn(64, 1.0, |ix, iy| 0.1 * ix as f64 + 0.2 * iy as f64).unwrap();
    refused(&plane, FitOptions::default(), "rms height of the map = ");
    let flat = HeightMap::new(64, 1.0, vec![3.0; 4096]).unwrap();
    for boundary in [Boundary::Free, Boundary::Periodic] {
        refused(&flat, FitOptions { boundary, ..FitOptions::default() }, "rms height of the map = 0");
    }
    let tiny = map().scaled(1.0, 1e-200).unwrap();
    refused(&tiny, FitOptions::default(), "power spectral density = 0");
    let part = map().cropped(0..16, 0..16).unwrap();
    refused(&part, FitOptions::default(), "rings of the spectrum = ");
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = FitOptions { shortest: Some(bad), ..FitOptions::default() };
        refused(&map(), options, "shortest wavelength of the fit = ");
        let options = FitOptions { longest: Some(bad), ..FitOptions::default() };
        refused(&map(), options, "longest wavelength of the fit = ");
    }
}
