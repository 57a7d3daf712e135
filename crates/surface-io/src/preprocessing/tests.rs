use crate::{AlignLines, Crop, Detrend, Fill, Mirror, Preprocessing, ReadOptions, Scan, Undefined, Window};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use contact_model::HeightMap;
use proptest::prelude::*;

/// Sums of a few hundred terms of size 1.
const ROUNDING: f64 = 1e-13;

/// The iteration that fills holes ends at 1e-12 of its first residual; the error is that times the width of
/// the hole.
const FILLED: f64 = 1e-10;

/// A scan of cells of side 1 with the height `f(x, y)` in column x of row y, NaN where it is missing.
fn scan(rows: usize, columns: usize, f: impl Fn(f64, f64) -> f64) -> Scan {
    scan_of("1", rows, columns, f)
}

/// The same with cells of the given sides.
fn scan_of(cell: &str, rows: usize, columns: usize, f: impl Fn(f64, f64) -> f64) -> Scan {
    let heights: Vec<f64> =
        (0..rows * columns).map(|i| f((i % columns) as f64, (i / columns) as f64)).collect();
    let declared = ReadOptions { cell: cell.parse().ok(), ..ReadOptions::default() };
    Scan::from_bytes("a.npy", &crate::npy(&[rows, columns], &heights).unwrap(), &declared).unwrap()
}

fn preprocessed(scan: &Scan, change: impl FnOnce(&mut Preprocessing)) -> crate::Result<HeightMap> {
    let mut preprocessing = Preprocessing::default();
    change(&mut preprocessing);
    scan.map(&preprocessing)
}

#[test]
fn units_are_metres_or_none() {
    let read = |cell: &str, unit: Option<&str>| {
        let unit = unit.map(|u| u.parse().unwrap());
        let declared = ReadOptions { cell: cell.parse().ok(), unit, ..ReadOptions::default() };
        let scan = Scan::from_bytes("a.txt", b"1 2\n3 4\n", &declared).unwrap();
        preprocessed(&scan, |_| ()).map_err(|e| e.to_string())
    };
    let map = read("0.5 um", Some("nm")).unwrap();
    assert_eq!((map.length().to_bits(), map.heights()), (1e-6_f64.to_bits(), &[1e-9, 2e-9, 3e-9, 4e-9][..]));
    let map = read("0.5", None).unwrap();
    assert_eq!((map.length().to_bits(), map.heights()), (1_f64.to_bits(), &[1.0, 2.0, 3.0, 4.0][..]));
    assert_eq!(read("0.5", Some("none")).unwrap(), map);
    assert!(read("0.5 um", None).unwrap_err().contains("say unit, such as nm"));
    assert!(
        read("0.5", Some("nm")).unwrap_err().contains("the side of a cell is 0.5, but the heights have nm")
    );
    assert!(read("0.5 um", Some("none")).unwrap_err().contains("but the heights have no unit"));
    assert!(
        read("", Some("none"))
            .unwrap_err()
            .contains("the size of the map is neither in the file nor given: say size, ")
    );
}

