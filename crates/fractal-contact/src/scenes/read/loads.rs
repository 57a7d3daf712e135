//! The prescribed loads: independent loads, or a path.

use crate::scenes::read::{Entries, Entry, Read, System};
use contact_model::{Load, Normalisation, Size, Step, Tangential};
use surface_io::Dimension;

/// Largest number of loads of a range; more are taken for a typing error.
const MOST: u64 = 10_000;

/// What a list of loads prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadKind {
    /// Normal force F.
    Force,
    /// F over E* h L, with the measured rms height of each surface.
    ForceBar,
    /// Force over the nominal contact area Lx Ly, undefined points included.
    MeanPressure,
    /// Approach.
    Approach,
    /// Mean gap, with periodic boundaries.
    MeanGap,
}

impl LoadKind {
    const ALL: [Self; 5] = [Self::Force, Self::ForceBar, Self::MeanPressure, Self::Approach, Self::MeanGap];

    /// Its key in the file, its dimension and unit in SI, and its description in tables.
    fn record(self) -> (&'static str, Dimension, &'static str, &'static str) {
        match self {
            Self::Force => ("force", Dimension::FORCE, "N", "force"),
            Self::ForceBar => {
                let meaning = "F_bar = F/(E* h L) with this surface's measured rms height h, L = sqrt(Lx Ly)";
                ("force_bar", Dimension::NONE, "1", meaning)
            }
            Self::MeanPressure => {
                let meaning = "mean pressure, F/(Lx Ly), undefined points included";
                ("mean_pressure", Dimension::PRESSURE, "Pa", meaning)
            }
            Self::Approach => ("approach", Dimension::LENGTH, "m", "approach"),
            Self::MeanGap => ("mean_gap", Dimension::LENGTH, "m", "mean gap"),
        }
    }

    /// Its key in the file.
    pub fn key(self) -> &'static str {
        self.record().0
    }

    /// Its unit in SI.
    pub(crate) fn unit(self) -> &'static str {
        self.record().2
    }

    /// A description in a phrase.
    pub(crate) fn meaning(self) -> &'static str {
        self.record().3
    }
}

/// Loads, solved one by one in this order.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadList {
    /// The quantity that is prescribed.
    pub kind: LoadKind,
    /// The numbers, in SI or the scene's own units.
    pub values: Vec<f64>,
}

impl LoadList {
    /// The load of a number for a surface with this normalisation.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for a normalised force of a surface without rms height.
    pub fn load(&self, value: f64, normalisation: &Normalisation) -> contact_model::Result<Load> {
        Ok(match self.kind {
            LoadKind::Force => Load::Force(value),
            LoadKind::ForceBar => Load::Force(normalisation.force(value)?),
            LoadKind::MeanPressure => Load::Force(value * normalisation.length * normalisation.length),
            LoadKind::Approach => Load::Approach(value),
            LoadKind::MeanGap => Load::MeanGap(value),
        })
    }
}

/// The states that the models compute.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadRequest {
    /// States under loads.
    Loads(LoadList),
    /// States along a path.
    Path(Vec<Step>),
}

impl LoadRequest {
    /// Number of states.
    pub fn count(&self) -> usize {
        match self {
            Self::Loads(loads) => loads.values.len(),
            Self::Path(steps) => steps.len(),
        }
    }

    /// The number that the load of a state prescribes; `None` along a path.
    pub(crate) fn prescribed(&self, state: usize) -> Option<f64> {
        match self {
            Self::Loads(loads) => loads.values.get(state).copied(),
            Self::Path(_) => None,
        }
    }

    /// Whether tangential loads along x, and along y, are prescribed.
    pub(crate) fn shears(&self) -> [bool; 2] {
        let steps = match self {
            Self::Loads(_) => &[][..],
            Self::Path(steps) => steps,
        };
        [0, 1].map(|along| steps.iter().any(|step| step.tangential.components()[along].abs() > 0.0))
    }

    /// Whether an approach or a mean gap may be prescribed, so that the force is a result with an error.
    pub(crate) fn prescribes_distance(&self) -> bool {
        match self {
            Self::Loads(loads) => matches!(loads.kind, LoadKind::Approach | LoadKind::MeanGap),
            Self::Path(steps) => {
                steps.iter().any(|step| matches!(step.normal, Load::Approach(_) | Load::MeanGap(_)))
            }
        }
    }
}

