//! Readers under files that nobody meant well: they never panic and never allocate more than a stated
//! multiple of the file.

#![allow(clippy::unwrap_used)] // Tests, as a whole.
#![allow(unsafe_code)] // A global allocator that counts is unsafe by its nature; it hands everything to the system's.

mod files;

use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use surface_io::{
    AlignLines, Border, Crop, Decimal, Detrend, Fill, Format, Mirror, Preprocessing, ReadOptions, Scan,
    SurfaceFile, Undefined, Window,
};

thread_local! {
    /// Bytes that this thread holds, and the most that it held.
    static HELD: Cell<(usize, usize)> = const { Cell::new((0, 0)) };
}

struct Counting;

fn count(more: usize, less: usize) {
    // A thread that is ending has no more count; it is none of the test's.
    let _ = HELD.try_with(|held| {
        let (now, most) = held.get();
        let now = (now + more).saturating_sub(less);
        held.set((now, most.max(now)));
    });
}

// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size(), 0);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(0, layout.size());
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Old and new may exist at once.
        count(size, 0);
        count(0, layout.size());
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What is stated on the crate's front page: the file itself, 8 bytes for nothing between two commas, twice
/// that for points on a half-empty grid.
const MULTIPLE: usize = 24;

/// Errors, words of `Metadata`, the buffer of NPY.
const CONSTANT: usize = 100_000;

/// The most that `read` held beyond what was held before.
fn most_held<T>(read: impl FnOnce() -> T) -> (T, usize) {
    let before = HELD.get().0;
    HELD.set((before, before));
    let result = read();
    (result, HELD.get().1 - before)
}

const NAMES: [&str; 4] = ["a.npy", "a.txt", "a.xyz", "a"];

/// What callers may declare of a file.
fn declarations() -> [ReadOptions; 10] {
    let plain = ReadOptions::default();
    let cell = ReadOptions { cell: "1".parse().ok(), ..plain.clone() };
    [
        plain.clone(),
        ReadOptions { format: Some(Format::Xyz), missing: Some(0.0), skip_lines: 1, ..cell.clone() },
        ReadOptions { format: Some(Format::Text), decimal: Decimal::Comma, ..cell.clone() },
        ReadOptions {
            unit: "nm".parse().ok(),
            lateral_unit: "um".parse().ok(),
            cell: "1 um x 3 um".parse().ok(),
            ..plain.clone()
        },
        ReadOptions { size: "7 x 0.5".parse().ok(), ..plain.clone() },
        ReadOptions { size: "1 nm x 1 m".parse().ok(), unit: "nm".parse().ok(), ..plain.clone() },
        ReadOptions { cell: "1e-300 x 1e300".parse().ok(), width: "1".parse().ok(), ..plain.clone() },
        ReadOptions { border: Some(Border::Axes), lateral_unit: "um".parse().ok(), ..plain.clone() },
        ReadOptions { cell: "1 x 2".parse().ok(), format: Some(Format::Xyz), ..plain },
        cell,
    ]
}

/// Reads the bytes under every name and with several declarations; what is read is treated in all ways.
fn torture(bytes: &[u8]) -> Result<(), TestCaseError> {
    let declarations = declarations();
    for name in NAMES {
        for declared in &declarations {
            let (line, held) = most_held(|| surface_io::profile_from_bytes(name, bytes, declared));
            prop_assert!(held <= MULTIPLE * bytes.len() + CONSTANT, "{held} bytes for {}", bytes.len());
            prop_assert!(line.is_ok() || line.is_err_and(|e| e.to_string().starts_with(name)));
            let (scan, held) = most_held(|| Scan::from_bytes(name, bytes, declared));
            prop_assert!(held <= MULTIPLE * bytes.len() + CONSTANT, "{held} bytes for {}", bytes.len());
            match scan {
                Ok(scan) => {
                    prop_assert!(!scan.metadata().to_string().is_empty());
                    treat(&scan)?;
                }
                Err(error) => {
                    let text = error.to_string();
                    prop_assert!(text.starts_with(name) && text.len() < 2000, "{text}");
                }
            }
        }
    }
    Ok(())
}

/// Makes maps of a scan with all trends, fillings and crops, and with all other steps.
fn treat(scan: &Scan) -> Result<(), TestCaseError> {
    let fillings = [
        (None, None),
        (Some(Fill::Neighbours), None),
        (Some(Fill::Plane), None),
        (None, Some(Undefined::NoContact)),
    ];
    let crops =
        [(None, None), (Some(Crop::Centre), Some(1)), (Some(WINDOW), None), (Some(Crop::Defined), None)];
    for detrend in [Detrend::Nothing, Detrend::Plane, Detrend::Quadric, Detrend::Sphere, Detrend::Cylinder] {
        for (fill, undefined) in fillings {
            for (crop, rows) in crops {
                let plain =
                    Preprocessing { crop, undefined, fill, detrend, rows, ..Preprocessing::default() };
                check(scan, &plain)?;
                let all = Preprocessing {
                    align_lines: Some(AlignLines::MedianDifference),
                    scars: Some(3.0),
                    outliers: Some(3.0),
                    tip_radius: "0.5".parse().ok(),
                    mirror: Some(Mirror::Y),
                    quarter_turns: 1,
                    window: Some(Window::Hann),
                    ..plain
                };
                check(scan, &all)?;
                let filtered = Preprocessing {
                    align_lines: Some(AlignLines::Median),
                    filter_across: "4.5".parse().ok(),
                    crop: None,
                    ..all
                };
                check(scan, &filtered)?;
            }
        }
    }
    Ok(())
}

