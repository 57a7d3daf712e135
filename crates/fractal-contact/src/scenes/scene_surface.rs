//! The surface of a scene: `[scene.surface]`, and `[scene.body]` added to it.

use crate::scenes::diagnostic::Diagnostic;
use crate::scenes::entries::{Entries, LengthOrPair, Read, System};
use crate::scenes::human_readable::number;
use crate::scenes::numerics::Numerics;
use crate::scenes::scan;
use contact_model::{Amplitude, Error, HeightMap, Result, SelfAffine, Size, Surface};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use surface_io::Dimension;

/// What is pressed: a surface, or a random surface on a body.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneSurface {
    /// One surface.
    Plain(Surface),
    /// A random surface on a body: heights add.
    Sum {
        /// The random part.
        rough: SelfAffine,
        /// The body.
        body: Surface,
    },
}

impl SceneSurface {
    /// Sides of the nominal contact area.
    pub fn size(&self) -> Size {
        match self {
            Self::Plain(surface) => surface.size(),
            Self::Sum { rough, .. } => rough.size,
        }
    }

    /// Whether a seed decides what it looks like.
    pub fn is_random(&self) -> bool {
        matches!(self, Self::Plain(Surface::SelfAffine(_)) | Self::Sum { .. })
    }

    /// Whether a model has other numbers for other seeds: of a given map only the line that stands for it has.
    pub(crate) fn is_random_for(&self, numerics: &Numerics) -> bool {
        let given = matches!(self, Self::Plain(Surface::Heights(_)));
        numerics.depends_on_realisation() && (!given || matches!(numerics, Numerics::Mdr1d(_)))
    }

    /// Whether it is rough: it has an rms height in which forces can be counted.
    pub fn is_rough(&self) -> bool {
        matches!(
            self,
            Self::Plain(Surface::SelfAffine(_) | Surface::Heights(_) | Surface::Line { .. })
                | Self::Sum { .. }
        )
    }

    /// In a phrase.
    pub fn describe(&self) -> String {
        match self {
            Self::Plain(Surface::SelfAffine(s)) => self_affine(s),
            Self::Plain(Surface::Heights(map)) => {
                let mut text =
                    format!("a map of {} x {} cells, {}", map.columns(), map.rows(), sides(map.size()));
                if map.undefined() > 0 {
                    text += &format!(", {} undefined points", map.undefined());
                }
                text
            }
            Self::Plain(surface) => {
                let size = surface.size();
                let shape = if size.is_square() { "square" } else { "rectangle" };
                format!("{} on a {shape} of {}", surface.kind(), sides(size))
            }
            Self::Sum { rough, body } => format!("{} on {}", self_affine(rough), body.kind()),
        }
    }

    /// What a model is given: sums are drawn on the model's own cells.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a sum and a model without cells, and what drawing a surface refuses.
    pub fn for_model(&self, numerics: &Numerics, seed: u64) -> Result<Surface> {
        match self {
            Self::Plain(surface) => Ok(surface.clone()),
            Self::Sum { rough, body } => {
                let Some(elements) = numerics.boundary_elements() else {
                    return Err(Error::unsupported(
                        numerics.name(),
                        "a rough surface on a body (it takes one or the other)",
                    ));
                };
                let rough = surface_gen::self_affine_map(rough, elements.grid(rough.size), seed)?;
                Ok(Surface::Heights(Arc::new(add(&rough, body)?)))
            }
        }
    }
}

/// One side of a square or both of a rectangle.
fn sides(size: Size) -> String {
    if size.is_square() {
        format!("side {}", number(size.x))
    } else {
        format!("sides {} x {}", number(size.x), number(size.y))
    }
}

fn self_affine(s: &SelfAffine) -> String {
    let mut text = format!("a self-affine surface, D_f = {}, {}", s.fractal_dimension(), sides(s.size));
    if let Amplitude::RmsHeight(h) = s.amplitude {
        text += &format!(", rms height {}", number(h));
    }
    if let Some(q) = s.roll_off {
        text += &format!(", roll-off at the wavelength {}", number(2.0 * PI / q));
    }
    if let Some(q) = s.short_cutoff {
        text += &format!(", shortest wavelength {}", number(2.0 * PI / q));
    }
    text
}

