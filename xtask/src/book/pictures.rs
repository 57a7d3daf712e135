//! Draws the pictures of the book by `book/pictures.sh` and compares them with the stored ones.

use super::commands::Scratch;
use runs::{Error, Result};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The folder of the stored pictures, and the script that draws them.
const FOLDER: &str = "book/src/pictures";
const SCRIPT: &str = "book/pictures.sh";
/// Pictures that are drawn by hand.
const BY_HAND: [&str; 8] = [
    "adhesion-laws.svg",
    "cluster.svg",
    "conventions.svg",
    "free-and-periodic.svg",
    "jumps.svg",
    "relaxation.svg",
    "spectrum.svg",
    "stick-and-slip.svg",
];
/// Pictures taken with a browser, which depend on its version and on the fonts of the machine.
const OF_BROWSER: [&str; 1] = ["report.png"];

/// Largest difference of the coordinates of an SVG, which is 800 wide: less than half the width of a line.
/// Other processors change the last digits of a number, and a solver with a tolerance up to its tolerance.
const COORDINATE: f64 = 0.5;
/// Levels (of 255) by which a colour may differ, and the share of pixels that may differ by more, for a few
/// undecided cells at the boundary of a contact.
const LEVELS: u8 = 16;
const PIXELS: f64 = 2e-4;

/// Draws all pictures into a folder. Returns the output where that failed.
pub fn draw(root: &Path, scratch: &Scratch, folder: &Path) -> Result<Option<String>> {
    let script = root.join(SCRIPT);
    let text = fs::read_to_string(&script).map_err(Error::file("read", &script))?;
    scratch.run(&format!("pictures='{}'\n{text}", folder.display()))
}

/// Draws all pictures into the folder where they are stored.
pub fn store(root: &Path, scratch: &Scratch) -> Result<Option<String>> {
    draw(root, scratch, &root.join(FOLDER))
}

/// Draws all pictures anew and lists the stored ones that differ, that the script does not draw, or that are
/// missing.
pub fn check(root: &Path, scratch: &Scratch) -> Result<Vec<String>> {
    let drawn = scratch.empty("drawn")?;
    if let Some(output) = draw(root, scratch, &drawn)? {
        return Ok(vec![format!("{SCRIPT} failed:\n{output}")]);
    }
    let stored = root.join(FOLDER);
    let (new, old) = (names(&drawn)?, names(&stored)?);
    let mut wrong = Vec::new();
    for name in old.difference(&new).filter(|name| !BY_HAND.contains(&name.as_str())) {
        // Without a browser it is not drawn.
        if !OF_BROWSER.contains(&name.as_str()) {
            wrong.push(format!("{FOLDER}/{name}: not drawn by {SCRIPT}"));
        }
    }
    for name in &new {
        let differs = match (old.contains(name), Path::new(name).extension().is_some_and(|end| end == "svg"))
        {
            (false, _) => Some("not stored".to_owned()),
            _ if OF_BROWSER.contains(&name.as_str()) => None,
            (true, true) => svg_differs(&text(&stored.join(name))?, &text(&drawn.join(name))?),
            (true, false) => png_differs(&stored.join(name), &drawn.join(name))?,
        };
        wrong.extend(differs.map(|why| format!("{FOLDER}/{name}: {why}")));
    }
    Ok(wrong)
}

