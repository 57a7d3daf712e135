//! The surface of a scene: `[scene.surface]`, and `[scene.body]` added to it.

use crate::scenes::read::{
    Diagnostic, Entries, Entry, LengthOrPair, Numerics, RandomSpectrum, RandomSurface, Read, System, amount,
    describe_self_affine, describe_sides, map_key, sampled, scan,
};
use contact_model::{Amplitude, Cells, Error, HeightMap, Result, SelfAffine, Size, Surface};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use surface_gen::{Anisotropy, HeightDistribution, TwinSpectrum, WaveGenerator};
use surface_io::Dimension;

/// The surface of the contact: a given one, or a random one, alone or on a body.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneSurface {
    /// One surface.
    Plain(Surface),
    /// A random surface that is generated on the cells of each model, to which the heights of a body may be
    /// added.
    Drawn {
        /// The random part.
        rough: RandomSurface,
        /// The body.
        body: Option<Surface>,
    },
}

impl SceneSurface {
    /// Sides of the nominal contact area.
    pub fn size(&self) -> Size {
        match self {
            Self::Plain(surface) => surface.size(),
            Self::Drawn { rough, .. } => rough.size(),
        }
    }

    /// Whether it depends on the seed.
    pub fn is_random(&self) -> bool {
        matches!(self, Self::Plain(Surface::SelfAffine(_)) | Self::Drawn { .. })
    }

    /// Whether it is a profile: a body that is uniform along y.
    pub fn is_profile(&self) -> bool {
        matches!(self, Self::Plain(Surface::Profile(_)))
    }

    /// Whether the results of a model depend on the seed. For a given map only those of the random line of
    /// `mdr1d` do. A map that is drawn from the seed is another one for each seed, also for a theory that
    /// measures its statistics.
    pub(crate) fn is_random_for(&self, numerics: &Numerics) -> bool {
        match self {
            Self::Drawn { .. } => true,
            Self::Plain(Surface::Heights(_)) => matches!(numerics, Numerics::Mdr1d(_)),
            Self::Plain(Surface::Profile(_)) => false,
            Self::Plain(_) => numerics.depends_on_realisation(),
        }
    }

    /// Whether it is rough, so that it has an rms height by which forces can be normalised.
    pub fn is_rough(&self) -> bool {
        matches!(
            self,
            Self::Plain(
                Surface::SelfAffine(_) | Surface::Heights(_) | Surface::Profile(_) | Surface::Line { .. }
            ) | Self::Drawn { .. }
        )
    }

    /// The map of a file, as it is solved; that of a profile has one row.
    pub fn given_map(&self) -> Option<&Arc<HeightMap>> {
        match self {
            Self::Plain(Surface::Heights(map) | Surface::Profile(map)) => Some(map),
            _ => None,
        }
    }

    /// The cells that it defines itself, which models have to use: those of a given map or of its twin.
    pub(crate) fn own_cells(&self) -> Option<Cells> {
        match self {
            Self::Plain(Surface::Heights(map) | Surface::Profile(map)) => Some(map.cells()),
            Self::Plain(_) => None,
            Self::Drawn { rough, .. } => rough.own_cells(),
        }
    }

    /// Whether the surface of a seed on other cells is a different one, and does not only have more or fewer
    /// short waves.
    pub(crate) fn differs_by_grid(&self) -> bool {
        matches!(self, Self::Drawn { rough, .. } if rough.heights.is_some()) && self.own_cells().is_none()
    }

    /// The same surface on at most `longer` cells along its longer side, where a model otherwise has `cells`.
    pub(crate) fn coarser(&self, cells: Cells, longer: usize) -> Result<Self> {
        Ok(match self {
            Self::Plain(Surface::Heights(map)) => {
                Self::Plain(Surface::Heights(Arc::new(sampled(map, longer)?)))
            }
            Self::Plain(Surface::Profile(map)) => {
                Self::Plain(Surface::Profile(Arc::new(sampled(map, longer)?)))
            }
            Self::Plain(_) => self.clone(),
            Self::Drawn { rough, body } => {
                Self::Drawn { rough: rough.coarser(cells, longer), body: body.clone() }
            }
        })
    }

