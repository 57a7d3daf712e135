use crate::{Crop, Declared, Detrend, Fill, Scan, Treatment};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use contact_model::HeightMap;
use proptest::prelude::*;

/// Sums of a few hundred terms of size 1.
const ROUNDING: f64 = 1e-13;

/// The iteration that fills holes ends at 1e-12 of its first residual; the error is that times the width of the hole.
const FILLED: f64 = 1e-10;

/// A scan of cells of side 1 with the height `f(x, y)` in column x of row y, NaN where it is missing.
fn scan(rows: usize, columns: usize, f: impl Fn(f64, f64) -> f64) -> Scan {
    let heights: Vec<f64> =
        (0..rows * columns).map(|i| f((i % columns) as f64, (i / columns) as f64)).collect();
    let declared = Declared { cell: "1".parse().ok(), ..Declared::default() };
    Scan::from_bytes("a.npy", &crate::npy(&[rows, columns], &heights).unwrap(), &declared).unwrap()
}

fn treated(scan: &Scan, change: impl FnOnce(&mut Treatment)) -> crate::Result<HeightMap> {
    let mut treatment = Treatment::default();
    change(&mut treatment);
    scan.map(&treatment)
}

#[test]
fn units_are_metres_or_none() {
    let read = |cell: &str, unit: Option<&str>| {
        let unit = unit.map(|u| u.parse().unwrap());
        let declared = Declared { cell: cell.parse().ok(), unit, ..Declared::default() };
        let scan = Scan::from_bytes("a.txt", b"1 2\n3 4\n", &declared).unwrap();
        treated(&scan, |_| ()).map_err(|e| e.to_string())
    };
    let map = read("0.5 um", Some("nm")).unwrap();
    assert_eq!((map.length().to_bits(), map.heights()), (1e-6_f64.to_bits(), &[1e-9, 2e-9, 3e-9, 4e-9][..]));
    let map = read("0.5", None).unwrap();
    assert_eq!((map.length().to_bits(), map.heights()), (1_f64.to_bits(), &[1.0, 2.0, 3.0, 4.0][..]));
    assert_eq!(read("0.5", Some("none")).unwrap(), map);
    assert!(read("0.5 um", None).unwrap_err().contains("say unit = \"nm\""));
    assert!(
        read("0.5", Some("nm")).unwrap_err().contains("the side of a cell is 0.5, but the heights have nm")
    );
    assert!(read("0.5 um", Some("none")).unwrap_err().contains("but the heights have no unit"));
    assert!(read("", Some("none")).unwrap_err().contains("say cell = "));
}

#[test]
fn crops_take_what_they_say() {
    let wide = scan(2, 5, |x, y| x + 10.0 * y);
    let error = treated(&wide, |_| ()).unwrap_err().to_string();
    assert!(error.contains("2 rows of 5: expected a square map; crop = \"centre\""), "{error}");
    let map = treated(&wide, |t| t.crop = Some(Crop::Centre)).unwrap();
    assert_eq!((map.length().to_bits(), map.heights()), (2_f64.to_bits(), &[1.0, 2.0, 11.0, 12.0][..]));
    let window = |row, column, cells| treated(&wide, |t| t.crop = Some(Crop::Window { row, column, cells }));
    assert_eq!(window(0, 3, 2).unwrap().heights(), [3.0, 4.0, 13.0, 14.0]);
    assert_eq!(window(1, 4, 1).unwrap().heights(), [14.0]);
    for (row, column, cells) in [(0, 4, 2), (1, 0, 2), (0, 0, 0), (usize::MAX, 0, 1), (0, 5, 1)] {
        let error = window(row, column, cells).unwrap_err().to_string();
        assert!(error.contains("the map has 2 rows of 5"), "{error}");
    }
}

