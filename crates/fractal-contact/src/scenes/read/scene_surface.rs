//! The surface of a scene: `[scene.surface]`, and `[scene.body]` added to it.

use crate::scenes::read::asked_surface::{AskedBody, AskedFile, AskedSelfAffine, AskedSurface, BODIES};
use crate::scenes::read::key::missing;
use crate::scenes::read::{
    Diagnostic, Numerics, Places, Question, RandomSpectrum, RandomSurface, ReadResult, System, amount,
    describe_self_affine, describe_sides, map_key, sampled, scan,
};
use contact_model::{Amplitude, Cells, Error, HeightMap, Result, SelfAffine, Size, Surface};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use surface_gen::{Anisotropy, HeightDistribution, WaveGenerator};
use surface_statistics::FilledPoints;

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

/// The surface of a question, read and drawn.
pub(crate) struct FoundSurface {
    pub surface: SceneSurface,
    /// The smooth body whose heights are part of those of a map.
    pub added_body: Option<Surface>,
    /// Metadata of its file.
    pub metadata: Option<String>,
    /// The distance from which on the tips of its instruments resolve heights.
    pub reliable_from: Option<f64>,
    /// Points of its map that were filled, where some were.
    pub filled: Option<FilledPoints>,
    /// Remarks on the keys.
    pub notes: Vec<Diagnostic>,
}

impl FoundSurface {
    /// The surface of a file.
    fn of_file(
        surface: SceneSurface,
        metadata: String,
        reliable_from: Option<f64>,
        notes: Vec<Diagnostic>,
    ) -> Self {
        Self { metadata: Some(metadata), reliable_from, notes, ..surface.into() }
    }
}

impl From<SceneSurface> for FoundSurface {
    fn from(surface: SceneSurface) -> Self {
        Self {
            surface,
            added_body: None,
            metadata: None,
            reliable_from: None,
            filled: None,
            notes: Vec::new(),
        }
    }
}

/// The surface that a question asks for; files are looked up from `directory`.
pub(crate) fn find_surface(
    question: &Question,
    directory: &Path,
    places: &Places,
) -> ReadResult<FoundSurface> {
    let Some(surface) = &question.surface else {
        let Some(body) = &question.body else {
            return Err(places
                .at_key("scene", "nothing is pressed: there is neither [scene.surface] nor [scene.body]")
                .with_help(
                    "describe one: [scene.surface] with `kind = \"self_affine\"` or \"file\", or [scene.body] with `kind = \"sphere\"`",
                ));
        };
        return Ok(SceneSurface::Plain(body_of(body, None, places)?).into());
    };
    let asked = match surface {
        AskedSurface::File(file) => return find_map(question, file, directory, places),
        AskedSurface::SelfAffine(asked) => asked,
    };
    let rough = self_affine(asked, places)?;
    let (anisotropy, heights) = (anisotropy(asked, places)?, asked.weibull);
    let heights = heights.map(|shape| HeightDistribution::Weibull { shape });
    let body = question.body.as_ref().map(|body| body_of(body, Some(rough.size), places)).transpose()?;
    if anisotropy.is_none() && heights.is_none() && body.is_none() {
        return Ok(SceneSurface::Plain(Surface::SelfAffine(rough)).into());
    }
    let spectrum = RandomSpectrum::SelfAffine { surface: rough, anisotropy };
    Ok(SceneSurface::Drawn { rough: RandomSurface::new(spectrum, heights), body }.into())
}

