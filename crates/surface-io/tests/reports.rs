//! Files after reports of users of other programs: each stands for a kind of fault, and is written here.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use surface_io::{
    Border, ContentError, Metadata, Preprocessing, Quantity, ReadOptions, Scan, SurfaceFile, Undefined,
};

const UNDEFINED: f64 = f64::NAN;

fn read(text: &str) -> Scan {
    read_with(text, &ReadOptions::default()).unwrap()
}

fn read_with(text: impl AsRef<[u8]>, options: &ReadOptions) -> surface_io::Result<Scan> {
    Scan::from_bytes("a.txt", text.as_ref(), options)
}

fn problem(text: impl AsRef<[u8]>) -> ContentError {
    read_with(text, &ReadOptions::default()).unwrap_err().problem().unwrap().clone()
}

fn heights(scan: &Scan) -> Vec<f64> {
    let Metadata { rows, columns, .. } = *scan.metadata();
    (0..rows * columns).map(|i| scan.height(i / columns, i % columns).unwrap_or(f64::NAN)).collect()
}

fn same(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs() || a.is_nan() && b.is_nan())
}

#[track_caller]
fn holds(text: &str, expected: &[f64]) {
    let found = heights(&read(text));
    assert!(same(&found, expected), "{text:?}: {found:?}");
}

fn metres(scan: &Scan) -> Option<[f64; 2]> {
    scan.metadata().cell.as_ref().map(|cell| cell.value.map(Quantity::value))
}

#[test]
fn a_comment_mark_inside_a_word_is_none() {
    let holed = [0.1, 0.2, 0.3, 0.4, UNDEFINED, 0.5, 0.7, 0.8, 0.9];
    for word in
        ["1.#QNAN", "-1.#IND", "1.#INF", "1.#QNAN0", "-1.#IND00", "#N/A", "nan(ind)", "-nan(ind)", "1.#SNAN"]
    {
        holds(&format!("0.10 0.20 0.30\n0.40 {word} 0.50\n0.70 0.80 0.90\n"), &holed);
        holds(&format!("0.10,0.20,0.30\n0.40,{word},0.50\n0.70,0.80,0.90\n"), &holed);
    }
    holds("0.1 0.2\n0.4 1.#QNAN\n", &[0.1, 0.2, 0.4, UNDEFINED]);
    holds("0.1 0.2 # 1.#QNAN\n0.4 0.5\t% more\n", &[0.1, 0.2, 0.4, 0.5]);
    assert!(matches!(problem("1 2\n3 4#5\n"), ContentError::Number { .. }));
    assert!(matches!(problem("1 2\n3 1.#X\n"), ContentError::Number { .. }));
}

#[test]
fn numbers_of_other_programs() {
    holds("\"0.1\",\"0.2\"\n\"\",\"0.4\"\n", &[0.1, 0.2, UNDEFINED, 0.4]);
    holds("\"0,1\";\"0,25\"\n\"0,3\";\"0,45\"\n", &[0.1, 0.25, 0.3, 0.45]);
    holds("1.0D-3 2.0d+0\n-3D2 4.0D0\n", &[0.001, 2.0, -300.0, 4.0]);
    holds("\u{2212}1.5 2\n3 1e\u{2212}2\n", &[-1.5, 2.0, 3.0, 0.01]);
    assert!(matches!(problem("1 2\n3 4D\n"), ContentError::Number { .. }));
    let scan = read("# Width: 2 um\r\r\n# Height: 2 um\r\r\n# Value units: nm\r\r\n1 2\r\r\n3 4\r\r\n");
    assert_eq!((heights(&scan), metres(&scan)), (vec![1.0, 2.0, 3.0, 4.0], Some([1e-6, 1e-6])));
    holds("1\t2\r\r\n3\t4\r\r\n", &[1.0, 2.0, 3.0, 4.0]);
    for order in [u16::to_le_bytes, u16::to_be_bytes] {
        let wide: Vec<u8> = "1 2\n3 4\n".encode_utf16().flat_map(order).collect();
        assert!(problem(&wide).to_string().contains("UTF-16"), "{}", problem(&wide));
    }
}