#[test]
fn holes_are_refused_unless_filled() {
    let hole = |x: f64, y: f64| (2.0..5.0).contains(&x) && (1.0..4.0).contains(&y);
    let plane = |x: f64, y: f64| 3.0 + 0.5 * x - 2.0 * y;
    let holed = scan(7, 7, |x, y| if hole(x, y) { f64::NAN } else { plane(x, y) });
    let error = treated(&holed, |_| ()).unwrap_err().to_string();
    assert!(error.contains("9 of 49 cells have no height, the first in row 1, column 2"), "{error}");
    for fill in [Fill::Neighbours, Fill::Plane] {
        let map = treated(&holed, |t| t.fill = Some(fill)).unwrap();
        for (i, h) in map.heights().iter().enumerate() {
            assert_abs_diff_eq!(*h, plane((i % 7) as f64, (i / 7) as f64), epsilon = FILLED);
        }
    }
    let map = treated(&holed, |t| t.fill = Some(Fill::Value("-7".parse().unwrap()))).unwrap();
    assert!((map.heights()[7 + 2] + 7.0).abs() <= 0.0);
    let error = treated(&holed, |t| t.fill = Some(Fill::Value("-7 nm".parse().unwrap()))).unwrap_err();
    assert!(
        error.to_string().contains("fill: -7e-9 m is a length: expected a number without a unit"),
        "{error}"
    );
    let empty = scan(2, 2, |_, _| f64::NAN);
    let error = treated(&empty, |t| t.fill = Some(Fill::Neighbours)).unwrap_err().to_string();
    assert!(error.contains("none of the 4 cells has a height"), "{error}");
    // Without holes no fill is needed and none is done.
    let whole = scan(3, 3, plane);
    assert_eq!(treated(&whole, |t| t.fill = Some(Fill::Plane)).unwrap(), treated(&whole, |_| ()).unwrap());
}

#[test]
fn filled_heights_are_the_means_of_their_neighbours() {
    // Holes at the edges, in a corner and inside; a single measured cell in a sea of holes.
    let rough = |x: f64, y: f64| (3.0 * x).sin() + (5.0 * y).cos();
    let missing = |x: f64, y: f64| (x * 7.0 + y * 11.0) % 5.0 < 3.0;
    let holed = scan(12, 12, |x, y| if missing(x, y) { f64::NAN } else { 1e6 + rough(x, y) });
    let map = treated(&holed, |t| t.fill = Some(Fill::Neighbours)).unwrap();
    let at = |x: usize, y: usize| map.heights()[y * 12 + x] - 1e6;
    for y in 0..12 {
        for x in 0..12 {
            if missing(x as f64, y as f64) {
                // Steps of -1, 0 and 1; what leaves the map to the left or above wraps far to the right.
                let steps = [(0_usize, 1_usize), (2, 1), (1, 0), (1, 2)]
                    .map(|(i, j)| ((x + i).wrapping_sub(1_usize), (y + j).wrapping_sub(1_usize)));
                let around: Vec<f64> =
                    steps.iter().filter(|&&(i, j)| i < 12 && j < 12).map(|&(i, j)| at(i, j)).collect();
                let mean = around.iter().sum::<f64>() / around.len() as f64;
                // The offset of 1e6 leaves ten digits.
                assert_abs_diff_eq!(at(x, y), mean, epsilon = 1e-9);
            }
        }
    }
    let lone = scan(9, 9, |x, y| if x + y > 0.0 { f64::NAN } else { 4.0 });
    let map = treated(&lone, |t| t.fill = Some(Fill::Neighbours)).unwrap();
    assert!(map.heights().iter().all(|h| (h - 4.0).abs() <= 0.0));
}

#[test]
fn trends_are_what_least_squares_give() {
    let quadric = |x: f64, y: f64| 1e3 + 2.0 * x - 3.0 * y + 0.1 * x * x - 0.2 * x * y + 0.05 * y * y;
    let bent = scan(9, 9, quadric);
    let flat = treated(&bent, |t| t.detrend = Detrend::Quadric).unwrap();
    assert!(flat.heights().iter().all(|h| h.abs() < 1e3 * ROUNDING));
    // With holes, the fit is to what was measured: a filled value of any size does not bend it.
    let holed = scan(9, 9, |x, y| if x > 6.0 { f64::NAN } else { quadric(x, y) });
    let map = treated(&holed, |t| {
        t.detrend = Detrend::Quadric;
        t.fill = Some(Fill::Value("1e6".parse().unwrap()));
    });
    let map = map.unwrap();
    assert_abs_diff_eq!(map.heights()[0], 0.0, epsilon = 1e3 * ROUNDING);
    assert_relative_eq!(map.heights()[8], 1e6 - quadric(8.0, 0.0), max_relative = ROUNDING);
    // A residue orthogonal to the plane stays as it is: x y on a centred square.
    let saddle = scan(5, 5, |x, y| (x - 2.0) * (y - 2.0) + x + 4.0);
    let map = treated(&saddle, |t| t.detrend = Detrend::Plane).unwrap();
    for (i, h) in map.heights().iter().enumerate() {
        let (x, y) = ((i % 5) as f64 - 2.0, (i / 5) as f64 - 2.0);
        assert_abs_diff_eq!(*h, x * y, epsilon = 16.0 * ROUNDING);
    }
    let mean = treated(&scan(2, 2, |x, y| x + 2.0 * y), |t| t.detrend = Detrend::Mean).unwrap();
    assert_eq!(mean.heights(), [-1.5, -0.5, 0.5, 1.5]);
    // Too few places for a plane, and all in one line.
    let line = scan(5, 5, |x, y| if (x - y).abs() > 0.0 { f64::NAN } else { x });
    let error = treated(&line, |t| {
        t.detrend = Detrend::Plane;
        t.fill = Some(Fill::Neighbours);
    });
    let error = error.unwrap_err().to_string();
    assert!(error.contains("a trend of 3 unknowns is not determined by the 5 cells"), "{error}");
    assert!(treated(&scan(2, 2, |x, _| x), |t| t.detrend = Detrend::Quadric).is_err());
}