/// All but the first column and row of small maps.
const WINDOW: Crop = Crop::Window { row: 1, column: 1, rows: 1, columns: 2 };

/// A map, or a reason why there is none; what is written of it is read as the same map.
fn check(scan: &Scan, preprocessing: &Preprocessing) -> Result<(), TestCaseError> {
    let map = match scan.map(preprocessing) {
        Ok(map) => map,
        Err(error) => {
            prop_assert!(!error.to_string().is_empty());
            return Ok(());
        }
    };
    prop_assert_eq!(map.defined().count() + map.undefined(), map.columns() * map.rows());
    prop_assert!(map.undefined() == 0 || preprocessing.undefined.is_some());
    prop_assert!(!surface_io::describe(&map).to_string().is_empty());
    let text = surface_io::text(&map, surface_io::Metric::Unitless);
    let again = Scan::from_bytes("b.txt", text.as_bytes(), &ReadOptions::default());
    let keep = Preprocessing { undefined: Some(Undefined::NoContact), ..Preprocessing::default() };
    match again.and_then(|scan| scan.map(&keep)) {
        Ok(again) => prop_assert_eq!(again, map),
        // The smallest numbers that quantities have are normal.
        Err(error) => prop_assert!(map.size().shorter() < 1e-300, "{error}"),
    }
    Ok(())
}

/// Valid files of all formats.
fn valid(which: usize) -> Vec<u8> {
    let heights: Vec<f64> = (0..9).map(|i| f64::from(i) / 3.0).collect();
    let map = contact_model::HeightMap::new(3, 1.5, heights.clone()).unwrap();
    match which {
        0 => surface_io::npy(&[3, 3], &heights).unwrap(),
        1 => surface_io::text(&map, surface_io::Metric::Metres).into_bytes(),
        2 => surface_io::xyz(&map, surface_io::Metric::Unitless).into_bytes(),
        3 => b"# Width: 10.00 um\n1,5;2,5;nan\n3;4;5\n-1e3;7;8\n".to_vec(),
        4 => b"\x93NUMPY\x01\x00\x46\x00{'descr': '>i2', 'fortran_order': True, 'shape': (2, 3), }           \n012345678901".to_vec(),
        5 => b"# Width: 6 um\n# Height: 1.0 um\n# Value units: nm\n1 2 nan\n4 bad 6\n".to_vec(),
        6 => b"# Lateral units: mm\n0 0 1\n2 0 2\n0 0.5 nan\n2 0.5 4\n0 1 5\n2 1 6\n".to_vec(),
        7 => b"\\Scan Size: 3 2 ~m\nx-pixels = 3\nPixel size (um)\t1\ndata unit=rad\nheight conversion factor (-> m)=6e-8\n1,5;2;3\n4;5;6,25\n".to_vec(),
        8 => b"x [um]\tz [nm]\r\n0,0\t5\r\n0,5\t6\r\n1,0\t4\r\n".to_vec(),
        9 => b"1,2,,4\n5,6,7,8\n9,,,,\n".to_vec(),
        10 => b"ncols 2\nnrows 2\ncellsize 0.5\nNODATA_value -9\n1 -9\n3 1.0D3\n".to_vec(),
        11 => b"\"XY Calibration\",\"7.4\",\"um\"\n\"Unit\",\"mm\"\n\n\"Height\"\n\"0.01\",\"0.02\"\n\"0.03\",#N/A\n".to_vec(),
        12 => b"# Channel: a\n1 1.#QNAN\n3 4\n\n# Channel: b\n5 6\n\n7 8\n9 0\n".to_vec(),
        13 => b"Zygo XYZ Data File - Format 1\n0\n0\n0 0 2 2\n\n\n\n0 0 6e-7 0.5 1 0 5e-5 17\n3\n0\n#\n0 0 0.1\n1 0 No Data\n#\n".to_vec(),
        14 => b"numCols\tnumRows\tpixelSize (um)\n2\t2\t1.7\nZ-data (um)\n1\t2\n3\t4\n".to_vec(),
        15 => b"Y (um),X (mm),Z (nm)\n0,0,1.3\n0,5,2.9\n1,0,2.2\n1,5,nan\n".to_vec(),
        16 => b"x;p 1;p 2;phase (deg)\num;nm;nm;\n0;1;2;3\n1;4;5;6\n2;3;2;1\n".to_vec(),
        17 => b",row,col,height_nm,Nx\n0,0,0,1.5,7\n1,0,1,2.5,7\n2,1,0,3.5,7\n3,1,1,4.5,7\n".to_vec(),
        18 => "# Canal : a\n# Largeur : 2,0 \u{b5}m\n# Hauteur\u{ff1a} 1 um\n# Unit\u{e9}s : deg\n1 2\n3 4\n".as_bytes().to_vec(),
        _ => b"\t0\t0.5\t1\n0\t0.1\t0.2\t0.3\n1\t0.2\t0.3\t0.5\n2\t0.3\t0.4\t0.6\n".to_vec(),
    }
}

