use super::*;
use crate::{
    LineGenerator, MapGenerator, SelfAffineFit, line_spectrum, radial_spectrum, rms_slope, self_affine_map,
};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use contact_model::{Amplitude, SelfAffine, Size, line_length};

/// Transforms and sums of up to 1e5 waves.
const ROUNDING: f64 = 1e-11;

fn unit(hurst: f64) -> SelfAffine {
    SelfAffine {
        size: 1.0.into(),
        hurst,
        amplitude: Amplitude::RmsHeight(1.0),
        roll_off: None,
        short_cutoff: None,
    }
}

/// `a cos(2 pi k x/Lx) + a cos(2 pi m y/Ly)` at the cells' centres.
fn waves_of(cells: [usize; 2], size: [f64; 2], amplitude: f64, [k, m]: [f64; 2]) -> HeightMap {
    let wave = |times: f64, i: usize, n: usize| (TAU * times * (i as f64 + 0.5) / n as f64).cos();
    HeightMap::from_fn(cells, size, |ix, iy| amplitude * (wave(k, ix, cells[0]) + wave(m, iy, cells[1])))
        .unwrap()
}

/// Two waves of one wavelength across each other have every moment in closed form, on any rectangle and in
/// any units.
#[test]
fn a_pair_of_waves_by_hand() {
    for (cells, size, times) in [([32, 32], [1.0, 1.0], [4.0, 4.0]), ([96, 32], [3.0, 1.0], [9.0, 3.0])] {
        for unit in [1e-150, 1.0, 1e150] {
            let map = waves_of(cells, size.map(|s| s * unit), 0.25 * unit, times);
            let found = MapStatistics::new(&map).unwrap();
            let (a, q) = (0.25 * unit, TAU * times[1] / size[1] / unit);
            // Variance a^2/2 of each.
            assert_relative_eq!(found.rms_height, a, max_relative = ROUNDING);
            assert_relative_eq!(found.rms_slope(), a * q, max_relative = ROUNDING);
            let own = q * Size::from(size.map(|s| s * unit)).length();
            for (moment, expected) in
                found.profile_moments().into_iter().zip([1.0, own.powi(2) / 2.0, 0.375 * own.powi(4)])
            {
                assert_relative_eq!(moment, expected, max_relative = ROUNDING);
            }
            // Kurtosis of a sum of two independent cosines: 3/2 + (3 - 3/2)/2.
            assert_abs_diff_eq!(found.kurtosis, 2.25, epsilon = ROUNDING);
            assert_abs_diff_eq!(found.skewness, 0.0, epsilon = ROUNDING);
            assert_abs_diff_eq!(found.isotropy, 1.0, epsilon = ROUNDING);
            assert!(!found.windowed && found.edge_step < 1.0 && found.tilt < ROUNDING);
        }
    }
}

#[test]
fn one_direction_along_a_diagonal_is_seen() {
    let n = 64;
    let ridge = |sign: f64| {
        let phase = |ix: usize, iy: usize| TAU * (3.0 * ix as f64 + sign * 3.0 * iy as f64) / n as f64;
        HeightMap::from_fn(n, 1.0, |ix, iy| phase(ix, iy).cos()).unwrap()
    };
    for map in [ridge(1.0), ridge(-1.0)] {
        assert!(MapStatistics::new(&map).unwrap().isotropy < 1e-5);
    }
    let both = MapStatistics::new(&ridge(1.0).plus(&ridge(-1.0)).unwrap()).unwrap();
    assert_abs_diff_eq!(both.isotropy, 1.0, epsilon = 1e-5);
}

#[test]
fn generated_surfaces_have_their_slope_and_are_isotropic() {
    for (hurst, cells, size) in [(0.8, [128, 128], [1.0, 1.0]), (0.3, [240, 60], [4.0, 1.0])] {
        let surface = SelfAffine { size: size.into(), ..unit(hurst) };
        for seed in 0..4 {
            let map = self_affine_map(&surface, cells, seed).unwrap();
            let found = MapStatistics::new(&map).unwrap();
            assert!(!found.windowed, "edge step {}", found.edge_step);
            assert_relative_eq!(found.rms_slope(), rms_slope(&map).unwrap(), max_relative = ROUNDING);
            assert_relative_eq!(found.profile_moments()[0], 1.0, max_relative = ROUNDING);
            assert_relative_eq!(
                found.rms_slope(),
                MapGenerator::new(&surface, cells).unwrap().rms_slope(),
                max_relative = ROUNDING
            );
            assert!(found.isotropy > 0.95, "{}", found.isotropy);
            let limits: Vec<f64> = found.bands.iter().flat_map(|b| b.limits).collect();
            assert!(limits.windows(2).all(|w| w[0] <= w[1]));
        }
    }
}

