//! What a scene reads off the interface: leakage, percolation and the stress below the surface.

use crate::scenes::read::key::Key;
use crate::scenes::read::{
    Diagnostic, Entry, Numerics, Places, ReadResult, RequestedOutputs, SceneFile, System, printed,
};
use contact_model::{Body, Friction, InterfaceOutput, Output};
use interface::FlowAxis;
use interface::stress::LoadedBody;
use surface_io::Dimension;

/// What is read off the interface of each state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RequestedInterface {
    /// Flow of a fluid between opposite edges.
    pub leakage: Option<RequestedLeakage>,
    /// Paths between opposite edges.
    pub percolation: bool,
    /// The largest stress below the surface.
    pub stress_below: Option<RequestedStress>,
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
}

impl RequestedInterface {
    /// What it names.
    pub fn outputs(&self) -> Vec<InterfaceOutput> {
        let is_requested = |output: &InterfaceOutput| match output {
            InterfaceOutput::Leakage => self.leakage.is_some(),
            InterfaceOutput::Percolation => self.percolation,
            InterfaceOutput::StressBelow => self.stress_below.is_some(),
            InterfaceOutput::YieldStress => {
                self.stress_below.as_ref().is_some_and(|stress| stress.yield_stress.is_some())
            }
        };
        InterfaceOutput::ALL.into_iter().filter(is_requested).collect()
    }

    /// Whether it needs the gap of each cell.
    pub(crate) fn needs_gap(&self) -> bool {
        self.leakage.is_some() || self.percolation
    }
}

const AXES: [(&str, FlowAxis); 2] = [("x", FlowAxis::X), ("y", FlowAxis::Y)];
const BODIES: [(&str, LoadedBody); 2] = [("first", LoadedBody::First), ("second", LoadedBody::Second)];