/// Thousands of strings of an attribute that are all one long string of the file.
#[test]
fn strings_that_share_their_bytes_are_not_copied_without_end() {
    const COUNT: usize = 3000;
    const LONG: usize = 60_000;
    let mut strings = vec!["s".to_owned(); COUNT];
    strings[0] = "long ".repeat(LONG / 5);
    let mut file = hdf5_pure::FileBuilder::new();
    let labels = hdf5_pure::AttrValue::VarLenAsciiStringArray(strings);
    file.create_dataset("heights").with_f64_data(&[1.0; 4]).with_shape(&[2, 2]).set_attr("labels", labels);
    let mut bytes = file.finish().unwrap();
    // An element is the length, the address of the collection and the number of the object in it.
    let element = |bytes: &[u8], at: usize| bytes.get(at..at + 16).map(<[u8]>::to_vec);
    let length = (LONG as u32).to_le_bytes();
    let next =
        |bytes: &[u8], at: usize| element(bytes, at + 16).is_some_and(|e| e[..4] == 1_u32.to_le_bytes());
    let first = (0..bytes.len() - 32).find(|&at| bytes[at..at + 4] == length && next(&bytes, at)).unwrap();
    let long = element(&bytes, first).unwrap();
    for i in 1..COUNT {
        bytes[first + 16 * i..][..16].copy_from_slice(&long);
    }
    // The error of the header tells which checksum it has and which one it should have.
    let said = Scan::from_bytes("a.h5", &bytes, &ReadOptions::default()).unwrap_err().to_string();
    let sums: Vec<[u8; 4]> = said
        .split("0x")
        .skip(1)
        .map(|sum| u32::from_str_radix(&sum[..8], 16).unwrap().to_le_bytes())
        .collect();
    let at = bytes.windows(4).position(|window| window == sums[0]).unwrap();
    bytes[at..at + 4].copy_from_slice(&sums[1]);
    let (found, held) = most_held(|| Scan::from_bytes("a.h5", &bytes, &ReadOptions::default()));
    let said = found.unwrap_err().to_string();
    assert!(said.contains("the same bytes again and again"), "{said}");
    assert!(held < 100 * bytes.len(), "{held} of {}", bytes.len());
}

/// A description that packs into little and unpacks to much: refused by its size, or read in place.
#[test]
fn long_descriptions_are_refused_or_held_once() {
    let of = |filler: &[u8], most: usize| {
        let [description, _] = files::x3p::descriptions();
        let (head, tail) = description.split_at(description.find("<p:ISO5436_2").unwrap());
        let mut main = [head.as_bytes(), b"<!-- "].concat();
        main.extend(filler.iter().copied().cycle().take(most));
        main.extend([b" -->", tail.as_bytes()].concat());
        files::x3p::described(&main, true)
    };
    let read = |bytes: &[u8]| most_held(|| Scan::from_bytes("a.x3p", bytes, &ReadOptions::default()));
    // No UTF-8, 100 MB.
    let bytes = of(b"\xff\xfe", 100_000_000);
    assert!(bytes.len() < 500_000, "{}", bytes.len());
    let (found, held) = read(&bytes);
    let said = found.unwrap_err().to_string();
    assert!(said.contains("main.xml of at most 16777216 bytes, it has 1000"), "{said}");
    assert!(held < bytes.len() + CONSTANT, "{held} bytes");
    for filler in [&b"\xff\xfe"[..], b"\xc3\xa9", b"a"] {
        let (found, held) = read(&of(filler, 15_000_000));
        assert_eq!(found.unwrap().metadata().columns, 3);
        assert!(held < 18_000_000, "{held} bytes");
    }
    // Elements in elements, and one long text.
    for filler in [&b"<a>"[..], b"x", b"<b/>"] {
        let [description, _] = files::x3p::descriptions();
        let (head, tail) = description.split_at(description.find("<Record1>").unwrap());
        let mut main = [head.as_bytes(), b"<c>"].concat();
        main.extend(filler.iter().copied().cycle().take(15_000_000));
        main.extend([b"</c>", tail.as_bytes()].concat());
        let (_, held) = read(&files::x3p::described(&main, true));
        assert!(held < 18_000_000, "{held} bytes");
    }
}

