//! Rectangles, oblong cells and undefined points.

#![allow(clippy::unwrap_used)]

use approx::{assert_abs_diff_eq, assert_relative_eq};
use contact_model::{Amplitude, Cells, Error, HeightMap, SelfAffine, Surface};
use std::f64::consts::{PI, TAU};
use surface_gen::{
    MapGenerator, height_map, hurst_from_spectrum, radial_spectrum, rms_height, rms_slope,
    rms_slope_differences, self_affine_map,
};

/// Rounding of a transform and of sums over up to 1e6 waves, relative to the rms.
const ROUNDING: f64 = 1e-12;

/// A few roundings of a closed form.
const CLOSED: f64 = 8.0 * f64::EPSILON;

fn bodies(size: [f64; 2]) -> [Surface; 5] {
    let size = size.into();
    [
        Surface::Sphere { radius: 5.0, size },
        Surface::Cone { slope: 0.1, size },
        Surface::PowerLaw { coefficient: 2.0, exponent: 0.7, size },
        Surface::FlatCircle { radius: 0.3, size },
        Surface::Flat { size },
    ]
}

#[test]
fn rms_is_exact_and_mean_is_zero() {
    for (cells, size) in [
        ([64, 16], [4.0, 1.0]),
        ([31, 97], [0.2, 0.7]),
        ([129, 128], [1.0, 30.0]),
        ([3, 200], [1e-3, 1.0]),
        ([1, 100], [0.01, 1.0]),
        ([101, 1], [1.0, 1.0]),
        ([2, 5], [1.0, 1.0]),
    ] {
        for fractal_dimension in [2.0, 2.4, 3.0] {
            let surface = SelfAffine::new(fractal_dimension, size, 0.02).unwrap();
            let map = self_affine_map(&surface, cells, 1).unwrap();
            assert_relative_eq!(rms_height(map.heights()), 0.02, max_relative = ROUNDING);
            let mean = map.heights().iter().sum::<f64>() / map.heights().len() as f64;
            assert_abs_diff_eq!(mean, 0.0, epsilon = 0.02 * ROUNDING);
        }
    }
}

#[test]
fn the_spectrum_follows_the_law_on_any_rectangle() {
    /// What is left of the rings' finite width from ring 8 on: p (p + 1) / (24 k^2), and of waves at the edge
    /// of the circle.
    const RINGS: f64 = 0.02;
    for (cells, size) in
        [([256, 64], [4.0, 1.0]), ([128, 256], [1.0, 1.0]), ([300, 300], [1.0, 3.0]), ([97, 512], [1.0, 5.0])]
    {
        for hurst in [0.2, 0.8] {
            let amplitude = Amplitude::Spectrum(0.01);
            let surface = SelfAffine { amplitude, ..SelfAffine::new(3.0 - hurst, size, 1.0).unwrap() };
            let map = self_affine_map(&surface, cells, 2).unwrap();
            let spectrum = radial_spectrum(&map).unwrap();
            let (longest, length) = (size[0].max(size[1]), map.length());
            let highest = PI / map.dx().max(map.dy());
            let window = [8.0 * TAU / longest, 0.95 * highest];
            let fitted = hurst_from_spectrum(&spectrum, window[0], window[1]).unwrap();
            assert_abs_diff_eq!(fitted, hurst, epsilon = RINGS);
            for &(q, c) in spectrum.iter().filter(|point| (window[0]..window[1]).contains(&point.0)) {
                let law = 0.01 * (q * length / TAU).powf(-2.0 * (hurst + 1.0));
                assert_relative_eq!(c, law, max_relative = 2.0 * RINGS);
            }
            // Rings are as wide as the longest wave, and reach to the shortest isotropic one.
            assert_eq!(spectrum.len(), (longest / (2.0 * map.dx().max(map.dy())) * (1.0 + 1e-9)) as usize);
        }
    }
}

