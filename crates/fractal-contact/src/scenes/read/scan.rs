//! `[scene.surface]` with `kind = "file"`: a measured map and its options.

use crate::scenes::read::{Diagnostic, Entries, Entry, LengthOrPair, Read, System, amount, number};
use contact_model::HeightMap;
use contact_model::units::{ascii, rounded};
use std::path::Path;
use surface_io::{
    AlignLines, Axes, Border, ChannelChoice, Crop, Decimal, Description, Detrend, Dimension, Fill, Format,
    Mirror, Preprocessed, Preprocessing, Quantity, ReadOptions, Scan, Sides, Undefined, Unit, Window,
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
}

/// The description of a map, with units where its lengths are in metres.
pub(crate) fn description(map: &HeightMap, system: System) -> Description {
    let description = surface_io::describe(map);
    if system == System::Si { description.in_metres() } else { description }
}

/// Reads the file of a surface.
pub(crate) fn read_map(table: &Entries<'_>, system: System, directory: &Path) -> Read<FileMap> {
    let mut notes = Vec::new();
    let file = table.require("path", "\"heights.npy\"")?;
    let path = directory.join(file.text()?);
    let declared = read_options(table, system, &mut notes)?;
    let preprocessing = read_treatment(table, system)?;
    table.known_only()?;
    let wrong = |e: surface_io::Error| {
        let diagnostic = file.diagnostic(e.to_string());
        if e.problem().is_none() {
            return diagnostic.with_help("a relative path counts from the folder of the scene");
        }
        diagnostic.with_help("`format`, `unit`, `size`, `cell`, `crop`, `fill`, `undefined`, `missing` in [scene.surface] say how to read it")
    };
    let scan = Scan::read(&path, &declared).map_err(wrong)?;
    let metadata = scan.metadata();
    for note in &metadata.notes {
        notes.push(Diagnostic::note(note.clone()).at(file.span()));
    }
    let metric = metadata.unit.as_ref().is_some_and(|u| u.value.dimension() == Dimension::LENGTH);
    let Preprocessed { map, steps, reliable_from, tapered, .. } =
        scan.preprocessed(&preprocessing).map_err(wrong)?;
    if metric != (system == System::Si) {
        let (found, scene) = if metric { ("a unit", "none") } else { ("no unit", "units") };
        return Err(file
            .diagnostic(format!("the heights have {found}, but the scene has {scene}"))
            .with_help("say `unit = \"nm\"` for heights of a scene with units, `unit = \"none\"` with `units = \"none\"`"));
    }
    if let (Some(entry), Some([before, after])) = (table.find("window"), tapered) {
        let [before, after] = [before, after].map(|h| number(rounded(h, 4)));
        let message = format!(
            "the map is tapered to its edges and divided by the rms of the taper: rms height {before} before, {after} after"
        );
        let help = "Theories take the spectrum, which a homogeneous surface keeps. But `bem3d` presses the tapered map, whose smooth edges \
                    carry load: on self-affine maps its contact fraction was 0.4 to 2.6 times that without the window.";
        notes.push(Diagnostic::note(message).at(entry.span()).with_help(help));
    }
    for Remark { message, help } in remarks(&scan, &preprocessing, &map, table.find("detrend").is_some()) {
        notes.push(Diagnostic::note(message).at(file.span()).with_help(help));
    }
    if let (Some(entry), Some(remark)) = (table.find("size"), exchanged_sides(&declared, metadata, system)) {
        notes.push(Diagnostic::note(remark.message).at(entry.span()).with_help(remark.help));
    }
    let profile = metadata.profile;
    notes.extend(profile.then(|| uniform(&file, &map, system)));
    let mut metadata = metadata.to_string();
    for step in steps {
        metadata += &format!("\nthen       {step}");
    }
    Ok(FileMap { map, metadata, reliable_from, notes, profile })
}

