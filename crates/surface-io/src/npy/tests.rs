use crate::{ContentError, ReadOptions, Scan};
use proptest::prelude::*;

fn header(text: &str) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16 + 1).to_le_bytes());
    bytes.extend(text.bytes());
    bytes.push(b'\n');
    bytes
}

fn of(kind: &str, order: &str, shape: &str) -> Vec<u8> {
    header(&format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}"))
}

fn scan(bytes: &[u8]) -> crate::Result<Scan> {
    Scan::from_bytes("a.npy", bytes, &ReadOptions::default())
}

fn heights(scan: &Scan) -> Vec<Option<f64>> {
    let (rows, columns) = (scan.metadata().rows, scan.metadata().columns);
    (0..rows * columns).map(|i| scan.height(i / columns, i % columns)).collect()
}

#[test]
fn every_type_and_order_of_numbers() {
    let some = |values: [f64; 6]| values.map(Some).to_vec();
    let numbers = [0.0, 1.0, -2.0, 3.0, 100.0, 5.0];
    let check = |kind: &str, data: Vec<u8>, expected: [f64; 6], details: &str| {
        let scan = scan(&[of(kind, "False", "(2, 3)"), data].concat()).unwrap();
        assert_eq!(heights(&scan), some(expected), "{kind}");
        assert_eq!(scan.metadata().details, details);
        assert_eq!((scan.metadata().rows, scan.metadata().columns), (2, 3));
    };
    let f = |to: fn(f64) -> Vec<u8>| numbers.iter().copied().flat_map(to).collect::<Vec<u8>>();
    check("'<f8'", f(|v| v.to_le_bytes().to_vec()), numbers, "float64, little-endian, row by row");
    check("'>f8'", f(|v| v.to_be_bytes().to_vec()), numbers, "float64, big-endian, row by row");
    check("'<f4'", f(|v| (v as f32).to_le_bytes().to_vec()), numbers, "float32, little-endian, row by row");
    check("'>f4'", f(|v| (v as f32).to_be_bytes().to_vec()), numbers, "float32, big-endian, row by row");
    check("'|i1'", f(|v| (v as i8).to_le_bytes().to_vec()), numbers, "int8, little-endian, row by row");
    check("'<i2'", f(|v| (v as i16).to_le_bytes().to_vec()), numbers, "int16, little-endian, row by row");
    check("'>i4'", f(|v| (v as i32).to_be_bytes().to_vec()), numbers, "int32, big-endian, row by row");
    check("'<i8'", f(|v| (v as i64).to_le_bytes().to_vec()), numbers, "int64, little-endian, row by row");
    let unsigned = numbers.map(f64::abs);
    let u = |to: fn(f64) -> Vec<u8>| unsigned.iter().copied().flat_map(to).collect::<Vec<u8>>();
    check("'|u1'", u(|v| vec![v as u8]), unsigned, "uint8, little-endian, row by row");
    check("'>u2'", u(|v| (v as u16).to_be_bytes().to_vec()), unsigned, "uint16, big-endian, row by row");
    check("'<u8'", u(|v| (v as u64).to_le_bytes().to_vec()), unsigned, "uint64, little-endian, row by row");
    let fortran = [of("'<f8'", "True", "(2, 3)"), f(|v| v.to_le_bytes().to_vec())].concat();
    assert_eq!(heights(&scan(&fortran).unwrap()), some([0.0, -2.0, 100.0, 1.0, 3.0, 5.0]));
}

#[test]
fn half_precision_by_its_definition() {
    // 1, -2, largest 65504, smallest normal 2^-14, smallest subnormal 2^-24, 0.1 rounded, NaN.
    let bits: [u16; 7] = [0x3c00, 0xc000, 0x7bff, 0x0400, 0x0001, 0x2e66, 0x7e00];
    let values =
        [1.0, -2.0, 65504.0, 6.103_515_625e-5, 5.960_464_477_539_063e-8, 0.099_975_585_937_5, f64::NAN];
    for (bits, value) in bits.into_iter().zip(values) {
        let read = crate::number_type::half(bits);
        assert!(read.to_bits() == value.to_bits() || (read.is_nan() && value.is_nan()), "{read} {value}");
    }
    assert!(crate::number_type::half(0x7c00).is_infinite());
}