    /// A description in a phrase, with lengths in the units of this system.
    pub fn describe(&self, system: System) -> String {
        match self {
            Self::Plain(Surface::SelfAffine(s)) => describe_self_affine(s, system),
            Self::Plain(Surface::Heights(map)) => {
                let sides = describe_sides(map.size(), system);
                let mut text = format!("a map of {} x {} cells, {sides}", map.columns(), map.rows());
                if map.undefined() > 0 {
                    text += &format!(", {} undefined points", map.undefined());
                }
                text
            }
            Self::Plain(Surface::Profile(map)) => {
                let [length, width] =
                    [map.size().x, map.size().y].map(|side| amount(side, system.shown("m")));
                let undefined = if map.undefined() > 0 {
                    format!(", {} undefined points", map.undefined())
                } else {
                    String::new()
                };
                format!(
                    "a profile of {} points over {length}{undefined}; the body is uniform along y (plane strain), forces are those on {width} of it",
                    map.columns()
                )
            }
            Self::Plain(surface) => {
                let size = surface.size();
                let shape = if size.is_square() { "square" } else { "rectangle" };
                format!("{} on a {shape} of {}", surface.kind(), describe_sides(size, system))
            }
            Self::Drawn { rough, body: None } => rough.describe(system),
            Self::Drawn { rough, body: Some(body) } => {
                format!("{} on {}", rough.describe(system), body.kind())
            }
        }
    }

    /// Everything that determines its heights except the seed, in a line.
    pub(crate) fn key(&self) -> String {
        match self {
            Self::Plain(Surface::Heights(map)) => map_key(map),
            Self::Plain(Surface::Profile(map)) => format!("profile {}", map_key(map)),
            Self::Drawn { rough, body } => format!("{} on {body:?}", rough.key()),
            Self::Plain(surface) => format!("{surface:?}"),
        }
    }