/// The options for reading the file.
fn read_options(table: &Entries<'_>, system: System, notes: &mut Vec<Diagnostic>) -> Read<ReadOptions> {
    let unit = |key: &'static str| -> Read<Option<Unit>> {
        table.optional(key, |entry| {
            entry.text()?.parse().map_err(|e| {
                entry
                    .diagnostic(format!("`{key}`: {e}"))
                    .with_help("a unit of length in quotes, such as \"nm\"")
            })
        })
    };
    let mut declared = ReadOptions {
        format: table.optional("format", |e| e.choice(&Format::ALL.map(|format| (format.word(), format))))?,
        channel: table.optional("channel", |e| match e.as_word() {
            Some(name) => Ok(ChannelChoice::Name(name.into())),
            None => e.size(0).map(ChannelChoice::Number),
        })?,
        unit: unit("unit")?,
        lateral_unit: unit("lateral_unit")?,
        height_scale: table.optional("height_scale", |e| positive_length(e, system))?,
        ..ReadOptions::default()
    };
    match table.one_of(&["size", "cell", "width"])? {
        Some(("size", entry)) => declared.size = Some(sides(&entry, system)?),
        Some(("cell", entry)) => declared.cell = Some(sides(&entry, system)?),
        Some((_, entry)) => {
            declared.width = Some(positive_length(&entry, system)?);
            let note = Diagnostic::note("`width` is now `size`").at(entry.key_span());
            notes.push(note.with_help("write `size = [Lx, Ly]`, or one value where the map is square; `width` is Lx, with square cells"));
        }
        None => {}
    }
    let decimals = [("point", Decimal::Point), ("comma", Decimal::Comma)];
    table.set(&mut declared.decimal, "decimal", |e| e.choice(&decimals))?;
    declared.axes = table.optional("axes", |e| e.choice(&[("xy", Axes::Xy), ("yx", Axes::Yx)]))?;
    let borders = [("axes", Border::Axes), ("heights", Border::Heights)];
    declared.border = table.optional("border", |e| e.choice(&borders))?;
    declared.missing = table.optional("missing", Entry::any_number)?;
    table.set(&mut declared.skip_lines, "skip_lines", |e| e.size(0))?;
    Ok(declared)
}

/// Reads the surface of the second body, turns it over so that it faces the first, and adds both.
pub(crate) fn read_second(
    table: &Entries<'_>,
    first: &HeightMap,
    system: System,
    directory: &Path,
) -> Read<FileMap> {
    let (mut facing, mut offset) = (Some(Mirror::X), [0.0; 2]);
    let faces = [("x", Some(Mirror::X)), ("y", Some(Mirror::Y)), ("none", None)];
    table.set(&mut facing, "facing", |e| e.choice(&faces))?;
    table.set(&mut offset, "offset", |e| match &e.list()[..] {
        [x, y] => Ok([x.quantity(Dimension::LENGTH, system)?, y.quantity(Dimension::LENGTH, system)?]),
        _ => Err(e.diagnostic("`offset` has not two values").with_help(
            "of the middle of the second surface from that of the first, along x and y: [\"5 um\", \"0 um\"]",
        )),
    })?;
    let FileMap { map, mut metadata, reliable_from, notes, profile } = read_map(table, system, directory)?;
    if profile {
        return Err(table
            .diagnostic("[scene.second_surface] is a profile")
            .with_help("a profile is a body uniform along y, alone: bring both surfaces as maps"));
    }
    let (map, how) = match facing {
        Some(mirror) => (mirror.of(&map), format!("{} reversed", mirror.word())),
        None => (map, "as it is seen through its body".to_owned()),
    };
    let sum = surface_io::composite(first, &map, offset).map_err(|e| table.diagnostic(e.to_string()))?;
    metadata += &format!("\nthen       laid on the first: {how}, its middle moved by {offset:?}");
    let length = |length: f64| ascii(&amount(length, system.shown("m")));
    metadata += &format!(
        "\ncomposite  {} rows of {} over {} x {}",
        sum.rows(),
        sum.columns(),
        length(sum.size().x),
        length(sum.size().y)
    );
    Ok(FileMap { map: sum, metadata, reliable_from, notes, profile: false })
}

