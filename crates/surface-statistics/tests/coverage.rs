//! Whether fitted intervals cover the truth as often as they say.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use analysis::binomial_test;
use contact_model::{Amplitude, Boundary, HeightMap, SelfAffine};
use std::f64::consts::TAU;
use std::time::Instant;
use surface_gen::{self_affine_map, surface_seed};
use surface_statistics::{FilledPoints, FitOptions, SpectrumFit, Wavelength};

/// Where a map comes from.
#[derive(Clone, Copy, PartialEq)]
enum MapOrigin {
    /// All of a period, amplitudes prescribed.
    Period,
    /// All of a period, the sum of 16 independent surfaces: each wave has a Gaussian amplitude, all but
    /// exactly.
    Gaussian,
    /// Cut out of a map four times as large along each side.
    Cut,
}

/// Surfaces whose true parameters are known.
struct CoverageCase {
    name: &'static str,
    hurst: f64,
    /// Wavelengths; `None`: none.
    roll_off: Option<f64>,
    cut_off: Option<f64>,
    cells: [usize; 2],
    /// Sides of a cell in 1/128.
    cell: [f64; 2],
    part: MapOrigin,
    /// Shortest wavelength of the fit.
    shortest: Option<f64>,
}

fn draw(case: &CoverageCase, seed: u64) -> HeightMap {
    let [columns, rows] = case.cells;
    let size = [columns as f64 * case.cell[0] / 128.0, rows as f64 * case.cell[1] / 128.0];
    let times = if case.part == MapOrigin::Cut { 4 } else { 1 };
    let surface = SelfAffine {
        size: size.map(|side| side * times as f64).into(),
        hurst: case.hurst,
        amplitude: Amplitude::RmsHeight(0.01),
        roll_off: case.roll_off.map(|l| TAU / l),
        short_cutoff: case.cut_off.map(|l| TAU / l),
    };
    let draw = |seed| self_affine_map(&surface, case.cells.map(|n| n * times), seed).unwrap();
    let map = draw(seed);
    if case.part == MapOrigin::Gaussian {
        return (1..16).fold(map, |sum, k| sum.plus(&draw(surface_seed(seed, k))).unwrap());
    }
    if times == 1 {
        map
    } else {
        map.cropped(columns / 2..columns / 2 + columns, rows / 2..rows / 2 + rows).unwrap()
    }
}

fn coverage(case: &CoverageCase, master: u64, count: u64) {
    let start = Instant::now();
    let boundary = if case.part == MapOrigin::Cut { Boundary::Free } else { Boundary::Periodic };
    let options = FitOptions { boundary, shortest: case.shortest, longest: None };
    let mut covered = [0; 3];
    let (mut bounds, mut good, mut widths) = ([0; 2], 0, Vec::new());
    for index in 0..count {
        let map = draw(case, surface_seed(master, index));
        let fit = SpectrumFit::new(&map, &options).unwrap();
        let inside = [
            fit.hurst.contains(case.hurst),
            fit.roll_off.contains(case.roll_off.unwrap_or(f64::INFINITY)),
            fit.cut_off.contains(case.cut_off.unwrap_or(0.0)),
        ];
        for (sum, inside) in covered.iter_mut().zip(inside) {
            *sum += usize::from(inside);
        }
        bounds[0] += usize::from(matches!(fit.roll_off, Wavelength::AtLeast(_)));
        bounds[1] += usize::from(matches!(fit.cut_off, Wavelength::AtMost(_)));
        good += usize::from(fit.goodness > 0.05);
        widths.push(fit.hurst.high - fit.hurst.low);
    }
    let width = widths.iter().sum::<f64>() / widths.len() as f64;
    let all = count as usize;
    println!(
        "{}: H {}, roll-off {} ({} bounds), cut-off {} ({} bounds) of {all}; mean width of H {width:.3}, goodness above 5 %: {good}; \
         {:.1} s",
        case.name,
        covered[0],
        covered[1],
        bounds[0],
        covered[2],
        bounds[1],
        start.elapsed().as_secs_f64()
    );
    for (sum, what) in covered.into_iter().zip(["H", "roll-off", "cut-off"]) {
        assert!(binomial_test(sum, all, 0.95) > 0.01, "{}: {what} {sum} of {all}", case.name);
    }
}

const CASES: [CoverageCase; 8] = [
    CoverageCase {
        name: "periodic, Gaussian",
        hurst: 0.7,
        roll_off: Some(0.12),
        cut_off: Some(0.02),
        cells: [128, 96],
        cell: [1.0, 1.0],
        part: MapOrigin::Gaussian,
        shortest: None,
    },
    CoverageCase {
        name: "periodic",
        hurst: 0.8,
        roll_off: Some(0.125),
        cut_off: Some(0.02),
        cells: [128, 128],
        cell: [1.0, 1.0],
        part: MapOrigin::Period,
        shortest: None,
    },
    CoverageCase {
        name: "free",
        hurst: 0.8,
        roll_off: Some(0.1),
        cut_off: Some(0.0213),
        cells: [128, 128],
        cell: [1.0, 1.0],
        part: MapOrigin::Cut,
        shortest: None,
    },
    CoverageCase {
        name: "free, no limits inside",
        hurst: 0.6,
        roll_off: None,
        cut_off: None,
        cells: [128, 128],
        cell: [1.0, 1.0],
        part: MapOrigin::Cut,
        shortest: None,
    },
    CoverageCase {
        name: "free rectangle, oblong cells",
        hurst: 0.5,
        roll_off: Some(0.08),
        cut_off: None,
        cells: [192, 80],
        cell: [1.0, 1.25],
        part: MapOrigin::Cut,
        shortest: None,
    },
    CoverageCase {
        name: "free, tip limit",
        hurst: 0.7,
        roll_off: Some(0.12),
        cut_off: Some(0.02),
        cells: [128, 128],
        cell: [1.0, 1.0],
        part: MapOrigin::Cut,
        shortest: Some(0.028),
    },
    CoverageCase {
        name: "free, cut-off far inside",
        hurst: 0.2,
        roll_off: Some(0.08),
        cut_off: Some(0.03),
        cells: [128, 128],
        cell: [1.0, 1.0],
        part: MapOrigin::Cut,
        shortest: None,
    },
    CoverageCase {
        name: "free, steep",
        hurst: 1.0,
        roll_off: None,
        cut_off: Some(0.03),
        cells: [128, 128],
        cell: [1.0, 1.0],
        part: MapOrigin::Cut,
        shortest: None,
    },
];

