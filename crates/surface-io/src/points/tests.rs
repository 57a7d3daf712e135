use crate::{ContentError, Quantity, ReadOptions, Scan};
use contact_model::Size;
use proptest::prelude::*;
use std::fmt::Write as _;

fn read(text: &str) -> crate::Result<Scan> {
    Scan::from_bytes("a.xyz", text.as_bytes(), &ReadOptions::default())
}

fn error(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

#[test]
fn points_in_any_order_with_an_undefined_one() {
    let scan = read("1 1 4\n0 0 1\n\n1 0 2 # last\n2 0 3\n0 1 nan\n").unwrap();
    let found = scan.metadata();
    assert_eq!((found.rows, found.columns, found.undefined), (2, 3, 2));
    assert_eq!(found.details, "5 points, spaces between numbers");
    assert_eq!(found.cell.clone().unwrap().value[0].to_string(), "1");
    assert_eq!((scan.height(0, 2), scan.height(1, 1), scan.height(1, 2)), (Some(3.0), Some(4.0), None));
}

#[test]
fn printed_digits_do_not_bend_the_grid() {
    let mut text = String::from("# Lateral units: mm\n# Value units: um\n");
    for i in 0..10 {
        for j in 0..10 {
            writeln!(text, "{:.2},{:.2},{}", -0.5 + f64::from(i) / 3.0, f64::from(j) / 3.0, i + j).unwrap();
        }
    }
    let scan = read(&text).unwrap();
    assert_eq!((scan.metadata().rows, scan.metadata().columns, scan.metadata().undefined), (10, 10, 0));
    approx::assert_relative_eq!(
        scan.metadata().cell.clone().unwrap().value[1].value(),
        1e-3 / 3.0,
        max_relative = 1e-12
    );
    assert_eq!(scan.height(3, 7), Some(10.0));
}

#[test]
fn noise_needs_a_cell() {
    // A stage that wanders by a tenth of the step.
    let mut text = String::new();
    for k in 0..64_u32 {
        let noise = |salt: u32| f64::from((k * 37 + salt) % 19) / 95.0 - 0.1;
        writeln!(text, "{} {} {k}", f64::from(k % 8) + noise(0), f64::from(k / 8) + noise(7)).unwrap();
    }
    let complaint = error(&text);
    assert!(complaint.contains("say cell"), "{complaint}");
    let declared = ReadOptions { cell: "1".parse().ok(), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.xyz", text.as_bytes(), &declared).unwrap();
    assert_eq!((scan.metadata().rows, scan.metadata().columns, scan.metadata().undefined), (8, 8, 0));
    assert_eq!(scan.height(7, 7), Some(63.0));
    assert!(scan.metadata().details.contains("% of a cell off their places"));
    for wrong in ["2", "0.4", "0.001", "1e-300"] {
        let declared = ReadOptions { cell: wrong.parse().ok(), ..ReadOptions::default() };
        assert!(Scan::from_bytes("a.xyz", text.as_bytes(), &declared).is_err(), "{wrong}");
    }
}

#[test]
fn bad_points_are_named() {
    for (text, expected) in [
        ("0 0 1\n1 0 2\n0 0 3\n", "the points of lines 1 and 3 are both at x = 0, y = 0"),
        ("0 0 1\n1 0 2\n2.4 0 3\n", "x = 1 is off the grid x = 0 + i * 1.2"),
        ("0 0 1\n1 1 2\n2 2 3\n3 3 3\n", "4 points on a grid of 4 x 4"),
        ("0 0 1\n1 nan 2\n", "line 2 has no y"),
        ("0 0\n1 0\n", "line 1 has 2 values: expected x, y and z"),
        ("0 0 1\n1e308 0 2\n-1e308 0 1\n", "beyond the range"),
        ("# Value units: nm\n0 0 1\n", "say lateral_unit"),
        ("", "no data"),
    ] {
        assert!(error(text).contains(expected), "{}: {expected}", error(text));
    }
    let declared = ReadOptions { size: "3 x 2".parse().ok(), ..ReadOptions::default() };
    let error = Scan::from_bytes("a.xyz", b"0 0 1\n1 0 2\n0 1 3\n1 1 4\n", &declared).unwrap_err();
    assert_eq!(error.to_string(), "a.xyz: size along x: 2 from the file, but 3 as given");
    let declared = ReadOptions { lateral_unit: "mm".parse().ok(), ..ReadOptions::default() };
    let text = b"# Lateral units: um\n0 0 1\n";
    assert!(matches!(
        Scan::from_bytes("a.xyz", text, &declared).unwrap_err().problem(),
        Some(ContentError::Contradiction { what: "unit of x and y", .. })
    ));
    let declared = ReadOptions { cell: "1 um".parse().ok(), ..ReadOptions::default() };
    assert!(
        Scan::from_bytes("a.xyz", b"0 0 1\n", &declared)
            .unwrap_err()
            .to_string()
            .contains("x and y have no unit")
    );
}

#[test]
fn cells_are_oblong_or_square_as_the_points_say() {
    let cell = |text: &str| read(text).unwrap().metadata().cell.clone().unwrap().value.map(Quantity::value);
    assert_eq!(Size::from(cell("0 0 1\n1 0 2\n0 2 3\n1 2 3\n")), [1.0, 2.0].into());
    // Points off their places by 0.5 % leave the spacing of three of them open to 1 %: 1.005 and 0.995 are
    // one.
    let [dx, dy] =
        cell("0 0 1\n1.01 0 2\n2.01 0 3\n0 1 1\n1.01 1 2\n2.01 1 3\n0 1.99 1\n1.01 1.99 2\n2.01 1.99 3\n");
    assert!(dx.to_bits() == dy.to_bits() && (dx - 1.0).abs() < 1e-12);
    let exact = cell("0 0 1\n1 0 2\n2 0 3\n0 0.99 1\n1 0.99 2\n2 0.99 3\n0 1.98 1\n1 1.98 2\n2 1.98 3\n");
    assert_eq!(Size::from(exact), [1.0, 0.99].into());
    // One row has no spacing along y unless somebody says it: a map of one row is no profile.
    let row = "0 0 1\n1 0 2\n2 0 3\n";
    assert_eq!(read(row).unwrap().metadata().cell, None);
    assert!(!read(row).unwrap().metadata().profile);
    let headed = format!("# Width: 3\n# Height: 0.5\n# Lateral units: none\n# Value units: none\n{row}");
    assert_eq!(Size::from(cell(&headed)), [1.0, 0.5].into());
    assert!(!read(&headed).unwrap().metadata().profile);
    let declared = ReadOptions { cell: "1 x 0.25".parse().ok(), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.xyz", row.as_bytes(), &declared).unwrap();
    assert_eq!(Size::from(scan.metadata().size.unwrap().map(Quantity::value)), [3.0, 0.25].into());
}

#[test]
fn one_point_has_no_spacing() {
    let scan = read("3 4 5\n").unwrap();
    assert_eq!((scan.metadata().rows, scan.metadata().columns), (1, 1));
    assert_eq!(scan.metadata().cell, None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A grid comes back whatever its order, origin and spacing, with a third of its points missing.
    #[test]
    fn any_regular_grid_is_found(
        rows in 2..7_usize,
        columns in 2..7_usize,
        origin in -1e3..1e3_f64,
        spacing in (1e-3..1e3_f64, 1e-3..1e3_f64),
        keys in prop::collection::vec(any::<u32>(), 36),
    ) {
        let mut kept: Vec<usize> = (0..rows * columns).collect();
        // The corners stay, so that the range does.
        kept.retain(|&i| {
            let (row, column) = (i / columns, i % columns);
            keys[i] % 3 > 0 || row < 2 || column < 2 || row + 1 == rows || column + 1 == columns
        });
        kept.sort_by_key(|&i| keys[i]);
        let mut text = String::new();
        for &i in &kept {
            let at = |k: usize, spacing: f64| origin + spacing * k as f64;
            writeln!(text, "{} {} {}", at(i % columns, spacing.0), at(i / columns, spacing.1), i).unwrap();
        }
        let scan = read(&text).unwrap();
        prop_assert_eq!((scan.metadata().rows, scan.metadata().columns), (rows, columns));
        prop_assert_eq!(scan.metadata().undefined, rows * columns - kept.len());
        for i in kept {
            prop_assert_eq!(scan.height(i / columns, i % columns), Some(i as f64));
        }
        let [dx, dy] = scan.metadata().cell.clone().unwrap().value.map(Quantity::value);
        // Coordinates are rounded at the size of the origin.
        prop_assert!((dx - spacing.0).abs() <= 1e-12 * (origin.abs() + spacing.0));
        prop_assert!((dy - spacing.1).abs() <= 1e-12 * (origin.abs() + spacing.1));
    }
}

#[test]
fn profiles_are_lines() {
    let declared =
        ReadOptions { unit: "nm".parse().ok(), lateral_unit: "um".parse().ok(), ..ReadOptions::default() };
    let line = crate::profile_from_bytes("a.txt", b"1.0\t5\n0.0\t4\n0.5\t6\n", &declared).unwrap();
    assert_eq!((line.length().to_bits(), line.heights()), (1.5e-6_f64.to_bits(), &[4e-9, 6e-9, 5e-9][..]));
    let headed = b"x [um]\tz [nm]\r\n0,0\t5\r\n0,5\t6\r\n1,0\t4\r\n";
    let line = crate::profile_from_bytes("a.txt", headed, &ReadOptions::default()).unwrap();
    assert_eq!((line.elements(), line.heights()[1].to_bits()), (3, 6e-9_f64.to_bits()));
    let counts = ReadOptions { unit: None, height_scale: "2 nm".parse().ok(), ..declared.clone() };
    let line = crate::profile_from_bytes("a.txt", b"0 1\n1 2\n", &counts).unwrap();
    assert_eq!(line.heights(), [2e-9, 4e-9]);
    for (text, change, expected) in [
        ("0 1\n1 2\n3 4\n", None, "1 of the 4 places of the profile have no height"),
        ("0 1\n1 nan\n2 3\n", None, "1 of the 3 places"),
        ("0 1\n1 2\n2.4 3\n", None, "off the grid"),
        ("0 1\n0 2\n1 3\n", None, "lines 1 and 2"),
        ("nan 1\n1 2\n", None, "line 1 has no x"),
        ("0 1 2\n1 2 3\n", None, "line 1 has 3 values: expected x and z"),
        ("0 1\n1 2\n", Some(ReadOptions { lateral_unit: None, ..declared.clone() }), "the unit of x and y"),
        ("0 1\n1 2\n", Some(ReadOptions { unit: None, ..declared.clone() }), "the unit of the heights"),
        ("0 1\n1 2\n", Some(ReadOptions { size: "1 um".parse().ok(), ..declared.clone() }), "size was given"),
        ("3 1\n", None, "the step of the profile"),
        ("\u{93}NUMPY", None, "expected a number"),
    ] {
        let declared = change.as_ref().unwrap_or(&declared);
        let error = crate::profile_from_bytes("a.txt", text.as_bytes(), declared).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\n{expected}");
    }
    let npy = crate::npy(&[1, 2], &[1.0, 2.0]).unwrap();
    assert!(crate::profile_from_bytes("a.npy", &npy, &declared).unwrap_err().to_string().contains("NPY"));
}

/// A profile of x in um and heights in nm.
fn profile(text: &str, change: impl FnOnce(&mut ReadOptions)) -> crate::Result<Scan> {
    let mut declared = ReadOptions {
        unit: "nm".parse().ok(),
        lateral_unit: "um".parse().ok(),
        format: Some(crate::Format::Profile),
        ..ReadOptions::default()
    };
    change(&mut declared);
    Scan::from_bytes("a.txt", text.as_bytes(), &declared)
}

/// Of two points the format has to be said.
#[test]
fn profiles_are_maps_of_one_row() {
    // The cell along y is a square.
    let two = profile("0 1\n2 4\n", |_| ()).unwrap();
    let map = two.map(&crate::Preprocessing::default()).unwrap();
    assert_eq!((map.columns(), map.rows(), map.dx(), map.dy()), (2, 1, 2e-6, 2e-6));
    assert!((map.heights()[1] / 4e-9 - 1.0).abs() < 1e-12);
    let wide = profile("0 1\n2 4\n", |d| d.size = "4 um x 1 mm".parse().ok()).unwrap();
    assert!(wide.metadata().profile);
    assert_eq!(wide.map(&crate::Preprocessing::default()).unwrap().dy().to_bits(), 1e-3_f64.to_bits());
    // A size that contradicts x.
    let wrong = profile("0 1\n2 4\n", |d| d.size = "5 um x 1 mm".parse().ok());
    assert!(wrong.unwrap_err().to_string().contains("size along x"));
}

#[test]
fn one_row_of_a_matrix_with_both_sides_is_no_profile() {
    let row = Scan::from_bytes("a.txt", b"# Width: 3 um\n# Height: 1 um\n1 2 3\n", &ReadOptions::default());
    assert!(!row.unwrap().metadata().profile);
}

#[test]
fn undefined_points_of_profiles_are_named_and_filled_on_request() {
    let holed = profile("0 1\n1 nan\n2 3\n3 4\n5 6\n", |_| ()).unwrap();
    assert_eq!(holed.metadata().undefined, 2);
    assert!(holed.map(&crate::Preprocessing::default()).unwrap_err().to_string().contains("2 of 6"));
    for fill in [crate::Fill::Neighbours, crate::Fill::Plane] {
        // A tilt goes with the plane of one row.
        let filled = crate::Preprocessing {
            fill: Some(fill),
            detrend: crate::Detrend::Plane,
            ..crate::Preprocessing::default()
        };
        let map = holed.map(&filled).unwrap();
        assert!(map.heights().iter().all(|h| h.abs() < 1e-20), "{:?}", map.heights());
    }
}

#[test]
fn profiles_have_the_trends_and_steps_of_one_row() {
    let parabola = profile("0 0\n1 1\n2 4\n3 9\n4 16\n", |_| ()).unwrap();
    let level = crate::Preprocessing { detrend: crate::Detrend::Quadric, ..crate::Preprocessing::default() };
    assert!(parabola.map(&level).unwrap().heights().iter().all(|h| h.abs() < 1e-22));
    for (preprocessing, expected) in [
        (crate::Preprocessing { quarter_turns: 1, ..Default::default() }, "a profile has one row"),
        (
            crate::Preprocessing { crop: Some(crate::Crop::Centre), ..Default::default() },
            "a profile has one row",
        ),
        (
            crate::Preprocessing { detrend: crate::Detrend::Sphere, ..Default::default() },
            "a profile has one row",
        ),
        (crate::Preprocessing { rows: Some(2), ..Default::default() }, "rows"),
    ] {
        let error = parabola.map(&preprocessing).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn odd_profiles_are_maps_or_refused() {
    for (text, expected) in [
        ("0 1 2\n1 2 3\n", "line 1 has 3 values"),
        ("0 1\n1e308 2\n", ""),
        ("-1e308 1\n1e308 2\n", ""),
        ("0 1\n1 1e400\n", ""),
        ("5 1\n", "the step of the profile"),
        ("nan 1\nnan 2\n", "line 1 has no x"),
    ] {
        let found = profile(text, |_| ()).and_then(|scan| scan.map(&crate::Preprocessing::default()));
        let text = found.map_or_else(|e| e.to_string(), |map| format!("{:?}", map.size()));
        assert!(text.contains(expected), "{text}");
    }
}
