use crate::{Decimal, Declared, NumberKind, Place, Problem, Scan, Speaker};

fn read(text: &[u8]) -> crate::Result<Scan> {
    Scan::from_bytes("a.txt", text, &Declared::default())
}

fn heights(scan: &Scan) -> Vec<f64> {
    let (rows, columns) = (scan.understood().rows, scan.understood().columns);
    (0..rows * columns).map(|i| scan.height(i / columns, i % columns).unwrap_or(f64::MIN)).collect()
}

fn problem(text: &[u8]) -> Problem {
    read(text).unwrap_err().problem().unwrap().clone()
}

#[test]
fn delimiters_comments_and_line_ends() {
    let expected = [1.0, 2.5, -3e-9, 4.0];
    for text in [
        "1 2.5\n-3e-9 4\n",
        "1 2.5\n-3e-9 4",
        "  1   2.5  \r\n\r\n -3e-9  4 \r\n",
        "# heights\n1 2.5 # first row\n% more\n-3e-9 4\n",
        "1\t2.5\n-3e-9\t4\t\n",
        "1\t2.5\t\r\n-3e-9\t4\t\r\n",
        "1,2.5\n-3E-9,4\n",
        "1, 2.5,\n-3e-9, 4,\n",
        "1;2.5\n-3e-9 ; 4\n",
        "\u{feff}1 2.5\n-3e-9 4.\n",
        "+1 2.5\n-3e-9 4\n\n\n",
    ] {
        assert_eq!(heights(&read(text.as_bytes()).unwrap()), expected, "{text:?}");
    }
    assert_eq!(read(b"1;2\n3;4").unwrap().understood().details, "semicolons between numbers");
    let comma = Declared { decimal: Decimal::Comma, ..Declared::default() };
    for text in ["1 2,5\n-3e-9 4\n", "1,0;2,5\n-3e-9;4,\n", "1\t2,5\n-3e-9\t4\n"] {
        assert_eq!(
            heights(&Scan::from_bytes("a.csv", text.as_bytes(), &comma).unwrap()),
            expected,
            "{text:?}"
        );
    }
    let skipped = Declared { skip_lines: 2, ..Declared::default() };
    let scan = Scan::from_bytes("a.csv", b"map of\nheights\n1 2.5\n-3e-9 4\n", &skipped).unwrap();
    assert_eq!(heights(&scan), expected);
}

#[test]
fn holes_are_counted() {
    for text in ["1,,3\n4,nan,6\n", "1,NaN,3\n4,BAD,6", "1\t---\t3\n4\t***\t6\n", "1 n/a 3\n4 - 6\n"] {
        let scan = read(text.as_bytes()).unwrap();
        assert_eq!((scan.understood().missing, scan.understood().rows), (2, 2), "{text:?}");
        assert_eq!(scan.understood().range, Some([1.0, 6.0]));
    }
    let declared = Declared { missing: Some(-9999.0), ..Declared::default() };
    let scan = Scan::from_bytes("a.txt", b"1 -9999\n3 4\n", &declared).unwrap();
    assert_eq!((scan.understood().missing, scan.height(0, 1), scan.height(0, 0)), (1, None, Some(1.0)));
    // Heights 1, 3, 4 about their mean 8/3: squares 25/9, 1/9 and 16/9, mean 14/9.
    approx::assert_relative_eq!(
        scan.understood().rms_height.unwrap(),
        (14.0_f64 / 9.0).sqrt(),
        max_relative = 1e-15
    );
    let shown = scan.understood().to_string();
    assert!(shown.contains("missing  1 of 4 cells (25.000 %)") && shown.contains("unit not said"), "{shown}");
}