/// A note on how a profile is used.
fn uniform(file: &Entry<'_>, map: &HeightMap, system: System) -> Diagnostic {
    let help = "The contact is one of plane strain, and `bem3d` solves it. Pressures do not depend on that width, and the force over the width is \
                the force per length. Theories of isotropic surfaces and `mdr1d` are refused.";
    let width = ascii(&amount(map.size().y, system.shown("m")));
    let message = format!(
        "a profile: the body is taken as uniform along y, and forces are those on a width of {width}"
    );
    Diagnostic::note(message).at(file.span()).with_help(help)
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
    if !declared && let Some(share) = tilt(scan, preprocessing, map) {
        remarks.push(Remark {
            message: format!(
                "the map is tilted: from edge to edge by {share:.1} times its rms height without the tilt"
            ),
            help: "Its highest corner then carries the load. Subtract the tilt (`detrend` by \"plane\"), or say that it is real (\"none\").",
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

/// One length or two: sides of the map or of a cell.
fn sides(entry: &Entry<'_>, system: System) -> Read<Sides> {
    Ok(match entry.lengths(system)? {
        LengthOrPair::One(side) => Sides::One(length(entry, side, system)?),
        LengthOrPair::Two([x, y]) => Sides::Two([length(entry, x, system)?, length(entry, y, system)?]),
    })
}

fn length(entry: &Entry<'_>, value: f64, system: System) -> Read<Quantity> {
    let dimension = if system == System::Si { Dimension::LENGTH } else { Dimension::NONE };
    Quantity::new(value, dimension).map_err(|e| entry.diagnostic(e.to_string()))
}

fn positive_length(entry: &Entry<'_>, system: System) -> Read<Quantity> {
    length(entry, entry.positive(Dimension::LENGTH, system)?, system)
}

fn read_crop(entry: &Entry<'_>) -> Read<Crop> {
    if !entry.is_table() {
        return entry.choice(&[("centre", Crop::Centre), ("defined", Crop::Defined)]);
    }
    let window = entry.table()?;
    let number = |key: &'static str, least: u64| window.require(key, "0")?.size(least);
    let (rows, columns) = match window.one_of(&["cells", "rows"])? {
        Some(("cells", cells)) => cells.size(1).map(|cells| (cells, cells))?,
        _ => (number("rows", 1)?, number("columns", 1)?),
    };
    let crop = Crop::Window { row: number("row", 0)?, column: number("column", 0)?, rows, columns };
    window.finish()?;
    Ok(crop)
}

fn read_treatment(table: &Entries<'_>, system: System) -> Read<Preprocessing> {
    let mut preprocessing = Preprocessing {
        crop: table.optional("crop", read_crop)?,
        align_lines: table.optional("align_lines", |e| e.choice(&AlignLines::ALL.map(|a| (a.word(), a))))?,
        scars: table.optional("scars", Entry::number)?,
        outliers: table.optional("outliers", Entry::number)?,
        tip_radius: table.optional("tip_radius", |e| positive_length(e, system))?,
        ..Preprocessing::default()
    };
    match table.one_of(&["fill", "undefined"])? {
        Some(("fill", entry)) => {
            preprocessing.fill = Some(match entry.as_word() {
                Some("neighbours") => Fill::Neighbours,
                Some("plane") => Fill::Plane,
                _ => {
                    let value = entry.quantity(Dimension::LENGTH, system).map_err(|diagnostic| {
                        diagnostic.with_help(
                            "how undefined points are filled: \"neighbours\", \"plane\" or one height",
                        )
                    })?;
                    Fill::Value(length(&entry, value, system)?)
                }
            });
        }
        Some((_, entry)) => {
            preprocessing.undefined = Some(entry.choice(&[("no_contact", Undefined::NoContact)])?);
        }
        None => {}
    }
    table.set(&mut preprocessing.detrend, "detrend", |e| e.choice(&Detrend::ALL.map(|d| (d.word(), d))))?;
    preprocessing.filter_across = table.optional("filter_across", |e| positive_length(e, system))?;
    preprocessing.mirror = table.optional("mirror", |e| e.choice(&[("x", Mirror::X), ("y", Mirror::Y)]))?;
    table.set(&mut preprocessing.quarter_turns, "rotate", |e| match e.count(0)? {
        degrees @ (0 | 90 | 180 | 270) => Ok((degrees / 90) as u8),
        degrees => Err(e
            .diagnostic(format!("`rotate` is {degrees}"))
            .with_help("degrees from x to y: 0, 90, 180 or 270")),
    })?;
    preprocessing.window = table.optional("window", |e| e.choice(&[("hann", Window::Hann)]))?;
    preprocessing.cells = table.optional("cells", |e| e.size(1))?;
    preprocessing.rows = table.optional("rows", |e| e.size(1))?;
    Ok(preprocessing)
}
