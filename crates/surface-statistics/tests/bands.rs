//! Whether confidence bands of spectra cover the truth as often as they say.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use contact_model::{Boundary, HeightMap, SelfAffine};
use std::f64::consts::TAU;
use surface_gen::{self_affine_map, surface_seed};
use surface_statistics::{Bins, DifferenceBands, DifferenceMap, PowerSpectrum, ScaleDependence, Taper};

/// Largest difference of the covered share from 95 %; bins of a spectrum are practically independent.
const TOLERANCE: f64 = 0.02;
/// Surfaces.
const COUNT: u64 = 200;

fn surface(size: f64) -> SelfAffine {
    SelfAffine { roll_off: Some(8.0 * TAU), ..SelfAffine::new(2.2, size, 1.0).unwrap() }
}

/// Share of values of the true spectrum inside of the bands.
fn inside(truth: &PowerSpectrum, spectra: &[PowerSpectrum]) -> f64 {
    let (mut inside, mut all) = (0_usize, 0_usize);
    for spectrum in spectra {
        for (k, [low, high]) in spectrum.band(0.95).unwrap().into_iter().enumerate() {
            all += 1;
            inside += usize::from((low..=high).contains(&truth.density[k]));
        }
    }
    inside as f64 / all as f64
}

/// Periodic maps.
fn gaussian_maps() -> Vec<HeightMap> {
    let draw = |seed| self_affine_map(&surface(1.0), 96, seed).unwrap();
    // Sums of independent surfaces are all but Gaussian; one surface has the amplitudes themselves.
    let gaussian = |index| {
        let seed = surface_seed(3, index);
        let sum = (1..16).fold(draw(seed), |sum, k| sum.plus(&draw(surface_seed(seed, k))).unwrap());
        sum.scaled(1.0, 0.25).unwrap()
    };
    (0..COUNT).map(gaussian).collect()
}

/// Free maps.
fn cut_maps() -> Vec<HeightMap> {
    let cut = |index| {
        let whole = self_affine_map(&surface(4.0), 384, surface_seed(4, index)).unwrap();
        whole.cropped(0..96, 96..192).unwrap()
    };
    (0..COUNT).map(cut).collect()
}

#[test]
fn bands_of_gaussian_surfaces_cover_their_spectrum() {
    let draw = |seed| self_affine_map(&surface(1.0), 96, seed).unwrap();
    let maps = gaussian_maps();
    let bins = Bins::of_wavenumbers(&maps[0], 12.0).unwrap();
    let radial = |map: &HeightMap| PowerSpectrum::radial(map, Taper::None, &bins).unwrap();
    let share = inside(&radial(&draw(1)), &maps.iter().map(radial).collect::<Vec<_>>());
    println!("radial: {share}");
    assert!((share - 0.95).abs() < TOLERANCE, "{share}");
    let along = |map: &HeightMap| PowerSpectrum::along_x(map, Taper::None).unwrap();
    let share = inside(&along(&draw(1)), &maps.iter().map(along).collect::<Vec<_>>());
    println!("along x: {share}");
    assert!((share - 0.95).abs() < TOLERANCE, "{share}");
}

#[test]
fn bands_of_cut_maps_cover_their_spectrum() {
    let maps = cut_maps();
    let bins = Bins::of_wavenumbers(&maps[0], 12.0).unwrap();
    for taper in [Taper::Hann, Taper::RadialHann] {
        let spectra: Vec<_> =
            maps.iter().map(|map| PowerSpectrum::radial(map, taper, &bins).unwrap()).collect();
        // Smeared by the window, the expected spectrum is the mean of many.
        let mut truth = spectra[0].clone();
        for (k, density) in truth.density.iter_mut().enumerate() {
            *density = spectra.iter().map(|s| s.density[k]).sum::<f64>() / spectra.len() as f64;
        }
        let share = inside(&truth, &spectra);
        println!("{taper:?}: {share}");
        assert!((share - 0.95).abs() < TOLERANCE, "{taper:?} {share}");
    }
}

/// Of mean squares over distances, with the bands of each surface.
type BandedDifferences = Vec<(f64, Option<[f64; 2]>)>;

#[test]
fn bands_of_differences_cover_the_mean_square() {
    for (boundary, maps) in [(Boundary::Periodic, gaussian_maps()), (Boundary::Free, cut_maps())] {
        let bins = Bins::of_distances(&maps[0], 10.0).unwrap();
        let of = |map: &HeightMap| -> [BandedDifferences; 3] {
            let bands = DifferenceBands::new(map, boundary).unwrap();
            let a = DifferenceMap::new(map, boundary).radial(&bins).unwrap();
            let slope = ScaleDependence::slope_along_x(map, boundary).unwrap();
            let curvature = ScaleDependence::curvature_along_y(map, boundary).unwrap();
            let squares = |rms: &[f64], bands: Vec<Option<[f64; 2]>>| -> BandedDifferences {
                let bands = bands.into_iter().map(|band| band.map(|limits| limits.map(|l| l * l)));
                rms.iter().map(|v| v * v).zip(bands).collect()
            };
            [
                a.half_square.iter().copied().zip(bands.of_differences(&a, 0.95).unwrap()).collect(),
                squares(&slope.rms, bands.of_slopes(&slope, 0, 0.95).unwrap()),
                squares(&curvature.rms, bands.of_curvatures(&curvature, 1, 0.95).unwrap()),
            ]
        };
        let found: Vec<_> = maps.iter().map(of).collect();
        for (kind, name) in ["height differences", "slopes", "curvatures"].iter().enumerate() {
            let (mut all, mut inside, mut by_distance) = (0, 0, Vec::new());
            for k in 0..found[0][kind].len() {
                let mean = found.iter().map(|f| f[kind][k].0).sum::<f64>() / COUNT as f64;
                let bands: Vec<[f64; 2]> = found.iter().filter_map(|f| f[kind][k].1).collect();
                let holding = bands.iter().filter(|[low, high]| (*low..=*high).contains(&mean)).count();
                all += bands.len();
                inside += holding;
                by_distance.push(holding);
            }
            let share = inside as f64 / all as f64;
            println!("{boundary:?} {name}: {share:.3} {by_distance:?}");
            assert!((share - 0.95).abs() < 0.03, "{boundary:?} {name}: {share}");
        }
    }
}