#[test]
fn blocks_of_numbers_are_maps() {
    let export = |name: &str, first: u8| {
        format!(
            "# Channel: Height ({name})\n# Width: 4.000 \u{b5}m\n# Height: 3.000 \u{b5}m\n# Value units: m\n\
             {first}e-9 2e-9 3e-9 4e-9\n{first}e-9 3e-9 4e-9 5e-9\n{first}e-9 4e-9 5e-9 6e-9\n\n"
        )
    };
    let both = export("trace", 1) + &export("retrace", 7);
    let message = problem(&both).to_string();
    assert!(message.contains("Height (trace)") && message.contains("Height (retrace)"), "{message}");
    let second = ReadOptions { channel: Some("Height (retrace)".parse().unwrap()), ..ReadOptions::default() };
    let scan = read_with(&both, &second).unwrap();
    assert_eq!((scan.height(1, 0), scan.metadata().rows), (Some(7e-9), 3));
    assert_eq!(metres(&scan), Some([1e-6, 1e-6]));
    let count = |text: &str| {
        SurfaceFile::from_bytes("a.txt", text.as_bytes(), &ReadOptions::default()).unwrap().len()
    };
    // A blank line ends a map; one behind every line does not, nor does one between points, nor a comment
    // that says nothing.
    assert_eq!(count("1 2\n3 4\n\n5 6\n7 8\n"), 2);
    assert_eq!(count("1 2\n\n3 4\n\n5 6\n"), 1);
    assert_eq!(count("0 0 1\n1 0 2\n\n0 1 3\n1 1 4\n"), 1);
    assert_eq!(count("1 2\n# half way\n3 4\n"), 1);
    assert_eq!(count("1 2\n3 4\n# Channel: b\n5 6\n7 8\n"), 2);
    assert_eq!(count("1 2\n3 4\nChannel: b\n5 6 7\n7 8 9\n"), 2);
    // Words behind the last numbers are no heading of anything.
    assert!(matches!(problem("1 2\n3 4\nend\n"), ContentError::Number { .. }));
    let many: String = (0..2000).map(|_| "1 2\n3 4\n\n").collect();
    assert!(matches!(problem(many), ContentError::TooManyMaps { .. }));
}