/// Multiple of the default number of cases: `HOSTILE=10 cargo test -p surface-io --test hostile`.
fn times() -> u32 {
    std::env::var("HOSTILE").ok().and_then(|times| times.parse().ok()).unwrap_or(1)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1000 * times(),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct("tests/hostile.proptest-regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        torture(&bytes)?;
    }

    #[test]
    fn random_bytes_behind_a_magic(version in 0..4_u8, bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        torture(&[b"\x93NUMPY", &[version, 0][..], &bytes].concat())?;
    }

    #[test]
    fn almost_text(text in "[-+0-9.,;eE \\t\\n#%naif]{0,120}") {
        torture(text.as_bytes())?;
    }

    #[test]
    fn almost_a_heading(
        width in "[-+]?[0-9]{0,3}[.]?[0-9]{0,2}(e-?[0-9]{1,3})? ?(um|m|nm|px|)",
        height in "[-+]?[0-9]{0,3}[.]?[0-9]{0,2}(e-?[0-9]{1,3})? ?(um|m|nm|s|)",
        heights in "(([0-9]|nan|-)[ \n]){1,20}",
    ) {
        torture(format!("# Width: {width}\n# Height: {height}\n# Value units: nm\n{heights}").as_bytes())?;
    }

    #[test]
    fn almost_a_header_block(
        keys in prop::collection::vec(
            ("(x.length|ncols|cellsize|NODATA_value|unit|z-data|Width|Scan Size|Pixel size|x-pixels|Lines|z unit|x unit|Bit2nm|data unit|a b|height conversion factor \\(-> m\\)|# File Format = ASCII)",
             "( ?[:=\t] ?|)", "[-+]?[0-9]{0,2}([.,][0-9]{1,3})?(e-?[0-9]{1,3})?", " ?(um|nm|x 3 um|~m|microns|\u{b5}m|V|)"),
            0..5,
        ),
        heights in "(([0-9]|nan|[0-9],[0-9])[ ;\n]){1,20}",
        end in "(\n|\r\n|\r)",
    ) {
        let header: Vec<String> = keys.iter().map(|(a, b, c, d)| format!("{a}{b}{c}{d}\n")).collect();
        let header = header.concat();
        torture(format!("{header}{heights}").replace('\n', &end).as_bytes())?;
    }

    #[test]
    fn almost_named_columns(
        columns in prop::collection::vec(
            ("(x|y|z|row|col|lat|X|Height|N|x position|Points:0|\"|)", "( ?[(\\[]|_| |/|)", "(um|nm|px|deg|V|\u{b5}m|microns|)", "[)\\]\"]?"),
            1..6,
        ),
        delimiter in "(,|;|\t| )",
        mark in "(# ?|//|)",
        units in "(|um,nm,mm\n|\\[um\\];\\[nm\\]\n)",
        rows in prop::collection::vec(prop::collection::vec("(0|1|2|0.5|nan|)", 1..6), 1..9),
    ) {
        let names: Vec<String> = columns.iter().map(|(a, b, c, d)| format!("{a}{b}{c}{d}")).collect();
        // As many numbers as names, mostly.
        let line = |row: &Vec<String>| row.iter().cycle().take(names.len()).cloned().collect::<Vec<_>>().join(&delimiter);
        let rows: Vec<String> = rows.iter().map(line).collect();
        torture(format!("{mark}{}\n{units}{}\n", names.join(&delimiter), rows.join("\n")).as_bytes())?;
    }

    #[test]
    fn almost_a_header(shape in "[0-9,() L]{0,24}", kind in "[<>|=]?[fiuc]?[0-9]{0,2}", order in "(True|False|1)") {
        let text = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': ({shape}), }}");
        let length = (text.len() as u16).to_le_bytes();
        torture(&[&b"\x93NUMPY\x01\x00"[..], &length, text.as_bytes(), &[0; 64]].concat())?;
    }

    #[test]
    fn valid_files_with_bytes_changed_lost_and_doubled(
        which in 0..20_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..6),
    ) {
        let mut bytes = valid(which);
        for (at, byte, how) in changes {
            if bytes.is_empty() {
                break;
            }
            let at = at.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => { bytes.remove(at); }
                2 => bytes.insert(at, bytes[at]),
                _ => bytes.truncate(at),
            }
        }
        torture(&bytes)?;
    }
}

/// Deflate packs at most so many bytes into one; heights take eight for each.
const PACKED: usize = 1032 * 8 + MULTIPLE;

/// Reads all channels of the bytes of an instrument's file.
fn torture_channels(bytes: &[u8], compressed: bool) -> Result<(), TestCaseError> {
    let (read, held) = most_held(|| {
        let file = SurfaceFile::from_bytes("a", bytes, &ReadOptions::default())?;
        file.scans()
            .map(|scan| scan.map(|scan| scan.metadata().to_string().len()))
            .collect::<Result<Vec<_>, _>>()
    });
    let multiple = if compressed { PACKED } else { MULTIPLE };
    prop_assert!(held <= multiple * bytes.len() + 10 * CONSTANT, "{held} bytes for {}", bytes.len());
    if let Err(error) = read {
        let text = error.to_string();
        prop_assert!(text.starts_with('a') && text.len() < 4000, "{text}");
    }
    Ok(())
}

