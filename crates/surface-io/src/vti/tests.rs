use super::*;
use base64::Engine as _;

fn decode(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::new();
    for four in text.as_bytes().chunks_exact(4) {
        let used = four.iter().filter(|&&c| c != b'=').count();
        let word =
            four.iter().fold(0_u32, |w, &c| (w << 6) | u32::from(if c == b'=' { 0 } else { value(c) }));
        bytes.extend(&word.to_be_bytes()[1..used]);
    }
    bytes
}

#[test]
fn base64_of_the_rfc() {
    for (plain, coded) in [
        ("", ""),
        ("f", "Zg=="),
        ("fo", "Zm8="),
        ("foo", "Zm9v"),
        ("foob", "Zm9vYg=="),
        ("foobar", "Zm9vYmFy"),
    ] {
        assert_eq!(STANDARD.encode(plain), coded);
        assert_eq!(decode(coded), plain.as_bytes());
    }
}

#[test]
fn a_reader_finds_every_field_at_its_offset() {
    let fields: Vec<Vec<f64>> =
        [1e-9, 70e9, -0.0].iter().map(|s| (0..9).map(|i| s * f64::from(i) / 7.0).collect()).collect();
    let named: Vec<DataArray<'_>> = fields
        .iter()
        .zip(["gap", "p <&\">", "third"])
        .map(|(values, name)| DataArray { name, unit: "m", values })
        .collect();
    let file = String::from_utf8(vti(3, 0.25, &named, Encoding::Base64).unwrap()).unwrap();
    assert!(file.contains("Name=\"p &lt;&amp;&quot;&gt; [m]\""));
    assert!(file.contains("<CellData Scalars=\"gap [m]\">"));
    assert!(file.contains("header_type=\"UInt64\"") && file.contains("byte_order=\"LittleEndian\""));
    let (section, offsets) = appended(&file);
    assert_eq!(offsets.len(), 3);
    for (offset, values) in offsets.into_iter().zip(&fields) {
        // Length and numbers are one run of base64.
        let run = decode(&section[offset..offset + 4 * (8 + 72_usize).div_ceil(3)]);
        assert_eq!(run[..8], 72_u64.to_le_bytes());
        let read = run[8..].chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().unwrap()).to_bits());
        assert!(read.eq(values.iter().map(|v| v.to_bits())));
    }
}

/// The appended section and the offsets into it.
fn appended(file: &str) -> (&str, Vec<usize>) {
    let section = file.split_once("encoding=\"base64\">\n_").unwrap().1;
    let offset = |rest: &str| rest.split_once('"').unwrap().0.parse().unwrap();
    (section.split_once('\n').unwrap().0, file.split("offset=\"").skip(1).map(offset).collect())
}

/// Undefined points are NaN in their field and hidden in all.
#[test]
fn rectangles_with_undefined_points() {
    let (gap, height) = ([f64::NAN, 1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 2.0, 3.0, f64::NAN, 5.0, 6.0]);
    let fields = [
        DataArray { name: "gap", unit: "", values: &gap },
        DataArray { name: "height", unit: "", values: &height },
    ];
    let file = String::from_utf8(vti([3, 2], [6.0, 1.0], &fields, Encoding::Base64).unwrap()).unwrap();
    assert!(file.contains("WholeExtent=\"0 3 0 2 0 0\" Origin=\"0 0 0\" Spacing=\"2 0.5 2\""), "{file}");
    assert!(file.contains("<DataArray type=\"UInt8\" Name=\"vtkGhostType\""));
    let (section, offsets) = appended(&file);
    assert_eq!(offsets.len(), 3);
    let run = decode(&section[offsets[1]..offsets[2]]);
    assert!(run[..8] == 48_u64.to_le_bytes() && f64::from_le_bytes(run[32..40].try_into().unwrap()).is_nan());
    let hidden = decode(&section[offsets[2]..]);
    assert_eq!(hidden, [&6_u64.to_le_bytes()[..], &[32, 0, 0, 32, 0, 0]].concat());
}

#[test]
fn decimals_are_exact_and_plain() {
    let values = [1e-9, 1.0 / 3.0, -2.5e12, 0.0];
    let field = DataArray { name: "p", unit: "none", values: &values };
    let file = String::from_utf8(vti(2, 1.0, &[field], Encoding::Ascii).unwrap()).unwrap();
    let data = file.split_once("Name=\"p\" format=\"ascii\">\n").unwrap().1.split_once("</").unwrap().0;
    let read: Vec<f64> = data.split_whitespace().map(|t| t.parse().unwrap()).collect();
    assert_eq!(read, values);
    assert!(!file.contains("AppendedData"));
}

#[test]
fn what_no_viewer_shows_is_refused() {
    let field = |values| DataArray { name: "gap", unit: "", values };
    let error = |cells: usize, size: f64, values| {
        vti(cells, size, &[field(values)], Encoding::Base64).unwrap_err().to_string()
    };
    assert_eq!(
        error(1, 1.0, &[f64::INFINITY]),
        "gap: value 0 (counted from 0) is inf: expected finite numbers"
    );
    assert_eq!(error(2, 1.0, &[1.0]), "number of values of a field = 1: expected rows x columns");
    assert_eq!(error(1, 0.0, &[1.0]), "side along x = 0: expected a finite number > 0");
    assert_eq!(error(0, 1.0, &[]), "an array of 0 rows x 0 columns: expected at least 1 of each");
    let decimals = vti(1, 1.0, &[field(&[f64::NAN])], Encoding::Ascii).unwrap_err().to_string();
    assert_eq!(decimals, "gap: value 0 (counted from 0) is NaN: expected finite numbers");
    assert!(vti([2, 1], [1.0, -1.0], &[], Encoding::Base64).is_err());
    assert!(vti(usize::MAX, 1.0, &[field(&[])], Encoding::Ascii).is_err());
    assert!(vti(2, 1.0, &[], Encoding::Base64).is_ok());
}
