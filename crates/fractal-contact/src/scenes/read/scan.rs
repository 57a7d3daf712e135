//! A measured map of a scene, read and preprocessed.

use crate::scenes::read::asked_surface::{AskedFile, AskedSecond};
use crate::scenes::read::key::missing;
use crate::scenes::read::{Diagnostic, Places, ReadResult, System, amount, number};
use contact_model::HeightMap;
use contact_model::units::{ascii, rounded};
use std::borrow::Cow;
use std::path::Path;
use surface_io::{
    Description, Detrend, Dimension, Mirror, Preprocessed, Preprocessing, Quantity, ReadOptions, Scan, Sides,
    Undefined,
};

/// A map from a file.
pub(crate) struct FileMap {
    pub map: HeightMap,
    /// Metadata of its file.
    pub metadata: String,
    /// The distance from which on the tip of the instrument resolves heights.
    pub reliable_from: Option<f64>,
    /// Remarks on the keys.
    pub notes: Vec<Diagnostic>,
    /// Whether it is a profile: one row that stands for a body uniform along y.
    pub profile: bool,
    /// The map with the points undefined that were filled, where some were.
    pub holes: Option<HeightMap>,
}

/// The description of a map, with units where its lengths are in metres.
pub(crate) fn description(map: &HeightMap, system: System) -> Description {
    let description = surface_io::describe(map);
    if system == System::Si { description.in_metres() } else { description }
}

/// Reads the file of a surface, which the table of this name asks for.
pub(crate) fn read_map(
    asked: &AskedFile,
    table: &str,
    system: System,
    directory: &Path,
    places: &Places,
) -> ReadResult<FileMap> {
    let place = |key: &str| format!("{table}.{key}");
    let (file, declared, preprocessing) = (place("path"), &asked.declared, asked.preprocessing());
    let path = asked.path.as_ref().ok_or_else(|| missing(table, "path", "\"heights.npy\"", places))?;
    let path = directory.join(path);
    let wrong = |e: surface_io::Error| {
        let diagnostic = places.at_value(&file, e.to_string());
        if e.problem().is_none() {
            return diagnostic.with_help("a relative path counts from the folder of the scene");
        }
        diagnostic.with_help("`format`, `unit`, `size`, `cell`, `crop`, `fill`, `undefined`, `missing` in [scene.surface] say how to read it")
    };
    let note = |message: String, at: &str| Diagnostic::note(message).at(places.value(at));
    let scan = match &asked.content {
        Some(bytes) => Scan::from_bytes(&path, bytes, declared),
        None => Scan::read(&path, declared),
    };
    let scan = scan.map_err(wrong)?;
    let metadata = scan.metadata();
    let mut notes: Vec<Diagnostic> = metadata.notes.iter().map(|text| note(text.clone(), &file)).collect();
    let metric = metadata.unit.as_ref().is_some_and(|u| u.value.dimension() == Dimension::LENGTH);
    let Preprocessed { map, steps, reliable_from, tapered, holes, .. } =
        scan.preprocessed(&preprocessing).map_err(wrong)?;
    if metric != (system == System::Si) {
        let (found, scene) = if metric { ("a unit", "none") } else { ("no unit", "units") };
        return Err(places
            .at_value(&file, format!("the heights have {found}, but the scene has {scene}"))
            .with_help("say `unit = \"nm\"` for heights of a scene with units, `unit = \"none\"` with `units = \"none\"`"));
    }
    if let Some([before, after]) = tapered {
        let [before, after] = [before, after].map(|h| number(rounded(h, 4)));
        let message = format!(
            "the map is tapered to its edges and divided by the rms of the taper: rms height {before} before, {after} after"
        );
        let help = "Theories take the spectrum, which a homogeneous surface keeps. But `bem3d` presses the tapered map, whose smooth edges \
                    carry load: on self-affine maps its contact fraction was 0.4 to 2.6 times that without the window.";
        notes.push(note(message, &place("window")).with_help(help));
    }
    for Remark { message, help } in remarks(&scan, &preprocessing, &map, asked.detrend.is_some()) {
        notes.push(note(message, &file).with_help(help));
    }
    if let Some(remark) = exchanged_sides(declared, metadata, system) {
        notes.push(note(remark.message, &place("size")).with_help(remark.help));
    }
    let profile = metadata.profile;
    if profile {
        let remark = uniform(&map, system);
        notes.push(note(remark.message, &file).with_help(remark.help));
    }
    let mut metadata = metadata.to_string();
    for step in steps {
        metadata += &format!("\nthen       {step}");
    }
    Ok(FileMap { map, metadata, reliable_from, notes, profile, holes })
}