fn names(folder: &Path) -> Result<BTreeSet<String>> {
    let failed = || Error::file("list", folder);
    let entries = fs::read_dir(folder).map_err(failed())?.collect::<Result<Vec<_>, _>>().map_err(failed())?;
    Ok(entries.iter().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
}

fn text(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(Error::file("read", path))
}

/// The difference of two SVG files in labels, or in coordinates by more than [`COORDINATE`].
fn svg_differs(stored: &str, drawn: &str) -> Option<String> {
    let labels = |svg: &str| {
        let labels = svg.split("aria-label=\"").skip(1).filter_map(|after| after.split('"').next());
        labels.map(str::to_owned).collect::<Vec<_>>()
    };
    let (old, new) = (labels(stored), labels(drawn));
    if let Some((old, new)) = old.iter().zip(&new).find(|(old, new)| old != new) {
        return Some(format!("a label was \"{old}\" and is \"{new}\""));
    }
    let ((old, from), (new, to)) = (numbers(stored), numbers(drawn));
    if old != new {
        return Some("different lines or text".into());
    }
    let farthest = from.iter().zip(&to).map(|(from, to)| (from - to).abs()).fold(0.0, f64::max);
    (farthest > COORDINATE).then(|| format!("something moved by {farthest:.1}"))
}

/// A text with `#` in the place of each number, and the numbers.
fn numbers(text: &str) -> (String, Vec<f64>) {
    let (mut rest, mut found) = (String::new(), Vec::new());
    let mut digits = String::new();
    for c in text.chars().chain([' ']) {
        if c.is_ascii_digit() || c == '.' {
            digits.push(c);
            continue;
        }
        match digits.parse::<f64>() {
            Ok(number) => {
                // A coordinate next to 0 may change its sign, which is no word.
                let negative = rest.ends_with('-');
                if negative {
                    rest.pop();
                }
                found.push(if negative { -number } else { number });
                rest.push('#');
            }
            Err(_) => rest += &digits,
        }
        digits.clear();
        rest.push(c);
    }
    (rest, found)
}

/// The difference of two PNG files in size, or in more than the share [`PIXELS`] of the pixels.
fn png_differs(stored: &Path, drawn: &Path) -> Result<Option<String>> {
    let ((old_size, old), (new_size, new)) = (pixels(stored)?, pixels(drawn)?);
    if old_size != new_size || old.len() != new.len() {
        return Ok(Some(format!("was {old_size:?} and is {new_size:?}")));
    }
    let samples = (old.len() / (old_size.0 * old_size.1).max(1)).max(1);
    let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > LEVELS);
    let count = old.chunks(samples).zip(new.chunks(samples)).filter(differs).count();
    let share = count as f64 / (old.len() / samples).max(1) as f64;
    Ok((share > PIXELS).then(|| format!("{:.2} % of its pixels differ", 100.0 * share)))
}

/// Width and height, and the samples.
fn pixels(path: &Path) -> Result<((usize, usize), Vec<u8>)> {
    let file = fs::File::open(path).map_err(Error::file("read", path))?;
    let damaged = |error: png::DecodingError| Error::content(path, error.to_string());
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().map_err(damaged)?;
    let size = reader.output_buffer_size().ok_or_else(|| Error::content(path, "too large"))?;
    let mut samples = vec![0; size];
    let info = reader.next_frame(&mut samples).map_err(damaged)?;
    samples.truncate(info.buffer_size());
    Ok(((info.width as usize, info.height as usize), samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_no_difference_and_a_label_is() {
        let svg = |x: &str, label: &str| {
            format!("<g aria-label=\"{label}\"><path d=\"M{x} 3.5L-4 .5\" stroke=\"#0b559f\"/></g>")
        };
        let stored = svg("1.2500", "100 MPa");
        assert_eq!(svg_differs(&stored, &svg("1.2499998", "100 MPa")), None);
        assert_eq!(svg_differs(&stored, &svg("-0.01", "100 MPa")), Some("something moved by 1.3".into()));
        assert!(svg_differs(&stored, &svg("1.25", "100.2 MPa")).is_some());
        assert!(svg_differs(&stored, &stored.replace("9f", "8f")).is_some());
        assert!(svg_differs(&stored, &stored.replace("L-4", "L-4 1L")).is_some());
    }

    #[test]
    fn a_few_pixels_and_a_level_are_no_difference() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str, side: u32, changed: &[(usize, u8)]| {
            let path = dir.path().join(name);
            let mut samples = vec![100; 3 * (side * side) as usize];
            for (at, value) in changed {
                samples[*at] = *value;
            }
            let mut encoder = png::Encoder::new(fs::File::create(&path).unwrap(), side, side);
            encoder.set_color(png::ColorType::Rgb);
            encoder.write_header().unwrap().write_image_data(&samples).unwrap();
            path
        };
        let stored = write("a.png", 100, &[]);
        let many: Vec<(usize, u8)> = (0..3).map(|i| (30 * i, 200)).collect();
        for (name, side, changed, same) in [
            ("b.png", 100, &[(0, 110), (7, 95), (31, 84)][..], true),
            ("c.png", 100, &many[..2], true),
            ("d.png", 100, &many[..], false),
            ("e.png", 101, &[], false),
        ] {
            assert_eq!(png_differs(&stored, &write(name, side, changed)).unwrap().is_none(), same, "{name}");
        }
    }
}