/// Changes, loses, doubles bytes, sets them to the ends of their range, or cuts the file short.
fn mutated(mut bytes: Vec<u8>, changes: &[(prop::sample::Index, u8, u8)]) -> Vec<u8> {
    for (at, byte, how) in changes {
        if bytes.is_empty() {
            break;
        }
        let at = at.index(bytes.len());
        match how {
            0 => bytes[at] = *byte,
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, bytes[at]),
            3 => bytes.iter_mut().skip(at).take(4).for_each(|b| *b = 0xff),
            4 => bytes.iter_mut().skip(at).take(4).for_each(|b| *b = 0),
            _ => bytes.truncate(at),
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 3000 * times(),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct("tests/hostile.proptest-regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn files_of_instruments_with_bytes_changed(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..6_u8), 1..6),
    ) {
        let mut all = files::all();
        let file = all.swap_remove(which.index(all.len()));
        torture_channels(&mutated(file.bytes, &changes), file.compressed)?;
    }

    /// Within archives whose checksums are right: they keep other changes from the description.
    #[test]
    fn descriptions_of_x3p_with_bytes_changed(
        which in 0..2_usize,
        packed in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..6_u8), 1..6),
    ) {
        let description = files::x3p::descriptions()[which].clone().into_bytes();
        torture_channels(&files::x3p::described(&mutated(description, &changes), packed), true)?;
    }
}

#[test]
fn small_files_of_instruments_hold_what_was_written() {
    for file in files::all() {
        let opened = SurfaceFile::from_bytes("a", &file.bytes, &ReadOptions::default());
        let opened = opened.unwrap_or_else(|e| panic!("{}: {e}", file.name));
        let word = file.name.split(' ').next().unwrap();
        assert_eq!(opened.format().word(), word, "{}", file.name);
        let scan = opened.scans().nth(file.number).unwrap().unwrap_or_else(|e| panic!("{}: {e}", file.name));
        let metadata = scan.metadata();
        assert_eq!([metadata.columns, metadata.rows], file.shape, "{}", file.name);
        let size = metadata.size.map(|size| size.map(surface_io::Quantity::value));
        match (size, file.size) {
            (Some(size), Some(expected)) => {
                for (side, expected) in size.iter().zip(expected) {
                    assert!((side / expected - 1.0).abs() < 1e-6, "{}: {side:e}, {expected:e}", file.name);
                }
            }
            (size, expected) => assert_eq!(size, expected, "{}", file.name),
        }
        for (i, expected) in file.heights.iter().enumerate() {
            let (row, column) = (i / metadata.columns, i % metadata.columns);
            let height = scan.height(row, column).map_or(f64::NAN, |h| match &metadata.unit {
                Some(unit) => unit.value.to_si(h),
                None => h,
            });
            let same = (height - expected).abs() <= 1e-9 * expected.abs();
            assert!(
                same || (height.is_nan() && expected.is_nan()),
                "{}: {height:e}, {expected:e}",
                file.name
            );
        }
        // Every file cut short is refused or shorter, and nothing panics.
        for length in 0..file.bytes.len() {
            let short = SurfaceFile::from_bytes("a", &file.bytes[..length], &ReadOptions::default());
            let _ = short.map(|file| file.scans().filter_map(Result::ok).count());
        }
    }
}

/// A heading of so many columns that each would be a channel.
#[test]
fn columns_are_no_channels_without_end() {
    let text = |count: usize| {
        let line = |cell: &dyn Fn(usize) -> String| (0..count).map(cell).collect::<Vec<_>>().join(",");
        let rows: Vec<String> = (0..20).map(|row| line(&|_| row.to_string())).collect();
        format!(
            "x,{}\n{}\n",
            line(&|i| format!("p{i}")),
            rows.iter().map(|row| format!("{row},1")).collect::<Vec<_>>().join("\n")
        )
    };
    let error = |count: usize| {
        let text = text(count);
        let (read, held) =
            most_held(|| SurfaceFile::from_bytes("a.csv", text.as_bytes(), &ReadOptions::default()));
        assert!(held <= MULTIPLE * text.len() + CONSTANT, "{held} bytes for {}", text.len());
        read.map(|file| file.len()).map_err(|e| e.to_string())
    };
    assert_eq!(error(256), Ok(256));
    assert!(error(257).unwrap_err().contains("at most 256 columns of heights, found 257"));
    assert!(error(5000).is_err());
}

#[test]
fn archives_are_told_by_their_members() {
    let npz = files::x3p::zip(&[("b/heights.npy", vec![0]), ("x.npy", vec![1])], true);
    let other = files::x3p::zip(&[("main.xml", b"<other/>".to_vec())], false);
    let error = |name: &str, bytes: &[u8]| {
        SurfaceFile::from_bytes(name, bytes, &ReadOptions::default()).unwrap_err().to_string()
    };
    let expected = "a: an archive of b/heights.npy, x.npy: take the file of heights out of it";
    assert_eq!(error("a", &npz), expected);
    assert!(error("a", &other).starts_with("a: an archive of main.xml: take"));
    assert!(error("a.npy", &npz).starts_with("a.npy: looks like an archive (NPZ"));
    for (member, expected) in [
        ("header.properties", "a JPK file"),
        ("index.xml", "a PLUX file"),
        ("xl/workbook.xml", "a workbook of Excel (XLSX): save the sheet as CSV"),
        ("content.xml", "a document of LibreOffice (ODS): save the sheet as CSV"),
    ] {
        let message = error("a", &files::x3p::zip(&[(member, vec![1])], false));
        assert!(message.contains(expected), "{message}");
    }
    let profile = files::x3p::descriptions()[0].replace("SUR", "PRF");
    let error = error("a", &files::x3p::described(profile.as_bytes(), true));
    assert!(error.contains("in main.xml a surface, FeatureType SUR, found \"PRF\""), "{error}");
}

