//! Every parameter that a map with undefined points has is that of the map without them: scattered failures
//! of an instrument change none by more than a stated bound, and what a hole changes by more is an error.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use contact_model::{Amplitude, Boundary, HeightMap, SelfAffine};
use std::f64::consts::TAU;
use surface_gen::self_affine_map;
use surface_statistics::{
    Bins, Derivatives, DifferenceMap, FeatureParameters, FunctionalParameters, HeightParameters,
    HybridParameters, PowerSpectrum, ReliableWavelengths, ScaleDependence, SpatialParameters, SpectrumFit,
    Taper, texture_direction,
};

/// Means over all points or pairs of points: a sample of 90 % has the same mean within its scatter.
const MEAN: f64 = 0.03;
/// Means of higher powers, which single points decide.
const TAIL: f64 = 0.1;
/// The highest or lowest point may be one of those that are undefined; the next one is close.
const EXTREME: f64 = 0.15;
/// Numbers of hills: a peak whose height is not known is one no more, or another one.
const HILLS: f64 = 0.1;
/// Outlines of the autocorrelation.
const OUTLINE: f64 = 0.05;

type StatisticsFound = Vec<(&'static str, Option<f64>, f64)>;

/// Name, value and bound of everything.
fn parameters(map: &HeightMap) -> StatisticsFound {
    let mut all: StatisticsFound = Vec::new();
    let heights = HeightParameters::new(map).ok();
    let height = |of: fn(&HeightParameters) -> f64| heights.as_ref().map(of);
    all.push(("Sa", height(|h| h.sa), MEAN));
    all.push(("Sq", height(|h| h.sq), MEAN));
    all.push(("3 + Ssk", height(|h| 3.0 + h.ssk), TAIL));
    all.push(("Sku", height(|h| h.sku), TAIL));
    all.push(("Sp", height(|h| h.sp), EXTREME));
    all.push(("Sv", height(|h| h.sv), EXTREME));
    all.push(("Sz", height(|h| h.sz), EXTREME));
    let hybrid = HybridParameters::new(map).ok();
    all.push(("Sdq", hybrid.map(|h| h.sdq), MEAN));
    all.push(("Sdr", hybrid.map(|h| h.sdr), TAIL));
    let functional = FunctionalParameters::new(map).ok();
    all.push(("Sk", functional.map(|f| f.sk), MEAN));
    all.push(("Spk", functional.map(|f| f.spk), TAIL));
    all.push(("Svk", functional.map(|f| f.svk), TAIL));
    let spatial = SpatialParameters::new(map).ok();
    all.push(("Sal", spatial.and_then(|s| s.sal), OUTLINE));
    all.push(("Str", spatial.and_then(|s| s.str), OUTLINE));
    all.push(("Std", texture_direction(map).ok(), MEAN));
    let features = FeatureParameters::new(map).ok();
    all.push(("Spd", features.map(|f| f.spd), HILLS));
    all.push(("Spc", features.and_then(|f| f.spc), HILLS));
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let derivatives = Derivatives::new(map, boundary).ok();
        let derivative = |of: fn(&Derivatives) -> f64| derivatives.as_ref().map(of);
        all.push(("rms gradient", derivative(|d| d.rms_gradient), MEAN));
        all.push(("rms curvature", derivative(|d| d.rms_curvature), MEAN));
        all.push(("rms slope along x", derivative(|d| d.rms_slope[0]), MEAN));
        let slope = ScaleDependence::slope_along_y(map, boundary).ok();
        all.push(("slope by scale", slope.map(|s| s.rms[2]), MEAN));
        let curvature = ScaleDependence::curvature_along_x(map, boundary).ok();
        all.push(("curvature by scale", curvature.map(|s| s.rms[2]), MEAN));
        let differences = DifferenceMap::new(map, boundary);
        all.push(("autocorrelation", differences.autocorrelation([2, 1]), MEAN));
        let radial = Bins::of_distances(map, 5.0).and_then(|bins| differences.radial(&bins)).ok();
        all.push(("structure function", radial.map(|d| d.slope()[1]), MEAN));
    }
    // What needs every point is an error, which says so.
    let along = PowerSpectrum::along_x(map, Taper::Hann).ok();
    all.push(("spectrum", along.map(|s| s.density[3]), MEAN));
    let reliable = ReliableWavelengths::new(map, Boundary::Free, None).ok();
    let fit = reliable.and_then(|r| SpectrumFit::new(map, &r.fit_options(Boundary::Free)).ok());
    all.push(("Hurst exponent", fit.map(|f| f.hurst.value), MEAN));
    let theory = surface_gen::MapStatistics::new(map).ok();
    all.push(("slope of theories", theory.map(|t| t.rms_slope()), MEAN));
    all
}

