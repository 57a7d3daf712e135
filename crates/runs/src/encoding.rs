//! Results of jobs as text: JSON that names their kind and the number of their format.

use crate::finite::all_finite;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Name of the results of one kind of jobs in a store, with the number of their format.
///
/// ```
/// use runs::ResultKind;
/// let kind = ResultKind::new("summit", 2);
/// let text = kind.encode(&vec![0.1 + 0.2, -0.0]);
/// assert_eq!(text, "{\"fractal-contact\":\"summit\",\"format\":2,\"output\":[0.30000000000000004,-0.0]}\n");
/// assert_eq!(kind.decode::<Vec<f64>>(&text), Some(vec![0.1 + 0.2, -0.0]));
/// assert_eq!(ResultKind::new("summit", 3).decode::<Vec<f64>>(&text), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ResultKind {
    name: &'static str,
    format: u32,
}

/// A text as it is written; what cannot be stored is left out.
#[derive(Serialize)]
struct Written<'a, T> {
    #[serde(rename = "fractal-contact")]
    name: &'a str,
    format: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<&'a T>,
}

/// A text as it is read: its other entries are compared with what would be written.
#[derive(Deserialize)]
struct ReadBack<T> {
    output: T,
}

impl ResultKind {
    /// A kind by its name. Raise the number of its format when an output of the same key is written
    /// differently or means something else: results of the format before are then not found.
    pub const fn new(name: &'static str, format: u32) -> Self {
        Self { name, format }
    }

    /// The key under which a result is stored: that of its job, after name and format.
    pub fn stored_key(&self, key: &str) -> String {
        format!("{} {}\n{key}", self.name, self.format)
    }

    /// An output as one line. JSON has no NaN and no infinity: the line of an output that holds one is
    /// without the output, so that it is refused when it is read.
    pub fn encode<T: Serialize>(&self, output: &T) -> String {
        let Self { name, format } = *self;
        let line = Written { name, format, output: all_finite(output).then_some(output) };
        // What JSON cannot hold, such as keys that are no text, is refused when it is read, too.
        serde_json::to_string(&line).unwrap_or_default() + "\n"
    }

    /// Reads an output back bit for bit; `None` for any text that [`ResultKind::encode`] does not write.
    pub fn decode<T: Serialize + DeserializeOwned>(&self, text: &str) -> Option<T> {
        let ReadBack { output } = serde_json::from_str(text).ok()?;
        // An entry that is absent, unknown or of another kind would otherwise be passed over.
        (self.encode(&output) == text).then_some(output)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    const KIND: ResultKind = ResultKind::new("test", 7);

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    enum StoredExample {
        Nothing,
        Number(f64),
        Pair(f32, Option<f64>),
        Named { rows: Vec<Option<f64>>, text: String, digest: u128 },
    }

    fn all() -> Vec<StoredExample> {
        let text = "a \"b\"\n\u{1f300}".to_owned();
        let rows =
            vec![Some(-0.0), None, Some(5e-324), Some(1e308), Some(0.1 + 0.2), Some(f64::MIN_POSITIVE)];
        let named = StoredExample::Named { rows, text, digest: u128::MAX };
        vec![StoredExample::Nothing, StoredExample::Number(-1.0 / 3.0), StoredExample::Pair(0.1, None), named]
    }

    #[test]
    fn outputs_come_back_bit_for_bit_and_damage_does_not() {
        let text = KIND.encode(&all());
        let back: Vec<StoredExample> = KIND.decode(&text).unwrap();
        assert_eq!(back, all());
        // Signs of zeros too.
        assert_eq!(KIND.encode(&back), text);
        for cut in (0..text.len()).filter(|cut| text.is_char_boundary(*cut)) {
            assert_eq!(
                KIND.decode::<Vec<StoredExample>>(&text[..cut]),
                None,
                "{cut} of {} bytes",
                text.len()
            );
        }
        for bad in [format!("{text}\n"), format!("{text}{text}"), format!(" {text}"), text.replace('7', "8")]
        {
            assert_eq!(KIND.decode::<Vec<StoredExample>>(&bad), None, "{bad}");
        }
        for (from, to) in
            [("1e+308", "1e+309"), ("1e+308", "1e308"), ("5e-324", "NaN"), ("null", "0"), ("test", "rest")]
        {
            assert_eq!(
                KIND.decode::<Vec<StoredExample>>(&text.replacen(from, to, 1)),
                None,
                "{from} as {to}"
            );
        }
        assert_eq!(KIND.decode::<Vec<f64>>(&text), None);
    }

    #[test]
    fn an_entry_that_is_absent_or_unknown_is_refused() {
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        struct Maybe {
            width: Option<f64>,
        }
        let text = KIND.encode(&Maybe { width: Some(2.0) });
        assert_eq!(KIND.decode(&text), Some(Maybe { width: Some(2.0) }));
        for bad in [
            text.replace("width", "w"),
            text.replace("\"width\":2.0", ""),
            text.replace("2.0", "2.0,\"x\":1"),
        ] {
            assert_eq!(KIND.decode::<Maybe>(&bad), None, "{bad}");
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused_and_not_taken_for_absent_ones() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let outputs = [
                StoredExample::Number(bad),
                StoredExample::Pair(bad as f32, None),
                StoredExample::Pair(1.0, Some(bad)),
            ];
            for output in outputs {
                let text = KIND.encode(&output);
                assert_eq!(text, "{\"fractal-contact\":\"test\",\"format\":7}\n");
                assert_eq!(KIND.decode::<StoredExample>(&text), None);
            }
            assert_eq!(KIND.decode::<Option<f64>>(&KIND.encode(&Some(bad))), None);
            assert!(!all_finite(&[StoredExample::Named {
                rows: vec![Some(bad)],
                text: String::new(),
                digest: 0
            }]));
            assert!(!all_finite(&BTreeMap::from([(1, (0, [bad]))])));
        }
        assert_eq!(KIND.decode::<Option<f64>>(&KIND.encode(&None::<f64>)), Some(None));
        assert!(all_finite(&all()));
        // A key that is no text.
        assert_eq!(KIND.encode(&BTreeMap::from([((1, 2), 3)])), "\n");
    }

    proptest! {
        #[test]
        fn every_number_comes_back(bits in any::<u64>(), single in any::<u32>()) {
            let output = (f64::from_bits(bits), f32::from_bits(single));
            let back = KIND.decode::<(f64, f32)>(&KIND.encode(&output));
            let finite = output.0.is_finite() && output.1.is_finite();
            let same = back.map(|(a, b)| (a.to_bits(), b.to_bits()));
            prop_assert_eq!(same, finite.then_some((bits, single)));
        }
    }
}
