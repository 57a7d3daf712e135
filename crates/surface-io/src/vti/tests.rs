use super::*;

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
        let mut text = String::new();
        let mut base64 = Base64::new(&mut text);
        base64.add(plain.bytes());
        base64.finish();
        assert_eq!(text, coded);
        assert_eq!(decode(coded), plain.as_bytes());
    }
}

#[test]
fn a_reader_finds_every_field_at_its_offset() {
    let fields: Vec<Vec<f64>> =
        [1e-9, 70e9, -0.0].iter().map(|s| (0..9).map(|i| s * f64::from(i) / 7.0).collect()).collect();
    let named: Vec<Field<'_>> = fields
        .iter()
        .zip(["gap", "p <&\">", "third"])
        .map(|(values, name)| Field { name, unit: "m", values })
        .collect();
    let file = String::from_utf8(vti(3, 0.25, &named, Encoding::Base64).unwrap()).unwrap();
    assert!(file.contains("Name=\"p &lt;&amp;&quot;&gt; [m]\""));
    assert!(file.contains("<CellData Scalars=\"gap [m]\">"));
    assert!(file.contains("header_type=\"UInt64\"") && file.contains("byte_order=\"LittleEndian\""));
    let section = file.split_once("encoding=\"base64\">\n_").unwrap().1;
    let section = section.split_once('\n').unwrap().0;
    let offsets: Vec<usize> = file
        .split("offset=\"")
        .skip(1)
        .map(|rest| rest.split_once('"').unwrap().0.parse().unwrap())
        .collect();
    assert_eq!(offsets.len(), 3);
    for (offset, values) in offsets.into_iter().zip(&fields) {
        // Length and numbers are one run of base64.
        let run = decode(&section[offset..offset + 4 * (8 + 72_usize).div_ceil(3)]);
        assert_eq!(run[..8], 72_u64.to_le_bytes());
        let read = run[8..].chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().unwrap()).to_bits());
        assert!(read.eq(values.iter().map(|v| v.to_bits())));
    }
}

#[test]
fn decimals_are_exact_and_plain() {
    let values = [1e-9, 1.0 / 3.0, -2.5e12, 0.0];
    let field = Field { name: "p", unit: "none", values: &values };
    let file = String::from_utf8(vti(2, 1.0, &[field], Encoding::Ascii).unwrap()).unwrap();
    let data = file.split_once("Name=\"p\" format=\"ascii\">\n").unwrap().1.split_once("</").unwrap().0;
    let read: Vec<f64> = data.split_whitespace().map(|t| t.parse().unwrap()).collect();
    assert_eq!(read, values);
    assert!(!file.contains("AppendedData"));
}

#[test]
fn what_no_viewer_shows_is_refused() {
    let field = |values| Field { name: "gap", unit: "", values };
    let error =
        |cells, cell, values| vti(cells, cell, &[field(values)], Encoding::Base64).unwrap_err().to_string();
    assert_eq!(error(1, 1.0, &[f64::NAN]), "gap: value 0 (counted from 0) is NaN: expected finite numbers");
    assert_eq!(error(2, 1.0, &[1.0]), "number of values of a field = 1: expected cells x cells");
    assert_eq!(error(1, 0.0, &[1.0]), "cell = 0: expected a finite number > 0");
    assert_eq!(error(0, 1.0, &[]), "no data in it");
    assert!(vti(usize::MAX, 1.0, &[field(&[])], Encoding::Ascii).is_err());
    assert!(vti(2, 1.0, &[], Encoding::Base64).is_ok());
}