/// The small file of a name.
fn small(name: &str) -> Vec<u8> {
    files::all().into_iter().find(|file| file.name == name).unwrap().bytes
}

/// The error of the file, or of the first channel that is not read.
fn error(bytes: &[u8]) -> String {
    match SurfaceFile::from_bytes("a", bytes, &ReadOptions::default()) {
        Err(error) => error.to_string(),
        Ok(file) => file.scans().find_map(Result::err).unwrap().to_string(),
    }
}

/// The error of a small file with other bytes at an offset.
fn changed(name: &str, at: usize, to: &[u8]) -> String {
    let mut bytes = small(name);
    bytes[at..at + to.len()].copy_from_slice(to);
    error(&bytes)
}

/// The error of a small file with another text, whose bytes are Latin-1.
fn replaced(name: &str, from: &str, to: &str) -> String {
    let text: String = small(name).iter().map(|&b| char::from(b)).collect();
    assert!(text.contains(from), "{name}: {from}");
    error(&text.replace(from, to).chars().map(|c| c as u8).collect::<Vec<_>>())
}

/// One byte makes heights that are upside down, of another scale, or not heights at all: what is refused, and
/// the message.
#[test]
fn heights_that_may_be_others_are_refused() {
    let nanoscope = "nanoscope with two channels";
    // As many points, in six columns of one.
    let mut other_mask = small("gwy with a mask");
    let mask = other_mask.windows(7).position(|part| part == b"/3/mask").unwrap();
    for (key, count) in [(b"xres\0i", 6), (b"yres\0i", 1)] {
        let at = mask + other_mask[mask..].windows(6).position(|part| part == key).unwrap();
        other_mask[at + 6] = count;
    }
    for (found, expected) in [
        (changed("sur", 290, &[1]), "SUR (Digital Surf), offset 290: expected no mark of an inversion"),
        (changed("metropro", 233, &[1]), "MetroPro (Zygo), offset 232: expected no mark of another sign"),
        (
            changed("metropro", 5, &[2]),
            "MetroPro (Zygo), offset 4: expected the format 1 and 834 bytes of header",
        ),
        (
            changed("metropro", 219, &[2]),
            "MetroPro (Zygo), offset 218: expected a phase resolution of 0 or 1",
        ),
        (changed("metropro", 63, &[0]), "MetroPro (Zygo), offset 60: expected 4 bytes, as width and height"),
        (changed("metropro", 168, &[0xb5]), "MetroPro (Zygo), offset 164: expected a scale"),
        (
            changed("opd of int16 without a size", 66, &[5]),
            "OPD (Wyko), offset 126: expected a number as Mult",
        ),
        (replaced("al3d", "800\0", "000\0"), "AL3D (Alicona), offset 17: expected heights behind the tags"),
        (replaced(nanoscope, "\r\n", "\n"), "Nanoscope, offset 0: expected lines that end in CR LF"),
        (replaced(nanoscope, "\n", "\r\n"), "Nanoscope, offset 0: expected lines that end in CR LF"),
        (
            replaced(nanoscope, "\\*File list\r", "\\*Force file list\r"),
            "Nanoscope, offset 0: expected a map",
        ),
        (
            replaced(nanoscope, "offset: 4096", "offset: 0096"),
            "Nanoscope, offset 159: expected a place behind the header",
        ),
        (replaced("tiff of ImageJ", "c1=0.5", "c1=0.0"), "TIFF, offset 0: expected a factor other than 0"),
        (
            // The double 2 of scale_factor.
            replaced("netcdf of version 1", "@\0\0\0\0\0\0\0", "\0\0\0\0\0\0\0\0"),
            "NetCDF-3, offset 572: expected a factor other than 0",
        ),
        (
            // Characters are no scale_factor.
            replaced(
                "netcdf of version 1",
                "scale_factor\0\0\0\x06\0\0\0\x01",
                "scale_factor\0\0\0\x02\0\0\0\x08",
            ),
            "NetCDF-3, offset 416: expected one number as scale_factor",
        ),
        (error(&other_mask), "GWY (Gwyddion), offset 655: expected a mask of as many columns and rows"),
    ] {
        // Of a file, or of one channel of it.
        let said = found.split_once("(not read: ").map_or(found.trim_start_matches("a: "), |(_, said)| said);
        assert!(said.starts_with(expected), "{found}");
    }
}