/// Heights of a map plus those of a body on the same cells.
pub(crate) fn add(map: &HeightMap, body: &Surface) -> Result<HeightMap> {
    let body = surface_gen::height_map(body, map.cells(), 0)?;
    let sum = |(a, b): (&f64, &f64)| if a.is_finite() { a + b } else { f64::NAN };
    let heights = map.heights().iter().zip(body.heights()).map(sum).collect();
    if map.undefined() > 0 {
        HeightMap::with_undefined(map.cells(), map.size(), heights)
    } else {
        HeightMap::new(map.cells(), map.size(), heights)
    }
}

/// `[scene.surface]` and `[scene.body]` as they were read.
pub(crate) struct SurfaceEntry {
    pub surface: SceneSurface,
    /// Metadata of its file.
    pub metadata: Option<String>,
    /// From which distance on the tips of its instruments let heights be seen.
    pub reliable_from: Option<f64>,
    /// Remarks on the keys.
    pub notes: Vec<Diagnostic>,
}

impl From<SceneSurface> for SurfaceEntry {
    fn from(surface: SceneSurface) -> Self {
        Self { surface, metadata: None, reliable_from: None, notes: Vec::new() }
    }
}

/// Reads `[scene.surface]`, `[scene.second_surface]` and `[scene.body]`.
pub(crate) fn read_surface(scene: &Entries<'_>, system: System, directory: &Path) -> Read<SurfaceEntry> {
    let surface = scene.table("surface")?;
    let second = scene.table("second_surface")?;
    let body = scene.table("body")?;
    let of_file = |table: &Entries<'_>| -> Read<bool> {
        Ok(table.require("kind", "\"self_affine\"")?.choice(&ROUGH)? == RoughKind::File)
    };
    if let Some(second) = &second
        && !(of_file(second)? && surface.as_ref().map_or(Ok(false), &of_file)?)
    {
        return Err(second.diagnostic("[scene.second_surface] is added to a measured [scene.surface]").with_help(
            "say `kind = \"file\"` in both; two independent random surfaces are one of the rms height sqrt(h1^2 + h2^2)",
        ));
    }
    let Some(surface) = surface else {
        let Some(body) = body else {
            return Err(scene
                .diagnostic("nothing is pressed: there is neither [scene.surface] nor [scene.body]")
                .with_help(
                    "describe one: [scene.surface] with `kind = \"self_affine\"` or \"file\", or [scene.body] with `kind = \"sphere\"`",
                ));
        };
        return Ok(SceneSurface::Plain(read_body(&body, None, system)?).into());
    };
    if of_file(&surface)? {
        let scan::FileMap { mut map, mut metadata, mut reliable_from, mut notes } =
            scan::read_map(&surface, system, directory)?;
        if let Some(second) = second {
            let other = scan::read_second(&second, &map, system, directory)?;
            map = other.map;
            reliable_from = [reliable_from, other.reliable_from].into_iter().flatten().reduce(f64::max);
            metadata += &format!("\nsecond surface\n{}", other.metadata);
            notes.extend(other.notes);
        }
        let map = match body {
            None => map,
            Some(body) => {
                let body = read_body(&body, Some(map.size()), system)?;
                add(&map, &body).map_err(|e| scene.diagnostic(e.to_string()))?
            }
        };
        let plain = SceneSurface::Plain(Surface::Heights(Arc::new(map)));
        return Ok(SurfaceEntry { surface: plain, metadata: Some(metadata), reliable_from, notes });
    }
    let rough = read_self_affine(&surface, system)?;
    surface.known_only()?;
    let sum = match body {
        None => SceneSurface::Plain(Surface::SelfAffine(rough)),
        Some(body) => SceneSurface::Sum { rough, body: read_body(&body, Some(rough.size), system)? },
    };
    Ok(sum.into())
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum RoughKind {
    SelfAffine,
    File,
}

const ROUGH: [(&str, RoughKind); 2] = [("self_affine", RoughKind::SelfAffine), ("file", RoughKind::File)];