/// Reads the loads or the path of `[scene]`. `pulls` allows negative loads (adhesion). `size` is that of the
/// nominal contact area, for mean pressures along a path.
pub(crate) fn read_request<'a>(
    scene: &Entries<'a>,
    system: System,
    pulls: bool,
    size: Size,
) -> Read<(LoadRequest, Entry<'a>)> {
    let keys = LoadKind::ALL.map(LoadKind::key);
    let loads = scene.one_of(&keys)?;
    let path = scene.find("path");
    match (loads, path) {
        (Some((key, _)), Some(path)) => Err(path
            .diagnostic_at_key(format!("`{key}` and `path` are both given in [scene]"))
            .with_help(format!("loads one by one are `{key}`; a history (friction, rheology, indentation, adhesion) is `path`: keep one of them"))),
        (None, None) => Err(scene.misspelt_or(&keys, scene
            .diagnostic("nothing is pressed: [scene] has no load")
            .with_help("add `force = \"1 N\"`, `approach = [...]`, `force_bar = { from = 1e-4, to = 1, count = 9 }`, or [[scene.path]] for a history"))),
        (Some((key, entry)), None) => {
            let kind = LoadKind::ALL.into_iter().find(|kind| kind.key() == key).unwrap_or(LoadKind::Force);
            Ok((LoadRequest::Loads(read_loads(kind, &entry, system, pulls)?), entry))
        }
        (None, Some(entry)) => Ok((LoadRequest::Path(read_path(&entry, system, pulls, size)?), entry)),
    }
}

fn read_loads(kind: LoadKind, entry: &Entry<'_>, system: System, pulls: bool) -> Read<LoadList> {
    let (key, dimension, ..) = kind.record();
    let signed = pulls && matches!(kind, LoadKind::Force | LoadKind::Approach);
    let number = |item: &Entry<'_>| {
        let value = match dimension {
            Dimension::NONE => item.number()?,
            dimension => item.quantity(dimension, system)?,
        };
        if value >= 0.0 || signed {
            return Ok(value);
        }
        let help = "press with a value >= 0; only adhesion (`adhesion` in [effects]) holds against a pull";
        Err(item.diagnostic(format!("the load `{key}` = {} is negative", item.shown())).with_help(help))
    };
    let values = if entry.is_table() {
        let range = entry.table()?;
        let from = range.require("from", "...")?;
        let to = range.require("to", "...")?;
        let count = range.require("count", "9")?;
        let mut even = false;
        range.set(&mut even, "spacing", |e| e.choice(&[("log", false), ("linear", true)]))?;
        range.finish()?;
        let number_of = count.count(2)?;
        if number_of > MOST {
            return Err(count
                .diagnostic(format!("{number_of} loads: expected at most {MOST}"))
                .with_help("ask for fewer"));
        }
        let (low, high) = (number(&from)?, number(&to)?);
        if !even && (low <= 0.0 || high <= 0.0) {
            return Err(from
                .diagnostic(format!(
                    "a logarithmic range of `{key}` from {} to {} meets zero",
                    from.shown(),
                    to.shown()
                ))
                .with_help("both ends > 0, or `spacing = \"linear\"`"));
        }
        between(low, high, number_of as usize, even)
    } else {
        entry.list().iter().map(number).collect::<Read<Vec<f64>>>()?
    };
    if values.is_empty() {
        return Err(entry
            .diagnostic(format!("`{key}` is an empty list"))
            .with_help("name at least one load"));
    }
    Ok(LoadList { kind, values })
}

/// `count` >= 2 numbers with both ends exactly as given.
fn between(low: f64, high: f64, count: usize, even: bool) -> Vec<f64> {
    let last = count - 1;
    let at = |i: usize| {
        let t = i as f64 / last as f64;
        match i {
            0 => low,
            i if i == last => high,
            // So that a range through 0 meets it exactly.
            _ if even => (low * (last - i) as f64 + high * i as f64) / last as f64,
            _ => (low.ln() + (high.ln() - low.ln()) * t).exp(),
        }
    };
    (0..count).map(at).collect()
}