/// The map of a file, with the surface of the second body and a body added to it, or its twin.
fn find_map(
    question: &Question,
    file: &AskedFile,
    directory: &Path,
    places: &Places,
) -> ReadResult<FoundSurface> {
    const TWIN: &str = "scene.surface.twin";
    let (system, second) = (question.units, question.second_surface.as_ref());
    if file.keep_heights.is_some() && file.twin.is_none() {
        return Err(places
            .at_key("scene.surface.keep_heights", "`keep_heights` is given, but no `twin`")
            .with_help("add `twin = \"waves\"`, or remove it: the map itself has its heights"));
    }
    if file.twin.is_some() && second.is_some() {
        return Err(places
            .at_key(TWIN, "`twin` beside [scene.second_surface]")
            .with_help("draw the twin into a file with `fractal-contact twin`, and read that file here"));
    }
    let scan::FileMap { mut map, mut metadata, mut reliable_from, mut notes, profile, mut holes } =
        scan::read_map(file, "scene.surface", system, directory, places)?;
    if profile {
        refuse_for_profile(question, places)?;
        let plain = SceneSurface::Plain(Surface::Profile(Arc::new(map)));
        return Ok(FoundSurface::of_file(plain, metadata, reliable_from, notes));
    }
    if let Some(second) = second {
        let other = scan::read_second(second, (&map, holes.as_ref()), system, directory, places)?;
        (map, holes) = (other.map, other.holes);
        reliable_from = [reliable_from, other.reliable_from].into_iter().flatten().reduce(f64::max);
        metadata += &format!("\nsecond surface\n{}", other.metadata);
        notes.extend(other.notes);
    }
    let body = question.body.as_ref().map(|body| body_of(body, Some(map.size()), places)).transpose()?;
    if let Some(like) = file.twin {
        let of = Arc::new(map);
        // Obstacles to a twin are found before anything is solved.
        WaveGenerator::twin(&of, like).map_err(|e| {
            places.at_value(TWIN, format!("no twin of this map: {e}")).with_help(
                "undefined points need `fill`; a map that is not periodic `detrend` and `window = \"hann\"`",
            )
        })?;
        let keep_heights = file.keep_heights == Some(true);
        let heights = keep_heights.then(|| HeightDistribution::Of(Arc::clone(&of)));
        let rough = RandomSurface::new(RandomSpectrum::Twin { of, like }, heights);
        let surface = SceneSurface::Drawn { rough, body };
        return Ok(FoundSurface::of_file(surface, metadata, reliable_from, notes));
    }
    let map = match &body {
        None => map,
        Some(body) => add(&map, body).map_err(|e| places.at_key("scene", e.to_string()))?,
    };
    let plain = SceneSurface::Plain(Surface::Heights(Arc::new(map)));
    let filled = holes.as_ref().map(FilledPoints::new);
    let found = FoundSurface::of_file(plain, metadata, reliable_from, notes);
    Ok(FoundSurface { added_body: body, filled, ..found })
}

/// Refuses keys that cannot be combined with a profile.
fn refuse_for_profile(question: &Question, places: &Places) -> ReadResult<()> {
    let help = "remove it, or measure an area; a tilt or a bow of the profile goes with `detrend`";
    let twin = matches!(&question.surface, Some(AskedSurface::File(file)) if file.twin.is_some());
    if twin {
        let message = "`twin` of a profile: a twin has the spectrum of a map in all directions";
        return Err(places.at_key("scene.surface.twin", message).with_help(help));
    }
    for (name, given) in
        [("second_surface", question.second_surface.is_some()), ("body", question.body.is_some())]
    {
        if given {
            let message = format!("[scene.{name}] beside a profile, which is a body uniform along y");
            return Err(places.at_key(&format!("scene.{name}"), message).with_help(help));
        }
    }
    Ok(())
}

fn anisotropy(asked: &AskedSelfAffine, places: &Places) -> ReadResult<Option<Anisotropy>> {
    match (asked.anisotropy, asked.lay) {
        (Some(ratio), lay) => Ok(Some(Anisotropy { ratio, lay: lay.unwrap_or(0.0) })),
        (None, None) => Ok(None),
        (None, Some(_)) => {
            let message = "`lay` is given, but no `anisotropy`";
            let help = "add `anisotropy = 4`: waves along the lay are then four times as long as across it";
            Err(places.at_key("scene.surface.lay", message).with_help(help))
        }
    }
}