#[test]
fn what_a_heading_says_counts() {
    let gwyddion =
        "# Channel: Height\n# Width: 10.00 \u{b5}m\n# Height: 5.00 \u{b5}m\n# Value units: m\n1e-9 2e-9\n";
    let latin: Vec<u8> = gwyddion.chars().map(|c| c as u8).collect();
    for bytes in [gwyddion.as_bytes(), &latin] {
        let scan = read(bytes).unwrap();
        let cell = scan.understood().cell.clone().unwrap();
        assert_eq!((cell.value.value().to_bits(), cell.by), (5e-6_f64.to_bits(), Speaker::File));
        assert_eq!(scan.understood().unit.clone().unwrap().value.to_string(), "m");
    }
    // A number of pixels is no length.
    assert_eq!(read(b"# Width: 512\n1 2\n3 4\n").unwrap().understood().cell, None);
    assert_eq!(read(b"# Width: 512 px\n1 2\n3 4\n").unwrap().understood().cell, None);
    let plain = read(b"# Width: 3\n# Value units: none\n1 2\n3 4\n").unwrap();
    assert_eq!(plain.understood().cell.clone().unwrap().value.to_string(), "1.5");
    for (text, expected) in [
        (
            "# c\n# Value units: V\n1\n",
            "a.txt: line 2, value units: V is a quantity in m^2 kg s^-3 A^-1: expected a length, such as \"1 mm\"; skip_lines leaves out a header",
        ),
        (
            "# Lateral units: Nm\n1\n",
            "a.txt: line 1, lateral units: unknown unit \"Nm\": upper and lower case differ, is it nm?; skip_lines",
        ),
    ] {
        let error = read(text.as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
    assert_eq!(read(b"# Value units:\n1\n").unwrap().understood().unit, None);
    assert!(matches!(problem(b"# Width: 3 um\n# Height: 2 um\n1 2\n3 4\n"), Problem::Oblong { .. }));
}

#[test]
fn contradictions_are_named() {
    let text = b"# Width: 10.00 um\n# Value units: nm\n1 2\n3 4\n";
    let with = |change: fn(&mut Declared)| {
        let mut declared = Declared::default();
        change(&mut declared);
        Scan::from_bytes("a.txt", text, &declared).map_err(|e| e.to_string())
    };
    let error = with(|d| d.cell = "6 um".parse().ok()).unwrap_err();
    assert_eq!(error, "a.txt: side of a cell: 5e-6 m said by the file, but 6e-6 m as given");
    let error = with(|d| d.unit = "um".parse().ok()).unwrap_err();
    assert_eq!(error, "a.txt: unit of the heights: nm said by the file, but um as given");
    // The header prints few digits: what is given within them is taken.
    let scan = with(|d| d.width = "10.01 um".parse().ok()).unwrap();
    assert_eq!(scan.understood().cell.clone().unwrap().by, Speaker::Caller);
    let error = with(|d| {
        d.width = "10 um".parse().ok();
        d.cell = "4 um".parse().ok();
    });
    assert_eq!(error.unwrap_err(), "a.txt: side of a cell: cell = 4e-6 m, but width over 2 columns = 5e-6 m");
    assert!(with(|d| d.cell = "5 s".parse().ok()).unwrap_err().contains("5 s is a time: expected a length"));
    assert!(with(|d| d.cell = "-5 um".parse().ok()).unwrap_err().contains("expected a length > 0"));
    assert!(with(|d| d.unit = "GPa".parse().ok()).unwrap_err().contains("expected a length"));
    assert!(with(|d| d.lateral_unit = "um".parse().ok()).unwrap_err().contains("no coordinates"));
}

#[test]
fn every_bad_text_says_where_and_what_to_do() {
    for (text, expected) in [
        (&b""[..], "a.txt: no data in it"),
        (b"# nothing\n\n", "a.txt: no data in it"),
        (
            b"1 2\n3 x\n",
            "a.txt: line 2, value 2: \"x\": expected a number (comments begin with # or %; skip_lines leaves out a heading)",
        ),
        (b"1 2\n3\n", "a.txt: line 2 has 1 values: expected 2 as in line 1"),
        (b"# c\n\n1 2\n3 4 5\n", "a.txt: line 4 has 3 values: expected 2 as in line 3"),
        (b"1,5\t2,5\n", "a.txt: line 1, value 1: \"1,5\": a decimal comma? say decimal = \"comma\""),
        (b"1,5;2,5\n", "a.txt: line 1, value 1: \"1,5\": a decimal comma? say decimal = \"comma\""),
        (
            b"1,5 2,5\n",
            "a.txt: line 1, value 2: \"5 2\": two numbers between two delimiters: one delimiter per file, and decimal commas need decimal = \"comma\"",
        ),
        (b"1e999 1\n", "a.txt: line 1, value 1: \"1e999\": beyond the range of double precision"),
        (
            b"1 -inf\n",
            "a.txt: line 1, value 2: -inf: expected a finite height; write nan where nothing was measured",
        ),
        (
            b"1 2\n\x00\x01",
            "a.txt: byte 0x00 at offset 4 does not occur in text: expected numbers as text, or an NPY file",
        ),
        (
            b"1 2\r3 4\r",
            "a.txt: byte 0x0d at offset 3 does not occur in text: expected numbers as text, or an NPY file",
        ),
        (b"\xc3\xa9 2\n", "a.txt: line 1, value 1: \"\u{e9}\": expected a number (comments"),
        (b"\xff\xfe1\x00", "a.txt: looks like text in UTF-16: save it as UTF-8"),
        (b"\x89HDF\r\n\x1a\n", "a.txt: looks like an HDF5 file: export the data set of heights as NPY"),
        (
            b"PK\x03\x04....",
            "a.txt: looks like an archive (NPZ, X3P, XLSX): take the array out of it and save it as NPY",
        ),
        (
            b"GWYPGWYO",
            "a.txt: looks like a Gwyddion file: export the channel as text matrix, with the header",
        ),
        (
            b"1 2 3\n1 2 3\n1 2 3\n1 2 3\n",
            "a.txt: 4 lines of three numbers are points or a matrix of three columns: say format = \"xyz\" or format = \"text\"",
        ),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}\n{expected}");
    }
    let long = problem("x".repeat(1000).as_bytes());
    let Problem::Number { place, text, kind } = long else { panic!("{long}") };
    assert_eq!((place, text.len(), kind), (Place::Line { line: 1, value: 1 }, 32, NumberKind::None));
}

#[test]
fn three_columns_with_a_format_are_read() {
    let text = b"1 2 3\n1 2 3\n1 2 3\n1 2 3\n";
    let declared = Declared { format: Some(crate::Format::Text), ..Declared::default() };
    let scan = Scan::from_bytes("a.txt", text, &declared).unwrap();
    assert_eq!((scan.understood().rows, scan.understood().columns), (4, 3));
    assert_eq!(read(b"1 2 3\n4 5 6\n7 8 9\n").unwrap().understood().rows, 3);
}

#[test]
fn files_that_are_none() {
    let dir = tempfile::tempdir().unwrap();
    let error = Scan::read(dir.path(), &Declared::default()).unwrap_err().to_string();
    assert!(error.contains("not a regular file"), "{error}");
    let error = Scan::read(&dir.path().join("none.txt"), &Declared::default()).unwrap_err().to_string();
    assert!(error.starts_with("cannot open "), "{error}");
    std::fs::write(dir.path().join("a.txt"), "1 2\n3 4\n").unwrap();
    let scan = Scan::read(&dir.path().join("a.txt"), &Declared::default()).unwrap();
    assert_eq!(heights(&scan), [1.0, 2.0, 3.0, 4.0]);
}
