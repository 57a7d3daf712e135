//! `main.xml` of an X3P file.

use quick_xml::Reader;
use quick_xml::events::Event;

/// What it says of one axis, as written; empty where it says nothing.
#[derive(Debug, Default)]
pub(super) struct X3pAxis {
    pub(super) kind: String,
    pub(super) number: String,
    pub(super) increment: String,
    pub(super) offset: String,
}

/// What it says, as written; empty where it says nothing.
#[derive(Debug, Default)]
pub(super) struct Main {
    pub(super) feature: String,
    /// x, y and z.
    pub(super) axes: [X3pAxis; 3],
    /// Columns, rows and layers.
    pub(super) sizes: [String; 3],
    /// Names of the members with the numbers and with the bits of the points that are defined.
    pub(super) data: String,
    pub(super) valid: String,
    /// r11, r12, ... r33.
    pub(super) rotation: [String; 9],
    /// Numbers that stand in `main.xml` itself.
    pub(super) listed: u64,
}

const AXES: [&str; 3] = ["CX", "CY", "CZ"];
const SIZES: [&str; 3] = ["SizeX", "SizeY", "SizeZ"];

impl Main {
    /// Reads it; `None` where the document is another one.
    pub(super) fn read(text: &str) -> Option<Self> {
        let (mut main, mut found) = (Self::default(), false);
        elements(text, &mut |path, text| {
            // Some writers leave out the part of the standard.
            let Some(path) = path.strip_prefix("ISO5436_2/").or_else(|| path.strip_prefix("ISO5436/")) else {
                return;
            };
            found = true;
            if path == DATUM {
                main.listed += 1;
            } else if let Some(target) = main.target(path) {
                *target = text.chars().take(256).collect();
            }
        });
        found.then_some(main)
    }

    fn target(&mut self, path: &str) -> Option<&mut String> {
        match path {
            "Record1/FeatureType" => return Some(&mut self.feature),
            "Record3/DataLink/PointDataLink" => return Some(&mut self.data),
            "Record3/DataLink/ValidPointsLink" => return Some(&mut self.valid),
            _ => {}
        }
        if let Some(name) = path.strip_prefix("Record3/MatrixDimension/") {
            return self.sizes.get_mut(SIZES.iter().position(|size| *size == name)?);
        }
        if let Some([b'r', row @ b'1'..=b'3', column @ b'1'..=b'3']) =
            path.strip_prefix("Record1/Axes/Rotation/").map(str::as_bytes)
        {
            return self.rotation.get_mut(usize::from(3 * (row - b'1') + column - b'1'));
        }
        let (name, what) = path.strip_prefix("Record1/Axes/")?.split_once('/')?;
        let axis = self.axes.get_mut(AXES.iter().position(|axis| *axis == name)?)?;
        match what {
            "AxisType" => Some(&mut axis.kind),
            "DataType" => Some(&mut axis.number),
            "Increment" => Some(&mut axis.increment),
            "Offset" => Some(&mut axis.offset),
            _ => None,
        }
    }
}

const DATUM: &str = "Record3/DataList/Datum";

/// Calls for every number that stands in `main.xml` itself, NaN where it is missing, `None` where it is no
/// number.
pub(super) fn listed(text: &str, each: &mut impl FnMut(Option<f64>)) {
    elements(text, &mut |path, text| {
        if path.split_once('/').is_some_and(|(_, path)| path == DATUM) {
            // The last of x;y;z.
            let number = text.rsplit(';').next().unwrap_or_default().trim();
            each(if number.is_empty() { Some(f64::NAN) } else { number.parse().ok() });
        }
    });
}

/// Elements inside elements that are looked at, and bytes of the names from the root on; the standard has
/// six.
const DEEPEST: usize = 32;
const LONGEST_PATH: usize = 1 << 10;
/// Bytes of an element's own text that are kept: a number, a name. Of a longer one nothing is, so that its
/// beginning is no number.
const LONGEST: usize = 1 << 12;
const TOO_LONG: &str = "(too long)";

/// Calls for every element at its end, with the names from the root on and its own text. What is no XML ends
/// the document, and so does what is nested deeper than any description.
fn elements(text: &str, each: &mut impl FnMut(&str, &str)) {
    let mut reader = Reader::from_str(text);
    let (mut path, mut lengths, mut own) = (String::new(), Vec::new(), String::new());
    loop {
        match reader.read_event() {
            Ok(Event::Start(element)) => {
                lengths.push(path.len());
                enter(&mut path, element.local_name().as_ref());
                own.clear();
            }
            Ok(Event::Empty(element)) => {
                let length = path.len();
                enter(&mut path, element.local_name().as_ref());
                each(&path, "");
                path.truncate(length);
            }
            Ok(Event::Text(text)) => keep(&mut own, &text.xml10_content()),
            Ok(Event::CData(text)) => keep(&mut own, &text.xml10_content()),
            Ok(Event::End(_)) => {
                each(&path, own.trim());
                own.clear();
                path.truncate(lengths.pop().unwrap_or_default());
            }
            Ok(Event::Eof) | Err(_) => return,
            Ok(_) => {}
        }
        if lengths.len() > DEEPEST || path.len() > LONGEST_PATH {
            return;
        }
    }
}

fn keep(own: &mut String, text: &str) {
    if own.len() + text.len() <= LONGEST && own != TOO_LONG {
        own.push_str(text);
    } else {
        TOO_LONG.clone_into(own);
    }
}

fn enter(path: &mut String, name: &str) {
    if !path.is_empty() {
        path.push('/');
    }
    path.push_str(name);
}