#[test]
fn coarser_cells_are_means() {
    let fine = scan(4, 4, |x, y| x + 4.0 * y);
    let map = treated(&fine, |t| t.cells = Some(2)).unwrap();
    assert_eq!((map.heights(), map.length().to_bits()), (&[2.5, 4.5, 10.5, 12.5][..], 4_f64.to_bits()));
    // 3 cells to 2: weights 2/3 and 1/3.
    let map = treated(&scan(3, 3, |x, _| 3.0 * x * x), |t| t.cells = Some(2)).unwrap();
    for (h, expected) in map.heights().iter().zip([1.0, 9.0, 1.0, 9.0]) {
        assert_relative_eq!(*h, expected, max_relative = ROUNDING);
    }
    for wrong in [0, 5] {
        let error = treated(&fine, |t| t.cells = Some(wrong)).unwrap_err().to_string();
        assert!(error.contains("expected 1 to 4"), "{error}");
    }
    assert_eq!(treated(&fine, |t| t.cells = Some(4)).unwrap(), treated(&fine, |_| ()).unwrap());
}

#[test]
fn extreme_heights_stay_finite_or_are_named() {
    let huge = scan(3, 3, |x, y| if x + y > 3.0 { f64::NAN } else { 8e307 * (x - y) / 2.0 });
    let map = treated(&huge, |t| {
        t.detrend = Detrend::Plane;
        t.fill = Some(Fill::Neighbours);
    });
    assert!(map.is_ok());
    let declared = Declared { cell: "1 m".parse().ok(), unit: "km".parse().ok(), ..Declared::default() };
    let scan = Scan::from_bytes("a.txt", b"1e308", &declared).unwrap();
    assert!(treated(&scan, |_| ()).unwrap_err().to_string().contains("after conversion"));
    let wide = Scan::from_bytes(
        "a.txt",
        b"1.5e308 -1.5e308\n0 0",
        &Declared { cell: "1".parse().ok(), ..Declared::default() },
    )
    .unwrap();
    assert!(treated(&wide, |_| ()).unwrap_err().to_string().contains("relief"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn averaging_keeps_the_mean_and_the_range(cells in 1..12_usize, coarse in 1..12_usize, values in any::<[i16; 144]>()) {
        prop_assume!(coarse <= cells);
        let fine = scan(cells, cells, |x, y| f64::from(values[y as usize * 12 + x as usize]));
        let map = treated(&fine, |t| t.cells = Some(coarse)).unwrap();
        let whole = treated(&fine, |_| ()).unwrap();
        let mean = |m: &HeightMap| m.heights().iter().sum::<f64>() / m.heights().len() as f64;
        prop_assert!((mean(&map) - mean(&whole)).abs() <= 32768.0 * ROUNDING);
        prop_assert!(map.highest() <= whole.highest() + 32768.0 * ROUNDING);
    }

    /// What is left after a fit is orthogonal to what was fitted, and a second fit finds nothing.
    #[test]
    fn a_fit_leaves_nothing_to_fit(cells in 3..10_usize, values in any::<[i16; 100]>()) {
        let rough = scan(cells, cells, |x, y| f64::from(values[y as usize * 10 + x as usize]));
        for detrend in [Detrend::Mean, Detrend::Plane, Detrend::Quadric] {
            let once = treated(&rough, |t| t.detrend = detrend).unwrap();
            let again = scan(cells, cells, |x, y| once.heights()[y as usize * cells + x as usize]);
            let twice = treated(&again, |t| t.detrend = detrend).unwrap();
            for (a, b) in once.heights().iter().zip(twice.heights()) {
                prop_assert!((a - b).abs() <= 32768.0 * ROUNDING);
            }
        }
    }
}