/// Reads the surface of the second body, turns it over so that it faces the first, and adds both.
pub(crate) fn read_second(
    asked: &AskedSecond,
    (first, first_holes): (&HeightMap, Option<&HeightMap>),
    system: System,
    directory: &Path,
    places: &Places,
) -> ReadResult<FileMap> {
    const TABLE: &str = "scene.second_surface";
    let (facing, offset) = (asked.facing.unwrap_or(Some(Mirror::X)), asked.offset.unwrap_or_default());
    let FileMap { map, mut metadata, reliable_from, notes, profile, holes } =
        read_map(&asked.file, TABLE, system, directory, places)?;
    if profile {
        return Err(places
            .at_key(TABLE, "[scene.second_surface] is a profile")
            .with_help("a profile is a body uniform along y, alone: bring both surfaces as maps"));
    }
    let (map, holes, how) = match facing {
        Some(mirror) => {
            let holes = holes.map(|holes| mirror.of(&holes));
            (mirror.of(&map), holes, format!("{} reversed", mirror.word()))
        }
        None => (map, holes, "as it is seen through its body".to_owned()),
    };
    let sum = surface_io::composite(first, &map, offset).map_err(|e| places.at_key(TABLE, e.to_string()))?;
    // A point of the sum is measured where both are.
    let holes = if first_holes.is_some() || holes.is_some() {
        let (first, second) = (first_holes.unwrap_or(first), holes.as_ref().unwrap_or(&map));
        surface_io::composite(first, second, offset).ok()
    } else {
        None
    };
    metadata += &format!("\nthen       laid on the first: {how}, its middle moved by {offset:?}");
    let length = |length: f64| ascii(&amount(length, system.shown("m")));
    metadata += &format!(
        "\ncomposite  {} rows of {} over {} x {}",
        sum.rows(),
        sum.columns(),
        length(sum.size().x),
        length(sum.size().y)
    );
    Ok(FileMap { map: sum, metadata, reliable_from, notes, profile: false, holes })
}

/// How a profile is used.
fn uniform(map: &HeightMap, system: System) -> Remark {
    let width = ascii(&amount(map.size().y, system.shown("m")));
    Remark {
        message: format!(
            "a profile: the body is taken as uniform along y, and forces are those on a width of {width}"
        ),
        help: "The contact is one of plane strain, and `bem3d` solves it. Pressures do not depend on that width, and the force over the width is \
               the force per length. Theories of isotropic surfaces and `mdr1d` are refused.",
    }
}

/// A property of a map that may make its results differ from what the user expects.
pub(crate) struct Remark {
    pub message: String,
    pub help: &'static str,
}

/// Remarks on a map after its preprocessing: a tilt, unless the scene `declared` what to do with it, and a
/// spike.
pub(crate) fn remarks(
    scan: &Scan,
    preprocessing: &Preprocessing,
    map: &HeightMap,
    declared: bool,
) -> Vec<Remark> {
    let mut remarks = Vec::new();
    if let Some(remark) = of_rounding(scan, preprocessing, map) {
        remarks.push(remark);
    } else if !declared && let Some(share) = tilt(scan, preprocessing, map) {
        remarks.push(Remark {
            message: format!(
                "the map is tilted: from corner to corner by {share:.1} times its rms height without the tilt"
            ),
            help: "Its highest corner then carries the load. Subtract the tilt (`detrend = \"plane\"`), or say that it is real (`detrend = \"none\"`).",
        });
    }
    if let Some((row, column, height)) = spike(map) {
        remarks.push(Remark {
            message: format!(
                "the highest point, in row {row}, column {column} (from 0) of the map as solved, stands {height:.0} times the rms height above the mean"
            ),
            help: "It carries the first load. If it is a spike of the measurement, declare its height (as in the file) as `missing`, and say \
                   with `fill` or `undefined` what stands there instead.",
        });
    }
    remarks
}

/// A remark on a map that is so much tilted that the numbers of its file have no digits left for the roughness.
fn of_rounding(scan: &Scan, preprocessing: &Preprocessing, map: &HeightMap) -> Option<Remark> {
    /// A roughness below this times the last decimal of the largest heights is rounding: rounding alone is 0.29
    /// of it, and as much roughness again makes 0.41.
    const ROUNDED: f64 = 0.5;
    /// Heights along a tilt over the rms height of the rest from which the tilt has taken the digits.
    const STEEP: f64 = 20.0;
    let metadata = scan.metadata();
    let to_map = |h: f64| metadata.unit.as_ref().map_or(h, |unit| unit.value.to_si(h));
    let [low, high] = metadata.range?;
    let flat = Preprocessing {
        detrend: Detrend::Plane,
        crop: preprocessing.crop,
        undefined: Some(Undefined::NoContact),
        ..Preprocessing::default()
    };
    let asked = Preprocessing { undefined: flat.undefined, ..preprocessing.clone() };
    let level = if asked == flat { Cow::Borrowed(map) } else { Cow::Owned(scan.map(&flat).ok()?) };
    let roughness = surface_gen::rms_height(level.heights());
    let (range, rounding) = (to_map(high - low), to_map(last_digit(scan)?));
    if range <= STEEP * roughness || roughness > ROUNDED * rounding {
        return None;
    }
    let symbol = metadata.unit.as_ref().map(|unit| unit.value.dimension().symbol()).unwrap_or_default();
    let [range, roughness, rounding] = [range, roughness, rounding].map(|h| ascii(&amount(h, &symbol)));
    Some(Remark {
        message: format!(
            "the heights differ by {range} along a tilt, and by {roughness} (rms) from it: the rounding of the file's numbers, {rounding}, is \
             as large as the roughness"
        ),
        help: "What is left without the tilt is rounding, and so is everything that is computed from it. Subtract the tilt in the program of \
               the instrument before the heights are exported, or export them with more digits.",
    })
}