#[test]
fn crops_take_what_they_say() {
    let wide = scan(2, 5, |x, y| x + 10.0 * y);
    let whole = preprocessed(&wide, |_| ()).unwrap();
    assert_eq!((whole.columns(), whole.rows(), whole.size()), (5, 2, [5.0, 2.0].into()));
    assert_eq!(whole.heights()[5..], [10.0, 11.0, 12.0, 13.0, 14.0]);
    let map = preprocessed(&wide, |t| t.crop = Some(Crop::Centre)).unwrap();
    assert_eq!((map.length().to_bits(), map.heights()), (2_f64.to_bits(), &[1.0, 2.0, 11.0, 12.0][..]));
    let window = |row, column, rows, columns| {
        preprocessed(&wide, |t| t.crop = Some(Crop::Window { row, column, rows, columns }))
    };
    assert_eq!(window(0, 3, 2, 2).unwrap().heights(), [3.0, 4.0, 13.0, 14.0]);
    assert_eq!(window(1, 4, 1, 1).unwrap().heights(), [14.0]);
    let part = window(1, 1, 1, 3).unwrap();
    assert_eq!((part.heights(), part.size()), (&[11.0, 12.0, 13.0][..], [3.0, 1.0].into()));
    for (row, column, rows, columns) in
        [(0, 4, 2, 2), (1, 0, 2, 2), (0, 0, 0, 1), (0, 0, 1, 0), (usize::MAX, 0, 1, 1), (0, 5, 1, 1)]
    {
        let error = window(row, column, rows, columns).unwrap_err().to_string();
        assert!(error.contains("the map has 2 rows of 5"), "{error}");
    }
    // A square of oblong cells: 4 columns of 1 and 2 rows of 2.
    let oblong = scan_of("1 x 2", 2, 7, |x, _| x);
    let map = preprocessed(&oblong, |t| t.crop = Some(Crop::Centre)).unwrap();
    assert_eq!((map.columns(), map.rows(), map.size()), (4, 2, 4.0.into()));
    assert_eq!(map.heights()[..4], [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn undefined_points_are_refused_unless_filled_or_kept() {
    let hole = |x: f64, y: f64| (2.0..5.0).contains(&x) && (1.0..4.0).contains(&y);
    let plane = |x: f64, y: f64| 3.0 + 0.5 * x - 2.0 * y;
    let holed = scan(7, 7, |x, y| if hole(x, y) { f64::NAN } else { plane(x, y) });
    let error = preprocessed(&holed, |_| ()).unwrap_err().to_string();
    assert!(error.contains("9 of 49 points are undefined, the first in row 1, column 2"), "{error}");
    for fill in [Fill::Neighbours, Fill::Plane] {
        let map = preprocessed(&holed, |t| t.fill = Some(fill)).unwrap();
        for (i, h) in map.heights().iter().enumerate() {
            assert_abs_diff_eq!(*h, plane((i % 7) as f64, (i / 7) as f64), epsilon = FILLED);
        }
    }
    let map = preprocessed(&holed, |t| t.fill = Some(Fill::Value("-7".parse().unwrap()))).unwrap();
    assert!((map.heights()[7 + 2] + 7.0).abs() <= 0.0);
    let error = preprocessed(&holed, |t| t.fill = Some(Fill::Value("-7 nm".parse().unwrap()))).unwrap_err();
    assert!(
        error.to_string().contains("fill: -7 nm is a length: expected a number without a unit"),
        "{error}"
    );
    let empty = scan(2, 2, |_, _| f64::NAN);
    let error = preprocessed(&empty, |t| t.fill = Some(Fill::Neighbours)).unwrap_err().to_string();
    assert!(error.contains("4 of 4 points are undefined: expected one height at least"), "{error}");
    let error = preprocessed(&empty, |t| t.undefined = Some(Undefined::NoContact)).unwrap_err().to_string();
    assert!(error.contains("4 of 4 points are undefined"), "{error}");
    let error = preprocessed(&holed, |t| {
        t.undefined = Some(Undefined::NoContact);
        t.fill = Some(Fill::Plane);
    });
    let error = error.unwrap_err().to_string();
    assert!(error.contains("undefined points: fill is given, but undefined = \"no_contact\" too"), "{error}");
    // Without undefined points no fill is needed and none is done.
    let whole = scan(3, 3, plane);
    assert_eq!(
        preprocessed(&whole, |t| t.fill = Some(Fill::Plane)).unwrap(),
        preprocessed(&whole, |_| ()).unwrap()
    );
}

#[test]
fn filled_heights_are_the_means_of_their_neighbours() {
    // Holes at the edges, in a corner and inside; a single measured cell in a sea of holes.
    let rough = |x: f64, y: f64| (3.0 * x).sin() + (5.0 * y).cos();
    let missing = |x: f64, y: f64| (x * 7.0 + y * 11.0) % 5.0 < 3.0;
    let holed = scan(12, 12, |x, y| if missing(x, y) { f64::NAN } else { 1e6 + rough(x, y) });
    let map = preprocessed(&holed, |t| t.fill = Some(Fill::Neighbours)).unwrap();
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
    let map = preprocessed(&lone, |t| t.fill = Some(Fill::Neighbours)).unwrap();
    assert!(map.heights().iter().all(|h| (h - 4.0).abs() <= 0.0));
}

#[test]
fn trends_are_what_least_squares_give() {
    let quadric = |x: f64, y: f64| 1e3 + 2.0 * x - 3.0 * y + 0.1 * x * x - 0.2 * x * y + 0.05 * y * y;
    let bent = scan(9, 9, quadric);
    let flat = preprocessed(&bent, |t| t.detrend = Detrend::Quadric).unwrap();
    assert!(flat.heights().iter().all(|h| h.abs() < 1e3 * ROUNDING));
    // With holes, the fit is to what was measured: a filled value of any size does not bend it.
    let holed = scan(9, 9, |x, y| if x > 6.0 { f64::NAN } else { quadric(x, y) });
    let map = preprocessed(&holed, |t| {
        t.detrend = Detrend::Quadric;
        t.fill = Some(Fill::Value("1e6".parse().unwrap()));
    });
    let map = map.unwrap();
    assert_abs_diff_eq!(map.heights()[0], 0.0, epsilon = 1e3 * ROUNDING);
    assert_relative_eq!(map.heights()[8], 1e6 - quadric(8.0, 0.0), max_relative = ROUNDING);
    // A residue orthogonal to the plane stays as it is: x y on a centred square.
    let saddle = scan(5, 5, |x, y| (x - 2.0) * (y - 2.0) + x + 4.0);
    let map = preprocessed(&saddle, |t| t.detrend = Detrend::Plane).unwrap();
    for (i, h) in map.heights().iter().enumerate() {
        let (x, y) = ((i % 5) as f64 - 2.0, (i / 5) as f64 - 2.0);
        assert_abs_diff_eq!(*h, x * y, epsilon = 16.0 * ROUNDING);
    }
    let mean = preprocessed(&scan(2, 2, |x, y| x + 2.0 * y), |t| t.detrend = Detrend::Mean).unwrap();
    assert_eq!(mean.heights(), [-1.5, -0.5, 0.5, 1.5]);
    // Too few places for a plane, and all in one line.
    let line = scan(5, 5, |x, y| if (x - y).abs() > 0.0 { f64::NAN } else { x });
    let error = preprocessed(&line, |t| {
        t.detrend = Detrend::Plane;
        t.fill = Some(Fill::Neighbours);
    });
    let error = error.unwrap_err().to_string();
    assert!(error.contains("a trend of 3 unknowns is not determined by the 5 defined points"), "{error}");
    assert!(preprocessed(&scan(2, 2, |x, _| x), |t| t.detrend = Detrend::Quadric).is_err());
}

#[test]
fn coarser_cells_are_means() {
    let fine = scan(4, 4, |x, y| x + 4.0 * y);
    let map = preprocessed(&fine, |t| t.cells = Some(2)).unwrap();
    assert_eq!((map.heights(), map.length().to_bits()), (&[2.5, 4.5, 10.5, 12.5][..], 4_f64.to_bits()));
    // 3 cells to 2: weights 2/3 and 1/3.
    let map = preprocessed(&scan(3, 3, |x, _| 3.0 * x * x), |t| t.cells = Some(2)).unwrap();
    for (h, expected) in map.heights().iter().zip([1.0, 9.0, 1.0, 9.0]) {
        assert_relative_eq!(*h, expected, max_relative = ROUNDING);
    }
    for wrong in [0, 5] {
        let error = preprocessed(&fine, |t| t.cells = Some(wrong)).unwrap_err().to_string();
        assert!(error.contains(&format!("{wrong} columns: expected 1 to 4")), "{error}");
        let error = preprocessed(&fine, |t| t.rows = Some(wrong)).unwrap_err().to_string();
        assert!(error.contains(&format!("{wrong} rows: expected 1 to 4")), "{error}");
    }
    // Columns and rows each for themselves; half as many rows as columns stay half as many.
    let wide = scan_of("1 x 2", 4, 8, |x, y| x + 10.0 * y);
    let map = preprocessed(&wide, |t| t.cells = Some(2)).unwrap();
    assert_eq!((map.rows(), map.size()), (1, [8.0, 8.0].into()));
    assert_eq!(map.heights(), [16.5, 20.5]);
    let map = preprocessed(&wide, |t| t.rows = Some(2)).unwrap();
    assert_eq!((map.columns(), map.rows(), map.heights()[8]), (8, 2, 25.0));
    let map = preprocessed(&wide, |t| (t.cells, t.rows) = (Some(1), Some(4))).unwrap();
    assert_eq!(map.heights(), [3.5, 13.5, 23.5, 33.5]);
    assert_eq!(preprocessed(&fine, |t| t.cells = Some(4)).unwrap(), preprocessed(&fine, |_| ()).unwrap());
}

/// Points that are kept undefined stay so through the crop and the trend, and coarse cells follow their
/// larger half.
#[test]
fn undefined_points_are_kept() {
    let plane = |x: f64, y: f64| 5.0 + x - 2.0 * y;
    let gone = |x: f64, y: f64| x >= 4.0 && y < 1.0;
    let holed = scan_of("1 x 0.5", 3, 6, |x, y| if gone(x, y) { f64::NAN } else { plane(x, y) });
    let keep = |change: &dyn Fn(&mut Preprocessing)| {
        preprocessed(&holed, |t| {
            t.undefined = Some(Undefined::NoContact);
            change(t);
        })
        .unwrap()
    };
    let map = keep(&|_| ());
    assert_eq!((map.undefined(), map.size(), map.highest()), (2, [6.0, 1.5].into(), 8.0));
    assert_eq!(map.heights()[4..6], [f64::NEG_INFINITY; 2]);
    let map = keep(&|t| t.detrend = Detrend::Plane);
    assert!(map.undefined() == 2 && map.defined().all(|h| h.abs() < 10.0 * ROUNDING));
    let map = keep(&|t| t.crop = Some(Crop::Window { row: 0, column: 0, rows: 2, columns: 5 }));
    assert_eq!((map.undefined(), map.columns(), map.size()), (1, 5, [5.0, 1.0].into()));
    let map = keep(&|t| t.crop = Some(Crop::Window { row: 1, column: 0, rows: 2, columns: 6 }));
    assert_eq!(map.undefined(), 0);
    // Coarse cells of 4 columns: one defined, the other half defined and the mean of that half.
    let part = scan(1, 8, |x, _| if x >= 6.0 { f64::NAN } else { x });
    let coarser = |columns: usize| {
        preprocessed(&part, |t| (t.undefined, t.cells) = (Some(Undefined::NoContact), Some(columns))).unwrap()
    };
    assert_eq!(coarser(2).heights(), [1.5, 4.5]);
    assert_eq!(coarser(4).heights(), [0.5, 2.5, 4.5, f64::NEG_INFINITY]);
    assert_eq!((coarser(4).undefined(), coarser(1).heights()), (1, &[2.5][..]));
}

/// On oblong cells the fill is the five-point formula of the Laplacian with both spacings.
#[test]
fn fills_know_the_sides_of_a_cell() {
    // x^2 - y^2 is harmonic, on the grid too: dx = 1, dy = 1/4.
    let harmonic = |x: f64, y: f64| x * x - (0.25 * y).powi(2);
    let gone = |x: f64, y: f64| (1.0..6.0).contains(&x) && (1.0..9.0).contains(&y);
    let holed = scan_of("1 x 0.25", 10, 7, |x, y| if gone(x, y) { f64::NAN } else { harmonic(x, y) });
    let map = preprocessed(&holed, |t| t.fill = Some(Fill::Neighbours)).unwrap();
    for (i, h) in map.heights().iter().enumerate() {
        assert_abs_diff_eq!(*h, harmonic((i % 7) as f64, (i / 7) as f64), epsilon = 36.0 * FILLED);
    }
}

#[test]
fn cells_that_no_map_has_are_refused() {
    for cell in ["1 x 1e9", "1e9 x 1", "1 x 1.1e4"] {
        let error =
            preprocessed(&scan_of(cell, 2, 2, |x, _| x), |t| t.fill = Some(Fill::Neighbours)).unwrap_err();
        assert!(error.to_string().contains("a.npy: dx / dy (ratio of the sides of a cell) = "), "{error}");
    }
    assert!(preprocessed(&scan_of("1 x 1e4", 2, 2, |x, _| x), |_| ()).is_ok());
}

#[test]
fn extreme_heights_stay_finite_or_are_named() {
    let huge = scan(3, 3, |x, y| if x + y > 3.0 { f64::NAN } else { 8e307 * (x - y) / 2.0 });
    let map = preprocessed(&huge, |t| {
        t.detrend = Detrend::Plane;
        t.fill = Some(Fill::Neighbours);
    });
    assert!(map.is_ok());
    let declared =
        ReadOptions { cell: "1 m".parse().ok(), unit: "km".parse().ok(), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.txt", b"1e308", &declared).unwrap();
    assert!(preprocessed(&scan, |_| ()).unwrap_err().to_string().contains("after conversion"));
    let wide = Scan::from_bytes(
        "a.txt",
        b"1.5e308 -1.5e308\n0 0",
        &ReadOptions { cell: "1".parse().ok(), ..ReadOptions::default() },
    )
    .unwrap();
    assert!(preprocessed(&wide, |_| ()).unwrap_err().to_string().contains("range of heights"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn averaging_keeps_the_mean_and_the_range(cells in 1..12_usize, coarse in 1..12_usize, values in any::<[i16; 144]>()) {
        prop_assume!(coarse <= cells);
        let fine = scan(cells, cells, |x, y| f64::from(values[y as usize * 12 + x as usize]));
        let map = preprocessed(&fine, |t| t.cells = Some(coarse)).unwrap();
        let whole = preprocessed(&fine, |_| ()).unwrap();
        let mean = |m: &HeightMap| m.heights().iter().sum::<f64>() / m.heights().len() as f64;
        prop_assert!((mean(&map) - mean(&whole)).abs() <= 32768.0 * ROUNDING);
        prop_assert!(map.highest() <= whole.highest() + 32768.0 * ROUNDING);
    }

    /// What is left after a fit is orthogonal to what was fitted, and a second fit finds nothing.
    #[test]
    fn a_fit_leaves_nothing_to_fit(cells in 3..10_usize, values in any::<[i16; 100]>()) {
        let rough = scan(cells, cells, |x, y| f64::from(values[y as usize * 10 + x as usize]));
        for detrend in [Detrend::Mean, Detrend::Plane, Detrend::Quadric] {
            let once = preprocessed(&rough, |t| t.detrend = detrend).unwrap();
            let again = scan(cells, cells, |x, y| once.heights()[y as usize * cells + x as usize]);
            let twice = preprocessed(&again, |t| t.detrend = detrend).unwrap();
            for (a, b) in once.heights().iter().zip(twice.heights()) {
                prop_assert!((a - b).abs() <= 32768.0 * ROUNDING);
            }
        }
    }
}

#[test]
fn spheres_and_cylinders_are_found_and_nothing_is_left() {
    let subtract = |scan: &Scan, detrend| {
        let preprocessing = Preprocessing { detrend, ..Preprocessing::default() };
        let found = scan.preprocessed(&preprocessing).unwrap();
        let range = found.map.defined().fold([0.0_f64; 2], |[a, b], h| [a.min(h), b.max(h)]);
        (range[1] - range[0], found.steps.concat())
    };
    // Half of a ball from its side, a hollow, and nearly a plane: radii over the half diagonal of 25 x 18
    // cells.
    for (radius, x0, y0) in [(25.0, 3.0, 9.0), (-40.0, 10.0, 0.0), (2e4, -300.0, 700.0)] {
        let sphere = |x: f64, y: f64| {
            let square: f64 = radius * radius - (x - x0).powi(2) - (y - y0).powi(2);
            3.0 + radius.signum() * square.sqrt()
        };
        let (left, step) = subtract(&scan_of("1 x 1", 18, 25, sphere), Detrend::Sphere);
        assert!(left < 1e-8 * radius.abs(), "{radius}: {left:e}");
        let found: f64 = step.split("radius ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert_relative_eq!(found, radius.abs(), max_relative = 1e-6);
        assert!(step.contains(if radius > 0.0 { "a hill" } else { "a hollow" }), "{step}");
    }
    // A roller across the map, tilted along its axis.
    for (radius, angle, slope) in [(30.0_f64, 0.4_f64, 0.1_f64), (200.0, 1.3, -0.3), (-60.0, -0.7, 0.0)] {
        let cylinder = |x: f64, y: f64| {
            let (sin, cos) = angle.sin_cos();
            let (along, across) = (x * cos + y * sin, y * cos - x * sin);
            slope * along
                + radius.signum() * (radius * radius - (across - 2.0).powi(2)).sqrt() * slope.hypot(1.0)
        };
        let (left, step) = subtract(&scan_of("1 x 1", 18, 25, cylinder), Detrend::Cylinder);
        assert!(left < 1e-7 * radius.abs(), "{radius}: {left:e} {step}");
        let found: f64 = step.split("radius ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert_relative_eq!(found, radius.abs(), max_relative = 1e-6);
    }
    // A rough ball keeps its roughness; three points are no sphere.
    let rough = scan_of("1 x 1", 30, 30, |x, y| {
        (1e4 - (x - 12.0).powi(2) - (y - 20.0).powi(2)).sqrt() + 0.01 * (3.0 * x + 2.0 * y).sin()
    });
    let (left, _) = subtract(&rough, Detrend::Sphere);
    assert!((0.0199..0.021).contains(&left), "{left}");
    let small = scan_of("1 x 1", 1, 3, |x, _| x);
    assert!(small.map(&Preprocessing { detrend: Detrend::Sphere, ..Preprocessing::default() }).is_err());
}

#[test]
fn mirrors_turns_and_tapers() {
    let scan = scan_of("1 x 2", 2, 3, |x, y| x + 10.0 * y);
    let heights = |change: &dyn Fn(&mut Preprocessing)| preprocessed(&scan, change).unwrap();
    assert_eq!(heights(&|p| p.mirror = Some(Mirror::X)).heights(), [2.0, 1.0, 0.0, 12.0, 11.0, 10.0]);
    assert_eq!(heights(&|p| p.mirror = Some(Mirror::Y)).heights(), [10.0, 11.0, 12.0, 0.0, 1.0, 2.0]);
    let turned = heights(&|p| p.quarter_turns = 1);
    assert_eq!((turned.columns(), turned.dx(), turned.dy()), (2, 2.0, 1.0));
    assert_eq!(turned.heights(), [10.0, 0.0, 11.0, 1.0, 12.0, 2.0]);
    assert_eq!(heights(&|p| p.quarter_turns = 4).heights(), heights(&|_| ()).heights());
    let even = scan_of("1 x 1", 64, 64, |x, y| if (x as i64 + y as i64) % 2 == 0 { 1.0 } else { -1.0 });
    let tapered = preprocessed(&even, |p| p.window = Some(Window::Hann)).unwrap();
    let square = tapered.heights().iter().map(|h| h * h).sum::<f64>() / 4096.0;
    assert_relative_eq!(square.sqrt(), 1.0, max_relative = 1e-9);
    // 1.0 in the middle of the window over its rms, next to nothing at the corner.
    let largest = tapered.heights().iter().copied().fold(0.0, f64::max);
    assert_relative_eq!(largest, 8.0 / 3.0, max_relative = 5e-3);
    assert!(tapered.heights()[0].abs() < 1e-5);
    // The taper counts where points are defined.
    let half = scan_of("1 x 1", 64, 64, |x, y| match (x < 32.0, (x as i64 + y as i64) % 2 == 0) {
        (true, _) => f64::NAN,
        (_, even) => {
            if even {
                1.0
            } else {
                -1.0
            }
        }
    });
    let window = Preprocessing {
        window: Some(Window::Hann),
        undefined: Some(Undefined::NoContact),
        ..Preprocessing::default()
    };
    let found = half.preprocessed(&window).unwrap();
    let [before, after] = found.tapered.unwrap();
    assert_relative_eq!(after, before, max_relative = 1e-3);
    assert!(found.steps[0].contains("rms height 1 before, 1 after"), "{:?}", found.steps);
    let steps = scan.preprocessed(&Preprocessing {
        crop: Some(Crop::Window { row: 0, column: 1, rows: 2, columns: 2 }),
        outliers: Some(1e9),
        tip_radius: "0.1".parse().ok(),
        mirror: Some(Mirror::X),
        quarter_turns: 2,
        ..Preprocessing::default()
    });
    let steps = steps.unwrap().steps;
    assert_eq!(
        steps,
        [
            "cropped to 2 x 2 points from row 0, column 1 (from 0)",
            "0 outliers beyond 1000000000 robust standard deviations made undefined",
            "with a tip of radius 0.1, heights are reliable at all distances",
            "x reversed",
            "turned by 180 degrees",
        ]
    );
}

#[test]
fn undefined_points_are_cropped_away() {
    let holes = scan_of("1 x 1", 5, 6, |x, y| if x < 2.0 && y < 1.0 { f64::NAN } else { x + y });
    let map = preprocessed(&holes, |p| p.crop = Some(Crop::Defined)).unwrap();
    assert_eq!((map.columns(), map.rows(), map.undefined()), (6, 4, 0));
    for (change, expected) in [
        (
            Preprocessing { outliers: Some(0.0), ..Preprocessing::default() },
            "outliers = 0: expected a number > 0",
        ),
        (Preprocessing { tip_radius: "-1".parse().ok(), ..Preprocessing::default() }, "tip_radius = -1"),
        (Preprocessing { tip_radius: "1 um".parse().ok(), ..Preprocessing::default() }, "tip_radius: "),
    ] {
        let error = holes.map(&change).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// Lines 2 nm apart that jump by 3 nm, a streak of 50 nm in row 9, a wave across the lines at the cut-off; in
/// a file of nanometres.
fn scan_with_errors() -> Scan {
    let wave = |y: f64| (std::f64::consts::TAU * y / 10.0).cos();
    let height = |x: f64, y: f64| {
        let streak = if (y - 9.0).abs() < 0.5 && (30.0..46.0).contains(&x) { 50.0 } else { 0.0 };
        let jump = if y < 15.0 { 0.0 } else { 3.0 };
        // Columns of their own height, which no median of differences takes away.
        let band = if x < 8.0 { 4.0 * wave(y) } else { 0.0 };
        0.001 * (x * 7.7 + y * 1.3).sin() + streak + jump + band
    };
    let values: Vec<f64> = (0..60 * 40).map(|i| height(f64::from(i % 60), f64::from(i / 60))).collect();
    let bytes = crate::npy(&[40, 60], &values).unwrap();
    let declared =
        ReadOptions { cell: "1 nm x 2 nm".parse().ok(), unit: "nm".parse().ok(), ..ReadOptions::default() };
    Scan::from_bytes("a.npy", &bytes, &declared).unwrap()
}

#[test]
fn errors_of_scanning_are_repaired_in_order_and_told() {
    let all = Preprocessing {
        crop: Some(Crop::Window { row: 0, column: 0, rows: 40, columns: 59 }),
        align_lines: Some(AlignLines::MedianDifference),
        scars: Some(20.0),
        outliers: Some(1e9),
        tip_radius: "1 nm".parse().ok(),
        fill: Some(Fill::Neighbours),
        detrend: Detrend::Mean,
        filter_across: "20 nm".parse().ok(),
        mirror: Some(Mirror::X),
        ..Preprocessing::default()
    };
    let found = scan_with_errors().preprocessed(&all).unwrap();
    let beginnings = [
        "cropped to 59 x 40 points",
        "scan lines shifted by 1.4",
        "16 points of scars made undefined, in 1 run along x: beyond 20 times ",
        "0 outliers beyond 1000000000 robust",
        "with a tip of radius 1 nm, heights are reliable",
        "16 undefined points filled",
        "the mean of least squares subtracted",
        "filtered across the scan lines, cut-off 20 nm: rms height 1.",
        "x reversed",
    ];
    assert_eq!(found.steps.len(), beginnings.len(), "{:?}", found.steps);
    for (step, beginning) in found.steps.iter().zip(beginnings) {
        assert!(step.starts_with(beginning), "{step}\n{beginning}");
    }
    let h = |row: usize, column: usize| 1e9 * found.map.heights()[row * 59 + 58 - column];
    // Half of the band far from the edges; the jump and the streak are gone.
    assert_abs_diff_eq!(h(20, 5) - h(20, 55), 2.0, epsilon = 0.05);
    assert_abs_diff_eq!(h(30, 55) - h(2, 55), 0.0, epsilon = 0.05);
    assert_abs_diff_eq!(h(9, 40), h(9, 55), epsilon = 0.05);
}

/// As others: an error unless something is said of them.
#[test]
fn scars_are_undefined_points() {
    let scan = scan_with_errors();
    let bare = Preprocessing {
        scars: Some(20.0),
        align_lines: Some(AlignLines::MedianDifference),
        ..Preprocessing::default()
    };
    let error = scan.map(&bare).unwrap_err().to_string();
    assert!(error.contains("16 of 2400 points are undefined, the first in row 9, column 30"), "{error}");
    let kept = Preprocessing { undefined: Some(Undefined::NoContact), ..bare };
    assert_eq!(scan.map(&kept).unwrap().undefined(), 16);
}

#[test]
fn limits_of_scars_are_positive_numbers() {
    let scan = scan_with_errors();
    for (scars, expected) in [
        (0.0, "scars = 0: expected a number > 0"),
        (-2.0, "scars = -2: expected a number > 0"),
        (f64::NAN, "scars = NaN: expected a number > 0"),
        (f64::INFINITY, "scars = inf: expected a number > 0"),
    ] {
        let error = preprocessed(&scan, |p| p.scars = Some(scars)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn cut_offs_are_lengths_from_four_cells_to_the_side() {
    let scan = scan_with_errors();
    for (cut_off, expected) in [
        (
            "7.9 nm",
            "filter_across = 7.9e-9: expected a wavelength from 8e-9, four cells, to 8e-8, the side of the map across",
        ),
        ("81 nm", "filter_across = 8.1e-8: "),
        ("0 nm", "filter_across = 0: "),
        ("-9 nm", "filter_across = -9e-9: "),
        ("5", "filter_across: 5 "),
    ] {
        let error = preprocessed(&scan, |p| p.filter_across = cut_off.parse().ok()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    for cut_off in ["8 nm", "80 nm"] {
        assert!(preprocessed(&scan, |p| p.filter_across = cut_off.parse().ok()).is_ok());
    }
}

/// No wave runs across it, no line is off another.
#[test]
fn a_map_of_one_line_is_filtered_by_no_cut_off_and_needs_no_other_repair() {
    let line = scan_of("1", 1, 30, |x, _| x);
    let filter = Preprocessing { filter_across: "4".parse().ok(), ..Preprocessing::default() };
    let error = line.map(&filter).unwrap_err().to_string();
    assert!(error.contains("from 4, four cells, to 1, the side"), "{error}");
    let rest = Preprocessing {
        align_lines: Some(AlignLines::MedianDifference),
        scars: Some(3.0),
        ..Preprocessing::default()
    };
    assert_eq!(line.map(&rest).unwrap(), line.map(&Preprocessing::default()).unwrap());
}