/// A quarter of a surface is not periodic: the window gives it the slope that the whole has, within the
/// scatter of its long waves, and the jump at the edges does not count.
#[test]
fn a_part_of_a_surface_is_windowed() {
    let whole = self_affine_map(&SelfAffine { roll_off: Some(16.0 * TAU), ..unit(0.8) }, 512, 1).unwrap();
    let part = whole.cropped(0..256, 0..256).unwrap();
    let found = MapStatistics::new(&part).unwrap();
    assert!(found.windowed && found.edge_step > 3.0, "{}", found.edge_step);
    let slope = rms_slope(&whole).unwrap();
    assert_relative_eq!(found.rms_slope(), slope, max_relative = 0.05);
    assert!(rms_slope(&part).unwrap() > 1.05 * slope);
}

/// Holes change neither what the edges do nor the tilt by more than the points that are missing.
#[test]
fn edges_and_tilt_are_known_with_holes() {
    let whole = self_affine_map(&unit(0.8), 64, 3).unwrap();
    let part = whole.cropped(0..48, 0..40).unwrap();
    let tilted = |map: &HeightMap, slope: f64| {
        let heights = map.heights().iter().enumerate();
        let columns = map.columns();
        let heights = heights.map(|(i, h)| h + slope * ((i % columns) as f64 - 0.4 * (i / columns) as f64));
        HeightMap::new(map.cells(), map.size(), heights.collect()).unwrap()
    };
    for map in [&whole, &part, &tilted(&whole, 0.2)] {
        let full = MapEdges::new(map).unwrap();
        let hole = |i: usize| {
            (i * 7919).is_multiple_of(31) || (60..64).contains(&(i / map.columns() + i % map.columns()))
        };
        let heights = map.heights().iter().enumerate().map(|(i, h)| if hole(i) { f64::NAN } else { *h });
        let holes = HeightMap::with_undefined(map.cells(), map.size(), heights.collect()).unwrap();
        let found = MapEdges::new(&holes).unwrap();
        assert_eq!(found.match_each_other(), full.match_each_other());
        assert_relative_eq!(found.edge_step, full.edge_step, max_relative = 0.2);
        assert!((found.tilt - full.tilt).abs() < 0.05, "{} {}", found.tilt, full.tilt);
    }
    assert!(MapEdges::new(&whole).unwrap().match_each_other());
    assert!(!MapEdges::new(&part).unwrap().match_each_other());
    // A plane is a tilt alone, whichever of its points are missing.
    let plane =
        |i: usize| if i % 5 == 2 || i > 300 { f64::NAN } else { (i % 20) as f64 - 3.0 * (i / 20) as f64 };
    let plane = HeightMap::with_undefined([20, 30], [2.0, 3.0], (0..600).map(plane).collect()).unwrap();
    assert_relative_eq!(MapEdges::new(&plane).unwrap().tilt, 1.0, max_relative = ROUNDING);
}

#[test]
fn what_is_no_sample_of_a_surface_is_refused() {
    let rough = self_affine_map(&unit(0.8), 64, 3).unwrap();
    let message = |map: &HeightMap| MapStatistics::new(map).unwrap_err().to_string();
    let tilted = HeightMap::from_fn(64, 1.0, |ix, _| rough.heights()[ix] + 0.2 * ix as f64).unwrap();
    assert!(message(&tilted).contains("`detrend = \"plane\"`"), "{}", message(&tilted));
    let mut heights = rough.heights().to_vec();
    heights[7] = f64::NAN;
    let holes = HeightMap::with_undefined(64, 1.0, heights).unwrap();
    assert!(message(&holes).starts_with("undefined points = 1: expected 0"), "{}", message(&holes));
    for n in [1, 2, 64] {
        let flat = HeightMap::from_fn(n, 1.0, |_, _| 7.0).unwrap();
        assert!(message(&flat).starts_with("rms height of the map = 0"), "{}", message(&flat));
    }
    // Lines of 65536 elements or 3: those of the map, or none of its waves.
    assert!(LineGenerator::of_map(&waves_of([32, 32], [1.0, 1.0], 1.0, [8.0, 8.0]), 3).is_err());
    for elements in [0, usize::MAX] {
        assert!(LineGenerator::of_map(&rough, elements).is_err());
    }
}

