use crate::{ContentError, Decimal, NumberKind, Origin, Place, Quantity, ReadOptions, Scan};
use contact_model::Size;

fn read(text: &[u8]) -> crate::Result<Scan> {
    Scan::from_bytes("a.txt", text, &ReadOptions::default())
}

fn heights(scan: &Scan) -> Vec<f64> {
    let (rows, columns) = (scan.metadata().rows, scan.metadata().columns);
    (0..rows * columns).map(|i| scan.height(i / columns, i % columns).unwrap_or(f64::MIN)).collect()
}

fn problem(text: &[u8]) -> ContentError {
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
    assert_eq!(read(b"1;2\n3;4").unwrap().metadata().details, "semicolons between numbers");
    let comma = ReadOptions { decimal: Decimal::Comma, ..ReadOptions::default() };
    for text in ["1 2,5\n-3e-9 4\n", "1,0;2,5\n-3e-9;4,\n", "1\t2,5\n-3e-9\t4\n"] {
        assert_eq!(
            heights(&Scan::from_bytes("a.csv", text.as_bytes(), &comma).unwrap()),
            expected,
            "{text:?}"
        );
    }
    let skipped = ReadOptions { skip_lines: 2, ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.csv", b"map of\nheights\n1 2.5\n-3e-9 4\n", &skipped).unwrap();
    assert_eq!(heights(&scan), expected);
}

#[test]
fn undefined_points_are_counted() {
    for text in ["1,,3\n4,nan,6\n", "1,NaN,3\n4,BAD,6", "1\t---\t3\n4\t***\t6\n", "1 n/a 3\n4 - 6\n"] {
        let scan = read(text.as_bytes()).unwrap();
        assert_eq!((scan.metadata().undefined, scan.metadata().rows), (2, 2), "{text:?}");
        assert_eq!(scan.metadata().range, Some([1.0, 6.0]));
    }
    // The last place of a line is empty: in a later line, in the first ones, in the only other one.
    for (text, expected) in [
        ("1,2,3\n4,5,\n7,8,9\n", [Some(3.0), None, Some(9.0)].as_slice()),
        ("1,2,\n4,5,\n7,8,9\n", &[None, None, Some(9.0)]),
        ("1;2;\n4;5;6", &[None, Some(6.0)]),
        ("1\t2\t3\n4\t5\t\r\n", &[Some(3.0), None]),
        // Before the first number of every line a delimiter is none; before that of some it is an empty place.
        ("\t1\t2\t3\n\t4\t5\t6\n", &[Some(3.0), Some(6.0)]),
        (",1,2,3\n,4,5,6\n", &[Some(3.0), Some(6.0)]),
        ("\t2\t3\n4\t5\t6\n", &[Some(3.0), Some(6.0)]),
        // Words of spreadsheets, which begin as a comment does.
        ("1\t2\t#DIV/0!\n4\t5\t6\n", &[None, Some(6.0)]),
        ("1 #REF! 3\n4 5 #value!\n", &[Some(3.0), None]),
        ("1 2 3 # a comment\n4 5 #N/A # another\n", &[Some(3.0), None]),
    ] {
        let scan = read(text.as_bytes()).unwrap();
        assert_eq!((scan.metadata().rows, scan.metadata().columns), (expected.len(), 3), "{text:?}");
        let last: Vec<Option<f64>> = (0..expected.len()).map(|row| scan.height(row, 2)).collect();
        assert_eq!(last, expected, "{text:?}");
    }
    let shown = read(b"\t1\t2\n\t4\t5\n").unwrap().metadata().to_string();
    assert!(shown.contains("tabs between numbers, one before every line"), "{shown}");
    let declared = ReadOptions { missing: Some(-9999.0), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.txt", b"1 -9999\n3 4\n", &declared).unwrap();
    assert_eq!((scan.metadata().undefined, scan.height(0, 1), scan.height(0, 0)), (1, None, Some(1.0)));
    // Heights 1, 3, 4 about their mean 8/3: squares 25/9, 1/9 and 16/9, mean 14/9.
    approx::assert_relative_eq!(
        scan.metadata().rms_height.unwrap(),
        (14.0_f64 / 9.0).sqrt(),
        max_relative = 1e-15
    );
    let shown = scan.metadata().to_string();
    assert!(
        shown.contains("undefined  1 of 4 points (25.000 %)") && shown.contains("unit unknown"),
        "{shown}"
    );
}

#[test]
fn what_a_heading_says_counts() {
    let gwyddion =
        "# Channel: Height\n# Width: 10.00 \u{b5}m\n# Height: 5.00 \u{b5}m\n# Value units: m\n1e-9 2e-9\n";
    let latin: Vec<u8> = gwyddion.chars().map(|c| c as u8).collect();
    for bytes in [gwyddion.as_bytes(), &latin] {
        let scan = read(bytes).unwrap();
        let cell = scan.metadata().cell.clone().unwrap();
        let sides = cell.value.map(Quantity::value);
        assert_eq!((sides, cell.origin), ([5e-6; 2], Origin::File));
        assert_eq!(Size::from(scan.metadata().size.unwrap().map(Quantity::value)), [10e-6, 5e-6].into());
        assert_eq!(scan.metadata().unit.clone().unwrap().value.to_string(), "m");
    }
    // A number of pixels is no length.
    assert_eq!(read(b"# Width: 512\n1 2\n3 4\n").unwrap().metadata().cell, None);
    assert_eq!(read(b"# Width: 512 px\n1 2\n3 4\n").unwrap().metadata().cell, None);
    let plain = read(b"# Width: 3\n# Value units: none\n1 2\n3 4\n").unwrap();
    assert_eq!(plain.metadata().cell.clone().unwrap().value[1].to_string(), "1.5");
    for (text, expected) in [
        (
            "# c\n# Value units: V\n1\n",
            "a.txt: channel 0 without a name (1 x 1, no heights: V): its values are no heights (line 2, value units: V is a quantity in m^2 kg s^-3 A^-1: expected a length, such as \"1 mm\"; skip_lines leaves out a header)",
        ),
        (
            "# Lateral units: Nm\n1\n",
            "a.txt: line 1, lateral units: unknown unit \"Nm\": upper and lower case differ, is it nm?; skip_lines",
        ),
    ] {
        let error = read(text.as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
    assert_eq!(read(b"# Value units:\n1\n").unwrap().metadata().unit, None);
    let oblong = read(b"# Width: 3 um\n# Height: 2 um\n1 2\n3 4\n").unwrap();
    let cell = oblong.metadata().cell.clone().unwrap().value.map(Quantity::value);
    assert_eq!(Size::from(cell), [1.5e-6, 1e-6].into());
    assert!(oblong.metadata().to_string().contains("cell       1.5 um x 1 um"));
    assert_eq!(
        read(b"1 2\n# Width: 3 um\n# Height: -2 um\n3 4\n").unwrap_err().to_string(),
        "a.txt: line 3, height = -2 um: expected a length > 0; skip_lines leaves out a header"
    );
    assert!(matches!(
        problem(b"# Width: 3 um\n# Height: 2\n# Value units: none\n1 2\n3 4\n"),
        ContentError::Contradiction { what: "size", .. }
    ));
}

#[test]
fn contradictions_are_named() {
    let text = b"# Width: 10.00 um\n# Value units: nm\n1 2\n3 4\n";
    let with = |change: fn(&mut ReadOptions)| {
        let mut declared = ReadOptions::default();
        change(&mut declared);
        Scan::from_bytes("a.txt", text, &declared).map_err(|e| e.to_string())
    };
    let error = with(|d| d.cell = "6 um".parse().ok()).unwrap_err();
    assert_eq!(error, "a.txt: side of a cell along x: 5 um from the file, but 6 um as given");
    let error = with(|d| d.unit = "um".parse().ok()).unwrap_err();
    assert_eq!(error, "a.txt: unit of the heights: nm from the file, but um as given");
    // The header prints few digits: what is given within them is taken.
    let scan = with(|d| d.width = "10.01 um".parse().ok()).unwrap();
    assert_eq!(scan.metadata().cell.clone().unwrap().origin, Origin::Caller);
    let error = with(|d| {
        d.width = "10 um".parse().ok();
        d.cell = "4 um".parse().ok();
    });
    assert_eq!(
        error.unwrap_err(),
        "a.txt: side of a cell along x: cell = 4 um, but width over 2 columns = 5 um"
    );
    assert!(with(|d| d.cell = "5 s".parse().ok()).unwrap_err().contains("5 s is a time: expected a length"));
    assert!(with(|d| d.cell = "-5 um".parse().ok()).unwrap_err().contains("expected a length > 0"));
    assert!(with(|d| d.unit = "GPa".parse().ok()).unwrap_err().contains("expected a length"));
    assert!(with(|d| d.lateral_unit = "um".parse().ok()).unwrap_err().contains("no coordinates"));
}

#[test]
fn every_bad_text_says_where_and_what_to_do() {
    for (text, expected) in [
        (&b""[..], "a.txt: no data in it: it is empty or has nothing but comments; export it again"),
        (b"# nothing\n\n", "a.txt: no data in it: it is empty or has nothing but comments; export it again"),
        (
            b"1 2\n3 x\n",
            "a.txt: line 2, value 2: \"x\": expected a number (comments begin with # or %; skip_lines leaves out a heading)",
        ),
        (b"1 2\n3\n", "a.txt: line 2 has 1 value: expected 2 as in line 1"),
        (b"# c\n\n1 2\n3 4 5\n", "a.txt: line 4 has 3 values: expected 2 as in line 3"),
        (b"1,500\t2,500\n", "a.txt: line 1, value 1: \"1,500\": a decimal comma? say decimal = \"comma\""),
        (b"1,5;2.5\n", "a.txt: line 1, value 1: \"1,5\": a decimal comma? say decimal = \"comma\""),
        (
            b"1,500 2,500\n",
            "a.txt: line 1, value 2: \"500 2\": two numbers between two delimiters: one delimiter per file, and decimal commas need decimal = \"comma\"",
        ),
        (b"1e999 1\n", "a.txt: line 1, value 1: \"1e999\": beyond the range of double precision"),
        (
            b"1 -inf\n",
            "a.txt: line 1, value 2: -inf: expected a finite height; write nan where nothing was measured",
        ),
        (
            b"1 2\n\x00\x01",
            "a.txt: byte 0x00 at offset 4 does not occur in text: expected numbers as text, or a binary format that is read",
        ),
        (
            b"1 2\r3 4\n",
            "a.txt: byte 0x0d at offset 3 does not occur in text: expected numbers as text, or a binary format that is read",
        ),
        (b"\xc3\xa9 2\n", "a.txt: line 1, value 1: \"\u{e9}\": expected a number (comments"),
        (b"\xff\xfe1\x00", "a.txt: looks like text in UTF-16: save it as UTF-8"),
        (b"\x89HDF\r\n\x1a\n", "a.txt: HDF5, offset 0: expected a file as its specification has it"),
        (
            b"PK\x03\x04....",
            "a.txt: X3P (ISO 25178-72), offset 8: expected the directory of the archive before this",
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
    let ContentError::Number { place, text, kind } = long else { panic!("{long}") };
    assert_eq!((place, text.len(), kind), (Place::Line { line: 1, value: 1 }, 32, NumberKind::None));
}

#[test]
fn headers_of_the_usual_programs_are_read() {
    type SidesAndUnit = (Option<[f64; 2]>, Option<String>);
    let found = |text: &[u8]| -> SidesAndUnit {
        let scan = read(text).unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(text)));
        assert_eq!(scan.metadata().rows, 2);
        let rounded = |q: Quantity| format!("{:.6e}", q.value()).parse().unwrap();
        let size = scan.metadata().size.map(|size| size.map(rounded));
        (size, scan.metadata().unit.clone().map(|u| u.value.to_string()))
    };
    let both = Some([3e-6, 1e-6]);
    let nm = || Some("nm".to_owned());
    let rows = "1 2 3\n4 5 6\n";
    for (header, size, unit) in [
        (
            "# File Format = ASCII\n# x-pixels = 3\n# y-pixels = 2\n# x-length = 3000\n# y-length = 1000\n# z-unit = nm\n# Start of Data:\n",
            both,
            nm(),
        ),
        ("# File Format = ASCII\n# x-length = 3000\n# y-length = 1000\n# Bit2nm = 0.5\n", both, nm()),
        ("\\*File list\n\\Scan Size: 3 1 ~m\n\\Samps/line: 3\n\\Number of lines: 2\n", both, None),
        ("Scan Size: 3 um x 1 um\n", both, None),
        ("Scan range = 3 x 1 \u{b5}m\n", both, None),
        ("X Amplitude = 3 um\nY Amplitude = 1 um\nZ unit: nm\n", both, nm()),
        ("x length: 3\ny length: 1\nx unit: um\ny unit: um\n", both, None),
        ("Operator,somebody\nPixel size (um), 1\nPixel size (um)\t1\n", Some([3e-6, 2e-6]), None),
        ("X-Resolution: 1 um\nY-Resolution: 500 nm\n", both, None),
        ("X-Resolution: 3\nY-Resolution: 2\nWidth: 3 microns\nHeight: 1,0 microns\n", both, None),
        (
            "pixel size=1e-006 m\ndata unit=rad\nheight conversion factor (-> m)=6.25e-08\n",
            Some([3e-6, 2e-6]),
            Some("m".into()),
        ),
        ("h=2 w=3\nBreite: 3,00 \u{b5}m\nH\u{f6}he: 1,00 \u{b5}m\n", both, None),
        // One length is that of a square map, a number may be one of pixels.
        ("Scan Size: 3 um\n", None, None),
        ("X Size: 3\nY Size: 2\n", None, None),
        ("a b c\nMeasured on a Friday, 12:30\n", None, None),
    ] {
        for text in [format!("{header}{rows}"), format!("{header}{rows}").replace('\n', "\r\n")] {
            assert_eq!(found(text.as_bytes()), (size, unit.clone()), "{text}");
        }
        let old = format!("{header}{rows}").replace('\n', "\r");
        assert_eq!(found(old.as_bytes()), (size, unit.clone()), "{old}");
        let latin: Vec<u8> = format!("{header}{rows}").chars().map(|c| c as u8).collect();
        assert_eq!(found(&latin), (size, unit), "{header}");
    }
    let scan = read(b"pixel size=1 m\nheight conversion factor (-> m)=0.25\n1 2\n3 4\n").unwrap();
    assert_eq!(heights(&scan), [0.25, 0.5, 0.75, 1.0]);
    assert!(scan.metadata().details.contains("times 0.25"));
    let square = read(b"Scan Size: 4 um\n1 2\n3 4\n").unwrap();
    assert_eq!(Size::from(square.metadata().size.unwrap().map(Quantity::value)), [4e-6, 4e-6].into());
}

#[test]
fn headers_that_contradict_themselves_or_the_lines_are_errors() {
    for (text, expected) in [
        ("Columns: 4\n1 2 3\n4 5 6\n", "number of columns: 4 in the header, but 3 in the lines"),
        ("Lines = 3\n1 2 3\n4 5 6\n", "number of rows: 3 in the header, but 2 in the lines"),
        (
            "Width: 3 um\nHeight: 1 um\nPixel size: 2 um\n1 2 3\n4 5 6\n",
            "two lines of the header: size: 3 um",
        ),
        ("x length = 3 um\nWidth = 4 um\n1 2 3\n4 5 6\n", "two lines of the header: width: 3 um"),
        ("z unit: nm\nvalue units: um\n1 2 3\n4 5 6\n", "two lines of the header: value units: nm"),
        ("z unit: V\n1 2 3\n4 5 6\n", "line 1, z unit: V is a quantity in"),
        ("data unit: rad\n1 2 3\n4 5 6\n", "line 1, data unit: unknown unit"),
        ("Width: -3 um\n1 2 3\n4 5 6\n", "line 1, width = -3 um"),
        // A slip in the first line of numbers is no header.
        ("l 2 3\n4 5 6\n", "line 1, value 1: \"l\": expected a number"),
        ("1 2 x\n4 5 6\n", "line 1, value 3: \"x\": expected a number"),
        ("This is no map.\n", "line 1, value 1: \"This\": expected a number"),
    ] {
        let error = read(text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\n{expected}");
    }
}

#[test]
fn decimal_commas_are_found_where_they_can_be_nothing_else() {
    for text in ["1,5\t2\n-3,25\t4\n", "1,5;2;\n-3,25;4;\n", "1,5 2\n-3,25 4\n", "note\n1,5;2\n-0,325E1;4"] {
        let scan = read(text.as_bytes()).unwrap_or_else(|e| panic!("{e}: {text}"));
        assert_eq!(heights(&scan), [1.5, 2.0, -3.25, 4.0], "{text}");
        assert!(scan.metadata().details.ends_with(", decimal commas"), "{}", scan.metadata().details);
    }
    // Commas between numbers, thousands, points beside commas.
    assert_eq!(read(b"1,5\n3,4\n").unwrap().metadata().details, "commas between numbers");
    for text in ["1,500;2,250\n", "1,5;2.5\n", "1,5;1,2,3\n"] {
        assert!(read(text.as_bytes()).is_err(), "{text}");
    }
}

/// Lines of `columns` numbers with decimal commas and commas between them.
fn commas(columns: usize, lines: usize, height: impl Fn(usize) -> String) -> String {
    let line = |row: usize| (0..columns).map(|i| height(row * columns + i)).collect::<Vec<_>>().join(",");
    (0..lines).map(|row| line(row) + "\n").collect()
}

#[test]
fn commas_that_are_decimal_signs_and_separators_are_refused() {
    // Decimals that begin with 0, and -0 before the comma.
    let hundredths = |i: usize| format!("{},{:02}", i * i * 7 % 113, i * i * 37 % 100);
    let tenths =
        |i: usize| format!("{}{},{}", if i.is_multiple_of(5) { "-" } else { "" }, i % 5 * 3, i * 7 % 10);
    let quoted = |i: usize| format!("\"{}\"", hundredths(i));
    for text in [
        commas(24, 24, hundredths),
        commas(6, 4, tenths),
        commas(5, 3, quoted),
        format!("x,y,z\n{}", commas(7, 5, hundredths)),
        commas(6, 4, hundredths).replace('\n', ",\r\n"),
    ] {
        let error = problem(text.as_bytes());
        assert_eq!(error, ContentError::Commas, "{text}");
        let comma = ReadOptions { decimal: Decimal::Comma, ..ReadOptions::default() };
        let error = Scan::from_bytes("a.txt", text.as_bytes(), &comma).unwrap_err().to_string();
        assert!(error.contains("commas are decimal signs and separators at once"), "{error}");
        // The remedy.
        let lines = text.lines().filter(|line| !line.contains('x')).map(|line| {
            let fields: Vec<&str> = line.trim_end_matches(',').split(',').collect();
            fields.chunks(2).map(|pair| pair.join(",")).collect::<Vec<_>>().join(";") + "\n"
        });
        let scan = Scan::from_bytes("a.txt", lines.collect::<String>().as_bytes(), &comma).unwrap();
        assert!(scan.metadata().notes.is_empty(), "{:?}", scan.metadata().notes);
    }
    // Whoever has such heights says so.
    let text = ReadOptions { format: Some(crate::Format::Text), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.txt", commas(24, 24, hundredths).as_bytes(), &text).unwrap();
    assert_eq!((scan.metadata().columns, scan.metadata().notes.len()), (48, 1));
}

#[test]
fn whole_numbers_between_commas_are_heights() {
    let note =
        |text: &str| read(text.as_bytes()).unwrap_or_else(|e| panic!("{e}: {text}")).metadata().notes.clone();
    for text in [
        // Of one length everywhere, of several, with signs, filled up with zeros, and few.
        commas(20, 10, |i| (100 + i * 37 % 900).to_string()),
        commas(20, 10, |i| (i * 37 % 900).to_string()),
        commas(20, 10, |i| ((i * 37 % 90).cast_signed() - 40).to_string()),
        commas(20, 10, |i| format!("{:03}", i * 37 % 900)),
        commas(20, 10, |i| (i * 7 % 10).to_string()),
        commas(21, 10, |i| (i * 37 % 90).to_string()),
        "1,05\n3,07\n".to_owned(),
        "1,5\n3,4\n".to_owned(),
        // Numbers in order and heights.
        commas(1, 40, |i| format!("{},{}", (i + 3) * (i + 3) % 41, 100 + i % 7)),
        // A point that is not defined, and one decimal.
        commas(20, 10, |i| if i == 33 { String::new() } else { (10 + i * 37 % 90).to_string() }),
        commas(20, 10, |i| if i == 33 { "1.5".into() } else { (10 + i * 37 % 90).to_string() }),
    ] {
        assert_eq!(note(&text), [""; 0], "{text}");
    }
    // One decimal has no 0 before it, and heights above 0 no -0: this is a suspicion only.
    let notes = note(&commas(12, 10, |i| format!("{},{}", i * 7 % 113, i * 3 % 10)));
    assert!(notes.len() == 1 && notes[0].contains("decimal signs and separators at once"), "{notes:?}");
}

#[test]
fn one_column_is_told() {
    let lines = (0..448).map(|i| format!("{}.5\n", i * 7 % 31)).collect::<Vec<_>>().concat();
    let error = read(lines.as_bytes()).unwrap_err().to_string();
    assert!(
        error.starts_with("a.txt: one column of 448 numbers: a profile needs two columns, x and z"),
        "{error}"
    );
    let text = ReadOptions { format: Some(crate::Format::Text), ..ReadOptions::default() };
    let asked = Scan::from_bytes("a.txt", lines.as_bytes(), &text).unwrap();
    for scan in [asked, read(b"1\n2\n4\n").unwrap()] {
        let notes = &scan.metadata().notes;
        assert!(notes.len() == 1 && notes[0].contains("have one number each"), "{notes:?}");
    }
    // A heading that states both sides says that it is a map.
    let headed = read(format!("# Width: 1 um\n# Height: 448 um\n{lines}").as_bytes()).unwrap();
    assert!((headed.metadata().rows, headed.metadata().notes.is_empty()) == (448, true));
    assert!(read(b"5\n").unwrap().metadata().notes.is_empty());
}

#[test]
fn a_count_has_a_height() {
    let declared = ReadOptions { height_scale: "0.25 nm".parse().ok(), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.txt", b"1 2\n4 nan\n", &declared).unwrap();
    assert_eq!(
        (scan.height(1, 0), scan.metadata().unit.clone().unwrap().origin),
        (Some(1e-9), Origin::Caller)
    );
    for (text, scale, expected) in [
        (
            &b"# Value units: nm\n1 2\n"[..],
            "1 nm",
            "unit of the heights: nm from the file, but height_scale = 1 nm",
        ),
        (b"1 2\n", "1 V", "height_scale: 1 m^2 kg s^-3 A^-1 is a quantity"),
        (b"1 2\n", "-1 nm", "height_scale = -1e-9: expected a length > 0"),
    ] {
        let declared = ReadOptions { height_scale: scale.parse().ok(), ..ReadOptions::default() };
        let error = Scan::from_bytes("a.txt", text, &declared).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn two_columns_with_ascending_numbers_are_a_profile() {
    let line = |i: i32| format!("{:.3} {}\n", 0.1 * f64::from(i), (i * i) % 7);
    let text: String = (0..20).map(line).collect();
    let scan = read(text.as_bytes()).unwrap();
    let metadata = scan.metadata();
    assert_eq!((metadata.format, metadata.profile), (crate::Format::Profile, true));
    assert_eq!((metadata.rows, metadata.columns), (1, 20));
    let shown = metadata.to_string();
    assert!(shown.contains("a profile of 20 points") && shown.contains("uniform along y"), "{shown}");
    // Down is up.
    let down: String = (0..20).rev().map(line).collect();
    assert_eq!(read(down.as_bytes()).unwrap().heights(), scan.heights());
    let declared = ReadOptions { format: Some(crate::Format::Text), ..ReadOptions::default() };
    let map = Scan::from_bytes("a.txt", text.as_bytes(), &declared).unwrap();
    assert_eq!((map.metadata().rows, map.metadata().columns, map.metadata().profile), (20, 2, false));
    let uneven = (0..20).map(|i| format!("{} 1\n", i * i)).collect::<Vec<_>>().concat();
    assert!(matches!(problem(uneven.as_bytes()), ContentError::Sparse { .. }));
    let unequal = (0..20).map(|i| format!("{} 1\n", if i == 7 { 7.4 } else { f64::from(i) }));
    let error = problem(unequal.collect::<String>().as_bytes());
    assert!(matches!(error, ContentError::Irregular { axis: 'x', .. }), "{error}");
    let unknown: String =
        (0..20).map(|i| if i == 5 { "nan 1\n".into() } else { format!("{i} 1\n") }).collect();
    assert_eq!(problem(unknown.as_bytes()), ContentError::Coordinate { axis: 'x', line: 6 });
    // Few lines, and a first column that does not ascend.
    for map in [(0..8).map(line).collect(), (0..20).map(|i| line((i * i) % 19)).collect::<String>()] {
        assert_eq!(read(map.as_bytes()).unwrap().metadata().columns, 2);
    }
}

#[test]
fn three_columns_with_a_format_are_read() {
    let text = b"1 2 3\n1 2 3\n1 2 3\n1 2 3\n";
    let declared = ReadOptions { format: Some(crate::Format::Text), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.txt", text, &declared).unwrap();
    assert_eq!((scan.metadata().rows, scan.metadata().columns), (4, 3));
    assert_eq!(read(b"1 2 3\n4 5 6\n7 8 9\n").unwrap().metadata().rows, 3);
    // Comments of a matrix, and of points.
    let headed = read(&[b"# Width: 3 um\n# Height: 4 um\n", &text[..]].concat()).unwrap();
    assert_eq!((headed.metadata().format, headed.metadata().rows), (crate::Format::Text, 4));
    let headed = read(b"# Lateral units: um\n0 0 1\n1 0 2\n0 1 3\n1 1 4\n").unwrap();
    assert_eq!((headed.metadata().format, headed.metadata().rows), (crate::Format::Xyz, 2));
}

#[test]
fn files_that_are_none() {
    let dir = tempfile::tempdir().unwrap();
    let error = Scan::read(dir.path(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("not a regular file"), "{error}");
    let error = Scan::read(dir.path().join("none.txt"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.starts_with("cannot open "), "{error}");
    std::fs::write(dir.path().join("a.txt"), "1 2\n3 4\n").unwrap();
    let scan = Scan::read(dir.path().join("a.txt"), &ReadOptions::default()).unwrap();
    assert_eq!(heights(&scan), [1.0, 2.0, 3.0, 4.0]);
}

/// Lengths that are printed with decimals are rounded there: cells that are square within them are square.
#[test]
fn printed_decimals_do_not_make_cells_oblong() {
    let row = "1 2 3 4 5 6 7\n";
    let cell = |width: &str, height: &str| {
        let text = format!("# Width: {width}\n# Height: {height}\n{}", row.repeat(3));
        read(text.as_bytes()).unwrap().metadata().cell.clone().unwrap().value.map(Quantity::value)
    };
    // 10/7 = 1.428571, 4.29/3 = 1.43: within the last digit of 4.29.
    let [dx, dy] = cell("10.00 um", "4.29 um");
    assert_eq!((dx.to_bits(), dx.to_bits()), ((10e-6_f64 / 7.0).to_bits(), dy.to_bits()));
    for (width, height) in [("10.000 um", "4.290 um"), ("10 um", "4 um"), ("1e-5 m", "4.29e-6 m")] {
        let [dx, dy] = cell(width, height);
        assert!((dx / dy - 1.0).abs() > 5e-4, "{width} {height}");
    }
}

#[test]
fn sizes_are_one_value_or_two_and_agree() {
    let with = |change: &dyn Fn(&mut ReadOptions)| {
        let mut declared = ReadOptions { unit: "nm".parse().ok(), ..ReadOptions::default() };
        change(&mut declared);
        let scan = Scan::from_bytes("a.txt", b"1 2 3 4\n5 6 7 8\n", &declared).map_err(|e| e.to_string())?;
        let found = scan.metadata();
        Ok::<_, String>((
            found.size.unwrap().map(Quantity::value),
            found.cell.clone().unwrap().value.map(Quantity::value),
        ))
    };
    assert_eq!(with(&|d| d.size = "4 m x 1 m".parse().ok()), Ok(([4.0, 1.0], [1.0, 0.5])));
    assert_eq!(with(&|d| d.cell = "3 m x 1 m".parse().ok()), Ok(([12.0, 2.0], [3.0, 1.0])));
    assert_eq!(with(&|d| d.cell = "3 m".parse().ok()), Ok(([12.0, 6.0], [3.0, 3.0])));
    assert_eq!(with(&|d| d.width = "4 m".parse().ok()), Ok(([4.0, 2.0], [1.0, 1.0])));
    let both = with(&|d| (d.cell, d.size) = ("1 m".parse().ok(), "4 m x 2 m".parse().ok()));
    assert_eq!(both, Ok(([4.0, 2.0], [1.0, 1.0])));
    for (size, cell, expected) in [
        (
            "4 m",
            "",
            "size: one value, 4 m, is that of a square map, but there are 2 rows of 4: say both sides",
        ),
        ("4 m x 2 m", "1 m x 2 m", "side of a cell along y: cell = 2 m, but size over 2 rows = 1 m"),
        ("4 m x -2 m", "", "size along y = -2: expected a length > 0"),
        ("", "-1 m x 1 m", "cell along x = -1: expected a length > 0"),
        ("", "0 m", "cell = 0: expected a length > 0"),
        ("4 m x 2", "", "size: 4 m along x, but 2 along y"),
        ("4 m x 2 s", "", "size along y: 2 s is a time: expected a length"),
        ("", "1e308 m", "size: inf: beyond the range of double precision"),
    ] {
        let error = with(&|d| (d.size, d.cell) = (size.parse().ok(), cell.parse().ok()));
        assert!(error.as_ref().is_err_and(|e| e.contains(expected)), "{size} {cell}: {error:?}");
    }
    // The file and the caller differ along y only.
    let text = b"# Width: 4 um\n# Height: 1 um\n1 2 3 4\n5 6 7 8\n";
    let error = |change: &dyn Fn(&mut ReadOptions)| {
        let mut declared = ReadOptions::default();
        change(&mut declared);
        Scan::from_bytes("a.txt", text, &declared).unwrap_err().to_string()
    };
    assert_eq!(
        error(&|d| d.size = "4 um x 2 um".parse().ok()),
        "a.txt: size along y: 1 um from the file, but 2 um as given"
    );
    assert_eq!(
        error(&|d| d.cell = "1 um".parse().ok()),
        "a.txt: side of a cell along y: 500 nm from the file, but 1 um as given"
    );
}