/// Contradictions in headers of probe microscopes, and what is not read of them.
#[test]
fn contradictions_in_headers_of_probe_microscopes_are_named() {
    // The sum of all words of the headers stays 0.
    let mut complex = small("ibw of Asylum");
    complex[80] += 1;
    let sum = u16::from_le_bytes([complex[2], complex[3]]).wrapping_sub(1);
    complex[2..4].copy_from_slice(&sum.to_le_bytes());
    for (found, expected) in [
        (
            replaced("wsxm of doubles", "Z Amplitude: 2.5 nm", "Z Amplitude: 2.6 nm"),
            "WSxM, offset 262: expected the amplitude 2.5, Maximum less Minimum, as z amplitude, found \"2.6 nm\"",
        ),
        (
            replaced("wsxm of integers", "Maximum", "Max"),
            "WSxM, offset 0: expected Maximum and Minimum of the integers",
        ),
        (
            replaced("nid", "Order=Intel", "Order=Other"),
            "NID (Nanosurf), offset 323: expected Intel, little-endian, as saveorder",
        ),
        (
            replaced("nid", "\n[DataSet-0:0]", "\n[DataSet-1:0]"),
            "NID (Nanosurf), offset 49: expected the name of a section as gr0-ch0",
        ),
        (
            replaced("mi", "BINARY_32", "ASCII"),
            "MI (Molecular Imaging), offset 384: expected data of the type BINARY or BINARY_32",
        ),
        (
            replaced("mi", "Image", "Spectroscopy"),
            "MI (Molecular Imaging), offset 0: expected an image; this file holds spectra",
        ),
        (
            replaced("mi of int16", "yPixels       2", "yPixels       1"),
            "MI (Molecular Imaging), offset 307: expected the end",
        ),
        (replaced("nid", "Bits=32", "Bits=16"), "NID (Nanosurf), offset 617: expected the end of the file"),
        (replaced("wsxm of doubles", "rows: 2", "rows: 1"), "WSxM, offset 383: expected the end of the file"),
        (error(&complex), "IBW (Igor), offset 80: expected real numbers, found the type 0x3"),
        (
            replaced("tiff of Park", "\u{3}\0\0\0\u{2}\0\0\0", "\u{2}\0\0\0\u{2}\0\0\0"),
            "TIFF, offset 172: expected 2 x 2 numbers of 2 bytes, found 12 bytes",
        ),
    ] {
        assert!(found.starts_with(&format!("a: {expected}")), "{found}");
    }
}

/// Of a wave, a group, a list of buffers, the only heights are taken; other signals are listed with their
/// unit.
#[test]
fn other_signals_are_no_heights() {
    for (name, heights, other, unit) in [
        ("ibw of Asylum", "HeightRetrace", "PhaseTrace", ""),
        ("nid", "Scan forward (Z-Axis)", "Scan forward (Z-Axis)", "N"),
        ("mi", "Topography", "Amplitude", "nm"),
    ] {
        let bytes = files::all().into_iter().find(|file| file.name == name).unwrap().bytes;
        let scan = Scan::from_bytes("a", &bytes, &ReadOptions::default()).unwrap();
        assert_eq!(scan.metadata().name.as_deref(), Some(heights));
        let all = SurfaceFile::from_bytes("a", &bytes, &ReadOptions::default()).unwrap();
        let first = all.scans().next().unwrap().unwrap();
        assert_eq!(first.metadata().name.as_deref(), Some(other));
        assert_eq!(first.metadata().no_heights.as_deref(), Some(unit));
    }
}

#[test]
fn the_valid_files_are_valid() {
    // The last one is asked about.
    for which in 0..15 {
        let declared = match which {
            3 => ReadOptions { decimal: Decimal::Comma, ..ReadOptions::default() },
            2 | 6 => ReadOptions { format: Some(Format::Xyz), ..ReadOptions::default() },
            12 => ReadOptions { channel: "b".parse().ok(), ..ReadOptions::default() },
            _ => ReadOptions::default(),
        };
        let scan = Scan::from_bytes("a", &valid(which), &declared);
        assert!(scan.is_ok(), "{which}: {scan:?}");
    }
}

#[test]
fn large_claims_allocate_nothing() {
    for bytes in [
        &b"\x93NUMPY\x02\x00\xff\xff\xff\xff"[..],
        b"\x93NUMPY\x01\x00\x50\x00{'descr': '<f8', 'fortran_order': False, 'shape': (400000, 400000), }            \n",
        b"\x93NUMPY\x01\x00\x50\x00{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296), }    \n",
        b"0 0 1\n1 1 2\n1000000 1000000 3\n",
        b"0 0 1\n1e-300 1e-300 2\n1 1 3\n",
    ] {
        for name in NAMES {
            let (scan, held) = most_held(|| Scan::from_bytes(name, bytes, &ReadOptions::default()));
            assert!(held < MULTIPLE * bytes.len() + 5000, "{name}: {held}");
            assert!(scan.is_err() || name != "a.xyz");
        }
    }
}