#[test]
fn the_integral_of_the_spectrum_is_the_variance() {
    // Without waves beyond the last ring: sum over rings of C times their area of the plane of q.
    let (size, cells) = ([3.0, 1.0], [96, 32]);
    let surface =
        SelfAffine { short_cutoff: Some(0.9 * PI * 32.0), ..SelfAffine::new(2.4, size, 0.5).unwrap() };
    let map = self_affine_map(&surface, cells, 3).unwrap();
    let spectrum = radial_spectrum(&map).unwrap();
    let longest = TAU / 3.0;
    let counts = (1..=spectrum.len()).map(|k| {
        let inside = |m: f64| m.round() as usize == k;
        (-48_i32..48)
            .flat_map(|i| (-16_i32..16).map(move |j| f64::from(i).hypot(3.0 * f64::from(j))))
            .filter(|&m| inside(m))
            .count()
    });
    let variance: f64 =
        spectrum.iter().zip(counts).map(|(p, n)| p.1 * n as f64 * longest * 3.0 * longest).sum();
    assert_relative_eq!(variance, 0.25, max_relative = ROUNDING);
}

#[test]
fn a_surface_is_the_same_on_every_grid() {
    // Column i of 40 has the centre of column 3 i + 1 of 120, row j of 16 that of row 5 j + 2 of 80.
    let surface = SelfAffine { short_cutoff: Some(20.0), ..SelfAffine::new(2.2, [3.0, 1.0], 1.0).unwrap() };
    let coarse = self_affine_map(&surface, [40, 16], 9).unwrap();
    let fine = self_affine_map(&surface, [120, 80], 9).unwrap();
    for (i, h) in coarse.heights().iter().enumerate() {
        let (ix, iy) = (i % 40, i / 40);
        assert_abs_diff_eq!(*h, fine.heights()[(5 * iy + 2) * 120 + 3 * ix + 1], epsilon = ROUNDING);
    }
}

#[test]
fn one_row_has_waves_along_x_alone() {
    let surface = SelfAffine::new(2.4, [1.0, 0.01], 1.0).unwrap();
    let map = self_affine_map(&surface, [100, 1], 4).unwrap();
    assert_relative_eq!(rms_height(map.heights()), 1.0, max_relative = ROUNDING);
    assert_relative_eq!(
        rms_slope(&map).unwrap(),
        MapGenerator::new(&surface, [100, 1]).unwrap().rms_slope(),
        max_relative = ROUNDING
    );
    // One ring for each wave, each on the power law: no scatter.
    let spectrum = radial_spectrum(&map).unwrap();
    assert_eq!(spectrum.len(), 50);
    assert_abs_diff_eq!(hurst_from_spectrum(&spectrum[..49], 0.0, 1e9).unwrap(), 0.6, epsilon = 1e-9);
}

#[test]
fn bodies_at_known_points_of_oblong_cells() {
    // Cells of 2 x 0.5 on 8 x 2: the centre of cell (0, 1) is at (-3, -0.25) from the middle.
    let r2 = 9.0 + 0.0625_f64;
    let at = |surface: &Surface| height_map(surface, 4, 0).unwrap().heights()[4];
    let [sphere, cone, power, _, flat] = bodies([8.0, 2.0]);
    assert_relative_eq!(at(&sphere), -r2 / 10.0, max_relative = CLOSED);
    assert_relative_eq!(at(&cone), -0.1 * r2.sqrt(), max_relative = CLOSED);
    assert_relative_eq!(at(&power), -2.0 * r2.powf(0.35), max_relative = CLOSED);
    assert!(at(&flat).abs() <= 0.0);
    // Of 5 columns, 1.6 wide, a face of radius 1 covers the centres in the middle one; the others lie 1000
    // longer sides lower.
    let punch = Surface::FlatCircle { radius: 1.0, size: [8.0, 2.0].into() };
    let map = height_map(&punch, [5, 4], 0).unwrap();
    let covered: Vec<usize> = (0..20).filter(|&i| map.heights()[i] >= 0.0).collect();
    assert_eq!(covered, [2, 7, 12, 17]);
    assert_relative_eq!(map.heights()[0], -8000.0);
}