fn self_affine(asked: &AskedSelfAffine, places: &Places) -> ReadResult<SelfAffine> {
    const TABLE: &str = "scene.surface";
    let size = asked.size.ok_or_else(|| missing(TABLE, "side", "\"1 mm\"", places))?;
    let hurst = asked.hurst.ok_or_else(|| {
        places
            .at_key(TABLE, "`fractal_dimension` is missing in [scene.surface]")
            .with_help("add `fractal_dimension = 2.4`, or `hurst = 0.6`")
    })?;
    let rms = asked.rms_height.ok_or_else(|| missing(TABLE, "rms_height", "\"1 um\"", places))?;
    if let (Some(long), Some(short)) = (asked.roll_off_wavelength, asked.shortest_wavelength)
        && long < short
    {
        let place = "scene.surface.roll_off_wavelength";
        return Err(places
            .at_value(place, "`roll_off_wavelength` is below `shortest_wavelength`")
            .with_help("the roll-off is the longest wave of the fractal range"));
    }
    let wavenumber = |wavelength: f64| 2.0 * PI / wavelength;
    Ok(SelfAffine {
        size,
        hurst,
        amplitude: Amplitude::RmsHeight(rms),
        roll_off: asked.roll_off_wavelength.map(wavenumber),
        short_cutoff: asked.shortest_wavelength.map(wavenumber),
    })
}

/// A body; on a rough surface it has that surface's size.
fn body_of(asked: &AskedBody, given: Option<Size>, places: &Places) -> ReadResult<Surface> {
    const TABLE: &str = "scene.body";
    let kind = asked.kind.ok_or_else(|| missing(TABLE, "kind", "\"sphere\"", places))?;
    let size = match (given, asked.size) {
        (Some(_), Some(_)) => {
            let key = if places.has("scene.body.side") { "side" } else { "size" };
            return Err(places
                .at_key(
                    &format!("scene.body.{key}"),
                    format!("`{key}` is given for the body, which has that of the surface"),
                )
                .with_help("remove it in [scene.body]: the area is that of [scene.surface]"));
        }
        (Some(size), None) | (None, Some(size)) => size,
        (None, None) => return Err(missing(TABLE, "side", "\"1 mm\"", places)),
    };
    let needed = BODIES.iter().find(|(name, _)| *name == kind).map_or(&[][..], |(_, keys)| keys);
    let parameters = [
        ("radius", asked.radius, "\"1 mm\""),
        ("slope", asked.slope, "0.1"),
        ("exponent", asked.exponent, "4"),
        ("depth", asked.depth, "\"1 mm\""),
        ("amplitude", asked.amplitude, "\"1 mm\""),
        ("wavelength", asked.wavelength, "\"1 mm\""),
    ];
    for (key, value, _) in parameters {
        if value.is_some() && !needed.contains(&key) {
            let place = format!("scene.body.{key}");
            let known = needed.join(", ");
            let takes =
                if known.is_empty() { "takes no parameter".to_owned() } else { format!("takes {known}") };
            return Err(places
                .at_key(&place, format!("`{key}` is no key of the body \"{kind}\""))
                .with_help(format!("this body {takes}")));
        }
    }
    let take = |key: &str| {
        let known = parameters.iter().find(|(name, ..)| *name == key);
        let (value, example) = known.map_or((None, ""), |(_, value, example)| (*value, *example));
        value.ok_or_else(|| missing(TABLE, key, example, places))
    };
    Ok(match kind {
        "sphere" => Surface::Sphere { radius: take("radius")?, size },
        "cone" => Surface::Cone { slope: take("slope")?, size },
        "power_law" => {
            // Two lengths instead of a coefficient whose unit depends on the exponent.
            let (exponent, depth, radius) = (take("exponent")?, take("depth")?, take("radius")?);
            Surface::PowerLaw { coefficient: depth / radius.powf(exponent), exponent, size }
        }
        "flat_circle" => Surface::FlatCircle { radius: take("radius")?, size },
        "sine" => Surface::Sine { amplitude: take("amplitude")?, wavelength: take("wavelength")?, size },
        _ => Surface::Flat { size },
    })
}