#[test]
fn nan_is_an_undefined_point_and_an_infinity_an_error() {
    let data = |v: f64| {
        [of("'<f8'", "False", "(1, 2)"), 1.0_f64.to_le_bytes().to_vec(), v.to_le_bytes().to_vec()].concat()
    };
    let found = scan(&data(f64::NAN)).unwrap();
    assert_eq!((found.metadata().undefined, found.height(0, 1), found.height(0, 2)), (1, None, None));
    assert_eq!(found.metadata().range, Some([1.0, 1.0]));
    let error = scan(&data(f64::INFINITY)).unwrap_err().to_string();
    assert_eq!(
        error,
        "a.npy: row 0, column 1 (counted from 0): inf: expected a finite height; write nan where nothing was measured"
    );
}

#[test]
fn every_bad_file_says_what_is_wrong() {
    let reason = |bytes: &[u8]| scan(bytes).unwrap_err().to_string();
    let whole = [of("'<f8'", "False", "(2, 2)"), vec![0; 32]].concat();
    for (bytes, expected) in [
        (&b""[..], "no data"),
        (b"1 2 3\n", "expected NPY, but the file does not begin like one"),
        (b"\x93NUMPY", "offset 6: expected the length of the header"),
        (b"\x93NUMPY\x04\x00\x00\x00", "offset 6: expected version"),
        (b"\x93NUMPY\x01\x00\x80\x00{", "offset 8: expected a header that ends inside the file"),
        // A header of 4 GB is neither allocated nor read.
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff{", "offset 8: expected a header that ends inside the file"),
        (&whole[..whole.len() - 1], "31 bytes after the header: 2 x 2 numbers take 32 (cut short)"),
        (&whole[..20], "ends inside the file"),
        (
            &[&whole[..], &[0]].concat(),
            "33 bytes after the header: 2 x 2 numbers take 32 (more than one array?)",
        ),
    ] {
        assert!(reason(bytes).contains(expected), "{expected}: {}", reason(bytes));
    }
    for kind in ["'<c16'", "'|b1'", "'|O'", "'<f16'", "'<U8'", "'f8'", "''", "'<M8[ns]'", "[('x', '<f8')]"] {
        assert!(reason(&of(kind, "False", "(2, 2)")).contains("astype('f8')"), "{kind}");
    }
    for (shape, expected) in [
        ("(4,)", "1 dimensions [4]: expected two"),
        ("()", "0 dimensions []"),
        ("(1, 2, 2)", "3 dimensions [1, 2, 2]"),
        ("(0, 4)", "an array of 0 rows x 4 columns: expected at least 1 of each"),
        ("(4, 0)", "an array of 4 rows x 0 columns: expected at least 1 of each"),
        ("(1000000, 125000)", "take 1000000000000 (cut short)"),
        ("(18446744073709551615, 18446744073709551615)", "cut short"),
        ("(18446744073709551616, 1)", "below 2^64"),
        ("(-1, 1)", "below 2^64"),
        ("(2 2)", "a comma or )"),
        ("[2, 2]", "a shape in brackets"),
        ("(2, 2", "below 2^64"),
    ] {
        let bytes = [of("'<f8'", "False", shape), vec![0; 64]].concat();
        assert!(reason(&bytes).contains(expected), "{shape}: {}", reason(&bytes));
    }
    assert!(reason(&of("'<f8'", "Maybe", "(2, 2)")).contains("True or False"));
    assert!(reason(&header("{'descr': '<f8'}")).contains("before }"));
    assert!(reason(&header("{'descr': '<f8', 'descr': '<f8'}")).contains("each once"));
    assert!(reason(&header("{'descr': '<f8', 'extra': '1'}")).contains("descr, fortran_order and shape"));
    assert!(reason(&header("{'descr': '<f8")).contains("a string that ends"));
    // No recursion: brackets do not eat the stack.
    assert!(reason(&header(&"(".repeat(9000))).contains("expected {"));
    assert!(reason(&header(&"{".repeat(20000))).contains("at most 10000 bytes"));
}

#[test]
fn integers_that_no_double_holds_are_named() {
    let big = (1_i64 << 53) + 1;
    let bytes = [of("'<i8'", "False", "(1, 1)"), big.to_le_bytes().to_vec()].concat();
    assert!(
        matches!(scan(&bytes).unwrap_err().problem(), Some(ContentError::Inexact { value, .. }) if *value == i128::from(big))
    );
    let bytes = [of("'<i8'", "False", "(1, 1)"), i64::MIN.to_le_bytes().to_vec()].concat();
    assert_eq!(scan(&bytes).unwrap().height(0, 0), Some(-(2_f64.powi(63))));
}

#[test]
fn what_has_no_use_is_refused() {
    let whole = [of("'<f8'", "False", "(1, 1)"), vec![0; 8]].concat();
    let declared = ReadOptions { skip_lines: 1, ..ReadOptions::default() };
    assert!(Scan::from_bytes("a.npy", &whole, &declared).unwrap_err().to_string().contains("has no lines"));
    let declared = ReadOptions { lateral_unit: Some("um".parse().unwrap()), ..ReadOptions::default() };
    assert!(Scan::from_bytes("a.npy", &whole, &declared).unwrap_err().to_string().contains("no coordinates"));
    let declared = ReadOptions { format: Some(crate::Format::Text), ..ReadOptions::default() };
    assert!(
        Scan::from_bytes("a.dat", &whole, &declared).unwrap_err().to_string().contains("correct the name")
    );
    let declared = ReadOptions { largest_bytes: 10, ..ReadOptions::default() };
    assert!(
        Scan::from_bytes("a.npy", &whole, &declared).unwrap_err().to_string().contains("at most 10 are read")
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_is_written_is_read(rows in 1..8_usize, columns in 1..8_usize, seed in any::<[f64; 64]>()) {
        let values: Vec<f64> = seed[..rows * columns].iter().map(|v| if v.is_infinite() { 0.0 } else { *v }).collect();
        let bytes = super::npy(&[rows, columns], &values).unwrap();
        prop_assert_eq!((bytes.len() - 8 * values.len()) % 64, 0);
        let read = heights(&scan(&bytes).unwrap());
        for (a, b) in read.iter().zip(&values) {
            prop_assert!(a.map_or(b.is_nan(), |a| a.to_bits() == b.to_bits()));
        }
    }
}

/// The bytes that `numpy.save` of NumPy 2.4 writes: the header as text, filled up to 128 bytes, and the numbers.
fn of_numpy(header: &str, numbers: &[u8]) -> Vec<u8> {
    let begin = [b"\x93NUMPY\x01\x00\x76\x00", header.as_bytes()].concat();
    let blanks = vec![b' '; 127 - begin.len()];
    [&begin[..], &blanks, b"\n", numbers].concat()
}

#[test]
fn bytes_are_those_of_numpy() {
    // np.array([[0.0, -0.0, 1.5], [np.nan, -2.25, 1e300]])
    let numbers = [
        "0000000000000000",
        "0000000000000080",
        "000000000000f83f",
        "000000000000f87f",
        "00000000000002c0",
        "9c7500883ce4377e",
    ];
    let numbers: Vec<u8> =
        numbers.iter().flat_map(|hex| u64::from_str_radix(hex, 16).unwrap().to_be_bytes()).collect();
    let golden = of_numpy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", &numbers);
    assert_eq!(super::npy(&[2, 3], &[0.0, -0.0, 1.5, f64::NAN, -2.25, 1e300]).unwrap(), golden);
    let read = heights(&scan(&golden).unwrap());
    assert_eq!(read, [Some(0.0), Some(-0.0), Some(1.5), None, Some(-2.25), Some(1e300)]);
    // np.asfortranarray(np.array([[1, -2, 3], [4, 5, -6]], dtype="i4"))
    let numbers: Vec<u8> = [1_i32, 4, -2, 5, 3, -6].iter().flat_map(|n| n.to_le_bytes()).collect();
    let golden = of_numpy("{'descr': '<i4', 'fortran_order': True, 'shape': (2, 3), }", &numbers);
    assert_eq!(heights(&scan(&golden).unwrap()), [1.0, -2.0, 3.0, 4.0, 5.0, -6.0].map(Some));
}
