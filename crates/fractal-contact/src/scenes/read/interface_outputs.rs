//! The keys of leakage, percolation and the stress below the surface.

use crate::scenes::read::{Diagnostic, Entry, ReadResult, System, printed};
use contact_model::{Body, Cells, Friction, InterfaceOutput, Pair, Size};
use interface::FlowAxis;
use interface::stress::LoadedBody;
use surface_io::Dimension;

/// Leakage, percolation and the stress below the surface, as far as a scene requests them of each state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RequestedInterface {
    /// Flow of a fluid between opposite edges.
    pub leakage: Option<RequestedLeakage>,
    /// Paths between opposite edges.
    pub percolation: bool,
    /// The largest stress below the surface.
    pub stress_below: Option<RequestedStress>,
    /// A film in the gap that conducts.
    pub film: Option<RequestedFilm>,
}

/// A film that fills the gap and conducts as the bodies do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RequestedFilm {
    /// How well it conducts.
    pub material: FilmMaterial,
    /// The axis along which it conducts between opposite edges, where that is requested too.
    pub along: Option<FlowAxis>,
}

/// How well a film conducts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FilmMaterial {
    /// Its electrical resistivity.
    Resistivity(f64),
    /// Its thermal conductivity.
    Conductivity(f64),
}

impl FilmMaterial {
    /// Its resistivity, electrical or thermal.
    pub fn resistivity(self) -> f64 {
        match self {
            Self::Resistivity(resistivity) => resistivity,
            Self::Conductivity(conductivity) => 1.0 / conductivity,
        }
    }
}

/// The fluid whose flow is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RequestedLeakage {
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// Pressure drop between the edges.
    pub pressure_drop: f64,
    /// The axis along which it flows.
    pub along: FlowAxis,
}

/// Where the stress is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct RequestedStress {
    /// Depths below the surface, between which the largest stress is searched for.
    pub depths: Vec<f64>,
    /// Stress at which the body yields.
    pub yield_stress: Option<f64>,
    /// The body; `None` where it does not matter, or where one of them is rigid.
    pub body: Option<LoadedBody>,
    /// The axis of a vertical section; `None` for x.
    pub section: Option<FlowAxis>,
    /// Number of layers of a volume; `None` for [`VOLUME_LAYERS`].
    pub layers: Option<usize>,
}

/// Layers of a volume, where a scene does not say.
pub(crate) const VOLUME_LAYERS: usize = 16;
/// More layers than this are a mistake.
const MOST_LAYERS: usize = 1000;

/// Depths of a vertical section.
pub(crate) const SECTION_DEPTHS: usize = 64;

impl RequestedStress {
    /// The cells and the sides of a vertical section below a map, with the surface in the first row.
    pub(crate) fn section_grid(&self, cells: Cells, size: Size) -> (Cells, Size) {
        let (count, side) = match self.section {
            Some(FlowAxis::Y) => (cells.rows, size.y),
            _ => (cells.columns, size.x),
        };
        (Cells { columns: count, rows: SECTION_DEPTHS }, Size { x: side, y: self.deepest() })
    }

    /// Number of layers of a volume, and the thickness of each.
    pub(crate) fn layers(&self) -> (usize, f64) {
        let count = self.layers.unwrap_or(VOLUME_LAYERS);
        (count, self.deepest() / count as f64)
    }

    fn deepest(&self) -> f64 {
        self.depths.iter().copied().fold(0.0, f64::max)
    }
}

impl RequestedInterface {
    /// All results that are requested.
    pub fn outputs(&self) -> Vec<InterfaceOutput> {
        let is_requested = |output: &InterfaceOutput| match output {
            InterfaceOutput::Leakage => self.leakage.is_some(),
            InterfaceOutput::Percolation => self.percolation,
            InterfaceOutput::StressBelow => self.stress_below.is_some(),
            InterfaceOutput::Gap => self.leakage.is_some() || self.percolation,
            InterfaceOutput::Film => self.film.is_some(),
            InterfaceOutput::FilmAlong => self.film.is_some_and(|film| film.along.is_some()),
            InterfaceOutput::YieldStress => {
                self.stress_below.as_ref().is_some_and(|stress| stress.yield_stress.is_some())
            }
        };
        InterfaceOutput::ALL.into_iter().filter(is_requested).collect()
    }

    /// Whether it needs the gap of each cell.
    pub(crate) fn needs_gap(&self) -> bool {
        self.leakage.is_some() || self.percolation || self.film.is_some()
    }
}

const AXES: [(&str, FlowAxis); 2] = [("x", FlowAxis::X), ("y", FlowAxis::Y)];
const BODIES: [(&str, LoadedBody); 2] = [("first", LoadedBody::First), ("second", LoadedBody::Second)];