/// The last decimal place of the largest heights of a scan, in its own unit: what its numbers are rounded to.
/// Numbers that are all those of single precision are rounded to its digits, and none is finer than those of
/// double precision after a plane is fitted.
fn last_digit(scan: &Scan) -> Option<f64> {
    /// Heights that are looked at.
    const SAMPLE: usize = 4096;
    /// Rounding of a fit to numbers of double precision.
    const FITTED: f64 = 8.0 * f64::EPSILON;
    let metadata = scan.metadata();
    let largest = metadata.range.map(|[low, high]| low.abs().max(high.abs()))?;
    let count = metadata.rows * metadata.columns;
    let step = count.div_ceil(SAMPLE).max(1);
    let heights =
        (0..count).step_by(step).filter_map(|i| scan.height(i / metadata.columns, i % metadata.columns));
    let large: Vec<f64> = heights.filter(|h| h.abs() >= 0.1 * largest).collect();
    let last = large.iter().filter_map(|h| decimal_place(*h)).fold(f64::INFINITY, f64::min);
    let single = large.iter().all(|h| f64::from(*h as f32).to_bits() == h.to_bits());
    let binary = if single { f64::from(f32::EPSILON) * largest } else { FITTED * largest };
    last.is_finite().then(|| last.max(binary))
}

/// The last decimal place of a number as it is written in the fewest digits: 0.1 of 112.7, 1e15 of 1.23e17.
fn decimal_place(height: f64) -> Option<f64> {
    let text = format!("{height:e}");
    let (digits, exponent) = text.split_once('e')?;
    let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    Some(10.0_f64.powi(exponent.parse::<i32>().ok()? - i32::try_from(decimals).ok()?))
}

/// A remark on declared sides of a map that would make its cells squares if they were exchanged.
pub(crate) fn exchanged_sides(
    declared: &ReadOptions,
    map: &surface_io::Metadata,
    system: System,
) -> Option<Remark> {
    let [dx, dy] = swapped(declared, map)?.map(|side| ascii(&amount(side, system.shown("m"))));
    Some(Remark {
        message: format!("cells of {dx} x {dy}: with both sides of `size` exchanged they would be squares"),
        help: "The first side of `size` is along x, the direction of the rows. Ignore this if the cells are really oblong.",
    })
}

/// The highest point and its height above the mean over the rms height, where it is a single spike. The
/// highest point of a Gaussian map of 1e8 points is at about 6.
pub(crate) fn spike(map: &HeightMap) -> Option<(usize, usize, f64)> {
    const ALONE: f64 = 8.0;
    let known: Vec<f64> = map.defined().collect();
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    let (place, highest) = map.heights().iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    let above = (highest - mean) / surface_gen::rms_height(&known);
    (above.is_finite() && above > ALONE).then(|| (place / map.columns(), place % map.columns(), above))
}

/// The sides of oblong cells that would be squares if both declared sides of the map were exchanged.
fn swapped(declared: &ReadOptions, map: &surface_io::Metadata) -> Option<[f64; 2]> {
    const SQUARE: f64 = 1e-2;
    let Sides::Two([x, y]) = declared.size? else { return None };
    let (columns, rows) = (map.columns as f64, map.rows as f64);
    let square = |x: f64, y: f64| ((x / columns) / (y / rows) - 1.0).abs() < SQUARE;
    let [x, y] = [x, y].map(Quantity::value);
    (!square(x, y) && square(y, x)).then(|| [x / columns, y / rows])
}

/// The tilt of a map over its whole size, over the rms height of the map without it, where the tilt changes
/// the contact.
fn tilt(scan: &Scan, preprocessing: &Preprocessing, map: &HeightMap) -> Option<f64> {
    /// A tilt below this is hidden by the roughness.
    const HIDDEN: f64 = 1.0;
    let level = scan.map(&Preprocessing { detrend: Detrend::Plane, ..preprocessing.clone() }).ok()?;
    let differences = map.heights().iter().zip(level.heights()).map(|(h, level)| h - level);
    let known = differences.filter(|d| d.is_finite());
    let (low, high) =
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
    let rest: Vec<f64> = level.defined().collect();
    let share = (high - low) / surface_gen::rms_height(&rest);
    (share.is_finite() && share > HIDDEN).then_some(share)
}
