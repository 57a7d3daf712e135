//! The load at which an interface closes, and that at which a body yields first, between two loads of a scene.

use crate::scenes::plan::{Threshold, thresholds_of};
use crate::scenes::read::{LoadRequest, PrescribedLoad, Result, SceneFile, amount};
use crate::scenes::run::{SolvedUnit, bracket};
use crate::scenes::tell::{StateTable, columns};
use contact_model::{Table, Value};

/// The file with the thresholds.
pub(crate) const FILE: &str = "thresholds.csv";

/// Whether a scene has thresholds.
pub(crate) fn are_told(scene: &SceneFile) -> bool {
    !thresholds_of(scene).is_empty()
}

/// The loads between which a threshold lies on a surface, as they are prescribed and as forces: refined ones where
/// there are such, or those of the scene. `None` stands for a load smaller or larger than those of the scene.
fn between(scene: &SceneFile, unit: &SolvedUnit<'_>, of: Threshold) -> [[Option<f64>; 2]; 2] {
    if let Some(refined) = unit.thresholds.iter().find(|refined| refined.of == of) {
        return [refined.prescribed.map(Some), refined.forces.map(Some)];
    }
    let states = bracket(unit.states, of);
    [states.map(|state| prescribed(scene, state)), states.map(|state| force(unit, state))]
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
            "the largest prescribed load that is known to be before it; empty where it happens before all",
        ),
        (
            "prescribed_after",
            kind,
            "the smallest prescribed load that is known to be after it; empty where it happens after all",
        ),
        ("force_before", newton, "the normal force before it"),
        ("force_after", newton, "the normal force after it"),
    ];
    let all = [columns::MODEL, columns::SURFACE].into_iter().chain(numbers).map(columns::plain).collect();
    let mut table = Table::new(format!("{}: loads between which something happens", states.title), all);
    for unit in &states.units {
        for of in thresholds_of(scene) {
            let [prescribed, forces] = between(scene, unit, of);
            if prescribed == [None, None] {
                continue;
            }
            let mut row: Vec<Value> = vec![unit.model.into(), unit.surface.into(), of.name().into()];
            row.extend(prescribed.into_iter().chain(forces).map(Value::from));
            table.push(row).map_err(runs::Error::model("a threshold"))?;
        }
    }
    Ok(table)
}

/// The thresholds of a model in words; of several surfaces their range.
pub(crate) fn lines(states: &StateTable<'_>, model: &str) -> Vec<String> {
    let scene = states.scene;
    let LoadRequest::Loads(loads) = &scene.request else { return Vec::new() };
    let unit = columns::prescribed(scene).map_or("1", |column| column.unit);
    let shown =
        |value: f64| if unit == "1" { amount(value, "") } else { amount(value, scene.system.shown(unit)) };
    let line = |of: Threshold| {
        let of_model = states.units.iter().filter(|unit| unit.model == model);
        let brackets: Vec<[Option<f64>; 2]> = of_model.map(|unit| between(scene, unit, of)[0]).collect();
        // Under a smaller mean gap the load is larger.
        let falls = loads.kind == PrescribedLoad::MeanGap;
        let ends = |end: usize| -> Option<[f64; 2]> {
            let of_surfaces = brackets.iter().map(|ends| ends[end]);
            let mut values = of_surfaces.collect::<Option<Vec<f64>>>()?;
            values.sort_by(f64::total_cmp);
            let [least, most] = [*values.first()?, *values.last()?];
            Some(if falls { [most, least] } else { [least, most] })
        };
        let kind = match loads.kind {
            PrescribedLoad::Approach => "an approach".to_owned(),
            kind => format!("a {}", kind.key().replace('_', " ")),
        };
        let surfaces = match brackets.len() {
            0 => return None,
            1 => String::new(),
            count => format!(" on {count} surfaces"),
        };
        let words = of.words();
        Some(match (ends(0).map(|[least, _]| least), ends(1).map(|[_, most]| most)) {
            (Some(before), Some(after)) => {
                format!("{words} at {kind} between {} and {}{surfaces}", shown(before), shown(after))
            }
            (Some(before), None) => format!("{words} beyond {kind} of {}{surfaces}", shown(before)),
            (None, Some(after)) => format!("{words} below {kind} of {}{surfaces}", shown(after)),
            (None, None) => return None,
        })
    };
    thresholds_of(scene).into_iter().filter_map(line).collect()
}