fn maps() -> Vec<(&'static str, HeightMap)> {
    let surface = |hurst: f64, roll_off: f64, cut_off: f64| SelfAffine {
        size: [1.0, 1.0].into(),
        hurst,
        amplitude: Amplitude::RmsHeight(0.01),
        roll_off: Some(TAU * roll_off),
        short_cutoff: Some(TAU * cut_off),
    };
    // Waves of at least 8 cells, of 4, and down to the cells.
    let map = |hurst, cut_off, seed| self_affine_map(&surface(hurst, 6.0, cut_off), 192, seed).unwrap();
    vec![
        ("smooth", map(0.8, 24.0, 3)),
        ("rough", map(0.7, 48.0, 4)),
        ("down to the cells", map(0.5, 96.0, 5)),
    ]
}

/// The map without a share of its points, chosen by a hash.
fn with_holes(map: &HeightMap, share: f64, seed: u64) -> HeightMap {
    let hole = |i: usize| {
        let mut x =
            (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ seed.wrapping_mul(0xd1b5_4a32_d192_ed03);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 <= share
    };
    let heights =
        map.heights().iter().enumerate().map(|(i, h)| if hole(i) { f64::NAN } else { *h }).collect();
    HeightMap::with_undefined(map.cells(), map.size(), heights).unwrap()
}

#[test]
fn scattered_undefined_points_change_no_parameter_beyond_its_bound() {
    let mut wrong = Vec::new();
    for (name, map) in maps() {
        let whole = parameters(&map);
        for share in [0.01, 0.03, 0.1] {
            for seed in 0..2 {
                let holes = parameters(&with_holes(&map, share, seed));
                for ((what, value, bound), (_, found, _)) in whole.iter().zip(&holes) {
                    let (Some(value), Some(found)) = (value, found) else { continue };
                    let off = (found / value - 1.0).abs();
                    if off.is_nan() || off > *bound {
                        wrong.push(format!("{name}, {share}: {what} {found} for {value}, off by {off:.3}"));
                    }
                }
                let known = holes.iter().filter(|(_, value, _)| value.is_some()).count();
                assert!(known >= 27, "{known} of {} are known", holes.len());
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn hills_are_not_known_where_large_holes_cut_them_and_are_inside_an_outline() {
    let (_, map) = maps().remove(1);
    let whole = FeatureParameters::new(&map).unwrap();
    assert_eq!(whole.filled, 0);
    let without = |hole: &dyn Fn(usize, usize) -> bool| {
        let heights = map.heights().iter().enumerate();
        let heights = heights.map(|(i, h)| if hole(i % 192, i / 192) { f64::NAN } else { *h }).collect();
        FeatureParameters::new(&HeightMap::with_undefined(map.cells(), map.size(), heights).unwrap())
    };
    // Squares of 5 x 5 inside, one in each 12 x 12 cells.
    let cut = without(&|x, y| x % 12 < 5 && y % 12 < 5 && x > 11 && y > 11).unwrap_err().to_string();
    assert!(cut.starts_with("hills that touch undefined points = ") && cut.contains("fill"), "{cut}");
    // A few of them.
    let few = without(&|x, y| x % 96 < 5 && y % 96 < 5 && x > 11 && y > 11).unwrap();
    assert!((few.spd / whole.spd - 1.0).abs() < HILLS, "{few:?} {whole:?}");
    // A round field of view: the density is that of what was seen.
    let round = without(&|x, y| (x as f64 - 95.5).hypot(y as f64 - 95.5) > 96.0).unwrap();
    assert!((round.spd / whole.spd - 1.0).abs() < HILLS, "{round:?} {whole:?}");
    assert!((round.spc.unwrap() / whole.spc.unwrap() - 1.0).abs() < HILLS);
}