/// A tangential load: one number along x, or a pair along x and along y.
fn read_tangential(entry: &Entry<'_>, dimension: Dimension, system: System) -> Read<[f64; 2]> {
    let component = |item: &Entry<'_>| item.quantity(dimension, system);
    match &entry.list()[..] {
        [x, y] => Ok([component(x)?, component(y)?]),
        [x] if !entry.is_list() => Ok([component(x)?, 0.0]),
        components => {
            let example = match (system, dimension) {
                (System::None, _) => "[25, 10]",
                (System::Si, Dimension::LENGTH) => "[\"2 um\", \"1 um\"]",
                (System::Si, _) => "[\"25 N\", \"10 N\"]",
            };
            let message = format!("a tangential load of {} components", components.len());
            let help = format!("give one value along x, or a pair along x and along y, such as {example}");
            Err(entry.diagnostic(message).with_help(help))
        }
    }
}

fn read_path(entry: &Entry<'_>, system: System, pulls: bool, size: Size) -> Read<Vec<Step>> {
    if !entry.is_list() {
        return Err(entry
            .diagnostic_at_key("`path` is no list of steps")
            .with_help("write [[scene.path]] once for each step"));
    }
    let mut steps: Vec<Step> = Vec::new();
    let mut last = Step::normal(0.0, Load::Force(0.0));
    for item in entry.list() {
        let table = item.table()?;
        let mut time = last.time;
        table.set(&mut time, "time", |e| e.quantity(Dimension::TIME, system))?;
        let normal = match table.one_of(&["force", "approach", "mean_pressure", "mean_gap"])? {
            Some(("force", e)) => Load::Force(e.quantity(Dimension::FORCE, system)?),
            // The mean pressure times the nominal contact area, as for a list of mean pressures.
            Some(("mean_pressure", e)) => {
                Load::Force(e.quantity(Dimension::PRESSURE, system)? * size.length() * size.length())
            }
            Some(("mean_gap", e)) => Load::MeanGap(e.quantity(Dimension::LENGTH, system)?),
            Some((_, e)) => Load::Approach(e.quantity(Dimension::LENGTH, system)?),
            None if steps.is_empty() => {
                return Err(item
                    .diagnostic("the first step of the path has no normal load")
                    .with_help("give `force`, `mean_pressure`, `approach` or (periodic) `mean_gap`"));
            }
            None => last.normal,
        };
        let tangential = match table.one_of(&["tangential_force", "tangential_displacement"])? {
            Some(("tangential_force", e)) => {
                Tangential::Force(read_tangential(&e, Dimension::FORCE, system)?)
            }
            Some((_, e)) => Tangential::Displacement(read_tangential(&e, Dimension::LENGTH, system)?),
            None => last.tangential,
        };
        if steps.is_empty() {
            last = beginning(normal, tangential);
        } else if steps.iter().all(|step| step.tangential == Tangential::default()) {
            // At the beginning neither a displacement nor a force is applied, whichever of them is prescribed
            // now.
            last.tangential = unloaded(tangential);
        }
        let states = table.find("states");
        let count = states.as_ref().map_or(Ok(1), |e| e.count(1))?;
        if let Some(entry) = states
            && count.saturating_add(steps.len() as u64) > MOST
        {
            return Err(entry
                .diagnostic(format!("{count} states: expected at most {MOST} along the whole path"))
                .with_help(
                    "states in between are increments of friction, and otherwise only shown: request fewer",
                ));
        }
        table.finish()?;
        let end = Step { time, normal, tangential };
        let checked = if pulls { end.validated_with_adhesion(last.time) } else { end.validated(last.time) };
        checked.map_err(|e| {
            let help = match &e {
                contact_model::Error::Domain { name, .. } if name == "time" => "times never decrease along a path",
                _ if pulls => "loads are finite numbers",
                _ => "loads are finite, and normal loads at least 0: only `adhesion` in [effects] lets a contact pull",
            };
            item.diagnostic(e.to_string()).with_help(help)
        })?;
        for i in 1..=count {
            steps.push(if i == count { end } else { part(last, end, i as f64 / count as f64) });
        }
        last = end;
    }
    if steps.is_empty() {
        return Err(entry
            .diagnostic("the path has no step")
            .with_help("write [[scene.path]] once for each step"));
    }
    Ok(steps)
}