fn word_of<T: PartialEq + Copy>(words: &[(&'static str, T)], value: T) -> String {
    printed::text(words.iter().find(|(_, known)| *known == value).map_or("", |(word, _)| word))
}

pub(crate) fn print_leakage(leakage: &RequestedLeakage, system: System) -> String {
    let RequestedLeakage { viscosity, pressure_drop, along } = *leakage;
    let viscosity = printed::quantity(viscosity, Dimension::VISCOSITY, system);
    let pressure_drop = printed::quantity(pressure_drop, Dimension::PRESSURE, system);
    let along = word_of(&AXES, along);
    format!("{{ viscosity = {viscosity}, pressure_drop = {pressure_drop}, along = {along} }}")
}

pub(crate) fn print_stress(stress: &RequestedStress, system: System) -> String {
    let RequestedStress { depths, yield_stress, body, section, layers } = stress;
    let depths = depths.iter().map(|depth| printed::quantity(*depth, Dimension::LENGTH, system));
    let mut parts = vec![format!("depths = [{}]", depths.collect::<Vec<_>>().join(", "))];
    parts.extend(
        yield_stress.map(|stress| {
            format!("yield_stress = {}", printed::quantity(stress, Dimension::PRESSURE, system))
        }),
    );
    parts.extend(body.map(|body| format!("body = {}", word_of(&BODIES, body))));
    parts.extend(section.map(|axis| format!("section = {}", word_of(&AXES, axis))));
    parts.extend(layers.map(|layers| format!("layers = {layers}")));
    format!("{{ {} }}", parts.join(", "))
}

pub(crate) fn read_leakage(entry: &Entry<'_>, system: System) -> ReadResult<RequestedLeakage> {
    let table = entry.table()?;
    let viscosity = table.require("viscosity", "\"1 mPa s\"")?.positive(Dimension::VISCOSITY, system)?;
    let pressure_drop = table.require("pressure_drop", "\"1 bar\"")?.positive(Dimension::PRESSURE, system)?;
    let along = table.require("along", "\"x\"")?.choice(&AXES)?;
    table.finish()?;
    Ok(RequestedLeakage { viscosity, pressure_drop, along })
}

pub(crate) fn print_film(film: &RequestedFilm, system: System) -> String {
    let RequestedFilm { material, along } = *film;
    let material = match material {
        FilmMaterial::Resistivity(value) => {
            format!("resistivity = {}", printed::quantity(value, Dimension::RESISTIVITY, system))
        }
        FilmMaterial::Conductivity(value) => {
            format!("conductivity = {}", printed::quantity(value, Dimension::THERMAL_CONDUCTIVITY, system))
        }
    };
    let along = along.map_or_else(String::new, |along| format!(", along = {}", word_of(&AXES, along)));
    format!("{{ {material}{along} }}")
}

pub(crate) fn read_film(entry: &Entry<'_>, system: System) -> ReadResult<RequestedFilm> {
    let table = entry.table()?;
    let material = if let Some(heat) = table.find("conductivity") {
        FilmMaterial::Conductivity(heat.positive(Dimension::THERMAL_CONDUCTIVITY, system)?)
    } else {
        let electrical = table.require("resistivity", "\"0.2 Ohm m\"")?;
        FilmMaterial::Resistivity(electrical.positive(Dimension::RESISTIVITY, system)?)
    };
    let along = table.find("along").map(|along| along.choice(&AXES)).transpose()?;
    table.finish()?;
    Ok(RequestedFilm { material, along })
}

pub(crate) fn read_stress(entry: &Entry<'_>, system: System) -> ReadResult<RequestedStress> {
    let table = entry.table()?;
    let of = table.require("depths", "[\"1 um\", \"2 um\", \"5 um\"]")?;
    let depths: Vec<f64> = of
        .list()
        .iter()
        .map(|depth| depth.not_negative(Dimension::LENGTH, system))
        .collect::<ReadResult<_>>()?;
    if depths.is_empty() {
        return Err(of.diagnostic("`depths` is empty").with_help("at least one depth below the surface"));
    }
    let yield_stress =
        table.find("yield_stress").map(|stress| stress.positive(Dimension::PRESSURE, system)).transpose()?;
    let body = table.find("body").map(|body| body.choice(&BODIES)).transpose()?;
    let section = table.find("section").map(|axis| axis.choice(&AXES)).transpose()?;
    let layers = table.find("layers").map(|layers| read_layers(&layers)).transpose()?;
    table.finish()?;
    Ok(RequestedStress { depths, yield_stress, body, section, layers })
}

fn read_layers(entry: &Entry<'_>) -> ReadResult<usize> {
    let count = entry.size(1)?;
    if count > MOST_LAYERS {
        let help = format!("a whole number from 1 to {MOST_LAYERS}");
        return Err(entry.diagnostic(format!("a volume of {count} layers")).with_help(help));
    }
    Ok(count)
}

impl RequestedStress {
    /// The body whose stress is computed, and its Poisson's ratio.
    ///
    /// # Errors
    /// Where Poisson's ratio is not known, or it is not said which of two bodies is meant.
    pub(crate) fn of_body(&self, pair: Option<Pair>, friction: Friction) -> ReadResult<(LoadedBody, f64)> {
        let Some(pair) = pair else {
            let message =
                "the stress below the surface depends on Poisson's ratio, which the scene does not give";
            return Err(Diagnostic::new(message).with_help("name the `bodies` instead of `contact_modulus`"));
        };
        let ratio = |body: Body| match body {
            Body::Elastic { poisson, .. } => Some(poisson),
            _ => None,
        };
        let (first, second) = (ratio(pair.first), ratio(pair.second));
        let same = first.map(f64::to_bits) == second.map(f64::to_bits) && friction == Friction::Off;
        let body = match (self.body, first, second) {
            (Some(body), ..) => body,
            (None, None, Some(_)) => LoadedBody::Second,
            (None, Some(_), None) => LoadedBody::First,
            (None, ..) if same => LoadedBody::First,
            (None, ..) => {
                let message = "two elastic bodies, and `stress_below` does not say in which of them";
                return Err(
                    Diagnostic::new(message).with_help("add `body = \"first\"` or `body = \"second\"`")
                );
            }
        };
        let ratio = if body == LoadedBody::First { first } else { second };
        ratio.map(|poisson| (body, poisson)).ok_or_else(|| {
            let message =
                "the body of `stress_below` is rigid: it has no stress that follows from the contact";
            Diagnostic::new(message).with_help("name the elastic one")
        })
    }
}