#[test]
fn intervals_of_a_few_surfaces_cover_the_truth() {
    for case in &CASES {
        coverage(case, 11, 10);
    }
}

/// `cargo test -p surface-statistics --release --test coverage -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn intervals_cover_the_truth_in_95_of_100_surfaces() {
    for case in &CASES {
        coverage(case, 13, 100);
    }
}

/// The map with round holes of radii from one to four cells, at random places, in `share` of its points.
fn with_round_holes(map: &HeightMap, share: f64, seed: u64) -> HeightMap {
    let (columns, rows) = (map.columns(), map.rows());
    let mut heights = map.heights().to_vec();
    let mut state = seed;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    while (heights.iter().filter(|h| h.is_nan()).count() as f64) < share * heights.len() as f64 {
        let [x, y, radius] = [draw() * columns as f64, draw() * rows as f64, 1.0 + 3.0 * draw()];
        for (i, h) in heights.iter_mut().enumerate() {
            if ((i % columns) as f64 - x).hypot((i / columns) as f64 - y) < radius {
                *h = f64::NAN;
            }
        }
    }
    HeightMap::with_undefined(map.cells(), map.size(), heights).unwrap()
}

/// Of a map with holes that are filled the fit ends where filled points matter, and takes all of the map: its
/// interval contains the truth as often as without holes, and is little wider where the holes are few.
#[test]
fn intervals_of_maps_with_filled_holes_cover_the_truth() {
    const COUNT: usize = 40;
    // With both limits inside, down to the cells, and rough ones. The last has few waves between a quarter of its
    // side and the width of its many holes.
    for (case, share, wider) in
        [(&CASES[2], 0.017, 1.2), (&CASES[3], 0.017, 1.2), (&CASES[4], 0.03, 1.2), (&CASES[3], 0.05, 1.2)]
    {
        let mut covered = [0; 2];
        let mut widths = [0.0; 2];
        let (mut shortest, mut off) = (0.0, 0.0);
        for index in 0..COUNT as u64 {
            let seed = surface_seed(17, index);
            let map = draw(case, seed);
            let holes = with_round_holes(&map, share, seed);
            let points = FilledPoints::new(&holes);
            let options = FitOptions::default();
            let filled = surface_io::filled(&holes).unwrap();
            let found = [
                SpectrumFit::new(&map, &options).unwrap(),
                SpectrumFit::of_filled(&filled, &points, &options).unwrap(),
            ];
            for ((covered, width), fit) in covered.iter_mut().zip(&mut widths).zip(&found) {
                *covered += usize::from(fit.hurst.contains(case.hurst));
                *width += (fit.hurst.high - fit.hurst.low) / COUNT as f64;
            }
            // The same longest waves, which are those of the whole map.
            assert!((found[0].fitted[0] / found[1].fitted[0] - 1.0).abs() < 1e-12);
            shortest += points.shortest() / map.dx().max(map.dy()) / COUNT as f64;
            off += (found[1].hurst.value - found[0].hurst.value) / COUNT as f64;
        }
        println!(
            "{} {share}: {covered:?} of {COUNT} without and with holes, mean widths {widths:.3?}, mean difference {off:.4}, waves from \
             {shortest:.1} cells on",
            case.name
        );
        for covered in covered {
            assert!(binomial_test(covered, COUNT, 0.95) > 0.01, "{}: {covered} of {COUNT}", case.name);
        }
        assert!(off.abs() < 0.02, "{}: {off}", case.name);
        assert!(widths[1] < wider * widths[0], "{}: {widths:?}", case.name);
    }
}

/// Beyond the cut-off of a surface the rims of filled holes are all that there is: the fit ends before they
/// count, and finds what it finds without holes.
#[test]
fn a_cut_off_far_inside_is_found_beside_filled_holes() {
    let case = CoverageCase {
        name: "cut-off of eight cells",
        hurst: 0.8,
        roll_off: Some(120.0 / 128.0),
        cut_off: Some(8.0 / 128.0),
        cells: [320, 240],
        cell: [1.0, 1.0],
        part: MapOrigin::Cut,
        shortest: None,
    };
    for seed in 0..3 {
        let map = draw(&case, seed);
        let holes = with_round_holes(&map, 0.017, seed);
        let options = FitOptions::default();
        let whole = SpectrumFit::new(&map, &options).unwrap();
        let filled = surface_io::filled(&holes).unwrap();
        let found = SpectrumFit::of_filled(&filled, &FilledPoints::new(&holes), &options).unwrap();
        println!(
            "{seed}: {:?} {:?} {}, {:?} {:?}",
            found.hurst, found.cut_off, found.goodness, whole.hurst, whole.cut_off
        );
        assert!((found.hurst.value - whole.hurst.value).abs() < 0.25 * (whole.hurst.high - whole.hurst.low));
        assert!(found.goodness > 0.01 && found.cut_off.contains(8.0 / 128.0));
    }
}
