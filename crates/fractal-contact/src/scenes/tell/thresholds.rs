//! The load at which an interface closes, and that at which a body yields first, between two loads of a scene.

use crate::scenes::read::{LoadRequest, PrescribedLoad, Result, SceneFile, amount};
use crate::scenes::run::SolvedUnit;
use crate::scenes::tell::{StateTable, columns};
use contact_model::{ContactState, Table, Value};

/// The file with the thresholds.
pub(crate) const FILE: &str = "thresholds.csv";

/// Something that happens at some load, and goes on under larger ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Threshold {
    ClosesAlongX,
    ClosesAlongY,
    Yields,
}

impl Threshold {
    const ALL: [Self; 3] = [Self::ClosesAlongX, Self::ClosesAlongY, Self::Yields];

    /// Its name in the file.
    fn name(self) -> &'static str {
        match self {
            Self::ClosesAlongX => "closes_along_x",
            Self::ClosesAlongY => "closes_along_y",
            Self::Yields => "yields",
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::ClosesAlongX => "the gap closes along x",
            Self::ClosesAlongY => "the gap closes along y",
            Self::Yields => "the body yields first",
        }
    }

    fn is_requested(self, scene: &SceneFile) -> bool {
        let interface = &scene.requested.interface;
        match self {
            Self::ClosesAlongX | Self::ClosesAlongY => interface.percolation,
            Self::Yields => interface.stress_below.as_ref().is_some_and(|of| of.yield_stress.is_some()),
        }
    }

    /// Whether it has happened in a state.
    fn is_reached(self, state: &ContactState) -> Option<bool> {
        let closed = |axis: usize| state.interface.percolation.map(|paths| !paths[axis].open);
        match self {
            Self::ClosesAlongX => closed(0),
            Self::ClosesAlongY => closed(1),
            Self::Yields => {
                state.interface.stress.and_then(|s| s.factor_until_yield).map(|factor| factor <= 1.0)
            }
        }
    }
}

/// Whether a scene has thresholds: it has single loads and asks for what depends on them.
pub(crate) fn are_told(scene: &SceneFile) -> bool {
    matches!(scene.request, LoadRequest::Loads(_)) && Threshold::ALL.iter().any(|of| of.is_requested(scene))
}

/// The last state before a threshold and the first one after it, in the order of the forces. `None` stands for a
/// load smaller or larger than those of the scene.
fn bracket(unit: &SolvedUnit<'_>, of: Threshold) -> [Option<usize>; 2] {
    let mut states: Vec<(usize, f64, bool)> = unit
        .states
        .iter()
        .filter_map(|record| {
            let state = &record.converged()?.state;
            Some((record.index, state.force, of.is_reached(state)?))
        })
        .collect();
    states.sort_by(|a, b| a.1.total_cmp(&b.1));
    let reached = states.iter().rposition(|state| !state.2).map_or(0, |last| last + 1);
    let before = reached.checked_sub(1).map(|place| states[place].0);
    [before, states.get(reached).map(|state| state.0)]
}

fn prescribed(scene: &SceneFile, state: Option<usize>) -> Option<f64> {
    scene.request.prescribed(state?)
}

fn force(unit: &SolvedUnit<'_>, state: Option<usize>) -> Option<f64> {
    let record = unit.states.iter().find(|record| Some(record.index) == state)?;
    Some(record.converged()?.state.force)
}

/// One row for each threshold of each model on each surface.
pub(crate) fn table(states: &StateTable<'_>) -> Result<Table> {
    let scene = states.scene;
    let kind = columns::prescribed(scene).map_or("1", |column| column.unit);
    let newton = scene.system.unit("N");
    let numbers = [
        ("threshold", "-", "what happens at some load between the two states"),
        (
            "prescribed_before",
            kind,
            "the largest prescribed load before it; empty where it happens before all",
        ),
        ("prescribed_after", kind, "the smallest prescribed load after it; empty where it happens after all"),
        ("force_before", newton, "the normal force before it"),
        ("force_after", newton, "the normal force after it"),
    ];
    let all = [columns::MODEL, columns::SURFACE].into_iter().chain(numbers).map(columns::plain).collect();
    let mut table = Table::new(format!("{}: loads between which something happens", states.title), all);
    for unit in &states.units {
        for of in Threshold::ALL.into_iter().filter(|of| of.is_requested(scene)) {
            let [before, after] = bracket(unit, of);
            if before.or(after).is_none() {
                continue;
            }
            let mut row: Vec<Value> = vec![unit.model.into(), unit.surface.into(), of.name().into()];
            row.extend([before, after].map(|state| prescribed(scene, state).into()));
            row.extend([before, after].map(|state| force(unit, state).into()));
            table.push(row).map_err(runs::Error::model("a threshold"))?;
        }
    }
    Ok(table)
}

/// The thresholds of a model in words; of several surfaces their range.
pub(crate) fn lines(states: &StateTable<'_>, model: &str) -> Vec<String> {
    let scene = states.scene;
    if !are_told(scene) {
        return Vec::new();
    }
    let LoadRequest::Loads(loads) = &scene.request else { return Vec::new() };
    let unit = columns::prescribed(scene).map_or("1", |column| column.unit);
    let shown =
        |value: f64| if unit == "1" { amount(value, "") } else { amount(value, scene.system.shown(unit)) };
    let line = |of: Threshold| {
        let of_model = states.units.iter().filter(|unit| unit.model == model);
        let brackets: Vec<[Option<usize>; 2]> = of_model.map(|unit| bracket(unit, of)).collect();
        // Under a smaller mean gap the load is larger.
        let falls = loads.kind == PrescribedLoad::MeanGap;
        let ends = |end: usize| -> Option<[f64; 2]> {
            let of_surfaces = brackets.iter().map(|ends| prescribed(scene, ends[end]));
            let mut values = of_surfaces.collect::<Option<Vec<f64>>>()?;
            values.sort_by(f64::total_cmp);
            let [least, most] = [*values.first()?, *values.last()?];
            Some(if falls { [most, least] } else { [least, most] })
        };
        let kind = loads.kind.key().replace('_', " ");
        let surfaces = match brackets.len() {
            0 => return None,
            1 => String::new(),
            count => format!(" on {count} surfaces"),
        };
        let words = of.words();
        Some(match (ends(0).map(|[least, _]| least), ends(1).map(|[_, most]| most)) {
            (Some(before), Some(after)) => {
                format!("{words} at a {kind} between {} and {}{surfaces}", shown(before), shown(after))
            }
            (Some(before), None) => format!("{words} beyond a {kind} of {}{surfaces}", shown(before)),
            (None, Some(after)) => format!("{words} below a {kind} of {}{surfaces}", shown(after)),
            (None, None) => return None,
        })
    };
    Threshold::ALL.into_iter().filter(|of| of.is_requested(scene)).filter_map(line).collect()
}