#[test]
fn indices_and_axes_are_asked_about() {
    let frame = ",0,1,2,3\n0,0.0,1.0,4.0,9.0\n1,16.0,25.0,36.0,49.0\n2,64.0,81.0,100.0,121.0\n";
    let axes = "\t0\t0.5\t1.0\n0\t0.11\t0.12\t0.13\n0.5\t0.21\t0.22\t0.23\n1.0\t0.31\t0.32\t0.33\n";
    let index = "0 0.1 0.7 0.3\n1 0.4 0.5 0.6\n2 0.7 0.8 0.9\n";
    for text in [frame, axes, index] {
        let found = problem(text);
        assert!(matches!(found, ContentError::Border { .. }), "{found:?}");
        let all = ReadOptions { border: Some(Border::Heights), ..ReadOptions::default() };
        assert_eq!(read_with(text, &all).unwrap().metadata().rows, text.lines().count());
    }
    let taken = ReadOptions {
        border: Some(Border::Axes),
        lateral_unit: Some("um".parse().unwrap()),
        unit: Some("um".parse().unwrap()),
        ..ReadOptions::default()
    };
    let scan = read_with(axes, &taken).unwrap();
    assert_eq!(heights(&scan), [0.11, 0.12, 0.13, 0.21, 0.22, 0.23, 0.31, 0.32, 0.33]);
    assert_eq!(metres(&scan), Some([0.5e-6, 0.5e-6]));
    let taken = ReadOptions { border: Some(Border::Axes), ..ReadOptions::default() };
    assert_eq!(heights(&read_with(frame, &taken).unwrap())[..4], [0.0, 1.0, 4.0, 9.0]);
    // An index along one side only: nothing else is taken out.
    let scan = read_with(index, &taken).unwrap();
    assert_eq!(heights(&scan), [0.1, 0.7, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
    let scan = read_with("0,1,2,3\n0.1,0.9,0.3,0.4\n0.5,0.6,0.7,0.8\n", &taken).unwrap();
    assert_eq!((scan.metadata().rows, scan.height(0, 1), scan.metadata().size), (2, Some(0.9), None));
    let other = read_with("1 5 2\n7 8 1\n2 4 9\n", &taken).unwrap_err();
    assert!(other.to_string().contains("no coordinates in equal steps"), "{other}");
}

#[test]
fn headings_of_programs_count() {
    let scan = read(
        "ncols 4\nnrows 3\nxllcorner 0.0\nyllcorner 0.0\ncellsize 0.5\nNODATA_value -9999\n1 2 3 4\n5 -9999 7 8\n9 10 11 12\n",
    );
    assert!(same(&heights(&scan)[4..6], &[5.0, UNDEFINED]));
    assert_eq!(metres(&scan), Some([0.5, 0.5]));
    let with_unit = ReadOptions {
        unit: Some("m".parse().unwrap()),
        cell: Some("0.5 m".parse().unwrap()),
        ..ReadOptions::default()
    };
    read_with("ncols 2\nnrows 2\ncellsize 0.5\n1 2\n3 4\n", &with_unit).unwrap();
    let keyence = "\"Model\",\"VR-6000\"\n\"XY Calibration\",\"7.413\",\"um\"\n\"Horizontal\",\"2\"\n\"Vertical\",\"2\"\n\
                   \"Unit\",\"mm\"\n\n\"Height\"\n\"0.011\",\"0.012\"\n\"0.021\",\"0.022\"\n";
    let scan = read(keyence);
    assert_eq!(metres(&scan), Some([7.413e-6, 7.413e-6]));
    assert_eq!(
        (scan.height(1, 0), scan.metadata().unit.as_ref().unwrap().value.to_si(1.0)),
        (Some(0.021), 1e-3)
    );
    let profilm =
        "numCols\tnumRows\tpixelSize (um)\r\n2\t3\t1.7465\r\nZ-data (um)\r\n1\t2\r\n3\t4\r\n5\t6\r\n";
    let scan = read(profilm);
    assert_eq!((heights(&scan).len(), metres(&scan)), (6, Some([1.7465e-6, 1.7465e-6])));
    assert_eq!(scan.metadata().unit.as_ref().unwrap().value.to_string(), "um");
    let scan = read("x/mm y/mm z/um\n0 0 1\n1 0 2\n0 1 3\n1 1 4\n");
    assert_eq!((heights(&scan), metres(&scan)), (vec![1.0, 2.0, 3.0, 4.0], Some([1e-3, 1e-3])));
    let exported = "\\Exported image units: nm\n1.0e+000 2.0e+000\n4.0e+000 5.0e+000\n";
    let micrometres = ReadOptions { unit: Some("um".parse().unwrap()), ..ReadOptions::default() };
    assert!(matches!(
        read_with(exported, &micrometres).unwrap_err().problem(),
        Some(ContentError::Contradiction { .. })
    ));
    // A unit of nothing in particular is told, and is no reason to refuse.
    assert!(read("# Unit: V\n1 2\n3 4\n").metadata().notes[0].contains("Unit: V"));
    // What is said in words that are not known is told where it is missing.
    let scan = read("# Voxel size = 3 furlong\n1 2\n3 4\n");
    let error = scan.map(&Preprocessing::default()).unwrap_err().to_string();
    assert!(error.contains("Voxel size = 3 furlong"), "{error}");
}

#[test]
fn zygo_xyz_points() {
    let header = "Zygo XYZ Data File - Format 1\n0 3 0 0 \"Tue Aug 25 16:59:23 2026\"\n0 0 3 2 1 255\n0 0 3 2\n\"\"\n\"\"\n\"\"\n\
                  0 0 6.328e-07 0.5 1 0 5.067e-5 17\n3 2 0 0 0 6666 1\n0\n#\n";
    let points = "0 0 0.10\n1 0 0.20\n2 0 No Data\n0 1 0.30\n1 1 0.40\n2 1 0.50\n#\n";
    for name in ["a.xyz", "a.txt"] {
        let text = format!("{header}{points}");
        let scan = Scan::from_bytes(name, text.as_bytes(), &ReadOptions::default()).unwrap();
        assert!(same(&heights(&scan), &[0.1, 0.2, UNDEFINED, 0.3, 0.4, 0.5]));
        assert!(same(&metres(&scan).unwrap(), &[5.067e-5; 2]));
        let map =
            scan.map(&Preprocessing { undefined: Some(Undefined::NoContact), ..Preprocessing::default() });
        assert!((map.unwrap().heights()[5] - 5e-7).abs() < 1e-20);
    }
    for (from, to, expected) in [
        ("0 0 3 2\n\"", "0 0 3\n\"", "four numbers of the phase"),
        ("0 0 3 2\n\"", "0 0 3000 2000\n\"", "cut short?"),
        ("2 1 0.50", "3 1 0.50", "a place in 2 rows of 3"),
        ("2 1 0.50", "2 1 high", "a place in 2 rows of 3"),
    ] {
        let text = format!("{header}{points}").replacen(from, to, 1);
        let error = read_with(text, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn values_that_stand_alone_are_noted() {
    let note = |text: &str| read(text).metadata().notes.join("\n");
    assert!(note("1 2 3\n4 -9999 5\n").contains("1 point of -9999, all others are from 1 to 5"));
    assert!(note("1 2 3\n4 1.7e38 1.7e38\n").contains("2 points of 1.7e38, all others are from 1 to 4"));
    for text in ["1 2 3\n4 5 6\n", "0 0 0\n0 1 1\n", "1 1 1\n1 1 1\n", "nan nan 1\n1 2 nan\n"] {
        assert_eq!(note(text), "", "{text}");
    }
}

#[test]
fn other_programs_are_named() {
    for (bytes, expected) in [
        (&b"VK4_\0\0\0\0"[..], "a VK4 file of Keyence"),
        (b"DSBB\0\0", "a grid of Surfer"),
        (b"DSAA\n4 4\n", "a grid of Surfer as text"),
        (b"Zygo ASCII Data File - Format 2\n", "Zygo's text of phases"),
        (b"S\0T\0i\0M\0a\0g\0e\0\0\0", "an RHK SM4 file"),
        (b"%PDF-1.7\n", "a PDF page"),
        (b"VK6\0\0", "a VK6 file"),
        (b"VK7\0\0", "a VK7 file"),
        (b"KPK0\0\0", "a ZON file"),
        (b"\x10\x01S\0T\0i\0M\0a\0g\0e\0 \0", "an RHK SM4 file"),
        (b":NANONIS_VERSION:\n2\n", "a Nanonis SXM file"),
        (b";\r\n; Omicron SPM Control.\r\n", "the header (PAR) of Omicron"),
        (b"WIT_PR06\0", "a WITec project"),
        (b"\x70\0\0\0\x04\0\0\0\x2a", "a LIF file of Leica"),
        (b"\x28\xb5\x2f\xfd\x24", "a Zstandard archive: unpack it first"),
        (b"7z\xbc\xaf\x27\x1c\0", "a 7z archive"),
        (b"Rar!\x1a\x07", "a RAR archive"),
        (b"BZh91AY", "a bzip2 archive"),
        (b"\xfd7zXZ\0", "an xz archive"),
        (b"\x89PNG\r\n", "a PNG picture"),
        (b"\xff\xd8\xff\xe0", "a JPEG picture"),
        (b"PAR1\x15", "a Parquet table: export NPY or CSV"),
        (b"ARROW1\0\0", "a Feather (Arrow) table"),
        (b"ply\r\nformat", "a mesh (PLY)"),
        (b"solid cube\n facet normal 0 0 1\n", "a mesh (STL)"),
        (b"\x80\x04\x95\x01", "a pickle of Python"),
    ] {
        let message = problem(bytes).to_string();
        assert!(message.contains(expected), "{message}");
    }
    // A mesh of one facet, a matrix of MATLAB 4 in either order of bytes, and a tile by its name and length.
    let mut mesh = vec![0; 134];
    mesh[80] = 1;
    assert!(problem(&mesh).to_string().contains("a mesh (STL)"));
    let numbers = [0_u32, 2, 1, 0, 2].map(u32::to_le_bytes).concat();
    let other = [1000_u32, 2, 1, 0, 2].map(u32::to_be_bytes).concat();
    for header in [numbers, other] {
        let message = problem([&header[..], b"z\0", &[0; 16]].concat()).to_string();
        assert!(message.contains("a MATLAB file of version 4: save it with -v7"), "{message}");
    }
    let tile = Scan::from_bytes("N47E008.hgt", &vec![1; 2_884_802], &ReadOptions::default()).unwrap_err();
    assert!(tile.to_string().contains("a tile of the Shuttle radar (HGT)"), "{tile}");
}

#[test]
fn sizes_that_are_not_enough_are_said() {
    let reason = |text: &str| read(text).map(&Preprocessing::default()).unwrap_err().to_string();
    for (text, expected) in [
        ("# Width: 512\n1 2\n3 4\n", "the heading says \"Width: 512\", which does not give the size"),
        ("x-pixels = 3\ny-pixels = 2\n1 2 3\n4 5 6\n", "\"x-pixels = 3\", which does not give"),
        ("X Size: 3\nY Size: 2\n1 2 3\n4 5 6\n", "\"Y Size: 2\""),
        ("Scan Size: 3 um\n1 2 3\n4 5 6\n", "\"Scan Size: 3 um\""),
    ] {
        let found = reason(text);
        assert!(found.contains(expected) && !found.contains("neither in the file"), "{found}");
    }
    assert!(reason("1 2\n3 4\n").contains("neither in the file nor given"));
}