    /// The surface for a model; a random surface is generated on the model's own cells.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a model without cells and a surface that needs them; errors of generating
    /// the surface.
    pub fn for_model(&self, numerics: &Numerics, seed: u64) -> Result<Surface> {
        let (rough, body) = match self {
            Self::Plain(surface) => return Ok(surface.clone()),
            Self::Drawn { rough, body } => (rough, body),
        };
        let elements = numerics.boundary_elements();
        let cells = match (elements.map(|elements| elements.grid(rough.size())), rough.own_cells(), body) {
            (Some(cells), ..) | (None, Some(cells), None) => cells,
            (None, _, Some(_)) => {
                let what = "a rough surface on a body (it takes one or the other)";
                return Err(Error::unsupported(numerics.name(), what));
            }
            (None, None, None) => {
                let what = "a lay or a distribution of heights: it draws no map";
                return Err(Error::unsupported(numerics.name(), what));
            }
        };
        let map = rough.draw(cells, seed)?.map;
        Ok(Surface::Heights(Arc::new(match body {
            Some(body) => add(&map, body)?,
            None => map,
        })))
    }
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
    /// The distance from which on the tips of its instruments resolve heights.
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
        table.require("kind", "\"self_affine\"")?.choice(&[("self_affine", false), ("file", true)])
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
        let twin = read_twin(&surface, second.is_some())?;
        let scan::FileMap { mut map, mut metadata, mut reliable_from, mut notes, profile } =
            scan::read_map(&surface, system, directory)?;
        if profile {
            let twin = twin.map(|(entry, ..)| entry);
            refuse_for_profile(scene, twin.as_ref(), second.is_some(), body.is_some())?;
            let plain = SceneSurface::Plain(Surface::Profile(Arc::new(map)));
            return Ok(SurfaceEntry { surface: plain, metadata: Some(metadata), reliable_from, notes });
        }
        if let Some(second) = second {
            let other = scan::read_second(&second, &map, system, directory)?;
            map = other.map;
            reliable_from = [reliable_from, other.reliable_from].into_iter().flatten().reduce(f64::max);
            metadata += &format!("\nsecond surface\n{}", other.metadata);
            notes.extend(other.notes);
        }
        let body = body.map(|body| read_body(&body, Some(map.size()), system)).transpose()?;
        if let Some((entry, like, keep_heights)) = twin {
            let of = Arc::new(map);
            // Obstacles to a twin are found before anything is solved.
            WaveGenerator::twin(&of, like).map_err(|e| {
                entry.diagnostic(format!("no twin of this map: {e}")).with_help(
                    "undefined points need `fill`; a map that is not periodic `detrend` and `window = \"hann\"`",
                )
            })?;
            let heights = keep_heights.then(|| HeightDistribution::Of(Arc::clone(&of)));
            let rough = RandomSurface::new(RandomSpectrum::Twin { of, like }, heights);
            let surface = SceneSurface::Drawn { rough, body };
            return Ok(SurfaceEntry { surface, metadata: Some(metadata), reliable_from, notes });
        }
        let map = match body {
            None => map,
            Some(body) => add(&map, &body).map_err(|e| scene.diagnostic(e.to_string()))?,
        };
        let plain = SceneSurface::Plain(Surface::Heights(Arc::new(map)));
        return Ok(SurfaceEntry { surface: plain, metadata: Some(metadata), reliable_from, notes });
    }
    let rough = read_self_affine(&surface, system)?;
    let (anisotropy, heights) = (read_anisotropy(&surface)?, read_heights(&surface)?);
    surface.known_only()?;
    let body = body.map(|body| read_body(&body, Some(rough.size), system)).transpose()?;
    if anisotropy.is_none() && heights.is_none() && body.is_none() {
        return Ok(SceneSurface::Plain(Surface::SelfAffine(rough)).into());
    }
    let spectrum = RandomSpectrum::SelfAffine { surface: rough, anisotropy };
    Ok(SceneSurface::Drawn { rough: RandomSurface::new(spectrum, heights), body }.into())
}

/// Refuses keys that cannot be combined with a profile.
fn refuse_for_profile(
    scene: &Entries<'_>,
    twin: Option<&Entry<'_>>,
    has_second: bool,
    has_body: bool,
) -> Read<()> {
    let help = "remove it, or measure an area; a tilt or a bow of the profile goes with `detrend`";
    if let Some(entry) = twin {
        let message = "`twin` of a profile: a twin has the spectrum of a map in all directions";
        return Err(entry.diagnostic_at_key(message).with_help(help));
    }
    for (name, given) in [("second_surface", has_second), ("body", has_body)] {
        if let (true, Some(entry)) = (given, scene.entry(name)) {
            let message = format!("[scene.{name}] beside a profile, which is a body uniform along y");
            return Err(entry.diagnostic_at_key(message).with_help(help));
        }
    }
    Ok(())
}

/// `twin` and `keep_heights`.
fn read_twin<'a>(table: &Entries<'a>, is_second: bool) -> Read<Option<(Entry<'a>, TwinSpectrum, bool)>> {
    let help = "add `twin = \"waves\"`, or remove it: the map itself has its heights";
    let keep = table.beside("keep_heights", "twin", help)?;
    let Some(entry) = table.find("twin") else { return Ok(None) };
    let like = entry.choice(&[("waves", TwinSpectrum::EachWave), ("rings", TwinSpectrum::Rings)])?;
    if is_second {
        return Err(entry
            .diagnostic_at_key("`twin` beside [scene.second_surface]")
            .with_help("draw the twin into a file with `fractal-contact twin`, and read that file here"));
    }
    let keep_heights = keep.map_or(Ok(false), |keep| keep.flag())?;
    Ok(Some((entry, like, keep_heights)))
}