/// The state without contact and load, with the quantities that the first step prescribes.
fn beginning(normal: Load, tangential: Tangential) -> Step {
    let normal = match normal {
        Load::Approach(_) => Load::Approach(0.0),
        // The distance at first touch is not known here.
        Load::MeanGap(gap) => Load::MeanGap(gap),
        _ => Load::Force(0.0),
    };
    Step { time: 0.0, normal, tangential: unloaded(tangential) }
}

/// Zero of the prescribed tangential quantity.
fn unloaded(tangential: Tangential) -> Tangential {
    match tangential {
        Tangential::Displacement(_) => Tangential::Displacement([0.0; 2]),
        _ => Tangential::default(),
    }
}

/// A point of a straight piece; a quantity that is prescribed anew begins at its new value.
fn part(from: Step, to: Step, t: f64) -> Step {
    let mix = |a: f64, b: f64| a + (b - a) * t;
    let both = |a: [f64; 2], b: [f64; 2]| [mix(a[0], b[0]), mix(a[1], b[1])];
    let normal = match (from.normal, to.normal) {
        (Load::Force(a), Load::Force(b)) => Load::Force(mix(a, b)),
        (Load::Approach(a), Load::Approach(b)) => Load::Approach(mix(a, b)),
        (Load::MeanGap(a), Load::MeanGap(b)) => Load::MeanGap(mix(a, b)),
        (_, other) => other,
    };
    let tangential = match (from.tangential, to.tangential) {
        (Tangential::Force(a), Tangential::Force(b)) => Tangential::Force(both(a, b)),
        (Tangential::Displacement(a), Tangential::Displacement(b)) => Tangential::Displacement(both(a, b)),
        (_, other) => other,
    };
    Step { time: mix(from.time, to.time), normal, tangential }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_their_ends_exactly() {
        let values = between(1e-6, 20.0, 5, false);
        assert_eq!((values[0], values[4]), (1e-6, 20.0));
        approx::assert_relative_eq!(values[1] / values[0], 2e7_f64.powf(0.25), max_relative = 1e-12);
        assert_eq!(between(1.0, -1.0, 3, true), [1.0, 0.0, -1.0]);
    }

    fn path(text: &str) -> Read<Vec<Step>> {
        let size = Size { x: 4.0, y: 1.0 };
        Entries::of_text("scene", text, |scene| {
            read_path(&scene.require("path", "")?, System::None, false, size)
        })
    }

    #[test]
    fn tangential_loads_have_two_components_and_every_part_mixes_both() {
        let steps = path(
            "[[path]]\nmean_pressure = 3\n[[path]]\ntangential_force = [2, -4]\nstates = 2\n[[path]]\ntangential_force = 1\n\
             [[path]]\ntangential_displacement = [0.5, 0.25]",
        )
        .unwrap();
        let tangential: Vec<Tangential> = steps.iter().map(|step| step.tangential).collect();
        let forces = [[0.0, 0.0], [1.0, -2.0], [2.0, -4.0], [1.0, 0.0]].map(Tangential::Force);
        assert_eq!(tangential[..4], forces);
        assert_eq!(tangential[4], Tangential::Displacement([0.5, 0.25]));
        // The mean pressure of a path is the force over the nominal area, and stays as it was.
        assert!(steps.iter().all(|step| step.normal == Load::Force(12.0)));
        assert_eq!(LoadRequest::Path(steps).shears(), [true, true]);
        let pushed =
            path("[[path]]\nforce = 1\n[[path]]\ntangential_displacement = [2, 4]\nstates = 2").unwrap();
        assert_eq!(pushed[0].tangential, Tangential::default());
        assert_eq!(pushed[1].tangential, Tangential::Displacement([1.0, 2.0]));
        let along_x = path("[[path]]\nmean_gap = 1\ntangential_displacement = 2").unwrap();
        assert_eq!(along_x[0].normal, Load::MeanGap(1.0));
        assert_eq!(LoadRequest::Path(along_x).shears(), [true, false]);
        for wrong in ["[]", "[1]", "[1, 2, 3]", "[1, \"2 N\"]", "[1, nan]", "\"1 N\"", "{ x = 1 }"] {
            assert!(path(&format!("[[path]]\nforce = 1\ntangential_force = {wrong}")).is_err(), "{wrong}");
        }
    }
}