#[test]
fn real_files_stay_below_the_multiple() {
    let n = 300_usize;
    let heights: Vec<f64> = (0..n * n).map(|i| (i % 977) as f64 / 7.0).collect();
    let map = contact_model::HeightMap::new(n, 1.0, heights.clone()).unwrap();
    let npy = surface_io::npy(&[n, n], &heights).unwrap();
    let holes = vec![b","[0]; n];
    let commas = std::iter::repeat_n([&b"1"[..], &holes, b"\n"].concat(), n).collect::<Vec<_>>().concat();
    let short: Vec<String> = (0..n * n).map(|i| format!("{} {} 1\n", i % n, i / n)).collect();
    for (name, bytes, multiple) in [
        ("a.npy", npy, 2),
        ("a.txt", surface_io::text(&map, surface_io::Metric::Metres).into_bytes(), 3),
        ("a.xyz", surface_io::xyz(&map, surface_io::Metric::Metres).into_bytes(), 5),
        ("a.txt", commas, 10),
        ("a.xyz", short.concat().into_bytes(), 10),
    ] {
        let (scan, held) = most_held(|| Scan::from_bytes(name, &bytes, &ReadOptions::default()));
        assert!(scan.is_ok(), "{scan:?}");
        assert!(
            held <= multiple * bytes.len() + CONSTANT,
            "{name}: {} times",
            held as f64 / bytes.len() as f64
        );
    }
}

/// The message of a file that is no map, with heights in metres and what else is declared of it.
fn refusal(name: &str, bytes: &[u8], change: impl FnOnce(&mut ReadOptions)) -> String {
    let mut declared = ReadOptions { unit: "m".parse().ok(), ..ReadOptions::default() };
    change(&mut declared);
    let keep = Preprocessing { undefined: Some(Undefined::NoContact), ..Preprocessing::default() };
    let scan = Scan::from_bytes(name, bytes, &declared).and_then(|scan| scan.map(&keep));
    scan.unwrap_err().to_string()
}

/// A message has the file, the value and what was expected.
fn assert_begins(found: &str, expected: &str) {
    assert!(found.starts_with(expected), "{found}\n{expected}");
}

#[test]
fn lines_of_another_length_are_named() {
    for (name, text, expected) in [
        ("a.txt", "1 2 3\n4 5\n", "a.txt: line 2 has 2 values: expected 3 as in line 1"),
        ("a.txt", "1 2\n4 5 6\n7 8 9\n", "a.txt: line 1 has 2 values: expected 3 as in line 2"),
        ("a.csv", "1,2\n\n4,5,6\n#\n7,8,9", "a.csv: line 1 has 2 values: expected 3 as in line 3"),
        ("a.csv", "1,2\n4,5,6\n7,8\n", "a.csv: line 2 has 3 values: expected 2 as in line 1"),
    ] {
        assert_begins(&refusal(name, text.as_bytes(), |_| ()), expected);
    }
}

#[test]
fn arrays_without_a_height_are_named() {
    let empty = surface_io::npy(&[3, 0], &[]).unwrap();
    assert_begins(
        &refusal("a.npy", &empty, |_| ()),
        "a.npy: an array of 3 rows x 0 columns: expected at least 1 of each",
    );
    let undefined = surface_io::npy(&[1, 2], &[f64::NAN; 2]).unwrap();
    assert_begins(
        &refusal("a.npy", &undefined, |d| d.cell = "1 m".parse().ok()),
        "a.npy: 2 of 2 points are undefined: expected one height at least",
    );
}

/// Every contradiction and every impossible rectangle has a message.
#[test]
fn impossible_rectangles_are_named() {
    let two = surface_io::npy(&[1, 2], &[1.0, 2.0]).unwrap();
    for (found, expected) in [
        (
            refusal("a.npy", &two, |d| d.size = "1 m x 2e9 m".parse().ok()),
            "a.npy: dx / dy (ratio of the sides of a cell) = 2.5e-10: expected between",
        ),
        (
            refusal("a.npy", &two, |d| d.cell = "-1 m x 1 m".parse().ok()),
            "a.npy: cell along x = -1: expected a length > 0",
        ),
        (
            refusal("a.npy", &two, |d| d.size = "1 m".parse().ok()),
            "a.npy: size: one value, 1 m, is that of a square map, but there are 1 rows of 2",
        ),
        (
            refusal("a.npy", &two, |d| (d.size, d.cell) = ("2 m x 1 m".parse().ok(), "2 m".parse().ok())),
            "a.npy: side of a cell along x: cell = 2 m, but size over 2 columns = 1 m",
        ),
        (
            refusal("a.txt", b"# Width: 2 m\n# Height: 1 m\n1 2\n", |d| d.size = "2 m x 2 m".parse().ok()),
            "a.txt: size along y: 1 m from the file, but 2 m as given",
        ),
        (
            refusal("a.txt", b"# Width: -2 m\n1 2\n", |_| ()),
            "a.txt: line 1, width = -2 m: expected a length > 0",
        ),
        (
            refusal("a.xyz", b"0 0 1\n1 0 2\n0 1e-9 3\n1 1e-9 4\n", |d| d.lateral_unit = "m".parse().ok()),
            "a.xyz: dx / dy (ratio of the sides of a cell) = 1e9: expected between 1/10000 and 10000",
        ),
        (
            refusal("a.xyz", b"0 0 1\n1 0 2\n2 0 2\n", |d| d.lateral_unit = "m".parse().ok()),
            "a.xyz: the size of the map is neither in the file nor given: say size, ",
        ),
    ] {
        assert_begins(&found, expected);
    }
}