/// The line has the rms height of the map, and its spectrum follows the rule from the map's own.
#[test]
fn the_line_of_a_map_follows_the_rule() {
    for (hurst, roll_off, cells, size) in
        [(0.8, None, [256, 256], 1.0.into()), (0.4, Some(20.0), [320, 160], Size { x: 2.0, y: 1.0 })]
    {
        let surface = SelfAffine { roll_off, size, ..unit(hurst) };
        let map = self_affine_map(&surface, cells, 5).unwrap();
        let generator = LineGenerator::of_map(&map, 4096).unwrap();
        assert_relative_eq!(generator.rms_height(), 1.0, max_relative = ROUNDING);
        let line = generator.line(9).unwrap();
        assert_relative_eq!(rms_height(line.heights()), 1.0, max_relative = ROUNDING);
        assert_relative_eq!(line.length(), line_length(map.length()));
        assert!(generator.line(10).unwrap() != line);
        // Over an octave each: C_1D = pi q C_2D, within the lattice points of the annuli.
        let (one, two) = (line_spectrum(&line), radial_spectrum(&map).unwrap());
        for low in [60.0, 120.0, 240.0] {
            let inside = |q: f64| q >= low && q < 2.0 * low;
            let mean = |points: &mut dyn Iterator<Item = f64>| {
                let points: Vec<f64> = points.collect();
                points.iter().sum::<f64>() / points.len() as f64
            };
            let line = mean(&mut one.iter().filter(|p| inside(p.0)).map(|p| p.1));
            let rule =
                mean(&mut two.iter().filter(|p| inside(p.0)).map(|p| std::f64::consts::PI * p.0 * p.1));
            assert_relative_eq!(line, rule, max_relative = 0.1);
        }
    }
}

/// With a roll-off some octaves from the longest wave a line of the map is one of the surface that it was
/// drawn from, up to the map's shortest wave.
#[test]
fn the_line_of_a_map_is_that_of_its_surface() {
    let surface = SelfAffine { roll_off: Some(8.0 * TAU), short_cutoff: Some(64.0 * TAU), ..unit(0.7) };
    let map = self_affine_map(&surface, 256, 2).unwrap();
    let (of_map, of_surface) =
        (LineGenerator::of_map(&map, 8192).unwrap(), LineGenerator::new(&surface, 8192).unwrap());
    assert_relative_eq!(of_map.rms_slope(), of_surface.rms_slope(), max_relative = 0.02);
}

#[test]
fn self_affine_maps_are_told_from_others() {
    /// As in the tests of `surface_io::describe`.
    const SCATTER: f64 = 0.05;
    for hurst in [0.1, 0.4, 0.8, 1.0] {
        for seed in 0..4 {
            let fit = SelfAffineFit::new(&self_affine_map(&unit(hurst), 256, seed).unwrap()).unwrap();
            assert_abs_diff_eq!(fit.hurst, hurst, epsilon = SCATTER);
            // A part of it is none of the periodic ones.
            let part = self_affine_map(&unit(hurst), 512, seed).unwrap().cropped(0..256, 100..356).unwrap();
            let fit = SelfAffineFit::new(&part).unwrap();
            assert_abs_diff_eq!(fit.hurst, hurst, epsilon = 2.0 * SCATTER);
        }
    }
    let message = |map: &HeightMap| SelfAffineFit::new(map).unwrap_err().to_string();
    let rolled = |times: f64| {
        let surface = SelfAffine { roll_off: Some(times * TAU), ..unit(0.8) };
        message(&self_affine_map(&surface, 256, 1).unwrap())
    };
    assert!(rolled(4.0).starts_with("height variance of the longest waves"), "{}", rolled(4.0));
    assert!(rolled(24.0).starts_with("Hurst exponent of the longer waves"), "{}", rolled(24.0));
    assert!(rolled(100.0).starts_with("Hurst exponent of the spectrum"), "{}", rolled(100.0));
    let few = message(&self_affine_map(&unit(0.8), 64, 1).unwrap());
    assert!(few.contains("about 128 cells"), "{few}");
    // The smallest maps that are taken: none is refused for the scatter of its few waves.
    for seed in 0..32 {
        let fit = SelfAffineFit::new(&self_affine_map(&unit(0.8), 128, seed).unwrap());
        assert!(fit.as_ref().is_ok_and(|fit| (fit.hurst - 0.8).abs() < 0.2), "{seed}: {fit:?}");
    }
    let sine = message(&waves_of([256, 256], [1.0, 1.0], 1.0, [16.0, 16.0]));
    assert!(sine.contains("Hurst exponent"), "{sine}");
}