#[test]
fn bodies_turn_with_their_rectangle() {
    for (cells, size) in [([7, 4], [3.0, 1.0]), ([12, 5], [1.7, 0.9]), ([40, 10], [4.0, 1.0])] {
        let turned = [cells[1], cells[0]];
        for (body, other) in bodies(size).iter().zip(&bodies([size[1], size[0]])) {
            let map = height_map(body, cells, 0).unwrap();
            assert_eq!(map.transposed(), *height_map(other, turned, 0).unwrap(), "{body:?}");
            assert_eq!(map.mirrored(), *map, "{body:?}");
        }
    }
}

#[test]
fn measures_turn_with_their_rectangle() {
    let surface = SelfAffine::new(2.3, [2.0, 0.7], 0.1).unwrap();
    let map = self_affine_map(&surface, [50, 33], 5).unwrap();
    let turned = map.transposed();
    assert_relative_eq!(rms_slope(&turned).unwrap(), rms_slope(&map).unwrap(), max_relative = ROUNDING);
    let differences = rms_slope_differences(&map);
    assert_relative_eq!(rms_slope_differences(&turned), differences, max_relative = ROUNDING);
    let [one, other] = [&map, &turned].map(|map| radial_spectrum(map).unwrap());
    assert_eq!(one.len(), other.len());
    for (a, b) in one.iter().zip(&other) {
        assert_relative_eq!(a.0, b.0, max_relative = ROUNDING);
        assert_relative_eq!(a.1, b.1, max_relative = ROUNDING);
    }
}

#[test]
fn a_punch_fits_in_the_shorter_side() {
    let punch =
        |radius, size: [f64; 2]| height_map(&Surface::FlatCircle { radius, size: size.into() }, [40, 10], 0);
    assert!(punch(0.5, [4.0, 1.0]).is_ok() && punch(0.5, [1.0, 4.0]).is_ok());
    let e = punch(0.51, [4.0, 1.0]).unwrap_err();
    let text = "radius = 0.51: expected a face that fits in the rectangle of sides 4 and 1 and covers a cell's centre";
    assert_eq!(e.to_string(), text);
}

#[test]
fn a_sine_runs_along_x() {
    let surface = Surface::Sine { amplitude: 2.0, wavelength: 1.0, size: [4.0, 1.0].into() };
    let map = height_map(&surface, [16, 3], 0).unwrap();
    for (i, h) in map.heights().iter().enumerate() {
        let x = ((i % 16) as f64 + 0.5) / 4.0;
        assert_abs_diff_eq!(*h, 2.0 * (TAU * x).cos(), epsilon = 2.0 * CLOSED);
    }
    assert_relative_eq!(rms_slope(&map).unwrap(), 2.0 * TAU / 2.0_f64.sqrt(), max_relative = ROUNDING);
    assert!(height_map(&surface, [8, 3], 0).is_ok() && height_map(&surface, [7, 3], 0).is_err());
}

#[test]
fn slopes_of_planes_on_oblong_cells() {
    // Slopes 3 along x and -4 along y, cells of 0.5 x 2.
    let plane = |ix: usize, iy: usize| 3.0 * 0.5 * ix as f64 - 4.0 * 2.0 * iy as f64;
    let map = HeightMap::from_fn([6, 5], [3.0, 10.0], plane).unwrap();
    assert_relative_eq!(rms_slope_differences(&map), 5.0, max_relative = CLOSED);
    assert_relative_eq!(rms_slope_differences(&map.cropped(0..6, 2..3).unwrap()), 3.0, max_relative = CLOSED);
    assert_relative_eq!(rms_slope_differences(&map.cropped(1..2, 0..5).unwrap()), 4.0, max_relative = CLOSED);
    let cone = Surface::Cone { slope: 0.2, size: [3.0, 2.0].into() };
    let cone = height_map(&cone, [301, 401], 0).unwrap();
    assert_relative_eq!(rms_slope_differences(&cone), 0.2, max_relative = 2e-3); // as on a square

    // The same plane with holes: the pairs that are left have the same slopes.
    let mut heights: Vec<f64> = map.heights().to_vec();
    for hole in [0, 7, 8, 20, 29] {
        heights[hole] = f64::NAN;
    }
    let map = HeightMap::with_undefined([6, 5], [3.0, 10.0], heights).unwrap();
    assert_relative_eq!(rms_slope_differences(&map), 5.0, max_relative = CLOSED);
}