fn word_of<T: PartialEq + Copy>(words: &[(&'static str, T)], value: T) -> String {
    printed::text(words.iter().find(|(_, known)| *known == value).map_or("", |(word, _)| word))
}

pub(crate) const LEAKAGE: Key<RequestedOutputs> = Key {
    name: "leakage",
    takes: "table",
    about: "flow of an incompressible fluid through the gap between opposite edges, with proven bounds: `{ viscosity = \"1 mPa s\", \
            pressure_drop = \"1 bar\", along = \"x\" }`; the contact is impermeable, and so are the sides of a map that does not repeat \
            across the flow",
    default: "none",
    read: |requested, entry, context| {
        requested.interface.leakage = Some(read_leakage(entry, context.system)?);
        Ok(())
    },
    print: |requested, system| {
        requested.interface.leakage.map(|RequestedLeakage { viscosity, pressure_drop, along }| {
            let viscosity = printed::quantity(viscosity, Dimension::VISCOSITY, system);
            let pressure_drop = printed::quantity(pressure_drop, Dimension::PRESSURE, system);
            let along = word_of(&AXES, along);
            format!("{{ viscosity = {viscosity}, pressure_drop = {pressure_drop}, along = {along} }}")
        })
    },
};

pub(crate) const PERCOLATION: Key<RequestedOutputs> = Key {
    name: "percolation",
    takes: "`true` or `false`",
    about: "whether cells with a gap, and cells in contact, lead between opposite edges along x and along y, and the critical \
            constriction, the narrowest cell of the widest path",
    default: "`false`",
    read: |requested, entry, _| entry.flag().map(|asked| requested.interface.percolation = asked),
    print: |requested, _| requested.interface.percolation.then(|| "true".to_owned()),
};

pub(crate) const STRESS_BELOW: Key<RequestedOutputs> = Key {
    name: "stress_below",
    takes: "table",
    about: "the largest equivalent stress of von Mises below the surface, and its place: `{ depths = [\"1 um\", \"2 um\", \"5 um\"], \
            yield_stress = \"1 GPa\", body = \"second\" }`. The depth is refined between the neighbours of the best of `depths`. With \
            `yield_stress` there is the factor on all tractions until yield. `body` is needed where two elastic bodies differ",
    default: "none",
    read: |requested, entry, context| {
        requested.interface.stress_below = Some(read_stress(entry, context.system)?);
        Ok(())
    },
    print: |requested, system| {
        requested.interface.stress_below.as_ref().map(|RequestedStress { depths, yield_stress, body }| {
            let depths = depths.iter().map(|depth| printed::quantity(*depth, Dimension::LENGTH, system));
            let mut parts = vec![format!("depths = [{}]", depths.collect::<Vec<_>>().join(", "))];
            parts.extend(yield_stress.map(|stress| {
                format!("yield_stress = {}", printed::quantity(stress, Dimension::PRESSURE, system))
            }));
            parts.extend(body.map(|body| format!("body = {}", word_of(&BODIES, body))));
            format!("{{ {} }}", parts.join(", "))
        })
    },
};

fn read_leakage(entry: &Entry<'_>, system: System) -> ReadResult<RequestedLeakage> {
    let table = entry.table()?;
    let viscosity = table.require("viscosity", "\"1 mPa s\"")?.positive(Dimension::VISCOSITY, system)?;
    let pressure_drop = table.require("pressure_drop", "\"1 bar\"")?.positive(Dimension::PRESSURE, system)?;
    let along = table.require("along", "\"x\"")?.choice(&AXES)?;
    table.finish()?;
    Ok(RequestedLeakage { viscosity, pressure_drop, along })
}

fn read_stress(entry: &Entry<'_>, system: System) -> ReadResult<RequestedStress> {
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
    table.finish()?;
    Ok(RequestedStress { depths, yield_stress, body })
}

/// The body whose stress is computed, and its Poisson's ratio.
pub(crate) fn stressed_body(scene: &SceneFile) -> Result<(LoadedBody, f64), Diagnostic> {
    let Some(pair) = scene.pair else {
        return Err(Diagnostic::new(
            "the stress below the surface depends on Poisson's ratio, which the scene does not give",
        )
        .with_help("name the `bodies` instead of `contact_modulus`"));
    };
    let asked = scene.requested.interface.stress_below.as_ref().and_then(|stress| stress.body);
    let ratio = |body: Body| match body {
        Body::Elastic { poisson, .. } => Some(poisson),
        _ => None,
    };
    let (first, second) = (ratio(pair.first), ratio(pair.second));
    let same = first.map(f64::to_bits) == second.map(f64::to_bits) && scene.effects.friction == Friction::Off;
    let body = match (asked, first, second) {
        (Some(body), ..) => body,
        (None, None, Some(_)) => LoadedBody::Second,
        (None, Some(_), None) => LoadedBody::First,
        (None, ..) if same => LoadedBody::First,
        (None, ..) => {
            let message = "two elastic bodies, and `stress_below` does not say in which of them";
            return Err(Diagnostic::new(message).with_help("add `body = \"first\"` or `body = \"second\"`"));
        }
    };
    let ratio = if body == LoadedBody::First { first } else { second };
    ratio.map(|poisson| (body, poisson)).ok_or_else(|| {
        Diagnostic::new("the body of `stress_below` is rigid: it has no stress that follows from the contact")
            .with_help("name the elastic one")
    })
}

/// Checks that the interface of the scene has what is requested.
pub(crate) fn check_interface(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let requested = &scene.requested.interface;
    let refused = |key: &str, message: String, help: &str| {
        Err(places.at_key(&format!("outputs.{key}"), message).with_help(help.to_owned()))
    };
    for (output, field) in requested.outputs().into_iter().flat_map(|output| {
        let gap = (output != InterfaceOutput::StressBelow).then_some((output, Output::Gap));
        [Some((output, Output::Pressure)), gap].into_iter().flatten()
    }) {
        let lacks = |numerics: &&Numerics| !numerics.model().abilities().outputs.contains(&field);
        if let Some(numerics) = scene.models.iter().find(lacks) {
            let (key, model, field) = (output.key(), numerics.name(), field.name());
            let message =
                format!("`{key}` needs the {field} of each cell, which the model {model} does not compute");
            return refused(key, message, "boundary elements do: `models = [\"bem3d\"]`");
        }
    }
    let undefined = scene.surface.given_map().map_or(0, |map| map.undefined());
    if requested.leakage.is_some() && undefined > 0 {
        let message = format!("the flow through a map with {undefined} undefined points is not known");
        return refused("leakage", message, "fill them with `fill` in [scene.surface], or crop the map");
    }
    if scene.surface.is_profile() && !requested.outputs().is_empty() {
        let key = requested.outputs()[0].key();
        let message = format!("`{key}` of a profile: it needs a map with several rows");
        return refused(key, message, "remove it, or press a map");
    }
    if requested.stress_below.is_none() {
        return Ok(());
    }
    if scene.effects.layer.is_some() {
        let message = "the stress below the surface of a layer is not known here".to_owned();
        return refused("stress_below", message, "remove `layer` or `stress_below`");
    }
    stressed_body(scene).map(|_| ()).map_err(|wrong| wrong.at(places.key("outputs.stress_below")))
}