/// `anisotropy` and `lay`.
fn read_anisotropy(table: &Entries<'_>) -> Read<Option<Anisotropy>> {
    let help = "add `anisotropy = 4`: waves along the lay are then four times as long as across it";
    let lay = table.beside("lay", "anisotropy", help)?;
    let Some(ratio) = table.find("anisotropy") else { return Ok(None) };
    let lay = lay.map_or(Ok(0.0), |lay| lay.angle())?;
    Ok(Some(Anisotropy { ratio: ratio.positive_number()?, lay }))
}

/// `weibull`.
fn read_heights(table: &Entries<'_>) -> Read<Option<HeightDistribution>> {
    let shape = table.optional("weibull", Entry::positive_number)?;
    Ok(shape.map(|shape| HeightDistribution::Weibull { shape }))
}

fn read_self_affine(table: &Entries<'_>, system: System) -> Read<SelfAffine> {
    let length = |key: &'static str| table.optional(key, |e| e.positive(Dimension::LENGTH, system));
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
    let roll_off = length("roll_off_wavelength")?;
    if let (Some(entry), Some(long), Some(short)) = (table.entry("roll_off_wavelength"), roll_off, short)
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

fn within(entry: &Entry<'_>, value: f64, low: f64, high: f64) -> Read<f64> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(entry
            .diagnostic(format!("{value} is outside [{low}, {high}]"))
            .with_help("D_f = 3 - H lies in [2, 3], H in [0, 1]"))
    }
}

/// How the parameters of a body are read.
type ReadBody = fn(&Entries<'_>, Size, System) -> Read<Surface>;

const BODIES: [(&str, ReadBody); 7] = [
    ("sphere", |table, size, system| Ok(Surface::Sphere { radius: length(table, "radius", system)?, size })),
    ("cone", |table, size, _| {
        Ok(Surface::Cone { slope: table.require("slope", "0.1")?.positive_number()?, size })
    }),
    ("power_law", |table, size, system| {
        // Two lengths instead of a coefficient whose unit depends on the exponent.
        let exponent = table.require("exponent", "4")?.positive_number()?;
        let (depth, radius) = (length(table, "depth", system)?, length(table, "radius", system)?);
        Ok(Surface::PowerLaw { coefficient: depth / radius.powf(exponent), exponent, size })
    }),
    ("flat_circle", |table, size, system| {
        Ok(Surface::FlatCircle { radius: length(table, "radius", system)?, size })
    }),
    ("flat", |_, size, _| Ok(Surface::Flat { size })),
    ("flat_square", |_, size, _| Ok(Surface::Flat { size })),
    ("sine", |table, size, system| {
        let (amplitude, wavelength) =
            (length(table, "amplitude", system)?, length(table, "wavelength", system)?);
        Ok(Surface::Sine { amplitude, wavelength, size })
    }),
];

fn length(table: &Entries<'_>, key: &'static str, system: System) -> Read<f64> {
    table.require(key, "\"1 mm\"")?.positive(Dimension::LENGTH, system)
}

/// A body; on a rough surface it has that surface's size.
fn read_body(table: &Entries<'_>, given: Option<Size>, system: System) -> Read<Surface> {
    let read = table.require("kind", "\"sphere\"")?.choice(&BODIES)?;
    let size = match (given, table.one_of(&["side", "size"])?) {
        (Some(_), Some((key, entry))) => {
            return Err(entry
                .diagnostic_at_key(format!("`{key}` is given for the body, which has that of the surface"))
                .with_help("remove it in [scene.body]: the area is that of [scene.surface]"));
        }
        (Some(size), None) => size,
        (None, _) => read_size(table, system)?,
    };
    let surface = read(table, size, system)?;
    table.known_only()?;
    Ok(surface)
}