#[test]
fn undefined_points_count_for_nothing() {
    let heights = [0.5, 1.0, -0.5, 2.0, 7.0];
    let holed = [f64::NEG_INFINITY, 0.5, 1.0, f64::NEG_INFINITY, -0.5, 2.0, 7.0];
    assert_relative_eq!(rms_height(&holed), rms_height(&heights), max_relative = 0.0);
    assert!(rms_height(&[f64::NEG_INFINITY; 3]) <= 0.0);
    assert!(!rms_height(&[f64::INFINITY, 0.0]).is_finite());

    let map = HeightMap::with_undefined(2, 1.0, vec![0.0, f64::NAN, f64::NAN, 1.0]).unwrap();
    assert!(rms_slope_differences(&map) <= 0.0); // no two neighbours are left
    for e in [rms_slope(&map).unwrap_err(), radial_spectrum(&map).unwrap_err()] {
        let text = e.to_string();
        assert!(
            text.starts_with("undefined points = 2: expected 0: a spectrum needs every height"),
            "{text}"
        );
    }
}

#[test]
fn what_cannot_be_made_is_named() {
    let name = |e| match e {
        Error::Domain { name, .. } => name.into_owned(),
        Error::OutOfMemory { .. } => "memory".to_owned(),
        e => panic!("{e}"),
    };
    let unit = SelfAffine::new(2.4, [2.0, 1.0], 1.0).unwrap();
    let rough =
        |surface: &SelfAffine, cells: [usize; 2]| name(self_affine_map(surface, cells, 0).unwrap_err());
    assert_eq!(rough(&unit, [0, 5]), "columns");
    assert_eq!(rough(&unit, [5, 0]), "rows");
    assert_eq!(rough(&unit, [5, (1 << 17) + 1]), "rows");
    assert_eq!(rough(&unit, [2, 1]), "cells");
    assert_eq!(rough(&unit, [100_000, 1]), "dx / dy (ratio of the sides of a cell)");
    assert_eq!(rough(&SelfAffine { size: [1.0, -1.0].into(), ..unit }, [8, 8]), "side along y");
    assert_eq!(rough(&SelfAffine { short_cutoff: Some(3.0), ..unit }, [8, 8]), "short_cutoff");
    assert!(self_affine_map(&SelfAffine { short_cutoff: Some(3.2), ..unit }, [8, 8], 0).is_ok());

    for body in bodies([2.0, 1.0]) {
        for (cells, expected) in [
            ([0, 5], "columns"),
            ([5, 0], "rows"),
            ([1, usize::MAX], "dx / dy (ratio of the sides of a cell)"),
        ] {
            assert_eq!(name(height_map(&body, cells, 0).unwrap_err()), expected, "{body:?}");
        }
    }
    let flat = Surface::Flat { size: [2.0, 1.0].into() };
    assert_eq!(name(height_map(&flat, [usize::MAX, usize::MAX], 0).unwrap_err()), "memory");
    assert_eq!(
        name(height_map(&Surface::Flat { size: [-2.0, 1.0].into() }, 4, 0).unwrap_err()),
        "side along x"
    );

    let map = HeightMap::new([2, 3], [2.0, 3.0], vec![0.0; 6]).unwrap();
    let surface = Surface::Heights(map.into());
    assert!(height_map(&surface, Cells { columns: 2, rows: 3 }, 0).is_ok());
    let e = height_map(&surface, [3, 2], 0).unwrap_err().to_string();
    assert_eq!(
        e,
        "heights has 6 values: expected 2 rows x 3 columns, the requested cells (maps are not resampled)"
    );
}