fn read_self_affine(table: &Entries<'_>, system: System) -> Read<SelfAffine> {
    let length =
        |key: &'static str| table.find(key).map(|e| e.positive(Dimension::LENGTH, system)).transpose();
    let size = read_size(table, system)?;
    let hurst = match table.one_of(&["fractal_dimension", "hurst"])? {
        Some(("hurst", e)) => within(&e, e.number()?, 0.0, 1.0)?,
        Some((_, e)) => 3.0 - within(&e, e.number()?, 2.0, 3.0)?,
        None => {
            return Err(table
                .diagnostic("`fractal_dimension` is missing in [scene.surface]")
                .with_help("add `fractal_dimension = 2.4`, or `hurst = 0.6`"));
        }
    };
    let rms = table.require("rms_height", "\"1 um\"")?.positive(Dimension::LENGTH, system)?;
    let short = length("shortest_wavelength")?;
    let long = table.find("roll_off_wavelength");
    let roll_off = long.as_ref().map(|e| e.positive(Dimension::LENGTH, system)).transpose()?;
    if let (Some(entry), Some(long), Some(short)) = (&long, roll_off, short)
        && long < short
    {
        return Err(entry
            .diagnostic("`roll_off_wavelength` is below `shortest_wavelength`")
            .with_help("the roll-off is the longest wave of the fractal range"));
    }
    let wavenumber = |wavelength: f64| 2.0 * PI / wavelength;
    Ok(SelfAffine {
        size,
        hurst,
        amplitude: Amplitude::RmsHeight(rms),
        roll_off: roll_off.map(wavenumber),
        short_cutoff: short.map(wavenumber),
    })
}

/// `side = s` or `size = [Lx, Ly]`.
fn read_size(table: &Entries<'_>, system: System) -> Read<Size> {
    match table.one_of(&["side", "size"])? {
        Some(("size", entry)) => Ok(match entry.lengths(system)? {
            LengthOrPair::One(side) => side.into(),
            LengthOrPair::Two(sides) => sides.into(),
        }),
        Some((_, entry)) if entry.is_list() => Err(entry
            .diagnostic(format!("`side` has {} values: it is the one of a square", entry.list().len()))
            .with_help("both sides of a rectangle are `size = [Lx, Ly]`")),
        Some((_, entry)) => entry.positive(Dimension::LENGTH, system).map(Size::from),
        None => table.require("side", "\"1 mm\"")?.positive(Dimension::LENGTH, system).map(Size::from),
    }
}

fn within(entry: &crate::scenes::entries::Entry<'_>, value: f64, low: f64, high: f64) -> Read<f64> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(entry
            .diagnostic(format!("{value} is outside [{low}, {high}]"))
            .with_help("D_f = 3 - H lies in [2, 3], H in [0, 1]"))
    }
}

#[derive(Clone, Copy)]
enum BodyKind {
    Sphere,
    Cone,
    PowerLaw,
    FlatCircle,
    Flat,
    Sine,
}

const BODIES: [(&str, BodyKind); 7] = [
    ("sphere", BodyKind::Sphere),
    ("cone", BodyKind::Cone),
    ("power_law", BodyKind::PowerLaw),
    ("flat_circle", BodyKind::FlatCircle),
    ("flat", BodyKind::Flat),
    ("flat_square", BodyKind::Flat),
    ("sine", BodyKind::Sine),
];

/// A body; on a rough surface it has that surface's size.
fn read_body(table: &Entries<'_>, given: Option<Size>, system: System) -> Read<Surface> {
    let length = |key: &'static str| table.require(key, "\"1 mm\"")?.positive(Dimension::LENGTH, system);
    let kind = table.require("kind", "\"sphere\"")?.choice(&BODIES)?;
    let size = match (given, table.one_of(&["side", "size"])?) {
        (Some(_), Some((key, entry))) => {
            return Err(entry
                .diagnostic_at_key(format!("`{key}` is given for the body, which has that of the surface"))
                .with_help("remove it in [scene.body]: the area is that of [scene.surface]"));
        }
        (Some(size), None) => size,
        (None, _) => read_size(table, system)?,
    };
    let surface = match kind {
        BodyKind::Sphere => Surface::Sphere { radius: length("radius")?, size },
        BodyKind::Cone => Surface::Cone { slope: table.require("slope", "0.1")?.positive_number()?, size },
        BodyKind::PowerLaw => {
            // Two lengths instead of a coefficient whose unit depends on the exponent.
            let exponent = table.require("exponent", "4")?.positive_number()?;
            let (depth, radius) = (length("depth")?, length("radius")?);
            Surface::PowerLaw { coefficient: depth / radius.powf(exponent), exponent, size }
        }
        BodyKind::FlatCircle => Surface::FlatCircle { radius: length("radius")?, size },
        BodyKind::Flat => Surface::Flat { size },
        BodyKind::Sine => {
            Surface::Sine { amplitude: length("amplitude")?, wavelength: length("wavelength")?, size }
        }
    };
    table.known_only()?;
    Ok(surface)
}
